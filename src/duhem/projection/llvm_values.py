"""What a function in LLVM's text is given and returns: numbers, arrays and tuples of these, each carried by numbers alone."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = ["Dense", "NotLowered", "Number", "Value", "constant", "kinds_of", "leaves", "listed", "made_of", "returned", "type_of"]


class NotLowered(Exception):
    """A construction that has no place here: numba is given the text."""


@dataclass(frozen=True)
class Number:
    """A number of LLVM's type ``kind``, or an address; ``known`` where it is a constant, else ``text`` names it."""

    kind: str
    text: str = ""
    known: Any = None

    def __str__(self) -> str:
        if self.known is None:
            return self.text
        return f"0x{struct.pack('>d', self.known).hex()}" if self.kind == "double" else str(int(self.known))


@dataclass(frozen=True)
class Dense:
    """An array, dense by rows (``C``) or by columns (``F``); a ``local`` one is gone where its function returns."""

    element: str
    start: Number
    sizes: tuple[Number, ...]
    order: str = "C"
    local: bool = False


Value = Number | Dense | tuple[Any, ...]


def kinds_of(value: Value) -> Any:
    """What a function is written for: the kind of a number, (element, directions, order) of an array, a list of those of a tuple."""
    if isinstance(value, Number):
        return value.kind
    if isinstance(value, Dense):
        return value.element, len(value.sizes), value.order
    return ("tuple", *map(kinds_of, value))


def leaves(value: Value) -> list[Number]:
    """The numbers that carry a value."""
    if isinstance(value, Number):
        return [value]
    return [value.start, *value.sizes] if isinstance(value, Dense) else [part for each in value for part in leaves(each)]


def made_of(kinds: Any, number: Callable[[str], Number]) -> Value:
    """A value of these kinds, carried by what ``number`` gives for the kind of each, in turn."""
    if isinstance(kinds, str):
        return number(kinds)
    if kinds[0] == "tuple":
        return tuple([made_of(each, number) for each in kinds[1:]])
    element, directions, order = kinds
    return Dense(element, number("ptr"), tuple([number("i64") for _ in range(directions)]), order)


def returned(value: Value) -> list[Number]:
    """The same of what a function returns; NotLowered for an array of its own."""
    if isinstance(value, tuple):
        return [part for each in value for part in returned(each)]
    if isinstance(value, Dense) and value.local:
        raise NotLowered("an array is returned where it was made")
    return leaves(value)


def listed(value: Value) -> str:
    """As arguments of a call."""
    return ", ".join(f"{number.kind} {number}" for number in leaves(value))


def type_of(kinds: Any) -> str:
    """LLVM's type of what is returned, of which these are the kinds; None is nothing."""
    return (
        kinds
        if isinstance(kinds, str)
        else "void"
        if kinds is None
        else f"{{ {', '.join(each.kind for each in leaves(made_of(kinds, Number)))} }}"
    )


def constant(value: Any) -> Value:
    """A number of Python, or a tuple of such; NotLowered for anything else."""
    match value:
        case bool():
            return Number("i1", known=value)
        case int():
            return Number("i64", known=value)
        case float():
            return Number("double", known=value)
        case tuple():
            return tuple(map(constant, value))
    raise NotLowered(repr(value))
