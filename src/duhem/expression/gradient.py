"""Gradients of formulas with kinks: one formula for each component, with the pieces of a kink behind a ``where``."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.build import settled, unacceptable
from duhem.expression.vocabulary import Where, adopted

__all__ = ["gradient", "jacobian"]


def gradient(potential: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...]:
    """The derivatives by ``forces``; where pieces meet at a kink, that of one of them.  InputError where a part has no derivative."""
    opened = potential.replace(lambda node: isinstance(node, sp.Abs | sp.Max | sp.Min), _pieces)
    found = tuple(settled(sp.diff(opened, x)) for x in forces)
    for part in found:
        if fault := unacceptable(part, potential.free_symbols):
            raise InputError(f"the potential has no gradient in the words of the language: {fault.what}", remedy="give the flow itself")
    return found


def _pieces(node: Any) -> sp.Expr:
    """A kink as the choice between its pieces."""
    if isinstance(node, sp.Abs):
        return Where(node.args[0] >= 0, node.args[0], -node.args[0])
    greatest = isinstance(node, sp.Max)
    return reduce(lambda rest, a: Where(a >= rest if greatest else a <= rest, a, rest), node.args)


def jacobian(system: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol]) -> sp.Matrix | None:
    """The derivatives of formulas, a row each; None where one cannot be said in the words of the language."""
    found = sp.Matrix(system).jacobian(list(unknowns)).applyfunc(adopted)
    return None if any(unacceptable(part, found.free_symbols) for part in found) else found
