"""Max and Min as SymPy builds them, for less.

SymPy compares every pair of arguments in up to eight ways and drops those that another always covers.  Of most pairs now one,
now the other is the greater; two points show that, and what holds at every point cannot be said of them.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterator
from itertools import combinations

import sympy as sp

from duhem.errors import InputError
from duhem.expression.floats import value_at

__all__ = ["greatest", "least"]

MOST_POINTS = 16
_MARGIN = 1e-6  # far beyond what rounding does to a formula of a law
_SIGNED = frozenset(sp.Symbol("x", positive=True).assumptions0) | frozenset(sp.Symbol("x", negative=True).assumptions0)


def greatest(*args: sp.Expr) -> sp.Expr:
    """``sp.Max(*args)``, the same expression; ValueError as there."""
    return _extreme(sp.Max, args)


def least(*args: sp.Expr) -> sp.Expr:
    """``sp.Min(*args)``, the same expression; ValueError as there."""
    return _extreme(sp.Min, args)


def _extreme(kind: type[sp.Max] | type[sp.Min], args: Collection[sp.Expr]) -> sp.Expr:
    flat = dict.fromkeys(inner for a in args for inner in (a.args if isinstance(a, kind) else (a,)))
    # Within one another SymPy factors them, even where nothing can be compared.
    plain = len(flat) > 1 and not any(isinstance(a, sp.Max | sp.Min) for a in flat)
    return kind(*flat, evaluate=not (plain and _cross(tuple(flat))))


def _cross(args: tuple[sp.Expr, ...]) -> bool:
    """Whether points show of each two that neither is always the greater; False where that stays open."""
    symbols = sorted(set().union(*(a.free_symbols for a in args)), key=str)
    if not symbols or not all(s.assumptions0.keys() <= _SIGNED for s in symbols):  # as integers they are not all that the points are
        return False
    seen: set[tuple[int, int]] = set()
    left = [*combinations(range(len(args)), 2)]
    for point in _points(symbols):
        try:
            values = [value_at(a, point) for a in args]
        except (OverflowError, ValueError, ZeroDivisionError):
            continue
        except (InputError, TypeError):
            return False
        for i, j in left:
            apart = values[i] - values[j]
            if abs(apart) > _MARGIN * (abs(values[i]) + abs(values[j])):
                seen.add((i, j) if apart > 0 else (j, i))
        left = [(i, j) for i, j in left if (i, j) not in seen or (j, i) not in seen]
        if not left:
            return True
    return False


def _points(symbols: Collection[sp.Symbol]) -> Iterator[dict[sp.Symbol, float]]:
    """Points that the symbols' signs allow, always the same."""
    drawn = random.Random(1)
    for _ in range(MOST_POINTS):
        sizes = {s: 2.0 ** drawn.uniform(-4, 4) for s in symbols}
        signs = {s: -1 if s.is_nonpositive else 1 if s.is_nonnegative else drawn.choice((-1, 1)) for s in symbols}
        yield {s: signs[s] * sizes[s] for s in symbols}
