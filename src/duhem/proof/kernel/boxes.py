"""Convexity, smoothness and dissipation of a law in a box of its forces, by enclosures of g and of its derivatives in parts of the box.

Let g be twice differentiable in the box and c a point of it with g(c) < 0.  If (sigma - c) . grad g > 0 wherever g = 0, then g is 0 at
most once on each ray from c, so that K is star-shaped; if v . H v > 0 there for all v != 0 along the boundary, with H the second
derivatives, K is locally convex.  A closed connected set that is locally convex is convex (Tietze 1928, Nakajima 1928).  Both are asked in
each part in which g may be 0; a part in which they are not shown is divided (R. E. Moore 1966, Interval analysis).

Where dg/dsigma_k != 0 the vectors t_i = (dg/dsigma_k) e_i - (dg/dsigma_i) e_k with i != k span all v along the boundary.

Wherever g = 0, smoothness asks in the same way that grad g is continuous and not 0, and dissipation that force . slip is >= 0.  At a kink
the slip may be any mean of the slopes on both sides, so that an interval for each slope holds both.

Of a potential of rates both are asked in every part: that its gradient is continuous, and that force . gradient is >= 0.

Parameters and the pressure are further sides of the box, by which nothing is differentiated.

By the mean value theorem f lies in f(c) + f'(z) . (x - c) too, with c the middle of a part and z somewhere in it, and so do the slopes
with the second derivatives.  With the width of the part the excess of these enclosures falls off as its square (the same): each part of
a formula is narrowed by them before what stands around it is enclosed.

The Taylor series of a polynomial of two forces about the middle of a part ends, so that g = sum_ij d_ij x^i y^j there, x and y being the
distances from the middle, and term by term it is differentiated.  Enclosures of the terms are much narrower than those of the formula as
it is written, in which large parts cancel (the same).  The coefficients d_ij are enclosed, as each step of Horner's scheme is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cache, partial, reduce
from itertools import combinations_with_replacement, product
from math import perm
from typing import TypeAlias

from duhem.proof.kernel.bounds import NEGATIVE, POSITIVE, ZERO, Bounds, Sign
from duhem.proof.kernel.constant_value import Enclosure, enclosed, exact_value
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.polynomial import ONE, Polynomial, times, total
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import HALF, NotWritten, Term, minus, number, parse, product_of, sum_of

__all__ = ["MOST_FORCES", "TaylorForm", "coefficients", "convex_in_its_box", "dissipates_in_its_box", "smooth_in_its_box"]

# -- a polynomial in a part of a box -----------------------------------------------------------------------------------

_MOST = 24  # its degree in one force
_PRICE_OF_PRODUCT = 3  # steps for a product of enclosures
_Coefficients = Mapping[tuple[int, int], Fraction]
_product = partial(times, most=_MOST**4)  # of two polynomials of that degree


def coefficients(term: Term, forces: Sequence[str]) -> _Coefficients:
    """Those of a formula of sums, products and whole powers >= 0 of two forces and of numbers; ValueError for any other.

    As no part of such a formula is without a value anywhere, no part is lost with the others that it cancels.
    """
    x, y = (Term("name", name=name) for name in forces)
    found = {(dict(m).get(x, 0), dict(m).get(y, 0)): c for m, c in _read(term, forces, {}).items()}
    if max(map(max, found), default=0) > _MOST:
        raise ValueError("the degree is too high")
    return found


def _read(term: Term, forces: Sequence[str], done: dict[Term, Polynomial]) -> Polynomial:
    if term not in done:
        done[term] = _of_its_word(term, forces, done)  # once, as parts may be shared without end
    return done[term]


def _of_its_word(term: Term, forces: Sequence[str], done: dict[Term, Polynomial]) -> Polynomial:
    if not term.names():
        return {(): exact_value(term)}
    if term.op == "name" and term.name in forces:
        return {((term, 1),): Fraction(1)}
    if term.op == "+":
        return total(*(_read(part, forces, done) for part in term.args))
    if term.op == "*":
        return reduce(_product, (_read(part, forces, done) for part in term.args))
    if term.op == "**" and not term.args[1].names() and (n := exact_value(term.args[1])).denominator == 1 and 0 <= n <= _MOST:
        return reduce(_product, [_read(term.args[0], forces, done)] * int(n), ONE)
    raise ValueError(f"no polynomial of two forces: {term.op}")


class TaylorForm:
    """Enclosures of a polynomial and its derivatives in a part of the box."""

    def __init__(self, of: _Coefficients, box: Sequence[Enclosure]) -> None:
        size = 1 + max(map(max, of), default=0)
        pay(_PRICE_OF_PRODUCT * size**3)
        rows = [[Enclosure.between(c, c) for j in range(size) for c in [of.get((i, j), Fraction(0))]] for i in range(size)]
        middles = [Enclosure(m, m) for side in box for m in [(side.low + side.high) // 2]]
        columns = zip(*(_shifted(row, middles[1]) for row in rows), strict=True)
        self.columns = [_shifted([*column], middles[0]) for column in columns]
        ways = [side.plus(middle.minus()) for side, middle in zip(box, middles, strict=True)]
        self.powers = [[way.power(n) for n in range(size)] for way in ways]

    def value(self, _: Term) -> Enclosure:
        return self._derivative(0, 0)

    def sign(self, term: Term) -> Sign:
        return self.value(term).sign

    def of(self, _: Term) -> tuple[Enclosure, ...]:
        """The slopes by both forces; the second derivatives by the first alone, by both, by the second alone."""
        return tuple(self._derivative(n, m) for n, m in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))

    def _derivative(self, n: int, m: int) -> Enclosure:
        """By the first force n times and by the second m times."""
        x, y = self.powers
        total = _ZERO
        for j, column in enumerate(self.columns[m:], m):
            across = _ZERO
            for i, d in enumerate(column[n:], n):
                across = across.plus(Enclosure(d.low * perm(i, n), d.high * perm(i, n)).times(x[i - n]))
            total = total.plus(Enclosure(across.low * perm(j, m), across.high * perm(j, m)).times(y[j - m]))
        return total


def _shifted(row: list[Enclosure], middle: Enclosure) -> list[Enclosure]:
    """The coefficients in x of sum_i row_i (x + middle)^i, by Horner's scheme again and again."""
    found = [*row]
    for k in range(len(found)):
        for i in reversed(range(k, len(found) - 1)):
            found[i] = found[i].plus(middle.times(found[i + 1]))
    return found


# -- any formula in its box --------------------------------------------------------------------------------------------

_MOST_BOXES, _FINEST, _NEARER = 20_000, 4096, 4  # the second for the least part of a side; places that are tried for c
_PRICE, _ENTRIES = 10, 5  # steps for a part of g with its derivatives by two forces, so many, in a part of the box
_SMOOTH = ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan", "asin", "acos")
_ZERO, _ONE = (Enclosure.between(Fraction(n), Fraction(n)) for n in range(2))
_SLOPES = {"abs": (_ONE, _ONE.minus()), "pos": (_ONE, _ZERO), "neg": (_ZERO, _ONE.minus())}  # above 0, and below
_X, _E, _SOFTPLUS = Term("name", name="x"), Term("name", name="exponent of x"), parse("log(1 + exp(x))")
MOST_FORCES = 3  # of a law in a box: with more there would be too many parts
_Box = Mapping[str, Enclosure]
_Jet = tuple[Enclosure, ...]  # slopes by all forces, and the second derivatives by each pair of them: by 0 and 0, 0 and 1, ... 1 and 1, ...
_Found: TypeAlias = "_Derivatives | TaylorForm"


def convex_in_its_box(law: StatedLaw) -> bool:
    """Whether the above is shown of g; c is 0, the middle of the ranges, which all have 0 in them, or a half or less of that."""
    if law.viscous or (whole := _whole(law)) is None:
        return False
    middle = {x: (whole[x].low + whole[x].high) // 2 for x in law.forces}
    zero = [dict.fromkeys(law.forces, _ZERO)] if all(whole[x].sign & ZERO for x in law.forces) else []
    for c in (*zero, *({x: Enclosure(y >> k, y >> k) for x, y in middle.items()} for k in range(_NEARER))):
        with suppress(ValueError, ZeroDivisionError):
            if enclosed(law.g, {**whole, **c}).sign == NEGATIVE:
                return _shown_in_all_parts(law, whole, partial(_curves_about, law, c))
    return False


def smooth_in_its_box(law: StatedLaw) -> bool:
    """Whether grad g is continuous and not 0 wherever g = 0, or that of a potential of rates is continuous."""
    return (whole := _whole(law)) is not None and _shown_in_all_parts(law, whole, partial(_has_a_slope, law))


def dissipates_in_its_box(law: StatedLaw) -> bool:
    """Whether sigma . grad g > 0 wherever g = 0, or force . slip >= 0 for a slip of the law's own."""
    if (law.surfaces and not law.associated) or (whole := _whole(law)) is None:
        return False
    return _shown_in_all_parts(law, whole, partial(_dissipates, law), kinked=True)


def _whole(law: StatedLaw) -> dict[str, Enclosure] | None:
    """The ranges of all names; None of a law of too many forces, or with forces of rates, NotWritten where a name has no range."""
    if len(law.forces) > MOST_FORCES or law.of_rates:
        return None
    sides = {**law.parameters, **dict(law.ranges)}
    names = {*law.forces}.union(*(x.names() for x in (law.g, *(law.flow or ()), *([law.power] if law.power else ()))))
    return {name: _side(sides.get(name, Bounds(None, None))) for name in sorted(names - {"pi"})}


def _shown_in_all_parts(law: StatedLaw, whole: dict[str, Enclosure], shown: Callable[[_Box, _Found], bool], kinked: bool = False) -> bool:
    """Whether something is shown in each part of the box, or in both halves of one in which it is not, and so on.

    It is shown by derivatives of g, which may be ``kinked``, or by a Taylor form where these are asked of a polynomial of two forces alone.
    """
    of: _Coefficients | None = None
    with suppress(ValueError, ZeroDivisionError, NotWritten):
        of = coefficients(law.g, law.forces) if len(law.forces) == 2 and (law.associated or not kinked) else None
    n, boxes = len(law.forces), [whole]

    def shown_in(box: _Box) -> bool:
        for found in (False, True)[: 1 + kinked] if of is None else (False,):
            pay(price)
            with suppress(ValueError, ZeroDivisionError):  # a kink may be in the box
                return shown(box, _Derivatives(law.forces, box, found) if of is None else TaylorForm(of, [box[x] for x in law.forces]))
        return False

    price = _PRICE * sum(1 for _ in law.g.parts()) * (n + len(_pairs(n))) // _ENTRIES if of is None else 0  # a Taylor form pays itself
    for _ in range(_MOST_BOXES):
        if not boxes:
            return True
        box = boxes.pop()
        if shown_in(box):
            continue
        shares = {x: Fraction(box[x].high - box[x].low, whole[x].high - whole[x].low or 1) for x in whole}
        if (widest := max(shares.values())) * _FINEST < 1:
            return False
        halved = [x for x in whole if shares[x] == widest][:2]  # not all at once: many parameters would make too many parts
        parts = product(*(_halves(box[x]) if x in halved else (box[x],) for x in whole))
        boxes += [dict(zip(whole, part, strict=True)) for part in parts]
    return False


def _side(own: Bounds) -> Enclosure:
    if own.low is None or own.high is None:
        raise NotWritten("a name has no range")
    return Enclosure.between(own.low, own.high)


def _middle(side: Enclosure) -> Enclosure:
    return Enclosure(middle := (side.low + side.high) // 2, middle)


def _in_both(x: Enclosure, y: Enclosure) -> Enclosure:
    return Enclosure(max(x.low, y.low), min(x.high, y.high))


def _halves(side: Enclosure) -> tuple[Enclosure, Enclosure]:
    middle = (side.low + side.high) // 2
    return Enclosure(side.low, middle), Enclosure(middle, side.high)


def _curves_about(law: StatedLaw, c: _Box, box: _Box, found: _Found) -> bool:
    """Whether g keeps a sign in a part of the box, which is < 0 at c, or the boundary rises from c and curves towards it."""
    if (sign := found.sign(law.g)) in (NEGATIVE, POSITIVE):
        return sign == NEGATIVE or any(c[x].high < box[x].low or c[x].low > box[x].high for x in c)
    n, jet = len(law.forces), found.of(law.g)
    away = [box[x].plus(c[x].minus()) for x in law.forces]
    return reduce(_plus, map(_times, away, jet[:n])).sign == POSITIVE and _curves(jet[:n], dict(zip(_pairs(n), jet[n:], strict=True)))


def _curves(slopes: Sequence[Enclosure], bends: Mapping[tuple[int, int], Enclosure]) -> bool:
    """Whether v . H v > 0 for all v != 0 along the boundary: H is positive definite in the t_i, of which there are two at most."""
    k = max(range(len(slopes)), key=lambda i: max(slopes[i].low, -slopes[i].high))
    across = [i for i in range(len(slopes)) if i != k]

    def bend(i: int, j: int) -> Enclosure:
        """t_i . H t_j."""
        mixed = _plus(_times(slopes[i], bends[min(k, j), max(k, j)]), _times(slopes[j], bends[min(k, i), max(k, i)]))
        square = slopes[i].power(2) if i == j else _times(slopes[i], slopes[j])
        own = _plus(_times(slopes[k].power(2), bends[i, j]), _times(square, bends[k, k]))
        return _plus(own, _times(slopes[k], mixed).minus())

    if len(across) < 2:
        return all(bend(i, i).sign == POSITIVE for i in across)
    (i, j), one = across, bend(across[0], across[0])
    minor = _plus(_times(one, bend(j, j)), bend(i, j).power(2).minus())
    return not slopes[k].sign & ZERO and one.sign == POSITIVE == minor.sign


def _has_a_slope(law: StatedLaw, _: _Box, found: _Found) -> bool:
    """Whether g keeps a sign in a part of the box, or one of its slopes does."""
    if law.viscous:
        return bool(found.of(law.g))  # there are none where it may not be C^1
    if found.sign(law.g) in (NEGATIVE, POSITIVE):  # it may have no slopes there
        return True
    return any(not slope.sign & ZERO for slope in found.of(law.g)[: len(law.forces)])


def _dissipates(law: StatedLaw, box: _Box, found: _Found) -> bool:
    """Whether g keeps a sign in a part of the box, or the power is >= 0, and > 0 if the law is associated: then grad g is not 0."""
    if law.viscous:
        return not _along(law, box, found.of(law.g)) & NEGATIVE
    if found.sign(law.g) in (NEGATIVE, POSITIVE):
        return True
    if law.associated:
        return _along(law, box, found.of(law.g)) == POSITIVE
    assert isinstance(found, _Derivatives)
    if law.power is not None:
        for choice in (x for x in law.power.parts() if x.op == "where"):
            found.chosen(choice)
        return not found.value(law.power).sign & NEGATIVE
    return not _along(law, box, map(found.value, law.flow or ()) if law.potential is None else found.of(law.potential)) & NEGATIVE


def _along(law: StatedLaw, box: _Box, slip: Iterable[Enclosure]) -> Sign:
    """The signs of force . slip, which stands first in a jet."""
    return reduce(_plus, (_times(box[x], d) for x, d in zip(law.forces, slip, strict=False))).sign


@cache
def _pairs(n: int) -> list[tuple[int, int]]:
    """All pairs of n forces, in the order of second derivatives."""
    return [*combinations_with_replacement(range(n), 2)]


class _Derivatives:
    """Those of the parts of a formula in a box; ValueError or ZeroDivisionError where a part may have none, or is of no known word.

    Of what may be ``kinked`` they are slopes alone, and hold all means of those on the sides of each kink.
    """

    def __init__(self, forces: Sequence[str], box: _Box, kinked: bool = False, point: bool = False) -> None:
        self.middle = None if point else _Derivatives(forces, {**box, **{x: _middle(box[x]) for x in forces}}, True, True)
        self.pairs = [] if kinked else _pairs(len(forces))
        self.still: _Jet = (_ZERO,) * (len(forces) + len(self.pairs))
        self.forces, self.box, self.kinked = [*forces], box, kinked
        self.values, self.found = dict[Term, Enclosure](), dict[Term, _Jet]()

    def value(self, term: Term) -> Enclosure:
        return enclosed(term, self.box, done=self.values)

    def sign(self, term: Term) -> Sign:
        """That of its values as they are enclosed without derivatives, which it may not have, and else with these."""
        with suppress(ValueError, ZeroDivisionError):
            if (known := self.value(term).sign) in (NEGATIVE, POSITIVE):
                return known
        self.of(term)
        return self.value(term).sign

    def of(self, term: Term) -> _Jet:
        if term not in self.found:
            self.found[term] = self._narrowed(term, self._jet(term)) if term.names() & {*self.forces} else self.still
        return self.found[term]

    def _narrowed(self, term: Term, jet: _Jet) -> _Jet:
        """The derivatives, with the slopes narrowed by the second ones; the value of the term is narrowed by the slopes."""
        if self.middle is None or term.op == "name" or (self.pairs and all(b is _ZERO for b in jet[len(self.forces) :])):
            return jet
        at, n = self.middle.of(term), len(self.forces)
        away = [self.box[x].plus(self.middle.box[x].minus()) for x in self.forces]
        bends, slopes = dict(zip(self.pairs, jet[n:], strict=True)), [*jet[:n]]
        for i in range(n) if bends else ():
            slopes[i] = _in_both(slopes[i], reduce(_plus, (_times(bends[min(i, j), max(i, j)], away[j]) for j in range(n)), at[i]))
        self.values.pop(term, None)  # its parts are narrower now
        self.values[term] = _in_both(self.value(term), reduce(_plus, map(_times, slopes, away), self.middle.value(term)))
        return (*slopes, *jet[n:])

    def _jet(self, term: Term) -> _Jet:
        x = term.args[0] if term.args else term
        match term.op:
            case "name":
                own = self.forces.index(term.name)
                return (*self.still[:own], _ONE, *self.still[own + 1 :])
            case "+":
                return tuple(reduce(_plus, ends) for ends in zip(*map(self.of, term.args), strict=True))
            case "*":
                still = reduce(Enclosure.times, (self.value(a) for a in term.args if self.of(a) is self.still), _ONE)
                moving = [(self.value(a), self.of(a)) for a in term.args if self.of(a) is not self.still]
                return tuple(_times(still, d) for d in reduce(self._multiplied, moving)[1]) if moving else self.still
            case "log" if x.op == "+" and len(x.args) == 2 and x.args[0] == number(1) and x.args[1].op == "exp":
                return self._chained(_SOFTPLUS, x.args[1].args[0], {_SOFTPLUS.args[0].args[1]: self.value(x.args[1])})
            case "**" if not (e := term.args[1]).names() & {*self.forces}:
                with suppress(NotWritten):
                    return self._chained(Term("**", (_X, number(exact_value(e)))), x, {})
                return self._chained(Term("**", (_X, _E)), x, {}, self.value(e))
            case "norm":
                return self.of(Term("**", (sum_of(*(product_of(a, a) for a in term.args)), HALF)))
            case "abs" | "pos" | "neg":
                above, below = _SLOPES[term.op]
                return self._among(self.value(x).sign, *(tuple(_times(side, d) for d in self.of(x)) for side in (above, below)))
            case "max" | "min" if len(term.args) == 1:
                return self.of(x)
            case "max" | "min":
                one, other = x, Term(term.op, term.args[1:]) if term.args[2:] else term.args[-1]
                gap = self.value(one).plus(self.value(other).minus())
                return self._among((gap if term.op == "max" else gap.minus()).sign, self.of(one), self.of(other))
            case "where":
                return self.of(self.chosen(term))
            case "atan2":
                (y, x), (high, right) = term.args, map(self.value, term.args)
                if right.sign == POSITIVE and right.low >= high.size().low:
                    one, other = y, x  # its slopes are those of atan(y/x), and of -atan(x/y)
                elif high.sign in (NEGATIVE, POSITIVE):
                    one, other = minus(x), y
                else:
                    raise ValueError("an angle may jump")
                return self.of(Term("atan", (product_of(one, Term("**", (other, number(-1)))),)))
            case op if op in _SMOOTH:
                return self._chained(Term(op, (_X,)), x, {})
        raise ValueError(f"no derivative of {term.op}")

    def _among(self, sign: Sign, above: _Jet, below: _Jet) -> _Jet:
        """The derivatives on one side of a kink, or what holds those on both where it may be in the box."""
        if sign in (NEGATIVE, POSITIVE):
            return above if sign == POSITIVE else below
        if not self.kinked:
            raise ValueError("a kink may be there")
        return tuple(Enclosure(min(p.low, q.low), max(p.high, q.high)) for p, q in zip(above, below, strict=True))

    def chosen(self, term: Term) -> Term:
        """The formula that a choice is in all of the box; ValueError where it may be another too."""
        one, other = term.args[0].args
        gap = self.value(one).plus(self.value(other).minus()).sign
        if gap not in (NEGATIVE, POSITIVE):
            raise ValueError("a choice goes both ways")
        return term.args[1 if (gap == NEGATIVE) == (term.args[0].op in ("<", "<=")) else 2]

    def _chained(self, outer: Term, inner: Term, done: dict[Term, Enclosure], exponent: Enclosure = _ONE) -> _Jet:
        """Of ``outer`` in x with the value of ``inner`` for x; what is ``done`` was enclosed before."""
        n, jet = len(self.forces), self.of(inner)
        box = {_X.name: self.value(inner), _E.name: exponent}
        d, dd = (enclosed(each, box, done=done) for each in _derived(outer))
        squares = (jet[i].power(2) if i == j else _times(jet[i], jet[j]) for i, j in self.pairs)
        return (*(_times(d, p) for p in jet[:n]), *(_plus(_times(d, b), _times(dd, s)) for b, s in zip(jet[n:], squares, strict=True)))

    def _multiplied(self, one: tuple[Enclosure, _Jet], other: tuple[Enclosure, _Jet]) -> tuple[Enclosure, _Jet]:
        """The product of two values with their derivatives."""
        (f, df), (g, dg), n = one, other, len(self.forces)
        across = (_plus(_times(df[i], dg[j]), _times(df[j], dg[i])) for i, j in self.pairs)
        jet = (_plus(_plus(_times(g, x), _times(f, y)), z) for x, y, z in zip(df, dg, ((_ZERO,) * n + (*across,)), strict=True))
        return f.times(g), tuple(jet)


@cache
def _derived(outer: Term) -> tuple[Term, Term]:
    """The first and the second derivative of a function of x; those of log(1 + exp(x)) in a form with x in one place."""
    if outer == _SOFTPLUS:
        return parse("1 - 1/(1 + exp(x))"), parse("1/4 - (1/2 - 1/(1 + exp(x)))**2")
    (first,) = gradient(outer, (_X.name,))
    return first, gradient(first, (_X.name,))[0]


def _plus(x: Enclosure, y: Enclosure) -> Enclosure:
    return x if y is _ZERO else y if x is _ZERO else x.plus(y)


def _times(x: Enclosure, y: Enclosure) -> Enclosure:
    return _ZERO if x is _ZERO or y is _ZERO else y if x is _ONE else x.times(y)
