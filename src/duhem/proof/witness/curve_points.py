"""How a violation on a boundary curve is written down: exact angles, exact parameters, enclosed coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import flint
import sympy as sp

from duhem.proof.facts.curve import CurveCase, Values
from duhem.proof.facts.curve_balls import Vector
from duhem.proof.witness.rational_points import decimal_pair

__all__ = ["at_angle", "coordinates", "parameters"]


def at_angle(case: CurveCase, t: Fraction) -> dict[str, str]:
    """A boundary point at sigma_n = -1 by the tangent of half its angle."""
    return {f"tan_half_{case.law.angle}": str(t), case.law.pressure: "-1"}


def coordinates(case: CurveCase, role: str, point: Vector) -> dict[str, tuple[str, str]]:
    """Enclosures of a point's coordinates, by name."""
    return {f"{force}({role})": decimal_pair(flint.arb(x)) for force, x in zip(case.law.forces, point, strict=True)}


def parameters(case: CurveCase, values: Values) -> Mapping[str, str]:
    """Every parameter's exact value, by name."""
    table = case.law.symbols()
    known: dict[sp.Symbol, sp.Rational] = {**case.fixed, **values}
    return {name: str(known[table[name]]) for name in case.law.parameters}
