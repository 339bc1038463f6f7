"""Angles of a boundary curve worth an exact look, found in floats; angles are handed on as rational t = tan(angle/2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from duhem.expression.balls import precision
from duhem.expression.numpy_ import compiled
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.parameter_choices import Values

__all__ = ["dents", "half_tangent", "least_powers", "targets"]

_ANGLES = 720
_STEPS = (40, 20, 10, 5, 2, 1)  # half the width of a dent, in samples
_BITS = 256
_CHOICE = 10_000  # steps of the samples at one choice of parameters and the exact looks at what they suggest
Array = NDArray[np.float64]
Rim = tuple[Fraction, Fraction, Fraction]  # a point before, the place itself and a point after it


def half_tangent(angle: float, digits: int = 9) -> Fraction:
    """A rational close to tan(angle/2); angle in radians, not an odd multiple of pi."""
    return Fraction(round(float(np.tan(angle / 2)) * 10**digits), 10**digits)


def dents(subject: CurveSubject, most: int) -> Iterator[tuple[Values, Rim]]:
    """Where the curve turns right most sharply, at each choice of parameters at which it does, the widest rim first."""
    for values, samples in _sampled(subject, most):
        if (k := samples.dent()) is not None:
            for step in _STEPS:
                p, m, q = (half_tangent(samples.angle(k + shift)) for shift in (-step, 0, step))
                yield values, (p, m, q)


def least_powers(subject: CurveSubject, most: int) -> Iterator[tuple[Values, Fraction]]:
    """Where boundary . flow is least, at each choice of parameters."""
    yield from ((values, half_tangent(samples.angle(samples.least_power()))) for values, samples in _sampled(subject, most))


def targets(subject: CurveSubject, values: Values, angle: float) -> Iterator[Fraction]:
    """Where the flow at an angle may lean to: far along the boundary first, then close by at the scale of the deviation itself."""
    with precision(_BITS):
        jet = subject.at(values).at(half_tangent(angle), 2)
        point, slip = ([float(x) for x in v] for v in (jet.boundary[0], jet.flow[0]))
        turn = math.atan2(float(jet.lean), float(jet.lead))
    if not all(map(math.isfinite, (*point, *slip, turn))):
        return
    for other in _samples(subject)(values).ahead(slip, point):
        yield half_tangent(other)
    for digits in range(8):
        yield half_tangent(angle + turn / 10**digits, 15)


def _sampled(subject: CurveSubject, most: int) -> Iterator[tuple[Values, _Samples]]:
    samples = _samples(subject)
    for values in subject.choices(most):
        if not subject.budget.pays(_CHOICE):
            return
        yield values, samples(values)


def _samples(subject: CurveSubject) -> Callable[[Values], _Samples]:
    """The samples at a choice of parameters, of formulas compiled once."""
    names = (subject.cosine, subject.sine, *subject.free)
    programs = [compiled(x, names) for x in (*subject.boundary, *(subject.flow or ()))]
    angles = 2 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES - np.pi

    def at(values: Values) -> _Samples:
        here: list[Array] = [np.cos(angles), np.sin(angles), *(np.asarray(float(values[x])) for x in subject.free)]
        with np.errstate(all="ignore"):
            columns = [np.broadcast_to(program(*here), _ANGLES) for program in programs]
        return _Samples(angles, np.stack(columns[:2], axis=1), np.stack(columns[2:], axis=1) if len(columns) > 2 else None)

    return at


class _Samples:
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
        turn = _quotient(self.steps[:, 0] * after[:, 1] - self.steps[:, 1] * after[:, 0], np.linalg.norm(self.steps, axis=1))
        k = int(np.argmin(turn))
        return (k + 1) % _ANGLES if turn[k] < 0 else None

    def least_power(self) -> int:
        """Where boundary . flow is least, for its size."""
        sizes = np.linalg.norm(self.points, axis=1) * np.linalg.norm(self.slips, axis=1)
        return int(np.argmin(_quotient(np.sum(self.points * self.slips, axis=1), sizes)))

    def ahead(self, slip: list[float], point: list[float]) -> Iterator[float]:
        """Angles of boundary points towards which a flow at a boundary point leans, the farthest in that direction first."""
        reach = (self.points - np.asarray(point)) @ np.asarray(slip)
        for k in np.argsort(-reach)[:3]:
            if reach[k] > 0:
                yield self.angle(int(k))


def _quotient(over: Array, under: Array) -> Array:
    """Infinite where it has no value: where the curve stands still, or a size is 0."""
    with np.errstate(all="ignore"):
        found = over / under
    return np.where(np.isfinite(found), found, np.inf)
