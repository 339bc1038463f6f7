"""How names are spelled: Unicode has several ways to write one letter, and Python's parser, the formula's too, reads them as one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from unicodedata import normalize

from duhem.errors import InputError

__all__ = ["respelled", "spelled"]


def spelled(name: Any) -> Any:
    """A name in its normal form NFKC (Unicode Standard Annex 31): the micro sign is a mu, wide letters are letters.

    What is no name stays what it is, so that it is refused as it was written.
    """
    return normalize("NFKC", name) if isinstance(name, str) and name.isidentifier() else name


def respelled(given: Mapping[Any, Any], where: str) -> dict[Any, Any]:
    """``given`` by names in their normal form; InputError where two of them are one."""
    made = {spelled(name): value for name, value in given.items()}
    if len(made) < len(given):
        names = [spelled(name) for name in given]
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"{twice!r} is given twice, in two spellings", where=where, remedy="give it once")
    return made
