"""The conic solvers CVXPY finds installed, by name: what they accept, what they return, nothing believed.

The problems are O(1).  The place of a minimum is known to about the square root of the gap in its value, so the gap is
asked to be far smaller than the infeasibility: an interior-point method that must bring both to 1e-12 stalls instead,
and may then return an early iterate, wrong in the third digit, as "almost solved".  Short steps keep its iterates near
the central path, which is worth two to four digits of the place; where it stalls, other steps may not.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

from duhem.errors import InputError

__all__ = ["KNOWN", "Rungs", "checked", "compiled", "installed", "ran", "rungs", "tolerances"]

Settings = Mapping[str, Any]  # in the words of a solver
Rungs = tuple[tuple[Settings, ...], ...]  # tolerances from the tightest on; for each, the ways to try it

LEAST_INFEASIBILITY = 1e-8  # no tighter one is asked for; what is met is mostly tighter by far
ALMOST = 10.0  # a stalled answer is taken if it misses what was asked by no more than this factor
_PLAIN: Settings = MappingProxyType({})


@dataclass(frozen=True)
class _Dialect:
    """How one solver spells its tolerances, ``inside`` what, which to ask for where the caller names none, and in which ways."""

    gap: tuple[str, ...]
    infeasibility: tuple[str, ...] = ()
    almost_gap: tuple[str, ...] = ()
    almost_infeasibility: tuple[str, ...] = ()
    ladder: tuple[float, ...] = (1e-12, 1e-10, 1e-8)
    ways: tuple[Settings, ...] = (_PLAIN,)
    inside: str | None = None

    def rung(self, tolerance: float) -> tuple[Settings, ...]:
        infeasibility = max(tolerance, LEAST_INFEASIBILITY)
        stop = {
            **dict.fromkeys(self.gap, tolerance),
            **dict.fromkeys(self.infeasibility, infeasibility),
            **dict.fromkeys(self.almost_gap, tolerance * ALMOST),
            **dict.fromkeys(self.almost_infeasibility, infeasibility * ALMOST),
        }
        return tuple({**(stop if self.inside is None else {self.inside: stop}), **way} for way in self.ways)


_CLARABEL = _Dialect(
    ("tol_gap_abs", "tol_gap_rel"),
    ("tol_feas",),
    ("reduced_tol_gap_abs", "reduced_tol_gap_rel"),
    ("reduced_tol_feas",),
    ladder=(1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8),
    ways=tuple({"max_step_fraction": step, "min_terminate_step_length": 1e-8} for step in (0.7, 0.9, 0.5)),
)
_DIALECTS = {
    "CLARABEL": _CLARABEL,
    "CVXOPT": _Dialect(("abstol", "reltol"), ("feastol",)),
    "ECOS": _Dialect(("abstol", "reltol"), ("feastol",)),
    "MOREAU": _Dialect(
        ("tol_gap_abs", "tol_gap_rel"),
        ("tol_feas",),
        ("reduced_tol_gap_abs", "reduced_tol_gap_rel"),
        ("reduced_tol_feas",),
        inside="ipm_settings",
    ),
    "OSQP": _Dialect(("eps_abs", "eps_rel"), ways=({"max_iter": 100_000},)),
    "QOCO": _Dialect(("abstol", "reltol")),
    "SCS": _Dialect(("eps_abs", "eps_rel"), ways=({"max_iters": 100_000},)),
}


KNOWN = tuple(_DIALECTS)


@cache
def installed() -> tuple[str, ...]:
    """The solvers CVXPY finds, which imports each to see."""
    return tuple(_cp().installed_solvers())


def checked(solver: str) -> str:
    """The name as CVXPY writes it; raises InputError, saying what is installed, for any other."""
    found = installed()
    if str(solver).upper() not in found:
        raise InputError(f"the solver {solver!r} is not installed", where="solver", remedy=f"installed are {', '.join(found)}")
    return str(solver).upper()


def rungs(solver: str, tolerance: float | None) -> Rungs:
    """The solver's own options for a stopping tolerance; where none is given, for one after the other until it answers."""
    dialect = _DIALECTS.get(solver)
    if tolerance is None:
        return tuple(map(dialect.rung, dialect.ladder)) if dialect else ((_PLAIN,),)
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise InputError(f"the tolerance {tolerance} is not a positive number", where="tolerance", remedy="give one such as 1e-9")
    if dialect is None:
        raise InputError(f"duhem does not know the tolerance option of {solver}", where="tolerance", remedy="remove it")
    return (dialect.rung(tolerance),)


def tolerances(solver: str) -> tuple[float, ...]:
    """Those asked for one after the other where the caller names none."""
    return _DIALECTS[solver].ladder if solver in _DIALECTS else ()


def compiled(problem: Any, solver: str) -> Any:
    """What the solver is given for the parameters that the problem holds now, and the way back from its answer.

    Raises InputError where the solver lacks a cone that the problem needs.
    """
    posing = {} if problem.is_dpp() else {"ignore_dpp": True}
    try:
        return problem.get_problem_data(solver, solver_opts={}, **posing)
    except _cp().error.SolverError:
        raise InputError(
            f"{solver} does not support the cones or the quadratic objective of this law", where="solver", remedy="take CLARABEL"
        ) from None


def ran(problem: Any, given: Any, tries: Rungs, *, warm_start: bool) -> bool:
    """Solve in place what was :func:`compiled`; whether the variables now hold numbers, which says nothing of how good they are."""
    return any(_answered(problem, given, way, warm_start) for rung in tries for way in rung)


def _answered(problem: Any, given: Any, settings: Settings, warm_start: bool) -> bool:
    cp, (data, chain, inverse) = _cp(), given
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": every answer is judged by its residuals
        try:
            answer = chain.solve_via_data(problem, dict(data), warm_start, False, dict(settings))
            problem.unpack_results(answer, chain, inverse)
        except cp.error.SolverError:
            return False
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)


def _cp() -> Any:
    import cvxpy as cp

    return cp
