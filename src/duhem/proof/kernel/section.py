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
from fractions import Fraction

from duhem.proof.kernel.deviatoric import DeviatoricReader
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.forms import degree_at_most
from duhem.proof.kernel.invariants import Invariants, invariants
from duhem.proof.kernel.plane_function import PlaneFunction, base_of, power_of
from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, joined, negated, number_in, times, total, written
from duhem.proof.kernel.positivity import RAY, nonnegative
from duhem.proof.kernel.shape import Facts, Shown, of_settled_parts
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number

__all__ = ["by_section", "meanings", "section_readers"]

_ROOT = Term("**", (number(3), number(Fraction(1, 2))))
_THIRD_OF_C: Polynomial = {((RAY, 1), (_ROOT, 1)): Fraction(2, 9)}  # J3 = (2 sqrt(3)/9) c for J2 = 1
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
        second, third = ([x for x in sums if degree_at_most(x, domain) == k] for k in (2, 3))
        tried = (_SectionReader(domain, shown, meaning) for meaning in invariants(domain.law.forces)) if second else ()
        found = [reader for reader in tried if any(map(reader.invariant, second))]
        domain.kept["sections"] = [reader for reader in found if any(map(reader.invariant, third))] or found[:2]
    readers: list[_SectionReader] = domain.kept["sections"]
    return readers


def _sums(term: Term) -> Iterator[Term]:
    if term.op == "+":
        yield term
    for a in term.args:
        yield from _sums(a)


class _SectionReader(DeviatoricReader):
    """Functions of J2 and J3 of one ``meaning`` of the forces, in c = cos 3 theta; J2 = 0 is where they are 0 by continuity."""

    by_continuity = True
    weights = ({(): Fraction(9), ((RAY, 2),): Fraction(-9)}, {((RAY, 1),): Fraction(-9)}, ONE)

    def __init__(self, domain: StatedDomain, shown: Shown, meaning: Invariants) -> None:
        super().__init__(domain, shown)
        self.meaning = meaning

    @property
    def second(self) -> Polynomial:
        return self.meaning.second

    def invariant(self, term: Term) -> bool:
        """Whether a sum is a polynomial in J2 and J3."""
        return self.value(term) is not None

    def of_wave(self, term: Term) -> Facts | None:
        """What is shown of a multiple of rho cos(b - acos(gamma c)/3)."""
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
        third = number_in(higher[0]) if len(higher) == 1 else None
        if third is None or abs(third) != Fraction(1, 3):
            raise NotWritten("an angle is no third of an acos")
        z = self.read(x.args[0])
        towards = Fraction(-1 if x.op == "acos" else 1) / third / 3  # 1 where the angle is b - acos/3 as it stands
        b = {m: c * towards for m, c in base.items()}
        if x.op == "atan":
            b = total(b, {((_PI, 1),): Fraction(1, 6)})
            square = self.plain(total(ONE, negated(times(z.poly, z.poly))))
            if z.powers != {base_of(square): {(): Fraction(-1, 2)}}:
                raise NotWritten("an atan is no acos")
        elif z.powers:
            raise NotWritten("an acos is of another argument")
        rate = in_powers(z.poly, RAY)
        if z.degree != 0 or len(rate) != 2 or rate[0]:
            raise NotWritten("an acos is of another argument")
        for side in (rate[1], negated(rate[1])):
            if not self.above(total(ONE, side)):
                raise NotWritten("an acos may have no value")
        return written(b)

    def of_polynomial(self, poly: Polynomial) -> PlaneFunction:
        """A polynomial of J2 and J3, where J2 = 1."""
        k, shares = self.meaning.of(poly)
        return PlaneFunction(Fraction(k), total(*(times(a, power_of(_THIRD_OF_C, j)) for j, a in shares.items())), {})

    def rooted(self, poly: Polynomial) -> bool:
        """Only roots of numbers stand in polynomials."""
        return number_in(poly) is not None

    def above(self, poly: Polynomial, strict: bool = False) -> bool:
        """Whether it is >= 0, or > 0, for -1 <= c <= 1 over the whole domain; perhaps with c = sqrt(3) w."""
        turned: Polynomial = {joined(m, ((_ROOT, dict(m).get(RAY, 0)),)): c for m, c in poly.items()}
        for form, end in ((poly, Fraction(1)), (turned, _ABOVE)):
            form = self.plain(form)
            roots = {dict(m).get(_ROOT, 0) for m in form}
            if len(roots) < 2:
                return nonnegative({joined(m, ((_ROOT, -k),)): c for m, c in form.items() for k in roots}, (-end, end), self.domain, strict)
        raise NotWritten("sqrt(3) stands in some coefficients alone")


def _third_of_pi() -> Term:
    return Term("*", (number(Fraction(1, 3)), _PI))
