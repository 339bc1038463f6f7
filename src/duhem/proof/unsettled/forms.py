"""Other forms of g with the same K, of which the rules may read more.

A root by itself on one side: x <= c u^e, with c > 0 and 0 < e < 1, says the same as (pos(x)/c)^(1/e) <= u, for u >= 0 where u^e has a
value.  Divided by a factor > 0 of one of its terms a sum keeps its sign.
A product of two cosh is a sum of two, a product of exponentials one, and x log u is c u log u + d log u for x = c u + d: these have the
value that they had.
Of the others it depends on the law whether K stays the same, which is looked at in floats: the root for a power e > 1 by itself; a
division by what may have any sign; powers put together, which may have a value
where their factors have none; a product with a choice by a sign as one term for each side; one formula of a choice without its condition.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction

from duhem.proof.kernel.curvature import within_ranges
from duhem.proof.kernel.deviatoric import deviatoric_readers
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain, gap
from duhem.proof.kernel.forms import degree_at_most, share_and_rest
from duhem.proof.kernel.polynomial import added, scaled
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, factors, minus, number, product_of, sum_of
from duhem.proof.unsettled.limits import short, split, times

__all__ = ["equal_forms", "other_forms"]

_ZERO, _ONE = number(0), number(1)


def other_forms(read: StatedLaw) -> Iterator[tuple[Term, Term, bool]]:
    """A part of g, what to write for it, and whether K is known to stay the same then; else it is to be looked at."""
    g, domain = read.g, within_ranges(read)
    for part in g.args if g.op == "max" else (g,):
        with suppress(NotWritten):
            yield from ((part, new, known) for way in (_root_alone, _divided) for new, known in way(part, domain))
    for part in g.parts():
        with suppress(NotWritten):
            if part.op == "*":
                yield from ((part, new, False) for new in (*_without_brackets(part, domain), *_by_sides(part, domain)))
            if part.op == "where" and not domain.constant(part):
                yield from ((part, new, False) for new in _without_condition(part))


def equal_forms(term: Term, domain: StatedDomain) -> Iterator[tuple[Term, Term]]:
    """A product in a formula, and a sum or product that has its value wherever it has one; a sum with a size, and one without."""
    with suppress(NotWritten):
        yield from ((term, new) for new in _of_both_signs(term, domain))
    for part in (part for part in term.parts() if part.op == "*"):
        with suppress(NotWritten):
            yield from ((part, new) for new in _equal(factors(part), domain))


def _equal(own: list[Term], domain: StatedDomain) -> Iterator[Term]:
    """cosh a cosh b as (cosh(a + b) + cosh(a - b))/2, exp a exp b as exp(a + b), (c u + d) log u as c u log u + d log u."""
    for word in ("cosh", "exp"):
        if len(two := [f for f in own if f.op == word and not domain.constant(f)][:2]) == 2:
            a, b = (f.args[0] for f in two)
            both = [Term(word, (added([a, other]),)) for other in ((b, minus(b)) if word == "cosh" else (b,))]
            half = [number(Fraction(1, 2))] if word == "cosh" else []
            yield _times(*half, *(f for f in own if f not in two), added(both))
    for log in (f for f in own if f.op == "log" and not domain.constant(f)):
        x, fixed = ([f for f in own if f is not log and domain.constant(f) is still] for still in (False, True))
        u = log.args[0]
        if len(x) == 1 and (split := share_and_rest(domain.polynomial(x[0]), domain.polynomial(u), domain)) and split[1]:
            c, d = (added([scaled(number(k), m) for m, k in sorted(poly.items())]) for poly in split)
            yield _times(*fixed, added([_times(c, u, log), _times(d, log)]))


def _of_both_signs(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """x + c abs(y) with c >= 0 as max(x + c y, x - c y), where abs(y) is not shown to be convex."""
    for part in term.args if term.op == "+" else ():
        fixed, moving = ([f for f in factors(part) if domain.constant(f) is still] for still in (True, False))
        if [f.op for f in moving] == ["abs"] and not domain.facts(moving[0]).convex and not domain.facts(_times(*fixed)).sign & NEGATIVE:
            (y,) = moving[0].args
            yield Term(
                "max", tuple(term._replace(args=tuple(_times(*fixed, x) if a is part else a for a in term.args)) for x in (y, minus(y)))
            )


def _root_alone(part: Term, domain: StatedDomain) -> Iterator[tuple[Term, bool]]:
    """Of x - c u^e the form (pos(x)/c)^(1/e) - u, and whether K is known to stay: u^1 has a value for u < 0 too."""
    for term in part.args if part.op == "+" else ():
        moving = [f for f in factors(term) if not domain.constant(f)]
        c = minus(product_of(*(f for f in factors(term) if domain.constant(f))))
        if len(moving) != 1 or moving[0].op != "**" or domain.facts(c).sign != POSITIVE:
            continue
        u, e = moving[0].args
        x = sum_of(*(other for other in part.args if other is not term and other != _ZERO))
        if domain.constant(x) or not domain.constant(e) or domain.facts(e).sign != POSITIVE or e == _ONE:
            continue
        negative, below_one = domain.facts(x).sign & NEGATIVE, domain.facts(sum_of(_ONE, minus(e))).sign
        size = Term("pos", (x,)) if negative else x
        power = number(1 / e.value) if e.op == "number" else Term("**", (e, number(-1)))
        known = below_one == POSITIVE or not (negative or below_one & NEGATIVE)
        yield sum_of(Term("**", (_times(short(Term("**", (c, number(-1)))), size), power)), minus(u)), known


def _divided(part: Term, domain: StatedDomain) -> Iterator[tuple[Term, bool]]:
    """A sum divided by a factor of one of its terms, and whether that is known to be > 0, so that K stays."""
    for f in dict.fromkeys(x for a in part.args for x in factors(a) if x.op != "name") if part.op == "+" else ():
        base, power = f.args if f.op == "**" else (f, _ONE)
        # where J2 = 0 such a factor has no value, unless a choice gives it one
        beside = {r.sign(f) for r in deviatoric_readers(f, domain) if r.degree(f) == 0 and all(x.op != "where" for x in f.parts())}
        known = POSITIVE in (domain.facts(f).defined and domain.facts(f).sign, *beside)
        if not domain.constant(f) and (known or (f.op == "**" and degree_at_most(base, domain) is None)):
            yield times(part, base, minus(power), domain), known


def _without_brackets(part: Term, domain: StatedDomain) -> Iterator[Term]:
    """The part without brackets, the powers of one of its factors put together in each product."""
    own = factors(part)
    for u in dict.fromkeys(f.args[0] if f.op == "**" else f for f in own if not domain.constant(f)):
        for factor in (f for f in own if f.op == "+" and f != u and u in f.parts()):
            rest, power = split(product_of(*(f for f in own if f is not factor)), u, domain)
            if power != _ZERO:
                yield _times(*rest, times(factor, u, power, domain))


def _times(*terms: Term) -> Term:
    """Their product, without ones."""
    left = [x for x in terms if x != _ONE] or [_ONE]
    return left[0] if len(left) == 1 else product_of(*left)


def _by_sides(part: Term, domain: StatedDomain) -> Iterator[Term]:
    """A product in which a choice by the sign of a force stands, 0 where that force is: the sum of both formulas, each on its side."""
    for choice in (w for w in part.parts() if w.op == "where" and w.args[0].op in COMPARISONS):
        x = next((side for side in choice.args[0].args if side.op == "name"), None)
        if x is not None and x.name in domain.law.forces and _ZERO in choice.args[0].args:
            above = domain.polynomial(gap(choice.args[0])) == domain.polynomial(x)
            ends = {1: Term("pos", (x,)), 2: Term("neg", (x,))} if above else {2: Term("pos", (x,)), 1: Term("neg", (x,))}
            yield sum_of(*(part.put({choice: choice.args[k], Term("abs", (x,)): size, x: size}) for k, size in ends.items()))


def _without_condition(choice: Term) -> Iterator[Term]:
    """One of both formulas, or the one as far as the condition goes, or the greater or the smaller of both."""
    condition, a, b = choice.args
    yield from (a, b)
    for x, other in (condition.args, condition.args[::-1]) if condition.op in COMPARISONS else ():
        if x.op == "name" and other.op == "number":
            words = ("max", "min") if (condition.op in (">", ">=")) == (x is condition.args[0]) else ("min", "max")
            yield from (own.put({x: Term(word, (x, other))}) for own, word in zip((a, b), words, strict=True))
    yield from (Term(word, (a, b)) for word in ("max", "min"))
