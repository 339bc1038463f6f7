"""Functions of one load t, or of one part r: convex, or concave, by their derivatives; and choices of two of them.

Let f be made of t by sums, products, powers and words that are smooth, so that it is continuous wherever it has a value, and C^2 where
f, f' and f'' have one.  A power u^e is read as exp(e log u) for this, unless e is a whole number.  If f'' >= 0 between the ends of t, then
f is convex between these, and at them where it has a value.

A function of t that is >= 0 at an end of t, and does not fall from there, is >= 0: so is 1 - sqrt(c/t) for t >= c > 0.

Let f be one such function where t <= c, and another where t >= c, with one value at c.  It is convex where both are, if its slope does not
fall at c; and C^1 if its slope is one there.

Let r be convex.  Then f(r) is quasiconvex where f does not fall, and convex where f is convex too (Boyd, Vandenberghe 2004, 3.2.4, 3.4.4).
A convex f that is least at t = 0 does not fall for t >= 0.  Of a concave r the same holds where f does not rise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, gap
from duhem.proof.kernel.forms import degree_at_most, of_load, pivot, share_and_rest
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import multiplied_through
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.squares import plainly
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["MOST_PARTS", "along_its_load", "joined", "of_its_size", "sized"]

Rules = Callable[[Term, StatedDomain], Facts]
_SMOOTH = ("+", "*", "**", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan")
MOST_PARTS, _MOST_AT_AN_END = 100, 900  # of a function that is derived twice, and of what is asked at an end
_MOST_TURNS = 3  # derivatives of which the value at an end is asked


class _Line(NamedTuple):
    """A function ``f`` of one force ``x`` strictly ``inside`` its ends: each a value, with 1 or -1 for the way from there."""

    f: Term
    x: Term
    ends: dict[Term, int]
    inside: StatedDomain

    def rate(self, f: Term) -> Term:
        """df/dx; NotWritten where f, its powers being exponentials, or df/dx is not shown to have a value."""
        powers = dict[Term, Term]()
        for p in f.parts():  # the inner ones first
            if p.op == "**" and not self.inside.constant(p) and (p.args[1].op != "number" or p.args[1].value.denominator > 1):
                powers[p] = Term("exp", (product_of(p.args[1], Term("log", (p.args[0].put(powers),))),))
        (slope,) = gradient(f.put(powers), (self.x.name,))
        slope = slope.put({p: power for power, p in powers.items()})
        if not self.inside.facts(slope).defined or any(self.inside.facts(p.args[0]).sign != POSITIVE for p in powers):
            raise NotWritten("a slope is not shown to have a value")
        return slope

    def above(self, f: Term, turns: int = _MOST_TURNS) -> bool:
        """Whether f >= 0."""
        cleared = written(multiplied_through(self.inside.polynomial(f), self.inside, signed=True))
        if any(not self.inside.facts(form).sign & NEGATIVE for form in (f, cleared)):
            return True
        ends = self.ends.items() if turns and f.size() <= _MOST_AT_AN_END else ()
        starts = [way for end, way in ends if not _sign_of_constant(f.put({self.x: end}), self.inside) & NEGATIVE]
        return any(self.above(product_of(number(way), self.rate(f)), turns - 1) for way in starts)


def along_its_load(term: Term, known: Facts, domain: StatedDomain, rules: Rules) -> Facts:
    """What is ``known`` of a term, and the curvature of one that the forces enter by one load alone; ``rules`` tell signs along it."""
    with suppress(NotWritten):
        if (line := _line(term, domain, rules)) is not None:
            bend = line.rate(line.rate(line.f))
            convex, concave = line.above(bend, 1), line.above(minus(bend), 1)
            return replace(known, convex=known.convex or convex, concave=known.concave or concave, quasiconvex=known.quasiconvex or convex)
    return known


def _line(term: Term, domain: StatedDomain, rules: Rules) -> _Line | None:
    moving = term.names() & {*domain.law.forces}
    term = term.put({p: p.args[0] for p in term.parts() if p.op in ("abs", "pos") and domain.facts(p.args[0]).nonnegative})
    if term.size() > MOST_PARTS or any(p.args and p.op not in _SMOOTH and not domain.constant(p) for p in term.parts()):
        return None
    load = next((domain.polynomial(p) for p in term.parts() if p.names() >= moving and degree_at_most(p, domain) == 1), {})
    if (one := pivot(load, domain)) is None or not of_load(term, load, domain):
        return None
    (((x, _),), _) = one
    whole, sides = domain.law.once(StatedDomain, rules), dict[Term, tuple[Term, int]]()
    still = {y: number(0) for f in domain.law.forces if (y := Term("name", name=f)) != x}
    for side in domain.sides:
        if share_and_rest(domain.polynomial(side), load, domain) is not None:
            c, d = share_and_rest(whole.polynomial(side.put(still)), whole.polynomial(x), whole) or ({}, {})
            if (way := whole.facts(written(c)).sign) in (NEGATIVE, POSITIVE):
                end = plainly(whole.polynomial(product_of(minus(written(d)), Term("**", (written(c), number(-1))))))
                sides[side.put(still)] = end, 1 if way == POSITIVE else -1
    ends = {end: way for end, way in sides.values() if all(whole.facts(other.put({x: end})).nonnegative for other in sides)}
    return _Line(term.put(still), x, ends, whole.where(dict.fromkeys(sides, True)))


def _sign_of_constant(term: Term, domain: StatedDomain) -> Sign:
    """Its signs; any where it is not shown to have a value."""
    known = domain.facts(term)
    if not known.defined:
        return ANY
    return known.sign if multiplied_through(domain.polynomial(term), domain) else ZERO


def joined(term: Term, domain: StatedDomain, rules: Rules) -> tuple[Facts, Sign] | None:
    """What is shown of a choice of two functions of one force, which has one value where it changes over, and the signs of the step that
    its slope has there, in the way of the force; None for any other choice.
    """
    if term.args[0].op not in COMPARISONS or domain.constant(term.args[0]) or len(moving := term.names() & {*domain.law.forces}) != 1:
        return None
    (x,), y, known, steps = (Term("name", name=name) for name in moving), gap(term.args[0]), list[Facts](), [number(0), number(0)]
    ways = list[int]()
    for piece, side in zip(term.args[1:], (y, minus(y)), strict=True):
        inside = domain.where({side: False})
        line = _line(sum_of(piece, product_of(number(0), x)), inside, rules)
        end = None if line is None else next((end for end in line.ends if not domain.polynomial(y.put({x: end}))), None)
        if line is None or end is None or not line.inside.facts(slope := gradient(line.f, (x.name,))[0]).defined:
            return None
        shape, one_way = inside.facts(piece), len({*line.ends.values()}) == 1  # else it may have no inside
        known.append(replace(shape, sign=shape.sign & ~NEGATIVE if one_way and line.above(line.f) else shape.sign))
        ways.append(line.ends[end])  # the other way has the other sign, so that what it adds is taken away
        steps = [sum_of(step, product_of(number(ways[-1]), f.put({x: end}))) for step, f in zip(steps, (line.f, slope), strict=True)]
    if sum(ways):
        return None  # both functions begin at an end of the range: the choice changes over elsewhere
    jump, kink = (_sign_of_constant(step, domain) for step in steps)
    convex, concave = (all(f.convex for f in known) and not kink & NEGATIVE, all(f.concave for f in known) and not kink & POSITIVE)
    return (Facts(all(f.defined for f in known), known[0].sign | known[1].sign, convex, concave, convex), kink) if jump == ZERO else None


def sized(term: Term, domain: StatedDomain) -> Iterator[tuple[Term, Term, StatedDomain]]:
    """A part r that is convex, or concave, by which alone the forces enter, and the term with a force t for it, where t has its sign."""
    size, two = Term("name", name="the size"), number(2)  # no name of a law has blanks
    moving = term.names() & {*domain.law.forces}
    for part in (p for p in term.parts() if p.args and p != term and p.names() >= moving):
        square = {Term("**", (part.args[0], two)): Term("**", (size, two))} if part.op == "abs" else {}
        f = term.put({part: size, **square})
        own = domain.facts(part) if f.names().isdisjoint(domain.law.forces) else Facts()
        if own.defined and own.convex is not own.concave:
            yield part, f, domain.wider(size.name).where({size: own.sign == POSITIVE} if own.nonnegative else {})


def of_its_size(term: Term, known: Facts, domain: StatedDomain, rules: Rules) -> Facts:
    """What is ``known`` of a term, and what is shown of one that the forces enter by one part alone, which is convex, or concave."""
    for part, f, inside in sized(term, domain):
        shape, own, size = inside.facts(f), domain.facts(part), Term("name", name=inside.law.forces[-1])
        with suppress(NotWritten):
            start = inside.facts(f.put({size: number(0)}))  # a convex function that is least there does not fall
            least = (
                own.convex and own.sign == ZERO | POSITIVE and shape.convex and shape.nonnegative and start.defined and start.sign == ZERO
            )
            way = number(1 if own.convex else -1)
            if shape.defined and (least or ((line := _line(f, inside, rules)) is not None and line.above(product_of(way, line.rate(f))))):
                return replace(known, defined=True, sign=known.sign & shape.sign, convex=shape.convex, quasiconvex=True)
    return known
