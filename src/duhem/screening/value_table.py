"""Tables of parameter values, CSV or Parquet, as text: a cell is what is written, so that decimals stay exact.

A line that is malformed stays a line: it is the fault of its row, and the rows beside it are asked.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

from duhem.errors import InputError, MissingExtraError
from duhem.expression.spelling import spelled
from duhem.path.table_file import cells_of, header_of
from duhem.show import parquet_package

__all__ = ["cells_in_lines"]

_MOST_CHARACTERS = 100_000  # of a line
_ROWS = 8_192  # of Parquet, read together


def cells_in_lines(file: str) -> tuple[tuple[str, ...], bytes]:
    """The names of the columns, and a line for each row, its cells between tabs.

    InputError where there is no header or no row, or the file cannot be read.  Blank lines of CSV and those that begin with # are
    left out.
    """
    try:
        names, text = _parquet(file) if file.endswith(".parquet") else _csv(file)
    except (InputError, MissingExtraError):
        raise
    except UnicodeDecodeError:
        raise InputError("this is not text in UTF-8", where=file, remedy="write the table as CSV") from None
    except (OSError, ValueError) as fault:
        reason = getattr(fault, "strerror", None) or " ".join(str(fault).split())[:200]
        raise InputError(f"the table cannot be read: {reason}", where=file, remedy="check its name and kind") from None
    if not text:
        raise InputError("the table has no rows", where=file, remedy="give a header and at least one row")
    return names, text


def _csv(file: str) -> tuple[tuple[str, ...], bytes]:
    lines = bytearray()
    names: tuple[str, ...] = ()
    with open(file, encoding="utf-8-sig") as stream:
        for number, text in enumerate(iter(lambda: stream.readline(_MOST_CHARACTERS + 1), ""), 1):
            place = f"{file}:{number}"
            if len(text) > _MOST_CHARACTERS:
                raise InputError("this is no line of a table", where=place, remedy="write the table as CSV")
            if not text.strip() or text.lstrip().startswith("#"):
                continue
            if not names:
                names = tuple(header_of(cells_of(text.rstrip("\r\n"), place), place))
                continue
            try:
                cells = cells_of(text.rstrip("\r\n"), place)
            except InputError:
                cells = [text]
            lines += _line(cells)
    if not names:
        raise InputError("the table is empty", where=file, remedy="give a header and at least one row")
    return names, bytes(lines)


def _parquet(file: str) -> tuple[tuple[str, ...], bytes]:
    _, parquet = parquet_package.packages()
    with open(os.fspath(file), "rb") as stream:
        table = parquet.ParquetFile(stream)
        names = tuple(spelled(name) for name in table.schema_arrow.names)
        return names, b"".join(_line(row) for batch in table.iter_batches(_ROWS) for row in _rows(batch))


def _rows(batch: Any) -> Iterator[list[str]]:
    """Numbers as their shortest decimals; nothing where there is none."""
    columns = [["" if value is None else str(value) for value in column.to_pylist()] for column in batch.columns]
    yield from map(list, zip(*columns, strict=True))


def _line(cells: list[str]) -> bytes:
    return "\t".join(" ".join(cell.split()) for cell in cells).encode() + b"\n"
