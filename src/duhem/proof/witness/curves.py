"""Violations of the claims by a boundary curve, shown in balls at exact angles (t = tan of half the angle is rational)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

import flint

from duhem.expression.balls import ball, certain_sign, precision
from duhem.proof.facts.curve_subject import Ball, CurveSubject, Vector, cross, dot
from duhem.proof.facts.subject import Values
from duhem.proof.verdict import Witness
from duhem.proof.witness.points import decimal_pair

__all__ = ["backward_flow", "leaning", "origin_outside", "triangle"]

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
    with precision(_BITS):
        jet = subject.at(values).at(t)
        power = dot(jet.boundary[0], jet.flow[0])
        if certain_sign(power) != -1 or not subject.simple_at(values):
            return None
        shown = {**_coordinates(subject, "sigma", jet.boundary[0]), "force . flow": decimal_pair(power)}
    return _witness(subject, values, {"sigma": t}, shown, "force . flow < 0 at sigma")


def leaning(
    subject: CurveSubject, values: Values, t: Fraction, u: Fraction | None = None, what: str = "flow", deviation: Ball | None = None
) -> Witness | None:
    """The flow, or the normal, at a point of the boundary of K leans towards another such point, or for None to zero force in K.

    The curve is known to be simple where the greatest ``deviation`` of a flow from the normal (radians) is, which is told then.
    """
    curve, zero = subject.at(values), (Fraction(0), Fraction(0))
    with precision(_BITS):
        jet = curve.at(t, 2)
        sigma, flow = jet.boundary[0], jet.flow[0]
        tau = (flint.arb(0), flint.arb(0)) if u is None else curve.point(u)
        lean = dot(flow, _minus(tau, sigma))
        if certain_sign(lean) != 1 or (deviation is None and not subject.simple_at(values)):
            return None
        if u is None and not subject.turns_at(values, 0):
            return None
        shown = _coordinates(subject, "sigma", sigma) | ({} if u is None else _coordinates(subject, "tau", tau))
        shown[f"{what} . (tau - sigma)"] = decimal_pair(lean)
        told, measures = "", dict[str, float]()
        if deviation is not None:
            degrees = deviation * 180 / flint.arb.pi()
            shown["greatest deviation in degrees"] = decimal_pair(degrees)
            slip = math.degrees(math.atan2(float(flow[1]), float(flow[0])))
            told = "; the deviation is the greatest of all angles"
            measures = {"deviation_degrees": float(degrees.lower()), "slip_angle_degrees": slip}
    place = "zero force, which is in K" if u is None else "a point of K"
    statement = f"the {'outward ' * (what == 'normal')}{what} at sigma points towards tau, {place}: it is not in the normal cone{told}"
    return _witness(subject, values, {"sigma": t, "tau": zero if u is None else u}, shown, statement, measures)


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
    table, known = law.symbols(), {**law.fixed_values(), **values}
    written = {
        role: {f"tan_half_{law.angle}": str(subject.sense * at)}
        if isinstance(at, Fraction)
        else {force: str(x) for force, x in zip(law.forces, at, strict=True)}
        for role, at in points.items()
    }
    at_pressure = {role: {**point, law.pressure: "-1"} for role, point in written.items()}
    return Witness({name: str(known[table[name]]) for name in law.parameters}, at_pressure, shown, statement, measures or {})
