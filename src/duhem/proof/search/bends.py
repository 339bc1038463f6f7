"""States at which an energy is not convex, and the direction in which it bends most: chords of its epigraph with few digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from duhem.errors import InputError
from duhem.expression.branches import gradient
from duhem.expression.number import fraction, rational
from duhem.expression.numpy_ import compiled
from duhem.law.domain import Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values
from duhem.proof.search.boundary_points import Chord
from duhem.proof.search.plain_states import plain_states

__all__ = ["chords_across_bends"]

_MOST, _VALUES = 4_000, 6  # states, of which each has a matrix, and plain values of each variable
_CHOICES = 12
_LEAST = 1e-200  # heights of a chord, whose inverse is a double
_PARTS = (4, 16, 128)  # to whole shares of which a direction is rounded
_SIZES = (Fraction(1), Fraction(1, 2), Fraction(1, 8), Fraction(1, 2000))  # of a chord, in units of the variables or half the least range
_ROUNDING, _HUGE = 1e-9, 1e200  # of second derivatives


def chords_across_bends(subject: FormulaSubject) -> Iterator[Chord]:
    """Of a law {psi(chi) - z <= 0}, z its last force: between chi - v and chi + v with v . psi'' v < 0, a little above the graph."""
    *moving, height = subject.simple.forces
    if not moving:  # every variable is fixed
        return
    for parameters in subject.choices(_CHOICES):
        energy = subject.formula_at(parameters) + height
        try:
            second = [[compiled(d, moving) for d in gradient(slope, moving)] for slope in gradient(energy, moving)]
        except InputError:  # it has no derivatives in words
            return
        value = compiled(energy, moving)
        spans = [subject.law.domain.get(x.name, Domain()) for x in moving]
        for state in plain_states(spans, _MOST, _VALUES):
            at = [np.array([float(x)]) for x in state]
            with np.errstate(all="ignore"):
                matrix = np.array([[np.broadcast_to(entry(*at), 1)[0] for entry in row] for row in second], dtype=float)
            if not (np.abs(matrix) < _HUGE).all():
                continue
            bends, directions = np.linalg.eigh(matrix)
            if bends[0] < -_ROUNDING * np.abs(bends).max():
                yield from _along(parameters, state, directions[:, 0], spans, value)


def _along(
    parameters: Values, state: Sequence[Fraction], steep: Any, spans: Sequence[Domain], value: Callable[..., Any]
) -> Iterator[Chord]:
    """Chords on both sides of a state, or of one beside it where the state lies at an end of a range."""
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
