"""What a law states, as titled fields in words: its boundary, names, domains, slip and source."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Context
from fractions import Fraction

from duhem.expression.text import formula
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.yield_surface import YieldSurface
from duhem.show.page import tied

__all__ = ["number_in_short", "number_in_words", "stated"]

_DIGITS = Context(prec=8)
_SHORT = 12  # characters of an exact number that a cell of a table shows whole


def stated(law: Law) -> Iterator[tuple[str, str]]:
    """Titles and contents, the boundary of K first; spaces that a line may not break at are tied."""
    yield _boundary(law)
    pressure = f"; pressure {law.pressure} <= 0 in compression, frozen" if law.pressure else "; no pressure"
    yield "forces", ", ".join(law.forces) + pressure
    yield "parameters", ", ".join(_in_domain(n, d.describe()) for n, d in law.parameters.items()) or "none"
    if not isinstance(law, ParametricCriterion) and law.domain:
        yield "asked for", ", ".join(d.stated(n) for n, d in law.domain.items())
    if law.constraints:
        yield "with", ", ".join(formula(c) for c in law.constraints)
    yield "slip", _direction(law)
    if law.source:
        yield "source", law.source


def number_in_words(exact: str) -> str:
    """A rational in decimals and exactly: ``= 0.15 = 3/20``, or ``~ 0.33333333 = 1/3`` where decimals do not end."""
    decimal = _decimal(exact)
    return f"= {exact}" if decimal is None or Fraction(exact).denominator == 1 else f"{decimal} = {exact}"


def number_in_short(exact: str) -> str:
    """The same in a cell of a table: exactly, ``= 3/20``, but ``~ 0.20000315`` where that is long; what is no number stays as it is."""
    decimal = _decimal(exact) if len(exact) > _SHORT else None
    return f"= {exact}" if decimal is None else decimal


def _decimal(exact: str) -> str | None:
    """A rational to eight digits, after the sign that says whether these are all; None for what is none."""
    try:
        fraction = Fraction(exact)
    except (ValueError, ZeroDivisionError):
        return None
    decimal = _DIGITS.divide(*(_DIGITS.create_decimal(x) for x in fraction.as_integer_ratio()))
    return f"= {decimal.normalize()}" if Fraction(decimal) == fraction else f"~ {decimal}"


def _direction(law: Law) -> str:
    if law.associated:
        return "normal to the boundary (associated)"
    if isinstance(law, ParametricCriterion) or not law.surfaces:
        return _slip(law)
    return "any sum of: " + "; ".join(f"{_slip(surface)} where {formula(surface.g)} = 0" for surface in law.surfaces)


def _slip(own: Law | YieldSurface) -> str:
    if not isinstance(own, ParametricCriterion) and own.potential is not None:
        return f"gradient of {' '.join(own.potential.split())}"
    return "normal" if own.flow is None else f"({', '.join(formula(c) for c in own.flow)})"


def _boundary(law: Law) -> tuple[str, str]:
    """What bounds K: the formula, or the curve at |pressure| = 1."""
    if isinstance(law, ParametricCriterion):
        return "boundary", f"|{law.pressure}| ({', '.join(formula(x) for x in law.boundary)}), {law.angle} from 0 to 2 pi"
    return "criterion", f"{formula(law.g)} <= 0"


def _in_domain(name: str, domain: str) -> str:
    if domain.startswith("="):
        return tied(f"{name} {number_in_words(domain[1:].strip())}")
    return f"{name} in {domain}" if domain[0] in "[(" else f"{name} {domain}"
