"""Chords built in high precision at one place of the boundary: they show violations far below double precision.

Dents: at a boundary point whose curvature has the wrong sign, a short chord along the tangent.  Kinks: the same where the boundary
crosses a seam, however slight the kink.  Edges: where g rises beside one a little less than in proportion, a chord from the edge to a
place beside it; so do sums of powers of loads of which one is a little below 1: the dent is as close to the edge as the power to 1, and
shallower.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import partial
from math import floor
from typing import Any

from duhem.expression import mpmath_
from duhem.expression.mpmath_ import reach
from duhem.expression.number import fraction
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Point, Values
from duhem.proof.search.boundary_points import Chord
from duhem.proof.search.corners import crossings
from duhem.proof.search.edges import edges

__all__ = ["chords_beside_edges", "dent_chords", "kink_chords"]

_DIGITS, _PRICE = 60, 20_000  # steps of an edge
_SHORTEST, _TURNED = 58, 10  # powers of 1/2 that a chord is made shorter by; after so many the tangent is sought again
_NEAR = 2.0**-40  # how far from an edge it is seen that g rises less than in proportion
_PLACES = range(2, 60, 3)  # powers of 2: how far the other end may be
_FROM = 4  # edges


class _Level:
    """g at a parameter choice in many digits; infinite where it has no value."""

    def __init__(self, subject: FormulaSubject, parameters: Values) -> None:
        self.context = mpmath_.kept_digits(_DIGITS)
        self._run = mpmath_.compiled([subject.formula_at(parameters)], subject.simple.forces, self.context)

    def __call__(self, point: Sequence[Any]) -> Any:
        (found,) = self._run(*point)
        return found if self.context.isfinite(found) else self.context.inf

    def end(self, ray: Sequence[Any]) -> list[Any] | None:
        """Where a ray from 0 leaves K."""
        t = reach(self.context, self, [0] * len(ray), ray, int(3.4 * _DIGITS))
        return None if t is None else [t * c for c in ray]


def dent_chords(subject: FormulaSubject, parameters: Values, direction: Sequence[Any]) -> Iterator[Chord]:
    """Chords through the boundary point seen from the origin in ``direction`` that seem to leave K, the longest first.

    In more than two forces along the tangent in which the second differences of about that length are least.
    """
    value = _Level(subject, parameters)
    ray = _unit([mpmath_.number(value.context, fraction(c)) for c in direction], value.context)
    if (x := value.end(ray)) is not None:
        yield from ((parameters, p, q) for p, q in _short(value, x))


def _short(value: _Level, x: Sequence[Any]) -> Iterator[tuple[Point, Point]]:
    """The ends of those about a boundary point x; where it is a kink, differences give the mean of the gradients on its two sides."""
    context = value.context
    end = context.norm(x) or context.one
    step = end * context.mpf(10) ** (-_DIGITS // 3)
    units = [[context.mpf(i == k) for i in range(len(x))] for k in range(len(x))]
    slope = [(value(_moved(x, (step, unit))) - value(_moved(x, (-step, unit)))) / (2 * step) for unit in units]
    length = context.norm(slope)
    if not 0 < length < context.inf:
        return
    normal = [c / length for c in slope]
    across = context.qr(context.matrix(normal))[0]
    frame = [[across[i, k] for i in range(len(normal))] for k in range(1, len(normal))]  # unit vectors across the normal and each other

    def bend(t: Any, tangent: Sequence[Any]) -> Any:
        return value(_moved(x, (t, tangent))) + value(_moved(x, (-t, tangent)))

    tangent: list[Any] | None = frame[0]
    for k in range(_SHORTEST):
        t = end * context.mpf(2) ** -(k + 2)
        if len(frame) > 1 and k % _TURNED == 0:
            tangent = _least(context, frame, partial(bend, t))
        if tangent is not None and (rise := -bend(t, tangent) / (2 * length)) > 0:
            ends = [_moved(x, (s * t, tangent), (rise / 2, normal)) for s in (1, -1)]
            if max(map(value, ends)) <= 0:
                yield _rounded(ends[0], rise / 1000), _rounded(ends[1], rise / 1000)


def _moved(x: Sequence[Any], *steps: tuple[Any, Sequence[Any]]) -> list[Any]:
    """By some lengths along some ways."""
    return [sum((length * way[i] for length, way in steps), c) for i, c in enumerate(x)]


def _least(context: Any, frame: Sequence[Sequence[Any]], bend: Callable[[Sequence[Any]], Any]) -> list[Any] | None:
    """The unit vector in a frame at which the form that takes ``bend`` as its values is least."""
    n = len(frame)
    form = context.matrix(n, n)
    for i in range(n):
        form[i, i] = bend(frame[i])
    for i in range(n):
        for j in range(i):
            form[i, j] = form[j, i] = (bend([a + b for a, b in zip(frame[i], frame[j], strict=True)]) - form[i, i] - form[j, j]) / 2
    if not all(map(context.isfinite, form)):
        return None
    axes = context.eigsy(form)[1]
    return _unit([sum(axes[i, 0] * v[k] for i, v in enumerate(frame)) for k in range(len(frame[0]))], context)


def kink_chords(subject: FormulaSubject, most: int = 12) -> Iterator[Chord]:
    """Chords across seams where the boundary seems to have a kink inward (two forces)."""
    for parameters in subject.choices(most):
        value = _Level(subject, parameters)
        for _, point in crossings(subject, parameters, 80):
            yield from ((parameters, p, q) for p, q in _short(value, [mpmath_.number(value.context, c) for c in point]))


def chords_beside_edges(subject: FormulaSubject, most: int = 2) -> Iterator[Chord]:
    """Those that seem to leave K, the longest first, at so many choices of the parameters; 0 must be inside K."""
    forces = subject.simple.forces
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        rays = edges(subject.formula_at(parameters), forces)
        if not rays or not subject.budget.pays(_PRICE * len(rays)):
            return
        value = _Level(subject, parameters)
        if value([0] * len(forces)) >= 0:
            continue
        for ray in rays[:_FROM]:
            if (start := value.end(ray)) is not None:
                for other in rays[::2]:
                    if other not in (ray, tuple(-c for c in ray)):
                        yield from ((parameters, p, q) for p, q in _beside(value, start, other))


def _beside(value: _Level, start: Sequence[Any], other: Sequence[int]) -> Iterator[tuple[Point, Point]]:
    context = value.context
    size = context.norm(start) / context.norm(other)

    def at(share: Any, back: Any = 0) -> list[Any]:
        return _moved(start, (-back, start), (share * size, other))

    def rise(share: Any) -> Any:
        return value(at(share)) - value(start)

    near = context.mpf(_NEAR)
    fall = (value(start) - value(at(0, near))) / near
    if not (fall > 0 and 0 < rise(2 * near) < 2 * rise(near) * (1 - context.mpf(10) ** -30)):  # fall is 0 or none where g jumps
        return
    for k in _PLACES:
        share = context.mpf(2) ** -k
        back = rise(share) / fall
        for _ in range(6):
            back += value(at(share, back)) / fall
        height = value(at(share / 2, back / 2))
        if context.isfinite(back) and 0 < back < 0.5 and 0 < height < context.inf:
            pull = height / fall / 4
            yield _rounded(at(0, pull), pull * size / 1000), _rounded(at(share, back + pull), pull * size / 1000)


def _unit(vector: Sequence[Any], context: Any) -> list[Any]:
    size = context.norm(vector)
    return [c / size if size else context.zero for c in vector]


def _rounded(point: Sequence[Any], tolerance: Any) -> Point:
    """The point rounded to the coarsest decimals within the tolerance."""
    digits = max(1, 1 - floor(float(tolerance.context.log10(tolerance))))
    return tuple(Fraction(int(c.context.nint(c * 10**digits)), 10**digits) for c in point)
