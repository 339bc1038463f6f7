"""One slip increment, as a user solves it: a few trial stresses, each alone, by every method and at every tolerance."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from duhem.benchmark.contenders import Contender, Specimen
from duhem.benchmark.measurement import Measurement, largest_errors, timed
from duhem.benchmark.reference import ReferenceIncrement
from duhem.projection.cvxpy_method import CvxpyOptions
from duhem.projection.increment import Increment
from duhem.projection.projector import ACCURACY
from duhem.projection.residuals import residuals
from duhem.projection.result import Array, Solution

__all__ = ["SCENE", "TOLERANCES", "Exercise", "exercise", "rows"]

SCENE = "increment"
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, None)
_FACTORS = (1.05, 2.0, 30.0, 1e3)  # trial stresses in units of the reach of K


@dataclass(frozen=True)
class Exercise:
    """Trial stresses (N, d), N checked questions of one point each, and their answers in many digits."""

    specimen: Specimen
    trial: Array
    questions: tuple[Increment, ...]
    answers: tuple[ReferenceIncrement, ...]

    @property
    def residual(self) -> float:
        """The largest error of the answers themselves."""
        return max((answer.residual for answer in self.answers), default=0.0)


def exercise(specimen: Specimen) -> Exercise:
    """Four trial stresses outside K, in unlike directions and at unlike distances; NoReference where K has no reference."""
    d = len(specimen.law.forces)
    draw = np.random.default_rng(2007)
    ways = draw.uniform(0.3, 1.0, (len(_FACTORS), d)) * np.where((np.arange(len(_FACTORS))[:, None] >> np.arange(d)) & 1, -1.0, 1.0)
    reach = [specimen.radius(way, specimen.pressure) for way in ways]
    usable = [way * r * f for way, r, f in zip(ways, reach, _FACTORS, strict=True) if 0.0 < r < 1e300]
    trial = np.array(usable).reshape(-1, d)
    closest = specimen.reference()
    answers = tuple(closest(x.tolist(), specimen.pressure) for x in trial)
    return Exercise(specimen, trial, tuple(specimen.question(x[None], specimen.pressure) for x in trial), answers)


def rows(work: Exercise, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """A row for each contender, in turn: the largest errors, and the time of the method alone for one increment.

    The checks and residuals that duhem.project adds are in a row of their own.
    """
    for contender in contenders:
        yield _row(work, contender, repeats)
    first = next((contender for contender in contenders if not contender.peer), None)
    if first is None:
        return

    def all_of_it() -> None:
        for x in work.trial:
            first.project(work.specimen, x, work.specimen.pressure)

    note = f"{first.name} through duhem.project: checks and residuals included"
    found = [first.solve(question) for question in work.questions]
    yield Measurement(SCENE, "duhem.project", "", _errors(work, found), timed(all_of_it, repeats, 1.0 / len(work.trial)), 0, None, note)


def _row(work: Exercise, contender: Contender, repeats: int) -> Measurement:
    setting = _setting(contender)
    try:
        found = [contender.solve(question) for question in work.questions]
        errors, flagged = _errors(work, found), _flagged(work, found)

        def run() -> None:
            for question in work.questions:
                contender.solve(question)

        missing = sum(bool(f.failed[0]) for f in found)
        note = f"{missing} of {len(found)} increments without an answer" if missing else ""
        return Measurement(SCENE, contender.name, setting, errors, timed(run, repeats, 1.0 / len(work.trial)), flagged, None, note)
    except Exception as fault:  # whatever a solver raises is its result
        return Measurement.failing(SCENE, contender.name, setting, fault)


def _errors(work: Exercise, found: Sequence[Solution]) -> dict[str, float]:
    """The largest of the answers there are."""
    answered = [(f.stress[0], f.slip[0], a) for f, a in zip(found, work.answers, strict=True) if not f.failed[0]]
    if not answered:
        raise ArithmeticError("no answer to any increment")
    return largest_errors(answered)


def _flagged(work: Exercise, found: Sequence[Solution]) -> int:
    """How many of its answers duhem's own residuals call inaccurate or failed."""
    judged = [residuals(q, solution).worst()[0] for q, solution in zip(work.questions, found, strict=True)]
    return sum(bool(f.failed[0]) or not worst <= ACCURACY for f, worst in zip(found, judged, strict=True))


def _setting(contender: Contender) -> str:
    """The tolerance, where the method has one."""
    match contender.options:
        case CvxpyOptions(tolerance=None):
            return "tightest it meets"
        case CvxpyOptions(tolerance=tolerance):
            return f"tolerance {tolerance:.0e}"
    return ""
