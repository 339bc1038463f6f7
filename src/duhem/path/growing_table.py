"""A table of many points that grows on disk as they are done, and what is noted beside it so that a killed run can go on.

The rows go into FILE.partial.rows.  FILE.partial begins with the mark of the run; each of its further lines says, after some
points, how many are done and how many of them ended early, how many bytes of rows they take, and the sum over these bytes.
Whenever the process dies, the last whole line holds: what stands behind its bytes is cut off, and the run goes on from there.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from duhem.errors import InputError, MissingExtraError
from duhem.path.histories import Histories
from duhem.path.kept_part import ANOTHER, DAMAGED, MARK, UNREADABLE, beside, check_kept
from duhem.show.place import AnyPath, check_place, written

__all__ = ["GrowingTable", "check_growing"]

_PIECE = 1 << 22  # bytes read together
_LINES = 65_536  # of a table, turned into Parquet together


def check_growing(file: AnyPath, inputs: Iterable[str] = ()) -> None:
    """InputError where the rows of the table ``file`` cannot grow beside it."""
    inputs = tuple(inputs)
    check_kept(file, inputs)
    check_place(_rows(file), inputs)
    if _rows(file).exists() and not beside(file).exists():
        raise InputError("this is no part of a run, and rows would go there", where=f"{_rows(file)}", remedy="move it away")


class GrowingTable:
    """The table ``file`` of the run ``fingerprint`` with these ``columns``; ``points`` are done, ``ended`` of them early.

    ``resume`` goes on with what is there; InputError if that is of another run or damaged.  Use it as a context: what is whole
    stays, and :meth:`finish` puts the table in its place.
    """

    def __init__(self, file: AnyPath, fingerprint: str, columns: tuple[str, ...], resume: bool) -> None:
        self.file = os.fspath(file)
        self.points = self.ended = 0
        self._sum = hashlib.sha256()
        self._bytes = 0
        if not (resume and self._recalled(fingerprint)):
            beside(file).write_text(f"{MARK}{fingerprint}\n", encoding="utf-8")
            _rows(file).write_bytes(b"")
        self._stream: BinaryIO = open(_rows(file), "r+b")  # noqa: SIM115 (closed by __exit__)
        self._stream.truncate(self._bytes)
        self._stream.seek(self._bytes)
        if not self._bytes:
            self._write(",".join(columns) + "\n")

    def __enter__(self) -> GrowingTable:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._stream.close()

    def add(self, part: Histories) -> None:
        """The rows of further points; they are noted once they are all there."""
        for text in part.rows():
            self._write(text)
        self._stream.flush()
        self.points += len(part)
        self.ended += part.ended_early()
        with open(beside(self.file), "a", encoding="utf-8") as notes:
            notes.write(f"{self.points} {self.ended} {self._bytes} {self._sum.hexdigest()}\n")

    def finish(self) -> None:
        """The table in its place, as Parquet where its name says so; nothing is left beside it."""
        self._stream.close()
        check_place(self.file)
        if self.file.endswith(".parquet"):
            _to_parquet(_rows(self.file), self.file)
            _rows(self.file).unlink()
        else:
            os.replace(_rows(self.file), self.file)
        beside(self.file).unlink()

    def _write(self, text: str) -> None:
        data = text.encode()
        self._stream.write(data)
        self._sum.update(data)
        self._bytes += len(data)

    def _recalled(self, fingerprint: str) -> bool:
        """Whether there is something to go on with, which is looked at byte by byte."""
        place = beside(self.file)
        try:
            mark, *lines = place.read_text(encoding="utf-8").split("\n")[:-1]  # what no end of line follows was cut off
            rows = open(_rows(self.file), "rb")  # noqa: SIM115 (closed below)
        except (FileNotFoundError, ValueError):
            return False  # nothing there, or not even the mark was whole
        except OSError:
            raise InputError("the part of a run cannot be read", where=f"{place}", remedy=UNREADABLE) from None
        with rows:
            if mark != f"{MARK}{fingerprint}":
                raise InputError("this is the part of another run", where=f"{place}", remedy=ANOTHER)
            if not lines:
                return False
            try:
                points, ended, size, noted = lines[-1].split(" ")
                self.points, self.ended, self._bytes = int(points), int(ended), int(size)
            except ValueError:
                raise InputError("the part of a run is damaged", where=f"{place}", remedy=DAMAGED) from None
            left = self._bytes
            while left > 0 and (piece := rows.read(min(left, _PIECE))):
                self._sum.update(piece)
                left -= len(piece)
            if left or self._sum.hexdigest() != noted:
                raise InputError("the part of a run is damaged", where=f"{_rows(self.file)}", remedy=DAMAGED)
        return True


def _rows(file: AnyPath) -> Path:
    return Path(f"{beside(file)}.rows")


def _to_parquet(rows: Path, file: str) -> None:
    """The same table as Parquet, some rows at a time."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingExtraError("pyarrow", "parquet") from None
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
