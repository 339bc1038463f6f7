"""How far the flow of a boundary curve leaves the normal: the greatest deviation of all directions, by branch and bound."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from math import factorial

import flint

from duhem.expression.balls import certain_sign, precision
from duhem.proof.facts.curve_quantities import LEAD, LEAN
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.numeric_curve import Ball, CurveJet, Greatest, NumericCurve, Span, cross, dot
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.curve_points import at_angle, coordinates, parameters
from duhem.proof.witness.rational_points import decimal_pair

__all__ = ["normality"]

_WIDTH = 1e-9  # radians, that is 6e-8 degrees
_BITS = 256
_STATEMENT = "the flow at sigma points towards tau, a point of K: it is not in the normal cone; the deviation is the greatest of all angles"


def normality(subject: CurveSubject) -> Evidence | None:
    """A flow that leans from the boundary point of greatest deviation towards another boundary point."""
    if subject.law.flow is None:
        return None
    for values in subject.choices(12):
        if subject.exhausted:
            return None
        if not subject.simple_at(values) or not _deviates(subject, values):
            continue
        curve = subject.at(values)
        worst = curve.greatest(deviation, 3, _WIDTH)
        if worst is None:
            continue
        angle = _place(curve, worst)
        if (witness := _witness(subject, values, curve, worst, angle)) is not None:
            least, most = (math.degrees(float(x)) for x in (worst.value.lower(), worst.value.upper()))
            bound = "nowhere by more" if most - least < 1e-6 else f"nowhere by more than {most:.6g}"
            detail = f"the flow leaves the normal by {least:.6g} degrees at angle {math.degrees(angle):.6g}, and {bound}"
            return Evidence(Verdict.REFUTED, "deviation (interval)", detail, witness)
    return None


def _deviates(subject: CurveSubject, values: Values) -> bool:
    """Whether a few angles show a deviation at all."""
    curve = subject.at(values)
    return any(certain_sign(LEAN.of(curve.at(Fraction(k, 7), 1))) in (1, -1) for k in range(-20, 21, 3)) or any(
        certain_sign(LEAD.of(curve.at(Fraction(k, 7), 1))) == -1 for k in range(-20, 21, 3)
    )


def deviation(jet: CurveJet) -> tuple[Ball, Ball, Ball]:
    """The angle from the outward normal to the flow, its slope and second derivative by the angle (not a number at a jump)."""
    tangent = [flint.arb_series([v[i] / factorial(k) for k, v in enumerate(jet.boundary[1:4])], prec=3) for i in (0, 1)]
    flow = [flint.arb_series([v[i] / factorial(k) for k, v in enumerate(jet.flow[:3])], prec=3) for i in (0, 1)]
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


def _witness(subject: CurveSubject, values: Values, curve: NumericCurve, worst: Greatest, angle: float) -> Witness | None:
    from duhem.proof.search.curve_angles import half_tangent

    with precision(_BITS):
        t = half_tangent(angle)
        jet = curve.at(t, 2)
        sigma, flow = jet.boundary[0], jet.flow[0]
        for u in _targets(subject, values, jet, angle):
            tau = curve.point(u)
            lean = dot(flow, (tau[0] - sigma[0], tau[1] - sigma[1]))
            if certain_sign(lean) == 1:
                degrees = worst.value * 180 / flint.arb.pi()
                shown = {
                    **coordinates(subject, "sigma", sigma),
                    **coordinates(subject, "tau", tau),
                    "flow . (tau - sigma)": decimal_pair(lean),
                    "greatest deviation in degrees": decimal_pair(degrees),
                }
                points = {"sigma": at_angle(subject, t), "tau": at_angle(subject, u)}
                slip = math.degrees(math.atan2(float(flow[1]), float(flow[0])))
                measures = {"deviation_degrees": float(degrees.lower()), "slip_angle_degrees": slip}
                return Witness(parameters(subject, values), points, shown, _STATEMENT, measures)
    return None


def _targets(subject: CurveSubject, values: Values, jet: CurveJet, angle: float) -> Iterator[Fraction]:
    """Where the flow may lean to: far along the boundary first, then close by at the scale of the deviation itself."""
    from duhem.proof.search.curve_angles import CurveScouts, half_tangent

    point, slip = ([float(x) for x in v] for v in (jet.boundary[0], jet.flow[0]))
    for other in CurveScouts(subject).at(values).targets(slip, point):
        yield half_tangent(other)
    turn = math.atan2(float(LEAN.of(jet)), float(LEAD.of(jet)))
    for digits in range(8):
        yield half_tangent(angle + turn / 10**digits, 15)
