"""Refuters of a law kept as a graph: points at which its value, enclosed, breaks a claim."""

from __future__ import annotations

from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.graphs import graph_chord, graph_origin_outside

__all__ = ["convexity_refuted", "duality_left_out", "origin_refuted"]

_CHOICES = 3


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


def duality_left_out(_: GraphSubject) -> Evidence:
    """There is no closed form to ask about."""
    return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", "g is kept as a graph, and no closed form is looked for of one")
