"""The thermodynamics of a law with a state: its forces, the inequality of Clausius and Duhem in full, and the heat equation.

chi = (u, alpha, T) are the observables, the internal variables and the temperature of the law, psi_C(chi) is its free energy;
sigma = d psi_C/d u, s_C = -d psi_C/d T and Y = -d psi_C/d alpha (Antoni et al. 2007, Eqs. 24-26).  With q_k . n_k the heat that flows from
body k into the interface, D = D_intr + D_th >= 0 (Eqs. 22, 23), and the first law, with the internal energy psi_C + T s_C, gives

    T ds_C/dt = D_intr + sum q_k . n_k,    c_C dT/dt = T sum d2 psi_C/dT dchi . dchi/dt + D_intr + sum q_k . n_k,    c_C = -T d2 psi_C/dT2.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from random import Random

import sympy as sp

from duhem.derivation.equation import Equation, Names, columns, dot, equal
from duhem.derivation.support_function import finite, sample_values
from duhem.errors import InputError
from duhem.expression import mpmath_
from duhem.expression.branches import gradient
from duhem.expression.vocabulary import Norm, Where
from duhem.law.formula_law import Criterion
from duhem.law.state import variables_of
from duhem.omitted import LeftOut

__all__ = ["DISSIPATION", "STATE", "heat_equations", "in_state", "on_boundary", "state_equations"]

STATE, DISSIPATION, HEAT = "State and state laws", "Clausius-Duhem inequality", "Heat equation"


def _slopes(law: Criterion, psi: sp.Expr) -> dict[str, sp.Expr]:
    """The derivative of psi, or of one of its derivatives, by each variable; InputError where a part has none."""
    try:
        found = gradient(psi, [law.symbols()[name] for name in law.variables])
    except InputError as fault:
        raise InputError(fault.what, where=f"energy of {law.name}", remedy="write the energy with words that have a derivative") from None
    return dict(zip(law.variables, map(sp.factor_terms, found), strict=True))


def in_state(law: Criterion) -> dict[sp.Symbol, sp.Expr]:
    """Each force as a function of the state, Y = -d psi_C/d alpha; nothing without an energy.

    InputError where an observable gives the same force another value.
    """
    if law.energy is None:
        return {}
    slopes, table = _slopes(law, law.energy), law.symbols()
    found = {table[force]: -slopes[name] for force, name in variables_of(law).driven().items()}
    for force, name in variables_of(law).observed().items():
        if table.get(force) in found and not _alike(law, slopes[name], found[table[force]]):
            own = variables_of(law).driven()[force]
            what = f"d psi/d {name} and -d psi/d {own} differ, and both are said to be {force}"
            raise InputError(what, where=f"energy of {law.name}", remedy=f"let the energy depend on {name} - {own}, or mend the forces")
    return found


def _expand_alike(one: sp.Expr, other: sp.Expr) -> bool:
    return bool(sp.expand(one - other) == 0)


def _alike(law: Criterion, one: sp.Expr, other: sp.Expr) -> bool:
    """Whether they expand to the same, or agree to 20 digits at exact states drawn at random, which is no proof."""
    if _expand_alike(one, other):
        return True
    symbols, context = law.symbols().values(), mpmath_.digits(40)
    values, seen = mpmath_.compiled([one, other], symbols, context), 0
    for point in sample_values(law, (), Random(25), 8):
        try:
            a, b = finite(values(*(point.get(x, sp.S.Zero) for x in symbols)))
        except ArithmeticError:  # outside of where the energy has a value
            continue
        if abs(a - b) > context.mpf(10) ** -20 * (1 + abs(a)):
            return False
        seen += 1
    return seen > 0


def state_equations(names: Names, left_out: list[LeftOut]) -> Iterator[Equation]:
    """Equations 22 to 26 and 30: the variables, the energy with its derivatives, and the dissipation in full."""
    law, state, variables = names.law, names.state, variables_of(names.law)
    assert state is not None
    table, thermal = law.symbols(), law.temperature
    if thermal is None:
        left_out.append(LeftOut("thermal block: T_C, s_C, heat fluxes and D_th of Eq. (23)", "the law has no temperature"))
    left_out.append(LeftOut("decomposition (21) and elastic part (31)", "the state is that of the variables of the law"))
    if variables:
        said = "; ".join(f"{name}: {own.describe()}" for name, own in variables.items())
        yield Equation("24", "state_variables", equal(state.variables, sp.Tuple(*(table[x] for x in variables))), said, STATE)
    bounds = [relation for name, own in variables.items() for relation in own.domain.relations(table[name])]
    if bounds:
        within = bounds[0] if len(bounds) == 1 else sp.And(*bounds, evaluate=False)
        yield Equation("24'", "admissible_states", within, "bounds of the variables; an evolution stops at them", STATE)
    reduced, work, cold = dot(names.forces, names.rates), sp.S.Zero, sp.S.Zero
    change: sp.Expr = sp.S.Zero
    if law.energy is None:
        left_out.append(LeftOut("free energy, state laws (25) and forces in the state (26)", "the law declares no energy"))
    else:
        slopes, observed, forces = _slopes(law, law.energy), variables.observed(), in_state(law)
        stress = [table.get(force, sp.Symbol(force, real=True)) for force in observed]  # no force of the law where nothing slips
        yield Equation("30", "free_energy", equal(state.energy, law.energy), "free energy, as declared", STATE)
        if observed:
            relation = columns(stress, [slopes[name] for name in observed.values()])
            yield Equation("25", "state_law", relation, "sigma = d psi_C/d u for each observable", STATE)
        else:
            left_out.append(LeftOut("state laws (25)", "the law has no observable"))
        if thermal is not None:
            yield Equation("25'", "entropy", equal(state.entropy, -slopes[thermal]), "entropy s_C = -d psi_C/d T", STATE)
            cold = state.entropy * state.rate[thermal]
        note = "Y = -d psi_C/d alpha for each internal variable that has a force; that of a slip is the stress of (25)"
        shared = [(x, slopes[name]) for x, name in zip(stress, observed.values(), strict=True) if x in forces]
        if tried := [str(x) for x, slope in shared if not _expand_alike(slope, forces[x])]:
            note += f", which was compared at random states only for {', '.join(tried)}"
        yield Equation("26", "thermodynamic_forces", columns(forces, forces.values()), note, STATE)
        work = dot(stress, [state.rate[name] for name in observed.values()])
        change = dot(slopes.values(), state.rate.values())
    yield from _inequality(names, work - change - cold, reduced, work - reduced - cold)


def _inequality(names: Names, intrinsic: sp.Expr, reduced: sp.Expr, energy_rate: sp.Expr) -> Iterator[Equation]:
    law, state = names.law, names.state
    assert state is not None
    known, thermal = law.energy is not None, law.temperature
    note = "second principle at the interface"
    isothermal = "" if thermal else "; no temperature, so the whole dissipation is the intrinsic one"
    yield Equation("22", "clausius_duhem", sp.GreaterThan(state.total, 0, evaluate=False), note + isothermal, DISSIPATION)
    if thermal is not None:
        split = equal(state.total, names.power + state.thermal)
        yield Equation(
            "22'", "dissipation_split", split, "intrinsic part, of the mechanisms, and thermal part, of the conduction", DISSIPATION
        )
    if known:
        note = "D_intr = sigma . du/dt - (dpsi_C/dt + s_C dT/dt), dpsi_C/dt by the chain rule"
        yield Equation("23", "intrinsic_dissipation", equal(names.power, intrinsic), note, DISSIPATION)
    if thermal is not None:
        conducted = sp.Add(*(q / body * (body - law.symbols()[thermal]) for body, q in state.bodies))
        note = "sum of (q_k . n_k/T_k) (T_k - T), where body k, at T_k, gives the heat q_k . n_k to the interface"
        note += ": h_k (T_k - T)" if law.heat else ", which the law leaves open"
        yield Equation("23'", "thermal_dissipation", equal(state.thermal, conducted), note, DISSIPATION)
    note = "what (23) leaves once (25) and (26) hold: the power of the forces on the rates of the internal variables"
    yield Equation("D2", "reduced_dissipation", equal(names.power, reduced), note, DISSIPATION)
    if known:
        note = "rate of the energy by (25) and (26): power of the stress, less what is dissipated" + ", less s_C dT/dt" * bool(thermal)
        yield Equation("D20", "energy_rate", equal(state.energy_rate, energy_rate), note, DISSIPATION)


def heat_equations(names: Names, left_out: list[LeftOut]) -> Iterator[Equation]:
    """How the temperature changes; D_intr is that of the evolution law."""
    law, state = names.law, names.state
    assert state is not None
    if (thermal := law.temperature) is None:
        return
    if law.energy is None:
        left_out.append(LeftOut("entropy and heat equation", "the law declares no energy"))
        return
    warm, slopes = law.symbols()[thermal], _slopes(law, law.energy)
    mixed = _slopes(law, slopes[thermal])
    flowing = sp.Add(*(q for _, q in state.bodies))
    note = "heat capacity c_C = -T d2 psi_C/dT2, per unit of area"
    yield Equation("D21", "heat_capacity", equal(state.capacity, -warm * mixed.pop(thermal)), note, HEAT)
    note = "first law with the internal energy psi_C + T s_C: what is dissipated and what flows in from the bodies"
    yield Equation("D22", "heat_balance", equal(warm * state.entropy_rate, names.power + flowing), note, HEAT)
    coupled = warm * dot(mixed.values(), [state.rate[name] for name in mixed])
    note = "(D22) with (25'): thermoelastic term T d2 psi_C/dT dchi . dchi/dt, dissipation, heat from the bodies"
    if coupled == 0:
        note = "(D22) with (25'): dissipation and heat from the bodies; no thermoelastic term, since d2 psi_C/dT dchi = 0"
    balance = equal(state.capacity * state.rate[thermal], coupled + names.power + flowing)
    yield Equation("D23", "heat_equation", balance, note, HEAT)


def on_boundary(g: sp.Expr, power: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Expr | None:
    """The power where g = 0, if one norm or modulus N of the forces is all that is no polynomial of them, and g is linear in N.

    N^2 is the sum of the squares of its arguments, sign(x) is x/|x|, and g = 0 says what N is.
    """
    signs: Mapping[sp.Expr, sp.Expr] = {
        word: word.sign_of / sp.Abs(word.sign_of) for word in power.atoms(Where) if isinstance(word, Where) and word.sign_of is not None
    }
    power = power.xreplace(signs)
    sizes = [size for size in sp.Tuple(g, power).atoms(Norm, sp.Abs) if size.has(*forces)]
    if len(sizes) != 1:
        return None
    size, root = sizes[0], sp.Dummy("N", positive=True)
    above, below = sp.fraction(sp.together(power.xreplace({size: root})))
    bare, square = g.xreplace({size: root}), sp.Add(*(x**2 for x in size.args))
    slope = bare.diff(root)
    if slope == 0 or slope.has(root, *forces) or not all(x.is_polynomial(root, *forces) for x in (bare, above, below, square)):
        return None
    _, rest = sp.reduced(above, [square - root**2], *forces, root)
    return sp.expand(sp.cancel(rest / below).xreplace({root: -(bare - slope * root) / slope}))
