"""Formulas over NumPy arrays with a running bound of their rounding: |computed - exact| <= bound, node by node.

Symbols carry a bound of their own, 0 where the double is what is meant.  Each row adds what its node does to the bounds of its
arguments, to all orders, and the rounding of its own result (J. H. Wilkinson, 1963, Rounding Errors in Algebraic Processes;
N. J. Higham, 2002, Accuracy and Stability of Numerical Algorithms, section 3.3).  The bounds are themselves computed in doubles
and round by some parts in 1e15 of themselves.  Where nothing can be said the bound is inf or nan.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial, reduce
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression import UNDEFINED, numpy_
from duhem.expression.elementary import ELEMENTARY, Elementary, array_function, on_arrays
from duhem.expression.fold import Recording, Table, bound, recorded
from duhem.expression.numpy_ import length
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["TABLE", "Bounded", "BoundedProgram", "bounded", "constant", "eigenvalue"]

Array = NDArray[np.float64]

_UNIT = 2.0**-53  # the rounding of one operation
_WORD = 2.0**-50  # of a function of the C library or NumPy, a few units in the last place
_LEAST = 2.0**-1074  # what may be lost where a result underflows


class Bounded(NamedTuple):
    """``value`` and a ``bound`` of what it is off by, arrays (N,) or numbers."""

    value: Any
    bound: Any


@dataclass(frozen=True)
class BoundedProgram:
    """A formula over ``symbols`` as recorded steps."""

    symbols: tuple[sp.Symbol, ...]
    recording: Recording

    def __call__(self, values: Sequence[Array], bounds: Sequence[Array | float]) -> tuple[Array, Array]:
        """Value and bound (N,) at one array and its own bound for each symbol."""
        found = self.found(values, bounds)
        shapes = {v.shape for v in values}
        shape = shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes)
        value, bound = (x if np.shape(x) == shape else np.broadcast_to(x, shape) for x in found)
        return value, bound

    def found(self, values: Sequence[Array], bounds: Sequence[Array | float]) -> Bounded:
        """The same, numbers where nothing differs from point to point."""
        with np.errstate(all="ignore"):
            return Bounded(*self.recording.value([Bounded(v, b) for v, b in zip(values, bounds, strict=True)]))


@lru_cache(maxsize=256)
def bounded(expr: sp.Basic, symbols: tuple[sp.Symbol, ...]) -> BoundedProgram:
    """``expr`` over ``symbols``; walk once, call often.  Raises what :func:`duhem.expression.numpy_.compiled` raises."""
    return BoundedProgram(symbols, recorded(recognised(expr), symbols, bound(TABLE), constant))


def constant(node: Any) -> Callable[[], Bounded]:
    if node in UNDEFINED:
        return partial(Bounded, np.nan, np.nan)
    value = numpy_.constant(node)
    exact = not node.is_Number or (np.isfinite(value) and sp.Rational(value) == node)
    off = 0.0 if exact and node not in (sp.pi, sp.E) else _UNIT * abs(value) + _LEAST
    return partial(Bounded, value, off)


def _total(a: Bounded, b: Bounded) -> Bounded:
    value = np.add(a.value, b.value)
    return Bounded(value, _sum(_sum(a.bound, b.bound), _UNIT * np.abs(value)))


def _sum(a: Any, b: Any) -> Any:
    """a + b of bounds, where one may be known to be nothing."""
    return b if isinstance(a, float) and a == 0.0 else a if isinstance(b, float) and b == 0.0 else a + b


def _product(a: Bounded, b: Bounded) -> Bounded:
    value = np.multiply(a.value, b.value)
    for c, x in ((a, b), (b, a)):
        if isinstance(c.value, float) and isinstance(c.bound, float) and 0.0 < abs(c.value) < np.inf:  # a number: as shares of the product
            off = (_UNIT + c.bound / abs(c.value)) * np.abs(value) + _LEAST
            return Bounded(value, off if _exact(x) else off + (abs(c.value) + c.bound) * x.bound)
    off = _UNIT * np.abs(value) + _LEAST
    if not _exact(b):
        off = off + np.abs(a.value) * b.bound
    return Bounded(value, off if _exact(a) else off + a.bound * (np.abs(b.value) + b.bound))


def _exact(x: Bounded) -> bool:
    """Whether that is known of all points at once."""
    return isinstance(x.bound, float) and x.bound == 0.0


def _power(node: Any, base: Bounded, exponent: Bounded) -> Bounded:
    b, e = base
    match node.exp:
        case sp.Integer(p=2):
            value = np.square(b)
            return Bounded(value, (2.0 * np.abs(b) + e) * e + (_UNIT * value + _LEAST))
        case sp.Integer(p=-1):
            value = np.true_divide(1.0, b)
            return Bounded(value, _gap(e, np.abs(b) * (np.abs(b) - e), np.abs(b) > e) + (_UNIT * np.abs(value) + _LEAST))
        case sp.Rational(p=1, q=2):
            value = np.sqrt(b)
            return Bounded(value, np.where(b > e, e / (value + np.sqrt(np.maximum(b - e, 0.0))), np.sqrt(b + e)) + _UNIT * value)
    x = exponent.value
    value, size = np.power(b, x), np.abs(b)
    own = _WORD * np.abs(value) + _LEAST
    if not node.exp.is_number:
        own = own + np.abs(value) * np.expm1(_gap(np.abs(x) * e, b - e, b > e) + np.abs(np.log(b)) * exponent.bound)
        return Bounded(value, np.where(e + exponent.bound > 0.0, own, _WORD * np.abs(value) + _LEAST))
    if exponent.bound > 0.0:
        own = own + np.where(size > 0.0, np.abs(value * np.log(size)) * exponent.bound, 0.0)
    near = np.maximum(size - e, 0.0)
    if x >= 1.0:
        return Bounded(value, _times(x * np.power(size + e, x - 1.0), e) + own)
    steep = _times(abs(x) * np.power(near, x - 1.0), e)
    return Bounded(value, np.where(near > 0.0, steep, np.power(size + e, x) if x > 0.0 else np.where(e > 0.0, np.inf, 0.0)) + own)


def _gap(part: Any, whole: Any, sound: Any) -> Any:
    """part/whole, 0 where the part is 0, inf where the whole may be 0."""
    return np.where(part == 0.0, 0.0, np.where(sound, part / np.where(sound, whole, 1.0), np.inf))


def _times(slope: Any, off: Any) -> Any:
    """A slope times what an argument is off by: 0 where it is not off, whatever the slope."""
    return np.where(off == 0.0, 0.0, slope * off)


def _norm(_: Any, *args: Bounded) -> Bounded:
    value = length(*(a.value for a in args))
    return Bounded(value, reduce(np.add, [a.bound for a in args]) + (2 * len(args) * _UNIT) * value)


def _pnorm(_: Any, p: Bounded, *args: Bounded) -> Bounded:
    value = numpy_.TABLE[PNorm](_, p.value, *(a.value for a in args))
    off = reduce(np.add, [a.bound for a in args])
    if p.value < 1.0:  # no norm: nothing bounds the slopes
        off = np.where(off > 0.0, np.inf, 0.0)
    return Bounded(value, off + (1.0 + 1.0 / p.value) * (8 + len(args)) * _WORD * value)


def _elementary(word: Elementary, _: Any, x: Bounded) -> Bounded:
    value = array_function(word.numpy)(x.value)
    off = on_arrays(word.off)(x=x.value, v=value, e=x.bound)
    vanishing = _LEAST if word.far is not None and 0.0 in word.far else 0.0  # what tends to 0 underflows
    return Bounded(value, off + _WORD * np.abs(value) + vanishing)


def _atan2(_: Any, y: Bounded, x: Bounded) -> Bounded:
    value = numpy_.TABLE[Atan2](_, y.value, x.value)
    share = (y.bound + x.bound) / np.hypot(y.value, x.value)
    cut = (x.value < 0.0) & (np.abs(y.value) <= y.bound) & (y.bound > 0.0)  # it jumps there
    return Bounded(value, np.where((share < 1.0) & ~cut, 1.6 * share, np.inf) + _WORD * np.abs(value))


def eigenvalue(value: Any, entries: Sequence[Bounded]) -> Bounded:
    """The greatest eigenvalue, as found by whatever is off by some roundings of the entries xx, yy, zz, yz, xz, xy."""
    off = reduce(np.add, [a.bound for a in entries[:3]]) + 2.0 * reduce(np.add, [a.bound for a in entries[3:]])
    return Bounded(value, off + 8.0 * _WORD * reduce(np.maximum, [np.abs(a.value) for a in entries]))


def _extreme(most: Callable[[Any, Any], Any], _: Any, *args: Bounded) -> Bounded:
    """Of the values, of all at their upper ends and of all at their lower ends."""
    value = reduce(most, [a.value for a in args])
    if all(map(_exact, args)):
        return Bounded(value, 0.0)
    up, down = reduce(most, [a.value + a.bound for a in args]), reduce(most, [a.value - a.bound for a in args])
    some = reduce(np.maximum, [a.bound for a in args]) > 0.0
    return Bounded(value, np.where(some, np.maximum(up - value, value - down) + 2 * _UNIT * np.abs(value), 0.0))


def _ramp(node: Any, x: Bounded) -> Bounded:
    value = _positive_part(x.value if isinstance(node, Pos) else np.negative(x.value))
    if _exact(x):
        return Bounded(value, 0.0)
    return Bounded(value, np.where((value > 0.0) | (np.abs(x.value) <= x.bound), x.bound, 0.0))


def _positive_part(x: Any) -> Any:
    """max(x, 0), of an array with an array: for that NumPy has a loop on vectors."""
    return np.maximum(x, np.zeros_like(x) if isinstance(x, np.ndarray) else 0.0)


def _comparison(node: Any, a: Bounded, b: Bounded) -> Bounded:
    """1 or 0, and a bound of 1 where it might be the other."""
    value = numpy_.TABLE[type(node)](node, a.value, b.value)
    if _exact(a) and _exact(b):
        return Bounded(value, 0.0)
    off = a.bound + b.bound
    open_ = (np.abs(np.subtract(a.value, b.value)) <= off) & (off > 0.0)
    return Bounded(value, np.where(open_, 1.0, 0.0))


def _where(_: Any, condition: Bounded, a: Bounded, b: Bounded) -> Bounded:
    value = numpy_.TABLE[Where](_, condition.value, a.value, b.value)
    if _exact(condition):
        return Bounded(value, np.where(condition.value == 1.0, a.bound, b.bound))
    either = np.abs(np.subtract(a.value, b.value)) + np.maximum(a.bound, b.bound)
    return Bounded(value, np.where(condition.bound > 0.0, either, np.where(condition.value == 1.0, a.bound, b.bound)))


TABLE: Table[Bounded] = {
    sp.Add: lambda _, *x: reduce(_total, x),
    sp.Mul: lambda _, *x: reduce(_product, x),
    sp.Pow: _power,
    sp.Abs: lambda _, x: Bounded(np.abs(x.value), x.bound),
    EigMax: lambda _, *entries: eigenvalue(numpy_.TABLE[EigMax](_, *(a.value for a in entries)), entries),
    **{word.node: partial(_elementary, word) for word in ELEMENTARY.values()},
    Atan2: _atan2,
    sp.Min: partial(_extreme, np.minimum),
    sp.Max: partial(_extreme, np.maximum),
    Pos: _ramp,
    Neg: _ramp,
    Norm: _norm,
    PNorm: _pnorm,
    Where: _where,
    **dict.fromkeys(COMPARISONS, _comparison),
}
