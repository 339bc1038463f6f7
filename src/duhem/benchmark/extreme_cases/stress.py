"""Every method on every extreme case, judged against many digits."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from duhem.benchmark.contenders import Contender, applicable
from duhem.benchmark.extreme_cases.cases import AXES, ExtremeCase, cases
from duhem.benchmark.extreme_cases.judge import Judgement, judged
from duhem.benchmark.extreme_cases.refusals import Refusal, refusals
from duhem.benchmark.machine import machine
from duhem.benchmark.reference import Closest, ReferenceIncrement
from duhem.benchmark.specimen import Specimen
from duhem.benchmark.study import Study
from duhem.errors import DuhemError, InputError
from duhem.law.formula_law import Criterion
from duhem.left_out import LeftOut
from duhem.projection.result import Status

__all__ = ["ExtremeCases", "Tally", "stress"]


@dataclass(frozen=True)
class Tally:
    """One method at one place of an axis: counts over ``points`` and the fewest accurate digits of stress and slip.

    ``wrong_stress`` and ``wrong_slip`` count answers with fewer than 6 digits that the method did not flag.
    """

    axis: str
    label: str
    decade: float
    method: str
    points: int
    finite: int
    feasible: int
    flagged: int
    stress_digits: float
    slip_digits: float
    wrong_stress: int
    wrong_slip: int
    failure: str | None = None


@dataclass(frozen=True, kw_only=True)
class ExtremeCases(Study):
    """Rows in the order taken; ``refusals`` of input that cannot be used; ``reference`` the largest error of the reference."""

    rows: tuple[Tally, ...]
    refusals: tuple[Refusal, ...]
    reference: float

    @property
    def methods(self) -> tuple[str, ...]:
        """Who was measured, in order."""
        return tuple(dict.fromkeys(row.method for row in self.rows))

    @property
    def silently_wrong(self) -> dict[str, tuple[int, int]]:
        """By method: points whose stress, and whose slip, is wrong without a flag."""
        return {
            m: (sum(r.wrong_stress for r in self.rows if r.method == m), sum(r.wrong_slip for r in self.rows if r.method == m))
            for m in self.methods
        }

    @property
    def failed(self) -> bool:
        return bool(self.rows) and all(row.finite == 0 for row in self.rows)

    def measured(self) -> dict[str, Any]:
        return {
            "interrupted": self.interrupted,
            "reference": self.reference if math.isfinite(self.reference) else None,
            "rows": [asdict(row) for row in self.rows],
            "refusals": [asdict(refusal) for refusal in self.refusals],
            "silently_wrong": {m: {"stress": a, "slip": b} for m, (a, b) in self.silently_wrong.items()},
        }


def stress(
    law: Criterion,
    *,
    axes: Sequence[str] = tuple(AXES),
    stiffness: Sequence[float] | None = None,
    contenders: Sequence[Contender] | None = None,
    peers: bool = False,
    every: int = 1,
    on_row: Callable[[Tally], None] | None = None,
) -> ExtremeCases:
    """Every method that applies to ``law``, all parameters fixed, on the cases of ``axes``.

    ``stiffness`` (d,) diagonal in Pa/m, left out 1, 2, ...; ``contenders`` in place of all of them; ``peers``: other programs
    too, those that are installed; of the cases each ``every``-th.  KeyboardInterrupt ends it
    with what is done.  Raises InputError for a parameter without value, a law with a flow of its own, an unknown axis.
    """
    if strange := [axis for axis in axes if axis not in AXES]:
        raise InputError(f"unknown axis {strange[0]!r}", where="axes", remedy=f"choose {', '.join(AXES)}")
    if every < 1:
        raise InputError(f"every is {every}", where="every", remedy="give a whole number >= 1")
    specimen = Specimen.of(law, stiffness)
    found, left_out = applicable(specimen.question(np.zeros((1, len(law.forces))), specimen.pressure), peers=peers)
    chosen = list(found if contenders is None else contenders)
    rows: list[Tally] = []
    refused: list[Refusal] = []
    worst, interrupted, seen = 0.0, False, set[str]()
    try:
        for number, case in enumerate(cases(specimen, tuple(axes))):
            seen.add(case.axis)
            if number % every:
                continue
            try:
                closest = case.specimen.reference()
                answers = [closest(x.tolist(), case.pressure) for x in case.trial]
            except DuhemError as fault:
                left_out.append(LeftOut(f"{case.axis} {case.label}", f"no reference: {fault}"))
                continue
            worst = max([worst, *(a.residual for a in answers)])
            for contender in chosen:
                row = _row(case, contender, closest, answers)
                rows.append(row)
                if on_row is not None:
                    on_row(row)
        left_out += [LeftOut(f"axis {axis}", _absent(specimen, axis)) for axis in axes if axis not in seen]
        refused += [refusal for contender in chosen for refusal in refusals(specimen, contender)]
    except KeyboardInterrupt:
        interrupted = True
    return ExtremeCases(
        law=law.name,
        subject=specimen.describe(),
        machine=machine(),
        rows=tuple(rows),
        refusals=tuple(refused),
        reference=worst,
        left_out=tuple(left_out),
        interrupted=interrupted,
    )


def _absent(specimen: Specimen, axis: str) -> str:
    if axis == "aspect of K" and len(specimen.law.forces) > 1:
        return "no parameter of the law scales one axis of K alone"
    return f"a law in {len(specimen.law.forces)} force has none"


def _row(case: ExtremeCase, contender: Contender, closest: Closest, answers: Sequence[ReferenceIncrement]) -> Tally:
    where = (case.axis, case.label, case.decade, contender.name, len(case.trial))
    try:
        each = list(_judged(case, contender, closest, answers))
    except Exception as fault:  # an error is a flag: nothing was returned
        return Tally(*where, 0, 0, len(case.trial), 0.0, 0.0, 0, 0, f"{type(fault).__name__}: {fault}")
    return Tally(
        *where,
        sum(j.finite for j in each),
        sum(j.feasible for j in each),
        sum(j.flagged for j in each),
        min(j.stress for j in each),
        min(j.slip for j in each),
        sum(j.wrong_stress for j in each),
        sum(j.wrong_slip for j in each),
    )


def _judged(case: ExtremeCase, contender: Contender, closest: Closest, answers: Sequence[ReferenceIncrement]) -> Iterator[Judgement]:
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # an overflow on the way is no flag: what comes back is judged
        done = contender.project(case.specimen, case.trial, case.pressure)
    for i, answer in enumerate(answers):
        flagged = done.status[i] in (Status.INACCURATE, Status.FAILED)
        yield judged(closest, case.trial[i].tolist(), case.pressure, answer, done.stress[i], done.slip[i], bool(flagged))
