"""Formulas over real balls (Arb through python-flint): an enclosure of every value over a box, outward rounded.

Kinks are enclosed without being decided: ``where`` with an open condition is the union of its branches.  A value that
may leave the domain of a function (a root or a logarithm of what may be negative) is the indeterminate ball.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import partial, reduce
from operator import add, ge, gt, le, lt, mul
from typing import Any

import flint
import sympy as sp

from duhem.expression.elementary import ELEMENTARY, Elementary
from duhem.expression.fold import Table, bound, fold, once_a_precision, recorded
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, deviator

__all__ = ["TABLE", "ball", "certain_sign", "compiled", "constant", "enclose", "precision"]

_MOST = 10_000  # an exponent with a letter in it, that is a whole number


def precision(bits: int) -> Any:
    """Context manager: working precision in bits."""
    return flint.ctx.workprec(bits)


def ball(low: Fraction, high: Fraction | None = None) -> Any:
    """The smallest ball containing the closed interval (or the point) of exact rationals."""
    if high is None or high == low:
        return flint.arb(flint.fmpq(low.numerator, low.denominator))
    middle, radius = (low + high) / 2, (high - low) / 2
    return ball(middle) + flint.arb(0, ball(radius))


def certain_sign(value: Any) -> int | None:
    """-1, 0, 1 when every real in the ball has that sign, else None."""
    if not value.is_finite():
        return None
    if value > 0:
        return 1
    if value < 0:
        return -1
    return 0 if value.is_zero() else None


def enclose(expr: sp.Basic, values: Mapping[sp.Symbol, Any]) -> Any:
    """Ball containing every value of ``expr`` when each symbol ranges over its ball."""
    return fold(expr, TABLE, lambda node: _leaf(node, values))


def compiled(expr: sp.Basic, symbols: Iterable[sp.Symbol]) -> Callable[..., Any]:
    """:func:`enclose` as a function of one ball a symbol, in their order; walk once, call often, in any working precision."""
    recording = recorded(expr, symbols, bound(TABLE), lambda node: once_a_precision(lambda: flint.ctx.prec, partial(_leaf, node, {})))
    return lambda *values: recording.value(values)


def constant(node: Any) -> Any:
    """A number or a truth value of a formula, as sharp as the working precision allows; None for what is neither."""
    if node.is_Rational:
        return flint.arb(flint.fmpq(int(node.p), int(node.q)))
    if node is sp.pi:
        return flint.arb.pi()
    if node is sp.E:
        return flint.arb(1).exp()
    return node is sp.true if node in (sp.true, sp.false) else None


def _leaf(node: Any, values: Mapping[sp.Symbol, Any]) -> Any:
    if node.is_Symbol:
        return values[node]
    known = constant(node)
    return flint.arb("nan") if known is None else known


def _integer_power(base: Any, n: int) -> Any:
    """x^n, even powers without the loss of x * x on balls around zero."""
    if n < 0:
        return 1 / _integer_power(base, -n)
    if n == 1 or not base.is_finite():
        return base
    if n % 2 == 0:
        return (base.abs_lower() ** n).union(base.abs_upper() ** n).nonnegative_part()
    return (base.lower() ** n).union(base.upper() ** n)


def _pow(node: Any, base: Any, exponent: Any) -> Any:
    power = node.exp
    if power.is_Integer:
        return _integer_power(base, int(power))
    if node.base.is_extended_nonnegative:  # the formula says so, whatever the ball adds by rounding
        base = base.nonnegative_part()
    if base > 0:
        return base**exponent
    if base >= 0 and exponent > 0:
        high = base.upper()
        return flint.arb(0).union(high**exponent) if high > 0 else flint.arb(0)
    if exponent.is_integer() and abs(exponent) < _MOST:  # as 2*b is where b = 1
        return _integer_power(base, int(exponent.unique_fmpz()))
    return flint.arb("nan")


def _norm(node: sp.Basic, *args: Any) -> Any:
    total = reduce(add, (_integer_power(x, 2) for x in args))
    low, high = total.lower(), total.upper()
    return (low.sqrt() if low > 0 else flint.arb(0)).union(high.sqrt()).nonnegative_part()


def _eigmax(node: sp.Basic, *entries: Any) -> Any:
    """That of the matrix in the middle, and as far from it as the Euclidean size of the radii (Weyl 1912)."""
    if not all(x.is_finite() for x in entries):
        return flint.arb("nan")
    mean, second, third = deviator(*(x.mid() for x in entries))
    radii = [x.rad() for x in entries]
    spread = reduce(add, (_integer_power(x, 2) for x in (*radii, *radii[3:]))).upper().sqrt().upper()
    far = 2 * (second / 3).nonnegative_part().upper().sqrt()
    near = far / 2
    if second > 0:
        root = (second / 3).sqrt()
        turn = third / (2 * root**3)
        low, high = (min(max(end, flint.arb(-1)), flint.arb(1)) for end in (turn.lower(), turn.upper()))
        near, far = (2 * root * (end.acos() / 3).cos() for end in (low, high))
    elif not second.is_zero():
        near = flint.arb(0)
    return mean + near.union(far) + flint.arb(0, spread)


def _extreme(pick: Callable[[Any, Any], Any], _: sp.Basic, *values: Any) -> Any:
    if not all(v.is_finite() for v in values):
        return flint.arb("nan")
    return reduce(pick, [v.lower() for v in values]).union(reduce(pick, [v.upper() for v in values]))


_max, _min = partial(_extreme, lambda a, b: a if a > b else b), partial(_extreme, lambda a, b: b if a > b else a)


def _elementary(word: Elementary, _: sp.Basic, x: Any) -> Any:
    """Where the domain ends on both sides, f is monotone and taken at the ends of what lies within."""
    function, (least, most) = getattr(flint.arb, word.name), word.domain
    if most < math.inf:
        low, high = x.lower(), x.upper()
        return function(low).union(function(high)) if low >= least and high <= most else flint.arb("nan")
    return function(x) if least == -math.inf or x > least else flint.arb("nan")


def _where(node: sp.Basic, condition: bool | None, a: Any, b: Any) -> Any:
    if condition is None:
        return a.union(b) if a.is_finite() and b.is_finite() else flint.arb("nan")
    return a if condition else b


_FAILS: dict[Any, Callable[[Any, Any], bool]] = {gt: le, ge: lt, lt: ge, le: gt}  # what holds where a comparison never does


def _truth(sure: Callable[[Any, Any], bool], _: sp.Basic, left: Any, right: Any) -> bool | None:
    return True if sure(left, right) else False if _FAILS[sure](left, right) else None


TABLE: Table[Any] = {
    sp.Add: lambda _, *terms: reduce(add, terms),
    sp.Mul: lambda _, *factors: reduce(mul, factors),
    sp.Pow: _pow,
    sp.Abs: lambda node, x: _max(node, x, -x).nonnegative_part(),
    **{word.node: partial(_elementary, word) for word in ELEMENTARY.values()},
    Atan2: lambda _, y, x: flint.arb("nan") if y.contains(0) and x.contains(0) else flint.arb.atan2(y, x),
    sp.Max: _max,
    sp.Min: _min,
    Pos: lambda node, x: _max(node, x, flint.arb(0)).nonnegative_part(),
    Neg: lambda node, x: _max(node, -x, flint.arb(0)).nonnegative_part(),
    Norm: _norm,
    EigMax: _eigmax,
    Where: _where,
    **{kind: partial(_truth, holds) for kind, holds in COMPARISONS.items()},
}
