"""Powers and products of several parts as functions of the forces: norms, means and entropies, one theorem each."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

import sympy as sp

from duhem.expression import Pos
from duhem.expression.number import plain_exponent
from duhem.proof.facts.formula_subject import FormulaSubject
from tests.oracles.prover.quadratic_form import semidefinite
from tests.oracles.prover.shape import Curvature

__all__ = ["MovingParts"]


class MovingParts:
    """What several parts are together, from what each of them is as ``of`` tells it."""

    def __init__(self, of: Callable[[sp.Expr], Curvature], forces: Collection[sp.Symbol], subject: FormulaSubject) -> None:
        self._of, self._forces, self._subject = of, set(forces), subject

    def norm(self, base: sp.Expr, p: sp.Expr) -> tuple[str, ...] | None:
        """Why (sum c_i v_i^q)^(1/q), q >= 1, v_i convex and >= 0 (or affine, q even), is convex: a norm of convex functions (Minkowski)."""
        if p == sp.S.Half and semidefinite(base, self._forces, self._subject, root=True):
            return ("the square root of a non-negative quadratic form is a seminorm",)
        q, rules = sp.simplify(1 / plain_exponent(p)), ["Minkowski's inequality: a p-norm with p >= 1 of convex functions >= 0 is convex"]
        terms = [t for part in sp.Add.make_args(base) for t in sp.Add.make_args(sp.expand(part, power_base=False, power_exp=False))]
        for term in terms:
            moving, scale = self._moving(term)
            if not self._subject.nonnegative(scale):
                return None
            powers = [(f.base, plain_exponent(f.exp)) if f.is_Pow else (f, sp.S.One) for f in moving]
            if not powers:
                continue
            if any(sp.simplify(e - q) != 0 for _, e in powers):
                return None
            inner = self._of(sp.Mul(*(b for b, _ in powers)))
            even = q.is_Integer and q % 2 == 0
            if not ((inner.convex and inner.nonnegative) or (even and inner.affine)):
                return None
            rules += inner.rules
        return tuple(dict.fromkeys(rules)) if self._subject.nonnegative(q - 1) else None

    def geometric_mean(self, base: sp.Expr, p: sp.Expr) -> bool:
        """Whether base^p is (x y ...)^p, n factors that are concave and >= 0 and n p <= 1."""
        base = base.args[0] if isinstance(base, Pos) and self._of(base.args[0]).nonnegative else base
        moving, scale = self._moving(base)
        small = self._subject.nonnegative(1 - len(moving) * p) and self._subject.nonnegative(scale)
        shapes = [self._of(f) for f in moving] if small else []
        return len(shapes) > 1 and all(x.concave and x.nonnegative for x in shapes)

    def size_by_its_logarithm(self, factors: Sequence[sp.Expr], scale: sp.Expr) -> bool:
        """Whether it is c x log(d x) with x >= 0 affine and c >= 0."""
        x, logarithm = sorted(factors, key=lambda f: isinstance(f, sp.log))
        if not isinstance(logarithm, sp.log) or not self._of(logarithm.args[0]).affine or not self._of(logarithm.args[0]).nonnegative:
            return False
        share = sp.cancel(scale * x / logarithm.args[0])
        return not share.free_symbols & self._forces and self._subject.nonnegative(share)

    def _moving(self, product: sp.Expr) -> tuple[list[sp.Expr], sp.Expr]:
        """The factors that depend on the forces, and what the others make."""
        moving = [f for f in sp.Mul.make_args(product) if f.free_symbols & self._forces]
        return moving, sp.Mul(*(f for f in sp.Mul.make_args(product) if not f.free_symbols & self._forces))
