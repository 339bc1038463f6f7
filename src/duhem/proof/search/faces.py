"""Smaller cones for a sum of squares that only just is one (facial reduction): what every square must look like.

Where the form is 0 each square vanishes; where it is all but 0, so do they, and are better counted in smaller units.  What a
solver's matrix is flat in may be left out as well.  All of it is found in floats and made rational: a wrong guess finds no
identity, and nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from duhem.proof.search.blocks import Block, Polynomial, added
from duhem.proof.search.touching_points import on_spheres, touching_points, values_at

__all__ = ["Matrix", "combined", "positive_somewhere", "stretched", "vanishing", "without_flat_directions"]

Matrix = list[list[Fraction]]
_BLUNT = MappingProxyType({60: 2e-3})  # the greatest denominator of what is taken for rational, and how near it is
_FINE = 10**7  # what need not be rational is rounded to such fractions
_LOOKS, _FAR = 500, 1e-6  # points at which a form is looked at, and what is taken for another sign
_STARTS, _GAP = 4, 1e-4  # looks for zeros a square; how far singular values drop behind the last that is not 0
_NEARLY = 1e-4  # a depth or a gradient of a form that is all but 0


def positive_somewhere(start: Polynomial, spheres: Sequence[Sequence[int]]) -> bool:
    """Whether it is, by far, at one of many points."""
    import numpy as np

    factors = [float(c) for c in start.values()]
    return bool(values_at(on_spheres(len(next(iter(start))), spheres, _LOOKS), start).max() > _FAR * np.abs(factors).max())


def vanishing(start: Polynomial, blocks: Sequence[Block], spheres: Sequence[Sequence[int]]) -> list[Block] | None:
    """The blocks without what does not vanish at the zeros of ``start``, as far as these look rational; None if all does."""
    found = touching_points({m: -c for m, c in start.items()}, spheres, _STARTS * sum(len(b.squares) for b in blocks))
    kept, less = list[Block](), False
    for block in blocks:
        rank, axes, precision = _span(found, block)
        left = _complement(block.squares, axes[:rank], {int((0.01 / precision) ** 0.5): 100 * precision}) if rank else block.squares
        less = less or len(left) < len(block.squares)
        if left:
            kept.append(replace(block, squares=left))
    return kept if less else None


def stretched(start: Polynomial, blocks: Sequence[Block], spheres: Sequence[Sequence[int]]) -> list[Matrix] | None:
    """For each block the combinations of its squares in which no number of a sum of squares is small; None if that changes nothing.

    Of what ``start`` allows but little it is the smaller unit: the root of the depth at the points where it is all but 0.
    """
    import numpy as np

    found = touching_points({m: -c for m, c in start.items()}, spheres, _STARTS * sum(len(b.squares) for b in blocks), _NEARLY)
    depths = -values_at(found, start) if len(found) else np.ones(1)
    if not (depths < _NEARLY).any():
        return None
    deep = depths < _NEARLY
    unit = Fraction(1, 10 ** round(-float(np.log10(np.sqrt(np.clip(np.median(depths[deep]), 1e-14, 1e-2))))))
    matrices, some = list[Matrix](), False
    for block in blocks:
        rank, axes, _ = _span(found[deep], block)
        rows, pivots = _orthogonal(axes[:rank], {_FINE: 1.0}) if rank else (None, [])
        size = range(len(block.squares))
        some = some or bool(pivots)
        fine = [i for i in size if i not in pivots] if rows is None else []
        matrices.append(
            [*(rows or []), *([Fraction(int(i == j)) for j in size] for i in fine), *([unit * (p == j) for j in size] for p in pivots)]
        )
    return matrices if some else None


def _span(points: Any, block: Block) -> tuple[int, Any, float]:
    """Of the values of the squares at some points: how many directions they span, axes with these first, and how sharply they end."""
    import numpy as np

    if not len(points):
        return 0, None, 1.0
    _, sizes, axes = np.linalg.svd(np.stack([values_at(points, q) for q in block.squares], axis=1))
    sizes = np.concatenate([sizes, np.zeros(len(axes) - len(sizes))])
    drops = sizes[1:] / np.maximum(sizes[:-1], 1e-300)
    rank = int(np.argmin(drops)) + 1 if len(drops) else 1
    if sizes[0] < _GAP or (len(drops) and drops[rank - 1] > _GAP):
        return 0, None, 1.0
    return rank, axes, max(1e-14, float(sizes[rank] / sizes[0]) if len(drops) else 0.0)


def without_flat_directions(blocks: Sequence[Block], grams: Sequence[Any], flat: float) -> list[Block] | None:
    """The blocks without the directions in which the Gram matrices are flat, as far as these look rational; None if none is."""
    import numpy as np

    kept, less = list[Block](), False
    for block, gram in zip(blocks, grams, strict=True):
        sizes, axes = np.linalg.eigh(np.array(gram, dtype=float))
        null = sizes < flat * max(1.0, float(np.abs(sizes).max()))
        left = _complement(block.squares, axes[:, null].T, _BLUNT) if null.any() else block.squares
        less = less or len(left) < len(block.squares)
        if left:
            kept.append(replace(block, squares=left))
    return kept if less else None


def _complement(squares: tuple[Polynomial, ...], null: Any, looks: Mapping[int, float]) -> tuple[Polynomial, ...]:
    """Combinations of ``squares`` that span what is orthogonal to the rows of ``null``, these made rational; all where they are not."""
    rows = _orthogonal(null, looks)[0]
    return squares if rows is None else tuple(combined(squares, row) for row in rows)


def combined(squares: Sequence[Polynomial], row: Sequence[Fraction]) -> Polynomial:
    """Their sum, each with its number."""
    return added(*({m: x * c for m, c in q.items()} for q, x in zip(squares, row, strict=True) if x))


def _orthogonal(null: Any, looks: Mapping[int, float]) -> tuple[list[list[Fraction]] | None, list[int]]:
    """Rows that span what is orthogonal to those of ``null``, these made rational, and the places at which none of them stands alone.

    They are rational if for one of the greatest denominators in ``looks`` all are so near; if not, there are no rows.
    """
    import numpy as np

    rows, pivots = np.array(null), list[int]()
    for r in range(len(rows)):  # Gauss-Jordan, the greatest entry as pivot: entries of a rational space come out rational
        p, c = max(((p, c) for p in range(r, len(rows)) for c in range(rows.shape[1])), key=lambda at: abs(rows[at]))
        rows[[r, p]] = rows[[p, r]]
        rows[r] /= rows[r, c]
        for i in range(len(rows)):
            if i != r:
                rows[i] -= rows[i, c] * rows[r]
        pivots.append(c)
    for most, near in looks.items():
        exact = [[Fraction(float(x)).limit_denominator(most) for x in row] for row in rows]
        if max(abs(float(f) - x) for row, given in zip(exact, rows, strict=True) for f, x in zip(row, given, strict=True)) <= near:
            break
    else:
        return None, pivots
    found = []
    for f in (c for c in range(rows.shape[1]) if c not in pivots):
        at = {f: Fraction(1), **{p: -row[f] for p, row in zip(pivots, exact, strict=True)}}
        found.append([at.get(c, Fraction(0)) for c in range(rows.shape[1])])
    return found, pivots
