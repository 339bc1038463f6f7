"""The local names of a law: formulas that stand for what they say, each in terms of the ones above it."""

from __future__ import annotations

from collections.abc import Mapping
from keyword import iskeyword
from typing import NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression import WORDS
from duhem.expression.abbreviations import NONE, Abbreviations
from duhem.expression.invariants import Stress
from duhem.expression.parse import parse_expression, written_out
from duhem.expression.spelling import spelled
from duhem.law.domain import by_name
from duhem.law.frozen_mapping import FrozenMapping

__all__ = ["Definitions", "PlacedFormula", "definitions"]


class PlacedFormula(NamedTuple):
    """A formula, where it stands (file or law, line from 1, column from 0), and where its name does."""

    text: str
    where: str
    line: int
    column: int
    name_at: str


class Definitions(FrozenMapping[str, str]):
    """Name to formula as it was given, in order; ``short`` has them, and the invariants of the law's stress, written out."""

    __slots__ = ("short",)

    def __init__(self, content: Mapping[str, str] | None = None, short: Abbreviations = NONE) -> None:
        super().__init__(content)
        self.short = short

    @classmethod
    def of(cls, given: Mapping[str, str], known: Mapping[str, sp.Symbol], stress: Stress | None, law: str) -> Definitions:
        """Those that a program gives ``law``; InputError as :func:`definitions`."""
        for name, text in by_name(given, "a formula").items():
            if not isinstance(text, str):
                raise InputError(f"the definition of {name} is no text", where=law, remedy="write its formula as text")
        return definitions({name: PlacedFormula(text, f"{name} of {law}", 1, 0, law) for name, text in given.items()}, known, stress)


def definitions(given: Mapping[str, PlacedFormula], known: Mapping[str, sp.Symbol], stress: Stress | None) -> Definitions:
    """Those of a law over the symbols ``known``; InputError, with its place, for a name or a formula that cannot be one.

    A definition is replaced by its formula, in brackets, wherever its name stands: the law is what it is with all written out.
    """
    formulas: dict[str, str] = {}
    left = [spelled(name) for name in given]
    taken = [*map(spelled, known), *left]
    for name, formula in given.items():
        if fault := _fault(name, taken, Abbreviations(stress=stress).words()):
            raise InputError(fault[0], where=formula.name_at, remedy=fault[1])
    for formula in given.values():
        short = Abbreviations(dict(formulas), stress, frozenset(left))
        parse_expression(formula.text, known, where=formula.where, line=formula.line, column=formula.column, short=short)
        formulas[left.pop(0)] = written_out(formula.text, short)
    return Definitions({spelled(name): formula.text for name, formula in given.items()}, Abbreviations(formulas, stress))


def _fault(name: str, taken: list[str], invariants: frozenset[str]) -> tuple[str, str] | None:
    """What is wrong with a name, and the remedy."""
    if not isinstance(name, str) or not name.isidentifier():
        return f"{name!r} is not a name", "use letters, digits and underscores"
    if (name := spelled(name)) in WORDS or name in invariants or name == "pi" or iskeyword(name):
        return f"the name {name!r} already means something", "choose another"
    if taken.count(name) > 1:
        return f"{name!r} is declared twice", "give each force, parameter and definition a name of its own"
    return None
