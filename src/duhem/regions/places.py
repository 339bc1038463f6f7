"""Places of parameters: the leaves of a tree of comparisons, each with what is known of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from functools import lru_cache, reduce
from math import prod
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.parameter_tree import law_where, opposite, read_comparison
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from duhem.regions.numbers import simplest

__all__ = ["Node", "Place", "against", "between", "compared", "difference", "is_end", "law_at", "leaves", "length", "middle", "share_of"]

Node = dict[str, Any]  # of a tree, as a certificate has it


@lru_cache(maxsize=4096)
def compared(text: str, names: tuple[str, ...]) -> Term:
    """A comparison as the kernel reads it, which many leaves share."""
    return read_comparison(text, names)


@lru_cache(maxsize=4096)
def against(text: str) -> str:
    """What holds where a comparison does not, found once too."""
    return opposite(text)


def law_at(law: StatedLaw, where: Iterable[str], names: tuple[str, ...]) -> StatedLaw:
    """A law where comparisons of its parameters hold."""
    return reduce(lambda here, text: law_where(here, compared(text, names)), where, law)


def is_end(text: str, names: tuple[str, ...]) -> bool:
    """Whether a comparison is one of a parameter with a number, which ends its range."""
    with suppress(NotWritten):
        return {side.op for side in compared(text, names).args} == {"name", "number"}
    return False


def leaves(holder: Node, key: str = "tree", where: tuple[str, ...] = (), way: str = "") -> Iterator[tuple[str, tuple[str, ...], Node, str]]:
    """Each leaf of a tree in order: the way to it, the comparisons that hold there, and in what and by which key it stands."""
    if "split" not in (node := holder[key]):
        yield way, where, holder, key
        return
    yield from leaves(node, "holds", (*where, node["split"]), way + "0")
    yield from leaves(node, "fails", (*where, against(node["split"])), way + "1")


class Place(NamedTuple):
    """Where a leaf is: the comparisons that hold there, and the range that they leave to each parameter."""

    where: tuple[str, ...]
    box: Mapping[str, Bounds]

    @classmethod
    def of(cls, where: tuple[str, ...], whole: Mapping[str, Bounds]) -> Place:
        """The place where comparisons hold."""
        return cls(where, law_at(StatedLaw((), None, number(0), None, whole, ()), where, tuple(whole)).parameters)

    @property
    def polynomials(self) -> tuple[str, ...]:
        """Those of the comparisons that bound no edge of the box."""
        return tuple(text for text in dict.fromkeys(self.where) if not is_end(text, tuple(self.box)))

    def joined(self, other: Place) -> Place | None:
        """The place that is this one and another, on the same side of the same polynomials; None where they do not meet along one edge."""
        apart = [name for name in self.box if self.box[name] != other.box[name]]
        shared = [text for text in self.polynomials if text in other.polynomials]
        rest = {*self.polynomials, *other.polynomials} - {*shared}
        if not apart and len(rest) == 2 and against(min(rest)) == max(rest):
            return Place(tuple(shared), self.box)
        if len(apart) != 1 or rest:
            return None
        one, two = sorted((self.box[apart[0]], other.box[apart[0]]), key=lambda own: (own.low is not None, own.low))
        if one.high is None or one.high != two.low or one.open_high == two.open:
            return None
        return Place(self.polynomials, {**self.box, apart[0]: Bounds(one.low, two.high, one.open, two.open_high)})


def difference(comparison: str) -> str:
    """A formula that is >= 0, or > 0, where a comparison holds."""
    op = parse(comparison).op
    left, right = (side.strip() for side in comparison.split(op))
    return f"{left} - ({right})" if op.startswith(">") else f"{right} - ({left})"


def share_of(box: Mapping[str, Bounds], whole: Mapping[str, Bounds]) -> Fraction:
    """How much of the whole a box is; a range without an end is measured after x/(1 + |x|)."""
    return prod((length(box[name], own) for name, own in whole.items()), start=Fraction(1))


def length(own: Bounds, whole: Bounds) -> Fraction:
    if whole.single:
        return Fraction(1)
    low, high, first, last = (_along(end, i, None in whole[:2]) for bounds in (own, whole) for i, end in enumerate(bounds[:2]))
    return max((high - low) / (last - first), Fraction(0))


def _along(end: Fraction | None, i: int, endless: bool) -> Fraction:
    return Fraction(2 * i - 1) if end is None else end / (1 + abs(end)) if endless else end


def between(own: Bounds, whole: Bounds, share: Fraction = Fraction(1, 2)) -> Fraction:
    """What lies at a share of the way from one end to the other."""
    endless = None in whole[:2]
    low, high = (_along(end, i, endless) for i, end in enumerate(own[:2]))
    at = low + (high - low) * share
    return at / (1 - abs(at)) if endless else at


def middle(own: Bounds) -> Fraction:
    """A short number well inside of a range."""
    low, high = (between(own, own, Fraction(k, 4)) for k in (1, 3))
    return low if low == high else simplest(low, high)
