"""The sections of a TOML file: tables, texts and formulas, each with its place in every message."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.abbreviations import Abbreviations
from duhem.expression.parse import parse_expression, written_out
from duhem.law.placed_toml import Key, PlacedToml, meant

__all__ = ["SectionReader"]


@dataclass(frozen=True)
class SectionReader:
    """What stands where in a document; InputError for what is missing or of another kind."""

    toml: PlacedToml

    @property
    def where(self) -> str:
        """The name of the file."""
        return self.toml.where

    @property
    def document(self) -> Mapping[str, Any]:
        """Everything in it."""
        return self.toml.document

    def table(self, section: str, *, required: bool = True) -> Mapping[str, Any]:
        given = self.document.get(section)
        if given is None and required:
            raise InputError(f"there is no [{section}]", where=self.where, remedy="start from the template: duhem init NAME")
        if given is not None and not isinstance(given, dict):
            raise self.error(f"{section} is not a table", "", section, remedy=f"write [{section}] on a line of its own")
        return given or {}

    def keys(self, section: str, given: Mapping[str, Any], allowed: Sequence[str], inside: str = "", at: tuple[Key, ...] = ()) -> None:
        for key in given:
            if key not in allowed:
                what = f"unknown {'key' if section else 'section'} {key[:40]!r}" + (f" of {inside}" if inside else "")
                raise self.error(what, *(at or (section,)), inside or key, remedy=meant(key, allowed))

    def value(self, *path: Key) -> Any:
        """What stands at a place that is known to be there."""
        found: Any = self.document
        for key in path:
            found = found[key]
        return found

    def string(self, *path: Key, required: bool = True) -> str:
        *section, key = path
        given = self.value(*section).get(key, None if required else "")
        if given is None:
            header = f"[[{section[0]}]]" if len(section) > 1 else f"[{section[0]}]"
            raise self.error(f"{header} has no {key}", *section, remedy=f'add {key} = "..."')
        if not isinstance(given, str) or (required and not given.strip()):
            raise self.error(f"{key} is not a text" if given != "" else f"{key} is empty", *path, remedy=f'write {key} = "..."')
        return given

    def line(self, section: str, key: str, *, required: bool = True) -> str:
        """A text for people, as one printable line."""
        given = " ".join(self.string(section, key, required=required).split())
        if not given.isprintable() or len(given) > 500:
            raise self.error(f"{key} is not a printable line of at most 500 characters", section, key, remedy="shorten it")
        return given

    def alone(self, header: str, inside: str, *others: str) -> None:
        """No ``others`` beside a section that stands for them."""
        for key in others:
            if key in (self.document[inside] if inside else self.document):
                what = f"{header} and {key if inside else f'[{key}]'} are both given"
                raise self.error(what, inside, key, remedy="leave one of them out")

    def expression(self, *path: Key, known: Mapping[str, sp.Symbol], short: Abbreviations) -> sp.Expr:
        """The formula at a place, over the symbols ``known``."""
        text, line, column = self.formula(*path)
        return parse_expression(text, known, where=self.where, line=line, column=column, short=short)

    def written(self, *path: Key, short: Abbreviations) -> str:
        """The formula at a place as it is given, with all that stands for others written out."""
        return written_out(self.formula(*path)[0], short)

    def entries(self, *path: Key, example: str) -> list[tuple[Key, ...]]:
        """The places of the formulas in a list."""
        given = self.value(*path)
        if not (isinstance(given, list) and all(isinstance(c, str) for c in given)):
            raise self.error(f"{path[-1]} is not a list of expressions", *path, remedy=f"write {path[-1]} = {example}")
        return [(*path, i) for i in range(len(given))]

    def error(self, what: str, *path: Key, remedy: str) -> InputError:
        return InputError(what, where=self.place(*path), remedy=remedy)

    def place(self, *path: Key) -> str:
        """file:line:column of a key, or the file where the key is not found."""
        return self.toml.place(*(key for key in path if key != ""))

    def formula(self, *path: Key) -> tuple[str, int, int]:
        """A formula with the line (from 1) and column (from 0) at which it begins.

        The text is taken as written in the file, so that the columns are the file's; a formula has no use for escapes.
        """
        value = self.value(*path) if isinstance(path[-1], int) else self.string(*path)
        written, line, column = self.toml.written(*path) or (value, 1, 0)
        return (value if "\\" in written else written), line, column
