"""Regions of known laws, exact and timed, held to the curvature of the boundary at random values and beside each end.

    python -m tests.campaigns.region_points                 some 13,000 values
    python -m tests.campaigns.region_points 100 7           100 values a law beside those near its ends, by another seed

A boundary r(t) has the gauge h = 1/r, and K is convex where h > 0 and h + h'' >= 0 for all angles t.  That is asked on a grid, and in
fifty digits at the angle that is the worst there and at plain ones: near an end the two verdicts part within 1e-12.  Forms are held to
the eigenvalues of their second derivatives.  The exit code is 1 where a region is not exact or a verdict is another.
"""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp

import duhem
from duhem.law.builtin.lobes import lobe_law
from duhem.law.formula_law import Criterion
from duhem.proof.kernel.signs import RealRoot, sign_at
from duhem.regions import FoundRegion, region

__all__ = ["disagreements", "main"]

BETWEEN, POSITIVE = duhem.Domain.between, duhem.POSITIVE
T, E = sp.symbols("t e", real=True)
_ANGLES, _DIGITS, _NEAR, _FEW = 6001, 50, (12, 9, 6, 4, 2), 4  # how near to an end, in digits; values at each distance
_PLAIN = sorted({sp.Rational(k, n) for n in range(1, 9) for k in range(n + 1)})  # of half a turn


class Curve(NamedTuple):
    """The region of one parameter, and the gauge of its boundary; ``far`` is the greatest angle, in half turns."""

    ask: Callable[[], FoundRegion]
    gauge: sp.Expr
    far: sp.Rational = sp.Integer(1)


def _asked(law: Any, name: str | Sequence[str] | None = None, **over: Any) -> Callable[[], FoundRegion]:
    return lambda: region(law, name, "convexity", over)


def _adhesive() -> Criterion:
    free = {"c": POSITIVE, "mu": POSITIVE, "e": BETWEEN("-9/10", "9/10")}
    return Criterion("adhesive", "norm(x, y) - (c - mu*n)*(1 + e*cos(2*atan2(y, x)))", free, ("x", "y"), "n")


def _oval() -> Criterion:
    g = "norm(a, b)**2 - mu*abs(n)*(norm(a, b) + e*a)"
    return Criterion("oval", g, {"mu": POSITIVE, "e": BETWEEN(0, "4/5")}, ("a", "b"), "n")


def _form(g: str, **free: Any) -> Criterion:
    return Criterion("form", f"{g} - 1", free, ("x", "y"), None)


_COS3, _X = sp.cos(3 * T), sp.cos(T)
_ELLIPTIC = (4 * (1 - E**2) * _X**2 + (2 * E - 1) ** 2) / (
    2 * (1 - E**2) * _X + (2 * E - 1) * sp.sqrt(4 * (1 - E**2) * _X**2 + 5 * E**2 - 4 * E)
)
CURVES: Mapping[str, Curve] = {
    "limacon": Curve(_asked("limacon"), 1 / (1 + E * sp.cos(T))),
    **{f"{n} lobes": Curve(_asked(lobe_law(n), "e", e=("-9/10", "9/10")), 1 / (1 + E * sp.cos(n * T))) for n in range(2, 9)},
    "matchstick": Curve(_asked("matchstick"), 1 / sp.sqrt(E**2 * sp.cos(T) ** 2 + sp.sin(T) ** 2)),
    "quartic": Curve(
        _asked(_form("x**4 + c*x**2*y**2 + y**4", c=BETWEEN(-1, 10)), "c"),
        sp.root(sp.cos(T) ** 4 + E * sp.cos(T) ** 2 * sp.sin(T) ** 2 + sp.sin(T) ** 4, 4),
    ),
    "drucker": Curve(_asked("drucker", "c", c=(-6, 6)), sp.root(1 - E * sp.Rational(4, 27) * _COS3**2, 6)),
    "cazacu-barlat": Curve(_asked("cazacu-barlat", "c", c=(-3, 3)), sp.root(1 - E * 2 / (3 * sp.sqrt(3)) * _COS3, 3)),
    "willam-warnke": Curve(_asked("willam-warnke", "e", e=(0, 1)), _ELLIPTIC, sp.Rational(1, 3)),
    "argyris": Curve(_asked("argyris", "K", K=(0, 1)), 1 + E - (1 - E) * _COS3),
    "cos 2 theta with adhesion": Curve(_asked(_adhesive(), "e"), 1 / (1 + E * sp.cos(2 * T))),
    "oval of the README": Curve(_asked(_oval()), 1 / (1 + E * sp.cos(T))),
}


def _quartic_holds(at: Mapping[str, float]) -> float:
    """The least eigenvalue of the second derivatives of x^4 + a x^3 y + b x^2 y^2 + a x y^3 + y^4 on the unit circle."""
    (a, b), angle = (at["a"], at["b"]), np.linspace(0, np.pi, _ANGLES)
    x, y = np.cos(angle), np.sin(angle)
    xx, yy, xy = (
        12 * x**2 + 6 * a * x * y + 2 * b * y**2,
        12 * y**2 + 6 * a * x * y + 2 * b * x**2,
        3 * a * x**2 + 4 * b * x * y + 3 * a * y**2,
    )
    return float(np.min((xx + yy) / 2 - np.sqrt(((xx - yy) / 2) ** 2 + xy**2)))


def _least(*rows: Sequence[float]) -> float:
    return float(np.linalg.eigvalsh(np.array(rows))[0])


def _fibre(at: Mapping[str, float]) -> float:
    """Of (s22 + s33)^2/(T C) + (s23^2 - s22 s33)/S23^2 in s22 and s33, times T C."""
    half = at["T"] * at["C"] / (2 * at["S23"] ** 2)
    return _least((1, 1 - half), (1 - half, 1))


FIBRE = Criterion(
    "fibre",
    "(1/T - 1/C)*(s22 + s33) + (s22 + s33)**2/(T*C) + (s23**2 - s22*s33)/S23**2 + (s12**2 + s31**2)/S12**2 - 1",
    dict.fromkeys(("T", "C", "S23", "S12"), POSITIVE), ("s22", "s33", "s23", "s12", "s31"), None,
)  # fmt: skip
FORMS: Mapping[str, tuple[Callable[[], FoundRegion], Mapping[str, tuple[float, float]], Callable[[Mapping[str, float]], float]]] = {
    "a form of two": (
        _asked(_form("x**4 + a*x**3*y + b*x**2*y**2 + a*x*y**3 + y**4", a=BETWEEN(-8, 8), b=BETWEEN(-3, 10)), ("a", "b")),
        {"a": (-8, 8), "b": (-3, 10)}, _quartic_holds,
    ),
    "christensen": (_asked(FIBRE), dict.fromkeys(("T", "C", "S23"), (0.1, 10)), _fibre),
    "hill48": (
        _asked("hill48", ("F", "G", "H"), **dict.fromkeys("FGH", (-1, 3))), dict.fromkeys("FGH", (-1, 3)),
        lambda at: _least((at["G"] + at["H"], -at["H"]), (-at["H"], at["F"] + at["H"])),
    ),
}  # fmt: skip
_TOO_NEAR = 1e-3  # an eigenvalue that the grid does not tell from 0


def disagreements(found: FoundRegion, curve: Curve, values: Sequence[Fraction]) -> Iterator[Fraction]:
    """Yield the values of a parameter at which the region says another thing than the curvature."""
    bend, far = curve.gauge + sp.diff(curve.gauge, T, 2), float(sp.pi * curve.far)
    angles = np.linspace(0, far * (1 - 1e-9), _ANGLES)  # at the end itself floats may see less than 0 under a root
    on_grid, of_gauge, exactly = (sp.lambdify((T, E), f, words) for f, words in ((bend, "numpy"), (curve.gauge, "numpy"), (bend, "mpmath")))
    for x in values:
        with np.errstate(all="ignore"):
            least, size = on_grid(angles, float(x)), np.broadcast_to(of_gauge(angles, float(x)), angles.shape)
        convex = bool((size > 0).all())
        if convex:
            with mpmath.workdps(_DIGITS):
                e, turns = mpmath.mpf(x.numerator) / x.denominator, (mpmath.pi * mpmath.mpf(p.p) / p.q for p in _PLAIN if p <= curve.far)
                convex = min(mpmath.re(exactly(t, e)) for t in (*turns, mpmath.mpf(float(angles[np.nanargmin(least)])))) >= 0
        if convex != (_verdict(found, x) == "proved"):
            yield x


def _verdict(found: FoundRegion, x: Fraction) -> str:
    for cell, leaf in found.known:
        after = cell.low is None or _beyond(x, cell.low) or (not cell.open and x == cell.low.low and cell.low.exact)
        before = cell.high is None or not (_beyond(x, cell.high) or (cell.open_high and x == cell.high.low and cell.high.exact))
        if after and before:
            return str(leaf["verdict"])
    raise AssertionError(f"no cell has {x}")


def _beyond(x: Fraction, end: RealRoot) -> bool:
    if end.exact or not end.low < x < end.high:
        return x > end.low
    return sign_at(end.poly, x) != sign_at(end.poly, end.low)


def _values(found: FoundRegion, count: int, draw: random.Random) -> list[Fraction]:
    """Some in the domain, and some near each end of a cell."""
    low, high = found.known[0].cell.low, found.known[-1].cell.high
    first, last = Fraction(1, 100) if low is None or not low.low else low.low, Fraction(4) if high is None else high.high
    values = [first + (last - first) * Fraction(draw.randrange(1, 10**9), 10**9) for _ in range(count)]
    ends = [(end.low + end.high) / 2 for cell, _ in found.known for end in cell[:2] if end is not None and first < end.low < last]
    tiny = (Fraction(sign * draw.randrange(10**5, 10**6), 10 ** (6 + digits)) for digits in _NEAR for sign in (1, -1) for _ in range(_FEW))
    values += [end + way for way in [*tiny] for end in ends]
    return [x for x in values if first <= x <= last]


def main(arguments: Sequence[str]) -> int:
    """Run the campaign."""
    count, seed = (int(word) for word in (*arguments, *("480", "1")[len(arguments) :]))
    draw, total, wrong = random.Random(seed), 0, 0

    def row(name: str, found: FoundRegion, seconds: float, asked: int, others: Sequence[object]) -> None:
        nonlocal total, wrong
        total, wrong = total + asked, wrong + len(others) + (not found.exact)
        kind = "exact" if found.exact else "NOT EXACT"
        print(
            name, kind, f"{seconds:.1f} s", found.sentence, f"{asked} values", f"{len(others)} others", *others[:3], sep=" | ", flush=True
        )

    for name, curve in CURVES.items():
        start = time.process_time()
        found = curve.ask()
        seconds, values = time.process_time() - start, _values(found, count, draw)
        row(name, found, seconds, len(values), [*disagreements(found, curve, values)])
    for name, (ask, ranges, least) in FORMS.items():
        start = time.process_time()
        found = ask()
        seconds, many = time.process_time() - start, 2 * count
        places = {x: np.array([draw.uniform(*ends) for _ in range(many)]) for x, ends in ranges.items()}
        told = [(least({x: float(v[i]) for x, v in places.items()}), verdict == "proved") for i, verdict in enumerate(found.at(places))]
        clear = [(value, proved) for value, proved in told if abs(value) > _TOO_NEAR]
        row(name, found, seconds, len(clear), [value for value, proved in clear if (value > 0) is not proved])
    print(f"{total} values, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
