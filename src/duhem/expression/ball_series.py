"""Formulas over power series in real balls (Arb): an enclosure of a value and its derivatives along a line, arc or step.

A value may also be a plain ball, a series that is constant.  A kink (abs, pos, ...) is followed where the sign of what it
bends is certain; where it is open the value is enclosed and every derivative is the indeterminate ball.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial, reduce
from math import factorial
from typing import Any

import flint
import sympy as sp

from duhem.errors import InputError
from duhem.expression import balls
from duhem.expression.balls import certain_sign, constant
from duhem.expression.elementary import ELEMENTARY, Elementary
from duhem.expression.fold import Table, bound, recorded
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, deviator

__all__ = ["TABLE", "compiled", "derivatives"]


def compiled(exprs: Sequence[sp.Expr], symbols: Iterable[sp.Symbol]) -> Callable[..., tuple[Any, ...]]:
    """The formulas as one function of the symbols' series; walked once, run in the precision of each call."""
    rows = {sp.Tuple: lambda _, *parts: parts, **TABLE}
    recording = recorded(sp.Tuple(*exprs), symbols, bound(rows), lambda node: partial(_known, node))
    return lambda *values: tuple(recording.value(values))


def derivatives(value: Any, order: int) -> list[Any]:
    """The value at 0 and its derivatives up to ``order``, in balls."""
    if not isinstance(value, flint.arb_series):
        return [value, *([flint.arb(0)] * order)]
    return [value[k] * factorial(k) for k in range(order + 1)]


def _known(node: Any) -> Any:
    value = constant(node)
    if value is None:
        raise InputError(f"{node} has no value", remedy="fix every parameter")
    return value


def _power(node: sp.Pow, base: Any, exponent: Any) -> Any:
    if node.exp.is_Integer:
        raised = base ** abs(int(node.exp))
        return raised if node.exp > 0 else _inverse(raised)
    if node.exp == sp.S.Half:
        return base.sqrt()
    return base**exponent


def _inverse(x: Any) -> Any:
    """1/x; not a number where x may vanish, which a series would refuse."""
    if isinstance(x, flint.arb_series) and certain_sign(x[0]) not in (1, -1):
        return flint.arb_series([flint.arb("nan")] * x.prec, prec=x.prec)
    return 1 / x


def _signed(node: sp.Basic, x: Any, left: int, right: int) -> Any:
    """left * x below 0 and right * x above; where the sign is open the value is enclosed and no derivative known."""
    here = _here(x)
    sign = certain_sign(here)
    if sign in (1, -1):
        return x * (left if sign == -1 else right)
    value = (here * left).union(here * right) if here.is_finite() else here
    return _open(value, x)


def _here(x: Any) -> Any:
    """The value at 0."""
    return x[0] if isinstance(x, flint.arb_series) else x


def _open(value: Any, *like: Any) -> Any:
    """A value of which no derivative is known, as a series where one of ``like`` is one."""
    orders = [x.prec for x in like if isinstance(x, flint.arb_series)]
    return flint.arb_series([value, *([flint.arb("nan")] * (min(orders) - 1))], prec=min(orders)) if orders else value


def _lattice(below: int, node: sp.Basic, first: Any, *rest: Any) -> Any:
    """The least where what is ``below`` another counts (1), else the greatest (0)."""
    return reduce(lambda a, b: b + _signed(node, a - b, below, 1 - below), rest, first)


def _atan2(node: sp.Basic, y: Any, x: Any) -> Any:
    if certain_sign(_here(x)) == 1:
        return (y * _inverse(x)).atan()
    if (above := certain_sign(_here(y))) in (1, -1):
        return above * flint.arb.pi() / 2 - (x * _inverse(y)).atan()
    return _open(balls.TABLE[Atan2](node, _here(y), _here(x)), y, x)


def _eigmax(node: sp.Basic, *entries: Any) -> Any:
    mean, second, third = deviator(*entries)
    if certain_sign(_here(second)) == 1:
        root = (second / 3).sqrt()
        turn = third * _inverse(2 * root * root * root)
        if -1 < _here(turn) < 1:
            return mean + 2 * root * (turn.acos() / 3).cos()
    return _open(balls.TABLE[EigMax](node, *map(_here, entries)), *entries)


def _elementary(word: Elementary, node: sp.Basic, x: Any) -> Any:
    if not isinstance(x, flint.arb_series):
        return balls.TABLE[word.node](node, x)
    return word.series(x) if word.series else getattr(x, word.name)()


def _compared(sense: int, _: sp.Basic, a: Any, b: Any) -> bool | None:
    sign = certain_sign(_here(a - b))
    return None if not sign else sign == sense


TABLE: Table[Any] = {
    sp.Add: balls.TABLE[sp.Add],
    sp.Mul: balls.TABLE[sp.Mul],
    sp.Pow: _power,
    **{word.node: partial(_elementary, word) for word in ELEMENTARY.values()},
    Atan2: _atan2,
    sp.Abs: lambda node, x: _signed(node, x, -1, 1),
    Pos: lambda node, x: _signed(node, x, 0, 1),
    Neg: lambda node, x: _signed(node, x, -1, 0),
    sp.Max: partial(_lattice, 0),
    sp.Min: partial(_lattice, 1),
    Norm: lambda _, *parts: sum((p * p for p in parts), flint.arb(0)).sqrt(),
    EigMax: _eigmax,
    Where: lambda node, condition, a, b: flint.arb("nan") * a if condition is None else a if condition else b,
    **{kind: partial(_compared, 1 if holds(1, 0) else -1) for kind, holds in COMPARISONS.items()},
}
