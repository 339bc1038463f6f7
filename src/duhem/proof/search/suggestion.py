"""What a search hands on: exact parameter values and exact points, worth an exact look.  Nothing here is certain."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from duhem.proof.facts.parameter_choices import Values
from duhem.proof.facts.plane_section import PlaneSection

__all__ = ["Chord", "Exit", "Point", "SectionCorner", "SharpPoint"]

Point = tuple[Fraction, ...]  # in the force space of the simple problem


@dataclass(frozen=True)
class Chord:
    """Two points of K, as it seems, whose midpoint is outside."""

    parameters: Values
    p: Point
    q: Point


@dataclass(frozen=True)
class Exit:
    """A segment from ``inside`` K, as it seems, to ``outside``: the boundary crosses it."""

    parameters: Values
    inside: Point
    outside: Point


@dataclass(frozen=True)
class SectionCorner:
    """A place in a plane of forces at which, as it seems, the boundary has a corner."""

    parameters: Values
    section: PlaneSection
    place: Point


@dataclass(frozen=True)
class SharpPoint:
    """A place from which, as it seems, K is left in the direction ``away`` and in the opposite one, and entered in ``into``."""

    parameters: Values
    place: Point
    away: Point
    into: Point
