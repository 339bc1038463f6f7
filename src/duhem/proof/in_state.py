"""What is claimed of a law with a state, as laws in other forces: the epigraph of its energy, and its dissipation in the state.

The same is done of texts by the kernel (:mod:`duhem.proof.kernel.state`), which is asked for every proof; here it is what refuters and
finders of evidence look at.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Norm
from duhem.expression.branches import gradient
from duhem.expression.vocabulary import KINKS
from duhem.law.domain import POSITIVE, Domain, Domains
from duhem.law.formula_law import Criterion
from duhem.law.state import variables_of
from duhem.proof.statement import parsed_as_written

__all__ = [
    "Dissipating", "Spent", "dissipating", "epigraph", "forces_in", "heat_in_states", "power_of_rates", "rate_epigraph",
    "spent_by_rates", "spent_in_states", "two_forces",
]  # fmt: skip


def epigraph(law: Criterion, *, of_heat: bool = False) -> Criterion | None:
    """{psi(chi) <= z} in the variables but the temperature, and z, which is convex where psi is; None without an energy.

    ``of_heat`` it is {-psi <= z} in the temperature and z, convex where psi is concave in that; None without a temperature.
    """
    if law.energy is None or (of_heat and law.temperature is None):
        return None
    taken, height = law.symbols(), _unused(law)
    plain = [name for name, own in law.variables.items() if own.temperature == of_heat and law.parameters[name].value is None]
    rest = {name: own for name, own in law.parameters.items() if name not in plain}
    psi = law.energy.xreplace({taken[name]: sp.Symbol(name, real=True) for name in plain})
    g = _above(-psi if of_heat else psi, law.written_energy and f"{'-' * of_heat}({law.written_energy})", height)
    found = Criterion(law.name, g, rest, (*plain, height), None, law.constraints)
    # The ranges of a law's forces have 0 in them, those of variables need not.
    object.__setattr__(found, "domain", Domains({name: law.parameters[name] for name in plain if law.parameters[name] != Domain()}))
    return found


def rate_epigraph(law: Criterion) -> Criterion:
    """{Phi*(Y) <= z} in the forces and z, of a potential of rates; convex where that is."""
    height = _unused(law)
    g = _above(law.g, law.written and f"({law.written})", height)
    return Criterion(law.name, g, law.parameters, (*law.forces, height), law.pressure, law.constraints, domain=law.domain)


def _above(expr: sp.Expr, written: str, height: str) -> Any:
    """What is <= 0 above the graph: as it is written, where it has a text, so that a part without a value is not lost."""
    return f"{written} - {height}" if written else expr - sp.Symbol(height, real=True)


def _unused(law: Criterion) -> str:
    """A name that the law has no use for."""
    taken = law.symbols()
    return next(name for name in ("z", *(f"z{i}" for i in range(len(taken) + 1))) if name not in taken)


class Dissipating(NamedTuple):
    """A law in the forces that stay free, and its ``power`` = sum of Y . rate; the other forces are functions of the state.

    ``onto``: every value of the free forces is one of some state, so that a power < 0 at free forces is one of the law.
    """

    law: Criterion
    power: sp.Expr
    onto: bool


def dissipating(law: Criterion) -> Dissipating | None:
    """The law with Y = -d psi/d alpha put in; None for a law without an energy or a flow of its own, or where no force stays free."""
    if law.viscous:
        power = sp.Add(*(x * d for x, d in zip(law.force_symbols(), gradient(law.g, law.force_symbols()), strict=True)))
        return Dissipating(rate_epigraph(law), power, law.energy is None and not law.rates)
    if law.energy is None or law.flow is None or law.surfaces:
        return None
    try:
        return _with_forces_put_in(law, law.flow)
    except InputError:  # an energy without derivatives in words, or a K without a force of its own
        return None


def _with_forces_put_in(law: Criterion, slip: tuple[sp.Expr, ...]) -> Dissipating | None:
    table, variables, found = law.symbols(), variables_of(law), forces_in(law)
    observed = [table[name] for name in variables.observed().values()]
    free = tuple(f for f in law.forces if any(sp.expand(sp.diff(found[f], u)) != 0 for u in observed))
    bound = {table[f]: sp.expand(found[f]) for f in law.forces if f not in free}
    if not free:
        return None
    g, flow = law.g.xreplace(bound), tuple(d.xreplace(bound) for d in slip)
    power = sp.Add(*(bound.get(table[f], table[f]) * d for f, d in zip(law.forces, flow, strict=True)))
    slips = tuple(d for f, d in zip(law.forces, flow, strict=True) if f in free)
    plain = replace(law, energy=None, written_energy="", variables={}, unforced={}, rates={})
    inner = replace(plain, g=g, written="", forces=free, flow=slips, written_flow=(), potential=None)
    return Dissipating(inner, power, _onto(law, found, free, sp.Tuple(g, power)))


def _onto(law: Criterion, found: Mapping[str, sp.Expr], free: tuple[str, ...], said: sp.Basic) -> bool:
    """Whether the free forces are K (u - u_in) and more, K constant with an inverse, and each u is any number and stands nowhere else."""
    table, observed = law.symbols(), variables_of(law).observed()
    names = [name for force, name in observed.items() if force in free]
    if len(names) != len(free) or any(law.parameters[name] != Domain() or table[name] in said.free_symbols for name in names):
        return False
    matrix = sp.Matrix([[sp.diff(found[f], table[name]) for name in names] for f in free])
    fixed = not matrix.free_symbols & {table[name] for name in law.variables}
    return bool(fixed and sp.factor(matrix.det()).is_nonzero is True)


def forces_in(law: Criterion) -> dict[str, sp.Expr]:
    """The force that the energy gives by each internal variable; InputError where it has no derivatives in words."""
    driven, table = variables_of(law).driven(), law.symbols()
    assert law.energy is not None
    return dict(zip(driven, (-d for d in gradient(law.energy, [table[name] for name in driven.values()])), strict=True))


def two_forces(law: Criterion) -> dict[str, sp.Expr]:
    """What must be 0 for the energy to give one force by an observable and by the slip of the same; nothing where it has kinks."""
    variables, table = variables_of(law), law.symbols()
    driven, observed = variables.driven(), variables.observed()
    pairs = [(u, driven[force]) for force, u in observed.items() if force in driven]
    if law.energy is None or law.energy.has(*KINKS, Norm):
        return {}
    try:
        return {f"dpsi/d{u} + dpsi/d{w}": sp.Add(*gradient(law.energy, (table[u], table[w]))) for u, w in pairs}
    except InputError:
        return {}


class Spent(NamedTuple):
    """A ``power`` that is to be >= 0 where ``bound`` <= 0 (= 0 if ``on_it``); None is no bound.  Both are trees as they are written.

    The ``energy``, which gives the forces in them, must have a value; None is none.
    They are over parameters, pressure and what is ``chosen``: variables and, without an energy, forces, each in its range.
    """

    power: sp.Expr
    bound: sp.Expr | None
    on_it: bool
    energy: sp.Expr | None
    chosen: Mapping[sp.Symbol, Domain]


def spent_in_states(law: Criterion, pressure: Mapping[sp.Symbol, sp.Expr]) -> Iterator[Spent]:
    """What rates dissipate in states of the law, the forces being those of its energy; of a law whose forces nobody gives, nothing.

    Rates without a multiplier act in all of K, beside those of a potential if there is one; a flow of the law's own acts on g = 0.
    """
    table, slots = law.symbols(), {name: own.force for name, own in law.variables.items() if own.force is not None}
    own_flow = law.flow if law.energy is not None and not law.surfaces and law.potential is None else None
    if not law.rates and own_flow is None and not (law.viscous and law.energy is not None):
        return
    if law.energy is not None and law.energy.has(*KINKS, Norm):
        return  # at a kink it gives no one force
    chosen = {table[name]: law.parameters[name] for name in law.variables if law.parameters[name].value is None}
    known: dict[str, Any] = {name: x.xreplace(pressure) for name, x in table.items()}
    try:
        if law.energy is not None:
            known |= forces_in(law)
        elif sp.Tuple(law.g, *law.rates.values()).free_symbols & {table[name] for name in slots}:
            return  # such a variable and its force go together, nobody says how
        else:
            chosen |= {table[f]: law.domain.get(f, Domain()) for f in law.forces}
        potential = gradient(law.g, law.force_symbols()) if law.viscous else ()
    except InputError:
        return
    g = parsed_as_written(law, law.g, law.written, known)
    energy = None if law.energy is None else parsed_as_written(law, law.energy, law.written_energy, known)
    rates = {name: parsed_as_written(law, rate, law.written_rates[name], known) for name, rate in law.rates.items()}
    powers = [known[slots[name]] * rate for name, rate in rates.items() if name in slots]
    at = {table[name]: value for name, value in known.items()}
    powers += [known[f] * d.xreplace(at) for f, d in zip(law.forces, potential, strict=bool(potential))]
    if powers:
        yield Spent(sp.Add(*powers, evaluate=False), None if law.viscous else g, False, energy, chosen)
    if own_flow is not None:
        texts = law.written_flow or ("",) * len(own_flow)
        slips = (parsed_as_written(law, d, text, known) for d, text in zip(own_flow, texts, strict=True))
        yield Spent(sp.Add(*(known[f] * d for f, d in zip(law.forces, slips, strict=True)), evaluate=False), g, True, energy, chosen)


def power_of_rates(law: Criterion) -> Criterion:
    """{force . rate <= z} in the rates and z, of a law whose forces are functions of the rates, by which it is looked at."""
    height = _unused(law)
    g = law.g - sp.Symbol(height, real=True)
    return Criterion(law.name, g, law.parameters, (*law.velocities.values(), height), law.pressure, law.constraints)


def spent_by_rates(law: Criterion, pressure: Mapping[sp.Symbol, sp.Expr]) -> tuple[Spent, Spent]:
    """Force . rate, and (force - force at another rate) . (rate - other), >= 0 if forces derive from a convex potential of the rates."""
    known = {name: x.xreplace(pressure) for name, x in law.symbols().items()}
    other = {rate: sp.Symbol(f"{rate} of the other", real=True) for rate in law.velocities.values()}
    rates, others = [[given[rate] for rate in other] for given in (known, other)]
    forces, elsewhere = (
        [parsed_as_written(law, law.forces_of_rates[f], law.written_forces_of_rates[f], known | more) for f in law.velocities]
        for more in ({}, other)
    )
    power = sp.Add(*(f * v for f, v in zip(forces, rates, strict=True)), evaluate=False)
    gain = sp.Add(*((f - h) * (v - w) for f, h, v, w in zip(forces, elsewhere, rates, others, strict=True)), evaluate=False)
    chosen = dict.fromkeys(rates, Domain())
    return Spent(power, None, False, None, chosen), Spent(gain, None, False, None, chosen | dict.fromkeys(others, Domain()))


def heat_in_states(law: Criterion, pressure: Mapping[sp.Symbol, sp.Expr]) -> Spent:
    """The thermal dissipation, sum of h_k (T_k - T)^2/T_k, for all temperatures > 0."""
    table, own = law.symbols(), law.parameters[str(law.temperature)]
    known = {name: x.xreplace(pressure) for name, x in table.items()}
    ranges = {name: law.parameters[name] for name in (*law.variables, *law.heat)}
    if own.low is None or own.low <= 0:
        ranges[str(law.temperature)] = Domain(POSITIVE.low, own.high, positive=True)
    t = table[str(law.temperature)]
    parts = ((known[name], parsed_as_written(law, h, law.written_heat[name], known)) for name, h in law.heat.items())
    spent = sp.Add(*(h * (body - t) ** 2 / body for body, h in parts), evaluate=False)
    return Spent(spent, None, False, None, {table[name]: own for name, own in ranges.items() if own.value is None})
