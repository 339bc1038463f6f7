"""Violations of the claims by a boundary curve, at exact angles (t = tan of half the angle is rational) in balls."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from duhem.expression.balls import ball, certain_sign, precision
from duhem.proof.facts.curve_quantities import POWER
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.numeric_curve import NumericCurve, Vector, cross, dot
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.curve_points import at_angle, coordinates, parameters
from duhem.proof.witness.rational_points import decimal_pair

__all__ = ["convexity", "dissipation", "normality_of_a_dent", "origin"]

_BITS = 256
_CHOICES = 200


def origin(subject: CurveSubject) -> Evidence | None:
    """The curve does not meet 0 and does not wind around it."""
    for values in subject.choices(12):
        if subject.exhausted:
            return None
        if subject.turns_at(values, 0) == 0:
            point = {force: "0" for force in subject.law.forces} | {subject.law.pressure: "-1"}
            statement = "the boundary curve does not meet zero force and winds around it 0 times: 0 is not in K"
            witness = Witness(parameters(subject, values), {"origin": point}, {"winding number": ("0", "0")}, statement)
            return Evidence(Verdict.REFUTED, "winding (interval)", "zero force is outside K", witness)
    return None


def convexity(subject: CurveSubject) -> Evidence | None:
    """A point between three points of K that the curve does not wind around."""
    for values, t, z in _dents(subject):
        curve = subject.at(values)
        with precision(_BITS):
            shown = {f"side {a} {b}": decimal_pair(side) for (a, b), side in zip(_SIDES, _sides(curve, t, z), strict=True)}
        points = {role: at_angle(subject, x) for role, x in zip("pmq", t, strict=True)}
        points["z"] = {force: str(x) for force, x in zip(subject.law.forces, z, strict=True)} | {subject.law.pressure: "-1"}
        statement = (
            "z lies inside the triangle of the boundary points p, m, q (the cross products of its sides with z have one sign), "
            "yet the boundary curve winds around z 0 times: K is not convex"
        )
        witness = Witness(parameters(subject, values), points, {**shown, "winding number around z": ("0", "0")}, statement)
        return Evidence(Verdict.REFUTED, "winding (interval)", "a triangle of boundary points holds a point outside K", witness)
    return None


def dissipation(subject: CurveSubject) -> Evidence | None:
    """A boundary point where T . d < 0."""
    from duhem.proof.search.curve_angles import CurveScouts, half_tangent

    scouts = CurveScouts(subject)
    for values in subject.choices(12):
        if subject.exhausted:
            return None
        scout = scouts.at(values)
        t, curve = half_tangent(scout.angle(scout.least_power())), subject.at(values)
        with precision(_BITS):
            power = POWER.of(curve.at(t, POWER.order))
            if certain_sign(power) == -1 and subject.simple_at(values):
                shown = {**coordinates(subject, "sigma", curve.point(t)), "force . flow": decimal_pair(power)}
                witness = Witness(parameters(subject, values), {"sigma": at_angle(subject, t)}, shown, "force . flow < 0 at sigma")
                return Evidence(Verdict.REFUTED, "witness-power", "force . flow is negative on the boundary", witness)
    return None


def normality_of_a_dent(subject: CurveSubject) -> Evidence | None:
    """Associated flow on a non-convex K: at the edge of a dent the normal points towards the other edge."""
    if subject.law.flow is not None:
        return None
    for values, (p, _, q), _ in _dents(subject):
        curve = subject.at(values)
        if not subject.simple_at(values):
            continue
        with precision(_BITS):
            sigma, tau = curve.point(p), curve.point(q)
            lean = dot(curve.at(p).flow[0], _minus(tau, sigma))
            if certain_sign(lean) != 1:
                continue
            shown = {
                **coordinates(subject, "sigma", sigma),
                **coordinates(subject, "tau", tau),
                "normal . (tau - sigma)": decimal_pair(lean),
            }
        points = {"sigma": at_angle(subject, p), "tau": at_angle(subject, q)}
        statement = "the outward normal at sigma points towards tau, a point of K: it is not in the normal cone"
        witness = Witness(parameters(subject, values), points, shown, statement)
        return Evidence(Verdict.REFUTED, "witness-normal", "the normal is not in the normal cone at the edge of a dent", witness)
    return None


_SIDES = (("p", "m"), ("m", "q"), ("q", "p"))


def _dents(subject: CurveSubject) -> Iterator[tuple[Values, tuple[Fraction, Fraction, Fraction], tuple[Fraction, Fraction]]]:
    """Choices of parameters with angles p, m, q on the rim and a rational point between them, surely outside K."""
    from duhem.proof.search.curve_angles import CurveScouts, half_tangent

    scouts = CurveScouts(subject)
    for values in subject.choices(_CHOICES):
        if subject.exhausted:
            return
        scout = scouts.at(values)
        k = scout.dent()
        for step in (40, 20, 10, 5, 2, 1) if k is not None else ():
            assert k is not None
            one, two, three = (half_tangent(scout.angle(k + shift)) for shift in (-step, 0, step))
            curve = subject.at(values)
            with precision(_BITS):
                corners = [curve.point(x) for x in (one, two, three)]
                middle = [sum((float(c[i].mid()) for c in corners), 0.0) / 3 for i in (0, 1)]
                z = (Fraction(middle[0]).limit_denominator(10**9), Fraction(middle[1]).limit_denominator(10**9))
                signs = {certain_sign(side) for side in _sides(curve, (one, two, three), z)}
            if signs in ({1}, {-1}) and curve.winding(lambda j, z=z: _minus(j.boundary[0], _exact(z)), 0) == 0:  # type: ignore[misc]
                yield values, (one, two, three), z


def _sides(curve: NumericCurve, t: tuple[Fraction, ...], z: tuple[Fraction, Fraction]) -> list[Any]:
    """Cross products of the triangle's sides with the way to z: of one sign exactly when z is inside."""
    corners, inner = [curve.point(x) for x in t], _exact(z)
    return [cross(_minus(b, a), _minus(inner, a)) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]


def _exact(z: tuple[Fraction, Fraction]) -> Vector:
    return ball(z[0]), ball(z[1])


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]
