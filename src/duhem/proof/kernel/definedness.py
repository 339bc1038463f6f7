"""Whether a formula has a value wherever it is read: decided from its innermost parts outward, before any rule reads it.

The one list of what asks for more than the values of its parts: a divisor is not 0, what is under a root or a power that is not
whole is >= 0, under a logarithm > 0, an asin or acos is of what lies in [-1, 1], a tan of what lies between its poles, an angle
is not of (0, 0).  A part is asked for its sign only after all of its own parts are shown to have a value, so that nothing is
multiplied out, and nothing cancels, of which that is not known: sqrt(x) - sqrt(x) has no value where x < 0.

Of a choice the condition is read always, and each value where the condition sends one to it: the other value is read under the
guard that the condition does not hold.  A condition on constants is a constraint there, one on forces a side of the domain.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, StatedLaw, gap
from duhem.proof.kernel.loads import by_forces
from duhem.proof.kernel.pieces import below
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.shape import Shown
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["AGAINST", "Reader", "asks", "has_value"]

AGAINST = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}  # what holds where a comparison does not
_PARTIAL = ("**", "log", "asin", "acos", "tan", "atan2")
_ONE, _NEAR_RIGHT = number(1), number(Fraction(3, 2))  # an angle below pi/2


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
            return not any(sign(sum_of(_NEAR_RIGHT, x)) & NEGATIVE for x in (*term.args, minus(term.args[0])))
        case "atan2":
            return any(not sign(x) & ZERO for x in term.args)
    return True


def _raised(base: Term, exponent: Term, sign: Callable[[Term], Sign], domain: StatedDomain) -> bool:
    """Whether a power has a value; what is raised to 0 is 1."""
    poly = domain.polynomial(exponent)
    p = None if set(poly) - {()} else poly.get((), 0)
    if p is not None and p.denominator == 1:
        return p >= 0 or not sign(base) & ZERO
    known = sign(base)
    return not known & (NEGATIVE | ZERO) or (not known & NEGATIVE and (p > 0 if p is not None else sign(exponent) == POSITIVE))


class Reader(NamedTuple):
    """Reads formulas over a ``domain``; ``more`` are signs that hold there beside those that are ``shown``."""

    domain: StatedDomain
    shown: Shown
    over: Callable[[StatedLaw], StatedDomain]
    more: Callable[[Term], Sign] = lambda _: ANY

    def undecided(self, term: Term) -> Term | None:
        """An innermost part that is not shown to have a value; None where the whole formula has one."""
        known: dict[Term, Term | None] = self.domain.kept.setdefault("undecided", {})
        if term not in known:
            known[term] = self._undecided(term) if asks(term) else None
        return known[term]

    def _undecided(self, term: Term) -> Term | None:
        if term.op == "where":
            condition, one, two = term.args
            if (found := self.undecided(condition)) is not None:
                return found
            branches = ((one, True), (two, False))
            return next((x for a, holds in branches if asks(a) and (x := self._under(condition, holds, a)) is not None), None)
        if (found := next((x for a in term.args if (x := self.undecided(a)) is not None), None)) is not None:
            return found
        try:
            return None if has_value(term, self.sign, self.domain) else term
        except NotWritten:  # there is too much to multiply out
            return term

    def sign(self, term: Term) -> Sign:
        """The signs that a formula may have, all of whose parts have values."""
        known = self.shown(term, self.domain).sign
        return known if known in (NEGATIVE, ZERO, POSITIVE) else known & self.more(term)

    def _under(self, condition: Term, holds: bool, term: Term) -> Term | None:
        """What is undecided of a formula that is read where a condition holds, or does not."""
        if (holding := self.domain.decided(condition)) is not None:
            return self.undecided(term) if holding is holds else None
        guarded: dict[tuple[Term, bool], Reader] = self.domain.kept.setdefault("guarded", {})
        if (condition, holds) not in guarded:
            guarded[condition, holds] = self._guarded(condition, holds)
        return guarded[condition, holds].undecided(term)

    def _guarded(self, condition: Term, holds: bool) -> Reader:
        law, sides = self.domain.law, dict(self.domain.sides)
        if self.domain.constant(condition):
            own = condition if holds else Term(AGAINST[condition.op], condition.args)
            law = law._replace(constraints=(*law.constraints, own))
        else:
            against = Term(AGAINST[condition.op], condition.args)
            own, other = (condition, against) if holds else (against, condition)
            own_sides = (gap(own), *map(minus, below(gap(other))))
            sides |= dict.fromkeys((*own_sides, *map(self._without_what_is_below_zero, own_sides)), len(own.op) == 1)
        try:
            inner = self.over(law)
        except NotWritten:  # it never holds, or is too long: more is asked than need be
            inner = self.over(self.domain.law)
        inner.sides |= sides
        return self._replace(domain=inner)

    def _without_what_is_below_zero(self, side: Term) -> Term:
        """What is no less than a formula: its terms that may be > 0."""
        parts = by_forces(self.domain.polynomial(side), self.domain).items()
        terms = (product_of(written(c), written({moving: Fraction(1)})) for moving, c in parts)
        return sum_of(*(term for term in terms if self.sign(term) & POSITIVE))


def asks(term: Term) -> bool:
    """Whether some part asks for more than the values of its own parts."""
    if term.op == "**" and term.args[1].op == "number" and term.args[1].value >= 0 and term.args[1].value.denominator == 1:
        return asks(term.args[0])
    return term.op in _PARTIAL or any(map(asks, term.args))
