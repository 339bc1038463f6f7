"""What the parts of a sum show together: a part that stands several times, kinks of one x, the matrix of a quadratic form.

phi(x) = right x for x >= 0 and left x for x <= 0, such as |x| - k x, is convex for left <= right; of a convex x so is phi(x) where phi does
not fall (left >= 0), of a concave one where it does not rise (right <= 0).  phi >= 0 for left <= 0 <= right: |x| - k x with |k| <= 1
(Cazacu, Plunkett, Barlat 2006, IJP 22, 1171).

A quadratic formula is convex where its matrix is positive semidefinite, >= 0 where it is so with 1 as a force more.  A symmetric matrix is
positive semidefinite exactly where no principal minor is < 0 (Horn, Johnson 2013, Theorem 7.2.5).  It is so block by block, forces that
meet in no product being in different ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.forms import Matrix, degree_at_most, determinant, multiple, quadratic
from duhem.proof.kernel.polynomial import Monomial, written
from duhem.proof.kernel.shape import Facts
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["by_its_matrix", "collected", "convex_when_bent", "nonnegative_when_bent"]

_LARGEST_BLOCK = 3
_HALF = number(Fraction(1, 2))
_Bend = tuple[Term, Term, Term]  # x, right, left


def collected(term: Term, domain: StatedDomain) -> Term:
    """A sum with every part that depends on the forces once, with the sum of its coefficients; as it is where none stands twice."""
    found = _summed(term, domain)
    if all(len(scales) == 1 or domain.constant(part) or part.op == "name" for part, scales in found.items()):
        return term
    return sum_of(*(product_of(sum_of(*scales), part) for part, scales in found.items()))


def _summed(term: Term, domain: StatedDomain) -> dict[Term, list[Term]]:
    """What is added up, in sums within sums too, each part with the constants it is multiplied by."""
    found: dict[Term, list[Term]] = {}
    queue = [(term, number(1))]
    while queue:
        part, scale = queue.pop()
        moving = [a for a in part.args if not domain.constant(a)] if part.op == "*" else []
        if part.op == "+":
            queue += [(a, scale) for a in part.args]
        elif len(moving) == 1:
            queue.append((moving[0], product_of(scale, *(a for a in part.args if domain.constant(a)))))
        else:
            found.setdefault(part, []).append(scale)
    return found


def convex_when_bent(term: Term, domain: StatedDomain) -> bool:
    """Whether a sum is convex, the kinks of one x taken together and with the multiples of x."""
    with suppress(NotWritten):
        bends, rest = _bends(term, domain)
        return bool(bends) and all(domain.facts(part).convex for part in rest) and all(_convex(*bend, domain) for bend in bends)
    return False


def nonnegative_when_bent(term: Term, domain: StatedDomain) -> bool:
    """Whether a sum is made of phi >= 0 and what is >= 0 itself."""
    with suppress(NotWritten):
        bends, rest = _bends(term, domain)
        return (
            bool(bends)
            and all(domain.facts(part).nonnegative for part in rest)
            and all(not domain.facts(right).sign & NEGATIVE and not domain.facts(left).sign & POSITIVE for _, right, left in bends)
        )
    return False


def _convex(x: Term, right: Term, left: Term, domain: StatedDomain) -> bool:
    inner = domain.facts(x)
    if domain.facts(sum_of(right, minus(left))).sign & NEGATIVE:
        return False
    rises, falls = not domain.facts(left).sign & NEGATIVE, not domain.facts(right).sign & POSITIVE
    return inner.affine or (inner.convex and rises) or (inner.concave and falls)


def _bends(term: Term, domain: StatedDomain) -> tuple[list[_Bend], list[Term]]:
    """A phi for every x that stands under a kink, and the terms in none of them."""
    kinks, rest = dict[frozenset[tuple[Monomial, Fraction]], tuple[Term, list[tuple[Term, Term]]]](), list[Term]()
    for part, scales in _summed(term, domain).items():
        scale = sum_of(*scales)
        if part.op not in ("abs", "pos", "neg") or domain.constant(part):
            rest.append(product_of(scale, part))
            continue
        (x,), right, left = part.args, scale, minus(scale)
        poly = domain.polynomial(x)
        if poly and poly[min(poly)] < 0:  # of x and -x one
            x, right, left = minus(x), *((right, left) if part.op == "abs" else (number(0), left))
        elif part.op != "abs":
            left = number(0)
        if part.op == "neg":
            right, left = minus(left), minus(right)
        kinks.setdefault(frozenset(domain.polynomial(x).items()), (x, []))[1].append((right, left))
    bends = list[_Bend]()
    for x, slopes in kinks.values():
        poly, whole = domain.polynomial(x), sum_of(*rest)
        multiples = {part: c for part in (whole, *rest) if (c := multiple(domain.polynomial(part), poly, domain)) is not None}
        own = [whole] if whole in multiples else [part for part in rest if part in multiples]
        rest = [] if whole in multiples else [part for part in rest if part not in multiples]
        shares = [written(multiples[part]) for part in own]
        bends.append((x, sum_of(*(right for right, _ in slopes), *shares), sum_of(*(left for _, left in slopes), *shares)))
    return bends, rest


def by_its_matrix(term: Term, known: Facts, domain: StatedDomain) -> Facts:
    """What is ``known`` of a sum, and what the matrix of its quadratic part shows if what is added to that is convex, or >= 0, too."""
    parts = [product_of(scale, part) for part, scales in _summed(term, domain).items() for scale in scales]
    degrees = [degree_at_most(part, domain) for part in parts]
    square = sum_of(*(part for part, k in zip(parts, degrees, strict=True) if k in (0, 1, 2)))
    others = [domain.facts(part) for part, k in zip(parts, degrees, strict=True) if k not in (0, 1, 2)]
    names = sorted(square.names() & set(domain.law.forces))
    with suppress(NotWritten):
        if 2 in degrees:
            matrix, row, constant = quadratic(square, names, domain)
            if all(part.convex for part in others) and _semidefinite(matrix, domain):
                known = replace(known, convex=True, quasiconvex=True)
            halves = [product_of(_HALF, b) for b in row]
            wider = [*([*line, b] for line, b in zip(matrix, halves, strict=True)), [*halves, constant]]
            if all(part.nonnegative for part in others) and _semidefinite(wider, domain):
                above = domain.facts(constant).sign == POSITIVE and all(domain.facts(b).sign == ZERO for b in row)
                known = replace(known, sign=known.sign & (POSITIVE if above else ZERO | POSITIVE))
    return known


def _semidefinite(matrix: Matrix, domain: StatedDomain) -> bool:
    """Whether no principal minor of a block of the symmetric matrix is < 0."""
    return all(
        not domain.facts(determinant([[matrix[i][j] for j in some] for i in some])).sign & NEGATIVE
        for block in _blocks(matrix, domain)
        for size in range(1, len(block) + 1)
        for some in combinations(block, size)
    )


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
