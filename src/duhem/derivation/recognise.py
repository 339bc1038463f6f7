"""From a formula to a ball: g <= 0 rewritten as gauge(sigma - centre) <= radius.

The reading is by rules on the SymPy tree, never by the name of a law: constants move to the right, increasing outer
maps are undone (roots, powers, norms), what is left is read as a p-norm of one-dimensional gauges of linear forms,
a quadratic form, or a maximum of linear forms.  What no rule reads is given up: the answer is None.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import sympy as sp

from duhem.derivation.gauge import Gauge, Holder, Polytope, Quadratic, Separable, Side
from duhem.expression.branches import TooManyBranchesError, branches
from duhem.expression.vocabulary import Neg, Norm, Pos, Where

__all__ = ["Ball", "read_ball"]

_KINKED = (sp.Abs, Pos, Neg, sp.Max, sp.Min, Norm, Where)


@dataclass(frozen=True)
class Ball:
    """{x : gauge(x - centre) <= radius}, true wherever every expression of ``requires`` is positive."""

    gauge: Gauge
    centre: tuple[sp.Expr, ...]
    radius: sp.Expr
    requires: tuple[sp.Expr, ...]


class _UnreadError(Exception):
    """No rule reads the formula."""


@dataclass(frozen=True)
class _Leaf:
    """The gauge ``side`` of row . x - offset."""

    side: Side
    row: tuple[sp.Expr, ...]
    offset: sp.Expr


@dataclass(frozen=True)
class _Node:
    """The p-norm of its parts."""

    p: sp.Expr
    parts: tuple[_Leaf | _Node, ...]


@dataclass(frozen=True)
class _Form:
    """sqrt((x - centre) . matrix (x - centre)) for a form that is not diagonal."""

    matrix: sp.ImmutableMatrix
    centre: tuple[sp.Expr, ...]


_Tree = _Leaf | _Node | _Form


def read_ball(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Ball | None:
    """The ball {g <= 0} in the space of ``forces``, or None where no rule reads it."""
    reader = _Reader(tuple(forces))
    try:
        tree, radius = reader.sublevel(g, sp.S.Zero)
        gauge, centre, radius = reader.assemble(tree, radius)
    except (_UnreadError, TooManyBranchesError, sp.PolynomialError, ArithmeticError, ValueError):
        return None
    unknown = dict.fromkeys(sp.factor_terms(r) for r in [*reader.requires, radius] if not r.is_positive)
    if any(r.is_nonpositive for r in unknown):
        return None
    return Ball(gauge, centre, radius, tuple(unknown))


class _Reader:
    """One reading; ``requires`` collects the expressions that have to be positive for it to hold."""

    def __init__(self, forces: tuple[sp.Symbol, ...]) -> None:
        self.forces = forces
        self.requires: list[sp.Expr] = []

    # -- the inequality ---------------------------------------------------------------------------------------

    def sublevel(self, a: sp.Expr, bound: sp.Expr) -> tuple[_Tree, sp.Expr]:
        """(tree, radius) with {a <= bound} = {tree <= radius}."""
        bound, a = self._to_the_right(a, bound)
        if isinstance(a, sp.Max):
            return self._intersection(self._arms(a, bound))
        if isinstance(a, Norm):
            return self._raised(sp.Add(*[x**2 for x in a.args]), bound, sp.Integer(2))
        if isinstance(a, sp.Pow) and not a.exp.has(*self.forces) and not self._is_polynomial(a):
            self._positive(a.exp)
            return self._raised(a.base, bound, 1 / a.exp)
        try:
            tree, p, offset = self.power(a)
        except _UnreadError:
            if len(self._present(a)) != 1:
                raise
            return self._intersection(self._arms_of_branches(a, bound))
        return tree, self._root(bound - offset, p)

    def _to_the_right(self, a: sp.Expr, bound: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
        while True:
            constant, a = a.as_independent(*self.forces, as_Add=True)
            bound -= constant
            factor, rest = a.as_independent(*self.forces, as_Add=False)
            if factor.is_negative and isinstance(rest, sp.Min):
                factor, rest = -factor, sp.Max(*[-x for x in rest.args])
            if factor == 1 or rest.is_Add and self._is_polynomial(rest):
                if constant == 0 or not a.is_Add:
                    return bound, factor * rest
                return bound, a
            self._positive(factor)
            bound, a = bound / factor, rest

    def _raised(self, a: sp.Expr, bound: sp.Expr, power: sp.Expr) -> tuple[_Tree, sp.Expr]:
        """{a**(1/power) <= bound} for a >= 0: both sides are not negative, so the power may be taken."""
        self._positive(bound)
        tree, radius = self.sublevel(a, bound**power)
        return tree, sp.powdenest(radius)

    def _arms(self, a: sp.Expr, bound: sp.Expr) -> list[tuple[sp.Expr, sp.Expr]]:
        """{max(...) <= bound} as a list of inequalities a_i <= b_i, absolute values of linear forms split in two."""
        found: list[tuple[sp.Expr, sp.Expr]] = []
        for arm in a.args if isinstance(a, sp.Max) else (a,):
            limit, left = self._to_the_right(arm, bound)
            if isinstance(left, sp.Max):
                found += self._arms(left, limit)
            elif isinstance(left, sp.Abs) and self._is_affine(left.args[0]):
                for side in (left.args[0], -left.args[0]):
                    high, form = self._to_the_right(side, limit)
                    found.append((form, high))
            else:
                found.append((left, limit))
        return found

    def _arms_of_branches(self, a: sp.Expr, bound: sp.Expr) -> list[tuple[sp.Expr, sp.Expr]]:
        raise _UnreadError

    def _intersection(self, arms: list[tuple[sp.Expr, sp.Expr]]) -> tuple[_Tree, sp.Expr]:
        if all(self._is_affine(left) for left, _ in arms):
            return self._polyhedron(arms)
        balls = [self.sublevel(left, limit) for left, limit in self._paired(arms)]
        trees = list(dict.fromkeys(tree for tree, _ in balls))
        if len(trees) == 1:
            return trees[0], sp.Min(*[radius for _, radius in balls])
        if any(isinstance(tree, _Form) for tree in trees) or len(trees) < len(balls):
            raise _UnreadError
        for _, radius in balls:
            self._positive(radius)
        parts = tuple(_scaled(tree, 1 / radius) for tree, radius in balls if not isinstance(tree, _Form))
        return _Node(sp.oo, parts), sp.S.One

    def _paired(self, arms: list[tuple[sp.Expr, sp.Expr]]) -> list[tuple[sp.Expr, sp.Expr]]:
        """Opposite linear arms with the same bound joined again into an absolute value."""
        left, found = list(arms), []
        while left:
            form, limit = left.pop(0)
            if self._is_affine(form):
                if (-form, limit) not in left:
                    raise _UnreadError
                left.remove((-form, limit))
                form = sp.Abs(form)
            found.append((form, limit))
        return found

    def _polyhedron(self, arms: list[tuple[sp.Expr, sp.Expr]]) -> tuple[_Tree, sp.Expr]:
        """Linear forms bounded above: a box where they pair up along independent directions, else a polytope."""
        sides: dict[tuple[sp.Expr, ...], dict[int, list[sp.Expr]]] = {}
        for left, limit in arms:
            row, constant = self._affine(left)
            scale, sign = self._leading(row)
            direction = tuple(sp.cancel(sign * c / scale) for c in row)
            sides.setdefault(direction, {1: [], -1: []})[sign].append((limit - constant) / scale)
        for side in sides.values():
            for limits in side.values():
                for limit in limits:
                    self._positive(limit)
        rows = sp.Matrix([list(direction) for direction in sides])
        if all(side[1] and side[-1] for side in sides.values()) and _independent(rows):
            leaves = [_Leaf(Side(1 / sp.Min(*side[1]), 1 / sp.Min(*side[-1])), row, sp.S.Zero) for row, side in sides.items()]
            if len(leaves) == 1 and leaves[0].side.symmetric:
                return _Leaf(Side(sp.S.One, sp.S.One), leaves[0].row, sp.S.Zero), 1 / leaves[0].side.up
            radii = {w for leaf in leaves for w in (leaf.side.up, leaf.side.down)}
            if len(radii) == 1:
                unit = Side(sp.S.One, sp.S.One)
                return _Node(sp.oo, tuple(_Leaf(unit, leaf.row, sp.S.Zero) for leaf in leaves)), 1 / radii.pop()
            return (leaves[0] if len(leaves) == 1 else _Node(sp.oo, tuple(leaves))), sp.S.One
        raise _PolytopeFound(rows=[(tuple(sign * c for c in row), limit) for row, side in sides.items() for sign in (1, -1) for limit in side[sign]])

    # -- one expression as a power of a gauge -------------------------------------------------------------------

    def power(self, a: sp.Expr) -> tuple[_Tree, sp.Expr, sp.Expr]:
        """(tree, p, offset) with a = tree**p + offset."""
        factor, rest = a.as_independent(*self.forces, as_Add=False)
        if factor != 1 and not (rest.is_Add and self._is_polynomial(rest)):
            self._positive(factor)
            tree, p, offset = self.power(rest)
            return self._multiplied(tree, factor ** (1 / p)), p, factor * offset
        if isinstance(a, sp.Abs):
            if self._is_affine(a.args[0]):
                return self._leaf(a.args[0]), sp.S.One, sp.S.Zero
            return self._one_sided(a)
        if isinstance(a, Norm):
            return _Node(sp.Integer(2), tuple(self._member(x) for x in a.args)), sp.S.One, sp.S.Zero
        if isinstance(a, sp.Max):
            try:
                return self._one_sided(a)
            except _UnreadError:
                return _Node(sp.oo, tuple(self._member(x) for x in a.args)), sp.S.One, sp.S.Zero
        if self._is_polynomial(a) and sp.Poly(a, *self.forces).total_degree() == 2:
            return self._quadratic(a)
        if isinstance(a, sp.Pow) and not a.exp.has(*self.forces):
            if a.exp.is_integer and a.exp.is_even and self._is_affine(a.base):
                return self._leaf(a.base), a.exp, sp.S.Zero
            tree, p, offset = self.power(a.base)
            if offset != 0:
                raise _UnreadError
            return tree, sp.cancel(p * a.exp), sp.S.Zero
        if len(self._present(a)) == 1 and a.has(*_KINKED):
            return self._one_sided(a)
        if a.is_Add:
            return self._sum(a)
        raise _UnreadError

    def _member(self, x: sp.Expr) -> _Leaf | _Node:
        """An argument of a norm: what counts is its absolute value."""
        if not x.has(*self.forces):
            raise _UnreadError
        tree, p, offset = self.power(x if x.is_nonnegative else sp.Abs(x))
        if p != 1 or offset != 0 or isinstance(tree, _Form):
            raise _UnreadError
        return tree

    def _sum(self, a: sp.Expr) -> tuple[_Tree, sp.Expr, sp.Expr]:
        """A sum: terms that share forces are read together where they can be, else one by one."""
        groups: list[list[sp.Expr]] = []
        for term in a.args:
            joined = [g for g in groups if any(self._present(term) & self._present(x) for x in g)]
            groups = [g for g in groups if g not in joined] + [[term, *(x for g in joined for x in g)]]
        if len(groups) > 1:
            read = [self.power(sp.Add(*group)) for group in sorted(groups, key=lambda g: min(map(self.forces.index, self._present(sp.Add(*g)))))]
        else:
            read = [self.power(term) for term in a.args]
        p = read[0][1]
        if any(sp.cancel(q - p) != 0 for _, q, _ in read) or any(isinstance(tree, _Form) for tree, _, _ in read):
            raise _UnreadError
        if p.is_number and p < 1:
            raise _UnreadError
        if p != 1:
            self._positive(p - 1)
        parts = [part for tree, _, _ in read for part in (tree.parts if isinstance(tree, _Node) and tree.p == p else (tree,))]
        return _Node(p, tuple(parts)), p, sp.Add(*[offset for _, _, offset in read])  # type: ignore[arg-type]

    def _one_sided(self, a: sp.Expr) -> tuple[_Tree, sp.Expr, sp.Expr]:
        """One kink, linear or a power on both sides of it: a one-dimensional gauge, from the one-sided branches."""
        found = branches(a, most=8)
        switches = {switch for branch in found for switch in branch.signs}
        if len(switches) != 1 or len(found) != 2:
            raise _UnreadError
        switch = switches.pop()
        row, constant = self._affine(switch)
        pivot = next(i for i, c in enumerate(row) if c != 0)
        t = sp.Dummy("t", positive=True)
        sides: dict[int, tuple[sp.Expr, sp.Expr, sp.Expr]] = {}
        for branch in found:
            sign = branch.signs[switch]
            away = self.forces[pivot] + (sign * t - switch) / row[pivot]
            along = sp.expand(sp.expand_power_base(branch.expr.subs(self.forces[pivot], sp.expand(away))))
            if along.has(*self.forces):
                raise _UnreadError
            offset, rest = along.as_independent(t, as_Add=True)
            weight, monomial = sp.powsimp(rest).as_independent(t, as_Add=False)
            base, p = monomial.as_base_exp()
            if base != t or p.has(t):
                raise _UnreadError
            sides[sign] = (weight, p, offset)
        (up, p, offset), (down, p_below, offset_below) = sides[1], sides[-1]
        if sp.cancel(p - p_below) != 0 or sp.cancel(offset - offset_below) != 0:
            raise _UnreadError
        side = Side(*(self._root(self._positive(w), p) for w in (up, down)))
        return self._normalised(_Leaf(side, row, -constant)), p, offset

    def _leaf(self, form: sp.Expr) -> _Leaf:
        row, constant = self._affine(form)
        return self._normalised(_Leaf(Side(sp.S.One, sp.S.One), row, -constant))

    def _normalised(self, leaf: _Leaf) -> _Leaf:
        """The leading coefficient of the row moved into the weights where its sign is known."""
        lead = next(c for c in leaf.row if c != 0)
        if lead == 1 or not (lead.is_positive or lead.is_negative):
            return leaf
        size = abs(lead)
        up, down = (leaf.side.up, leaf.side.down) if lead.is_positive else (leaf.side.down, leaf.side.up)
        side = Side(sp.cancel(up * size), sp.cancel(down * size)) if not leaf.side.symmetric else Side(*[sp.cancel(up * size)] * 2)
        return _Leaf(side, tuple(sp.cancel(c / lead) for c in leaf.row), sp.cancel(leaf.offset / lead))

    def _quadratic(self, a: sp.Expr) -> tuple[_Tree, sp.Expr, sp.Expr]:
        """The square completed: x . A x + b . x + c = (x - x0) . A (x - x0) + c - x0 . A x0."""
        poly, n = sp.Poly(a, *self.forces), len(self.forces)
        origin = dict.fromkeys(self.forces, 0)
        matrix = sp.ImmutableMatrix(sp.hessian(poly.as_expr(), self.forces) / 2).applyfunc(sp.cancel)
        slope = sp.Matrix([poly.as_expr().diff(f).subs(origin) for f in self.forces])
        constant = poly.as_expr().subs(origin)
        if matrix.is_diagonal():
            seen = [i for i in range(n) if matrix[i, i] != 0]
            if any(slope[i] != 0 for i in range(n) if i not in seen):
                raise _UnreadError
            leaves = []
            for i in seen:
                weight = self._root(self._positive(matrix[i, i]), sp.Integer(2))
                row = tuple(sp.S.One if j == i else sp.S.Zero for j in range(n))
                leaves.append(_Leaf(Side(weight, weight), row, -slope[i] / (2 * matrix[i, i])))
            constant -= sp.Add(*[slope[i] ** 2 / (4 * matrix[i, i]) for i in seen])
            return (leaves[0] if len(leaves) == 1 else _Node(sp.Integer(2), tuple(leaves))), sp.Integer(2), constant
        self._semidefinite(matrix)
        centre = -matrix.pinv() * slope / 2 if any(slope) else sp.zeros(n, 1)
        if any(sp.cancel(v) != 0 for v in 2 * matrix * centre + slope):
            raise _UnreadError
        constant -= (centre.T * matrix * centre)[0]
        return _Form(matrix, tuple(centre)), sp.Integer(2), sp.cancel(constant)

    def _semidefinite(self, matrix: sp.ImmutableMatrix) -> None:
        """Positive semidefinite: the leading minors of the rows that see something independent are positive (Sylvester)."""
        kept = list(matrix.rref(simplify=True)[1])
        block = matrix[kept, kept]
        for k in range(1, len(kept) + 1):
            self._positive(sp.cancel(block[:k, :k].det()))

    # -- putting the parts together -----------------------------------------------------------------------------

    def assemble(self, tree: _Tree, radius: sp.Expr) -> tuple[Gauge, tuple[sp.Expr, ...], sp.Expr]:
        if isinstance(tree, _Form):
            return Quadratic(tree.matrix), tree.centre, radius
        leaves = _leaves(tree)
        rows = sp.ImmutableMatrix([list(leaf.row) for leaf in leaves])
        offsets = sp.Matrix([leaf.offset for leaf in leaves])
        if _independent(rows):
            centre = (rows.T * (rows * rows.T).inv() * offsets).applyfunc(sp.cancel) if any(offsets) else sp.zeros(rows.cols, 1)
            return Separable(_tree_of(tree), rows), tuple(centre), radius
        flat = isinstance(tree, _Node) and all(isinstance(p, _Leaf) and p.side.symmetric and p.offset == 0 for p in tree.parts)
        if not flat or not isinstance(tree, _Node):
            raise _UnreadError
        if tree.p == 2:
            weights = sp.diag(*[leaf.side.up**2 for leaf in leaves])
            return Quadratic(sp.ImmutableMatrix(rows.T * weights * rows).applyfunc(sp.cancel)), (sp.S.Zero,) * rows.cols, radius
        if tree.p is sp.oo:
            weighted = [(tuple(sign * c for c in leaf.row), radius / leaf.side.up) for leaf in leaves for sign in (1, -1)]
            return self.polytope(weighted)
        if tree.p == 1:
            return self.polytope(_sums_of_signs(leaves, radius))
        raise _UnreadError

    def polytope(self, arms: list[tuple[tuple[sp.Expr, ...], sp.Expr]]) -> tuple[Gauge, tuple[sp.Expr, ...], sp.Expr]:
        """{row . x <= limit}: numeric up to one common positive factor, which becomes the radius."""
        radius = arms[0][1]
        rows = sp.Matrix([[sp.cancel(c * radius / limit) for c in row] for row, limit in arms])
        if any(not c.is_number for c in rows):
            raise _UnreadError
        ball = Polytope.of(rows)
        if ball is None:
            raise _UnreadError
        return ball, (sp.S.Zero,) * rows.cols, radius

    # -- small readings -----------------------------------------------------------------------------------------

    def _multiplied(self, tree: _Tree, factor: sp.Expr) -> _Tree:
        return _Form(tree.matrix * factor**2, tree.centre) if isinstance(tree, _Form) else _scaled(tree, factor)

    def _present(self, a: sp.Expr) -> set[sp.Symbol]:
        return a.free_symbols & set(self.forces)  # type: ignore[return-value]

    def _is_polynomial(self, a: sp.Expr) -> bool:
        return bool(a.is_polynomial(*self.forces))

    def _is_affine(self, a: sp.Expr) -> bool:
        return self._is_polynomial(a) and a.has(*self.forces) and sp.Poly(a, *self.forces).total_degree() == 1

    def _affine(self, a: sp.Expr) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
        if not self._is_affine(a):
            raise _UnreadError
        row = tuple(sp.cancel(sp.expand(a).coeff(f)) for f in self.forces)
        return row, sp.expand(a).subs(dict.fromkeys(self.forces, 0))

    def _leading(self, row: Sequence[sp.Expr]) -> tuple[sp.Expr, int]:
        lead = next(c for c in row if c != 0)
        if lead.is_positive or lead.is_negative:
            return abs(lead), 1 if lead.is_positive else -1
        raise _UnreadError

    def _positive(self, expr: sp.Expr) -> sp.Expr:
        if expr.is_nonpositive:
            raise _UnreadError
        if not expr.is_positive:
            self.requires.append(expr)
        return expr

    def _root(self, expr: sp.Expr, p: sp.Expr) -> sp.Expr:
        if p == 1:
            return expr
        return sp.powdenest(sp.factor_terms(expr) ** (1 / p))


class _PolytopeFound(Exception):
    pass


def _scaled(tree: _Leaf | _Node, factor: sp.Expr) -> _Leaf | _Node:
    if isinstance(tree, _Node):
        return _Node(tree.p, tuple(_scaled(part, factor) for part in tree.parts))
    return _Leaf(Side(tree.side.up * factor, tree.side.down * factor), tree.row, tree.offset)


def _leaves(tree: _Leaf | _Node) -> list[_Leaf]:
    return [tree] if isinstance(tree, _Leaf) else [leaf for part in tree.parts for leaf in _leaves(part)]


def _tree_of(tree: _Leaf | _Node) -> Side | Holder:
    return tree.side if isinstance(tree, _Leaf) else Holder(tree.p, tuple(_tree_of(part) for part in tree.parts))


def _independent(rows: sp.Matrix) -> bool:
    return rows.rows <= rows.cols and rows.rank() == rows.rows


def _sums_of_signs(leaves: list[_Leaf], radius: sp.Expr) -> list[tuple[tuple[sp.Expr, ...], sp.Expr]]:
    """A sum of absolute values as the greatest of its signed sums."""

    def grow(sums: list[list[sp.Expr]], leaf: _Leaf) -> list[list[sp.Expr]]:
        step = [leaf.side.up * c for c in leaf.row]
        return [[s + sign * v for s, v in zip(total, step, strict=True)] for total in sums for sign in (1, -1)]

    start: list[list[sp.Expr]] = [[sp.S.Zero] * len(leaves[0].row)]
    return [(tuple(row), radius) for row in reduce(grow, leaves, start) if any(row)]
