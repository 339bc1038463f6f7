"""The blocks a formula is read into, and the gauge they make: forms of the forces with weights, joined by norms."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import sympy as sp

from duhem.derivation.gauge import Gauge, Holder, Polytope, Quadratic, Separable, Side

__all__ = ["Facets", "Form", "Leaf", "Node", "Tree", "UnreadError", "assemble", "independent", "scaled"]

Row = tuple[sp.Expr, ...]


class UnreadError(Exception):
    """No rule reads the formula."""


@dataclass(frozen=True)
class Leaf:
    """The gauge ``side`` of row . x - offset."""

    side: Side
    row: Row
    offset: sp.Expr


@dataclass(frozen=True)
class Node:
    """The p-norm of its parts."""

    p: sp.Expr
    parts: tuple[Leaf | Node, ...]


@dataclass(frozen=True)
class Form:
    """sqrt((x - centre) . matrix (x - centre)) for a form that is not diagonal."""

    matrix: sp.ImmutableMatrix
    centre: Row


@dataclass(frozen=True)
class Facets:
    """max of row . x / limit over (row, limit)."""

    arms: tuple[tuple[Row, sp.Expr], ...]


Tree = Leaf | Node | Form | Facets


def scaled(tree: Leaf | Node, factor: sp.Expr) -> Leaf | Node:
    """``factor`` times the gauge."""
    if isinstance(tree, Node):
        return Node(tree.p, tuple(scaled(part, factor) for part in tree.parts))
    return Leaf(Side(tree.side.up * factor, tree.side.down * factor), tree.row, tree.offset)


def independent(rows: sp.Matrix) -> bool:
    """Whether the rows are linearly independent (for symbols: at general values)."""
    return bool(rows.rows <= rows.cols and rows.rank() == rows.rows)


def assemble(tree: Tree, radius: sp.Expr) -> tuple[Gauge, Row, sp.Expr, sp.Expr]:
    """(gauge, centre, radius, an expression that must be positive for it to hold); raises UnreadError."""
    if isinstance(tree, Form):
        return Quadratic(tree.matrix), tree.centre, radius, sp.S.One
    if isinstance(tree, Facets):
        return _polytope([(row, limit * radius) for row, limit in tree.arms])
    leaves = list(_leaves(tree))
    rows = sp.ImmutableMatrix([list(leaf.row) for leaf in leaves])
    if independent(rows):
        offsets = sp.Matrix([leaf.offset for leaf in leaves])
        gram = rows * rows.T
        centre = (rows.T * gram.inv() * offsets).applyfunc(sp.cancel) if any(offsets) else sp.zeros(rows.cols, 1)
        return Separable(_tree_of(tree), rows), tuple(centre), radius, sp.factor(gram.det())
    if not isinstance(tree, Node) or not all(isinstance(p, Leaf) and p.side.symmetric and p.offset == 0 for p in tree.parts):
        raise UnreadError
    if tree.p == 2:
        weights = sp.diag(*[leaf.side.up**2 for leaf in leaves])
        matrix = sp.ImmutableMatrix(rows.T * weights * rows).applyfunc(sp.cancel)
        kept = list(matrix.rref(simplify=True)[1])  # its rank at general values; at special ones it may be less
        return Quadratic(matrix), (sp.S.Zero,) * rows.cols, radius, sp.factor(matrix[kept, kept].det())
    if tree.p is sp.oo:
        return _polytope([(tuple(sign * c for c in leaf.row), radius / leaf.side.up) for leaf in leaves for sign in (1, -1)])
    if tree.p == 1:
        return _polytope([(row, radius) for row in _signed_sums(leaves)])
    raise UnreadError


def _polytope(arms: Sequence[tuple[Row, sp.Expr]]) -> tuple[Gauge, Row, sp.Expr, sp.Expr]:
    """{row . x <= limit}: numeric up to one common positive factor, which becomes the radius."""
    radius = arms[0][1]
    rows = sp.Matrix([[sp.cancel(c * radius / limit) for c in row] for row, limit in arms])
    if any(not c.is_number for c in rows):
        raise UnreadError
    ball = Polytope.of(rows)
    if ball is None:
        raise UnreadError
    return ball, (sp.S.Zero,) * rows.cols, radius, sp.S.One


def _leaves(tree: Leaf | Node) -> Iterator[Leaf]:
    if isinstance(tree, Leaf):
        yield tree
    else:
        for part in tree.parts:
            yield from _leaves(part)


def _tree_of(tree: Leaf | Node) -> Side | Holder:
    return tree.side if isinstance(tree, Leaf) else Holder(tree.p, tuple(_tree_of(part) for part in tree.parts))


def _signed_sums(leaves: Sequence[Leaf]) -> Iterator[Row]:
    """A sum of absolute values is the greatest of these."""
    rows = [[leaf.side.up * c for c in leaf.row] for leaf in leaves]
    for signs in product((1, -1), repeat=len(rows)):
        row = tuple(sp.Add(*[s * v for s, v in zip(signs, column, strict=True)]) for column in zip(*rows, strict=True))
        if any(row):
            yield row
