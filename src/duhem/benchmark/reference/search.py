"""The closest point in the plane: bisection along the boundary that faces the target, Newton's method for the last digits.

As seen from a point inside K, the boundary that faces the target is searched by bisection on the angle: there the distance in
the metric is strictly convex along the boundary (for a boundary r(s) with outward normal n and curvature >= 0,
(|x - r|^2/2)'' = 1 + curvature (x - r).n >= 1 where (x - r).n >= 0), so one sign tells on which side the closest point lies,
whatever the aspect of K and of the metric, and at corners alike.  Newton's method is tried from time to time, on the piece of
g that holds or where two pieces meet, and believed only if the optimality conditions then hold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from duhem.benchmark.reference.formula import Choices, NoReference, Slice, steep
from duhem.benchmark.reference.ray import reach

__all__ = ["Found", "Search"]

_FIRST_TRY, _EVERY = 6, 8  # bisections before and between the tries of Newton's method
_NEWTON = 14

Vector = list[Any]


@dataclass(frozen=True)
class Found:
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


class Search:
    """The closest point in coordinates of size 1, in the metric ``metric`` (m, m), to ``target`` (m,)."""

    def __init__(self, slice_: Slice, metric: list[Vector], target: Vector, digits: int) -> None:
        self.slice, self.metric, self.target, self.digits = slice_, metric, target, digits
        self.mp = slice_.formula.context
        self.fine = self.mp.mpf(10) ** -(digits + 2)

    def run(self) -> Found:
        mp = self.mp
        length = mp.sqrt(sum(c * c for c in self.target))
        ahead = [c / length for c in self.target]
        hint = reach(self.slice, ahead, mp.mpf(1), digits=3)
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

    def _tried(self, near: _Seen, far: _Seen | None) -> Found | None:
        both = [near] if far is None else [near, far]
        for seen in both:
            found = self._newton(seen)
            if found is not None:
                return found
        if far is not None and far.choices != near.choices:
            return self._corner(near, far)
        return None

    def _newton(self, start: _Seen) -> Found | None:
        mp, m = self.mp, len(start.w)
        w, choices = list(start.w), start.choices
        normal, pull = start.normal, self.pull(start.w)
        multiplier = sum(a * b for a, b in zip(normal, pull, strict=True)) / steep(normal, mp.dps)
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

    def _corner(self, near: _Seen, far: _Seen) -> Found | None:
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

    def _checked(self, w: Vector, normals: list[Vector], shares: Vector, pieces: Sequence[Choices]) -> Found | None:
        """The point with its residual, if it is as good as asked for and the pieces hold there."""
        residual = self._residual(w, normals, shares)
        return Found(w, sum(shares), residual) if residual <= self.fine and self._hold(w, pieces) else None

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
        length, most = mp.sqrt(sum(c * c for c in pull)), max(abs(s) for s in shares)
        if length == 0 or most == 0:
            return mp.inf
        off = mp.sqrt(sum(c * c for c in left)) / length
        negative = max([mp.mpf(0), *(-s for s in shares)]) / most
        return max(level / scale, off, negative) if scale > 0 else mp.inf

    def _ended(self, seen: _Seen, *others: Vector) -> Found:
        """The best that the search gives, with the residual it has: the normal cone is spanned by one or two normals."""
        mp, pull = self.mp, self.pull(seen.w)
        share = sum(a * b for a, b in zip(seen.normal, pull, strict=True)) / steep(seen.normal, mp.dps)
        best = Found(seen.w, share, self._residual(seen.w, [seen.normal], [share]))
        for other in others:
            try:
                shares = list(mp.lu_solve(mp.matrix([seen.normal, other]).T, mp.matrix(pull)))
            except ZeroDivisionError:
                continue
            residual = self._residual(seen.w, [seen.normal, other], shares)
            if residual < best.residual:
                best = Found(seen.w, sum(shares), residual)
        return best


@dataclass(frozen=True)
class _Along:
    """The boundary by the angle from ``ahead`` towards ``left``."""

    search: Search
    ahead: Vector
    left: Vector

    def seen(self, angle: Any, hint: Any, digits: int | None = None) -> _Seen:
        search, mp = self.search, self.search.mp
        cos, sin = mp.cos(angle), mp.sin(angle)
        direction = [cos * a + sin * b for a, b in zip(self.ahead, self.left, strict=True)]
        length = reach(search.slice, direction, hint, search.digits + 20 if digits is None else digits)
        w = [length * c for c in direction]
        choices = search.slice.read(w).choices
        normal = search.slice.gradient(w, choices)
        faces = sum((t - c) * n for t, c, n in zip(search.target, w, normal, strict=True)) > 0
        if len(w) == 1:
            return _Seen(w, choices, normal, length, 0, faces)
        pull = search.pull(w)
        return _Seen(w, choices, normal, length, int(mp.sign(normal[0] * pull[1] - normal[1] * pull[0])), faces)
