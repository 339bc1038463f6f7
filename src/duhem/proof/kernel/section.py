"""Functions of J2 and J3 alone, homogeneous in the stress: rho^k f(c), with rho = sqrt(J2) and c = cos 3 theta = (3 sqrt(3)/2) J3/J2^(3/2).

In the deviatoric plane rho f(cos 3 theta) is convex where f'' + f >= 0 in theta, that is 9 (1 - c^2) f'' - 9 c f' + f >= 0 for
-1 <= c <= 1; then so is the function of the tensor, being symmetric in its eigenvalues (Davis 1957, Arch. Math. 8, 276).  Where
J2 = 0, c has no value and rho^k f is 0, by continuity.  With f > 0 and another degree k > 0 this is asked of rho f^(1/k).

One section is no power of polynomials in c: rho cos(b - acos(gamma c)/3), 0 <= b <= pi/3, |gamma| <= 1 (Ottosen 1977; Bigoni, Piccolroaz
2004).  With phi = acos(gamma c)/3, f'' + f is (1 - gamma^2)/sin^3(3 phi) times cos(b - phi) sin(3 phi) + 3 sin(b - phi) cos(3 phi),
whose derivative in phi is -8 sin(b - phi) sin(3 phi), so that it is sin(3 b) >= 0 at least; |gamma| = 1 is a limit of such.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any, NamedTuple

from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.invariants import Invariants, invariants
from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, joined, slope, times, total, written
from duhem.proof.kernel.positivity import RAY, nonnegative
from duhem.proof.kernel.shape import Facts, Shown
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number

__all__ = ["apart_from_axis", "by_section", "without_sections"]

_ROOT = Term("**", (number(3), number(Fraction(1, 2))))
_THIRD_OF_C: Polynomial = {((RAY, 1), (_ROOT, 1)): Fraction(2, 9)}  # J3 = (2 sqrt(3)/9) c for J2 = 1
_ABOVE = Fraction(577350269190, 10**12)  # > 1/sqrt(3)
_PI = Term("name", name="pi")
_MOST_POWER = 12
Base = tuple[tuple[Any, Fraction], ...]  # a polynomial > 0, as its terms in order


class _Section(NamedTuple):
    """rho^degree times ``poly`` times positive polynomials in c, each to the power, a polynomial of constants, that ``powers`` gives."""

    degree: Fraction
    poly: Polynomial
    powers: Mapping[Base, Polynomial]


def by_section(term: Term, domain: StatedDomain, shown: Shown) -> Facts | None:
    """What is shown of a sum, product or power, the parts that are functions of J2 and J3 taken together by their degree."""
    found = (reader.facts(term) for reader in _readers(domain, shown))
    return next((known for known in found if known is not None and known.quasiconvex), None)


def without_sections(term: Term, domain: StatedDomain, shown: Shown) -> Iterator[Term]:
    """The term as it is where J2 = 0: with 0 for its functions of J2 and J3 of a degree above 0, as its parts may be read."""
    for reader in _readers(domain, shown):
        yield reader.emptied(term)


def apart_from_axis(g: Term, tip: Term, domain: StatedDomain, shown: Shown) -> bool:
    """Whether ``tip`` is 0 only where J2 = 0, and g, by continuity, is there a constant of one strict sign."""
    for reader in _readers(domain, shown):
        section, there = reader.read_or_none(tip), reader.emptied(g)
        if section is None or not domain.constant(there) or not reader.holds(section.poly, strict=True):
            continue
        value = shown(there, domain)
        if value.defined and value.sign in (NEGATIVE, POSITIVE):
            return True
    return False


def _readers(domain: StatedDomain, shown: Shown) -> Sequence[_SectionReader]:
    """One for each meaning of the forces in which some sum of the law is J2, and some sum J3 if there is such a meaning."""
    if "sections" not in domain.kept:
        sums = [*_sums(domain.law.g)]
        second, third = ([x for x in sums if _degree(x, domain) == k] for k in (2, 3))
        tried = (_SectionReader(domain, shown, meaning, {}) for meaning in invariants(domain.law.forces)) if second else ()
        found = [reader for reader in tried if any(map(reader.invariant, second))]
        domain.kept["sections"] = [reader for reader in found if any(map(reader.invariant, third))] or found[:2]
    readers: list[_SectionReader] = domain.kept["sections"]
    return readers


def _sums(term: Term) -> Iterator[Term]:
    if term.op == "+":
        yield term
    for a in term.args:
        yield from _sums(a)


def _degree(term: Term, domain: StatedDomain) -> int | None:
    """A bound on the degree of a polynomial in the forces, cheaply; None for what is none."""
    if domain.constant(term):
        return 0
    if term.op == "name":
        return 1
    parts = [_degree(a, domain) for a in term.args]
    if any(p is None for p in parts) or term.op not in ("+", "*", "**"):
        return None
    known = [p for p in parts if p is not None]
    if term.op != "**":
        return max(known) if term.op == "+" else sum(known)
    e = term.args[1]
    return known[0] * int(e.value) if e.op == "number" and e.value.denominator == 1 and e.value > 0 else None


@dataclass(frozen=True)
class _SectionReader:
    domain: StatedDomain
    shown: Shown
    meaning: Invariants
    known: dict[Term, _Section | None]  # what was read

    def invariant(self, term: Term) -> bool:
        """Whether a sum is a polynomial in J2 and J3."""
        return self.read_or_none(term) is not None

    # -- what is shown -------------------------------------------------------------------------------------------------

    def facts(self, term: Term) -> Facts | None:
        """None for a product or power that is no such function."""
        groups, moving, constants = dict[Fraction, list[_Section]](), list[Facts](), list[Facts]()
        for part in term.args if term.op == "+" else (term,):
            if self.domain.constant(part):
                constants.append(self.shown(part, self.domain))
            elif (known := self.lode(part)) is not None:
                moving.append(known)
            elif (section := self.read_or_none(part)) is not None and section.degree > 0:
                groups.setdefault(section.degree, []).append(section)
            elif term.op != "+":
                return None
            else:
                moving.append(self.shown(part, self.domain))
        moving += [self.together(sections) for sections in groups.values()]
        sign = 0
        for known in (*moving, *constants):
            sign |= known.sign
        convex = all(known.convex for known in moving)
        quasi = convex or (len(moving) == 1 and moving[0].quasiconvex)
        return Facts(all(known.defined for known in (*moving, *constants)), _of_sum(sign), convex, False, quasi)

    def together(self, sections: list[_Section]) -> Facts:
        """What is shown of a sum of one degree."""
        with suppress(NotWritten):
            return self.of_one(_total(sections))
        each = [self.of_one(section) for section in sections]
        convex, nonnegative_ = all(x.convex for x in each), all(x.nonnegative for x in each)
        return Facts(True, ZERO | POSITIVE | (0 if nonnegative_ else NEGATIVE), convex, False, convex)

    def of_one(self, section: _Section) -> Facts:
        with suppress(NotWritten):
            k = section.degree
            if k == 1:
                above = self.holds(section.poly)
                sign = ZERO | POSITIVE | (0 if above else NEGATIVE)
                convex = self.holds(_bend(section.poly, section.powers))
                return Facts(True, sign, convex, False, convex)
            if self.holds(section.poly, strict=True):
                root = _times_powers(_with(section.powers, section.poly, ONE), {(): 1 / k})
                convex = self.holds(_bend(ONE, root))
                return Facts(True, ZERO | POSITIVE, convex and k > 1, False, convex)
        return Facts(True)

    def lode(self, term: Term) -> Facts | None:
        """Of a multiple of rho cos(b - acos(gamma c)/3)."""
        parts = factors(term)
        waves = [f for f in parts if f.op == "cos" and not self.domain.constant(f)]
        if len(waves) != 1:
            return None
        with suppress(NotWritten):
            parts.remove(waves[0])
            rest = self.read(Term("*", (number(1), *parts)))
            if rest.degree != 1 or rest.powers or any(x == RAY for m in rest.poly for x, _ in m):
                return None
            scale, offset = self.shown(written(rest.poly), self.domain), self.offset(waves[0].args[0])
            inside = all(not self.shown(x, self.domain).sign & NEGATIVE for x in (offset, Term("+", (_third_of_pi(), minus(offset)))))
            if inside and scale.nonnegative and self.shown(offset, self.domain).defined:
                return Facts(scale.defined, ZERO | POSITIVE, True, False, True)
        return None

    def offset(self, angle: Term) -> Term:
        """b where the angle is b - acos(gamma c)/3 or its negative, |gamma| <= 1; acos z may stand as pi/2 - atan(z/sqrt(1 - z^2))."""
        poly = self.domain.polynomial(angle)
        inverse = {x for m in poly for x, _ in m if not self.domain.constant(x)}
        if len(inverse) != 1 or (x := inverse.pop()).op not in ("acos", "atan"):
            raise NotWritten("an angle is no third of an acos")
        base, *higher = in_powers(poly, x)
        third = higher[0].get((), Fraction(0)) if len(higher) == 1 and set(higher[0]) == {()} else Fraction(0)
        if abs(third) != Fraction(1, 3):
            raise NotWritten("an angle is no third of an acos")
        z = self.read(x.args[0])
        towards = Fraction(-1 if x.op == "acos" else 1) / third / 3  # 1 where the angle is b - acos/3 as it stands
        b = {m: c * towards for m, c in base.items()}
        if x.op == "atan":
            b = total(b, {((_PI, 1),): Fraction(1, 6)})
            square = total(ONE, {m: -c for m, c in times(z.poly, z.poly).items()})
            if z.powers != {_base(square): {(): Fraction(-1, 2)}}:
                raise NotWritten("an atan is no acos")
        elif z.powers:
            raise NotWritten("an acos is of another argument")
        rate = in_powers(z.poly, RAY)
        if z.degree != 0 or len(rate) != 2 or rate[0]:
            raise NotWritten("an acos is of another argument")
        for side in (rate[1], {m: -c for m, c in rate[1].items()}):
            if not self.holds(total(ONE, side)):
                raise NotWritten("an acos may have no value")
        return written(b)

    def emptied(self, term: Term) -> Term:
        if self.domain.constant(term) or term.op == "name":
            return term
        section = self.read_or_none(term)
        if self.lode(term) is not None or (section is not None and section.degree > 0):
            return number(0)
        return term._replace(args=tuple(map(self.emptied, term.args)))

    # -- reading -------------------------------------------------------------------------------------------------------

    def read_or_none(self, term: Term) -> _Section | None:
        if term not in self.known:
            self.known[term] = None
            with suppress(NotWritten):
                self.known[term] = self._read(term)
        return self.known[term]

    def read(self, term: Term) -> _Section:
        """NotWritten where it is no such function."""
        if (known := self.read_or_none(term)) is None:
            raise NotWritten("it is no function of J2 and J3")
        return known

    def _read(self, term: Term) -> _Section:
        if self.domain.constant(term):
            if not self.shown(term, self.domain).defined:
                raise NotWritten("a constant may be undefined")
            return _Section(Fraction(0), _reduced(self.domain.polynomial(term)), {})
        if _degree(term, self.domain) is not None:
            k, shares = self.meaning.of(self.domain.polynomial(term))
            return _Section(Fraction(k), total(*(times(a, _raised(_THIRD_OF_C, j)) for j, a in shares.items())), {})
        match term.op:
            case "+":
                return _total([self.read(a) for a in term.args])
            case "*":
                parts = factors(term)
                plain = [f for f in parts if _degree(f, self.domain) is not None]
                read = [self.read(f) for f in parts if f not in plain]
                return _product([self.read(Term("*", (number(1), *plain))), *read] if plain else read)
            case "**":
                return self.power(self.read(term.args[0]), term.args[1])
        raise NotWritten(f"{term.op} is not read in J2 and J3")

    def power(self, base: _Section, exponent: Term) -> _Section:
        e = self.domain.polynomial(exponent)
        known = e.get((), Fraction(0)) if set(e) <= {()} else None
        if not (self.domain.constant(exponent) and self.shown(exponent, self.domain).defined) or (known is None and base.degree):
            raise NotWritten("an exponent varies")
        if known is not None and known.denominator == 1 and 0 <= known <= _MOST_POWER:
            return _product([base] * int(known))
        if not self.holds(base.poly, strict=True):
            raise NotWritten("what is divided by or under a root may be <= 0")
        degree = base.degree * known if known is not None else Fraction(0)
        if set(base.poly) == {()} and known is not None and known.denominator <= 2:  # a number, perhaps a root of one
            number_ = _reduced({((Term("**", (number(base.poly[()]), number(Fraction(1, 2)))), int(2 * known)),): Fraction(1)})
            return _Section(degree, number_, _times_powers(base.powers, e))
        return _Section(degree, ONE, _times_powers(_with(base.powers, base.poly, ONE), e))

    def holds(self, poly: Polynomial, strict: bool = False) -> bool:
        """Whether it is >= 0, or > 0, for -1 <= c <= 1 over the whole domain."""
        poly = _reduced(poly)
        whole = {dict(m).get(_ROOT, 0) % 2 for m in poly}
        if whole == {1}:  # a multiple of sqrt(3)
            poly = _reduced({joined(m, ((_ROOT, -1),)): c for m, c in poly.items()})
        elif len(whole) == 2:  # c = sqrt(3) w
            turned = _reduced({joined(m, ((_ROOT, dict(m).get(RAY, 0)),)): c for m, c in poly.items()})
            odd = {dict(m).get(_ROOT, 0) % 2 for m in turned}
            if len(odd) == 2:
                raise NotWritten("sqrt(3) stands in some coefficients alone")
            turned = _reduced({joined(m, ((_ROOT, -1),)): c for m, c in turned.items()}) if odd == {1} else turned
            return nonnegative(turned, (-_ABOVE, _ABOVE), self.domain, strict)
        return nonnegative(poly, (Fraction(-1), Fraction(1)), self.domain, strict)


def _of_sum(signs: Sign) -> Sign:
    """The signs of a sum of parts that together have ``signs``."""
    return ANY if signs & NEGATIVE and signs & POSITIVE else signs


def _third_of_pi() -> Term:
    return Term("*", (number(Fraction(1, 3)), _PI))


# -- sections as values ------------------------------------------------------------------------------------------------


def _bend(poly: Polynomial, powers: Mapping[Base, Polynomial]) -> Polynomial:
    """A positive multiple of 9 (1 - c^2) f'' - 9 c f' + f for f = P W, W = prod F_i^(e_i): with W'/W = N/D, D = prod F_i."""
    bases = [dict(base) for base in powers]
    d, n = ONE, dict[Any, Fraction]()
    for base in bases:
        d = times(d, base)
    for i, e in enumerate(powers.values()):
        part = times(e, slope(bases[i], RAY))
        for j, base in enumerate(bases):
            part = part if i == j else times(part, base)
        n = total(n, part)
    first, second = slope(poly, RAY), slope(slope(poly, RAY), RAY)
    square = times(d, d)
    rate = total(times(first, square), times(poly, times(n, d)))  # D^2 f'/W
    spread = total(times(slope(n, RAY), d), _scaled(-1, times(n, slope(d, RAY))), times(n, n))
    bend = total(times(second, square), _scaled(2, times(first, times(n, d))), times(poly, spread))  # D^2 f''/W
    weight: Polynomial = {(): Fraction(9), ((RAY, 2),): Fraction(-9)}
    return total(times(weight, bend), times({((RAY, 1),): Fraction(-9)}, rate), times(poly, square))


def _product(sections: Iterable[_Section]) -> _Section:
    degree, poly, powers = Fraction(0), ONE, dict[Base, Polynomial]()
    for section in sections:
        degree, poly = degree + section.degree, _reduced(times(poly, section.poly))
        for base, e in section.powers.items():
            powers[base] = total(powers.get(base, {}), e)
    return _Section(degree, poly, {base: e for base, e in powers.items() if e})


def _total(sections: list[_Section]) -> _Section:
    """NotWritten where they have different degrees or roots; a whole power that one has and another lacks is multiplied out."""
    sections = [section for section in sections if section.poly] or sections[:1]
    degree = sections[0].degree
    if any(section.degree != degree for section in sections):
        raise NotWritten("different degrees are added")
    shared: dict[Base, Polynomial] = {}
    for base in {base for section in sections for base in section.powers}:
        powers = [section.powers.get(base, {}) for section in sections]
        apart = [total(e, _scaled(-1, powers[0])) for e in powers]
        if not all(set(e) <= {()} and e.get((), Fraction(0)).denominator == 1 for e in apart):
            raise NotWritten("different roots are added")
        shared[base] = total(powers[0], {(): min(e.get((), Fraction(0)) for e in apart)})
    poly: Polynomial = {}
    for section in sections:
        part = section.poly
        for base, least in shared.items():
            left = total(section.powers.get(base, {}), _scaled(-1, least)).get((), Fraction(0))
            part = times(part, _raised(dict(base), int(left)))
        poly = total(poly, part)
    return _Section(degree, _reduced(poly), {base: e for base, e in shared.items() if e})


def _with(powers: Mapping[Base, Polynomial], poly: Polynomial, e: Polynomial) -> dict[Base, Polynomial]:
    """With one positive polynomial more."""
    base = _base(poly)
    found = {**powers, base: total(powers.get(base, {}), e)}
    return {b: n for b, n in found.items() if n and dict(b) != ONE}


def _times_powers(powers: Mapping[Base, Polynomial], e: Polynomial) -> dict[Base, Polynomial]:
    return {base: times(n, e) for base, n in powers.items()}


def _raised(poly: Polynomial, n: int) -> Polynomial:
    if n > _MOST_POWER:
        raise NotWritten("a power is too high")
    found = ONE
    for _ in range(n):
        found = times(found, poly)
    return _reduced(found)


def _scaled(factor: int, poly: Polynomial) -> Polynomial:
    return {m: factor * c for m, c in poly.items()}


def _base(poly: Polynomial) -> Base:
    return tuple(sorted(poly.items()))


def _reduced(poly: Polynomial) -> Polynomial:
    """With sqrt(3)^2 = 3, and numbers or sqrt(3) in the place of roots of squares or of 3 times a square."""
    found: Polynomial = {}
    for m, c in poly.items():
        left, power = list[tuple[Term, int]](), 0
        for x, n in m:
            share, odd = _share(x)
            if share == 0:
                left.append((x, n))
            else:
                power, c = power + n * odd, c * share**n
        odd = power % 2
        c *= Fraction(3) ** ((power - odd) // 2)
        found = total(found, {tuple(sorted([*left, (_ROOT, 1)] if odd else left)): c})
    return found


def _share(x: Term) -> tuple[Fraction, int]:
    """(q, 1) where x = q sqrt(3) and (q, 0) where x = q, for the root of a number; else (0, 0)."""
    if x.op == "**" and x.args[0].op == "number" and x.args[1] == _ROOT.args[1] and x.args[0].value > 0:
        for odd, square in enumerate((x.args[0].value, x.args[0].value / 3)):
            root = Fraction(isqrt(square.numerator), isqrt(square.denominator))
            if root * root == square:
                return root, odd
    return Fraction(0), 0
