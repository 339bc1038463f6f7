"""Answers judged against many digits where doubles are at their end: python -m tests.campaigns.numbers [family ...]

Families of laws, loads and trials on which g cancels, powers leave the range of doubles, trials lie ulps from the boundary,
stiffnesses and coefficients are 1e12 apart and sets are not convex.  A status ``stick`` or ``slip`` vouches for the stress to 1e-7
and for the slip to 1e-6, each of its largest component, or so that k slip is right to 1e-27 of the stress; what is as good as that
and flagged all the same is counted too.  Every method that takes a law is asked; cvxpy, which is slow, one question of ``--seldom``.

Where K is not convex, or not shown to be, nobody vouches that a stationary point is the closest: what is right there and comes out
as ``stationary``, or flagged, is so by design and stands apart.

A long run may be had in parts: ``--to FILE`` adds a line of counts a family, law and method, ``--sum FILE ...`` prints them together.
"""

from __future__ import annotations

import argparse
import itertools
import json
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import duhem
from duhem.api.convexity import asked as convexity
from duhem.benchmark.reference import Closest, NoReference, distance
from duhem.projection.increment import at_doubles, increment
from duhem.projection.methods import METHODS
from duhem.projection.result import ACCURACY, Status
from tests.campaigns.number_families import FAMILIES, Question, mp

SLIP = 1e-6
LEAST = 1e-27

Array = NDArray[np.float64]


@dataclass
class Count:
    """Points, those wrong without a flag in stress and in slip, the right ones, and those of them that are flagged.

    Of the right ones on a K that is not shown to be convex ``unvouched_flagged`` are flagged and ``stationary`` no more than that;
    ``elsewhere`` are stationary and not the closest.
    """

    points: int = 0
    wrong_stress: int = 0
    wrong_slip: int = 0
    right: int = 0
    right_flagged: int = 0
    unvouched_flagged: int = 0
    stationary: int = 0
    elsewhere: int = 0

    def __add__(self, other: Count) -> Count:
        return Count(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(Count)))

    def text(self) -> str:
        """One row of the table."""
        share = f"{self.right_flagged / self.right:7.2%}" if self.right else ""
        return (
            f"{self.points:6} {self.wrong_stress:12} {self.wrong_slip:10} {self.right:6} {self.right_flagged:7} {share:>7} "
            f"{self.unvouched_flagged:17} {self.stationary:17} {self.elsewhere:7}"
        )


_HEADS = "points wrong stress wrong slip  right flagged   share flagged by design stationary, right and not"


_Answer = tuple[Sequence[Any], Sequence[Any]]


def _name(asked: Question) -> str:
    return asked.law if isinstance(asked.law, str) else asked.law.name


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
    convex = _shown_convex(method, asked)
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
        count.right_flagged += right and flagged and convex
        count.unvouched_flagged += right and flagged and not convex
        count.stationary += right and done.status[i] == Status.STATIONARY
        count.elsewhere += not right and done.status[i] == Status.STATIONARY
        count.wrong_stress += silent and not off_stress <= ACCURACY
        count.wrong_slip += silent and not off_slip <= SLIP
        if verbose and ((silent and not right) or (right and flagged)):
            where = f"{_name(asked)} {method} {asked.trial[i].tolist()} {asked.pressure} k {k.tolist()} {asked.parameters}"
            print(f"  {Status(done.status[i]).name} stress {off_stress:.1e} slip {off_slip:.1e} residuals", end=" ")
            print(*(f"{getattr(done.residuals, name)[i]:.1e}" for name in done.residuals.__dataclass_fields__), where, flush=True)


def tally(questions: Iterator[Question], methods: Sequence[str], verbose: bool = False, seldom: int = 1) -> dict[tuple[str, str], Count]:
    """Counts by law and method."""
    found: dict[tuple[str, str], Count] = {}
    for turn, asked in enumerate(questions):
        name = _name(asked)
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            exact = list(answers(asked))
            for method in methods:
                if (method == "cvxpy" and turn % seldom) or not _takes(method, asked):
                    continue
                counted(asked, method, found.setdefault((name, method), Count()), exact, verbose)
    return found


def _shown_convex(method: str, asked: Question) -> bool:
    """Whether somebody vouches that a stationary point is the closest one: the method, or a proof."""
    if METHODS["newton" if method == "compiled" else method]().convex:
        return True
    found = convexity(duhem.load(asked.law) if isinstance(asked.law, str) else asked.law, asked.parameters, "ask", unloaded=False)
    return found is not None and found.loaded


def _takes(method: str, asked: Question) -> bool:
    law = duhem.load(asked.law) if isinstance(asked.law, str) else asked.law
    posed = increment(law, asked.trial[:1], asked.pressure, asked.stiffness, asked.parameters)
    return METHODS["newton" if method == "compiled" else method]().applies(posed) is None


def main() -> None:
    """Print a line a family, law and method as each family ends, then a line a law and method."""
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("family", nargs="*", default=list(FAMILIES))
    reader.add_argument("--method", nargs="*", default=["closed-form", "newton", "compiled", "cvxpy"])
    reader.add_argument("--law", nargs="*", help="these laws alone")
    reader.add_argument("--every", type=int, default=1, help="one question of so many")
    reader.add_argument("--first", type=int, default=0, help="the first of these")
    reader.add_argument("--seldom", type=int, default=4, help="one question of so many to cvxpy")
    reader.add_argument("--verbose", action="store_true", help="each answer that is wrong and not flagged, or right and flagged")
    reader.add_argument("--to", type=Path, help="add the counts of this part to a file")
    reader.add_argument("--sum", nargs="+", type=Path, help="ask nothing: the counts of these files together")
    asked = reader.parse_args()
    print(f"{'family':11} {'law':15} {'method':12} {_HEADS}")
    total: dict[tuple[str, str], Count] = {}
    for _family, law, method, c in _kept(asked.sum) if asked.sum else _asked(asked):
        total[law, method] = total.get((law, method), Count()) + c
    print()
    for (law, method), c in sorted(total.items()):
        print(f"{'all':11} {law:15} {method:12} {c.text()}")
    print(f"{'all':40} {sum(total.values(), Count()).text()}")


_Row = tuple[str, str, str, Count]  # family, law, method and what came of them


def _asked(given: argparse.Namespace) -> Iterator[_Row]:
    """The rows of each family as it ends, printed and kept."""
    for family in given.family:
        questions = (q for q in FAMILIES[family]() if not given.law or _name(q) in given.law)
        found = tally(itertools.islice(questions, given.first, None, given.every), given.method, given.verbose, given.seldom)
        for (law, method), c in found.items():
            print(f"{family:11} {law:15} {method:12} {c.text()}", flush=True)
            if given.to:
                with given.to.open("a", encoding="utf-8") as kept:
                    print(json.dumps([family, law, method, {name: int(x) for name, x in asdict(c).items()}]), file=kept)
            yield family, law, method, c


def _kept(files: Sequence[Path]) -> list[_Row]:
    """The rows of some files, those of one family, law and method as one."""
    found: dict[tuple[str, str, str], Count] = {}
    for family, law, method, c in (json.loads(line) for file in files for line in file.read_text(encoding="utf-8").splitlines()):
        found[family, law, method] = found.get((family, law, method), Count()) + Count(**c)
    for (family, law, method), c in found.items():
        print(f"{family:11} {law:15} {method:12} {c.text()}")
    return [(*names, c) for names, c in found.items()]


if __name__ == "__main__":
    main()
