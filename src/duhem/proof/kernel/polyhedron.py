"""Polyhedra {x : l . x <= r for each face (l, r)} in fractions: their corners, whether they are bounded, whether a union is convex.

A corner lies on as many independent faces as there are dimensions.  A polyhedron with so many independent faces holds no line;
if it is unbounded, some direction never leaves it along which all but one of as many independent forms vanish.  A bounded one is
the hull of its corners (R. T. Rockafellar 1970, Convex Analysis, section 18).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, product
from math import comb, prod

from duhem.proof.kernel.term import NotWritten

__all__ = ["Face", "Vector", "corners", "dot", "is_bounded", "solved", "union_is_convex", "within"]

_MOST_CHOICES, _MOST_CELLS = 5000, 100
Vector = tuple[Fraction, ...]
Face = tuple[Vector, Fraction]


def corners(faces: Sequence[Face], n: int) -> list[Vector]:
    """The corners, each once."""
    found = list[Vector]()
    for chosen in _chosen(faces, n):
        free, point = solved(chosen, n)
        if not free and point is not None and point not in found and within(point, faces):
            found.append(point)
    return found


def is_bounded(faces: Sequence[Face], n: int) -> bool:
    """Whether it is, and holds no line even if it is empty."""
    if all(solved(chosen, n)[0] for chosen in _chosen(faces, n)):
        return False
    for chosen in _chosen([(row, Fraction(0)) for row, _ in faces], n - 1):
        free, _ = solved(chosen, n)
        if len(free) == 1 and not {-1, 1} <= {(rise > 0) - (rise < 0) for rise in (dot(row, free[0]) for row, _ in faces)}:
            return False
    return True


def union_is_convex(parts: Sequence[Sequence[Face]], n: int) -> bool:
    """Whether it is the polyhedron of all those faces that no part goes beyond.

    A point of that one outside of every part would be strictly beyond a face of each: the mean of the corners of what is beyond
    or on these faces would be such a point, or there is none.
    """
    reached = [corner for part in parts for corner in corners(part, n)]
    outer = [face for face in dict.fromkeys(face for part in parts for face in part) if all(within(corner, [face]) for corner in reached)]
    inner = [[face for face in part if face not in outer] for part in parts]
    if not all(is_bounded(part, n) for part in (*parts, outer)) or prod(map(len, inner)) > _MOST_CELLS:
        return False
    for chosen in product(*inner):
        ends = corners([*outer, *((tuple(-v for v in row), -limit) for row, limit in chosen)], n)
        if ends and not any(all(dot(row, end) == limit for end in ends) for row, limit in chosen):
            return False
    return True


def within(point: Vector, faces: Sequence[Face]) -> bool:
    """Whether a point lies in it."""
    return all(dot(row, point) <= limit for row, limit in faces)


def dot(one: Vector, two: Vector) -> Fraction:
    """one . two."""
    return sum((a * b for a, b in zip(one, two, strict=True)), Fraction(0))


def _chosen(faces: Sequence[Face], n: int) -> Iterator[tuple[Face, ...]]:
    if comb(len(faces), n) > _MOST_CHOICES:
        raise NotWritten("there are too many faces")
    return combinations(faces, n)


def solved(equations: Sequence[Face], n: int) -> tuple[list[Vector], Vector | None]:
    """Directions along which every solution may be moved, and one solution if there is any, by elimination."""
    left, done = [[*row, limit] for row, limit in equations], dict[int, list[Fraction]]()
    for column in range(n):
        pivot = next((row for row in left if row[column]), None)
        if pivot is None:
            continue
        left = [_cleared(row, pivot, column) for row in left if row is not pivot]
        done = {k: _cleared(row, pivot, column) for k, row in done.items()}
        done[column] = [v / pivot[column] for v in pivot]
    loose = [k for k in range(n) if k not in done]
    free: list[Vector] = [tuple(Fraction(i == k) - (done[i][k] if i in done else 0) for i in range(n)) for k in loose]
    return free, None if any(row[n] for row in left) else tuple(done[i][n] if i in done else Fraction(0) for i in range(n))


def _cleared(row: list[Fraction], pivot: list[Fraction], column: int) -> list[Fraction]:
    return [v - row[column] / pivot[column] * w for v, w in zip(row, pivot, strict=True)]
