"""The claims as statements about a law's text, and the rules that prove them.  What no rule reaches is not confirmed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Any, NamedTuple

from duhem.proof.kernel import boundary, normal_flows, obligations, rates, state
from duhem.proof.kernel import homogeneity as degrees
from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.boxes import convex_in_its_box, dissipates_in_its_box, smooth_in_its_box
from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.curve import Stated, StatedCurve
from duhem.proof.kernel.definedness import Reader, divides_by_zero_force, undecided_beside
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import place_of
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.pieces import chooses
from duhem.proof.kernel.plane_gauge import StarGauge, above_zero_along_rays
from duhem.proof.kernel.polynomial import negated, written
from duhem.proof.kernel.region import convex_in_its_region, region_of, round_at_its_ends, where_it_has_a_value
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.simpler_laws import about_its_centre, cases, in_principal_stresses, normal_forms, without_outer_map
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.support import is_support_function, polyhedra, union_is_convex
from duhem.proof.kernel.term import UNREADABLE, Term, in_words, parse

__all__ = ["BY_CONSTRUCTION", "CURVE_RULES", "RULES", "RuleRow", "at_point", "needs_of", "objection", "row_of", "rules_of"]

Evidence = Mapping[str, Any]


class RuleRow(NamedTuple):
    """A rule: the claims that are ``needed`` before it, what it checks, the parts of the law that it ``reads``, which are shown to have a
    value before, and the argument as a sentence with its source.

    One that shows nothing without evidence, or is asked only where it is offered, works ``by_evidence``; some say nothing of a law of more
    than ``most_forces``.  What one that ``moves`` shows without evidence of K, it shows of K wherever that is moved.
    """

    needed: frozenset[str]
    check: Callable[..., bool]
    reads: Callable[[StatedLaw], str]
    sentence: str
    by_evidence: bool = False
    most_forces: int = 1_000
    moves: bool = False


_AT_ZERO = ("origin", "duality", "homogeneity", "bipotential")  # the claims that are about zero force, or all of K
_OF_THE_STATE = ("state_laws", "thermal")  # the claims that are about neither K nor the rates
# What every rule for a claim rests on, whatever else it checks; "" where it is so.
_MORE: Mapping[str, Callable[[StatedLaw], str]] = {"origin": state.potential_least_at_zero, "dissipation": state.stored_and_rates}
_RULES_OF_RATES = ("resistance", "monotone-resistance")  # those of laws whose forces are functions of the rates
_MOST_CASES = 4  # choices one after another
_IN_BOXES = ("curvature-in-a-box", "slope-in-a-box", "power-in-a-box")  # by the ranges of the forces, wherever these are
_PLACE_BY_PLACE = (*_IN_BOXES, "potential", "power-share")
# they look at a part once
_OF_GRAPHS = ("evaluation", "composition", *_IN_BOXES, "normality-rule", "fenchel", "by-construction", "conductances")


def objection(claim: str, rule: str, settled: frozenset[str], law: Stated, evidence: Evidence, as_written: bool | None = None) -> str:
    """Why ``rule`` does not prove ``claim`` for ``law``, where the claims ``settled`` are confirmed for it already; "" if it does.

    ``as_written`` says what it reads: True the law as its text says it, False the law in its normal forms, None both.
    """
    rules = _rules(law)
    if (claim, rule) not in rules:
        return f"no rule {rule!r} for this claim"
    if not _suits(claim, rule, law):
        of_rates = rule in _RULES_OF_RATES
        return "no force is a function of the rates" if of_rates else "a law whose forces are functions of the rates has no K"
    if _large(law) and rule not in _OF_GRAPHS:
        return f"g is too large for the rule {rule!r}"
    row = rules[claim, rule]
    if isinstance(law, StatedLaw) and not law.around_zero:
        if claim in _AT_ZERO:
            return "zero force is outside the ranges of the forces"
        if rule not in _PLACE_BY_PLACE:  # others rest on zero force, or look along rays from it
            law = law.once(StatedLaw.everywhere)
    if not row.needed <= settled:
        return f"it rests on {', '.join(sorted(row.needed - settled))}, not confirmed"
    try:
        once = law.once if isinstance(law, StatedLaw) else lambda ask: ask(law)
        undecided = once(obligations.constraints) or once(row.reads)
        if isinstance(law, StatedLaw) and claim in _MORE:
            undecided = undecided or once(_MORE[claim])
    except UNREADABLE as fault:
        undecided = f"the law cannot be read: {in_words(fault)}"
    return undecided or _objection_to_forms(claim, rule, row, law, evidence, as_written)


def _large(law: Stated) -> bool:
    return isinstance(law, StatedLaw) and law.g.large


def _suits(claim: str, rule: str, law: Stated) -> bool:
    """Whether the rule is for laws that have a K, or a potential, or for those whose forces are functions of the rates, as this one is."""
    return not isinstance(law, StatedLaw) or law.of_rates == (rule in _RULES_OF_RATES) or claim in _OF_THE_STATE


def _objection_to_forms(claim: str, rule: str, row: RuleRow, law: Stated, evidence: Evidence, as_written: bool | None) -> str:
    """The objection to a law as it is written, and in its normal forms, or to some of these; evidence on sums is of g as it is written."""
    found = f"the rule {rule!r} does not show it" if as_written is False else _objection_in_cases(claim, rule, row, law, evidence)
    if found and not as_written and "convex sums" not in evidence and isinstance(law, StatedLaw) and not law.of_rates:
        with suppress(*UNREADABLE):
            if any(not _objection_in_cases(claim, rule, row, form, evidence) for form in law.once(_spelled_otherwise)):
                return ""
    return found


def _objection_in_cases(claim: str, rule: str, row: RuleRow, law: Stated, evidence: Evidence, depth: int = 0) -> str:
    """The objection to a law, and to each of those that it is where a choice of constants goes one way."""
    reasons, unread = set[str](), ""
    try:
        in_ranges = rule in _IN_BOXES and isinstance(law, StatedLaw) and law.viscous  # the height of an epigraph has none
        for form in [law] if in_ranges else _forms(claim, law, moves=row.moves and not evidence):
            reasons.add(_objection(rule, row.check, form, evidence))
            if "" in reasons:
                return ""
        parts = law.once(cases) if isinstance(law, StatedLaw) and not law.of_rates and not law.g.large and depth < _MOST_CASES else ()
        if parts and not any(_objection_in_cases(claim, rule, row, part, evidence, depth + 1) for part in parts):
            return ""
    except UNREADABLE as fault:
        unread = f"the law cannot be read: {in_words(fault)}"  # what it can be read as has been examined
    return max(reasons, default=unread)


def _forms(claim: str, law: Stated, moves: bool = False) -> Iterator[Stated]:
    """The law as written; with the forces of its energy put in; with the same boundary and a simpler g; moved; in principal stresses.

    What K's support function is, is said of all components.  Of a potential of rates there is its epigraph alone.  What
    ``moves`` has a value for all forces.
    """
    if isinstance(law, StatedCurve) or law.of_rates:
        yield law
        return
    if law.viscous and claim not in _OF_THE_STATE:
        yield law.once(state.rate_epigraph, claim == "dissipation")
        return
    yield law
    if law.g.large:
        return
    if claim == "dissipation" and (inner := law.once(state.in_state)) is not None:
        yield inner
    if (simpler := law.once(without_outer_map)) != law:
        yield simpler
    if moves and not law.once(obligations.formula) and (moved := simpler.once(about_its_centre)) != simpler:
        yield (simpler := moved)
    if claim not in ("duality", *_OF_THE_STATE) and (principal := simpler.once(in_principal_stresses)) is not None:
        yield principal


def _spelled_otherwise(law: StatedLaw) -> tuple[StatedLaw, ...]:
    """The normal forms that say the same of K: g has a value for all forces, or where the same loads allow it, and is continuous there."""
    if law.viscous or law.g.large:
        return ()  # the rates of a potential are the gradient of the formula as written, at a kink too
    if not law.once(obligations.formula):
        return normal_forms(law)
    if law.once(obligations.formula_where_loads_allow):
        return ()
    loads = region_of(law)
    forms = (form for form in normal_forms(law) if not form.once(obligations.formula_where_loads_allow))
    return tuple(form for form in forms if loads <= region_of(form) and not chooses(form.g, over(form)))


def _objection(rule: str, check: Callable[..., bool], law: Stated, evidence: Evidence) -> str:
    try:
        return "" if check(law, evidence) else f"the rule {rule!r} does not show it"
    except UNREADABLE as fault:
        return f"its evidence cannot be read: {in_words(fault)}"


def rules_of(claim: str, law: Stated) -> tuple[str, ...]:
    """The rules that may prove a claim of such a law without evidence, in order."""
    rows = ((rule, row) for (name, rule), row in _rules(law).items() if name == claim and _suits(claim, rule, law))
    own = tuple(rule for rule, row in rows if not row.by_evidence and len(law.forces) <= row.most_forces)
    return tuple(rule for rule in own if rule in _OF_GRAPHS) if _large(law) else own


def needs_of(claim: str, law: Stated) -> frozenset[str]:
    """The claims that a rule for a claim of such a law may rest on."""
    return frozenset().union(*(row.needed for (name, _), row in _rules(law).items() if name == claim))


def row_of(claim: str, rule: str, law: Stated) -> RuleRow | None:
    """What is said of a rule; None where there is none of that name."""
    row = _rules(law).get((claim, rule))
    of_rates = row is not None and isinstance(law, StatedLaw) and law.viscous
    return row._replace(sentence=_OF_RATES.get(claim, row.sentence)) if row is not None and of_rates else row


def _rules(law: Stated) -> Mapping[tuple[str, str], RuleRow]:
    return RULES if isinstance(law, StatedLaw) else CURVE_RULES


def _over(law: StatedLaw, evidence: Evidence) -> StatedDomain:
    """The law's domain; the sums in g that ``evidence`` shows to be convex, or >= 0, are taken as such."""
    sums = evidence.get("convex sums")
    return boundary.with_convex_sums(law, evidence["directions"], sums) if sums else over(law)


def _shape(law: StatedLaw, evidence: Evidence) -> Facts:
    """Of g."""
    return _over(law, evidence).facts(law.g)


def at_point(law: StatedLaw, point: Mapping[str, str]) -> Facts:
    """g at a point, given by constants; a force that is not named is 0."""
    return over(law).facts(law.g.put(place_of(point, over(law))))


def _at_zero(law: StatedLaw) -> Iterator[Facts]:
    """g at the origin, as its text says it, and by continuity; what jumps beside a limit has none."""
    yield at_point(law, {})
    yield from (at_point(law._replace(g=g), {}) for g in law.once(obligations.limits) if not chooses(g, over(law)))


def _inside(law: StatedLaw, evidence: Evidence) -> bool:
    """Whether g < 0 at the point ``inside`` of the evidence, the origin without one."""
    point = evidence.get("inside", {})
    return any(here.defined and here.sign == NEGATIVE for here in ([at_point(law, point)] if point else _at_zero(law)))


def origin(law: StatedLaw, _: Evidence) -> bool:
    """g(0) is defined and <= 0."""
    return any(here.defined and not here.sign & POSITIVE for here in _at_zero(law))


def convexity(law: StatedLaw, evidence: Evidence) -> bool:
    """g is defined everywhere and quasiconvex, so that every {g <= 0} is convex; or it is so in a convex region that K lies in."""
    shape = _shape(law, evidence)
    return (shape.defined and shape.quasiconvex) or (not law.g.large and convex_in_its_region(law))


def curved(law: StatedLaw, evidence: Evidence) -> bool:
    """g is negative at the origin, rises outward where it is 0, and is smooth there and curves inward unless K is an interval."""
    rises = _inside(law, {}) and boundary.rises_outward(law, evidence["outward"])
    return rises and (len(law.forces) == 1 or boundary.curves_inward(law, evidence["directions"], evidence["inward"]))


def polyhedral(law: StatedLaw, _: Evidence) -> bool:
    """g is defined everywhere and piecewise affine; {g <= 0}, a union of polyhedra, is one."""
    domain = over(law)
    return domain.facts(law.g).defined and union_is_convex(polyhedra(law.g, law.forces, domain)[0], len(law.forces))


def without_boundary(law: StatedLaw, _: Evidence) -> bool:
    """g is nowhere > 0, or nowhere <= 0, for all forces in their ranges."""
    domain = within_ranges(law)
    if (sign := domain.facts(law.g).sign) == POSITIVE or not sign & POSITIVE:
        return True
    return domain.nonnegative(law.g, strict=True) or domain.never_negative(written(negated(domain.polynomial(law.g))))


def smoothness(law: StatedLaw, evidence: Evidence) -> bool:
    """g is C^1 where g = 0, and has no minimum there: it is convex and somewhere negative; or K is convex and round at its ends.

    It may be convex in the ranges of the forces alone, which hold zero force, if it is negative there.
    """
    inside, within = _inside(law, evidence), within_ranges(law)
    if not (inside or (not law.g.large and (degrees.falls_from_zero(law) or degrees.is_a_graph(law)))):
        return False
    shapes = (_shape(law, evidence), *([within.facts(law.g)] if inside and not evidence.get("inside") else []))
    smooth = any(shape.defined and shape.convex for shape in shapes) and smooth_near_the_boundary(law.g, within)
    return smooth or (not law.g.large and round_at_its_ends(law))


def regular(law: StatedLaw, evidence: Evidence) -> bool:
    """g is C^1 where g = 0, and grad g != 0 there: g rises outward, or it is shown of the gradient itself."""
    if not smooth_near_the_boundary(law.g, over(law)):
        return False
    return boundary.is_steep(law, evidence["steep"]) if "steep" in evidence else boundary.rises_outward(law, evidence["outward"])


def regular_along_rays(law: StatedLaw, evidence: Evidence) -> bool:
    """g is C^1 where g = 0, and grad g != 0 there: g is a graph, or d g(r sigma)/dr > 0, or >= 0 for a g that is steep, by its degrees.

    Where it has no value, that is asked of the rest alone, if it tends to a limit < 0 there, or if this is outside the forces' ranges.
    """
    there = law.once(where_it_has_a_value) if _inside_at_tips(law) else within_ranges(law)
    read = _where_defined(law, _over(law, evidence), there, _inside_at_tips(law))
    graph = degrees.is_a_graph(law)
    if any((graph or degrees.grows_along_rays(*place, steep=True)) and smooth_near_the_boundary(*place) for place in read):
        return True
    continued = over(law).facts(law.g).defined or (law.once(obligations.limits) and not chooses(law.g, over(law)))
    return bool(continued) and degrees.rises_from_zero_force(law.g, over(law)) and smooth_near_the_boundary(law.g, over(law))


def one_force(law: StatedLaw, evidence: Evidence) -> bool:
    """A convex set on a line that has an inside is bounded by at most two points, each with one normal."""
    return len(law.forces) == 1 and _shape(law, {}).defined and _inside(law, evidence)


def parallel(law: StatedLaw, evidence: Evidence) -> bool:
    """Every flow of the law's own is a positive multiple of the gradient of its g, which does not rise towards K, K being convex."""
    return boundary.flows_along_normals(law, evidence.get("along", ()), evidence.get("across", ()))


def gradient_flow(law: StatedLaw, _: Evidence) -> bool:
    """The flow is a multiple > 0 of the gradient of g, wherever a tip of g is not 0; g is C^1 where it is 0, convex, and negative at 0."""
    shape = _shape(law, {})
    steep = shape.defined and shape.convex and _inside(law, {}) and smooth_near_the_boundary(law.g, over(law))
    return steep and normal_flows.follows_the_gradient(law)


def star_shaped(law: StatedLaw, _: Evidence) -> bool:
    """K is star-shaped about 0, and closed where the formula divides by 0."""
    return divides_by_zero_force(law.g, over(law)) and bool(StarGauge(law))


def homogeneity(law: StatedLaw, _: Evidence) -> bool:
    """g(r sigma)/r^m does not fall with r > 0: so sigma . n >= 0 for every normal n; or K is a cone: it is 0.

    What is divided by, and may be 0, is of one degree.  Else g may have no value on a plane beside 0, as in (a - 1)/(a - 1): K as it is
    written leaves that out, and ends there with a normal to either side.
    """
    inside, ended = law.once(where_it_has_a_value), law.once(obligations.formula_but_at_tips)
    cones = all(degrees.is_cone(x, over(law)) for x in inside.sides.keys() - within_ranges(law).sides.keys())
    if not law.associated or (ended and not cones):
        return False
    read = _where_defined(law, over(law), inside if cones else over(law), tips=not ended)
    return any(degrees.is_cone(*place) or degrees.grows_along_rays(*place, steep=False) for place in read)


def _where_defined(law: StatedLaw, whole: StatedDomain, inside: StatedDomain, tips: bool) -> Iterator[tuple[Term, StatedDomain]]:
    """g, in the ``whole``, or but at ``tips``, and ``inside``, as far as it has a value there, and inside its normal form too."""
    if whole.facts(law.g).defined or (tips and not chooses(law.g, over(law))):
        yield law.g, whole
    for spelled in (lambda g, _: g, normal) if Reader(inside).undecided(law.g) is None else ():
        yield spelled(law.g, inside), inside


def _inside_at_tips(law: StatedLaw) -> bool:
    """Whether g has a value but at tips, where it is < 0 by continuity."""
    ends = law.once(obligations.limits)
    return bool(ends) and not chooses(law.g, over(law)) and all(over(law).facts(end).sign == NEGATIVE for end in ends)


def power(law: StatedLaw, evidence: Evidence) -> bool:
    """sigma . d >= 0 wherever g = 0: d is the law's own flow, or a mean of the gradients of the pieces of g there, none of which is 0."""
    if law.power is not None and undecided_beside((law.power,), (), within_ranges(law)) is not None:
        return False
    if law.power is not None and rates.never_negative_on_each_side(law.power, law):
        return True
    return boundary.flows_outward(law, evidence.get("outward", ()))


def potential(law: StatedLaw, evidence: Evidence) -> bool:
    """The flow is the gradient of a potential, and the power is the ``share`` of the evidence times g, and something >= 0 (Euler)."""
    return law.potential is not None and degrees.potential_flows_outward(law.potential, law.g, parse(evidence["share"]), within_ranges(law))


def convex_potential(law: StatedLaw, _: Evidence) -> bool:
    """The flow is a subgradient of a potential that is convex, and least at zero force."""
    if law.potential is None:
        return False
    shown = over(law).facts(law.potential)
    return shown.defined and shown.convex and state.least_at_zero(law.potential, law)


def power_share(law: StatedLaw, evidence: Evidence) -> bool:
    """The power, times the ``scale`` of the evidence, is the ``share`` of it times g, and its ``rest`` >= 0."""
    return degrees.flows_with_a_share_of_g(law, parse(evidence["share"]), parse(evidence["rest"]), parse(evidence.get("scale", "1")))


def polar_gauge(law: StatedLaw, evidence: Evidence) -> bool:
    """The ``potential`` of the evidence is the support function of K where its forms ``flat`` vanish, in the ``slips`` of the forces.

    Of K within ranges of the forces it is not.
    """
    if any(name in law.forces for name, _ in law.ranges):
        return False
    flat = [parse(form) for form in evidence.get("flat", [])]
    return "potential" in evidence and is_support_function(parse(evidence["potential"]), dict(evidence["slips"]), flat, law)


def convex_energy(law: StatedLaw, evidence: Evidence) -> bool:
    """The forces of the energy agree, and its epigraph is convex."""
    stored = law.once(state.epigraph)
    if stored is None or not law.once(state.state_laws_agree):
        return False
    return any(isinstance(form, StatedLaw) and convexity(form, evidence) for form in _forms("convexity", stored))


def scales_with_the_pressure(law: StatedLaw, _: Evidence) -> bool:
    """g keeps its sign along each ray of forces and pressure together, and no range cuts one."""
    return False if law.pressure is None or law.ranges else degrees.is_cone(law.g, over(law).wider(law.pressure))


def with_k_alone(law: StatedLaw) -> str:
    """For a rule that speaks of slip in the normal cone of K, and of no other rate."""
    return "rates that are no slip in the normal cone of K act in the law" if law.viscous or law.rates else ""


_OF_RATES = {  # what rules show of a potential of rates, by its epigraph
    "origin": "Phi* is 0 at zero force and never less",
    "convexity": "Phi* is convex, as {Phi* <= z} is by the rules of composition (Grant, Boyd, Ye 2006)",
    "smoothness": "Phi* is C^1",
    "normality": "the rates are the gradient of Phi*, which is convex (Antoni et al. 2007, Eqs. 27, 28)",
    "dissipation": "Y . dPhi*/dY >= Phi*(Y) - Phi*(0) >= 0, as Phi* is convex, and 0 and least at zero force",
}
_MOREAU = "the law is associated: its flow is the normal cone of K, and K is convex (Moreau 1970)"
BY_CONSTRUCTION = "by-construction"  # the rule of what holds of every law of its kind, so that it counts as no proof
_SQUARES = (
    "the law states no energy, and with the default one it holds by construction: sigma = k (u - u_in) = dpsi/du = -dpsi/du_in; "
    "psi = |L^T (u - u_in)|^2/2 with k = L L^T is a sum of squares"
)
_BIPOTENTIAL = (
    "K(sigma_n) = p K(-1), p = |sigma_n|, so b - (sigma . d - p v_n) = (p Phi_1(d) - sigma . d) + p v_n is a sum of two terms >= 0, "
    "which are both 0 exactly if the slip d is in the normal cone of K and p v_n = 0 (de Saxcé, Feng 1991)"
)
_PLANE = 3  # forces: two, or three of which adding the same to all changes nothing
_NONE: frozenset[str] = frozenset()
_ORIGIN = frozenset({"origin"})
_CONVEXITY = frozenset({"convexity"})
_CONTACT = frozenset({"homogeneity", "origin", "convexity", "normality"})
RULES: Mapping[tuple[str, str], RuleRow] = {
    ("origin", "evaluation"): RuleRow(
        _NONE, origin, obligations.formula_at_zero,
        "g(0), or its limit where g has no value at zero force, is <= 0 for every pressure and all parameters",
    ),
    ("origin", "polar-form"): RuleRow(
        _NONE, star_shaped, obligations.numbers_in_formula,
        "K is star-shaped about 0 (if the formula is 0/0 at 0, K is closed there)", most_forces=_PLANE,
    ),
    ("convexity", "composition"): RuleRow(
        _NONE, convexity, obligations.formula_where_loads_allow,
        "g is quasiconvex by the rules of composition (Grant, Boyd, Ye 2006; Agrawal, Boyd 2020)", moves=True,
    ),
    ("convexity", "sign"): RuleRow(
        _NONE, without_boundary, obligations.formula_in_ranges, "g is nowhere > 0, so that K is everything, or nowhere <= 0: K is empty",
        by_evidence=True,
    ),
    ("convexity", "polyhedral"): RuleRow(
        _NONE, polyhedral, obligations.formula,
        "g is piecewise affine, and the union of the polyhedra on which g <= 0 is itself a polyhedron (Bemporad, Fukuda, Torrisi 2001)",
    ),
    ("convexity", "polar-curvature"): RuleRow(
        _ORIGIN, lambda law, _: StarGauge(law).convex(), obligations.numbers_in_formula,
        "the boundary r = 1/gamma(theta) has no dent: gamma'' + gamma >= 0 on every arc, and gamma' does not decrease "
        "where two arcs meet (Schneider 2014, section 1.7)", most_forces=_PLANE,
    ),
    ("convexity", "polar-sign"): RuleRow(
        _NONE, lambda law, _: above_zero_along_rays(law), obligations.numbers_in_formula,
        "g > 0 along every ray from zero force, so that K is zero force alone, or empty", by_evidence=True, most_forces=_PLANE,
    ),
    ("convexity", "fan"): RuleRow(
        _ORIGIN, lambda law, _: degrees.Fan(law).convex(), obligations.formula,
        "K = {f <= c} with f of degree 1: f is convex in each cone between two rays, and its slope does not decrease "
        "across a ray", most_forces=_PLANE,
    ),
    ("convexity", "implicit-curvature"): RuleRow(
        _NONE, curved, obligations.formula,
        "K is star-shaped about 0 and its boundary curves inward everywhere (Tietze 1928, Nakajima 1928)", True,
    ),
    ("convexity", "curvature-in-a-box"): RuleRow(
        _NONE, lambda law, _: law.once(convex_in_its_box), obligations.nothing,
        "K is star-shaped about a point and its boundary curves inward, by enclosures in parts of the ranges of the forces "
        "(Tietze 1928, Nakajima 1928; Moore 1966)", True,
    ),
    ("smoothness", "slope-in-a-box"): RuleRow(
        _NONE, lambda law, _: law.once(smooth_in_its_box), obligations.nothing,
        "grad g is continuous and not 0 wherever g = 0, by enclosures in parts of the ranges of the forces (Moore 1966)", True,
    ),
    ("smoothness", "composition"): RuleRow(
        _NONE, smoothness, obligations.formula_where_loads_allow,
        "g is C^1 wherever g = 0, and grad g != 0 there because g is convex and somewhere negative; or K is convex, "
        "and round where its loads end (Rockafellar 1970, theorem 25.5)", moves=True,
    ),
    ("smoothness", "polar-seams"): RuleRow(
        _ORIGIN, lambda law, _: StarGauge(law).smooth(), obligations.numbers_in_formula,
        "gamma > 0 is smooth on each arc, and gamma' is equal on both sides of each seam", most_forces=_PLANE,
    ),
    ("smoothness", "fan"): RuleRow(
        _ORIGIN, lambda law, _: degrees.Fan(law).smooth(), obligations.formula,
        "the boundary is {f = c} with f of degree 1: f is smooth in each cone between two rays, and its gradient is "
        "continuous from each cone to the next", most_forces=_PLANE,
    ),
    ("smoothness", "euler"): RuleRow(
        _NONE, regular_along_rays, obligations.formula_where_it_has_a_value,
        "g is C^1 wherever g = 0, and grad g != 0 there: sigma . grad g > 0 (Euler), or g is a graph, or convex and somewhere negative",
    ),
    ("smoothness", "regular-value"): RuleRow(
        _NONE, regular, obligations.formula,
        "g is C^1 wherever g = 0, and grad g != 0 there", True,
    ),
    ("smoothness", "centre"): RuleRow(
        _NONE, lambda law, _: boundary.is_not_zero_at_its_centre(law), obligations.formula,
        "g is quadratic, and not 0 at its centre, which is the only place where grad g = 0", most_forces=3,
    ),
    ("smoothness", "one-dimensional"): RuleRow(
        _CONVEXITY, one_force, obligations.formula,
        "K is an interval with interior points: at each of its ends the normal is +1 or -1", most_forces=1,
    ),
    ("normality", "normality-rule"): RuleRow(_CONVEXITY, lambda law, _: law.associated, obligations.nothing, _MOREAU),
    ("normality", "parallel"): RuleRow(
        _CONVEXITY, parallel, obligations.formula_and_flow,
        "the flow is a non-negative multiple of grad g wherever g = 0, and K is convex", True,
    ),
    ("normality", "one-force"): RuleRow(
        _NONE, lambda law, _: normal_flows.has_the_sign_of_the_force(law), obligations.formula_and_flow,
        "g rises with the size of the force on both sides of 0, and the flow has the sign of the force: so it is normal to the "
        "interval K at both its ends", most_forces=1,
    ),
    ("normality", "gradient"): RuleRow(
        _CONVEXITY, gradient_flow, obligations.formula,
        "the flow is a multiple > 0 of grad g, and g is convex, negative at zero force and C^1 wherever it is 0: so grad g is not 0 there",
    ),
    ("dissipation", "fenchel"): RuleRow(
        _ORIGIN | {"normality"}, lambda law, _: True, obligations.flow,
        "0 lies in K and the flow d lies in the normal cone at sigma, so d . (0 - sigma) <= 0",
    ),
    ("dissipation", "homogeneity"): RuleRow(
        _NONE, homogeneity, obligations.formula_where_it_has_a_value,
        "the degrees of the parts of g in the forces, or its slope along rays, show that K is star-shaped about 0, so that sigma . n >= 0 "
        "for every normal n, or that K is a cone, and sigma . n = 0 (Euler)",
    ),
    ("dissipation", "potential"): RuleRow(
        _NONE, potential, obligations.formula_and_potential,
        "the degrees of the parts of the potential in the forces show that force . flow >= 0 wherever g = 0 (Euler)", True,
    ),
    ("dissipation", "convex-potential"): RuleRow(
        _NONE, convex_potential, obligations.formula_and_potential,
        "the potential h is convex and least at zero force, so force . flow >= h - h(0) >= 0 (Rockafellar 1970, section 23)",
    ),
    ("dissipation", "power-in-a-box"): RuleRow(
        _NONE, lambda law, _: law.once(dissipates_in_its_box), obligations.nothing,
        "force . slip >= 0 wherever g = 0, by enclosures in parts of the ranges of the forces (Moore 1966)", True,
    ),
    ("dissipation", "boundary-power"): RuleRow(_NONE, power, obligations.formula_and_flow, "force . flow >= 0 wherever g = 0"),
    ("dissipation", "power-share"): RuleRow(
        _NONE, power_share, obligations.formula_in_ranges,
        "a constant > 0 times force . flow is a constant times g plus a term >= 0, so it is >= 0 wherever g = 0; at an apex the limits "
        "of the flow dissipate too (Koiter 1953)", True,
    ),
    ("dissipation", "resistance"): RuleRow(
        _NONE, lambda law, _: rates.forces_dissipate(law), obligations.flow,
        "the forces as functions of the rates have sum of force . rate >= 0",
    ),
    ("normality", "monotone-resistance"): RuleRow(
        _NONE, lambda law, _: rates.forces_increase(law), obligations.flow,
        "each force is a function of its own rate that does not decrease, or all are one of their size: so they are the gradient "
        "of a convex potential of the rates (Rockafellar 1970, theorems 5.1 and 24.2)",
    ),
    ("duality", "polar-gauge"): RuleRow(
        _NONE, polar_gauge, obligations.formula,
        "Phi is the support function of K by the rules of the polar gauge (Rockafellar 1970, sections 13 to 15)", True,
    ),
    ("state_laws", BY_CONSTRUCTION): RuleRow(_NONE, lambda law, _: state.has_default_energy(law), obligations.nothing, _SQUARES),
    ("state_laws", "composition"): RuleRow(
        _NONE, convex_energy, state.energy_differentiable,
        "dpsi/du = -dpsi/du_in where both have one force; psi is convex in all variables together by the rules of composition, and concave "
        "in the temperature",
    ),
    ("thermal", "conductances"): RuleRow(
        _NONE, lambda law, _: state.heat_flows_downhill(law), obligations.nothing,
        "q_k . n_k = h_k (T_k - T) with h_k >= 0, so D_th is the sum of h_k (T_k - T)^2/T_k >= 0; that T changes by what D_intr and the "
        "thermoelastic term leave of this heat holds by construction (Antoni et al. 2007, Eq. 22)",
    ),
    ("homogeneity", "degrees"): RuleRow(
        _NONE, scales_with_the_pressure, lambda law: with_k_alone(law) or law.once(obligations.formula_but_at_tips),
        "g is of one degree in the forces and the pressure together, so that K(sigma_n) = |sigma_n| K(-1) (Euler)",
    ),
    ("bipotential", "polar-gauge"): RuleRow(_CONTACT | {"duality"}, lambda law, _: law.associated, with_k_alone, _BIPOTENTIAL, True),
    ("bipotential", "support-function"): RuleRow(_CONTACT, lambda law, _: law.associated, with_k_alone, _BIPOTENTIAL, True),
    ("bipotential", "one-normal"): RuleRow(_CONTACT | {"smoothness"}, lambda law, _: True, with_k_alone, _BIPOTENTIAL, True),
}  # fmt: skip
CURVE_RULES: Mapping[tuple[str, str], RuleRow] = {
    ("origin", "winding"): RuleRow(
        _NONE, lambda curve, _: curve.around_zero(), obligations.nothing,
        "the curve does not pass through 0 and winds around it",
    ),
    ("convexity", "turning-tangent"): RuleRow(
        _NONE, lambda curve, _: curve.convex(), obligations.nothing,
        "T' x T'' > 0 at every angle and the tangent turns once (do Carmo 1976, section 5-7)",
    ),
    ("smoothness", "convex-curve"): RuleRow(
        _CONVEXITY, lambda curve, _: True, obligations.nothing,
        "T' x T'' > 0 at every angle, so that T' is never 0, and the curve is simple",
    ),
    ("smoothness", "regular-curve"): RuleRow(
        _NONE, lambda curve, _: curve.convex() or curve.star_shaped(), obligations.nothing,
        "the curve is simple, and T' is never 0 (do Carmo 1976, section 5-7)",
    ),
    ("normality", "normality-rule"): RuleRow(_CONVEXITY, lambda curve, _: curve.flow is None, obligations.nothing, _MOREAU),
    ("normality", "parallel"): RuleRow(
        _CONVEXITY, lambda curve, _: curve.parallel(), obligations.nothing,
        "d . T' = 0 and d x T' > 0: the flow is the outward normal at every angle, and K is convex",
    ),
    ("dissipation", "power"): RuleRow(
        _NONE, lambda curve, _: curve.powered(), obligations.nothing,
        "T . d >= 0 at every angle, so force . flow >= 0",
    ),
    ("state_laws", BY_CONSTRUCTION): RuleRow(_NONE, lambda law, _: True, obligations.nothing, _SQUARES),
    ("homogeneity", BY_CONSTRUCTION): RuleRow(
        _NONE, lambda curve, _: True, obligations.nothing, "the curve bounds K(-1), and K(sigma_n) = |sigma_n| K(-1) by definition",
    ),
    ("bipotential", "support-function"): RuleRow(_CONTACT, lambda curve, _: curve.flow is None, obligations.nothing, _BIPOTENTIAL, True),
    ("bipotential", "one-normal"): RuleRow(_CONTACT | {"smoothness"}, lambda curve, _: True, obligations.nothing, _BIPOTENTIAL, True),
}  # fmt: skip
