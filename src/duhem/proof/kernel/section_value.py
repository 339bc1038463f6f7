"""Functions rho^k P(c) prod F_i(c)^(e_i) of rho = sqrt(J2) and c = cos 3 theta, with F_i > 0, as values: multiplied, added and bent."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import isqrt
from typing import Any, NamedTuple

from duhem.proof.kernel.polynomial import ONE, Polynomial, slope, times, total
from duhem.proof.kernel.positivity import RAY
from duhem.proof.kernel.term import NotWritten, Term, number

__all__ = [
    "MOST_POWER", "ROOT", "Base", "SectionValue", "added", "base_of", "bend", "multiplied", "power_of", "raised_to", "reduced", "scaled",
    "widened",
]  # fmt: skip

ROOT = Term("**", (number(3), number(Fraction(1, 2))))
MOST_POWER = 12
Base = tuple[tuple[Any, Fraction], ...]  # a polynomial > 0, as its terms in order


class SectionValue(NamedTuple):
    """rho^degree times ``poly`` times positive polynomials in c, each to the power, a polynomial of constants, that ``powers`` gives."""

    degree: Fraction
    poly: Polynomial
    powers: Mapping[Base, Polynomial]


def bend(poly: Polynomial, powers: Mapping[Base, Polynomial]) -> Polynomial:
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
    spread = total(times(slope(n, RAY), d), scaled(-1, times(n, slope(d, RAY))), times(n, n))
    bend = total(times(second, square), scaled(2, times(first, times(n, d))), times(poly, spread))  # D^2 f''/W
    weight: Polynomial = {(): Fraction(9), ((RAY, 2),): Fraction(-9)}
    return total(times(weight, bend), times({((RAY, 1),): Fraction(-9)}, rate), times(poly, square))


def multiplied(sections: Iterable[SectionValue]) -> SectionValue:
    """The product."""
    degree, poly, powers = Fraction(0), ONE, dict[Base, Polynomial]()
    for section in sections:
        degree, poly = degree + section.degree, reduced(times(poly, section.poly))
        for base, e in section.powers.items():
            powers[base] = total(powers.get(base, {}), e)
    return SectionValue(degree, poly, {base: e for base, e in powers.items() if e})


def added(sections: list[SectionValue]) -> SectionValue:
    """NotWritten where they have different degrees or roots; a whole power that one has and another lacks is multiplied out."""
    sections = [section for section in sections if section.poly] or sections[:1]
    degree = sections[0].degree
    if any(section.degree != degree for section in sections):
        raise NotWritten("different degrees are added")
    shared: dict[Base, Polynomial] = {}
    for base in {base for section in sections for base in section.powers}:
        powers = [section.powers.get(base, {}) for section in sections]
        apart = [total(e, scaled(-1, powers[0])) for e in powers]
        if not all(set(e) <= {()} and e.get((), Fraction(0)).denominator == 1 for e in apart):
            raise NotWritten("different roots are added")
        shared[base] = total(powers[0], {(): min(e.get((), Fraction(0)) for e in apart)})
    poly: Polynomial = {}
    for section in sections:
        part = section.poly
        for base, least in shared.items():
            left = total(section.powers.get(base, {}), scaled(-1, least)).get((), Fraction(0))
            part = times(part, power_of(dict(base), int(left)))
        poly = total(poly, part)
    return SectionValue(degree, reduced(poly), {base: e for base, e in shared.items() if e})


def widened(powers: Mapping[Base, Polynomial], poly: Polynomial, e: Polynomial) -> dict[Base, Polynomial]:
    """With one positive polynomial more."""
    base = base_of(poly)
    found = {**powers, base: total(powers.get(base, {}), e)}
    return {b: n for b, n in found.items() if n and dict(b) != ONE}


def raised_to(powers: Mapping[Base, Polynomial], e: Polynomial) -> dict[Base, Polynomial]:
    """Every power times e."""
    return {base: times(n, e) for base, n in powers.items()}


def power_of(poly: Polynomial, n: int) -> Polynomial:
    """poly^n, multiplied out."""
    if n > MOST_POWER:
        raise NotWritten("a power is too high")
    found = ONE
    for _ in range(n):
        found = times(found, poly)
    return reduced(found)


def scaled(factor: int, poly: Polynomial) -> Polynomial:
    """A whole multiple."""
    return {m: factor * c for m, c in poly.items()}


def base_of(poly: Polynomial) -> Base:
    """A polynomial as a key."""
    return tuple(sorted(poly.items()))


def reduced(poly: Polynomial) -> Polynomial:
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
        found = total(found, {tuple(sorted([*left, (ROOT, 1)] if odd else left)): c})
    return found


def _share(x: Term) -> tuple[Fraction, int]:
    """(q, 1) where x = q sqrt(3) and (q, 0) where x = q, for the root of a number; else (0, 0)."""
    if x.op == "**" and x.args[0].op == "number" and x.args[1] == ROOT.args[1] and x.args[0].value > 0:
        for odd, square in enumerate((x.args[0].value, x.args[0].value / 3)):
            root = Fraction(isqrt(square.numerator), isqrt(square.denominator))
            if root * root == square:
                return root, odd
    return Fraction(0), 0
