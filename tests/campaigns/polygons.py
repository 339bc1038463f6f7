"""Verdicts on polygons of several surfaces, each side with a slip of its own, against their truth in fractions.

K is bounded by lines a . sigma <= b and a square.  The flow d of a side is normal to K at each of its points exactly when it is at
both ends: d . (tau - sigma) <= 0 for all vertices tau; it dissipates exactly when sigma . d >= 0 at both ends.  A line that K
does not reach asks nothing.

    python -m tests.campaigns.polygons --count 200
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations
from random import Random
from typing import NamedTuple

from duhem import Criterion, YieldSurface, verify

__all__ = ["Polygon", "drawn", "said"]

Vector = tuple[Fraction, Fraction]
_SQUARE = Fraction(3)


class Polygon(NamedTuple):
    """Lines a . sigma <= b with a flow each, None for associated ones."""

    sides: tuple[tuple[Vector, Fraction, Vector | None], ...]

    def vertices(self) -> list[Vector]:
        """The points of K on two of the lines."""
        found = set[Vector]()
        for ((a, b), p, _), ((c, d), q, _) in combinations(self.sides, 2):
            if area := a * d - b * c:
                point = ((p * d - q * b) / area, (a * q - c * p) / area)
                if all(dot(n, point) <= most for n, most, _ in self.sides):
                    found.add(point)
        return sorted(found)

    def truth(self) -> dict[str, bool]:
        """Whether every flow is normal, and dissipates, where its line bounds K."""
        vertices, answers = self.vertices(), {"normality": True, "dissipation": True}
        for a, b, flow in self.sides:
            for end in (v for v in vertices if dot(a, v) == b):
                slip = flow or a
                answers["dissipation"] &= dot(slip, end) >= 0
                answers["normality"] &= all(dot(slip, (v[0] - end[0], v[1] - end[1])) <= 0 for v in vertices)
        return answers

    def law(self) -> Criterion:
        """As a law of several surfaces."""
        surfaces = [YieldSurface(f"({a})*s + ({b})*t - ({c})", flow and tuple(map(str, flow))) for (a, b), c, flow in self.sides]
        return Criterion("polygon", forces=("s", "t"), pressure=None, surfaces=tuple(surfaces))


def dot(a: Vector, b: Vector) -> Fraction:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1]


def drawn(count: int, seed: int) -> Iterator[Polygon]:
    """Up to three lines around 0, some that pass a vertex and some that miss K; flows normal, nearly so, turned, or opposite."""
    rng = Random(seed)
    square = [((Fraction(x), Fraction(y)), _SQUARE, None) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    for _ in range(count):
        sides = list[tuple[Vector, Fraction, Vector | None]](square)
        for _ in range(rng.randint(1, 3)):
            a = (Fraction(rng.randint(-4, 4)), Fraction(rng.randint(-4, 4)))
            if a == (0, 0):
                continue
            corner = _SQUARE * (abs(a[0]) + abs(a[1]))  # where the line only touches the square
            b = rng.choice([Fraction(rng.randint(1, 8)), corner, corner + 1, Fraction(0)])
            turn = rng.choice([Fraction(0), Fraction(1, 1000), Fraction(-1, 7), Fraction(1), Fraction(-3)])
            way = rng.choice([1, 1, 1, -1])
            flow = (way * (a[0] - turn * a[1]), way * (a[1] + turn * a[0]))
            sides.append((a, b, rng.choice([flow, flow, None])))
        yield Polygon(tuple(sides))


def said(polygon: Polygon) -> dict[str, str]:
    """The verdicts, with how far proofs are to be trusted."""
    found = verify(polygon.law(), claims=("normality", "dissipation"))
    return {r.claim: r.verdict.value + (f" {r.trust.value}" if r.trust else "") for r in found.results}


def main() -> None:
    """Draw, ask, compare and count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    counts, start = Counter[str](), time.process_time()
    for i, polygon in enumerate(drawn(asked.count, asked.seed)):
        truth = polygon.truth()
        for claim, verdict in said(polygon).items():
            word = verdict.partition(" ")[0]
            outcome = "open" if word not in ("proved", "refuted") else "right" if (word == "proved") == truth[claim] else "WRONG"
            counts[f"{outcome} ({verdict})"] += 1
            if outcome != "right":
                print(f"{i} {claim} {verdict}, in truth {truth[claim]}: {polygon.sides[4:]}")
    for outcome, number in sorted(counts.items()):
        print(f"{number:5d} {outcome}")
    print(f"{time.process_time() - start:.0f} s of processor time")


if __name__ == "__main__":
    main()
