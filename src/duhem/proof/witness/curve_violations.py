"""Violations of the claims by a boundary curve, shown in balls at exact angles (t = tan of half the angle is rational)."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import flint

from duhem.expression.balls import ball, certain_sign, precision
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.numeric_curve import POWER, Ball, NumericCurve, Vector, cross, dot
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.verdict import Witness
from duhem.proof.witness.curve_points import at_angle, coordinates, parameters
from duhem.proof.witness.rational_points import decimal_pair

__all__ = ["backward_flow", "leaning_flow", "leaning_normal", "origin_outside", "outside_point", "triangle"]

_BITS = 256
Angles = tuple[Fraction, Fraction, Fraction]
_SIDES = (("p", "m"), ("m", "q"), ("q", "p"))


def origin_outside(subject: CurveSubject, values: Values) -> Witness | None:
    """The curve does not meet 0 and does not wind around it."""
    if subject.turns_at(values, 0) != 0:
        return None
    point = {force: "0" for force in subject.law.forces} | {subject.law.pressure: "-1"}
    statement = "the boundary curve does not meet zero force and winds around it 0 times: 0 is not in K"
    return Witness(parameters(subject, values), {"origin": point}, {"winding number": ("0", "0")}, statement)


def outside_point(subject: CurveSubject, values: Values, rim: Angles) -> tuple[Fraction, Fraction] | None:
    """A rational point inside the triangle of three boundary points that the curve surely does not wind around."""
    curve = subject.at(values)
    with precision(_BITS):
        corners = [curve.point(t) for t in rim]
        middle = [sum((float(c[i].mid()) for c in corners), 0.0) / 3 for i in (0, 1)]
        z = (Fraction(middle[0]).limit_denominator(10**9), Fraction(middle[1]).limit_denominator(10**9))
        signs = {certain_sign(side) for side in _sides(curve, rim, z)}
    if signs in ({1}, {-1}) and curve.winding(lambda j: _minus(j.boundary[0], _exact(z)), 0) == 0:
        return z
    return None


def triangle(subject: CurveSubject, values: Values, rim: Angles, z: tuple[Fraction, Fraction]) -> Witness:
    """Non-convexity by such a point."""
    curve = subject.at(values)
    with precision(_BITS):
        shown = {f"side {a} {b}": decimal_pair(side) for (a, b), side in zip(_SIDES, _sides(curve, rim, z), strict=True)}
    points = {role: at_angle(subject, x) for role, x in zip("pmq", rim, strict=True)}
    points["z"] = {force: str(x) for force, x in zip(subject.law.forces, z, strict=True)} | {subject.law.pressure: "-1"}
    statement = (
        "z lies inside the triangle of the boundary points p, m, q (the cross products of its sides with z have one sign), "
        "yet the boundary curve winds around z 0 times: K is not convex"
    )
    return Witness(parameters(subject, values), points, {**shown, "winding number around z": ("0", "0")}, statement)


def backward_flow(subject: CurveSubject, values: Values, t: Fraction) -> Witness | None:
    """T . d < 0 at a point of the boundary of K."""
    curve = subject.at(values)
    with precision(_BITS):
        power = POWER.of(curve.at(t, POWER.order))
        if certain_sign(power) != -1 or not subject.simple_at(values):
            return None
        shown = {**coordinates(subject, "sigma", curve.point(t)), "force . flow": decimal_pair(power)}
    return Witness(parameters(subject, values), {"sigma": at_angle(subject, t)}, shown, "force . flow < 0 at sigma")


def leaning_normal(subject: CurveSubject, values: Values, p: Fraction, q: Fraction) -> Witness | None:
    """The normal of a simple curve at one boundary point leans towards another."""
    curve = subject.at(values)
    if not subject.simple_at(values):
        return None
    with precision(_BITS):
        sigma, tau = curve.point(p), curve.point(q)
        lean = dot(curve.at(p).flow[0], _minus(tau, sigma))
        if certain_sign(lean) != 1:
            return None
        shown = {**_ends(subject, sigma, tau), "normal . (tau - sigma)": decimal_pair(lean)}
    points = {"sigma": at_angle(subject, p), "tau": at_angle(subject, q)}
    statement = "the outward normal at sigma points towards tau, a point of K: it is not in the normal cone"
    return Witness(parameters(subject, values), points, shown, statement)


def leaning_flow(subject: CurveSubject, values: Values, t: Fraction, u: Fraction, deviation: Ball) -> Witness | None:
    """The flow at the boundary point of greatest ``deviation`` from the normal (radians) leans towards another boundary point."""
    curve = subject.at(values)
    with precision(_BITS):
        jet = curve.at(t, 2)
        sigma, flow, tau = jet.boundary[0], jet.flow[0], curve.point(u)
        lean = dot(flow, _minus(tau, sigma))
        if certain_sign(lean) != 1:
            return None
        degrees = deviation * 180 / flint.arb.pi()
        shown = {
            **_ends(subject, sigma, tau),
            "flow . (tau - sigma)": decimal_pair(lean),
            "greatest deviation in degrees": decimal_pair(degrees),
        }
        slip = math.degrees(math.atan2(float(flow[1]), float(flow[0])))
        measures = {"deviation_degrees": float(degrees.lower()), "slip_angle_degrees": slip}
    points = {"sigma": at_angle(subject, t), "tau": at_angle(subject, u)}
    statement = (
        "the flow at sigma points towards tau, a point of K: it is not in the normal cone; the deviation is the greatest of all angles"
    )
    return Witness(parameters(subject, values), points, shown, statement, measures)


def _ends(subject: CurveSubject, sigma: Vector, tau: Vector) -> dict[str, tuple[str, str]]:
    return {**coordinates(subject, "sigma", sigma), **coordinates(subject, "tau", tau)}


def _sides(curve: NumericCurve, rim: Angles, z: tuple[Fraction, Fraction]) -> list[Any]:
    """Cross products of the triangle's sides with the way to z: of one sign exactly when z is inside."""
    corners, inner = [curve.point(t) for t in rim], _exact(z)
    return [cross(_minus(b, a), _minus(inner, a)) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]


def _exact(z: tuple[Fraction, Fraction]) -> Vector:
    return ball(z[0]), ball(z[1])


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]
