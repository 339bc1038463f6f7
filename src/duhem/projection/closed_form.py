"""Slip increments onto the shape a law declares (:mod:`duhem.closed_form`): exact to rounding, no iteration to tune."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import sympy as sp

from duhem.closed_form import Interval
from duhem.projection import quadrants
from duhem.projection.increment import Increment
from duhem.projection.quadrants import BLOCK, Quarters
from duhem.projection.result import Array, Solution
from duhem.projection.shape import Coefficients, centre, coefficients, declared, of_pressure, own_entries
from duhem.projection.tangent import tangent

__all__ = ["applies", "solve", "tangent"]


# Until arrays of megabytes have come and gone, the C library gives the memory of a larger block back after each operation
# and has it faulted in again, at twice the time; the checks of this many points are such arrays.
_MANY, _SMALL_BLOCK = 300_000, 6_144


def applies(increment: Increment) -> str | None:
    """None where the law declares a shape this method projects onto, else why not, with the remedy."""
    law, shape = increment.law, increment.law.closed_form
    if shape is None:
        return f"{law.name} declares no closed form: use method newton or cvxpy"
    if len(law.forces) != (1 if isinstance(shape, Interval) else 2):
        return f"the closed form of {law.name} does not fit its {len(law.forces)} forces: use method newton or cvxpy"
    pressure = law.symbols().get(law.pressure or "")
    if any(pressure in sp.sympify(entry).free_symbols for entry in own_entries(shape)):
        return f"a coefficient in the closed form of {law.name} depends on the pressure: write that part in its load"
    if 0.0 in coefficients(increment).mu and not increment.diagonal:
        return "a zero coefficient and a stiffness that couples the forces: give a diagonal stiffness"
    return None


def solve(increment: Increment, *, compiled: bool = False) -> Solution:
    """The closest points, in blocks; units as in :class:`Increment`.

    ``compiled`` runs the same formulas through numba; a missing numba raises MissingExtraError.
    """
    n, d = increment.trial.shape
    solution = Solution(np.empty((n, d)), np.empty((n, d)), np.empty(n), np.zeros(n, dtype=np.bool_))
    shape = declared(increment)
    found = coefficients(increment)
    project = _on_interval(found, increment) if isinstance(shape, Interval) else _on_quarters(found, increment, compiled)
    load, slope = of_pressure(increment, shape.load), of_pressure(increment, shape.slope)
    middles = [of_pressure(increment, c) for c in centre(shape)]
    size = BLOCK if n >= _MANY else _SMALL_BLOCK
    for start in range(0, n, size):
        block = slice(start, start + size)
        pressure = increment.pressure[block]
        middle = np.stack([c(pressure) for c in middles], axis=1) if middles else None
        trial = increment.trial[block] if middle is None else increment.trial[block] - middle
        stress, slip, multiplier = solution.stress[block], solution.slip[block], solution.multiplier[block]
        e = np.zeros_like(pressure) if found.empty else load(pressure)
        project(trial, e, stress, slip, multiplier)
        if middle is not None:
            slips = multiplier > 0.0
            stress[:] = np.where(slips[:, None], stress + middle, increment.trial[block])
        steep = slope(pressure)
        multiplier /= np.where(steep > 0.0, steep, 1.0) * found.scale  # no slope where K is one point: every slip is normal
        sound = np.isfinite(multiplier)
        for i in range(d):  # column by column: there are many rows and few columns
            sound &= np.isfinite(stress[:, i]) & np.isfinite(slip[:, i])
        np.logical_not(sound, out=solution.failed[block])
    return solution


Project = Callable[[Array, Array, Array, Array, Array], None]


def _on_quarters(found: Coefficients, increment: Increment, compiled: bool) -> Project:
    quarters = Quarters.of(found.mu, increment.stiffness)
    if compiled:
        from duhem.projection.compiled import project
    else:
        from duhem.projection.quadrants import project

    return lambda trial, load, *out: project(trial, load, quarters, *out)


def _on_interval(found: Coefficients, increment: Increment) -> Project:
    plus, minus = found.mu
    stiffness = float(increment.stiffness[0, 0])

    def project(trial: Array, load: Array, stress: Array, slip: Array, multiplier: Array) -> None:
        mu = np.where(trial[:, 0] < 0.0, minus, plus)
        stress[:, 0], slip[:, 0], multiplier[:] = quadrants.clamped(trial[:, 0], mu, load, stiffness)

    return project
