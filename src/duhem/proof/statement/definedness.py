"""Whether a law's formula means something for every parameter value it admits."""

from __future__ import annotations

import sympy as sp

from duhem.errors import InputError
from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.statement.problem import Problem

__all__ = ["check_quotients"]

_REMEDY = "keep its domain away from there (positive = true, or a least value above 0)"


def check_quotients(problem: Problem) -> None:
    """Raise InputError where the formula divides by something that is 0 for admitted parameter values."""
    law, forces = problem.law, set(problem.law.force_symbols())
    if problem.g.has(sp.zoo, sp.nan, sp.oo, -sp.oo):
        raise InputError(f"{formula(law.g)} is undefined at the fixed values", where=law.name, remedy=_REMEDY)
    bases = {p.base for p in problem.g.atoms(sp.Pow) if p.exp.could_extract_minus_sign() and not p.base.free_symbols & forces}
    for base in sorted(bases, key=str):
        answer = decide(Question(base**2, Sense.POSITIVE, problem.given))
        point = {x: v for x, v in (answer.point or {}).items() if x in base.free_symbols}
        if answer.holds is False and base.free_symbols <= point.keys() and base.subs(point) == 0:
            at = ", ".join(f"{x} = {v}" for x, v in point.items())
            raise InputError(f"g divides by {formula(base)}, which is 0 at {at}", where=law.name, remedy=_REMEDY)
