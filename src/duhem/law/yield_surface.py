"""A surface that bounds K, with the slip on it: what a law states once, or several times."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import repeat
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.abbreviations import Abbreviations
from duhem.expression.given import given_formula
from duhem.expression.gradient import gradient
from duhem.expression.parse import parse_expression, written_out
from duhem.expression.verbatim import Verbatim
from duhem.law.given_text import text_of
from duhem.law.signature import listed

__all__ = ["YieldSurface", "as_expression"]


@dataclass(frozen=True)
class YieldSurface(Verbatim):
    """K lies in {g <= 0}; where g = 0 the slip is a non-negative multiple of ``flow``, one expression per force.

    ``potential`` is a formula whose gradient is the flow, instead of ``flow``; neither means associated: the slip is in the normal
    cone of {g <= 0}.  Text and SymPy expressions as for :class:`duhem.law.formula_law.Criterion`, which reads them; ``written``
    and ``written_flow`` are g and flow as they were given, where that was text.
    """

    g: sp.Expr
    flow: tuple[sp.Expr, ...] | None = None
    potential: str | None = None
    written: str = field(default="", repr=False, compare=False)
    written_flow: tuple[str, ...] = field(default=(), repr=False, compare=False)

    def read(self, known: Mapping[str, sp.Symbol], forces: Sequence[sp.Symbol], short: Abbreviations, owner: str) -> YieldSurface:
        """The same with its texts read over the symbols ``known``; InputError names the ``owner`` of what cannot be."""
        g = self.g if self.g is sp.nan else as_expression(self.g, known, f"g of {owner}", short)
        written = text_of(self.g, g, self.written, known, short)
        flow, written_flow = self.flow, self.written_flow
        if flow is not None:
            given = listed(flow, "flow", owner)
            flow = tuple(as_expression(c, known, f"flow of {owner}", short) for c in given)
            texts = zip(given, flow, self.written_flow or repeat(""), strict=False)
            written_flow = tuple(text_of(c, component, text, known, short) for c, component, text in texts)
        if self.potential is None:
            return YieldSurface(g, flow, None, written, written_flow)
        slip = _gradient(self.potential, known, forces, short, owner)
        if flow not in (None, slip):
            raise InputError("a flow and a potential are both given", where=owner, remedy="leave one of them out")
        return YieldSurface(g, slip, written_out(self.potential, short), written, written_flow)

    def map(self, change: Callable[[sp.Expr], sp.Expr]) -> YieldSurface:
        """The same with every expression changed, and no longer the texts it came from."""
        return YieldSurface(change(self.g), None if self.flow is None else tuple(map(change, self.flow)))

    def moved(self, change: Callable[[sp.Expr, str], sp.Expr]) -> YieldSurface:
        """The same with every expression, and its text, in other symbols of the same names; a potential's flow is to be found again."""
        flow = None if self.flow is None or self.potential is not None else tuple(map(change, self.flow, self.written_flow or repeat("")))
        return replace(self, g=change(self.g, self.written), flow=flow)


def as_expression(given: Any, known: Mapping[str, sp.Symbol], where: str, short: Abbreviations) -> sp.Expr:
    """Text, read over the symbols ``known``, or what :func:`duhem.expression.given.given_formula` makes of anything else."""
    return (
        parse_expression(given, known, where=where, short=short) if isinstance(given, str) else given_formula(given, known.values(), where)
    )


def _gradient(
    potential: Any, known: Mapping[str, sp.Symbol], forces: Sequence[sp.Symbol], short: Abbreviations, owner: str
) -> tuple[sp.Expr, ...]:
    """The flow that a potential gives."""
    if not isinstance(potential, str):
        raise InputError("the potential is no text", where=owner, remedy="write its formula as text")
    where = f"potential of {owner}"
    value = parse_expression(potential, known, where=where, short=short)
    try:
        flow = gradient(value, forces)
    except InputError as fault:
        raise InputError(fault.what, where=where, remedy=fault.remedy) from None
    if not any(flow):
        raise InputError(
            "the potential does not depend on any force", where=where, remedy=f"use at least one of {', '.join(map(str, forces))}"
        )
    return flow
