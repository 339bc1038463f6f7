"""The conic solvers CVXPY finds installed, by name: what they accept, what they return, nothing believed."""

from __future__ import annotations

import math
import warnings
from typing import Any

from duhem.errors import InputError

__all__ = ["checked", "ran", "settings"]

# How each solver spells its stopping tolerance.
TOLERANCES: dict[str, tuple[str, ...]] = {
    "CLARABEL": ("tol_gap_abs", "tol_gap_rel", "tol_feas"),
    "CUCLARABEL": ("tol_gap_abs", "tol_gap_rel", "tol_feas"),
    "CVXOPT": ("abstol", "reltol", "feastol"),
    "ECOS": ("abstol", "reltol", "feastol"),
    "OSQP": ("eps_abs", "eps_rel"),
    "QOCO": ("abstol", "reltol"),
    "SCS": ("eps_abs", "eps_rel"),
}

# Asked of a solver where the caller asks for nothing: as tight as each still answers reliably, its cost aside.
TIGHT: dict[str, dict[str, Any]] = {
    "CLARABEL": {"tolerance": 1e-12},
    "CUCLARABEL": {"tolerance": 1e-12},
    "ECOS": {"tolerance": 1e-10},
    "SCS": {"tolerance": 1e-9, "max_iters": 100_000},
}


def checked(solver: str) -> str:
    """The name as CVXPY writes it; raises InputError, saying what is installed, for any other."""
    import cvxpy as cp

    installed = cp.installed_solvers()
    if str(solver).upper() not in installed:
        raise InputError(f"the solver {solver!r} is not installed", where="solver", remedy=f"take one of {', '.join(installed)}")
    return str(solver).upper()


def settings(solver: str, tolerance: float | None) -> dict[str, Any]:
    """The solver's own options for a stopping tolerance (relative, on an O(1) problem); None asks for its tightest reliable one."""
    options = dict(TIGHT.get(solver, {}))
    asked = options.pop("tolerance", None) if tolerance is None else tolerance
    if asked is None:
        return options
    if not (math.isfinite(asked) and asked > 0):
        raise InputError(f"the tolerance {asked} is not a positive number", where="tolerance", remedy="give one such as 1e-9")
    if solver not in TOLERANCES:
        raise InputError(f"how {solver} spells its tolerance is not known", where="tolerance", remedy="leave it out")
    return options | dict.fromkeys(TOLERANCES[solver], asked)


def ran(problem: Any, solver: str, options: dict[str, Any]) -> bool:
    """Solve in place; whether the variables now hold numbers, which says nothing of how good they are."""
    import cvxpy as cp

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": every answer is judged by its residuals
        try:
            problem.solve(solver=solver, warm_start=False, **options)
        except cp.error.SolverError:
            return False
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)
