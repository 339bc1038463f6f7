"""Loading paths in some eighteen digits: the flow rule and the consistency condition, integrated from the formula alone.

On straight steps under constant pressure the stress moves as sigma' = k (u' - lambda' n), n = dg/dsigma, with
lambda' = n . k u' / n . k n while it slips and n . k u' > 0 (Antoni et al. 2007, Eq. 36), else as sigma' = k u'.  The
modified midpoint rule, extrapolated to order 16 (W. B. Gragg, 1965; R. Bulirsch and J. Stoer, 1966), takes it along one
smooth piece of g; where a kink changes its branch the step ends there, found as a root.  The last two columns of the
extrapolation differ by more than the last one is wrong; these differences, summed, are the error that is stated: the flow of
an associated convex law never drives two paths apart in the metric of k^-1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp
from mpmath import MPContext

from duhem.benchmark.precise_formula import Choices, NoReference, PreciseFormula, Slice, Vector, dot, extents, root, steep, within_reach

__all__ = ["Drive", "Driven"]

_SUBSTEPS = (2, 4, 6, 8, 10, 12, 14, 16)
_AHEAD = 1e-12  # of a step: far enough to tell the branches that come next, too short to matter where n is continuous
_LEAST = 1e-13  # of a segment: no step is shorter
_CORNER = 1e-9  # a turn of the normal at a kink that is more than the step beyond it explains


@dataclass(frozen=True)
class Driven:
    """Stress (m, d) in Pa at the knots, as ``mpf``, and ``error`` of it relative to the size of K."""

    stress: list[Vector]
    error: float


class Drive:
    """Paths of one associated convex law under one pressure, from zero stress; ``stiffness`` (d, d) in Pa/m, floats exact."""

    def __init__(
        self,
        g: sp.Expr,
        forces: Sequence[sp.Symbol],
        pressure: sp.Symbol | None,
        stiffness: Sequence[Sequence[float]],
        load: float | None = None,
        digits: int = 18,
    ) -> None:
        mp = self.mp = MPContext()
        mp.dps = 2 * digits + 6
        d = len(forces)
        self.tolerance, self.nothing = mp.mpf(10) ** -digits, mp.mpf(10) ** -(digits + 6)
        formula = PreciseFormula(g, (*forces, *([] if pressure is None else [pressure])), mp)
        tail = [] if load is None else [mp.mpf(float(load))]
        unit = [[mp.mpf(int(i == j)) for j in range(d)] for i in range(d)]
        with within_reach(mp.dps):
            size = extents(Slice(formula, unit, tail), [mp.mpf(1)] * d)
        if size is None:
            raise NoReference("K is the origin alone")
        self.size = size
        self.slice = Slice(formula, [[x * s for x, s in zip(row, size, strict=True)] for row in unit], tail)
        self.k = [[mp.mpf(float(x)) for x in row] for row in stiffness]
        self.scaled = [[x / (a * b) for x, b in zip(row, size, strict=True)] for row, a in zip(self.k, size, strict=True)]

    def __call__(self, points: Sequence[Sequence[float]]) -> Driven:
        """Straight through the displacements ``points`` (m, d) in m, the first of which is where the stress is zero."""
        with within_reach(self.mp.dps):
            return self._driven(points)

    def _driven(self, points: Sequence[Sequence[float]]) -> Driven:
        mp = self.mp
        exact = [[mp.mpf(float(x)) for x in point] for point in points]
        w, slips, error = [mp.mpf(0)] * len(self.size), False, mp.mpf(0)
        stress = [list(w)]
        for before, after in pairwise(exact):
            du = [b - a for a, b in zip(before, after, strict=True)]
            q = [dot(row, du) / s for row, s in zip(self.k, self.size, strict=True)]
            w, slips, lost = self._segment(w, q, slips)
            error += lost
            stress.append(self.slice.forces(w))
        return Driven(stress, float(error))

    def _segment(self, w: Vector, q: Vector, slips: bool) -> tuple[Vector, bool, Any]:
        """The scaled stress at the end of a step that would add ``q`` without slip, whether it slips there, and the error."""
        mp = self.mp
        if not any(q):
            return w, slips, mp.mpf(0)
        time, error, step = mp.mpf(0), mp.mpf(0), mp.mpf(1) / 2
        if not slips or dot(self._normal(w, self.slice.read(w).choices), q) <= 0:
            end = self._to_the_boundary(w, q)
            if end is None:
                return _moved(w, q, mp.mpf(1)), False, error
            time = end
            w = _moved(w, q, end)
        choices = self._next(w, q, self.slice.read(w).choices)
        while 1 - time > self.nothing:
            step = min(step, 1 - time)
            if step < _LEAST * (1 - time) and step < _LEAST:
                raise NoReference("the path is not smooth enough for the reference")
            there, lost = self._extrapolated(w, q, choices, step)
            if not lost <= self.tolerance * step:
                step /= 2
                continue
            if self._signed(there, choices) < 0:
                step = self._event(w, q, choices, step)
                w, time, error = self._extrapolated(w, q, choices, step)[0], time + step, error + lost
                choices = self._next(w, q, choices)
                step = mp.mpf(1) / 8
                continue
            w, time, error, step = there, time + step, error + lost, 2 * step
        return w, True, error

    def _to_the_boundary(self, w: Vector, q: Vector) -> Any:
        """The share of ``q`` at which the stress leaves K without slip; None where it does not."""

        def at(t: Any) -> Any:
            return self.slice.read(_moved(w, q, t)).value

        high = self.mp.mpf(1)
        if at(high) <= 0:
            return None
        low = high
        while at(low) > 0:
            low /= 2
            if low < self.nothing:
                return self.mp.mpf(0)
        return root(at, low, at(low), 2 * low, at(2 * low), self.nothing * self.nothing)

    def _event(self, w: Vector, q: Vector, choices: Choices, step: Any) -> Any:
        def at(h: Any) -> Any:
            return -self._signed(self._extrapolated(w, q, choices, h)[0], choices)

        low = self.mp.mpf(0)
        return root(at, low, -self._signed(w, choices), step, at(step), self.nothing)

    def _signed(self, w: Vector, choices: Choices) -> Any:
        """How far the kinks are from leaving the branches ``choices``, negative beyond; rounding is not beyond."""
        read = self.slice.read(w)
        each = [m if a == b else -m for m, a, b in zip(read.margins, read.choices, choices, strict=True)]
        return min(each, default=self.mp.mpf(1)) + self.nothing

    def _next(self, w: Vector, q: Vector, choices: Choices) -> Choices:
        """The branches a little ahead; a normal that turns there is a corner of K, which this method does not follow."""
        ahead = self.slice.read(_moved(w, self._rate(w, q, choices), self.mp.mpf(_AHEAD))).choices
        if ahead != choices:
            old, new = self._normal(w, choices), self._normal(w, ahead)
            if max(abs(a - b) for a, b in zip(old, new, strict=True)) > _CORNER * max(map(abs, old)):
                raise NoReference("the path meets a corner of K")
        return ahead

    def _normal(self, w: Vector, choices: Choices) -> Vector:
        return self.slice.gradient(w, choices)

    def _rate(self, w: Vector, q: Vector, choices: Choices) -> Vector:
        n = self._normal(w, choices)
        steep(n, self.mp.dps)
        back = [dot(row, n) for row in self.scaled]
        push = dot(n, q) / dot(n, back)
        return [a - push * b for a, b in zip(q, back, strict=True)]

    def _extrapolated(self, w: Vector, q: Vector, choices: Choices, h: Any) -> tuple[Vector, Any]:
        """One step, and the difference of its last two columns."""
        rows: list[Vector] = []
        old: list[Vector] = []
        first = self._rate(w, q, choices)
        for j, n in enumerate(_SUBSTEPS):
            part = h / n
            before, here = w, _moved(w, first, part)
            for _ in range(n - 1):
                before, here = here, _moved(before, self._rate(here, q, choices), 2 * part)
            rows = [[(a + b + part * c) / 2 for a, b, c in zip(before, here, self._rate(here, q, choices), strict=True)]]
            for i in range(j):
                share = (self.mp.mpf(n) / _SUBSTEPS[j - 1 - i]) ** 2 - 1
                rows.append([a + (a - b) / share for a, b in zip(rows[i], old[i], strict=True)])
            old = rows
        return rows[-1], max(abs(a - b) for a, b in zip(rows[-1], rows[-2], strict=True))


def _moved(w: Vector, q: Vector, t: Any) -> Vector:
    return [a + t * b for a, b in zip(w, q, strict=True)]
