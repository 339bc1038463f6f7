"""Chords from an edge of K to a place beside it: where g rises along another edge a little less than in proportion, K is dented.

So do sums of powers of loads of which one is a little below 1: the dent is as close to the edge as the power to 1, and shallower.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from math import floor
from typing import Any

from duhem.expression import mpmath_
from duhem.expression.rays_mpmath import reach
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.edges import edges
from duhem.proof.search.suggestion import Chord, Point

__all__ = ["chords_beside_edges"]

_DIGITS, _PRICE = 60, 20_000  # steps of an edge
_NEAR = 2.0**-40  # how far from an edge it is seen that g rises less than in proportion
_PLACES = range(2, 60, 3)  # powers of 2: how far the other end may be
_FROM = 4  # edges


def chords_beside_edges(subject: FormulaSubject, most: int = 2) -> Iterator[Chord]:
    """Those that seem to leave K, the longest first, at so many choices of the parameters; 0 must be inside K."""
    from mpmath import MPContext

    forces = subject.simple.forces
    context = MPContext()
    context.dps = _DIGITS
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        g = subject.formula_at(parameters)
        rays = edges(g, forces)
        if not rays or not subject.budget.pays(_PRICE * len(rays)):
            return
        run = mpmath_.compiled([g], forces, context)

        def value(point: Sequence[Any], run: Callable[..., Any] = run) -> Any:
            found = run(*point)[0]
            return found if context.isfinite(found) else context.inf

        if value([context.zero] * len(forces)) >= 0:
            continue
        for ray in rays[:_FROM]:
            if (end := reach(context, value, [0] * len(ray), ray, int(3.4 * _DIGITS))) is not None:
                start = [end * c for c in ray]
                for other in rays[::2]:
                    if other not in (ray, tuple(-c for c in ray)):
                        yield from (Chord(parameters, p, q) for p, q in _beside(context, value, start, other))


def _beside(
    context: Any, value: Callable[[Sequence[Any]], Any], start: Sequence[Any], other: Sequence[int]
) -> Iterator[tuple[Point, Point]]:
    size = context.norm(start) / context.norm(other)

    def at(share: Any, back: Any = 0) -> list[Any]:
        return [(1 - back) * c + share * size * d for c, d in zip(start, other, strict=True)]

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
        if context.isfinite(back) and 0 < back < 0.5 and height > 0:
            pull = height / fall / 4
            yield _rounded(at(0, pull), pull * size), _rounded(at(share, back + pull), pull * size)


def _rounded(point: Sequence[Any], tolerance: Any) -> Point:
    """The point in so many decimals that it moves by less than the tolerance, far below it."""
    digits = max(1, 4 - floor(float(tolerance.context.log10(tolerance))))
    return tuple(Fraction(int(c.context.nint(c * 10**digits)), 10**digits) for c in point)
