"""Whether two formulas have one value: multiplied out, powers of roots undone, what they divide by multiplied through.

Or whether they are one as functions: what stands under |.|, a norm or an even power with one of its two signs, in order.
"""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.polynomial import Polynomial, in_powers, negated, number_in, times, total, written
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sign_of, sum_of

__all__ = ["alike", "in_order", "multiplied_out", "multiplied_through", "signs_as_sizes", "value", "vanishes", "written_in_order"]

_MOST_STEPS, _HIGHEST = 60, 64
_SORTED = ("norm", "max", "min")
_EVEN = ("abs", "norm", "cos", "cosh")  # the same for x and -x


def multiplied_out(term: Term, domain: StatedDomain) -> Term:
    """The same as a sum of products."""
    return written(domain.polynomial(term))


def value(term: Term, domain: StatedDomain) -> Fraction | None:
    """The number that a term is; None where it is not seen to be one."""
    return number_in(domain.polynomial(term))


def vanishes(term: Term, domain: StatedDomain) -> bool:
    """Whether a term is 0 wherever it is defined; False where these rules do not show it."""
    return not multiplied_through(domain.polynomial(term), domain)


def signs_as_sizes(term: Term, domain: StatedDomain) -> Term:
    """The same, multiplied out, with c |y| for c y sign(y), where a sign stands with such a multiple of its argument alone."""
    poly = domain.polynomial(term)
    for sign, y in {x: y for m in poly for x, _ in m if (y := sign_of(x)) is not None}.items():
        own = domain.polynomial(y)
        linear = next((m for m in own if len(m) == 1 and m[0][1] == 1), None)
        if linear is None or any(n < 0 for m in poly for x, n in m if x in (sign, linear[0][0])):
            continue
        powers = in_powers(poly, sign)  # what came before may have left none of it
        coefficients = in_powers(powers[1], linear[0][0]) if len(powers) == 2 else []
        c = times(coefficients[1], {(): 1 / own[linear]}) if len(coefficients) > 1 else {}
        if c and powers[1] == times(c, own):
            poly = total(powers[0], times(c, domain.polynomial(Term("abs", (y,)))))
    return written(poly)


def multiplied_through(poly: Polynomial, domain: StatedDomain, signed: bool = False) -> Polynomial:
    """The polynomial times what it divides by, and powers of roots undone; ``signed``: times what is seen to be > 0 alone."""
    kept = set[Term]()
    for _ in range(_MOST_STEPS):
        found = next(((x, *root) for m in poly for x, n in m if x not in kept and (root := _undone(x, n, domain)) is not None), None)
        if found is None:
            break
        atom, base, e = found
        least = -min(0, *(dict(m).get(atom, 0) * e.numerator // e.denominator for m in poly))  # how often it is divided by the base
        sign = domain.of(base) if signed and least % 2 else POSITIVE
        if sign not in (NEGATIVE, POSITIVE):
            kept.add(atom)
            continue
        poly = domain.polynomial(_without(atom, base, e, least, poly))
        if sign == NEGATIVE:
            poly = negated(poly)
    return poly


def _root(x: Term, domain: StatedDomain) -> tuple[Term, Fraction] | None:
    """(y, e) where x = y**e, y >= 0 unless e is whole; a size is the root of a square, a norm that of a sum of squares."""
    if x.op in ("abs", "norm"):
        return sum_of(*(product_of(a, a) for a in x.args)), Fraction(1, 2)
    if x.op != "**" or (e := value(x.args[1], domain)) is None or _high(e):
        return None
    y = x.args[0]
    if y.op == "**" and (k := value(y.args[1], domain)) is not None and not _high(k * e):  # (z**k)**e is z**(k e) for z >= 0
        sign = domain.of(y.args[0])
        if not sign & NEGATIVE:
            return y.args[0], k * e
        if not sign & POSITIVE and k % 2 == 0:
            return minus(y.args[0]), k * e
    return y, e


def _high(e: Fraction) -> bool:
    """Whether an exponent is beyond what is multiplied out."""
    return max(abs(e.numerator), e.denominator) > _HIGHEST


def _undone(x: Term, n: int, domain: StatedDomain) -> tuple[Term, Fraction] | None:
    """That y and e where x**n is to be written otherwise: as y**k y**(j/s) with 0 <= j < s, and k >= 0 after multiplying through."""
    if (found := _root(x, domain)) is None:
        return None
    y, e = found
    plain = x.op != "**" or x.args == (y, number(e))
    return None if plain and e >= 0 and (e.denominator == 1 or (e.numerator == 1 and 0 <= n < e.denominator)) else found


def _without(x: Term, y: Term, e: Fraction, least: int, poly: Polynomial) -> Term:
    """The polynomial times y**least, which leaves none below the line, x = y**e."""
    root = x if x.op != "**" else Term("**", (y, number(Fraction(1, e.denominator))))
    parts = list[Term]()
    for m, c in poly.items():
        k, j = divmod(dict(m).get(x, 0) * e.numerator, e.denominator)
        rest = written({tuple((z, n) for z, n in m if z != x): c})
        parts.append(product_of(rest, Term("**", (y, number(k + least))), *[root] * j))
    return sum_of(*parts)


def alike(one: Term, two: Term, domain: StatedDomain) -> bool:
    """Whether they have one form, even powers multiplied out or kept as powers of a size; False where neither is seen."""
    for powers in (False, True):
        with suppress(NotWritten):
            if _form(one, domain, powers) == _form(two, domain, powers):
                return True
    return False


def _form(term: Term, domain: StatedDomain, powers: bool) -> Polynomial:
    return domain.polynomial(in_order(term, domain, powers))


def in_order(term: Term, domain: StatedDomain, powers: bool = False) -> Term:
    """The same formula, its parts multiplied out, and written alike where they are alike; even ``powers`` as those of a size."""
    if not term.args:
        return term
    args = [written_in_order(domain.polynomial(in_order(a, domain, powers))) for a in term.args]
    even = term.op == "**" and args[1].op == "number" and args[1].value % 2 == 0
    if term.op in _EVEN or even:
        sized = 1 if even else len(args)
        args[:sized] = [min(a, written_in_order(domain.polynomial(minus(a)))) for a in args[:sized]]
    if even and powers:
        args[0] = Term("abs", (args[0],))
    return Term(term.op, tuple(sorted(args) if term.op in _SORTED else args))


def written_in_order(poly: Polynomial) -> Term:
    """A number as it is, else a sum of products in order: the same for equal polynomials."""
    return number(poly.get((), 0)) if number_in(poly) is not None else written(dict(sorted(poly.items())))
