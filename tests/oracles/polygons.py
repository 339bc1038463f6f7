"""Polygons with rational vertices, exactly: cut by half-planes, area, convex hull."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

__all__ = ["HalfPlane", "Point", "area", "bounded_by", "hull"]

F = Fraction
Point = tuple[Fraction, Fraction]
HalfPlane = tuple[Fraction, Fraction, Fraction]  # a x + b y <= d


def _clip(polygon: Sequence[Point], half: HalfPlane) -> list[Point]:
    """The part of a convex polygon in a half-plane (Sutherland and Hodgman 1974)."""
    a, b, d = half
    kept: list[Point] = []
    for p, q in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True):
        hp, hq = a * p[0] + b * p[1] - d, a * q[0] + b * q[1] - d
        if hp <= 0:
            kept.append(p)
        if hp * hq < 0:
            s = hp / (hp - hq)
            kept.append((p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])))
    return list(dict.fromkeys(kept))


def area(polygon: Sequence[Point]) -> Fraction:
    """Area of a polygon whose vertices run counter-clockwise."""
    return sum((p[0] * q[1] - p[1] * q[0] for p, q in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True)), F(0)) / 2


def _left_turn(p: Point, q: Point, r: Point) -> bool:
    return (q[0] - p[0]) * (r[1] - p[1]) > (q[1] - p[1]) * (r[0] - p[0])


def hull(points: Sequence[Point]) -> list[Point]:
    """Convex hull, counter-clockwise (Andrew 1979)."""

    def half(ordered: Sequence[Point]) -> list[Point]:
        chain: list[Point] = []
        for p in ordered:
            while len(chain) > 1 and not _left_turn(chain[-2], chain[-1], p):
                chain.pop()
            chain.append(p)
        return chain[:-1]

    ordered = sorted(set(points))
    return half(ordered) + half(ordered[::-1])


_HUGE = [(F(-1000), F(-1000)), (F(1000), F(-1000)), (F(1000), F(1000)), (F(-1000), F(1000))]


def bounded_by(halves: Sequence[HalfPlane]) -> list[Point]:
    """The polygon that half-planes leave of a square far greater than they are."""
    found = _HUGE
    for half in halves:
        found = _clip(found, half)
    return found
