"""Matrices of constants that are positive semidefinite over a whole domain, and forms of even degree of which the matrix is.

A symmetric matrix is positive semidefinite exactly where no principal minor is < 0 (Horn, Johnson 2013, Theorem 7.2.5).  It is so block by
block, forces that meet in no product being in different ones.  A large block is positive definite where its leading minors are > 0
(Sylvester's criterion, the same theorem), and semidefinite where no entry of the diagonal is less than the sizes of the others in its row
(Gershgorin 1931).

Let f(v_1, ..., v_2k) be linear in each vector, symmetric, and the form f(x) of degree 2k where all of them are x.  It is a bilinear form of
the products v_1 ... v_k and v_(k+1) ... v_2k, whose matrix C is the catalecticant of f (Sylvester 1851).  The second derivative of f along
u is 2k (2k - 1) f(x, ..., x, u, u), the value of C at x ... x u: where C is positive semidefinite, f is convex.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import combinations_with_replacement
from math import factorial, prod

from duhem.proof.kernel.domain import POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.forms import Matrix, by_forces, leading_minors, principal_minors, quadratic
from duhem.proof.kernel.polynomial import Monomial, Polynomial, times, written
from duhem.proof.kernel.term import NotWritten, Term, minus, number, sum_of

__all__ = ["catalecticant", "homogeneous_parts", "in_coordinates", "only_at_zero_force", "semidefinite", "sum_of_even_powers", "zero_with"]

_SMALL, _LARGEST_BLOCK, _MOST_ROWS = 3, 6, 21


def semidefinite(matrix: Matrix, domain: StatedDomain) -> bool:
    """Whether each block of the symmetric matrix is positive semidefinite."""
    blocks = ([[matrix[i][j] for j in block] for i in block] for block in _blocks(matrix, domain))
    return all(_minors(b, domain) if len(b) <= _SMALL else _dominant(b, domain) or _leading_above_0(b, domain) for b in blocks)


def zero_with(term: Term, domain: StatedDomain) -> list[Term]:
    """The forces that are 0 wherever a term is, if it, or the square of a size, is a semidefinite form: those of its definite blocks."""
    names = [f for f in domain.law.forces if f in term.names()]
    with suppress(NotWritten):
        matrix, row, rest = quadratic(Term("**", (term, number(2))) if term.op in ("abs", "norm") else term, names, domain)
        if semidefinite(matrix, domain) and not any(domain.polynomial(x) for x in (*row, rest)):
            blocks = ((block, [[matrix[i][j] for j in block] for i in block]) for block in _blocks(matrix, domain))
            return [Term("name", name=names[i]) for block, own in blocks if _leading_above_0(own, domain) for i in block]
    return []


def only_at_zero_force(term: Term, domain: StatedDomain) -> bool:
    """Whether a term is 0 at zero force alone, as a definite form is."""
    return len(zero_with(term, domain)) == len(domain.law.forces)


def _minors(matrix: Matrix, domain: StatedDomain) -> bool:
    """Whether no principal minor is < 0."""
    return all(domain.never_negative(written(minor)) for _, minor in principal_minors(matrix, domain))


def _leading_above_0(matrix: Matrix, domain: StatedDomain) -> bool:
    return all(domain.facts(written(minor)).sign == POSITIVE for minor in leading_minors(matrix, domain))


def _dominant(matrix: Matrix, domain: StatedDomain) -> bool:
    """Whether no entry of the diagonal is less than the sizes of the others in its row."""
    rows = (sum_of(row[i], *(minus(Term("abs", (x,))) for j, x in enumerate(row) if j != i)) for i, row in enumerate(matrix))
    return all(domain.facts(row).nonnegative for row in rows)


def _blocks(matrix: Matrix, domain: StatedDomain) -> list[Sequence[int]]:
    """Rows that no entry but 0 joins to those of another block; NotWritten where one is too large."""
    left, found = list(range(len(matrix))), list[Sequence[int]]()
    while left:
        block = [left.pop(0)]
        for i in block:
            joined = [j for j in left if domain.facts(matrix[i][j]).sign != ZERO]
            left = [j for j in left if j not in joined]
            block += joined
        if len(block) > _LARGEST_BLOCK:
            raise NotWritten("a matrix is too large")
        found.append(block)
    return found


def homogeneous_parts(poly: Polynomial, domain: StatedDomain) -> dict[int, dict[Monomial, Polynomial]]:
    """The forms that a polynomial in the forces is the sum of, by their degrees; NotWritten for what is none."""
    found = dict[int, dict[Monomial, Polynomial]]()
    for moving, c in by_forces(poly, domain).items():
        if any(x.op != "name" or n < 0 for x, n in moving):
            raise NotWritten("it is no polynomial in the forces")
        found.setdefault(sum(n for _, n in moving), {})[moving] = c
    return found


def catalecticant(form: dict[Monomial, Polynomial], degree: int) -> Matrix:
    """The matrix of a form of even degree, its rows and columns the monomials of half of that degree in order."""
    rows = [*combinations_with_replacement(sorted({x for m in form for x, _ in m}), degree // 2)]
    if len(rows) > _MOST_ROWS:
        raise NotWritten("a form has too many monomials")

    def entry(one: tuple[Term, ...], two: tuple[Term, ...]) -> Term:
        m = tuple(sorted(Counter((*one, *two)).items()))
        share = Fraction(prod(factorial(n) for _, n in m), factorial(degree))
        return written(times({(): share}, form.get(m, {})))

    return [[entry(one, two) for two in rows] for one in rows]


def sum_of_even_powers(term: Term, domain: StatedDomain) -> bool:
    """Whether a polynomial in the forces is affine but for forms of even degree whose matrices are positive semidefinite."""
    forces = sorted(term.names() & {*domain.law.forces})
    spellings = in_coordinates(term, forces) if term.names() - {*forces} else (term,)  # of numbers alone one matrix says it
    forms = (homogeneous_parts(domain.polynomial(spelled), domain) for spelled in spellings)
    return any(
        all(degree < 2 or (degree % 2 == 0 and semidefinite(catalecticant(form, degree), domain)) for degree, form in sorted(parts.items()))
        for parts in forms
    )


def in_coordinates(term: Term, forces: Sequence[str]) -> Iterator[Term]:
    """A formula; in two forces also with their sum and difference in their place: what is even in these has a matrix of blocks."""
    yield term
    if len(forces) == 2:
        x, y = (Term("name", name=f) for f in forces)
        yield term.put({x: sum_of(x, y), y: sum_of(x, minus(y))})
