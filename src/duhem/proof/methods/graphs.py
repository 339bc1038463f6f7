"""Refuters of a law kept as a graph: points at which its value, enclosed, breaks a claim."""

from __future__ import annotations

import re

from duhem.expression.abbreviations import names_in
from duhem.expression.number import DECIMAL
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.points import chord, origin_outside

__all__ = ["convexity_left_open", "convexity_refuted", "duality_left_out", "origin_refuted"]

_CHOICES = 3
_WORD = re.compile(r"\w\s*\(|\*\*")
_NEGATIVE = re.compile(rf"-\s*(?P<number>{DECIMAL})\)?\s*\*\s*(?P<of>[^\W\d]\w*)(?!\s*\()")


def origin_refuted(subject: GraphSubject) -> Evidence | None:
    """Parameters at which g(0) > 0."""
    found = (origin_outside(subject, parameters) for parameters in subject.choices(_CHOICES))
    return Evidence.refuted_by(found, "witness-point", "zero force is outside K")


def convexity_refuted(subject: GraphSubject) -> Evidence | None:
    """A chord that leaves K."""
    from duhem.proof.search.graph_chords import graph_chords

    found = (chord(subject, values, *ends) for values in subject.choices(_CHOICES) for ends in graph_chords(subject, values))
    return Evidence.refuted_by(found, "witness-chord", "a chord between two points of K leaves K")


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
