"""Driving a law along a path: checks, the start, and the integrator asked for."""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.path.history import History
from duhem.path.integrators import INTEGRATORS
from duhem.path.ledger import Ledger
from duhem.path.loading import Path
from duhem.path.problem import Problem
from duhem.projection.projector import project
from duhem.projection.result import Array
from duhem.projection.validation import increment as checked

__all__ = ["Interrupted", "plan", "simulate"]

_TOLERANCE = 1e-12  # how far outside K a given stress may lie, relative to its size: what rounding explains


class Interrupted(KeyboardInterrupt):
    """A run that was stopped; ``history`` is what was done, from which :func:`simulate` goes on."""

    def __init__(self, history: History) -> None:
        self.history = history
        super().__init__(f"interrupted after {len(history) - 1} steps")


def simulate(
    law: Criterion | str | pathlib.Path,
    path: Path,
    *,
    stiffness: ArrayLike,
    parameters: Mapping[str, Any] | None = None,
    method: str = "implicit",
    projection: str = "auto",
    substeps: int = 1,
    stress: ArrayLike | None = None,
    start: History | None = None,
    on_step: Callable[[int, int], None] | None = None,
) -> History:
    """Drive ``law`` along ``path``: sigma = k (u - u_in), u_in' = lambda' dg/dsigma (Antoni et al. 2007, Eqs. 25, 36).

    ``stiffness`` k in Pa/m: a number, (d,) or symmetric positive definite (d, d); ``parameters`` a number for each the law
    leaves open.  ``method``: ``implicit`` (first order in the step), ``extrapolated`` (second order) or ``exact`` (each
    step of the path as one, to rounding).  ``projection`` is the closest point's method, as in :func:`duhem.project`.
    ``substeps`` cuts each step of the path, for the accuracy of the first two and for more rows of all.  ``stress`` (d,) at
    the first knot, inside K; left out, it is zero, or the first knot of a stress path.
    A stress path must stay inside K: there no slip is determined on the boundary, and none is made.

    ``start`` is a part of the same run, to go on from; ``on_step(done, all)`` hears of progress.  Raises InputError for what
    cannot be used, and :class:`Interrupted`, a KeyboardInterrupt, with the part that is done.
    """
    problem = plan(law, path, stiffness=stiffness, parameters=parameters, method=method, projection=projection, substeps=substeps)
    if problem.path.control == "stress":
        return _prescribed(problem)
    integrator = INTEGRATORS[method]
    why = integrator.why(problem)
    ledger = Ledger.begun(problem, _first(problem, stress))
    if start is not None:
        _go_on(ledger, problem, start)
    steps = len(problem.path.time) - 1
    try:
        for done in integrator.advance(problem, ledger):
            if on_step is not None:
                on_step(done - 1, steps)
    except KeyboardInterrupt:
        raise Interrupted(ledger.history(problem, method, why)) from None
    return ledger.history(problem, method, why)


def plan(
    law: Criterion | str | pathlib.Path,
    path: Path,
    *,
    stiffness: ArrayLike,
    parameters: Mapping[str, Any] | None = None,
    method: str = "implicit",
    projection: str = "auto",
    substeps: int = 1,
) -> Problem:
    """The checked question of :func:`simulate`, without an answer."""
    if method not in INTEGRATORS:
        raise InputError(f"unknown method {method!r}", where="method", remedy=f"choose {', '.join(INTEGRATORS)}")
    known = load_formula(law)
    fine = path.refined(substeps)
    d = len(known.forces)
    if fine.values.shape[1] != d:
        raise InputError(
            f"the path has {fine.values.shape[1]} columns and {known.name} the {d} forces {', '.join(known.forces)}",
            where="path",
            remedy="give one column for each force",
        )
    question = checked(known, fine.values, fine.pressure, stiffness, parameters)
    return Problem(question, fine, projection, np.asarray(np.linalg.inv(question.stiffness)))


def _inside(problem: Problem, stress: Array, rows: slice) -> int | None:
    """The first of ``stress`` (n, d) that lies outside K under the pressures of ``rows``."""
    question = problem.increment
    pressure = None if question.law.pressure is None else question.pressure[rows]
    found = project(question.law, stress, pressure, problem.stiffness, question.parameters, method=problem.projection)
    size = np.maximum(np.abs(stress).max(axis=1), np.abs(found.stress).max(axis=1))
    outside = np.flatnonzero(~(np.abs(found.stress - stress).max(axis=1) <= _TOLERANCE * size))
    return int(outside[0]) if outside.size else None


def _first(problem: Problem, given: ArrayLike | None) -> Array:
    d = len(problem.increment.law.forces)
    try:
        stress = np.zeros(d) if given is None else np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("the stress at the start is not made of numbers", where="stress", remedy=f"give {d} numbers") from None
    if stress.shape != (d,) or not np.isfinite(stress).all():
        raise InputError("the stress at the start does not fit the law or is not finite", where="stress", remedy=f"give {d} numbers")
    if _inside(problem, stress[None], slice(0, 1)) is not None:
        remedy = "give one inside K" if given is not None else "zero stress is not admissible: give stress= inside K"
        raise InputError(f"the stress at the start {stress.tolist()} lies outside K", where="stress", remedy=remedy)
    return stress


def _prescribed(problem: Problem) -> History:
    """A stress path inside K: the displacement follows, and nothing slips."""
    stress = problem.path.values
    if (i := _inside(problem, stress, slice(None))) is not None:
        raise InputError(
            f"the stress {stress[i].tolist()} at time {problem.path.time[i]:g} lies outside K, where no equilibrium exists",
            where=f"path, step {i}",
            remedy='stay inside K, or prescribe the displacement (control="displacement")',
        )
    ledger = Ledger.begun(problem, stress[0])
    ledger.sticks(problem, 1, len(stress), stress[1:])
    return ledger.history(problem, "prescribed stress", "inside K the slip stays what it was")


def _go_on(ledger: Ledger, problem: Problem, start: History) -> None:
    """Copy the rows of an earlier part of the run into the ledger."""
    n, path = len(start), problem.path
    pairs = ((start.time, path.time), (start.pressure, problem.increment.pressure), (start.displacement, path.values))
    same = 1 <= n <= len(path.time) and all(np.array_equal(old, new[:n]) for old, new in pairs)
    if not same or start.law != problem.increment.law.name:
        raise InputError("the history to go on from belongs to another run", where="start", remedy="start afresh")
    ledger.resume(start)
