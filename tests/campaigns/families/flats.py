"""Sets bounded by straight lines: a polygon, and the union of two."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction

from duhem import Criterion
from tests.campaigns.families.trial import PRESSURE, Trial, linear, written
from tests.oracles.polygons import HalfPlane, area, bounded_by, hull

__all__ = ["polygon", "union"]

F = Fraction


def _halves(rng: random.Random, count: int, offset: Callable[[], Fraction]) -> list[HalfPlane]:
    while True:
        found = [(F(rng.randint(-4, 4)), F(rng.randint(-4, 4)), offset()) for _ in range(count)]
        found = [h for h in found if h[0] or h[1]]
        polygon = bounded_by(found)
        if len(polygon) > 2 and max(max(abs(c) for c in p) for p in polygon) < 900 and area(polygon) > F(1, 20):
            return found


def _forms(halves: Sequence[HalfPlane]) -> str:
    return f"max({', '.join(f'{linear(h[:2])} - {written(h[2])}*{PRESSURE}' for h in halves)})"


def polygon(rng: random.Random, name: str) -> Trial:
    """Finitely many half-planes: convex with corners; 0 in K, and then dissipative, if and only if no offset is negative."""
    shifted = rng.random() < 0.4
    halves = _halves(rng, rng.randint(4, 6), lambda: F(rng.randint(-1 if shifted else 1, 6), 2))
    inside = all(h[2] >= 0 for h in halves)
    truth = {"origin": inside, "convexity": True, "smoothness": False, "normality": True, "dissipation": inside}
    return Trial("polygon", Criterion(name=name, g=_forms(halves)), truth, "origin inside" if inside else "origin outside")


def union(rng: random.Random, name: str) -> Trial:
    """Two polygons around the origin: convex if and only if their hull has no greater area than their union."""
    if rng.random() < 0.4:  # one polygon cut twice, so that the union may be whole again
        base = _halves(rng, 4, lambda: F(rng.randint(1, 6), 2))
        a, b = rng.choice([(F(1), F(0)), (F(1), F(2)), (F(0), F(1))])
        one = [*base, (a, b, F(rng.randint(1, 3), 4))]
        two = [*base, (-a, -b, F(rng.randint(1, 3), 4))]
        if rng.random() < 0.3:
            two[-1] = (-a - F(1, 10), -b, two[-1][2])
    else:
        one, two = (_halves(rng, 4, lambda: F(rng.randint(1, 6), 2)) for _ in range(2))
    p, q = bounded_by(one), bounded_by(two)
    both = bounded_by([*one, *two])
    convex = area(hull([*p, *q])) == area(p) + area(q) - area(both)
    truth = {"origin": True, "convexity": convex, "normality": convex, "smoothness": False, "dissipation": True}
    law = Criterion(name=name, g=f"min({_forms(one)}, {_forms(two)})")
    return Trial("union of polygons", law, truth, "convex" if convex else "not convex")
