"""The slip increment in some fifty digits: the optimality conditions of the closest point, solved from the formula.

In the plane, as seen from a point inside K, the boundary that faces the trial stress is searched by bisection on the angle:
there the distance in the metric of k^-1 is strictly convex along the boundary (for a boundary r(s) with outward normal n
and curvature >= 0, (|x - r|^2/2)'' = 1 + curvature (x - r).n >= 1 where (x - r).n >= 0), so one sign tells on which side
the closest point lies, whatever the aspect of K and of k, and at corners alike.  Newton's method gives the last digits, on
the piece of g that holds there or where two pieces meet.  Directions along which K does not end are taken out first.

What counts is the residual that comes with each answer: for a convex K the optimality conditions are sufficient, and the
error of the stress in the metric of k^-1 is at most the residual's share of the way to the trial stress.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from mpmath import MPContext

from duhem.model.lineality import invariant_directions
from duhem.reference.formula import Choices, Formula, NoReference, Slice

__all__ = ["Answer", "Closest", "distance", "extents", "root"]

_GUARD = 3  # times the digits asked for: differences take a part of them, extreme aspects another
_FIRST_TRY, _EVERY = 6, 8  # bisections before and between the tries of Newton's method
_NEWTON = 14
_FARTHEST = 14  # 2^(2^14): how far a ray is followed for the boundary

Vector = list[Any]


@dataclass(frozen=True)
class Answer:
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
    directions, or does not contain the origin.
    """

    def __init__(
        self, g: sp.Expr, forces: Sequence[sp.Symbol], pressure: sp.Symbol | None, stiffness: Sequence[Sequence[float]], digits: int = 50
    ) -> None:
        self.digits, self.context = digits, MPContext()
        self.context.dps = _GUARD * digits
        self.formula = Formula(g, (*forces, *([] if pressure is None else [pressure])), self.context)
        mp, d = self.context, len(forces)
        k = mp.matrix([[mp.mpf(float(x)) for x in row] for row in stiffness])
        self.compliance = k**-1
        endless = [mp.matrix([int(c) for c in v]) for v in invariant_directions(g, forces)]
        self.endless = endless
        self.columns = mp.eye(d) if not endless else k * _normals(mp, endless, d)
        if self.columns.cols > 2:
            raise NoReference(f"the reference handles two bounded directions, K has {self.columns.cols}")

    def __call__(self, trial: Sequence[float], pressure: float | None = None) -> Answer:
        """The closest point to ``trial`` (d,) in Pa under ``pressure`` sigma_n <= 0 in Pa."""
        mp = self.context
        x = mp.matrix([mp.mpf(float(t)) for t in trial])
        tail = [] if pressure is None else [mp.mpf(float(pressure))]
        level = self.formula.read([*x, *tail]).value
        if mp.isnan(level):
            raise NoReference("g is not defined at the trial stress")
        if level <= 0:
            zero = mp.mpf(0)
            return Answer(tuple(x), (zero,) * len(x), zero, False, 0.0)
        aim = x - self._along(x)
        b = self.columns
        metric = b.T * self.compliance * b
        y = list(mp.lu_solve(metric, b.T * self.compliance * aim))
        plain = Slice(self.formula, b.tolist(), tail)
        size = extents(plain, y)
        if size is None:  # K is the origin alone
            return Answer((mp.mpf(0),) * len(x), tuple(self.compliance * x), mp.nan, True, 0.0)
        sliced = Slice(self.formula, [[c * s for c, s in zip(row, size, strict=True)] for row in b.tolist()], tail)
        scaled = [[metric[i, j] * size[i] * size[j] for j in range(len(y))] for i in range(len(y))]
        unit = max(scaled[i][i] for i in range(len(y)))
        scaled = [[c / unit for c in row] for row in scaled]
        target = [c / s for c, s in zip(y, size, strict=True)]
        found = _Search(sliced, scaled, target, self.digits).run()
        stress = mp.matrix(sliced.forces(found.w)) + self._along(x)
        return Answer(
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
    return mp.matrix([[mp.mpf(int(v[i].p)) / int(v[i].q) for v in space] for i in range(d)])


def extents(plain: Slice, y: Vector) -> Vector | None:
    """How far K reaches along each coordinate; None where it is the origin alone."""
    m, mp = len(y), plain.formula.context
    if plain.read([0 * c for c in y]).value > 100 * mp.eps * abs(plain.read(y).value):
        raise NoReference("the origin is not inside K")
    hint = max(abs(c) for c in y)
    axes = [[s * (1 if i == j else 0) for j in range(m)] for i in range(m) for s in (1, -1)]
    reach = [_reach(plain, [mp.mpf(c) for c in axis], hint, digits=3) for axis in axes]
    toward = _reach(plain, y, mp.mpf(1), digits=3)
    if toward is None:
        if any(r is not None for r in reach):
            raise NoReference("the origin is not inside K")
        return None
    sizes = []
    for i in range(m):
        both = [r for r in reach[2 * i : 2 * i + 2] if r is not None]
        sizes.append(max(both) if both else toward * hint)
    return sizes


def _reach(slice_: Slice, direction: Vector, hint: Any, digits: int) -> Any:
    """The t > 0 at which g(t direction) = 0, to ``digits``; None where no point of the ray lies in K."""
    mp = slice_.formula.context

    def at(t: Any) -> Any:
        value = slice_.read([t * c for c in direction]).value
        return mp.inf if mp.isnan(value) else value

    low = high = hint
    f_low = f_high = at(hint)
    for power in range(_FARTHEST):
        factor = mp.mpf(2) ** (2**power)
        if f_low > 0:
            high, f_high = low, f_low
            low = low / factor
            f_low = at(low)
        elif f_high <= 0:
            low, f_low = high, f_high
            high = high * factor
            f_high = at(high)
        else:
            break
    if f_low > 0:
        return None
    if f_high <= 0:
        raise NoReference("K does not end along a ray")
    while high > 4 * low:  # brackets found by growing factors are wide
        middle = mp.sqrt(low * high)
        f = at(middle)
        low, f_low, high, f_high = (middle, f, high, f_high) if f <= 0 else (low, f_low, middle, f)
    return root(at, low, f_low, high, f_high, mp.mpf(10) ** -digits)


def root(at: Any, low: Any, f_low: Any, high: Any, f_high: Any, tolerance: Any) -> Any:
    """Regula falsi with the Illinois weights, a halving wherever it dawdles."""
    side = 0
    for turn in range(400):
        if f_low == 0 or high - low <= tolerance * high:
            return low
        infinite = f_high - f_low == f_high.context.inf if hasattr(f_high, "context") else False
        t = (low + high) / 2 if turn % 3 == 2 or infinite else (low * f_high - high * f_low) / (f_high - f_low)
        if not low < t < high:
            t = (low + high) / 2
        f = at(t)
        if f == 0:
            return t
        if f < 0:
            low, f_low = t, f
            f_high = f_high / 2 if side < 0 else f_high
            side = -1
        else:
            high, f_high = t, f
            f_low = f_low / 2 if side > 0 else f_low
            side = 1
    return low


@dataclass(frozen=True)
class _Found:
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

    def run(self) -> _Found:
        mp = self.mp
        length = mp.sqrt(sum(c * c for c in self.target))
        ahead = [c / length for c in self.target]
        hint = _reach(self.slice, ahead, mp.mpf(1), digits=3)
        if hint is None:
            raise NoReference("the origin is not inside K")
        if len(ahead) == 1:
            return self._ended(_Along(self, ahead, ahead).seen(mp.mpf(0), hint, self.mp.dps - 5))
        line = _Along(self, ahead, [-ahead[1], ahead[0]])
        first = line.seen(mp.mpf(0), hint)
        if first.side == 0:
            return self._ended(line.seen(mp.mpf(0), first.reach, mp.dps - 5))
        way, near, far = first.side, first, None
        low, high = mp.mpf(0), mp.pi
        for turn in range(4 * self.digits + 40):
            if turn == _FIRST_TRY or (turn > _FIRST_TRY and (turn - _FIRST_TRY) % _EVERY == 0):
                found = self._tried(near, far)
                if found is not None:
                    return found
            middle = (low + high) / 2
            seen = line.seen(way * middle, (far or near).reach)
            if seen.faces and seen.side == 0:
                return self._ended(line.seen(way * middle, seen.reach, mp.dps - 5))
            if seen.faces and seen.side == way:
                low, near = middle, seen
            else:
                high, far = middle, seen
        ended = line.seen(way * low, near.reach, mp.dps - 5)
        return self._ended(ended, *([] if far is None else [far.normal]))

    def pull(self, w: Vector) -> Vector:
        """M (target - w)."""
        off = [t - c for t, c in zip(self.target, w, strict=True)]
        return [sum(m * c for m, c in zip(row, off, strict=True)) for row in self.metric]

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
        multiplier = sum(a * b for a, b in zip(normal, pull, strict=True)) / sum(a * a for a in normal)
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
        return self._checked(w, [normal], [multiplier])

    def _corner(self, near: _Seen, far: _Seen) -> _Found | None:
        """Where the pieces of two boundary points meet."""
        mp, w = self.mp, list(near.w)
        for _ in range(_NEWTON):
            levels = [self.slice.read(w, s.choices).value for s in (near, far)]
            normals = [self.slice.gradient(w, s.choices) for s in (near, far)]
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
        return self._checked(w, normals, shares)

    def _checked(self, w: Vector, normals: list[Vector], shares: Vector) -> _Found | None:
        """The point with its residual, if it is as good as asked for."""
        residual = self._residual(w, normals, shares)
        return _Found(w, sum(shares), residual) if residual <= self.fine else None

    def _residual(self, w: Vector, normals: list[Vector], shares: Vector) -> Any:
        mp, pull = self.mp, self.pull(w)
        if any(mp.isnan(c) for c in [*w, *shares]):
            return mp.inf
        level = abs(self.slice.read(w).value)
        scale = max(sum(abs(a * b) for a, b in zip(n, w, strict=True)) for n in normals)
        left = [c - sum(s * n[i] for s, n in zip(shares, normals, strict=True)) for i, c in enumerate(pull)]
        off = mp.sqrt(sum(c * c for c in left)) / mp.sqrt(sum(c * c for c in pull))
        negative = max([mp.mpf(0), *(-s for s in shares)]) / max(abs(s) for s in shares)
        return max(level / scale, off, negative) if scale > 0 else mp.inf

    def _ended(self, seen: _Seen, *others: Vector) -> _Found:
        """The best that the search gives, with the residual it has: the normal cone is spanned by one or two normals."""
        mp, pull = self.mp, self.pull(seen.w)
        share = sum(a * b for a, b in zip(seen.normal, pull, strict=True)) / sum(a * a for a in seen.normal)
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


@dataclass(frozen=True)
class _Along:
    """The boundary by the angle from ``ahead`` towards ``left``."""

    search: _Search
    ahead: Vector
    left: Vector

    def seen(self, angle: Any, hint: Any, digits: int | None = None) -> _Seen:
        search, mp = self.search, self.search.mp
        cos, sin = mp.cos(angle), mp.sin(angle)
        direction = [cos * a + sin * b for a, b in zip(self.ahead, self.left, strict=True)]
        reach = _reach(search.slice, direction, hint, search.digits + 20 if digits is None else digits)
        w = [reach * c for c in direction]
        choices = search.slice.read(w).choices
        normal = search.slice.gradient(w, choices)
        faces = sum((t - c) * n for t, c, n in zip(search.target, w, normal, strict=True)) > 0
        if len(w) == 1:
            return _Seen(w, choices, normal, reach, 0, faces)
        pull = search.pull(w)
        return _Seen(w, choices, normal, reach, int(mp.sign(normal[0] * pull[1] - normal[1] * pull[0])), faces)
