"""Criterion, normality, dissipation and its potential (Antoni et al. 2007, Eqs. 27, 28, 32-36), by differentiation.

Everything one-sided is taken from the smooth branches of g, never from two-sided limits at a kink.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import sympy as sp

from duhem.derivation.energy import column, equal
from duhem.derivation.equation import Belongs, Equation
from duhem.derivation.koiter import flow_of_surfaces
from duhem.derivation.notation import Names
from duhem.derivation.numerical_check import varies
from duhem.derivation.pieces import Pieces, Seams, seams
from duhem.derivation.potential import SupportFunction
from duhem.derivation.support_function import biconjugate
from duhem.expression.vocabulary import Norm
from duhem.expression.weights import degree
from duhem.law.formula_law import Criterion

__all__ = ["evolution_equations", "potential_equations"]

CRITERION, FLOW, POTENTIAL = "Criterion", "Evolution law", "Dissipation potential"


def rooted(expr: sp.Expr) -> sp.Expr:
    """Norms written as square roots."""
    return expr.replace(Norm, lambda *args: sp.sqrt(sp.Add(*[a**2 for a in args])))


def evolution_equations(names: Names, found: Pieces | None) -> Iterator[Equation]:
    """Equations 28 and 32 to 36."""
    law, forces = names.law, names.forces
    point = sp.Tuple(*forces)
    inside = sp.LessThan(law.g, 0, evaluate=False)
    for i, (name, value) in enumerate(law.defined().items(), 1):
        note = f"as defined: {name} = {' '.join(law.define[name].split())}"
        yield Equation(f"D0.{i}", f"definition_{name}", equal(sp.Symbol(name, real=True), value), note, CRITERION)
    yield Equation("35", "criterion", equal(sp.Symbol("g"), law.g), "the limit criterion, as declared", CRITERION)
    if found is not None and len(found.values) > 1:
        yield Equation(
            "35'",
            "criterion_branches",
            equal(sp.Symbol("g"), found.joined([rooted(v) for v in found.values])),
            "the same, branch by branch: each kink of the formula resolved on either side",
            CRITERION,
        )
    yield Equation(
        "32",
        "admissible_set",
        equal(sp.Symbol("K"), sp.ConditionSet(point, inside, sp.S.UniversalSet)),
        "the admissible stresses at frozen pressure" if law.pressure else "the admissible stresses",
        CRITERION,
    )
    indicator = sp.Function("I_K")(*forces)
    if law.associated:
        yield Equation(
            "33",
            "dual_potential",
            equal(sp.Function("Phi_C_star")(*forces), indicator),
            "dual pseudo-potential: the indicator of K",
            CRITERION,
        )
    yield Equation(
        "34",
        "indicator",
        equal(indicator, sp.Piecewise((sp.S.Zero, inside), (sp.oo, True), evaluate=False)),
        "zero on K, infinite outside",
        CRITERION,
    )
    if not law.associated:
        yield from _own_flow(names) if law.flow is not None else flow_of_surfaces(names, FLOW)
        return
    cone = sp.Function("N_K")(*forces)
    yield Equation(
        "28",
        "evolution_inclusion",
        Belongs(sp.Tuple(*names.rates), cone),
        "the slip rate is a subgradient of the indicator, that is an element of the normal cone of K",
        FLOW,
    )
    work = sp.Add(*[d * (t - s) for d, t, s in zip(names.rates, names.other, forces, strict=True)])
    yield Equation(
        "D3",
        "normal_cone",
        sp.LessThan(work, 0, evaluate=False),
        "what (28) says, for every tau in K: maximal dissipation; at an interior point the cone is {0}",
        FLOW,
    )
    if found is None:
        return
    normal = column(found.joined([g[i] for g in found.gradients]) for i in range(len(forces)))
    met = seams(law, found)
    yield Equation(
        "D4", "normal", equal(column(names.normal), normal), f"outward normal n = dg/dsigma{_smoothness(names, found, met)}", FLOW
    )
    yield Equation(
        "36",
        "normality",
        equal(column(names.rates), column(names.multiplier * n for n in names.normal)),
        "normality rule where g is differentiable, n of (D4)",
        FLOW,
    )
    yield _complementarity(names)
    yield from _corners(names, found, met)
    yield from _dissipation(names, found)


def _complementarity(names: Names) -> Equation:
    g = names.law.g
    three = (sp.GreaterThan(names.multiplier, 0, evaluate=False), sp.LessThan(g, 0, evaluate=False), equal(names.multiplier * g, sp.S.Zero))
    return Equation(
        "36'", "complementarity", sp.And(*three, evaluate=False), "slip only on the boundary, and never against the normal", FLOW
    )


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
        spanned = column(one * a + two * b for a, b in zip(found.gradients[corner.first], found.gradients[corner.second], strict=True))
        signs = {**found.switches[corner.second], **found.switches[corner.first]}
        plain = {s: sign for s, sign in signs.items() if s in names.forces} or signs
        sides = [f"{names.shown(s)} {'>=' if sign > 0 else '<='} 0" for s, sign in plain.items() if s != corner.switch]
        yield Equation(
            f"D5.{count}",
            f"corner_{count}",
            equal(column(names.rates), spanned),
            f"normal cone of a convex K at boundary points with {', '.join([f'{names.shown(corner.switch)} = 0', *sides])}; "
            "lambda_1, lambda_2 >= 0",
            FLOW,
        )


def _dissipation(names: Names, found: Pieces) -> Iterator[Equation]:
    law, forces = names.law, names.forces
    powers = [sp.Add(*[s * n for s, n in zip(forces, g, strict=True)]) for g in found.gradients]
    reduced = [_euler(law, value, power) for value, power in zip(found.values, powers, strict=True)]
    dissipation = sp.Symbol("D", real=True)
    if all(r is not None for r in reduced):
        values = [r for r in reduced if r is not None]
        note = "D = lambda sigma . dg/dsigma on g = 0, by Euler's identity for homogeneous functions"
        yield Equation("D6", "dissipation", equal(dissipation, names.multiplier * found.joined(values)), note, FLOW)
    else:
        yield Equation(
            "D6", "dissipation", equal(dissipation, names.multiplier * found.joined(powers)), "D = lambda sigma . dg/dsigma", FLOW
        )


def _euler(law: Criterion, value: sp.Expr, power: sp.Expr) -> sp.Expr | None:
    """sigma . dg/dsigma on g = 0 where g = (homogeneous of degree m) + constant: it is -m constant."""
    constant, part = value.as_independent(*law.force_symbols(), as_Add=True)
    if (known := _degree(part, law.force_symbols())) is not None:
        return sp.factor_terms(-known * constant)
    if varies(law, power / part):  # no multiple of it: told by numbers, which is cheap where to cancel is endless
        return None
    roots = sp.cancel(sp.powsimp(sp.expand(rooted(power)) / rooted(part)))
    if roots.has(*law.force_symbols()):
        roots = sp.cancel(sp.together(rooted(power) * rooted(part)) / sp.expand(rooted(part) ** 2))
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
    law = names.law
    assert law.flow is not None
    yield Equation(
        "D4",
        "flow",
        equal(column(names.rates), names.multiplier * column(law.flow)),
        "slip direction declared by the law itself: not associated, normality is a claim to test",
        FLOW,
    )
    yield _complementarity(names)
    power = sp.expand(sp.Add(*[s * c for s, c in zip(names.forces, law.flow, strict=True)]))
    yield Equation(
        "D6", "dissipation", equal(sp.Symbol("D", real=True), names.multiplier * sp.factor_terms(power)), "D = lambda sigma . flow", FLOW
    )


def potential_equations(names: Names, support: SupportFunction) -> Iterator[Equation]:
    """The Legendre-Fenchel conjugate of the indicator, its flow rule turned round, and the conjugate of that."""
    phi = sp.Function("Phi_C")(*support.rates)
    for count, form in enumerate(support.domain, start=1):
        yield Equation(f"D7.{count}", f"potential_domain_{count}", equal(form, sp.S.Zero), "the potential is infinite elsewhere", POTENTIAL)
    needs = f"; where {', '.join(f'{names.shown(r)} > 0' for r in support.requires)}" if support.requires else ""
    yield Equation("D8", "dissipation_potential", equal(phi, support.potential), "; then ".join(support.steps) + needs, POTENTIAL)
    if support.maximiser is not None:
        yield Equation(
            "D9",
            "stress_of_slip",
            equal(column(names.forces), column(support.maximiser)),
            "the stress that attains the supremum: the evolution law (28) solved for sigma, at nonzero slip rate",
            POTENTIAL,
        )
    yield Equation(
        "D9'",
        "fenchel_equality",
        equal(sp.Symbol("D", real=True), support.potential),
        "D = sigma . d = I_K(sigma) + Phi_C(d) on the evolution law (Fenchel), and I_K = 0 on K",
        POTENTIAL,
    )
    gauge = sp.Function("gamma_K")(*names.forces)
    yield Equation("D10", "gauge", equal(gauge, support.gauge), "gauge of K about its centre: K = {gamma_K <= 1}", POTENTIAL)
    back = biconjugate(names.law, support)
    if back is not None and back.agrees:
        yield Equation(
            "D11",
            "biconjugate",
            equal(gauge, back.gauge),
            f"polar of the polar, read afresh from (D8), so that Phi** = Phi: {back.how}",
            POTENTIAL,
        )
    frozen = names.law.pressure and names.law.symbols()[names.law.pressure]
    if frozen and support.radius.subs(frozen, 0) == 0:
        tip = column(c.subs(frozen, 0) for c in support.centre)
        yield Equation(
            "D12",
            "tip",
            equal(column(names.forces), tip),
            f"at {frozen} = 0 K is this one point, and the normal cone is the whole space",
            POTENTIAL,
        )
