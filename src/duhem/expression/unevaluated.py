"""Values whose expressions are pickled and copied node by node, as they stand.

SymPy pickles an expression as a call of its class, which evaluates it anew: k > 0 with a positive k comes back as ``True``,
a pair of branches in another order, and a function that is only a name not at all.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Self

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.matrices.matrixbase import MatrixBase

__all__ = ["HASH", "Verbatim"]

HASH = "_hash"  # where a value may keep its own, which is another in each process


class Verbatim:
    """A frozen value with expressions, tuples of expressions or tables of them in its fields; it equals its copies."""

    def __getstate__(self) -> dict[str, Any]:
        return {name: _recorded(value) for name, value in vars(self).items() if name != HASH}

    def __copy__(self) -> Self:
        return self


@dataclass(frozen=True)
class _Node:
    """One inner node: its class (a name where it is only a name), the places of its arguments, and what it knows beside them."""

    kind: type | str
    arguments: tuple[int, ...]
    beside: tuple[tuple[str, Any], ...]


@dataclass(frozen=True)
class _Record:
    """The nodes of an expression, each once and after its arguments; leaves are SymPy's own.  It comes back as the expression."""

    nodes: tuple[Any, ...]

    def __reduce__(self) -> tuple[Any, ...]:
        return _expression, self.nodes


def _recorded(value: Any) -> Any:
    if isinstance(value, sp.Basic):
        return _record(value) if value.args else value
    if isinstance(value, (tuple, list)):
        return type(value)(map(_recorded, value))
    if type(value) is dict:
        return {_recorded(key): _recorded(item) for key, item in value.items()}
    return value


def _record(expr: sp.Basic) -> _Record:
    places: dict[sp.Basic, int] = {}
    nodes: list[Any] = []
    for node in sp.postorder_traversal(expr):
        if node not in places:
            places[node] = len(nodes)
            nodes.append(_node(node, tuple(places[x] for x in node.args)) if node.args else node)
    return _Record(tuple(nodes))


def _node(node: sp.Basic, arguments: tuple[int, ...]) -> _Node:
    if isinstance(node, AppliedUndef):
        return _Node(node.func.__name__, arguments, tuple(node.func._kwargs.items()))
    if isinstance(node, MatrixBase):
        return _Node(type(node), arguments, ())
    return _Node(type(node), arguments, tuple((name, getattr(node, name)) for name in _beside(node) if name != "_argset"))


def _beside(node: sp.Basic) -> Iterator[str]:
    """What a node knows beside its class and arguments, and does not find out again by itself."""
    slots = (name for kind in type(node).__mro__ for name in kind.__dict__.get("__slots__", ()))
    yield from (name for name in slots if name not in ("_mhash", "_args", "_assumptions", "__weakref__") and hasattr(node, name))
    yield from getattr(node, "__dict__", ())


def _expression(*nodes: Any) -> sp.Basic:
    done: list[sp.Basic] = []
    for node in nodes:
        done.append(_built(node, [done[i] for i in node.arguments]) if isinstance(node, _Node) else node)
    return done[-1]


def _built(node: _Node, arguments: list[sp.Basic]) -> sp.Basic:
    if isinstance(node.kind, str):
        return sp.Function(node.kind, **dict(node.beside))(*arguments)
    if issubclass(node.kind, MatrixBase):
        return node.kind(*arguments)
    made = sp.Basic.__new__(node.kind, *arguments)
    for name, value in node.beside:
        setattr(made, name, value)
    if isinstance(made, (sp.core.operations.LatticeOp, sp.Max, sp.Min)):
        made._argset = frozenset(arguments)
    return made
