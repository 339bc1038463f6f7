"""Seams as simple as they are: where two roots are compared, what is under them is."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from duhem.expression import Norm
from duhem.expression.branches import Branch, oriented

__all__ = ["plain_switches"]


def plain_switches(pieces: Iterable[Branch]) -> tuple[Branch, ...]:
    """The branches with each switch sqrt(p) - sqrt(q) replaced by p - q, which has its sign and no root."""
    found = []
    for piece in pieces:
        signs: dict[sp.Expr, int] = {}
        for switch, sign in piece.signs.items():
            core, flip = oriented(_squared(switch))
            if core in signs and signs[core] != sign * flip:
                core, flip = switch, 1  # two switches that have become one: kept apart, as they came
            signs[core] = sign * flip
        found.append(Branch(signs, piece.expr))
    return tuple(found)


def _squared(switch: sp.Expr) -> sp.Expr:
    if not (switch.is_Add and len(switch.args) == 2):
        return switch
    squares = [_square(term) for term in switch.args]
    if None in squares or {s.is_positive for _, s in squares} != {True, False}:  # type: ignore[misc]
        return switch
    return sp.expand(sp.Add(*(square * sense for square, sense in squares)))  # type: ignore[misc]


def _square(term: sp.Expr) -> tuple[sp.Expr, sp.Integer] | None:
    """The square of +- a root, or of a number, and the sign; None for anything else."""
    scale, root = term.as_coeff_Mul()
    if not scale.is_Rational:
        return None
    if isinstance(root, Norm):
        under = sp.Add(*(c**2 for c in root.args))
    elif root.is_Pow and root.exp == sp.S.Half and root.base.is_nonnegative:  # else it may be undefined
        under = root.base
    elif root == 1:
        under = root
    else:
        return None
    return scale**2 * under, sp.sign(scale)
