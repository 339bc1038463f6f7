"""z3 as a portfolio: the negation of the goal together with the hypotheses must be unsatisfiable.

Encodings as measured: polynomials only, quotients cleared, roots as non-negative variables with their defining equation.
``unknown`` and time-outs decide nothing; a model is only a hint for the witness search.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import sympy as sp

from duhem.proof.decide.polynomials import Relation, System
from duhem.proof.decide.question import Answer

__all__ = ["by_smt"]

# Shares of the budget: nlsat is complete for these questions but may be slow, the others are quick or hang.
_PORTFOLIO = (("nlsat", 0.3), ("default", 0.2), ("smt", 0.1), ("nlsat", 1.0))


def by_smt(system: System, seconds: float) -> Answer:
    """Prove the goal, or return a model of its negation as a hint."""
    import z3

    context = z3.Context()
    names = {x: z3.Real(f"x{i}", ctx=context) for i, x in enumerate(system.variables)}
    hypotheses = [_relation(r, names, z3) for r in system.given]
    negated = z3.Not(_relation(system.goal, names, z3))
    deadline = time.monotonic() + seconds
    reason = "time ran out"
    for tactic, share in _PORTFOLIO:
        left = deadline - time.monotonic()
        if left <= 0:
            break
        solver = _solver(tactic, context, z3)
        solver.set("timeout", max(1, int(1000 * min(left, share * seconds))))
        solver.add(*hypotheses, negated)
        try:
            result = solver.check()
        except z3.Z3Exception as fault:
            reason = str(fault)
            continue
        if result == z3.unsat:
            return Answer(True, "smt-z3")
        if result == z3.sat:
            return Answer(False, "smt-z3", point=_model(solver.model(), names, z3))
        reason = f"z3: {solver.reason_unknown()}"
        if "interrupted" in reason:  # z3 takes Ctrl-C for itself
            raise KeyboardInterrupt
    return Answer(None, "smt-z3", reason=reason)


def _solver(tactic: str, context: Any, z3: Any) -> Any:
    if tactic == "nlsat":
        return z3.Tactic("qfnra-nlsat", ctx=context).solver()
    return z3.Tactic("smt", ctx=context).solver() if tactic == "smt" else z3.Solver(ctx=context)


def _relation(relation: Relation, names: Mapping[sp.Symbol, Any], z3: Any) -> Any:
    poly = _polynomial(relation.poly, names, z3)
    match relation.op:
        case ">=":
            return poly >= 0
        case ">":
            return poly > 0
        case "==":
            return poly == 0
        case _:
            return poly != 0


def _polynomial(expr: sp.Expr, names: Mapping[sp.Symbol, Any], z3: Any) -> Any:
    context = next(iter(names.values())).ctx if names else None

    def number(value: Any) -> Any:
        return z3.RealVal(f"{value.p}/{value.q}", ctx=context)

    def convert(node: Any) -> Any:
        if node.is_Rational:
            return number(node)
        if node.is_Symbol:
            return names[node]
        if node.is_Pow:
            base = convert(node.base)
            product = base
            for _ in range(int(node.exp) - 1):
                product = product * base
            return product
        parts = [convert(a) for a in node.args]
        if node.is_Add:
            return z3.Sum(parts)
        product = parts[0]
        for part in parts[1:]:
            product = product * part
        return product

    return convert(expr)


def _model(model: Any, names: Mapping[sp.Symbol, Any], z3: Any) -> dict[sp.Symbol, sp.Rational]:
    """The model as rationals; algebraic numbers are approximated to thirty digits."""
    point = {}
    for symbol, name in names.items():
        value = model.eval(name, model_completion=True)
        if z3.is_algebraic_value(value):
            value = value.approx(30)
        point[symbol] = sp.Rational(value.numerator_as_long(), value.denominator_as_long())
    return point
