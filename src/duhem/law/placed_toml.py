"""TOML files read beside their text, so that everything in them has a place: file, line and column.

:mod:`tomllib` says what a document means; a scan of the text it has accepted says where each key and each string stands,
in whatever layout: sections, dotted and quoted keys, inline tables, arrays, arrays of tables.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from os import PathLike
from typing import Any

from duhem.errors import InputError

__all__ = ["Key", "PlacedToml", "document_text", "parsed", "text_of", "toml"]

Key = str | int  # of a table by name, of an array by number
_Path = tuple[Key, ...]


def text_of(path: str | PathLike[str], kind: str, most_bytes: int, *, absent: str = "check the path", large: str = "") -> str:
    """The text of a file of a ``kind``; InputError where it is not there, too large (remedies ``absent``, ``large``) or no UTF-8."""
    try:
        with open(path, "rb") as stream:
            data = stream.read(most_bytes + 1)
    except FileNotFoundError:
        raise InputError("there is no such file", where=f"{path}", remedy=absent) from None
    except IsADirectoryError:
        raise InputError("this is a directory", where=f"{path}", remedy=f"name a {kind} in it") from None
    except (OSError, ValueError) as fault:
        reason = getattr(fault, "strerror", None) or str(fault)
        raise InputError(f"the file cannot be read: {reason}", where=f"{path}", remedy="check its name and permissions") from None
    if len(data) > most_bytes:
        raise InputError(f"the file is larger than {most_bytes} bytes", where=f"{path}", remedy=large or f"is it a {kind}?")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        line = data.count(b"\n", 0, fault.start) + 1
        raise InputError("this is not text in UTF-8", where=f"{path}:{line}", remedy=f"is it a {kind}?") from None


def toml(value: Any) -> str:
    """A text, a truth value, a decimal, a list of texts or a table of these, without what is None, as TOML has it on one line.

    A JSON string of printable text is a basic string of TOML.
    """
    if isinstance(value, Mapping):
        said = ", ".join(f"{key} = {toml(part)}" for key, part in value.items() if part is not None)
        return f"{{ {said} }}" if said else "{}"
    return f"{value:f}" if isinstance(value, Decimal) else json.dumps(value, ensure_ascii=False)


def document_text(sections: Mapping[str, Mapping[str, Any] | Sequence[Mapping[str, Any]]]) -> str:
    """A document of sections, or of lists of them, with their keys; what is None is left out."""
    lines = list[str]()
    for name, content in sections.items():
        header, tables = (f"[{name}]", [content]) if isinstance(content, Mapping) else (f"[[{name}]]", content)
        for table in tables:
            lines += ["", header, *(f"{key} = {toml(value)}" for key, value in table.items() if value is not None)]
    return "\n".join(lines[1:]) + "\n"


@dataclass(frozen=True)
class _Spot:
    """Offsets: of a key (of a header's bracket, of an array's entry), and of what stands between the quotes of a string."""

    at: int
    content: tuple[int, int] | None = None
    implied: bool = False  # a table that a longer name only passes through


@dataclass(frozen=True)
class PlacedToml:
    """A document and the places of everything in it; ``where`` names the file in messages."""

    where: str
    text: str
    document: dict[str, Any]
    _spots: dict[_Path, _Spot] = field(repr=False)

    def place(self, *path: Key) -> str:
        """file:line:column of what stands at the path, or the file alone where nothing does."""
        spot = self._spots.get(path)
        if spot is None:
            return self.where
        line, column = self._line_column(spot.at)
        return f"{self.where}:{line}:{column + 1}"

    def written(self, *path: Key) -> tuple[str, int, int] | None:
        """A string as it is written, with the line (from 1) and column (from 0) where it begins; None where none stands.

        Ends of lines after a backslash become blanks; other escapes stay, so that the columns are those of the file.
        """
        spot = self._spots.get(path)
        if spot is None or spot.content is None:
            return None
        start, end = spot.content
        return (re.sub(r"\\([ \t]*\r?\n)", r" \1", self.text[start:end]), *self._line_column(start))

    def _line_column(self, at: int) -> tuple[int, int]:
        return self.text.count("\n", 0, at) + 1, at - (self.text.rfind("\n", 0, at) + 1)


def parsed(text: str, where: str, *, number: Callable[[str], Any] = float) -> PlacedToml:
    """The document written in ``text``, decimals read by ``number``; InputError with line and column where it is no TOML."""
    if deep := _DEEP.search(text):
        at = f"{where}:{text.count(chr(10), 0, deep.end()) + 1}"
        raise InputError(f"a key has more than {_MOST_PARTS} parts", where=at, remedy="shorten it")
    try:
        document = tomllib.loads(text, parse_float=number)
        placed = PlacedToml(where, text, document, _Scan(text).spots)
        long = next((path for path, value in _integers(document) if not -_LARGEST < value < _LARGEST), None)
    except tomllib.TOMLDecodeError as fault:
        what, _, place = str(fault).partition(" (at ")
        if numbers := re.fullmatch(r"line (\d+), column (\d+)\)", place):
            at = f"{where}:{numbers[1]}:{numbers[2]}"
        else:
            at = f"{where}:{text.count(chr(10), 0, len(text.rstrip())) + 1}" if place else where
        raise InputError(what[:1].lower() + what[1:], where=at, remedy="correct the TOML syntax") from None
    except (RecursionError, ValueError, ArithmeticError):
        raise InputError("the file nests too deeply or holds a number that is too large", where=where, remedy="simplify it") from None
    if long is not None:
        raise InputError("the number is too long", where=placed.place(*long), remedy=f"at most {_MOST_DIGITS} digits are read")
    return placed


def _integers(found: Any, path: _Path = ()) -> Iterator[tuple[_Path, int]]:
    """Every integer in a document: hexadecimal ones are read in any length, and too long to be printed."""
    if isinstance(found, dict | list):
        for key, inner in found.items() if isinstance(found, dict) else enumerate(found):
            yield from _integers(inner, (*path, key))
    elif isinstance(found, int) and found.bit_length() > 64:
        yield path, found


_MOST_DIGITS = 400
_LARGEST = 10**_MOST_DIGITS
_MOST_PARTS = 16  # of a dotted key, whose cost grows with their square
_KEY = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')[ \t]*+"""
_DEEP = re.compile(rf"(?:^|[\[{{,])[ \t]*+(?:{_KEY}\.[ \t]*+){{{_MOST_PARTS}}}", re.MULTILINE)  # where a key may begin
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_PART = re.compile(r"""[ \t]*(?P<part>[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')[ \t]*""")
_STRING = re.compile(
    r'"""(?:\r?\n)?(?P<a>(?:[^\\]|\\.)*?"{0,2})"""(?!")'  # multi-line basic
    r"|'''(?:\r?\n)?(?P<b>.*?'{0,2})'''(?!')"  # multi-line literal
    r'|"(?P<c>(?:[^"\\\n]|\\.)*)"'  # basic
    r"|'(?P<d>[^'\n]*)'",  # literal
    re.DOTALL,
)
_OTHER = re.compile(r"[^,\]}#\n]*")  # a number, a date or a truth value


class _Scan:
    """Where everything stands in a text that is known to be TOML: ``spots`` by path."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.spots: dict[_Path, _Spot] = {}
        self.tables: dict[_Path, int] = {}  # how many an array of tables has so far
        here: _Path = ()
        at = self.past_blank(0)
        while at < len(text):
            here, at = self.header(at) if text[at] == "[" else (here, self.entry(here, at))
            at = self.past_blank(at)

    def past_blank(self, at: int) -> int:
        """Behind blanks, ends of lines and comments."""
        found = _BLANK.match(self.text, at)
        return found.end() if found else at

    def header(self, at: int) -> tuple[_Path, int]:
        """The table that ``[a.b]`` or ``[[a.b]]`` opens, and the offset behind it."""
        brackets = 2 if self.text.startswith("[[", at) else 1
        names, end = self.names(at + brackets)
        here: _Path = ()
        for name, _ in names[:-1]:
            here = (*here, name)
            self.mark(here, _Spot(at, implied=True))
            if here in self.tables:
                here = (*here, self.tables[here] - 1)
        here = (*here, names[-1][0])
        self.mark(here, _Spot(at))
        if brackets == 2:
            self.tables[here] = self.tables.get(here, 0) + 1
            here = (*here, self.tables[here] - 1)
            self.mark(here, _Spot(at))
        return here, end + brackets

    def names(self, at: int) -> tuple[list[tuple[str, int]], int]:
        """The parts of a dotted key with their offsets, and the offset behind it."""
        parts = []
        while found := _PART.match(self.text, at):
            part, at = found["part"], found.end()
            plain = tomllib.loads(f"name = {part}")["name"] if part[0] in "\"'" else part
            parts.append((plain, found.start("part")))
            if self.text[at : at + 1] != ".":
                return parts, at
            at += 1
        raise ValueError(f"no key at offset {at}")

    def entry(self, here: _Path, at: int) -> int:
        """One ``key = value``; the offset behind it."""
        names, at = self.names(at)
        for name, start in names[:-1]:
            here = (*here, name)
            self.mark(here, _Spot(start, implied=True))
        name, start = names[-1]
        equals = self.text.index("=", at)
        return self.value((*here, name), start, self.past_blank(equals + 1))

    def value(self, path: _Path, start: int, at: int) -> int:
        """The value at ``at`` of what begins at ``start``; the offset behind it."""
        if found := _STRING.match(self.text, at):
            self.mark(path, _Spot(start, found.span(found.lastgroup or 0)))
            return found.end()
        self.mark(path, _Spot(start))
        opening = self.text[at]
        if opening not in "[{":
            other = _OTHER.match(self.text, at)
            return other.end() if other else at
        number, at = 0, self.past_blank(at + 1)
        while self.text[at] not in "]}":
            at = self.value((*path, number), at, at) if opening == "[" else self.entry(path, at)
            number, at = number + 1, self.past_blank(at)
            at = self.past_blank(at + 1) if self.text[at] == "," else at
        return at + 1

    def mark(self, path: _Path, spot: _Spot) -> None:
        """Note where something stands first; what a header opens goes before what longer names passed through."""
        if path not in self.spots or (self.spots[path].implied and not spot.implied):
            self.spots[path] = spot
