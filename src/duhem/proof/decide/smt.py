"""z3: the negation of the goal together with the hypotheses must be unsatisfiable.

Encodings as measured: polynomials only, quotients and roots as variables with their defining equations.
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

_TACTIC = "qfnra-nlsat"  # complete for these questions, but may be slow
_MOST = 2**32 - 1  # z3 counts no further
_NET = 3  # microseconds of the processor for each step of the budget; a counted step takes less than one


def by_smt(system: System, budget: Budget) -> Answer:
    """Prove the goal, or return a model of its negation as a hint."""
    import z3

    most = min(budget.left, _MOST)
    if not most:
        raise SpentError
    reals = Reals(system.variables)
    solver = z3.Tactic(_TACTIC, ctx=reals.context).solver()
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
    budget.spend(most if result == z3.unknown else min(most, counted(solver, most)))
    if result == z3.unknown:
        return Answer(None, "smt-z3", reason=reason)
    return Answer(True, "smt-z3") if result == z3.unsat else Answer(False, "smt-z3", point=reals.point(solver.model()))


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
