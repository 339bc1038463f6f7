"""Cells of one parameter, of which an end may be the root of a polynomial, and the tree that has them for leaves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.real_root import RealRoot
from duhem.regions.numbers import written_root
from duhem.regions.places import Node, against

__all__ = ["Decided", "ParameterCell", "order", "tree_of"]


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

    def meets(self, after: ParameterCell) -> bool:
        """Whether another cell begins where this one ends, nothing between them left out; the end is told in the same way."""
        return self.high is not None and self.high == after.low and not (self.open_high and after.open)

    def joined(self, other: ParameterCell) -> ParameterCell | None:
        """The cell that is this one and another; None where this does not end where the other begins."""
        return self._replace(high=other.high, open_high=other.open_high) if self.meets(other) else None

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


@dataclass(frozen=True)
class Decided:
    """A cell with what the kernel confirmed of it; ``row`` is how a certificate says so, None where it is open."""

    cell: ParameterCell
    verdict: str
    row: Mapping[str, Any] | None = None

    @property
    def leaf(self) -> Node:
        """As a certificate has it."""
        return {"verdict": self.verdict, **(self.row or {})}


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
