"""Homogeneous functions of the ordered principal values s1 >= s2 >= s3 of a deviator, over the sector of the plane where they lie.

With X = s1 and s2, s3 = -X/2 +- d, 0 <= d <= 3 X/2, it is J2 = 3 X^2/4 + d^2 and J3 = X^3/4 - X d^2.  A function F of degree 1 is
X p(d/X), and the five other sectors have its reflections.  F is convex where it is so around the origin, f'' + f >= 0 as a measure of
the angle: in the sector p'' >= 0, and no kink at a wall turns inward, p'(0) >= 0 and p(3/2) >= 2 p'(3/2).  Then so is the function of
the tensor (Davis 1957, Arch. Math. 8, 276), and of what the tensor is linear in.  With F > 0 of degree k > 0 this is asked of F^(1/k).

p may have roots of what is > 0 in the sector.  Where that is 0 for parameters at an end of their range alone, F is a limit of convex
functions.  Where X = 0 the formula needs a value of its own: N/D, 0/0 there, has none.  ``where(J2 > 0, N/D, 0)`` is 0; what is
rho^k f, f a function of the angle alone, is 0 by continuity, as in ``section``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import islice
from typing import NamedTuple

from duhem.proof.kernel.algebraic import Signs, inner, plain, root_of, roots_in, slope_along
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, StatedLaw, gap
from duhem.proof.kernel.invariants import Invariants, of_tensor
from duhem.proof.kernel.polynomial import ONE, Monomial, Polynomial, times, total, written
from duhem.proof.kernel.positivity import RAY, negated
from duhem.proof.kernel.section import meanings
from duhem.proof.kernel.section_value import MOST_POWER, Base, SectionValue, added, multiplied, power_of, raised_to, scaled, widened
from duhem.proof.kernel.shape import Facts, Shown, of_settled_parts, of_sum
from duhem.proof.kernel.spectrum import entries_of, extremes
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["by_sector", "sector_readers"]

Over = Callable[[StatedLaw], StatedDomain]
_FIRST, _GAP = (Term("name", name=name) for name in ("greatest deviator", "half of the others' gap"))  # no name of a law has blanks
_FAR = Fraction(3, 2)
_SECOND: Polynomial = {(): Fraction(3, 4), ((RAY, 2),): Fraction(1)}
_THIRD: Polynomial = {(): Fraction(1, 4), ((RAY, 2),): Fraction(-1)}
_MOST_PARTS = 6


def by_sector(term: Term, domain: StatedDomain, shown: Shown, over: Over) -> Facts | None:
    """What is shown of a sum, product, power or choice, its functions of principal deviators taken together by their degree."""
    for reader in sector_readers(term, domain, shown, over):
        with suppress(NotWritten):
            if (known := reader.facts(term)) is not None and known.quasiconvex:
                return known
    return None


class _Tensor(NamedTuple):
    """J2 and J3, the mean, and the entries by which its greatest and least principal value are told; None without such."""

    invariants: Invariants
    mean: Term
    entries: tuple[Polynomial, ...] | None = None

    def value(self, part: Term, domain: StatedDomain) -> Term | None:
        """A greatest or least principal value of this tensor, or of its negative, by mean, X and d."""
        for turned in (False, True):
            if self.entries is not None and entries_of(part, domain, turned) == self.entries:
                least = turned is (part.op != "min")
                away = [product_of(number(Fraction(-1, 2)), _FIRST), minus(_GAP)] if least else [_FIRST]
                return minus(sum_of(self.mean, *away)) if turned else sum_of(self.mean, *away)
        return None


class _Value(NamedTuple):
    """Where the deviator is not 0; ``whole`` if it is 0, or what it is near there, where the deviator is."""

    section: SectionValue
    whole: bool


def sector_readers(term: Term, domain: StatedDomain, shown: Shown, over: Over) -> list[_SectorReader]:
    """One for each tensor of which a greatest or least principal value stands in the term; else for what the forces may be."""
    if _FIRST.name in domain.law.forces or domain.constant(term) or not of_settled_parts(term, domain, shown):
        return []
    told = dict[object, Term]()
    for part in islice((part for part in dict.fromkeys(extremes(term)) if _is_linear(part, domain)), _MOST_PARTS):
        if _key(entries_of(part, domain, turned=True)) not in told:
            told.setdefault(_key(entries_of(part, domain)), part)
    kept: dict[object, list[_SectorReader]] = domain.kept.setdefault("sectors", {})
    found = list[_SectorReader]()
    for key, own in told.items() or [((), None)]:
        if key not in kept:
            wider = over(domain.law._replace(forces=(*domain.law.forces, _FIRST.name, _GAP.name)))
            tensors = [_told_by(own, domain)] if own is not None else [_Tensor(m, number(0)) for m in meanings(domain, shown)]
            kept[key] = [_SectorReader(domain, wider, shown, over, tensor) for tensor in tensors]
        found += kept[key]
    return found


def _key(entries: tuple[Polynomial, ...]) -> tuple[object, ...]:
    """The entries as a key."""
    return tuple(tuple(sorted(e.items())) for e in entries)


def _is_linear(part: Term, domain: StatedDomain) -> bool:
    """Whether every entry is a sum of multiples of the forces."""
    return not domain.constant(part) and all(
        [n for x, n in m if not domain.constant(x)] == [1] and all(x.op == "name" for x, _ in m if not domain.constant(x))
        for entry in entries_of(part, domain)
        for m in entry
    )


def _told_by(part: Term, domain: StatedDomain) -> _Tensor:
    entries, zero = entries_of(part, domain), dict[tuple[tuple[Term, int], ...], Fraction]()
    forces = tuple(Term("name", name=f) for f in domain.law.forces)
    mean = written({m: c / 3 for m, c in total(*entries[:3]).items()})
    return _Tensor(of_tensor(forces, entries[:3], entries[3:] or (zero, zero, zero)), mean, entries)


class _SectorReader:
    """``domain`` is the law's, ``wider`` has X and d among the forces."""

    def __init__(self, domain: StatedDomain, wider: StatedDomain, shown: Shown, over: Over, tensor: _Tensor) -> None:
        self.domain, self.wider, self.shown, self.over, self.tensor = domain, wider, shown, over, tensor
        self.signs = Signs(domain, (Fraction(0), _FAR))
        self.known: dict[Term, _Value | None] = {}  # what was read

    # -- what is shown -------------------------------------------------------------------------------------------------

    @property
    def second(self) -> Polynomial:
        """J2."""
        return self.tensor.invariants.second

    def sign(self, term: Term) -> Sign:
        """The signs that such a function may have where the deviator is not 0."""
        with suppress(NotWritten):
            poly = {} if (value := self.value(term)) is None else value.section.poly
            for turned, sign in ((poly, POSITIVE), (negated(poly), NEGATIVE)) if value is not None else ():
                if self.signs.above(turned):
                    return sign if self.signs.above(turned, strict=True) else sign | ZERO
        return ANY

    def facts(self, term: Term) -> Facts | None:
        """None for a product, power or choice that is no such function."""
        groups, whole, moving, constants = dict[Fraction, list[SectionValue]](), True, list[Facts](), list[Facts]()
        for part in term.args if term.op == "+" else (term,):
            if self.domain.constant(part):
                constants.append(self.shown(part, self.domain))
            elif (value := self.value(part)) is not None and value.section.degree > 0:
                groups.setdefault(value.section.degree, []).append(value.section)
                whole &= value.whole
            elif term.op != "+":
                return None
            else:
                moving.append(self.shown(part, self.domain))
        moving += [self.together(sections) for sections in groups.values()]
        known = of_sum(moving, constants)
        return replace(known, defined=known.defined and whole)

    def together(self, sections: list[SectionValue]) -> Facts:
        """What is shown of a sum of one degree."""
        with suppress(NotWritten):
            return self.of_one(added(sections))
        return of_sum([self.of_one(section) for section in sections])

    def of_one(self, section: SectionValue) -> Facts:
        """Of one function; its value where the deviator is 0 is 0."""
        k, poly, powers = section
        above = self.signs.above(poly)
        sign = ZERO | POSITIVE | (0 if above else NEGATIVE)
        if k != 1:
            if not self.signs.above(poly, strict=True):
                return Facts(True, sign)
            poly, powers = ONE, raised_to(widened(powers, poly, ONE), {(): 1 / k})
        bent = self.bent_outward(poly, powers)
        return Facts(True, sign, bent and k >= 1, False, bent)

    def bent_outward(self, poly: Polynomial, powers: Mapping[Base, Polynomial]) -> bool:
        """Whether p = poly prod F_i^(e_i) is convex in the sector, and no wall of it turns inward; F_i > 0."""
        opened = self.over(_opened(self.domain.law))
        signs = Signs(opened, (Fraction(0), _FAR))
        d, n = ONE, dict[Monomial, Fraction]()
        for base, e in powers.items():  # p'/p = poly'/poly + n/d
            f = dict(base)
            n = total(times(n, f), times(times(e, self.slope(f)), d))
            d = times(d, f)
        d, n = plain(d, opened), plain(n, opened)
        roots = {w for p in (poly, d, n) for w in roots_in(p)}
        if not all(signs.above(inner(w, opened), strict=True) for w in roots):
            return False
        first, second = self.slope(poly), self.slope(self.slope(poly))
        rate = self.sum(times(first, d), times(poly, n))  # d p' over prod F_i^(e_i)
        spread = self.sum(times(self.slope(n), d), scaled(-1, times(n, self.slope(d))), times(n, n))
        bend = self.sum(times(second, times(d, d)), scaled(2, times(first, times(n, d))), times(poly, spread))
        far = self.sum(times(poly, d), scaled(-2, rate))
        return signs.above(bend) and signs.above(signs.at(rate, Fraction(0))) and signs.above(signs.at(far, _FAR))

    def slope(self, poly: Polynomial) -> Polynomial:
        return slope_along(poly, self.domain)

    def sum(self, *parts: Polynomial) -> Polynomial:
        return plain(total(*parts), self.domain)

    # -- reading -------------------------------------------------------------------------------------------------------

    def value(self, term: Term) -> _Value | None:
        if term not in self.known:
            self.known[term] = None
            with suppress(NotWritten):
                self.known[term] = self._read(self.replaced(term))
        return self.known[term]

    def emptied(self, term: Term) -> Term:
        """The term where the deviator is 0: with 0 for such functions of a degree above 0 that have a value there."""
        if self.domain.constant(term) or term.op == "name" or term.op in COMPARISONS:  # what is compared may have another sign beside it
            return term
        value = self.value(term)
        if value is not None and value.section.degree > 0 and value.whole:
            return number(0)
        return term._replace(args=tuple(map(self.emptied, term.args)))

    def replaced(self, term: Term) -> Term:
        """With mean, X and d for principal values."""
        known = self.tensor.value(term, self.domain) if term.op in ("eigmax", "max", "min") else None
        return known or term._replace(args=tuple(map(self.replaced, term.args)))

    def _read(self, term: Term) -> _Value:
        if self.wider.constant(term):
            if not self.shown(term, self.domain).defined:
                raise NotWritten("a constant may be undefined")
            return _Value(SectionValue(Fraction(0), plain(self.domain.polynomial(term), self.domain), {}), True)
        if _is_polynomial(term, self.wider):
            return _Value(self.of_polynomial(self.wider.polynomial(term)), True)
        match term.op:
            case "+":
                values = [self._read(a) for a in term.args]
                return _Value(self.plain(added([v.section for v in values])), all(v.whole for v in values))
            case "*":
                return self.product(factors(term))
            case "**":
                return self.power(self._read(term.args[0]), term.args[1])
            case "cos":
                return self.cosine(term.args[0])
            case "where":
                return self.choice(*term.args)
        raise NotWritten(f"{term.op} is not read in principal values")

    def plain(self, section: SectionValue) -> SectionValue:
        return section._replace(poly=plain(section.poly, self.domain))

    def of_polynomial(self, poly: Polynomial) -> SectionValue:
        """One of the forces, X and d: at X = 1, by J2 and J3."""
        groups: dict[tuple[int, int], Polynomial] = {}
        for m, c in poly.items():
            own = dict(m)
            i, j = own.pop(_FIRST, 0), own.pop(_GAP, 0)
            groups.setdefault((i, j), {})[tuple(sorted(own.items()))] = c
        degrees, found = set[int](), dict[Monomial, Fraction]()
        for (i, j), rest in groups.items():
            k, shares = self.tensor.invariants.of(rest)
            degrees.add(i + j + k)
            for n, share in shares.items():
                part = times(power_of(_SECOND, (k - 3 * n) // 2), power_of(_THIRD, n))
                found = total(found, times(share, times(part, {((RAY, j),) if j else (): Fraction(1)})))
        if len(degrees) > 1:
            raise NotWritten("different degrees are added")
        return SectionValue(Fraction(degrees.pop() if degrees else 0), plain(found, self.domain), {})

    def product(self, parts: list[Term]) -> _Value:
        """Of factors; those of degree 0 are bounded, so that a product with what vanishes where the deviator is 0 does so too."""
        smooth = [f for f in parts if _is_polynomial(f, self.wider)]
        values = [self._read(f) for f in parts if f not in smooth]
        values += [self._read(product_of(*smooth))] if smooth else []
        whole = all(v.whole for v in values) or (
            all(v.whole or v.section.degree == 0 for v in values) and any(v.whole and v.section.degree > 0 for v in values)
        )
        return _Value(self.plain(multiplied([v.section for v in values])), whole)

    def power(self, base: _Value, exponent: Term) -> _Value:
        (degree, poly, powers), e = base.section, self.domain.polynomial(exponent)
        known = e.get((), Fraction(0)) if set(e) <= {()} else None
        if not (self.domain.constant(exponent) and self.shown(exponent, self.domain).defined) or (known is None and degree):
            raise NotWritten("an exponent varies")
        if known is not None and known.denominator == 1 and 0 < known <= MOST_POWER:
            return _Value(self.plain(multiplied([base.section] * int(known))), base.whole)
        halves = known is not None and known.denominator == 2 and abs(known) <= MOST_POWER
        if not self.signs.above(poly, strict=not (halves and known is not None and known > 0)):
            raise NotWritten("what is divided by, or under a root, may be <= 0")
        if not poly:
            raise NotWritten("a root of what is 0 everywhere")
        whole = base.whole and known is not None and known > 0
        if known is None:
            return _Value(SectionValue(degree, ONE, raised_to(widened(powers, poly, ONE), e)), base.whole)
        found, left = ONE, dict[Base, Polynomial]()
        poly, under = self.signs.split(poly)
        parts: list[tuple[Polynomial, Polynomial]] = [(poly, ONE)]
        parts += [(inner(w, self.domain), {(): Fraction(n, 2)}) for w, n in under.items()]
        for f, own in [*parts, *((dict(b), n) for b, n in powers.items())]:
            share = times(own, {(): known})
            half = share.get((), Fraction(0)) * 2 if set(share) <= {()} else Fraction(0)
            if half.denominator == 1 and half % 2 and abs(half) <= 2 * MOST_POWER:
                if any(RAY.name in w.names() for w in roots_in(f)):
                    raise NotWritten("a root stands under a root")
                ((root, scale),) = root_of(f).items()
                found = times(found, {tuple((x, n * int(half)) for x, n in root): scale ** int(half)})
            else:
                left = widened(left, f, share)
        return _Value(self.plain(SectionValue(degree * known, found, left)), whole)

    def cosine(self, angle: Term) -> _Value:
        """cos(acos(c)/3) with c = (3 sqrt(3)/2) J3/J2^(3/2) is (sqrt(3)/2) X/sqrt(J2)."""
        parts = factors(angle)
        inverse = [f for f in parts if f.op == "acos"]
        rest = self.domain.polynomial(product_of(*(f for f in parts if f.op != "acos")))
        if len(inverse) != 1 or rest not in ({(): Fraction(1, 3)}, {(): Fraction(-1, 3)}):
            raise NotWritten("a cosine is not of a third of an acos")
        c = self._read(inverse[0].args[0]).section
        three, ((w, _),) = root_of({(): Fraction(3)}), next(iter(root_of(_SECOND)))
        own = times(times(three, {((w, -3),): _FAR}), _THIRD)
        for base, e in c.powers.items():
            own = times(own, power_of(dict(base), -_whole(e)))
        if c.degree or self.signs.cleared(total(c.poly, negated(own))):
            raise NotWritten("an acos is of another argument")
        return _Value(SectionValue(Fraction(0), times(three, {((w, -1),): Fraction(1, 2)}), {}), False)

    def choice(self, condition: Term, one: Term, two: Term) -> _Value:
        """By what is 0 where the deviator is 0 and > 0 elsewhere: what is chosen elsewhere, if it is 0 there."""
        strict = len(condition.op) == 1
        size = self._read(gap(condition) if strict else minus(gap(condition)))
        away, here = (one, two) if strict else (two, one)
        if not (size.whole and size.section.degree > 0 and self.signs.above(size.section.poly, strict=True)):
            raise NotWritten("a choice is by something else")
        value = self._read(away)
        nothing = not self.wider.polynomial(here) and self.shown(here, self.wider).defined
        if value.section.degree <= 0 or not (nothing or self._vanishes(here)):
            raise NotWritten("a choice leaves a jump")
        return _Value(value.section, True)

    def _vanishes(self, term: Term) -> bool:
        value = self._read(term)
        return value.whole and value.section.degree > 0


def _whole(exponent: Polynomial) -> int:
    """A whole number < 0."""
    n = exponent.get((), Fraction(0))
    if set(exponent) != {()} or n.denominator > 1 or n > 0:
        raise NotWritten("a power is another")
    return int(n)


def _is_polynomial(term: Term, domain: StatedDomain) -> bool:
    if domain.constant(term) or term.op == "name":
        return True
    if term.op == "**":
        e = term.args[1]
        return e.op == "number" and e.value.denominator == 1 and e.value > 0 and _is_polynomial(term.args[0], domain)
    return term.op in ("+", "*") and all(_is_polynomial(a, domain) for a in term.args)


def _opened(law: StatedLaw) -> StatedLaw:
    """Without the ends of the parameters' ranges, where no constraint ties these."""
    if law.constraints:
        return law
    ends = {
        name: own._replace(open=True, open_high=True) if own.low is None or own.low != own.high else own
        for name, own in law.parameters.items()
    }
    return law._replace(parameters=ends)
