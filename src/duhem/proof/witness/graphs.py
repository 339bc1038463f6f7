"""Violations of a law kept as a graph, by signs enclosed in balls at rational points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Values
from duhem.proof.verdict import Witness
from duhem.proof.witness.points import decimal_pair, sign_at

__all__ = ["graph_chord", "graph_origin_outside"]

_CHORD = "g(p) <= 0 and g(q) <= 0, yet g > 0 at the midpoint of p and q: {g <= 0} is not convex"


def graph_chord(subject: GraphSubject, parameters: Values, p: Sequence[Fraction], q: Sequence[Fraction]) -> Witness | None:
    """Non-convexity: g(p) < 0, g(q) < 0 and g > 0 at the midpoint, or None if that is not certain."""
    middle = [(a + b) / 2 for a, b in zip(p, q, strict=True)]
    return _violation(subject, parameters, {"midpoint": (middle, 1), "p": (p, -1), "q": (q, -1)}, _CHORD)


def graph_origin_outside(subject: GraphSubject, parameters: Values) -> Witness | None:
    """g(0) > 0, or None if that is not certain."""
    zero = [Fraction(0)] * len(subject.law.forces)
    return _violation(subject, parameters, {"0": (zero, 1)}, "g > 0 at zero force: 0 is not in K")


def _violation(
    subject: GraphSubject, parameters: Values, wanted: Mapping[str, tuple[Sequence[Fraction], int]], statement: str
) -> Witness | None:
    law, table, shown = subject.law, subject.law.symbols(), dict[str, tuple[str, str]]()
    places = {role: subject.values_at(parameters, point) for role, (point, _) in wanted.items()}
    for role, (_, sign) in wanted.items():
        found, enclosure = sign_at(law.g, places[role])
        if found != sign:
            return None
        shown[f"g({role})"] = decimal_pair(enclosure)
    points = {"origin" if role == "0" else role: {x: str(at[table[x]]) for x in law.coordinates} for role, at in places.items()}
    own = {name: str(next(iter(places.values()))[table[name]]) for name in law.parameters}
    return Witness(own, points, shown, statement)
