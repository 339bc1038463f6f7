"""Refutation of convexity by a chord of K whose midpoint is outside, found by scouting and checked exactly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from duhem.proof.decide import Sense
from duhem.proof.facts.case import Case
from duhem.proof.facts.polar_form import profile
from duhem.proof.search.choices import choices
from duhem.proof.verdict import Evidence, Verdict, Witness

__all__ = ["convexity_at_dents", "convexity_at_seams", "convexity_by_scouting", "convexity_by_thorough_scouting"]


def _refuted(witness: Witness | None, method: str) -> Evidence | None:
    if witness is None:
        return None
    return Evidence(Verdict.REFUTED, method, "a chord between two points of K leaves K", witness)


def convexity_by_scouting(case: Case) -> Evidence | None:
    """A few parameter choices."""
    return _scouted(case, 6)


def convexity_by_thorough_scouting(case: Case) -> Evidence | None:
    """Many parameter choices."""
    return _scouted(case, 60)


def _scouted(case: Case, most: int) -> Evidence | None:
    from duhem.proof.search.chords import nonconvex_chord  # numpy, only when something is looked for

    return _refuted(nonconvex_chord(case, most=most), "witness-chord")


def convexity_at_dents(case: Case) -> Evidence | None:
    """Where an arc's curvature question has a counterexample, a chord through the boundary point in that direction."""
    from duhem.proof.search.chords import boundary_dent

    form = profile(case)
    if form is None:
        return None
    for arc in form.arcs:
        answer = case.ask(form.curvature(arc), Sense.NONNEGATIVE, *arc.conditions(strict=True), circle=(form.x, form.y))
        if answer.holds is not False or answer.point is None:
            continue
        point: Mapping[sp.Symbol, Any] = answer.point
        for parameters in choices(case, [point], most=1):
            if witness := boundary_dent(case, parameters, [point[form.x], point[form.y]]):
                return _refuted(witness, "witness-chord")
    return None


def convexity_at_seams(case: Case) -> Evidence | None:
    """Where the boundary crosses a seam with a kink inward, a chord across it (two forces)."""
    if len(case.simple.forces) != 2 or case.pieces is None or len(case.pieces) < 2:
        return None
    from duhem.proof.search.chords import inward_kink

    return _refuted(inward_kink(case), "witness-chord")
