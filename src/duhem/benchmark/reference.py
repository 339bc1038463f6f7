"""High-precision references from the law's formula alone, with their own error: the slip increment in some fifty digits, paths in eighteen.

Nothing here is shared with the methods that are measured against it: neither their derivatives nor their shapes.  Directions
along which K does not end are taken out, what is left is scaled to size 1 and searched.

As seen from a point inside K, the boundary that faces the target is searched by bisection on the angle: there the distance in
the metric is strictly convex along the boundary (for a boundary r(s) with outward normal n and curvature >= 0,
(|x - r|^2/2)'' = 1 + curvature (x - r).n >= 1 where (x - r).n >= 0), so one sign tells on which side the closest point lies,
whatever the aspect of K and of the metric, and at corners alike.  Newton's method is tried from time to time, on the piece of
g that holds or where two pieces meet, and believed only if the optimality conditions then hold.

What counts is the residual that comes with each answer: for a convex K the optimality conditions are sufficient, and the
error of the stress in the metric of k^-1 is at most the residual's share of the way to the trial stress.

Along a loading path the flow rule and the consistency condition are integrated. On straight steps under constant pressure the stress
moves as sigma' = k (u' - lambda' n), n = dg/dsigma, with lambda' = n . k u' / n . k n while it slips and n . k u' > 0 (Antoni et al.
2007, Eq. 36), else as sigma' = k u'.  The modified midpoint rule, extrapolated to order 16 (W. B. Gragg, 1965; R. Bulirsch and J. Stoer,
1966), takes it along one smooth piece of g; where a kink changes its branch the step ends there, found as a root.  The last two columns
of the extrapolation differ by more than the last one is wrong; these differences, summed, are the error that is stated: the flow of an
associated convex law never drives two paths apart in the metric of k^-1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp
from mpmath import MPContext

from duhem.benchmark.precise_formula import (
    Choices,
    NoReference,
    PreciseFormula,
    Slice,
    Vector,
    dot,
    extents,
    reach,
    root,
    steep,
    within_reach,
)
from duhem.expression.invariance import invariant_directions
from duhem.expression.mpmath_ import number

__all__ = ["Closest", "Drive", "Driven", "NoReference", "ReferenceIncrement", "distance"]

_GUARD = 3  # times the digits asked for: differences take a part of them, extreme aspects another

_FIRST_TRY, _EVERY = 6, 8  # bisections before and between the tries of Newton's method
_NEWTON = 14


@dataclass(frozen=True)
class ReferenceIncrement:
    """Stress (Pa), slip k^-1 (trial - stress) and multiplier of g, as ``mpf``; ``slips`` whether the trial lies outside K.

    ``residual``: the optimality conditions, relative to the slip and to the size of K: the reference's own error, never less
    than the rounding of the differences it rests on.
    """

    stress: tuple[Any, ...]
    slip: tuple[Any, ...]
    multiplier: Any
    slips: bool
    residual: float


def distance(got: Sequence[float], exact: Sequence[Any], unit: Any = None) -> float:
    """The largest |got - exact| relative to ``unit``, by default the largest |exact|; the difference is taken in many digits."""
    off = max(abs(float(a) - b) for a, b in zip(got, exact, strict=True))
    size = max(abs(b) for b in exact) if unit is None else unit
    return float("nan") if off != off else 0.0 if off == 0 else float("inf") if size == 0 else float(off / size)


class Closest:
    """Closest points of one law with numbers for parameters: ``g`` over ``forces`` and ``pressure``, convex in the forces.

    ``stiffness`` (d, d) in Pa/m.  Floats are taken exactly.  Raises NoReference where K has more than two bounded
    directions, or does not contain the origin, and where its digits do not suffice.
    """

    def __init__(
        self, g: sp.Expr, forces: Sequence[sp.Symbol], pressure: sp.Symbol | None, stiffness: Sequence[Sequence[float]], digits: int = 50
    ) -> None:
        self.digits, self.context = digits, MPContext()
        self.context.dps = _GUARD * digits
        self.formula = PreciseFormula(g, (*forces, *([] if pressure is None else [pressure])), self.context)
        mp, d = self.context, len(forces)
        k = mp.matrix([[mp.mpf(float(x)) for x in row] for row in stiffness])
        with within_reach(mp.dps):
            self.compliance = k**-1
        endless = [mp.matrix([int(c) for c in v]) for v in invariant_directions(g, forces)]
        self.endless = endless
        self.columns = mp.eye(d) if not endless else k * _normals(mp, endless, d)
        if self.columns.cols > 2:
            raise NoReference(f"the reference handles two bounded directions, K has {self.columns.cols}")

    def __call__(self, trial: Sequence[float], pressure: float | None = None) -> ReferenceIncrement:
        """The closest point to ``trial`` (d,) in Pa under ``pressure`` sigma_n <= 0 in Pa."""
        with within_reach(self.context.dps):
            return self._found(trial, pressure)

    def _found(self, trial: Sequence[float], pressure: float | None) -> ReferenceIncrement:
        mp = self.context
        x = mp.matrix([mp.mpf(float(t)) for t in trial])
        tail = [] if pressure is None else [mp.mpf(float(pressure))]
        level = self.formula.read([*x, *tail]).value
        if mp.isnan(level):
            raise NoReference("g is not defined at the trial stress")
        if level <= 0:
            zero = mp.mpf(0)
            return ReferenceIncrement(tuple(x), (zero,) * len(x), zero, False, 0.0)
        aim = x - self._along(x)
        b = self.columns
        metric = b.T * self.compliance * b
        y = list(mp.lu_solve(metric, b.T * self.compliance * aim))
        plain = Slice(self.formula, b.tolist(), tail)
        size = extents(plain, y)
        if size is None:  # K is the origin alone
            return ReferenceIncrement((mp.mpf(0),) * len(x), tuple(self.compliance * x), mp.nan, True, 0.0)
        sliced = Slice(self.formula, [[c * s for c, s in zip(row, size, strict=True)] for row in b.tolist()], tail)
        scaled = [[metric[i, j] * size[i] * size[j] for j in range(len(y))] for i in range(len(y))]
        unit = max(scaled[i][i] for i in range(len(y)))
        scaled = [[c / unit for c in row] for row in scaled]
        target = [c / s for c, s in zip(y, size, strict=True)]
        found = _Search(sliced, scaled, target, self.digits).run()
        stress = mp.matrix(sliced.forces(found.w)) + self._along(x)
        return ReferenceIncrement(
            tuple(stress),
            tuple(self.compliance * (x - stress)),
            found.multiplier * unit,
            True,
            float(max(found.residual, self.formula.step**2)),
        )

    def _along(self, x: Any) -> Any:
        """The part of ``x`` along which K does not end, in the metric of k^-1."""
        mp = self.context
        if not self.endless:
            return mp.matrix(len(x), 1)
        lines = mp.matrix([list(v) for v in self.endless]).T
        return lines * mp.lu_solve(lines.T * self.compliance * lines, lines.T * self.compliance * x)


def _normals(mp: Any, endless: Sequence[Any], d: int) -> Any:
    """A basis (d, d - r) of what is orthogonal to the endless directions."""
    space = sp.Matrix([[int(c) for c in v] for v in endless]).nullspace()
    return mp.matrix([[number(mp, v[i]) for v in space] for i in range(d)])


@dataclass(frozen=True)
class _Found:
    """The point in coordinates of size 1, the multiplier of g and the residual of the optimality conditions."""

    w: Vector
    multiplier: Any
    residual: Any


@dataclass(frozen=True)
class _Seen:
    """A boundary point, the piece that holds there, its normal, and on which side of it the closest point lies."""

    w: Vector
    choices: Choices
    normal: Vector
    reach: Any
    side: int  # -1, 0, 1
    faces: bool


class _Search:
    """The closest point in coordinates of size 1, in the metric ``metric`` (m, m), to ``target`` (m,)."""

    def __init__(self, slice_: Slice, metric: list[Vector], target: Vector, digits: int) -> None:
        self.slice, self.metric, self.target, self.digits = slice_, metric, target, digits
        self.mp = slice_.formula.context
        self.fine = self.mp.mpf(10) ** -(digits + 2)
        length = self.mp.sqrt(dot(target, target))
        self.ahead = [c / length for c in target]  # an angle is taken from here, towards the left

    def run(self) -> _Found:
        mp = self.mp
        hint = reach(self.slice, self.ahead, mp.mpf(1), digits=3)
        if hint is None:
            raise NoReference("the origin is not inside K")
        if len(self.ahead) == 1:
            return self._ended(self._seen(mp.mpf(0), hint, mp.dps - 5))
        first = self._seen(mp.mpf(0), hint)
        if first.side == 0:
            return self._ended(self._seen(mp.mpf(0), first.reach, mp.dps - 5))
        way, near, far = first.side, first, None
        low, high = mp.mpf(0), mp.pi
        for turn in range(4 * self.digits + 40):
            if turn == _FIRST_TRY or (turn > _FIRST_TRY and (turn - _FIRST_TRY) % _EVERY == 0):
                found = self._tried(near, far)
                if found is not None:
                    return found
            middle = (low + high) / 2
            seen = self._seen(way * middle, (far or near).reach)
            if seen.faces and seen.side == 0:
                return self._ended(self._seen(way * middle, seen.reach, mp.dps - 5))
            if seen.faces and seen.side == way:
                low, near = middle, seen
            else:
                high, far = middle, seen
        ended = self._seen(way * low, near.reach, mp.dps - 5)
        return self._ended(ended, *([] if far is None else [far.normal]))

    def _seen(self, angle: Any, hint: Any, digits: int | None = None) -> _Seen:
        """The boundary point at an angle; of one force the angle is 0."""
        mp, direction = self.mp, self.ahead
        if len(direction) == 2:
            (a, b), cos, sin = direction, mp.cos(angle), mp.sin(angle)
            direction = [cos * a - sin * b, cos * b + sin * a]
        length = reach(self.slice, direction, hint, self.digits + 20 if digits is None else digits)
        w = [length * c for c in direction]
        choices = self.slice.read(w).choices
        normal = self.slice.gradient(w, choices)
        faces = dot([t - c for t, c in zip(self.target, w, strict=True)], normal) > 0
        if len(w) == 1:
            return _Seen(w, choices, normal, length, 0, faces)
        pull = self.pull(w)
        return _Seen(w, choices, normal, length, int(mp.sign(normal[0] * pull[1] - normal[1] * pull[0])), faces)

    def pull(self, w: Vector) -> Vector:
        """M (target - w)."""
        off = [t - c for t, c in zip(self.target, w, strict=True)]
        return [dot(row, off) for row in self.metric]

    def _tried(self, near: _Seen, far: _Seen | None) -> _Found | None:
        both = [near] if far is None else [near, far]
        for seen in both:
            found = self._newton(seen)
            if found is not None:
                return found
        if far is not None and far.choices != near.choices:
            return self._corner(near, far)
        return None

    def _newton(self, start: _Seen) -> _Found | None:
        mp, m = self.mp, len(start.w)
        w, choices = list(start.w), start.choices
        normal, pull = start.normal, self.pull(start.w)
        multiplier = dot(normal, pull) / steep(normal, mp.dps)
        last = mp.inf
        for turn in range(_NEWTON):
            level = self.slice.read(w, choices).value
            bend = self.slice.hessian(w, choices)
            matrix = mp.matrix(m + 1, m + 1)
            right = mp.matrix(m + 1, 1)
            for i in range(m):
                for j in range(m):
                    matrix[i, j] = self.metric[i][j] + multiplier * bend[i][j]
                matrix[i, m] = matrix[m, i] = normal[i]
                right[i] = pull[i] - multiplier * normal[i]
            right[m] = -level
            if any(mp.isnan(c) or mp.isinf(c) for c in [*matrix, *right]):
                return None
            try:
                step = mp.lu_solve(matrix, right)
            except ZeroDivisionError:
                return None
            w = [c + s for c, s in zip(w, step, strict=False)]
            multiplier += step[m]
            size = max(abs(step[i]) for i in range(m))
            if turn > 3 and size > last / 2 and size > self.fine:
                return None
            last = size
            normal, pull = self.slice.gradient(w, choices), self.pull(w)
            if size <= self.fine * self.fine:
                break
        return self._checked(w, [normal], [multiplier], [choices])

    def _corner(self, near: _Seen, far: _Seen) -> _Found | None:
        """Where the pieces of two boundary points meet."""
        mp, w = self.mp, list(near.w)
        for _ in range(_NEWTON):
            levels = [self.slice.read(w, s.choices).value for s in (near, far)]
            normals = [self.slice.gradient(w, s.choices) for s in (near, far)]
            if any(mp.isnan(c) or mp.isinf(c) for c in [*levels, *normals[0], *normals[1]]):
                return None
            try:
                step = mp.lu_solve(mp.matrix(normals), -mp.matrix(levels))
            except ZeroDivisionError:
                return None
            w = [c + s for c, s in zip(w, step, strict=True)]
            if max(abs(s) for s in step) <= self.fine * self.fine:
                break
        try:
            shares = list(mp.lu_solve(mp.matrix(normals).T, mp.matrix(self.pull(w))))
        except ZeroDivisionError:
            return None
        return self._checked(w, normals, shares, [near.choices, far.choices])

    def _checked(self, w: Vector, normals: list[Vector], shares: Vector, pieces: Sequence[Choices]) -> _Found | None:
        """The point with its residual, if it is as good as asked for and the pieces hold there."""
        residual = self._residual(w, normals, shares)
        return _Found(w, sum(shares), residual) if residual <= self.fine and self._hold(w, pieces) else None

    def _hold(self, w: Vector, pieces: Sequence[Choices]) -> bool:
        """Whether each kink takes the branch of every piece at ``w``, or is as close to it as rounding, in lengths of w."""
        here = self.slice.read(w)
        aside = [self.slice.read([c + sign * (i + 1) / self.mp.mpf(7) for i, c in enumerate(w)]).margins for sign in (1, -1)]
        return all(
            branch == taken or margin <= self.mp.sqrt(self.fine) * max(sizes)
            for piece in pieces
            for branch, taken, margin, *sizes in zip(piece, here.choices, here.margins, *aside, strict=True)
        )

    def _residual(self, w: Vector, normals: list[Vector], shares: Vector) -> Any:
        mp, pull = self.mp, self.pull(w)
        if any(mp.isnan(c) for c in [*w, *shares]):
            return mp.inf
        level = abs(self.slice.read(w).value)
        scale = max(sum(abs(a * b) for a, b in zip(n, w, strict=True)) for n in normals)
        left = [c - sum(s * n[i] for s, n in zip(shares, normals, strict=True)) for i, c in enumerate(pull)]
        length, most = mp.sqrt(dot(pull, pull)), max(abs(s) for s in shares)
        if length == 0 or most == 0:
            return mp.inf
        off = mp.sqrt(dot(left, left)) / length
        negative = max([mp.mpf(0), *(-s for s in shares)]) / most
        return max(level / scale, off, negative) if scale > 0 else mp.inf

    def _ended(self, seen: _Seen, *others: Vector) -> _Found:
        """The best that the search gives, with the residual it has: the normal cone is spanned by one or two normals."""
        mp, pull = self.mp, self.pull(seen.w)
        share = dot(seen.normal, pull) / steep(seen.normal, mp.dps)
        best = _Found(seen.w, share, self._residual(seen.w, [seen.normal], [share]))
        for other in others:
            try:
                shares = list(mp.lu_solve(mp.matrix([seen.normal, other]).T, mp.matrix(pull)))
            except ZeroDivisionError:
                continue
            residual = self._residual(seen.w, [seen.normal, other], shares)
            if residual < best.residual:
                best = _Found(seen.w, sum(shares), residual)
        return best


# -- loading paths -----------------------------------------------------------------------------------------------------


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
