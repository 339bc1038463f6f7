"""What is claimed of a law with a state, as laws in other forces: the epigraph of its energy, and its dissipation in the state.

The same is done of texts by the kernel (:mod:`duhem.proof.kernel.state`), which is asked for every proof; here it is what refuters and
finders of evidence look at.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression.branches import gradient
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.state import Variables

__all__ = ["Dissipating", "dissipating", "epigraph", "rate_epigraph"]


def epigraph(law: Criterion) -> Criterion | None:
    """{psi(chi) <= z} in the variables but the temperature, and z, which is convex where psi is; None without an energy."""
    if law.energy is None:
        return None
    taken, height = law.symbols(), _unused(law)
    plain = [name for name in _variables(law).mechanical() if 0 in law.parameters[name] and law.parameters[name].value is None]
    rest = {name: own for name, own in law.parameters.items() if name not in plain}  # what leaves 0 out stays as it is: a part of the claim
    ranges = {name: law.parameters[name] for name in plain if law.parameters[name] != Domain()}
    g = law.energy.xreplace({taken[name]: sp.Symbol(name, real=True) for name in plain}) - sp.Symbol(height, real=True)
    return Criterion(law.name, g, rest, (*plain, height), None, law.constraints, domain=ranges)


def rate_epigraph(law: Criterion) -> Criterion:
    """{Phi*(Y) <= z} in the forces and z, of a potential of rates; convex where that is."""
    height = _unused(law)
    g = law.g - sp.Symbol(height, real=True)
    return Criterion(law.name, g, law.parameters, (*law.forces, height), law.pressure, law.constraints, domain=law.domain)


def _unused(law: Criterion) -> str:
    """A name that the law has no use for."""
    taken = law.symbols()
    return next(name for name in ("z", *(f"z{i}" for i in range(len(taken) + 1))) if name not in taken)


class Dissipating(NamedTuple):
    """A law in the forces that stay free, and its ``power`` = sum of Y . rate; the other forces are functions of the state.

    ``rates`` is the same of the rates without a multiplier.

    ``onto``: every value of the free forces is one of some state, so that a power < 0 at free forces is one of the law.
    """

    law: Criterion
    power: sp.Expr
    rates: sp.Expr
    onto: bool


def dissipating(law: Criterion) -> Dissipating | None:
    """The law with Y = -d psi/d alpha put in; None for a law without an energy or a flow of its own, or where no force stays free."""
    if law.viscous:
        power = sp.Add(*(x * d for x, d in zip(law.force_symbols(), gradient(law.g, law.force_symbols()), strict=True)))
        return Dissipating(rate_epigraph(law), power, sp.S.Zero, law.energy is None and not law.rates)
    if law.energy is None or law.flow is None or law.surfaces:
        return None
    try:
        return _with_forces_put_in(law, law.energy, law.flow)
    except InputError:  # an energy without derivatives in words, or a K without a force of its own
        return None


def _with_forces_put_in(law: Criterion, energy: sp.Expr, slip: tuple[sp.Expr, ...]) -> Dissipating | None:
    table, variables = law.symbols(), _variables(law)
    driven = variables.driven()
    found = dict(zip(driven, (-d for d in gradient(energy, [table[name] for name in driven.values()])), strict=True))
    observed = [table[name] for name in variables.observed().values()]
    free = tuple(f for f in law.forces if any(sp.expand(sp.diff(found[f], u)) != 0 for u in observed))
    bound = {table[f]: sp.expand(found[f]) for f in law.forces if f not in free}
    if not free:
        return None
    g, flow = law.g.xreplace(bound), tuple(d.xreplace(bound) for d in slip)
    power = sp.Add(*(bound.get(table[f], table[f]) * d for f, d in zip(law.forces, flow, strict=True)))
    slips = tuple(d for f, d in zip(law.forces, flow, strict=True) if f in free)
    force = {name: table[own.force] for name, own in variables.items() if own.force is not None}
    rates = sp.Add(*((force[name] * rate).xreplace(bound) for name, rate in law.rates.items() if name in force))
    plain = replace(law, energy=None, written_energy="", variables={}, unforced={}, rates={})
    inner = replace(plain, g=g, written="", forces=free, flow=slips, written_flow=(), potential=None)
    return Dissipating(inner, power, rates, _onto(law, found, free, sp.Tuple(g, power, rates)))


def _onto(law: Criterion, found: Mapping[str, sp.Expr], free: tuple[str, ...], said: sp.Basic) -> bool:
    """Whether the free forces are K (u - u_in) and more, K constant with an inverse, and each u is any number and stands nowhere else."""
    table, observed = law.symbols(), _variables(law).observed()
    names = [name for force, name in observed.items() if force in free]
    if len(names) != len(free) or any(law.parameters[name] != Domain() or table[name] in said.free_symbols for name in names):
        return False
    matrix = sp.Matrix([[sp.diff(found[f], table[name]) for name in names] for f in free])
    fixed = not matrix.free_symbols & {table[name] for name in law.variables}
    return bool(fixed and sp.factor(matrix.det()).is_nonzero is True)


def _variables(law: Criterion) -> Variables:
    assert isinstance(law.variables, Variables)  # since __post_init__
    return law.variables
