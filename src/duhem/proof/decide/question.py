"""The one question every proof comes down to: is an expression >= 0 (or > 0, or = 0) wherever some relations hold?

And what a formula asks of its parts before it means anything: divisors, roots, logarithms, poles, angles.  This is the one list of what a
function or power needs, for formulas as written and for questions.  The needs are read off a formula's tree as it stands, before any branch
is opened: abs(a)/a divides by a although on either side of a = 0 it is a constant.

And what a question or a claim may cost, in steps instead of seconds: counted alike on every machine, busy or idle.  A step is about a
microsecond of a core.  The kernel counts its own; the searches have prices, as measured.  What cannot be stopped half-way is priced by
its size before it is begun.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import partial
from typing import NamedTuple

import sympy as sp

from duhem.expression import UNDEFINED, Atan2, Where, holds_at
from duhem.expression.number import InertNumber, fraction

__all__ = [
    "ANY_STEPS", "EFFORTS", "NEAR_RIGHT", "Answer", "Budget", "Obligation", "Question", "Sense", "bounds", "evaluated", "obligations",
]  # fmt: skip

NEAR_RIGHT = sp.Rational(157, 100)  # an angle below pi/2


class Sense(StrEnum):
    """What is asked of an expression; of a divisor, ZERO asks that it is not 0."""

    NONNEGATIVE = ">="
    POSITIVE = ">"
    ZERO = "=="


class Obligation(NamedTuple):
    """``expr`` is not 0 (``sense`` ZERO), >= 0 or > 0 wherever ``given`` holds, or else those ``instead`` of it are met.

    ``does`` says what the formula does to it.  An expression that cannot be computed is nan: nothing is shown of it.
    """

    expr: sp.Expr
    sense: Sense
    does: str
    given: tuple[sp.Basic, ...] = ()
    instead: tuple[Obligation, ...] = ()

    @property
    def asked(self) -> tuple[sp.Expr, Sense]:
        """The obligation as a question: an expression and the sign that it must have."""
        return (self.expr**2, Sense.POSITIVE) if self.sense is Sense.ZERO else (self.expr, self.sense)

    def symbols(self) -> set[sp.Symbol]:
        """The symbols that occur in the obligation, its conditions and its alternatives."""
        return self.expr.free_symbols.union(*(r.free_symbols for r in self.given), *(o.symbols() for o in self.instead))

    def put(self, values: Mapping[sp.Symbol, sp.Expr]) -> Obligation:
        """The same obligation with values in the place of symbols."""
        given = tuple(r.xreplace({**values}) for r in self.given)
        return self._replace(expr=self.expr.xreplace({**values}), given=given, instead=tuple(o.put(values) for o in self.instead))

    def met(self, shown: Callable[[sp.Expr, Sense, tuple[sp.Basic, ...]], bool]) -> bool:
        """Return whether the obligation, or every one of its alternatives, is met; ``shown`` tells whether an expression has a sign."""
        ways = [self.asked, *((side * self.expr, Sense.POSITIVE) for side in (1, -1) if self.sense is Sense.ZERO)]
        if not any(e.has(*UNDEFINED) for e in (self.expr, *self.given)) and any(shown(*way, self.given) for way in ways):
            return True
        return bool(self.instead) and all(other._replace(given=self.given).met(shown) for other in self.instead)

    def broken(self, values: Mapping[sp.Symbol, sp.Expr]) -> bool:
        """Return whether the obligation certainly fails at exact values of all symbols."""
        if not all(holds_at(r, values) for r in self.given):
            return False
        value = self.expr.subs(values)
        fails = {Sense.ZERO: value.is_zero, Sense.NONNEGATIVE: value.is_negative, Sense.POSITIVE: value.is_nonpositive}[self.sense]
        return fails is True and (not self.instead or any(other.broken(values) for other in self.instead))


def obligations(tree: sp.Basic, given: tuple[sp.Basic, ...] = ()) -> Iterator[Obligation]:
    """Yield the obligations of every part of a formula's tree; a branch that a ``where`` does not choose needs no value."""
    if isinstance(tree, Where):
        condition, then, otherwise = tree.args
        yield from obligations(condition, given)
        holds = evaluated(condition)
        for choice, part in ((holds, then), (sp.Not(holds), otherwise)):
            if choice != sp.false:
                yield from obligations(part, given if choice == sp.true else (*given, choice))
        return
    for part in tree.args:
        yield from obligations(part, given)
    for kind, needs in _NEEDS.items():
        if isinstance(tree, kind):
            yield from (need._replace(given=given) for need in needs(*map(evaluated, tree.args)))


def evaluated(tree: sp.Basic) -> sp.Basic:
    """Return the tree as SymPy computes it, which has the same value wherever all obligations of its parts are met."""
    if not tree.args:
        return tree
    try:
        return tree.func(*map(evaluated, tree.args))
    except (ValueError, TypeError):  # nan compared with something
        return sp.nan


def _of_power(base: sp.Expr, exponent: sp.Expr) -> Iterator[Obligation]:
    p = exponent.value if isinstance(exponent, InertNumber) else exponent
    if p.is_Integer:
        if p < 0:
            yield Obligation(base, Sense.ZERO, "divides by")
    elif p.is_Rational:
        yield Obligation(base, Sense.NONNEGATIVE if p > 0 else Sense.POSITIVE, "takes a root of")
    else:  # 0 has positive powers only
        weak = Obligation(base, Sense.NONNEGATIVE, "takes a power of")
        rising = Obligation(exponent, Sense.POSITIVE, "takes a power with exponent")
        yield weak if exponent.is_positive else Obligation(base, Sense.POSITIVE, "takes a power of", instead=(weak, rising))


def _of_arc(name: str, x: sp.Expr) -> Iterator[Obligation]:
    yield from (Obligation(1 + sign * x, Sense.NONNEGATIVE, f"needs for an {name} that 0 <=") for sign in (-1, 1))


def _of_angle(y: sp.Expr, x: sp.Expr) -> Iterator[Obligation]:
    if not (y.is_nonzero or x.is_nonzero):
        yield Obligation(sp.Add(y**2, x**2), Sense.POSITIVE, "takes the angle of a point at the squared distance")


def _of_tangent(x: sp.Expr) -> Iterator[Obligation]:
    near = tuple(Obligation(NEAR_RIGHT + sign * x, Sense.POSITIVE, "takes the tangent of") for sign in (-1, 1))
    yield Obligation(sp.cos(x), Sense.ZERO, "divides by", instead=near)


_NEEDS: Mapping[type[sp.Basic], Callable[..., Iterator[Obligation]]] = {
    sp.Pow: _of_power,
    sp.log: lambda x: iter([Obligation(x, Sense.POSITIVE, "takes the logarithm of")]),
    sp.asin: partial(_of_arc, "arc sine"),
    sp.acos: partial(_of_arc, "arc cosine"),
    Atan2: _of_angle,
    sp.tan: _of_tangent,
}


@dataclass(frozen=True)
class Question:
    """For all real values of the symbols that satisfy every relation of ``given``: ``expr sense 0``?"""

    expr: sp.Expr
    sense: Sense
    given: tuple[sp.Basic, ...] = ()


def bounds(x: sp.Symbol, given: Iterable[sp.Basic]) -> tuple[Fraction | None, Fraction | None]:
    """Return the least and the greatest value that relations about this symbol alone give; None where they give none."""
    low = [fraction(r.lts) for r in given if getattr(r, "gts", None) == x and r.lts.is_Rational]
    high = [fraction(r.gts) for r in given if getattr(r, "lts", None) == x and r.gts.is_Rational]
    return max(low, default=None), min(high, default=None)


@dataclass(frozen=True)
class Answer:
    """``holds`` True: shown by ``method``; None: open."""

    holds: bool | None
    method: str = ""
    reason: str = ""


# -- steps -------------------------------------------------------------------------------------------------------------


ANY_STEPS = 1 << 62  # more than anybody spends
EFFORTS = {"quick": Fraction(1, 8), "normal": Fraction(1), "thorough": Fraction(8)}  # each budget is multiplied by


class Budget:
    """Steps that may still be spent; a part of it draws on the whole as well."""

    def __init__(self, steps: int, whole: Budget | None = None) -> None:
        self._given, self._left, self._whole = steps, steps, whole

    @property
    def spent(self) -> int:
        """How many steps were paid."""
        return self._given - self._left

    @property
    def left(self) -> int:
        """How many steps may be spent at once."""
        return self._left if self._whole is None else min(self._left, self._whole.left)

    def part(self, most: int) -> Budget:
        """Up to ``most`` of the steps that are left."""
        return Budget(min(most, self.left), self)

    def pays(self, steps: int) -> bool:
        """Pay for something before it is done; False, and nothing is paid, where it costs more than is left."""
        if steps > self.left:
            return False
        self._left -= steps
        return self._whole is None or self._whole.pays(steps)
