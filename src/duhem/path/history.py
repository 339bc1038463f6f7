"""What the loading paths of one point or of many leave behind: arrays over knots, as a table, a file, or the start of a further run."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from time import monotonic
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.path.run import Plan
from duhem.projection.result import NOT_SHOWN, Array, Status
from duhem.show.place import AnyPath, parquet_packages, written
from duhem.show.printing import Shown, draw

__all__ = [
    "STATES", "SUMS", "Checkpoint", "Due", "EndedEarly", "H", "Histories", "History", "Interrupted", "LeftDomain", "LeftPrecision",
    "Recorded", "Tabled", "columns", "told_of",
]  # fmt: skip

SUMS = ("multiplier", "psi", "dissipation", "work", "numerical", "balance")
STATES = ("displacement", "slip", "stress", "pressure", *SUMS)  # in the order of the tables' columns


@dataclass(frozen=True, eq=False, repr=False)
class Tabled(Shown, ABC):
    """What is kept of a law at the knots of one path or of many, and its table; ``stress`` (..., o), numbers (...).

    ``forces`` and ``pressure_name`` are the law's names; ``method`` and ``why`` say how it was integrated; ``time`` is in s, or
    counts the steps of a path that is not ``timed``.
    """

    law: str
    forces: tuple[str, ...]
    pressure_name: str | None
    time: Array
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

    printed_by: ClassVar[str] = "duhem.path.picture"

    @abstractmethod
    def columns(self) -> tuple[str, ...]:
        """The names of the table's columns, in order."""

    @abstractmethod
    def to_array(self) -> Array:
        """The table as one array (m, columns)."""

    def to_dict(self) -> dict[str, Array]:
        """Columns by name, as ``pandas.DataFrame`` takes them."""
        return dict(zip(self.columns(), self.to_array().T, strict=True))

    def rows(self) -> Iterator[str]:
        """The lines of the table below its header, one or some at a time."""
        return (",".join(map(repr, row)) + "\n" for row in self.to_array().tolist())

    def to_text(self) -> str:
        """The table as comma-separated text; every number is read back to the last bit."""
        return "".join([",".join(self.columns()), "\n", *self.rows()])

    def to_csv(self, file: AnyPath, *, above: str = "") -> None:
        """Write :meth:`to_text`, under a line ``above`` if one is given.  Raises InputError if the file cannot be written."""
        with written(file) as beside, open(beside, "w", encoding="utf-8", newline="") as stream:
            stream.write((f"{above}\n" if above else "") + ",".join(self.columns()) + "\n")
            stream.writelines(self.rows())

    def to_parquet(self, file: AnyPath) -> None:
        """Write the table as Parquet; MissingExtraError without pyarrow (extra ``parquet``), InputError as :meth:`to_csv`."""
        pyarrow, parquet = parquet_packages()
        with written(file) as beside:
            parquet.write_table(pyarrow.table(self.to_dict()), beside)


@dataclass(frozen=True, eq=False, repr=False)
class Recorded(Tabled):
    """Of a law whose steps are closest points also ``displacement`` and ``slip`` (..., d), with the units of :class:`History`."""

    displacement: Array
    slip: Array

    def columns(self) -> tuple[str, ...]:
        """The names of the table's columns, in order."""
        return columns(self.forces, self.pressure_name)

    def tabled(self) -> list[Array]:
        """The states of which the table has columns, in order."""
        return [getattr(self, name) for name in STATES if name != "pressure" or self.pressure_name]


@dataclass(frozen=True, eq=False, repr=False)
class History(Recorded):
    """The states of a law at the m knots of a path, knot 0 being the start.

    ``displacement`` u, ``slip`` u_in (m, d) in m; ``stress`` sigma (m, d), ``pressure`` sigma_n (m,) in Pa;
    ``multiplier`` lambda >= 0 (m,), accumulated; ``psi`` = u_e . k u_e / 2 (m,) in Pa m, u_e = u - u_in;
    ``dissipation`` the integral of sigma . du_in, ``work`` that of sigma . du, ``numerical`` the sum of du_e . k du_e / 2,
    the energy an implicit step loses, all accumulated from knot 0; ``balance`` the residual of each step,
    d work - d psi - d dissipation - d numerical (Antoni et al. 2007, Eqs. 22-31, isothermal).
    ``forces`` and ``pressure_name`` are the law's names; ``method`` and ``why`` say how it was integrated; ``plan`` is
    the question that was answered, from which :func:`duhem.path.picture.trajectory` finds what lies between the knots.
    """

    plan: Plan | None = field(default=None)

    def __repr__(self) -> str:
        stationary = f", {count} stationary" if (count := self.stationary()) else ""
        return f"<History of {self.law}: {len(self)} knots{stationary}; {self.method}>"

    def __len__(self) -> int:
        return len(self.time)

    def to_array(self) -> Array:
        """The table as one array (m, columns)."""
        return np.column_stack([self.time, *self.tabled()])

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

    def plot(self, file: Any = None, **options: Any) -> Any:
        """Draw stress path, hysteresis loops and energies, into ``file``, a name or a binary stream, if one is given (extra ``plot``).

        ``ax=`` takes the stress path alone, ``axes=`` all three; what was drawn on is returned.  ``law=`` and its parameters
        by name draw another criterion than that of the run.  ``units=("MPa", "mm")`` names those of stress and length, else Pa and m.
        """
        return draw(self, file, **options)


def columns(forces: tuple[str, ...], pressure: str | None) -> tuple[str, ...]:
    """The names of the columns for a law with these forces and this pressure."""
    tails = [force.removeprefix("sigma_") for force in forces]
    named = [f"u_{t}" for t in tails] + [f"u_in_{t}" for t in tails] + list(forces)
    return ("time", *named, *([pressure] if pressure else []), "lambda", "psi", "dissipation", "work", "numerical", "balance")


_ROWS = 65_536  # of a table, written together


@dataclass(frozen=True, eq=False, repr=False)
class Histories(Recorded):
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


def told_of(law: Criterion, **states: Any) -> dict[str, Any]:
    """What a history says of its law, and its ``states``."""
    return {"law": law.name, "forces": law.forces, "pressure_name": law.pressure, **states}


H = TypeVar("H", bound=Tabled)
Checkpoint = tuple[float, Callable[[H], object]]  # seconds, and who is given what is done


class Due:
    """A checkpoint of a run: who is given the history so far, not more often than so many seconds and in a tenth of the time at most."""

    def __init__(self, checkpoint: Checkpoint[Any] | None) -> None:
        self.checkpoint, self.since, self.took = checkpoint, monotonic(), 0.0

    def __call__(self, history: Callable[[], Any]) -> None:
        """Hand over the ``history`` if it is time."""
        if self.checkpoint is not None and (now := monotonic()) - self.since >= max(self.checkpoint[0], 9.0 * self.took):
            self.checkpoint[1](history())
            self.since = monotonic()
            self.took = self.since - now


# -- runs that do not come to the end of their path ----------------------------------------------------------------------


class Interrupted(KeyboardInterrupt):
    """A run that was stopped; ``history`` is what was done, from which :func:`duhem.simulate` goes on.

    Of many points it is the :class:`Histories` of those that are done, none of which may be there yet.
    """

    def __init__(self, history: Any) -> None:
        self.history = history
        points = history is None or isinstance(history, Histories)
        done = f"{0 if history is None else len(history)} points" if points else f"{len(history) - 1} steps"
        super().__init__(f"interrupted after {done}")


class EndedEarly(InputError):
    """A run that cannot go on to the end of its path; ``history`` is what was done before."""

    def __init__(self, history: Any, what: str, remedy: str) -> None:
        self.history = history
        super().__init__(what, where=f"path, step {len(history)}", remedy=remedy)


class LeftPrecision(EndedEarly):
    """A run whose numbers grew beyond double precision."""

    def __init__(self, history: Any, time: float) -> None:
        what = f"stress, slip or energies overflow or underflow on the way to time {time:g}"
        super().__init__(history, what, "use other units, so that the numbers have a moderate size")


class LeftDomain(EndedEarly):
    """A run whose stress leaves a range of forces that the law declares."""

    def __init__(self, history: Any, crossed: str, time: float) -> None:
        what = f"at time {time:g} {crossed}, where {history.law} is not declared"
        super().__init__(history, what, "stay inside the range, or declare a wider one in the law's domain")
