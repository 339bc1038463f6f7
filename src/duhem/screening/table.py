"""The table of a campaign: rows grow beside it in the order in which they are done, and are sorted when all are there."""

from __future__ import annotations

import csv
import os
from array import array
from collections.abc import Iterable, Iterator
from itertools import islice
from time import monotonic
from typing import Any

from duhem.errors import InputError
from duhem.screening.campaign import Campaign, VerdictLine, lines_of, number_of
from duhem.show.place import DAMAGED, AnyPath, GrowingFile, beside, check_growing, check_parquet, check_place, parquet_packages, written
from duhem.version import __version__

__all__ = ["GrowingLines", "check_table", "finished_csv", "read_lines", "stands", "write_table"]

_PAUSE = 1.0  # s: what is done is noted so often
_LINES = 8_192  # of a table, turned into Parquet together
_MAY_LACK = ("verdict", "method", "trust", "witness", "error")


def check_table(file: AnyPath, inputs: Iterable[str] = ()) -> None:
    """InputError or MissingExtraError, before a long run, where the table cannot go there."""
    name, inputs = os.fspath(file), tuple(inputs)
    if not name.endswith((".csv", ".parquet")):
        raise InputError("the table is neither .csv nor .parquet", where=name, remedy="end its name in .csv or .parquet")
    if name.endswith(".parquet"):
        check_parquet()
    check_place(name, inputs)
    check_growing(name, inputs)


class GrowingLines(GrowingFile):
    """What is done of a campaign, beside its table ``file``; ``resume`` goes on with it.

    Use it as a context: what is done is kept, and dropped with :meth:`drop` when the table is written.
    """

    def __init__(self, campaign: Campaign, file: AnyPath, resume: bool) -> None:
        super().__init__(file, campaign.fingerprint, (0,), resume, asked="campaign")
        self._places = array("q", [-1]) * (len(campaign) + 1)
        self.done, self._noted = 0, monotonic()
        with open(self.rows, "rb") as rows:
            while (at := rows.tell()) < self.size:
                self._found(number_of(rows.readline().decode()), at)

    def missing(self) -> Iterator[range]:
        """The rows that are not done."""
        first = 1
        for number in range(1, len(self._places) + 1):
            if number == len(self._places) or self._places[number] >= 0:
                yield range(first, number)
                first = number + 1

    def add(self, text: str) -> None:
        """A row that is done; every second what is there is noted."""
        self._found(number_of(text), self.size)
        self.write(f"{text}\n")
        if monotonic() - self._noted > _PAUSE:
            self.keep()

    def keep(self) -> None:
        """What is done so far stays, whatever happens."""
        self.note(self.done)
        self._noted = monotonic()

    def lines(self) -> Iterator[VerdictLine]:
        """All lines, sorted by row and claim, once every row is done."""
        with open(self.rows, "rb") as rows:
            for place in self._places[1:]:
                rows.seek(place)
                yield from lines_of(rows.readline().decode())

    def drop(self) -> None:
        """Leave nothing beside the table."""
        self.end()
        super().drop()

    def _found(self, number: int, at: int) -> None:
        if not 0 < number < len(self._places) or self._places[number] >= 0:
            raise InputError("the file of an interrupted run is damaged", where=f"{self.rows}", remedy=DAMAGED)
        self._places[number] = at
        self.done += 1


def write_table(file: AnyPath, lines: Iterator[VerdictLine], campaign: Campaign) -> None:
    """The table in its place, whole or not at all; as Parquet, its metadata say what was asked and by which version."""
    name = os.fspath(file)
    with written(name) as place:
        if name.endswith(".parquet"):
            _to_parquet(place, lines, campaign)
            return
        with open(place, "w", encoding="utf-8", newline="") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(VerdictLine._fields)
            writer.writerows(lines)


def _to_parquet(place: str, lines: Iterator[VerdictLine], campaign: Campaign) -> None:
    pyarrow, parquet = parquet_packages()
    kinds = {"row": pyarrow.int64(), "steps": pyarrow.int64(), "seconds": pyarrow.float64()}
    told = {"duhem": __version__, "asked": campaign.inquiry.told(), "rows": f"{len(campaign)}", "campaign": campaign.fingerprint}
    fields: Any = [(name, kinds.get(name, pyarrow.string())) for name in VerdictLine._fields]
    schema = pyarrow.schema(fields, metadata=told)
    with parquet.ParquetWriter(place, schema) as writer:
        while part := list(islice(lines, _LINES)):
            columns = [list(column) for column in zip(*part, strict=True)]
            writer.write_table(pyarrow.table(dict(zip(VerdictLine._fields, columns, strict=True)), schema=schema))


def stands(file: AnyPath, campaign: Campaign) -> bool:
    """Whether the table of this campaign is there, whole, and no part of a run beside it.  InputError where another's is.

    A Parquet table says of which campaign it is, which one in CSV cannot.
    """
    name = os.fspath(file)
    if not name.endswith(".parquet") or not _finished(name):
        return False
    if _told(name).get(b"campaign", b"").decode() != campaign.fingerprint:
        remedy = "use another name for the table, or remove --resume to overwrite it"
        raise InputError("this is the table of another campaign", where=name, remedy=remedy)
    return True


def finished_csv(file: AnyPath) -> bool:
    """Whether a table in CSV is there, and no part of a run beside it: of what was asked it says nothing, and all is asked anew."""
    return os.fspath(file).endswith(".csv") and _finished(os.fspath(file))


def _finished(name: str) -> bool:
    return os.path.exists(name) and not beside(name).exists()


def _told(name: str) -> dict[bytes, bytes]:
    """What the metadata of a Parquet table say."""
    _, parquet = parquet_packages()
    try:
        return parquet.read_schema(name).metadata or {}
    except (OSError, ValueError):
        return {}


def read_lines(file: AnyPath) -> Iterator[VerdictLine]:
    """The lines of a finished table, CSV or Parquet.  InputError where it is none."""
    name = os.fspath(file)
    try:
        for line in _from_parquet(name) if name.endswith(".parquet") else _from_csv(name):
            yield VerdictLine(**line | {"row": int(line["row"]), "steps": int(line["steps"]), "seconds": float(line["seconds"])})
    except (OSError, ValueError, TypeError, KeyError, csv.Error) as fault:
        reason = getattr(fault, "strerror", None) or "it has no lines of row, law, parameters, claim and verdict"
        raise InputError(
            f"this is not the table of a campaign: {reason}", where=name, remedy="give a table that duhem campaign has written"
        ) from None


def _from_csv(name: str) -> Iterator[dict[str, Any]]:
    with open(name, encoding="utf-8", newline="") as stream:
        for line in csv.DictReader(stream, strict=True):
            yield {key: value or None if key in _MAY_LACK else value for key, value in line.items()}


def _from_parquet(name: str) -> Iterator[dict[str, Any]]:
    _, parquet = parquet_packages()
    with open(name, "rb") as stream:
        for batch in parquet.ParquetFile(stream).iter_batches(_LINES):
            yield from batch.to_pylist()
