"""A point inside the slice of a cone of matrices, found to many digits where that slice is thin.

Of the matrices B + y_1 N_1 + y_2 N_2 + ... that are positive definite one is sought by Newton's method on the barrier -log det
(Nesterov, Nemirovskii 1994), on the way from B + s I, s large, to s < 0.  It does not matter to the barrier how thin the slice is, and
many digits bear it.  Nothing is certain of what is found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from duhem.expression.balls import ball, precision

__all__ = ["Blocks", "inner_point"]

Blocks = Sequence[Sequence[Sequence[Fraction]]]  # a symmetric matrix by the blocks on its diagonal
_BITS, _STEPS = 256, 120
_THINNEST = 1e-22  # s, of a matrix with entries up to 1, below which the slice is taken to have no inside
_FASTER = 20.0  # how much more s counts after each step that came near the middle
_SHORT = 0.9  # of the way to the edge of the cone
_FINEST = 40  # digits of what is found


def inner_point(base: Blocks, ways: Sequence[Blocks], start: Sequence[Fraction]) -> Iterator[list[Fraction]]:
    """Numbers y with which base + sum y_k ways_k is positive definite, as it seems, in ever more digits; none where none was found."""
    with precision(_BITS):
        found = _found(base, ways, start)
    if found is None:
        return
    for digits in range(3, _FINEST, 3):
        yield [Fraction(round(y * 10**digits), 10**digits) for y in found]


def _found(base: Blocks, ways: Sequence[Blocks], start: Sequence[Fraction]) -> list[Fraction] | None:
    """In phase one s is made small, in phase two the determinant great."""
    cone = _Slice.of(base, ways)
    y = [ball(x) for x in start]
    here = cone.at(y)
    size = max(abs(float(x)) for block in here for x in block.entries()) or 1.0
    lowest = min(float(np.linalg.eigvalsh(_floats(block))[0]) for block in here)
    room, count = ball(Fraction(max(-2 * lowest, 1e-9 * size))), sum(block.nrows() for block in here)
    raised = cone.raised()
    weight = count / float(room)
    for _ in range(_STEPS):
        step = raised.step(raised.at([*y, room]), weight)
        if step is None:
            return None
        y, room = [a + b for a, b in zip(y, step.by[:-1], strict=True)], room + step.by[-1]
        if float(room) < 0:
            break
        if step.size < 1:
            if count / weight < _THINNEST * size:
                return _fractions(y)
            weight *= _FASTER
    else:
        return None
    for _ in range(_STEPS):
        step = cone.step(cone.at(y), 0.0)
        if step is None:
            return None
        y = [a + b for a, b in zip(y, step.by, strict=True)]
        if step.size < 1:
            break
    return _fractions(y)


def _fractions(y: Sequence[Any]) -> list[Fraction]:
    return [Fraction(int(q.p), int(q.q)) for q in (x.mid().fmpq() for x in y)]


@dataclass(frozen=True)
class _Step:
    """``by`` how much each number changes; ``size`` of the whole Newton step in the norm of the barrier."""

    by: list[Any]
    size: float


@dataclass(frozen=True)
class _Slice:
    """Matrices of Arb, a block each."""

    base: list[Any]
    ways: list[list[Any]]

    @classmethod
    def of(cls, base: Blocks, ways: Sequence[Blocks]) -> _Slice:
        def matrices(blocks: Blocks) -> list[Any]:
            return [flint.arb_mat(len(b), len(b), [ball(x) for row in b for x in row]) for b in blocks]

        return cls(matrices(base), [matrices(way) for way in ways])

    def raised(self) -> _Slice:
        """With the unit matrix as the last way."""
        unit = [flint.arb_mat(b.nrows(), b.nrows(), [int(i == j) for i in range(b.nrows()) for j in range(b.nrows())]) for b in self.base]
        return _Slice(self.base, [*self.ways, unit])

    def at(self, y: Sequence[Any]) -> list[Any]:
        """Its matrix."""
        found = list(self.base)
        for x, way in zip(y, self.ways, strict=True):
            found = [a + x * b for a, b in zip(found, way, strict=True)]
        return [a.mid() for a in found]

    def step(self, here: list[Any], weight: float) -> _Step | None:
        """Newton's for ``weight`` times the last number minus log det, or so much of it as stays inside; None where it fails."""
        try:
            inverse = [block.inv().mid() for block in here]
            turned = [[(w * n).mid() for w, n in zip(inverse, way, strict=True)] for way in self.ways]
            slope = [-sum((d.trace() for d in blocks), flint.arb(0)) for blocks in turned]
            slope[-1] += weight
            count, width = len(turned), sum(block.nrows() ** 2 for block in here)
            rows = flint.arb_mat(count, width, [x for blocks in turned for d in blocks for x in d.entries()])
            columns = flint.arb_mat(count, width, [x for blocks in turned for d in blocks for x in d.transpose().entries()])
            curve = rows * columns.transpose()
            by = curve.mid().solve(flint.arb_mat(count, 1, [-x for x in slope]).mid()).mid()
        except ZeroDivisionError:  # a matrix is too near a singular one
            return None
        size = float(-sum((a * by[k, 0] for k, a in enumerate(slope)), flint.arb(0)).mid())
        change = [sum((by[k, 0] * turned[k][b] for k in range(1, count)), by[0, 0] * turned[0][b]) for b in range(len(here))]
        least = min(float(np.linalg.eigvals(_floats(c)).real.min()) for c in change)
        part = min(1.0, -_SHORT / least) if least < 0 else 1.0
        return _Step([(part * by[k, 0]).mid() for k in range(count)], max(size, 0.0) ** 0.5) if np.isfinite(least + size) else None


def _floats(matrix: Any) -> Any:
    return np.array([float(x) for x in matrix.entries()]).reshape(matrix.nrows(), matrix.ncols())
