"""Exact parameter values to look at: inside the ranges that single relations give, the plainest first."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import prod

import sympy as sp

from duhem.expression.number import fraction, rational

__all__ = ["Values", "plain_choices", "rationals"]

_SCALES = (Fraction(1), Fraction(1, 2), Fraction(2), Fraction(1, 10), Fraction(10), Fraction(1, 100), Fraction(100))
_SHARES = (Fraction(0), Fraction(1), *(Fraction(k, 100) for k in (50, 1, 99, 25, 75, 90)))
_MOST_TOGETHER, _DRAWN = 4096, 400

Values = Mapping[sp.Symbol, Fraction]


def rationals(values: Values) -> dict[sp.Symbol, sp.Rational]:
    """The values as SymPy has them."""
    return {x: rational(v) for x, v in values.items()}


def plain_choices(free: Sequence[sp.Symbol], given: Sequence[sp.Basic]) -> Iterator[dict[sp.Symbol, Fraction]]:
    """Ends, middles and decades of each symbol's range together; where these are too many, some at random (fixed seed)."""
    grids = [_grid(x, given) for x in free]
    combinations = list(product(*grids)) if prod(len(g) for g in grids) <= _MOST_TOGETHER else []
    rng = random.Random(2)
    if not combinations:
        combinations = [tuple(rng.choice(g) for g in grids) for _ in range(_DRAWN)]
    plain, rest = combinations[:1], combinations[1:]
    rng.shuffle(rest)
    for combination in plain + rest:
        yield dict(zip(free, combination, strict=True))


def _grid(x: sp.Symbol, given: Sequence[sp.Basic]) -> list[Fraction]:
    low = high = None
    for relation in given:
        if getattr(relation, "gts", None) == x and relation.lts.is_Rational:
            low = fraction(relation.lts) if low is None else max(low, fraction(relation.lts))
        if getattr(relation, "lts", None) == x and relation.gts.is_Rational:
            high = fraction(relation.gts) if high is None else min(high, fraction(relation.gts))
    if low is not None and high is not None:
        return [low + s * (high - low) for s in _SHARES]
    if low is None and high is None:
        return [Fraction(0), *_SCALES, *(-s for s in _SCALES)]
    start, sense = (low, 1) if low is not None else (high, -1)
    assert start is not None
    return [start + sense * s for s in _SCALES] + [start]
