"""Boundary points of a law in floats, with their flow and normal: where to look for a bad slip direction."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.search.suggestion import Exit, Point

__all__ = ["BoundaryScout", "scouts"]

_DIRECTIONS = 720
_BITS = 50  # finer than any fraction made of them; the ends of witnesses in print depend on them
_RADII = 10.0 ** np.linspace(-5, 5, 61)


class BoundaryScout:
    """Boundary points of one parameter choice, in floats, along rays from a point of K."""

    def __init__(self, subject: FormulaSubject, parameters: Values) -> None:
        self.subject, self.parameters = subject, parameters
        self.forces = subject.simple.forces
        self._g = compiled(subject.formula_at(parameters), self.forces)
        d = len(self.forces)
        rng = np.random.default_rng(5)
        if d == 2:
            turn = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
            directions = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        else:
            directions = rng.standard_normal((_DIRECTIONS, d))
        rays = np.round(directions, 6)
        # On the boundary 0 is no centre: it may be an apex, and rays from it run along the faces that meet there.
        self.centre = np.zeros(d) if self.value(np.zeros(d)) < 0 else self._lowest(rng, d)
        self.directions, self.low = self._ends(rays)
        if not len(self.low) and self.centre is not None and not self.centre.any():  # every ray from 0 may stay in K
            self.centre = self._lowest(rng, d)
            self.directions, self.low = self._ends(rays)
        self.boundary = np.zeros((0, d)) if self.centre is None else self.centre + self.low[:, None] * self.directions

    def value(self, points: Any) -> Any:
        return self._g(*np.moveaxis(np.asarray(points, dtype=float), -1, 0))

    @property
    def found(self) -> int:
        """How many different boundary points were found."""
        return len(np.unique(np.round(self.boundary, 12), axis=0))

    def _lowest(self, rng: np.random.Generator, d: int) -> Any:
        """The point of K with the least g among random ones of many sizes."""
        points = rng.standard_normal((4000, d)) * 10.0 ** rng.uniform(-2, 2, (4000, 1))
        heights = self.value(points)
        best = points[int(np.argmin(np.where(np.isfinite(heights), heights, np.inf)))]
        return np.round(best, 9) if self.value(np.round(best, 9)) <= 0 else None

    def _ends(self, directions: Any) -> tuple[Any, Any]:
        """The rays that begin inside and end, and where they do."""
        if self.centre is None:
            return directions[:0], np.zeros(0)
        last, first = Rays(self.value, self.centre, directions).left(_RADII, _BITS)
        keep = (last >= _RADII[0]) & (last < first)
        return directions[keep], last[keep]

    def unit_flow(self) -> Any:
        """The flow at the boundary points, of length 1; 0 where it has no value or none in doubles."""
        slips = np.stack([self._slips(face.flow) for face in self.subject.simple.faces])[self._acting(), np.arange(len(self.boundary))]
        slips = np.where(np.isfinite(slips).all(axis=1, keepdims=True), slips, 0.0)
        return slips / (np.linalg.norm(slips, axis=1, keepdims=True) + 1e-300)

    def _acting(self) -> Any:
        """Which face each boundary point lies on: that whose g is greatest."""
        faces = self.subject.simple.faces
        return np.argmax([self._over_boundary(face.g) for face in faces], axis=0) if len(faces) > 1 else 0

    def _slips(self, flow: tuple[sp.Expr, ...] | None) -> Any:
        return self._gradient() if flow is None else np.stack([self._over_boundary(c) for c in flow], axis=1)

    def _over_boundary(self, expr: sp.Expr) -> Any:
        with np.errstate(all="ignore"):
            return np.broadcast_to(compiled(expr.subs(rationals(self.parameters)), self.forces)(*self.boundary.T), len(self.boundary))

    def _gradient(self) -> Any:
        step = 1e-6 * (np.linalg.norm(self.boundary, axis=1, keepdims=True) + 1e-300)
        columns = []
        for i in range(len(self.forces)):
            offset = np.zeros(len(self.forces))
            offset[i] = 1.0
            columns.append((self.value(self.boundary + step * offset) - self.value(self.boundary - step * offset)) / (2 * step[:, 0]))
        return np.stack(columns, axis=1)

    def far_targets(self) -> Iterator[tuple[Exit, Point]]:
        """The three boundary points whose flow leans most towards some other sampled point, with that point."""
        slips = self.unit_flow()
        reach = slips @ self.boundary.T - np.sum(slips * self.boundary, axis=1)[:, None]
        reach = np.where(np.isfinite(reach), reach, -np.inf)
        sizes = np.linalg.norm(self.boundary[None, :, :] - self.boundary[:, None, :], axis=2) + 1e-300
        for k in np.argsort(-np.max(reach / sizes, axis=1))[:3]:
            best = int(np.argmax(reach[k]))
            if reach[k, best] > 0:
                yield self._exit(int(k)), tuple(Fraction(float(c) * (1 - 2.0**-20)).limit_denominator(10**6) for c in self.boundary[best])

    def near_targets(self) -> Iterator[tuple[Exit, Exit]]:
        """In two forces: the points of largest deviation, each with others of the boundary, turned by a share of that deviation."""
        if len(self.forces) != 2:
            return
        normals, slips = self._gradient(), self.unit_flow()
        turn = np.arctan2(normals[:, 0] * slips[:, 1] - normals[:, 1] * slips[:, 0], np.sum(normals * slips, axis=1))
        turn = np.where(np.isfinite(turn), turn, 0.0)
        for k in np.argsort(-np.abs(turn))[:3]:
            for share in (1.0, 0.5, 0.25, 0.1):
                angle = Fraction(float(share * turn[k])).limit_denominator(10**12)
                here = self._exit(int(k))
                turned = ((p[0] - angle * p[1], p[1] + angle * p[0]) for p in (here.inside, here.outside))
                yield here, Exit(self.parameters, *turned)

    def towards_zero_force(self) -> Iterator[Exit]:
        """From a point of K to 0 where 0 is outside: the boundary is crossed outward, so grad g . (0 - sigma) > 0 there."""
        if self.centre is not None and self.centre.any():
            inside = tuple(Fraction(float(c)).limit_denominator(10**9) for c in self.centre)
            yield Exit(self.parameters, inside, (Fraction(0),) * len(inside))

    def least_power(self, most: int) -> Iterator[Exit]:
        """Boundary points with negative power, the most negative first."""
        if len(self.boundary) == 0:
            return
        power = np.sum(self.unit_flow() * self.boundary, axis=1) / (np.linalg.norm(self.boundary, axis=1) + 1e-300)
        order = np.argsort(np.where(np.isfinite(power), power, np.inf))
        for k in [k for k in order if power[k] < -1e-12][:most]:
            yield self._exit(int(k))

    def _exit(self, k: int) -> Exit:
        """Exact points on the ray, a little before and a little after the crossing."""
        centre = [Fraction(float(c)).limit_denominator(10**9) for c in self.centre]
        ray = [Fraction(float(c)).limit_denominator(10**6) for c in self.directions[k]]
        ends = (Fraction(float(s * self.low[k])).limit_denominator(10**12) for s in (1 - 1e-6, 1 + 1e-6))
        return Exit(self.parameters, *(tuple(c + end * r for c, r in zip(centre, ray, strict=True)) for end in ends))


def scouts(subject: FormulaSubject, most: int) -> Iterator[BoundaryScout]:
    """At so many choices of the parameters; each is made once for a subject."""
    for parameters in subject.choices(most):
        key = (BoundaryScout, tuple(parameters.items()))
        if key not in subject.known:
            subject.known[key] = BoundaryScout(subject, parameters)
        yield subject.known[key]
