"""z3, several of its solvers in turn: the negation of the goal together with the hypotheses must be unsatisfiable.

Encodings as measured: polynomials only, quotients cleared, roots as non-negative variables with their defining equation.
``unknown`` decides nothing; a model is only a hint for the witness search.  z3 is stopped by its own count of steps.  It
counts nothing for long stretches of some resultants, though, and nothing tells beforehand which: a net of processor time, many
times what a counted step takes, ends those.  No answer was ever seen to take half of it, on a busy machine or an idle one.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import process_time
from typing import Any

from duhem.expression.smt import Reals
from duhem.proof.decide.budget import Budget, SpentError
from duhem.proof.decide.polynomials import System
from duhem.proof.decide.question import Answer

__all__ = ["by_smt", "counted"]

# Eighths of the budget: nlsat is complete for these questions but may be slow, the other is quick or hangs.
_SOLVERS = (("qfnra-nlsat", 3), ("smt", 2))
_MOST = 2**32 - 1  # z3 counts no further
_NET = 3  # microseconds of the processor for each step of the budget; a counted step takes less than one


def by_smt(system: System, budget: Budget) -> Answer:
    """Prove the goal, or return a model of its negation as a hint."""
    import z3

    reason, eighth = str(SpentError()), budget.left // 8
    for tactic, share in _SOLVERS:
        most = min(share * eighth, _MOST)
        if not most:
            break
        reals = Reals(system.variables)  # a context for each: what the one did before it was stopped is nothing to the other
        solver = z3.Tactic(tactic, ctx=reals.context).solver()
        solver.set("rlimit", most)
        solver.add(*(reals.relation(r.poly, r.op) for r in system.given), z3.Not(reals.relation(system.goal.poly, system.goal.op)))
        try:
            with _net(reals.context, _NET * most):
                result = solver.check()
        except z3.Z3Exception as fault:
            result, reason = z3.unknown, str(fault)
        else:
            reason = f"z3: {solver.reason_unknown()}"
        if "keyboard" in reason:  # z3 takes Ctrl-C for itself
            raise KeyboardInterrupt
        if result == z3.unknown:
            budget.spend(most)
            continue
        budget.spend(min(most, counted(solver, most)))
        return Answer(True, "smt-z3") if result == z3.unsat else Answer(False, "smt-z3", point=reals.point(solver.model()))
    return Answer(None, "smt-z3", reason=reason)


def counted(solver: Any, otherwise: int) -> int:
    """How many steps the solver counted."""
    found = solver.statistics()
    return int(found.get_key_value("rlimit count")) if "rlimit count" in found.keys() else otherwise  # noqa: SIM118


@contextmanager
def _net(context: Any, microseconds: int) -> Iterator[None]:
    """Interrupt what runs in the context once it has had so much of the processor."""
    end, done = process_time() + 1e-6 * microseconds, Event()

    def watch() -> None:
        while not done.wait(0.1):
            if process_time() > end:
                context.interrupt()
                return

    thread = Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
