"""Refutation of convexity by a chord of K whose midpoint is outside: suggested by a search, checked exactly."""

from __future__ import annotations

from collections.abc import Iterable

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.suggestion import Chord
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.rational_points import chord

__all__ = [
    "convexity_at_clear_dents",
    "convexity_at_deepest_dents",
    "convexity_at_dents",
    "convexity_at_far_points",
    "convexity_at_narrow_dents",
    "convexity_at_seams",
    "convexity_beside_edges",
    "convexity_between_exact_rays",
    "convexity_by_scouting",
    "convexity_by_thorough_scouting",
]


def _refuted(subject: FormulaSubject, suggested: Iterable[Chord], touching: bool = False) -> Evidence | None:
    """By the first chord that passes the exact check."""
    for one in suggested:
        if (witness := chord(subject, one.parameters, one.p, one.q, touching)) is not None:
            return Evidence(Verdict.REFUTED, "witness-chord", "a chord between two points of K leaves K", witness)
    return None


def convexity_by_scouting(subject: FormulaSubject) -> Evidence | None:
    """A few parameter choices."""
    return _scouted(subject, 6)


def convexity_by_thorough_scouting(subject: FormulaSubject) -> Evidence | None:
    """Many parameter choices."""
    return _scouted(subject, 60)


def _scouted(subject: FormulaSubject, most: int) -> Evidence | None:
    from duhem.proof.search.long_chords import sampled_chords  # numpy, only when something is looked for

    return _refuted(subject, sampled_chords(subject, most))


def convexity_at_far_points(subject: FormulaSubject) -> Evidence | None:
    """From where a ball in a maximum lies farthest along a load."""
    from duhem.proof.search.long_chords import chords_from_far_points

    return _refuted(subject, chords_from_far_points(subject), touching=True)


def convexity_between_exact_rays(subject: FormulaSubject) -> Evidence | None:
    """Between points of faces, edges or whiskers of K that no sample meets."""
    from duhem.proof.search.long_chords import chords_between_exact_rays

    return _refuted(subject, chords_between_exact_rays(subject))


def convexity_at_narrow_dents(subject: FormulaSubject) -> Evidence | None:
    """Where a ray that is known exactly leaves K at a point without second derivatives, or with none inward."""
    from duhem.proof.search.dents import dents_on_exact_rays

    return _refuted(subject, dents_on_exact_rays(subject))


def convexity_beside_edges(subject: FormulaSubject) -> Evidence | None:
    """Where g rises beside an edge a little less than in proportion, as powers a little below 1 do."""
    from duhem.proof.search.precise_chords import chords_beside_edges

    return _refuted(subject, chords_beside_edges(subject))


def convexity_at_clear_dents(subject: FormulaSubject) -> Evidence | None:
    """Where the boundary of a polynomial law bends outward in one of many directions."""
    return _dented(subject, False)


def convexity_at_deepest_dents(subject: FormulaSubject) -> Evidence | None:
    """Where the boundary of a polynomial law bends outward most, however little."""
    return _dented(subject, True)


def _dented(subject: FormulaSubject, thorough: bool) -> Evidence | None:
    from duhem.proof.search.dents import chords_across_dents

    return _refuted(subject, chords_across_dents(subject, 24, thorough))


def convexity_at_dents(subject: FormulaSubject) -> Evidence | None:
    """Where the boundary of any law bends outward most, between its kinks."""
    from duhem.proof.search.dents import chords_across_smooth_dents

    return _refuted(subject, chords_across_smooth_dents(subject))


def convexity_at_seams(subject: FormulaSubject) -> Evidence | None:
    """Where the boundary crosses a seam with a kink inward, a chord across it (two forces)."""
    if len(subject.simple.forces) != 2 or subject.pieces is None or len(subject.pieces) < 2:
        return None
    from duhem.proof.search.precise_chords import kink_chords

    return _refuted(subject, kink_chords(subject))
