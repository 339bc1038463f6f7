"""Sums of |x|, x+, x- and multiples of one x: phi(x) = right x for x >= 0 and left x for x <= 0, such as |x| - k x.

phi is convex for left <= right; of a convex x so is phi(x) where phi does not fall (left >= 0), of a concave one where it does not
rise (right <= 0).  phi >= 0 for left <= 0 <= right: |x| - k x with |k| <= 1 (Cazacu, Plunkett, Barlat 2006, IJP 22, 1171).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.loads import multiple
from duhem.proof.kernel.polynomial import Polynomial, negated, written
from duhem.proof.kernel.shape import Shown
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["convex_when_bent", "nonnegative_when_bent"]


class _Bend(NamedTuple):
    """phi, by its slopes on either side of x = 0."""

    x: Polynomial
    right: Term
    left: Term

    def plus(self, right: Term, left: Term) -> _Bend:
        return self._replace(right=sum_of(self.right, right), left=sum_of(self.left, left))


def convex_when_bent(terms: Sequence[Term], domain: StatedDomain, shown: Shown) -> bool:
    """Whether a sum is convex, the kinks of one x taken together and with the multiples of x, where these are written as such."""
    try:
        bends, rest = _bends(terms, domain)
    except NotWritten:
        return False
    return bool(bends) and all(shown(part, domain).convex for part in rest) and all(_convex(bend, x, domain, shown) for x, bend in bends)


def nonnegative_when_bent(terms: Sequence[Term], domain: StatedDomain, shown: Shown) -> bool:
    """Whether a sum is a phi >= 0 of one x, the rest of it being a multiple of x."""
    try:
        bends, rest = _bends(terms, domain)
        slope = multiple(domain.polynomial(sum_of(*rest)), bends[0][1].x, domain) if len(bends) == 1 else None
    except NotWritten:
        return False
    if slope is None:
        return False
    _, right, left = bends[0][1].plus(written(slope), written(slope))
    return not shown(right, domain).sign & NEGATIVE and not shown(left, domain).sign & POSITIVE


def _convex(bend: _Bend, x: Term, domain: StatedDomain, shown: Shown) -> bool:
    inner, _, right, left = shown(x, domain), *bend
    if shown(sum_of(right, minus(left)), domain).sign & NEGATIVE:
        return False
    rises, falls = not shown(left, domain).sign & NEGATIVE, not shown(right, domain).sign & POSITIVE
    return inner.affine or (inner.convex and rises) or (inner.concave and falls)


def _bends(terms: Sequence[Term], domain: StatedDomain) -> tuple[list[tuple[Term, _Bend]], list[Term]]:
    """A phi for every x that stands under a kink, and the terms in none of them."""
    found, rest = list[tuple[Term, _Bend]](), list[Term]()
    for term in terms:
        parts = factors(term)
        moving = [f for f in parts if not domain.constant(f)]
        if len(moving) != 1 or moving[0].op not in ("abs", "pos", "neg"):
            rest.append(term)
            continue
        scale, (x,), kind = product_of(*(f for f in parts if domain.constant(f))), moving[0].args, moving[0].op
        slopes = (number(0) if kind == "neg" else scale, number(0) if kind == "pos" else minus(scale))
        _enter(found, x, slopes, domain)
    for i, (x, bend) in enumerate(found):
        own = [term for term in rest if _factor(term, x, domain) is not None]
        for term in own:
            scale = _factor(term, x, domain) or number(0)
            bend = bend.plus(scale, scale)
        found[i] = (x, bend)
        rest = [term for term in rest if term not in own]
    return found, rest


def _enter(found: list[tuple[Term, _Bend]], x: Term, slopes: tuple[Term, Term], domain: StatedDomain) -> None:
    """One kink more: of an x that was met before, of its negative or of another."""
    poly, (right, left) = domain.polynomial(x), slopes
    for i, (y, bend) in enumerate(found):
        if bend.x == poly:
            found[i] = (y, bend.plus(right, left))
            return
        if bend.x == negated(poly):
            found[i] = (y, bend.plus(minus(left), minus(right)))
            return
    found.append((x, _Bend(poly, right, left)))


def _factor(term: Term, x: Term, domain: StatedDomain) -> Term | None:
    """c where the term is c x, x written as it is under the kink."""
    parts = factors(term)
    moving = [f for f in parts if not domain.constant(f)]
    return product_of(*(f for f in parts if domain.constant(f))) if moving == [x] else None
