"""What is shown of a part of a formula, as a function of the forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Sign

__all__ = ["Facts", "of_sum", "signs_of_product"]


@dataclass(frozen=True)
class Facts:
    """What is shown of a part: ``defined`` everywhere, its ``sign``, its curvature in the forces."""

    defined: bool = False
    sign: Sign = ANY
    convex: bool = False
    concave: bool = False
    quasiconvex: bool = False

    @property
    def affine(self) -> bool:
        """Convex and concave."""
        return self.convex and self.concave

    @property
    def nonnegative(self) -> bool:
        """>= 0 everywhere."""
        return not self.sign & NEGATIVE

    @property
    def convex_in_size(self) -> bool:
        """Whether |x| is convex."""
        return self.affine or (self.convex and self.nonnegative) or (self.concave and not self.sign & POSITIVE)

    def negated(self) -> Facts:
        """Of -x."""
        return Facts(self.defined, signs_of_product(self.sign, NEGATIVE), self.concave, self.convex, self.concave)


def of_sum(moving: Sequence[Facts], constants: Sequence[Facts] = ()) -> Facts:
    """Of a sum of parts, ``constants`` among them that depend on no force."""
    parts = (*moving, *constants)
    signs = [known.sign for known in parts if known.sign != ZERO]
    together = reduce(or_, signs or [ZERO])
    if together & NEGATIVE and together & POSITIVE:
        together = ANY
    elif any(not sign & ZERO for sign in signs):
        together &= ~ZERO
    convex, concave = all(known.convex for known in moving), all(known.concave for known in moving)
    quasi = convex or (len(moving) == 1 and moving[0].quasiconvex)
    return Facts(all(known.defined for known in parts), together, convex, concave, quasi)


def signs_of_product(a: Sign, b: Sign) -> Sign:
    """The signs that a product of one of ``a`` and one of ``b`` may have."""
    return _PRODUCTS[a][b]


def _sign_of_products(a: Sign, b: Sign) -> Sign:
    parts = {NEGATIVE: -1, ZERO: 0, POSITIVE: 1}
    found = {s * t for i, s in parts.items() for j, t in parts.items() if a & i and b & j}
    return sum(i for i, s in parts.items() if s in found)


_PRODUCTS = [[_sign_of_products(a, b) for b in range(ANY + 1)] for a in range(ANY + 1)]  # of every two sets of signs
