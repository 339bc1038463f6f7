"""From a formula to a ball: g <= 0 rewritten as gauge(sigma - centre) <= radius.

The reading is by rules on the SymPy tree, never by the name of a law: constants move to the right, increasing outer
maps are undone (roots, powers, norms), what is left is read as a p-norm of one-dimensional gauges of linear forms,
a quadratic form, or a maximum of linear forms.  What no rule reads is given up: the answer is None.

A formula is read into blocks, forms of the forces with weights, joined by norms, of which the gauge is made.  Factors of polynomials over
the rationals are FLINT's: SymPy's own search for them is by chance, and now and then takes minutes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import sympy as sp

from duhem.derivation.gauge import Gauge, Holder, Polytope, Quadratic, Separable, Side
from duhem.expression.branches import TooManyBranchesError, branches
from duhem.expression.vocabulary import KINKS, Norm

__all__ = ["Ball", "factor_list", "factored", "read_ball"]


def factor_list(poly: sp.Expr) -> tuple[sp.Rational, list[tuple[sp.Expr, int]]]:
    """A number and the irreducible factors with their powers, with the signs that ``sympy.factor_list`` gives them.

    Rational coefficients, since python-flint 0.9 takes whole ones for C integers when it sorts factors.
    """
    import flint

    form = sp.Poly(poly)
    if not (form.domain.is_ZZ or form.domain.is_QQ):
        number, found = sp.factor_list(poly)
        return number, found
    ring = flint.fmpq_mpoly_ctx.get([f"x{i}" for i in range(len(form.gens))], "lex")
    number, parts = ring.from_dict({m: flint.fmpq(c.p, c.q) for m, c in form.terms()}).factor()
    factors = [(sp.Poly({m: sp.Rational(int(c.p), int(c.q)) for m, c in f.to_dict().items()}, *form.gens), int(n)) for f, n in parts]
    factors.sort(key=lambda factor: (len(factor[0].rep.to_list()), factor[1], factor[0].rep.to_list()))
    return sp.Rational(int(number.p), int(number.q)), [(part.as_expr(), power) for part, power in factors]


def factored(expr: sp.Expr) -> sp.Expr:
    """The expression as a product, quotients put together, where it is a quotient of polynomials in symbols > 0 and roots of them."""
    powers = [p for p in expr.atoms(sp.Pow) if p.base.is_Symbol and p.base.is_positive and p.exp.is_Rational]
    roots = {s: sp.Dummy(s.name, positive=True) for p in powers if (s := p.base)}
    share = {s: sp.ilcm(*(p.exp.q for p in powers if p.base == s), 1) for s in roots}
    whole = {p: roots[p.base] ** (p.exp * share[p.base]) for p in powers} | {s: root ** share[s] for s, root in roots.items()}
    above, below = sp.fraction(sp.together(expr.xreplace(whole)))
    if not (above.is_polynomial(*above.free_symbols) and below.is_polynomial(*below.free_symbols)) or above.is_zero:
        return sp.factor(expr)
    scale, found = sp.S.One, list[sp.Expr]()
    for part, sign in ((above, 1), (below, -1)):
        number, factors = (part, []) if part.is_number else factor_list(sp.expand(part))
        scale *= number**sign
        found += [factor ** (sign * power) for factor, power in factors]
    product = sp.Mul(*found).xreplace({root: s ** sp.Rational(1, share[s]) for s, root in roots.items()})
    return sp.Mul(scale, product, evaluate=False) if scale != 1 and product.is_Add else scale * product


Row = tuple[sp.Expr, ...]


class UnreadError(Exception):
    """No rule reads the formula."""


@dataclass(frozen=True)
class Form:
    """sqrt((x - centre) . matrix (x - centre)) for a form that is not diagonal."""

    matrix: sp.ImmutableMatrix
    centre: Row


@dataclass(frozen=True)
class Facets:
    """max of row . x / limit over (row, limit)."""

    arms: tuple[tuple[Row, sp.Expr], ...]


Tree = Side | Holder | Form | Facets


def independent(rows: sp.Matrix) -> bool:
    """Whether the rows are linearly independent (for symbols: at general values)."""
    return bool(rows.rows <= rows.cols and rows.rank() == rows.rows)


def assemble(tree: Tree, radius: sp.Expr) -> tuple[Gauge, Row, sp.Expr, sp.Expr]:
    """(gauge, centre, radius, an expression that must be positive for it to hold); raises UnreadError."""
    if isinstance(tree, Form):
        return Quadratic(tree.matrix), tree.centre, radius, sp.S.One
    if isinstance(tree, Facets):
        return _polytope([(row, limit * radius) for row, limit in tree.arms])
    leaves = tree.sides
    rows = sp.ImmutableMatrix([list(leaf.row) for leaf in leaves])
    if independent(rows):
        offsets = sp.Matrix([leaf.offset for leaf in leaves])
        gram = rows * rows.T
        centre = (rows.T * gram.inv() * offsets).applyfunc(sp.cancel) if any(offsets) else sp.zeros(rows.cols, 1)
        return Separable(tree), tuple(centre), radius, sp.factor(gram.det())
    if not isinstance(tree, Holder) or not all(isinstance(p, Side) and p.symmetric and p.offset == 0 for p in tree.parts):
        raise UnreadError
    if tree.p == 2:
        weights = sp.diag(*[leaf.up**2 for leaf in leaves])
        matrix = sp.ImmutableMatrix(rows.T * weights * rows).applyfunc(sp.cancel)
        kept = list(matrix.rref(simplify=True)[1])  # its rank at general values; at special ones it may be less
        return Quadratic(matrix), (sp.S.Zero,) * rows.cols, radius, sp.factor(matrix[kept, kept].det())
    if tree.p is sp.oo:
        return _polytope([(tuple(sign * c for c in leaf.row), radius / leaf.up) for leaf in leaves for sign in (1, -1)])
    if tree.p == 1:
        return _polytope([(row, radius) for row in _signed_sums(leaves)])
    raise UnreadError


def _polytope(arms: Sequence[tuple[Row, sp.Expr]]) -> tuple[Gauge, Row, sp.Expr, sp.Expr]:
    """{row . x <= limit}: numeric up to one common positive factor, which becomes the radius."""
    radius = arms[0][1]
    rows = sp.Matrix([[sp.cancel(c * radius / limit) for c in row] for row, limit in arms])
    if any(not c.is_number for c in rows):
        raise UnreadError
    ball = Polytope.of(rows)
    if ball is None:
        raise UnreadError
    return ball, (sp.S.Zero,) * rows.cols, radius, sp.S.One


def _signed_sums(leaves: Sequence[Side]) -> Iterator[Row]:
    """A sum of absolute values is the greatest of these."""
    rows = [[leaf.up * c for c in leaf.row] for leaf in leaves]
    for signs in product((1, -1), repeat=len(rows)):
        row = tuple(sp.Add(*[s * v for s, v in zip(signs, column, strict=True)]) for column in zip(*rows, strict=True))
        if any(row):
            yield row


_MOST_OPERATIONS = 200  # in the matrix of a quadratic form
_KINKED = (*KINKS, Norm)


@dataclass(frozen=True)
class Ball:
    """{x : gauge(x - centre) <= radius}, true wherever every expression of ``requires`` is positive."""

    gauge: Gauge
    centre: tuple[sp.Expr, ...]
    radius: sp.Expr
    requires: tuple[sp.Expr, ...]


def read_ball(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Ball | None:
    """The ball {g <= 0} in the space of ``forces``, or None where no rule reads it."""
    reader = _BallReader(tuple(forces))
    try:
        tree, radius = reader.sublevel(g, sp.S.Zero)
        gauge, centre, radius, full_rank = assemble(tree, radius)
    except (UnreadError, TooManyBranchesError, sp.PolynomialError, ArithmeticError, ValueError, TypeError, NotImplementedError):
        return None
    needed = dict.fromkeys(_core(r) for r in [*reader.requires, full_rank, radius] if not r.is_positive)
    needed.pop(sp.S.One, None)
    if any(r.is_nonpositive for r in needed):
        return None
    implied = {shape for r in needed for shape in (sp.Abs(r), r**2, r**-2) if shape != r}  # |r| is r itself where r >= 0
    return Ball(gauge, centre, radius, tuple(r for r in needed if r not in implied))


def _core(expr: sp.Expr) -> sp.Expr:
    """A shorter expression that is positive exactly where ``expr`` is: positive factors and odd or broken powers dropped."""
    product = factored(expr) if expr.is_Add else sp.factor_terms(expr)
    expr = sp.Mul(*[x for x in sp.Mul.make_args(product) if not x.is_positive])
    while isinstance(expr, sp.Pow) and expr.exp.is_Rational and expr.exp.p % 2 != 0:
        expr = expr.base
    return expr


class _BallReader:
    """One reading; ``requires`` collects the expressions that have to be positive for it to hold."""

    def __init__(self, forces: tuple[sp.Symbol, ...]) -> None:
        self.forces = forces
        self.requires: list[sp.Expr] = []

    # -- the inequality ---------------------------------------------------------------------------------------

    def sublevel(self, a: sp.Expr, bound: sp.Expr) -> tuple[Tree, sp.Expr]:
        """(tree, radius) with {a <= bound} = {tree <= radius}."""
        a, bound = self._isolated(a, bound)
        if isinstance(a, sp.Max):
            return self._intersection(self._arms(a, bound))
        if isinstance(a, Norm):
            return self._raised(sp.Add(*[x**2 for x in a.args]), bound, sp.Integer(2))
        if isinstance(a, sp.Pow) and not a.exp.has(*self.forces) and not self._is_polynomial(a):
            self._positive(a.exp)
            self._check_never_negative(a.base)
            return self._raised(a.base, bound, 1 / a.exp)
        tree, p, offset = self.power(a)
        return tree, self._root(self._positive(bound - offset), p)

    def _check_never_negative(self, base: sp.Expr) -> None:
        """A power is increasing only on what is never negative."""
        if not base.is_nonnegative and not self.power(base)[2].is_nonnegative:
            raise UnreadError

    def _isolated(self, a: sp.Expr, bound: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
        """The same inequality with constants and positive factors moved to the right."""
        while True:
            constant, a = a.as_independent(*self.forces, as_Add=True)
            bound -= constant
            if a.is_Add or self._is_affine(a):
                return a, bound
            factor, a = a.as_independent(*self.forces, as_Add=False)
            if factor == 1:
                return a, bound
            if factor.is_negative and isinstance(a, sp.Min):
                factor, a = -factor, sp.Max(*[-x for x in a.args])
            bound /= self._positive(factor)

    def _raised(self, a: sp.Expr, bound: sp.Expr, power: sp.Expr) -> tuple[Tree, sp.Expr]:
        """{a**(1/power) <= bound} for a >= 0: both sides are not negative, so the power may be taken."""
        self._positive(bound)
        return self.sublevel(a, _raise(bound, power))

    def _arms(self, a: sp.Expr, bound: sp.Expr) -> list[tuple[sp.Expr, sp.Expr]]:
        """{a <= bound} as inequalities a_i <= b_i: max(...) by its arguments, sums of absolute values by their signs."""
        a, bound = self._isolated(a, bound)
        if isinstance(a, sp.Max):
            return [arm for x in a.args for arm in self._arms(x, bound)]
        inner = [x for x in a.atoms(sp.Abs) if x.has(*self.forces)]
        free = dict.fromkeys(inner, sp.S.Zero)
        if not inner or not all(self._is_affine(x.args[0]) for x in inner) or a.xreplace(free).has(*_KINKED):
            return [(a, bound)]
        slots = {x: sp.Dummy() for x in inner}
        linear = sp.Poly(a.xreplace(slots), *slots.values(), *self.forces)
        if linear.total_degree() != 1:
            return [(a, bound)]
        for x in inner:
            self._positive(linear.coeff_monomial(slots[x]))
        signed = (dict(zip(inner, signs, strict=True)) for signs in product((1, -1), repeat=len(inner)))
        return [self._isolated(sp.expand(a.xreplace({x: s * x.args[0] for x, s in choice.items()})), bound) for choice in signed]

    def _intersection(self, arms: list[tuple[sp.Expr, sp.Expr]]) -> tuple[Tree, sp.Expr]:
        if all(self._is_affine(left) for left, _ in arms):
            return self._polyhedron(arms)
        balls = [self.sublevel(left, limit) for left, limit in self._paired(arms)]
        trees = list(dict.fromkeys(tree for tree, _ in balls))
        if len(trees) == 1:
            return trees[0], sp.Min(*[radius for _, radius in balls])
        if len(trees) < len(balls):
            raise UnreadError
        parts = tuple(self._block(self._multiplied(tree, 1 / self._positive(radius))) for tree, radius in balls)
        return Holder(sp.oo, parts), sp.S.One

    def _paired(self, arms: list[tuple[sp.Expr, sp.Expr]]) -> list[tuple[sp.Expr, sp.Expr]]:
        """Opposite linear arms with the same bound joined again into an absolute value."""
        left, found = list(arms), []
        while left:
            form, limit = left.pop(0)
            if self._is_affine(form):
                if (-form, limit) not in left:
                    raise UnreadError
                left.remove((-form, limit))
                form = sp.Abs(form)
            found.append((form, limit))
        return found

    def _polyhedron(self, arms: list[tuple[sp.Expr, sp.Expr]]) -> tuple[Tree, sp.Expr]:
        """Linear forms bounded above: intervals along independent directions, else a polytope."""
        sides: dict[tuple[sp.Expr, ...], dict[int, list[sp.Expr]]] = {}
        for left, limit in arms:
            row, constant = self._affine(left)
            lead = next(c for c in row if c != 0)
            if not (lead.is_positive or lead.is_negative):
                raise UnreadError
            direction = tuple(sp.cancel(c / lead) for c in row)
            side = sides.setdefault(direction, {1: [], -1: []})
            side[1 if lead.is_positive else -1].append(self._positive(sp.cancel((limit - constant) / abs(lead))))
        boxed = all(side[1] and side[-1] for side in sides.values()) and independent(sp.Matrix(list(sides)))
        if not boxed:
            facets = [(tuple(sign * c for c in row), limit) for row, side in sides.items() for sign in (1, -1) for limit in side[sign]]
            return Facets(tuple(facets)), sp.S.One
        limits = [(row, sp.Min(*side[1]), sp.Min(*side[-1])) for row, side in sides.items()]
        radius = limits[0][1] if len({limit for _, *both in limits for limit in both}) == 1 else sp.S.One
        leaves = tuple(Side(radius / high, radius / low, row, sp.S.Zero) for row, high, low in limits)
        return (leaves[0] if len(leaves) == 1 else Holder(sp.oo, leaves)), radius

    # -- one expression as a power of a gauge -------------------------------------------------------------------

    def power(self, a: sp.Expr) -> tuple[Tree, sp.Expr, sp.Expr]:
        """(tree, p, offset) with a = tree**p + offset."""
        factor, rest = a.as_independent(*self.forces, as_Add=False)
        if factor != 1 and not (rest.is_Add and self._is_polynomial(rest)):
            self._positive(factor)
            tree, p, offset = self.power(rest)
            return self._multiplied(tree, _raise(factor, 1 / p)), p, factor * offset
        if isinstance(a, sp.Abs):
            if self._is_affine(a.args[0]):
                return self._leaf(a.args[0]), sp.S.One, sp.S.Zero
            return self._one_sided(a)
        if isinstance(a, Norm):
            return Holder(sp.Integer(2), tuple(self._member(x) for x in a.args)), sp.S.One, sp.S.Zero
        if isinstance(a, sp.Max):
            try:
                return self._one_sided(a)
            except UnreadError:
                return Holder(sp.oo, tuple(self._member(x) for x in a.args)), sp.S.One, sp.S.Zero
        if self._is_polynomial(a) and sp.Poly(a, *self.forces).total_degree() == 2:
            return self._quadratic(a)
        if isinstance(a, sp.Pow) and not a.exp.has(*self.forces):
            if a.exp.is_integer and a.exp.is_even and self._is_affine(a.base):
                return self._leaf(a.base), a.exp, sp.S.Zero
            tree, p, offset = self.power(a.base)
            self._positive(a.exp)
            if offset != 0:
                raise UnreadError
            return tree, sp.cancel(p * a.exp), sp.S.Zero
        if len(self._present(a)) == 1 and a.has(*_KINKED):
            return self._one_sided(a)
        if a.is_Add:
            return self._sum(a)
        raise UnreadError

    def _member(self, x: sp.Expr) -> Side | Holder:
        """An argument of a norm: what counts is its absolute value."""
        tree, p, offset = self.power(x if x.is_nonnegative else sp.Abs(x))
        if p != 1 or offset != 0:
            raise UnreadError
        return self._block(tree)

    def _block(self, tree: Tree) -> Side | Holder:
        if not isinstance(tree, Side | Holder):
            raise UnreadError
        return tree

    def _sum(self, a: sp.Expr) -> tuple[Tree, sp.Expr, sp.Expr]:
        """A sum: terms that share forces are read together where they can be, else one by one."""
        groups: list[list[sp.Expr]] = []
        for term in a.args:
            joined = [g for g in groups if any(self._present(term) & self._present(x) for x in g)]
            groups = [g for g in groups if g not in joined] + [[term, *(x for g in joined for x in g)]]
        if len(groups) > 1:
            sums = sorted((sp.Add(*group) for group in groups), key=lambda total: min(map(self.forces.index, self._present(total))))
            read = [self.power(total) for total in sums]
        else:
            read = [self.power(term) for term in a.args]
        p = read[0][1]
        if any(sp.cancel(q - p) != 0 for _, q, _ in read):
            raise UnreadError
        if p != 1:
            self._positive(p - 1)
        blocks = [self._block(tree) for tree, _, _ in read]
        parts = [part for block in blocks for part in (block.parts if isinstance(block, Holder) and block.p == p else (block,))]
        return Holder(p, tuple(parts)), p, sp.Add(*[offset for _, _, offset in read])

    def _one_sided(self, a: sp.Expr) -> tuple[Tree, sp.Expr, sp.Expr]:
        """One kink, linear or a power on both sides of it: a one-dimensional gauge, from the one-sided branches."""
        found = branches(a, most=8)
        switches = {switch for branch in found for switch in branch.signs}
        if len(switches) != 1 or len(found) != 2:
            raise UnreadError
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
                raise UnreadError
            offset, rest = along.as_independent(t, as_Add=True)
            weight, monomial = sp.powsimp(rest).as_independent(t, as_Add=False)
            base, p = monomial.as_base_exp()
            if base != t or p.has(t):
                raise UnreadError
            sides[sign] = (weight, p, offset)
        (up, p, offset), (down, p_below, offset_below) = sides[1], sides[-1]
        if sp.cancel(p - p_below) != 0 or sp.cancel(offset - offset_below) != 0:
            raise UnreadError
        up, down = (self._root(self._positive(w), p) for w in (up, down))
        return self._normalised(Side(up, down, row, -constant)), p, offset

    def _leaf(self, form: sp.Expr) -> Side:
        row, constant = self._affine(form)
        return self._normalised(Side(sp.S.One, sp.S.One, row, -constant))

    def _normalised(self, leaf: Side) -> Side:
        """The leading coefficient of the row moved into the weights where its sign is known."""
        lead = next(c for c in leaf.row if c != 0)
        if lead == 1 or not (lead.is_positive or lead.is_negative):
            return leaf
        size = abs(lead)
        up, down = (leaf.up, leaf.down) if lead.is_positive else (leaf.down, leaf.up)
        return Side(
            sp.cancel(up * size), sp.cancel(down * size), tuple(sp.cancel(c / lead) for c in leaf.row), sp.cancel(leaf.offset / lead)
        )

    def _quadratic(self, a: sp.Expr) -> tuple[Tree, sp.Expr, sp.Expr]:
        """The square completed: x . A x + b . x + c = (x - x0) . A (x - x0) + c - x0 . A x0."""
        poly, n = sp.Poly(a, *self.forces), len(self.forces)
        origin = dict.fromkeys(self.forces, 0)
        matrix = sp.ImmutableMatrix(sp.hessian(poly.as_expr(), self.forces) / 2).applyfunc(sp.cancel)
        slope = sp.Matrix([poly.as_expr().diff(f).subs(origin) for f in self.forces])
        constant = poly.as_expr().subs(origin)
        if matrix.is_diagonal():
            seen = [i for i in range(n) if matrix[i, i] != 0]
            if any(slope[i] != 0 for i in range(n) if i not in seen):
                raise UnreadError
            leaves = []
            for i in seen:
                weight = self._root(self._positive(matrix[i, i]), sp.Integer(2))
                row = tuple(sp.S.One if j == i else sp.S.Zero for j in range(n))
                leaves.append(Side(weight, weight, row, -slope[i] / (2 * matrix[i, i])))
            constant -= sp.Add(*[slope[i] ** 2 / (4 * matrix[i, i]) for i in seen])
            return (leaves[0] if len(leaves) == 1 else Holder(sp.Integer(2), tuple(leaves))), sp.Integer(2), constant
        whole = self._semidefinite(matrix)
        if not any(slope):
            centre = sp.zeros(n, 1)
        elif whole:  # by Cramer's rule: pinv leaves quotients that no cancelling comes to the end of
            centre = (-matrix.adjugate() * slope / (2 * matrix.det())).applyfunc(sp.cancel)
        else:
            centre = -matrix.pinv() * slope / 2
            if any(sp.cancel(v) != 0 for v in 2 * matrix * centre + slope):
                raise UnreadError
        constant -= (centre.T * matrix * centre)[0]
        return Form(matrix, tuple(centre)), sp.Integer(2), sp.cancel(constant)

    def _semidefinite(self, matrix: sp.ImmutableMatrix) -> bool:
        """Positive semidefinite: the leading minors of the rows that see something independent are positive (Sylvester); whether all do."""
        if sum(entry.count_ops() for entry in matrix) > _MOST_OPERATIONS:
            raise UnreadError  # SymPy would reduce it for minutes
        kept = list(matrix.rref(simplify=True)[1])
        block = matrix[kept, kept]
        for k in range(1, len(kept) + 1):
            self._positive(sp.cancel(block[:k, :k].det()))
        return len(kept) == matrix.rows

    # -- small readings -----------------------------------------------------------------------------------------

    def _multiplied(self, tree: Tree, factor: sp.Expr) -> Tree:
        if isinstance(tree, Form):
            return Form(tree.matrix * factor**2, tree.centre)
        return self._block(tree).scaled(factor)

    def _present(self, a: sp.Expr) -> set[sp.Symbol]:
        return a.free_symbols & set(self.forces)

    def _is_polynomial(self, a: sp.Expr) -> bool:
        return bool(a.is_polynomial(*self.forces))

    def _is_affine(self, a: sp.Expr) -> bool:
        return self._is_polynomial(a) and a.has(*self.forces) and sp.Poly(a, *self.forces).total_degree() == 1

    def _affine(self, a: sp.Expr) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
        if not self._is_affine(a):
            raise UnreadError
        row = tuple(sp.cancel(sp.expand(a).coeff(f)) for f in self.forces)
        return row, sp.expand(a).subs(dict.fromkeys(self.forces, 0))

    def _positive(self, expr: sp.Expr) -> sp.Expr:
        if expr.is_nonpositive:
            raise UnreadError
        if not expr.is_positive:
            self.requires.append(expr)
        return expr

    def _root(self, expr: sp.Expr, p: sp.Expr) -> sp.Expr:
        return expr if p == 1 else _raise(factored(expr) if expr.is_Add else expr, 1 / p)


def _raise(expr: sp.Expr, power: sp.Expr) -> sp.Expr:
    """expr**power for expr > 0 (the caller asks for it), factor by factor so that powers of powers join."""
    if isinstance(expr, sp.Mul):
        return sp.Mul(*[_raise(x, power) for x in expr.args]) if all(x.is_positive for x in expr.args) else expr**power
    if isinstance(expr, sp.Pow) and expr.base.is_positive:
        return expr.base ** sp.cancel(expr.exp * power)
    return expr ** sp.cancel(power)
