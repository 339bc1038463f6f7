"""Parts of a maximum of which the other parts leave one side: a hyperbola of which a ball meets one branch, a gap beside a ball.

Let f be concave and depend on the forces through one load w alone, and let w <= e on K, e constant, by another part of the maximum.
{f > 0} is an interval of w; where it holds e, what is left of {f <= 0} is all w up to its lower end: a half-space, or nothing.

A load u <= 0 bounds its multiples.  So does a ball c_1 a_1^2 + ... <= r^2, for w = m + y . a gives
(w - m)^2 <= r^2 (y_1^2/c_1 + ...) (Cauchy, Schwarz).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import POSITIVE, StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.identity import value
from duhem.proof.kernel.loads import at_end_of, share_and_rest
from duhem.proof.kernel.polyhedron import solved
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["left_on_one_side"]

_HALF, _TWO = number(Fraction(1, 2)), number(2)
Ball = tuple[Sequence[Term], Sequence[Term], Term]  # terms a_i and constants c_i > 0, r: c_1 a_1^2 + ... <= r^2


def left_on_one_side(part: Term, others: Sequence[Term], domain: StatedDomain) -> bool:
    """Whether what the others leave of {part <= 0} is a half-space or nothing, where they are <= 0."""
    known = facts(part, domain)
    if not (known.defined and known.concave):
        return False
    for other in others:
        for end in _ends(part, other, domain):
            try:
                there = facts(at_end_of(end, part, domain), domain)
            except NotWritten:  # the part depends on more than this load
                continue
            if there.defined and there.sign == POSITIVE:
                return True
    return False


def _ends(part: Term, other: Term, domain: StatedDomain) -> Iterator[Term]:
    """Loads of which K has one sign, or is empty, because ``other`` is <= 0 on it."""
    if facts(other, domain).affine:
        yield other
        return
    if (ball := _ball(other, domain)) is None:
        return
    for load in dict.fromkeys(_loads(part, domain)):
        if (found := _centre_and_reach(load, ball, domain)) is not None:
            centre, reach = found
            yield from (sum_of(load, minus(centre), product_of(number(s), reach)) for s in (-1, 1))


def _loads(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """The largest affine parts of a formula that the forces enter."""
    if domain.constant(term):
        return
    if facts(term, domain).affine:
        yield term
        return
    for a in term.args:
        yield from _loads(a, domain)


def _ball(part: Term, domain: StatedDomain) -> Ball | None:
    """A norm, or a root of a sum of squares, times a constant > 0, and a constant; or a sum of squares and a constant."""
    moving, still = _apart(part, domain)
    if len(moving) == 1:
        scales, rest = ([f for f in factors(moving[0]) if domain.constant(f) is c] for c in (True, False))
        scale = facts(product_of(*scales), domain)
        if len(rest) != 1 or not scale.defined or scale.sign != POSITIVE:
            return None
        reach = product_of(minus(still), Term("**", (product_of(*scales), number(-1)))) if scales else minus(still)
        if rest[0].op in ("norm", "abs"):
            return rest[0].args, [number(1)] * len(rest[0].args), reach
        if rest[0].op == "**" and value(rest[0].args[1], domain) == Fraction(1, 2):
            moving, level = _apart(rest[0].args[0], domain)
            still = sum_of(level, minus(product_of(reach, reach)))
            return _of_squares(moving, still, domain)
    return _of_squares(moving, still, domain)


def _of_squares(moving: Sequence[Term], still: Term, domain: StatedDomain) -> Ball | None:
    """c_1 a_1^2 + ... + still <= 0, every c > 0."""
    rows, weights = list[Term](), list[Term]()
    for term in moving:
        scales, rest = ([f for f in factors(term) if domain.constant(f) is c] for c in (True, False))
        scale = facts(product_of(*scales), domain)
        if len(rest) != 1 or rest[0].op != "**" or value(rest[0].args[1], domain) != 2 or not scale.defined or scale.sign != POSITIVE:
            return None
        rows.append(rest[0].args[0])
        weights.append(product_of(*scales))
    return rows, weights, Term("**", (minus(still), _HALF))


def _apart(total: Term, domain: StatedDomain) -> tuple[list[Term], Term]:
    """What the forces enter in a sum, and the rest together."""
    terms = total.args if total.op == "+" else (total,)
    moving = [t for t in terms if not domain.constant(t)]
    return moving, sum_of(*(t for t in terms if domain.constant(t)))


def _centre_and_reach(load: Term, ball: Ball, domain: StatedDomain) -> tuple[Term, Term] | None:
    """m, and r times the root of y_1^2/c_1 + ..., where the load is m + y . a."""
    rows, weights, radius = ball
    found = _share_of_one(load, rows, domain) or _shares_of_all(load, rows, domain)
    if found is None:
        return None
    centre, shares = found
    sizes = [product_of(y, Term("**", (c, number(Fraction(-1, 2))))) for y, c in zip(shares, weights, strict=True) if y != number(0)]
    return centre, product_of(radius, Term("norm", tuple(sizes) or (number(0),)))


def _share_of_one(load: Term, rows: Sequence[Term], domain: StatedDomain) -> tuple[Term, list[Term]] | None:
    for i, row in enumerate(rows):
        found = share_and_rest(domain.polynomial(load), domain.polynomial(row), domain)
        if found is not None:
            share, rest = map(written, found)
            return rest, [share if k == i else number(0) for k in range(len(rows))]
    return None


def _shares_of_all(load: Term, rows: Sequence[Term], domain: StatedDomain) -> tuple[Term, list[Term]] | None:
    """Where all coefficients are fractions."""
    try:
        (aim, *columns), (level, *levels) = zip(*(_numbers(term, domain) for term in (load, *rows)), strict=True)
    except NotWritten:
        return None
    equations = [(tuple(column[i] for column in columns), c) for i, c in enumerate(aim)]
    if (found := solved(equations, len(rows))[1]) is None:
        return None
    shares = [number(y) for y in found]
    return sum_of(level, minus(sum_of(*map(product_of, shares, levels)))), shares


def _numbers(term: Term, domain: StatedDomain) -> tuple[list[Fraction], Term]:
    row, level = affine(term, domain.law.forces, domain)
    found = [value(c, domain) for c in row]
    if any(c is None for c in found):
        raise NotWritten("a coefficient is no number")
    return [c for c in found if c is not None], level
