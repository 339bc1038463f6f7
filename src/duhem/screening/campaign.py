"""A campaign as a frozen value: its rows, what is asked of each and what that may cost; and the lines of one row, whatever comes of it.

An inquiry is a value that can be sent to another process, with an answer for each line.  The text of a row is a JSON list of its lines,
which is what processes and parts hold.

Rows are laws times parameter sets, in blocks: each row is made from its number alone, in whichever process asks for it.  Values are exact
and travel as text such as ``3/20``.  What is wrong with one row is that row's ``fault``, not the block's.  The cells of tables of parameter
values, CSV or Parquet, are text: what is written, so that decimals stay exact.  A line that is malformed stays a line: it is the fault of
its row, and the rows beside it are asked.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import random
import traceback
from array import array
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import accumulate
from math import prod
from operator import itemgetter
from typing import Any, ClassVar, NamedTuple, Protocol, TypeAlias

import sympy as sp

from duhem.errors import DuhemError, InputError, words_of
from duhem.expression import holds_at
from duhem.expression.number import exact_number, exact_text, ratio
from duhem.expression.syntax import spelled
from duhem.law import table_file
from duhem.law.catalogue import load, load_named
from duhem.law.curve_law import Law
from duhem.law.placed_toml import text_of
from duhem.law.table_file import cells_of, header_of, reading
from duhem.show.place import parquet_packages
from duhem.version import __version__

__all__ = [
    "Answer", "Campaign", "Claimed", "Draw", "Given", "Grid", "Inquiry", "LawName", "Row", "RowBlock", "Span", "TableRows", "VerdictLine",
    "as_text", "asked", "cells_in_lines", "counted", "ended", "given", "lines_of", "number_of", "told",
]  # fmt: skip

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
        for place, text in table_file.lines_of(stream, file):
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


# -- what is asked of the rows -----------------------------------------------------------------------------------------

_MOST = 1_000  # characters of an error
_A_LIBRARY = 100_000_000  # bytes: what is mapped at once of a large one, or for a thread


Answer: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]
"""The fields of a :class:`VerdictLine` from ``claim`` to ``seconds``."""


class Inquiry(Protocol):
    """``names`` are the lines that each row has, whatever comes of it; ``options`` what the command line names beside the campaign.

    ``alone`` says that a row may leave behind what the next one meets, so that each is asked in a process of its own.
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def options(self) -> tuple[str, ...]: ...

    @property
    def alone(self) -> bool: ...

    def told(self) -> str:
        """Return words that tell this inquiry from every other."""
        ...

    def answers(self, law: Law) -> Iterator[Answer]:
        """Return a line for each name; raise InputError where the law cannot be asked."""
        ...


@dataclass(frozen=True)
class Claimed:
    """The claims of :func:`duhem.verify`, over what the row leaves open of the parameters."""

    claims: tuple[str, ...]
    effort: str = "normal"
    options: ClassVar[tuple[str, ...]] = ()
    alone: ClassVar[bool] = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.claims

    def told(self) -> str:
        return f"claims {','.join(self.claims)} {self.effort}"

    def answers(self, law: Law) -> Iterator[Answer]:
        from duhem.proof.verification import claim_results

        for r in claim_results(law, self.claims, self.effort):
            witness = None if r.witness is None else json.dumps(r.witness.to_dict())
            trust = None if r.trust is None else r.trust.value
            yield r.claim, r.verdict.value, r.method, trust, witness, r.steps, round(r.seconds, 6)


@dataclass(frozen=True)
class Campaign:
    """Rows in ``blocks``, numbered from 1 on, and the ``inquiry`` put to each.

    What a verdict may cost is counted in steps, by the inquiry; beyond ``seconds`` of the processor or ``memory`` gigabytes more than
    its process has at the start, a row is ended with its process; and so is one that waits, by the clock, ten times ``seconds`` and more.
    """

    blocks: tuple[RowBlock, ...]
    inquiry: Inquiry
    seconds: float = 600.0
    memory: float = 4.0
    out: str | None = None
    inputs: tuple[str, ...] = ()

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @cached_property
    def _ends(self) -> tuple[int, ...]:
        return tuple(accumulate(map(len, self.blocks)))

    def row(self, number: int) -> Row:
        """Return the row of a number from 1 to ``len``."""
        block = bisect_right(self._ends, number - 1)
        before = self._ends[block - 1] if block else 0
        return self.blocks[block].row(number - 1 - before, number)

    @property
    def fingerprint(self) -> str:
        """What tells the campaign's table from every other: all that is asked, and the version of duhem."""
        parts = [__version__, self.inquiry.told(), self.seconds, self.memory, *map(told, self.blocks)]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


class VerdictLine(NamedTuple):
    """One line of the table.  ``parameters`` are those that the row fixes and ``witness`` a violation, both as JSON text.

    ``error`` says why there is no verdict; ``steps`` are what the verdict cost, counted, and ``seconds`` what it took.
    """

    row: int
    law: str
    parameters: str
    claim: str
    verdict: str | None
    method: str | None
    trust: str | None
    witness: str | None
    steps: int
    seconds: float
    error: str | None

    @property
    def counts_as(self) -> str:
        """The verdict under which the line is counted: a claim that holds by construction does not count as proved."""
        from duhem.proof.kernel.claims import BY_CONSTRUCTION

        return "by_construction" if self.method == BY_CONSTRUCTION else "none" if self.verdict is None else self.verdict


def asked(campaign: Campaign, number: int) -> tuple[VerdictLine, ...]:
    """Return the lines of a row, sorted by claim.  They contain every error but lack of memory, also one that would end a program."""
    row = campaign.row(number)
    try:
        return _lines(row, campaign.inquiry.answers(row.law()), None)
    except DuhemError as fault:
        return ended(campaign, row, str(fault))
    except MemoryError:
        raise
    except SystemExit as fault:
        return ended(campaign, row, f"it ends the program, with {fault.code!r}")
    except BaseException as fault:  # a routine raises what it likes
        if _for_lack_of_memory(fault):
            raise MemoryError from None
        place = traceback.extract_tb(fault.__traceback__)[-1]
        where = f"{os.path.basename(place.filename)}:{place.lineno}"
        return ended(campaign, row, f"{': '.join(filter(None, (type(fault).__name__, ' '.join(words_of(fault).split()))))} (at {where})")


def _for_lack_of_memory(fault: BaseException) -> bool:
    """Return whether memory was lacking, also where the error speaks of a library that does not load or a thread that does not start."""
    met = set[int]()
    cause: BaseException | None = fault
    while cause is not None and id(cause) not in met:
        if isinstance(cause, MemoryError) or (isinstance(cause, OSError) and cause.errno == errno.ENOMEM):
            return True
        if (isinstance(cause, ImportError) or "start new thread" in words_of(cause)) and _all_but_taken():
            return True
        met.add(id(cause))
        cause = cause.__cause__ or cause.__context__
    return False


def _all_but_taken() -> bool:
    """Return whether this process has come so near to its limit of memory that one more thread or library does not fit."""
    try:
        import resource

        with open("/proc/self/status") as stream:
            peak = next(1024 * int(line.split()[1]) for line in stream if line.startswith("VmPeak"))
        most = resource.getrlimit(resource.RLIMIT_AS)[0]
    except (ImportError, OSError, StopIteration):  # a platform that does not count
        return False
    return most != resource.RLIM_INFINITY and peak > most - _A_LIBRARY


def ended(campaign: Campaign, row: Row, error: str) -> tuple[VerdictLine, ...]:
    """Return the lines of a row without verdicts, with the reason."""
    answers: Iterator[Answer] = ((name, None, None, None, None, 0, 0.0) for name in campaign.inquiry.names)
    return _lines(row, answers, error if len(error) <= _MOST else f"{error[:_MOST]} ...")


def _lines(row: Row, answers: Iterable[Answer], error: str | None) -> tuple[VerdictLine, ...]:
    why = None if error is None else _writable(error)
    law, values = _writable(row.name.shown), json.dumps(dict(row.values))
    return tuple(VerdictLine(row.number, law, values, *answer, why) for answer in sorted(answers, key=itemgetter(0)))


def _writable(text: str) -> str:
    return text.encode("utf-8", "backslashreplace").decode()


def as_text(lines: Sequence[VerdictLine]) -> str:
    """Return the lines of one row as one line of text."""
    return json.dumps(lines, separators=(",", ":"))


def number_of(text: str) -> int:
    """Return the number of the row of which :func:`as_text` made the text."""
    return int(text[2 : text.index(",")])


def lines_of(text: str) -> tuple[VerdictLine, ...]:
    """Return the lines of which :func:`as_text` made the text."""
    return tuple(VerdictLine(*values) for values in json.loads(text))
