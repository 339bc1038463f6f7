"""The coefficients of affine and quadratic formulas."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import Polynomial, times, written
from duhem.proof.kernel.term import NotWritten, Term, number, product_of, sum_of

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
    matrix, row, constant = quadratic(term, names, domain)
    if any(domain.polynomial(entry) for line in matrix for entry in line):
        raise NotWritten("a formula is not affine")
    return row, constant


def quadratic(term: Term, names: Sequence[str], domain: StatedDomain) -> tuple[Matrix, Row, Term]:
    """(A, b, c) with x . A x + b . x + c = term, A symmetric; NotWritten where it is not of that form."""
    parts: dict[tuple[int, ...], Polynomial] = {}
    for monomial, c in domain.polynomial(term).items():
        moving = [(x, n) for x, n in monomial if x.names() & {*names}]
        if any(x.op != "name" or n < 0 for x, n in moving) or sum(n for _, n in moving) > 2:
            raise NotWritten("a formula is not quadratic")
        places = tuple(sorted(names.index(x.name) for x, n in moving for _ in range(n)))
        parts.setdefault(places, {})[tuple((x, n) for x, n in monomial if (x, n) not in moving)] = c
    half, n = Fraction(1, 2), range(len(names))
    entries = {(i, j): times({(): half if i < j else Fraction(1)}, parts.get((i, j), {})) for i in n for j in n if i <= j}
    matrix = [[written(entries[min(i, j), max(i, j)]) for j in n] for i in n]
    return matrix, [written(parts.get((i,), {})) for i in n], written(parts.get((), {}))


def determinant(matrix: Matrix) -> Term:
    """By the first row."""
    if not matrix:
        return number(1)
    minors = ([[*row[:j], *row[j + 1 :]] for row in matrix[1:]] for j in range(len(matrix)))
    return sum_of(*(product_of(number((-1) ** j), matrix[0][j], determinant(minor)) for j, minor in enumerate(minors)))
