"""A text whose definitions are too long to be written out, as a graph: each is read once, and its value made when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from duhem.expression.abbreviations import Abbreviations, names_in
from duhem.expression.build import IN_RANGE
from duhem.expression.parse import check_formula, parse_as_written, written_out
from duhem.expression.shared import Graph, Shared
from duhem.expression.vocabulary import symbol

__all__ = ["own_text", "parse_graph"]


def parse_graph(text: str, known: Mapping[str, sp.Symbol], short: Abbreviations, *, where: str, line: int = 1, column: int = 0) -> Shared:
    """The formula over the symbols ``known`` and the definitions of ``short``; InputError for anything outside the language."""
    check_formula(text, [*known, *short.own], where=where, line=line, column=column, short=short.alone())
    last = own_text(text, short)
    nodes = tuple((name, short.own[name]) for name in short.used_by(last))
    used = names_in(last).union(*(names_in(formula) for _, formula in nodes))
    names = tuple(name for name in known if name in used)
    return Shared(Graph(nodes, last, tuple(map(symbol, names)), _read), *(known[name] for name in names))


def own_text(text: str, short: Abbreviations) -> str:
    """The formula with its invariants written out, and the names of definitions left in."""
    return written_out(text, short.alone())


def _read(graph: Graph) -> sp.Expr:
    """The formula in a form for doubles, each definition one object wherever its name stands."""
    made: dict[str, sp.Expr] = {x.name: x for x in graph.names}
    for name, text in graph.nodes:
        made[name] = parse_as_written(text, made, IN_RANGE)
        hash(made[name])  # kept by SymPy, the inner ones first
    return parse_as_written(graph.last, made, IN_RANGE)
