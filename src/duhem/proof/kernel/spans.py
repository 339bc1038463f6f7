"""Where a constant that is no parameter lies, and which of two is the greater: what a sign of a sum rests on beside ranges and constraints.

A word that rises keeps the order of its arguments; a power of what is at most 1 is at most 1 for an exponent >= 0; a wave lies between
-1 and 1.  Over bounded ranges of all names an enclosure says more (R. E. Moore 1966).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from itertools import permutations

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, Sign
from duhem.proof.kernel.constant_value import BITS, Enclosure, enclosed
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import Term, minus, number, product_of, sum_of

__all__ = ["RISING", "below_right", "ordered", "span"]

_Signs = Callable[[Term], Sign]
_COARSE = 40  # binary digits that the ends of a span need not have
_ONE, _RIGHT = Fraction(1), product_of(number(Fraction(1, 2)), Term("name", name="pi"))
_NEAR_RIGHT = number(Fraction(3, 2))  # less than pi/2, and a fraction
_WITHIN = {
    "sin": Bounds(-_ONE, _ONE), "cos": Bounds(-_ONE, _ONE), "tanh": Bounds(-_ONE, _ONE, True, True), "exp": Bounds(Fraction(0), None, True),
    "atan": Bounds(-2 * _ONE, 2 * _ONE), "asin": Bounds(-2 * _ONE, 2 * _ONE), "acos": Bounds(Fraction(0), 4 * _ONE),
}  # fmt: skip
RISING = ("exp", "log", "atan", "asin", "sinh", "tanh")  # words that rise wherever they have a value


def span(atom: Term, sign: _Signs, bounds: Mapping[str, Bounds]) -> Bounds:
    """Where a constant lies, wherever it has a value, by its ``sign``, its word and the ranges of its names."""
    found = _WITHIN.get(atom.op, Bounds(None, None))
    for end, beside in ((Fraction(0), sign(atom)), (_ONE, _beside_one(atom, sign))):
        if not beside & NEGATIVE:
            found = found.above(end, not beside & ZERO)
        if not beside & POSITIVE:
            found = found.below(end, not beside & ZERO)
    ends = {name: bounds[name] for name in atom.names() - {"pi"} if name in bounds}
    if set(ends) == atom.names() - {"pi"} and all(own.low is not None and own.high is not None for own in ends.values()):
        pay(100)
        with suppress(ValueError, ZeroDivisionError):
            box = {name: Enclosure.between(own.low or Fraction(0), own.high or Fraction(0)) for name, own in ends.items()}
            low, high = enclosed(atom, box)
            found = found.above(Fraction(low >> _COARSE, 1 << BITS - _COARSE), False)
            found = found.below(Fraction(-(-high >> _COARSE), 1 << BITS - _COARSE), False)
    return found


def _beside_one(atom: Term, sign: _Signs) -> Sign:
    """The signs that atom - 1 may have, of an exponential and of a power of what is >= 0."""
    if atom.op == "exp":
        return sign(atom.args[0])
    if atom.op != "**" or sign(atom.args[0]) & NEGATIVE:
        return ANY
    base, exponent = sign(sum_of(atom.args[0], number(-1))), sign(atom.args[1])
    above, below = not base & NEGATIVE, not base & POSITIVE
    grows, falls = not exponent & NEGATIVE, not exponent & POSITIVE
    equal = (base | exponent) & ZERO
    if (above and grows) or (below and falls):
        return POSITIVE | equal
    return NEGATIVE | equal if (above and falls) or (below and grows) else ANY


def ordered(atoms: Collection[Term], sign: _Signs) -> Iterator[tuple[Polynomial, bool]]:
    """What is >= 0, or > 0, of two constants with one word that rises, or falls: y - x where it keeps, or turns, the order of arguments."""
    for x, y in permutations(sorted(atoms), 2):
        if x.op == y.op and (rises := _rises(x.op, (x.args[0], y.args[0]), sign)) is not None:
            gap = sign(sum_of(y.args[0], minus(x.args[0])))
            if not gap & (NEGATIVE if rises else POSITIVE):
                yield {((y, 1),): _ONE, ((x, 1),): -_ONE}, not gap & ZERO


def _rises(word: str, angles: Collection[Term], sign: _Signs) -> bool | None:
    """Whether a word rises, or falls, where these arguments may lie; None for a word that is not seen to do either."""
    if word in RISING or (word in ("tan", "sin") and all(below_right(angle, sign) for angle in angles)):
        return True
    ends = (end for angle in angles for end in (angle, sum_of(_RIGHT, _RIGHT, minus(angle))))
    return False if word == "acos" or (word == "cos" and not any(sign(end) & NEGATIVE for end in ends)) else None


def below_right(angle: Term, sign: _Signs) -> bool:
    """Whether an angle is less than a right one in size."""
    sides = (angle, minus(angle))
    return all(not sign(sum_of(_NEAR_RIGHT, side)) & NEGATIVE or sign(sum_of(_RIGHT, side)) == POSITIVE for side in sides)
