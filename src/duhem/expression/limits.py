"""A formula in doubles with its limits where it is 0/0: on the hydrostatic axis, where a deviator has no angle, for one.

At a stress without a value the formula is read beside it, four ways and at distances h, h/2, h/4 and h/8.  Three of them give
the limit without its terms in h and h^2 (L. F. Richardson, 1911): (f(h) - 6 f(h/2) + 8 f(h/4))/3.  It is taken where all of
them agree, so that holes are filled and no domain grows: beyond an end of its domain the formula has no value on one side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.expression.numpy_ import Program

__all__ = ["Filled", "filled"]

Array = NDArray[np.float64]

_STEP = 2.0**-20  # of a stress
_STEP_AT_ZERO = 2.0**-200  # in Pa: nothing cancels there
_AGREED = 1e-3  # of what the formula changes by over a step
_PARTS = np.array([1.0, 0.5, 0.25, 0.125])
_WEIGHTS = np.array([1.0, -6.0, 8.0])  # over 3


@dataclass(frozen=True)
class Filled:
    """``program`` over the forces, ``forces`` of them, and then other symbols."""

    program: Program
    forces: int

    def __call__(self, *values: ArrayLike) -> Array:
        """The formula, or its limit in the forces, at one array per symbol; nan where it has neither."""
        found = self.program(*values)
        lost = np.isnan(found)
        if lost.any():
            at = [np.broadcast_to(np.asarray(v, dtype=np.float64), found.shape)[lost] for v in values]
            found = np.array(found)
            found[lost] = self._limits(np.stack(at[: self.forces], axis=1), at[self.forces :])
        return found

    def _limits(self, at: Array, others: Sequence[Array]) -> Array:
        """At (n, forces), (n,) each of the others."""
        limits = np.full(len(at), np.nan)
        size = np.abs(at).max(axis=1)
        step = np.where(size > 0.0, _STEP * size, _STEP_AT_ZERO)
        ways = _ways(self.forces)
        with np.errstate(all="ignore"):
            first = self.program(*(at + step[:, None] * ways[0]).T, *others)
            who = np.flatnonzero(np.isfinite(first))  # most points without a value lie beyond the domain
            if who.size:
                beside = at[who, None, None] + (step[who, None, None] * _PARTS[:, None])[..., None] * ways
                shape = beside.shape[:3]  # (m, parts, ways)
                rest = [np.broadcast_to(v[who, None, None], shape) for v in others]
                read = self.program(*np.moveaxis(beside, -1, 0), *rest)
                guesses = (
                    np.stack([np.einsum("mpw,p->mw", read[:, i : i + 3], _WEIGHTS) for i in (0, 1)], axis=1).reshape(who.size, -1) / 3.0
                )
                spread, change = np.ptp(guesses, axis=1), np.abs(read - guesses[:, :1, None]).max(axis=(1, 2))
                limits[who] = np.where(spread <= _AGREED * change, guesses.mean(axis=1), np.nan)
        return limits


def filled(program: Program, expr: sp.Basic, forces: Sequence[sp.Symbol]) -> Program | Filled:
    """``program``, of ``expr`` over the ``forces`` and what follows them, with limits where a divisor of forces may vanish."""
    acting = {*forces}
    divides = any(power.exp.could_extract_minus_sign() and power.base.free_symbols & acting for power in expr.atoms(sp.Pow))
    return Filled(program, len(acting)) if divides else program


def _ways(d: int) -> Array:
    """Directions (4, d) with nothing to them, two and their opposites, the same each time."""
    ways = np.random.default_rng(0).standard_normal((2, d))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return np.vstack([ways, -ways])
