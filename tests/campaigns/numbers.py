"""Answers judged against many digits where doubles are at their end: python -m tests.campaigns.numbers [family ...]

Families of laws, loads and trials on which g cancels, powers leave the range of doubles, trials lie ulps from the boundary
and stiffnesses and coefficients are 1e12 apart.  A status ``stick`` or ``slip`` vouches for the stress to 1e-7 and for the slip
to 1e-6, each of its largest component; what is as good as that and flagged all the same is counted too.
"""

from __future__ import annotations

import argparse
import itertools
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mpmath import MPContext

import duhem
from duhem.benchmark.reference import Closest, distance
from duhem.errors import DuhemError
from duhem.law.formula_law import Criterion
from duhem.projection.increment import at_doubles
from duhem.projection.result import ACCURACY, Status
from duhem.projection.validation import increment

SLIP = 1e-6
LOADS = (1e-290, 1e-200, 1e-80, 1e-20, 1.0, 1e20, 1e80, 1e200, 1e290)
ULPS = (1 - 1e-15, 1 + 1e-15, 1 + 1e-14, 1 + 1e-13, 1 + 1e-12, 1 + 1e-11, 1 + 1e-10, 1 + 1e-9, 1 + 1e-8, 1 + 1e-6)
FAR = (0.3, 1.01, 2.3, 1e3, 1e12)
ANGLES = (0.1, 0.7, 2.0, 3.9)

mp = MPContext()
mp.dps = 60


@dataclass(frozen=True)
class Question:
    """Trials (N, 2) of one law; ``radius`` in many digits where K is a disk and k one number."""

    law: str | Criterion
    parameters: dict[str, Any]
    trial: np.ndarray
    pressure: float | None
    stiffness: Any = 1.0
    radius: Any = None


@dataclass
class Count:
    """Points, those wrong without a flag in stress and in slip, the right ones and those of them that are flagged."""

    points: int = 0
    wrong_stress: int = 0
    wrong_slip: int = 0
    right: int = 0
    right_flagged: int = 0
    seen: list[str] = field(default_factory=list)


def ring(radius: Any, shares: Sequence[float]) -> np.ndarray:
    """Trials at these shares of a radius, of which they keep the digits."""
    with np.errstate(over="ignore"):
        found = np.array([[float(radius * mp.mpf(f) * w(mp.mpf(a))) for w in (mp.cos, mp.sin)] for f in shares for a in ANGLES])
    return found[np.isfinite(found).all(axis=1)]


def disk(
    law: str | Criterion, parameters: dict[str, Any], pressure: float, radius: Any, shares: Sequence[float], k: float = 1.0
) -> Question:
    return Question(law, parameters, ring(radius, shares), pressure, k, radius)


def cancelling() -> Iterator[Question]:
    """Radii that are differences of numbers much larger."""
    written = Criterion("hyperbola", "sqrt(1 + sigma_a**2 + sigma_b**2) - 1 - abs(sigma_n)")
    cosh = Criterion("catenary", "cosh(norm(sigma_a, sigma_b)) - 1 - abs(sigma_n)")
    shifted = Criterion("far", "(sigma_a + 1000)**2 + (sigma_b - 500)**2 - 2000*sigma_a + 1000*sigma_b - 1250000 - sigma_n**2")
    spread = Criterion("spread", "sqrt((sigma_a - 3*sigma_b)**2 - 8*sigma_b**2 + 6*sigma_a*sigma_b) - abs(sigma_n)")
    for load in (1e-2, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-15):
        n = mp.mpf(load)
        yield disk("regularised", {"mu": 1.0, "c": 1.0}, -load, mp.sqrt(n * n + 2 * n), FAR[:4])
        yield disk(written, {}, -load, mp.sqrt(n * n + 2 * n), FAR[:4])
        yield disk(cosh, {}, -load, mp.acosh(1 + n), FAR[1:3])
        yield disk(shifted, {}, -load, n, FAR[:4])
        yield disk(spread, {}, -load, n, FAR[:4])


def powers() -> Iterator[Question]:
    """Formulas of a degree, at loads whose powers a double does not hold."""
    for load in LOADS:
        n = mp.mpf(load)
        yield disk("coulomb", {"mu": 0.5}, -load, n / 2, FAR)
        yield disk("quartic", {"mu": 0.5, "c": 2}, -load, n / 2, FAR)
        yield disk("limacon", {"mu": 0.5, "e": 0}, -load, n / 2, FAR)
        yield disk("matchstick", {"mu_a": 0.5, "mu_b": 0.5}, -load, n / 2, FAR)
        yield disk("lobes", {"mu": 0.5, "e": 0}, -load, n / 2, FAR)
        yield disk("superellipse", {"mu_a": 0.5, "mu_b": 0.5, "p": 2}, -load, n / 2, FAR)
        yield disk("orthotropic", {"mu_a": 0.5, "mu_b": 0.5}, -load, n / 2, FAR, 3e11)
        yield disk("capped", {"mu": 0.5, "tau_max": 0.1}, -load, min(n / 2, mp.mpf(0.1)), FAR)
        yield disk("cohesive", {"mu": 0.5, "cohesion": 1.0}, -load, n / 2 + 1, FAR)
        yield disk("regularised", {"mu": 0.5, "c": 0.125}, -load, mp.sqrt(n * n / 4 + n / 8), FAR)


def ulps() -> Iterator[Question]:
    """Trials next to the boundary."""
    for load in (1e-200, 1.0, 1e200):
        n = mp.mpf(load)
        yield disk("coulomb", {"mu": 0.5}, -load, n / 2, ULPS)
        yield disk("quartic", {"mu": 0.5, "c": 2}, -load, n / 2, ULPS)
        yield disk("limacon", {"mu": 0.5, "e": 0}, -load, n / 2, ULPS, 3e11)
        yield disk("superellipse", {"mu_a": 0.5, "mu_b": 0.5, "p": 2}, -load, n / 2, ULPS)
        yield disk("cohesive", {"mu": 0.5, "cohesion": 1.0}, -load, n / 2 + 1, ULPS)
        yield disk("regularised", {"mu": 0.5, "c": 0.125}, -load, mp.sqrt(n * n / 4 + n / 8), ULPS)
    laws: list[tuple[str, dict[str, Any]]] = [
        ("antoni2007", {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}),
        ("box", {"mu_a": 0.3, "mu_b": 0.1}),
        ("polygon", {"mu": 0.3}),
        ("superellipse", {"mu_a": 0.3, "mu_b": 0.1, "p": 4}),
        ("superellipse", {"mu_a": 0.3, "mu_b": 0.1, "p": 1.25}),
        ("limacon", {"mu": 0.3, "e": 0.375}),
    ]
    for (law, parameters), k in itertools.product(laws, (np.array([1.0, 2.0]), np.array([1.0, 1e6]))):
        yield Question(law, parameters, _edge(law, parameters, ULPS[1::3]), -1.0, k)


def aspects() -> Iterator[Question]:
    """Coefficients and stiffnesses far apart."""
    for e, f in itertools.product((1e-12, 1e-6, 1.0, 1e6), (1e-12, 1e-6, 1.0, 1e6, 1e12)):
        for law, parameters in (
            ("orthotropic", {"mu_a": 1.0, "mu_b": e}),
            ("box", {"mu_a": 1.0, "mu_b": e}),
            ("superellipse", {"mu_a": 1.0, "mu_b": e, "p": 4}),
        ):
            trial = np.array([[2.0, 1.5 * e], [0.3, 3.0 * e], [1e3, -e], [-1.1, 1e3 * e]])
            yield Question(law, parameters, trial, -1.0, np.array([1.0, f]))


FAMILIES: dict[str, Callable[[], Iterator[Question]]] = {"cancelling": cancelling, "powers": powers, "ulps": ulps, "aspects": aspects}


def _edge(law: str, parameters: dict[str, Any], shares: Sequence[float]) -> np.ndarray:
    """Trials at shares of how far K reaches at unit pressure, by a bisection in doubles."""
    posed = increment(duhem.load(law), np.ones((1, 2)), -1.0, 1.0, parameters)
    symbols = (*posed.law.force_symbols(), posed.law.symbols()["sigma_n"])
    g = duhem.expression.numpy_.compiled(posed.g, symbols)
    way = np.array([[np.cos(a), np.sin(a)] for a in ANGLES])
    low, high = np.zeros(len(way)), np.full(len(way), 10.0)
    for _ in range(80):
        middle = (low + high) / 2
        inside = g(*(middle[:, None] * way).T, -1.0) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.concatenate([share * low[:, None] * way for share in shares])


def answers(asked: Question) -> Iterator[tuple[Sequence[Any], Sequence[Any]]]:
    """Stress and slip of each trial in many digits."""
    if asked.radius is not None:
        for trial in asked.trial:
            x = [mp.mpf(float(t)) for t in trial]
            share = min(mp.mpf(1), asked.radius / mp.sqrt(x[0] ** 2 + x[1] ** 2))
            stress = [share * t for t in x]
            yield stress, [(t - s) / mp.mpf(asked.stiffness) for t, s in zip(x, stress, strict=True)]
        return
    law = duhem.load(asked.law) if isinstance(asked.law, str) else asked.law
    posed = increment(law, asked.trial, asked.pressure, asked.stiffness, asked.parameters)
    closest = Closest(
        at_doubles(law, posed.parameters), law.force_symbols(), law.symbols().get(law.pressure or ""), posed.stiffness.tolist(), 40
    )
    for trial in asked.trial:
        found = closest(trial.tolist(), asked.pressure)
        yield found.stress, found.slip


def counted(
    asked: Question, method: str, count: Count, exact: Sequence[tuple[Sequence[Any], Sequence[Any]]], verbose: bool = False
) -> None:
    """Add the answers of one method to the count."""
    done = duhem.project(asked.law, asked.trial, asked.pressure, asked.stiffness, asked.parameters, method=method)
    for i, (stress, slip) in enumerate(exact):
        off_stress, off_slip = distance(done.stress[i].tolist(), stress), distance(done.slip[i].tolist(), slip)
        flagged = done.status[i] in (Status.INACCURATE, Status.FAILED)
        right = off_stress <= ACCURACY and off_slip <= SLIP
        count.points += 1
        count.right += right
        count.right_flagged += right and flagged
        count.wrong_stress += not flagged and not off_stress <= ACCURACY
        count.wrong_slip += not flagged and not off_slip <= SLIP
        if verbose and right == flagged:
            where = f"{asked.trial[i].tolist()} {asked.pressure} k {np.asarray(asked.stiffness).tolist()} {asked.parameters}"
            print(f"  {Status(done.status[i]).name} stress {off_stress:.1e} slip {off_slip:.1e} residuals", end=" ")
            print(*(f"{getattr(done.residuals, name)[i]:.1e}" for name in done.residuals.__dataclass_fields__), where)


def tally(questions: Iterator[Question], methods: Sequence[str], verbose: bool = False) -> dict[tuple[str, str], Count]:
    """Counts by law and method."""
    found: dict[tuple[str, str], Count] = {}
    for asked in questions:
        name = asked.law if isinstance(asked.law, str) else asked.law.name
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            try:
                exact = list(answers(asked))
            except DuhemError as fault:
                print(f"{name}: no reference: {fault}")
                continue
            for method in methods:
                if method == "closed-form" and duhem.load(asked.law).closed_form is None:
                    continue
                counted(asked, method, found.setdefault((name, method), Count()), exact, verbose)
    return found


def main() -> None:
    """Print a line a family, law and method."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("family", nargs="*", default=list(FAMILIES))
    reader.add_argument("--method", nargs="*", default=["closed-form", "newton"])
    reader.add_argument("--verbose", action="store_true")
    asked = reader.parse_args()
    heads = f"{'points':>6} {'wrong stress':>12} {'wrong slip':>10} {'right':>6} {'of these flagged':>16}"
    print(f"{'family':11} {'law':13} {'method':12} {heads}")
    total: Counter[str] = Counter()
    for family in asked.family:
        for (law, method), c in tally(FAMILIES[family](), asked.method, asked.verbose).items():
            print(f"{family:11} {law:13} {method:12} {c.points:6} {c.wrong_stress:12} {c.wrong_slip:10} {c.right:6} {c.right_flagged:16}")
            total.update(points=c.points, stress=c.wrong_stress, slip=c.wrong_slip, right=c.right, flagged=c.right_flagged)
    print(f"{'all':38} {total['points']:6} {total['stress']:12} {total['slip']:10} {total['right']:6} {total['flagged']:16}")


if __name__ == "__main__":
    main()
