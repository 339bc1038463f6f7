"""Functions of J2 and J3 alone, homogeneous in the stress: rho^k f(c), with rho = sqrt(J2) and c = cos 3 theta = (3 sqrt(3)/2) J3/J2^(3/2).

In the deviatoric plane rho f(cos 3 theta) is convex where f'' + f >= 0 in theta, that is 9 (1 - c^2) f'' - 9 c f' + f >= 0 for
-1 <= c <= 1; then so is the function of the tensor, being symmetric in its eigenvalues (Davis 1957, Arch. Math. 8, 276).  Where
J2 = 0, c has no value and rho^k f is 0, by continuity.  With f > 0 and another degree k > 0 this is asked of rho f^(1/k).

One section is no power of polynomials in c: rho cos(b - acos(gamma c)/3), 0 <= b <= pi/3, |gamma| <= 1 (Ottosen 1977; Bigoni, Piccolroaz
2004).  With phi = acos(gamma c)/3, f'' + f is (1 - gamma^2)/sin^3(3 phi) times cos(b - phi) sin(3 phi) + 3 sin(b - phi) cos(3 phi),
whose derivative in phi is -8 sin(b - phi) sin(3 phi), so that it is sin(3 b) >= 0 at least; |gamma| = 1 is a limit of such.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction

from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.invariants import Invariants, invariants
from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, joined, times, total, written
from duhem.proof.kernel.positivity import RAY, negated, nonnegative
from duhem.proof.kernel.section_value import (
    MOST_POWER,
    ROOT,
    SectionValue,
    added,
    base_of,
    bend,
    multiplied,
    power_of,
    raised_to,
    reduced,
    widened,
)
from duhem.proof.kernel.shape import Facts, Shown, of_settled_parts, of_sum
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, factors, minus, number

__all__ = ["by_section", "meanings", "section_readers"]

_THIRD_OF_C: Polynomial = {((RAY, 1), (ROOT, 1)): Fraction(2, 9)}  # J3 = (2 sqrt(3)/9) c for J2 = 1
_ABOVE = Fraction(577350269190, 10**12)  # > 1/sqrt(3)
_PI = Term("name", name="pi")


def by_section(term: Term, domain: StatedDomain, shown: Shown) -> Facts | None:
    """What is shown of a sum, product or power, the parts that are functions of J2 and J3 taken together by their degree."""
    found = (reader.facts(term) for reader in section_readers(term, domain, shown))
    return next((known for known in found if known is not None and known.quasiconvex), None)


def meanings(domain: StatedDomain, shown: Shown) -> list[Invariants]:
    """J2 and J3 of the tensors that the forces may be."""
    return [reader.meaning for reader in _readers(domain, shown)]


def section_readers(term: Term, domain: StatedDomain, shown: Shown) -> Sequence[_SectionReader]:
    """Of the law's formulas; none for one of which a constant may have no value."""
    readers = _readers(domain, shown)
    return readers if readers and of_settled_parts(term, domain, shown) else ()


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
    known: dict[Term, SectionValue | None]  # what was read

    def invariant(self, term: Term) -> bool:
        """Whether a sum is a polynomial in J2 and J3."""
        return self.read_or_none(term) is not None

    # -- what is shown -------------------------------------------------------------------------------------------------

    @property
    def second(self) -> Polynomial:
        """J2."""
        return self.meaning.second

    def sign(self, term: Term) -> Sign:
        """The signs that such a function may have where J2 is not 0."""
        with suppress(NotWritten):
            poly = self.read(term).poly
            for turned, sign in ((poly, POSITIVE), (negated(poly), NEGATIVE)):
                if self.holds(turned):
                    return sign if self.holds(turned, strict=True) else sign | ZERO
        return ANY

    def facts(self, term: Term) -> Facts | None:
        """None for a product or power that is no such function."""
        groups, moving, constants = dict[Fraction, list[SectionValue]](), list[Facts](), list[Facts]()
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
        return of_sum(moving, constants)

    def together(self, sections: list[SectionValue]) -> Facts:
        """What is shown of a sum of one degree."""
        with suppress(NotWritten):
            return self.of_one(added(sections))
        return of_sum([self.of_one(section) for section in sections])

    def of_one(self, section: SectionValue) -> Facts:
        with suppress(NotWritten):
            k = section.degree
            if k == 1:
                above = self.holds(section.poly)
                sign = ZERO | POSITIVE | (0 if above else NEGATIVE)
                convex = self.holds(bend(section.poly, section.powers))
                return Facts(True, sign, convex, False, convex)
            if self.holds(section.poly, strict=True):
                root = raised_to(widened(section.powers, section.poly, ONE), {(): 1 / k})
                convex = self.holds(bend(ONE, root))
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
            if z.powers != {base_of(square): {(): Fraction(-1, 2)}}:
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
        """The term where J2 = 0: with 0 for such functions of a degree above 0."""
        if self.domain.constant(term) or term.op == "name" or term.op in COMPARISONS:  # what is compared may have another sign beside it
            return term
        section = self.read_or_none(term)
        if self.lode(term) is not None or (section is not None and section.degree > 0):
            return number(0)
        return term._replace(args=tuple(map(self.emptied, term.args)))

    # -- reading -------------------------------------------------------------------------------------------------------

    def read_or_none(self, term: Term) -> SectionValue | None:
        if term not in self.known:
            self.known[term] = None
            with suppress(NotWritten):
                self.known[term] = self._read(term)
        return self.known[term]

    def read(self, term: Term) -> SectionValue:
        """NotWritten where it is no such function."""
        if (known := self.read_or_none(term)) is None:
            raise NotWritten("it is no function of J2 and J3")
        return known

    def _read(self, term: Term) -> SectionValue:
        if self.domain.constant(term):
            if not self.shown(term, self.domain).defined:
                raise NotWritten("a constant may be undefined")
            return SectionValue(Fraction(0), reduced(self.domain.polynomial(term)), {})
        if _degree(term, self.domain) is not None:
            k, shares = self.meaning.of(self.domain.polynomial(term))
            return SectionValue(Fraction(k), total(*(times(a, power_of(_THIRD_OF_C, j)) for j, a in shares.items())), {})
        match term.op:
            case "+":
                return added([self.read(a) for a in term.args])
            case "*":
                parts = factors(term)
                plain = [f for f in parts if _degree(f, self.domain) is not None]
                read = [self.read(f) for f in parts if f not in plain]
                return multiplied([self.read(Term("*", (number(1), *plain))), *read] if plain else read)
            case "**":
                return self.power(self.read(term.args[0]), term.args[1])
        raise NotWritten(f"{term.op} is not read in J2 and J3")

    def power(self, base: SectionValue, exponent: Term) -> SectionValue:
        e = self.domain.polynomial(exponent)
        known = e.get((), Fraction(0)) if set(e) <= {()} else None
        if not (self.domain.constant(exponent) and self.shown(exponent, self.domain).defined) or (known is None and base.degree):
            raise NotWritten("an exponent varies")
        if known is not None and known.denominator == 1 and 0 <= known <= MOST_POWER:
            return multiplied([base] * int(known))
        if not self.holds(base.poly, strict=True):
            raise NotWritten("what is divided by or under a root may be <= 0")
        degree = base.degree * known if known is not None else Fraction(0)
        if set(base.poly) == {()} and known is not None and known.denominator <= 2:  # a number, perhaps a root of one
            number_ = reduced({((Term("**", (number(base.poly[()]), number(Fraction(1, 2)))), int(2 * known)),): Fraction(1)})
            return SectionValue(degree, number_, raised_to(base.powers, e))
        return SectionValue(degree, ONE, raised_to(widened(base.powers, base.poly, ONE), e))

    def holds(self, poly: Polynomial, strict: bool = False) -> bool:
        """Whether it is >= 0, or > 0, for -1 <= c <= 1 over the whole domain."""
        poly = reduced(poly)
        whole = {dict(m).get(ROOT, 0) % 2 for m in poly}
        if whole == {1}:  # a multiple of sqrt(3)
            poly = reduced({joined(m, ((ROOT, -1),)): c for m, c in poly.items()})
        elif len(whole) == 2:  # c = sqrt(3) w
            turned = reduced({joined(m, ((ROOT, dict(m).get(RAY, 0)),)): c for m, c in poly.items()})
            odd = {dict(m).get(ROOT, 0) % 2 for m in turned}
            if len(odd) == 2:
                raise NotWritten("sqrt(3) stands in some coefficients alone")
            turned = reduced({joined(m, ((ROOT, -1),)): c for m, c in turned.items()}) if odd == {1} else turned
            return nonnegative(turned, (-_ABOVE, _ABOVE), self.domain, strict)
        return nonnegative(poly, (Fraction(-1), Fraction(1)), self.domain, strict)


def _third_of_pi() -> Term:
    return Term("*", (number(Fraction(1, 3)), _PI))
