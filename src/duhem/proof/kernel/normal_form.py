"""The same law with its formulas in a normal form, so that no rule depends on how they were spelled.

Every step is an identity wherever the formula as written has a value.  What has a value is asked of the text as written, before
(:mod:`obligations`): so nothing here may be read as showing that, and a form that has a value in more places says no more of the law.

Kinks, of constants too, come to ``abs``, ``pos`` and ``neg`` of what begins with a coefficient > 0, powers of powers to one, and what is
multiplied and added up between words is multiplied out and collected.  ``where(d >= 0, a, b)`` with a - b = c d is b + c pos(d);
r + c pos(d) is max(r, r + c d) for c >= 0.  Of a pos(d) + b neg(d) one part is 0: its whole powers are those of the parts.
Of a sum of squares under a root those that are no polynomials become parts of a norm.  Under a root N w + N q with a word w is N (w + q).

A quotient N/P has a value only where P is not 0.  Factors of all terms of P are divided by on their own; N/P is q + R/P for N = q P + R.
Several powers of one P are written as whole powers of one of them: P is >= 0 where they have values, or they are all whole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from fractions import Fraction
from functools import reduce
from math import lcm
from typing import NamedTuple

from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain, gap
from duhem.proof.kernel.forms import apart, by_forces, inverse, multiple, sum_of_squares
from duhem.proof.kernel.identity import signs_as_sizes
from duhem.proof.kernel.polynomial import (
    ONE,
    Monomial,
    Polynomial,
    added,
    divided,
    grouped,
    in_powers,
    inverse_or_root,
    joined,
    negated,
    number_in,
    plainly,
    quotient,
    replaced,
    root_of_square,
    scaled,
    shared,
    slope,
    solved,
    times,
    total,
)
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import COMPARISONS, ENDS, HALF, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["normal"]

_ZERO = number(0)
_KINKS = (*ENDS, "max", "min", "where")
_LOAD = Term("name", name="the load")  # no name of a law has blanks
_PRICE = 20  # steps for a part, beside what its polynomials cost
_MOST_TERMS = 300  # of what is multiplied out
_HIGHEST, _KEPT = 3, "power of a sum"  # whole powers that are multiplied out; the word of the others while polynomials are made


def normal(term: Term, domain: StatedDomain, collects: bool = True) -> Term:
    """The normal form; or that with simpler words alone, sums and products as they are.  NotWritten where there is too much of these."""
    if term.large:
        raise NotWritten("a formula is too large")
    found = _Form(domain, collects, domain.kept.setdefault(f"normal forms, {collects}", {})).of(term)
    return _as_written(found) if collects else found


def _square(ramp: str, d: Term) -> Polynomial:
    return {((Term(ramp, (d,)), 2),): Fraction(1)}


class _Form(NamedTuple):
    """What the terms of a ``domain`` become, and those that were asked for; sums and products may be left as they are written."""

    domain: StatedDomain
    collects: bool
    known: dict[Term, Term]

    def of(self, term: Term) -> Term:
        """The normal form."""
        if not term.args or (self.domain.constant(term) and not any(part.op in _KINKS for part in term.parts())):
            return term
        if term not in self.known:
            pay(_PRICE)
            self.known[term] = self._of(term._replace(args=tuple(map(self.of, term.args))))
        return self.known[term]

    def _of(self, term: Term) -> Term:
        words = {"where": self._choice, "max": self._extreme, "min": self._extreme, "+": self._collected}
        if term.op in words:
            return words[term.op](term)
        if term.op == "cosh":
            size = self._kink("abs", *term.args)
            return term if size.op == "abs" else Term("cosh", (size,))
        if term.op in ENDS:
            return self._kink(term.op, *term.args)
        if term.op == "norm":
            return self._norm(term.args)
        if term.op == "*":
            parts = (self._power(x, number(n)) for x, n in Counter(factors(term)).items()) if self.collects else term.args
            return self._multiplied(self._collected(Term("*", tuple(parts))))
        if term.op == "log":
            upside = inverse(term.args[0], self.domain)
            return term if upside is None else minus(Term("log", (self._collected(upside),)))
        return self._power(*term.args) if term.op == "**" else term

    # -- kinks ---------------------------------------------------------------------------------------------------------

    def _choice(self, term: Term) -> Term:
        """b + c pos(d), where a is b + c d, and both have a value on either side; so of powers of d."""
        condition, one, two = term.args
        if condition.op not in COMPARISONS or not all(self.domain.facts(x).defined for x in (*condition.args, one, two)):
            return term
        d = gap(condition)
        gained = self._poly(sum_of(one, minus(two)))
        if (c := multiple(gained, self._poly(d), self.domain)) is not None:
            ramp = product_of(plainly(c), self._kink("pos", d))
            return self._collected(sum_of(two, ramp) if self._poly(two) else ramp)
        gains, own = (self._by_powers(poly, self._poly(d)) for poly in (gained, self._poly(two)))
        if not gains and (c := multiple(gained, self._poly(product_of(d, d)), self.domain)) is not None:
            return self._collected(sum_of(two, product_of(plainly(c), self._power(self._kink("pos", d), number(2)))))
        if not gains or gains[0] or not all(self.domain.constant(x) for c in gains for m in c for x, _ in m):
            return term
        parts = [two]
        for k, c in enumerate(gains):
            if c:
                before = own[k] if 1 < k < len(own) and all(self.domain.constant(x) for m in own[k] for x, _ in m) else {}
                for word, share in (("pos", total(before, c)), ("neg", before if k % 2 == 0 else negated(before))):
                    parts.append(product_of(plainly(share), self._power(self._kink(word, d), number(k))))
                parts.append(minus(product_of(plainly(before), self._power(d, number(k)))))
        return self._collected(sum_of(*parts))

    def _multiplied(self, term: Term) -> Term:
        """A product with a choice of constants, or a power of one, as the choice of products that it is, if this is none any more."""
        either = (x for a in (factors(term) if term.op == "*" else ()) for x in (a, *a.args[:1]) if x.op == "where")
        if (x := next((x for x in either if all(map(self.domain.constant, x.args[1:]))), None)) is None or self.domain.constant(x):
            return term
        found = self._choice(x._replace(args=(x.args[0], *(term.put({x: value}) for value in x.args[1:]))))
        return term if found.op == "where" else found

    def _by_powers(self, poly: Polynomial, d: Polynomial) -> list[Polynomial]:
        """The coefficients of a polynomial by powers of ``d``, which holds a force times a number and stands for it; else none."""
        forces = (m[0][0] for m in d if len(m) == 1 and m[0][1] == 1 and self._in_forces(m))
        f = next((x for x in forces if sum(x in dict(m) for m in d) == 1), None)
        if f is None or any(x == f and n < 0 for m in poly for x, n in m):
            return []
        rest = {m: c for m, c in d.items() if m != ((f, 1),)}
        share: Polynomial = {(): 1 / d[((f, 1),)]}
        return in_powers(replaced(poly, f, times(share, total({((_LOAD, 1),): Fraction(1)}, negated(rest)))), _LOAD)

    def _extreme(self, term: Term) -> Term:
        """Of x alone x, of x and 0 pos(x), of x and k x, k <= 0, pos(x) - k neg(x); a minimum is the maximum of the negatives, turned,
        and so is a maximum of sums of forces that all begin with a coefficient < 0.  What differs by constants is a sum with their maximum.
        """
        if term.op == "min":
            turned = self._extreme(Term("max", tuple(self._collected(minus(a)) for a in term.args)))
            return Term("min", tuple(sorted(term.args))) if turned.op == "max" else self._collected(minus(turned))
        inner = [part for a in term.args for part in (a.args if a.op == "max" else (a,))]
        args = sorted({frozenset(self._poly(part).items()): part for part in reversed(inner)}.values())  # of those that are alike the first
        if len(args) == 1:
            return args[0]
        if rest := [a for a in args if not self._poly(a)]:
            return self._kink("pos", self._extreme(Term("max", tuple(a for a in args if a not in rest))))
        if len(args) == 2 and (k := multiple(self._poly(args[0]), self._poly(args[1]), self.domain)) is not None:
            if k == {(): Fraction(-1)}:
                return self._kink("abs", args[0])
            if not self.domain.facts(plainly(k)).sign & POSITIVE:
                turned = product_of(plainly(negated(k)), self._kink("neg", args[1]))
                return self._collected(sum_of(self._kink("pos", args[1]), turned))
        polys = list(map(self._poly, args))
        moving, *others = ({m: c for m, c in poly.items() if not all(self.domain.constant(x) for x, _ in m)} for poly in polys)
        if moving and all(other == moving for other in others):
            ends = (plainly({m: c for m, c in poly.items() if m not in moving}) for poly in polys)
            return self._collected(sum_of(plainly(moving), Term("max", tuple(ends))))
        if all(poly[min(poly)] < 0 and {sum(n for _, n in self._in_forces(m)) for m in poly} == {1} for poly in polys):
            return self._collected(minus(Term("min", tuple(sorted(self._collected(minus(a)) for a in args)))))
        return Term("max", tuple(args))

    def _kink(self, word: str, x: Term) -> Term:
        """c |y|, c pos(y) or c neg(y) for x = c y, y beginning with a coefficient > 0 and c a product of constants that is > 0."""
        poly = self._poly(x)
        if not poly:
            return _ZERO
        known = self.domain.facts(x).sign
        if not known & NEGATIVE:
            return _ZERO if word == "neg" else x
        if not known & POSITIVE:
            return _ZERO if word == "pos" else self._collected(minus(x))
        parts = by_forces(poly, self.domain)
        ramps = {m[0][0]: c for m, c in parts.items() if len(m) == 1 and m[0][1] == 1 and m[0][0].op in ("pos", "neg")}
        if word == "abs" and len(ramps) == len(parts) == 2 and len({x.args for x in ramps}) == 1:
            return self._collected(sum_of(*(product_of(self._kink("abs", plainly(c)), x) for x, c in ramps.items())))  # one of the two is 0
        content, rest = self._content(poly)
        sign = self.domain.facts(plainly(content)).sign
        if sign == NEGATIVE:
            content, word = negated(content), {"pos": "neg", "neg": "pos"}.get(word, word)
        elif sign != POSITIVE:
            return Term(word, (x,))
        kink = Term(word, (self._presented(rest) if self.collects or rest != poly else x,))
        return kink if number_in(content) == 1 else product_of(plainly(content), kink)

    def _content(self, poly: Polynomial) -> tuple[Polynomial, Polynomial]:
        """(c, p) with poly = c p, c one term of constants that are > 0 or < 0, and p beginning with a coefficient > 0."""
        own = shared(poly, lambda x: self.domain.constant(x) and self.domain.of(x) in (NEGATIVE, POSITIVE))
        lead = Fraction(1 if poly[min(poly)] > 0 else -1)
        return {own: lead}, divided(poly, own, lead)

    # -- powers --------------------------------------------------------------------------------------------------------

    def _norm(self, args: Sequence[Term]) -> Term:
        """Without parts that are 0, multiples of sizes and norms inside, in order; of one part it is its size."""
        parts = list[Term]()
        for a in args:
            c, moving = apart(a, self.domain)
            inside = len(moving) == 1 and moving[0].op in ("abs", "norm")
            parts += [self._collected(product_of(c, x)) for x in moving[0].args] if inside else [a] if self._poly(a) else []
        if len(parts) < 2:
            return self._kink("abs", parts[0]) if parts else _ZERO
        found = Term("norm", tuple(sorted(min(a, self._collected(minus(a))) if self.collects else a for a in parts)))
        plain = self.collects and all(x.op == "name" or self.domain.constant(x) for a in parts for m in self._poly(a) for x, _ in m)
        return (self._root(sum_of(*(product_of(a, a) for a in parts))) if plain else None) or found

    def _power(self, base: Term, exponent: Term) -> Term:
        """(y^k)^p is y^(k p) for y >= 0 and |y|^(k p) for even k; even powers of sizes, and of norms, are polynomials."""
        p = number_in(self.domain.polynomial(exponent)) if self.domain.constant(exponent) else None
        if p is None:
            return self._power_of_power(base, exponent)
        if p in (0, 1):
            return base if p else number(1)
        if self.collects and p.denominator == 1 and p > 1 and (parts := self._ramps(base)):
            return added([product_of(self._power_of_constant(c, int(p)), Term("**", (ramp, number(p)))) for c, ramp in parts])
        if self.collects and base.op == "+" and p.denominator == 1 and p > _HIGHEST:
            return Term(_KEPT, (base, number(p)))
        if p > 0 and p % 2 == 0 and base.op in ("abs", "norm"):
            square = sum_of(*(product_of(a, a) for a in base.args)) if base.op == "norm" else base.args[0]
            return self._power(self._collected(square), number(p / 2 if base.op == "norm" else p))
        if p == Fraction(1, 2) and (norm := self._root(base)) is not None:
            return norm
        if p.denominator == 1 and p < 0 and base.op == "*":
            return self._collected(Term("*", tuple(self._power(a, number(p)) for a in base.args)))
        if self.collects and p.denominator == 1 and p < 0 and base.op == "+":
            return self._presented(self._times_power(ONE, self._reduced(self._poly(base)), int(p)))
        return self._power_of_power(self._factored(base) if self.collects and 0 < p < 1 else base, number(p))

    def _ramps(self, base: Term) -> list[tuple[Term, Term]]:
        """x and y with pos(d) and neg(d) for x pos(d) + y neg(d), of which one part is 0 at a time; else none."""
        parts = [(c, moving[0]) for c, moving in (apart(a, self.domain) for a in base.args) if len(moving) == 1] if base.op == "+" else []
        words, inner = {ramp.op for _, ramp in parts}, {ramp.args for _, ramp in parts}
        return parts if len(parts) == len(base.args) == 2 and words == {"pos", "neg"} and len(inner) == 1 else []

    def _power_of_constant(self, constant: Term, p: int) -> Term:
        value = number_in(self.domain.polynomial(constant))
        return Term(_KEPT, (constant, number(p))) if value is None else number(value**p)

    def _factored(self, base: Term) -> Term:
        """N (w + q) for N w + N q, w a word: of a root the factors tell more than the terms; N begins with a coefficient > 0."""
        if base.op == "pos":
            return base._replace(args=(self._factored(base.args[0]),))
        groups = grouped(self._poly(base), self._is_word) if base.op == "+" else {}
        for own in sorted(groups.values(), key=len) if len(groups) > 1 else ():
            factor = self._content(own)[1]
            shares = [(words, quotient(part, factor)) for words, part in groups.items()]
            if any(map(self._in_forces, own)) and all(q for _, q in shares):
                rest = total(*(times(q, {words: Fraction(1)}) for words, q in shares if q))
                return Term("*", (self._presented(factor), self._presented(rest)))
        return base

    def _power_of_power(self, base: Term, p: Term) -> Term:
        if base.op == "**" and self.domain.constant(base.args[1]):
            y, k = base.args
            product = number_in(self.domain.polynomial(product_of(k, p)))
            even = k.op == "number" and k.value > 0 and k.value % 2 == 0
            risen = self.domain.facts(k).sign == POSITIVE
            if product and risen and (even or not self.domain.facts(y).sign & NEGATIVE):
                inner = self._kink("abs", y) if even and product % 2 else y
                return self._power(inner, number(product))
            if product is None and even and self.domain.constant(p):
                return Term("**", (self._kink("abs", y), product_of(k, p)))
        return Term("**", (base, p))

    def _root(self, base: Term) -> Term | None:
        """The root of a polynomial of second degree in forces, and squares of other parts, as a norm; None for anything else."""
        poly = self._reduced(self._poly(base))
        if (whole := self._square(poly)) is not None and not self.domain.facts(plainly(whole[0])).sign & NEGATIVE:
            return self._norm([self._collected(product_of(self._root_of(whole[0]), whole[1]))])
        squares, rest = list[tuple[Polynomial, Term]](), dict[Monomial, Fraction]()
        for moving, c in by_forces(poly, self.domain).items():
            if len(moving) == 1 and moving[0][1] == 2 and moving[0][0].op != "name":
                squares.append((c, moving[0][0]))
            elif all(x.op == "name" and n > 0 for x, n in moving) and sum(n for _, n in moving) <= 2:
                rest = total(rest, times(c, {moving: Fraction(1)}))
            else:
                return None
        if (square := self._square(rest)) is not None:
            squares.append(square)
        elif rest:
            known = sum_of_squares(rest, self.domain)
            inner = self._presented(rest) if known is None else added([scaled(c, ((self._presented(y), 2),)) for c, y in known])
            if not squares or (known is None and self.domain.facts(inner).sign & NEGATIVE):
                return None if known is None else Term("**", (inner, HALF))
            squares.append(({(): Fraction(1)}, Term("**", (inner, HALF))))
        if any(self.domain.facts(plainly(c)).sign & NEGATIVE for c, _ in squares):
            return None
        return self._norm([self._collected(product_of(self._root_of(c), x)) for c, x in squares])

    def _root_of(self, constant: Polynomial) -> Term:
        root = Term("**", (plainly(constant), HALF))
        with suppress(NotWritten):
            return number(exact_value(root))
        return root

    def _square(self, poly: Polynomial) -> tuple[Polynomial, Term] | None:
        """(d, y) where the polynomial is d y^2 with a constant d; None where it is no square."""
        common = shared(poly, self.domain.constant)
        found = root_of_square(divided(poly, common))
        return None if found is None else ({common: found[0]}, self._presented(found[1]))

    # -- sums and products -----------------------------------------------------------------------------------------------

    def _poly(self, term: Term) -> Polynomial:
        poly = self.domain.polynomial(term)
        if len(poly) > _MOST_TERMS:
            raise NotWritten("there is too much to multiply out")
        exponents: dict[Term, set[Fraction]] = {}
        for x in {x for m in poly for x, _ in m if x.op == "**" and x.args[1].op == "number"}:
            exponents.setdefault(x.args[0], set()).add(x.args[1].value)
        for base, own in exponents.items():  # 1/P^2 as (1/P)^2, and where there are several powers of P, all as those of one
            unit = Fraction(-1 if all(n.denominator == 1 for n in own) else 1, lcm(*(n.denominator for n in own)))
            if len(own) > 1 or (unit == -1 and own != {unit}):
                powers = {Term("**", (base, number(n))): int(n / unit) for n in own}
                one = Term("**", (base, number(unit)))
                swapped = [(joined((), tuple((one, n * powers[x]) if x in powers else (x, n) for x, n in m)), c) for m, c in poly.items()]
                poly = total(*({m: c} for m, c in swapped))
        return poly

    def _collected(self, term: Term) -> Term:
        """What is added up and multiplied, multiplied out and collected; a kink is drawn out of a sum where that leaves less."""
        if not self.collects:
            return self._drawn_out(self._folded(term))
        return self._drawn_out(self._presented(self._with_sizes(self._reduced(self._poly(signs_as_sizes(term, self.domain))))))

    def _folded(self, term: Term) -> Term:
        """A product with its numbers as one."""
        if term.op != "*":
            return term
        value, others = Fraction(1), list[Term]()
        for f in factors(term):
            known = number_in(self.domain.polynomial(f)) if self.domain.constant(f) else None
            value, others = (value, [*others, f]) if known is None else (value * known, others)
        return scaled(number(value), tuple((f, 1) for f in others)) if value else _ZERO

    def _with_sizes(self, poly: Polynomial) -> Polynomial:
        """Ramps that are added up as sizes: pos(d) is (|d| + d)/2, neg(d) is (|d| - d)/2."""
        for m in [*poly]:
            moving = [(x, n) for x, n in m if not self.domain.constant(x)]
            if len(moving) == 1 and moving[0][1] == 1 and (ramp := moving[0][0]).op in ("pos", "neg") and m in poly:
                size, way = Term("abs", ramp.args), HALF if ramp.op == "pos" else minus(HALF)
                both = self._poly(sum_of(product_of(HALF, size), product_of(way, ramp.args[0])))
                linear = {k: c for k, c in poly.items() if dict(k).get(ramp) == 1 and sum(not self.domain.constant(x) for x, _ in k) == 1}
                rest = {k: c for k, c in poly.items() if k not in linear}
                poly = total(rest, replaced(linear, ramp, both))
        return poly

    def _reduced(self, poly: Polynomial) -> Polynomial:
        """Even powers of roots, sizes and norms undone, and P divided out of quotients (q P)/P."""
        for x in sorted({x for m in poly for x, n in m if abs(n) >= 2}):
            rooted = x.op == "**" and x.args[1] == HALF
            if x.op in ("abs", "norm") or rooted:
                square = self._poly(x.args[0] if rooted else sum_of(*(product_of(a, a) for a in x.args)))
                found = list[Polynomial]()
                for power, part in grouped(poly, x.__eq__).items():
                    n = sum(n for _, n in power)
                    half = 0 if abs(n) > 2 * _HIGHEST and len(square) > 1 else (n + (n < 0)) // 2  # towards 0
                    own, left = self._times_power(part, square, half), n - 2 * half
                    found.append(times(own, {((x, left),): Fraction(1)}) if left else own)
                poly = total(*found)
        return self._divided_out(self._by_squares_of_ramps(self._with_fewer_ramps(self._without_signed_squares(poly))))

    def _with_fewer_ramps(self, poly: Polynomial) -> Polynomial:
        """pos(d) neg(d) is 0, pos(d)^n + neg(d)^n is d^n for even n > 0, and pos(d)^n is d^(n - 1) pos(d), where that leaves no pos(d)."""
        for up in sorted({x for m in poly for x, n in m if x.op == "pos" and n > 0}):
            down = Term("neg", up.args)
            poly = {m: c for m, c in poly.items() if not {(x, n > 0) for x, n in m} >= {(up, True), (down, True)}}
            for m in [*poly]:
                n = dict(m).get(up, 0)
                other = joined(tuple((x, k) for x, k in m if x != up), ((down, n),))
                if n > 0 and n % 2 == 0 and poly.get(other) == poly[m]:
                    whole = times({tuple((x, k) for x, k in m if x != up): poly[m]}, self._poly(Term("**", (up.args[0], number(n)))))
                    poly = total({k: c for k, c in poly.items() if k not in (m, other)}, whole)
            if (own := {m: c for m, c in poly.items() if dict(m).get(up, 0) > 0}) and len(own) > 1:
                d, parts = self._poly(up.args[0]), in_powers(own, up)
                if not total(*(self._times_power(part, d, n) for n, part in enumerate(parts[1:]))):
                    poly = {m: c for m, c in poly.items() if m not in own}
        return poly

    def _without_signed_squares(self, poly: Polynomial) -> Polynomial:
        """d |d| is pos(d)^2 - neg(d)^2."""
        for size in sorted({x for m in poly for x, n in m if x.op == "abs" and n == 1}):
            own = {m: c for m, c in poly.items() if dict(m).get(size) == 1}
            if (c := multiple(divided(own, ((size, 1),)), self._poly(size.args[0]), self.domain)) is not None:
                signed = total(_square("pos", size.args[0]), negated(_square("neg", size.args[0])))
                poly = total({m: a for m, a in poly.items() if m not in own}, times(c, signed))
        return poly

    def _by_squares_of_ramps(self, poly: Polynomial) -> Polynomial:
        """A quadratic form Q that is a sum of multiples of d^2 in one way, where pos(d)^2 and neg(d)^2 stand beside it, by these."""
        ups, downs = ({x.args for m in poly for x, n in m if x.op == word and n == 2} for word in ("pos", "neg"))
        squares = {d: self._poly(product_of(d, d)) for (d,) in sorted(ups & downs)}
        parts = by_forces(poly, self.domain)
        form = {m: c for m, c in parts.items() if all(x.op == "name" and n > 0 for x, n in m) and sum(n for _, n in m) == 2}
        if not form or not squares:
            return poly
        moving = dict.fromkeys([*form, *(m for own in squares.values() for m in own)])
        found = solved(({d: own.get(m, Fraction(0)) for d, own in squares.items()}, form.get(m, {})) for m in moving)
        if found is None or len(found) < len(squares):
            return poly
        ramps = (times(c, _square(word, d)) for d, c in found.items() for word in ("pos", "neg"))
        return total(poly, *(negated(times(c, {m: Fraction(1)})) for m, c in form.items()), *ramps)

    def _times_power(self, part: Polynomial, poly: Polynomial, n: int) -> Polynomial:
        """A polynomial times P^n."""
        factor = poly if n >= 0 else self._inverse(poly)
        return reduce(times, [factor] * abs(n), part)

    def _inverse(self, poly: Polynomial) -> Polynomial:
        """1/P, factors of all terms of P on their own."""
        if not poly:
            raise NotWritten("it divides by 0")
        own = shared(poly)
        first = abs(poly[min(poly)])
        atom = self.domain.polynomial(Term("**", (self._presented(divided(poly, own, first)), number(-1))))
        return divided(atom, own, first)

    def _in_forces(self, m: Monomial) -> Monomial:
        return tuple((x, n) for x, n in m if x.op == "name" and not self.domain.constant(x))

    def _is_word(self, x: Term) -> bool:
        return x.op != "name" and not self.domain.constant(x)

    def _divides(self, x: Term) -> bool:
        return self._is_word(x) and inverse_or_root(x) and x.args[1].value < 0

    def _divided_out(self, poly: Polynomial) -> Polynomial:
        """With q for (q P)/P, among the terms that have the same words beside the forces, and the same degree in these if P has one."""
        for x in sorted({x for m in poly for x, n in m if n > 0 and x.op == "**" and x.args[1] == number(-1)}):
            if not (by := self._poly(x.args[0])):
                continue
            alike = len({sum(n for _, n in self._in_forces(m)) for m in by}) == 1
            poly = self._without_a_word(poly, x, by)
            parts, groups = list[Polynomial](), dict[object, Polynomial]()
            for m, c in poly.items():
                words = tuple((y, n) for y, n in m if self._is_word(y))
                groups.setdefault((words, sum(n for _, n in self._in_forces(m)) if alike else 0), {})[m] = c
            for part in groups.values():
                while any(x in dict(m) for m in part) and (q := quotient(divided(part, ((x, 1),)), by)) is not None:
                    part = q
                parts += self._apart(part, x, by) if any(x in dict(m) for m in part) else [part]
            poly = total(*parts)
        return poly

    def _without_a_word(self, poly: Polynomial, x: Term, by: Polynomial) -> Polynomial:
        """q + R/P for N/P, where P is a w + b, N is q a w + c, and no word w is left in R = c - q b."""
        rest, numerator = ({m: c for m, c in poly.items() if (x in dict(m)) is over} for over in (False, True))
        numerator = divided(numerator, ((x, 1),))
        for w in sorted({y for m in by for y, n in m if n == 1 and self._is_word(y)}):
            if any(dict(m).get(w, 0) not in (0, 1) for m in (*by, *numerator)):
                continue
            (b, a), (c, *found) = in_powers(by, w), in_powers(numerator, w)
            if found and (q := quotient(found[0], a)):
                return total(rest, q, times(total(c, negated(times(q, b))), {((x, 1),): Fraction(1)}))
        return poly

    def _apart(self, poly: Polynomial, x: Term, by: Polynomial) -> list[Polynomial]:
        """N/P as s l + (N - s l P)/P: l is the mean of forces, and N grows by s P when all these grow alike."""
        mixed = sorted({y for m in by if len(own := self._in_forces(m)) > 1 for y, _ in own})
        numerator = divided(poly, ((x, 1),))
        if not mixed or any(n < 0 for m in numerator for y, n in m if y in mixed):
            return [poly]
        share = quotient(total(*(slope(numerator, y) for y in mixed)), by)
        if not share or not all(self.domain.constant(y) for m in share for y, _ in m):
            return [poly]
        linear = times(share, {((y, 1),): Fraction(1, len(mixed)) for y in mixed})
        return [linear, times(total(numerator, negated(times(linear, by))), {((x, 1),): Fraction(1)})]

    def _presented(self, poly: Polynomial) -> Term:
        """A polynomial as a sum, each product of forces and words once, with what it is multiplied by; a square as one, and N/P as one."""
        if (value := number_in(poly)) is not None:
            return number(value)
        poly = dict(sorted(poly.items()))
        if any(n == 2 for m in poly for x, n in m if not self.domain.constant(x)):
            if (square := self._square(poly)) is not None:
                return scaled(plainly(square[0]), ((square[1], 2),))
            if (squares := sum_of_squares(poly, self.domain)) is not None:
                return added([scaled(c, ((self._presented(y), 2),)) for c, y in squares])
            twice = {m: c for m, c in poly.items() if [n for x, n in m if self._is_word(x)] in ([2], [1, 1])}
            if 1 < len(twice) < len(poly) and (square := self._square(twice)) is not None:
                rest = self._presented(total(poly, negated(twice)))
                return sum_of(scaled(plainly(square[0]), ((square[1], 2),)), rest)
        fractions = {under: own for under, own in grouped(poly, self._divides).items() if under and len(own) > 1}
        poly = total(poly, *(negated(times(own, {under: Fraction(1)})) for under, own in fractions.items()))
        poly, parts = self._with_ramps(poly)
        parts += [scaled(self._presented(own), under) for under, own in fractions.items()]
        groups: dict[tuple[Monomial, int], Polynomial] = {}
        for moving, own in by_forces(poly, self.domain).items():
            words = tuple((x, n) for x, n in moving if x.op != "name")
            forces = tuple((x, n) for x, n in moving if x.op == "name")
            degree = sum(n for _, n in forces) if all(n > 0 for _, n in forces) else -1
            key = (words if degree >= 0 else moving, degree)
            groups[key] = total(groups.get(key, {}), times(own, {forces if degree >= 0 else (): Fraction(1)}))
        parts += [scaled(self._group(own), words) for (words, _), own in sorted(groups.items())]
        return added(parts)

    def _group(self, poly: Polynomial) -> Term:
        """A polynomial of one degree in the forces: what is common to all of it in front; a power of a sum, and the rest."""
        common = shared(poly, self.domain.constant)
        powers, rest = self._power_of_sum(divided(poly, common))
        return scaled(added([*powers, *(scaled(plainly(own), moving) for moving, own in by_forces(rest, self.domain).items())]), common)

    def _power_of_sum(self, poly: Polynomial) -> tuple[list[Term], Polynomial]:
        """c (x + ...)^n with a number c, n > 2, and what is left of a polynomial of this degree, where that is much less."""
        beside: Polynomial
        for x in sorted({x for m in poly for x, _ in m if not self.domain.constant(x)}):
            *_, beside, own = ({}, *in_powers(poly, x))
            n, c = max(dict(m).get(x, 0) for m in poly), number_in(own)
            if n > 2 and c and beside:
                base = total({((x, 1),): Fraction(1)}, times({(): 1 / (n * c)}, beside))
                rest = total(poly, reduce(times, [base] * n, {(): -c}))
                if 2 * len(rest) < len(poly):
                    return [scaled(number(c), ((self._group(base), n),))], rest
        return [], poly

    def _with_ramps(self, poly: Polynomial) -> tuple[Polynomial, list[Term]]:
        """c |d| + k d as (c + k) pos(d) + (c - k) neg(d) where that leaves less beside it, and the terms that it makes."""
        parts = list[Term]()
        for moving, c in by_forces(poly, self.domain).items():
            if len(moving) != 1 or moving[0][1] != 1 or (size := moving[0][0]).op != "abs":
                continue
            (d,), own = size.args, {joined(moving, m): a for m, a in c.items()}
            inner, rest = self._poly(d), total(poly, negated(own))
            shares, beside = by_forces(inner, self.domain), by_forces(rest, self.domain)
            along = total(*(times(beside.get(m, {}), {m: Fraction(1)}) for m in shares if m))
            tried = [c, negated(c), *([k] if (k := multiple(along, inner, self.domain)) else [])]
            left = {i: total(rest, negated(times(k, inner))) for i, k in enumerate(tried)}
            best = min(left, key=lambda i: len(left[i]))
            if len(left[best]) < len(rest):
                poly = left[best]
                scales = {"pos": total(c, tried[best]), "neg": total(c, negated(tried[best]))}
                parts += [scaled(plainly(scale), ((Term(word, (d,)), 1),)) for word, scale in scales.items() if scale]
        return poly, parts

    def _drawn_out(self, term: Term) -> Term:
        """r + c pos(d) as max(r, r + c d), r + c |d| as max(r + c d, r - c d), c > 0, where d is made of more than forces and constants."""
        if term.op != "+":
            return term
        for i, part in enumerate(term.args):
            c, moving = apart(part, self.domain)
            if len(moving) != 1 or moving[0].op not in ENDS:
                continue
            (d,) = moving[0].args
            poly, rest = self._poly(d), sum_of(*term.args[:i], *term.args[i + 1 :])
            plain = len(poly) < 4 and not any(self._is_word(x) for m in poly for x, _ in m)
            if plain or self.domain.facts(c).sign & NEGATIVE:
                continue
            values = [self._reduced(self._poly(sum_of(rest, product_of(c, d, number(k))))) for k in ENDS[moving[0].op]]
            *words, inside = (len({x for m in v for x, _ in m if self._is_word(x)}) for v in (*values, poly))
            if max(words) <= inside and sum(map(len, values)) <= 2 * len(poly) + len(self._poly(rest)):
                return self._extreme(Term("max", tuple(map(self._presented, values))))
        return term


def _as_written(term: Term) -> Term:
    """The term with the powers of sums that were kept."""
    args = tuple(map(_as_written, term.args))
    return Term("**", args) if term.op == _KEPT else term if args == term.args else term._replace(args=args)
