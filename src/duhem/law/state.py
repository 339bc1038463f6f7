"""The state of a law: its variables, each with its force, and whether they fit the law's forces and free energy.

With psi(u, alpha, T) per unit area (or volume) the forces are sigma = d psi/d u, Y = -d psi/d alpha, and s = -d psi/d T is the entropy
(Antoni et al. 2007, Eqs. 24-26).  A slip u_in is an internal variable of an energy in u - u_in, so that its force is sigma (Eq. 31).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.fold import graph_of
from duhem.law.domain import REAL, Domain
from duhem.law.frozen_mapping import FrozenMapping

__all__ = [
    "NO_STATE", "Variable", "Variables", "check_has_k", "check_heat", "check_state", "check_stateless", "evolves", "frozen", "misfits",
    "prescribed", "variables_of",
]  # fmt: skip


@dataclass(frozen=True)
class Variable:
    """An observable (``force`` = +d psi/d u), an internal variable (``force`` = -d psi/d alpha, or none), or the temperature."""

    force: str | None = None
    observable: bool = False
    temperature: bool = False
    domain: Domain = REAL

    @property
    def internal(self) -> bool:
        """Whether it changes by the complementary laws alone."""
        return not (self.observable or self.temperature)

    def describe(self) -> str:
        """Its kind and its force in words."""
        kind = "temperature" if self.temperature else "observable" if self.observable else "internal"
        return kind if self.force is None else f"{kind}, force {self.force}"


class Variables(FrozenMapping[str, Variable]):
    """The variables of a state by name, in order."""

    __slots__ = ()

    def temperature(self) -> str | None:
        """The name of the temperature, if there is one."""
        return next((name for name, own in self.items() if own.temperature), None)

    def driven(self) -> dict[str, str]:
        """Each force with its internal variable."""
        return {own.force: name for name, own in self.items() if own.internal and own.force is not None}

    def rates(self, forces: Sequence[str]) -> dict[str, str]:
        """Each of the forces that drives an internal variable, with the name of the rate of that."""
        driven = self.driven()
        return {force: f"{driven[force]}_rate" for force in forces if force in driven}

    def observed(self) -> dict[str, str]:
        """Each force with its observable."""
        return {own.force: name for name, own in self.items() if own.observable and own.force is not None}

    def slots(self, forces: Sequence[str]) -> list[tuple[str, str | None]]:
        """What each entry of a flow is the rate of, with its force: slips that no variable is, then the internal variables in order."""
        driven = self.driven()
        slips = [(f"the slip of {force}" if self else force, force) for force in forces if force not in driven]
        return [*slips, *((name, own.force) for name, own in self.items() if own.internal)]


NO_STATE = Variables()


def variables_of(law: Any) -> Variables:
    """The variables of a :class:`~duhem.law.formula_law.Criterion`, which takes any mapping for them and keeps this one."""
    assert isinstance(law.variables, Variables)
    return law.variables


def misfits(variables: Variables, forces: Sequence[str], energy: bool) -> Iterator[tuple[str, str, str]]:
    """What does not fit: the variable, or nothing where one is missing, what is wrong with it, and the remedy."""
    for name, own in variables.items():
        if own.observable and own.temperature:
            yield name, f"{name} is an observable and the temperature", "remove one of them"
        elif own.temperature and own.force is not None:
            yield name, f"the temperature {name} has a force", "remove force: what belongs to it is the entropy"
        elif own.observable and own.force is None:
            other = ", or another name if no internal variable has this force: the energy gives it, and it need not stand in forces"
            yield name, f"the observable {name} has no force", f'add force = "{forces[0]}"{other if energy else ""}'
        elif own.force is not None and own.force not in forces and not (own.observable and energy):  # then it is what the energy gives
            remedy = f"add it to forces, which are: {', '.join(forces)}; or name no force of {name}, if neither g nor a flow contains it"
            yield name, f"the force {own.force!r} of {name} is not declared", remedy
    for kind in ("observable", "internal"):
        taken: dict[str, str] = {}
        for name, own in variables.items():
            if own.force is not None and getattr(own, kind) and taken.setdefault(own.force, name) != name:
                two = f"{own.force} is the force of two {kind} variables, {taken[own.force]} and {name}"
                yield name, two, "give each a force of its own"
    if temperatures := [name for name, own in variables.items() if own.temperature][1:]:
        yield temperatures[0], "there are two temperatures", "declare one"
    observed = variables.observed()
    for force in forces if energy else ():
        if force not in variables.driven():
            given = f"remove {force} from forces, as the energy gives the force of {observed[force]}; or " if force in observed else ""
            yield "", f"no internal variable has the force {force}", f'{given}declare one, such as {force}_in = {{ force = "{force}" }}'


def check_state(law: Any) -> None:
    """InputError where variables, rates and energy of a :class:`~duhem.law.formula_law.Criterion` do not fit it."""
    variables = variables_of(law)
    for _, what, remedy in misfits(variables, law.forces, law.energy is not None):
        raise InputError(what, where=f"variables of {law.name}", remedy=remedy)
    if taken := [own.force for own in variables.values() if own.force is not None and own.force in (*law.parameters, law.pressure)]:
        raise InputError(f"{taken[0]} is a force and another name too", where=f"variables of {law.name}", remedy="rename the force")
    states = {law.symbols()[name] for name in variables}
    for relation in law.constraints:
        if stray := relation.free_symbols & states:
            what = f"the constraint {relation} relates {', '.join(sorted(map(str, stray)))}"
            raise InputError(what, where=law.name, remedy="constraints relate parameters; give a variable its range by min and max")
    for name in (*law.rates, *law.unforced):
        if name not in variables or not variables[name].internal:
            internal = ", ".join(name for name, own in variables.items() if own.internal) or "none"
            raise InputError(f"{name!r} has a rate and is no internal variable", where=law.name, remedy=f"they are: {internal}")
    for name in law.unforced:
        if variables[name].force is not None:
            remedy = "its rate is an entry of the flow; put what needs no multiplier in rates"
            raise InputError(f"{name} has a force, and a rate beside the flow", where=law.name, remedy=remedy)
    check_heat(law)
    if law.forces_of_rates:
        _check_forces_of_rates(law)
    stored = set() if law.energy is None else law.energy.free_symbols
    for name, own in variables.items():
        if own.internal and own.force is None and law.symbols()[name] in stored:
            what = f"the energy depends on {name}, which has no force"
            remedy = f'give it one, such as {name} = {{ force = "Y" }}, and declare that'
            raise InputError(what, where=f"energy of {law.name}", remedy=remedy)
    known = {law.symbols()[name] for name in law.parameters}
    if law.energy is not None and (stray := law.energy.free_symbols - known):
        remedy = "an energy is a formula in variables and parameters"
        raise InputError(f"the energy uses {sorted(map(str, stray))}", where=f"energy of {law.name}", remedy=remedy)


def _check_forces_of_rates(law: Any) -> None:
    """InputError where not every force is a function of the rates, or the law states more than these, which nobody would examine."""
    where = f"forces of rates of {law.name}"
    if missing := [f for f in law.forces if f not in law.forces_of_rates or f not in law.variables.driven()]:
        remedy = f'give it as a function of the rates, and declare a variable such as {missing[0]}_in = {{ force = "{missing[0]}" }}'
        raise InputError(f"the force {missing[0]} is no function of the rate of a variable", where=where, remedy=remedy)
    stray = {x.name for x in sp.Tuple(*law.forces_of_rates.values()).free_symbols} & {*law.forces}
    if stray := stray | ({*law.forces_of_rates} - {*law.forces}):
        remedy = f"write functions of the rates, one for each of {', '.join(law.forces)}"
        raise InputError(f"{', '.join(sorted(stray))} is no force, or a force depends on it", where=where, remedy=remedy)
    if more := [name for name in ("flow", "surfaces", "viscous", "rates", "unforced", "energy", "heat", "domain") if getattr(law, name)]:
        raise InputError(f"the law has {more[0]} too", where=where, remedy=f"remove {more[0]}: a law with forces_of_rates has nothing else")


def check_heat(law: Any) -> None:
    """InputError where heat flows without a temperature, from a body whose own may be <= 0, or as forces tell."""
    if not law.heat:
        return
    where, temperature = f"heat of {law.name}", law.temperature
    if temperature is None:
        raise InputError("heat flows into a law without a temperature", where=where, remedy="declare T = { temperature = true }")
    if (high := law.parameters[temperature].high) is not None and high <= 0:
        raise InputError(f"the temperature {temperature} is never > 0", where=where, remedy="give it a range above 0, in kelvin")
    for name, conductance in law.heat.items():
        own = law.parameters[name]
        if name in law.variables or not (own.positive or (own.low is not None and own.low > 0)):
            remedy = "declare it nowhere else: heat declares it, as a number > 0"
            raise InputError(f"the temperature {name} of a body is declared in another way too", where=where, remedy=remedy)
        if stray := {x for x in conductance.free_symbols if x.name in law.forces}:
            remedy = "a conductance is a formula in variables, temperatures, parameters and the pressure"
            raise InputError(f"the conductance to {name} uses {sorted(map(str, stray))}", where=where, remedy=remedy)


def evolves(law: Any) -> bool:
    """Whether an increment of a :class:`~duhem.law.formula_law.Criterion` is more than a closest point of its K.

    It is where the law has variables, an energy, rates without a multiplier, a potential of rates, or a flow of its own.
    """
    return bool(law.variables or law.energy is not None or law.rates or law.viscous or not law.associated)


def prescribed(law: Any) -> tuple[str, ...]:
    """The forces whose observables a loading path prescribes: all of them where nobody declares an energy."""
    if law.energy is None:
        return tuple(law.forces)
    observed = law.variables.observed()
    return (*(f for f in law.forces if f in observed), *(f for f in observed if f not in law.forces))


def check_stateless(law: Any, what: str) -> None:
    """InputError for ``what``, which knows closest points of K alone, where an energy or rates of the law make more of an increment."""
    check_has_k(law)
    if law.energy is not None or law.viscous or law.rates:
        remedy = "let duhem.simulate integrate it, or state K in a file without [energy] and [dissipation]"
        said = f"an increment of {law.name} is more than a closest point of K, but {what} knows closest points only"
        raise InputError(said, where="law", remedy=remedy)


def check_has_k(law: Any) -> None:
    """InputError for a law with which nothing is computed: its forces are functions of the rates, or its g is kept as a graph."""
    if law.forces_of_rates:
        what = f"{law.name} gives forces as functions of the rates, so it has no K"
        raise InputError(what, where="law", remedy="duhem verify decides its claims; nothing else is done with such a law")
    if (graph := graph_of(law.g)) is not None:
        what = f"g of {law.name} is kept as a graph of {len(graph.nodes)} definitions, since it is too large to be written out"
        raise InputError(what, where="law", remedy="duhem verify decides its claims, duhem plot draws K; all else takes a shorter formula")


@lru_cache(maxsize=256)
def frozen(law: Any) -> Any:
    """The law at frozen variables: of these the ones that g names are parameters, and nothing else of the state is left."""
    if not law.variables:
        return law
    used = {str(x) for x in law.g.free_symbols}
    kept = {name: domain for name, domain in law.parameters.items() if name in used or name not in (*law.variables, *law.heat)}
    bare = {"written_energy": "", "variables": NO_STATE, "unforced": {}, "written_unforced": {}, "heat": {}, "written_heat": {}}
    return replace(law, parameters=kept, g=law.g if not law.surfaces else sp.nan, energy=None, **bare)
