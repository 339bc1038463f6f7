"""Proofs for laws given by a boundary curve: signs of the derivatives all around, and how often vectors turn.

Theorems used: a closed curve whose tangent turns once and to the left throughout is simple and bounds a convex set; one
that runs around 0 in polar order once is simple and bounds a set star-shaped about 0 (M. P. do Carmo 1976, section 5-7);
two fields that are nowhere opposite turn equally often.
"""

from __future__ import annotations

import sympy as sp

from duhem.expression.vocabulary import Neg, Norm, Pos, Where
from duhem.proof.decide import Sense
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.numeric_curve import LEAD, LEAN, POWER, STAR, TURNING
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["convexity", "dissipation", "duality", "normality", "origin", "smoothness"]

_KINKS = (sp.Abs, sp.Max, sp.Min, Pos, Neg, Where)


def origin(subject: CurveSubject) -> Evidence | None:
    """The curve winds around 0."""
    if not subject.shaped_by_parameters:
        turns = next((subject.turns_at(values, 0) for values in subject.choices(1)), None)
        return _proved("winding (interval)", f"the curve never meets 0 and winds around it {_times(turns)}") if turns else None
    turns = subject.flow_turns()
    if turns and (method := subject.positive(POWER)):
        return _proved(f"winding ({method})", f"T . d > 0, so T is never opposite to d and winds around 0 as d turns: {_times(turns)}")
    return _proved("winding", "T x T' > 0: the curve runs around 0 once") if _star(subject) else None


def convexity(subject: CurveSubject) -> Evidence | None:
    """T' x T'' > 0 and the tangent turns once."""
    method = _convex(subject)
    return _proved(f"turning-tangent ({method})", "T' x T'' > 0 at every angle and the tangent turns once") if method else None


def smoothness(subject: CurveSubject) -> Evidence | None:
    """A simple closed curve, smooth in its angle, that never stops."""
    method, reason = _convex(subject), "T' x T'' > 0, the tangent turning once"
    if not method:
        method, reason = _star(subject), "T x T' > 0, the curve running around 0 once"
    if not method or not _analytic(subject):
        return None
    return _proved(f"regular-curve ({method})", f"{reason}: simple and never at rest; T is an analytic function of the angle")


def normality(subject: CurveSubject) -> Evidence | None:
    """The flow is normal by definition, or d . T' = 0 with d on the outer side; K convex in either case."""
    if not _convex(subject):
        return None
    if subject.law.flow is None:
        return _proved("normality-rule", "the law is associated: its flow is the normal cone of K, and K is convex")
    if subject.vanishes(LEAN) and subject.positive(LEAD):
        return _proved("parallel", "d . T' = 0 and d x T' > 0: the flow is the outward normal at every angle, and K is convex")
    return None


def dissipation(subject: CurveSubject) -> Evidence | None:
    """T . d >= 0 at every angle."""
    pressure = subject.law.pressure
    if method := subject.positive(POWER):
        return _proved(f"power ({method})", f"T . d > 0 at every angle, so force . flow = |{pressure}| T . d > 0")
    if subject.law.flow is not None and (method := subject.nonnegative(POWER)):
        return _proved(f"power ({method})", f"T . d >= 0 at every angle, so force . flow = |{pressure}| T . d >= 0")
    return None


def duality(subject: CurveSubject) -> Evidence | None:
    """A boundary curve gives its support function point by point only."""
    if subject.law.flow is not None:
        return Evidence(Verdict.NOT_APPLICABLE, "curve", "the law has a flow of its own, which no potential of K gives")
    reason = "the support function of K is known along the curve only, Phi = T . n at the normal n, not in closed form"
    return Evidence(Verdict.NOT_APPLICABLE, "curve", reason)


def _convex(subject: CurveSubject) -> str | None:
    return subject.positive(TURNING) if subject.turns_once(1, TURNING) else None


def _star(subject: CurveSubject) -> str | None:
    return subject.positive(STAR) if subject.turns_once(0, STAR) else None


def _analytic(subject: CurveSubject) -> bool:
    """Whether T is built from analytic functions, roots of what is > 0 only (balls show that where parameters are fixed)."""
    if any(x.has(*_KINKS) or (subject.free and x.has(Norm)) for x in subject.boundary):
        return False
    radicands = {p.base for x in subject.boundary for p in x.atoms(sp.Pow) if not p.exp.is_Integer}
    return not subject.free or all(subject.ask(r, Sense.POSITIVE).method for r in radicands)


def _times(turns: int | None) -> str:
    return "once" if turns == 1 else f"{turns} times"


def _proved(method: str, detail: str) -> Evidence:
    return Evidence(Verdict.PROVED, method, detail)
