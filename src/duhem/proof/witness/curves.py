"""Violations of the claims by a boundary curve, shown in balls at exact angles (t = tan of half the angle is rational)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

import flint

from duhem.expression.balls import ball, certain_sign, precision
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.numeric_curve import POWER, Ball, Vector, cross, dot
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.verdict import Witness
from duhem.proof.witness.points import decimal_pair

__all__ = ["backward_flow", "inward_flow", "leaning_flow", "leaning_normal", "origin_outside", "triangle"]

_BITS = 256
Place = tuple[Fraction, Fraction]
Angles = tuple[Fraction, Fraction, Fraction]


def origin_outside(subject: CurveSubject, values: Values) -> Witness | None:
    """The curve does not meet 0 and does not wind around it."""
    if subject.turns_at(values, 0) != 0:
        return None
    statement = "the boundary curve does not meet zero force and winds around it 0 times: 0 is not in K"
    return _witness(subject, values, {"origin": (Fraction(0), Fraction(0))}, {"winding number": ("0", "0")}, statement)


def triangle(subject: CurveSubject, values: Values, rim: Angles) -> Witness | None:
    """Non-convexity by a rational point inside the triangle of three boundary points that the curve surely does not wind around."""
    curve = subject.at(values)
    with precision(_BITS):
        corners = [curve.point(t) for t in rim]
        middle = [sum((float(c[i].mid()) for c in corners), 0.0) / 3 for i in (0, 1)]
        z = (Fraction(middle[0]).limit_denominator(10**9), Fraction(middle[1]).limit_denominator(10**9))
        inner = (ball(z[0]), ball(z[1]))
        # cross products of the triangle's sides with the way to z: of one sign exactly when z is inside
        sides = [cross(_minus(b, a), _minus(inner, a)) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    if {certain_sign(side) for side in sides} not in ({1}, {-1}) or curve.winding(lambda j: _minus(j.boundary[0], inner), 0) != 0:
        return None
    shown = {f"side {role}": decimal_pair(side) for role, side in zip(("p m", "m q", "q p"), sides, strict=True)}
    statement = (
        "z lies inside the triangle of the boundary points p, m, q (the cross products of its sides with z have one sign), "
        "yet the boundary curve winds around z 0 times: K is not convex"
    )
    points: dict[str, Fraction | Place] = {**dict(zip("pmq", rim, strict=True)), "z": z}
    return _witness(subject, values, points, {**shown, "winding number around z": ("0", "0")}, statement)


def backward_flow(subject: CurveSubject, values: Values, t: Fraction) -> Witness | None:
    """T . d < 0 at a point of the boundary of K."""
    curve = subject.at(values)
    with precision(_BITS):
        power = POWER.of(curve.at(t, POWER.order))
        if certain_sign(power) != -1 or not subject.simple_at(values):
            return None
        shown = {**_coordinates(subject, "sigma", curve.point(t)), "force . flow": decimal_pair(power)}
    return _witness(subject, values, {"sigma": t}, shown, "force . flow < 0 at sigma")


def inward_flow(subject: CurveSubject, values: Values, t: Fraction) -> Witness | None:
    """The flow at a point of the boundary leans towards zero force, around which the curve winds."""
    curve = subject.at(values)
    with precision(_BITS):
        lean = -POWER.of(curve.at(t, POWER.order))
        if certain_sign(lean) != 1 or not subject.simple_at(values) or not subject.turns_at(values, 0):
            return None
        shown = {**_coordinates(subject, "sigma", curve.point(t)), "flow . (tau - sigma)": decimal_pair(lean)}
    statement = "the flow at sigma points towards tau, zero force, which is in K: it is not in the normal cone"
    return _witness(subject, values, {"sigma": t, "tau": (Fraction(0), Fraction(0))}, shown, statement)


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
    statement = "the outward normal at sigma points towards tau, a point of K: it is not in the normal cone"
    return _witness(subject, values, {"sigma": p, "tau": q}, shown, statement)


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
    statement = (
        "the flow at sigma points towards tau, a point of K: it is not in the normal cone; the deviation is the greatest of all angles"
    )
    return _witness(subject, values, {"sigma": t, "tau": u}, shown, statement, measures)


def _ends(subject: CurveSubject, sigma: Vector, tau: Vector) -> dict[str, tuple[str, str]]:
    return {**_coordinates(subject, "sigma", sigma), **_coordinates(subject, "tau", tau)}


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]


def _coordinates(subject: CurveSubject, role: str, point: Vector) -> dict[str, tuple[str, str]]:
    """Enclosures of a point's coordinates, by name."""
    return {f"{force}({role})": decimal_pair(flint.arb(x)) for force, x in zip(subject.law.forces, point, strict=True)}


def _witness(
    subject: CurveSubject,
    values: Values,
    points: Mapping[str, Fraction | Place],
    shown: Mapping[str, tuple[str, str]],
    statement: str,
    measures: Mapping[str, float] | None = None,
) -> Witness:
    """A violation at sigma_n = -1 and points by role: of the boundary by the tangent of half the angle, others by their coordinates."""
    law = subject.law
    table, known = law.symbols(), {**subject.fixed, **values}
    written = {
        role: {f"tan_half_{law.angle}": str(subject.sense * at)}
        if isinstance(at, Fraction)
        else {force: str(x) for force, x in zip(law.forces, at, strict=True)}
        for role, at in points.items()
    }
    at_pressure = {role: {**point, law.pressure: "-1"} for role, point in written.items()}
    return Witness({name: str(known[table[name]]) for name in law.parameters}, at_pressure, shown, statement, measures or {})
