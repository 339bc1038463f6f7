"""Sums of |x|, <x>+, <x>- and multiples of one x, which are functions of x with one bend.

phi(x) = right x for x >= 0, left x for x <= 0: |x| - k x = (1 - k) <x>+ + (1 + k) <x>- is convex and, for |k| <= 1, >= 0.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import sympy as sp

from duhem.expression import Neg, Pos

__all__ = ["Bend", "bends"]


@dataclass(frozen=True)
class Bend:
    """phi, by the x that it depends on and its slopes on either side."""

    x: sp.Expr
    right: sp.Expr
    left: sp.Expr

    def plus(self, slope: sp.Expr) -> Bend:
        """With a multiple of x added."""
        return replace(self, right=self.right + slope, left=self.left + slope)

    def nonnegative(self, sign: Callable[[sp.Expr], bool]) -> bool:
        """Whether left <= 0 <= right, ``sign`` telling of constants whether they are >= 0."""
        return sign(self.right) and sign(-self.left)

    def convex(self, sign: Callable[[sp.Expr], bool], convex: bool, concave: bool) -> bool:
        """Whether phi(x) is, x being ``convex`` or ``concave`` or, if both, affine."""
        if not (convex or concave) or not sign(self.right - self.left):
            return False
        return (convex and concave) or (convex and sign(self.left)) or (concave and sign(-self.right))


def bends(total: sp.Expr, forces: Collection[sp.Symbol]) -> tuple[list[Bend], sp.Expr]:
    """The bends of a sum, and what is left of it: multiples of one x are taken to its bend if it is the only one."""
    found, rest = dict[sp.Expr, Bend](), sp.S.Zero
    for term in sp.Add.make_args(total):
        scale, part = term.as_independent(*forces, as_Add=False)
        if not isinstance(part, sp.Abs | Pos | Neg):
            rest += term
            continue
        x, way = part.args[0], 1
        if -x in found:
            x, way = -x, -1
        right, left = (0 if isinstance(part, Neg) else scale, 0 if isinstance(part, Pos) else -scale)[::way]
        known = found.get(x, Bend(x, sp.S.Zero, sp.S.Zero))
        found[x] = Bend(x, known.right + way * right, known.left + way * left)
    for x, bend in found.items():  # what is written as a multiple of x
        for scale, term in [(term.as_independent(*forces, as_Add=False), term) for term in sp.Add.make_args(rest)]:
            if scale[1] == x:
                found[x], rest = (bend := bend.plus(scale[0])), rest - term
    if len(found) == 1 and (slope := _multiple(rest, next(iter(found)), forces)) is not None:
        return [bend.plus(slope) for bend in found.values()], sp.S.Zero
    return list(found.values()), rest


def _multiple(rest: sp.Expr, x: sp.Expr, forces: Collection[sp.Symbol]) -> sp.Expr | None:
    """c where rest = c x, for a polynomial x."""
    if rest.is_zero:
        return sp.S.Zero
    slopes = [(rest.diff(f), x.diff(f)) for f in sorted(forces, key=str) if x.has(f)] if x.is_polynomial(*forces) else []
    own = next((over / under for over, under in slopes if under.is_number and under), None)
    return None if own is None or own.free_symbols & set(forces) or sp.expand(rest - own * x) != 0 else own
