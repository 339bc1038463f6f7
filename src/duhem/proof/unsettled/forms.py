"""Other formulas with the same K: g <= 0 says the same of them wherever g has a value, within the ranges of the forces.

Each step is exact there: log(A) + log(B) <= h is A B <= exp(h), as the logarithm rises; a divisor > 0 may be multiplied with.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.identity import multiplied_out
from duhem.proof.kernel.polynomial import number_in
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, Term, factors, minus, number, product_of, sum_of
from duhem.proof.unsettled.limits import raised, split, times

__all__ = ["same_k"]

_MOST = 6  # forms of one g
_ZERO, _ONE = number(0), number(1)


def same_k(read: StatedLaw) -> list[Term]:
    """The forms of g, those made in the fewest steps first."""
    domain, found = within_ranges(read), [read.g]
    for g in found:
        for step in (_exponentiated, _multiplied):
            with suppress(*UNREADABLE):
                found += [form for form in step(g, domain) if form not in found and len(found) <= _MOST]
    return found[1:]


def _terms(g: Term) -> list[Term]:
    """What a sum adds up, with products of one sum that holds a logarithm multiplied out."""
    if g.op == "+":
        return [t for a in g.args for t in _terms(a) if t != _ZERO]
    every = factors(g)
    sums = [f for f in every if f.op == "+" and any(x.op == "log" for t in f.args for x in factors(t))]
    if len(sums) != 1 or len(every) == 1:
        return [g]
    rest = [f for f in every if f is not sums[0]]
    return [t for a in sums[0].args if a != _ZERO for t in _terms(product_of(*rest, a))]


def _parted(term: Term, domain: StatedDomain) -> tuple[Term, int, list[Term]]:
    """The size of the constant factor of a term, its sign, 0 where that is open, and the factors with forces."""
    constant = product_of(*(f for f in factors(term) if domain.constant(f)))
    sign = {POSITIVE: 1, NEGATIVE: -1}.get(domain.facts(constant).sign, 0)
    return constant if sign >= 0 else minus(constant), sign, [f for f in factors(term) if not domain.constant(f)]


def _over(term: Term, divisor: Term) -> Term:
    return product_of(term, Term("**", (divisor, number(-1))))


def _exponentiated(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """Logarithms gathered into one, over the constant before all of them if that is no number, and both sides put into exp."""
    sides: dict[int, list[Term]] = {1: [], -1: []}
    rest, divisors = list[Term](), set[Term]()
    for term in _terms(g):
        size, sign, moving = _parted(term, domain)
        if len(moving) != 1 or moving[0].op != "log" or not sign or domain.facts(moving[0].args[0]).sign & NEGATIVE:
            rest.append(term)
            continue
        times_ = number_in(domain.polynomial(size))
        divisors.add(_ONE if times_ is not None else multiplied_out(size, domain))
        sides[sign].append(raised(moving[0].args[0], number(times_ or 1)))
    if len(divisors) == 1:
        left = [_over(term, *divisors) for term in rest]
        still, moving = ([t for t in left if domain.constant(t) is own] for own in (True, False))
        one = product_of(*sides[1], *([Term("exp", (sum_of(*moving),))] if moving else []))
        yield sum_of(one, minus(product_of(*sides[-1], *([Term("exp", (sum_of(*map(minus, still)),))] if still else []))))


def _multiplied(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """Times what it divides by, where that is > 0, or an even power; without the powers of a force >= 0 that all terms then have."""
    for part in g.parts():
        if part.op != "**" or (e := number_in(domain.polynomial(part.args[1]))) is None or e >= 0 or domain.constant(part.args[0]):
            continue
        base, even = part.args[0], e.denominator == 1 and e % 2 == 0
        if over(domain.law).facts(base).sign != POSITIVE and (even or not domain.facts(base).sign & NEGATIVE):
            form = times(g, base, number(-e))
            for x in (Term("name", name=f) for f in domain.law.forces if not domain.facts(Term("name", name=f)).sign & NEGATIVE):
                parted = [split(t, x) for t in _terms(form)]
                if (least := min(-e * split(base, x)[1], *(own for _, own in parted))) > 0:  # where x = 0, g has no value then
                    powers = ((rest, own - least) for rest, own in parted)
                    form = sum_of(*(product_of(*rest, *([raised(x, number(n))] if n else [])) for rest, n in powers))
            if part not in form.parts():
                yield form
