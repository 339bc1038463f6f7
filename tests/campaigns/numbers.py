"""Answers judged against many digits where doubles are at their end: python -m tests.campaigns.numbers [family ...]

Families of laws, loads and trials on which g cancels, powers leave the range of doubles, trials lie ulps from the boundary,
stiffnesses and coefficients are 1e12 apart and sets are not convex.  A status ``stick`` or ``slip`` vouches for the stress to 1e-7
and for the slip to 1e-6, each of its largest component, or so that k slip is right to 1e-27 of the stress; what is as good as that
and flagged all the same is counted too.  Every method that takes a law is asked; cvxpy, which is slow, one question of ``--seldom``.
"""

from __future__ import annotations

import argparse
import itertools
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import duhem
from duhem.benchmark.reference import Closest, NoReference, distance
from duhem.projection.increment import at_doubles
from duhem.projection.methods import METHODS
from duhem.projection.result import ACCURACY, Status
from duhem.projection.validation import increment
from tests.campaigns.number_families import FAMILIES, Question, mp

SLIP = 1e-6
LEAST = 1e-27

Array = NDArray[np.float64]


@dataclass
class Count:
    """Points, those wrong without a flag in stress and in slip, the right ones and those of them that are flagged."""

    points: int = 0
    wrong_stress: int = 0
    wrong_slip: int = 0
    right: int = 0
    right_flagged: int = 0


_Answer = tuple[Sequence[Any], Sequence[Any]]


def answers(asked: Question) -> Iterator[_Answer | None]:
    """Stress and slip of each trial in many digits; None where there is no reference."""
    if callable(asked.radius):
        for trial in asked.trial:
            yield _closest_of_all(asked.radius, trial, [mp.mpf(float(k)) for k in asked.stiffness])
        return
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
        try:
            found = closest(trial.tolist(), asked.pressure)
            yield found.stress, found.slip
        except NoReference:
            yield None


def _closest_of_all(radius: Callable[[Any], Any], trial: Array, k: Sequence[Any]) -> _Answer:
    """The closest point of a boundary given by its radius over the angle: of the angles on a grid, then between the next two."""

    def away(a: Any) -> Any:
        r = radius(a)
        return (trial[0] - r * mp.cos(a)) ** 2 / k[0] + (trial[1] - r * mp.sin(a)) ** 2 / k[1]

    if mp.hypot(*trial) <= radius(mp.atan2(trial[1], trial[0])):
        return list(map(mp.mpf, trial)), [mp.mpf(0)] * 2
    step = 2 * mp.pi / 720
    best = min((i * step for i in range(720)), key=away)
    low, high, golden = best - step, best + step, (mp.sqrt(5) - 1) / 2
    for _ in range(150):
        a, b = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, b) if away(a) < away(b) else (a, high)
    stress = [radius(low) * mp.cos(low), radius(low) * mp.sin(low)]
    return stress, [(mp.mpf(t) - s) / x for t, s, x in zip(trial, stress, k, strict=True)]


def counted(asked: Question, method: str, count: Count, exact: Sequence[_Answer | None], verbose: bool = False) -> None:
    """Add the answers of one method to the count."""
    how: dict[str, Any] = {"method": "newton", "compiled": True} if method == "compiled" else {"method": method}
    done = duhem.project(asked.law, asked.trial, asked.pressure, asked.stiffness, asked.parameters, **how)
    k = np.asarray(asked.stiffness, dtype=float)
    k = k if k.ndim == 2 else np.diag(np.broadcast_to(k, asked.trial.shape[1]))
    for i, answer in enumerate(exact):
        if answer is None:
            continue
        stress, slip = answer
        off_stress, off_slip = distance(done.stress[i].tolist(), stress), distance(done.slip[i].tolist(), slip)
        if off_slip > SLIP:
            missed = [mp.mpf(float(a)) - b for a, b in zip(done.slip[i], slip, strict=True)]
            pushed = [sum(mp.mpf(float(x)) * m for x, m in zip(row, missed, strict=True)) for row in k]
            off_slip = 0.0 if max(map(abs, pushed)) <= LEAST * max(map(abs, stress)) else off_slip
        flagged = done.status[i] in (Status.INACCURATE, Status.FAILED)
        silent = not flagged and done.status[i] != Status.STATIONARY  # for which nobody vouches, right or wrong
        right = off_stress <= ACCURACY and off_slip <= SLIP
        count.points += 1
        count.right += right
        count.right_flagged += right and flagged
        count.wrong_stress += silent and not off_stress <= ACCURACY
        count.wrong_slip += silent and not off_slip <= SLIP
        if verbose and right == flagged:
            name = asked.law if isinstance(asked.law, str) else asked.law.name
            where = f"{name} {method} {asked.trial[i].tolist()} {asked.pressure} k {k.tolist()} {asked.parameters}"
            print(f"  {Status(done.status[i]).name} stress {off_stress:.1e} slip {off_slip:.1e} residuals", end=" ")
            print(*(f"{getattr(done.residuals, name)[i]:.1e}" for name in done.residuals.__dataclass_fields__), where)


def tally(questions: Iterator[Question], methods: Sequence[str], verbose: bool = False, seldom: int = 1) -> dict[tuple[str, str], Count]:
    """Counts by law and method."""
    found: dict[tuple[str, str], Count] = {}
    for turn, asked in enumerate(questions):
        name = asked.law if isinstance(asked.law, str) else asked.law.name
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            exact = list(answers(asked))
            for method in methods:
                if (method == "cvxpy" and turn % seldom) or not _takes(method, asked):
                    continue
                counted(asked, method, found.setdefault((name, method), Count()), exact, verbose)
    return found


def _takes(method: str, asked: Question) -> bool:
    law = duhem.load(asked.law) if isinstance(asked.law, str) else asked.law
    posed = increment(law, asked.trial[:1], asked.pressure, asked.stiffness, asked.parameters)
    return METHODS["newton" if method == "compiled" else method]().applies(posed) is None


def main() -> None:
    """Print a line a family, law and method."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("family", nargs="*", default=list(FAMILIES))
    reader.add_argument("--method", nargs="*", default=["closed-form", "newton", "compiled", "cvxpy"])
    reader.add_argument("--every", type=int, default=1, help="one question of so many")
    reader.add_argument("--seldom", type=int, default=4)
    reader.add_argument("--verbose", action="store_true")
    asked = reader.parse_args()
    heads = f"{'points':>6} {'wrong stress':>12} {'wrong slip':>10} {'right':>6} {'of these flagged':>16}"
    print(f"{'family':11} {'law':15} {'method':12} {heads}")
    total: Counter[str] = Counter()
    for family in asked.family:
        for (law, method), c in tally(
            itertools.islice(FAMILIES[family](), 0, None, asked.every), asked.method, asked.verbose, asked.seldom
        ).items():
            print(f"{family:11} {law:15} {method:12} {c.points:6} {c.wrong_stress:12} {c.wrong_slip:10} {c.right:6} {c.right_flagged:16}")
            total.update(points=c.points, stress=c.wrong_stress, slip=c.wrong_slip, right=c.right, flagged=c.right_flagged)
    print(f"{'all':40} {total['points']:6} {total['stress']:12} {total['slip']:10} {total['right']:6} {total['flagged']:16}")


if __name__ == "__main__":
    main()
