"""The exact sign of a number made of fractions by sums, products, quotients and roots.

Such a number is U/L with algebraic integers U and L, all of whose conjugates are at most u and l, read off its form.  If it is not 0,
neither is the norm of U, a whole number; so |U/L| >= 1/(u^(D - 1) l), D the product of the roots' indices (Burnikel, Funke,
Mehlhorn, Schirra, Schmitt 2001, ESA, LNCS 2161, 254).  What an enclosure shows to be closer to 0 is 0.
"""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from math import isqrt, lcm, prod

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Sign
from duhem.proof.kernel.term import NotWritten, Term, number, product_of, sum_of

__all__ = ["sign_of_radicals"]

_FEW, _MOST_BITS, _SPARE, _LARGEST = 128, 1 << 15, 64, 200  # binary digits; the largest index and exponent
Ends = tuple[int, int]  # of an interval, in units


def sign_of_radicals(term: Term) -> Sign:
    """The sign; all three for what is no such number, may be undefined or would take too many digits."""
    try:
        term, roots = _without_norms(term), dict[Term, int]()
        u, below = _sizes(term, roots)
        if max(u, below) > _MOST_BITS:
            return ANY
        low, high = _between(term, _FEW)
        if low > 0 or high < 0:
            return POSITIVE if low > 0 else NEGATIVE
        apart = u * (prod(roots.values()) - 1) + below
        if apart > _MOST_BITS:
            return ANY
        bits = apart + u + _SPARE
        low, high = _between(term, bits)
    except (NotWritten, ZeroDivisionError):
        return ANY
    if low > 0 or high < 0:
        return POSITIVE if low > 0 else NEGATIVE
    return ZERO if max(-low, high) < 1 << (bits - apart) else ANY


def _without_norms(term: Term) -> Term:
    """The term with every Euclidean norm written as a root."""
    term = term._replace(args=tuple(map(_without_norms, term.args)))
    return Term("**", (sum_of(*(product_of(a, a) for a in term.args)), number(Fraction(1, 2)))) if term.op == "norm" else term


def _exponent(term: Term) -> Fraction:
    power = _fraction(term.args[1])
    if abs(power.numerator) > _LARGEST or power.denominator > _LARGEST:
        raise NotWritten("an exponent is no small fraction")
    return power


def _fraction(term: Term) -> Fraction:
    """The value of a quotient such as 1/3."""
    if term.op == "number":
        return term.value
    if term.op == "**" and abs(n := _fraction(term.args[1])) == 1:
        return _fraction(term.args[0]) ** int(n)
    if term.op in ("+", "*"):
        parts = map(_fraction, term.args)
        return sum(parts, Fraction(0)) if term.op == "+" else prod(parts, start=Fraction(1))
    raise NotWritten("an exponent is no fraction")


def _sizes(term: Term, roots: dict[Term, int]) -> Ends:
    """The logarithms to base 2 of u and l, rounded up; ``roots`` takes up what roots are taken of, and of which index."""
    if term.op == "number":
        return max(0, abs(term.value.numerator) - 1).bit_length(), (term.value.denominator - 1).bit_length()
    if term.op == "**":
        n = _exponent(term)
        k, (u, below) = n.denominator, _sizes(term.args[0], roots)
        if k > 1:
            roots[term.args[0]] = lcm(k, roots.get(term.args[0], 1))
            u = -(-(u + (k - 1) * below) // k)  # the k-th root of U/L is that of U L^(k - 1), over L
        u, below = abs(n.numerator) * u, abs(n.numerator) * below
        return (u, below) if n > 0 else (below, u)
    if term.op not in ("+", "*", "abs"):
        raise NotWritten(f"{term.op} is no root")
    parts = [_sizes(a, roots) for a in term.args]
    below = sum(low for _, low in parts)
    if term.op == "+":
        return max(u + below - low for u, low in parts) + (len(parts) - 1).bit_length(), below
    return sum(u for u, _ in parts), below


def _between(term: Term, bits: int) -> Ends:
    """Whole multiples of 2^-bits between which the number lies."""
    if term.op == "number":
        over, under = term.value.numerator << bits, term.value.denominator
        return over // under, -(-over // under)
    if term.op == "**":
        return _power(_between(term.args[0], bits), _exponent(term), bits)
    parts = [_between(a, bits) for a in term.args]
    match term.op:
        case "+":
            return sum(low for low, _ in parts), sum(high for _, high in parts)
        case "*":
            return reduce(lambda x, y: _times(x, y, bits), parts)
        case "abs":
            low, high = parts[0]
            return (low, high) if low >= 0 else (-high, -low) if high <= 0 else (0, max(-low, high))
    raise NotWritten(f"{term.op} is no root")


def _times(x: Ends, y: Ends, bits: int) -> Ends:
    ends = [a * b for a in x for b in y]
    return min(ends) >> bits, -(-max(ends) >> bits)


def _power(x: Ends, n: Fraction, bits: int) -> Ends:
    k = n.denominator
    if k > 1:
        if x[0] < 0:
            raise NotWritten("a root may be undefined")
        x = _root(x[0] << (k - 1) * bits, k), _root(x[1] << (k - 1) * bits, k) + 1
    if n < 0:
        if x[0] <= 0 <= x[1]:
            raise ZeroDivisionError("an interval holds 0")
        one = 1 << 2 * bits
        x = one // x[1], -(-one // x[0])
    return reduce(lambda y, _: _times(x, y, bits), range(abs(n.numerator)), (1 << bits, 1 << bits))


def _root(x: int, k: int) -> int:
    """The greatest whole number whose k-th power is at most x."""
    if k == 2 or x < 2:
        return isqrt(x)
    found = 1 << -(-x.bit_length() // k)
    while (lower := ((k - 1) * found + x // found ** (k - 1)) // k) < found:  # Newton's method, from above
        found = lower
    return found
