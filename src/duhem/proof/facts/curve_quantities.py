"""The signs that decide the claims of a boundary curve, as functions of its derivatives by the angle.

With T the boundary, d the flow and ' the derivative by the angle (the curve runs counter-clockwise):
power T . d, star T x T' (> 0: the curve runs around 0 in polar order), turning T' x T'' (> 0: it turns left throughout),
lead d x T' (> 0: the flow is less than a right angle from the outward normal), lean d . T' (0: the flow is normal).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from duhem.proof.facts.numeric_curve import CurveJet, cross, dot

__all__ = ["LEAD", "LEAN", "POWER", "STAR", "TURNING", "Quantity"]


@dataclass(frozen=True)
class Quantity:
    """A function of a jet of this order; ``linear`` in the boundary or not."""

    name: str
    order: int
    of: Callable[[CurveJet], Any]
    linear: bool


POWER = Quantity("T . d", 0, lambda j: dot(j.boundary[0], j.flow[0]), True)
STAR = Quantity("T x T'", 1, lambda j: cross(j.boundary[0], j.boundary[1]), False)
TURNING = Quantity("T' x T''", 2, lambda j: cross(j.boundary[1], j.boundary[2]), False)
LEAD = Quantity("d x T'", 1, lambda j: cross(j.flow[0], j.boundary[1]), True)
LEAN = Quantity("d . T'", 1, lambda j: dot(j.flow[0], j.boundary[1]), True)
