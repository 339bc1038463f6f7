"""What a loading path leaves behind: arrays over its knots, as a table, a file, or the start of a further run."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from duhem.path.plan import Plan
from duhem.projection.result import NOT_SHOWN, Array
from duhem.show import parquet_package
from duhem.show.place import write, written
from duhem.show.printing import draw
from duhem.show.shown import Shown

__all__ = ["STATES", "SUMS", "History", "Recorded", "columns"]

SUMS = ("multiplier", "psi", "dissipation", "work", "numerical", "balance")
STATES = ("displacement", "slip", "stress", "pressure", *SUMS)  # in the order of the tables' columns


@dataclass(frozen=True, eq=False)
class Recorded:
    """What is written down of a law at the knots of one path or of many: ``displacement``, ``slip`` and ``stress`` (..., d), others (...).

    ``forces`` and ``pressure_name`` are the law's names; ``method`` and ``why`` say how it was integrated; ``time`` is in s, or
    counts the steps of a path that is not ``timed``.  The states and their units are those of :class:`History`.
    """

    law: str
    forces: tuple[str, ...]
    pressure_name: str | None
    time: Array
    displacement: Array
    slip: Array
    stress: Array
    pressure: Array
    multiplier: Array
    psi: Array
    dissipation: Array
    work: Array
    numerical: Array
    balance: Array
    method: str
    why: str
    timed: bool = field(default=True, kw_only=True)

    def columns(self) -> tuple[str, ...]:
        """The names of the table's columns, in order."""
        return columns(self.forces, self.pressure_name)

    def tabled(self) -> list[Array]:
        """The states of which the table has columns, in order."""
        return [getattr(self, name) for name in STATES if name != "pressure" or self.pressure_name]


@dataclass(frozen=True, eq=False, repr=False)
class History(Recorded, Shown):
    """The states of a law at the m knots of a path, knot 0 being the start.

    ``displacement`` u, ``slip`` u_in (m, d) in m; ``stress`` sigma (m, d), ``pressure`` sigma_n (m,) in Pa;
    ``multiplier`` lambda >= 0 (m,), accumulated; ``psi`` = u_e . k u_e / 2 (m,) in Pa m, u_e = u - u_in;
    ``dissipation`` the integral of sigma . du_in, ``work`` that of sigma . du, ``numerical`` the sum of du_e . k du_e / 2,
    the energy an implicit step loses, all accumulated from knot 0; ``balance`` the residual of each step,
    d work - d psi - d dissipation - d numerical (Antoni et al. 2007, Eqs. 22-31, isothermal).
    ``forces`` and ``pressure_name`` are the law's names; ``method`` and ``why`` say how it was integrated; ``plan`` is
    the question that was answered, from which :func:`duhem.path.trajectory.trajectory` finds what lies between the knots.
    """

    printed_by: ClassVar[str] = "duhem.path.history_sheet"

    plan: Plan | None = field(default=None)

    def __repr__(self) -> str:
        stationary = f", {count} stationary" if (count := self.stationary()) else ""
        return f"<History of {self.law}: {len(self)} knots{stationary}; {self.method}>"

    def __len__(self) -> int:
        return len(self.time)

    def stationary(self) -> int:
        """How many steps slip to a stationary point, on a K that was asked about and not shown to be convex under their pressure."""
        if NOT_SHOWN not in self.why:
            return 0
        slips = (np.diff(self.slip, axis=0) != 0.0).any(axis=1) | (np.diff(self.multiplier) > 0.0)
        if self.plan is not None:
            slips &= ~self.plan.increment.shown_convex()[1 : len(self)]
        return int(slips.sum())

    def remark(self) -> str | None:
        """What nobody vouches for in it, in words; None where there is nothing of the kind."""
        count = self.stationary()
        return f"in {count} of {len(self) - 1} steps {NOT_SHOWN}" if count else None

    def to_array(self) -> Array:
        """The table as one array (m, columns)."""
        return np.column_stack([self.time, *self.tabled()])

    def to_dict(self) -> dict[str, Array]:
        """Columns by name, as ``pandas.DataFrame`` takes them."""
        return dict(zip(self.columns(), self.to_array().T, strict=True))

    def to_text(self) -> str:
        """The table as comma-separated text; every number is read back to the last bit."""
        return "".join(",".join(row) + "\n" for row in [self.columns(), *(map(repr, row) for row in self.to_array().tolist())])

    def to_csv(self, file: str | os.PathLike[str], *, above: str = "") -> None:
        """Write :meth:`to_text`, under a line ``above`` if one is given.  Raises InputError if the file cannot be written."""
        write(file, (f"{above}\n" if above else "") + self.to_text())

    def to_parquet(self, file: str | os.PathLike[str]) -> None:
        """Write the table as Parquet; MissingExtraError without pyarrow (extra ``parquet``), InputError as :meth:`to_csv`."""
        pyarrow, parquet = parquet_package.packages()
        with written(file) as beside:
            parquet.write_table(pyarrow.table(self.to_dict()), beside)

    def plot(self, file: Any = None, **options: Any) -> Any:
        """Draw stress path, hysteresis loops and energies, into ``file``, a name or a binary stream, if one is given (extra ``plot``).

        ``ax=`` takes the stress path alone, ``axes=`` all three; what was drawn on is returned.  ``law=`` and its parameters
        by name draw another criterion than that of the run.
        """
        return draw(self, file, **options)


def columns(forces: tuple[str, ...], pressure: str | None) -> tuple[str, ...]:
    """The names of the columns for a law with these forces and this pressure."""
    tails = [force.removeprefix("sigma_") for force in forces]
    named = [f"u_{t}" for t in tails] + [f"u_in_{t}" for t in tails] + list(forces)
    return ("time", *named, *([pressure] if pressure else []), "lambda", "psi", "dissipation", "work", "numerical", "balance")
