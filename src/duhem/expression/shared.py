"""A formula kept as a graph: names, each with a formula of those before it, and the formula of the whole.

Written out, such a formula is too long for whoever goes through a tree.  SymPy is shown one node, :class:`Shared`, over the names of the
law; the walk of the interpreters (:mod:`duhem.expression.fold`) goes inside, through each shared part once.  What needs the formula in
symbols refuses it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from typing import Any

import sympy as sp

from duhem.errors import InputError

__all__ = ["Graph", "Shared", "graph_of"]


@dataclass(frozen=True)
class Graph:
    """``nodes`` are names with formulas, in order; ``last`` is the formula of the whole, over the law's ``names``.

    ``read`` makes of it an expression.
    """

    nodes: tuple[tuple[str, str], ...]
    last: str
    names: tuple[sp.Symbol, ...]
    read: Callable[[Graph], sp.Expr] = field(repr=False, compare=False)

    @cached_property
    def digest(self) -> str:
        """The hash of all texts."""
        return sha256(repr((self.nodes, self.last)).encode()).hexdigest()

    @cached_property
    def formula(self) -> sp.Expr:
        """The expression as it is written, whose shared parts are the same objects; made when it is first asked for."""
        return self.read(self)

    def __str__(self) -> str:
        return f"{self.last} with {len(self.nodes)} definitions"


class _Handle(sp.Atom):
    """The graph of a formula, as SymPy carries it about."""

    graph: Graph
    __slots__ = ("graph",)

    def __new__(cls, graph: Graph) -> _Handle:
        made: _Handle = super().__new__(cls)
        made.graph = graph
        return made

    def _hashable_content(self) -> tuple[str, ...]:
        return (self.graph.digest,)

    def __reduce__(self) -> Any:
        return type(self), (self.graph,)

    def _sympystr(self, _: Any) -> str:
        return self.graph.digest[:12]


class Shared(sp.Expr):
    """The formula of a graph over symbols, which may be replaced by other expressions; real, and a variable of its own to SymPy."""

    is_commutative = True

    def __new__(cls, graph: Graph | _Handle, *symbols: sp.Expr) -> Shared:
        made: Shared = super().__new__(cls, graph if isinstance(graph, _Handle) else _Handle(graph), *symbols)
        return made

    @property
    def graph(self) -> Graph:
        """What it is the formula of."""
        handle: _Handle = self.args[0]
        return handle.graph

    @property
    def parts(self) -> tuple[sp.Basic, ...]:
        """What stands for the names, in the order in which the graph's formula has them."""
        return self.args[1:]

    def _eval_is_extended_real(self) -> bool:
        return True

    def _eval_derivative(self, _: sp.Symbol) -> sp.Expr:
        raise InputError("a formula kept as a graph has no derivative in symbols", remedy="write a shorter formula")

    def _sympystr(self, _: Any) -> str:
        return str(self.graph)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        body = rf"\operatorname{{graph}}_{{{len(self.graph.nodes)}}}\left({', '.join(printer.doprint(x) for x in self.parts)}\right)"
        return rf"{body}^{{{exp}}}" if exp else body


def graph_of(expr: Any) -> Graph | None:
    """The graph that an expression is kept as; None where it is an expression like others."""
    return expr.graph if isinstance(expr, Shared) else None
