"""Polynomials as sums of squares, each times a product of constants >= 0, by Lagrange's reduction; and how polynomials are presented."""

from __future__ import annotations

from fractions import Fraction

from duhem.proof.kernel.domain import NEGATIVE, ZERO, StatedDomain
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, joined, negated, times, total
from duhem.proof.kernel.term import Term, number

__all__ = ["added", "plainly", "scaled", "sum_of_squares"]

_UNIT = Term("name", name="the unit")  # no name of a law has blanks


def sum_of_squares(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """Products of constants >= 0, each with a polynomial, the sum of whose squares it is; None where none is found."""
    return _by_products(poly, domain) or _by_one_force_after_another(poly, domain)


def _by_one_force_after_another(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """By Lagrange's reduction, where one product of constants stands with the square of a force and divides what stands with twice it."""
    found, left = list[tuple[Term, Polynomial]](), poly
    for x in sorted({x for m in poly for x, _ in m if not domain.constant(x)}):
        if not any(x in dict(m) for m in left):
            continue
        if x.op != "name" or any(dict(m).get(x, 0) < 0 for m in left) or len(powers := in_powers(left, x)) != 3 or len(powers[2]) != 1:
            return None
        ((m, c),) = powers[2].items()
        scale, whole = plainly({m: c}), times(powers[1], {tuple((y, -n) for y, n in m): 1 / (2 * c)})
        if (
            not domain.constant(scale)
            or domain.facts(scale).sign & NEGATIVE
            or any(n < 0 and domain.of(y) & ZERO for k in whole for y, n in k)
        ):
            return None
        whole = total({((x, 1),): Fraction(1)}, whole)
        found.append((scale, whole))
        left = total(left, negated(times(powers[2], times(whole, whole))))
    return None if left else found


def _by_products(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """By Lagrange's reduction in fractions.

    Its terms of second degree, in the forces and in what stands beside a force once, are taken for each product of other constants.
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
            square = next(((x, a) for m, a in sorted(form.items()) for x, n in m if n == 2 and a > 0), None)
            if square is None:
                return None
            x, a = square
            beside_x = {m: b / (a if dict(m)[x] == 2 else 2 * a) for m, b in form.items() if x in dict(m)}
            whole = {joined(m, ((x, -1),)): b for m, b in beside_x.items()}
            form = total(form, times({(): -a}, times(whole, whole)))
            line = {tuple(y for y in m if y[0] != _UNIT): b for m, b in whole.items()}
            found.append((scaled(number(a), scale), line))
            if any(x in dict(m) for m in form):
                return None
    return found


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
    return parts[0] if len(parts) == 1 else Term("+", tuple(parts)) if parts else number(0)
