"""What a function or power needs of its arguments to have a value: the one list of it, for formulas as written and for questions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from enum import StrEnum
from typing import NamedTuple

import sympy as sp

from duhem.expression import Atan2
from duhem.expression.inert_number import InertNumber

__all__ = ["NEEDY", "Need", "Sense", "needs_of"]


class Sense(StrEnum):
    """What is asked of an expression, or needed: of a divisor (ZERO) that it is not 0."""

    NONNEGATIVE = ">="
    POSITIVE = ">"
    ZERO = "=="


class Need(NamedTuple):
    """``expr`` is not 0 (``sense`` ZERO), >= 0 or > 0, or else those ``instead`` of it are met; ``does`` says what is done to it."""

    expr: sp.Expr
    sense: Sense
    does: str
    instead: tuple[Need, ...] = ()


def needs_of(kind: type[sp.Basic], args: tuple[sp.Expr, ...]) -> Iterator[Need]:
    """The needs of a function of this kind, those of its arguments aside; none of a function that has a value everywhere."""
    for needy, needs in _NEEDS.items():
        if issubclass(kind, needy):
            yield from needs(*args)


def _of_power(base: sp.Expr, exponent: sp.Expr) -> Iterator[Need]:
    p = exponent.value if isinstance(exponent, InertNumber) else exponent
    if p.is_Integer:
        if p < 0:
            yield Need(base, Sense.ZERO, "divides by")
    elif p.is_Rational:
        yield Need(base, Sense.NONNEGATIVE if p > 0 else Sense.POSITIVE, "takes a root of")
    else:  # 0 has positive powers only
        weak = Need(base, Sense.NONNEGATIVE, "takes a power of")
        rising = Need(exponent, Sense.POSITIVE, "takes a power with exponent")
        yield Need(base, Sense.POSITIVE, "takes a power of", (weak, rising))


def _of_logarithm(x: sp.Expr) -> Iterator[Need]:
    yield Need(x, Sense.POSITIVE, "takes the logarithm of")


def _of_arc(name: str) -> Callable[[sp.Expr], Iterator[Need]]:
    def needs(x: sp.Expr) -> Iterator[Need]:
        yield from (Need(1 + sign * x, Sense.NONNEGATIVE, f"needs for an {name} that 0 <=") for sign in (-1, 1))

    return needs


def _of_angle(y: sp.Expr, x: sp.Expr) -> Iterator[Need]:
    if not (y.is_nonzero or x.is_nonzero):
        yield Need(sp.Add(y**2, x**2), Sense.POSITIVE, "takes the angle of a point at the squared distance")


def _of_tangent(x: sp.Expr) -> Iterator[Need]:
    yield Need(sp.cos(x), Sense.ZERO, "divides by")


_NEEDS: Mapping[type[sp.Basic], Callable[..., Iterator[Need]]] = {
    sp.Pow: _of_power,
    sp.log: _of_logarithm,
    sp.asin: _of_arc("arc sine"),
    sp.acos: _of_arc("arc cosine"),
    Atan2: _of_angle,
    sp.tan: _of_tangent,
}
NEEDY = tuple(_NEEDS)  # the functions that have no value everywhere
