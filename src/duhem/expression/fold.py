"""One walk over the tree for every back end: a table maps node classes to functions, nothing else differs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import sympy as sp

from duhem.errors import InputError
from duhem.expression.inert_number import InertNumber

__all__ = ["Table", "fold"]

T = TypeVar("T")
Table = Mapping[type, Callable[..., T]]


def fold(expr: sp.Basic, table: Table[T], leaf: Callable[[Any], T]) -> T:
    """Value of ``expr`` under ``table``: ``table[type(node)](node, *values of its arguments)``.

    ``leaf`` gives the value of symbols, numbers and constants.  Equal subtrees are evaluated once, and the walk is
    iterative, so depth is no limit.  A node class the table lacks raises InputError naming the sub-expression.
    """
    done: dict[sp.Basic, T] = {}
    stack: list[tuple[sp.Basic, bool]] = [(expr, False)]
    while stack:
        node, ready = stack.pop()
        if node in done:
            continue
        if not node.args:
            done[node] = leaf(node.value if isinstance(node, InertNumber) else node)
        elif ready:
            done[node] = _row(node, table)(node, *(done[a] for a in node.args))
        else:
            stack.append((node, True))
            stack.extend((a, False) for a in reversed(node.args))
    return done[expr]


def _row(node: sp.Basic, table: Table[T]) -> Callable[..., T]:
    row = table.get(type(node))
    if row is None:
        raise InputError(f"no meaning is given to {type(node).__name__} in {node}", remedy="rewrite that part of the formula")
    return row
