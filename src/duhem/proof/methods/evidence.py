"""Evidence that a claim holds, for a rule of the kernel, which decides.

Composition with sums of squares in it: Helton, Nie (2010), Math. Program. 122, 21; Ahmadi, Parrilo (2013), SIAM J. Optim. 23, 811.
The squares come from a conic solver and are made exact: what proves it is an identity of fractions.  So it is of a boundary that
rises and curves inward: if g < 0 at the origin and sigma . grad g > 0 wherever g = 0, each ray leaves K once, so K is the region
inside its boundary and convexity is local (Tietze 1928, Nakajima 1928).  The polar gauge: Rockafellar (1970), sections 13-15.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from duhem.expression import UNDEFINED, Norm, Where
from duhem.expression.dimensions import degree
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.domain import REAL
from duhem.proof.decide import Question, Sense
from duhem.proof.decide.question import obligations
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.search.boundary_identities import composed_of_sums, convex_sums, directions, inward, outward, parallel, steep
from duhem.proof.verdict import Evidence, Proof, Verdict

__all__ = [
    "convexity_by_sums", "convexity_in_a_box", "convexity_on_boundary", "dissipation_by_identities", "dissipation_by_shares",
    "dissipation_in_a_box", "dissipation_of_potential", "duality", "normality_parallel", "smoothness_by_identities", "smoothness_by_sums",
    "smoothness_in_a_box", "smoothness_of_an_interval", "state_laws_not_stated", "without_heat",
]  # fmt: skip

Terms = Mapping[sp.Expr, sp.Expr]  # what depends on the forces, and its coefficient
_MOST_ROOTS, _MOST_SHARES = 4, 6
_PLACES = ("1/2", "-1/2", "2", "-2", "1/10", "-1/10")  # at which g may be < 0 on a line


def _offered(rule: str, detail: str, evidence: Mapping[str, Any], method: str | None = None) -> Evidence:
    """Evidence for a rule of the kernel, whose name the method has too where it has none of its own."""
    return Evidence(Verdict.PROVED, method or rule, detail, proof=Proof(rule, evidence))


def convexity_by_sums(subject: FormulaSubject) -> Iterator[Evidence]:
    """K is convex if g is quasiconvex by composition, polynomials in it being convex by sums of squares."""
    if not convex_sums(subject):
        return
    detail = f"g is quasiconvex by composition, in it by sums of squares: {', '.join(map(formula, convex_sums(subject)))}"
    yield _offered("composition", detail, composed_of_sums(subject), "sos-convexity")


def smoothness_by_sums(subject: FormulaSubject) -> Iterator[Evidence]:
    """The boundary is C^1 if g is C^1 near it and convex so, and negative somewhere: at the origin, or at the centre of K."""
    sums, support = composed_of_sums(subject), subject.support
    centre = {} if support is None else {x: formula(c) for x, c in zip(subject.law.forces, support.centre, strict=True)}
    inside = {"inside": centre} if support is not None and any(support.centre) else {}
    told = "g is C^1 wherever g = 0, and grad g != 0 there because g is convex"
    if inside:
        yield _offered("composition", f"{told} and negative at ({', '.join(centre.values())})", {**inside, **sums})
    if sums:
        yield _offered("composition", f"{told}, by sums of squares, and negative at 0", sums, "sos-convexity")
        detail = "g is C^1 wherever g = 0, and sigma . grad g > 0 there by Euler's relation, so that grad g != 0"
        yield _offered("euler", detail, sums)


def smoothness_of_an_interval(subject: FormulaSubject) -> Iterator[Evidence]:
    """A convex K on a line has two ends, each with one normal, if it has an inside: g may be negative beside zero force alone."""
    for place in _PLACES if len(subject.law.forces) == 1 else ():
        yield _offered("one-dimensional", f"K is an interval around {place}", {"inside": {subject.law.forces[0]: place}})


def convexity_on_boundary(subject: FormulaSubject) -> Iterator[Evidence]:
    """The boundary rises outward and, in more than one force, curves inward, where g has no kink."""
    rises = {"outward": list(outward(subject))}
    if rises["outward"] and len(subject.law.forces) == 1:
        yield _offered("implicit-curvature", "K is an interval: star-shaped about 0 on a line", rises)
    elif rises["outward"] and inward(subject):
        evidence = {**rises, "directions": directions(subject.law), "inward": list(inward(subject))}
        yield _offered("implicit-curvature", "K is star-shaped about 0 and its boundary curves inward everywhere", evidence)


def convexity_in_a_box(subject: FormulaSubject | GraphSubject) -> Iterator[Evidence]:
    """In each part of the ranges of the forces the boundary curves inward.  It is too dear for the effort ``quick``."""
    return _in_a_box(subject, "curvature-in-a-box", "K is star-shaped and its boundary curves inward")


def smoothness_in_a_box(subject: FormulaSubject | GraphSubject) -> Iterator[Evidence]:
    """In each part of the ranges of the forces in which g may be 0 its gradient is not.  It is too dear for the effort ``quick``."""
    return _in_a_box(subject, "slope-in-a-box", "grad g is continuous and not 0 where g = 0")


def dissipation_in_a_box(subject: FormulaSubject | GraphSubject) -> Iterator[Evidence]:
    """In each part of the ranges of the forces in which g may be 0 the slip dissipates.  It is too dear for the effort ``quick``."""
    return _in_a_box(subject, "power-in-a-box", "force . slip >= 0 where g = 0")


def _in_a_box(subject: FormulaSubject | GraphSubject, rule: str, shown: str) -> Iterator[Evidence]:
    """What a rule may show by enclosures of forces that have ranges with both ends; the kernel passes where they are too many."""
    law = subject.of if isinstance(subject, FormulaSubject) and subject.of.viscous else subject.law  # without the height of an epigraph
    ranges = [law.domain.get(x, REAL) for x in law.forces]
    if subject.effort >= 1 and all(own.low is not None and own.high is not None for own in ranges):
        yield _offered(rule, f"{shown}, by enclosures in parts of the ranges of the forces", {})


def smoothness_by_identities(subject: FormulaSubject) -> Iterator[Evidence]:
    """grad g != 0 where a piece of g that is a polynomial is 0: g rises outward there, or the square of grad g is > 0."""
    for name, found in (("outward", outward), ("steep", steep)):
        if identities := found(subject):
            yield _offered("regular-value", "grad g != 0 wherever g = 0", {name: list(identities)})


def dissipation_by_identities(subject: FormulaSubject) -> Iterator[Evidence]:
    """force . flow > 0 where a piece of g that is a polynomial is 0 (>= 0 for a flow of the law's own)."""
    if identities := outward(subject):
        yield _offered("boundary-power", "force . flow >= 0 wherever g = 0", {"outward": list(identities)})


def normality_parallel(subject: FormulaSubject) -> Iterator[Evidence]:
    """A flow of the law's own, or of a surface, is parallel to grad g and points the same way, wherever g = 0 in K, K being convex.

    K lies in {g <= 0}, so g does not rise from the boundary point towards any point of K.
    """
    if any(face.flow is not None for face in subject.simple.faces) and (known := parallel(subject)):
        yield _offered("parallel", "the flow is a non-negative multiple of grad g wherever g = 0, and K is convex", known)


def _square(vector: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(d**2 for d in vector))


def dissipation_by_shares(subject: FormulaSubject) -> Iterator[Evidence]:
    """sigma . d = c g + rest >= 0, for the constants c with which a term of the power goes, as of sqrt(J2) + beta I1 of a cone.

    Where a tip of g is 0, as at an apex, the formula of the flow may have no value: there the slip is any mean of limits of the flow
    from around (Koiter 1953), and the power of these is >= 0 too.
    """
    law = subject.law
    if law.flow is None or law.surfaces or law.potential is not None:
        return
    forces, settled = law.force_symbols(), law.settled()
    g, power = (_without_signs(x.xreplace(settled)) for x in (law.g, subject.power(law.flow)))
    open_powers = {p for p in (g + power).atoms(sp.Pow) if p.exp.free_symbols and p.base.has(*forces)}
    words = {x for x in (g + power).atoms(sp.Function) if x.func.__name__ in ELEMENTARY and x.has(*forces)}
    named = {x: sp.Dummy(real=True, positive=x.is_Pow or None) for x in sp.ordered(open_powers | words)}  # each as a force of its own
    g, power, forces = g.xreplace(named), power.xreplace(named), (*forces, *named.values())
    radicands = _radicands(g + power, forces)
    roots = {y: sp.Dummy(f"r{i}", positive=True) for i, y in enumerate(radicands)}
    if len(roots) > _MOST_ROOTS or (of_power := _terms(power, forces, roots)) is None or (of_g := _terms(g, forces, roots)) is None:
        return
    back = {r: radicands[y] for y, r in roots.items()} | {x: p for p, x in named.items()}
    for share in _shares(of_power, of_g)[:_MOST_SHARES]:
        below = sp.fraction(sp.together(share))[1]
        scales = (sp.S.One, *((below, -below) if below.free_symbols else ()))  # what is divided by may be 0
        for scale in scales:
            of_scale = sp.cancel(share * scale)
            left = {x: sp.factor(scale * of_power.get(x, sp.S.Zero) - of_scale * of_g.get(x, sp.S.Zero)) for x in {**of_power, **of_g}}
            rest = sp.Add(*(c * part for part, c in left.items())).xreplace(back)
            power_told, told = ("force . flow", {}) if scale == 1 else (f"({formula(scale)})*(force . flow)", {"scale": formula(scale)})
            detail = f"{power_told} = {formula(of_scale)}*g + {formula(rest)}, which is >= 0 wherever g = 0, also in the limit at an apex"
            yield _offered("power-share", detail, {"share": formula(of_scale), "rest": formula(rest), **told})


def _without_signs(expr: sp.Expr) -> sp.Expr:
    """With y/|y| for sign(y)."""
    return expr.xreplace({x: x.sign_of / sp.Abs(x.sign_of) for x in expr.atoms(Where) if x.sign_of is not None})


def _radicands(expr: sp.Expr, forces: tuple[sp.Symbol, ...]) -> dict[sp.Expr, sp.Expr]:
    """What stands under square roots and depends on the forces, each with its root as it is written; |x| and a norm are roots too."""
    roots = {p.base: sp.sqrt(p.base) for p in expr.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q == 2}
    roots |= {_square(x.args): x for x in expr.atoms(Norm, sp.Abs)}
    return {y: roots[y] for y in sorted(roots, key=sp.default_sort_key) if y.free_symbols & set(forces)}


def _terms(expr: sp.Expr, forces: tuple[sp.Symbol, ...], roots: Mapping[sp.Expr, sp.Symbol]) -> Terms | None:
    """The coefficients by powers of forces and roots r, r^2 put for what is under them; None where it is no such polynomial."""
    expr = expr.replace(lambda x: isinstance(x, Norm | sp.Abs) and _square(x.args) in roots, lambda x: roots[_square(x.args)])
    plain = expr.replace(lambda p: p.is_Pow and p.base in roots and p.exp.is_Rational, lambda p: roots[p.base] ** (2 * p.exp))
    over, under = sp.fraction(sp.together(plain))
    if not all(part.is_polynomial(*forces, *roots.values()) for part in (over, under)):
        return None
    for y, r in roots.items():
        over = sp.reduced(over, [y - r**2], *forces)[1] if y.is_polynomial(*forces) else over
    whole = sp.cancel(over / under)
    if not whole.is_polynomial(*forces, *roots.values()):
        return None
    return _by_forces(whole, (*forces, *roots.values()))


def dissipation_of_potential(subject: FormulaSubject) -> Iterator[Evidence]:
    """A flow that is the gradient of a potential P has sigma . d = sum of k P_k; where g = 0 a multiple of g may be taken from it.

    So it is for every mean of gradients that meet at a kink or a tip, of which the formula of the flow says nothing.
    """
    law, problem = subject.law, subject.problem
    if law.potential is None:
        return
    potential = parse_expression(law.potential, law.symbols()).subs({**law.settled(), **problem.compressed})
    parts, g = _by_forces(potential, problem.forces), _by_forces(problem.g, problem.forces)
    degrees = {part: degree(part, problem.forces) for part in parts}  # None also of powers whose exponent is a parameter
    power = {part: k * c for part, c in parts.items() if (k := degrees[part]) is not None}
    told = ", ".join(map(str, sorted({k for k in degrees.values() if k is not None})))
    detail = f"the potential has parts of degree {told} in the forces, so force . flow >= 0 wherever g = 0"
    for share in (*_shares(power, g), *_share_at_equal_forces(power, g, problem.forces)):
        yield _offered("potential", detail, {"share": formula(_in_pressure(subject, share))})


def _shares(power: Terms, g: Terms) -> list[sp.Expr]:
    """Constants c with which power - c g has no term of some part; first 0."""
    return [*dict.fromkeys([sp.S.Zero, *(sp.cancel(power.get(part, sp.S.Zero) / c) for part, c in g.items() if part != 1)])]


def _share_at_equal_forces(power: Terms, g: Terms, forces: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """The constant c with which power - c g does not change along equal forces, as those of Mohr and Coulomb do to their apex."""
    equal = dict.fromkeys(forces, sp.S.One)
    over, under = (sp.Add(*(c * part.xreplace(equal) for part, c in terms.items() if part != 1)) for terms in (power, g))
    return [] if under == 0 or (over / under).has(*UNDEFINED) else [sp.cancel(over / under)]


def _by_forces(expr: sp.Expr, forces: Sequence[sp.Symbol]) -> Terms:
    """The terms of a sum."""
    found: dict[sp.Expr, sp.Expr] = {}
    for term in sp.Add.make_args(sp.expand(expr, deep=False)):
        scale, part = term.as_independent(*forces, as_Add=False)
        found[part] = found.get(part, sp.S.Zero) + scale
    return found


def _in_pressure(subject: FormulaSubject, expr: sp.Expr) -> sp.Expr:
    """In the law's own names."""
    return expr.xreplace({-load: -pressure for pressure, load in subject.problem.compressed.items()})


def duality(subject: FormulaSubject) -> Evidence | None:
    """Phi is the support function of K: each step is a theorem, its positivity hypotheses decided over the whole domain."""
    if subject.of.viscous:
        reason = "no closed form found: none is looked for of the conjugate of a potential of rates"
        return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", reason)
    if bounded := [name for name in subject.law.forces if name in subject.law.domain]:
        reason = f"no closed form found: the claims have a range of {', '.join(bounded)}, and no closed form is known for a part of K"
        return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", reason)
    if (found := subject.support) is None:
        reason = "no closed form found: the rules of the polar gauge give none for the dissipation potential of this law"
        return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", reason)
    swap = subject.problem.compressed
    # What the potential divides by must not vanish for any admitted parameters, whatever the rules that gave it have asked.
    asked = [o for o in obligations(found.potential.xreplace(swap)) if not o.symbols() & set(found.rates)]
    if not all(map(subject.met, asked)):
        return None
    for needed in found.requires:
        if subject.decided(Question(sp.sympify(needed).xreplace(swap), Sense.POSITIVE, subject.problem.given)).holds is not True:
            return None
    slips = {f: x.name for f, x in zip(subject.law.forces, found.rates, strict=True)}
    told = {"potential": formula(found.potential), "slips": slips, "flat": [formula(form) for form in found.domain]}
    detail = f"Phi(d) = {formula(found.potential)}; " + "; ".join(found.steps)
    return _offered("polar-gauge", detail, {key: value for key, value in told.items() if value})


def state_laws_not_stated(subject: FormulaSubject) -> Evidence | None:
    """Without an energy the default one gives sigma of a slip; what gives the force of any other variable nobody says."""
    law = subject.of
    observed = {own.force for own in law.variables.values() if own.observable}
    unsaid = [f"{own.force} follows from {name}" for name, own in law.variables.items() if own.force not in (None, *observed)]
    if law.energy is not None or not unsaid:
        return None
    detail = f"the law states no energy, so nothing says how {', '.join(unsaid)}; write psi in [energy], or declare no force of it"
    return Evidence(Verdict.NOT_APPLICABLE, "none", detail)


def without_heat(subject: Subject) -> Evidence | None:
    """Nothing is claimed of heat where none flows."""
    if isinstance(subject, FormulaSubject) and subject.of.heat:
        return None
    return Evidence(Verdict.NOT_APPLICABLE, "none", "the law has no [heat]: no body exchanges heat with it")
