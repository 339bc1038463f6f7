"""The signs of a law's constants over the whole domain and every pressure sigma_n < 0.

The sign of a sum of products is shown by three sound rules: every term has it; so it is once each variable is measured
from an end of its range; so it is once a multiple of a constraint that has it is taken away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from fractions import Fraction
from functools import reduce
from itertools import combinations_with_replacement, islice, product
from math import isqrt
from typing import Any

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, Facts, Sign, exact, signs_of_product
from duhem.proof.kernel.constant_value import ordered, span
from duhem.proof.kernel.polynomial import (
    ONE,
    Monomial,
    Polynomial,
    divided,
    in_powers,
    joined,
    number_in,
    quotient,
    replaced,
    root_of_square,
    shared,
    times,
    total,
    written,
)
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import HALF, NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["ANY", "NEGATIVE", "POSITIVE", "ZERO", "Bounds", "EmptyError", "Sign", "StatedDomain", "exact", "gap"]

_MOST_POWER, _MOST_POWER_OF_ONE, _MOST_CHOICES = 12, 64, 64  # of a sum; of a single term
_MOST_PAIRS = 40  # of a term of a formula and one of a constraint, for two constraints to be tried together
_MOST_OF_PRODUCT, _MOST_SIZES = 16, 2  # pairs of terms of two constraints; sizes in one
_FEW, _SHORT = 4, 12  # words that are no names, and terms, of which ends of spans are tried
_PASSES = 3  # over the constraints, as ends that one leaves are used by the next
_AT_ZERO = dict.fromkeys(("exp", "cos", "cosh"), 1) | dict.fromkeys(("sin", "tan", "asin", "atan", "sinh", "tanh"), 0)


_Gaps = Sequence[tuple[Polynomial, bool]]  # each is >= 0, or > 0


class StatedDomain:
    """Signs over a law's domain.  What it says holds wherever the term is defined; what it does not say is not known.

    A range of the pressure bounds it; forces are any numbers, for what holds of all holds within a range too.  What was shown is kept
    for whoever asks next.  So it is a function of the law, the rules and the ``sides`` alone: nothing is kept before it is known, and
    whether there is too much of something is asked of that alone, whatever was asked before.
    """

    def __init__(self, law: StatedLaw, rules: Callable[[Term, StatedDomain], Facts]) -> None:
        """``rules`` say what is shown of a term over a domain."""
        self.law, self.rules, self._forces = law, rules, frozenset(law.forces)
        self._named: dict[frozenset[Term], int] = {}
        self.known: dict[Term, Facts] = {}  # what was shown of terms
        self._polynomials: dict[Term, Polynomial] = {}  # as they were multiplied out once; nobody changes one
        self._spans = dict[Term, Bounds]()
        self.kept: dict[str, Any] = {}  # what a rule looks up once a domain
        self.sides: Mapping[Term, bool] = {}  # loads that are >= 0 where it is asked, or > 0
        self.bounds = {**law.parameters, **{name: own for name, own in law.ranges if name == law.pressure}}
        self._stated = self._gaps = self._products = list[tuple[Polynomial, bool]]()
        self._tied = frozenset[Term]()
        self._stated = [(self.without_quotients(self.polynomial(gap(c))), len(c.op) == 1) for c in law.constraints]  # each is >= 0, or > 0
        self._tied = frozenset(x for known, _ in self._stated for m in known for x, _ in m)
        self._compared: dict[Term, Sign] = {}
        self._gaps = [*self._stated, *self._sides_of_sizes()]
        self.bounds = sharpened(self.bounds, self._gaps)
        self._products = [*self._products_of_sides()]
        for shown_before in (self.known, self.kept, self._polynomials, self._spans):
            shown_before.clear()

    def without_quotients(self, poly: Polynomial) -> Polynomial:
        """The polynomial times the sums that it divides by, where they are > 0."""
        for x in sorted({x for m in poly for x, _ in m if x.op == "**" and x.args[1] == number(-1)}):
            if self.of(x) == POSITIVE and all(0 <= dict(m).get(x, 0) <= _MOST_POWER for m in poly):
                whole, base = Polynomial(), self.polynomial(x.args[0])
                for part in in_powers(poly, x):
                    whole = total(times(whole, base), part)
                poly = whole
        return poly

    def _sides_of_sizes(self) -> Iterator[tuple[Polynomial, bool]]:
        """Of |x| <= y all of x <= y, -x <= y and 0 <= y, where names alone make up x; of a sum of sizes each in turn."""
        for known, sharp in self._stated:
            sizes = [m[0][0] for m, c in known.items() if len(m) == 1 and m[0][1] == 1 and m[0][0].op == "abs" and c < 0]
            inner = [self.polynomial(x.args[0]) for x in sizes if sum(x in dict(m) for m in known) == 1]
            if 0 < len(inner) == len(sizes) <= _MOST_SIZES and all(y.op == "name" for own in inner for m in own for y, _ in m):
                for ends in product((1, -1, 0), repeat=len(sizes)):
                    side = known
                    for x, own, end in zip(sizes, inner, ends, strict=True):
                        side = replaced(side, x, times(own, {(): Fraction(end)}))
                    yield side, sharp

    def _products_of_sides(self) -> Iterator[tuple[Polynomial, bool]]:
        """Of -y <= x <= y the products x^2 <= y^2 and (y - x)^2 >= 0: no multiple of one of the two by what has a sign says them."""
        for (one, sharp), (two, sharp_too) in combinations_with_replacement(self._gaps, 2):
            both = (m for m, c in one.items() if (sum(n for _, n in m) == 1 if one is two else c * two.get(m, 0) < 0))
            free = any(all(x.op == "name" for x, _ in m) and self._of_term(m, Fraction(1)) == ANY for m in both)
            if free and len(one) * len(two) <= _MOST_OF_PRODUCT:
                yield times(one, two), sharp and sharp_too

    def over(self, law: StatedLaw) -> StatedDomain:
        """The domain of another law, by the same rules."""
        return law.once(StatedDomain, self.rules)

    def wider(self, *names: str) -> StatedDomain:
        """The domain of this law with further names, that may be any numbers, among its forces."""
        return self.over(self.law.once(StatedLaw.with_forces, *names))

    def where(self, sides: Mapping[Term, bool]) -> StatedDomain:
        """The domain of this law where these loads too are >= 0, or > 0; constants are there what they are everywhere."""
        whole = self.over(self.law)
        known: dict[object, StatedDomain] = whole.kept.setdefault("where", {})
        together = {**self.sides, **sides}
        if (key := tuple(together.items())) not in known:
            inside = copy(whole)
            inside.known, inside.kept, inside.sides = {}, {}, together
            known[key] = inside
        return known[key]

    def facts(self, term: Term) -> Facts:
        """What is shown of a term, once."""
        if self.sides and self.constant(term):
            return self.over(self.law).facts(term)
        if term not in self.known:
            self.known[term] = self.rules(term, self)
        return self.known[term]

    def sign(self, term: Term) -> Sign:
        """The signs that a term may have, where it has a value: those of its facts, where a kind of domain knows no more."""
        return self.facts(term).sign

    def constant(self, term: Term) -> bool:
        """Whether no force enters."""
        return self._forces.isdisjoint(term.names())

    def of(self, atom: Term) -> Sign:
        """The sign of what polynomials are written in."""
        if atom.op != "name":
            return self._of_compared(atom) if atom in self._tied else self.sign(atom)
        if atom.name in ("pi", self.law.pressure):
            return POSITIVE if atom.name == "pi" else NEGATIVE
        return ANY if atom.name in self.law.forces else self.bounds[atom.name].sign()

    def _of_compared(self, atom: Term) -> Sign:
        """The sign of what constraints are written in, as the other constraints show it: else each would be asked before itself."""
        if atom not in self._compared:
            stated = zip(self.law.constraints, self._stated, strict=True)
            others = (c for c, (known, _) in stated if all(x != atom for m in known for x, _ in m))
            self._compared[atom] = self.over(self.law._replace(constraints=tuple(others))).sign(atom)
        return self._compared[atom]

    def never_negative(self, term: Term) -> bool:
        """Whether a term is >= 0: by the ranges and constraints of what stands in it, or by what it is put together from."""
        return self.nonnegative(term) or self.facts(term).nonnegative

    def nonnegative(self, term: Term, strict: bool = False) -> bool:
        """Whether a constant is >= 0, or > 0, over the domain."""
        poly = self.polynomial(term)
        words = frozenset(x for m in poly for x, _ in m if x.op not in ("name", "abs", "norm") and self.constant(x))
        gaps = [*self._gaps, *(ordered(words, self.sign) if len(words) > 1 else ())]
        most = 2 if len(poly) * sum(len(known) for known, _ in self._stated) <= _MOST_PAIRS else 1
        forms = enumerate(self._in_ranges(poly, words, gaps))
        return any(self._nonnegative(form, strict, 1 if i else most, known, self._products) for i, (form, known) in forms)

    def _in_ranges(self, poly: Polynomial, words: frozenset[Term], gaps: _Gaps) -> Iterator[tuple[Polynomial, _Gaps]]:
        """The polynomial, and what is >= 0, with names for exponentials; then for all words of which more is known than a sign."""
        exponentials = frozenset(x for x in words if x.op == "exp")
        yield self._with_names(poly, gaps, exponentials)
        few = len(poly) <= _SHORT and len(words) <= _FEW
        told = frozenset(x for x in sorted(words) if few and not _is_root(x) and {*self.span(x)[:2]} - {None, Fraction(0)})
        if told - exponentials:
            yield self._with_names(poly, gaps, told)

    def _with_names(self, poly: Polynomial, gaps: _Gaps, words: frozenset[Term]) -> tuple[Polynomial, _Gaps]:
        own = self._named.setdefault(words, len(self._named))  # their order does not depend on what else was asked
        swap = {x: Term("name", name=f"constant {i} of {own}") for i, x in enumerate(sorted(words))}  # no name of a law
        self.bounds |= {named.name: self.span(x) for x, named in swap.items()}

        def put(form: Polynomial) -> Polynomial:
            return {tuple(sorted((swap.get(x, x), n) for x, n in m)): c for m, c in form.items()} if swap else form

        return put(poly), [(put(known), sharp) for known, sharp in gaps] if swap else gaps

    def span(self, constant: Term) -> Bounds:
        """Where a constant lies."""
        if constant.op == "name" and constant.name in self.bounds:
            return self.bounds[constant.name]
        if constant not in self._spans:
            self._spans[constant] = span(constant, self.of, self.bounds)
        return self._spans[constant]

    def ends(self, x: Term, way: int) -> Iterator[tuple[Polynomial, bool]]:
        """What a parameter is no less than (``way`` 1), or no greater (-1), and whether it is never that: by its range and constraints."""
        low, high, *left_out = self.bounds[x.name]
        if (end := low if way > 0 else high) is not None:
            yield {(): end} if end else {}, left_out[way < 0]
        for known, sharp in self._gaps:
            if (own := known.get(((x, 1),), Fraction(0)) * way) > 0:
                rest = {m: -way * c / own for m, c in known.items() if m != ((x, 1),)}
                if all(x not in dict(m) for m in rest):
                    yield rest, sharp

    def sign_of_multiple(self, term: Term) -> Sign:
        """Of a constraint times something: the product of their signs."""
        poly = self.polynomial(term) if self._gaps else {}
        for known, sharp in self._gaps if len(poly) > 1 else ():
            if 1 < len(known) < len(poly) and (rest := quotient(poly, known)) is not None:
                return signs_of_product(POSITIVE if sharp else ZERO | POSITIVE, self.sign(written(rest)))
        return ANY

    def _nonnegative(self, poly: Polynomial, strict: bool, constraints: int, gaps: _Gaps, first: _Gaps = ()) -> bool:
        """Whether it is >= 0, or > 0, perhaps once multiples of so many gaps are taken away; one of ``first`` goes before the others."""
        if any(self._by_terms(moved, strict) for moved in self._measured(poly)) or self._between_ends(poly, strict):
            return True
        for m, c in poly.items() if constraints else ():
            for known, sharp in [*gaps, *first]:
                for n, d in known.items():
                    share = joined(m, tuple((x, -k) for x, k in n))
                    if (sign := self._of_term(share, c / d)) & NEGATIVE or not sign:
                        continue
                    rest = total(poly, times({share: -c / d}, known))
                    if self._nonnegative(rest, strict and not (sharp and sign == POSITIVE), constraints - 1, gaps):
                        return True
        return False

    def _between_ends(self, poly: Polynomial, strict: bool) -> bool:
        """Whether what is quadratic in one parameter with two ends has no Bernstein coefficient < 0; at the ends these are its values."""
        x = next((x for m in poly for x, n in m if n == 2), None)
        if x is None or x.name not in self.bounds or set(poly) - {(), ((x, 1),), ((x, 2),)}:
            return False
        (low, high, *_), (c, b, a) = self.bounds[x.name], (poly.get(((x, k),) if k else (), Fraction(0)) for k in range(3))
        if low is None or high is None or 2 * a * low * high + b * (low + high) + 2 * c < 0:
            return False
        ends = [(a * end + b) * end + c for end in (low, high)]
        return all(end > 0 or (end == 0 and not strict) for end in ends)

    def _by_terms(self, poly: Polynomial, strict: bool) -> bool:
        pay(20 * len(poly))
        signs = {m: self._of_term(m, c) for m, c in poly.items()}
        above = {m: c for m, c in poly.items() if not signs[m] & NEGATIVE}
        others = {m: c for m, c in poly.items() if m not in above}
        if 2 * len(others) > len(above) or not all(_outweighed(m, c, above) for m, c in others.items()):
            return False
        return not strict or any(signs[m] == POSITIVE for m in above)

    def _of_term(self, monomial: Monomial, factor: Fraction) -> Sign:
        sign = POSITIVE if factor > 0 else NEGATIVE
        for x, n in monomial:
            own = self.of(x)
            if n < 0 and own & ZERO:
                return ANY
            sign = signs_of_product(sign, own if n % 2 else signs_of_product(own, own) if own != ANY else ZERO | POSITIVE)
        return sign

    def _measured(self, poly: Polynomial) -> Iterator[Polynomial]:
        """The polynomial, and with its variables measured from ends of their ranges, by distances that are >= 0."""
        powers = {(x, n > 0) for m in poly for x, n in m}
        turned = sorted(x for x, above in powers if above and x.name in self.bounds and (x, False) not in powers)
        if turned:
            yield poly
        for choice in islice(product(*(self._ends(x) for x in turned)), _MOST_CHOICES):
            moved = poly
            for x, (end, i) in zip(turned, choice, strict=True):
                if end != 0 or i:
                    step = Term("name", name=f"{x.name} from end {i}")  # no name of a law has blanks
                    self.bounds[step.name] = Bounds(Fraction(0), None, (self.bounds[x.name].open, self.bounds[x.name].open_high)[i])
                    moved = replaced(moved, x, total({(): end}, {((step, 1),): Fraction(1 - 2 * i)}))
            yield moved

    def _ends(self, x: Term) -> list[tuple[Fraction, int]]:
        """The ends of a variable's range, 0 for lower and 1 for upper; measuring from a lower end 0 changes nothing."""
        return [(end, i) for i, end in enumerate(self.bounds[x.name][:2]) if end is not None] or [(Fraction(0), 0)]

    def decided(self, comparison: Term) -> bool | None:
        """Whether a comparison of constants holds, where their signs tell."""
        if not self.constant(comparison):
            return None
        sign, holds = self.sign(gap(comparison)), POSITIVE | (ZERO if len(comparison.op) == 2 else 0)
        return True if not sign & ~holds else False if not sign & holds else None

    def polynomial(self, term: Term) -> Polynomial:
        """Sums, products and whole powers multiplied out, sizes of known sign undone; anything else is a variable of its own."""
        if not term.args:
            return self._multiplied_out(term)
        if term not in self._polynomials:
            self._polynomials[term] = self._multiplied_out(term)
        return self._polynomials[term]

    def _multiplied_out(self, term: Term) -> Polynomial:
        term = self.plain(term)
        if term.op == "number":
            return {(): term.value} if term.value else {}
        if term.op == "+":
            return total(*(self.polynomial(a) for a in term.args))
        if term.op == "*":
            return reduce(times, map(self.polynomial, term.args), ONE)
        if term.op == "**" and term.args[1].op == "number" and term.args[1].value.denominator == 1:
            n, inner = int(term.args[1].value), term.args[0]
            if n == 2 and inner.op in ("norm", "abs"):
                return self.polynomial(sum_of(*(product_of(a, a) for a in inner.args)))
            base = self.polynomial(inner)
            if len(base) == 1 and 0 < abs(n) <= _MOST_POWER_OF_ONE:
                ((monomial, c),) = base.items()
                return {tuple((x, k * n) for x, k in monomial): c**n}
            if 0 <= n <= _MOST_POWER:
                return reduce(times, [base] * n, ONE)
            if base == ONE:
                return ONE
            if base and n < 0 and self.constant(term) and term.names() - {"pi"}:
                return _inverse(base, -n)
        if term.op == "**" and self.constant(term) and self.polynomial(term.args[0]) == ONE:
            return ONE  # whatever the power
        if term.args and not term.names():  # of numbers, whose quotients have one spelling
            values = [number_in(self.polynomial(a)) for a in term.args]
            term = term._replace(args=tuple(a if x is None else number(x) for a, x in zip(term.args, values, strict=True)))
        return {((term, 1),): Fraction(1)}

    def _root_of_square(self, base: Term, exponent: Term) -> Term | None:
        """The size of x, times the root of a number, where a constant is a number times x^2."""
        known = base.names() <= {*self.bounds, "pi", self.law.pressure}
        with suppress(NotWritten):
            if known and exponent == HALF and (found := root_of_square(self.polynomial(base))) is not None and number_in(found[1]) is None:
                size, root = self.plain(Term("abs", (written(found[1]),))), Fraction(*map(isqrt, found[0].as_integer_ratio()))
                scale = number(root) if root**2 == found[0] else Term("**", (number(found[0]), HALF))
                return size if root**2 == 1 == found[0] else product_of(scale, size)
        return None

    def plain(self, term: Term) -> Term:
        """A ramp or size of a constant of known sign is it, its negative or 0; a norm of one that need not be 0, or the root of a square,
        is a size.

        A choice that is decided is what is chosen, also of the greatest or least of several; what a word is at 0 is a number.
        """
        if term.op == "where" and (holds := self.decided(term.args[0])) is not None:
            return self.plain(term.args[1 if holds else 2])
        if term.op not in ("norm", "abs", "pos", "neg", "**", "max", "min", *_AT_ZERO) or not self.constant(term):
            return term
        if term.op in ("max", "min"):
            wrong = NEGATIVE if term.op == "max" else POSITIVE
            return next((x for x in term.args if not any(self.sign(sum_of(x, minus(y))) & wrong for y in term.args if y != x)), term)
        if term.op == "**":
            return self._root_of_square(*term.args) or term
        if term.op in _AT_ZERO:
            return number(_AT_ZERO[term.op]) if self.sign(term.args[0]) == ZERO else term
        left = [a for a in term.args if self.sign(a) != ZERO] or [number(0)]
        if len(left) > 1:
            return term
        (x,), sign = left, self.sign(left[0])
        if not sign & NEGATIVE:
            return number(0) if term.op == "neg" else x
        if not sign & POSITIVE:
            return number(0) if term.op == "pos" else minus(x)
        return Term("abs", (x,)) if term.op == "norm" else term


def _inverse(poly: Polynomial, n: int) -> Polynomial:
    """1/P^n, factors of all terms of P and its first number on their own: P is not 0 where it has a value, and it has one spelling."""
    own, first = shared(poly), abs(poly[min(poly)])
    rest = Term("**", (written(divided(poly, own, first)), number(-1)))
    return divided({((rest, n),): Fraction(1)}, tuple((x, k * n) for x, k in own), first**n)


def _outweighed(m: Monomial, c: Fraction, above: Polynomial) -> bool:
    """Whether two terms that are >= 0 have a sum no less than |c m|, twice their geometric mean being so; what that takes is used up."""
    for one, a in above.items():
        other = joined(joined(m, m), tuple((x, -n) for x, n in one))
        if other in above and other != one and c * c <= (most := 4 * a * above[other]):
            del above[one], above[other]
            if c * c < most:
                above[one] = a - a * c * c / most
            return True
    return False


def _is_root(term: Term) -> bool:
    """Whether it is a power with a number for exponent: what such ones say beside their sign, squares say (:mod:`signs`)."""
    return term.op == "**" and term.args[1].op == "number"


def gap(comparison: Term) -> Term:
    """What a comparison says is >= 0."""
    left, right = comparison.args if comparison.op in (">", ">=") else comparison.args[::-1]
    return Term("+", (left, minus(right)))


# -- ranges --------------------------------------------------------------------------------------------------------------


class EmptyError(NotWritten):
    """No parameters meet the ranges and constraints of a law."""


def sharpened(bounds: Mapping[str, Bounds], gaps: _Gaps) -> dict[str, Bounds]:
    """Bounds and what ``gaps`` >= 0, or > 0, leave of them: what is linear in a parameter bounds it by the ends of the others.

    So does what is of the second degree in one alone, by its roots.
    """
    found = dict(bounds)
    for gap, sharp in [*gaps] * _PASSES:
        for x in {x for m in gap for x, _ in m if x.name in found and all(n > 0 for m in gap for _, n in m)}:
            found[x.name] = _left(x, in_powers(gap, x), sharp, found)
    for known in found.values():
        if known.low is not None and known.high is not None and not (known.low < known.high or known.holds(known.high)):
            raise EmptyError("the domain is empty")
    return found


def _left(x: Term, parts: list[Polynomial], sharp: bool, bounds: Mapping[str, Bounds]) -> Bounds:
    """What a constraint, by powers of the parameter, leaves of where it lies."""
    known = bounds[x.name]
    if len(parts) == 2:
        (_, most), (least, greatest) = (_span(part, bounds) for part in parts)  # least > greatest where no values are left
        if most is None or least is None or greatest is None or not (0 < least <= greatest or least <= greatest < 0):
            return known
        ends = [-most / f for f in (least, greatest)]
        return known.above(min(ends), sharp) if least > 0 else known.below(max(ends), sharp)
    if len(parts) == 3 and all(set(part) <= {()} for part in parts):
        c, b, a = (part.get((), Fraction(0)) for part in parts)
        if a < 0 and (square := b * b - 4 * a * c) >= 0:
            root = Fraction(isqrt(square.numerator * square.denominator), square.denominator)
            inexact = root * root != square
            root += Fraction(inexact, square.denominator)
            sharp = sharp and not inexact
            return known.above((root - b) / (2 * a), sharp).below((-root - b) / (2 * a), sharp)
    return known


def _span(poly: Polynomial, bounds: Mapping[str, Bounds]) -> tuple[Fraction | None, Fraction | None]:
    """Numbers between which a polynomial of degree 1 lies; None where there is none."""
    low: Fraction | None = Fraction(0)
    high: Fraction | None = Fraction(0)
    for m, c in poly.items():
        if m and (len(m) > 1 or m[0][1] != 1 or m[0][0].name not in bounds):
            return None, None
        ends = bounds[m[0][0].name][:2] if m else (Fraction(1), Fraction(1))
        first, last = ends if c > 0 else ends[::-1]
        low = None if low is None or first is None else low + c * first
        high = None if high is None or last is None else high + c * last
    return low, high
