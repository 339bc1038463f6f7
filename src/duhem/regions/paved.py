"""The values of several parameters for which a claim holds, as a frozen value: the leaves of a tree of comparisons."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice, product
from typing import Any

import numpy as np

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.constant_value import holds
from duhem.proof.kernel.parameter_tree import ends
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from duhem.regions.asked import constraints_on
from duhem.regions.places import Node, Place, between, is_end, leaves
from duhem.regions.result import FoundRegion
from duhem.regions.seen import met

__all__ = ["PavedRegion"]

_MOST_SAMPLES = 400
_SHARES = tuple(Fraction(k, 16) for k in (8, 4, 12, 2, 14, 6, 10, 1, 15))
_MOST_POINTS = 10_000
_MOST_PARTS = 6  # of a condition for people


@dataclass(frozen=True, repr=False)
class PavedRegion(FoundRegion):
    """The region of several parameters: a ``tree`` of comparisons with what the kernel confirmed of its leaves, over the ``whole`` box.

    It was ``stopped`` where the search was interrupted.  :func:`duhem.region` goes on with its certificate.
    """

    tree: Node
    whole: Mapping[str, Bounds]
    stopped: bool = False

    @cached_property
    def known(self) -> list[tuple[Place, Node]]:
        """The place of each leaf with what a certificate says of it, in order; those outside of the domain are none."""
        found = ((Place.of(where, self.whole), holder[key]) for _, where, holder, key in leaves({"tree": self.tree}))
        return [(place, leaf) for place, leaf in found if leaf["verdict"] != "outside"]

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """The constraints of the law on these parameters alone, which bound the domain too, but for those that bound the whole box."""
        return tuple(text for text in constraints_on(self.criterion, self.parameters)[0] if not is_end(text, self.parameters))

    @property
    def everything(self) -> Place:
        """The whole domain as a place."""
        return Place((), self.whole)

    def box(self, cell: Place) -> Mapping[str, Bounds]:
        """The range of each parameter in a place."""
        return cell.box

    def size(self, cell: Place) -> Fraction:
        """How much of the whole a place is: of one on sides of polynomials, or under conditions, the share of many points."""
        size, bounds = super().size(cell), (*cell.polynomials, *self.conditions)
        if bounds:
            n = int(_MOST_POINTS ** (1 / len(self.whole)))
            shares = [Fraction(2 * k + 1, 2 * n) for k in range(n)]
            each = [[float(between(cell.box[name], own, share)) for share in shares] for name, own in self.whole.items()]
            points = dict(zip(self.whole, map(np.ravel, np.meshgrid(*each)), strict=True))
            size *= Fraction(int(np.sum(met(bounds, points))), n ** len(each))
        return size

    def percentage(self, verdict: str) -> str:
        """The same for people."""
        sampled = self.conditions or any(place.polynomials for place, _ in self.known)
        return f"{'about ' if sampled else ''}{super().percentage(verdict)}"

    @property
    def proved(self) -> str:
        """Where the claim is proved, for people: how much of the domain that is, where the condition is long."""
        shares = f"{self.percentage('proved')} and refuted for {self.percentage('refuted')} of the domain"
        return super().proved if len(self.stretches("proved")) <= _MOST_PARTS else shares

    def relations(self, cell: Place, with_domain: bool = True) -> list[str]:
        """The same as :meth:`comparisons`, with an equation in the place of two that leave one value; none for the whole domain."""
        if not cell.polynomials and cell.box == self.whole:
            return []
        said, equal = self.comparisons(cell), " == " if with_domain else " = "
        both = {text: text.replace(" >= ", " <= ") for text in said if " >= " in text and text.replace(" >= ", " <= ") in said}
        kept = {*self.comparisons(cell, with_domain), *both}
        return [text.replace(" >= ", equal) if text in both else text for text in said if text in kept and text not in both.values()]

    def comparisons(self, cell: Place, with_domain: bool = True) -> list[str]:
        """Those that hold in a place, with the ends of the domain and the conditions of the law or without."""
        said = list[str]()
        for name, own in cell.box.items():
            known = () if with_domain else (*ends(name, self.whole[name]),)
            said += [end for end in ends(name, own) if end not in known]
        said += self.conditions if with_domain else ()
        return [*said, *cell.polynomials]

    def sample(self, cell: Place) -> dict[str, Fraction]:
        """An exact point in a place; none where none of those that are tried lies in it."""
        comparisons = [parse(text) for text in (*cell.polynomials, *self.conditions)]
        for shares in islice(product(_SHARES, repeat=len(self.parameters)), _MOST_SAMPLES):
            point = {name: between(cell.box[name], own, share) for (name, own), share in zip(self.whole.items(), shares, strict=True)}
            here = {Term("name", name=name): number(x) for name, x in point.items()}
            with suppress(NotWritten):  # a root or an exponential there is no fraction
                if all(holds(c.put(here)) for c in comparisons):
                    return point
        return {}

    def written(self) -> dict[str, Any]:
        """The tree of comparisons that a certificate has."""
        return self.tree
