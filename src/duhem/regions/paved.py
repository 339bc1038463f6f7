"""The values of several parameters for which a claim holds, as a frozen value: the leaves of a tree of comparisons."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.constant_value import holds
from duhem.proof.kernel.domain import gap
from duhem.proof.kernel.parameter_tree import SCHEMA, ends
from duhem.proof.kernel.term import Term, number
from duhem.regions.paving import Known, Place, Tree, between, compared, share_of
from duhem.regions.result import FoundRegion, RegionCell
from duhem.regions.suggested import value_of

__all__ = ["PavedRegion"]

_MOST_SAMPLES = 400
_SHARES = tuple(Fraction(k, 16) for k in (8, 4, 12, 2, 14, 6, 10, 1, 15))
_MOST_JOINED, _MOST_POINTS = 100, 10_000
_MOST_PARTS = 6  # of a condition for people


@dataclass(frozen=True, repr=False)
class PavedRegion(FoundRegion):
    """The region of several parameters: a ``tree`` of comparisons with what the kernel confirmed of its leaves, over the ``whole`` box.

    ``conditions`` of the law on these parameters alone bound the domain too.  ``steps`` were spent on it; it was ``stopped`` where the
    search was interrupted.  :func:`duhem.region` goes on with its certificate.
    """

    tree: Tree
    whole: Mapping[str, Bounds]
    conditions: tuple[str, ...] = ()
    steps: int = 0
    stopped: bool = False

    @property
    def known(self) -> list[Known]:
        """What is known of each leaf, in order."""
        return [self.tree.leaves[way] for way in sorted(self.tree.leaves)]

    @property
    def open_share(self) -> float:
        """How much of the domain is open, from 0 to 1, a leaf on one side of a polynomial taken for its whole box."""
        return float(sum((share_of(place.box, self.whole) for place, own in self.places if own == "open"), Fraction(0)))

    def share(self, verdict: str) -> float:
        """How much of the domain has a verdict, from 0 to 1: of boxes exactly, on sides of polynomials by many points."""
        if any(place.polynomials for place, _ in self.places):
            points = self._points()
            verdicts = self.at(points)
            return float(np.sum(verdicts == verdict) / max(np.sum(verdicts != ""), 1))
        return float(sum((share_of(place.box, self.whole) for place, own in self.places if own == verdict), Fraction(0)))

    def _points(self) -> dict[str, NDArray[np.float64]]:
        """Many points of the whole, evenly in each range."""
        each = [
            [float(between(own, own, Fraction(2 * k + 1, 2 * n))) for k in range(n)]
            for own, n in zip(self.whole.values(), [int(_MOST_POINTS ** (1 / len(self.whole)))] * len(self.whole), strict=True)
        ]
        return dict(zip(self.whole, map(np.ravel, np.meshgrid(*each)), strict=True))

    @cached_property
    def places(self) -> tuple[tuple[Place, str], ...]:
        """Each place with one verdict on all of it, with the verdict: leaves, those joined that together are one box."""
        found = [(Place.of(self.tree.where(way), self.whole), self.tree.leaves[way].verdict) for way in sorted(self.tree.leaves)]
        i = 0
        while i < len(found) and len(found) <= _MOST_JOINED:
            (one, verdict), joined = found[i], None
            for k in range(i + 1, len(found)):
                if found[k][1] == verdict and (joined := one.joined(found[k][0])) is not None:
                    found[i : i + 1], found[k : k + 1], i = [(joined, verdict)], [], -1
                    break
            i += 1
        return tuple(found)

    @property
    def proved(self) -> str:
        """Where the claim is proved, for people: how much of the domain that is, where the condition is long."""
        parts = sum(verdict == "proved" for _, verdict in self.places)
        shares = f"{self.share('proved'):.2%} and refuted for {self.share('refuted'):.2%} of the domain"
        return super().proved if parts <= _MOST_PARTS else shares

    def _told(self, *, with_domain: bool) -> str:
        parts = [self.between(place, with_domain) for place, verdict in self.places if verdict == "proved"]
        if not parts or "" in parts:
            return "true" if parts else "false"
        return " or ".join(f"({part})" if len(parts) > 1 and " and " in part else part for part in parts)

    def between(self, place: Place, with_domain: bool) -> str:
        """A place in words; "" for the whole domain."""
        said = list[str]()
        for name, own in place.box.items():
            known = () if with_domain else (*ends(name, self.whole[name]),)
            said += [end for end in ends(name, own) if end not in known]
        said += Place(self.conditions, self.whole).polynomials if with_domain else ()
        return " and ".join([*said, *place.polynomials])

    @property
    def over(self) -> str:
        """The domain asked for, as comparisons."""
        return self.between(Place((), self.whole), True) or "true"

    @property
    def cells(self) -> tuple[RegionCell, ...]:
        """The leaves in order."""
        return tuple(map(self._shown, sorted(self.tree.leaves)))

    def _shown(self, way: str) -> RegionCell:
        place, leaf = Place.of(self.tree.where(way), self.whole), self.tree.leaves[way]
        witness = {"rule": leaf.row["rule"], **leaf.row["evidence"]} if leaf.verdict == "refuted" and leaf.row is not None else None
        sample = {name: str(x) for name, x in (self.sample(place) or {}).items()}
        return RegionCell(self.between(place, True) or "true", leaf.verdict, "checked" if leaf.row else None, sample, witness)

    def at(self, points: Mapping[str, NDArray[np.float64]]) -> NDArray[np.str_]:
        """The verdict at many points, in floating point; "" where none is, outside of the domain."""
        shape = next(iter(points.values())).shape
        found = np.full(shape, "", dtype="<U7")
        flat = {name: np.ravel(x) for name, x in points.items()}
        for place, verdict in self.places:
            inside = np.ones(shape, dtype=bool)
            for text in filter(None, self.between(place, True).split(" and ")):
                comparison = compared(text, self.parameters)
                value = value_of(gap(comparison), flat).reshape(shape)
                inside &= value >= 0 if len(comparison.op) == 2 else value > 0
            found[inside] = verdict
        return found

    def sample(self, place: Place) -> dict[str, Fraction] | None:
        """An exact point in a place; None where none of those that are tried lies in it."""
        comparisons = [compared(text, self.parameters) for text in (*place.polynomials, *self.conditions)]
        for shares in islice(product(_SHARES, repeat=len(self.parameters)), _MOST_SAMPLES):
            point = {name: between(place.box[name], own, share) for (name, own), share in zip(self.whole.items(), shares, strict=True)}
            here = {Term("name", name=name): number(x) for name, x in point.items()}
            if all(holds(c.put(here)) for c in comparisons):
                return point
        return None

    def written(self) -> dict[str, Any]:
        """What a certificate has of the leaves."""
        return {"schema": SCHEMA, "parameters": list(self.parameters), "tree": self.tree.written(), "steps": self.steps}
