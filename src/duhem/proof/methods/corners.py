"""Refutation of smoothness: a corner where the boundary crosses a seam, or a point to which K narrows."""

from __future__ import annotations

from collections.abc import Iterator

from duhem.expression import Where
from duhem.expression.branches import almost_everywhere
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.facts.plane_section import PlaneSection
from duhem.proof.search.suggestion import SectionCorner
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.corner import corner
from duhem.proof.witness.sharp_point import sharp_point

__all__ = ["smoothness", "smoothness_at_sharp_points"]


def smoothness(subject: FormulaSubject) -> Evidence | None:
    """A boundary point on a seam where the one-sided normals differ: in two forces on any seam, in more in some planes."""
    jumps: bool | None = None
    for parameters in subject.choices(6 if len(subject.simple.forces) == 2 else 2):
        for one in _suggested(subject, parameters):
            if jumps is None:
                jumps = almost_everywhere(subject.simple.g).has(Where) and not subject.continuous
            witness = corner(subject, parameters, one.section, one.place, jumps)
            if witness is not None and subject.may_refute("smoothness", witness.points.values()):
                return Evidence(Verdict.REFUTED, "witness-corner", "the outward normal jumps at a corner of the boundary", witness)
    return None


def smoothness_at_sharp_points(subject: FormulaSubject) -> Evidence | None:
    """An exact boundary point to which K narrows: the tip of a cone, of a drop, a cusp."""
    from duhem.proof.search.corners import sharp_points

    for parameters in subject.choices(1):
        for one in sharp_points(subject, parameters):
            witness = sharp_point(subject, parameters, one.place, one.away, one.into)
            if witness is not None and subject.may_refute("smoothness", witness.points.values()):
                return Evidence(Verdict.REFUTED, "witness-sharp-point", "the boundary has a sharp point", witness)
    return None


def _suggested(subject: FormulaSubject, parameters: Values) -> Iterator[SectionCorner]:
    from duhem.proof.search.corners import crossings, section_corners  # numpy, only when something is looked for

    forces = subject.simple.forces
    if len(forces) > 2:
        yield from section_corners(subject, parameters)
    elif len(forces) == 2:
        plane = PlaneSection.whole((forces[0], forces[1]))
        yield from (SectionCorner(parameters, plane, crossing.point) for crossing in crossings(subject, parameters))
