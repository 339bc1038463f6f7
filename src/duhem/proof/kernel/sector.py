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

from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from itertools import islice
from typing import NamedTuple

from duhem.proof.kernel.algebraic import Signs, inner, root_of, roots_in, slope_along
from duhem.proof.kernel.deviatoric import DeviatoricReader
from duhem.proof.kernel.domain import StatedDomain, StatedLaw, gap
from duhem.proof.kernel.invariants import Invariants, of_tensor
from duhem.proof.kernel.plane_function import PlaneFunction, derivatives, power_of
from duhem.proof.kernel.polynomial import ONE, Monomial, Polynomial, negated, number_in, times, total, written
from duhem.proof.kernel.positivity import RAY
from duhem.proof.kernel.section import meanings
from duhem.proof.kernel.shape import Facts, Shown, of_settled_parts
from duhem.proof.kernel.spectrum import entries_of, extremes
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

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


class _SectorReader(DeviatoricReader):
    """Functions of the principal deviators of one ``tensor``, in d/X; ``within`` has X and d among the forces."""

    weights = (ONE, {}, {})

    def __init__(self, domain: StatedDomain, wider: StatedDomain, shown: Shown, over: Over, tensor: _Tensor) -> None:
        super().__init__(domain, shown, wider)
        self.over, self.tensor, self.signs = over, tensor, Signs(domain, (Fraction(0), _FAR))

    @property
    def second(self) -> Polynomial:
        return self.tensor.invariants.second

    def above(self, poly: Polynomial, strict: bool = False) -> bool:
        return self.signs.above(poly, strict)

    def along(self, poly: Polynomial) -> Polynomial:
        return slope_along(poly, self.domain)

    def rooted(self, poly: Polynomial) -> bool:
        return True

    def factors(self, poly: Polynomial) -> list[tuple[Polynomial, Polynomial]]:
        """The polynomial without the roots that it divides by, and these."""
        left, under = self.signs.split(poly)
        found = [(left, ONE)]
        for w, n in under.items():
            half: Polynomial = {(): Fraction(n, 2)}
            found.append((inner(w, self.domain), half))
        return found

    def convex(self, value: PlaneFunction) -> bool:
        """Whether p = poly prod F_i^(e_i) is convex in the sector, and no wall of it turns inward; F_i > 0."""
        opened = self.over(_opened(self.domain.law))
        signs = Signs(opened, (Fraction(0), _FAR))
        roots = {w for p in (value.poly, *map(dict, value.powers), *value.powers.values()) for w in roots_in(p)}
        if not all(signs.above(inner(w, opened), strict=True) for w in roots):
            return False
        found = derivatives(value, self.along)
        rate = self.plain(found.first)
        far = self.plain(total(times(value.poly, found.over), times({(): Fraction(-2)}, rate)))
        return signs.above(self.bend(value)) and signs.above(signs.at(rate, Fraction(0))) and signs.above(signs.at(far, _FAR))

    # -- reading -------------------------------------------------------------------------------------------------------

    def replaced(self, term: Term) -> Term:
        """With mean, X and d for principal values."""
        known = self.tensor.value(term, self.domain) if term.op in ("eigmax", "max", "min") else None
        return known or term._replace(args=tuple(map(self.replaced, term.args)))

    def of_word(self, term: Term) -> PlaneFunction:
        if term.op == "cos":
            return self.cosine(term.args[0])
        return self.choice(*term.args) if term.op == "where" else super().of_word(term)

    def of_polynomial(self, poly: Polynomial) -> PlaneFunction:
        """A polynomial of the forces, X and d: at X = 1, by J2 and J3."""
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
        return PlaneFunction(Fraction(degrees.pop() if degrees else 0), found, {})

    def cosine(self, angle: Term) -> PlaneFunction:
        """cos(acos(c)/3) with c = (3 sqrt(3)/2) J3/J2^(3/2) is (sqrt(3)/2) X/sqrt(J2)."""
        parts = factors(angle)
        inverse = [f for f in parts if f.op == "acos"]
        rest = self.domain.polynomial(product_of(*(f for f in parts if f.op != "acos")))
        if len(inverse) != 1 or rest not in ({(): Fraction(1, 3)}, {(): Fraction(-1, 3)}):
            raise NotWritten("a cosine is not of a third of an acos")
        c = self.read(inverse[0].args[0])
        three, ((w, _),) = root_of({(): Fraction(3)}), next(iter(root_of(_SECOND)))
        own = times(times(three, {((w, -3),): _FAR}), _THIRD)
        for base, e in c.powers.items():
            own = times(own, power_of(dict(base), -_whole(e)))
        if c.degree or self.signs.cleared(total(c.poly, negated(own))):
            raise NotWritten("an acos is of another argument")
        return PlaneFunction(Fraction(0), times(three, {((w, -1),): Fraction(1, 2)}), {}, False)

    def choice(self, condition: Term, one: Term, two: Term) -> PlaneFunction:
        """By what is 0 where the deviator is 0 and > 0 elsewhere: what is chosen elsewhere, if it is 0 there."""
        strict = len(condition.op) == 1
        size = self.read(gap(condition) if strict else minus(gap(condition)))
        away, here = (one, two) if strict else (two, one)
        if not (self.vanishes(size) and self.above(size.poly, strict=True)):
            raise NotWritten("a choice is by something else")
        value = self.read(away)
        nothing = not self.within.polynomial(here) and self.shown(here, self.within).defined
        if value.degree <= 0 or not (nothing or self.vanishes(self.read(here))):
            raise NotWritten("a choice leaves a jump")
        return value._replace(whole=True)


def _whole(exponent: Polynomial) -> int:
    """A whole number < 0."""
    n = number_in(exponent)
    if n is None or n.denominator > 1 or n > 0:
        raise NotWritten("a power is another")
    return int(n)


def _opened(law: StatedLaw) -> StatedLaw:
    """Without the ends of the parameters' ranges, where no constraint ties these."""
    if law.constraints:
        return law
    ends = {
        name: own._replace(open=True, open_high=True) if own.low is None or own.low != own.high else own
        for name, own in law.parameters.items()
    }
    return law._replace(parameters=ends)
