"""What must have a value before a rule reads a law: the parts of it that the rule speaks of, as they are written.

g is asked for a value for all forces, or but for a limit at a tip (:mod:`definedness`), or where the loads in it allow K (:mod:`region`),
as the rule that reads it allows.  Each function returns "" where everything has a value, else what is not shown to have one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from fractions import Fraction
from functools import partial

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.curve import Stated
from duhem.proof.kernel.definedness import Reader, asks, continued, in_quotients, put_over_divisors, undecided_beside
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.homogeneity import by_degree
from duhem.proof.kernel.pieces import chooses
from duhem.proof.kernel.region import where_it_has_a_value, where_loads_allow
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.semidefinite import only_at_zero_force
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, minus, number, parse, sum_of

__all__ = [
    "constraints", "flow", "formula", "formula_and_flow", "formula_and_potential", "formula_at_zero", "formula_but_at_tips",
    "formula_in_ranges", "formula_where_it_has_a_value", "formula_where_loads_allow", "limits", "nothing", "numbers", "numbers_in_formula",
]  # fmt: skip

_KIND = {"**": "a power, root or quotient", "log": "a logarithm", "asin": "an asin", "acos": "an acos", "tan": "a tan", "atan2": "an angle"}

# Under exp, sinh and cosh, and of exponents on numbers and on names, and a little more: max(64, 2) is not told from 64 by enclosures.
_MOST_GROWTH, _MOST_POWER, _MOST_POWER_OF_NAME = (Fraction(n) + Fraction(1, 2**20) for n in (700, 64, 1000))


def nothing(_: StatedLaw) -> str:
    """For a rule that speaks of no part of the law, or of what other claims have settled."""
    return ""


def numbers(text: str) -> str:
    """Each part of a formula that is a number, read or not: it has a value, and one of an ordinary size."""
    reader = Reader(over(StatedLaw(("x",), None, number(0), None, {}, ())))
    for part in parse(text).parts():
        if part.args and _is_number(part) and reader.undecided(part) is part:
            return _said("a number in the law", part)
        if any(_is_number(x) and reader.sign(x) & NEGATIVE for x in _below_its_limit(part)):
            return f"a number in the law is too large: {part.op} in it"
    return ""


def _is_number(term: Term) -> bool:
    return not term.names() - {"pi"}


def _below_its_limit(part: Term) -> Iterator[Term]:
    """What is >= 0 where a number under exp, sinh or cosh, or an exponent that is one, is not too large."""
    if part.op in ("exp", "sinh", "cosh"):
        sides, limit = (part.args[0], minus(part.args[0])), _MOST_GROWTH
        yield from (sum_of(number(limit), minus(x)) for x in sides[: 1 if part.op == "exp" else 2])
    if part.op == "**":
        limit = _MOST_POWER if _is_number(part.args[0]) else _MOST_POWER_OF_NAME
        yield from (sum_of(number(limit), x) for x in (part.args[1], minus(part.args[1])))


def constraints(law: Stated) -> str:
    """Each constraint, where the parameters lie in their ranges and the constraints hold that are shown to have a value before it."""
    left = [c for c in law.constraints if asks(c)]
    settled = tuple(c for c in law.constraints if c not in left)
    while left:
        reader = Reader(over(StatedLaw(law.forces, law.pressure, number(0), None, law.parameters, settled)))
        ready = {c: reader.undecided(c) for c in left}
        if not (new := tuple(c for c, undecided in ready.items() if undecided is None)):
            return _said("a constraint of the parameters", next(iter(ready.values())))
        left, settled = [c for c in left if c not in new], (*settled, *new)
    return ""


def formula(law: StatedLaw) -> str:
    """g, for all forces."""
    return _everywhere("g", (law.g,), over(law))


def formula_in_ranges(law: StatedLaw) -> str:
    """g, for all forces in their ranges."""
    return _everywhere("g", (law.g,), within_ranges(law))


def limits(law: StatedLaw) -> tuple[Term, ...]:
    """What g is at a tip, as its parts may be read, by continuity; none where it may have no value elsewhere."""
    if law.g.large:
        return ()
    if found := tuple(continued(law.g, over(law))):
        return found
    with suppress(NotWritten, ValueError):
        if found := tuple(_at_zero_force(law)):
            return found
    for spelled in (partial(in_quotients, divided_out=True), put_over_divisors):
        with suppress(NotWritten):
            form = spelled(law.g, over(law))
            if found := tuple(continued(law.g, over(law._replace(g=form)), form)):
                return found
    return ()


def _at_zero_force(law: StatedLaw) -> Iterator[Term]:
    """What g tends to there, if it has a value elsewhere: parts of degrees k > 0, being r^k times what is bounded, tend to 0."""
    beside = law.once(where_it_has_a_value)
    tips = all(strict and only_at_zero_force(tip, beside) for tip, strict in beside.sides.items())
    if not beside.sides or not tips or Reader(beside).undecided(law.g) is not None or chooses(law.g, beside):
        return
    parts = by_degree(law.g, beside)
    end = parts.pop(number(0), number(0))
    if beside.constant(end) and all(beside.facts(k).sign == POSITIVE for k in parts):
        yield end


def formula_but_at_tips(law: StatedLaw) -> str:
    """g, for all forces; at a tip by continuity."""
    found = law.once(formula)
    return "" if found and law.once(limits) else found


def formula_where_loads_allow(law: StatedLaw) -> str:
    """g, where the loads in it allow it to be <= 0; at a tip by continuity."""
    if not (found := law.once(formula_but_at_tips)) or law.g.large:
        return found
    _, others, inside = law.once(where_loads_allow)  # loads have values everywhere
    reader = Reader(inside)
    settled = (reader.undecided(part) is None or any(True for _ in continued(part, inside)) for part in others)
    return "" if all(settled) else found


def formula_where_it_has_a_value(law: StatedLaw) -> str:
    """The same, or g wherever it does not divide by 0: no other point is one of K as it is written, but K may end there."""
    found = law.once(formula_where_loads_allow)
    return "" if found and not law.g.large and Reader(law.once(where_it_has_a_value)).undecided(law.g) is None else found


def formula_at_zero(law: StatedLaw) -> str:
    """g at zero force; if that is a tip, by continuity."""
    found = _everywhere("g at zero force", (law.g.put({Term("name", name=f): number(0) for f in law.forces}),), over(law))
    return "" if found and law.once(limits) else found


def numbers_in_formula(law: StatedLaw) -> str:
    """What no force enters in g: the rest is read along every ray from zero force by who asks for this."""
    domain = over(law)
    reader = Reader(domain, lambda term: ANY if domain.constant(term) else 0)  # 0: no sign speaks against a value
    return _said("g", reader.undecided(law.g))


def flow(law: StatedLaw) -> str:
    """Every slip of the law's own, that of a surface where the others are <= 0; or every force where these are functions of the rates."""
    if not law.surfaces:
        return _everywhere("a force" if law.of_rates else "the flow", law.flow or (), within_ranges(law))
    places = ((face.flow or (), {minus(other): False for other in face.others}) for face in law.faces())
    said = (_everywhere("the flow", flow, within_ranges(law).where(sides)) for flow, sides in places)
    return next(filter(None, said), "")


def formula_and_flow(law: StatedLaw) -> str:
    """g, each of its surfaces and every slip, for all forces."""
    return law.once(formula_in_ranges) or law.once(flow)


def formula_and_potential(law: StatedLaw) -> str:
    """g, the potential, and its gradient but where a tip of the potential is 0: a slip there is a mean of gradients from around."""
    if law.potential is None:
        return law.once(formula_in_ranges)
    domain = within_ranges(law)
    found = law.once(formula_in_ranges) or _everywhere("the potential", (law.potential,), domain)
    return found or _said("the gradient", undecided_beside(law.flow or (), tips(law.potential, domain), domain))


def _everywhere(what: str, terms: Iterable[Term], domain: StatedDomain) -> str:
    reader = Reader(domain)
    return next((said for term in terms if (said := _said(what, reader.undecided(term)))), "")


def _said(what: str, undecided: Term | None) -> str:
    if undecided is None:
        return ""
    return f"{what} is not shown to have a value wherever it is read: {_KIND[undecided.op]} in it may have none"
