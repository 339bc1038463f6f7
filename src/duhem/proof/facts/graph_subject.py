"""A law whose formula is kept as a graph, under examination: nothing is derived from it in symbols, and numbers come from its parts.

The kernel alone proves what is said of such a law.  A refutation is a value enclosed in balls, as of any law.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

import sympy as sp

from duhem.expression.fold import Graph
from duhem.expression.number import fraction
from duhem.expression.vocabulary import KINKS
from duhem.law.domain import REAL
from duhem.law.formula_law import Criterion
from duhem.proof.decide import EFFORTS
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Point, Subject, Values

__all__ = ["GraphSubject"]

_QUESTION_STEPS = 8_000_000
_LONGEST, _WRITTEN_OUT_STEPS = 20_000, 400_000_000
_WORD = re.compile(r"\w+")


def _length(graph: Graph) -> int:
    """How many words its formula has once it is written out."""
    known: dict[str, int] = {}
    for name, text in (*graph.nodes, ("g", graph.last)):
        known[name] = sum(known.get(word, 1) for word in _WORD.findall(text))
    return known["g"]


class GraphSubject(Subject):
    """``g`` over the forces, the pressure and the parameters, in the law's own symbols."""

    law: Criterion

    def __init__(self, law: Criterion, effort: Fraction = EFFORTS["normal"]) -> None:
        super().__init__(_QUESTION_STEPS, effort)
        self.law = law

    def check_defined(self) -> None:
        """Where g has no value the kernel proves nothing, and a place without one refutes nothing."""

    @property
    def stated(self) -> sp.Basic:
        """g as it is written."""
        return self.law.g

    @property
    def nowhere(self) -> Point:
        """Zero force."""
        return (Fraction(0),) * len(self.law.forces)

    @cached_property
    def written_out(self) -> FormulaSubject | None:
        """The law with g written out, where it has kinks and is short enough for that."""
        graph = self.law.graph
        if graph is None or _length(graph) > _LONGEST or not graph.formula.has(*KINKS):
            return None
        named = dict(zip(graph.names, self.law.g.args[1:], strict=True))
        found = FormulaSubject(replace(self.law, g=graph.formula.xreplace(named)), self.effort)
        found.allow(_WRITTEN_OUT_STEPS)
        return found

    def named(self, values: Values) -> dict[str, Fraction]:
        """Parameters, forces and pressure by their names in the law."""
        table = self.law.symbols()
        return {name: values[table[name]] for name in (*self.law.parameters, *self.law.coordinates)}

    def values_at(self, parameters: Values, point: Iterable[Fraction]) -> dict[sp.Symbol, Fraction]:
        """Every symbol of the law at a choice of the parameters and a point of the forces; the pressure is -1, or nearest to it."""
        law, table = self.law, self.law.symbols()
        fixed = {x: fraction(value) for x, value in law.fixed_values().items()}
        load = {} if law.pressure is None else {table[law.pressure]: self._pressure(law.pressure)}
        return {**fixed, **parameters, **load, **dict(zip(law.force_symbols(), point, strict=True))}

    def _pressure(self, name: str) -> Fraction:
        span = self.law.domain.get(name, REAL)
        if -1 in span:
            return Fraction(-1)
        return fraction(span.low if span.low is not None and span.low > -1 else span.high)
