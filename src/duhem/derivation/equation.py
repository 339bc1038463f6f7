"""A derivation as a value: numbered, named relations in order, each computed, none stored."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.derivation.notation import Names
from duhem.errors import InputError
from duhem.expression.parse import exact_number
from duhem.expression.verbatim import Verbatim
from duhem.left_out import LeftOut
from duhem.show.page import Page
from duhem.show.printing import latex, markdown, sheet, text
from duhem.show.shown import Shown

__all__ = ["Belongs", "Derivation", "Equation"]


class Belongs(sp.Function):
    """``Belongs(x, A)``: x is an element of A."""

    nargs = 2


@dataclass(frozen=True, repr=False)
class Equation(Verbatim, Shown):
    """One line: its number in Antoni et al. (2007) or D1, D2, ... where the paper has none; ``note`` is one sentence."""

    number: str
    name: str
    relation: sp.Basic
    note: str
    section: str

    def __repr__(self) -> str:
        return f"<Equation ({self.number}) {self.name}: {self.note}>"

    def _repr_latex_(self) -> str:
        return latex(self)

    @property
    def lhs(self) -> sp.Basic:
        """Left side of the relation."""
        return self.relation.args[0]

    @property
    def rhs(self) -> sp.Basic:
        """Right side of the relation."""
        return self.relation.args[1]

    def at(self, **values: Any) -> sp.Basic:
        """The right side where the symbols of these names have these values, exactly: ``at(d_a=1, mu="0.3")``; decimals are fractions.

        Raises InputError for a name that it does not have and for what is no number.
        """
        known = {symbol.name: symbol for symbol in self.rhs.free_symbols if isinstance(symbol, sp.Symbol)}
        if strange := [name for name in values if name not in known]:
            remedy = f"it has {', '.join(sorted(known)) or 'none'}"
            raise InputError(f"{strange[0]} is no symbol on the right side", where=self.name, remedy=remedy)
        return self.rhs.xreplace({known[name]: _number(name, value) for name, value in values.items()})


def _number(name: str, value: Any) -> sp.Rational:
    try:
        return exact_number(value)
    except InputError as fault:
        raise InputError(fault.what, where=name, remedy=fault.remedy) from None


@dataclass(frozen=True, repr=False)
class Derivation(Shown):
    """What follows from one law's formula.  ``derivation["state_law"]`` is the equation of that name.

    ``left_out`` lists part and reason of what the law does not need or has no closed form for.
    """

    law: str
    equations: tuple[Equation, ...]
    left_out: tuple[LeftOut, ...]
    names: Names

    def __getitem__(self, name: str) -> Equation:
        for equation in self.equations:
            if equation.name == name:
                return equation
        raise KeyError(f"{name}; this derivation has: {', '.join(self.titles)}")

    def __contains__(self, name: object) -> bool:
        return name in self.titles

    def __iter__(self) -> Iterator[Equation]:
        return iter(self.equations)

    def __len__(self) -> int:
        return len(self.equations)

    def __repr__(self) -> str:
        return f"<Derivation of {self.law}: {len(self)} equations>"

    def _repr_latex_(self) -> str:
        return "\n".join(rf"$$ {formula.latex} $$" for _, formula in sheet(self).fields if not isinstance(formula, str))

    @property
    def titles(self) -> tuple[str, ...]:
        """Names of the equations, in order."""
        return tuple(equation.name for equation in self.equations)

    def text(self) -> str:
        """Plain text, a line a sentence; formulas in the vocabulary of criterion files."""
        return text(self, Page(None))

    def markdown(self) -> str:
        """Markdown with LaTeX formulas between dollar signs."""
        return markdown(self)

    def latex(self) -> str:
        """A complete LaTeX document that needs amsmath only."""
        return latex(self)
