"""What an answer is worth against many digits: finite, feasible, how many digits, flagged or not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from duhem.benchmark.reference import Closest, ReferenceIncrement, distance
from duhem.projection.result import Array

__all__ = ["MOST", "POOR", "Judgement", "digits", "judged"]

POOR = 6.0  # an answer with fewer digits is wrong
MOST = 16.0  # as many as a double shows
_SMALLEST = 2.0**-1022  # below it doubles lose digits, whoever computes
_LARGEST = 1.79e308
_INSIDE = 1e-7  # of the stress, taken off before asking whether it lies in K


@dataclass(frozen=True)
class Judgement:
    """One point: ``stress`` and ``slip`` are accurate digits (0 to 16); ``wrong`` ones are poor and not flagged."""

    finite: bool
    feasible: bool
    stress: float
    slip: float
    flagged: bool

    @property
    def wrong_stress(self) -> bool:
        return not self.flagged and not self.stress >= POOR

    @property
    def wrong_slip(self) -> bool:
        return not self.flagged and not self.slip >= POOR


def judged(
    closest: Closest, trial: Sequence[float], pressure: float | None, answer: ReferenceIncrement, stress: Array, slip: Array, flagged: bool
) -> Judgement:
    """The judgement of one returned increment.

    Digits are relative to the largest component of the exact stress or slip; where that is zero, to the trial stress and
    to k^-1 times it; below the smallest normal number, to that number.
    """
    mp = closest.context
    finite = bool(np.isfinite(stress).all() and np.isfinite(slip).all())
    if not finite:
        return Judgement(False, False, 0.0, 0.0, flagged)
    tail = [] if pressure is None else [mp.mpf(pressure)]
    shrunk = [mp.mpf(float(s)) * (1 - mp.mpf(_INSIDE)) for s in stress]
    feasible = bool(closest.formula.read([*shrunk, *tail]).value <= 0)
    whole = mp.matrix([mp.mpf(float(t)) for t in trial])
    elastic = closest.compliance * whole
    return Judgement(
        True,
        feasible,
        digits(stress.tolist(), answer.stress, max(map(abs, whole))),
        digits(slip.tolist(), answer.slip, max(map(abs, elastic))),
        flagged,
    )


def digits(got: Sequence[float], exact: Sequence[Any], otherwise: Any) -> float:
    """Accurate digits, between 0 and 16; 0 where the exact number is beyond doubles, which only a flag can tell."""
    size = max(abs(x) for x in exact)
    if size > _LARGEST:
        return 0.0
    unit = max(size if size != 0 else otherwise, _SMALLEST)
    off = distance(got, exact, unit)
    return MOST if off == 0.0 else min(MOST, max(0.0, -math.log10(off))) if math.isfinite(off) else 0.0
