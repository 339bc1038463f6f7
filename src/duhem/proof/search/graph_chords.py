"""Chords of a law kept as a graph, in floating point: across its boundary, long ones between any two points and short ones along tangents.

A dent may be as narrow as one kink of one neuron.  So short chords of every length are tilted and shifted until both ends lie on a level
of g, and the one whose midpoint lies highest above it is a candidate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Values
from duhem.proof.search.boundary_points import lowest

__all__ = ["Chord", "graph_chords"]

Array = NDArray[np.float64]
Chord = tuple[tuple[Fraction, ...], tuple[Fraction, ...]]
_DIRECTIONS, _FEWEST, _PAIRS, _LENGTHS, _TURNS = 1500, 100, 4, 10, 3
_LENGTH = 1_000_000  # letters of all definitions, beyond which fewer directions are looked at
_RADII, _BITS = np.exp2(np.arange(-10.0, 30.0)), 40
_DIGITS = (2, 3, 4, 6, 9, 12)
_BEST = 2  # of each length
_NOISE = 1e-11  # relative to the sizes of g


def graph_chords(subject: GraphSubject, parameters: Values) -> Iterator[Chord]:
    """Ends in K with a midpoint that seems to lie outside, the plainest digits first."""
    forces = subject.law.force_symbols()
    rest = {x: float(v) for x, v in subject.values_at(parameters, [Fraction(0)] * len(forces)).items() if x not in forces}
    program = compiled(subject.law.g, [*forces, *rest])

    def g(at: Array) -> Array:
        with np.errstate(all="ignore"):
            return np.asarray(program(*np.moveaxis(at, -1, 0), *rest.values()) + np.zeros(at.shape[:-1]))

    rng = np.random.default_rng(0)
    length = sum(len(text) for _, text in subject.law.graph.nodes) if subject.law.graph else 0
    directions = int(np.clip(_DIRECTIONS * _LENGTH / max(length, 1), _FEWEST, _DIRECTIONS))
    zero = np.zeros(len(forces))
    start = zero if g(zero) < 0.0 else lowest(g, len(forces), rng, (-2, 2))
    if start is None or len(edge := _boundary(g, start, directions, rng)) < 2:
        return
    with np.errstate(all="ignore"):  # where g has no value, or an infinite one
        found = [*_long(g, start, edge, rng), *_short(g, start, edge, rng)]
    for a, b in found:
        yield from _in_digits(a, b)


def _boundary(g: Callable[[Array], Array], start: Array, directions: int, rng: np.random.Generator) -> Array:
    """Points just inside of where rays from a point of K leave it."""
    ways = rng.normal(size=(directions, len(start)))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    rays = Rays(g, start, ways)
    last, first = rays.left(_RADII, _BITS)
    return rays.at(last)[last < first]


def _long(g: Callable[[Array], Array], start: Array, edge: Array, rng: np.random.Generator) -> Iterator[tuple[Array, Array]]:
    """Between two points of the boundary, a little nearer to the inner point."""
    a, b = (start + (1.0 - 1e-6) * (edge[rng.integers(len(edge), size=_PAIRS * len(edge))] - start) for _ in range(2))
    above = np.minimum(g(0.5 * (a + b)), -np.maximum(g(a), g(b)))
    for i in np.argsort(-above)[:_BEST]:
        if above[i] > 0.0:
            yield a[i], b[i]


def _short(g: Callable[[Array], Array], start: Array, edge: Array, rng: np.random.Generator) -> Iterator[tuple[Array, Array]]:
    """Along tangents, both ends on one level."""
    size = float(np.median(np.linalg.norm(edge - start, axis=1)))
    steps = 1e-6 * size * np.eye(edge.shape[1])
    slopes = np.stack([(g(edge + s) - g(edge - s)) / (2e-6 * size) for s in steps], axis=1)
    steep = np.linalg.norm(slopes, axis=1, keepdims=True)
    edge, slopes, steep = (x[np.isfinite(steep[:, 0]) & (steep[:, 0] > 0.0)] for x in (edge, slopes, steep))
    normal, noise = slopes / steep, _NOISE * float(np.max(steep, initial=0.0)) * size
    for k in range(1, _LENGTHS + 1):
        along = rng.normal(size=edge.shape)
        along -= normal * np.sum(along * normal, axis=1, keepdims=True)
        along *= size * 2.0**-k / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
        middle = edge
        for _ in range(_TURNS):
            ahead, behind = g(middle + along), g(middle - along)
            along = along - normal * ((ahead - behind)[:, None] / (2.0 * steep))
            middle = middle - normal * (0.5 * (ahead + behind)[:, None] / steep)
        ends, above = np.maximum(g(middle + along), g(middle - along)), g(middle)
        gap = np.where(np.isfinite(ends + above), above - ends, -np.inf)
        middle = middle - normal * ((ends + 0.5 * gap)[:, None] / steep)
        for i in np.argsort(-gap)[:_BEST]:
            if gap[i] > noise:
                yield middle[i] + along[i], middle[i] - along[i]


def _in_digits(a: Array, b: Array) -> Iterator[Chord]:
    """The ends rounded to a few digits of the chord's length, then to more, then as they are."""
    first = -int(np.floor(np.log10(np.max(np.abs(a - b)))))
    p, q = (tuple(Fraction(float(x)) for x in end) for end in (a, b))
    for digits in _DIGITS:
        one, two = (tuple(round(x, first + digits) for x in end) for end in (p, q))
        yield one, two
    yield p, q
