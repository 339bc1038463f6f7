"""Refuters of a law kept as a graph: points at which its value, enclosed, breaks a claim.

The points are rational, and signs are enclosed in balls.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction

from duhem.expression.abbreviations import names_in
from duhem.expression.number import DECIMAL
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Values
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.points import decimal_pair, sign_at

__all__ = ["convexity_left_open", "convexity_refuted", "duality_left_out", "origin_refuted"]

_CHOICES = 3
_WORD = re.compile(r"\w\s*\(|\*\*")
_NEGATIVE = re.compile(rf"-\s*(?P<number>{DECIMAL})\)?\s*\*\s*(?P<of>[^\W\d]\w*)(?!\s*\()")


def origin_refuted(subject: GraphSubject) -> Evidence | None:
    """Parameters at which g(0) > 0."""
    found = (graph_origin_outside(subject, parameters) for parameters in subject.choices(_CHOICES))
    witness = next((w for w in found if w is not None), None)
    return None if witness is None else Evidence(Verdict.REFUTED, "witness-point", "zero force is outside K", witness)


def convexity_refuted(subject: GraphSubject) -> Evidence | None:
    """A chord that leaves K."""
    from duhem.proof.search.graph_chords import graph_chords

    for parameters in subject.choices(_CHOICES):
        for p, q in graph_chords(subject, parameters):
            if (witness := graph_chord(subject, parameters, p, q)) is not None:
                return Evidence(Verdict.REFUTED, "witness-chord", "a chord between two points of K leaves K", witness)
    return None


def convexity_left_open(subject: GraphSubject) -> Evidence | None:
    """Which weight is negative, where one is, so that convexity does not follow from the structure of a network."""
    graph = subject.law.graph
    nodes = () if graph is None else (*graph.nodes, ("g", graph.last))
    curved = set[str]()  # of words, or of what is
    for name, text in nodes:
        found = next((part for part in _NEGATIVE.finditer(text) if part["of"] in curved), None)
        curved |= {name} if _WORD.search(text) or names_in(text) & curved else set()
        if found is not None:
            weight = f"the weight of {found['of']} in {name} is -{found['number']}"
            said = f"{weight}: convexity does not follow from the structure, and duhem found no chord that leaves K. K may be convex or not"
            return Evidence(Verdict.UNDECIDED, "none", f"{said}; if it is to be convex, train with weights >= 0 between layers")
    return None


def duality_left_out(_: GraphSubject) -> Evidence:
    """There is no closed form to ask about."""
    return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", "g is kept as a graph, and no closed form is looked for of one")


# -- violations at rational points -------------------------------------------------------------------------------------


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
