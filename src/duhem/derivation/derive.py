"""From one formula to its thermodynamics: state laws, normality, dissipation, potential, increment, one dimension.

The relations are those of Antoni et al. (2007), Eqs. 1 and 21-36, by differentiation, and what follows from them.  Everything one-sided is
taken from the smooth branches of g, never from two-sided limits at a kink.  The slip of a law of several surfaces with flows of their own
is a non-negative combination over those that are 0 (Koiter 1953).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import add, sub
from pathlib import Path
from random import Random
from typing import Any

import sympy as sp

from duhem.derivation.equation import Belongs, Derivation, Equation, Names, columns, dot, equal, put
from duhem.derivation.pieces import MOST, Pieces, Seams, pieces, seams
from duhem.derivation.recognise import read_ball
from duhem.derivation.support_function import SupportFunction, biconjugate, compression, fixed, sample_values, support_function, varies
from duhem.derivation.thermodynamics import DISSIPATION, STATE, heat_equations, in_state, on_boundary, state_equations
from duhem.errors import InputError
from duhem.expression import mpmath_
from duhem.expression.dimensions import degree
from duhem.expression.vocabulary import Norm
from duhem.law.catalogue import load, load_formula
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.omitted import LeftOut

__all__ = ["derive"]

CRITERION, FLOW, POTENTIAL = "Criterion", "Evolution law", "Dissipation potential"
STEP, LINE = "Incremental problem", "Reduction to one direction"


def _energy(names: Names, strain: Iterable[sp.Expr]) -> sp.Expr:
    """1/2 strain . k strain; of u - u_in it is the free energy psi_C (Antoni et al. 2007, Eq. 30)."""
    vector = sp.Matrix(list(strain))
    return (vector.T * names.stiffness * vector)[0] / 2


def _needs(names: Names, requires: Sequence[sp.Expr]) -> str:
    """Where something holds, to be said behind it."""
    return f"; where {', '.join(f'{names.shown(r)} > 0' for r in requires)}" if requires else ""


def _state_equations(names: Names) -> Iterator[Equation]:
    """Equations 21 to 31, isothermal; what has to agree is checked here, symbolically."""
    u, p, v, d = names.total, names.inelastic, names.speed, names.rates
    psi = _energy(names, map(sub, u, p))
    stress = [sp.factor_terms(psi.diff(x)) for x in u]
    forces = [sp.factor_terms(-psi.diff(x)) for x in p]
    if any(sp.expand(a - b) != 0 for a, b in zip(stress, forces, strict=True)):
        raise ArithmeticError("dpsi/du and -dpsi/du_in differ")
    note = "displacement = elastic (reversible) part + inelastic part (slip)"
    yield Equation("21", "decomposition", columns(u, map(add, names.elastic, p)), note, STATE)
    note = "observable and internal state variables; no temperature and no further internal variable"
    yield Equation("24", "state_variables", equal(sp.Symbol("chi"), sp.Tuple(*u, *p)), note, STATE)
    note = "stored energy, quadratic in the elastic part u - u_in"
    yield Equation("30", "free_energy", equal(sp.Symbol("psi_C", real=True), psi), note, STATE)
    minors = [sp.StrictGreaterThan(names.stiffness[:i, :i].det(), 0, evaluate=False) for i in range(1, len(u) + 1)]
    note = "psi_C is strictly convex in u - u_in: leading minors of its Hessian, the stiffness (Sylvester)"
    yield Equation("D1", "free_energy_convex", sp.And(*minors, evaluate=False), note, STATE)
    yield Equation("25", "state_law", columns(names.forces, stress), "sigma = d psi_C/d u", STATE)
    pulled = [sp.factor_terms(_energy(names, names.elastic).diff(e)) for e in names.elastic]
    yield Equation("31", "state_law_elastic", columns(names.forces, pulled), "the same in the elastic part: sigma = k u_e", STATE)
    if len(u) == 1:
        note = "the same solved for the elastic part, the reversible slip before the macroscopic one"
        yield Equation("19", "elastic_slip", columns(names.elastic, [names.forces[0] / names.stiffness[0]]), note, STATE)
    note = "the force Y = -d psi_C/d u_in that drives the slip is the stress itself (difference expanded to 0)"
    yield Equation("26", "thermodynamic_forces", columns(names.forces, forces), note, STATE)
    change, power = dot([sp.factor_terms(psi.diff(x)) for x in (*u, *p)], (*v, *d)), dot(names.forces, v)
    note = "second principle at the interface; isothermal, so the whole dissipation is the intrinsic one"
    yield Equation("22", "clausius_duhem", sp.GreaterThan(names.power, 0, evaluate=False), note, DISSIPATION)
    note = "D = sigma . du/dt - dpsi_C/dt by the chain rule; the entropy term dT_C/dt s_C is zero"
    yield Equation("23", "intrinsic_dissipation", equal(names.power, power - change), note, DISSIPATION)
    reduced = dot(names.forces, d)
    if sp.expand((power - change - reduced).xreplace(dict(zip(names.forces, stress, strict=True)))) != 0:
        raise ArithmeticError("the Clausius-Duhem inequality does not reduce to the power of the stress on the slip rate")
    note = "what is left of (23) once the state law (25) holds: the power of the stress on the slip rate"
    yield Equation("D2", "reduced_dissipation", equal(names.power, reduced), note, DISSIPATION)


# -- laws of several surfaces -----------------------------------------------------------------------------------------


def _slips(law: Criterion) -> tuple[tuple[sp.Expr, ...], ...] | None:
    """On each surface its flow, or else the gradient of its g, branch by branch; None where one has too many branches to print."""
    found = [surface.flow or _gradient(replace(law, g=surface.g, surfaces=())) for surface in law.surfaces]
    return None if None in found else tuple(flow for flow in found if flow is not None)


def _gradient(law: Criterion) -> tuple[sp.Expr, ...] | None:
    found = pieces(law)
    return None if found is None else tuple(found.joined(list(parts)) for parts in zip(*found.gradients, strict=True))


def _complementary(surfaces: Iterable[sp.Expr], multipliers: Iterable[sp.Symbol]) -> sp.Basic:
    """Every g with its multiplier: >= 0, <= 0, one of them 0."""
    three = [
        relation
        for m, g in zip(multipliers, surfaces, strict=True)
        for relation in (sp.GreaterThan(m, 0, evaluate=False), sp.LessThan(g, 0, evaluate=False), equal(m * g, sp.S.Zero))
    ]
    return sp.And(*three, evaluate=False)


def _flow_of_surfaces(names: Names) -> Iterator[Equation]:
    """Koiter's rule in rates, and the power it dissipates."""
    if (flows := _slips(names.law)) is None:
        return
    note = "Koiter's rule: each surface that is 0 slips along its own flow, or along its normal if it states none"
    given = [dot(names.multipliers, parts) for parts in zip(*flows, strict=True)]
    yield Equation("D4", "flow", _rates(names, given), note, FLOW)
    both = _complementary([s.g for s in names.law.surfaces], names.multipliers)
    yield Equation("36'", "complementarity", both, "a surface slips only where it is 0, and never backwards", FLOW)
    power = dot(names.multipliers, [sp.factor_terms(dot(names.forces, flow)) for flow in flows])
    yield from _dissipated(names, power, "D = sum of lambda_i sigma . flow_i")


def _step_of_surfaces(names: Names) -> Iterator[Equation]:
    """The same over an increment: a fixed point with one multiplier a surface, not a projection."""
    if (flows := _slips(names.law)) is None:
        return
    moved = names.stiffness * sp.Matrix([dot(names.steps, parts) for parts in zip(*flows, strict=True)])
    ends = columns(names.forces, map(sub, names.trial, moved))
    yield Equation("D14", "step_stress", ends, "own flows: a fixed point, not a projection", STEP)
    both, note = _complementary([s.g for s in names.law.surfaces], names.steps), "a surface slips in the step only if the step ends on it"
    yield Equation("D16", "step_complementarity", both, note, STEP)


# -- laws of one surface ----------------------------------------------------------------------------------------------


def _either(names: Names, alone: str, in_state: str) -> str:
    """What is said of a law without a state, or of one with, where forces are more than a stress and rates more than a slip."""
    return alone if names.state is None else in_state


def _rooted(expr: sp.Expr) -> sp.Expr:
    """Norms written as square roots."""
    return expr.replace(Norm, lambda *args: sp.sqrt(sp.Add(*[a**2 for a in args])))


def _definitions(law: Criterion) -> Iterator[Equation]:
    for i, (name, value) in enumerate(law.defined().items(), 1):
        note = f"as defined: {name} = {' '.join(law.define[name].split())}"
        yield Equation(f"D0.{i}", f"definition_{name}", equal(sp.Symbol(name, real=True), value), note, CRITERION)


def _evolution_equations(names: Names, found: Pieces | None) -> Iterator[Equation]:
    """Equations 28 and 32 to 36."""
    law, forces = names.law, names.forces
    inside = sp.LessThan(law.g, 0, evaluate=False)
    yield Equation("35", "criterion", equal(sp.Symbol("g"), law.g), "the limit criterion, as declared", CRITERION)
    if found is not None and len(found.values) > 1:
        note = "the same, branch by branch: each kink of the formula resolved on either side"
        yield Equation("35'", "criterion_branches", equal(sp.Symbol("g"), found.joined([*map(_rooted, found.values)])), note, CRITERION)
    admissible = sp.ConditionSet(sp.Tuple(*forces), inside, sp.S.UniversalSet)
    frozen = ["pressure"] * bool(law.pressure) + [name for name in law.variables if law.symbols()[name] in law.g.free_symbols]
    note = f"the admissible {_either(names, 'stresses', 'forces')}" + (f" at frozen {', '.join(frozen)}" if frozen else "")
    yield Equation("32", "admissible_set", equal(sp.Symbol("K"), admissible), note, CRITERION)
    indicator = sp.Function("I_K")(*forces)
    if law.associated:
        dual = equal(sp.Function("Phi_C_star")(*forces), indicator)
        yield Equation("33", "dual_potential", dual, "dual pseudo-potential: the indicator of K", CRITERION)
    indicated = equal(indicator, sp.Piecewise((sp.S.Zero, inside), (sp.oo, True), evaluate=False))
    yield Equation("34", "indicator", indicated, "zero on K, infinite outside", CRITERION)
    if not law.associated:
        yield from _own_flow(names) if law.flow is not None else _flow_of_surfaces(names)
        return
    plastic = names.plastic
    note = _either(names, "the slip rate is", "the rates that the multiplier gives are") + " a subgradient of the indicator, "
    note += _either(names, "that is an element of the normal cone of K", "an element of the normal cone of K")
    yield Equation("28", "evolution_inclusion", Belongs(sp.Tuple(*plastic), sp.Function("N_K")(*forces)), note, FLOW)
    note = "what (28) says, for every tau in K: maximal dissipation; at an interior point the cone is {0}"
    yield Equation("D3", "normal_cone", sp.LessThan(dot(plastic, map(sub, names.other, forces)), 0, evaluate=False), note, FLOW)
    if found is None:
        return
    met = seams(law, found)
    normal = [found.joined([g[i] for g in found.gradients]) for i in range(len(forces))]
    note = f"outward normal n = dg/d{_either(names, 'sigma', 'Y')}"
    yield Equation("D4", "normal", columns(names.normal, normal), note + _smoothness(names, found, met), FLOW)
    given = [names.multiplier * n for n in names.normal]
    note = "normality rule where g is differentiable, n of (D4)"
    yield Equation("36", "normality", _rates(names, given, names.multiplier), note, FLOW)
    yield _complementarity(names)
    yield from _corners(names, found, met)
    yield from _dissipation(names, found)


def _rates(names: Names, given: Iterable[sp.Expr], unit: sp.Expr = sp.S.Zero) -> sp.Basic:
    """The rates of the internal variables: what is ``given`` and what needs no multiplier; without a force, ``unit`` times their own."""
    law, rate = names.law, names.state.rate if names.state is not None else {}
    idle = [x for x, own in law.variables.items() if own.internal and own.force is None and (unit != 0 or x not in law.unforced)]
    rest = [unit * law.unforced.get(name, sp.S.Zero) + law.rates.get(name, sp.S.Zero) for name in idle]
    return columns([*names.rates, *(rate[name] for name in idle)], [*map(_plus, given, names.beside), *rest])


def _plus(expr: sp.Expr, more: sp.Expr) -> sp.Expr:
    """The sum, in every branch where the first has branches."""
    if more == 0 or not isinstance(expr, sp.Piecewise):
        return expr + more
    return sp.Piecewise(*((value + more, condition) for value, condition in expr.args), evaluate=False)


def _dissipated(names: Names, power: sp.Expr, note: str, boundary: sp.Expr | None = None) -> Iterator[Equation]:
    """The dissipation, and the same with the forces put in as functions of the state; ``boundary`` is the power on g = 0."""
    beside = dot(names.forces, names.beside)
    more = "; then what the rates without a multiplier dissipate" if beside != 0 else ""
    yield Equation("D6", "dissipation", equal(names.power, _plus(power, beside)), note + more, FLOW)
    forces = {} if names.state is None else in_state(names.law)
    known = _plus(power if boundary is None else boundary, beside)
    if forces and (known.has(*forces) or boundary is not None):
        note = f"{'on g = 0, ' if boundary is not None else ''}the same with the forces put in as functions of the state (26)"
        yield Equation("D6'", "dissipation_in_state", equal(names.power, put(known, forces)), note, FLOW)


def _complementarity(names: Names) -> Equation:
    both = _complementary([names.law.g], [names.multiplier])
    return Equation("36'", "complementarity", both, "slip only on the boundary, and never against the normal", FLOW)


def _smoothness(names: Names, found: Pieces, met: Seams) -> str:
    said = []
    if met.corners:
        places = " or ".join(dict.fromkeys(f"{names.shown(c.switch)} = 0" for c in met.corners))
        said.append(f"on the boundary, at exact parameters drawn at random, its direction jumps where {places}")
    elif met.met and met.decided:
        said.append("its direction is continuous where branches meet, as seen on the boundary at exact parameters drawn at random")
    if not met.decided:
        said.append("not every seam of the branches was decided")
    where = _singular(names, found)
    if where:
        said.append("not defined where " + "; ".join(where))
    return "; " + "; ".join(said) if said else ""


def _singular(names: Names, found: Pieces) -> list[str]:
    """Points where all arguments of a norm vanish, and the value of g there."""
    forces, said = names.forces, []
    for norm in dict.fromkeys(n for v in found.values for n in v.atoms(Norm) if n.has(*forces)):
        if not all(a.is_polynomial(*forces) and sp.Poly(a, *forces).total_degree() <= 1 for a in norm.args):
            continue
        for point in sp.linsolve(list(norm.args), *forces):
            value = names.law.g.subs(dict(zip(forces, point, strict=True)))
            place = ", ".join(str(names.shown(x)) for x in point)
            said.append(f"({', '.join(map(str, forces))}) = ({place}), where g = {names.shown(value)}")
    return list(dict.fromkeys(said))


def _corners(names: Names, found: Pieces, met: Seams) -> Iterator[Equation]:
    """The cone spanned by the two normals that meet at a corner of the boundary."""
    for count, corner in enumerate(met.corners, start=1):
        one, two = sp.Symbol("lambda_1", nonnegative=True), sp.Symbol("lambda_2", nonnegative=True)
        spanned = [one * a + two * b for a, b in zip(found.gradients[corner.first], found.gradients[corner.second], strict=True)]
        signs = {**found.switches[corner.second], **found.switches[corner.first]}
        plain = {s: sign for s, sign in signs.items() if s in names.forces} or signs
        sides = [f"{names.shown(s)} {'>=' if sign > 0 else '<='} 0" for s, sign in plain.items() if s != corner.switch]
        where = ", ".join([f"{names.shown(corner.switch)} = 0", *sides])
        note = f"normal cone of a convex K at boundary points with {where}; lambda_1, lambda_2 >= 0"
        yield Equation(f"D5.{count}", f"corner_{count}", columns(names.rates, map(add, spanned, names.beside)), note, FLOW)


def _dissipation(names: Names, found: Pieces) -> Iterator[Equation]:
    powers = [dot(names.forces, g) for g in found.gradients]
    reduced = [_euler(names.law, value, power) for value, power in zip(found.values, powers, strict=True)]
    known, note = [r for r in reduced if r is not None], f"D = lambda {'sigma . dg/dsigma' if names.state is None else 'Y . dg/dY'}"
    if len(known) == len(reduced):
        powers, note = known, f"{note} on g = 0, by Euler's identity for homogeneous functions"
    yield from _dissipated(names, names.multiplier * found.joined(powers), note)


def _euler(law: Criterion, value: sp.Expr, power: sp.Expr) -> sp.Expr | None:
    """sigma . dg/dsigma on g = 0 where g = (homogeneous of degree m) + constant: it is -m constant."""
    constant, part = value.as_independent(*law.force_symbols(), as_Add=True)
    if (known := _degree(part, law.force_symbols())) is not None:
        return sp.factor_terms(-known * constant)
    if varies(law, power / part):  # no multiple of it: told by numbers, which is cheap where to cancel is endless
        return None
    roots = sp.cancel(sp.powsimp(sp.expand(_rooted(power)) / _rooted(part)))
    if roots.has(*law.force_symbols()):
        roots = sp.cancel(sp.together(_rooted(power) * _rooted(part)) / sp.expand(_rooted(part) ** 2))
    return None if roots.has(*law.force_symbols()) else sp.factor_terms(-roots * constant)


def _degree(expr: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Expr | None:
    """Degree of homogeneity, of powers with a symbol for exponent too; None where there is none to see."""
    if isinstance(expr, sp.Pow) and not expr.exp.has(*forces):
        base = _degree(expr.base, forces)
        return None if base is None else base * expr.exp
    if isinstance(expr, sp.Add | sp.Mul):
        parts = [_degree(part, forces) for part in expr.args]
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        return sp.Add(*known) if isinstance(expr, sp.Mul) else known[0] if len(set(known)) == 1 else None
    return degree(expr, forces)


def _own_flow(names: Names) -> Iterator[Equation]:
    flow = names.law.flow
    assert flow is not None
    note = "slip direction declared by the law itself: not associated, normality is a claim to test"
    yield Equation("D4", "flow", _rates(names, [names.multiplier * part for part in flow], names.multiplier), note, FLOW)
    yield _complementarity(names)
    power = sp.factor_terms(sp.expand(dot(names.forces, flow)))
    reduced = None if names.law.energy is None else on_boundary(names.law.g, dot(names.forces, flow), names.forces)
    boundary = None if reduced is None else names.multiplier * reduced
    yield from _dissipated(names, names.multiplier * power, f"D = lambda {'sigma' if names.state is None else 'Y'} . flow", boundary)


def _viscous_equations(names: Names, found: Pieces | None) -> Iterator[Equation]:
    """Equation 27: the rates as the gradient of a potential, and what they dissipate."""
    potential = sp.Function("Phi_C_star")(*names.forces)
    yield Equation("27'", "dual_potential", equal(potential, names.law.g), "dual potential of rates, as declared", POTENTIAL)
    if found is None:
        return
    found = replace(found, gradients=tuple(tuple(map(_one_power, g)) for g in found.gradients))
    given = [found.joined([g[i] for g in found.gradients]) for i in range(len(names.forces))]
    note = "rates = d Phi*/dY where Phi* is differentiable; elsewhere they are a subgradient (28)"
    yield Equation("27", "evolution", _rates(names, given), note, FLOW)
    degrees = [_degree(value, names.forces) for value in found.values]
    powers = [dot(names.forces, g) if m is None else m * v for m, v, g in zip(degrees, found.values, found.gradients, strict=True)]
    note = "D = Y . dPhi*/dY, which is m Phi* where Phi* is homogeneous of degree m (Euler)"
    yield from _dissipated(names, found.joined(powers), note)


def _one_power(expr: sp.Expr) -> sp.Expr:
    """x**n for the x**(n + 1)/x of a derivative, which is 0/0 where x is 0."""
    return sp.powsimp(expr, combine="exp")


def _potential_equations(names: Names, support: SupportFunction) -> Iterator[Equation]:
    """The Legendre-Fenchel conjugate of the indicator, its flow rule turned round, and the conjugate of that."""
    own = dict(zip(support.rates, names.plastic, strict=True))
    phi, value = sp.Function("Phi_C")(*names.plastic), support.potential.xreplace(own)
    for count, form in enumerate(support.domain, start=1):
        zero, note = equal(form.xreplace(own), sp.S.Zero), "the potential is infinite elsewhere"
        yield Equation(f"D7.{count}", f"potential_domain_{count}", zero, note, POTENTIAL)
    said = "; then ".join(support.steps) + _needs(names, support.requires)
    yield Equation("D8", "dissipation_potential", equal(phi, value), said, POTENTIAL)
    if support.maximiser is not None:
        attained = columns(names.forces, [part.xreplace(own) for part in support.maximiser])
        free = "; K is unbounded along the directions of (D7), and any multiple of those may be added" if support.domain else ""
        note = "the stress that attains the supremum: the evolution law (28) solved for sigma, at nonzero slip rate"
        if names.state is not None:
            note = f"the forces that attain the supremum: the evolution law (28) solved for them, at nonzero rates{free}"
        yield Equation("D9", "stress_of_slip", attained, note, POTENTIAL)
    beside = dot(names.forces, names.beside)
    more = "; then what the rates without a multiplier dissipate" if beside != 0 else ""
    note = _either(names, "D = sigma . d = I_K(sigma) + Phi_C(d)", "D = Y . rates = I_K(Y) + Phi_C(rates)")
    note += " on the evolution law (Fenchel), and I_K = 0 on K"
    yield Equation("D9'", "fenchel_equality", equal(names.power, value + beside), note + more, POTENTIAL)
    gauge = sp.Function("gamma_K")(*names.forces)
    yield Equation("D10", "gauge", equal(gauge, support.gauge), "gauge of K about its centre: K = {gamma_K <= 1}", POTENTIAL)
    back = biconjugate(names.law, support)
    if back is not None and back.agrees:
        note = f"polar of the polar, read afresh from (D8), so that Phi** = Phi: {back.how}"
        yield Equation("D11", "biconjugate", equal(gauge, back.gauge), note, POTENTIAL)
    frozen = names.law.pressure and names.law.symbols()[names.law.pressure]
    if frozen and not support.domain and support.radius.subs(frozen, 0) == 0:
        note = f"at {frozen} = 0 K is this one point, and the normal cone is the whole space"
        yield Equation("D12", "tip", columns(names.forces, [c.subs(frozen, 0) for c in support.centre]), note, POTENTIAL)


def _increment_equations(names: Names, found: Pieces | None) -> Iterator[Equation]:
    """The closest-point step in the metric of k^-1 with its optimality conditions; every line from the Lagrangian."""
    law, forces = names.law, names.forces
    unslipped = columns(names.trial, names.stiffness * sp.Matrix(list(map(sub, names.total, names.inelastic))))
    note = "stress if nothing slipped over the step: u at its end, u_in at its beginning"
    yield Equation("D13", "trial_stress", unslipped, note, STEP)
    compliance, gap = names.stiffness.inv(), sp.Matrix(list(map(sub, names.trial, forces)))
    slip = compliance * gap
    if not law.associated and law.flow is None:
        yield from _step_of_surfaces(names)
    elif law.flow is not None:
        moved = map(sub, names.trial, names.step * names.stiffness * sp.Matrix(law.flow))
        yield Equation("D14", "step_stress", columns(forces, moved), "own flow: a fixed point, not a projection", STEP)
    else:
        distance = (gap.T * compliance * gap)[0] / 2
        note = "the stress minimises J over K: the closest point to the trial stress in the metric of k^-1"
        yield Equation("D14", "step_objective", equal(sp.Function("J")(*forces), distance), note, STEP)
        if found is not None:
            slopes = [
                found.joined([sp.factor_terms(distance.diff(f)) + (names.step * value).diff(f) for value in found.values]) for f in forces
            ]
            note = "gradient of the Lagrangian J + Delta_lambda g: k^-1 (sigma_trial - sigma) = Delta_lambda dg/dsigma"
            yield Equation("D15", "step_stationarity", columns(slopes, [sp.S.Zero] * len(forces)), note, STEP)
    if law.associated or law.flow is not None:
        both = _complementary([law.g], [names.step])
        yield Equation("D16", "step_complementarity", both, "the step slips only if it ends on the boundary", STEP)
    yield Equation("D17", "step_slip", columns(names.slip_step, slip), "slip over the step: the trial stress in excess, released", STEP)
    yield _energy_identity(names)


def _energy_identity(names: Names) -> Equation:
    """sigma . Du = Dpsi + sigma . Du_in + 1/2 Du_e . k Du_e, expanded to zero here before it is stated."""
    ends, steps = names.elastic, names.elastic_step
    lost = _energy(names, steps)
    stored = _energy(names, ends) - _energy(names, map(sub, ends, steps))
    work, slipped = dot(names.forces, map(add, steps, names.slip_step)), dot(names.forces, names.slip_step)
    stress = dict(zip(names.forces, names.stiffness * sp.Matrix(list(ends)), strict=True))
    if sp.expand((work - slipped).xreplace(stress) - stored - lost) != 0:
        raise ArithmeticError("the discrete energy identity does not hold")
    note = "work = change of stored energy + dissipation + a numerical part that is never negative, for every step size"
    return Equation("D18", "step_energy", equal(work, sp.Symbol("Delta_psi_C", real=True) + slipped + lost), note, STEP)


@dataclass(frozen=True)
class LineSection:
    """low <= force <= high is K where the other forces vanish, wherever every expression of ``requires`` is positive."""

    force: sp.Symbol
    low: sp.Expr
    high: sp.Expr
    requires: tuple[sp.Expr, ...]


def interval(law: Criterion, force: sp.Symbol) -> LineSection | None:
    """K on the line of one force, from the formula; None where it is unbounded, not closed or not confirmed by g."""
    others = dict.fromkeys((f for f in law.force_symbols() if f != force), sp.S.Zero)
    inward, outward = compression(law)
    g = law.g.xreplace({**others, **inward})
    ball = read_ball(g, [force])
    if ball is not None:
        ends = [ball.centre[0] + ball.radius * sign / ball.gauge.value([sp.Integer(sign)]) for sign in (-1, 1)]
    else:
        below, above = (_positive_root(g, force, sign) for sign in (-1, 1))
        if below is None or above is None:
            return None
        ends = [-below, above]
    if any(end.has(sp.AccumBounds, sp.nan, sp.zoo, sp.oo) for end in ends):
        return None
    low, high = (sp.factor_terms(end).xreplace(outward) for end in ends)
    found = LineSection(force, low, high, tuple(r.xreplace(outward) for r in ball.requires) if ball is not None else ())
    return found if _confirmed(law, found) else None


def _confirmed(law: Criterion, found: LineSection) -> bool:
    """Whether g, at exact parameters drawn at random, is zero at both ends, not positive between and positive outside."""
    symbols = list(law.symbols().values())
    try:
        context = mpmath_.digits(30)
        evaluate = mpmath_.compiled([law.g, found.low, found.high], symbols, context)
        tried = 0
        for values in sample_values(law, found.requires, Random(1), 12):
            line = {s: sp.S.Zero for s in law.force_symbols()} | values

            def at(x: Any, line: dict[sp.Symbol, Any] = line) -> list[Any]:
                return evaluate(*(x if s == found.force else line[s] for s in symbols))

            _, low, high = at(sp.S.Zero)
            small = (high - low) * context.mpf(10) ** -9
            inside = [at(low + share * (high - low) / 8)[0] <= 0 for share in range(1, 8)]
            ends = [at(low + small)[0] <= 0 < at(low - small)[0], at(high - small)[0] <= 0 < at(high + small)[0]]
            if not (low < high and all(inside) and all(ends)):
                return False
            tried += 1
        return tried > 0
    except (ArithmeticError, TypeError, ValueError, NotImplementedError):
        return False


def _positive_root(g: sp.Expr, force: sp.Symbol, sign: int) -> sp.Expr | None:
    """The one positive t with g(sign t) = 0, if g is a polynomial there with exactly one."""
    t = sp.Dummy("t", positive=True)
    along = sp.factor(g.xreplace({force: sign * t}))
    if not along.is_polynomial(t):
        return None
    x = sp.Dummy("x")
    roots = [r for r in sp.roots(sp.Poly(along.xreplace({t: x}), x)) if r != 0 and r.is_real is not False and r.is_positive is not False]
    return roots[0] if len(roots) == 1 else None


def _one_dimensional_equations(names: Names, sections: Sequence[LineSection | None]) -> Iterator[Equation]:
    """Eq. (1) for each force alone: the interval of the sticking state and the elastic, perfectly plastic branch."""
    law, alone = names.law, len(names.forces) == 1
    for i, (force, found) in enumerate(zip(names.forces, sections, strict=True)):
        if found is None:
            continue
        low, high = found.low, found.high
        tail, nth = law.forces[i].removeprefix("sigma_"), "" if alone else f".{i + 1}"
        note = ("K as an interval" if alone else "K with the other forces zero") + _needs(names, found.requires)
        yield Equation(f"D19{nth}", f"interval_{tail}", Belongs(force, sp.Interval(low, high)), note, LINE)
        if not law.associated:
            continue
        elastic = names.stiffness[i, i] * names.total[i]
        stick = sp.And(sp.StrictLessThan(low, elastic, evaluate=False), sp.StrictLessThan(elastic, high, evaluate=False), evaluate=False)
        ends = (high, sp.GreaterThan(elastic, high, evaluate=False)), (low, sp.LessThan(elastic, low, evaluate=False))
        note = "first loading from rest along this direction: elastic between the ends, slipping at either"
        branches = sp.Piecewise((elastic, stick), *ends, evaluate=False)
        yield Equation(f"1{nth}", f"one_dimensional_{tail}", equal(force, branches), note, LINE)


def derive(law: Law | str | Path, parameters: Mapping[str, Any] | None = None, stiffness: str = "orthotropic") -> Derivation:
    """Derive what follows symbolically from the formula of a law (Antoni et al. 2007, section 2, Eqs. 1 and 21-36).

    Of a law with a state: its forces, the inequality of Clausius and Duhem, the evolution, what it dissipates, and its heat equation.
    ``law`` is a criterion, or a name or path for :func:`duhem.load`.  ``parameters`` fixes some of its parameters.  ``stiffness`` is
    ``orthotropic`` (one k per force), ``isotropic`` (one k) or ``full`` (any symmetric positive definite matrix), in stress per length; the
    energy of a law with a state has its own.  sigma_n <= 0 in compression.  Parts without a closed form are omitted and listed with the
    reason. A law that is given by a boundary curve has the derivation that it names, for all parameters, or none. Raises InputError for an
    unknown law, parameter or stiffness.
    """
    chosen = load(law)
    if isinstance(chosen, ParametricCriterion) and chosen.derivation:
        if parameters:
            raise InputError("this derivation is for all parameters", where="parameters", remedy="remove them")
        own: Derivation = chosen.derive()
        return own
    stated = fixed(load_formula(chosen), parameters)
    names = Names.of(stated, stiffness)
    left_out: list[LeftOut] = []
    return Derivation(stated.name, tuple(_equations(stated, names, left_out)), tuple(left_out), names)


def _equations(law: Criterion, names: Names, left_out: list[LeftOut]) -> Iterator[Equation]:
    if names.state is None:
        thermal = "thermal block: T_C, s_C, heat fluxes and D_th of Eq. (23)"
        left_out.append(LeftOut(thermal, "isothermal law, no equation contains a temperature"))
        left_out.append(LeftOut("further internal variables chi_3 ... chi_n of Eq. (24)", "the law has none"))
        yield from _state_equations(names)
    else:
        yield from state_equations(names, left_out)
    found = pieces(law)
    if found is None:
        left_out.append(LeftOut("normal and criterion by branches", f"the formula has more than {MOST} branches"))
    yield from _definitions(law)
    if law.unforced and (law.viscous or not (law.associated or law.flow)):
        left_out.append(
            LeftOut(f"rate of {', '.join(law.unforced)}", "it is for a unit of one multiplier, and the law has none or several")
        )
    if law.viscous:
        left_out.append(LeftOut("criterion, multiplier and normality, Eqs. (32) to (36)", "the rates are the gradient of a potential"))
        left_out.append(LeftOut("dissipation potential", "the conjugate of the dual potential has a closed form for a criterion only"))
        yield from _viscous_equations(names, found)
    else:
        yield from _evolution_equations(names, found)
        yield from _conjugate_equations(law, names, left_out)
    if names.state is not None:
        yield from heat_equations(names, left_out)
        left_out.append(LeftOut("incremental problem and reduction to one direction (1)", "they are derived for laws without a state"))
        return
    yield from _increment_equations(names, found)
    sections = [interval(law, force) for force in names.forces]
    yield from _one_dimensional_equations(names, sections)
    for force, section in zip(names.forces, sections, strict=True):
        if section is None:
            left_out.append(LeftOut(f"reduction to {force} alone", "K on that line is unbounded or has no closed form"))


def _conjugate_equations(law: Criterion, names: Names, left_out: list[LeftOut]) -> Iterator[Equation]:
    """The dissipation potential, or why there is none."""
    if not law.associated:
        left_out.append(LeftOut("dissipation potential", "the law has its own flow direction, which does not derive from a potential of K"))
        if law.flow is None and _slips(law) is None:
            left_out.append(LeftOut("flow by surfaces", f"a surface has more than {MOST} branches"))
    elif (support := support_function(law)) is None:
        left_out.append(LeftOut("dissipation potential", "K has no support function in closed form by the polar rules"))
    else:
        yield from _potential_equations(names, support)
