"""Gauges and their polars, the calculus behind the dissipation potential.

A gauge is convex, non-negative and positively homogeneous of degree 1; its polar is the support function of its unit
ball, polar(d) = sup { x . d : gauge(x) <= 1 }.  Every :data:`Gauge` knows its ``value`` at x; for d != 0 its ``polar`` and a point of the
unit ball that attains the supremum (``maximiser``); the linear forms of d that vanish where the polar is finite (``domain``); and the
theorems used, in order (``steps``).
Reference throughout: R. T. Rockafellar, Convex Analysis, Princeton 1970.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import sympy as sp

from duhem.expression.build import greatest
from duhem.expression.vocabulary import Neg, Norm, Pos, Where

__all__ = ["Gauge", "Holder", "Polytope", "Quadratic", "Separable", "Side", "sign_of"]

Exprs = tuple[sp.Expr, ...]

Coordinates = Mapping[Exprs, sp.Expr]  # of each row: what stands for it in x, or in d


@dataclass(frozen=True)
class Side:
    """One coordinate y = row . x - offset: up * pos(y) + down * neg(y), up and down > 0; its unit ball is [-1/down, 1/up]."""

    up: sp.Expr
    down: sp.Expr
    row: Exprs
    offset: sp.Expr

    @property
    def symmetric(self) -> bool:
        return self.up == self.down

    @property
    def sides(self) -> tuple[Side, ...]:
        return (self,)

    def scaled(self, factor: sp.Expr) -> Side:
        return replace(self, up=self.up * factor, down=self.down * factor)

    def value(self, y: Coordinates) -> sp.Expr:
        return _two_sided(y[self.row], self.up, self.down)

    def polar(self, c: Coordinates) -> sp.Expr:
        return _two_sided(c[self.row], 1 / self.up, 1 / self.down)

    def maximiser(self, c: Coordinates) -> Exprs:
        return (Where(c[self.row] >= 0, 1 / self.up, -1 / self.down),)

    def weighted_maximiser(self, c: Coordinates, q: sp.Expr) -> Exprs:
        """polar**(q - 1) times the maximiser, without the sign of c."""
        along = c[self.row]
        if self.symmetric and q == 2:
            return (along / self.up**2,)
        less = sp.cancel(q - 1)
        return (Pos(along) ** less / self.up**q - Neg(along) ** less / self.down**q,)

    @property
    def steps(self) -> tuple[str, ...]:
        return ("support function of an interval: sup {y c : -b <= y <= a} = a pos(c) + b neg(c) (Rockafellar 1970, section 13)",)


@dataclass(frozen=True)
class Holder:
    """The p-norm of gauges of separate coordinates, 1 <= p <= oo."""

    p: sp.Expr
    parts: tuple[Side | Holder, ...]

    @property
    def sides(self) -> tuple[Side, ...]:
        """Its coordinates, in order."""
        return tuple(side for part in self.parts for side in part.sides)

    def scaled(self, factor: sp.Expr) -> Holder:
        """``factor`` times the gauge."""
        return Holder(self.p, tuple(part.scaled(factor) for part in self.parts))

    @property
    def q(self) -> sp.Expr:
        """The conjugate exponent, 1/p + 1/q = 1."""
        if self.p == 1:
            return sp.oo
        return sp.S.One if self.p is sp.oo else sp.cancel(self.p / (self.p - 1))

    def value(self, y: Coordinates) -> sp.Expr:
        return _power_norm(self.p, [_unsigned(part, part.value(y), y, self.p, False) for part in self.parts])

    def polar(self, c: Coordinates) -> sp.Expr:
        return _power_norm(self.q, [_unsigned(part, part.polar(c), c, self.q, True) for part in self.parts])

    def maximiser(self, c: Coordinates) -> Exprs:
        q, points = self.q, [part.maximiser(c) for part in self.parts]
        if q == 1:
            return tuple(y for point in points for y in point)
        sizes = [part.polar(c) for part in self.parts]
        if q is sp.oo:
            marks = [[sp.S.One if i == j else sp.S.Zero for j in range(len(sizes))] for i in range(len(sizes))]
            most = greatest(*sizes)
            return tuple(_at_greatest(most, sizes, mark) * y for mark, point in zip(marks, points, strict=True) for y in point)
        total = self.polar(c) if q == 2 else sp.Add(*[s**q for s in sizes]) ** sp.cancel((q - 1) / q)
        found: list[sp.Expr] = []
        for size, part, point in zip(sizes, self.parts, points, strict=True):
            raised = size ** sp.cancel(q - 1)
            weighted = part.weighted_maximiser(c, q) if isinstance(part, Side) else tuple(raised * y for y in point)
            found += [y / total for y in weighted]
        return tuple(found)

    @property
    def steps(self) -> tuple[str, ...]:
        inner = tuple(dict.fromkeys(step for part in self.parts for step in part.steps))
        if self.p == 2:
            rule = "the Euclidean norm of gauges of separate variables has as polar the Euclidean norm of their polars (Cauchy-Schwarz"
        elif self.p == 1:
            rule = "a sum of gauges of separate variables has as polar the greatest of their polars (Hoelder"
        elif self.p is sp.oo:
            rule = "the greatest of gauges of separate variables has as polar the sum of their polars (Hoelder"
        else:
            rule = (
                f"the p-norm of gauges of separate variables has as polar the q-norm of their polars, p = {self.p}, q = {self.q} (Hoelder"
            )
        return (*inner, f"{rule}; Rockafellar 1970, Theorem 15.3 and its Corollary 15.3.1)")


@dataclass(frozen=True)
class Separable:
    """A tree of coordinates with linearly independent rows, without their offsets; a direction all rows ignore leaves it unchanged."""

    tree: Side | Holder

    @property
    def rows(self) -> sp.ImmutableMatrix:
        """Of its coordinates."""
        return sp.ImmutableMatrix([list(side.row) for side in self.tree.sides])

    def _named(self, entries: sp.Matrix) -> Coordinates:
        return dict(zip((side.row for side in self.tree.sides), entries, strict=True))

    def value(self, x: Sequence[sp.Expr]) -> sp.Expr:
        return self.tree.value(self._named(self.rows * sp.Matrix(list(x))))

    def _coordinates(self, d: Sequence[sp.Expr]) -> Coordinates:
        return self._named(_right_inverse(self.rows).T * sp.Matrix(list(d)))

    def polar(self, d: Sequence[sp.Expr]) -> sp.Expr:
        return self.tree.polar(self._coordinates(d))

    def maximiser(self, d: Sequence[sp.Expr]) -> Exprs:
        return tuple(_right_inverse(self.rows) * sp.Matrix(self.tree.maximiser(self._coordinates(d))))

    def domain(self, d: Sequence[sp.Expr]) -> Exprs:
        return _null_forms(self.rows, d)

    @property
    def steps(self) -> tuple[str, ...]:
        if self.rows.rows == self.rows.cols and self.rows.is_diagonal():
            return self.tree.steps
        change = (
            "change of variables y = L x: the polar at d = L^T c is the polar of the inner gauge at c (Rockafellar 1970, Corollary 16.3.1)"
        )
        return (*self.tree.steps, change, *_invariance(self.rows))


@dataclass(frozen=True)
class Quadratic:
    """sqrt(x . A x) with A symmetric and positive semidefinite."""

    matrix: sp.ImmutableMatrix

    def value(self, x: Sequence[sp.Expr]) -> sp.Expr:
        return _root_form(self.matrix, x)

    def inverse(self) -> sp.Matrix:
        """A generalised inverse, diagonal where the freedom left by the domain allows it."""
        if sp.cancel(self.matrix.det()) != 0:
            return self.matrix.inv().applyfunc(sp.cancel)
        inverse = sp.Matrix(self.matrix.pinv()).applyfunc(sp.cancel)
        null = self.matrix.nullspace()
        if len(null) != 1:
            return inverse
        n = sp.Matrix(null[0])
        pairs = [(i, j) for i, j in combinations(range(n.rows), 2) if n[i] * n[j] != 0]
        if not pairs:
            return inverse
        i, j = pairs[0]
        sparse = (inverse - inverse[i, j] / (n[i] * n[j]) * n * n.T).applyfunc(sp.cancel)
        return sparse if sparse.is_diagonal() else inverse

    def polar(self, d: Sequence[sp.Expr]) -> sp.Expr:
        return _root_form(self.inverse(), d)

    def maximiser(self, d: Sequence[sp.Expr]) -> Exprs:
        column = sp.Matrix(list(d))
        return tuple(y / self.polar(d) for y in self.inverse() * column)

    def domain(self, d: Sequence[sp.Expr]) -> Exprs:
        return _null_forms(self.matrix, d)

    @property
    def steps(self) -> tuple[str, ...]:
        rule = "sqrt(x . A x), A positive semidefinite, has as polar sqrt(d . A^+ d) for d in the range of A (Rockafellar 1970, section 12)"
        return (rule, *_invariance(self.matrix))


@dataclass(frozen=True)
class Polytope:
    """max of numeric linear forms; the unit ball, up to the directions all forms ignore, is the hull of ``vertices``."""

    rows: sp.ImmutableMatrix
    vertices: tuple[Exprs, ...]

    @classmethod
    def of(cls, rows: sp.Matrix, most: int = 400) -> Polytope | None:
        """From the forms; None where the ball is unbounded in a direction some form sees, or there is too much to list."""
        kept = rows.rref()[1]
        if len(rows.nullspace()) > 1 or sp.binomial(rows.rows, len(kept)) > most:
            return None
        plane = rows[:, list(kept)]  # moving along the ignored direction sets the other coordinate to zero
        if _recedes(plane):
            return None
        found: dict[Exprs, None] = {}
        for chosen in combinations(range(rows.rows), len(kept)):
            square = plane[list(chosen), :]
            if sign_of(square.det()) == 0:
                continue
            point = square.LUsolve(sp.ones(len(kept), 1)).applyfunc(sp.radsimp)
            if all(sign_of(v - 1) <= 0 for v in plane * point):
                full = sp.zeros(rows.cols, 1)
                for place, v in zip(kept, point, strict=True):
                    full[place] = v
                found[_sparsest(full, rows.nullspace())] = None
        return cls(sp.ImmutableMatrix(rows), tuple(found))

    def value(self, x: Sequence[sp.Expr]) -> sp.Expr:
        return _greatest(list(self.rows * sp.Matrix(list(x))))

    def polar(self, d: Sequence[sp.Expr]) -> sp.Expr:
        return _greatest(self._products(d))

    def _products(self, d: Sequence[sp.Expr]) -> list[sp.Expr]:
        return [sp.Add(*[v * c for v, c in zip(vertex, d, strict=True)]) for vertex in self.vertices]

    def maximiser(self, d: Sequence[sp.Expr]) -> Exprs:
        products = self._products(d)
        most = greatest(*products)
        return tuple(_at_greatest(most, products, column) for column in zip(*self.vertices, strict=True))

    def domain(self, d: Sequence[sp.Expr]) -> Exprs:
        return _null_forms(self.rows, d)

    @property
    def steps(self) -> tuple[str, ...]:
        rule = f"a linear form is greatest over a polytope at one of its {len(self.vertices)} vertices (Rockafellar 1970, Corollary 32.3.4)"
        return (rule, *_invariance(self.rows))


Gauge = Separable | Quadratic | Polytope


def sign_of(number: sp.Expr) -> int:
    """Sign of an exact real number: by 30 digits where they decide, else by simplification to zero."""
    value = sp.N(number, 30)
    if abs(value) > sp.Float("1e-20"):
        return 1 if value > 0 else -1
    if sp.simplify(number) != 0:
        raise ArithmeticError(f"the sign of {number} is not decided")
    return 0


def _two_sided(y: sp.Expr, up: sp.Expr, down: sp.Expr) -> sp.Expr:
    return up * sp.Abs(y) if up == down else up * Pos(y) + down * Neg(y)


def _unsigned(part: Side | Holder, size: sp.Expr, y: Coordinates, p: sp.Expr, polar: bool) -> sp.Expr:
    """``size``, or where the norm does not see the sign the shorter signed form."""
    if isinstance(part, Side) and part.symmetric and p == 2:
        return y[part.row] / part.up if polar else y[part.row] * part.up
    return size


def _power_norm(p: sp.Expr, sizes: list[sp.Expr]) -> sp.Expr:
    if p == 1:
        return sp.Add(*sizes)
    if p is sp.oo:
        return greatest(*sizes)
    return Norm(*sizes) if p == 2 else sp.Add(*[s**p for s in sizes]) ** sp.cancel(1 / p)


def _at_greatest(most: sp.Expr, sizes: Sequence[sp.Expr], values: Sequence[sp.Expr]) -> sp.Expr:
    """The value that belongs to the first of ``sizes`` that is the greatest, ``most``."""
    chosen = values[-1]
    for size, value in zip(reversed(sizes[:-1]), reversed(values[:-1]), strict=True):
        chosen = Where(size >= most, value, chosen)
    return chosen


def _greatest(forms: Sequence[sp.Expr]) -> sp.Expr:
    """max of the forms, opposite ones joined into an absolute value."""
    left, terms = list(dict.fromkeys(sp.expand(f) for f in forms)), []
    while left:
        form = left.pop(0)
        opposite = sp.expand(-form)
        if opposite in left:
            left.remove(opposite)
            form = sp.Abs(form)
        terms.append(form)
    return greatest(*terms)


def _root_form(matrix: sp.Matrix, x: Sequence[sp.Expr]) -> sp.Expr:
    if matrix.is_diagonal():
        weights = [sp.sqrt(matrix[i, i]) for i in range(matrix.rows)]
        if len(set(weights)) == 1:
            return weights[0] * Norm(*x)
        return Norm(*[w * v for w, v in zip(weights, x, strict=True)])
    column = sp.Matrix(list(x))
    return sp.sqrt(sp.expand((column.T * matrix * column)[0]))


def _right_inverse(rows: sp.Matrix) -> sp.Matrix:
    if rows.is_diagonal() and rows.rows == rows.cols:
        return sp.diag(*[1 / rows[i, i] for i in range(rows.rows)])
    return (rows.T * (rows * rows.T).inv()).applyfunc(sp.cancel)


def _null_forms(rows: sp.Matrix, d: Sequence[sp.Expr]) -> Exprs:
    column = sp.Matrix(list(d))
    return tuple((vector.T * column)[0] for vector in rows.nullspace())


def _invariance(rows: sp.Matrix) -> tuple[str, ...]:
    if not rows.nullspace():
        return ()
    return ("K is invariant along the null directions of the forms, so the supremum is infinite unless d is orthogonal to them "
            "(Rockafellar 1970, Corollary 13.3.4)",)  # fmt: skip


def _recedes(rows: sp.Matrix) -> bool:
    """Whether a nonzero v has rows v <= 0; the rows have full column rank, so extreme v annul all but one dimension of them."""
    for chosen in combinations(range(rows.rows), rows.cols - 1):
        null = rows[list(chosen), :].nullspace() if chosen else [sp.ones(1, 1)]
        if len(null) != 1:
            continue
        signs = {sign_of(sp.radsimp(v)) for v in rows * null[0]}
        if not {1, -1} <= signs:
            return True
    return False


def _sparsest(point: sp.Matrix, null: Sequence[sp.Matrix]) -> Exprs:
    """The representative of ``point`` along the ignored direction that has the most zeros."""
    if not null:
        return tuple(point)
    n = sp.Matrix(null[0])
    moved = [point - point[i] / n[i] * n for i in range(n.rows) if n[i] != 0]
    return tuple(max((p.applyfunc(sp.radsimp) for p in moved), key=lambda p: sum(v == 0 for v in p)))
