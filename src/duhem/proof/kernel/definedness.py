"""Whether a formula has a value wherever it is read: decided from its innermost parts outward, before any rule reads it.

The one list of what asks for more than the values of its parts: a divisor is not 0, what is under a root or a power that is not
whole is >= 0, under a logarithm > 0, an asin or acos is of what lies in [-1, 1], a tan of what has a cosine that is not 0, an angle
is not of (0, 0).  A part is asked for its sign only after all of its own parts are shown to have a value, so that nothing is
multiplied out, and nothing cancels, of which that is not known: sqrt(x) - sqrt(x) has no value where x < 0.

Of a choice the condition is read always, and each value where the condition sends one to it: the other value is read under the
guard that the condition does not hold.  A condition on constants is a constraint there, one on forces a side of the domain.

The one theorem on limits: where a formula has no value at a tip, and what it is there by continuity.  A tip is where a form that is >= 0
is 0, on a set without an inside: J2 of a tensor that the forces may be, which is 0 on an axis.  Let a formula g have a value wherever the
tip is not 0, every obligation being decided there, and let each part of g that has none on the axis stand in a function rho^k f, k > 0,
rho = sqrt(J2), f bounded: it tends to 0 there.  Then g, with 0 for these functions, which must have a value on the axis too, is what g
extends to, continuously.  Nothing else that divides 0 by 0 is given a value.  K is the set where g, so extended, is <= 0.  The same is
read of g with what is divided by the same added up over it, N/P for the terms of N each over P: that is g wherever g has a value.  For
N = q P + R, R not 0, it is q + R/P there: where g has a value wherever the tip is not 0, it has the limits of that at the tip.  A quotient
with N = 0 or R = 0 is left as it was.  The normal form of all of g is read so too where no part is gone that may have no limit.

So it is of zero force where g has a value everywhere else and parts G_k of degree k >= 0 in the forces, G_0 a constant: as G_k is r^k
times what is bounded, being continuous, g tends to G_0 there.  At zero force alone a gauge A <= B of :mod:`plane_gauge` may have no
value: A tends to 0 there and B is of less degree.  K holds 0 then.
The slip of a law's own, having no value where a tip of g is 0, is there any mean of its limits from around (Koiter 1953): it is asked
for a value where the tip is > 0 alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from duhem.proof.kernel.deviatoric import deviatoric_readers, sign_in_deviator
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, gap
from duhem.proof.kernel.forms import by_forces, place_of
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.pieces import below
from duhem.proof.kernel.polynomial import added, divided, number_in, scaled, written
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, minus, number, product_of, sum_of

__all__ = [
    "AGAINST", "Reader", "asks", "continued", "divides_by_zero_force", "flat_on_axis", "has_value", "in_quotients", "put_over_divisors",
    "rarely_zero", "sign_on_axis", "undecided_beside",
]  # fmt: skip

AGAINST = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}  # what holds where a comparison does not
_PARTIAL = ("**", "log", "asin", "acos", "tan", "atan2")
_SETTLED = (NEGATIVE, ZERO, POSITIVE)
_ONE = number(1)
_MOST_QUOTIENTS = 50
_CONDITIONS = (*COMPARISONS, "and", "or")


def has_value(term: Term, sign: Callable[[Term], Sign], domain: StatedDomain) -> bool:
    """Whether a term has a value wherever its parts have, by the signs of these."""
    match term.op:
        case "**":
            return _raised(term.args[0], term.args[1], sign, domain)
        case "log":
            return not sign(term.args[0]) & (NEGATIVE | ZERO)
        case "asin" | "acos":
            return not any(sign(sum_of(_ONE, x)) & NEGATIVE for x in (*term.args, minus(term.args[0])))
        case "tan":
            return not sign(Term("cos", term.args)) & ZERO
        case "atan2":
            return any(not sign(x) & ZERO for x in term.args)
    return True


def _raised(base: Term, exponent: Term, sign: Callable[[Term], Sign], domain: StatedDomain) -> bool:
    """Whether a power has a value; what is raised to 0 is 1."""
    p = number_in(domain.polynomial(exponent))
    if p is not None and p.denominator == 1:
        return p >= 0 or not sign(base) & ZERO
    known = sign(base)
    # an exponent that varies and may be 0 makes it jump from 0 to 1
    risen = p > 0 if p is not None else sign(exponent) == POSITIVE or (domain.constant(exponent) and not sign(exponent) & NEGATIVE)
    return not known & (NEGATIVE | ZERO) or (not known & NEGATIVE and risen)


def _nothing(_: Term) -> Sign:
    return ANY


class Reader(NamedTuple):
    """Reads formulas over a ``domain``; ``more`` are signs that hold there beside those that it shows."""

    domain: StatedDomain
    more: Callable[[Term], Sign] = _nothing

    def undecided(self, term: Term) -> Term | None:
        """An innermost part that is not shown to have a value; None where the whole formula has one."""
        known: dict[object, Term | None] = self.domain.kept.setdefault("undecided", {})
        if (term, self.more) not in known:
            known[term, self.more] = self._undecided(term) if self._asks(term) else None
        return known[term, self.more]

    def _undecided(self, term: Term) -> Term | None:
        if term.op == "where":
            condition, one, two = term.args
            if (found := self.undecided(condition)) is not None:
                return found
            branches = ((one, True), (two, False))
            return next((x for a, holds in branches if self._asks(a) and (x := self._under(condition, holds, a)) is not None), None)
        if (found := next((x for a in term.args if (x := self.undecided(a)) is not None), None)) is not None:
            return found
        try:
            shown = (has_value(term, sign, self.domain) for sign in (self._sign_as_written, self.sign))
            return None if any(shown) else term
        except NotWritten:  # there is too much to multiply out
            return term

    def _asks(self, term: Term) -> bool:
        return asks(term, self.domain.kept.setdefault("asks", {}))

    def _sign_as_written(self, term: Term) -> Sign:
        known = self.domain.sign(term)
        return known if known in _SETTLED else known & self.more(term)

    def sign(self, term: Term) -> Sign:
        """The signs that a formula may have, all of whose parts have values: so its normal forms have its value."""
        known = self._sign_as_written(term)
        for collects in () if known in _SETTLED or self.domain.constant(term) else (False, True):
            with suppress(NotWritten):
                form = normal(term, self.domain, collects)
                for told in (self.domain.sign, self.more):
                    known = known if known in _SETTLED else known & told(form)
        return known if known in _SETTLED or self.domain.constant(term) else known & sign_in_deviator(term, self.domain)

    def _under(self, condition: Term, holds: bool, term: Term) -> Term | None:
        """What is undecided of a formula that is read where a condition holds, or does not."""
        if (holding := self.domain.decided(condition)) is not None:
            return self.undecided(term) if holding is holds else None
        guarded: dict[object, Reader] = self.domain.kept.setdefault("guarded", {})
        if (condition, holds, self.more) not in guarded:
            guarded[condition, holds, self.more] = self._guarded(condition, holds)
        return guarded[condition, holds, self.more].undecided(term)

    def _guarded(self, condition: Term, holds: bool) -> Reader:
        against = Term(AGAINST[condition.op], condition.args)
        own, other = (condition, against) if holds else (against, condition)
        if not self.domain.constant(condition):
            sides = (gap(own), *map(minus, below(gap(other))))
            sides, strict = (*sides, *map(self._without_what_is_below_zero, sides)), len(own.op) == 1
            readers = ((reader, x) for x in sides if strict and self.more is _nothing for reader in deviatoric_readers(x, self.domain))
            more = next((reader.sign for reader, x in readers if reader.tells(x)), self.more)
            return self._replace(domain=self.domain.where(dict.fromkeys(sides, strict)), more=more)
        law, inner = self.domain.law, self.domain.where({})
        with suppress(NotWritten):  # it never holds, or is too long: more is asked than need be
            inner = self.domain.over(law._replace(constraints=(*law.constraints, own))).where(self.domain.sides)
        return self._replace(domain=inner)

    def _without_what_is_below_zero(self, side: Term) -> Term:
        """What is no less than a formula: its terms that may be > 0."""
        parts = by_forces(self.domain.polynomial(side), self.domain).items()
        terms = (product_of(written(c), written({moving: Fraction(1)})) for moving, c in parts)
        return sum_of(*(term for term in terms if self.sign(term) & POSITIVE))


def asks(term: Term, known: dict[Term, bool] | None = None) -> bool:
    """Whether some part asks for more than the values of its own parts; ``known`` keeps what was found."""
    known = {} if known is None else known
    if term not in known:
        n = term.args[1] if term.op == "**" else term
        whole = n.op == "number" and n.value >= 0 and n.value.denominator == 1
        known[term] = (term.op in _PARTIAL and not whole) or any(asks(a, known) for a in term.args)
    return known[term]


# -- limits --------------------------------------------------------------------------------------------------------------


def continued(term: Term, domain: StatedDomain, form: Term | None = None) -> Iterator[Term]:
    """What a formula is where J2 = 0, as its parts may be read, by continuity, if it has a value everywhere else where it is read.

    What is read is a ``form`` of it with the same value there, if one is given.
    """
    form = form or term
    for reader in deviatoric_readers(form, domain):
        with suppress(NotWritten):
            tip, there = written(reader.second), reader.emptied(form)
            beside = Reader(domain.where({tip: True}), reader.sign)
            settled = all(beside.undecided(x) is None for x in (term, form)) and Reader(domain).undecided(there) is None
            if settled and rarely_zero(tip, domain):
                yield there


def put_over_divisors(term: Term, domain: StatedDomain) -> Term:
    """The normal form, with q + R/P for (q P + R)/P; NotWritten where something is gone that may have no limit, as 1/P is for R = 0."""
    form = normal(term, domain)
    if any(not _without_limit(normal(x, domain), domain) <= _without_limit(form, domain) for x in _without_limit(term, domain)):
        raise NotWritten("what has no limit is multiplied by 0")
    return form


def _without_limit(term: Term, domain: StatedDomain) -> set[Term]:
    """The parts that forces enter and that may have no limit where they have no value; a root has one."""
    parts = (x for x in term.parts() if x.op in _PARTIAL and not domain.constant(x))
    return {x for x in parts if x.op != "**" or domain.facts(x.args[1]).sign != POSITIVE}


def in_quotients(term: Term, domain: StatedDomain, divided_out: bool = False) -> Term:
    """The term with its largest parts that have a value everywhere in normal form, and what is divided by the same as one quotient.

    It has a value where the term has one, and the same; a quotient that then is 0 stays as it was.  With what it divides by
    ``divided_out``, q + R/P for (q P + R)/P, it may have one in more places; a quotient that then has one everywhere stays as it was.
    """
    parts = list[Term]()
    for divisors, values in _quotients(term, domain, divided_out).items():
        under = tuple((x, 1) for x in divisors)
        asked = [(value, Reader(domain).undecided(value) is None) for value in values]
        whole = added([value for value, has_one in asked if has_one])
        if domain.polynomial(whole):
            values = [normal(whole, domain), *(value for value, has_one in asked if not has_one)]
            with suppress(NotWritten):  # what is too long stays as it was
                left = normal(scaled(values[0], under), domain)
                if divided_out and Reader(domain).undecided(left) is not None:
                    parts, values = [*parts, left], values[1:]
        parts += [scaled(value, under) for value in values]
    return added(parts)


def _quotients(term: Term, domain: StatedDomain, divided_out: bool) -> dict[tuple[Term, ...], list[Term]]:
    """What a term adds up, by what each is divided by."""
    found = dict[tuple[Term, ...], list[Term]]()
    if Reader(domain).undecided(term) is None:
        found[()] = [term]
    elif term.op == "+":
        for a in term.args:
            for divisors, values in _quotients(a, domain, divided_out).items():
                found.setdefault(divisors, []).extend(values)
    elif term.op == "*":
        found[()] = [number(1)]
        for a in term.args:
            pairs = product(found.items(), _quotients(a, domain, divided_out).items())
            found = {}
            for (below_one, ones), (below_two, twos) in pairs:
                key = tuple(sorted((*below_one, *below_two)))
                found.setdefault(key, []).append(scaled(added(ones), ((added(twos), 1),)))
            if len(found) > _MOST_QUOTIENTS:
                raise NotWritten("there are too many quotients")
    elif term.op == "**" and Reader(domain).undecided(term.args[0]) is None and domain.facts(term.args[1]).sign == NEGATIVE:
        base, p = normal(term.args[0], domain), number_in(domain.polynomial(term.args[1]))
        poly, lead = domain.polynomial(base), Fraction(1)
        if poly and p is not None and p.denominator == 1:
            lead = abs(poly[min(poly)]) * (1 if domain.facts(base).sign & POSITIVE else -1)
            base = normal(written(divided(poly, (), lead)), domain)
        found[(Term("**", (base, term.args[1])),)] = [number(lead ** int(p or 0))]
    else:
        args = (a if a.op in _CONDITIONS else in_quotients(a, domain, divided_out) for a in term.args)
        found[()] = [term._replace(args=tuple(args))]
    return found


def undecided_beside(terms: Iterable[Term], tips: Iterable[Term], domain: StatedDomain) -> Term | None:
    """A part of formulas that is not shown to have a value where no tip is 0."""
    tips = (tip for tip in tips if domain.facts(tip).nonnegative and rarely_zero(tip, domain))
    reader = Reader(domain.where(dict.fromkeys(tips, True)))
    return next((x for term in terms if (x := reader.undecided(term)) is not None), None)


def sign_on_axis(g: Term, tip: Term, domain: StatedDomain) -> Sign:
    """Where ``tip`` is 0 only where J2 = 0, and g, by continuity, is a constant there: its sign; else any."""
    for reader in deviatoric_readers(g, domain):
        size, there = reader.value(tip), reader.emptied(g)
        if size is None or not domain.constant(there) or not reader.above(size.poly, strict=True):
            continue
        value = domain.facts(there)
        if value.defined:
            return value.sign
    return ANY


def flat_on_axis(term: Term, tips: Iterable[Term], domain: StatedDomain) -> bool:
    """Whether a term is rho^k h, k > 1, h of the direction of the deviator alone, and each of the ``tips`` is > 0 but where J2 = 0."""
    readers = (reader for reader in deviatoric_readers(term, domain) if (reader.degree(term) or 0) > 1)
    return any(all(reader.sign(tip) == POSITIVE for tip in tips) for reader in readers)


def divides_by_zero_force(g: Term, domain: StatedDomain) -> bool:
    """Whether a formula divides by 0 at zero force, wherever it stands."""

    def divides(term: Term) -> bool:
        if term.op == "**" and domain.facts(term.args[1]).sign == NEGATIVE and domain.facts(term.args[0]).sign == ZERO:
            return True
        return term.op != "where" and any(map(divides, term.args))

    return divides(g.put(place_of({}, domain)))


def rarely_zero(tip: Term, domain: StatedDomain) -> bool:
    """Whether it is 0 on no open set: a polynomial in the forces with a coefficient that is never 0; |.|, a norm, or a power > 0, of such a
    part, or a sum of parts >= 0 with one.
    """
    parts = by_forces(domain.polynomial(tip), domain)
    if all(x.op == "name" for moving in parts for x, _ in moving):
        return any(not domain.facts(written(c)).sign & ZERO for c in parts.values())
    powers = tip.op == "**" and domain.facts(tip.args[1]).sign == POSITIVE
    parted = tip.op in ("abs", "norm") or (tip.op == "+" and all(domain.facts(a).nonnegative for a in tip.args))
    return any(rarely_zero(a, domain) for a in (tip.args[:1] if powers else tip.args if parted else ()))
