"""A derivation, or one of its equations, as a sheet, in LaTeX and in plain values."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from duhem.derivation.equation import Derivation, Equation
from duhem.derivation.printing import displayed, formulas, in_one, in_words
from duhem.derivation.typeset import Rows, Typesetter
from duhem.show.notation import latex_name
from duhem.show.printing import latex, plain, sheet
from duhem.show.sheet import Sheet, Typeset

__all__ = ["as_dict", "as_sheet", "equation_as_dict", "equation_as_latex", "equation_as_sheet"]


@sheet.register(Derivation)
def as_sheet(derivation: Derivation) -> Sheet:
    """A field an equation: its number, name and sentence, and the formula."""
    fields = tuple((_title(e), Typeset(_line(in_words(e, derivation.names)), in_one(rows))) for e, rows in formulas(derivation))
    return Sheet(f"Derivation of {derivation.law}", fields, notes=(("Left out", tuple(map(str, derivation.left_out))),))


@plain.register(Derivation)
def as_dict(derivation: Derivation) -> dict[str, Any]:
    """Every equation with its formula in the words of a criterion file and in LaTeX; what was left out."""
    return {
        "law": derivation.law,
        "equations": [_said(e, _line(in_words(e, derivation.names)), rows) for e, rows in formulas(derivation)],
        "left_out": [part.to_dict() for part in derivation.left_out],
    }


@sheet.register(Equation)
def equation_as_sheet(equation: Equation) -> Sheet:
    """Section and formula; symbols are written by their names, as the equation alone does not know better."""
    formula = Typeset(_line(in_words(equation)), in_one(_alone(equation)))
    return Sheet(_title(equation), (("section", equation.section), ("formula", formula)))


@plain.register(Equation)
def equation_as_dict(equation: Equation) -> dict[str, Any]:
    """As :func:`as_dict` has it."""
    return _said(equation, _line(in_words(equation)), _alone(equation))


@latex.register(Equation)
def equation_as_latex(equation: Equation) -> str:
    """A displayed formula with its number."""
    rows = _alone(equation)
    return displayed([*rows.formula, *rows.named], equation.number)


def _alone(equation: Equation) -> Rows:
    return Typesetter(dict(_written(equation.relation))).rows(equation.relation, equation.number)


def _written(relation: sp.Basic) -> Iterator[tuple[sp.Symbol, str]]:
    for known in relation.atoms(sp.Symbol):
        yield known, latex_name(known.name)


def _line(formula: str) -> str:
    """Rows of a vector or of branches one after the other."""
    return "; ".join(row.strip() for row in formula.splitlines())


def _title(equation: Equation) -> str:
    return f"({equation.number}) {equation.name}: {equation.note}"


def _said(equation: Equation, formula: str, rows: Rows) -> dict[str, Any]:
    return {
        "number": equation.number,
        "name": equation.name,
        "section": equation.section,
        "note": equation.note,
        "formula": formula,
        "latex": in_one(rows),
    }
