"""Slip increments onto the shape a law declares (:mod:`duhem.law.shapes`): exact to rounding, no iteration to tune."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Interval
from duhem.projection import quadrants
from duhem.projection.allocation import keep_freed_memory
from duhem.projection.closed_form_tangent import tangent
from duhem.projection.coefficients import Coefficients, centre, coefficients, declared, of_one_pressure, of_pressure, own_entries, uniform
from duhem.projection.in_blocks import BLOCK, in_blocks
from duhem.projection.increment import Increment
from duhem.projection.method import ClosestPoint, Compiling, Method
from duhem.projection.quadrants import Quarters, plain_closest
from duhem.projection.result import Array, Solution

__all__ = ["CLOSED_FORM", "ClosedFormOptions", "applies", "solve"]

_BLOCK = 2 * BLOCK  # of which the formulas take a quarter at a time
_COMPILED_BLOCK = 32_768  # the kernel has blocks of its own; these are for what NumPy does before and after it


@dataclass(frozen=True)
class ClosedFormOptions(Compiling):
    """Compiled, the formulas are the same.

    ``into``: the solution of as many points, written over and returned: memory that the system has to find and to clear
    first may cost half as much again.
    """

    into: Solution | None = None


_DEFAULTS = ClosedFormOptions()


def applies(increment: Increment) -> str | None:
    """None where the law declares a shape this method projects onto, else why not, with the remedy."""
    if (reason := _unfit(increment.law)) is not None:
        return reason
    if 0.0 in coefficients(increment).mu and not increment.diagonal:
        return "a zero coefficient and a stiffness that couples the forces: give a diagonal stiffness"
    return None


@lru_cache(maxsize=256)
def _unfit(law: Criterion) -> str | None:
    """Why a law has no closed form, whatever its numbers."""
    shape = law.closed_form
    if shape is None:
        return f"{law.name} declares no closed form: use method newton or cvxpy"
    if len(law.forces) != (1 if isinstance(shape, Interval) else 2):
        return f"the closed form of {law.name} does not fit its {len(law.forces)} forces: use method newton or cvxpy"
    pressure = law.symbols().get(law.pressure or "")
    if any(pressure in sp.sympify(entry).free_symbols for entry in own_entries(shape)):
        return f"a coefficient in the closed form of {law.name} depends on the pressure: write that part in its load"
    return None


def solve(increment: Increment, options: ClosedFormOptions = _DEFAULTS) -> Solution:
    """The closest points, in blocks; units as in :class:`Increment`."""
    n, d = increment.trial.shape
    solution = _room(n, d) if options.into is None else _checked(options.into, n, d)
    shape = declared(increment)
    found = coefficients(increment)
    project = _on_interval(found, increment) if isinstance(shape, Interval) else _on_quarters(found, increment, bool(options.compiled))
    load, share = of_pressure(increment, shape.load), _share(increment, found)
    middles = [of_pressure(increment, c) for c in centre(shape)]
    size = _COMPILED_BLOCK if options.compiled else _BLOCK
    keep_freed_memory(n)

    def fill(block: slice) -> None:
        pressure = increment.pressure[block]
        middle = np.stack([c(pressure) for c in middles], axis=1) if middles else None
        trial = increment.trial[block] if middle is None else increment.trial[block] - middle
        stress, slip, multiplier = solution.stress[block], solution.slip[block], solution.multiplier[block]
        e = np.zeros_like(pressure) if found.empty else load(pressure)
        project(trial, e, stress, slip, multiplier)
        if middle is not None:
            slips = multiplier > 0.0
            stress[:] = np.where(slips[:, None], stress + middle, increment.trial[block])
            multiplier[~np.isfinite(stress).all(axis=1)] = np.nan
        if share is not None:
            multiplier /= share(pressure)
        failed = np.isfinite(multiplier, out=solution.failed[block])
        np.logical_not(failed, out=failed)

    in_blocks(n, size, fill, options.sharing)
    return solution


def plain(increment: Increment, compiled: bool = False) -> ClosestPoint | None:
    """The closest point to one trial on plain numbers; None for a shape in one force, one that is moved and one that may be empty."""
    shape, found = declared(increment), coefficients(increment)
    slope = uniform(increment, shape.slope)
    if isinstance(shape, Interval) or centre(shape) or found.empty or slope is None or 0.0 in found.mu:
        return None
    quarters, load = _quarters(found.mu, increment.stiffness.tobytes()), of_one_pressure(increment, shape.load)
    share = (slope if slope > 0.0 else 1.0) * found.scale
    if compiled:
        from duhem.projection.compiled import compiled_closest

        at = compiled_closest(quarters)

        def by_numba(trial: Array, pressure: Array) -> Any:
            stress, slip, multiplier = at(trial, load(pressure.item()))
            multiplier[0] = own = multiplier.item() / share
            return (stress, slip, multiplier) if isfinite(own) else None

        return by_numba

    def closest(trial: Sequence[float], pressure: float) -> Any:
        with np.errstate(all="ignore"):
            answer = plain_closest(quarters, trial, load(pressure))
        if answer is None or not isfinite(answer[2]):
            return None
        stress, slip, multiplier = answer
        return stress, slip, multiplier / share

    return closest


def _share(increment: Increment, found: Coefficients) -> Callable[[Array], Array] | None:
    """What to divide the multiplier of the shape's gauge by to have that of the law's g; None for 1 everywhere.

    No slope where K is one point: every slip is normal.
    """
    steep = declared(increment).slope
    if uniform(increment, steep) == 1.0 and found.scale == 1.0:
        return None
    slope = of_pressure(increment, steep)

    def share(pressure: Array) -> Array:
        at = slope(pressure)
        return np.where(at > 0.0, at, 1.0) * found.scale

    return share


def _room(n: int, d: int) -> Solution:
    return Solution(np.empty((n, d)), np.empty((n, d)), np.empty(n), np.empty(n, dtype=np.bool_))


def _checked(into: Solution, n: int, d: int) -> Solution:
    """``into`` where it fits the question."""
    if not isinstance(into, Solution):
        raise InputError(f"into is {into!r}", where="into", remedy="give a Solution, or leave it out")
    expected = {field.name: getattr(_room(0, d), field.name) for field in fields(Solution)}
    for name, like in expected.items():
        given = getattr(into, name)
        if given.shape != (n, *like.shape[1:]) or given.dtype != like.dtype or not given.flags.c_contiguous or not given.flags.writeable:
            what = f"{name} of into has shape {given.shape} and type {given.dtype}, not {(n, *like.shape[1:])} and {like.dtype}"
            raise InputError(what, where="into", remedy="give a solution of as many points, whole and writable")
    return into


Project = Callable[[Array, Array, Array, Array, Array], None]


def _on_quarters(found: Coefficients, increment: Increment, compiled: bool) -> Project:
    quarters = _quarters(found.mu, increment.stiffness.tobytes())
    if compiled:
        from duhem.projection.compiled import project
    else:
        from duhem.projection.quadrants import project

    return lambda trial, load, *out: project(trial, load, quarters, *out)


@lru_cache(maxsize=256)
def _quarters(mu: tuple[float, ...], stiffness: bytes) -> Quarters:
    """Once for increments that follow one another."""
    return Quarters.of(mu, np.frombuffer(stiffness).reshape(2, 2))


def _on_interval(found: Coefficients, increment: Increment) -> Project:
    plus, minus = found.mu
    stiffness = float(increment.stiffness[0, 0])

    def project(trial: Array, load: Array, stress: Array, slip: Array, multiplier: Array) -> None:
        mu = np.where(trial[:, 0] < 0.0, minus, plus)
        stress[:, 0], slip[:, 0], multiplier[:] = quadrants.clamped(trial[:, 0], mu, load, stiffness)

    return project


CLOSED_FORM = Method("closed-form", applies, solve, ClosedFormOptions, tangent, convex=True, plain=plain)
