"""Formulas in as many digits as asked for (mpmath); plain rounding, no enclosure.

It shares no arithmetic with the other interpreters, which makes it the one they are tested against.  Undefined real
values (a root of a negative number, ...) are nan, and nan spreads; a zero divisor gives +inf.  :func:`reach` finds where a ray leaves a
set {level <= 0}.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial, reduce
from threading import local
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.elementary import ELEMENTARY, Elementary
from duhem.expression.fold import Table, bound, fold, once_a_precision, recorded
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, rows

__all__ = ["compiled", "constant", "digits", "doubles", "evaluate", "kept_digits", "number", "reach", "table"]

_MOST_BITS = 4096  # before the point, of what stands under an exponential or a wave


def evaluate(expr: sp.Basic, values: Mapping[sp.Symbol, Any], dps: int = 30) -> Any:
    """The formula at a point as an ``mpf``, computed with ``dps`` decimal digits (not all of them correct).

    ``values`` may be integers, floats (taken exactly), fractions, SymPy rationals, mpf or decimal text.  Comparisons
    give 1 and 0.  Raises InputError for a symbol without a value and for a node without a meaning.
    """
    context = kept_digits(dps)
    known = {symbol: number(context, value) for symbol, value in values.items()}
    return fold(expr, table(context), lambda node: known[node] if node in known else constant(context, node))


def compiled(exprs: Sequence[sp.Basic], symbols: Iterable[sp.Symbol], context: Any) -> Callable[..., list[Any]]:
    """The formulas as one function of the symbols' values; walked once, run in the precision ``context`` has at each call."""
    rows = {sp.Tuple: lambda _, *parts: parts, **table(context)}
    own = partial(constant, context)
    recording = recorded(sp.Tuple(*exprs), symbols, bound(rows), lambda node: once_a_precision(lambda: context.prec, partial(own, node)))
    return lambda *values: list(recording.value([number(context, v) for v in values]))


def digits(count: int) -> Any:
    """A context of so many decimal digits that nobody else has: mpmath's own carries one precision for all threads."""
    from mpmath import MPContext

    context = MPContext()
    context.dps = count
    return context


def doubles() -> Any:
    """A context of Python's own numbers, for what asks for no more of them: a number beyond their range is an ArithmeticError."""
    from mpmath.ctx_fp import FPContext

    context = FPContext()
    for name in ("asinh", "acosh", "atanh", "hypot", "isfinite"):  # which it lacks
        setattr(context, name, getattr(math, name))
    return context


_KEPT = local()  # the contexts of a thread by their digits: to make one takes as long as to evaluate a formula some times


def kept_digits(count: int) -> Any:
    """The context of so many decimal digits that this thread keeps, for whoever leaves its precision as it is."""
    contexts: dict[Any, Any] = vars(_KEPT)
    if (context := contexts.get(count)) is None:
        context = contexts[count] = digits(count)
    context.dps = count  # whoever has a number of it may have changed that
    return context


def constant(context: Any, node: Any) -> Any:
    """A number or a truth value of a formula in the precision of ``context``; InputError for anything else."""
    if node.is_Rational:
        return number(context, node)
    if node in (sp.pi, sp.E):
        return +(context.pi if node is sp.pi else context.e)
    if node in (sp.true, sp.false):
        return context.mpf(node is sp.true)
    raise InputError(f"{node} has no value", remedy="give a value for each symbol of the formula")


def number(context: Any, value: Any) -> Any:
    """An integer, float (taken exactly), fraction, SymPy rational, mpf or decimal text in the precision of ``context``."""
    if isinstance(value, sp.Rational):
        return context.mpf(int(value.p)) / int(value.q)
    if isinstance(value, Fraction):
        return context.mpf(value.numerator) / value.denominator
    return context.mpf(value)


def table(context: Any) -> Table[Any]:
    """The rows over one mpmath context, which carries the precision."""
    nan, zero = context.nan, context.mpf(0)

    def power(_: Any, base: Any, exponent: Any) -> Any:
        if base == 0 and exponent < 0:
            return context.inf
        if (base < 0 and not context.isint(exponent)) or beyond(exponent):
            return nan
        return base**exponent

    def beyond(x: Any) -> bool:  # exp of exp of exp: mpmath would write out every digit before the point
        return bool(context.mag(x) > _MOST_BITS)

    def elementary(word: Elementary) -> Callable[..., Any]:
        function, (least, most), far = getattr(context, word.name), word.domain, word.far

        def row(_: Any, x: Any) -> Any:
            if not least <= x <= most:
                return nan
            return context.mpf(far[x > 0]) if far is not None and beyond(x) else function(x)

        return row

    def extreme(pick: Callable[..., Any]) -> Callable[..., Any]:
        return lambda _, *x: nan if any(map(context.isnan, x)) else pick(x)

    def comparison(compare: Callable[[Any, Any], bool]) -> Callable[..., Any]:
        return lambda _, a, b: nan if context.isnan(a) or context.isnan(b) else context.mpf(compare(a, b))

    def eigmax(_: Any, *entries: Any) -> Any:
        if not all(map(context.isfinite, entries)):
            return nan
        return max(context.eigsy(context.matrix(rows(*entries)), eigvals_only=True))

    return {
        EigMax: eigmax,
        sp.Add: lambda _, *x: reduce(operator.add, x),
        sp.Mul: lambda _, *x: reduce(operator.mul, x),
        sp.Pow: power,
        sp.Abs: lambda _, x: abs(x),
        **{word.node: elementary(word) for word in ELEMENTARY.values()},
        Atan2: lambda _, y, x: context.atan2(y + zero, x) if x or y else nan,  # -0 is 0
        sp.Min: extreme(min),
        sp.Max: extreme(max),
        Pos: lambda _, x: extreme(max)(_, x, zero),
        Neg: lambda _, x: extreme(max)(_, -x, zero),
        Norm: lambda _, *x: context.sqrt(reduce(operator.add, (v * v for v in x))),
        Where: lambda _, condition, a, b: nan if context.isnan(condition) else a if condition == 1 else b,
        **{kind: comparison(holds) for kind, holds in COMPARISONS.items()},
    }


_LAG = 1.4142135623730951  # of two steps one may be wasted
_NEAREST, _FARTHEST = -13, 40  # powers of two: no end is looked for beyond 1e12


def reach(context: Any, level: Callable[[list[Any]], Any], start: Sequence[Any], way: Sequence[Any], bits: int) -> Any:
    """The t > 0 at which ``start`` + t ``way`` leaves first, from within and to ``bits`` binary digits.

    None if no point of the ray is found inside or none outside.  ``context`` is mpmath or one of its contexts, and carries the
    precision.  t doubles until it is outside; the last step is closed by false position (Illinois), or halved where that lags
    behind half as many halvings, as at a kink, and where the level is undefined.
    """

    def at(t: Any) -> Any:
        return level([c + t * w for c, w in zip(start, way, strict=True)])

    low, f_low = context.mpf(0), context.nan
    high = context.ldexp(1, _NEAREST)
    while (f_high := at(high)) <= 0:
        low, f_low, high = high, f_high, 2 * high
        if high > context.ldexp(1, _FARTHEST):
            return None
    least = max(context.ldexp(high - low, -bits), 2 * context.eps * high)  # the context may have fewer digits than are asked for
    allowed, before = 16 * (high - low), None
    while high - low > least:
        t, rise = (low + high) / 2, f_high - f_low
        if high - low <= allowed and context.isfinite(rise):
            t = min(max(low - (high - low) * f_low / rise - least / 2, low + least), high - least)  # within, not on the very end
        inside, allowed = bool((value := at(t)) <= 0), allowed / _LAG
        if inside:
            low, f_low, f_high = t, value, f_high / 2 if before is True else f_high
        else:
            high, f_high, f_low = t, value, f_low / 2 if before is False else f_low
        before = inside
    return low or None
