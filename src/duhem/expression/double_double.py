"""Formulas over unevaluated sums of two doubles, some 31 digits, on arrays of points.

For signs and values next to a zero, where one double has none left.  Words that are no algebra are left out, and so are powers
that are no whole ones or square roots: balls have them.  T. J. Dekker (1971), Numer. Math. 18, 224-242; Y. Hida, X. S. Li and
D. H. Bailey (2001), Algorithms for quad-double precision floating point arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial, reduce
from operator import gt, lt
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression import numpy_
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.fold import Recording, Table, bound, recorded, same
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["LEFT_OUT", "TABLE", "Pair", "PairProgram", "added", "paired", "product"]

_SPLIT = 2.0**27 + 1.0
_RANGE = 2.0**-450, 2.0**450  # sizes whose products keep all their digits
Comparison = Callable[[Any, Any], Any]


class Pair(NamedTuple):
    """high + low, the low one below half a unit in the last place of the high one; arrays (N,) or numbers."""

    high: Any
    low: Any


@dataclass(frozen=True)
class PairProgram:
    """A formula over as many pairs as it has symbols."""

    recording: Recording

    def __call__(self, values: Sequence[Pair], n: int) -> tuple[Pair, NDArray[np.bool_]]:
        """The formula at ``n`` points, and where no number on the way left the range in which products are exact."""
        with np.errstate(all="ignore"):
            registers = self.recording.run(values)
            sound = np.ones(n, dtype=bool)
            for high, _ in registers:
                size = np.abs(high)
                sound &= (size == 0.0) | ((size >= _RANGE[0]) & (size <= _RANGE[1]))
        high, low = registers[self.recording.last]
        return Pair(np.broadcast_to(high, (n,)), np.broadcast_to(low, (n,))), sound


@lru_cache(maxsize=256)
def paired(expr: sp.Basic, symbols: tuple[sp.Symbol, ...]) -> PairProgram | None:
    """``expr`` over ``symbols``, walked once; None where it has a word that is left out."""
    try:
        return PairProgram(recorded(expr, symbols, {**bound(TABLE), sp.Pow: _power}, lambda node: partial(same, _constant(node))))
    except InputError:
        return None


def _constant(node: Any) -> Pair:
    high = numpy_.constant(node)
    if node.is_Rational:
        return Pair(high, float(Fraction(int(node.p), int(node.q)) - Fraction(high)))
    return Pair(high, float((node - sp.Float(high, 60)).evalf(40)) if node in (sp.pi, sp.E) else 0.0)


def added(a: Pair, b: Pair) -> Pair:
    """a + b."""
    high, low = _sum(a.high, b.high)
    deep, least = _sum(a.low, b.low)
    high, low = _quick(high, low + deep)
    return _quick(high, low + least)


def product(a: Pair, b: Pair) -> Pair:
    """a b."""
    high, low = _times(a.high, b.high)
    return _quick(high, low + (a.high * b.low + a.low * b.high))


def _sum(a: Any, b: Any) -> Pair:
    total = np.add(a, b)
    part = total - a
    return Pair(total, (a - (total - part)) + (b - part))


def _quick(a: Any, b: Any) -> Pair:
    """For |a| >= |b|."""
    total = np.add(a, b)
    return Pair(total, b - (total - a))


def _times(a: Any, b: Any) -> Pair:
    whole = np.multiply(a, b)
    (x, u), (y, v) = _split(a), _split(b)
    return Pair(whole, ((x * y - whole) + x * v + u * y) + u * v)


def _split(a: Any) -> Pair:
    big = np.multiply(_SPLIT, a)
    high = big - (big - a)
    return Pair(high, a - high)


def _minus(a: Pair) -> Pair:
    return Pair(np.negative(a.high), np.negative(a.low))


def _quotient(a: Pair, b: Pair) -> Pair:
    """By long division, three steps of one double each."""
    first = a.high / b.high
    rest = added(a, _minus(product(b, Pair(first, 0.0))))
    second = rest.high / b.high
    rest = added(rest, _minus(product(b, Pair(second, 0.0))))
    return added(_quick(first, second), Pair(rest.high / b.high, 0.0))


def _root(a: Pair) -> Pair:
    """Square root, by one step of Newton's method from that of the high part."""
    high = np.sqrt(a.high)
    rest = added(a, _minus(_times(high, high)))
    low = np.where(high > 0.0, rest.high / np.where(high > 0.0, 2.0 * high, 1.0), 0.0)
    return _quick(high, low)


def _power(node: Any) -> Callable[[Pair, Pair], Pair]:
    if not (node.exp.is_Rational and node.exp.q in (1, 2) and abs(node.exp.p) <= 64):
        raise InputError(f"no meaning is given to {node} in pairs of doubles", remedy="use balls")
    return partial(_raised, node.exp)


def _raised(exponent: sp.Rational, base: Pair, _: Pair) -> Pair:
    whole = reduce(product, [base if exponent.q == 1 else _root(base)] * abs(int(exponent.p)))
    return whole if exponent.p > 0 else _quotient(Pair(1.0, 0.0), whole)


def _chosen(condition: Any, a: Pair, b: Pair) -> Pair:
    return Pair(np.where(condition, a.high, b.high), np.where(condition, a.low, b.low))


def _extreme(before: Comparison, _: Any, *args: Pair) -> Pair:
    return reduce(lambda a, b: _known(_chosen(_compared(before, a, b), a, b), a, b), args)


def _compared(holds: Comparison, a: Pair, b: Pair) -> Any:
    """By the low parts where the high ones are equal."""
    return np.where(np.equal(a.high, b.high), holds(a.low, b.low), holds(a.high, b.high))


def _known(value: Pair, *args: Pair) -> Pair:
    """``value``, nan where one of the arguments is."""
    unknown = reduce(np.logical_or, [np.isnan(a.high) for a in args])
    return Pair(np.where(unknown, np.nan, value.high), np.where(unknown, 0.0, value.low))


def _comparison(holds: Comparison, _: Any, a: Pair, b: Pair) -> Pair:
    return _known(Pair(np.where(_compared(holds, a, b), 1.0, 0.0), 0.0), a, b)


_NONE = Pair(0.0, 0.0)

TABLE: Table[Any] = {
    sp.Add: lambda _, *x: reduce(added, x),
    sp.Mul: lambda _, *x: reduce(product, x),
    sp.Pow: lambda node, base, exponent: _power(node)(base, exponent),
    sp.Abs: lambda _, a: _chosen(np.less(a.high, 0.0), _minus(a), a),
    sp.Min: partial(_extreme, lt),
    sp.Max: partial(_extreme, gt),
    Pos: lambda node, x: _extreme(gt, node, x, _NONE),
    Neg: lambda node, x: _extreme(gt, node, _minus(x), _NONE),
    Norm: lambda _, *x: _root(reduce(added, [product(a, a) for a in x])),
    Where: lambda _, condition, a, b: _known(_chosen(np.equal(condition.high, 1.0), a, b), condition),
    **{kind: partial(_comparison, holds) for kind, holds in COMPARISONS.items()},
}
LEFT_OUT = {
    **dict.fromkeys((Atan2, *(word.node for word in ELEMENTARY.values())), "no algebra: balls give its digits"),
    EigMax: "no algebra written out: balls give its digits",
}
