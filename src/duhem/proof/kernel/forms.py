"""The coefficients of affine and quadratic formulas, read off their values at unit points and confirmed as an identity."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations_with_replacement

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.identity import multiplied_out, vanishes
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["Matrix", "Row", "affine", "at", "degree_at_most", "determinant", "quadratic"]

Row = Sequence[Term]
Matrix = Sequence[Row]


def at(term: Term, names: Sequence[str], values: Sequence[Term]) -> Term:
    """A term with values in the place of names."""
    return term.put({Term("name", name=n): v for n, v in zip(names, values, strict=True)})


def degree_at_most(term: Term, domain: StatedDomain) -> int | None:
    """A bound on the degree of a polynomial in the forces, as it is written; None for what is no polynomial as it is written."""
    if domain.constant(term):
        return 0
    if term.op == "name":
        return 1
    if term.op == "**":
        n, base = term.args[1], degree_at_most(term.args[0], domain)
        whole = n.op == "number" and n.value.denominator == 1 and n.value > 0
        return base * int(n.value) if whole and base is not None else None
    degrees = [degree_at_most(a, domain) for a in term.args] if term.op in ("+", "*") else [None]
    known = [k for k in degrees if k is not None]
    if len(known) < len(degrees):
        return None
    return max(known) if term.op == "+" else sum(known)


def affine(term: Term, names: Sequence[str], domain: StatedDomain) -> tuple[Row, Term]:
    """(b, c) with b . x + c = term; NotWritten where it is not of that form."""
    zero = _value(term, names, (), domain)
    row = [_sum((_value(term, names, (i,), domain), minus(zero)), domain) for i in range(len(names))]
    _confirm(term, [*map(product_of, row, (Term("name", name=n) for n in names)), zero], domain)
    return row, zero


def quadratic(term: Term, names: Sequence[str], domain: StatedDomain) -> tuple[Matrix, Row, Term]:
    """(A, b, c) with x . A x + b . x + c = term, A symmetric; NotWritten where it is not of that form."""
    places, half, zero = range(len(names)), number(Fraction(1, 2)), _value(term, names, (), domain)
    ones, twos = ([_value(term, names, (i,) * k, domain) for i in places] for k in (1, 2))
    matrix = [[number(0)] * len(names) for _ in places]
    for i, j in combinations_with_replacement(places, 2):
        both = twos[i] if i == j else _value(term, names, (i, j), domain)
        matrix[i][j] = matrix[j][i] = _sum((product_of(half, sum_of(both, minus(ones[i]), minus(ones[j]), zero)),), domain)
    row = [_sum((ones[i], minus(matrix[i][i]), minus(zero)), domain) for i in places]
    x = [Term("name", name=n) for n in names]
    squares = [product_of(matrix[i][j], x[i], x[j]) for i in places for j in places]
    _confirm(term, [*squares, *map(product_of, row, x), zero], domain)
    return matrix, row, zero


def _value(term: Term, names: Sequence[str], steps: Sequence[int], domain: StatedDomain) -> Term:
    """The term at the sum of some unit points."""
    return multiplied_out(at(term, names, [number(steps.count(i)) for i in range(len(names))]), domain)


def _sum(terms: Sequence[Term], domain: StatedDomain) -> Term:
    return multiplied_out(sum_of(*terms), domain)


def _confirm(term: Term, parts: Sequence[Term], domain: StatedDomain) -> None:
    if not vanishes(sum_of(*parts, minus(term)), domain):
        raise NotWritten("a formula has another form")


def determinant(matrix: Matrix) -> Term:
    """By the first row."""
    if not matrix:
        return number(1)
    minors = ([[*row[:j], *row[j + 1 :]] for row in matrix[1:]] for j in range(len(matrix)))
    return sum_of(*(product_of(number((-1) ** j), matrix[0][j], determinant(minor)) for j, minor in enumerate(minors)))
