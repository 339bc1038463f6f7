"""What is shown of a part of a formula, as a function of the forces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, Sign, StatedDomain, StatedLaw, signs_of_product
from duhem.proof.kernel.term import Term

__all__ = ["Facts", "Over", "Shown", "of_settled_parts", "of_sum"]


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
    parts, signs = (*moving, *constants), 0
    for known in parts:
        signs |= known.sign
    convex = all(known.convex for known in moving)
    quasi = convex or (len(moving) == 1 and moving[0].quasiconvex)
    return Facts(all(known.defined for known in parts), ANY if signs & NEGATIVE and signs & POSITIVE else signs, convex, False, quasi)


Shown = Callable[[Term, StatedDomain], Facts]  # what is shown of a term over a domain, for the rules that ask about parts
Over = Callable[[StatedLaw], StatedDomain]  # the domain of a law, for those that ask about another law


def of_settled_parts(term: Term, domain: StatedDomain, shown: Shown) -> bool:
    """Whether every constant in a formula, and all of which a greatest is taken, has a value, which does not jump with the parameters.

    Who multiplies out, or goes to the end of a parameter's range, would lose sight of that.
    """
    if domain.constant(term):
        return all(part.op != "atan2" for part in term.parts()) and shown(term, domain).defined
    if term.op == "where" and domain.constant(term.args[0]) and domain.decided(term.args[0]) is None:
        return False
    if term.op in ("max", "min", "eigmax") and not all(shown(a, domain).defined for a in term.args):
        return False
    return all(of_settled_parts(a, domain, shown) for a in term.args)
