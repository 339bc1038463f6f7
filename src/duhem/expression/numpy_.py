"""Formulas over NumPy arrays, in double precision.

Norms, those spelt as powers included, are scaled so that no power overflows or vanishes on the way.
Both branches of every kink are computed, so the faults of a branch that is not taken stay silent;
where the formula itself is undefined (a root of a negative number, ...) the result is nan, and nan spreads, through
comparisons too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression import UNDEFINED
from duhem.expression.elementary import ELEMENTARY, array_function
from duhem.expression.fold import Table
from duhem.expression.matrices import rows
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.recording import Recording, bound, recorded
from duhem.expression.vocabulary import Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["TABLE", "Program", "compiled", "constant", "evaluate"]

Array = NDArray[np.float64]


def evaluate(expr: sp.Basic, values: Mapping[sp.Symbol, ArrayLike]) -> Array:
    """The formula at ``values`` (one array per symbol; they broadcast, and the result has their common shape).

    Units are the caller's.  Comparisons give 1.0 and 0.0.  Raises InputError for a symbol without a value and for a
    node without a meaning.
    """
    return compiled(expr, tuple(values))(*values.values())


def compiled(expr: sp.Basic, symbols: Iterable[sp.Symbol]) -> Program:
    """The formula as a function of ``symbols``, in their order; walk once, call often."""
    order = tuple(symbols)
    return Program(order, recorded(recognised(expr), order, bound(TABLE), lambda node: partial(_same, constant(node))))


@dataclass(frozen=True)
class Program:
    """A formula over arrays, one for each of ``symbols``, as recorded steps."""

    symbols: tuple[sp.Symbol, ...]
    recording: Recording

    def __call__(self, *values: ArrayLike) -> Array:
        """The formula at one array per symbol; a fresh array of their common shape."""
        given = [np.asarray(value, dtype=np.float64) for value in values]
        if len(given) != len(self.symbols):
            raise InputError(f"{len(given)} values are given for {len(self.symbols)} symbols", remedy="give one array per symbol")
        shapes = {value.shape for value in given}
        shape = shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes)
        with np.errstate(all="ignore"):
            found = self.recording.value(given)
        own = isinstance(found, np.ndarray) and found.shape == shape and found.base is None and not any(found is value for value in given)
        return found if own else np.array(np.broadcast_to(found, shape))


def _same(value: float) -> float:
    return value


def constant(node: Any) -> float:
    """A number or a truth value of a formula, correctly rounded."""
    if node.is_Rational:
        return _quotient(node)
    if node is sp.pi:
        return math.pi
    if node is sp.E:
        return math.e
    if node in (sp.true, sp.false):
        return float(node is sp.true)
    if node in UNDEFINED:
        return math.nan
    raise InputError(f"{node} has no value", remedy="give a value for each symbol of the formula")


def _quotient(number: Any) -> float:
    try:
        return int(number.p) / int(number.q)  # correctly rounded
    except OverflowError:
        raise InputError("a number of the formula is too large for double precision", remedy="rescale it") from None


def _power(node: Any, base: Any, exponent: Any) -> Any:
    match node.exp:
        case sp.Integer(p=2):
            return np.square(base)
        case sp.Integer(p=-1):
            return np.true_divide(1.0, base)
        case sp.Rational(p=1, q=2):
            return np.sqrt(base)
    return np.power(base, exponent)


def _norm(_: Any, first: Any, *others: Any) -> Any:
    """By hypot, so that squares of large or small arguments neither overflow nor vanish."""
    return reduce(np.hypot, others, np.abs(first))


def _pnorm(_: Any, p: Any, *args: Any) -> Any:
    """Relative to the largest argument: its p-th power alone may overflow, or all of them vanish."""
    sizes = [np.abs(x) for x in args]
    largest = reduce(np.maximum, sizes)
    unit = np.where((largest > 0.0) & np.isfinite(largest), largest, 1.0)
    return unit * np.power(reduce(np.add, [np.power(size / unit, p) for size in sizes]), 1.0 / p)


def _elementary(function: Callable[[Any], Any], _: Any, x: Any) -> Any:
    return function(x)


def _atan2(_: Any, y: Any, x: Any) -> Any:
    return np.where(np.equal(x, 0.0) & np.equal(y, 0.0), np.nan, np.arctan2(np.add(y, 0.0), x))  # -0 is 0


def _comparison(compare: Callable[[Any, Any], Any]) -> Callable[..., Any]:
    def row(_: Any, a: Any, b: Any) -> Any:
        return np.where(np.isnan(a) | np.isnan(b), np.nan, compare(a, b))

    return row


def _where(_: Any, condition: Any, a: Any, b: Any) -> Any:
    return np.where(np.isnan(condition), np.nan, np.where(condition == 1.0, a, b))


def _eigmax(_: Any, *entries: Any) -> Any:
    matrices = np.stack([np.stack(row, axis=-1) for row in rows(*np.broadcast_arrays(*entries))], axis=-2)
    known = np.isfinite(matrices).all(axis=(-2, -1))
    greatest = np.linalg.eigvalsh(np.where(known[..., None, None], matrices, 0.0))[..., -1]
    return np.where(known, greatest, np.nan)


TABLE: Table[Any] = {
    sp.Add: lambda _, *x: reduce(np.add, x),
    sp.Mul: lambda _, *x: reduce(np.multiply, x),
    sp.Pow: _power,
    sp.Abs: lambda _, x: np.abs(x),
    EigMax: _eigmax,
    **{word.node: partial(_elementary, array_function(word.numpy)) for word in ELEMENTARY.values()},
    Atan2: _atan2,
    sp.Min: lambda _, *x: reduce(np.minimum, x),
    sp.Max: lambda _, *x: reduce(np.maximum, x),
    Pos: lambda _, x: np.maximum(x, 0.0),
    Neg: lambda _, x: np.maximum(np.negative(x), 0.0),
    Norm: _norm,
    PNorm: _pnorm,
    Where: _where,
    sp.StrictGreaterThan: _comparison(np.greater),
    sp.GreaterThan: _comparison(np.greater_equal),
    sp.StrictLessThan: _comparison(np.less),
    sp.LessThan: _comparison(np.less_equal),
}
