"""What is shown of a part of a formula, as a function of the forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, Sign, StatedDomain, signs_of_product
from duhem.proof.kernel.term import Term

__all__ = ["Facts", "Shown"]


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


Shown = Callable[[Term, StatedDomain], Facts]  # what is shown of a term over a domain, for the rules that ask about parts
