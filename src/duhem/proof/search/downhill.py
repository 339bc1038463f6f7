"""Walks downhill over parameters and points together, many at once, in floats: they find what no plain choice of the parameters shows.

A walk has one number of each parameter and points of its own.  Ends of ranges, equal parameters and small moves are tried.  A gap is a
place outside K between two points of K: where K has another part or a hole, or where its boundary bends inward.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.law.domain import REAL
from duhem.proof.decide.question import bounds
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values, plain_choices
from duhem.proof.search.boundary_points import Exit

__all__ = ["ParameterRows", "downhill", "entered", "gaps"]

Array = NDArray[np.float64]
Move = Callable[[Sequence[Array], Array, np.random.Generator], Sequence[Array]]
_CHILDREN = 8  # moves that are tried at once from one place
_NARROWER, _WIDER, _WIDEST = 0.6, 1.5, 1.0  # widths of moves where none leads downhill, and where one does
_RARE = 0.1  # the share of moves to an end, and of those that make two parameters equal
_SMALL = 1e-3  # a distance from an end, in units of the parameter
_STARTS, _MOVES = 192, 30  # of a search for gaps
_SIZES = (-2.0, 2.5)  # powers of ten of the first points
_SHARES = np.linspace(0.0, 1.0, 17)[1:-1]  # of a chord, at which g is looked at
_NODE = 10_000  # steps of each node of the formula, for a search for gaps
_SHOWN = 8


def downhill(value: Callable[..., Any], start: Sequence[Array], move: Move, moves: int) -> tuple[list[Array], Array]:
    """The places (m, n) after so many moves of each walk, and their values (m,); each place is told by several arrays.

    ``move`` gives places beside those given, as far away as the widths (m, 1) say.  A walk that finds nothing lower looks closer.
    """
    rng = np.random.default_rng(9)
    here, heights = list(start), np.asarray(value(*start))
    widths, walk = np.full(len(heights), _WIDEST), np.arange(len(heights))
    for _ in range(moves):
        tried = move([np.repeat(part, _CHILDREN, axis=0) for part in here], np.repeat(widths, _CHILDREN)[:, None], rng)
        found = np.asarray(value(*tried)).reshape(-1, _CHILDREN)
        best = found.argmin(axis=1)
        lower = found[walk, best] < heights
        chosen = (part.reshape(len(walk), _CHILDREN, -1)[walk, best] for part in tried)
        here = [np.where(lower[:, None], new, old) for new, old in zip(chosen, here, strict=True)]
        heights = np.where(lower, found[walk, best], heights)
        widths = np.where(lower, np.minimum(_WIDEST, _WIDER * widths), _NARROWER * widths)
    return here, heights


class ParameterRows:
    """Values of the parameters of the simple problem as rows of doubles (m, k), with three digits or at the ends of their ranges."""

    def __init__(self, subject: FormulaSubject) -> None:
        self.subject, self.free = subject, subject.simple.parameters
        self._ends = [bounds(x, subject.simple.given) for x in self.free]
        ends = [[-np.inf if low is None else float(low), np.inf if high is None else float(high)] for low, high in self._ends]
        self._low, self._high = np.array(ends).reshape(-1, 2).T
        tied = [r for r in subject.simple.given if isinstance(r, sp.core.relational._Inequality)]
        self._gaps = [(compiled(r.gts - r.lts, self.free), isinstance(r, sp.StrictGreaterThan | sp.StrictLessThan)) for r in tied]

    def plain(self, most: int) -> Array:
        """So many plain choices, ends of ranges among them, repeated where there are fewer."""
        chosen = [[float(one[x]) for x in self.free] for one in plain_choices(self.free, self.subject.simple.given)]
        rows = np.reshape(chosen, (len(chosen), len(self.free)))
        rows = rows[self.admitted(rows)]
        return np.resize(rows, (most if len(rows) else 0, len(self.free)))

    def admitted(self, rows: Array) -> NDArray[np.bool_]:
        """Which rows the law admits, as far as floats show it."""
        found = np.ones(len(rows), dtype=bool)
        for gap, strict in self._gaps:
            found &= gap(*rows.T) > 0 if strict else gap(*rows.T) >= 0
        return found

    def beside(self, rows: Array, widths: Array, rng: np.random.Generator) -> Array:
        """Other rows: half of the numbers moved by about so much of their range or size, few to an end or to another number."""
        n, k = rows.shape
        if not k:
            return rows
        end = np.where(np.isfinite(self._low), self._low, np.where(np.isfinite(self._high), self._high, 0.0))
        span = np.where(np.isfinite(self._high - self._low), self._high - self._low, np.maximum(np.abs(rows - end), _SMALL))
        new = rows + widths * span * rng.standard_normal((n, k)) * (rng.random((n, k)) < 0.5)
        to_end = np.where(rng.random((n, k)) < 0.5, self._low, self._high)
        new = np.where((rng.random((n, k)) < _RARE) & np.isfinite(to_end), to_end, new)
        one, other = rng.integers(k, size=(2, n))
        new[np.arange(n), one] = np.where(rng.random(n) < _RARE, new[np.arange(n), other], new[np.arange(n), one])
        digits = 10.0 ** np.floor(np.log10(np.maximum(np.abs(new), 1e-300)) - 2.0)
        return np.clip(np.round(new / digits) * digits, self._low, self._high)

    def values(self, row: Array) -> Values | None:
        """The row in fractions; None where the law does not admit them."""
        found = dict[sp.Symbol, Fraction]()
        for x, number, ends in zip(self.free, row, self._ends, strict=True):
            found[x] = next((end for end in ends if end is not None and float(end) == number), Fraction(f"{number:.6g}"))
        return found if self.subject.admits_choice(found) else None


def entered(subject: FormulaSubject) -> Iterator[Exit]:
    """Where lines from zero force come back into K: g falls along the line there, so that sigma . grad g is not > 0."""
    for parameters, _, x, q in gaps(subject, from_zero=True):
        outside, inside = (tuple(Fraction(float(c)).limit_denominator(10**9) for c in end) for end in (x, q))
        yield Exit(parameters, inside, outside)


def gaps(subject: FormulaSubject, from_zero: bool) -> Iterator[tuple[Values, Array, Array, Array]]:
    """Parameters, a point p of K, one x outside and a point q of K on a line, as it seems; ``from_zero`` with p at zero force."""
    rows, forces = ParameterRows(subject), subject.simple.forces
    own, price = rows.plain(_STARTS), _NODE * sum(1 for _ in sp.preorder_traversal(subject.simple.g))
    if not (len(own) and subject.budget.pays(price)):
        return
    run = compiled(subject.simple.g, (*rows.free, *forces))
    low, high = np.array([subject.law.domain.get(x.name, REAL).ends for x in forces]).T

    def level(own: Array, points: Array) -> Any:
        """g at points (m, d), infinite where it has no value, and above 0 outside of the law's ranges."""
        found = np.broadcast_to(run(*own.T, *points.T), len(points))
        found = np.where(np.isfinite(found) & rows.admitted(own), found, np.inf)
        return np.maximum(found, np.max(np.maximum(low - points, points - high), axis=1))

    def nearer(places: Sequence[Array], widths: Array, rng: np.random.Generator) -> Sequence[Array]:
        own, *points = places
        return own, *(x + widths * np.linalg.norm(x, axis=1, keepdims=True) * rng.standard_normal(x.shape) for x in points)

    def elsewhere(places: Sequence[Array], widths: Array, rng: np.random.Generator) -> Sequence[Array]:
        own, p, q = places
        size = widths * np.linalg.norm(q - p, axis=1, keepdims=True)
        p, q = (x + size * rng.standard_normal(x.shape) * rng.integers(2, size=(len(x), 1)) for x in (p, q))
        return rows.beside(own, np.minimum(widths, 0.2), rng), np.zeros_like(p) if from_zero else p, q

    def between(own: Array, p: Array, q: Array) -> Any:
        """Minus the greatest g between two points of K; infinite where one of these is outside."""
        inside = (level(own, p) <= 0) & (level(own, q) <= 0)
        highest = np.max([np.where(np.isfinite(h := level(own, p + s * (q - p))), h, -np.inf) for s in _SHARES], axis=0)
        return np.where(inside, -highest, np.inf)

    with np.errstate(all="ignore"):
        rng = np.random.default_rng(11)
        sizes = 10.0 ** rng.uniform(*_SIZES, (2, len(own), 1))
        first = (size * rng.standard_normal((len(own), len(forces))) for size in sizes)
        ends = [downhill(lambda *place: np.maximum(level(*place), 0.0), (own, x), nearer, _MOVES)[0][1] for x in first]  # into K, no deeper
        start = (own, np.zeros_like(ends[0]) if from_zero else ends[0], ends[1])
        (own, p, q), heights = downhill(between, start, elsewhere, _MOVES)
        for k in np.argsort(heights)[: min(_SHOWN, np.count_nonzero(heights < 0))]:
            if (values := rows.values(own[k])) is not None:
                line = p[k] + _SHARES[:, None] * (q[k] - p[k])
                yield values, p[k], line[np.argmax(level(np.broadcast_to(own[k], (len(line), own.shape[1])), line))], q[k]
