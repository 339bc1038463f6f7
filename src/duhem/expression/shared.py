"""A formula kept as a graph: names, each with a formula of those before it, and the formula of the whole.

Written out, such a formula is too long for whoever goes through a tree.  SymPy is shown one node, :class:`Shared`, over the names of the
law; the walk of the interpreters (:mod:`duhem.expression.fold`) goes inside, through each shared part once.  What needs the formula in
symbols refuses it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from hashlib import sha256
from typing import Any

import sympy as sp

from duhem.errors import InputError

__all__ = ["Graph", "Shared", "graph_of"]


class Graph(sp.Atom):
    """``nodes`` are names with formulas, in order; ``last`` is the formula of the whole, over the law's ``names``.

    ``read`` makes of it an expression.  SymPy carries it about as something without parts.
    """

    nodes: tuple[tuple[str, str], ...]
    last: str
    names: tuple[sp.Symbol, ...]
    read: Callable[[Graph], sp.Expr]

    def __new__(cls, *given: Any) -> Graph:
        made: Graph = super().__new__(cls)
        made.nodes, made.last, made.names, made.read = given
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self.nodes, self.last, self.names, self.read

    def _hashable_content(self) -> tuple[str, ...]:
        return (self.digest,)

    @cached_property
    def digest(self) -> str:
        """The hash of all texts."""
        return sha256(repr((self.nodes, self.last)).encode()).hexdigest()

    @cached_property
    def formula(self) -> sp.Expr:
        """The expression as it is written, whose shared parts are the same objects; made when it is first asked for."""
        return self.read(self)

    def _sympystr(self, _: Any) -> str:
        return f"{self.last} with {len(self.nodes)} definitions"


class Shared(sp.Expr):
    """The formula of a graph over symbols, which may be replaced by other expressions; real, and a variable of its own to SymPy."""

    is_commutative = True

    @property
    def graph(self) -> Graph:
        """What it is the formula of."""
        graph: Graph = self.args[0]
        return graph

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
