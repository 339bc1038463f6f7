"""The prototype of a routine in C, read for what each argument is: its name says what it holds, its type how it is passed."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from duhem.errors import InputError

__all__ = ["MEANINGS", "RETURNED", "Argument", "Prototype"]

_GIVEN = ("pressure", "stiffness", "parameters", "n", "d", "trial", "increment", "strain", "duration")
RETURNED = ("stress", "tangent", "slip", "multiplier", "dissipation", "status", "variables", "stored", "dissipated")
MEANINGS = frozenset((*_GIVEN, *RETURNED))
_ARGUMENT = re.compile(
    r"(?:const\s+)?(double|int|size_t)\s*(?:const\s*)?(\*?)\s*(?:(?:restrict|__restrict|__restrict__|const)\s+)*([A-Za-z_]\w*)\s*((?:\[\w*\]\s*)*)"
)
_WHOLE = re.compile(r"\s*(?:extern\s+)?(void|int)\s+([A-Za-z_]\w*)\s*\((.*)\)\s*;?\s*", flags=re.S)
_EXAMPLE = "write it as in the header: 'int friction(const double *trial, double pressure, double mu, double *stress)'"


@dataclass(frozen=True)
class Argument:
    """``number`` is "double", "int" or "size_t"; ``place``: passed as a pointer."""

    name: str
    number: str
    place: bool

    @property
    def kind(self) -> str:
        """The letter of :class:`duhem.testing.foreign.native.Native`."""
        return "p" if self.place else {"double": "d", "int": "i", "size_t": "n"}[self.number]


@dataclass(frozen=True)
class Prototype:
    """``returns``: whether the routine returns an int, its status."""

    symbol: str
    arguments: tuple[Argument, ...]
    returns: bool

    @classmethod
    def read(cls, text: str, driver: str) -> Prototype:
        """``driver`` is what the routine is given beside what it returns, "trial" or "increment".

        Raises InputError for what is no such prototype, with the argument that is not understood.
        """
        whole = _WHOLE.fullmatch(re.sub(r"/\*.*?\*/", " ", text, flags=re.S))
        if whole is None:
            raise InputError(f"{text!r} is no prototype of a function that returns void or int", where="signature", remedy=_EXAMPLE)
        back, symbol, inner = whole.groups()
        arguments = tuple(_argument(part) for part in inner.split(","))
        names = [a.name for a in arguments]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError(f"{twice[0]!r} is named twice", where=f"signature of {symbol}", remedy="give each argument a name of its own")
        words = [*_GIVEN[:5], driver, *(("strain", "duration") if driver == "increment" else ())]
        words += (
            RETURNED[:3] + (("variables", "stored", "dissipated") if driver == "increment" else ("multiplier", "dissipation")) + ("status",)
        )
        remedy = f"name the arguments by what they hold: {', '.join(words)}, or a parameter"
        if lacking := [needed for needed in (driver, "stress") if needed not in names]:
            raise InputError(f"there is no argument {lacking[0]!r}", where=f"signature of {symbol}", remedy=remedy)
        if strange := [name for name in names if name in MEANINGS and name not in words]:
            raise InputError(f"{strange[0]!r} is not known to a routine given {driver}", where=f"signature of {symbol}", remedy=remedy)
        several = [a.name for a in arguments if a.name == "pressure" and not a.place]
        if several and "n" in names:
            raise InputError(
                "one pressure for n increments", where=f"signature of {symbol}", remedy="make it an array: 'const double *pressure'"
            )
        return cls(symbol, arguments, back == "int")

    @property
    def batched(self) -> bool:
        """Whether one call answers ``n`` increments."""
        return any(a.name == "n" for a in self.arguments)

    def values(self) -> tuple[str, ...]:
        """The names that are no meaning of their own: parameters."""
        return tuple(a.name for a in self.arguments if a.name not in MEANINGS)

    def covers(self, values: Iterable[str]) -> None:
        """Raises InputError unless the numbers that are known are those that the signature has a place for."""
        known = set(values)
        where = f"signature of {self.symbol}"
        if lacking := [name for name in self.values() if name not in known]:
            said = "it is no word of its own, and there is no parameter of that name"
            raise InputError(f"argument {lacking[0]!r}: {said}", where=where, remedy="rename it, or give its value in parameters")
        whole = any(a.name == "parameters" for a in self.arguments)
        if not whole and (unread := sorted(known - set(self.values()))):
            remedy = f"add 'double {unread[0]}', or fix its value in conformance"
            raise InputError(f"there is no argument for the parameter {unread[0]!r}", where=where, remedy=remedy)


def _argument(text: str) -> Argument:
    found = _ARGUMENT.fullmatch(text.strip())
    if found is None:
        raise InputError(f"{text.strip()!r} is not understood as an argument", where="signature", remedy=_EXAMPLE)
    number, star, name, brackets = found.groups()
    argument = Argument(name, number, bool(star or brackets))
    if (number == "double") == (name in ("n", "d", "status")):
        raise InputError(f"{text.strip()!r}: a {number}", where="signature", remedy="n, d and status are integers, all else is double")
    if name in RETURNED and not argument.place:
        raise InputError(f"{text.strip()!r} cannot be written to", where="signature", remedy=f"make it a pointer: '{number} *{name}'")
    if not argument.place and name in ("trial", "increment", "strain", "stiffness", "parameters"):
        raise InputError(f"{text.strip()!r} is one number", where="signature", remedy=f"make it a pointer: 'const double *{name}'")
    return argument
