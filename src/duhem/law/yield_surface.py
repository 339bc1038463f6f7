"""One of several surfaces that bound K, with the slip on it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from duhem.expression.verbatim import Verbatim

if TYPE_CHECKING:
    from collections.abc import Callable

    import sympy as sp

__all__ = ["YieldSurface"]


@dataclass(frozen=True)
class YieldSurface(Verbatim):
    """K lies in {g <= 0}; where g = 0 the slip is a non-negative multiple of ``flow``, one expression per force.

    ``potential`` is a formula whose gradient is the flow, instead of ``flow``; neither means associated: the slip is normal to K.
    Text and SymPy expressions as for :class:`duhem.law.formula_law.Criterion`, which reads them; ``written`` and
    ``written_flow`` are g and flow as they were given, where that was text.
    """

    g: sp.Expr
    flow: tuple[sp.Expr, ...] | None = None
    potential: str | None = None
    written: str = field(default="", repr=False, compare=False)
    written_flow: tuple[str, ...] = field(default=(), repr=False, compare=False)

    def map(self, change: Callable[[sp.Expr], sp.Expr]) -> YieldSurface:
        """The same with every expression changed, and no longer the texts it came from."""
        return YieldSurface(change(self.g), None if self.flow is None else tuple(map(change, self.flow)))
