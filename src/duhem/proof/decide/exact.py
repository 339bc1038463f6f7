"""Exact decisions: the question made as small as its equations allow, each part on the line, along a plane curve or in a
plane region."""

from __future__ import annotations

from duhem.proof.decide.budget import Budget
from duhem.proof.decide.line_cells import by_cells
from duhem.proof.decide.plane_curve import by_plane
from duhem.proof.decide.plane_region import by_region
from duhem.proof.decide.polynomials import System
from duhem.proof.decide.question import Answer
from duhem.proof.decide.reduction import parts, variables

__all__ = ["by_exact"]

_METHOD = "sturm"


def by_exact(system: System, budget: Budget) -> Answer:
    """Decide a polynomial question that comes down to two variables at most; ``holds`` is None for any other."""
    used = _METHOD
    for part in parts(system):
        answer = _decided(part.system, budget)
        if answer.holds is None:
            return answer
        if answer.holds is False:
            return Answer(False, answer.method, point=part.restored(answer.point or {}))
        used = answer.method if answer.method != _METHOD else used
    return Answer(True, used)


def _decided(system: System, budget: Budget) -> Answer:
    if len(variables(system)) < 2:
        return by_cells(system, budget)
    along = any(r.op == "==" for r in system.given)
    return by_plane(system, budget) if along else by_region(system, budget)
