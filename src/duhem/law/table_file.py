"""A table of numbers from a file: a header of names, rows of numbers, commas between them; what is otherwise is said with its line."""

from __future__ import annotations

import csv
from array import array
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.syntax import repeated, spelled

__all__ = ["MOST_NUMBERS", "cells_of", "header_of", "lines_of", "read_table", "reading"]

MOST_NUMBERS = 10_000_000  # of a path: five million knots in the plane, with some 100 bytes each before the first step
_MOST_CHARACTERS = 100_000  # of a line
_COMMAS = "separate numbers by commas, and write decimals with points"
_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}


def read_table(file: str | PathLike[str], least: int = 2) -> tuple[list[str], NDArray[np.float64]]:
    """The names in the header, and the rows (m, names) below it, ``least`` or more.  Blank lines and those that begin with # are left out.

    InputError names the line of whatever is no number; no more than ``MOST_NUMBERS`` are read.
    """
    if not isinstance(file, (str, PathLike)):
        raise InputError(f"{type(file).__name__} is no name of a file", where="file", remedy="give the path of a table")
    with reading(f"{file}"), open(file, encoding="utf-8-sig") as stream:
        return _read(stream, f"{file}", least)


@contextmanager
def reading(file: str) -> Iterator[None]:
    """InputError, with the file, where it cannot be read or is no text."""
    try:
        yield
    except InputError:
        raise
    except UnicodeDecodeError:
        raise InputError("this is not text in UTF-8", where=file, remedy="write the table as CSV") from None
    except (OSError, ValueError) as fault:
        reason = getattr(fault, "strerror", None) or " ".join(str(fault).split())[:200]
        raise InputError(f"the table cannot be read: {reason}", where=file, remedy="check its name and kind") from None


def lines_of(stream: TextIO, where: str) -> Iterator[tuple[str, str]]:
    """The lines that are neither blank nor begin with #, each after its place; InputError where one is too long for a table."""
    for number, text in enumerate(iter(lambda: stream.readline(_MOST_CHARACTERS + 1), ""), 1):
        if len(text) > _MOST_CHARACTERS:
            raise _no_csv(f"{where}:{number}")
        if text.strip() and not text.lstrip().startswith("#"):
            yield f"{where}:{number}", text


def _read(stream: TextIO, where: str, least: int) -> tuple[list[str], NDArray[np.float64]]:
    header: list[str] = []
    numbers = array("d")
    for place, text in lines_of(stream, where):
        if "\0" in text:
            raise _no_csv(place)
        cells = cells_of(text, place)
        if not header:
            header = header_of(cells, place)
            continue
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            row = []
        if len(row) != len(header):
            raise InputError(f"{text.strip()[:60]!r} is not {len(header)} numbers", where=place, remedy=_COMMAS)
        numbers.extend(row)
        if len(numbers) > MOST_NUMBERS:
            raise InputError(f"the table has more than {MOST_NUMBERS} numbers", where=place, remedy="run it in parts")
    if len(numbers) < least * max(1, len(header)):
        few = "two rows" if least == 2 else "one row"
        raise InputError(f"the table has fewer than {few}", where=where, remedy=f"give a header and at least {few}")
    return header, np.array(numbers).reshape(-1, len(header))


def _no_csv(place: str) -> InputError:
    return InputError("this line is not valid CSV", where=place, remedy="write the table as CSV")


def cells_of(text: str, place: str) -> list[str]:
    """The cells of a line; InputError where its quotes are none."""
    if '"' not in text:
        return text.split(",")
    try:
        return next(csv.reader([text], strict=True))
    except csv.Error as fault:
        raise InputError(f"this is not CSV: {fault}", where=place, remedy=_COMMAS) from None


def header_of(cells: list[str], place: str, example: str = "such as time,u_a,u_b,sigma_n") -> list[str]:
    """The names of the columns; InputError where these are none, or one is there twice, with an ``example`` of others."""
    names = [spelled(cell.strip()) for cell in cells]
    for mark, said in _SEPARATORS.items():
        words = [word for name in names for word in name.split(mark) if word]
        if (mark in names[0] and (mark != " " or len(names) == 1)) or (len(words) > len(names) and all(map(_is_number, words))):
            raise InputError(f"the columns are separated by {said}", where=place, remedy=_COMMAS)
    if all(map(_is_number, names)):
        raise InputError("there is no header", where=place, remedy=f"write the names of the columns above, {example}")
    if odd := next((name for name in names if not name.isprintable()), None):
        raise InputError(f"the column {odd[:40]!r} has an invisible character in its name", where=place, remedy="write the name anew")
    if twice := repeated(names):
        raise InputError(f"the column {twice[0][:40]!r} is there twice", where=place, remedy="give each column its own name")
    return names


def _is_number(text: str) -> bool:
    """Whether it is one in any notation; a comma may stand for the point."""
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True
