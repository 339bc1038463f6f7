"""The slip of a law of several surfaces with flows of their own: a non-negative combination over those that are 0 (Koiter 1953)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import sympy as sp

from duhem.derivation.energy import column, equal
from duhem.derivation.equation import Equation
from duhem.derivation.notation import Names
from duhem.derivation.pieces import pieces
from duhem.law.formula_law import Criterion

__all__ = ["flow_of_surfaces", "slips", "step_of_surfaces"]


def slips(law: Criterion) -> tuple[tuple[sp.Expr, ...], ...] | None:
    """On each surface its flow, or else the gradient of its g, branch by branch; None where one has too many branches to print."""
    found = [surface.flow or _gradient(replace(law, g=surface.g, surfaces=())) for surface in law.surfaces]
    return None if None in found else tuple(flow for flow in found if flow is not None)


def _gradient(law: Criterion) -> tuple[sp.Expr, ...] | None:
    found = pieces(law)
    return None if found is None else tuple(found.joined(list(parts)) for parts in zip(*found.gradients, strict=True))


def combined(multipliers: Sequence[sp.Symbol], flows: Sequence[Sequence[sp.Expr]]) -> list[sp.Expr]:
    """The sum of multiplier times flow, by component."""
    return [sp.Add(*(m * c for m, c in zip(multipliers, parts, strict=True))) for parts in zip(*flows, strict=True)]


def complementary(law: Criterion, multipliers: Sequence[sp.Symbol]) -> sp.Basic:
    """Every surface with its multiplier: >= 0, <= 0, one of them 0."""
    three = [
        relation
        for m, surface in zip(multipliers, law.surfaces, strict=True)
        for relation in (sp.GreaterThan(m, 0, evaluate=False), sp.LessThan(surface.g, 0, evaluate=False), equal(m * surface.g, sp.S.Zero))
    ]
    return sp.And(*three, evaluate=False)


def flow_of_surfaces(names: Names, section: str) -> Iterator[Equation]:
    """Koiter's rule in rates, and the power it dissipates."""
    law = names.law
    if (flows := slips(law)) is None:
        return
    note = "Koiter's rule: each surface that is 0 slips along its own flow, or along its normal if it states none"
    yield Equation("D4", "flow", equal(column(names.rates), column(combined(names.multipliers, flows))), note, section)
    yield Equation(
        "36'", "complementarity", complementary(law, names.multipliers), "a surface slips only where it is 0, and never backwards", section
    )
    powers = [sp.factor_terms(sp.Add(*(s * c for s, c in zip(names.forces, flow, strict=True)))) for flow in flows]
    power = sp.Add(*(m * p for m, p in zip(names.multipliers, powers, strict=True)))
    yield Equation("D6", "dissipation", equal(sp.Symbol("D", real=True), power), "D = sum of lambda_i sigma . flow_i", section)


def step_of_surfaces(names: Names, section: str) -> Iterator[Equation]:
    """The same over an increment: a fixed point with one multiplier a surface, not a projection."""
    law = names.law
    if (flows := slips(law)) is None:
        return
    moved = names.stiffness * sp.Matrix(combined(names.steps, flows))
    ends = column(t - c for t, c in zip(names.trial, moved, strict=True))
    yield Equation("D14", "step_stress", equal(column(names.forces), ends), "own flows: a fixed point, not a projection", section)
    note = "a surface slips in the step only if the step ends on it"
    yield Equation("D16", "step_complementarity", complementary(law, names.steps), note, section)
