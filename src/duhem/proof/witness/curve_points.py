"""How a violation on a boundary curve is written down: exact angles, exact parameters, enclosed coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import flint

from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.numeric_curve import Vector
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.witness.rational_points import decimal_pair

__all__ = ["at_angle", "coordinates", "parameters"]


def at_angle(subject: CurveSubject, t: Fraction) -> dict[str, str]:
    """A boundary point at sigma_n = -1 by the tangent of half its angle."""
    return {f"tan_half_{subject.law.angle}": str(subject.sense * t), subject.law.pressure: "-1"}


def coordinates(subject: CurveSubject, role: str, point: Vector) -> dict[str, tuple[str, str]]:
    """Enclosures of a point's coordinates, by name."""
    return {f"{force}({role})": decimal_pair(flint.arb(x)) for force, x in zip(subject.law.forces, point, strict=True)}


def parameters(subject: CurveSubject, values: Values) -> Mapping[str, str]:
    """Every parameter's exact value, by name."""
    table = subject.law.symbols()
    known = {**subject.fixed, **values}
    return {name: str(known[table[name]]) for name in subject.law.parameters}
