"""The methods that prove a claim on SymPy and with the deciders, as a second opinion on what the kernel's rules prove."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence
from tests.oracles.prover import (
    boundary,
    composition,
    convex_sums,
    degrees,
    evaluation,
    on_boundary,
    parallel,
    polar,
    polyhedral,
    power_share,
    rounded,
    state_laws,
)

__all__ = ["PROVERS"]

PROVERS: Mapping[str, tuple[Callable[[FormulaSubject], Evidence | None], ...]] = {
    "origin": (evaluation.origin, polar.origin),
    "convexity": (
        composition.convexity,
        convex_sums.convexity,
        polyhedral.convexity,
        polar.convexity,
        boundary.convexity,
        boundary.hessian,
    ),
    "smoothness": (composition.smoothness, rounded.smoothness, polar.smoothness, on_boundary.smoothness_on_boundary),
    "dissipation": (
        degrees.dissipation,
        degrees.dissipation_of_potential,
        power_share.dissipation,
        polar.dissipation,
        on_boundary.dissipation_on_boundary,
    ),
    "normality": (parallel.normality,),
    "state_laws": (state_laws.state_laws,),
}
