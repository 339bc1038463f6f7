"""Laws given by a boundary curve T: refutations in balls.

Angles at which something seems violated are suggested in floats.  How far the flow leaves the normal is the greatest deviation of all
directions, by branch and bound.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import factorial
from typing import TYPE_CHECKING

import flint

from duhem.expression.balls import certain_sign
from duhem.proof.facts.curve_subject import Ball, CurveJet, CurveSubject, Greatest, NumericCurve, Span, Vector, cross, dot
from duhem.proof.facts.subject import Values
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.curves import backward_flow, leaning, origin_outside, triangle

if TYPE_CHECKING:
    from duhem.proof.search.curve_angles import Rim

__all__ = [
    "convexity_refuted", "deviation", "dissipation_refuted", "duality", "normality_by_deviation", "normality_refuted", "origin_refuted",
]  # fmt: skip

_WIDTH = 1e-9  # radians, that is 6e-8 degrees


def duality(subject: CurveSubject) -> Evidence | None:
    """A boundary curve gives its support function point by point only."""
    if subject.law.flow is not None:
        return Evidence(Verdict.NOT_APPLICABLE, "curve", "the law has its own flow direction, which does not derive from a potential of K")
    reason = "no closed form found: the support function of K is known only along the curve, Phi = T . n at the normal n"
    return Evidence(Verdict.NOT_APPLICABLE, "curve", reason)


def origin_refuted(subject: CurveSubject) -> Evidence | None:
    """The curve does not meet 0 and does not wind around it."""
    found = (origin_outside(subject, values) for values in subject.choices(12))
    return Evidence.refuted_by(found, "winding (interval)", "zero force is outside K")


def convexity_refuted(subject: CurveSubject) -> Evidence | None:
    """A point between three points of K that the curve does not wind around."""
    found = (witness for *_, witness in _dents(subject))
    return Evidence.refuted_by(found, "winding (interval)", "a triangle of boundary points holds a point outside K")


def dissipation_refuted(subject: CurveSubject) -> Evidence | None:
    """A boundary point where T . d < 0."""
    from duhem.proof.search.curve_angles import least_powers  # numpy, only when something is looked for

    found = (backward_flow(subject, values, t) for values, t in least_powers(subject, 12))
    return Evidence.refuted_by(found, "witness-power", "force . flow is negative on the boundary")


def normality_refuted(subject: CurveSubject) -> Evidence | None:
    """At the edge of a dent of K the normal points towards the other edge; a flow of the law's own towards zero force in K."""
    if subject.law.flow is not None:
        from duhem.proof.search.curve_angles import least_powers

        found = (leaning(subject, values, t) for values, t in least_powers(subject, 12))
        return Evidence.refuted_by(found, "witness-flow", "the flow leaves the normal cone of K")
    found = (leaning(subject, values, before, after, "normal") for values, (before, _, after), _ in _dents(subject))
    return Evidence.refuted_by(found, "witness-normal", "the normal is not in the normal cone at the edge of a dent")


def _dents(subject: CurveSubject) -> Iterator[tuple[Values, Rim, Witness]]:
    """Those that surely hold a point outside K, with such a point."""
    from duhem.proof.search.curve_angles import dents

    for values, rim in dents(subject, 200):
        if (witness := triangle(subject, values, rim)) is not None:
            yield values, rim, witness


def normality_by_deviation(subject: CurveSubject) -> Evidence | None:
    """A flow that leans from the boundary point of greatest deviation towards another boundary point."""
    if subject.law.flow is None:
        return None
    from duhem.proof.search.curve_angles import half_tangent, targets  # numpy, only when something is looked for

    for values in subject.choices(12):
        if not subject.simple_at(values) or not _deviates(subject, values):
            continue
        curve = subject.at(values)
        worst = curve.greatest(deviation, 3, _WIDTH)
        if worst is None:
            continue
        angle = _place(curve, worst)
        t, leans = half_tangent(angle), targets(subject, values, angle)
        if (witness := next(filter(None, (leaning(subject, values, t, u, deviation=worst.value) for u in leans)), None)) is not None:
            least, most = (math.degrees(float(x)) for x in (worst.value.lower(), worst.value.upper()))
            bound = "nowhere by more" if most - least < 1e-6 else f"nowhere by more than {most:.6g}"
            detail = f"the flow leaves the normal by {least:.6g} degrees at angle {subject.sense * math.degrees(angle):.6g}, and {bound}"
            return Evidence(Verdict.REFUTED, "deviation (interval)", detail, witness)
    return None


def _deviates(subject: CurveSubject, values: Values) -> bool:
    """Whether a few angles show a deviation at all."""
    curve = subject.at(values)
    jets = (curve.at(Fraction(k, 7), 1) for k in range(-20, 21, 3))
    return any(certain_sign(jet.lean) or certain_sign(jet.lead) == -1 for jet in jets)


def deviation(jet: CurveJet) -> tuple[Ball, Ball, Ball]:
    """The angle from the outward normal to the flow, its slope and second derivative by the angle (not a number at a jump)."""
    flow, tangent = _series(jet.flow), _series(jet.boundary[1:])
    lead, lean = cross(flow, tangent), dot(flow, tangent)
    side, half = certain_sign(lean[0]), flint.arb.pi() / 2
    if lead[0] > 0:
        signed, shift = (lean / lead).atan(), flint.arb(0)
    elif side in (1, -1):
        signed, shift = -(lead / lean).atan(), side * half
    elif lead[0] < 0:  # about pi, on either side
        return 2 * half - abs((lean / -lead).atan()[0]), flint.arb("nan"), flint.arb("nan")
    else:
        return half + half * flint.arb(0, 1), flint.arb("nan"), flint.arb("nan")
    return signed[0] + shift, signed[1], 2 * signed[2]


def _series(derivatives: Sequence[Vector]) -> list[Ball]:
    """Both components of a vector with its derivatives 0, 1, 2, ... by the angle, as far as the second."""
    return [flint.arb_series([v[i] / factorial(k) for k, v in enumerate(derivatives)], prec=3) for i in (0, 1)]


def _place(curve: NumericCurve, worst: Greatest) -> float:
    """An angle (radians) of greatest deviation: where its slope changes sign, by bisection; one that is >= 0 if there is."""
    low, high = _cluster(worst.arcs)
    for _ in range(40):
        middle = (low + high) / 2
        value, slope, _ = deviation(curve.over((middle, middle), 3))
        rising = certain_sign(value * slope)
        if rising is None:
            break
        low, high = (middle, high) if rising > 0 else (low, middle)
    return math.pi * float((low + high) / 2)


def _cluster(arcs: tuple[Span, ...]) -> Span:
    """Neighbouring arcs joined; the first such cluster at an angle >= 0, else the last."""
    joined: list[Span] = []
    for low, high in arcs:
        if joined and joined[-1][1] == low:
            joined[-1] = (joined[-1][0], high)
        else:
            joined.append((low, high))
    return next((span for span in joined if span[0] + span[1] >= 0), joined[-1])
