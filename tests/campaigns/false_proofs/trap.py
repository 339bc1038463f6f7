"""A law built to deceive, written as a criterion file, and what is true of it; the numbers and ranges such laws are made with."""

from __future__ import annotations

import json
import random
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from duhem import Criterion
from duhem.law.criterion_file import reads

__all__ = ["Range", "Trap", "beside", "known", "margin", "ranged", "written"]

F = Fraction
_LETTERS = {"o": "origin", "c": "convexity", "s": "smoothness", "n": "normality", "d": "dissipation", "u": "duality"}


@dataclass(frozen=True)
class Trap:
    """``truth`` holds the claims that have an agreed one.  ``refused``: it is no law; an InputError is the right answer,
    and an open one is not wrong.

    ``refusable``: an InputError is right too.  ``parameters`` are inline tables of TOML by name.
    """

    kind: str
    g: str
    truth: Mapping[str, bool]
    parameters: Mapping[str, str] = field(default_factory=dict)
    constraints: tuple[str, ...] = ()
    flow: tuple[str, ...] | None = None
    forces: tuple[str, ...] = ("a", "b")
    pressure: str | None = "p"
    refused: bool = False
    refusable: bool = False

    def toml(self) -> str:
        """The criterion file."""

        def text(value: object) -> str:
            return json.dumps(value, ensure_ascii=False)

        head = ["[criterion]", f"name = {text(self.kind)}", f"forces = {text(self.forces)}"]
        head += [f"pressure = {'false' if self.pressure is None else text(self.pressure)}", f"g = {text(self.g)}"]
        head += [f"constraints = {text(self.constraints)}"] if self.constraints else []
        body = ["[parameters]", *(f"{text(name)} = {domain}" for name, domain in self.parameters.items())] if self.parameters else []
        tail = ["[flow]", f"direction = {text(self.flow)}"] if self.flow else []
        return "\n".join([*head, *body, *tail, ""])

    def law(self) -> Criterion:
        """The law; InputError where it is refused when it is read."""
        return reads(self.toml(), self.kind)


def known(true: str = "", false: str = "") -> dict[str, bool]:
    """Claims by first letter (u: duality)."""
    return {_LETTERS[c]: True for c in true} | {_LETTERS[c]: False for c in false}


def written(x: Fraction) -> str:
    """A number as a formula has it."""
    return f"({x})" if x < 0 or x.denominator > 1 else str(x)


def margin(rng: random.Random) -> Fraction:
    """1e-3 to 1e-9."""
    return F(1, 10 ** rng.randint(3, 9))


def beside(rng: random.Random) -> Fraction:
    """0 or a small number of either sign."""
    return rng.choice([F(0), 1, 1, -1, -1]) * margin(rng)


@dataclass(frozen=True)
class Range:
    """Parameters and constraints that let the parameter ``name`` take the values from ``low`` to ``high``, and no others."""

    name: str
    low: Fraction
    high: Fraction
    parameters: Mapping[str, str]
    constraints: tuple[str, ...] = ()


def interval(low: Fraction | None, high: Fraction | None) -> str:
    """A domain as TOML."""
    ends = {"min": low, "max": high}
    return "{ " + ", ".join(f'{key} = "{end}"' for key, end in ends.items() if end is not None) + " }"


def ranged(rng: random.Random, name: str, low: Fraction, high: Fraction) -> Range:
    """One of a dozen ways to say low <= x <= high: domain ends, constraints, thin wedges that touch an end in one point."""
    m, top = F(low), F(high)
    wide, side = interval(m, top + 5), f"{name}_side"
    one = {name: wide, side: interval(F(0), F(1))}
    thin, up, half = margin(rng), written(top), written((top - m) / 2)
    ways: list[tuple[Mapping[str, str], Iterable[str]]] = [
        ({name: interval(m, top)}, ()),
        ({name: interval(m, top)}, ()),
        ({name: wide}, (f"{name} <= {up}",)),
        (one, (f"{name} <= {up} - {side}",)),
        (one, (f"{name} + {side} <= {up}",)),
        (one, (f"{name} - {written((top - m) * thin)}*{side} <= {written(top - (top - m) * thin)}",)),
        ({name: wide, side: interval(m, top)}, (f"{name} <= {side}", f"{name} >= {side} - {written(thin)}")),
        ({name: interval(m - 5, top + 5)}, (f"({name} - {written((m + top) / 2)})**2 <= {half}**2",)),
    ]
    if m >= 0:
        ways += [({name: wide}, (f"{name}**2 <= {up}**2",))]
        ways += [({name: wide, side: interval(F(1), F(2))}, (f"{name}*{side} <= {up}",))]
    if m > 0:
        ways += [({name: wide}, (f"1/{name} >= 1/{up}",))]
    parameters, constraints = rng.choice(ways)
    return Range(name, m, top, parameters, tuple(constraints))
