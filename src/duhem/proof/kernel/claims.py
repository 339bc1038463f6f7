"""The claims as statements about a law's text, and the rules that prove them.  What no rule reaches is not confirmed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from duhem.proof.kernel import obligations
from duhem.proof.kernel.boundary import curves_inward, falls_from_zero, flows_along_normals, flows_outward, rises_outward, with_convex_sums
from duhem.proof.kernel.cases import cases
from duhem.proof.kernel.curvature import Facts, facts, over
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain, StatedLaw
from duhem.proof.kernel.fan import Fan
from duhem.proof.kernel.homogeneity import grows_along_rays, is_cone, potential_flows_outward
from duhem.proof.kernel.isotropy import in_principal_stresses
from duhem.proof.kernel.limits import divides_by_zero_force
from duhem.proof.kernel.outer import without_outer_map
from duhem.proof.kernel.pieces import chooses
from duhem.proof.kernel.piecewise import polyhedra
from duhem.proof.kernel.polyhedron import union_is_convex
from duhem.proof.kernel.polynomial import slope
from duhem.proof.kernel.power_share import flows_with_a_share_of_g
from duhem.proof.kernel.region import convex_in_its_region
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.rounded import round_at_its_ends
from duhem.proof.kernel.star import StarGauge
from duhem.proof.kernel.support import is_support_function
from duhem.proof.kernel.term import UNREADABLE, NotWritten, Term, in_words, minus, number, parse, product_of, sum_of

__all__ = ["RULES", "objection", "rules_of"]

Evidence = Mapping[str, Any]
Rule = Callable[[StatedLaw, Evidence], bool]
Reads = Callable[[StatedLaw], str]
_MOST_CASES = 4  # choices one after another


def objection(claim: str, rule: str, settled: frozenset[str], law: StatedLaw | StatedCurve, evidence: Evidence) -> str:
    """Why ``rule`` does not prove ``claim`` for ``law``, where the claims ``settled`` are confirmed for it already; "" if it does."""
    if rule not in rules_of(claim, law):
        return f"no rule {rule!r} for this claim"
    needed, check = (RULES[claim, rule] if isinstance(law, StatedLaw) else CURVE_RULES[claim, rule])[:2]
    if not needed <= settled:
        return f"it rests on {', '.join(sorted(needed - settled))}, not confirmed"
    try:
        if isinstance(law, StatedLaw):
            undecided = law.once(obligations.constraints) or law.once(RULES[claim, rule][2])
        else:
            undecided = obligations.constraints(law)
    except UNREADABLE as fault:
        undecided = f"the law cannot be read: {in_words(fault)}"
    return undecided or _objection_in_cases(claim, rule, check, law, evidence)


def _objection_in_cases(
    claim: str, rule: str, check: Callable[..., bool], law: StatedLaw | StatedCurve, evidence: Evidence, depth: int = 0
) -> str:
    """The objection to a law, and to each of those that it is where a choice of constants goes one way."""
    reasons = set[str]()
    try:
        for form in _forms(claim, law):
            reasons.add(_objection(rule, check, form, evidence))
            if "" in reasons:
                return ""
        parts = cases(law) if isinstance(law, StatedLaw) and depth < _MOST_CASES else ()
        if parts and not any(_objection_in_cases(claim, rule, check, part, evidence, depth + 1) for part in parts):
            return ""
    except UNREADABLE:
        pass  # there is no simpler form
    return max(reasons)


def _forms(claim: str, law: StatedLaw | StatedCurve) -> Iterator[StatedLaw | StatedCurve]:
    """The law as written; with the same K, the same boundary and a simpler g, if there is one; both in principal stresses.

    What K's support function is, is said of all components.
    """
    yield law
    if isinstance(law, StatedLaw):
        if (simpler := without_outer_map(law)) != law:
            yield simpler
        if claim not in ("duality", "state_laws") and (principal := in_principal_stresses(simpler)) is not None:
            yield principal


def _objection(rule: str, check: Callable[..., bool], law: StatedLaw | StatedCurve, evidence: Evidence) -> str:
    try:
        return "" if check(law, evidence) else f"the rule {rule!r} does not show it"
    except UNREADABLE as fault:
        return f"its evidence cannot be read: {in_words(fault)}"


def rules_of(claim: str, law: StatedLaw | StatedCurve) -> tuple[str, ...]:
    """The rules that may prove a claim of such a law, in order."""
    return tuple(rule for name, rule in (RULES if isinstance(law, StatedLaw) else CURVE_RULES) if name == claim)


def _over(law: StatedLaw, evidence: Evidence) -> StatedDomain:
    """The law's domain; the sums in g that ``evidence`` shows to be convex, or >= 0, are taken as such."""
    sums = evidence.get("convex sums")
    return with_convex_sums(law, evidence["directions"], sums) if sums else over(law)


def _shape(law: StatedLaw, evidence: Evidence) -> Facts:
    """Of g."""
    return facts(law.g, _over(law, evidence))


def _at(law: StatedLaw, point: Mapping[str, str]) -> Facts:
    """g at a point, given by constants; a force that is not named is 0."""
    domain, place = over(law), {f: parse(point.get(f, "0")) for f in law.forces}
    if not all(domain.constant(value) and facts(value, domain).defined for value in place.values()):
        raise NotWritten("the point is none")
    return facts(law.g.put({Term("name", name=f): value for f, value in place.items()}), domain)


def _at_zero(law: StatedLaw) -> list[Facts]:
    """g at the origin, as its text says it, and by continuity; what jumps beside a limit has none."""
    domain = over(law)
    return [_at(law._replace(g=g), {}) for g in (law.g, *(g for g in law.once(obligations.limits) if not chooses(g, domain)))]


def _inside(law: StatedLaw, evidence: Evidence) -> bool:
    """Whether g < 0 at the point ``inside`` of the evidence, the origin without one."""
    point = evidence.get("inside", {})
    return any(here.defined and here.sign == NEGATIVE for here in ([_at(law, point)] if point else _at_zero(law)))


def origin(law: StatedLaw, _: Evidence) -> bool:
    """g(0) is defined and <= 0."""
    return any(here.defined and not here.sign & POSITIVE for here in _at_zero(law))


def convexity(law: StatedLaw, evidence: Evidence) -> bool:
    """g is defined everywhere and quasiconvex, so that every {g <= 0} is convex; or it is so in a convex region that K lies in."""
    shape = _shape(law, evidence)
    return (shape.defined and shape.quasiconvex) or convex_in_its_region(law, facts, over)


def curved(law: StatedLaw, evidence: Evidence) -> bool:
    """g is negative at the origin, rises outward where it is 0, and is smooth there and curves inward unless K is an interval."""
    if not (_inside(law, {}) and rises_outward(law, evidence["outward"])):
        return False
    return len(law.forces) == 1 or curves_inward(law, evidence["directions"], evidence["inward"])


def polyhedral(law: StatedLaw, _: Evidence) -> bool:
    """g is defined everywhere and piecewise affine; {g <= 0}, a union of polyhedra, is one."""
    domain = over(law)
    return facts(law.g, domain).defined and union_is_convex(polyhedra(law.g, law.forces, domain)[0], len(law.forces))


def smoothness(law: StatedLaw, evidence: Evidence) -> bool:
    """g is C^1 where g = 0, and has no minimum there: it is convex and somewhere negative; or K is convex and round at its ends."""
    shape = _shape(law, evidence)
    if not (_inside(law, evidence) or falls_from_zero(law)):
        return False
    return (shape.defined and shape.convex and smooth_near_the_boundary(law.g, over(law))) or round_at_its_ends(law)


def regular(law: StatedLaw, evidence: Evidence) -> bool:
    """g is C^1 where g = 0, and rises outward there, so that grad g != 0."""
    return smooth_near_the_boundary(law.g, over(law)) and rises_outward(law, evidence["outward"])


def regular_along_rays(law: StatedLaw, evidence: Evidence) -> bool:
    """g is C^1 where g = 0, and d g(r sigma)/dr > 0 there, as its degrees in the forces show."""
    domain = _over(law, evidence)
    return facts(law.g, domain).defined and grows_along_rays(law.g, domain) and smooth_near_the_boundary(law.g, domain)


def one_force(law: StatedLaw, evidence: Evidence) -> bool:
    """A convex set on a line that has an inside is bounded by at most two points, each with one normal."""
    return len(law.forces) == 1 and _shape(law, {}).defined and _inside(law, evidence)


def associated(law: StatedLaw, _: Evidence) -> bool:
    """The flow of a law without one of its own is the normal cone of K, K being convex."""
    return law.associated


def parallel(law: StatedLaw, evidence: Evidence) -> bool:
    """Every flow of the law's own is a positive multiple of the gradient of its g, which does not rise towards K, K being convex."""
    return flows_along_normals(law, evidence.get("along", ()), evidence.get("across", ()))


def fenchel(law: StatedLaw, _: Evidence) -> bool:
    """d in the normal cone at sigma and 0 in K: d . (0 - sigma) <= 0."""
    return True


def star_shaped(law: StatedLaw, _: Evidence) -> bool:
    """K is star-shaped about 0, and closed where the formula divides by 0."""
    return divides_by_zero_force(law.g, over(law), facts) and bool(StarGauge(law))


def convex_gauge(law: StatedLaw, _: Evidence) -> bool:
    """K = {gamma <= 1} with a convex gauge gamma."""
    return StarGauge(law).convex()


def smooth_gauge(law: StatedLaw, _: Evidence) -> bool:
    """The boundary is {gamma = 1} with gamma of class C^1 and positive."""
    return StarGauge(law).smooth()


def convex_fan(law: StatedLaw, _: Evidence) -> bool:
    """K = {f <= c} with f of degree 1 and convex, one formula in each cone of a fan."""
    return Fan(law).convex()


def smooth_fan(law: StatedLaw, _: Evidence) -> bool:
    """The boundary is {f = c} with f of degree 1 and of class C^1, one formula in each cone of a fan."""
    return Fan(law).smooth()


def euler(law: StatedLaw, _: Evidence) -> bool:
    """On g = 0 every gradient of g = A - B from one side has sigma . grad g = (a - b) A > 0."""
    return law.associated and bool(StarGauge(law))


def homogeneity(law: StatedLaw, _: Evidence) -> bool:
    """d g(r sigma)/dr > 0 at r = 1 wherever g = 0: so sigma . n > 0 for every limit n of grad g there; or K is a cone: it is 0."""
    domain = over(law)
    return law.associated and facts(law.g, domain).defined and (is_cone(law.g, domain) or grows_along_rays(law.g, domain))


def power(law: StatedLaw, evidence: Evidence) -> bool:
    """sigma . d >= 0 wherever g = 0: d is the law's own flow, or a mean of the gradients of the pieces of g there, none of which is 0."""
    return flows_outward(law, evidence.get("outward", ()))


def potential(law: StatedLaw, evidence: Evidence) -> bool:
    """The flow is the gradient of a potential, and the power is the ``share`` of the evidence times g, and something >= 0 (Euler)."""
    return law.potential is not None and potential_flows_outward(law.potential, law.g, parse(evidence["share"]), over(law))


def power_share(law: StatedLaw, evidence: Evidence) -> bool:
    """The power is the ``share`` of the evidence times g, and its ``rest`` >= 0."""
    return flows_with_a_share_of_g(law, parse(evidence["share"]), parse(evidence["rest"]))


def polar_gauge(law: StatedLaw, evidence: Evidence) -> bool:
    """The ``potential`` of the evidence is the support function of K where its forms ``flat`` vanish, in the ``slips`` of the forces.

    Of K within ranges of the forces it is not.
    """
    if any(name in law.forces for name, _ in law.ranges):
        return False
    flat = [parse(form) for form in evidence.get("flat", [])]
    return "potential" in evidence and is_support_function(parse(evidence["potential"]), dict(evidence["slips"]), flat, law)


def quadratic_energy(law: StatedLaw | StatedCurve, _: Evidence) -> bool:
    """psi = (u - w) . k (u - w)/2, k = L L^T: dpsi/du = k (u - w) = -dpsi/dw, and psi is the sum of (L^T (u - w))_j^2/2."""
    d, half = len(law.forces), number(Fraction(1, 2))
    domain = over(StatedLaw(law.forces, law.pressure, number(0), None, {}, ()))
    u, w = ([Term("name", name=f"{x} {i}") for i in range(d)] for x in "uw")
    factor = [[Term("name", name=f"l {i} {j}") if i >= j else number(0) for j in range(d)] for i in range(d)]
    lift = list(map(sum_of, u, map(minus, w)))
    stress = [sum_of(*(product_of(factor[i][k], factor[j][k], lift[j]) for j in range(d) for k in range(d))) for i in range(d)]
    rows = [sum_of(*(product_of(factor[i][j], lift[i]) for i in range(d))) for j in range(d)]
    energy = domain.polynomial(product_of(half, sum_of(*map(product_of, lift, stress))))
    for x, force in [*zip(u, stress, strict=True), *zip(w, map(minus, stress), strict=True)]:
        if slope(energy, x) != domain.polynomial(force):
            return False
    return energy == domain.polynomial(product_of(half, sum_of(*(product_of(r, r) for r in rows))))


_NONE: frozenset[str] = frozenset()
_ORIGIN = frozenset({"origin"})
RULES: Mapping[tuple[str, str], tuple[frozenset[str], Rule, Reads]] = {  # the claims it rests on, itself, what it reads
    ("origin", "evaluation"): (_NONE, origin, obligations.formula_at_zero),
    ("origin", "polar-form"): (_NONE, star_shaped, obligations.numbers_in_formula),
    ("convexity", "composition"): (_NONE, convexity, obligations.formula_where_loads_allow),
    ("convexity", "polyhedral"): (_NONE, polyhedral, obligations.formula),
    ("convexity", "polar-curvature"): (_ORIGIN, convex_gauge, obligations.numbers_in_formula),
    ("convexity", "fan"): (_ORIGIN, convex_fan, obligations.formula),
    ("convexity", "implicit-curvature"): (_NONE, curved, obligations.formula),
    ("smoothness", "composition"): (_NONE, smoothness, obligations.formula_where_loads_allow),
    ("smoothness", "polar-seams"): (_ORIGIN, smooth_gauge, obligations.numbers_in_formula),
    ("smoothness", "fan"): (_ORIGIN, smooth_fan, obligations.formula),
    ("smoothness", "euler"): (_NONE, regular_along_rays, obligations.formula_but_at_tips),
    ("smoothness", "regular-value"): (_NONE, regular, obligations.formula),
    ("smoothness", "one-dimensional"): (frozenset({"convexity"}), one_force, obligations.formula),
    ("normality", "normality-rule"): (frozenset({"convexity"}), associated, obligations.nothing),
    ("normality", "parallel"): (frozenset({"convexity"}), parallel, obligations.formula_and_flow),
    ("dissipation", "fenchel"): (frozenset({"origin", "normality"}), fenchel, obligations.flow),
    ("dissipation", "euler"): (_ORIGIN, euler, obligations.numbers_in_formula),
    ("dissipation", "homogeneity"): (_NONE, homogeneity, obligations.formula_but_at_tips),
    ("dissipation", "potential"): (_NONE, potential, obligations.formula_and_potential),
    ("dissipation", "boundary-power"): (_NONE, power, obligations.formula_and_flow),
    ("dissipation", "power-share"): (_NONE, power_share, obligations.formula),
    ("duality", "polar-gauge"): (_NONE, polar_gauge, obligations.formula),
    ("state_laws", "symbolic"): (_NONE, quadratic_energy, obligations.nothing),
}
CURVE_RULES: Mapping[tuple[str, str], tuple[frozenset[str], Callable[[StatedCurve, Evidence], bool]]] = {
    ("origin", "winding"): (_NONE, lambda curve, _: curve.around_zero()),
    ("convexity", "turning-tangent"): (_NONE, lambda curve, _: curve.convex()),
    ("smoothness", "convex-curve"): (frozenset({"convexity"}), lambda curve, _: True),  # T' x T'' > 0, so that T' is never 0
    ("smoothness", "regular-curve"): (_NONE, lambda curve, _: curve.convex() or curve.star_shaped()),
    ("normality", "normality-rule"): (frozenset({"convexity"}), lambda curve, _: curve.flow is None),
    ("dissipation", "power"): (_NONE, lambda curve, _: curve.powered() if curve.flow else curve.star_shaped()),
    ("state_laws", "symbolic"): (_NONE, quadratic_energy),
}
