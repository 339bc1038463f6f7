"""Sums and products of polynomials with rational coefficients, in terms as their variables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import reduce
from typing import TypeVar

from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import NotWritten, Term, number, product_of, sum_of

__all__ = [
    "ONE", "Monomial", "Polynomial", "added", "divided", "grouped", "in_powers", "inverse_or_root", "joined", "negated", "number_in",
    "plainly", "quotient", "replaced", "root_of_square", "scaled", "shared", "slope", "solved", "times", "total", "written",
]  # fmt: skip

Unknown = TypeVar("Unknown")

Monomial = tuple[tuple[Term, int], ...]
Polynomial = dict[Monomial, Fraction]
ONE: Polynomial = {(): Fraction(1)}
_MOST_TERMS, _MOST_BITS = 20_000, 8192


def total(*parts: Polynomial) -> Polynomial:
    """The sum."""
    found: Polynomial = {}
    for part in parts:
        for m, c in part.items():
            found[m] = found[m] + c if m in found else c
    return {m: c for m, c in found.items() if c}


def negated(poly: Polynomial) -> Polynomial:
    """-P."""
    return {m: -c for m, c in poly.items()}


def number_in(poly: Polynomial) -> Fraction | None:
    """The number that a polynomial is; None where it is none."""
    return poly.get((), Fraction(0)) if set(poly) <= {()} else None


def joined(one: Monomial, two: Monomial) -> Monomial:
    """The product of two monomials; exponents may be negative."""
    powers = dict(one)
    for x, n in two:
        powers[x] = powers.get(x, 0) + n
    return tuple(sorted((x, n) for x, n in powers.items() if n))


def divided(poly: Polynomial, by: Monomial, scale: Fraction = Fraction(1)) -> Polynomial:
    """P/(c m) with a monomial m and a number c."""
    under = tuple((x, -n) for x, n in by)
    return {joined(m, under): c / scale for m, c in poly.items()}


def shared(poly: Polynomial, counts: Callable[[Term], bool] = lambda _: True) -> Monomial:
    """What divides every term, and what every term divides by, of the variables that count."""
    exponents, found = [dict(m) for m in poly], list[tuple[Term, int]]()
    for x in {x for e in exponents for x in e if counts(x)}:
        own = [e.get(x, 0) for e in exponents]
        found += [(x, min(own))] if min(own) > 0 else [(x, max(own))] if max(own) < 0 else []
    return tuple(sorted(found))


def times(one: Polynomial, two: Polynomial, most: int = _MOST_TERMS) -> Polynomial:
    """The product; NotWritten where it is too long to be worth checking: of more than so many products of terms."""
    if len(one) * len(two) > most:
        raise NotWritten("a product has too many terms")
    pay(5 + 5 * len(one) * len(two))
    found: Polynomial = {}
    for m, c in one.items():
        for n, d in two.items():
            power = joined(m, n)
            found[power] = found[power] + c * d if power in found else c * d
    found = {m: c for m, c in found.items() if c}
    if any(max(c.numerator.bit_length(), c.denominator.bit_length()) > _MOST_BITS for c in found.values()):
        raise NotWritten("a number is too long")
    return found


def replaced(poly: Polynomial, x: Term, inner: Polynomial) -> Polynomial:
    """``inner`` put for ``x``."""
    return total(*(reduce(times, [inner] * dict(m).get(x, 0), {tuple((y, n) for y, n in m if y != x): c}) for m, c in poly.items()))


def slope(poly: Polynomial, x: Term) -> Polynomial:
    """The derivative by ``x``."""
    return {tuple((y, n - (y == x)) for y, n in m if n != (y == x)): c * dict(m)[x] for m, c in poly.items() if x in dict(m)}


def grouped(poly: Polynomial, counts: Callable[[Term], bool]) -> dict[Monomial, Polynomial]:
    """The coefficients by products of the variables that count."""
    found: dict[Monomial, Polynomial] = {}
    for m, c in poly.items():
        found.setdefault(tuple((x, n) for x, n in m if counts(x)), {})[tuple((x, n) for x, n in m if not counts(x))] = c
    return found


def in_powers(poly: Polynomial, x: Term) -> list[Polynomial]:
    """The coefficients by powers of ``x``, that of 1 first; NotWritten where it divides by ``x``."""
    found = {sum(n for _, n in own): part for own, part in grouped(poly, lambda y: y == x).items()}
    if min(found, default=0) < 0:
        raise NotWritten("a variable divides")
    return [found.get(n, {}) for n in range(1 + max(found, default=0))]


def _ranks(monomials: Iterable[Monomial]) -> Callable[[Monomial], tuple[int, ...]]:
    """What the monomials of these variables are ordered by: the rank of a product is the sum of the ranks."""
    names = sorted({x for m in monomials for x, _ in m})

    def rank(m: Monomial) -> tuple[int, ...]:
        own = dict(m)
        return tuple(own.get(x, 0) for x in names)

    return rank


def root_of_square(poly: Polynomial) -> tuple[Fraction, Polynomial] | None:
    """(c, p) where the polynomial is c p^2, c > 0, term by term from the greatest; None where it is none, or p has more terms than that."""
    if not poly:
        return None
    rank = _ranks(poly)
    top, bottom = max(poly, key=rank), min(poly, key=rank)
    c, left, root, last = poly[top], poly, Polynomial(), None
    if c < 0 or poly[bottom] < 0 or any(n % 2 for _, n in (*top, *bottom)):
        return None
    lead = tuple((x, n // 2) for x, n in top)
    while left and len(root) <= len(poly) // 2:
        m = max(left, key=rank)
        here = joined(m, tuple((x, -n) for x, n in lead))
        if last is not None and rank(here) >= last:
            return None
        step, last = {here: left[m] / (c if not root else 2 * c)}, rank(here)
        left = total(left, times(step, times({(): -c}, total(root, root, step))))
        root |= step
    return None if left else (c, root)


def quotient(poly: Polynomial, by: Polynomial) -> Polynomial | None:
    """q with q times ``by`` the polynomial, term by term from the greatest; None where there is none, or it has more terms than that."""
    rank = _ranks((*poly, *by))
    lead, left, found = max(by, key=rank), poly, Polynomial()
    while left and len(found) < len(poly):
        m = max(left, key=rank)
        if any(dict(m).get(x, 0) < n for x, n in lead):
            return None
        step = divided({m: left[m]}, lead, by[lead])
        left, found = total(left, negated(times(step, by))), total(found, step)
    return None if left else found


def solved(rows: Iterable[tuple[Mapping[Unknown, Fraction], Polynomial]]) -> dict[Unknown, Polynomial] | None:
    """The unknowns x_k with sum of row_k x_k = value for each row, without those that are free, which are 0; None where there are none."""
    reduced = list[tuple[Unknown, dict[Unknown, Fraction], Polynomial]]()
    for given, value in rows:
        row = {k: c for k, c in given.items() if c}
        for pivot, known, had in reduced:
            if share := row.get(pivot, Fraction(0)) / known[pivot]:
                row = {k: c for k in {**row, **known} if (c := row.get(k, Fraction(0)) - share * known.get(k, Fraction(0)))}
                value = total(value, {m: -share * c for m, c in had.items()})
        if row:
            reduced.append((next(iter(row)), row, value))
        elif value:
            return None
    found = dict[Unknown, Polynomial]()
    for pivot, row, value in reversed(reduced):
        others = ({m: -c * d for m, d in found[k].items()} for k, c in row.items() if k in found)
        found[pivot] = {m: c / row[pivot] for m, c in total(value, *others).items()}
    return found


def inverse_or_root(x: Term) -> bool:
    """Whether it is 1/P or a root of P."""
    return x.op == "**" and x.args[1].op == "number" and abs(x.args[1].value.numerator) == 1


def scaled(scale: Term, parts: Monomial) -> Term:
    """A product of a scale, which may be 1, and powers."""
    powers = [
        x if n == 1 else Term("**", (x.args[0], number(n * x.args[1].value)) if inverse_or_root(x) else (x, number(n))) for x, n in parts
    ]
    found = [*([] if scale == number(1) and powers else scale.args if scale.op == "*" else [scale]), *powers]
    return found[0] if len(found) == 1 else Term("*", tuple(found))


def plainly(poly: Polynomial) -> Term:
    """A polynomial as a term, its parts in order and without factors 1."""
    return added([scaled(number(c), m) for m, c in sorted(poly.items())])


def added(parts: list[Term]) -> Term:
    """The sum of terms as they are, 0 for none."""
    return parts[0] if len(parts) == 1 else Term("+", tuple(parts)) if parts else number(0)


def written(poly: Polynomial) -> Term:
    """A polynomial as a term."""
    return sum_of(*(product_of(number(c), *(x if n == 1 else Term("**", (x, number(n))) for x, n in m)) for m, c in poly.items()))
