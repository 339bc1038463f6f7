"""Texts: where they stand, as Python's parser reads them (syntax trees, made by one thread at a time), and names in Unicode's spellings."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable, Mapping
from threading import RLock
from typing import Any, Self
from unicodedata import normalize

from duhem.errors import InputError

__all__ = ["PlacedText", "expression_tree", "module_tree", "repeated", "respelled", "spelled"]


class PlacedText(str):
    """A text that knows where it stands: in the file or law ``where``, from ``line`` (from 1) and ``column`` (from 0) on.

    Its name stands at ``name_at``.  A text that was ``made`` of another has its faults where that one begins.  A text that is ``alike``
    differs from the one before it in numbers alone.
    """

    where: str
    line: int
    column: int
    name_at: str
    made: bool
    alike: bool

    def __new__(
        cls, text: str, where: str, line: int = 1, column: int = 0, name_at: str = "", made: bool = False, alike: bool = False
    ) -> Self:
        placed = super().__new__(cls, text)
        vars(placed).update(where=where, line=line, column=column, name_at=name_at, made=made, alike=alike)
        return placed

    def made_into(self, text: str) -> PlacedText:
        """Another text that is read in the place of this one."""
        return PlacedText(text, self.where, self.line, self.column, self.name_at, made=True)


_TURN = RLock()
"""CPython counts how deep a tree is that it makes in one place for all threads; another thread may come in while it makes one, with the
garbage that is collected, and then the count is off and a SystemError is raised (python/cpython issue 106905)."""


def module_tree(text: str) -> ast.Module:
    """The statements of a text; raises what ``ast.parse`` raises."""
    with _TURN:
        return ast.parse(text)


def expression_tree(text: str) -> ast.expr:
    """The one expression that a text is; raises what ``ast.parse`` raises."""
    with _TURN:
        return ast.parse(text, mode="eval").body


# -- names -------------------------------------------------------------------------------------------------------------


def spelled(name: Any) -> Any:
    """A name in its normal form NFKC (Unicode Standard Annex 31): the micro sign is a mu, wide letters are letters.

    What is no name stays what it is, so that it is refused as it was written.
    """
    return normalize("NFKC", name) if isinstance(name, str) and name.isidentifier() else name


def respelled(given: Mapping[Any, Any], where: str) -> dict[Any, Any]:
    """``given`` by names in their normal form; InputError where two of them are one."""
    names = [spelled(name) for name in given]
    if twice := repeated(names):
        raise InputError(f"{twice[0]!r} is given twice, in two spellings", where=where, remedy="give it once")
    return dict(zip(names, given.values(), strict=True))


def repeated(names: Iterable[Any]) -> list[Any]:
    """The names that are there more than once."""
    return [name for name, count in Counter(names).items() if count > 1]
