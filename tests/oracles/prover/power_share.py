"""Dissipation of a flow of the law's own whose power is a constant times g and something >= 0, such as sqrt(J2) + beta I1 of a cone.

Where a tip of g is 0, as at an apex, the formula of such a flow may have no value: there the slip is any mean of limits of the flow from
around (Koiter 1953).  Their power is >= 0 too, for what is >= c g around is so in the limit.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from duhem.expression.parse import parse_expression
from duhem.proof.decide import Question, Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods.evidence import dissipation_by_shares
from duhem.proof.verdict import Evidence
from tests.oracles.prover.regularity import regularity

__all__ = ["dissipation"]


def dissipation(subject: FormulaSubject) -> Evidence | None:
    """sigma . d = c g + something >= 0, so that it is >= 0 wherever g = 0: what is offered for it, worked out and decided by SymPy."""
    law, problem = subject.law, subject.problem
    if law.flow is None or subject.doubtful or not subject.joined(problem.g) or not _defined_but_at_tips(subject):
        return None
    power = sp.Add(*(x * d for x, d in zip(law.force_symbols(), law.flow, strict=True)))
    for offer in dissipation_by_shares(subject):
        assert offer.proof is not None
        share, rest = (parse_expression(offer.proof.evidence[key], law.symbols()) for key in ("share", "rest"))
        answer = subject.decided(Question(rest.xreplace(dict(problem.compressed)), Sense.NONNEGATIVE, problem.given))
        if answer.holds is True and sp.simplify((power - share * law.g - rest).xreplace(law.settled())) == 0:
            return replace(offer, method=f"power-share ({answer.method})")
    return None


def _defined_but_at_tips(subject: FormulaSubject) -> bool:
    """Whether the flow has a value wherever tips of g, which are 0 on no open set, are not 0."""
    problem, found = subject.problem, regularity(subject.problem.g, subject)
    if not subject.doubtful_flow:
        return True
    tips = [tip for tip in found.tips if _rarely_zero(tip, problem.forces)] if found.known and not found.kinks else []
    there = tuple(sp.StrictGreaterThan(tip, 0) for tip in tips)
    return bool(there) and not any(subject.open_obligations(trees, there) for trees in problem.stated_flows)


def _rarely_zero(tip: sp.Expr, forces: tuple[sp.Symbol, ...]) -> bool:
    return bool(tip.is_polynomial(*forces) and any(c.is_number for c in sp.Poly(tip, *forces).coeffs()))
