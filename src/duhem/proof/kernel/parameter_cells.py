"""A claim decided for every value of one parameter: cells that cover its domain, on each of which the claim is proved or refuted.

On a cell where it is proved it is the claim of the law over that cell, by the rules of :mod:`claims`.  Where it is refuted a family of
witnesses shows that it fails for each value of the parameter, at values of the other parameters that the family gives.

An end of a cell that is no fraction is told by its polynomial.  A law over such a cell has a constraint more, by the sign of that
polynomial, which has no root within the cell; or l + (u - l) s stands in the place of the parameter, the ends l and u written by square
roots and 0 <= s <= 1.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from types import MappingProxyType
from typing import Any, NamedTuple

from duhem.proof.kernel import obligations
from duhem.proof.kernel.bounds import NEGATIVE, POSITIVE, ZERO, Bounds
from duhem.proof.kernel.certificate import check_version, law_of
from duhem.proof.kernel.claims import at_point, objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import dents, falls_both_ways, section
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import roots_between, sign_at
from duhem.proof.kernel.stated_law import StatedLaw, as_list, as_object, without_more
from duhem.proof.kernel.term import UNREADABLE, NotWritten, Term, in_words, minus, number, parse, product_of, sum_of

__all__ = [
    "AS",
    "REFUTATIONS",
    "SCHEMA",
    "Covered",
    "ParameterCell",
    "at_values",
    "family_fails",
    "law_over",
    "own_domain",
    "proof_fails",
    "recheck_region",
    "refutation_fails",
]

SCHEMA = "duhem region certificate 1"
AS = ("range", "sign", "share")  # how a law is put over a cell
_SHARE = Term("name", name="share of the cell")  # no name of a law has blanks
Evidence = Mapping[str, Any]


class ParameterCell(NamedTuple):
    """The values between two ends, None being no end; ``open`` leaves out the lower one, ``open_high`` the upper one."""

    low: RealRoot | None
    high: RealRoot | None
    open: bool = False
    open_high: bool = False

    @classmethod
    def read(cls, given: Evidence) -> ParameterCell:
        """NotWritten for what is no such interval, or is empty."""
        ends = [None if given[key] is None else RealRoot.read(as_object(given[key])) for key in ("low", "high")]
        if not all(isinstance(given[key], bool) for key in ("open", "open_high")):
            raise NotWritten("a cell does not say whether its ends belong to it")
        found = cls(ends[0], ends[1], given["open"], given["open_high"])
        if found.single and (found.open or found.open_high):
            raise NotWritten("a cell is empty")
        if None not in ends and not found.single and not ends[0].below(ends[1]):  # type: ignore[union-attr,arg-type]
            raise NotWritten("the ends of a cell are not in order")
        return found

    def written(self) -> dict[str, Any]:
        """As :meth:`read` takes it."""
        ends = {key: None if end is None else end.written() for key, end in (("low", self.low), ("high", self.high))}
        return {**ends, "open": self.open, "open_high": self.open_high}

    @property
    def single(self) -> bool:
        """Whether it is one value."""
        return self.low is not None and self.low == self.high

    def meets(self, after: ParameterCell) -> bool:
        """Whether another cell begins where this one ends, nothing between them left out; the end is told in the same way."""
        return self.high is not None and self.high == after.low and not (self.open_high and after.open)

    @property
    def bounds(self) -> Bounds:
        """The least interval with fractions for ends in which it is seen to lie."""
        low, high = self.low, self.high
        return Bounds(
            None if low is None else low.low, None if high is None else high.high,
            self.open if low is None or low.exact else True, self.open_high if high is None or high.exact else True,
        )  # fmt: skip


def own_domain(law: StatedLaw, name: str) -> Bounds:
    """Where a parameter may lie, by its range and by the constraints that speak of no other."""
    alone = tuple(c for c in law.constraints if c.names() == {name})
    return over(law._replace(constraints=alone)).bounds[name]


def law_over(law: StatedLaw, name: str, cell: ParameterCell, way: str) -> tuple[StatedLaw, dict[Term, Term]]:
    """The law over a cell of a parameter, and what stands in the place of that; NotWritten where it cannot be put in this ``way``.

    A variable of the state stays one: forces are derivatives by it.
    """
    known = law.parameters[name]
    if any(name == variable for variable, _ in law.variables):
        raise NotWritten("the parameter is a variable of the state")
    if cell.single and cell.low is not None:
        return _put(law, name, cell.low.term())
    if way == "share":
        return _put(law, name, *_by_share(cell))
    outer = cell.bounds
    known = known.above(outer.low, outer.open).below(outer.high, outer.open_high)
    signs = tuple(_sign(name, end, cell) for end in cell[:2] if isinstance(end, RealRoot) and not end.exact)
    if way != ("sign" if signs else "range"):
        raise NotWritten("a law is not put over such a cell in this way")
    return law._replace(parameters={**law.parameters, name: known}, constraints=(*law.constraints, *signs)), {}


def _by_share(cell: ParameterCell) -> tuple[Term, Bounds]:
    """The parameter by its share of the cell, or by its distance from the one end that the cell has, and where that lies."""
    match cell:
        case (None, RealRoot() as high, _, open_high):
            return sum_of(high.term(), minus(_SHARE)), Bounds(Fraction(0), None, open_high)
        case (RealRoot() as low, None, left_out, _):
            return sum_of(low.term(), _SHARE), Bounds(Fraction(0), None, left_out)
        case (RealRoot() as low, RealRoot() as high, left_out, open_high):
            rest = sum_of(number(1), minus(_SHARE))
            return sum_of(product_of(low.term(), rest), product_of(high.term(), _SHARE)), Bounds(
                Fraction(0), Fraction(1), left_out, open_high
            )
    raise NotWritten("a cell has no end")


def _put(law: StatedLaw, name: str, term: Term, share: Bounds | None = None) -> tuple[StatedLaw, dict[Term, Term]]:
    swap = {Term("name", name=name): term}
    parameters = {other: own for other, own in law.parameters.items() if other != name} | ({} if share is None else {_SHARE.name: share})

    def within(value: Any) -> Any:
        if isinstance(value, Term):
            return value.put(swap)
        return tuple(map(within, value)) if type(value) is tuple else value

    return StatedLaw(*map(within, law))._replace(parameters=parameters), swap


def _sign(name: str, end: RealRoot, cell: ParameterCell) -> Term:
    """A comparison that holds on the whole cell, by the sign of the polynomial of one of its ends.

    It leaves out an open end, unless it would leave out the other one too, which belongs to the cell.
    """
    lower = end is cell.low
    other, left_out, other_left_out = (cell.high, cell.open, cell.open_high) if lower else (cell.low, cell.open_high, cell.open)
    inside = -end.sign_before() if lower else end.sign_before()
    between = (end.high, None if other is None else other.low) if lower else (None if other is None else other.high, end.low)
    if roots_between(end.poly, *between):
        raise NotWritten("the polynomial of an end of a cell has a root inside")
    shared = other is not None and (sign_at(end.poly, other.low) == 0 if other.exact else other.poly == end.poly)
    if other is not None and not other.exact and not shared and (_vanishes_at_ends(end, other) or roots_between(end.poly, *other[1:])):
        raise NotWritten("the polynomial of an end of a cell may have a root inside")
    x = Term("name", name=name)
    powers = (Term("**", (x, number(i))) if i else number(1) for i in range(len(end.poly)))
    value = sum_of(*(product_of(number(c * inside), power) for c, power in zip(end.poly, powers, strict=True)))
    return Term(">" if left_out and (other_left_out or not shared) else ">=", (value, number(0)))


def _vanishes_at_ends(end: RealRoot, other: RealRoot) -> bool:
    return 0 in (sign_at(end.poly, other.low), sign_at(end.poly, other.high))


# -- refuted -----------------------------------------------------------------------------------------------------------


def at_values(
    law: StatedLaw, values: Mapping[str, Any], swap: Mapping[Term, Term], names: Collection[str] = (), related: Collection[Term] = ()
) -> StatedLaw:
    """The law at values of some of its parameters, given by formulas in the others; NotWritten where these are not shown to be admitted.

    Constraints on ``names`` alone, those of a region, say where it is asked.  ``related`` are constraints that related parameters before
    some were put.
    """
    terms = {name: parse(text).put(dict(swap)) for name, text in as_object(values).items()}
    # One that relates what is left is shown, not assumed: it may leave no values to some of a cell, which a witness must not pass over.
    left = (c for c in law.constraints if c not in related and not c.names() & set(terms))
    return _at_terms(law, terms, tuple(c for c in left if len(c.names()) < 2 or c.names() <= set(names)))


def _at_terms(law: StatedLaw, terms: Mapping[str, Term], alone: tuple[Term, ...]) -> StatedLaw:
    """The law at values of some of its parameters; of its constraints those that stand ``alone`` are left, the others are shown."""
    left = {name: own for name, own in law.parameters.items() if name not in terms}
    domain = over(law._replace(parameters=left, constraints=alone, g=number(0), flow=None, surfaces=(), ranges=()))
    found = law
    for name, term in terms.items():
        if name not in law.parameters or not term.names() <= set(left):
            raise NotWritten("a value is of no parameter, or of names that are not left")
        if not _lies_in(law.parameters[name], term, domain):
            raise NotWritten(f"the value of {name} is not shown to lie in its range")
        found = _put(found, name, term)[0]
    if not all(domain.decided(c) for c in found.constraints if c not in alone):
        raise NotWritten("the values are not shown to meet the constraints")
    return found._replace(constraints=alone)


def _lies_in(own: Bounds, term: Term, domain: StatedDomain) -> bool:
    """Whether a constant has a value and is shown to lie in a range."""
    sides = [(sum_of(term, number(-own.low)), own.open)] if own.low is not None else []
    sides += [(sum_of(number(own.high), minus(term)), own.open_high)] if own.high is not None else []
    return domain.facts(term).defined and not any(domain.facts(x).sign & (NEGATIVE | (ZERO if sharp else 0)) for x, sharp in sides)


def _dented(law: StatedLaw, evidence: Evidence) -> bool:
    """K is not convex: a section of it has a dent."""
    if any(name in law.forces for name, _ in law.ranges) or law.viscous or law.of_rates:
        return False
    if "section" in evidence:
        law = section(law, evidence["section"])
    place = RealRoot.read(as_object(evidence["at"]))
    return any(dent.name == evidence["dent"] and dent.at(place) for dent in dents(law, evidence["family"]))


def _on_a_line(law: StatedLaw, evidence: Evidence) -> bool:
    """K is not convex: a line leaves it and comes back."""
    whole = not law.ranges and not law.viscous and not law.of_rates
    return whole and falls_both_ways(law, evidence)


def _left_by_a_chord(law: StatedLaw, evidence: Evidence) -> bool:
    """K is not convex: two points lie in it and in the ranges, and the midpoint is not in K; at one pressure, where there is one."""
    if law.viscous or law.of_rates:
        return False
    ends = [{f: parse(as_object(evidence[key]).get(f, "0")) for f in law.forces} for key in ("p", "q")]
    middle = {f: product_of(number(Fraction(1, 2)), sum_of(*(end[f] for end in ends))) for f in law.forces}
    domain, held = over(law), dict[Term, Term]()
    if law.pressure is not None:
        held = {Term("name", name=law.pressure): (pressure := parse(evidence["pressure"]))}
        if not (domain.constant(pressure) and domain.facts(pressure).defined and domain.facts(pressure).sign == NEGATIVE):
            return False
    if not all(domain.constant(x) and domain.facts(x).defined for end in ends for x in end.values()):
        return False
    here = [{Term("name", name=f): x.put(held) for f, x in place.items()} | held for place in (*ends, middle)]
    if not all(_lies_in(own, place[Term("name", name=name)], domain) for place in here for name, own in law.ranges):
        return False
    places = [law.g.put(held).put(place) for place in here]
    one, two, between = map(domain.facts, places)
    inside = all(end.defined and not end.sign & POSITIVE for end in (one, two))
    return inside and between.defined and between.sign == POSITIVE


def _outside(law: StatedLaw, _: Evidence) -> bool:
    """g(0) > 0."""
    here = at_point(law, {})
    return not law.viscous and not law.of_rates and here.defined and here.sign == POSITIVE


def _consumes(law: StatedLaw, evidence: Evidence) -> bool:
    """force . flow < 0 at a point where g = 0, of a law with a flow of its own and no energy; every part has a value there.

    The parameter ``scale`` of the evidence is what g is there without it, so that g = 0 where it is subtracted in g.
    """
    if law.flow is None or law.energy is not None or law.rates or law.ranges or law.viscous or law.of_rates:
        return False
    place = {Term("name", name=f): parse(text) for f, text in as_object(evidence["point"]).items()}
    place = {Term("name", name=f): place.get(Term("name", name=f), number(0)) for f in law.forces}
    if "scale" in evidence:
        scale = Term("name", name=evidence["scale"])
        others = tuple(c for c in law.constraints if scale.name not in c.names())
        law = _at_terms(law, {scale.name: law.g.put({scale: number(0)}).put(place)}, others)
    domain = over(law)
    flow = tuple(d.put(place) for d in law.flow or ())
    if not all(domain.constant(x) and domain.facts(x).defined for x in (*place.values(), *flow)):
        return False
    here = at_point(law, evidence["point"])
    power = domain.facts(sum_of(*(product_of(x, d) for x, d in zip(place.values(), flow, strict=True))))
    return here.defined and here.sign == ZERO and power.defined and power.sign == NEGATIVE


REFUTATIONS: Mapping[tuple[str, str], Callable[[StatedLaw, Evidence], bool]] = {
    ("convexity", "dent"): _dented,
    ("convexity", "chord"): _left_by_a_chord,
    ("convexity", "line"): _on_a_line,
    ("origin", "evaluation"): _outside,
    ("dissipation", "point"): _consumes,
    ("normality", "dent"): lambda law, evidence: law.associated and _dented(law, evidence),
}
_EVIDENCE = ("at", "along", "dent", "family", "p", "point", "pressure", "q", "scale", "section", "through", "values")


def refutation_fails(claim: str, rule: str, law: StatedLaw, name: str, cell: ParameterCell, way: str, evidence: Evidence) -> str:
    """Why a family of witnesses does not refute a claim for each value of a parameter in a cell; "" if it does."""
    try:
        put, swap = law_over(law, name, cell, way)
    except UNREADABLE as fault:
        return in_words(fault)
    related = [c.put(swap) for c in law.constraints if len(c.names()) > 1]
    return family_fails(claim, rule, put, (name, _SHARE.name), evidence, swap, related)


def family_fails(
    claim: str,
    rule: str,
    law: StatedLaw,
    names: Collection[str],
    evidence: Evidence,
    swap: Mapping[Term, Term] = MappingProxyType({}),
    related: Collection[Term] = (),
) -> str:
    """Why a family of witnesses does not refute a claim of a law for all that its parameters ``names`` may be; "" if it does.

    ``swap`` has what was put in the place of a parameter in the law already, ``related`` the constraints that related it to others.
    """
    if (claim, rule) not in REFUTATIONS:
        return f"no rule {rule!r} refutes this claim"
    try:
        without_more(evidence, _EVIDENCE)
        if {*names} & {*as_object(evidence.get("values", {})), evidence.get("scale")}:
            raise NotWritten("a family is for one value of the parameter alone")
        put = at_values(law, evidence.get("values", {}), swap, names, related)
        undecided = obligations.constraints(put) or obligations.numbers_in_formula(put)
        return undecided or ("" if REFUTATIONS[claim, rule](put, evidence) else f"the rule {rule!r} does not show it")
    except UNREADABLE as fault:
        return f"its evidence cannot be read: {in_words(fault)}"


# -- the whole ---------------------------------------------------------------------------------------------------------


class Covered(NamedTuple):
    """A cell of a certificate: what it says, and ``reason`` where that is not confirmed."""

    cell: ParameterCell
    verdict: str
    reason: str

    @property
    def said(self) -> str:
        """The cell in words."""
        low, high = ("oo" if end is None else str(end.low) if end.exact else f"about {float(end.low):.9g}" for end in self.cell[:2])
        left, right = (
            mark[out]
            for mark, out in (("[(", self.cell.low is None or self.cell.open), ("])", self.cell.high is None or self.cell.open_high))
        )
        return f"{left}{'-' * (self.cell.low is None)}{low}, {high}{right}"


def _objection(law: StatedLaw, claim: str, name: str, cell: ParameterCell, row: Evidence) -> str:
    """Why what a certificate says of a cell is not confirmed; "" if it is."""
    way = row["as"]
    if row["verdict"] == "refuted":
        return refutation_fails(claim, row["rule"], law, name, cell, way, as_object(row["evidence"]))
    try:
        put, _ = law_over(law, name, cell, way)
    except UNREADABLE as fault:
        return in_words(fault)
    return proof_fails(claim, put, row)


def proof_fails(claim: str, law: StatedLaw, row: Evidence) -> str:
    """Why a rule, with those for the claims that it rests on, does not prove a claim of a law; "" if it does."""
    settled = set[str]()
    for step in (*as_list(row["needs"]), {"claim": claim, "rule": row["rule"], "evidence": row["evidence"]}):
        own, rule = step["claim"], without_more(as_object(step), {"claim", "rule", "evidence"})["rule"]
        if reason := objection(own, rule, frozenset(settled), law, as_object(step["evidence"])):
            return reason if own == claim else f"{own}: {reason}"
        settled.add(own)
    return ""


def recheck_region(document: Mapping[str, Any]) -> tuple[Covered, ...]:
    """Every cell of a certificate, in order; NotWritten where it is none, or its cells are not the parameter's domain."""
    try:
        check_version(document["schema"], SCHEMA)
        without_more(document, {"schema", "law", "inhabited", "claim", "parameter", "cells", "sha256"})
        law = law_of(document)
        claim, name = document["claim"], document["parameter"]
        if not isinstance(law, StatedLaw) or name not in law.parameters:
            raise NotWritten("its parameter is none of the law")
        rows = [_row(as_object(row)) for row in as_list(document["cells"])]
        cells = [ParameterCell.read(row) for row in rows]
        if not covers(own_domain(law, name), cells):
            raise NotWritten("its cells do not cover the domain of the parameter, or reach beyond it")
        return tuple(
            Covered(cell, row["verdict"], "" if row["verdict"] == "open" else _objection(law, claim, name, cell, row))
            for cell, row in zip(cells, rows, strict=True)
        )
    except UNREADABLE as fault:
        raise NotWritten(f"{'' if isinstance(fault, NotWritten) else 'it is no certificate: '}{in_words(fault)}") from None


def _row(given: Evidence) -> Evidence:
    more = () if given["verdict"] == "open" else ("as", "rule", "evidence", *(("needs",) if given["verdict"] == "proved" else ()))
    if given["verdict"] not in ("open", "proved", "refuted") or set(given) != {"low", "high", "open", "open_high", "verdict", *more}:
        raise NotWritten("a cell does not say what holds on it")
    return given


def covers(domain: Bounds, cells: Sequence[ParameterCell]) -> bool:
    """Whether cells in order are a domain, without a gap and nothing beyond; an end that two of them share is told in the same way."""
    if not cells:
        return False
    met = all(one.meets(two) for one, two in pairwise(cells))
    first, last = cells[0], cells[-1]
    if any(end is not None and not end.exact for end in (first.low, last.high)):
        return False
    whole = Bounds(first.bounds.low, last.bounds.high, first.open and first.low is not None, last.open_high and last.high is not None)
    return met and whole.covers(domain) and domain.covers(whole)
