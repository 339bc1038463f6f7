"""States of a law with few digits, inside the ranges of its variables, at which something seems to be violated.

At such a state a quantity seems to be negative, or an energy is not convex: then chords of its epigraph run along the direction in
which it bends most.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import product
from math import prod
from random import Random
from typing import Any

import numpy as np
import sympy as sp

from duhem.expression.jets import formula
from duhem.expression.number import fraction, rational
from duhem.expression.numpy_ import compiled
from duhem.law.domain import Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values
from duhem.proof.search.boundary_points import Chord

__all__ = ["chords_across_bends", "plain_states", "states_of_negative"]

_PLAIN = tuple(map(Fraction, ("0", "1/2", "1", "-1", "2", "-2", "10", "-10", "1/10", "-1/2", "1/2000", "-1/2000", "2000", "-2000")))
_TOUCHING = 1e-9
_TRIED = 8

State = tuple[Fraction, ...]


def plain_states(spans: Sequence[Domain], most: int, values: int = len(_PLAIN)) -> list[State]:
    """Return all combinations of so many plain values, or ``most`` drawn ones if there are more; those near 0 come first."""
    every = [_inside(span, values) for span in spans]
    if prod(map(len, every)) <= most:
        found = list(product(*every))
    else:
        draw = Random(7)
        found = list(dict.fromkeys(tuple(map(draw.choice, every)) for _ in range(most)))
    return sorted(found, key=lambda state: sum(map(abs, state)))


def _inside(span: Domain, values: int) -> list[Fraction]:
    """Return plain values of a range, its ends, its middle and values beside them."""
    low, high = (None if end is None else fraction(end) for end in (span.low, span.high))
    ends = [low, high, None if low is None or high is None else (low + high) / 2, None if low is None else low + 1]
    own = [*_PLAIN[:values], *(end for end in ends if end is not None), *([] if high is None else [high - 1])]
    return [x for x in dict.fromkeys(own) if rational(x) in span]


def states_of_negative(
    quantity: sp.Expr, bound: sp.Expr | None, on_it: bool, names: Sequence[sp.Symbol], states: Sequence[State]
) -> Iterator[State]:
    """Yield states where, in floats, the quantity is < 0 and the bound is <= 0 (0 with ``on_it``): the first, then the clearest."""
    columns = np.array([[float(x) for x in state] for state in states], dtype=float).reshape(len(states), len(names)).T
    with np.errstate(all="ignore"):
        spent, height = (np.broadcast_to(compiled(sp.S.Zero if e is None else e, names)(*columns), len(states)) for e in (quantity, bound))
        found = np.flatnonzero((spent < 0) & ((np.abs(height) if on_it else height) <= _TOUCHING))
    clearest = found[np.argsort(spent[found], kind="stable")]
    yield from (states[i] for i in dict.fromkeys([*found[:_TRIED].tolist(), *clearest[:_TRIED].tolist()]))


# -- energies that are not convex --------------------------------------------------------------------------------------

_MOST, _VALUES = 4_000, 6  # states, of which each has a matrix, and plain values of each variable
_CHOICES = 12
_LEAST = 1e-200  # heights of a chord, whose inverse is a double
_PARTS = (4, 16, 128)  # to whole shares of which a direction is rounded
_SIZES = (Fraction(1), Fraction(1, 2), Fraction(1, 8), Fraction(1, 2000))  # of a chord, in units of the variables or half the least range
_ROUNDING, _HUGE = 1e-9, 1e200  # of second derivatives


def chords_across_bends(subject: FormulaSubject) -> Iterator[Chord]:
    """Yield chords of the epigraph {psi(chi) - z <= 0}, where z is the last force: between chi - v and chi + v with v . psi'' v < 0.

    Their ends lie a little above the graph of psi.
    """
    *moving, height = subject.simple.forces
    if not moving:  # every variable is fixed
        return
    for parameters in subject.choices(_CHOICES):
        energy = subject.formula_at(parameters) + height
        value = compiled(energy, moving)
        spans = [subject.law.domain.get(x.name, Domain()) for x in moving]
        states = plain_states(spans, _MOST, _VALUES)
        jet, _ = formula(energy, moving, (), strict=True)(np.array(states, dtype=float), ())
        for state, matrix in zip(states, jet.hessian, strict=True):
            if not (np.abs(matrix) < _HUGE).all():
                continue
            bends, directions = np.linalg.eigh(matrix)
            if bends[0] < -_ROUNDING * np.abs(bends).max():
                yield from _along(parameters, state, directions[:, 0], spans, value)


def _along(
    parameters: Values, state: Sequence[Fraction], steep: Any, spans: Sequence[Domain], value: Callable[..., Any]
) -> Iterator[Chord]:
    """Yield chords about a state, or about one beside it where the state lies at an end of a range."""
    steep = steep / np.abs(steep).max()
    widths = (fraction(span.high - span.low) / 2 for span in spans if span.high is not None and span.low is not None)
    room = min([Fraction(1), *widths])
    for parts, size in product(_PARTS, _SIZES):
        way = [room * size * Fraction(round(float(c) * parts), parts) for c in steep]
        for shift in (0, 1, -1):
            ends = [tuple(x + (side + shift) * w for x, w in zip(state, way, strict=True)) for side in (-1, 1)]
            if not all(rational(x) in span for end in ends for x, span in zip(end, spans, strict=True)):
                continue
            middle = [float(a + b) / 2 for a, b in zip(*ends, strict=True)]
            with np.errstate(all="ignore"):
                above = [float(value(*map(float, end))) for end in ends]
                sag = float(value(*middle)) - sum(above) / 2
            if np.isfinite([*above, sag]).all() and sag > _LEAST:
                heights = [Fraction(height + sag / 2).limit_denominator(max(8, int(8 / sag))) for height in above]
                yield parameters, (*ends[0], heights[0]), (*ends[1], heights[1])
