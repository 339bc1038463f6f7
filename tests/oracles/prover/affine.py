"""Whether relations between piecewise affine expressions have a common solution: exact linear arithmetic (z3's simplex)."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Neg, Pos
from duhem.expression.smt import Reals
from duhem.proof.decide.question import Budget
from tests.oracles.prover.decide import counted, stated_in

__all__ = ["Affine"]

_STATED, _STEPS = 3_000, 200_000  # to state one question, and at most to decide it


class Affine:
    """Expressions in some variables made of sums, rational multiples, abs, pos, neg, max and min."""

    def __init__(self, variables: Iterable[sp.Symbol], budget: Budget) -> None:
        self._variables = tuple(variables)
        self._budget = budget

    def solution(self, *relations: tuple[sp.Expr, str]) -> dict[sp.Symbol, sp.Rational] | bool | None:
        """Values at which ``expr op 0`` for all; False if there are none, None if that stayed open or is not affine."""
        import z3

        if not all(_affine(expr) for expr, _ in relations) or not self._budget.pays(_STATED):
            return None
        reals = Reals(self._variables)  # a context for each: z3 counts what was done in it before as well
        try:
            stated = [stated_in(reals, expr, op) for expr, op in relations]
        except InputError:
            return None
        if not (most := min(_STEPS, self._budget.left)):
            return None
        solver = z3.SolverFor("QF_LRA", ctx=reals.context)
        solver.set("rlimit", most)
        solver.add(*stated)
        result = solver.check()
        self._budget.pays(min(most, counted(solver, most)))
        if result == z3.unsat:
            return False
        return reals.point(solver.model()) if result == z3.sat else None


def _affine(expr: sp.Expr) -> bool:
    inner = [node for node in sp.preorder_traversal(expr) if node.args]
    return all(isinstance(node, (sp.Add, sp.Max, sp.Min, sp.Abs, Pos, Neg)) or (node.is_Mul and _scaled(node)) for node in inner)


def _scaled(product: sp.Mul) -> bool:
    """Whether a product is a number times one expression."""
    scale, rest = product.as_coeff_Mul()
    return bool(scale.is_Rational) and not rest.is_Mul
