"""A formula in doubles with its limits where it is 0/0: on the hydrostatic axis, where a deviator has no angle, for one.

Where it has no value the formula is read beside the point, four ways and at distances h, h/2, h/4 and h/8.  Three of them give
the limit without its terms in h and h^2 (L. F. Richardson, 1911): (f(h) - 6 f(h/2) + 8 f(h/4))/3.  It is taken where all of
them agree, so that holes are filled and no domain grows: beyond an end of its domain the formula has no value on one side.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.expression.numpy_ import Program, compiled
from duhem.expression.vocabulary import Atan2

__all__ = ["Filled", "filled"]

Array = NDArray[np.float64]

_STEP = 2.0**-20  # of each number
_STEP_AT_ZERO = 2.0**-200  # nothing cancels there
_AGREED = 1e-3  # of what the formula changes by over a step
_PARTS = np.array([1.0, 0.5, 0.25, 0.125])
_WEIGHTS = np.array([1.0, -6.0, 8.0])  # over 3


def filled(expr: sp.Basic, symbols: Iterable[sp.Symbol]) -> Program:
    """``expr`` as a function of ``symbols``, like :func:`duhem.expression.numpy_.compiled`.

    It has limits if the formula divides by one of them or takes an angle of them.
    """
    plain = compiled(expr, symbols)
    divides = any(power.exp.could_extract_minus_sign() and power.base.free_symbols for power in expr.atoms(sp.Pow))
    turns = any(angle.free_symbols for angle in expr.atoms(Atan2))
    return Filled(plain.symbols, plain.recording) if divides or turns else plain


@dataclass(frozen=True)
class Filled(Program):
    """A program that gives the limit where its formula has one and no value; nan where it has neither."""

    def __call__(self, *values: ArrayLike) -> Array:
        """The formula, or its limit, at one array per symbol."""
        found = super().__call__(*values)
        lost = np.isnan(found)
        if lost.any():
            at = [np.broadcast_to(np.asarray(v, dtype=np.float64), found.shape)[lost] for v in values]
            found = np.array(found)
            found[lost] = self._limits(np.stack(at, axis=1))
        return found

    def _limits(self, at: Array) -> Array:
        """At points (n, symbols)."""
        limits = np.full(len(at), np.nan)
        ways = _ways(at.shape[1])
        with np.errstate(all="ignore"):
            step = np.where(at == 0.0, _STEP_AT_ZERO, _STEP * np.abs(at))
            first = super().__call__(*(at + step * ways[0]).T)
            who = np.flatnonzero(np.isfinite(first))  # most points without a value lie beyond the domain
            if who.size:
                beside = at[who, None, None] + _PARTS[:, None, None] * step[who, None, None] * ways  # (m, parts, ways, symbols)
                read = super().__call__(*np.moveaxis(beside, -1, 0))
                guesses = np.stack([np.einsum("mpw,p->mw", read[:, i : i + 3], _WEIGHTS) for i in (0, 1)], axis=1) / 3.0
                guesses = guesses.reshape(who.size, -1)
                spread, change = np.ptp(guesses, axis=1), np.abs(read - guesses[:, :1, None]).max(axis=(1, 2))
                limits[who] = np.where(spread <= _AGREED * change, guesses.mean(axis=1), np.nan)
        return limits


def _ways(d: int) -> Array:
    """Directions (4, d) with nothing to them, two and their opposites, the same each time."""
    ways = np.random.default_rng(0).uniform(0.5, 1.0, (2, d)) * np.where(np.arange(d) % 2 == 0, 1.0, [[-1.0], [1.0]])
    return np.vstack([ways, -ways])
