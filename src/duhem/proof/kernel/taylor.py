"""A polynomial of two forces in a part of a box, by its Taylor series about the middle of the part.

The series of a polynomial ends, so that g = sum_ij d_ij x^i y^j there, x and y being the distances from the middle, and term by term it is
differentiated.  Enclosures of the terms are much narrower than those of the formula as it is written, in which large parts cancel
(R. E. Moore 1966, Interval analysis).  The coefficients d_ij are enclosed, as each step of Horner's scheme is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import partial, reduce
from math import perm

from duhem.proof.kernel.constant_value import Enclosure, exact_value
from duhem.proof.kernel.polynomial import ONE, Polynomial, times, total
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import Term

__all__ = ["TaylorForm", "coefficients"]

_MOST = 24  # its degree in one force
_PRICE = 3  # steps for a product of enclosures
_Coefficients = Mapping[tuple[int, int], Fraction]
_ZERO = Enclosure(0, 0)
_times = partial(times, most=_MOST**4)  # of two polynomials of that degree


def coefficients(term: Term, forces: Sequence[str]) -> _Coefficients:
    """Those of a formula of sums, products and whole powers >= 0 of two forces and of numbers; ValueError for any other.

    As no part of such a formula is without a value anywhere, no part is lost with the others that it cancels.
    """
    x, y = (Term("name", name=name) for name in forces)
    found = {(dict(m).get(x, 0), dict(m).get(y, 0)): c for m, c in _read(term, forces, {}).items()}
    if max(map(max, found), default=0) > _MOST:
        raise ValueError("the degree is too high")
    return found


def _read(term: Term, forces: Sequence[str], done: dict[Term, Polynomial]) -> Polynomial:
    if term not in done:
        done[term] = _of_its_word(term, forces, done)  # once, as parts may be shared without end
    return done[term]


def _of_its_word(term: Term, forces: Sequence[str], done: dict[Term, Polynomial]) -> Polynomial:
    if not term.names():
        return {(): exact_value(term)}
    if term.op == "name" and term.name in forces:
        return {((term, 1),): Fraction(1)}
    if term.op == "+":
        return total(*(_read(part, forces, done) for part in term.args))
    if term.op == "*":
        return reduce(_times, (_read(part, forces, done) for part in term.args))
    if term.op == "**" and not term.args[1].names() and (n := exact_value(term.args[1])).denominator == 1 and 0 <= n <= _MOST:
        return reduce(_times, [_read(term.args[0], forces, done)] * int(n), ONE)
    raise ValueError(f"no polynomial of two forces: {term.op}")


class TaylorForm:
    """Enclosures of a polynomial and its derivatives in a part of the box."""

    def __init__(self, of: _Coefficients, box: Sequence[Enclosure]) -> None:
        size = 1 + max(map(max, of), default=0)
        pay(_PRICE * size**3)
        rows = [[Enclosure.between(c, c) for j in range(size) for c in [of.get((i, j), Fraction(0))]] for i in range(size)]
        middles = [Enclosure(m, m) for side in box for m in [(side.low + side.high) // 2]]
        columns = zip(*(_shifted(row, middles[1]) for row in rows), strict=True)
        self.columns = [_shifted([*column], middles[0]) for column in columns]
        ways = [side.plus(middle.minus()) for side, middle in zip(box, middles, strict=True)]
        self.powers = [[way.power(n) for n in range(size)] for way in ways]

    def value(self, _: Term) -> Enclosure:
        return self._derivative(0, 0)

    def of(self, _: Term) -> tuple[Enclosure, ...]:
        """The slopes by both forces; the second derivatives by the first alone, by both, by the second alone."""
        return tuple(self._derivative(n, m) for n, m in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))

    def _derivative(self, n: int, m: int) -> Enclosure:
        """By the first force n times and by the second m times."""
        x, y = self.powers
        total = _ZERO
        for j, column in enumerate(self.columns[m:], m):
            across = _ZERO
            for i, d in enumerate(column[n:], n):
                across = across.plus(Enclosure(d.low * perm(i, n), d.high * perm(i, n)).times(x[i - n]))
            total = total.plus(Enclosure(across.low * perm(j, m), across.high * perm(j, m)).times(y[j - m]))
        return total


def _shifted(row: list[Enclosure], middle: Enclosure) -> list[Enclosure]:
    """The coefficients in x of sum_i row_i (x + middle)^i, by Horner's scheme again and again."""
    found = [*row]
    for k in range(len(found)):
        for i in reversed(range(k, len(found) - 1)):
            found[i] = found[i].plus(middle.times(found[i + 1]))
    return found
