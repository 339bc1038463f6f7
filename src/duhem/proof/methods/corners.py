"""Refutation of smoothness: a corner where the boundary crosses a seam."""

from __future__ import annotations

from duhem.expression import Where
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.seam_crossings import crossings
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.corner import corner

__all__ = ["smoothness"]


def smoothness(subject: FormulaSubject) -> Evidence | None:
    """A boundary point on a seam where the one-sided normals differ (two forces, or laws that reduce to two)."""
    pieces = subject.pieces
    if len(subject.simple.forces) != 2 or pieces is None or len(pieces) < 2:
        return None
    jumps = subject.simple.g.has(Where) and not subject.continuous
    for parameters in subject.choices(6):
        for crossing in crossings(subject, parameters):
            if (witness := corner(subject, parameters, crossing.seam, crossing.point, jumps)) is not None:
                return Evidence(Verdict.REFUTED, "witness-corner", "the outward normal jumps at a corner of the boundary", witness)
    return None
