"""Dissipation by Euler's relation alone, in any number of forces: no gauge, no convexity, no point inside K is needed.

With G_k the part of g of degree k in the forces, sigma . grad g is the sum of k G_k.  Where g = 0 it is the sum of (k - m) G_k as
well, for every m; one of these that is positive shows that g rises outward there.  For g = A - B of degrees a > b it is (a - b) B.
Of one degree alone g keeps its sign along each ray: K is a cone.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods.evidence import _by_forces, _in_pressure
from duhem.proof.statement import Problem
from duhem.proof.verdict import Evidence, Proof, Verdict
from tests.oracles.prover.star import by_degree

__all__ = ["dissipation", "dissipation_of_potential"]


def dissipation(subject: FormulaSubject) -> Evidence | None:
    """sigma . grad g > 0 wherever g = 0 but at zero force, where the power is 0; so it is for every limit of such gradients at a kink."""
    problem = subject.simple
    if subject.problem.associated and _cone(problem) and subject.joined(problem.g):
        detail = "g keeps its sign along each ray from 0, so K is a cone: its normals are across the force, and the power is 0"
        return Evidence(Verdict.PROVED, "homogeneity", detail, proof=Proof("homogeneity"))
    if not subject.problem.associated or (parts := by_degree(problem)) is None or not subject.joined(problem.g):
        return None
    away = sp.StrictGreaterThan(sp.Add(*(x**2 for x in problem.forces)), 0)
    for m in sorted(parts, reverse=True):
        rest = {k: part for k, part in parts.items() if k != m}
        power = sp.Add(*((k - m) * part for k, part in rest.items()))
        answer = subject.ask(power, Sense.POSITIVE, *([away] if power.free_symbols & set(problem.forces) else []))
        if answer.holds is True:
            detail = f"g has parts of degree {', '.join(map(str, sorted(parts)))} in the forces, so sigma . grad g > 0 wherever g = 0"
            return Evidence(Verdict.PROVED, f"homogeneity ({answer.method})", detail, proof=Proof("homogeneity"))
    return None


def _cone(problem: Problem) -> bool:
    """Whether g has one degree, or is the greatest or least of such."""
    if isinstance(problem.g, sp.Max | sp.Min):
        return all(_cone(replace(problem, g=part)) for part in problem.g.args)
    return len(by_degree(problem) or ()) == 1


def dissipation_of_potential(subject: FormulaSubject) -> Evidence | None:
    """A flow that is the gradient of a potential P has sigma . d = sum of k P_k; where g = 0 a multiple of g may be taken from it.

    So it is for every mean of gradients that meet at a kink or a tip, of which the formula of the flow says nothing.
    """
    law, problem = subject.law, subject.problem
    if law.potential is None or not subject.joined(problem.g):
        return None
    potential = parse_expression(law.potential, law.symbols()).subs({**law.settled(), **problem.compressed})
    if (parts := by_degree(replace(problem, g=potential))) is None or not subject.joined(potential):
        return None
    power, g = (_by_forces(expr, problem.forces) for expr in (sp.Add(*(k * part for k, part in parts.items())), problem.g))
    for share in dict.fromkeys([sp.S.Zero, *(sp.cancel(power[part] / c) for part, c in g.items() if part in power and part != 1)]):
        rest = sp.Add(*(sp.factor(power.get(part, 0) - share * g.get(part, 0)) * part for part in {**power, **g}))
        answer = subject.decided(Question(rest, Sense.NONNEGATIVE, problem.given))
        if answer.holds is True:
            detail = (
                f"the potential has parts of degree {', '.join(map(str, sorted(parts)))} in the forces, so force . flow >= 0 wherever g = 0"
            )
            stated = formula(_in_pressure(subject, share))
            return Evidence(Verdict.PROVED, f"potential ({answer.method})", detail, proof=Proof("potential", {"share": stated}))
    return None
