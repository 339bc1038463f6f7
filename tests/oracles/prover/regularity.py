"""Smoothness by composition: where a formula fails to be C^1, and which of its kinks cancel.

A kink of abs, pos or neg sits where its argument vanishes.  A function that itself vanishes there loses the kink under
any power p > 1 and inside a Euclidean norm, which leaves only the tip where the norm is 0.  This is why Eq. (35) of
Antoni et al. (2007) is C^1 across the quadrant seams though pos and neg are not.

Let G(x, z) be C^1 and even in every z_i, and r_i(x) >= 0 convex, and C^1 where it is > 0.  Then G(x, r(x)) is C^1, where r_i = 0 too:
dG/dz_i is 0 for z_i = 0, and r_i is Lipschitz.  So f(u - r) + f(u + r) is C^1 for an f that is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Atan2, EigMax, Neg, Norm, Pos, Where, fold
from duhem.expression.branches import oriented
from duhem.proof.facts.formula_subject import FormulaSubject
from tests.oracles.prover.curvature import curvature
from tests.oracles.prover.deviator import positive_off_axis
from tests.oracles.prover.even_roots import even, freed, outermost_roots

__all__ = ["Regularity", "regularity"]

_NONE: frozenset[sp.Expr] = frozenset()
_MOST_ROOTS = 8


@dataclass(frozen=True)
class Regularity:
    """``kinks``: switches on whose zero set the function may fail to be C^1 (it is locally Lipschitz there).

    ``vanishing``: switches on whose zero set the function is 0.  ``tips``: nodes at whose zeros it may be singular.
    ``known`` False: nothing is claimed.
    """

    known: bool = True
    kinks: frozenset[sp.Expr] = _NONE
    vanishing: frozenset[sp.Expr] = _NONE
    tips: frozenset[sp.Expr] = _NONE

    @property
    def cancelling(self) -> bool:
        """Every kink lies where the function vanishes."""
        return self.kinks <= self.vanishing


_OPAQUE = Regularity(known=False)


def regularity(expr: sp.Expr, subject: FormulaSubject) -> Regularity:
    """Kinks and tips of ``expr`` in the forces of the subject's simple problem."""
    return _RegularityRules(subject).of(expr)


class _RegularityRules:
    def __init__(self, subject: FormulaSubject, others: Collection[sp.Symbol] = ()) -> None:
        """``others`` are taken for forces too."""
        self.subject, self.forces = subject, {*subject.simple.forces, *others}

    def of(self, expr: sp.Expr) -> Regularity:
        smooth = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan)
        table: dict[type, Callable[..., Regularity]] = {
            sp.Add: self.add, sp.Mul: self.mul, sp.Pow: self.power, Norm: self.norm,
            sp.Abs: self.ramp, Pos: self.ramp, Neg: self.ramp,
        } | {f: self.smooth for f in smooth}  # fmt: skip
        table |= dict.fromkeys((sp.asin, sp.acos), self.arc)
        table |= {f: self.opaque for f in (sp.Max, sp.Min, Where, sp.log, sp.tan, Atan2, EigMax)}
        for relation in (sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan):
            table[relation] = self.opaque
        try:
            return fold(expr, table, self.leaf)
        except InputError:
            return _OPAQUE

    def leaf(self, node: Any) -> Regularity:
        return Regularity(vanishing=frozenset({node})) if node in self.forces else Regularity()

    def constant(self, node: sp.Basic) -> bool:
        return not node.free_symbols & self.forces

    def opaque(self, node: sp.Basic, *parts: Regularity) -> Regularity:
        return Regularity() if self.constant(node) else _OPAQUE

    def add(self, node: sp.Expr, *terms: Regularity) -> Regularity:
        found = _OPAQUE
        if all(t.known for t in terms):
            zero = frozenset.intersection(*(t.vanishing for t in terms)) | {oriented(node)[0]}
            found = Regularity(True, frozenset().union(*(t.kinks for t in terms)), zero, frozenset().union(*(t.tips for t in terms)))
        return found if found.known and not found.kinks and not found.tips else self.even_in_roots(node) or found

    def even_in_roots(self, node: sp.Expr) -> Regularity | None:
        """Of a sum that is C^1 and even in its roots; what is singular but for the roots themselves stays a tip."""
        if not node.free_symbols & self.forces or self.forces != {*self.subject.simple.forces} or not node.has(sp.Pow, Norm):
            return None
        roots = [*dict.fromkeys(outermost_roots(node, self.forces, self.convex_root))]
        inner = [self.of(y) for root in roots for y in (root.args if isinstance(root, Norm) else root.args[:1])]
        if not 0 < len(roots) <= _MOST_ROOTS or not all(y.known and y.cancelling for y in inner):
            return None
        for expr, others in freed(node, roots, self.forces):
            found = _RegularityRules(self.subject, others).of(expr)
            if found.known and not found.kinks and even(expr, others):
                tips = frozenset(tip.xreplace(others) for tip in found.tips).union(*(y.tips for y in inner))
                return Regularity(True, _NONE, frozenset({oriented(node)[0]}), tips)
        return None

    def convex_root(self, root: sp.Expr) -> bool:
        shape = curvature(root, self.subject)
        return shape.convex and shape.nonnegative and not shape.affine

    def mul(self, node: sp.Expr, *factors: Regularity) -> Regularity:
        if not all(t.known for t in factors):
            return _OPAQUE
        # A kink of one factor is lost in the product where another factor vanishes.
        kinks = frozenset(
            k for i, f in enumerate(factors) for k in f.kinks if not any(k in g.vanishing for j, g in enumerate(factors) if j != i)
        )
        return Regularity(True, kinks, frozenset().union(*(f.vanishing for f in factors)), frozenset().union(*(f.tips for f in factors)))

    def smooth(self, node: Any, x: Regularity) -> Regularity:
        keeps = isinstance(node, sp.sin | sp.sinh | sp.tanh | sp.atan)
        return Regularity(x.known, x.kinks, x.vanishing if keeps else _NONE, x.tips)

    def arc(self, node: Any, x: Regularity) -> Regularity:
        """Of x, for x^2 < 1."""
        return Regularity() if self.constant(node) else Regularity(x.known, x.kinks, _NONE, x.tips | {1 - node.args[0] ** 2})

    def ramp(self, node: Any, x: Regularity) -> Regularity:
        if not x.known or self.constant(node):
            return x if not self.constant(node) else Regularity()
        switch = oriented(node.args[0])[0]
        return Regularity(True, x.kinks | {switch}, x.vanishing | {switch}, x.tips)

    def norm(self, node: Any, *args: Regularity) -> Regularity:
        if not all(a.known and a.cancelling for a in args):
            return _OPAQUE
        zero = frozenset.intersection(*(a.vanishing for a in args))
        tips = frozenset().union(*(a.tips for a in args))
        strictly = any(self.constant(a) and self.subject.positive(a**2) for a in node.args)
        return Regularity(True, _NONE, zero, tips if strictly else tips | {node})

    def power(self, node: Any, base: Regularity, exponent: Regularity) -> Regularity:
        if self.constant(node):
            return Regularity()
        p = node.exp
        if not base.known or not self.constant(p):
            return _OPAQUE
        if p.is_Integer and p > 0:
            return Regularity(True, _NONE if p > 1 and base.cancelling else base.kinks, base.vanishing, base.tips)
        if not (node.base.is_extended_nonnegative or positive_off_axis(self.subject, node.base) or self.subject.nonnegative(node.base)):
            return _OPAQUE  # undefined where the base is negative
        if self.subject.positive(p - 1):
            return Regularity(True, _NONE if base.cancelling else base.kinks, base.vanishing, base.tips)
        zero = base.vanishing if self.subject.positive(p) else _NONE
        return Regularity(True, base.kinks, zero, base.tips | {node.base})
