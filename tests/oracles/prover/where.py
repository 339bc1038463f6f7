"""Where branches and their seams lie, as relations."""

from __future__ import annotations

import sympy as sp

from duhem.expression.branches import Branch, Seam

__all__ = ["interior", "on", "within"]


def interior(piece: Branch) -> tuple[sp.Basic, ...]:
    """The region of a branch without its boundary."""
    return tuple(sp.StrictGreaterThan(sign * switch, 0) if sign else sp.Eq(switch, 0) for switch, sign in piece.signs.items())


def on(seam: Seam) -> tuple[sp.Basic, ...]:
    """That the switches crossed are 0."""
    return tuple(sp.Eq(s, 0) for s in seam.crossed)


def within(seam: Seam) -> tuple[sp.Basic, ...]:
    """That the others have the signs both branches give them."""
    return tuple(sp.GreaterThan(sign * s, 0) for s, sign in seam.kept.items())
