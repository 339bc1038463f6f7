"""Plain states of a law's variables inside their ranges, and those at which a quantity seems to be negative: few digits, few of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from math import prod
from random import Random

import numpy as np
import sympy as sp

from duhem.expression.number import fraction, rational
from duhem.expression.numpy_ import compiled
from duhem.law.domain import Domain

__all__ = ["plain_states", "states_of_negative"]

_PLAIN = tuple(map(Fraction, ("0", "1/2", "1", "-1", "2", "-2", "10", "-10", "1/10", "-1/2", "1/2000", "-1/2000", "2000", "-2000")))
_TOUCHING = 1e-9
_TRIED = 8

State = tuple[Fraction, ...]


def plain_states(spans: Sequence[Domain], most: int, values: int = len(_PLAIN)) -> list[State]:
    """Every combination of that many plain values, or of some of them drawn where these are too many; those near 0 first."""
    every = [_inside(span, values) for span in spans]
    if prod(map(len, every)) <= most:
        found = list(product(*every))
    else:
        draw = Random(7)
        found = list(dict.fromkeys(tuple(map(draw.choice, every)) for _ in range(most)))
    return sorted(found, key=lambda state: sum(map(abs, state)))


def _inside(span: Domain, values: int) -> list[Fraction]:
    """Plain values of a range; where it has none its ends, its middle and what lies beside them."""
    low, high = (None if end is None else fraction(end) for end in (span.low, span.high))
    ends = [low, high, None if low is None or high is None else (low + high) / 2, None if low is None else low + 1]
    own = [*_PLAIN[:values], *(end for end in ends if end is not None), *([] if high is None else [high - 1])]
    return [x for x in dict.fromkeys(own) if rational(x) in span]


def states_of_negative(
    quantity: sp.Expr, bound: sp.Expr | None, on_it: bool, names: Sequence[sp.Symbol], states: Sequence[State]
) -> Iterator[State]:
    """Those at which in floats the quantity is negative, and the bound <= 0, or 0 with ``on_it``: the first ones and the clearest."""
    columns = np.array([[float(x) for x in state] for state in states], dtype=float).reshape(len(states), len(names)).T
    with np.errstate(all="ignore"):
        spent, height = (np.broadcast_to(compiled(sp.S.Zero if e is None else e, names)(*columns), len(states)) for e in (quantity, bound))
        found = np.flatnonzero((spent < 0) & ((np.abs(height) if on_it else height) <= _TOUCHING))
    clearest = found[np.argsort(spent[found], kind="stable")]
    yield from (states[i] for i in dict.fromkeys([*found[:_TRIED].tolist(), *clearest[:_TRIED].tolist()]))
