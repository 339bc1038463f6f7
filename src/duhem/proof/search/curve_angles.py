"""Angles of a boundary curve worth an exact look, found in floats; angles are handed on as rational t = tan(angle/2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.parameter_choices import Values

__all__ = ["CurveScout", "CurveScouts", "half_tangent"]

_ANGLES = 720
Array = NDArray[np.float64]


def half_tangent(angle: float, digits: int = 9) -> Fraction:
    """A rational close to tan(angle/2); angle in radians, not an odd multiple of pi."""
    return Fraction(round(float(np.tan(angle / 2)) * 10**digits), 10**digits)


class CurveScouts:
    """Scouts of one law; its formulas are compiled once."""

    def __init__(self, subject: CurveSubject) -> None:
        self._free = subject.free
        names = (subject.cosine, subject.sine, *subject.free)
        self._programs = [compiled(x, names) for x in (*subject.boundary, *(subject.flow or ()))]

    def at(self, values: Values) -> CurveScout:
        """The scout at one choice of parameters."""
        angles = 2 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES - np.pi
        names: list[Array] = [np.cos(angles), np.sin(angles), *(np.asarray(float(values[x])) for x in self._free)]
        with np.errstate(all="ignore"):
            columns = [np.broadcast_to(program(*names), _ANGLES) for program in self._programs]
        return CurveScout(angles, np.stack(columns[:2], axis=1), np.stack(columns[2:], axis=1) if len(columns) > 2 else None)


class CurveScout:
    """Boundary and flow at angles all around, in floats; the flow of an associated law is normal to the chords."""

    def __init__(self, angles: Array, points: Array, slips: Array | None) -> None:
        self.angles, self.points = angles, points
        self.steps = np.roll(points, -1, axis=0) - points
        self.slips = np.stack([self.steps[:, 1], -self.steps[:, 0]], axis=1) if slips is None else slips

    def angle(self, k: int) -> float:
        """The angle of a sample, periodic."""
        return float(self.angles[k % _ANGLES])

    def dent(self) -> int | None:
        """Where the curve turns right most sharply, if anywhere."""
        after = np.roll(self.steps, -1, axis=0)
        turn = (self.steps[:, 0] * after[:, 1] - self.steps[:, 1] * after[:, 0]) / np.linalg.norm(self.steps, axis=1)
        k = int(np.argmin(turn))
        return (k + 1) % _ANGLES if turn[k] < 0 else None

    def least_power(self) -> int:
        """Where boundary . flow is least, for its size."""
        power = np.sum(self.points * self.slips, axis=1) / (np.linalg.norm(self.points, axis=1) * np.linalg.norm(self.slips, axis=1))
        return int(np.argmin(power))

    def targets(self, slip: Sequence[float], point: Sequence[float]) -> Iterator[float]:
        """Angles of boundary points towards which a flow at a boundary point leans, the farthest in that direction first."""
        reach = (self.points - np.asarray(point)) @ np.asarray(slip)
        for k in np.argsort(-reach)[:3]:
            if reach[k] > 0:
                yield self.angle(int(k))
