"""A claim decided for all values of some parameters: a tree of comparisons, of which each leaf is proved, refuted, outside or open.

A node compares two formulas of the parameters that have a value whatever these are.  So a comparison holds or fails, and the leaves cover
the domain by construction: no geometry is checked.  A leaf is a cell, about the law with the comparisons on the way to it, or their
opposites, as further constraints; where one holds a parameter against a number it is an end of the range of that.  A leaf is proved by the
rules of :mod:`claims`, of the law over the cell.  It is refuted by a family of witnesses, which shows that the claim fails for each value
in the cell, at values of the other parameters that the family gives.  It is outside where no values meet its ranges and constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from typing import Any, NamedTuple

from duhem.proof.kernel import obligations
from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, Sign
from duhem.proof.kernel.certificate import check_version, law_of
from duhem.proof.kernel.claims import at_point, objection
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import AGAINST, Reader
from duhem.proof.kernel.dents import dents, falls_both_ways
from duhem.proof.kernel.domain import EmptyError, StatedDomain, gap
from duhem.proof.kernel.forms import place_of
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw, as_list, as_object, without_more
from duhem.proof.kernel.term import COMPARISONS, HALF, UNREADABLE, NotWritten, Term, in_words, minus, number, parse, product_of, sum_of

__all__ = [
    "REFUTATIONS", "SCHEMA", "TreeLeaf", "at_values", "ends", "family_fails", "law_where", "not_outside", "opposite", "own_domain",
    "proof_fails", "read_comparison", "recheck_tree", "settled",
]  # fmt: skip

SCHEMA = "duhem region certificate 2"
_MOST_DEPTH = 200
Evidence = Mapping[str, Any]
_SAID = {"open": (), "outside": (), "refuted": ("rule", "evidence"), "proved": ("rule", "evidence", "needs")}  # beside its verdict


class TreeLeaf(NamedTuple):
    """A leaf: the comparisons that hold there, what is said of it, and ``reason`` where that is not confirmed."""

    where: tuple[str, ...]
    verdict: str
    reason: str

    @property
    def said(self) -> str:
        """The leaf in words."""
        return " and ".join(self.where) or "everywhere"


def read_comparison(text: str, names: Collection[str]) -> Term:
    """A comparison of formulas of ``names``, solved for its name where it has only one and is affine in it.

    NotWritten for anything else, and for what has not a value for all real values of these.
    """
    found = parse(text)
    if refused := obligations.numbers(text):
        raise NotWritten(refused)
    reader = Reader(over(StatedLaw(("",), None, number(0), None, dict.fromkeys(names, Bounds(None, None)), ())))
    if found.op not in COMPARISONS or not found.names() <= {*names, "pi"} or reader.undecided(found) is not None:
        raise NotWritten("a tree is divided by what is no comparison of its parameters, or has not always a value")
    found = found._replace(args=tuple(side if (value := _fraction(side)) is None else number(value) for side in found.args))
    poly = reader.domain.polynomial(gap(found))
    slopes = [(m[0][0], c) for m, c in poly.items() if [n for _, n in m] == [1] and m[0][0].names() <= {*names}]
    if len(slopes) != 1 or len(poly) > 1 + (() in poly) or slopes[0][0].op != "name":
        return found
    ((x, c),) = slopes
    return Term((">" if c > 0 else "<") + "=" * found.op.endswith("="), (x, number(-poly.get((), Fraction(0)) / c)))


def _fraction(term: Term) -> Fraction | None:
    """The fraction that a number is; None for any other term."""
    with suppress(NotWritten):
        return exact_value(term)
    return None


def opposite(comparison: str) -> str:
    """What holds where a comparison does not."""
    op = parse(comparison).op
    left, right = comparison.split(op)
    return f"{left.strip()} {AGAINST[op]} {right.strip()}"


def law_where(law: StatedLaw, comparison: Term) -> StatedLaw:
    """The law where its parameters meet one more comparison, as it is read; that with a number is an end of a range."""
    (left, right), op = comparison.args, comparison.op
    if left.op != "name" or right.op != "number":
        return law._replace(constraints=(*law.constraints, comparison))
    own, sharp = law.parameters[left.name], len(op) == 1
    own = own.above(right.value, sharp) if op.startswith(">") else own.below(right.value, sharp)
    return law._replace(parameters={**law.parameters, left.name: own})


def not_outside(law: StatedLaw) -> str:
    """Why it is not shown that no parameters meet the ranges and constraints of a law; "" if it is.

    It is where these leave no range to a parameter, or where the others show the opposite of one constraint.
    """
    rest = ((c, law._replace(constraints=tuple(other for other in law.constraints if other is not c))) for c in law.constraints)
    try:
        if not (undecided := obligations.constraints(law)):
            over(law)
            undecided = "" if any(over(others).decided(c) is False for c, others in rest) else "parameters may lie there"
    except EmptyError:
        return ""
    return undecided


def ends(name: str, own: Bounds) -> Iterator[str]:
    """The range of a parameter as comparisons."""
    if own.low is not None:
        yield f"{name} {'>' if own.open else '>='} {own.low}"
    if own.high is not None:
        yield f"{name} {'<' if own.open_high else '<='} {own.high}"


# -- the law over a cell -------------------------------------------------------------------------------------------------


def own_domain(law: StatedLaw, name: str) -> Bounds:
    """Where a parameter may lie, by its range and by the constraints that speak of no other."""
    alone = tuple(c for c in law.constraints if c.names() == {name})
    return over(law._replace(constraints=alone)).bounds[name]


def settled(law: StatedLaw, names: Collection[str]) -> StatedLaw:
    """The law with what stands for some of its parameters: a number, where its range leaves no other.

    Where one is compared with a number that is no fraction it is l + (u - l) s, the ends l and u written by roots and 0 <= s <= 1.
    """
    return _settled(law, names)[0]


def _settled(law: StatedLaw, names: Collection[str]) -> tuple[StatedLaw, dict[Term, Term]]:
    swap, shares, ends = dict[Term, Term](), dict[str, Bounds](), list[Term]()
    for name, own in law.parameters.items():
        x, share = Term("name", name=name), Term("name", name=f"share of {name}")  # no name of a law has blanks
        ends_of_it = (c for c in law.constraints if name in names and c.args[0] == x)
        beside = [c for c in ends_of_it if not c.args[1].names() and _fraction(c.args[1]) is None]  # numbers that are no fractions
        if name in names and own.single and own.low is not None:
            swap[x] = number(own.low)
        elif beside:
            swap[x], shares[share.name] = _by_share(share, own, beside)
            ends += beside
    left = {name: own for name, own in law.parameters.items() if Term("name", name=name) not in swap} | shares
    here = law._replace(constraints=tuple(c for c in law.constraints if c not in ends))
    return _put(here, swap)._replace(parameters=left), swap


def _by_share(share: Term, own: Bounds, beside: Collection[Term]) -> tuple[Term, Bounds]:
    """A parameter by its share of what lies between its ends, or by its distance from the one that it has, and where that lies."""
    low, high = (None if end is None else number(end) for end in own[:2])
    left_out, left_out_high = own[2:]
    for c in beside:  # the last one is an end
        if c.op.startswith(">"):
            low, left_out = c.args[1], len(c.op) == 1
        else:
            high, left_out_high = c.args[1], len(c.op) == 1
    if low is None or high is None:
        end, way = (high, minus(share)) if low is None else (low, share)
        return sum_of(end or number(0), way), Bounds(Fraction(0), None, left_out_high if low is None else left_out)
    rest = sum_of(number(1), minus(share))
    return sum_of(product_of(low, rest), product_of(high, share)), Bounds(Fraction(0), Fraction(1), left_out, left_out_high)


def _put(law: StatedLaw, swap: Mapping[Term, Term]) -> StatedLaw:
    def within(value: Any) -> Any:
        if isinstance(value, Term):
            return value.put(swap)
        return tuple(map(within, value)) if type(value) is tuple else value

    return StatedLaw(*map(within, law)) if swap else law


# -- refuted -----------------------------------------------------------------------------------------------------------


def at_values(law: StatedLaw, values: Mapping[str, Any], names: Collection[str] = ()) -> StatedLaw:
    """The law at values of some of its parameters, given by formulas in the others; NotWritten where these are not shown to be admitted.

    Constraints on ``names`` alone, those of a region, say where it is asked; what stands for one of these is put in.
    """
    # One that relates what is left is shown, not assumed: it may leave no values to some of a cell, which a witness must not pass over.
    left = (c for c in law.constraints if not c.names() & {*values})
    alone = [c for c in left if len(c.names()) < 2 or c.names() <= {*names}]
    here, swap = _settled(law, names)
    assumed = (c.put(swap) for c in alone)
    return _at_terms(here, {name: parse(text) for name, text in values.items()}, tuple(c for c in assumed if c in here.constraints))


def _at_terms(law: StatedLaw, terms: Mapping[str, Term], alone: tuple[Term, ...]) -> StatedLaw:
    """The law at values of some of its parameters; of its constraints those that stand ``alone`` are left, the others are shown."""
    left = {name: own for name, own in law.parameters.items() if name not in terms}
    domain = over(law._replace(parameters=left, constraints=alone, g=number(0), flow=None, surfaces=(), ranges=()))
    for name, term in terms.items():
        if name not in law.parameters or not term.names() <= set(left):
            raise NotWritten("a value is of no parameter, or of names that are not left")
        if not _lies_in(law.parameters[name], term, domain):
            raise NotWritten(f"the value of {name} is not shown to lie in its range")
    found = _put(law, {Term("name", name=name): term for name, term in terms.items()})._replace(parameters=left)
    if not all(domain.decided(c) for c in found.constraints if c not in alone):
        raise NotWritten("the values are not shown to meet the constraints")
    return found._replace(constraints=alone)


def _lies_in(own: Bounds, term: Term, domain: StatedDomain) -> bool:
    """Whether a constant has a value and is shown to lie in a range."""
    sides = [(sum_of(term, number(-own.low)), own.open)] if own.low is not None else []
    sides += [(sum_of(number(own.high), minus(term)), own.open_high)] if own.high is not None else []
    return domain.facts(term).defined and not any(domain.facts(x).sign & (NEGATIVE | (ZERO if sharp else 0)) for x, sharp in sides)


def _dented(law: StatedLaw, evidence: Evidence) -> bool:
    """K is not convex: it has a dent."""
    place, whole = RealRoot.read(as_object(evidence["at"])), not any(name in law.forces for name, _ in law.ranges)
    return whole and any(dent.name == evidence["dent"] and dent.at(place) for dent in dents(law, evidence["family"]))


def _left_by_a_chord(law: StatedLaw, evidence: Evidence) -> bool:
    """K is not convex: two points lie in it and in the ranges, and the midpoint is not in K; at one pressure, where there is one."""
    domain, held = over(law), dict[Term, Term]()
    ends = [place_of(evidence[key], domain) for key in ("p", "q")]
    middle = {x: product_of(HALF, sum_of(*(end[x] for end in ends))) for x in ends[0]}
    if law.pressure is not None:
        held = {Term("name", name=law.pressure): (pressure := parse(evidence["pressure"]))}
        if _sign(pressure, domain) != NEGATIVE:
            return False
    here = [{x: value.put(held) for x, value in place.items()} | held for place in (*ends, middle)]
    if not all(_lies_in(own, place[Term("name", name=name)], domain) for place in here for name, own in law.ranges):
        return False
    # its names are free in the normal form: an identity holds for all that they may be
    free = over(law._replace(forces=(*law.parameters,), parameters={}, constraints=(), ranges=()))
    one, two, between = (_sign(x, domain) & _sign_in_normal_form(x, domain, free) for x in (law.g.put(held).put(place) for place in here))
    return not (one | two) & POSITIVE and between == POSITIVE


def _outside(law: StatedLaw, _: Evidence) -> bool:
    """g(0) > 0."""
    here = at_point(law, {})
    return here.defined and here.sign == POSITIVE


def _consumes(law: StatedLaw, evidence: Evidence) -> bool:
    """force . flow < 0 at a point where g = 0, of a law with a flow of its own and no energy; every part has a value there.

    The parameter ``scale`` of the evidence is what g is there without it, so that g = 0 where it is subtracted in g.
    """
    if law.flow is None or law.energy is not None or law.rates or law.ranges:
        return False
    place = place_of(evidence["point"], over(law))
    if "scale" in evidence:
        scale = Term("name", name=evidence["scale"])
        others = tuple(c for c in law.constraints if scale.name not in c.names())
        law = _at_terms(law, {scale.name: law.g.put({scale: number(0)}).put(place)}, others)
    domain = over(law)
    flow = tuple(d.put(place) for d in law.flow or ())
    here, power = at_point(law, evidence["point"]), sum_of(*(product_of(x, d) for x, d in zip(place.values(), flow, strict=True)))
    known = all(_has_value(x, domain) for x in (*place.values(), *flow))
    return known and here.defined and here.sign == ZERO and _sign(power, domain) == NEGATIVE


def _has_value(x: Term, domain: StatedDomain) -> bool:
    """Whether it depends on no force, and has a value."""
    return domain.constant(x) and domain.facts(x).defined


def _sign_in_normal_form(x: Term, domain: StatedDomain, free: StatedDomain) -> Sign:
    """The signs of a constant that has a value as it is written: its normal form alone may have one in more places."""
    with suppress(NotWritten):
        return _sign(normal(x, free), domain) if _has_value(x, domain) else ANY
    return ANY


def _sign(x: Term, domain: StatedDomain) -> Sign:
    """The signs of a constant that has a value; of anything else nothing is known."""
    return domain.facts(x).sign if _has_value(x, domain) else ANY


REFUTATIONS: Mapping[tuple[str, str], Callable[[StatedLaw, Evidence], bool]] = {
    ("convexity", "dent"): _dented,
    ("convexity", "chord"): _left_by_a_chord,
    ("convexity", "line"): lambda law, evidence: not law.ranges and falls_both_ways(law, evidence),  # it leaves K and comes back
    ("origin", "evaluation"): _outside,
    ("dissipation", "point"): _consumes,
    ("normality", "dent"): lambda law, evidence: law.associated and _dented(law, evidence),
}
_EVIDENCE = ("at", "along", "dent", "family", "p", "point", "pressure", "q", "scale", "through", "values")


def family_fails(claim: str, rule: str, law: StatedLaw, names: Collection[str], evidence: Evidence) -> str:
    """Why a family of witnesses does not refute a claim of a law for all that its parameters ``names`` may be; "" if it does."""
    if (claim, rule) not in REFUTATIONS:
        return f"no rule {rule!r} refutes this claim"
    try:
        without_more(evidence, _EVIDENCE)
        values = as_object(evidence.get("values", {}))
        if law.viscous or law.of_rates:
            raise NotWritten("the law has no K of stresses")
        if not {*values, *([evidence["scale"]] if "scale" in evidence else [])} <= {*law.parameters} - {*names}:
            raise NotWritten("a family is for one value of the parameter alone")
        put = at_values(law, values, names)
        undecided = obligations.constraints(put) or obligations.numbers_in_formula(put)
        return undecided or ("" if REFUTATIONS[claim, rule](put, evidence) else f"the rule {rule!r} does not show it")
    except UNREADABLE as fault:
        return f"its evidence cannot be read: {in_words(fault)}"


def proof_fails(claim: str, law: StatedLaw, row: Evidence) -> str:
    """Why a rule, with those for the claims that it rests on, does not prove a claim of a law; "" if it does."""
    settled = set[str]()
    for step in (*as_list(row["needs"]), {"claim": claim, "rule": row["rule"], "evidence": row["evidence"]}):
        own, rule = step["claim"], without_more(as_object(step), {"claim", "rule", "evidence"})["rule"]
        if reason := objection(own, rule, frozenset(settled), law, as_object(step["evidence"])):
            return reason if own == claim else f"{own}: {reason}"
        settled.add(own)
    return ""


# -- the whole tree ------------------------------------------------------------------------------------------------------


def recheck_tree(document: Mapping[str, Any]) -> tuple[TreeLeaf, ...]:
    """Every leaf of a certificate, in order; NotWritten where it is none."""
    try:
        check_version(document["schema"], SCHEMA)
        without_more(document, {"schema", "law", "inhabited", "claim", "parameters", "tree", "steps", "sha256"})
        law, claim, names = law_of(document), document["claim"], as_list(document["parameters"])
        if not isinstance(law, StatedLaw) or not names or len({*names}) < len(names) or not {*names} <= {*law.parameters}:
            raise NotWritten("its parameters are none of the law")
        if {*names} & {variable for variable, _ in law.variables}:
            raise NotWritten("a parameter is a variable of the state")
        if not law.around_zero:
            raise NotWritten("zero force is outside the ranges of the forces")
        return tuple(_leaves(law, claim, names, as_object(document["tree"])))
    except UNREADABLE as fault:
        raise NotWritten(f"{'' if isinstance(fault, NotWritten) else 'it is no certificate: '}{in_words(fault)}") from None


def _leaves(
    law: StatedLaw, claim: str, names: Collection[str], node: Mapping[str, Any], way: tuple[str, ...] = (), depth: int = 0
) -> Iterator[TreeLeaf]:
    if depth > _MOST_DEPTH:
        raise NotWritten("a tree is too deep")
    if "split" in node:
        without_more(node, {"split", "holds", "fails"})
        for text, key in ((node["split"], "holds"), (opposite(node["split"]), "fails")):
            here = law_where(law, read_comparison(text, names))
            told = way if here.constraints == law.constraints else (*way, text)  # the ends of ranges are said as they are in the end
            yield from _leaves(here, claim, names, as_object(node[key]), told, depth + 1)
        return
    if node["verdict"] not in _SAID or set(node) != {"verdict", *_SAID[node["verdict"]]}:
        raise NotWritten("a leaf does not say what holds on it")
    reason = ""
    if node["verdict"] == "proved":
        reason = proof_fails(claim, settled(law, names), node)
    elif node["verdict"] == "refuted":
        reason = family_fails(claim, node["rule"], law, names, as_object(node["evidence"]))
    elif node["verdict"] == "outside":
        reason = not_outside(law)
    yield TreeLeaf((*(end for name in names for end in ends(name, law.parameters[name])), *way), node["verdict"], reason)
