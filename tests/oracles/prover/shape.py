"""What is proved of a part of a formula, as a function of the forces, and by which theorems."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Curvature", "total", "used"]


@dataclass(frozen=True)
class Curvature:
    """Facts proved about a node as a function of the forces; a flag left False says nothing.

    ``nonnegative`` and ``nonpositive`` hold for all forces and parameters; ``rules`` are the theorems used.
    """

    constant: bool = False
    convex: bool = False
    concave: bool = False
    quasiconvex: bool = False
    nonnegative: bool = False
    nonpositive: bool = False
    rules: tuple[str, ...] = ()

    @property
    def affine(self) -> bool:
        """Both convex and concave."""
        return self.convex and self.concave

    @property
    def by_a_matrix(self) -> bool:
        """Whether the matrix of a quadratic form was looked at, which is more than composition."""
        return any("quadratic" in rule for rule in self.rules)

    def negated(self) -> Curvature:
        """Facts of the opposite."""
        return Curvature(self.constant, self.concave, self.convex, self.concave, self.nonpositive, self.nonnegative, self.rules)


def used(*shapes: Curvature, rule: str = "") -> tuple[str, ...]:
    """The theorems on which several parts rest, each once, and one more."""
    return tuple(dict.fromkeys([r for s in shapes for r in s.rules] + ([rule] if rule else [])))


def total(parts: Sequence[Curvature]) -> Curvature:
    """Facts of a sum of such parts."""
    one = [shape for shape in parts if not shape.constant]
    convex = all(shape.convex for shape in parts)
    quasi = convex or (len(one) == 1 and one[0].quasiconvex)
    return Curvature(convex=convex, quasiconvex=quasi, nonnegative=all(shape.nonnegative for shape in parts), rules=used(*parts))
