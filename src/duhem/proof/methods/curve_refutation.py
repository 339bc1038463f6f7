"""Refutations for laws given by a boundary curve: angles suggested in floats, violations shown in balls."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.curve_violations import backward_flow, leaning_normal, origin_outside, outside_point, triangle

if TYPE_CHECKING:
    from duhem.proof.search.curve_angles import Dent

__all__ = ["convexity", "dissipation", "normality_of_a_dent", "origin"]


def origin(subject: CurveSubject) -> Evidence | None:
    """The curve does not meet 0 and does not wind around it."""
    for values in subject.choices(12):
        if (witness := origin_outside(subject, values)) is not None:
            return Evidence(Verdict.REFUTED, "winding (interval)", "zero force is outside K", witness)
    return None


def convexity(subject: CurveSubject) -> Evidence | None:
    """A point between three points of K that the curve does not wind around."""
    for dent, z in _dents(subject):
        witness = triangle(subject, dent.parameters, dent.rim, z)
        return Evidence(Verdict.REFUTED, "winding (interval)", "a triangle of boundary points holds a point outside K", witness)
    return None


def dissipation(subject: CurveSubject) -> Evidence | None:
    """A boundary point where T . d < 0."""
    from duhem.proof.search.curve_angles import least_powers  # numpy, only when something is looked for

    for values, t in least_powers(subject, 12):
        if (witness := backward_flow(subject, values, t)) is not None:
            return Evidence(Verdict.REFUTED, "witness-power", "force . flow is negative on the boundary", witness)
    return None


def normality_of_a_dent(subject: CurveSubject) -> Evidence | None:
    """Associated flow on a non-convex K: at the edge of a dent the normal points towards the other edge."""
    if subject.law.flow is not None:
        return None
    for dent, _ in _dents(subject):
        if (witness := leaning_normal(subject, dent.parameters, dent.rim[0], dent.rim[2])) is not None:
            return Evidence(Verdict.REFUTED, "witness-normal", "the normal is not in the normal cone at the edge of a dent", witness)
    return None


def _dents(subject: CurveSubject) -> Iterator[tuple[Dent, tuple[Fraction, Fraction]]]:
    """Those that surely hold a point outside K, with such a point."""
    from duhem.proof.search.curve_angles import dents

    for dent in dents(subject, 200):
        if (z := outside_point(subject, dent.parameters, dent.rim)) is not None:
            yield dent, z
