"""Polynomial laws of known truth, near and away from the threshold: python -m tests.campaigns.polynomials [SETS [FORMS [SEED]]]

Quartics of plane stress are held against an oracle of their own; forms in two to six forces have thresholds that are known
exactly.  Prints a line a family and margin, then what is wrong or open, and the processor time of the verdicts alone.
"""

from __future__ import annotations

import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from itertools import chain, product
from itertools import count as counted
from statistics import median

import sympy as sp

from duhem import Criterion, verify
from tests.campaigns.families.trial import Trial
from tests.oracles import plane_quartics

F = Fraction
PLANE = ((4, 0, 0), (3, 1, 0), (2, 2, 0), (1, 3, 0), (0, 4, 0), (2, 0, 2), (1, 1, 2), (0, 2, 2), (0, 0, 4))
AWAY = (F(0), F(3, 10), F(7, 10), F(95, 100), F(105, 100), F(13, 10), F(2), F(4))
NEAR = tuple(1 + s * F(1, 10**k) for k in (3, 5, 7, 9) for s in (-1, 1))


def plane_sets(count: int, seed: int) -> Iterator[Trial]:
    """Quartics of plane stress on rays that leave the convex ones, at shares of the way out."""
    sets = chain.from_iterable(plane_ray(seed, ray) for ray in counted())
    for made, (coefficients, truth, margin) in zip(range(1, count + 1), sets, strict=False):
        terms = " + ".join(f"({c})*sx**{i}*sy**{j}*t**{k}" for c, (i, j, k) in zip(coefficients, PLANE, strict=True) if c)
        law = Criterion(name=f"plane-{made}", g=f"{terms} - 1", forces=("sx", "sy", "t"), pressure=None)
        yield Trial("quartic of plane stress", law, {"convexity": truth}, margin)


def plane_ray(seed: int, ray: int) -> list[tuple[list[F], bool, str]]:
    """Coefficients of one ray, whether each set is convex, and how far it is from the threshold; none where the ray does not leave."""
    rng = random.Random(f"{seed}/plane/{ray}")
    start, way = _sum_of_powers(rng), [F(rng.randint(-40, 40), 10) for _ in PLANE]
    low, high = F(0), F(1)
    while plane_quartics.convex(_moved(start, way, high)):
        low, high = high, 2 * high
        if high > 2**12:
            break
    if high > 2**12 or not plane_quartics.convex(start):
        return []
    while high - low > high / 2**36:
        middle = (low + high) / 2
        low, high = (middle, high) if plane_quartics.convex(_moved(start, way, middle)) else (low, middle)
    sets = [(_moved(start, way, share * low), _margin(share)) for share in (*AWAY, *NEAR)]
    known = [(coefficients, plane_quartics.convex(coefficients), margin) for coefficients, margin in sets]
    return [(coefficients, truth, margin) for coefficients, truth, margin in known if truth is not None]


def _moved(start: list[F], way: list[F], by: F) -> list[F]:
    return [a + by * b for a, b in zip(start, way, strict=True)]


def _margin(share: F) -> str:
    return "away" if share in AWAY else f"{'below' if share < 1 else 'above'} {float(abs(share - 1)):.0e}"


def _sum_of_powers(rng: random.Random) -> list[F]:
    """Fourth powers of linear forms and squares of positive quadratic ones, even in the shear stress: strictly convex."""
    x, y, t = sp.symbols("x y t")
    total = sp.S.Zero
    for _ in range(3):
        a, b, c = (sp.Rational(rng.randint(-20, 20), 10) for _ in range(3))
        total += (a * x + b * y + c * t) ** 4 + (a * x + b * y - c * t) ** 4
    total += sp.Rational(rng.randint(1, 20), 20) * (x**2 + y**2 + t**2) ** 2
    poly = sp.Poly(total, x, y, t)
    return [F(int(c.p), int(c.q)) for m in PLANE for c in [poly.coeff_monomial(m)]]


def forms(count: int, seed: int) -> Iterator[Trial]:
    """|y|^2k - c y_1^2k in turned and sheared coordinates y, convex iff c <= ((2k/(2k - 1))^k)/2: 8/9, 108/125, 2048/2401, ...

    With |y| = 1 the second derivative along v is 2k (|v|^2 + (2k - 2)(y . v)^2 - (2k - 1) c y_1^(2k-2) v_1^2), and the greatest
    v_1^2/(|v|^2 + (2k - 2)(y . v)^2) is 1 - (2k - 2)/(2k - 1) y_1^2; what c must not exceed is found at y_1^2 = (2k - 1)/2k.
    """
    edges = [(F(1), "exact")] + [(1 + s * F(1, 10**k), f"{'below' if s < 0 else 'above'} 1e-{k}") for k in (1, 4, 9) for s in (-1, 1)]
    kinds = [(n, k) for k, most in ((2, 6), (3, 4), (4, 3)) for n in range(2, most + 1)]
    for made, ((n, k), (factor, margin)) in zip(range(count), _endless(list(product(kinds, edges))), strict=False):
        rng = random.Random(f"{seed}/forms/{made}")
        names = "abcdef"[:n]
        forces = sp.symbols(" ".join(names))
        rows = [[sp.Rational(rng.randint(-4, 4), rng.randint(2, 3)) + 2 * (i == j) for j in range(n)] for i in range(n)]
        if sp.Matrix(rows).det() == 0:
            continue
        moved = [sum(c * x for c, x in zip(row, forces, strict=True)) for row in rows]
        edge = F(2 * k, 2 * k - 1) ** k / 2
        c = factor * edge
        p = sum(z**2 for z in moved) ** k - sp.Rational(c.numerator, c.denominator) * moved[0] ** (2 * k)
        law = Criterion(name=f"form-{made}", g=f"{sp.expand(p)} - 1", forces=tuple(names), pressure=None)
        yield Trial(f"degree {2 * k}, {n} forces", law, {"convexity": c <= edge}, margin)


def _endless(kinds: list) -> Iterator:
    while True:
        yield from kinds


def run(trials: Iterator[Trial]) -> None:
    """Print what came of them."""
    table: dict[tuple[str, str], Counter[str]] = {}
    seconds, trusts, odd = dict[str, list[float]](), Counter[str](), list[str]()
    for trial in trials:
        start = time.process_time()
        found = verify(trial.law, claims=["convexity"])["convexity"]
        seconds.setdefault(trial.family, []).append(time.process_time() - start)
        said = {"proved": True, "refuted": False}.get(found.verdict.value)
        what = "open" if said is None else "right" if said == trial.truth["convexity"] else "WRONG"
        table.setdefault((trial.family, trial.margin), Counter())[what] += 1
        if found.verdict.value == "proved":
            trusts[str(found.trust)] += 1
        if what != "right":
            odd.append(f"{what} {trial.family}, {trial.margin}, convex {trial.truth['convexity']}: {found.method}; {trial.law.g}"[:400])
    print(*odd, sep="\n")
    for (family, margin), counts in sorted(table.items()):
        print(f"{family:26} {margin:14} {counts['right']:5} right {counts['open']:4} open {counts['WRONG']:3} wrong")
    for family, each in seconds.items():
        print(f"{family:26} {len(each)} laws, {sum(each):.1f} s of processor time, median {median(each):.3f}, most {max(each):.2f}")
    print("proofs:", dict(trusts))


if __name__ == "__main__":
    sets_, forms_, seed_ = (*map(int, sys.argv[1:]), *(2000, 140, 1)[len(sys.argv) - 1 :])
    run(plane_sets(sets_, seed_))
    run(forms(forms_, seed_))
