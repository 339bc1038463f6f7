"""Refutation of convexity by a chord of K whose midpoint is outside: suggested by a search, checked exactly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy as sp

from duhem.proof.decide import Sense
from duhem.proof.facts.case import Case
from duhem.proof.facts.polar_form import profile
from duhem.proof.search.suggestion import Chord
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.rational_points import chord

__all__ = ["convexity_at_dents", "convexity_at_seams", "convexity_by_scouting", "convexity_by_thorough_scouting"]


def _refuted(case: Case, suggested: Iterable[Chord]) -> Evidence | None:
    """By the first chord that passes the exact check."""
    for one in suggested:
        if (witness := chord(case, one.parameters, one.p, one.q)) is not None:
            return Evidence(Verdict.REFUTED, "witness-chord", "a chord between two points of K leaves K", witness)
    return None


def convexity_by_scouting(case: Case) -> Evidence | None:
    """A few parameter choices."""
    return _scouted(case, 6)


def convexity_by_thorough_scouting(case: Case) -> Evidence | None:
    """Many parameter choices."""
    return _scouted(case, 60)


def _scouted(case: Case, most: int) -> Evidence | None:
    from duhem.proof.search.sampled_chords import sampled_chords  # numpy, only when something is looked for

    return _refuted(case, sampled_chords(case, most))


def convexity_at_dents(case: Case) -> Evidence | None:
    """Where an arc's curvature question has a counterexample, a chord through the boundary point in that direction."""
    from duhem.proof.search.precise_chords import dent_chords

    form = profile(case)
    if form is None:
        return None
    for arc in form.arcs:
        answer = case.ask(form.curvature(arc), Sense.NONNEGATIVE, *arc.conditions(strict=True), circle=(form.x, form.y))
        if answer.holds is not False or answer.point is None:
            continue
        point: Mapping[sp.Symbol, Any] = answer.point
        for parameters in case.choices(1, [point]):
            if found := _refuted(case, dent_chords(case, parameters, [point[form.x], point[form.y]])):
                return found
    return None


def convexity_at_seams(case: Case) -> Evidence | None:
    """Where the boundary crosses a seam with a kink inward, a chord across it (two forces)."""
    if len(case.simple.forces) != 2 or case.pieces is None or len(case.pieces) < 2:
        return None
    from duhem.proof.search.precise_chords import kink_chords

    return _refuted(case, kink_chords(case))
