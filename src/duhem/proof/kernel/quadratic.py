"""Quadratic formulas: convex where their matrix is positive semidefinite, >= 0 where it is so with 1 as a force more.

A symmetric matrix is positive semidefinite exactly where no principal minor is < 0 (Horn, Johnson 2013, Theorem 7.2.5).  It is so
block by block, forces that meet in no product being in different ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.forms import Matrix, degree_at_most, determinant, quadratic
from duhem.proof.kernel.shape import Facts, Shown
from duhem.proof.kernel.term import NotWritten, Term, number, product_of, sum_of

__all__ = ["by_its_matrix"]

_LARGEST_BLOCK = 3
_HALF = number(Fraction(1, 2))


def by_its_matrix(term: Term, known: Facts, domain: StatedDomain, shown: Shown) -> Facts:
    """What is ``known`` of a sum, and what the matrix of its quadratic part shows if what is added to that is convex, or >= 0, too."""
    parts = list(_summed(term))
    degrees = [degree_at_most(part, domain) for part in parts]
    plain = [part for part, k in zip(parts, degrees, strict=True) if k in (0, 1, 2)]
    others = [shown(part, domain) for part, k in zip(parts, degrees, strict=True) if k not in (0, 1, 2)]
    square = sum_of(*plain)
    names = sorted(square.names() & set(domain.law.forces))
    with suppress(NotWritten):
        if 2 in degrees:
            matrix, row, constant = quadratic(square, names, domain)
            if all(part.convex for part in others) and _semidefinite(matrix, domain, shown):
                known = replace(known, convex=True, quasiconvex=True)
            halves = [product_of(_HALF, b) for b in row]
            wider = [*([*line, b] for line, b in zip(matrix, halves, strict=True)), [*halves, constant]]
            if all(part.nonnegative for part in others) and _semidefinite(wider, domain, shown):
                above = shown(constant, domain).sign == POSITIVE and all(shown(b, domain).sign == ZERO for b in row)
                known = replace(known, sign=known.sign & (POSITIVE if above else ZERO | POSITIVE))
    return known


def _summed(term: Term) -> Iterator[Term]:
    """What is added up, in sums within sums too."""
    for a in term.args:
        yield from _summed(a) if a.op == "+" else (a,)


def _semidefinite(matrix: Matrix, domain: StatedDomain, shown: Shown) -> bool:
    """Whether no principal minor of a block of the symmetric matrix is < 0."""
    return all(
        not shown(determinant([[matrix[i][j] for j in some] for i in some]), domain).sign & NEGATIVE
        for block in _blocks(matrix, domain, shown)
        for size in range(1, len(block) + 1)
        for some in combinations(block, size)
    )


def _blocks(matrix: Matrix, domain: StatedDomain, shown: Shown) -> list[Sequence[int]]:
    """Rows that no entry but 0 joins to those of another block; NotWritten where one is too large."""
    left, found = list(range(len(matrix))), list[Sequence[int]]()
    while left:
        block = [left.pop(0)]
        for i in block:
            joined = [j for j in left if shown(matrix[i][j], domain).sign != ZERO]
            left = [j for j in left if j not in joined]
            block += joined
        if len(block) > _LARGEST_BLOCK:
            raise NotWritten("a matrix is too large")
        found.append(block)
    return found
