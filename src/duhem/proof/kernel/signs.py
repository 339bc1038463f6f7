"""Signs over the whole domain of a law: of its constants, and of polynomials of one variable with constants as coefficients.

Of numbers alone Sturm's theorem tells a polynomial's sign on an interval, in whole numbers, roots of even multiplicity told apart.  A real
algebraic number is the root of such a polynomial between two fractions, or one fraction.

A constant x between two ends is written as the mean of them with weights 1 and u >= 0 (or as its distance from the one end);
with n its degree, (1 + u)^n P is a polynomial in u whose coefficients are P's Bernstein coefficients.  Where none of them is
< 0, neither is P; where besides their sum is > 0, so is P between the ends.  One constant after another is removed so; the
variable itself is left to Sturm's theorem.

What is shown of the parts of a constant comes first.  If that leaves its sign open, the rules are asked in this order, the cheap ones
first; all but the first are for sums, products, names, and powers as they stand in a constraint:

1. a number that no parameter enters, and a wave over the ranges of its parameters, is enclosed (:mod:`constant_value`);
2. a sum with |x| or a ramp has the signs of both sums that it may be, and one with a root is compared with its rest by squares;
3. the polynomial that the constant is has terms of one sign, measured from ends of ranges and with multiples of constraints taken away
   (``StatedDomain.nonnegative``), is a constraint times something, has no Bernstein coefficient of the other sign, or its enclosures over
   boxes of the parameters have one sign; so it is asked of the constant as written, and of what is left of it without what it divides by
   and what divides all of it;
4. a number made by roots is 0 where it is closer to 0 than such a number can be otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise, product
from math import gcd, lcm
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.constant_value import sign_of_radicals, sign_over
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, exact
from duhem.proof.kernel.identity import multiplied_through
from duhem.proof.kernel.polynomial import Polynomial, in_powers, joined, replaced, root_of_square, times, total, written
from duhem.proof.kernel.stated_law import as_list, without_more
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import ENDS, HALF, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = [
    "RAY", "Interval", "Line", "RealRoot", "common_roots", "divided_by", "divides", "line", "nonnegative", "nonnegative_on_the_line",
    "on_the_line", "parts", "roots", "roots_between", "roots_of_both", "sign_at", "sign_inside", "sign_of_constant", "without_content",
]  # fmt: skip

Line = tuple[int, ...]  # the coefficients of a polynomial, that of 1 first, none at the top 0; a positive factor is as good as none
Interval = tuple[Fraction, Fraction]
RAY = Term("name", name="the ray's")  # no name of a law has blanks
_FINEST = Fraction(1, 2**30)  # a root is enclosed at least as finely as this
_MOST_HALVINGS = 3
_MOST_DEGREE = 80  # about ten seconds of Sturm's theorem
_MOST_DEGREE_OF_A_NUMBER = 24
_A_CHAIN = 2_000  # degree^4 times digits of remainders that are found in a step
_MOST_SHARES = 100_000  # terms of polynomials, times their degrees, of one question
_LINEAR = 60  # terms of a polynomial that is looked at where a parameter has its ends
_FEW, _SHORT = 3, 12  # names and terms of a polynomial
_ONE_SIGN = (NEGATIVE, ZERO, POSITIVE)
_WAVES = ("sin", "cos", "tan")


# -- of a constant -----------------------------------------------------------------------------------------------------


def sign_of_constant(term: Term, known: Sign, domain: StatedDomain) -> Sign:
    """What is left of the ``known`` signs, which its parts leave to a constant."""
    if known not in _ONE_SIGN and (term.op in _WAVES or not term.names() - {"pi"}):
        known &= sign_over(term, domain.bounds, domain.kept.setdefault("enclosed", {}))
    constrained = term.op == "**" and any(term in c.parts() for c in domain.law.constraints)
    if term.large or known in _ONE_SIGN or not (constrained or term.op in ("+", "*", "name")):
        return known
    if (sign := _of_sum_with_a_size(term, domain)) != ANY:
        return known & sign
    if (known := known & domain.sign_of_multiple(term)) in _ONE_SIGN:
        return known
    left = ANY
    if (square := root_of_square(domain.polynomial(term))) is not None and len(square[1]) > 1:
        left = POSITIVE | (domain.facts(written(square[1])).sign & ZERO)
    for form in _of_one_sign(term, domain):
        for turned, sign in ((form, POSITIVE), (minus(form), NEGATIVE)):
            if domain.nonnegative(turned) or _above_zero(turned, domain):
                if domain.nonnegative(turned, strict=True) or _above_zero(turned, domain, strict=True):
                    return known & sign
                left &= sign | ZERO
        left &= sign_over(form, domain.bounds)
    return known & (left if left in _ONE_SIGN or term.names() else left & sign_of_radicals(term))


def _of_sum_with_a_size(term: Term, domain: StatedDomain) -> Sign:
    """The sign of a sum that has |x| or a ramp as one of its terms; the sign < 0 or <= 0 where a norm or a root is one, times what is > 0.

    Of a sum from which a root is taken away, the sign too that is > 0 in spite of it.
    """
    for i, part in enumerate(term.args if term.op == "+" else ()):
        part = product_of(*(g for f in factors(part) for g in factors(domain.plain(f))))
        sizes = [f for f in factors(part) if f.op in ("norm", *ENDS) or (f.op == "**" and f.args[1] == HALF)]
        scale = product_of(*(f for f in factors(part) if f not in sizes))
        if len(sizes) != 1 or (way := domain.facts(scale).sign) not in (POSITIVE, NEGATIVE):
            continue
        (size,), rest = sizes, sum_of(*term.args[:i], *term.args[i + 1 :])
        if size.op in ENDS:  # c |x| + y is c x + y or -c x + y, and c pos(x) + y is c x + y or y
            ends = (product_of(scale, size.args[0], number(k)) for k in ENDS[size.op])
            one, two = (domain.facts(Term("+", (*term.args[:i], end, *term.args[i + 1 :]))).sign for end in ends)
            if one | two != ANY:
                return one | two
            continue
        if way == NEGATIVE:
            # of the root of a plain number squares leave a sum with the root again
            one_name = len(size.names() - {"pi"}) == len(term.names() - {"pi"}) == 1
            if size.op == "**" and one_name and (sign := _of_less_a_root(rest, scale, size.args[0], domain)) != ANY:
                return sign
            continue
        # c |x| + y <= 0 where y <= 0 and c^2 x . x <= y^2; so is c sqrt(x) + y where c^2 x <= y^2
        squares = size.args[:1] if size.op == "**" else [Term("*", (a, a)) for a in size.args]
        gap = Term("+", (Term("*", (rest, rest)), *(minus(product_of(scale, scale, square)) for square in squares)))
        if not domain.facts(rest).sign & POSITIVE and domain.nonnegative(gap):
            return NEGATIVE if domain.nonnegative(gap, strict=True) else NEGATIVE | ZERO
    return ANY


def _of_less_a_root(y: Term, scale: Term, under: Term, domain: StatedDomain) -> Sign:
    """The sign, if it is one, of y - c sqrt(x) or y - c sqrt(pos(x)), c > 0, by that of c^2 x - y^2: an x < 0 is less than y^2 too."""
    x = under.args[0] if under.op == "pos" else under
    with suppress(NotWritten):  # there may be too much of it
        gap = domain.facts(sum_of(product_of(scale, scale, x), minus(product_of(y, y)))).sign
        return NEGATIVE if gap == POSITIVE else POSITIVE if gap == NEGATIVE and domain.facts(y).sign == POSITIVE else ANY
    return ANY


def _above_zero(constant: Term, domain: StatedDomain, strict: bool = False) -> bool:
    """Whether a short polynomial has no Bernstein coefficient < 0."""
    poly = domain.polynomial(constant)
    if len({x for m in poly for x, _ in m}) > _FEW or len(poly) > _SHORT:
        return False
    with suppress(NotWritten):
        return nonnegative(poly, (Fraction(0), Fraction(1)), domain, strict)
    return False


def _of_one_sign(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """A constant, and what is left of it without what it divides by and what divides all of it, where that is simpler."""
    yield term
    poly = domain.polynomial(term)
    rooted = poly
    for root in {x for m in poly for x, _ in m if x.op == "**" and x.args[1] == HALF and x.args[0].op == "name"}:
        rooted = replaced(rooted, root.args[0], {((root, 2),): Fraction(1)})  # as the square of its root
    if rooted != poly:
        yield written(rooted)
    with suppress(NotWritten):
        if (left := without_content(multiplied_through(poly, domain, signed=True), domain)) != poly:
            yield written(left)


# -- over ranges ---------------------------------------------------------------------------------------------------------


def without_content(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """The polynomial without the constants != 0 that divide all of it, its sign kept."""
    for x in {x for m in poly for x, _ in m if x != RAY}:
        least, own = min(dict(m).get(x, 0) for m in poly), domain.of(x)
        if own in (NEGATIVE, POSITIVE):
            turn = Fraction(-1 if own == NEGATIVE and least % 2 else 1)
            poly = {joined(m, ((x, -least),)): c * turn for m, c in poly.items()}
        elif least < 0:
            raise NotWritten("a constant that may be 0 divides")
    return poly


def divided_by(poly: Polynomial, by: Sequence[Fraction | int]) -> tuple[Polynomial, Polynomial]:
    """Quotient and rest of a polynomial by one of the variable alone with these numbers as coefficients, that of 1 first."""
    left, quotient = in_powers(poly, RAY), list[Polynomial]()
    while len(left) >= len(by):
        quotient.insert(0, {m: c / by[-1] for m, c in left.pop().items()})
        for i, c in enumerate(by[:-1], len(left) - len(by) + 1):
            left[i] = total(left[i], times({(): Fraction(-c)} if c else {}, quotient[0]))
    found, rest = (total(*(times(part, {((RAY, n),) if n else (): Fraction(1)}) for n, part in enumerate(p))) for p in (quotient, left))
    return found, rest


def on_the_line(poly: Polynomial) -> Line | None:
    """A polynomial of the variable alone; None if constants are left in it."""
    coefficients = in_powers(poly, RAY)
    if len(coefficients) > _MOST_DEGREE:
        raise NotWritten("a polynomial is too long")
    return line([c.get((), Fraction(0)) for c in coefficients]) if all(set(c) <= {()} for c in coefficients) else None


def nonnegative(poly: Polynomial, between: Interval, domain: StatedDomain, strict: bool = False) -> bool:
    """Whether P >= 0, or P > 0, where the variable is ``between`` the ends and the constants are what they may be."""
    if between[0] >= 0 and all(n % 2 == 0 for m in poly for x, n in m if x == RAY):  # a polynomial in its square
        poly = {tuple((x, n // 2 if x == RAY else n) for x, n in m): c for m, c in poly.items()}
        between = between[0] ** 2, between[1] ** 2
    if _InRanges(between, domain).above(poly, strict):
        return True
    moving = any(x == RAY for m in poly for x, _ in m)  # of a constant the constraints are asked by who asks for its sign
    if not moving or not domain.law.constraints:
        return False
    return _nonnegative_with_constraints(poly, between, domain, strict, _MOST_HALVINGS) or _at_ends(poly, between, domain, strict)


def _at_ends(poly: Polynomial, between: Interval, domain: StatedDomain, strict: bool) -> bool:
    """Whether P, linear in a parameter, is >= 0 at two ends of it, which other parameters may give: it is a mean of its values there.

    It is > 0 if it is at those ends that are reached; where none is, if the sum of both values is.
    """
    for x in sorted({x for m in poly for x, _ in m if x.name in domain.bounds} if len(poly) <= _LINEAR else ()):
        if any(n != 1 for m in poly for y, n in m if y == x):
            continue
        for ends in product(domain.ends(x, 1), domain.ends(x, -1)):
            with suppress(NotWritten):
                values = [replaced(poly, x, end) for end, _ in ends]
                reached = [value for value, (_, left_out) in zip(values, ends, strict=True) if not left_out] or [total(*values)]
                asked = [(value, False) for value in values] + [(value, True) for value in reached if strict]
                if all(_InRanges(between, domain).above(*one) for one in asked):
                    return True
    return False


def _nonnegative_with_constraints(poly: Polynomial, between: Interval, domain: StatedDomain, strict: bool, halvings: int) -> bool:
    """Whether the shares of a P in the powers of its variable are >= 0 by ranges and constraints together, perhaps in parts of the way."""
    low, high = between
    shares = _shares(in_powers(without_content(poly, domain), RAY), Bounds(low, high))
    somewhere = (shares[0], shares[-1], total(*shares)) if strict else ()
    if all(domain.nonnegative(written(share)) for share in shares) and all(domain.nonnegative(written(p), True) for p in somewhere):
        return True
    middle = (low + high) / 2
    parts = ((low, middle), (middle, high)) if halvings and low < high else ()
    return bool(parts) and all(_nonnegative_with_constraints(poly, part, domain, strict, halvings - 1) for part in parts)


class _InRanges:
    """The same, each constant being anywhere in its own range; NotWritten where that is too much, whatever else was asked before."""

    def __init__(self, between: Interval, domain: StatedDomain) -> None:
        self._between, self._domain, self._left = between, domain, _MOST_SHARES

    def above(self, poly: Polynomial, strict: bool) -> bool:
        """Whether P >= 0, or P > 0."""
        poly = without_content(poly, self._domain)
        if (plain := on_the_line(poly)) is not None:
            return nonnegative_on_the_line(plain, *self._between, strict)
        x = min(x for m in poly for x, _ in m if x != RAY)
        coefficients = in_powers(poly, x)
        for reach in _reaches(x, self._domain):
            self._left -= len(poly) * len(coefficients)
            if self._left < 0:
                raise NotWritten("there is too much to multiply out")
            if not self._shares_above(_shares(coefficients, reach), reach, strict):
                return False
        return True

    def _shares_above(self, shares: list[Polynomial], reach: Bounds, strict: bool) -> bool:
        if not all(self.above(share, False) for share in shares):
            return False
        values = [total(*shares)]
        values += [] if reach.low is None or reach.open else [shares[0]]
        values += [] if reach.high is None or reach.open_high else [shares[-1]]
        return not strict or all(self.above(value, True) for value in values)


def _shares(coefficients: list[Polynomial], reach: Bounds) -> list[Polynomial]:
    """What the powers of u >= 0 have in (c + d u)^n P((a + b u)/(c + d u)), where (a + b u)/(c + d u) runs from low to high.

    Where one of these is no end it is low + u, or high - 1/u.
    """
    (low, high, *_), degree = reach, len(coefficients) - 1
    above = (Fraction(-1) if low is None else low, Fraction(1) if high is None else high)
    below = (Fraction(low is not None), Fraction(high is not None))
    found: list[Polynomial] = [{} for _ in coefficients]
    for k, c in enumerate(coefficients):
        weights = [Fraction(1)]
        for a, b in [above] * k + [below] * (degree - k):
            weights = [a * p + b * q for p, q in zip([*weights, Fraction(0)], [Fraction(0), *weights], strict=True)]
        for j, weight in enumerate(weights):
            found[j] = total(found[j], times({(): weight}, c))
    return found


def _reaches(x: Term, domain: StatedDomain) -> Iterator[Bounds]:
    """Where a constant may lie; what has no end, or is no parameter, is cut at 0."""
    found, zero = domain.span(x), Fraction(0)
    across = found.sign() == ANY and (x.op != "name" or found.low is found.high is None)
    yield from (found.above(zero, False), found.below(zero, False)) if across else (found,)


# -- on the line ---------------------------------------------------------------------------------------------------------


def line(coefficients: Iterable[Fraction]) -> Line:
    """The polynomial with these coefficients."""
    given = list(coefficients)
    scale = lcm(*(c.denominator for c in given))
    return _reduced([int(c * scale) for c in given])


def _reduced(p: list[int]) -> Line:
    while p and not p[-1]:
        p.pop()
    shared = gcd(*p)
    return tuple(c // shared for c in p)


def sign_at(p: Line, x: Fraction) -> int:
    """The sign of p(x)."""
    value, power = 0, 1
    for c in reversed(p):
        value, power = value * x.numerator + c * power, power * x.denominator
    return (value > 0) - (value < 0)


def _quotient(p: Line, q: Line) -> Line:
    """p/q where q divides p."""
    found, left = _division(p, q)
    if left:
        raise ValueError("it does not divide")
    return found


def _division(p: Line, q: Line) -> tuple[Line, Line]:
    """Quotient and remainder of p by q, each up to a positive factor: p is multiplied by one where it has to be, to be divided."""
    rest, lead, way = list(p), abs(q[-1]), 1 if q[-1] > 0 else -1
    found = [0] * max(len(p) - len(q) + 1, 0)
    while len(rest) >= len(q):
        top, shift = way * rest[-1], len(rest) - len(q)
        rest, found = [lead * c for c in rest], [lead * c for c in found]
        found[shift] = top
        for i, c in enumerate(q):
            rest[i + shift] -= top * c
        while rest and not rest[-1]:
            rest.pop()
    return _reduced(found), _reduced(rest)


def _chain(p: Line, q: Line) -> list[Line]:
    """Euclid's remainders of p and q, with Sturm's signs; the last one is their greatest common divisor."""
    found = [p]
    while q:
        found.append(q)
        p, q = q, tuple(-c for c in _division(p, q)[1])
    return found


def _slope(p: Line) -> Line:
    return _reduced([i * c for i, c in enumerate(p)][1:])


def parts(p: Line) -> tuple[Line, Line]:
    """The roots of p != 0 once each, and those of odd multiplicity once each."""
    shared = common_roots(p, _slope(p))  # every root once less often than in p
    every = _quotient(p, shared)
    if len(shared) == 1:
        return every, every
    repeated = common_roots(shared, every)
    odd = parts(_quotient(shared, repeated))[1]  # every repeated root twice less often than in p
    return every, _product(_quotient(every, repeated), odd)


def _product(p: Line, q: Line) -> Line:
    found = [0] * (len(p) + len(q) - 1)
    for (i, c), (j, d) in product(enumerate(p), enumerate(q)):
        found[i + j] += c * d
    return _reduced(found)


def roots_of_both(p: Line, q: Line) -> Line:
    """The roots of both, once each if they are so in each."""
    return _product(p, _quotient(q, common_roots(p, q)))


def common_roots(p: Line, q: Line) -> Line:
    """The roots that p and q share, as their greatest common divisor; one of them may be 0."""
    return _chain(p, q)[-1]


def divides(p: Line, q: Line) -> bool:
    """Whether q is a multiple of p."""
    return not _division(q, p)[1]


def _count(chain: list[Line], low: Fraction, high: Fraction) -> int:
    """How many roots the first of a Sturm chain without repeated roots has in (low, high]."""
    return _changes(chain, low) - _changes(chain, high)


def _changes(chain: list[Line], x: Fraction) -> int:
    signs = [s for s in (sign_at(p, x) for p in chain) if s]
    return sum(s != t for s, t in pairwise(signs))


def roots_between(p: Line, low: Fraction | None, high: Fraction | None) -> int:
    """How many different roots p != 0 has strictly between; None is no end."""
    every, farthest = parts(p)[0], 1 + max(Fraction(abs(c), abs(p[-1])) for c in p)  # beyond that is none (Cauchy 1829)
    low, high = (-farthest if low is None else low), (farthest if high is None else high)
    if len(every) == 1 or low >= high:
        return 0
    return _count(_chain(every, _slope(every)), low, high) - (sign_at(every, high) == 0)


def nonnegative_on_the_line(p: Line, low: Fraction, high: Fraction, strict: bool = False) -> bool:
    """Whether p >= 0, or p > 0, on [low, high]."""
    if not p:
        return not strict
    if low == high or len(p) == 1 or (strict and sign_at(p, low) <= 0):
        return sign_at(p, low) > -(not strict)
    pay(len(p) ** 4 * max(c.bit_length() for c in p) // _A_CHAIN)  # remainders grow with the degree
    crossed = parts(p)[not strict]
    inside = _count(_chain(crossed, _slope(crossed)), low, high) - (not strict and sign_at(crossed, high) == 0)
    return inside == 0 and sign_inside(p, low, high) > 0


def sign_inside(p: Line, low: Fraction, high: Fraction) -> int:
    """The sign of p != 0 at a point between, not at a root."""
    steps = len(p) + 1
    return next(s for k in range(1, steps) if (s := sign_at(p, low + (high - low) * Fraction(k, steps))))


def roots(p: Line, low: Fraction, high: Fraction) -> Iterator[tuple[Fraction, Fraction]]:
    """Each root of p, none of them repeated, strictly between: the least first, exactly or between two numbers that are none."""
    chain = _chain(p, _slope(p))

    def between(a: Fraction, b: Fraction) -> Iterator[tuple[Fraction, Fraction]]:
        inside = _count(chain, a, b) - (sign_at(p, b) == 0)
        if inside == 1 and b - a <= _FINEST and sign_at(p, a) and sign_at(p, b):
            yield a, b
        elif inside:
            middle = (a + b) / 2
            yield from between(a, middle)
            if sign_at(p, middle) == 0:
                yield middle, middle
            yield from between(middle, b)

    return between(low, high)


class RealRoot(NamedTuple):
    """The one root of ``poly`` in (low, high), at which it changes its sign; the number ``low`` where that is ``high``."""

    poly: Line
    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, x: Fraction) -> RealRoot:
        """A fraction."""
        return cls((-x.numerator, x.denominator), x, x)

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> RealRoot:
        """``{"value": "1/2"}``, or ``{"polynomial": ["-2", "0", "1"], "enclosure": ["1", "3/2"]}``, the coefficient of 1 first."""
        if "value" in given:
            return cls.of(exact(without_more(given, {"value"})["value"]))
        low, high = map(exact, as_list(without_more(given, {"polynomial", "enclosure"})["enclosure"]))
        poly = line(map(exact, as_list(given["polynomial"])))
        if not 2 < len(poly) <= _MOST_DEGREE_OF_A_NUMBER + 1 or not low < high or sign_at(poly, low) * sign_at(poly, high) >= 0:
            raise NotWritten("a number is no root of its polynomial between its ends")
        if roots_between(poly, low, high) != 1:
            raise NotWritten("a polynomial has several roots between two ends")
        return cls(poly, low, high)

    def written(self) -> dict[str, Any]:
        """As :meth:`read` takes it."""
        if self.exact:
            return {"value": str(self.low)}
        return {"polynomial": [str(c) for c in self.poly], "enclosure": [str(self.low), str(self.high)]}

    @property
    def exact(self) -> bool:
        """Whether it is known as a fraction."""
        return self.low == self.high

    def below(self, other: RealRoot) -> bool:
        """Whether it is seen to be less than another."""
        return self.high < other.low or (self.high == other.low and not (self.exact and other.exact))

    def reduced(self, poly: Polynomial) -> Polynomial:
        """A polynomial with the same value where the variable is this number: its rest by the polynomial of the number."""
        return poly if self.exact else divided_by(poly, self.poly)[1]
