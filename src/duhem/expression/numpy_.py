"""Formulas over NumPy arrays, in double precision.

Norms, those spelt as powers included, are scaled so that no power overflows or vanishes on the way.
Both branches of every kink are computed, so the faults of a branch that is not taken stay silent;
where the formula itself is undefined (a root of a negative number, ...) the result is nan, and nan spreads, through
comparisons too.

A program may have limits where its formula is 0/0: on the hydrostatic axis, where a deviator has no angle, for one.  Where it has no
value the formula is read beside the point, four ways and at distances h, h/2, h/4 and h/8.  Three of them give the limit without its terms
in h and h^2 (L. F. Richardson, 1911): (f(h) - 6 f(h/2) + 8 f(h/4))/3.  It is taken where all of them agree, so that holes are filled and
no domain grows: beyond an end of its domain the formula has no value on one side.
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
from duhem.expression.fold import Recording, Table, bound, recorded, same
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, rows

__all__ = ["TABLE", "Filled", "Program", "compiled", "constant", "evaluate", "filled", "length"]

_SQUARES = 2.0**-900, 2.0**900  # of lengths whose squares are good to the last digits: no part that counts has vanished


def length(first: Any, *others: Any) -> Any:
    """(a^2 + b^2 + ...)^1/2, to 2^-53 (count/2 + 1) of itself on arrays; hypot, which takes ten times as long, where it has to be."""
    parts = (first, *others)
    if not others or not all(isinstance(x, np.ndarray) for x in parts):
        return reduce(np.hypot, others, np.abs(first))
    squares = reduce(np.add, [np.square(x) for x in parts])
    found = np.sqrt(squares)
    if not (squares.min(initial=1.0) >= _SQUARES[0] and squares.max(initial=1.0) <= _SQUARES[1]):
        far = ~((squares >= _SQUARES[0]) & (squares <= _SQUARES[1]))
        each = [x[far] for x in np.broadcast_arrays(*parts)]
        found = np.array(found)
        found[far] = reduce(np.hypot, each[1:], np.abs(each[0]))
    return found


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
    return Program(order, recorded(recognised(expr), order, bound(TABLE), lambda node: partial(same, constant(node))))


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


def constant(node: Any) -> float:
    """A number or a truth value of a formula, correctly rounded."""
    if node in _CONSTANTS:
        return _CONSTANTS[node]
    if not node.is_Rational:
        raise InputError(f"{node} has no value", remedy="give a value for each symbol of the formula")
    try:
        return int(node.p) / int(node.q)  # correctly rounded
    except OverflowError:
        power = round(0.30103 * (int(node.p).bit_length() - int(node.q).bit_length()))
        what = f"a number of about 10**{power} is too large for double precision"
        raise InputError(what, remedy="rescale the formula or its parameters") from None


_CONSTANTS = {sp.pi: math.pi, sp.E: math.e, sp.true: 1.0, sp.false: 0.0, **dict.fromkeys(UNDEFINED, math.nan)}


def _power(node: Any, base: Any, exponent: Any) -> Any:
    match node.exp:
        case sp.Integer(p=2):
            return np.square(base)
        case sp.Integer(p=-1):
            return np.true_divide(1.0, base)
        case sp.Rational(p=1, q=2):
            return np.sqrt(base)
    return np.power(base, exponent)


_LARGEST = np.finfo(np.float64).max


def _pnorm(_: Any, p: Any, *args: Any) -> Any:
    """Relative to the largest argument: its p-th power alone may overflow, or all of them vanish."""
    sizes = [np.abs(x) for x in args]
    largest = reduce(np.maximum, sizes)
    unit = np.where(largest > 0.0, np.minimum(largest, _LARGEST), 1.0)
    return unit * np.power(reduce(np.add, [np.power(size / unit, p) for size in sizes]), 1.0 / p)


def _atan2(_: Any, y: Any, x: Any) -> Any:
    return np.where(np.equal(x, 0.0) & np.equal(y, 0.0), np.nan, np.arctan2(np.add(y, 0.0), x))  # -0 is 0


def _comparison(compare: Callable[[Any, Any], Any], _: Any, a: Any, b: Any) -> Any:
    return np.where(np.isnan(a) | np.isnan(b), np.nan, compare(a, b))


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
    **{word.node: lambda _, x, f=f: f(x) for word in ELEMENTARY.values() for f in [array_function(word.numpy)]},
    Atan2: _atan2,
    sp.Min: lambda _, *x: reduce(np.minimum, x),
    sp.Max: lambda _, *x: reduce(np.maximum, x),
    Pos: lambda _, x: np.maximum(x, 0.0),
    Neg: lambda _, x: np.maximum(np.negative(x), 0.0),
    Norm: lambda _, *x: reduce(np.hypot, x[1:], np.abs(x[0])),  # squares of large or small arguments neither overflow nor vanish
    PNorm: _pnorm,
    Where: lambda _, condition, a, b: np.where(np.isnan(condition), np.nan, np.where(condition == 1.0, a, b)),
    **{kind: partial(_comparison, compare) for kind, compare in COMPARISONS.items()},
}


_STEP = 2.0**-20  # of each number
_STEP_AT_ZERO = 2.0**-200  # nothing cancels there
_AGREED = 1e-3  # of what the formula changes by over a step
_PARTS = np.array([1.0, 0.5, 0.25, 0.125])
_WEIGHTS = np.array([1.0, -6.0, 8.0])  # over 3


def filled(expr: sp.Basic, symbols: Iterable[sp.Symbol]) -> Program:
    """``expr`` as a function of ``symbols``, like :func:`compiled`.

    It has limits if the formula divides by one of them or takes an angle of them.
    """
    plain = compiled(expr, symbols)
    divides = any(power.exp.could_extract_minus_sign() and power.base.free_symbols for power in expr.atoms(sp.Pow))
    turns = any(angle.free_symbols for angle in expr.atoms(Atan2))
    return Filled(plain.symbols, plain.recording) if divides or turns else plain


@dataclass(frozen=True)
class Filled(Program):
    """A program that gives the limit where its formula has one and no value; nan where it has neither."""

    def __call__(self, *values: ArrayLike) -> Array:
        """The formula, or its limit, at one array per symbol."""
        found = super().__call__(*values)
        lost = np.isnan(found)
        if lost.any():
            at = [np.broadcast_to(np.asarray(v, dtype=np.float64), found.shape)[lost] for v in values]
            found = np.array(found)
            found[lost] = self._limits(np.stack(at, axis=1))
        return found

    def _limits(self, at: Array) -> Array:
        """At points (n, symbols)."""
        limits = np.full(len(at), np.nan)
        ways = _ways(at.shape[1])
        with np.errstate(all="ignore"):
            step = np.where(at == 0.0, _STEP_AT_ZERO, _STEP * np.abs(at))
            first = super().__call__(*(at + step * ways[0]).T)
            who = np.flatnonzero(np.isfinite(first))  # most points without a value lie beyond the domain
            if who.size:
                beside = at[who, None, None] + _PARTS[:, None, None] * step[who, None, None] * ways  # (m, parts, ways, symbols)
                read = super().__call__(*np.moveaxis(beside, -1, 0))
                guesses = np.stack([np.einsum("mpw,p->mw", read[:, i : i + 3], _WEIGHTS) for i in (0, 1)], axis=1) / 3.0
                guesses = guesses.reshape(who.size, -1)
                spread, change = np.ptp(guesses, axis=1), np.abs(read - guesses[:, :1, None]).max(axis=(1, 2))
                limits[who] = np.where(spread <= _AGREED * change, guesses.mean(axis=1), np.nan)
        return limits


def _ways(d: int) -> Array:
    """Directions (4, d) with nothing to them, two and their opposites, the same each time."""
    ways = np.random.default_rng(0).uniform(0.5, 1.0, (2, d)) * np.where(np.arange(d) % 2 == 0, 1.0, [[-1.0], [1.0]])
    return np.vstack([ways, -ways])
