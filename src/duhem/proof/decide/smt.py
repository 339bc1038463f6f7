"""z3, several of its solvers in turn: the negation of the goal together with the hypotheses must be unsatisfiable.

Encodings as measured: polynomials only, quotients cleared, roots as non-negative variables with their defining equation.
``unknown`` and time-outs decide nothing; a model is only a hint for the witness search.
"""

from __future__ import annotations

import time
from typing import Any

from duhem.expression.smt import Reals
from duhem.proof.decide.polynomials import System
from duhem.proof.decide.question import Answer

__all__ = ["by_smt"]

# Shares of the budget: nlsat is complete for these questions but may be slow, the others are quick or hang.
_SOLVERS = (("nlsat", 0.3), ("default", 0.2), ("smt", 0.1), ("nlsat", 1.0))


def by_smt(system: System, seconds: float) -> Answer:
    """Prove the goal, or return a model of its negation as a hint."""
    import z3

    reals = Reals(system.variables)
    hypotheses = [reals.relation(r.poly, r.op) for r in system.given]
    negated = z3.Not(reals.relation(system.goal.poly, system.goal.op))
    deadline = time.monotonic() + seconds
    reason = "time ran out"
    for tactic, share in _SOLVERS:
        left = deadline - time.monotonic()
        if left <= 0:
            break
        solver = _solver(tactic, reals.context)
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
            return Answer(False, "smt-z3", point=reals.point(solver.model()))
        reason = f"z3: {solver.reason_unknown()}"
        if "interrupted" in reason:  # z3 takes Ctrl-C for itself
            raise KeyboardInterrupt
    return Answer(None, "smt-z3", reason=reason)


def _solver(tactic: str, context: Any) -> Any:
    import z3

    if tactic == "nlsat":
        return z3.Tactic("qfnra-nlsat", ctx=context).solver()
    return z3.Tactic("smt", ctx=context).solver() if tactic == "smt" else z3.Solver(ctx=context)
