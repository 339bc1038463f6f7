"""Other formulas with the same K: g <= 0 says the same of them wherever g has a value, within the ranges of the forces.

Each step is exact there: log(A) + log(B) <= h is A B <= exp(h), as the logarithm rises; R <= c X**e is R**(1/e) <= c**(1/e) X where
R >= 0; a divisor > 0 may be multiplied with; log(c/X) is -log(X/c); a choice at x = k of what is the same there is a sum.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.identity import multiplied_out, vanishes
from duhem.proof.kernel.polynomial import number_in
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, Term, factors, minus, number, product_of, sum_of
from duhem.proof.unsettled.limits import split, times

__all__ = ["same_k"]

_MOST = 6  # forms of one g
_ZERO, _ONE = number(0), number(1)


def same_k(read: StatedLaw) -> list[Term]:
    """The forms of g, those made in the fewest steps first."""
    domain, found = within_ranges(read), [read.g]
    for g in found:
        for step in (_summed, _turned, _exponentiated, _cleared, _multiplied):
            with suppress(*UNREADABLE):
                found += [form for form in step(g, domain) if form not in found and len(found) <= _MOST]
    return found[1:]


def _terms(g: Term) -> list[Term]:
    """What a sum adds up, with products of sums that hold a logarithm multiplied out."""
    if g.op == "+":
        return [t for a in g.args for t in _terms(a) if t != _ZERO]
    sums = [f for f in factors(g) if f.op == "+" and any(t.op in ("log", "*") and _logs(t) for t in f.args)]
    if g.op != "*" or len(sums) != 1:
        return [g]
    rest = [f for f in factors(g) if f is not sums[0]]
    return [t for a in sums[0].args if a != _ZERO for t in _terms(product_of(*rest, a) if a != _ONE else product_of(*rest))]


def _logs(term: Term) -> list[Term]:
    return [f for f in factors(term) if f.op == "log"]


def _parted(term: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """The constant factor of a term, and its factors with forces."""
    every = factors(term)
    own = [f for f in every if domain.constant(f)]
    return (own[0] if len(own) == 1 else product_of(*own) if own else _ONE), [f for f in every if not domain.constant(f)]


def _to(base: Term, power: Term) -> Term:
    return base if power == _ONE or base == _ONE else Term("**", (base, power))


def _over(term: Term, divisor: Term) -> Term:
    """A term divided by a constant."""
    return term if divisor == _ONE else product_of(term, Term("**", (divisor, number(-1))))


def _size(constant: Term, domain: StatedDomain) -> tuple[Term, int]:
    """|c| and the sign of a constant that has one."""
    sign = domain.facts(constant).sign
    if sign not in (NEGATIVE, POSITIVE):
        return constant, 0
    if sign == POSITIVE:
        return constant, 1
    own = [f for f in factors(constant) if f.op != "number"]
    value = Fraction(1)
    for f in factors(constant):
        value *= f.value if f.op == "number" else 1
    if not own:
        return number(-value), -1
    return (own[0] if value == -1 and len(own) == 1 else product_of(number(-value), *own)), -1


def _turned(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """With -log(X/c) for log(c/X), and every logarithm in a term of its own."""
    swap = dict[Term, Term]()
    for part in g.parts():
        constant, moving = _parted(part.args[0], domain) if part.op == "log" else (_ONE, [])
        if moving and all(f.op == "**" and f.args[1].op == "number" and f.args[1].value < 0 for f in moving):
            above = [_to(f.args[0], number(-f.args[1].value)) for f in moving]
            swap[part] = minus(Term("log", (_over(product_of(*above) if above[1:] else above[0], constant),)))
    terms = _terms(g.put(swap))
    if swap:
        yield sum_of(*terms)


def _exponentiated(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """Logarithms gathered into one, and both sides put into exp."""
    logs, rest, divisor = list[tuple[Fraction, Term]](), list[Term](), _ONE
    terms = _terms(g)
    for term in terms:
        constant, moving = _parted(term, domain)
        if len(moving) != 1 or moving[0].op != "log" or domain.facts(moving[0].args[0]).sign & NEGATIVE:
            rest.append(term)
            continue
        size, sign = _size(constant, domain)
        plain = size.op == "number"
        if not sign or (logs and not plain and size != divisor):
            return
        divisor = divisor if plain else size
        logs.append((sign * (size.value if plain else Fraction(1)), moving[0].args[0]))
    if not logs or (divisor != _ONE and any(abs(c) != 1 for c, _ in logs)):
        return
    left = [_over(term, divisor) for term in rest]
    above, below = ([_to(x, number(abs(c))) for c, x in logs if (c > 0) is own] for own in (True, False))
    still, others = ([t for t in left if domain.constant(t) is own] for own in (True, False))
    one = product_of(*above, *([Term("exp", (sum_of(*others),))] if others else []))
    two = product_of(*below, *([Term("exp", (sum_of(*map(_negative, still)),))] if still else []))
    yield sum_of(one, minus(two))


def _negative(term: Term) -> Term:
    first, *rest = factors(term)
    if first == number(1) and rest:
        return _negative(product_of(*rest) if rest[1:] else rest[0])
    return (product_of(*rest) if rest[1:] else rest[0]) if first == number(-1) and rest else minus(term)


def _cleared(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """Without a root or power: R**(1/e) - c**(1/e) X for R - c X**e where R >= 0."""
    terms = _terms(g)
    for i, term in enumerate(terms):
        constant, moving = _parted(term, domain)
        if len(moving) != 1 or moving[0].op != "**" or not domain.constant(moving[0].args[1]):
            continue
        (inner, e), (size, sign) = moving[0].args, _size(constant, domain)
        exponent = number_in(domain.polynomial(e))
        if domain.facts(e).sign != POSITIVE or sign != -1 or (exponent is not None and exponent >= 1):
            continue
        rest = [t for j, t in enumerate(terms) if j != i]
        whole = sum_of(*rest) if rest[1:] else rest[0] if rest else _ZERO
        if rest and domain.never_negative(whole):
            inverse = Term("**", (e, number(-1))) if exponent is None else number(1 / exponent)
            yield sum_of(_to(whole, inverse), minus(product_of(_to(size, inverse), inner)))


def _multiplied(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """Times what it divides by, where that is > 0, or an even power; without what then is a factor of every term."""
    for part in g.parts():
        if part.op != "**" or (e := number_in(domain.polynomial(part.args[1]))) is None or e >= 0 or domain.constant(part.args[0]):
            continue
        base = part.args[0]
        even = e.denominator == 1 and e % 2 == 0
        if over(domain.law).facts(base).sign != POSITIVE and (even or not domain.facts(base).sign & NEGATIVE):
            form = times(g, base, number(-e))
            if part not in form.parts():
                yield _divided(form, domain)


def _divided(g: Term, domain: StatedDomain) -> Term:
    """Without the powers of forces >= 0 by which every term can be divided."""
    for x in (Term("name", name=f) for f in domain.law.forces):
        parted = [split(t, x) for t in _terms(g)]
        if (least := min((own for _, own in parted), default=Fraction(0))) > 0 and not domain.facts(x).sign & NEGATIVE:
            g = sum_of(*(product_of(*rest, *([_to(x, number(own - least))] if own != least else [])) for rest, own in parted))
    return g


def _summed(g: Term, domain: StatedDomain) -> Iterator[Term]:
    """Without a choice at x = k of two that are the same there: A at the smaller of x and k, and B at the larger, but for A at k."""
    for part in g.parts():
        if part.op != "where" or len(part.args[0].args) != 2:
            continue
        (x, k), (low, high) = part.args[0].args, part.args[1:]
        if part.args[0].op in (">", ">="):
            low, high = high, low
        if x.op != "name" or domain.constant(x) or not domain.constant(k):
            continue
        if vanishes(sum_of(low.put({x: k}), minus(high.put({x: k}))), domain):
            gap = x if k == _ZERO else sum_of(x, minus(k))
            sides = ((low, minus(Term("neg", (gap,)))), (high, Term("pos", (gap,))))
            moving = [side.put(_shifted(side, x, k, end)) for side, end in sides if x.name in side.names()]
            whole = moving[0] if len(moving) == 1 else sum_of(*moving, minus(multiplied_out(low.put({x: k}), domain)))
            yield g.put({part: whole})


def _shifted(side: Term, x: Term, k: Term, end: Term) -> dict[Term, Term]:
    """What to put for x - k, and for x."""
    swap = {x: end if k == _ZERO else sum_of(k, end)}
    gaps = (p for p in side.parts() if p.op == "+" and len([a for a in p.args if a != _ZERO]) == 2 and x in p.args)
    return swap | {p: end for p in gaps if k != _ZERO and any(a in (minus(k), product_of(number(-1), k)) for a in p.args)}
