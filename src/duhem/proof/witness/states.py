"""The exact check of what refutes in a state of a law: signs at plain values of its variables, with the forces that its energy gives.

A state counts where the energy has a value; what says nothing of some variables is told with all of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import sympy as sp

from duhem.law.formula_law import Criterion
from duhem.law.frozen_mapping import FrozenMapping
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values, rationals
from duhem.proof.in_state import Spent, forces_in
from duhem.proof.statement import parsed_as_written
from duhem.proof.verdict import Witness
from duhem.proof.witness.points import decimal_pair, sign_at

__all__ = ["less_than_0", "of_energy", "two_forces_at", "with_variables"]


def less_than_0(subject: FormulaSubject, spent: Spent, values: Values, name: str, statement: str) -> Witness | None:
    """The power is < 0 in this state, or None if that, or that the state is one of the law, is not certain."""
    sign, power = sign_at(spent.power, values)
    if sign != -1 or not subject.admits(values) or not _has_a_value(spent.energy, values):
        return None
    shown = {name: decimal_pair(power)}
    if spent.bound is not None:
        height, enclosure = sign_at(spent.bound, values, exact=True)
        if height not in ((0,) if spent.on_it else (-1, 0)):
            return None
        shown = {"g": decimal_pair(enclosure), **shown}
    return _in_state(subject.of, values, shown, statement, {x.name: x for x in spent.chosen})


def two_forces_at(subject: FormulaSubject, gaps: Mapping[str, sp.Expr], states: Iterable[Values], statement: str) -> Witness | None:
    """The first state in which one of what must be 0 is certainly not; None where none of them shows that."""
    law = subject.of
    stored = None if law.energy is None else parsed_as_written(law, law.energy, law.written_energy, law.symbols())
    for values in states:
        if subject.admits(values) and _has_a_value(stored, values):
            for name, gap in gaps.items():
                sign, enclosure = sign_at(gap, values)
                if sign in (1, -1):
                    return _in_state(law, values, {name: decimal_pair(enclosure)}, statement)
    return None


def _has_a_value(energy: sp.Expr | None, values: Values) -> bool:
    """Whether it certainly has one; where there is none, nothing is asked."""
    return energy is None or bool(sign_at(energy, values)[1].is_finite())


def _in_state(
    law: Criterion, values: Values, shown: Mapping[str, tuple[str, str]], statement: str, chosen: Mapping[str, sp.Symbol] = FrozenMapping()
) -> Witness:
    """A state with all its variables, what else is ``chosen``, the pressure, and the forces of the energy where these are fractions."""
    table, exact = law.symbols(), rationals(values)
    given = {} if law.energy is None else {f: force.xreplace(exact) for f, force in forces_in(law).items()}
    named = {name: values[x] for name, x in {**table, **chosen}.items() if name not in law.parameters and x in values}
    pressed = {str(law.pressure): -v for x, v in values.items() if x.name == f"abs({law.pressure})"}
    variables = {name: values[table[name]] for name in law.variables}
    state = {name: str(v) for name, v in {**variables, **named, **pressed}.items()}
    state |= {f: str(v) for f, v in given.items() if v.is_Rational}
    parameters = {name: str(values[table[name]]) for name in law.parameters if name not in law.variables and table[name] in values}
    return Witness(parameters, {"state": state}, shown, statement)


def of_energy(subject: FormulaSubject, chord: Witness, name: str, statement: str) -> Witness:
    """A chord of the epigraph of an energy as what it says of that, every variable among its points."""
    states = {x: v for x, v in chord.parameters.items() if x in subject.of.variables}
    shown = {role.replace("g(", f"{name} - z at ").rstrip(")"): value for role, value in chord.values.items()}
    parameters = {x: v for x, v in chord.parameters.items() if x not in states}
    return Witness(parameters, {role: {**states, **point} for role, point in chord.points.items()}, shown, statement)


def with_variables(subject: FormulaSubject, found: Witness) -> Witness:
    """The displacements, if they are fractions, that give the forces at each point, and with them every variable and force."""
    law, table = subject.of, subject.of.symbols()
    seen = {own.force: name for name, own in law.variables.items() if own.observable and own.force in subject.law.forces}
    if subject.state is None or not subject.state.onto or law.energy is None:
        return found
    fixed = {table[name]: sp.Rational(v) for name, v in found.parameters.items() if name not in seen.values()}
    forces, points = {f: x.xreplace(fixed) for f, x in forces_in(law).items()}, {}
    for role, point in found.points.items():
        answer = sp.solve([forces[f] - sp.Rational(point[f]) for f in seen], [table[name] for name in seen.values()], dict=True)
        here = fixed | (answer[0] if answer else {})
        given = {**{name: here.get(table[name]) for name in law.variables}, **{f: x.xreplace(here) for f, x in forces.items()}}
        if not all(value is not None and value.is_Rational for value in given.values()):
            return found
        points[role] = {**{name: str(value) for name, value in given.items()}, **point}
    return replace(found, parameters={x: v for x, v in found.parameters.items() if x not in law.variables}, points=points)
