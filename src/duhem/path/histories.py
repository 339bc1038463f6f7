"""What the loading paths of many points leave behind: arrays over points and kept knots."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from duhem.path.history import STATES, History, Recorded
from duhem.projection.result import NOT_SHOWN, Array, Status
from duhem.show.place import AnyPath, written
from duhem.show.shown import Shown

__all__ = ["Histories"]

_ROWS = 65_536  # of a table, written together


@dataclass(frozen=True, eq=False)
class Histories(Recorded, Shown):
    """The states of a law at N points and the r kept knots of their paths, the first and the last among them.

    ``points`` (N,) and ``knots`` (r,) are the numbers of points and knots, ``time`` (r,).  ``displacement``, ``slip``, ``stress``
    (N, r, d), the other states (N, r), in the units and with the meaning of :class:`duhem.History`; ``balance`` is summed over
    the steps since the kept knot before.  ``status`` (N,) is a :class:`duhem.Status` of the last knot that was ``reached`` (N,):
    ``inaccurate`` or ``failed`` where the next step could not be vouched for or left double precision, ``outside`` where it left
    a range that the law declares; ``stationary`` for a slip where K was asked about and not shown to be convex.  States at knots
    that were not reached are nan.
    """

    points: NDArray[np.intp]
    knots: NDArray[np.intp]
    status: NDArray[np.int8]
    reached: NDArray[np.intp]

    printed_by: ClassVar[str] = "duhem.path.history_sheet"

    def __repr__(self) -> str:
        early = f", {self.ended_early()} ended early" if self.ended_early() else ""
        return f"<Histories of {self.law}: {len(self)} points, {len(self.knots)} knots each{early}; {self.method}>"

    def __len__(self) -> int:
        return len(self.points)

    def ended_early(self) -> int:
        """How many points did not come to the end of their path."""
        return int(np.isin(self.status, (Status.INACCURATE, Status.FAILED, Status.OUTSIDE)).sum())

    def stationary(self) -> int:
        """How many points slip, at a kept knot or before, where K was asked about and not shown to be convex under all their pressures."""
        return int((self.multiplier > 0.0).any(axis=1).sum()) if NOT_SHOWN in self.why else 0

    def history(self, point: int) -> History:
        """One point by itself, by its place among ``points``: the kept knots that it reached."""
        done = self.knots <= self.reached[point]
        states = {name: getattr(self, name)[point][done] for name in STATES}
        named = {name: getattr(self, name) for name in ("law", "forces", "pressure_name", "method", "why", "timed")}
        return History(**named, time=self.time[done], **states)

    def columns(self) -> tuple[str, ...]:
        """The names of the table's columns, in order."""
        return ("point", *super().columns())

    def to_array(self, points: slice = slice(None)) -> Array:
        """The table as one array (N r, columns), point by point and knot by knot; nan at knots that were not reached."""
        n, r = self.multiplier[points].shape
        labels = [np.repeat(self.points[points], r).astype(np.float64), np.tile(self.time, n)]
        return np.column_stack([*labels, *(states[points].reshape(n * r, -1) for states in self.tabled())])

    def to_dict(self) -> dict[str, Array]:
        """Columns by name, as ``pandas.DataFrame`` takes them: a row for each point and knot that was reached."""
        table = self.to_array()
        return dict(zip(self.columns(), table[~np.isnan(table[:, -1])].T, strict=True))

    def rows(self) -> Iterator[str]:
        """The lines of the table below its header, some at a time; knots that were not reached have none."""
        each = max(1, _ROWS // len(self.knots))
        for start in range(0, len(self), each):
            block = self.to_array(slice(start, start + each))
            block = block[~np.isnan(block[:, -1])]
            lines = io.StringIO()
            for number, *row in block.tolist():
                lines.write(f"{int(number)},{','.join(map(repr, row))}\n")
            yield lines.getvalue()

    def to_csv(self, file: AnyPath) -> None:
        """Write the table as comma-separated text, every number to the last bit.  InputError if the file cannot be written."""
        with written(file) as beside, open(beside, "w", encoding="utf-8", newline="") as stream:
            stream.write(",".join(self.columns()) + "\n")
            stream.writelines(self.rows())
