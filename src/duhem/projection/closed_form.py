"""Slip increments onto the shape a law declares (:mod:`duhem.law.shapes`): exact to rounding, no iteration to tune, with tangents."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from math import inf, isfinite
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.expression.jets import formula
from duhem.expression.numpy_ import Program, compiled
from duhem.expression.scalar_jets import scalar_values
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants, Shape
from duhem.projection import quadrants
from duhem.projection.in_blocks import BLOCK, in_blocks, keep_freed_memory
from duhem.projection.increment import Increment, factors
from duhem.projection.method import ClosestPoint, Compiling, Method
from duhem.projection.plain_numbers import interpreted
from duhem.projection.quadrants import Quarters, plain_closest
from duhem.projection.result import Array, Solution

__all__ = ["CLOSED_FORM", "ClosedFormOptions", "applies", "centre", "in_columns", "solve"]

# -- the shape at the parameter values of an increment ------------------------------------------------------------------


@dataclass(frozen=True)
class Coefficients:
    """The declared shape at the parameter values: ``mu`` for each sense of each force.

    The shape's own gauge is ``scale`` times norm(sigma/mu).  A disk without size is a point: ``empty``.
    """

    mu: tuple[float, ...]
    scale: float = 1.0
    empty: bool = False


def declared(increment: Increment) -> Shape:
    """The shape, where the law declares one."""
    shape = increment.law.closed_form
    assert shape is not None, increment.law.name
    return shape


def coefficients(increment: Increment) -> Coefficients:
    """The coefficients of the declared shape at the parameter values."""
    return _coefficients(increment.law, declared(increment), _values(increment))


@lru_cache(maxsize=256)
def _coefficients(law: Criterion, shape: Shape, values: tuple[float, ...]) -> Coefficients:
    def number(entry: object) -> float:
        value = _at(law, entry, values)
        assert isinstance(value, float), entry  # refused by applies
        return value

    match shape:
        case Interval():
            return Coefficients((number(shape.plus), number(shape.minus)))
        case Disk():
            mu = number(shape.coefficient)
            return Coefficients((mu,) * 4, mu) if mu > 0.0 else Coefficients((1.0,) * 4, empty=True)
        case Quadrants():
            return Coefficients(tuple(map(number, (shape.a_plus, shape.a_minus, shape.b_plus, shape.b_minus))))


def of_pressure(increment: Increment, entry: object) -> Callable[[Array], Array]:
    """An entry of the shape as a function of the pressures (n,)."""
    values = _values(increment)
    value = _at(increment.law, entry, values)
    if isinstance(value, float):
        return lambda pressure: np.broadcast_to(value, pressure.shape)

    def at(pressure: Array) -> Array:
        found = value(pressure, *values)
        found += 0.0  # no -0
        return found

    return at


def of_one_pressure(increment: Increment, entry: object) -> Callable[[float], float]:
    """The same at one pressure, a plain number, to the bit."""
    values, formula = _values(increment), sp.sympify(entry)
    value = _at(increment.law, entry, values)
    if isinstance(value, float):
        return lambda _: value
    if formula.has(sp.Function, sp.Pow):  # of which Python and NumPy have other last digits
        found = value.recording.value
        doubles = [np.float64(x) for x in values]
        return lambda pressure: float(found([np.float64(pressure), *doubles])) + 0.0
    text, constants = scalar_values("value", [formula], value.symbols)
    run, numbers = interpreted(text, "value"), (*values, *constants)

    def at(pressure: float) -> float:
        out = [0.0]
        run((pressure, *numbers), out)
        return out[0] + 0.0

    return at


def uniform(increment: Increment, entry: object) -> float | None:
    """The value of an entry that is the same at every pressure, else None."""
    value = _at(increment.law, entry, _values(increment))
    return value if isinstance(value, float) else None


def _values(increment: Increment) -> tuple[float, ...]:
    return tuple(increment.parameters[name] for name in increment.law.parameters)


@lru_cache(maxsize=4096)
def _at(law: Criterion, entry: object, values: tuple[float, ...]) -> float | Program:
    """The value of an entry at these parameters; where the pressure enters, a program over it and them."""
    symbols, formula = law.symbols(), sp.sympify(entry)
    own = [symbols[name] for name in law.parameters]
    if law.pressure is not None and symbols[law.pressure] in formula.free_symbols:
        return compiled(formula, [symbols[law.pressure], *own])
    return float(compiled(formula, own)(*values)) + 0.0


def in_columns(law: Criterion, entry: object, parameters: Sequence[Array], pressure: Array) -> Array:
    """An entry of the shape where points have parameters of their own, in the law's order: an array of the common shape."""
    found = _program(law, entry)(pressure, *parameters)
    found += 0.0  # no -0
    return found


@lru_cache(maxsize=256)
def _program(law: Criterion, entry: object) -> Program:
    symbols = law.symbols()
    load = sp.Dummy() if law.pressure is None else symbols[law.pressure]
    return compiled(sp.sympify(entry), [load, *(symbols[name] for name in law.parameters)])


def own_entries(shape: Shape) -> tuple[object, ...]:
    """The entries that must not depend on the pressure."""
    match shape:
        case Interval():
            return shape.plus, shape.minus
        case Disk():
            return (shape.coefficient,)
        case Quadrants():
            return shape.a_plus, shape.a_minus, shape.b_plus, shape.b_minus


def centre(shape: Shape) -> tuple[object, ...]:
    """The centre where it is not the origin, else nothing."""
    if isinstance(shape, Quadrants) and not (sp.sympify(shape.centre_a).is_zero and sp.sympify(shape.centre_b).is_zero):
        return shape.centre_a, shape.centre_b
    return ()


# -- the closest points -------------------------------------------------------------------------------------------------

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
        return "a coefficient is zero and the stiffness couples the forces: give a diagonal stiffness"
    return None


@lru_cache(maxsize=256)
def _unfit(law: Criterion) -> str | None:
    """Why a law has no closed form, whatever its numbers."""
    shape = law.closed_form
    if shape is None:
        return f"{law.name} has no closed form: use method newton or cvxpy"
    if len(law.forces) != (1 if isinstance(shape, Interval) else 2):
        return f"the closed form of {law.name} does not fit its {len(law.forces)} forces: use method newton or cvxpy"
    pressure = law.symbols().get(law.pressure or "")
    if any(pressure in sp.sympify(entry).free_symbols for entry in own_entries(shape)):
        return f"a coefficient in the closed form of {law.name} depends on the pressure: move that part into its load"
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
            with np.errstate(all="ignore"):  # what overflows has failed
                multiplier /= share(pressure)
        if not e.max(initial=0.0) < inf:  # every trial would be inside, although nothing is known of K
            for found_there in (stress, slip, multiplier):
                found_there[~np.isfinite(e)] = np.nan
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
        raise InputError(f"into is {into!r}", where="into", remedy="give a Solution, or remove it")
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


# -- consistent tangents: implicit differentiation of the equations of the step -----------------------------------------
# With G the Hessian of the gauge, sigma + k lambda n = sigma_tr and n . d sigma = d e give in two dimensions
# (J. C. Simo and R. L. Taylor, 1985, Comput. Methods Appl. Mech. Eng. 48, 101-118)
#
#     d sigma/d u = s s^T / (s . k^-1 s + lambda s . G s),   s perpendicular to n,
#
# and on a quarter ellipse with sigma = e y, y = (mu_a w_a, mu_b w_b), the choice s = (-mu_a w_b, mu_b w_a) makes
# s . G s = 1/e.  Symmetric, and with eigenvalues in [0, 1] in the metric of k.  At a seam, where the curvature jumps, it is
# the one-sided value of the quarter the slip points to.


def tangent(increment: Increment, solution: Solution) -> tuple[Array, Array | None]:
    """d sigma/d u (N, d, d) in Pa/m, and d sigma/d sigma_n (N, d) or None for a law without pressure.

    Where K is a point d sigma/d u = 0, trials that stick there included; d sigma/d sigma_n is of the side where K opens.
    """
    slips = (solution.slip != 0.0).any(axis=1)
    n, d = solution.stress.shape
    size = of_pressure(increment, declared(increment).load)(increment.pressure)
    single = (size == 0.0) | coefficients(increment).empty | (not any(coefficients(increment).mu))
    of_u = np.where((slips | single)[:, None, None], 0.0, increment.stiffness)
    of_load, through = np.zeros((n, d)), np.zeros((n, d, d))
    at = np.flatnonzero(slips)
    with np.errstate(all="ignore"):
        slip = solution.slip[at]
        if isinstance(declared(increment), Interval):
            of_load[at, 0] = np.where(slip[:, 0] < 0.0, -coefficients(increment).mu[1], coefficients(increment).mu[0])
        else:
            load = of_pressure(increment, declared(increment).load)(increment.pressure[at])
            of_u[at], of_load[at], through[at] = _on_ellipse(increment, slip, load)
        if increment.law.pressure is None:
            return of_u, None
        of_pressure_ = _rate(increment, declared(increment).load)[:, None] * of_load
        if middle := centre(declared(increment)):
            moving = np.stack([_rate(increment, c) for c in middle], axis=1)
            of_pressure_ += moving - np.einsum("nij,nj->ni", through, moving)
        return of_u, np.where(slips[:, None], of_pressure_, 0.0)


def _on_ellipse(increment: Increment, slip: Array, load: Array) -> tuple[Array, Array, Array]:
    """d sigma/d u, d sigma/d e and d sigma/d sigma_tr of slipping points."""
    found = coefficients(increment)
    e = np.zeros_like(load) if found.empty else load
    mu = np.stack([np.where(slip[:, i] < 0.0, found.mu[2 * i + 1], found.mu[2 * i]) for i in (0, 1)], axis=1)
    size = np.abs(slip).max(axis=1, keepdims=True)
    force = mu * (slip / size)
    length = np.hypot(force[:, 0], force[:, 1])[:, None]
    w, multiplier = force / length, (length * size)[:, 0]  # slip_i = lambda w_i/mu_i
    y = mu * w
    s = np.stack([-mu[:, 0] * w[:, 1], mu[:, 1] * w[:, 0]], axis=1)
    root = factors(increment.stiffness)[1].T  # k^-1 = root root^T
    s_root, y_root = s @ root, y @ root
    whole = (s_root * s_root).sum(axis=1) + np.where(e > 0.0, multiplier / e, np.inf)
    root_whole = np.sqrt(whole)[:, None]
    part = s / root_whole  # the same factor twice, so that rounding keeps the symmetry
    of_load = y - part / root_whole * (s_root * y_root).sum(axis=1)[:, None]
    return part[:, :, None] * part[:, None, :], of_load, part[:, :, None] * (s_root @ root.T / root_whole)[:, None, :]


def _rate(increment: Increment, entry: object) -> Array:
    """d entry/d sigma_n (N,), one-sided where the entry has a kink."""
    law = increment.law
    assert law.pressure is not None
    table = law.symbols()
    at = sp.sympify(entry).xreplace({table[name]: sp.Rational(value) for name, value in increment.parameters.items()})
    jet, _ = formula(at, (table[law.pressure],), ())(increment.pressure[:, None], (), second=False)
    assert jet.gradient is not None
    return jet.gradient[:, 0]


CLOSED_FORM = Method("closed-form", applies, solve, ClosedFormOptions, tangent, convex=True, plain=plain)
