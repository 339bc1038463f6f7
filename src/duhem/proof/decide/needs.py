"""What a function or power needs of its arguments to have a value: the one list of it, for formulas as written and for questions."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from typing import NamedTuple

import sympy as sp

from duhem.expression import Atan2
from duhem.expression.inert_number import InertNumber

__all__ = ["NEEDY", "Need", "Sense", "needs_of"]

NEEDY = (sp.Pow, sp.log, sp.asin, sp.acos, Atan2, sp.tan)  # the functions that have no value everywhere


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
    """The needs of a function of a kind that is NEEDY, those of its arguments aside."""
    if issubclass(kind, sp.Pow):
        yield from _of_power(*args)
    elif issubclass(kind, sp.log):
        yield Need(args[0], Sense.POSITIVE, "takes the logarithm of")
    elif issubclass(kind, sp.asin | sp.acos):
        does = f"needs for an arc {'sine' if issubclass(kind, sp.asin) else 'cosine'} that 0 <="
        yield from (Need(1 + sign * args[0], Sense.NONNEGATIVE, does) for sign in (-1, 1))
    elif issubclass(kind, Atan2):
        if not any(x.is_nonzero for x in args):
            yield Need(sp.Add(*(x**2 for x in args)), Sense.POSITIVE, "takes the angle of a point at the squared distance")
    elif issubclass(kind, sp.tan):
        yield Need(sp.cos(args[0]), Sense.ZERO, "divides by")


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
