"""Laws times parameter sets: blocks of rows, each row made from its number alone, in whichever process asks for it.

Values are exact and travel as text such as ``3/20``.  What is wrong with one row is that row's ``fault``, not the block's.

The cells of tables of parameter values, CSV or Parquet, are text: what is written, so that decimals stay exact.  A line that is malformed
stays a line: it is the fault of its row, and the rows beside it are asked.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from fractions import Fraction
from functools import cached_property, lru_cache
from math import prod
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import holds_at
from duhem.expression.number import exact_number, exact_text, ratio
from duhem.expression.syntax import spelled
from duhem.law.catalogue import load, load_named
from duhem.law.curve_law import Law
from duhem.law.placed_toml import text_of
from duhem.law.table_file import cells_of, header_of, lines_of, reading
from duhem.show.place import parquet_packages

__all__ = ["Draw", "Given", "Grid", "LawName", "Row", "RowBlock", "Span", "TableRows", "cells_in_lines", "counted", "given", "told"]

_FINENESS = 10**6  # equal parts of a range, at whose ends values are drawn
_TRIES = 1_000

_TOGETHER = 8_192  # of Parquet, read together


@dataclass(frozen=True)
class LawName:
    """A law by the name that is ``shown``: that of a law of duhem, or of the file at ``path``, or of a value in the program."""

    shown: str
    path: str | None = None
    value: Law | None = None

    def law(self) -> Law:
        """InputError where the file or the name is none."""
        return _law(self) if self.value is None else self.value

    def told(self) -> str:
        """The law in words that tell it from every other; those of duhem are told by the version."""
        if self.value is not None:
            from duhem.proof.certificate import law_as_text

            return json.dumps([self.shown, law_as_text(self.value)])
        if self.path is None:
            return self.shown
        try:
            with open(self.path, "rb") as stream:
                return f"{self.shown} {hashlib.file_digest(stream, 'sha256').hexdigest()}"
        except OSError:
            return f"{self.shown} unread"


@lru_cache(maxsize=64)
def _law(name: LawName) -> Law:
    from duhem.law.criterion_file import MOST_BYTES, reads

    if name.path is None:
        return load_named(name.shown)
    return reads(text_of(name.path, "criterion file", MOST_BYTES), where=name.shown)


@dataclass(frozen=True)
class Row:
    """The ``number``, from 1 on, of a law with some of its parameters fixed; ``fault`` says why it cannot be asked."""

    number: int
    name: LawName
    values: Mapping[str, str] = field(default_factory=dict)
    fault: str = ""

    def law(self) -> Law:
        """InputError where there is none, or a value does not fit it."""
        if self.fault:
            raise InputError(self.fault)
        return self.name.law().fix(self.values)


@dataclass(frozen=True)
class Given:
    """Pairs of a law and its values."""

    pairs: tuple[tuple[LawName, tuple[tuple[str, str], ...]], ...]

    def __len__(self) -> int:
        return len(self.pairs)

    def row(self, i: int, number: int) -> Row:
        name, values = self.pairs[i]
        return Row(number, name, dict(values))


@dataclass(frozen=True)
class Grid:
    """Every combination of the values on ``axes``, the last axis first."""

    name: LawName
    axes: tuple[tuple[str, tuple[str, ...]], ...]
    values: tuple[tuple[str, str], ...] = ()

    def __len__(self) -> int:
        return prod(len(values) for _, values in self.axes)

    def row(self, i: int, number: int) -> Row:
        chosen = dict[str, str]()
        for axis, values in reversed(self.axes):
            i, at = divmod(i, len(values))
            chosen[axis] = values[at]
        return Row(number, self.name, {**dict(self.values), **{axis: chosen[axis] for axis, _ in self.axes}})


@dataclass(frozen=True)
class Span:
    """A closed range of a parameter; ``positive`` leaves its end 0 out."""

    parameter: str
    low: Fraction
    high: Fraction
    positive: bool = False

    def drawn(self, chance: random.Random) -> Fraction:
        """One of a million equally spaced values."""
        return self.low + (self.high - self.low) * Fraction(chance.randint(int(self.positive and self.low == 0), _FINENESS), _FINENESS)


@dataclass(frozen=True)
class Draw:
    """``count`` points drawn in the spans, each from the seed and its number; again where a constraint of the law does not hold."""

    name: LawName
    spans: tuple[Span, ...]
    count: int
    seed: int
    values: tuple[tuple[str, str], ...] = ()

    def __len__(self) -> int:
        return self.count

    def row(self, i: int, number: int) -> Row:
        chance, fixed = random.Random(f"{self.seed}/{i}"), dict(self.values)
        try:
            law = self.name.law()
        except InputError as fault:
            return Row(number, self.name, fixed, str(fault))
        table = law.symbols()
        exact = {table[p]: d.value for p, d in law.parameters.items() if d.value is not None}
        exact |= {table[p]: exact_number(value) for p, value in fixed.items() if p in table}
        for _ in range(_TRIES):
            point = {span.parameter: span.drawn(chance) for span in self.spans}
            at = exact | {table[p]: sp.Rational(x.numerator, x.denominator) for p, x in point.items()}
            if all(holds_at(c, at) for c in law.constraints):
                return Row(number, self.name, fixed | {p: ratio(at[table[p]]) for p in point})
        return Row(number, self.name, fixed, f"none of {_TRIES} random draws satisfies the constraints of {law.name}; narrow the ranges")


@dataclass(frozen=True)
class TableRows:
    """Rows of a table: ``columns`` are named as parameters, ``None`` is passed over; ``text`` has a line a row, cells between tabs."""

    name: LawName
    columns: tuple[str | None, ...]
    text: bytes
    values: tuple[tuple[str, str], ...] = ()

    def __len__(self) -> int:
        return len(self._ends)

    @cached_property
    def _ends(self) -> array[int]:
        ends, at = array("q"), 0
        while (at := self.text.find(b"\n", at) + 1) > 0:
            ends.append(at)
        return ends

    def row(self, i: int, number: int) -> Row:
        cells = self.text[self._ends[i - 1] if i else 0 : self._ends[i] - 1].decode().split("\t")
        if len(cells) != len(self.columns):
            fault = f"the row has {counted(len(cells), 'cell')} for {counted(len(self.columns), 'column')}"
            return Row(number, self.name, dict(self.values), fault)
        read = {name: _exact(cell) for name, cell in zip(self.columns, cells, strict=True) if name is not None}
        return Row(number, self.name, {**dict(self.values), **read})


RowBlock = Given | Grid | Draw | TableRows
"""Rows of one kind: so many, and ``row(i, number)`` of them, counted from 0 on."""


def told(block: RowBlock) -> str:
    """The block in words that tell it from every other."""
    return json.dumps([type(block).__name__, *(_told(getattr(block, each.name)) for each in fields(block))])


def _told(value: Any) -> Any:
    """A value of a block as JSON takes it."""
    match value:
        case LawName():
            return value.told()
        case bytes():
            return hashlib.sha256(value).hexdigest()
        case tuple():
            return [_told(each) for each in value]
        case Fraction() | Span():
            return str(value)
    return value


def _exact(cell: str) -> str:
    """A number in one spelling; what is none stays, and is the fault of its row."""
    try:
        return exact_text(cell)
    except InputError:
        return cell


def counted(count: int, name: str) -> str:
    """A number of things in words: 1 row, 2 rows."""
    return f"{count} {name}" if count == 1 else f"{count} {name}s"


def given(laws: tuple[tuple[Any, ...], ...]) -> Given:
    """Rows from pairs of a law, by name or as a value, and its values; InputError for what is none, or a value that is no number."""
    pairs = []
    for i, pair in enumerate(laws, 1):
        if len(pair) != 2 or not isinstance(pair[1], Mapping | None):
            remedy = 'write ("limacon", {"mu": 0.3})'
            raise InputError(f"{repr(pair)[:60]} is no pair of a law and its values", where=f"row {i}", remedy=remedy)
        law, values = pair
        found: Law = load(law)
        shown = law if isinstance(law, str) else found.name
        pairs.append((LawName(shown, value=found), tuple((str(p), exact_text(x)) for p, x in (values or {}).items())))
    return Given(tuple(pairs))


def cells_in_lines(file: str) -> tuple[tuple[str, ...], bytes]:
    """The names of the columns, and a line for each row, its cells between tabs.

    InputError where there is no header or no row, or the file cannot be read.  Blank lines of CSV and those that begin with # are
    left out.
    """
    with reading(file):
        names, text = _from_parquet(file) if file.endswith(".parquet") else _from_csv(file)
    if not text:
        raise InputError("the table has no rows", where=file, remedy="give a header and at least one row")
    return names, text


def _from_csv(file: str) -> tuple[tuple[str, ...], bytes]:
    lines = bytearray()
    names: tuple[str, ...] = ()
    with open(file, encoding="utf-8-sig") as stream:
        for place, text in lines_of(stream, file):
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


def _from_parquet(file: str) -> tuple[tuple[str, ...], bytes]:
    _, parquet = parquet_packages()
    with open(os.fspath(file), "rb") as stream:
        table = parquet.ParquetFile(stream)
        names = tuple(spelled(name) for name in table.schema_arrow.names)
        return names, b"".join(_line(row) for batch in table.iter_batches(_TOGETHER) for row in _cells(batch))


def _cells(batch: Any) -> Iterator[list[str]]:
    """Numbers as their shortest decimals; nothing where there is none."""
    columns = [["" if value is None else str(value) for value in column.to_pylist()] for column in batch.columns]
    yield from map(list, zip(*columns, strict=True))


def _line(cells: list[str]) -> bytes:
    return "\t".join(" ".join(cell.split()) for cell in cells).encode() + b"\n"
