"""The sign of a constant over the whole domain: the one place that says which rule is asked, and in which order.

What is shown of the parts comes first.  If that leaves the sign of a sum, product or name open, the rules are, the cheap ones first:

1. a number that no parameter enters is enclosed (``constant_value``);
2. a sum with |x| or with a root is compared with the rest of the sum by squares;
3. the polynomial that the constant is has terms of one sign, measured from ends of ranges and with multiples of constraints taken away
   (``StatedDomain.nonnegative``), or no Bernstein coefficient of the other sign (``positivity``), or its enclosures over boxes of
   the parameters have one sign; so it is asked of the constant as written, and of what is left of it without what it divides by and
   what divides all of it;
4. a number made by roots is 0 where it is closer to 0 than such a number can be otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction

from duhem.proof.kernel.constant_value import sign_of_radicals, sign_over
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.identity import multiplied_through
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.positivity import nonnegative, without_content
from duhem.proof.kernel.shape import Shown
from duhem.proof.kernel.term import NotWritten, Term, minus, number, sum_of

__all__ = ["sign_of_constant"]

_FEW, _SHORT = 3, 12  # names and terms of a polynomial
_ONE_SIGN = (NEGATIVE, ZERO, POSITIVE)


def sign_of_constant(term: Term, known: Sign, domain: StatedDomain, shown: Shown) -> Sign:
    """What is left of the ``known`` signs, which its parts leave to a constant."""
    if known in _ONE_SIGN or term.op not in ("+", "*", "name"):
        return known
    if not term.names() - {"pi"} and (sign := sign_over(term, domain.bounds)) != ANY:
        return known & sign
    if (sign := _of_sum_with_a_size(term, domain, shown)) != ANY:
        return known & sign
    left = ANY
    for form in _of_one_sign(term, domain):
        for turned, sign in ((form, POSITIVE), (minus(form), NEGATIVE)):
            if domain.nonnegative(turned) or _above_zero(turned, domain):
                if domain.nonnegative(turned, strict=True) or _above_zero(turned, domain, strict=True):
                    return known & sign
                left &= sign | ZERO
        left &= sign_over(form, domain.bounds)
    return known & (left if left in _ONE_SIGN or term.names() else left & sign_of_radicals(term))


def _of_sum_with_a_size(term: Term, domain: StatedDomain, shown: Shown) -> Sign:
    """The sign of a sum that is < 0, or <= 0, although |x|, a norm or a root is one of its terms."""
    for i, part in enumerate(map(domain.plain, term.args) if term.op == "+" else ()):
        rest = sum_of(*term.args[:i], *term.args[i + 1 :])
        if part.op == "abs":  # |x| + y < 0 where x + y < 0 and -x + y < 0
            (x,) = part.args
            signs = [shown(Term("+", (*term.args[:i], side, *term.args[i + 1 :])), domain).sign for side in (x, minus(x))]
            if not (signs[0] | signs[1]) & POSITIVE:
                return signs[0] | signs[1]
        rooted = part.op == "**" and part.args[1] == number(Fraction(1, 2))
        if part.op == "norm" or rooted:  # |x| + y <= 0 where y <= 0 and x . x <= y^2; so is sqrt(x) + y where x <= y^2
            squares = part.args[:1] if rooted else [Term("*", (a, a)) for a in part.args]
            gap = Term("+", (Term("*", (rest, rest)), *map(minus, squares)))
            if not shown(rest, domain).sign & POSITIVE and domain.nonnegative(gap):
                return NEGATIVE if domain.nonnegative(gap, strict=True) else NEGATIVE | ZERO
    return ANY


def _above_zero(constant: Term, domain: StatedDomain, strict: bool = False) -> bool:
    """Whether a short polynomial has no Bernstein coefficient < 0."""
    poly = domain.polynomial(constant)
    if len({x for m in poly for x, _ in m}) > _FEW or len(poly) > _SHORT:
        return False
    with suppress(NotWritten):
        return nonnegative(poly, (Fraction(0), Fraction(1)), domain, strict)
    return False


def _of_one_sign(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """A constant, and what is left of it without what it divides by and what divides all of it, where that is simpler."""
    yield term
    poly = domain.polynomial(term)
    with suppress(NotWritten):
        if (left := without_content(multiplied_through(poly, domain, signed=True), domain)) != poly:
            yield written(left)
