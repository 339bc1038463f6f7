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
from duhem.proof.facts.subject import Values

__all__ = ["dents", "half_tangent", "least_powers", "targets"]

_ANGLES = 720
_TURN = 2 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES - np.pi
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
    for values, points, _ in _sampled(subject, most):
        steps = _chords(points)
        after = np.roll(steps, -1, axis=0)
        turn = _quotient(steps[:, 0] * after[:, 1] - steps[:, 1] * after[:, 0], np.linalg.norm(steps, axis=1))
        k = int(np.argmin(turn))
        for width in _STEPS if turn[k] < 0 else ():
            p, m, q = (_at(k + 1 + shift) for shift in (-width, 0, width))
            yield values, (p, m, q)


def least_powers(subject: CurveSubject, most: int) -> Iterator[tuple[Values, Fraction]]:
    """Where boundary . flow is least for its size, at each choice of parameters."""
    for values, points, slips in _sampled(subject, most):
        sizes = np.linalg.norm(points, axis=1) * np.linalg.norm(slips, axis=1)
        yield values, _at(int(np.argmin(_quotient(np.sum(points * slips, axis=1), sizes))))


def targets(subject: CurveSubject, values: Values, angle: float) -> Iterator[Fraction]:
    """Where the flow at an angle may lean to: far along the boundary first, then close by at the scale of the deviation itself."""
    with precision(_BITS):
        jet = subject.at(values).at(half_tangent(angle), 2)
        point, slip = ([float(x) for x in v] for v in (jet.boundary[0], jet.flow[0]))
        turn = math.atan2(float(jet.lean), float(jet.lead))
    if not all(map(math.isfinite, (*point, *slip, turn))):
        return
    reach = (_samples(subject)(values)[0] - np.asarray(point)) @ np.asarray(slip)
    yield from (_at(int(k)) for k in np.argsort(-reach)[:3] if reach[k] > 0)
    for digits in range(8):
        yield half_tangent(angle + turn / 10**digits, 15)


def _sampled(subject: CurveSubject, most: int) -> Iterator[tuple[Values, Array, Array]]:
    """Choices of parameters with the samples there, while steps are left."""
    samples = _samples(subject)
    for values in subject.choices(most):
        if not subject.budget.pays(_CHOICE):
            return
        yield values, *samples(values)


def _samples(subject: CurveSubject) -> Callable[[Values], tuple[Array, Array]]:
    """Boundary and flow at angles all around, in floats, at a choice of parameters; an associated flow is normal to the chords."""
    names = (subject.cosine, subject.sine, *subject.free)
    programs = [compiled(x, names) for x in (*subject.boundary, *(subject.flow or ()))]

    def at(values: Values) -> tuple[Array, Array]:
        here: list[Array] = [np.cos(_TURN), np.sin(_TURN), *(np.asarray(float(values[x])) for x in subject.free)]
        with np.errstate(all="ignore"):
            columns = [np.broadcast_to(program(*here), _ANGLES) for program in programs]
        points = np.stack(columns[:2], axis=1)
        return points, np.stack(columns[2:], axis=1) if len(columns) > 2 else _chords(points)[:, ::-1] * (1, -1)

    return at


def _chords(points: Array) -> Array:
    """From each point to the next."""
    return np.roll(points, -1, axis=0) - points


def _at(k: int) -> Fraction:
    """The angle of a sample, periodic."""
    return half_tangent(float(_TURN[k % _ANGLES]))


def _quotient(over: Array, under: Array) -> Array:
    """Infinite where it has no value: where the curve stands still, or a size is 0."""
    with np.errstate(all="ignore"):
        found = over / under
    return np.where(np.isfinite(found), found, np.inf)
