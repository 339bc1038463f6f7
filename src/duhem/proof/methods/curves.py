"""Laws given by a boundary curve T: refutations in balls.

Angles at which something seems violated are suggested in floats.  How far the flow leaves the normal is the greatest deviation of all
directions, by branch and bound.  What is shown is shown at exact angles: t = tan of half the angle is rational.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import factorial
from typing import TYPE_CHECKING

import flint

from duhem.expression.balls import ball, certain_sign, precision
from duhem.proof.facts.curve_subject import Ball, CurveJet, CurveSubject, Greatest, NumericCurve, Span, Vector, cross, dot
from duhem.proof.facts.subject import Values
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.points import decimal_pair

if TYPE_CHECKING:
    from duhem.proof.search.curve_angles import Rim

__all__ = [
    "convexity_refuted",
    "deviation",
    "dissipation_refuted",
    "duality",
    "normality_by_deviation",
    "normality_refuted",
    "origin_refuted",
]

_WIDTH = 1e-9  # radians, that is 6e-8 degrees


def duality(subject: CurveSubject) -> Evidence | None:
    """A boundary curve gives its support function point by point only."""
    if subject.law.flow is not None:
        return Evidence(Verdict.NOT_APPLICABLE, "curve", "the law has its own flow direction, which does not derive from a potential of K")
    reason = "no closed form found: the support function of K is known only along the curve, Phi = T . n at the normal n"
    return Evidence(Verdict.NOT_APPLICABLE, "curve", reason)


def origin_refuted(subject: CurveSubject) -> Evidence | None:
    """The curve does not meet 0 and does not wind around it."""
    for values in subject.choices(12):
        if (witness := origin_outside(subject, values)) is not None:
            return Evidence(Verdict.REFUTED, "winding (interval)", "zero force is outside K", witness)
    return None


def convexity_refuted(subject: CurveSubject) -> Evidence | None:
    """A point between three points of K that the curve does not wind around."""
    for *_, witness in _dents(subject):
        return Evidence(Verdict.REFUTED, "winding (interval)", "a triangle of boundary points holds a point outside K", witness)
    return None


def dissipation_refuted(subject: CurveSubject) -> Evidence | None:
    """A boundary point where T . d < 0."""
    from duhem.proof.search.curve_angles import least_powers  # numpy, only when something is looked for

    for values, t in least_powers(subject, 12):
        if (witness := backward_flow(subject, values, t)) is not None:
            return Evidence(Verdict.REFUTED, "witness-power", "force . flow is negative on the boundary", witness)
    return None


def normality_refuted(subject: CurveSubject) -> Evidence | None:
    """At the edge of a dent of K the normal points towards the other edge; a flow of the law's own towards zero force in K."""
    if subject.law.flow is not None:
        from duhem.proof.search.curve_angles import least_powers

        for values, t in least_powers(subject, 12):
            if (witness := leaning(subject, values, t)) is not None:
                return Evidence(Verdict.REFUTED, "witness-flow", "the flow leaves the normal cone of K", witness)
        return None
    for values, (before, _, after), _ in _dents(subject):
        if (witness := leaning(subject, values, before, after, "normal")) is not None:
            return Evidence(Verdict.REFUTED, "witness-normal", "the normal is not in the normal cone at the edge of a dent", witness)
    return None


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


# -- violations at exact angles ----------------------------------------------------------------------------------------


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
            told, measures = (
                "; the deviation is the greatest of all angles",
                {"deviation_degrees": float(degrees.lower()), "slip_angle_degrees": slip},
            )
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
    table, known = law.symbols(), {**subject.fixed, **values}
    written = {
        role: {f"tan_half_{law.angle}": str(subject.sense * at)}
        if isinstance(at, Fraction)
        else {force: str(x) for force, x in zip(law.forces, at, strict=True)}
        for role, at in points.items()
    }
    at_pressure = {role: {**point, law.pressure: "-1"} for role, point in written.items()}
    return Witness({name: str(known[table[name]]) for name in law.parameters}, at_pressure, shown, statement, measures or {})
