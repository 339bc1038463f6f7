"""What follows for a law from claims that are proved: its flow is normal, or dissipates."""

from __future__ import annotations

from collections.abc import Mapping

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["by_convexity", "by_normality"]


def by_convexity(subject: FormulaSubject, settled: Mapping[str, Evidence]) -> Evidence | None:
    """The flow of an associated law is the normal cone of K if K is convex."""
    if subject.problem.associated and settled["convexity"].verdict is Verdict.PROVED:
        return Evidence(Verdict.PROVED, "normality-rule", "the law is associated: its flow is the normal cone of K, and K is convex")
    return None


def by_normality(subject: FormulaSubject, settled: Mapping[str, Evidence]) -> Evidence | None:
    """0 in K and a flow in the normal cone: d . (0 - sigma) <= 0."""
    if all(settled[name].verdict is Verdict.PROVED for name in ("origin", "normality")):
        return Evidence(Verdict.PROVED, "fenchel", "0 lies in K and the flow d lies in the normal cone at sigma, so d . (0 - sigma) <= 0")
    return None
