"""Boundary points of a law in floats, with their flow and normal: where to look for a bad slip direction.

What a search hands on are exact parameter values and exact points, worth an exact look.  Nothing of that is certain.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.law.domain import REAL
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Point, Values, rationals

__all__ = ["BoundaryScout", "Chord", "Exit", "lowest", "scout", "scouts"]

_DIRECTIONS = 720
_BITS = 50  # finer than any fraction made of them; the ends of witnesses in print depend on them
_TOUCHING, _NEAR = 1e-9, 1e-6  # heights of faces that meet; a point itself
_RADII = 10.0 ** np.linspace(-5, 5, 61)
_DRAWN, _DEEPENED, _AROUND = 4000, 80, 64
_DEEP = 3  # how many rounds are worth while inside


Chord = tuple[Values, Point, Point]  # two points of K, as it seems, whose midpoint is outside


class Exit(NamedTuple):
    """A segment from ``inside`` K, as it seems, to ``outside``: the boundary crosses it."""

    parameters: Values
    inside: Point
    outside: Point


class BoundaryScout:
    """Boundary points of one parameter choice, in floats, along rays from a point of K: in given directions (m, d), or all around.

    With ``rows`` (m, k), the values of all parameters on each ray, every ray has a choice and a centre (m, d) of its own.  Zero force
    takes the place of a given centre where it is inside K.  ``kept`` are the numbers of the rays that meet the boundary.
    """

    def __init__(
        self,
        subject: FormulaSubject,
        parameters: Values,
        directions: NDArray[np.float64] | None = None,
        centre: NDArray[np.float64] | None = None,
        rows: NDArray[np.float64] | None = None,
    ) -> None:
        self.subject, self.parameters = subject, parameters
        self.forces = subject.simple.forces
        self._names = (*self.forces, *(() if rows is None else subject.simple.parameters))
        self._rows = np.zeros((1, 0)) if rows is None else rows
        self._g = compiled(subject.formula_at(parameters), self._names)
        d = len(self.forces)
        rng = np.random.default_rng(5)
        if directions is None:
            turn = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
            directions = np.stack([np.cos(turn), np.sin(turn)], axis=1) if d == 2 else rng.standard_normal((_DIRECTIONS, d))
        rays = np.round(directions, 6)
        # On the boundary 0 is no centre: it may be an apex, and rays from it run along the faces that meet there.
        if centre is None:
            self.centre = np.zeros(d) if self.value(np.zeros(d)) < 0 else self._lowest(rng, d)
        else:
            self.centre = np.where(np.asarray(self.value(np.zeros_like(centre)))[..., None] < 0, 0.0, centre)
        self.directions, self.low, self.beyond = self._ends(rays)
        if centre is None and not len(self.low) and self.centre is not None and not self.centre.any():  # every ray from 0 may stay in K
            self.centre = self._lowest(rng, d)
            self.directions, self.low, self.beyond = self._ends(rays)
        self.boundary, self.outside = self._along(self.low), self._along(self.beyond)

    def value(self, points: Any) -> Any:
        found = np.asarray(points, dtype=float)
        own = (column.reshape(-1, *[1] * (found.ndim - 2)) for column in self._rows.T)
        return self._g(*np.moveaxis(found, -1, 0), *own)

    @property
    def found(self) -> int:
        """How many different boundary points were found."""
        return len(np.unique(np.round(self.boundary, 12), axis=0))

    def _lowest(self, rng: np.random.Generator, d: int) -> Any:
        low, high = self._ranges()
        found = lowest(lambda x: np.maximum(self.value(x), np.max(np.maximum(low - x, x - high), axis=-1)), d, rng, (-2, 2))
        return None if found is None or self.value(np.round(found, 9)) > 0 else np.round(found, 9)

    def _ends(self, directions: Any) -> tuple[Any, Any, Any]:
        """The rays that begin inside and end in the law's ranges, where they last are inside and where they first are not."""
        if self.centre is None:
            return directions[:0], np.zeros(0), np.zeros(0)
        last, first = Rays(self.value, self.centre, directions).left(_RADII, _BITS)
        low, high = self._ranges()
        at = self.centre + last[:, None] * directions
        keep = (last >= _RADII[0]) & (last < first) & ((low <= at) & (at <= high)).all(axis=1)
        self.kept = np.flatnonzero(keep)
        if self.centre.ndim == 2:
            self._rows, self.centre = self._rows[keep], self.centre[keep]
        return directions[keep], last[keep], first[keep]

    def _ranges(self) -> Any:
        """The lowest and the highest values of the forces in the law's ranges."""
        return np.array([self.subject.law.domain.get(x.name, REAL).ends for x in self.forces]).T

    def _along(self, radii: Any) -> Any:
        return np.zeros((0, len(self.forces))) if self.centre is None else self.centre + radii[:, None] * self.directions

    @cached_property
    @np.errstate(all="ignore")
    def unit_flow(self) -> tuple[Any, Any]:
        """Slips of length 1 at boundary points, and the number of the point of each; 0 where there is none in doubles.

        Of every face that acts there, as it is a last bit inside K and a last bit outside, between which it may jump.
        """
        faces, place, slips = self.subject.simple.faces, [], []
        for points in (self.boundary, self.outside):
            heights = np.stack([self._over(points, face.g) for face in faces])
            acting = heights >= np.max(heights, axis=0) - _TOUCHING * np.linalg.norm(points * self.gradient, axis=1)
            if len(faces) == 1:
                acting[:] = True  # also where its height is no number
            for face, acts in zip(faces, acting, strict=True):
                own = self.gradient if face.flow is None else np.stack([self._over(points, c) for c in face.flow], axis=1)
                place.append(np.flatnonzero(acts))
                slips.append(own[place[-1]])
        every = np.concatenate(slips)
        every = np.where(np.isfinite(every).all(axis=1, keepdims=True), every, 0.0)
        return np.concatenate(place), every / (np.linalg.norm(every, axis=1, keepdims=True) + 1e-300)

    def _over(self, points: Any, expr: sp.Expr) -> Any:
        with np.errstate(all="ignore"):
            return np.broadcast_to(compiled(expr.subs(rationals(self.parameters)), self._names)(*points.T, *self._rows.T), len(points))

    @cached_property
    @np.errstate(all="ignore")
    def gradient(self) -> Any:
        """Of g at the boundary points, by differences."""
        step = 1e-6 * (np.linalg.norm(self.boundary, axis=1, keepdims=True) + 1e-300)
        offsets = (step * unit for unit in np.eye(len(self.forces)))
        rises = [self.value(self.boundary + offset) - self.value(self.boundary - offset) for offset in offsets]
        return np.stack(rises, axis=1) / (2 * step)

    def far_targets(self) -> Iterator[tuple[Exit, Point]]:
        """Boundary points whose flow leans towards some other sampled point of K, with that point: the worst and some of the others."""
        place, _ = self.unit_flow
        reach, share = self._reach
        for k in _spread(-np.max(share, axis=1), 3):
            best = int(np.argmax(reach[k]))
            if reach[k, best] > 0:
                target = self.centre + (self._targets[best] - self.centre) * (1 - 2.0**-20)
                yield self._exit(int(place[k])), tuple(Fraction(float(c)).limit_denominator(10**6) for c in target)

    def near_targets(self) -> Iterator[tuple[Exit, Exit]]:
        """In two forces: the points of largest deviation, each with others of the boundary, turned by a share of that deviation."""
        if len(self.forces) != 2:
            return
        place, slips = self.unit_flow
        normals = self.gradient[place]
        turn = np.arctan2(normals[:, 0] * slips[:, 1] - normals[:, 1] * slips[:, 0], np.sum(normals * slips, axis=1))
        turn = np.where(np.isfinite(turn), turn, 0.0)
        for k in np.argsort(-np.abs(turn))[:3]:
            for share in (1.0, 0.5, 0.25, 0.1):
                angle = Fraction(float(share * turn[k])).limit_denominator(10**12)
                here = self._exit(int(place[k]))
                turned = ((p[0] - angle * p[1], p[1] + angle * p[0]) for p in (here.inside, here.outside))
                yield here, Exit(self.parameters, *turned)

    def towards_zero_force(self) -> Iterator[Exit]:
        """From a point of K to 0 where 0 is outside: the boundary is crossed outward, so grad g . (0 - sigma) > 0 there."""
        if self.centre is not None and self.centre.any():
            inside = tuple(Fraction(float(c)).limit_denominator(10**9) for c in self.centre)
            yield Exit(self.parameters, inside, (Fraction(0),) * len(inside))

    def least_power(self, most: int) -> Iterator[Exit]:
        """Boundary points with negative power: the most negative and some of the others."""
        yield from (self._exit(k) for k in _spread(self.power(), most))

    @np.errstate(all="ignore")
    def power(self) -> Any:
        """The least power of a slip of length 1 at each boundary point, as a share of the force's size."""
        if self.subject.state is not None:  # the slip is one of all variables, and of no length 1
            return self._over(self.boundary, self.subject.power(()))
        place, slips = self.unit_flow
        points = self.boundary[place]
        return self._least(np.sum(slips * points, axis=1) / (np.linalg.norm(points, axis=1) + 1e-300))

    @cached_property
    @np.errstate(all="ignore")
    def _reach(self) -> tuple[Any, Any]:
        """How far each slip goes towards each boundary point and the centre, and as a share of the distance."""
        place, slips = self.unit_flow
        away = self._targets[None, :, :] - self.boundary[place][:, None, :]
        distance = np.linalg.norm(away, axis=2)
        reach = np.einsum("kji,ki->kj", away, slips)
        near = ~np.isfinite(reach) | (distance <= _NEAR * np.linalg.norm(self.boundary[place], axis=1, keepdims=True))
        return np.where(near, -np.inf, reach), np.where(near, -np.inf, reach / (distance + 1e-300))

    def leaning(self) -> Any:
        """For each boundary point the greatest share of the distance that one of its slips goes towards another, or towards the centre.

        On rays of many choices, what the cosine of slip and normal lacks to 1.
        """
        if self.centre.ndim == 1:
            return -self._least(-np.max(self._reach[1], axis=1))
        place, slips = self.unit_flow
        normals = self.gradient[place] / (np.linalg.norm(self.gradient[place], axis=1, keepdims=True) + 1e-300)
        return 1.0 - self._least(np.sum(slips * normals, axis=1))

    def _least(self, values: Any) -> Any:
        """Of each boundary point the least of those of its slips."""
        found = np.full(len(self.boundary), np.inf)
        np.fmin.at(found, self.unit_flow[0], values)
        return found

    @property
    def _targets(self) -> Any:
        return self.boundary if self.centre is None else np.vstack([self.boundary, self.centre])

    def _exit(self, k: int) -> Exit:
        """Exact points on the ray, a little before and a little after the crossing."""
        centre = [Fraction(float(c)).limit_denominator(10**9) for c in self.centre]
        ray = [Fraction(float(c)).limit_denominator(10**6) for c in self.directions[k]]
        ends = (Fraction(float(s * self.low[k])).limit_denominator(10**12) for s in (1 - 1e-6, 1 + 1e-6))
        return Exit(self.parameters, *(tuple(c + end * r for c, r in zip(centre, ray, strict=True)) for end in ends))


def _spread(heights: Any, most: int) -> list[int]:
    """Places of negative values: so many of the least, and three between them and 0."""
    order = [int(k) for k in np.argsort(np.where(np.isfinite(heights), heights, np.inf)) if heights[k] < -1e-12]
    return list(dict.fromkeys([*order[:most], *(order[len(order) * n // 4] for n in (1, 2, 3) if order)]))


def scouts(subject: FormulaSubject, most: int) -> Iterator[BoundaryScout]:
    """At so many choices of the parameters."""
    return map(partial(scout, subject), subject.choices(most))


def scout(subject: FormulaSubject, parameters: Values) -> BoundaryScout:
    """Made once for a subject."""
    key = (BoundaryScout, tuple(parameters.items()))
    if key not in subject.known:
        subject.known[key] = BoundaryScout(subject, parameters)
    found: BoundaryScout = subject.known[key]
    return found


def lowest(value: Callable[[Any], Any], d: int, rng: np.random.Generator, sizes: tuple[float, float]) -> NDArray[np.float64] | None:
    """The lowest of random points, 10 to such powers in size; where that is outside of K, from there downhill, or None."""

    def heights(points: Any) -> Any:
        found = np.asarray(value(points), dtype=float)
        return np.where(np.isfinite(found), found, np.inf)

    points = rng.standard_normal((_DRAWN, d)) * 10.0 ** rng.uniform(*sizes, (_DRAWN, 1))
    found = heights(points)
    here, height = points[int(np.argmin(found))], float(found.min())
    if not height > 0:
        return here
    width, deeper = float(np.linalg.norm(here)), 0
    for _ in range(_DEEPENED):  # around the lowest so far, ever closer where none is lower
        near = here + width * rng.standard_normal((_AROUND, d))
        found = heights(near)
        if found.min() < height:
            here, height = near[int(np.argmin(found))], float(found.min())
            deeper += height <= 0
            if deeper == _DEEP:
                break
        else:
            width /= 2
    return here if height <= 0 else None
