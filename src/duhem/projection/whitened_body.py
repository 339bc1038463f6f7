"""The set K of each point in working units: lengths of its own size, stresses whitened by the stiffness.

With the stiffness k = kappa L L^T (kappa its mean eigenvalue) and a size R of K a point, stresses are sigma = R x and
x = L u; distances |u| are then the k^-1 metric up to a factor, and K has extent 1 in the direction of the trial.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.jets import Choices, JetProgram, formula, program
from duhem.expression.numpy_ import Program
from duhem.projection.increment import Increment
from duhem.projection.result import Array
from duhem.projection.row_by_row import length, times
from duhem.projection.scaled_formula import ScaledFormula

__all__ = ["Body", "Index", "Piece", "body", "whitening"]

Index = NDArray[np.intp]


@dataclass(frozen=True)
class Piece:
    """A smooth piece at a point, its level a signed distance to first order, in whitened units.

    ``level`` (M,), unit ``normal`` (M, d), ``curvature`` (M, d, d) the Hessian over the slope; ``slope`` (M,) = |grad h|;
    ``choices`` (M, kinks) name the piece.
    """

    level: Array
    normal: Array
    curvature: Array
    slope: Array
    choices: Choices


@dataclass(frozen=True)
class Body:
    """K = {h <= 0} of N points; ``root`` is L; ``data`` what h holds besides the forces, (N,) each; ``size`` R (N,)."""

    scaled: ScaledFormula
    value: Program
    jets: JetProgram
    data: tuple[Array, ...]
    size: Array
    root: Array

    def resized(self, pressure: Array, size: Array) -> Body:
        """The same bodies measured by other sizes."""
        values = self.scaled.values(pressure, size)
        return Body(self.scaled, self.value, self.jets, tuple(values[q] for q in self.scaled.data), size, self.root)

    def of(self, at: Index) -> Body:
        """The bodies of the points ``at`` alone."""
        return Body(self.scaled, self.value, self.jets, tuple(q[at] for q in self.data), self.size[at], self.root)

    def whitened(self, x: Array) -> Array:
        """u = L^-1 x."""
        u = np.empty_like(x)
        for i, row in enumerate(self.root):  # which is lower triangular
            u[:, i] = (x[:, i] - sum(row[j] * u[:, j] for j in range(i) if row[j])) / row[i]
        return u

    def level(self, x: Array, at: Index) -> Array:
        """h at the stresses ``x`` (M, d) of the points ``at``; where h is undefined, outside."""
        found = self.value(*x.T, *(q[at] for q in self.data))
        return np.where(np.isnan(found), np.inf, found)

    def piece(self, x: Array, at: Index, choices: Choices | None = None, second: bool = True) -> Piece:
        """The smooth piece that holds at ``x``, or the one that ``choices`` name."""
        jet, taken = self.jets(x, [q[at] for q in self.data], choices, second)
        assert jet.gradient is not None
        with np.errstate(all="ignore"):
            gradient = times(jet.gradient, self.root)
            slope = length(gradient)
            slope = np.where(np.isfinite(slope), slope, np.nan)  # of an infinite one every level would be a share of nothing
            unit = 1.0 / slope
            curvature = np.zeros((len(at), 0, 0))
            if jet.hessian is not None:
                curvature = (self.root.T @ jet.hessian @ self.root) * unit[:, None, None]
            return Piece(jet.value * unit, gradient * unit[:, None], curvature, slope, taken)


def body(scaled: ScaledFormula, forces: tuple[sp.Symbol, ...], pressure: Array, size: Array, root: Array) -> Body:
    """The bodies of one law, measured by ``size`` (N,)."""
    data = tuple(scaled.data)
    empty = Body(scaled, program(scaled.expr, (*forces, *data)), formula(scaled.expr, forces, data), (), size, root)
    return empty.resized(pressure, size)


def whitening(increment: Increment) -> tuple[float, Array]:
    """Mean eigenvalue kappa of the stiffness and L with k = kappa L L^T; diagonal stiffness keeps L diagonal."""
    k = increment.stiffness
    with np.errstate(over="ignore"):
        mean = float(np.trace(k) / len(k))
    mean = mean if np.isfinite(mean) else float(np.max(np.diagonal(k)))  # any size near theirs does, where only the sum overflows
    return mean, np.diag(np.sqrt(np.diag(k) / mean)) if increment.diagonal else np.asarray(np.linalg.cholesky(k / mean))
