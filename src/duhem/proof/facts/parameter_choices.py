"""Exact parameter values to look at: inside the ranges that single relations give, the plainest first."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, product
from math import prod

import sympy as sp

from duhem.expression.number import rational
from duhem.proof.decide.question import bounds

__all__ = ["Point", "Values", "middle_of", "plain_choices", "rationals", "walk"]

_SCALES = (Fraction(1), Fraction(1, 2), Fraction(2), Fraction(1, 10), Fraction(10), Fraction(1, 100), Fraction(100))
_SHARES = (Fraction(0), Fraction(1), *(Fraction(k, 100) for k in (50, 1, 99, 25, 75, 90)))
_MOST_TOGETHER, _DRAWN = 4096, 400

Values = Mapping[sp.Symbol, Fraction]
Point = tuple[Fraction, ...]  # in the force space of the simple problem


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


def walk(starts: Sequence[Values], admits: Callable[[Values], bool], most: int = 200) -> Iterator[dict[sp.Symbol, Fraction]]:
    """``starts``, what lies between two of them, and where random steps lead (fixed seed), as long as may be: inside however thin a set.

    At most so many values are tried, those between two starts first.
    """
    yield from map(dict, starts)
    for one, two in combinations(starts, 2):
        middle = {x: (one[x] + two[x]) / 2 for x in one}
        if admits(middle):
            yield middle
    rng = random.Random(8)
    for here in map(dict, starts):
        left = most // len(starts)
        while left > 0:
            way = {x: rng.choice((-1, 0, 1)) for x in here}
            for k in range(0, 40, 4):
                left -= 1
                there = {x: value + max(abs(value), Fraction(1)) * way[x] / 2**k for x, value in here.items()}
                if any(way.values()) and admits(there):
                    here = there
                    yield dict(here)
                    break


def middle_of(x: sp.Symbol, given: Sequence[sp.Basic]) -> Fraction:
    """A value well inside the range of a symbol, by the relations that speak of it alone."""
    low, high = bounds(x, given)
    return _grid(x, given)[2] if low is not None and high is not None else _grid(x, given)[0]


def _grid(x: sp.Symbol, given: Sequence[sp.Basic]) -> list[Fraction]:
    low, high = bounds(x, given)
    if low is not None and high is not None:
        return [low + s * (high - low) for s in _SHARES]
    if low is None and high is None:
        return [Fraction(0), *_SCALES, *(-s for s in _SCALES)]
    start, sense = (low, 1) if low is not None else (high, -1)
    assert start is not None
    return [start + sense * s for s in _SCALES] + [start]
