"""Places of parameters: leaves of a tree of comparisons, and cells of one parameter, whose ends are plain numbers or roots.

What floating point finds is told by plain numbers: the simplest fraction between two, the roots of short polynomials close to one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import lru_cache, reduce
from math import isqrt, prod
from typing import Any, NamedTuple

import mpmath
import sympy as sp

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.parameter_tree import law_where, opposite, read_comparison
from duhem.proof.kernel.signs import RealRoot, sign_at
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, number, parse

__all__ = [
    "OPEN", "Decided", "Node", "ParameterCell", "Place", "against", "between", "compared", "difference", "is_end",
    "law_at", "leaves", "length", "middle", "narrowed", "order", "share_of", "simplest", "square_root_near", "tree_of", "written_root",
]  # fmt: skip

_MOST_COEFFICIENT, _ALIKE = 300, 1e-6


def simplest(low: Fraction, high: Fraction) -> Fraction:
    """The fraction strictly between that has the least denominator, and among these the least size (Stern 1858, Brocot 1861)."""
    if low < 0 < high:
        return Fraction(0)
    if high <= 0:
        return -simplest(-high, -low)
    whole = low // 1
    if whole + 1 < high:
        return Fraction(whole + 1)
    if low == whole:
        return whole + Fraction(1, 1 / (high - whole) // 1 + 1)
    return whole + 1 / simplest(1 / (high - whole), 1 / (low - whole))


def square_root_near(low: Fraction, high: Fraction) -> RealRoot | None:
    """The root of a polynomial of degree 2 with small coefficients between, if there is one (H. Ferguson, D. Bailey 1992: PSLQ)."""
    found = mpmath.findpoly(float((low + high) / 2), 2, maxcoeff=_MOST_COEFFICIENT, tol=_ALIKE)
    if found is None or len(found) < 3 or isqrt(max(under := found[1] ** 2 - 4 * found[0] * found[2], 0)) ** 2 == under:
        return None  # a fraction, or not real
    return narrowed(tuple(found[::-1]), 2 * low - high, 2 * high - low)


def narrowed(poly: tuple[int, ...], low: Fraction, high: Fraction, bits: int = 40) -> RealRoot | None:
    """The root of a polynomial between two fractions, enclosed to so many binary digits; None where it has not one there."""
    if sign_at(poly, low) * sign_at(poly, high) >= 0:
        return None
    while high - low > Fraction(1, 2**bits):  # SymPy's refine_root did not end for some
        middle = simplest(low + (high - low) / 4, high - (high - low) / 4)
        if (here := sign_at(poly, middle)) == 0:
            return RealRoot.of(middle)
        low, high = (middle, high) if here == sign_at(poly, low) else (low, middle)
    with suppress(NotWritten):
        return RealRoot.read({"polynomial": [str(c) for c in poly], "enclosure": [str(low), str(high)]})
    return None


def written_root(root: RealRoot) -> str:
    """A number as a formula: a fraction, or by a square root as ``3*sqrt(3)/4``; what has neither is not asked."""
    if root.exact:
        return str(root.low)
    c, b, a = root.poly
    sign = 1 if 2 * a * root.low + b > 0 else -1
    part, shift = str(sign * sp.sqrt(b * b - 4 * a * c) / (2 * a)), Fraction(-b, 2 * a)
    return f"{shift} {'-' if part[0] == '-' else '+'} {part.removeprefix('-')}" if shift else part


Node = dict[str, Any]  # of a tree, as a certificate has it
OPEN: Node = {"verdict": "open"}


compared, against = lru_cache(maxsize=4096)(read_comparison), lru_cache(maxsize=4096)(opposite)  # many leaves share comparisons


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
        meets = one.high is not None and one.high == two.low and one.open_high != two.open
        return Place(self.polynomials, {**self.box, apart[0]: Bounds(one.low, two.high, one.open, two.open_high)}) if meets else None


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


class ParameterCell(NamedTuple):
    """The values between two ends, None being no end; ``open`` leaves out the lower one, ``open_high`` the upper one."""

    low: RealRoot | None
    high: RealRoot | None
    open: bool = False
    open_high: bool = False

    @property
    def single(self) -> bool:
        """Whether it is one value."""
        return self.low is not None and self.low == self.high

    def joined(self, other: ParameterCell) -> ParameterCell | None:
        """The cell that is this one and another; None where this does not end where the other begins, or that end is left out of both."""
        meets = self.high is not None and self.high == other.low and not (self.open_high and other.open)
        return self._replace(high=other.high, open_high=other.open_high) if meets else None

    @property
    def bounds(self) -> Bounds:
        """The least interval with fractions for ends in which it is seen to lie."""
        low, high = self.low, self.high
        return Bounds(
            None if low is None else low.low, None if high is None else high.high,
            self.open if low is None or low.exact else True, self.open_high if high is None or high.exact else True,
        )  # fmt: skip

    def where(self, name: str, whole: ParameterCell) -> Iterator[str]:
        """Comparisons that hold in the cell alone, without the ends of the ``whole`` domain."""
        if self.low is not None and (self.low, self.open) != (whole.low, whole.open):
            yield against(_below(name, self.low, not self.open))
        if self.high is not None and (self.high, self.open_high) != (whole.high, whole.open_high):
            yield _below(name, self.high, self.open_high)


def _below(name: str, end: RealRoot, left_out: bool) -> str:
    return f"{name} {'<' if left_out else '<='} {written_root(end)}"


class Decided(NamedTuple):
    """A cell, of one parameter or a place, with what a certificate says of it."""

    cell: Any
    leaf: Node


def order(cell: ParameterCell) -> tuple[bool, Fraction, bool]:
    """By which cells that do not overlap are in order."""
    return cell.low is not None, Fraction(0) if cell.low is None else cell.low.low, cell.open


def tree_of(name: str, cells: Sequence[Decided]) -> Node:
    """The tree of cells that are in order, as a certificate has it: divided near the middle, at fractions before it is at other numbers."""
    ends = [(i, one.cell.high, one.cell.open_high) for i, one in enumerate(cells[:-1], 1) if one.cell.high is not None]
    if not ends:
        return cells[0].leaf
    i, end, left_out = min(ends, key=lambda one: (not one[1].exact, abs(2 * one[0] - len(cells))))
    return {"split": _below(name, end, left_out), "holds": tree_of(name, cells[:i]), "fails": tree_of(name, cells[i:])}
