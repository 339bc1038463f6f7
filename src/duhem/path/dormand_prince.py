"""Dormand and Prince's method of order 8 on plain numbers (Hairer, Norsett and Wanner, 1993, section II.10), up to an event.

One step is written down as lines, without the coefficients that are 0: for the few numbers of one point arrays take longer to call than
to compute.  What lies within a step is the method's own interpolation, of order 7.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, isfinite, sqrt, ulp
from typing import Any, NamedTuple

import numpy as np

from duhem.errors import DuhemError
from duhem.projection.kept_code import interpreted_text
from duhem.projection.plain_numbers import FAULTS
from duhem.projection.result import Array

__all__ = ["Followed", "State", "followed"]

State = Sequence[float]
Slope = Callable[[float, State], State]  # of a state at a time
Event = Callable[[float, State], float]  # it ends the way where it rises through 0

_RTOL = 2.5e-14
_LEAST, _MOST, _SAFETY = 0.2, 10.0, 0.9  # by which a step changes
_STEPS = 50_000  # some seconds; a very stiff way under a pressure that goes to a billionth takes ten thousand


class Followed(NamedTuple):
    """The time and state where a way ends, whether by the first of the events, and the steps it took."""

    time: float
    state: State
    first: bool
    steps: Sequence[_Stride]

    def at(self, time: float) -> Array:
        """The state on the way, and at the end the one that was integrated."""
        if time == self.time:
            return np.array(self.state)
        return next(step for step in self.steps if time <= step.time + step.size).at(time)


@dataclass(eq=False)
class _Stride:
    """One step from a time over a size: its slopes are those of 13 stages."""

    slope: Slope
    time: float
    size: float
    start: State
    end: State
    slopes: Sequence[State]
    _powers: Array | None = None

    def at(self, time: float) -> Array:
        """The state within it."""
        if self._powers is None:
            from scipy.integrate import DOP853

            y, change, stages = np.array(self.start), np.subtract(self.end, self.start), np.array(self.slopes)
            for row, part in zip(DOP853.A_EXTRA, DOP853.C_EXTRA, strict=True):
                near = y + self.size * (row[: len(stages)] @ stages)
                stages = np.vstack([stages, self.slope(self.time + part * self.size, near.tolist())])
            first, last = self.size * stages[0], self.size * stages[12]
            self._powers = np.vstack([change, first - change, 2.0 * change - last - first, self.size * (DOP853.D @ stages)])
        x, found = (time - self.time) / self.size, np.zeros(len(self.start))
        for i, power in enumerate(self._powers[::-1]):
            found = (found + power) * (1.0 - x if i % 2 else x)
        return np.asarray(self.start + found)


def followed(slope: Slope, time: float, state: State, atol: State, events: Sequence[Event], kept: bool) -> Followed:
    """From ``time`` to 1, or to the first event on the way; ``kept``: with all steps, for what lies between.  DuhemError where it fails."""
    n = len(state)
    step, steps, last = _step(n), list[_Stride](), slope(time, state)
    sizes = [(a + _RTOL * abs(x)) for a, x in zip(atol, state, strict=True)]
    far, fast = (sqrt(sum((x / size) ** 2 for x, size in zip(each, sizes, strict=True))) for each in (state, last))
    h, high = min(0.01 * far / fast if fast > 0.0 else inf, 1.0 - time), inf
    before = [event(time, state) for event in events]
    tried = 0
    while time < 1.0:
        h, tried = min(h, 1.0 - time), tried + 1
        if h < 10.0 * ulp(time) or tried > _STEPS:
            raise DuhemError("the slipping stress could not be followed: steps become too small", remedy='use method="implicit"')
        try:
            end, slopes, e5, e3 = step(slope, time, h, state, last)
            error = _error(h, state, end, e5, e3, atol)
        except FAULTS:
            error = inf
        if not error < 1.0:
            h, high = h * (max(_LEAST, _SAFETY * error**-0.125) if error < inf else _LEAST), 1.0
            continue
        made = _Stride(slope, time, h, state, end, slopes)
        after = [event(time + h, end) for event in events]
        risen = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a <= 0.0 <= b]
        if kept:
            steps.append(made)
        if risen:
            found = [(_rise(events[i], made), i) for i in risen]
            time, i = min(found)
            return Followed(time, made.at(time).tolist(), i == 0, steps)
        time = 1.0 if h == 1.0 - time else time + h
        state, last, before = end, slopes[-1], after
        h *= min(high, _MOST, _SAFETY * error**-0.125) if error > 0.0 else min(high, _MOST)
        high = inf
    return Followed(time, state, False, steps)


def _error(h: float, state: State, end: State, e5: State, e3: State, atol: State) -> float:
    """The error of a step over what is allowed; inf where it is no number."""
    five = three = 0.0
    for x, y, a, b, least in zip(state, end, e5, e3, atol, strict=True):
        size = least + _RTOL * max(abs(x), abs(y))
        five += (a / size) ** 2
        three += (b / size) ** 2
    if five == 0.0 and three == 0.0:
        return 0.0
    error = h * five / sqrt((five + 0.01 * three) * len(state))
    return error if isfinite(error) else inf


def _rise(event: Event, step: _Stride) -> float:
    """When an event happens within a step."""
    from scipy.optimize import brentq

    end = step.time + step.size

    def value(time: float) -> float:
        return event(time, step.end if time == end else step.start if time == step.time else step.at(time).tolist())

    tight = 4.0 * np.finfo(float).eps
    return float(brentq(value, step.time, end, xtol=tight, rtol=tight))


@lru_cache(maxsize=16)
def _step(n: int) -> Callable[..., Any]:
    """``step(slope, t, h, y, f)`` for n numbers: the end, the 13 slopes, and what the embedded methods of order 5 and 3 differ by."""
    from scipy.integrate import DOP853

    every = range(n)

    def tuple_of(texts: Sequence[str]) -> str:
        return f"({''.join(f'{text}, ' for text in texts)})"

    def names(stage: int) -> str:
        return tuple_of([f"k{stage}_{i}" for i in every])

    def summed(weights: Array, i: int) -> str:
        return " + ".join(f"{weight!r} * k{j}_{i}" for j, weight in enumerate(weights.tolist()) if weight)

    lines = [f"{tuple_of([f'y{i}' for i in every])} = y", f"{names(0)} = f"]
    for stage in range(1, 12):
        near = [f"y{i} + h * ({summed(DOP853.A[stage, :stage], i)})" for i in every]
        lines.append(f"{names(stage)} = slope(t + {float(DOP853.C[stage])!r} * h, {tuple_of(near)})")
    lines.append(f"z = {tuple_of([f'y{i} + h * ({summed(DOP853.B, i)})' for i in every])}")
    lines.append(f"{names(12)} = slope(t + h, z)")
    errors = [tuple_of([summed(weights, i) for i in every]) for weights in (DOP853.E5, DOP853.E3)]
    lines.append(f"return z, {tuple_of([names(stage) for stage in range(13)])}, {', '.join(errors)}")
    return interpreted_text("def step(slope, t, h, y, f):\n    " + "\n    ".join(lines), "step")
