"""Homogeneous functions of the deviator of a tensor: of J2 and J3, of its ordered principal values, of the Lode angle.

The forces are components or principal values of a tensor.  Which ones is tried in the usual orders; that a polynomial of the forces is one
of J2 and J3 is confirmed as an identity, so that no name counts.

With X >= s2 >= s3 the principal deviators, s2, s3 = -X/2 +- d, it is J2 = 3 X^2/4 + d^2 and J3 = X^3/4 - X d^2.  In the plane of
(sqrt(3) X/2, d) they fill the sector 0 <= theta <= pi/3, whose rays are X = 3 - v^2, d = 3 v, sqrt(J2) = sqrt(3) N/2 with N = 3 + v^2 and
0 <= v <= 1; cos 3 theta = (3 sqrt(3)/2) J3/J2^(3/2) is (X^3 - 4 X d^2)/N^3.  The five other sectors have the reflections of a function F of
degree 1.  It is convex where it is so around the origin (:mod:`plane_function`): F'' + F >= 0 in the sector, and no kink at a wall of it
turns inward, F' >= 0 at v = 0 and F >= 2 F' at v = 1.  Then so is the function of the tensor (Davis 1957, Arch. Math. 8, 276), and of what
the tensor is linear in.  With F > 0 of degree k > 0 this is asked of F^(1/k); those of one degree that a sum adds up are taken together.

With theta = acos(c)/3, sin theta = 2 d/(sqrt(3) N) in the sector, so that cos(b - theta) with a constant b is such a function too.

F may have roots of what is > 0 in the sector.  Where that is 0 for parameters at an end of their range alone, F is a limit of convex
functions.  Where J2 = 0, what is rho^k f, k > 0, rho = sqrt(J2), is 0, by continuity: f is bounded.

One function is none of these: rho cos(b - acos(g c)/3), c = cos 3 theta, 0 <= b <= pi/3, |g| <= 1 (Ottosen 1977; Bigoni, Piccolroaz
2004).  With phi = acos(g c)/3, f'' + f is (1 - g^2)/sin^3(3 phi) times cos(b - phi) sin(3 phi) + 3 sin(b - phi) cos(3 phi),
whose derivative in phi is -8 sin(b - phi) sin(3 phi), so that it is sin(3 b) >= 0 at least; |g| = 1 is a limit of such.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property, reduce
from itertools import islice, permutations
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import Facts, of_sum
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, gap
from duhem.proof.kernel.forms import degree_at_most
from duhem.proof.kernel.plane_function import PlaneFunction, PlaneVariable, Signs, base_of, derivatives, inner, multiplied, power_of, sqrt
from duhem.proof.kernel.polynomial import ONE, Polynomial, grouped, in_powers, negated, number_in, solved, times, total, written
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.spectrum import entries_of, extremes
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = [
    "WALLS", "DeviatoricReader", "Invariants", "convex_in_deviator", "deviatoric_readers", "invariants", "of_tensor", "sign_in_deviator",
]  # fmt: skip

_HIGHEST = 12
_ALIKE = ("+", "abs", "pos", "neg", "norm", "max", "min", "eigmax")  # of one degree where their parts are


class Invariants(NamedTuple):
    """J2 = s:s/2 and J3 = det s of the deviator s, as polynomials of the forces."""

    forces: tuple[Term, ...]
    second: Polynomial
    third: Polynomial

    def of(self, poly: Polynomial) -> tuple[int, dict[int, Polynomial]]:
        """(k, a) with poly = sum of a_j J2^((k - 3 j)/2) J3^j, homogeneous in the forces; NotWritten where it is none of that."""
        degrees = {sum(n for x, n in m if x in self.forces) for m in poly}
        if len(degrees) != 1 or not 0 <= (k := degrees.pop()) <= _HIGHEST:
            raise NotWritten("a polynomial of the forces is not homogeneous")
        powers = [j for j in range(k // 3 + 1) if (k - 3 * j) % 2 == 0]
        terms = {j: reduce(times, (self.second,) * ((k - 3 * j) // 2) + (self.third,) * j, ONE) for j in powers}
        own = grouped(poly, self.forces.__contains__)
        moving = dict.fromkeys([*own, *(m for term in terms.values() for m in term)])
        found = solved(({j: term.get(m, Fraction(0)) for j, term in terms.items()}, own.get(m, {})) for m in moving)
        if found is None:
            raise NotWritten("a polynomial of the forces has other invariants than J2 and J3")
        return k, found


def invariants(forces: Sequence[str]) -> Iterator[Invariants]:
    """Those of the tensors that two to six forces may be: principal values, components in the plane or in space."""
    names = tuple(Term("name", name=f) for f in forces)
    x: list[Polynomial] = [{((name, 1),): Fraction(1)} for name in names]
    zero: Polynomial = {}
    if len(x) in (2, 3):
        yield of_tensor(names, (*x, zero)[:3], (zero, zero, zero))
    if len(x) in (3, 4):  # xx yy xy, xx yy zz xy
        yield of_tensor(names, (x[0], x[1], zero if len(x) == 3 else x[2]), (zero, zero, x[-1]))
    if len(x) == 6:
        for shear in permutations(x[3:]):
            yield of_tensor(names, x[:3], shear)


def of_tensor(forces: tuple[Term, ...], normal: Sequence[Polynomial], shear: Sequence[Polynomial]) -> Invariants:
    """Of the normal components xx, yy, zz and the shear components yz, zx, xy."""
    third = Fraction(1, 3)
    mean = {m: third * c for m, c in total(*normal).items()}
    xx, yy, zz = (total(s, negated(mean)) for s in normal)
    yz, zx, xy = shear
    second = total(*(times({(): Fraction(1, 2)}, times(s, s)) for s in (xx, yy, zz)), *(times(t, t) for t in shear))
    cross = (times(times(s, t), negated(t)) for s, t in ((xx, yz), (yy, zx), (zz, xy)))
    det = total(times(times(xx, yy), zz), times({(): Fraction(2)}, times(times(yz, zx), xy)), *cross)
    return Invariants(forces, second, det)


_FIRST, _GAP = (Term("name", name=name) for name in ("greatest deviator", "half of the others' gap"))  # no name of a law has blanks
_PI = Term("name", name="pi")
WALLS = Fraction(0), Fraction(1)
_NORM: Polynomial = {(): Fraction(3), ((RAY, 2),): Fraction(1)}
_X: Polynomial = {(): Fraction(3), ((RAY, 2),): Fraction(-1)}
_D: Polynomial = {((RAY, 1),): Fraction(3)}
_COSINE = times(_X, total(times(_X, _X), times({(): Fraction(-4)}, times(_D, _D))))  # cos 3 theta = this/N^3
_SECOND = times({(): Fraction(3, 4)}, times(_NORM, _NORM))
_THIRD = times({(): Fraction(1, 4)}, _COSINE)
_PER_CUBE: Mapping[Any, Polynomial] = {base_of(_NORM): {(): Fraction(-3)}}
_MOST_TENSORS = 6


def convex_in_deviator(term: Term, domain: StatedDomain) -> Facts | None:
    """What is shown of a sum, product, power or choice that is quasiconvex, its functions of a deviator taken together by their degree."""
    for reader in deviatoric_readers(term, domain):
        with suppress(NotWritten):
            if (known := reader.facts(term)) is not None and known.quasiconvex:
                return known
    return None


def sign_in_deviator(term: Term, domain: StatedDomain) -> Sign:
    """The signs that a sum may have, its functions of a deviator taken together by their degree."""
    found: Sign = ANY
    for reader in deviatoric_readers(term, domain):
        with suppress(NotWritten):
            value = reader.value(term)
            known = reader.facts(term) if value is None else Facts(sign=reader.sign(term) | (ZERO if value.degree > 0 else 0))
            found &= ANY if known is None else known.sign
    return found


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


def deviatoric_readers(term: Term, domain: StatedDomain) -> list[DeviatoricReader]:
    """One for each tensor that the forces may be, and for each of which a greatest or least principal value stands in the term.

    None for a formula of which a constant may have no value.
    """
    if domain.law.g.large or _FIRST.name in domain.law.forces or domain.constant(term):
        return []
    told = dict[object, Term]()
    for part in islice((part for part in dict.fromkeys(extremes(term)) if _is_linear(part, domain)), _MOST_TENSORS):
        if _key(entries_of(part, domain, turned=True)) not in told:
            told.setdefault(_key(entries_of(part, domain)), part)
    kept: dict[object, list[DeviatoricReader]] = domain.kept.setdefault("deviators", {})
    if () not in kept:
        kept[()] = _of_the_forces(domain)
    for key in told.keys() - kept.keys():
        kept[key] = [DeviatoricReader(domain, _told_by(told[key], domain))]
    found = [reader for key in (*told, ()) for reader in kept[key]]
    return found if found and _of_settled_parts(term, domain) else []


def _of_settled_parts(term: Term, domain: StatedDomain) -> bool:
    """Whether every constant in a formula, and all of which a greatest is taken, has a value, which does not jump with the parameters.

    Who multiplies out, or goes to the end of a parameter's range, would lose sight of that.
    """
    if domain.constant(term):
        return all(part.op != "atan2" for part in term.parts()) and domain.facts(term).defined
    if term.op == "where" and domain.constant(term.args[0]) and domain.decided(term.args[0]) is None:
        return False
    if term.op in ("max", "min", "eigmax") and not all(domain.facts(a).defined for a in term.args):
        return False
    return all(_of_settled_parts(a, domain) for a in term.args)


def _of_the_forces(domain: StatedDomain) -> list[DeviatoricReader]:
    """One for each meaning of the forces in which some sum of the law is J2, and some sum J3 if there is such a meaning."""
    sums = [part for part in domain.law.g.parts() if part.op == "+"]
    second, third = ([x for x in sums if degree_at_most(x, domain) == k] for k in (2, 3))
    meanings = invariants(domain.law.forces) if second else ()
    tried = (DeviatoricReader(domain, _Tensor(meaning, number(0))) for meaning in meanings)
    found = [reader for reader in tried if any(reader.value(x) is not None for x in second)]
    return [reader for reader in found if any(reader.value(x) is not None for x in third)] or found[:2]


def _opened(law: StatedLaw) -> StatedLaw:
    """The law without the ends of its parameters' ranges."""
    ends = {name: own if own.single else own._replace(open=True, open_high=True) for name, own in law.parameters.items()}
    return law._replace(parameters=ends)


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
    entries, zero = entries_of(part, domain), Polynomial()
    forces = tuple(Term("name", name=f) for f in domain.law.forces)
    mean = written({m: c / 3 for m, c in total(*entries[:3]).items()})
    return _Tensor(of_tensor(forces, entries[:3], entries[3:] or (zero, zero, zero)), mean, entries)


class DeviatoricReader(PlaneVariable):
    """Reads formulas over a ``domain`` as functions of one ``tensor``; ``within`` has X and d among the forces, if they are told."""

    far, rooted = 3, True

    def __init__(self, domain: StatedDomain, tensor: _Tensor) -> None:
        self.domain, self.tensor = domain, tensor
        told = tensor.entries is not None
        self.within = domain.wider(_FIRST.name, _GAP.name) if told else domain
        self.signs = Signs(domain, WALLS)
        self.known: dict[Term, PlaneFunction | None] = {}  # what was read

    @property
    def second(self) -> Polynomial:
        """J2 of the tensor, in the forces."""
        return self.tensor.invariants.second

    def above(self, poly: Polynomial, strict: bool = False) -> bool:
        return self.signs.above(poly, strict)

    def factors(self, poly: Polynomial) -> list[tuple[Polynomial, Polynomial]]:
        """Those of the polynomial without the roots that it divides by, and what stands under these."""
        left, under = self.signs.split(poly)
        halves: list[Polynomial] = [{(): Fraction(n, 2)} for n in under.values()]
        return [*super().factors(left), *zip((inner(w, self.domain) for w in under), halves, strict=True)]

    # -- what is shown -------------------------------------------------------------------------------------------------

    def facts(self, term: Term) -> Facts | None:
        """What is shown of a term; None for a product, power or choice that is no such function."""
        groups, moving, constants = dict[Fraction, list[PlaneFunction]](), list[Facts](), list[Facts]()
        for part in term.args if term.op == "+" else (term,):
            if self.domain.constant(part):
                constants.append(self.domain.facts(part))
            elif (wave := self.of_wave(part)) is not None:
                moving.append(wave)
            elif (value := self.value(part)) is not None and value.degree > 0:
                groups.setdefault(value.degree, []).append(value)
            elif term.op != "+":
                return self.of_root(term)
            else:
                moving.append(self.domain.facts(part))
        return of_sum([*moving, *map(self.together, groups.values())], constants)

    def of_root(self, term: Term) -> Facts | None:
        """What is shown of (f^k + c)^e with f >= 0 convex, c >= 0, k >= 1 and e k >= 1: it rises with f, and is convex."""
        if term.op != "**" or term.args[0].op != "+":
            return None
        moving, still = ([a for a in term.args[0].args if self.domain.constant(a) is c] for c in (False, True))
        if (e := number_in(self.domain.polynomial(term.args[1]))) is None or not moving or not still:
            return None
        value, rest = self.added(list(map(self.read, moving))), self.domain.facts(sum_of(*still))
        if min(value.degree, e * value.degree) < 1 or not (rest.defined and rest.nonnegative):
            return None
        known = self.of_one(value)
        return Facts(True, POSITIVE | (rest.sign & ZERO), True, False, True) if known.quasiconvex and known.nonnegative else None

    def sign(self, term: Term) -> Sign:
        """The signs that a term may have where the deviator is not 0."""
        with suppress(NotWritten):
            poly = self.read(term).poly
            for turned, sign in ((poly, POSITIVE), (negated(poly), NEGATIVE)):
                if self.above(turned):
                    return sign if self.above(turned, strict=True) else sign | ZERO
        return ANY

    def of_wave(self, term: Term) -> Facts | None:
        """What is shown of a multiple of rho cos(b - acos(g c)/3) but cos theta, which is read with other functions."""
        parts = factors(term)
        waves = [f for f in parts if f.op == "cos" and not self.domain.constant(f)]
        if len(waves) != 1:
            return None
        with suppress(NotWritten):
            parts.remove(waves[0])
            rest = self.read(product_of(*parts))
            scale = rest.poly
            if rest.degree != 1 or rest.powers != {base_of(self.distance): ONE} or any(RAY.name in x.names() for m in scale for x, _ in m):
                return None
            known, (b, rate) = self.domain.facts(written(scale)), self.phase(waves[0].args[0])
            ends = (offset := written(b), sum_of(product_of(number(Fraction(1, 3)), _PI), minus(offset)))
            inside = all(not self.domain.facts(x).sign & NEGATIVE for x in ends)
            if (b or rate != ONE) and inside and known.nonnegative and self.domain.facts(offset).defined:
                return Facts(known.defined, ZERO | POSITIVE, True, False, True)
        return None

    def phase(self, angle: Term) -> tuple[Polynomial, Polynomial]:
        """b and g where the angle is b - acos(g c)/3 or its negative, |g| <= 1; acos z may stand as pi/2 - asin z, the asin of it as
        atan(z/sqrt(1 - z^2)).
        """
        poly = self.domain.polynomial(angle)
        inverse = {x for m in poly for x, _ in m if not self.domain.constant(x)}
        if len(inverse) != 1 or (x := inverse.pop()).op not in ("acos", "asin", "atan"):
            raise NotWritten("an angle is no third of an acos")
        base, *higher = in_powers(poly, x)
        third = number_in(higher[0]) if len(higher) == 1 else None
        if third is None or abs(third) != Fraction(1, 3):
            raise NotWritten("an angle is no third of an acos")
        z = self.read(x.args[0])
        towards = Fraction(-1 if x.op == "acos" else 1) / third / 3  # 1 where the angle is b - acos/3 as it stands
        b = {m: c * towards for m, c in base.items()}
        if x.op != "acos":
            b = total(b, {((_PI, 1),): Fraction(1, 6)})
        if x.op == "atan":
            under = self.plain(total(power_of(self.distance, 6), negated(times(z.poly, z.poly))))
            if z.powers != {base_of(under): {(): Fraction(-1, 2)}}:
                raise NotWritten("an atan is no acos")
            z = z._replace(powers=_PER_CUBE)
        rate = {m: c / _COSINE[()] for m, c in in_powers(z.poly, RAY)[0].items()}
        if z.degree or z.powers != _PER_CUBE or self.plain(total(z.poly, negated(times(rate, _COSINE)))):
            raise NotWritten("an acos is of another argument")
        if not all(self.above(total(ONE, side)) for side in (rate, negated(rate))):
            raise NotWritten("an acos may have no value")
        return b, rate

    def together(self, values: list[PlaneFunction]) -> Facts:
        """What is shown of a sum of functions of one degree."""
        with suppress(NotWritten):
            return self.of_one(self.added(values))
        return of_sum(list(map(self.of_one, values)))

    def of_one(self, value: PlaneFunction) -> Facts:
        """What is shown of one function, whose value where the deviator is 0 is 0."""
        sign: Sign = ANY
        with suppress(NotWritten):
            sign = ZERO | POSITIVE | (0 if self.above(value.poly) else NEGATIVE)
            if value.degree == 1 or self.above(value.poly, strict=True):
                convex = self.convex(value if value.degree == 1 else self.root(value))
                return Facts(True, sign, convex and value.degree >= 1, False, convex)
        return Facts(True, sign)

    def convex(self, value: PlaneFunction) -> bool:
        """Whether a function of degree 1 is convex in the sector, and no wall of it turns inward."""
        signs = self.opened
        if not all(signs.above(inner(w, signs.domain), strict=True) for w in value.roots()):
            return False
        return signs.above(self.bend(value)) and all(signs.above(signs.at(*wall)) for wall in zip(self.at_walls(value), WALLS, strict=True))

    def at_walls(self, value: PlaneFunction) -> tuple[Polynomial, Polynomial]:
        """F' and F - 2 F' for a function of degree 1: the first at v = 0, the second at v = 1 has the sign of the kink there."""
        found = derivatives(value, self.along)
        rate = self.plain(found.first)
        return rate, self.plain(total(times(value.poly, found.over), times({(): Fraction(-2)}, rate)))

    @cached_property
    def opened(self) -> Signs:
        """Signs without the ends of the parameters' ranges, where no constraint ties these."""
        law = self.domain.law
        return self.signs if law.constraints else Signs(self.domain.over(law.once(_opened)), WALLS)

    def tells(self, size: Term) -> bool:
        """Whether a term is 0 where the deviator is 0, and > 0 elsewhere."""
        value = self.value(size)
        return value is not None and value.degree > 0 and self.above(value.poly, strict=True)

    def emptied(self, term: Term) -> Term:
        """The term as it is where the deviator is 0; what is compared stays, for beside that place it may have another sign."""
        if term.op in COMPARISONS:
            return term
        return number(0) if (self.degree(term) or 0) > 0 else term._replace(args=tuple(map(self.emptied, term.args)))

    def degree(self, term: Term) -> Fraction | None:
        """k where a term, which has a value where the deviator is not 0, is rho^k f, f continuous in its direction, and so bounded."""
        if (value := self.value(term)) is not None:
            return value.degree
        if term.op in ("where", "atan2") or not term.args:
            return Fraction(0) if self.domain.constant(term) else None
        known = [self.degree(a) for a in term.args]
        found = [k for k in known if k is not None]
        if len(found) < len(known):
            return None
        if term.op == "*":
            return sum(found, Fraction(0))
        if term.op == "**":
            exponent = number_in(self.domain.polynomial(term.args[1]))
            return found[0] * exponent if exponent is not None else None if any(found) else Fraction(0)
        return found[0] if {*found} == ({found[0]} if term.op in _ALIKE else {0}) else None

    # -- reading -------------------------------------------------------------------------------------------------------

    def value(self, term: Term) -> PlaneFunction | None:
        """The function that a term is; None where it is not read as one."""
        if term not in self.known:
            found = None
            with suppress(NotWritten):
                found = self.shortened(self._read(self.replaced(term)))
            self.known[term] = found
        return self.known[term]

    def replaced(self, term: Term) -> Term:
        """The term with mean, X and d for principal values."""
        known = self.tensor.value(term, self.domain) if term.op in ("eigmax", "max", "min") else None
        return known or term._replace(args=tuple(map(self.replaced, term.args)))

    def read(self, term: Term) -> PlaneFunction:
        """The function that a term is; NotWritten where it is not read as one."""
        if (known := self.value(term)) is None:
            raise NotWritten("it is no function of the deviator")
        return known

    def _read(self, term: Term) -> PlaneFunction:
        if self.within.constant(term):
            if not self.domain.facts(term).defined:
                raise NotWritten("a constant may be undefined")
            return PlaneFunction(Fraction(0), self.domain.polynomial(term), {})
        if self._is_polynomial(term):
            return self.of_polynomial(self.within.polynomial(term))
        match term.op:
            case "+" | "*":
                parts = factors(term) if term.op == "*" else term.args
                smooth = [f for f in parts if self._is_polynomial(f)]
                parts = [*(f for f in parts if f not in smooth), *([Term(term.op, tuple(smooth))] if smooth else [])]
                return (multiplied if term.op == "*" else self.added)([*map(self.read, parts)])
            case "**":
                exponent = term.args[1]
                if not (self.within.constant(exponent) and self.domain.facts(exponent).defined):
                    raise NotWritten("an exponent varies")
                base, even = term.args[0], exponent.op == "number" and exponent.value % 2 == 0
                return self.power(self.read(base.args[0] if even and base.op == "abs" else base), self.domain.polynomial(exponent))
            case "cos":
                return self.cosine(term.args[0])
            case "sin":  # the cosine of what is left of a right angle
                return self.cosine(sum_of(product_of(number(Fraction(1, 2)), _PI), minus(term.args[0])))
            case "where":
                return self.choice(*term.args)
        raise NotWritten(f"{term.op} is not read as a function of the deviator")

    def _is_polynomial(self, term: Term) -> bool:
        return degree_at_most(term, self.within) is not None

    def of_polynomial(self, poly: Polynomial) -> PlaneFunction:
        """A polynomial of the forces, X and d, by J2 and J3."""
        degrees, found = set[int](), Polynomial()
        for told, rest in grouped(poly, lambda x: x in (_FIRST, _GAP)).items():
            k, shares = self.tensor.invariants.of(rest)
            degrees.add(sum(n for _, n in told) + k)
            away = reduce(times, (power_of({_FIRST: _X, _GAP: _D}[x], n) for x, n in told), ONE)
            for n, share in shares.items():
                part = times(power_of(_SECOND, (k - 3 * n) // 2), power_of(_THIRD, n))
                found = total(found, times(share, times(part, away)))
        if len(degrees) > 1:
            raise NotWritten("different degrees are added")
        return PlaneFunction(Fraction(degrees.pop() if degrees else 0), found, {})

    def cosine(self, angle: Term) -> PlaneFunction:
        """cos(b - theta) is cos b cos theta + sin b sin theta, with cos theta = X/N, and sin theta = 2 d/(sqrt(3) N)."""
        b, rate = self.phase(angle)
        if rate == negated(ONE):  # acos(-z) is pi - acos(z), so that b - acos(-z)/3 is the negative of pi/3 - b - acos(z)/3
            b, rate = total({((_PI, 1),): Fraction(1, 3)}, negated(b)), ONE
        if rate != ONE:
            raise NotWritten("a cosine is of another angle")
        sine = self.wave(total({((_PI, 1),): Fraction(1, 2)}, negated(b)))
        poly = total(times(self.wave(b), _X), times(times(sine, sqrt({(): Fraction(4, 3)})), _D))
        return PlaneFunction(Fraction(0), poly, {base_of(self.distance): {(): Fraction(-1)}})

    def wave(self, angle: Polynomial) -> Polynomial:
        """The cosine of a constant, of sixths of pi as a number or a root of one."""
        if {*angle} <= {((_PI, 1),)} and (turns := 6 * angle.get(((_PI, 1),), Fraction(0))).denominator == 1:
            sixths = abs((int(turns) + 6) % 12 - 6)
            size = sqrt({(): Fraction((4, 3, 1, 0, 1, 3, 4)[sixths], 4)})
            return size if sixths < 3 else negated(size)
        return self.domain.polynomial(Term("cos", (written(angle),)))

    def choice(self, condition: Term, one: Term, two: Term) -> PlaneFunction:
        """By what is 0 where the deviator is 0 and > 0 elsewhere: what is chosen elsewhere, if it is 0 there."""
        strict = len(condition.op) == 1
        size = gap(condition) if strict else minus(gap(condition))
        away, here = (one, two) if strict else (two, one)
        if not self.tells(size):
            raise NotWritten("a choice is by something else")
        value = self.read(away)
        nothing = not self.within.polynomial(here) and self.within.facts(here).defined
        # of degree 0 it jumps where the deviator is 0, and a sum or a root of it would be read as if it did not
        if value.degree <= 0 or not (nothing or self.read(here).degree > 0):
            raise NotWritten("a choice leaves a jump")
        return value
