"""Convexity and smoothness of K in a box of two forces, by enclosures of the slopes and curvatures of g in parts of the box.

Let g be twice differentiable in the box and c a point of it with g(c) < 0.  If (sigma - c) . grad g > 0 wherever g = 0, then g is 0 at
most once on each ray from c, so that K is star-shaped; if v . H v > 0 there, with v along the boundary and H the second derivatives, K is
locally convex.  A closed connected set that is locally convex is convex (Tietze 1928, Nakajima 1928).  Both are asked in each part in
which g may be 0; a part in which they are not shown is divided (R. E. Moore 1966, Interval analysis).

The boundary of any K is C^1 where grad g is continuous and not 0, which is asked in the same way.

Parameters and the pressure are further sides of the box, by which nothing is differentiated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cache, reduce
from itertools import product

from duhem.proof.kernel.bounds import NEGATIVE, POSITIVE, ZERO, Bounds
from duhem.proof.kernel.constant_value import Enclosure, enclosed, exact_value
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.taylor import TaylorForm, coefficients
from duhem.proof.kernel.term import NotWritten, Term, number, parse

__all__ = ["convex_in_its_box"]

_MOST_BOXES, _FINEST, _NEARER = 20_000, 4096, 4  # the second for the least part of a side; places that are tried for c
_PRICE = 7  # steps for a part of g, in a part of the box
_SMOOTH = ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan", "asin", "acos")
_ZERO, _ONE, _TWO = (Enclosure.between(Fraction(n), Fraction(n)) for n in range(3))
_X, _E, _SOFTPLUS = Term("name", name="x"), Term("name", name="exponent of x"), parse("log(1 + exp(x))")
_Box = Mapping[str, Enclosure]
_Jet = tuple[Enclosure, ...]  # slopes by both forces; second derivatives by the first alone, by both, by the second alone
_STILL: _Jet = (_ZERO,) * 5


def convex_in_its_box(law: StatedLaw, convex: bool = True) -> bool:
    """Whether the above is shown of g; c is 0, the middle of the ranges, or a half or less of that.  Or that grad g is not 0, alone."""
    sides = {**law.parameters, **dict(law.ranges)}
    names = sorted({*law.g.names(), *law.forces} - {"pi"})
    if len(law.forces) != 2 or law.viscous or law.of_rates:
        return False
    whole = {name: _side(sides.get(name, Bounds(None, None))) for name in names}
    of, middle = None, {x: (whole[x].low + whole[x].high) // 2 for x in law.forces}
    with suppress(ValueError, ZeroDivisionError, NotWritten):
        of = coefficients(law.g, law.forces)
    zero = [dict.fromkeys(law.forces, _ZERO)] if all(whole[x].sign & ZERO for x in law.forces) else []
    places = (*zero, *({x: Enclosure(y >> k, y >> k) for x, y in middle.items()} for k in range(_NEARER)))
    c = next((here for here in places if convex and _is_shown(law, here, {**whole, **here}, of)), None)
    if convex and c is None:
        return False
    boxes, count = [whole], sum(1 for _ in law.g.parts())
    for _ in range(_MOST_BOXES):
        if not boxes:
            return True
        box = boxes.pop()
        pay(_PRICE * count)
        if not _is_shown(law, c, box, of):
            shares = {x: Fraction(box[x].high - box[x].low, whole[x].high - whole[x].low or 1) for x in names}
            if (widest := max(shares.values())) * _FINEST < 1:
                return False
            halved = [x for x in names if shares[x] == widest][:2]  # not all at once: many parameters would make too many parts
            parts = product(*(_halves(box[x]) if x in halved else (box[x],) for x in names))
            boxes += [dict(zip(names, part, strict=True)) for part in parts]
    return False


def _side(own: Bounds) -> Enclosure:
    if own.low is None or own.high is None:
        raise NotWritten("a name has no range")
    return Enclosure.between(own.low, own.high)


def _halves(side: Enclosure) -> tuple[Enclosure, Enclosure]:
    middle = (side.low + side.high) // 2
    return Enclosure(side.low, middle), Enclosure(middle, side.high)


def _is_shown(law: StatedLaw, c: _Box | None, box: _Box, of: Mapping[tuple[int, int], Fraction] | None) -> bool:
    """Whether g keeps a sign in a part of the box, which is < 0 at c, or the boundary rises from c and curves towards it.

    Without a c, whether g keeps a sign, or grad g is continuous and not 0.

    ``of`` are the coefficients of g where it is a polynomial of the two forces alone.
    """
    try:
        found = _Derivatives(law.forces, box) if of is None else TaylorForm(of, [box[x] for x in law.forces])
        sign = found.value(law.g).sign
        if sign in (NEGATIVE, POSITIVE):
            return c is None or sign == NEGATIVE or any(c[x].high < box[x].low or c[x].low > box[x].high for x in c)
        p, q, pp, pq, qq = found.of(law.g)
    except (ValueError, ZeroDivisionError):
        return False
    if c is None:
        return not p.sign & q.sign & ZERO
    x, y = (box[name].plus(c[name].minus()) for name in law.forces)
    bend = _plus(_plus(_times(pp, q.power(2)), _times(qq, p.power(2))), _times(_TWO, _times(pq, _times(p, q))).minus())
    return _plus(_times(x, p), _times(y, q)).sign == POSITIVE == bend.sign


class _Derivatives:
    """Those of the parts of a formula in a box; ValueError or ZeroDivisionError where a part may have none, or is of no known word."""

    def __init__(self, forces: Sequence[str], box: _Box) -> None:
        self.forces, self.box, self.axes = {*forces}, box, dict(zip(forces, ((_ONE, *_STILL[1:]), (_ZERO, _ONE, *_STILL[2:])), strict=True))
        self.values, self.found = dict[Term, Enclosure](), dict[Term, _Jet]()

    def value(self, term: Term) -> Enclosure:
        return enclosed(term, self.box, done=self.values)

    def of(self, term: Term) -> _Jet:
        if term not in self.found:
            self.found[term] = self._jet(term) if term.names() & self.forces else _STILL
        return self.found[term]

    def _jet(self, term: Term) -> _Jet:
        x = term.args[0] if term.args else term
        match term.op:
            case "name":
                return self.axes[term.name]
            case "+":
                return tuple(reduce(_plus, ends) for ends in zip(*map(self.of, term.args), strict=True))
            case "*":
                still = reduce(Enclosure.times, (self.value(a) for a in term.args if self.of(a) is _STILL), _ONE)
                moving = ((self.value(a), self.of(a)) for a in term.args if self.of(a) is not _STILL)
                return tuple(_times(still, d) for d in reduce(_multiplied, moving)[1])
            case "log" if x.op == "+" and len(x.args) == 2 and x.args[0] == number(1) and x.args[1].op == "exp":
                return self._chained(_SOFTPLUS, x.args[1].args[0], {_SOFTPLUS.args[0].args[1]: self.value(x.args[1])})
            case "**" if not (e := term.args[1]).names() & self.forces:
                with suppress(NotWritten):
                    return self._chained(Term("**", (_X, number(exact_value(e)))), x, {})
                return self._chained(Term("**", (_X, _E)), x, {}, self.value(e))
            case "abs" if not self.value(x).sign & ZERO:
                return tuple(d if self.value(x).low > 0 else d.minus() for d in self.of(x))
            case op if op in _SMOOTH:
                return self._chained(Term(op, (_X,)), x, {})
        raise ValueError(f"no derivative of {term.op}")

    def _chained(self, outer: Term, inner: Term, done: dict[Term, Enclosure], exponent: Enclosure = _ONE) -> _Jet:
        """Of ``outer`` in x with the value of ``inner`` for x; what is ``done`` was enclosed before."""
        box = {_X.name: self.value(inner), _E.name: exponent}
        d, dd = (enclosed(each, box, done=done) for each in _derived(outer))
        p, q, *bends = self.of(inner)
        squares = (p.power(2), _times(p, q), q.power(2))
        return (_times(d, p), _times(d, q), *(_plus(_times(d, b), _times(dd, s)) for b, s in zip(bends, squares, strict=True)))


@cache
def _derived(outer: Term) -> tuple[Term, Term]:
    """The first and the second derivative of a function of x; those of log(1 + exp(x)) in a form with x in one place."""
    if outer == _SOFTPLUS:
        return parse("1 - 1/(1 + exp(x))"), parse("1/4 - (1/2 - 1/(1 + exp(x)))**2")
    (first,) = gradient(outer, (_X.name,))
    return first, gradient(first, (_X.name,))[0]


def _multiplied(one: tuple[Enclosure, _Jet], other: tuple[Enclosure, _Jet]) -> tuple[Enclosure, _Jet]:
    """The product of two values with their derivatives."""
    (f, (p, q, *_)), (g, (r, s, *_)) = one, other
    across = (_ZERO, _ZERO, _times(_TWO, _times(p, r)), _plus(_times(p, s), _times(q, r)), _times(_TWO, _times(q, s)))
    jet = tuple(_plus(_plus(_times(g, x), _times(f, y)), z) for x, y, z in zip(one[1], other[1], across, strict=True))
    return f.times(g), jet


def _plus(x: Enclosure, y: Enclosure) -> Enclosure:
    return x if y is _ZERO else y if x is _ZERO else x.plus(y)


def _times(x: Enclosure, y: Enclosure) -> Enclosure:
    return _ZERO if x is _ZERO or y is _ZERO else y if x is _ONE else x.times(y)
