"""Criterion, normality, dissipation and its potential (Antoni et al. 2007, Eqs. 27, 28, 32-36), by differentiation.

Everything one-sided is taken from the smooth branches of g, never from two-sided limits at a kink.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import sympy as sp

from duhem.criterion import Criterion
from duhem.derivation.energy import column, equal
from duhem.derivation.equation import Belongs, Equation
from duhem.derivation.names import Names
from duhem.derivation.support_function import SupportFunction, biconjugate
from duhem.expression.branches import Branch, TooManyBranchesError, branches
from duhem.expression.vocabulary import Norm

__all__ = ["Pieces", "evolution_equations", "pieces", "potential_equations"]

CRITERION, FLOW, POTENTIAL = "Criterion", "Evolution law", "Dissipation potential"
MOST = 16


@dataclass(frozen=True)
class Pieces:
    """The smooth branches of g with their gradients, going round the quadrants where the switches are the forces."""

    conditions: tuple[sp.Basic, ...]
    switches: tuple[dict[sp.Expr, int], ...]
    values: tuple[sp.Expr, ...]
    gradients: tuple[tuple[sp.Expr, ...], ...]

    def joined(self, values: Sequence[sp.Expr]) -> sp.Expr:
        """One expression by branches."""
        if len(set(values)) == 1:
            return values[0]
        return sp.Piecewise(*zip(values, self.conditions, strict=True), evaluate=False)


def pieces(law: Criterion) -> Pieces | None:
    """The branches of g, or None where they are too many to print."""
    try:
        found = branches(law.g, most=MOST)
    except TooManyBranchesError:
        return None
    forces = law.force_symbols()
    order = [s for s in dict.fromkeys(switch for b in found for switch in b.signs)]
    order.sort(key=lambda s: (forces.index(s) if s in forces else len(forces), sp.default_sort_key(s)))
    found = tuple(sorted(found, key=lambda b: _gray([b.signs.get(s, 1) for s in reversed(order)])))
    values = tuple(_unsigned(b.expr) for b in found)
    return Pieces(
        tuple(_region(b) for b in found),
        tuple(dict(b.signs) for b in found),
        values,
        tuple(tuple(value.diff(f) for f in forces) for value in values),
    )


def _unsigned(expr: sp.Expr) -> sp.Expr:
    """Norms of -x written as norms of x."""
    return expr.replace(Norm, lambda *args: Norm(*[-a if a.could_extract_minus_sign() else a for a in args]))


def _gray(signs: Sequence[int]) -> int:
    """Place in the order where neighbours differ in one sign: ++, -+, --, +- for two."""
    place, flipped = 0, 0
    for sign in signs:
        flipped ^= sign < 0
        place = 2 * place + flipped
    return place


def _region(branch: Branch) -> sp.Basic:
    parts = [
        sp.GreaterThan(switch, 0, evaluate=False) if sign > 0 else sp.LessThan(switch, 0, evaluate=False) for switch, sign in branch.signs.items()
    ]
    return sp.And(*parts, evaluate=False) if len(parts) > 1 else parts[0] if parts else sp.true


def rooted(expr: sp.Expr) -> sp.Expr:
    """Norms written as square roots."""
    return expr.replace(Norm, lambda *args: sp.sqrt(sp.Add(*[a**2 for a in args])))


def seams(law: Criterion, found: Pieces) -> Iterator[tuple[int, int, sp.Expr, bool | None]]:
    """(branch, branch, switch, does the gradient agree on switch = 0); None where that is not decided."""
    for i, j in combinations(range(len(found.values)), 2):
        first, second = found.switches[i], found.switches[j]
        opposite = [s for s in first if second.get(s, 0) == -first[s]]
        if len(opposite) == 1:
            yield i, j, opposite[0], _agrees(law, opposite[0], found.gradients[i], found.gradients[j])


def _agrees(law: Criterion, switch: sp.Expr, first: Sequence[sp.Expr], second: Sequence[sp.Expr]) -> bool | None:
    pivot = next((f for f in law.force_symbols() if switch.is_polynomial(*law.force_symbols()) and switch.diff(f).free_symbols.isdisjoint(law.force_symbols()) and switch.diff(f) != 0), None)
    if pivot is None:
        return None
    on_seam = {pivot: sp.solve(switch, pivot)[0]}
    gaps = [sp.cancel(sp.together(a.subs(on_seam) - b.subs(on_seam))) for a, b in zip(first, second, strict=True)]
    if all(gap == 0 for gap in gaps):
        return True
    return False if any(gap.is_number or not gap.free_symbols & set(law.force_symbols()) for gap in gaps if gap != 0) else None


def evolution_equations(names: Names, found: Pieces | None) -> Iterator[Equation]:
    """Equations 28 and 32 to 36."""
    law, forces = names.law, names.forces
    point = sp.Tuple(*forces)
    inside = sp.LessThan(law.g, 0, evaluate=False)
    yield Equation("35", "criterion", equal(sp.Symbol("g"), law.g), "the limit criterion, as declared", CRITERION)
    if found is not None and len(found.values) > 1:
        yield Equation("35'", "criterion_branches", equal(sp.Symbol("g"), found.joined([rooted(v) for v in found.values])),
                       "the same, branch by branch: each kink of the formula resolved on either side", CRITERION)  # fmt: skip
    yield Equation("32", "admissible_set", equal(sp.Symbol("K"), sp.ConditionSet(point, inside, sp.S.UniversalSet)),
                   "the admissible stresses at frozen pressure" if law.pressure else "the admissible stresses", CRITERION)  # fmt: skip
    indicator = sp.Function("I_K")(*forces)
    if law.flow is None:
        yield Equation("33", "dual_potential", equal(sp.Function("Phi_C_star")(*forces), indicator), "dual pseudo-potential: the indicator of K", CRITERION)
    yield Equation("34", "indicator", equal(indicator, sp.Piecewise((sp.S.Zero, inside), (sp.oo, True), evaluate=False)),
                   "zero on K, infinite outside", CRITERION)  # fmt: skip
    if law.flow is not None:
        yield from _own_flow(names)
        return
    cone = sp.Function("N_K")(*forces)
    yield Equation("28", "evolution_inclusion", Belongs(sp.Tuple(*names.rates), cone),
                   "the slip rate is a subgradient of the indicator, that is an element of the normal cone of K", FLOW)  # fmt: skip
    work = sp.Add(*[d * (t - s) for d, t, s in zip(names.rates, names.other, forces, strict=True)])
    yield Equation("D3", "normal_cone", sp.LessThan(work, 0, evaluate=False),
                   "what (28) says, for every tau in K: maximal dissipation; at an interior point the cone is {0}", FLOW)  # fmt: skip
    if found is None:
        return
    normal = column(found.joined([g[i] for g in found.gradients]) for i in range(len(forces)))
    yield Equation("D4", "normal", equal(column(names.normal), normal), f"outward normal n = dg/dsigma{_smoothness(law, found)}", FLOW)
    yield Equation("36", "normality", equal(column(names.rates), column(names.multiplier * n for n in names.normal)),
                   "normality rule where g is differentiable, n of (D4)", FLOW)  # fmt: skip
    yield _complementarity(names)
    yield from _corners(names, found)
    yield from _dissipation(names, found)


def _complementarity(names: Names) -> Equation:
    g = names.law.g
    three = (
        sp.GreaterThan(names.multiplier, 0, evaluate=False), sp.LessThan(g, 0, evaluate=False), equal(names.multiplier * g, sp.S.Zero)
    )  # fmt: skip
    return Equation("36'", "complementarity", sp.And(*three, evaluate=False), "slip only on the boundary, and never against the normal", FLOW)


def _smoothness(law: Criterion, found: Pieces) -> str:
    said = []
    agreement = [agrees for *_, agrees in seams(law, found)]
    if agreement and all(agreement):
        said.append("continuous across every seam of the branches")
    elif False in agreement:
        said.append("not continuous across some seams, where the cone has the normals of both sides")
    where = _singular(law, found)
    if where:
        said.append("not defined where " + "; ".join(where))
    return "; " + "; ".join(said) if said else ""


def _singular(law: Criterion, found: Pieces) -> list[str]:
    """Points where all arguments of a norm vanish, and the value of g there."""
    forces, said = law.force_symbols(), []
    for norm in dict.fromkeys(n for v in found.values for n in v.atoms(Norm) if n.has(*forces)):
        if not all(a.is_polynomial(*forces) and sp.Poly(a, *forces).total_degree() <= 1 for a in norm.args):
            continue
        solution = sp.linsolve(list(norm.args), *forces)
        for point in solution:
            value = law.g.subs(dict(zip(forces, point, strict=True)))
            said.append(f"({', '.join(map(str, forces))}) = ({', '.join(map(str, point))}), where g = {value}")
    return list(dict.fromkeys(said))


def _corners(names: Names, found: Pieces) -> Iterator[Equation]:
    """The cone spanned by the two normals that meet at a kink, for the first kinks."""
    kinks = [(i, j, switch) for i, j, switch, agrees in seams(names.law, found) if agrees is False]
    for count, (i, j, switch) in enumerate(kinks[:4], start=1):
        one, two = sp.Symbol("lambda_1", nonnegative=True), sp.Symbol("lambda_2", nonnegative=True)
        spanned = column(one * a + two * b for a, b in zip(found.gradients[i], found.gradients[j], strict=True))
        yield Equation(f"D5.{count}", f"corner_{count}", equal(column(names.rates), spanned),
                       f"normal cone at a boundary point with {switch} = 0 where two branches meet; lambda_1, lambda_2 >= 0", FLOW)  # fmt: skip


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
        yield Equation("D6", "dissipation", equal(dissipation, names.multiplier * found.joined(powers)), "D = lambda sigma . dg/dsigma", FLOW)


def _euler(law: Criterion, value: sp.Expr, power: sp.Expr) -> sp.Expr | None:
    """sigma . dg/dsigma on g = 0 where g = (homogeneous of degree m) + constant: it is -m constant."""
    constant, part = value.as_independent(*law.force_symbols(), as_Add=True)
    roots = sp.cancel(sp.powsimp(sp.expand(rooted(power)) / rooted(part)))
    if roots.has(*law.force_symbols()):
        roots = sp.cancel(sp.together(rooted(power) * rooted(part)) / sp.expand(rooted(part) ** 2))
    return None if roots.has(*law.force_symbols()) else sp.factor_terms(-roots * constant)


def _own_flow(names: Names) -> Iterator[Equation]:
    law = names.law
    assert law.flow is not None
    yield Equation("D4", "flow", equal(column(names.rates), names.multiplier * column(law.flow)),
                   "slip direction declared by the law itself: not associated, normality is a claim to test", FLOW)  # fmt: skip
    yield _complementarity(names)
    power = sp.expand(sp.Add(*[s * c for s, c in zip(names.forces, law.flow, strict=True)]))
    yield Equation("D6", "dissipation", equal(sp.Symbol("D", real=True), names.multiplier * sp.factor_terms(power)),
                   "D = lambda sigma . flow", FLOW)  # fmt: skip


def potential_equations(names: Names, support: SupportFunction) -> Iterator[Equation]:
    """The Legendre-Fenchel conjugate of the indicator, its flow rule turned round, and the conjugate of that."""
    phi = sp.Function("Phi_C")(*support.rates)
    for count, form in enumerate(support.domain, start=1):
        yield Equation(f"D7.{count}", f"potential_domain_{count}", equal(form, sp.S.Zero), "the potential is infinite elsewhere", POTENTIAL)
    needs = f"; where {', '.join(f'{r} > 0' for r in support.requires)}" if support.requires else ""
    yield Equation("D8", "dissipation_potential", equal(phi, support.potential), "; then ".join(support.steps) + needs, POTENTIAL)
    if support.maximiser is not None:
        yield Equation("D9", "stress_of_slip", equal(column(names.forces), column(support.maximiser)),
                       "the stress that attains the supremum: the evolution law (28) solved for sigma, at nonzero slip rate", POTENTIAL)  # fmt: skip
    gauge = sp.Function("gamma_K")(*names.forces)
    yield Equation("D10", "gauge", equal(gauge, support.gauge), "gauge of K about its centre: K = {gamma_K <= 1}", POTENTIAL)
    back = biconjugate(names.law, support)
    if back is not None and back.agrees:
        yield Equation("D11", "biconjugate", equal(gauge, back.gauge),
                       f"polar of the polar, read afresh from (D8), so that Phi** = Phi: {back.how}", POTENTIAL)  # fmt: skip
    frozen = names.law.pressure and names.law.symbols()[names.law.pressure]
    if frozen and support.radius.subs(frozen, 0) == 0:
        tip = column(c.subs(frozen, 0) for c in support.centre)
        yield Equation("D12", "tip", equal(column(names.forces), tip),
                       f"at {frozen} = 0 K is this one point, where g is not differentiable and the normal cone is the whole space", POTENTIAL)  # fmt: skip
