"""Whether relations between piecewise affine expressions have a common solution: exact linear arithmetic (z3's simplex)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Neg, Pos, fold

__all__ = ["Affine"]


class Affine:
    """Expressions in some variables made of sums, rational multiples, abs, pos, neg, max and min."""

    def __init__(self, variables: Iterable[sp.Symbol], seconds: float) -> None:
        import z3

        self._z3, self._context = z3, z3.Context()
        self._milliseconds = max(1, int(1000 * seconds))
        self._names = {x: z3.Real(f"x{i}", ctx=self._context) for i, x in enumerate(variables)}

    def solution(self, *relations: tuple[sp.Expr, str]) -> dict[sp.Symbol, sp.Rational] | bool | None:
        """Values at which ``expr op 0`` for all; False if there are none, None if that stayed open or is not affine."""
        try:
            stated = [self._relation(expr, op) for expr, op in relations]
        except InputError:
            return None
        solver = self._z3.SolverFor("QF_LRA", ctx=self._context)
        solver.set("timeout", self._milliseconds)
        solver.add(*stated)
        result = solver.check()
        if result == self._z3.unsat:
            return False
        if result != self._z3.sat:
            return None
        model = solver.model()
        values = {x: model.eval(name, model_completion=True) for x, name in self._names.items()}
        return {x: sp.Rational(v.numerator_as_long(), v.denominator_as_long()) for x, v in values.items()}

    def _relation(self, expr: sp.Expr, op: str) -> Any:
        value = self._converted(expr)
        return {">=": value >= 0, ">": value > 0, "<=": value <= 0, "<": value < 0, "==": value == 0}[op]

    def _converted(self, expr: sp.Expr) -> Any:
        z3 = self._z3

        def number(value: sp.Rational) -> Any:
            return z3.RealVal(f"{value.p}/{value.q}", ctx=self._context)

        def leaf(node: Any) -> Any:
            if node in self._names:
                return self._names[node]
            if node.is_Rational:
                return number(node)
            raise InputError(f"{node} is no rational number")

        def mul(node: sp.Basic, *factors: Any) -> Any:
            scale, rest = node.as_coeff_Mul()
            if not scale.is_Rational or rest.is_Mul or len(factors) != 2:
                raise InputError(f"{node} is not affine")
            return number(scale) * self._converted(rest)

        def greatest(first: Any, *others: Any) -> Any:
            for other in others:
                first = z3.If(first >= other, first, other)
            return first

        def least(first: Any, *others: Any) -> Any:
            for other in others:
                first = z3.If(first <= other, first, other)
            return first

        zero = number(sp.S.Zero)
        table: Mapping[type, Callable[..., Any]] = {
            sp.Add: lambda _, *terms: z3.Sum(*terms),
            sp.Mul: mul,
            sp.Max: lambda _, *x: greatest(*x),
            sp.Min: lambda _, *x: least(*x),
            sp.Abs: lambda _, x: greatest(x, -x),
            Pos: lambda _, x: greatest(x, zero),
            Neg: lambda _, x: greatest(-x, zero),
        }
        return fold(expr, table, leaf)
