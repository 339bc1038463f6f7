"""Optimality of a slip increment, recomputed from the law's own formula whatever method solved it.

With |x|_k the norm of a slip (x . k x)^1/2 and of a stress (x . k^-1 x)^1/2, all five residuals are pure numbers,
unchanged by the units: a residual of size q moves the stress by about q of its own size.  They are the conditions of
Karush, Kuhn and Tucker for the closest point (R. T. Rockafellar, 1970, Convex Analysis, section 28), with Antoni et al.
(2007), Eq. (36).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.projection.increment import Increment
from duhem.projection.jets import Choices, Formula, Jet, formula
from duhem.projection.metric import factors
from duhem.projection.result import Array, Residuals, Solution

__all__ = ["residuals"]

_BLOCK = 16_384
_NUDGE = 1e-6  # relative; pieces of g that meet this close to a stress count as meeting in it
_SUSPECT = 1e-9  # a normal farther off than this is looked at again, as the normal of a corner
_HALVINGS = 1100


def residuals(increment: Increment, solution: Solution) -> Residuals:
    """The five residuals of each point (N,); nan or inf where the solution is."""
    n = len(solution.multiplier)
    out = Residuals(*(np.zeros(n) for _ in range(5)))
    judge = _Judge(increment)
    with np.errstate(all="ignore"):
        for start in range(0, n, _BLOCK):
            block = slice(start, start + _BLOCK)
            judge.fill(
                increment.trial[block],
                increment.pressure[block],
                Solution(solution.stress[block], solution.slip[block], solution.multiplier[block], solution.failed[block]),
                Residuals(*(getattr(out, name)[block] for name in Residuals.__dataclass_fields__)),
            )
    return out


class _Judge:
    """The law's formula, its slopes, and the metric of one set of increments."""

    def __init__(self, increment: Increment) -> None:
        law = increment.law
        self.forces = law.force_symbols()
        self.pressure = law.symbols()[law.pressure] if law.pressure else None
        self.formula: Formula = formula(increment.g, self.forces, () if self.pressure is None else (self.pressure,))
        names = self.forces if self.pressure is None else (*self.forces, self.pressure)
        self.g = compiled(increment.g, names)
        lower, inverse = factors(increment.stiffness)
        self.of_slip, self.of_stress = lower, inverse.T
        self.largest = float(increment.pressure.min(initial=0.0))
        with np.errstate(all="ignore"):
            self.reaches = self._reaches(self.largest)

    def value(self, stress: Array, pressure: Array) -> Array:
        return self.g(*stress.T) if self.pressure is None else self.g(*stress.T, pressure)

    def slopes(self, stress: Array, pressure: Array, choices: Choices | None = None) -> tuple[Jet, Choices]:
        return self.formula(stress, () if self.pressure is None else (pressure,), choices, second=False)

    def fill(self, trial: Array, pressure: Array, got: Solution, out: Residuals) -> None:
        """The residuals of one block."""
        moved = (got.multiplier != 0.0) | (_widest(got.slip) != 0.0) | (_widest(got.stress - trial) != 0.0)
        still = np.flatnonzero(~moved)
        g = self.value(got.stress[still], pressure[still])
        out.feasibility[still] = np.where(np.isnan(g), np.nan, 0.0)
        if (over := still[g > 0.0]).size:  # a stick on the boundary, to rounding
            jet, _ = self.slopes(got.stress[over], pressure[over])
            out.feasibility[over] = _share(jet.value, np.abs(_slope(jet.gradient) * got.stress[over]).sum(axis=1))
        at = np.flatnonzero(moved)
        if at.size:
            self._moved(at, trial[at], pressure[at], got, out)

    def _moved(self, at: NDArray[np.intp], trial: Array, pressure: Array, got: Solution, out: Residuals) -> None:
        stress, slip, multiplier = got.stress[at], got.slip[at], got.multiplier[at]
        jet, _ = self.slopes(stress, pressure)
        slope = _slope(jet.gradient)
        g = jet.value
        relative = _share(np.abs(g), np.abs(slope * stress).sum(axis=1))
        out.feasibility[at] = np.where(g <= 0.0, 0.0, relative)
        aim, point, moved = trial @ self.of_stress, stress @ self.of_stress, slip @ self.of_slip
        size = np.maximum(_widest(aim), _widest(point))
        size = np.where(size > 0.0, size, 1.0)[:, None]
        aim, point, moved, pull = aim / size, point / size, moved / size, multiplier[:, None] * slope @ self.of_slip / size
        distance, reach = _length(moved), _length(point)
        whole = distance + reach
        effort = np.sign(multiplier) * _share(_length(pull), whole)
        out.multiplier_sign[at] = np.maximum(-effort, 0.0)
        out.complementarity[at] = np.abs(effort) * relative
        balance = _share(_length(aim - moved - point), _length(aim) + reach)
        off = _share(_length(moved - pull), whole)
        if (suspect := np.flatnonzero(~(off <= _SUSPECT))).size:
            cone = self._off_cone(stress[suspect], pressure[suspect], slip[suspect], multiplier[suspect], trial[suspect])
            off[suspect] = np.fmin(off[suspect], _share(cone / size[suspect, 0], whole[suspect]))
        out.stationarity[at] = np.maximum(balance, off)
        variational = np.zeros(at.size)
        for known in self._known(pressure):
            inside = self.value(known, pressure) <= 0.0
            other = known @ self.of_stress / size
            excess = _share(((other - point) * moved).sum(axis=1), whole * (_length(other) + reach))
            variational = np.fmax(variational, np.where(inside, excess, 0.0))
        out.variational[at] = variational + 0.0 * whole

    def _known(self, pressure: Array) -> Iterator[Array]:
        """Points of K at each pressure, or close guesses: the origin, and what lies on the axes both ways."""
        n, d = pressure.size, len(self.forces)
        yield np.zeros((n, d))
        share = np.ones(n) if self.largest == 0.0 else pressure / self.largest
        for way, reach in zip(np.vstack([np.eye(d), -np.eye(d)]), self.reaches, strict=True):
            yield share[:, None] * (reach * way)

    def _reaches(self, pressure: float) -> Array:
        """How far K goes along the axes at one pressure, from within, by bisection; 0 where it does not contain the origin."""
        d = len(self.forces)
        ways = np.vstack([np.eye(d), -np.eye(d)])
        at = np.full(2 * d, pressure)
        low, high = np.zeros(2 * d), np.full(2 * d, 1e300)
        for _ in range(_HALVINGS):
            middle = np.where(low > 0.0, np.sqrt(low) * np.sqrt(high), high * 2.0**-64)
            middle = np.where(high < 1.5 * low, (low + high) / 2, middle)
            inside = self.value(middle[:, None] * ways, at) <= 0.0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
            if ((high - low <= 1e-12 * high) | (high == 0.0)).all():
                break
        return low

    def _off_cone(self, stress: Array, pressure: Array, slip: Array, multiplier: Array, trial: Array) -> Array:
        """Distance of each slip from lambda conv(the gradients of the pieces of g that meet in its stress)."""
        d = stress.shape[1]
        length = np.abs(stress).max(axis=1, keepdims=True)
        tip = length == 0.0
        nudge = _NUDGE * np.where(tip, np.abs(trial).max(axis=1, keepdims=True), length)
        normals, sizes = [], []
        for way in _ways(d):
            beside, pieces = self.slopes(stress + nudge * way, pressure)
            there, _ = self.slopes(stress, pressure, choices=pieces)
            normal = np.where(tip, _slope(beside.gradient), _slope(there.gradient)) @ self.of_slip
            sizes.append(_length(normal))
            normals.append(normal / sizes[-1][:, None])
        target = slip @ self.of_slip
        whole = _length(target)
        best = np.full(len(stress), np.inf)
        for count in range(1, d + 1):
            for chosen in combinations(range(len(normals)), count):
                basis = np.stack([normals[i] for i in chosen], axis=2)
                usable: NDArray[np.bool_] = np.asarray(np.isfinite(basis).all(axis=(1, 2)))
                weights = np.linalg.pinv(np.where(usable[:, None, None], basis, 0.0), rcond=1e-9) @ target[:, :, None]
                weights = np.maximum(weights, 0.0)
                left = _length(target - (basis @ weights)[:, :, 0])
                share = (weights[:, :, 0] / np.stack([sizes[i] for i in chosen], axis=1)).sum(axis=1)
                amount = np.where(tip[:, 0], 0.0, np.abs(share / multiplier - 1.0) * whole)  # a tip has gradients between those found
                best = np.fmin(best, np.where(usable, np.maximum(left, amount), np.inf))
        return best


def _ways(d: int) -> Array:
    """The axes both ways, and in few dimensions what lies between them."""
    grid = np.stack(np.meshgrid(*([[-1.0, 0.0, 1.0]] * min(d, 3)), indexing="ij"), axis=-1).reshape(-1, min(d, 3))
    return grid[(grid != 0.0).any(axis=1)] if d <= 2 else np.vstack([np.eye(d), -np.eye(d)])


def _length(vectors: Array) -> Array:
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


def _widest(vectors: Array) -> Array:
    """The largest size of a component, column by column: there are many rows and few columns."""
    return reduce(np.maximum, np.abs(vectors).T)


def _slope(gradient: Array | None) -> Array:
    assert gradient is not None
    return gradient


def _share(part: Array, whole: Array) -> Array:
    """part/whole, with 0/0 = 0."""
    return np.where(part == 0.0, 0.0, part / whole)
