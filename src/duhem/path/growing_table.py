"""A table of many points that grows on disk as they are done: how many are, and how they came out, is noted beside it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

from duhem.path.histories import Histories
from duhem.show import parquet_package
from duhem.show.growing_file import GrowingFile
from duhem.show.place import AnyPath, check_place, written

__all__ = ["GrowingTable"]

_LINES = 65_536  # of a table, turned into Parquet together


class GrowingTable:
    """The table ``file`` of the run ``fingerprint`` with these ``columns``; ``points`` are done.

    Of these ``ended`` ended early, and ``stationary`` slip to stationary points, of which no more is shown.

    ``resume`` goes on with what is there; InputError if that is of another run or damaged.  Use it as a context: what is whole
    stays, and :meth:`finish` puts the table in its place.
    """

    def __init__(self, file: AnyPath, fingerprint: str, columns: tuple[str, ...], resume: bool) -> None:
        self.file = os.fspath(file)
        self._growing = GrowingFile(file, fingerprint, (0, 0, 0), resume)
        self.points, self.ended, self.stationary = self._growing.counts
        if not self._growing.size:
            self._growing.write(",".join(columns) + "\n")

    def __enter__(self) -> GrowingTable:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._growing.close()

    def add(self, part: Histories) -> None:
        """The rows of further points; they are noted once they are all there."""
        for text in part.rows():
            self._growing.write(text)
        self.points += len(part)
        self.ended += part.ended_early()
        self.stationary += part.stationary()
        self._growing.note(self.points, self.ended, self.stationary)

    def finish(self) -> None:
        """The table in its place, as Parquet where its name says so; nothing is left beside it."""
        self._growing.end()
        check_place(self.file)
        if self.file.endswith(".parquet"):
            _to_parquet(self._growing.rows, self.file)
        else:
            os.replace(self._growing.rows, self.file)
        self._growing.drop()


def _to_parquet(rows: Path, file: str) -> None:
    """The same table as Parquet, some rows at a time."""
    pyarrow, parquet = parquet_package.packages()
    with written(file) as place, open(rows, encoding="utf-8") as stream:
        names = stream.readline().rstrip("\n").split(",")
        schema: Any = pyarrow.schema([(name, pyarrow.int64() if name == "point" else pyarrow.float64()) for name in names])
        with parquet.ParquetWriter(place, schema) as writer:
            for lines in _batches(stream):
                columns = zip(*(line.split(",") for line in lines), strict=True)
                numbers = [list(map(int if name == "point" else float, column)) for name, column in zip(names, columns, strict=True)]
                writer.write_table(pyarrow.table(dict(zip(names, numbers, strict=True)), schema=schema))


def _batches(stream: Iterable[str]) -> Iterator[list[str]]:
    lines: list[str] = []
    for line in stream:
        lines.append(line)
        if len(lines) == _LINES:
            yield lines
            lines = []
    if lines:
        yield lines
