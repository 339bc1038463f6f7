"""Polynomials as sums of squares, each times a product of constants >= 0, by Lagrange's reduction; and how polynomials are presented."""

from __future__ import annotations

from fractions import Fraction

from duhem.proof.kernel.domain import NEGATIVE, ZERO, StatedDomain
from duhem.proof.kernel.polynomial import Monomial, Polynomial, divided, in_powers, negated, times, total
from duhem.proof.kernel.term import Term, number

__all__ = ["added", "plainly", "scaled", "sum_of_squares"]

_UNIT = Term("name", name="the unit")  # no name of a law has blanks


def sum_of_squares(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """Products of constants >= 0, each with a polynomial times whose square it is, added up; None where none are found.

    By Lagrange's reduction (1759): a x^2 + b x + c is a (x + b/(2 a))^2 + c - b^2/(4 a), and x is gone from the rest.
    """
    return _by_products(poly, domain) or _by_one_force_after_another(poly, domain)


def _by_one_force_after_another(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """Where one product of constants stands with the square of each force, and divides what stands with twice that force."""
    found, left = list[tuple[Term, Polynomial]](), poly
    for x in sorted({x for m in poly for x, _ in m if not domain.constant(x)}):
        if not any(x in dict(m) for m in left):
            continue
        if x.op != "name" or any(dict(m).get(x, 0) < 0 for m in left) or len(powers := in_powers(left, x)) != 3 or len(powers[2]) != 1:
            return None
        scale, whole = plainly(powers[2]), _completed(x, powers)
        if not domain.constant(scale) or domain.facts(scale).sign & NEGATIVE:
            return None
        if any(n < 0 and domain.of(y) & ZERO for m in whole for y, n in m):
            return None
        found.append((scale, whole))
        left = total(left, negated(times(powers[2], times(whole, whole))))
    return None if left else found


def _by_products(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """For each product of constants, of what it multiplies: a form of second degree with numbers as coefficients.

    Its variables are the forces, the constants that stand once beside a force, and 1.
    """
    beside = {x for m in poly if sum(n for y, n in m if not domain.constant(y)) == 1 for x, n in m if domain.constant(x) and n == 1}
    groups: dict[Monomial, Polynomial] = {}
    for m, a in sorted(poly.items()):
        own = tuple((x, n) for x, n in m if x in beside or not domain.constant(x))
        if any(n < 0 for _, n in own) or (degree := sum(n for _, n in own)) > 2:
            return None
        own = tuple(sorted([*own, (_UNIT, 2 - degree)])) if degree < 2 else own
        groups.setdefault(tuple((x, n) for x, n in m if (x, n) not in own), {})[own] = a
    found = list[tuple[Term, Polynomial]]()
    for scale, form in groups.items():
        if domain.facts(plainly({scale: Fraction(1)})).sign & NEGATIVE:
            return None
        while form:
            x = next((x for m, a in sorted(form.items()) for x, n in m if n == 2 and a > 0), None)
            if x is None:
                return None
            powers = in_powers(form, x)
            whole = _completed(x, powers)
            found.append((scaled(number(powers[2][()]), scale), {tuple(y for y in m if y[0] != _UNIT): b for m, b in whole.items()}))
            form = total(form, negated(times(powers[2], times(whole, whole))))
    return found


def _completed(x: Term, powers: list[Polynomial]) -> Polynomial:
    """y = x + b/(2 a), where a y^2 is all of a x^2 + b x + c that x enters; a is one term."""
    ((m, a),) = powers[2].items()
    return total({((x, 1),): Fraction(1)}, divided(powers[1], m, 2 * a))


def _unit(x: Term) -> bool:
    """Whether it is 1/P or a root of P."""
    return x.op == "**" and x.args[1].op == "number" and abs(x.args[1].value.numerator) == 1


def scaled(scale: Term, parts: Monomial) -> Term:
    """A product of a scale, which may be 1, and powers."""
    powers = [x if n == 1 else Term("**", (x.args[0], number(n * x.args[1].value)) if _unit(x) else (x, number(n))) for x, n in parts]
    found = [*([] if scale == number(1) and powers else scale.args if scale.op == "*" else [scale]), *powers]
    return found[0] if len(found) == 1 else Term("*", tuple(found))


def plainly(poly: Polynomial) -> Term:
    """A polynomial as it is."""
    return added([scaled(number(c), m) for m, c in sorted(poly.items())])


def added(parts: list[Term]) -> Term:
    """The sum of terms as they are, 0 for none."""
    return parts[0] if len(parts) == 1 else Term("+", tuple(parts)) if parts else number(0)
