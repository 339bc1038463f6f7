"""Where a formula changes its piece: what is compared with what in its kinks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import sympy as sp

from duhem.expression import Neg, Pos, Where

__all__ = ["Switch", "switches"]

_MOST = 24  # arguments of a maximum, beyond which the seams between them are not looked for

Switch = tuple[sp.Expr, tuple[sp.Expr, ...]]
"""An expression that is 0 on a seam, and others that are <= 0 where the seam is one: elsewhere another piece holds."""


def switches(g: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[Switch, ...]:
    """The seams of a formula by the forces, each once; a factor in front of a comparison is dropped."""
    found: dict[sp.Expr, Switch] = {}
    for node in sp.preorder_traversal(g):
        for switch, others in _of(node):
            plain = switch.as_coeff_Mul()[1]
            if plain.free_symbols & set(forces):
                found.setdefault(plain, (switch, others))
    return tuple(found.values())


def _of(node: sp.Basic) -> Iterator[Switch]:
    if isinstance(node, sp.Abs | Pos | Neg):
        yield node.args[0], ()
    elif isinstance(node, sp.Max | sp.Min) and len(node.args) <= _MOST:
        sense = 1 if isinstance(node, sp.Max) else -1
        for a, b in combinations(node.args, 2):
            yield a - b, tuple(sense * (c - a) for c in node.args if c not in (a, b))
    elif isinstance(node, Where):
        for relation in node.args[0].atoms(sp.core.relational.Relational):
            yield relation.lhs - relation.rhs, ()
