"""Identification: from measured limit points to the admissible law that fits them best."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.identification.points import Points
from duhem.identification.result import Estimate, Identification, Outlier
from duhem.law.catalogue import load_formula
from duhem.law.convex import check_convex
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain

__all__ = ["Estimate", "Identification", "Outlier", "Points", "identify"]


MOST_DRAWS = 1_000_000


def identify(
    points: Any,
    law: str | Path | Criterion = "antoni2007",
    *,
    parameters: Mapping[str, Any] | None = None,
    robust: bool = False,
    bootstrap: int = 0,
    seed: int = 0,
    convex: str = "ask",
) -> Identification:
    """Fit the free parameters of ``law`` to limit points, and prove that the fitted law is admissible.

    ``points``: a CSV file, a mapping of columns or an array (m, d + 1), as :meth:`Points.of` reads them: forces and pressure (sigma_n <
    0 in compression) in one unit, and optionally ``weight`` or ``scatter``.  ``parameters`` fixes some values before the fit.  The fit
    minimises the sum of rho(distance/scatter) over the points (:mod:`duhem.identification.estimation`), where rho is the square or, with
    ``robust``, Huber's loss.  ``bootstrap`` samples with ``seed`` give percentile intervals; with 0 the intervals come from the
    covariance.

    The parameters of the fitted law are exactly the estimates.  If a parameter is an exponent, it is rounded to three decimals, and the
    other parameters are fitted again and rounded to six digits.  If no point depends on a parameter, it keeps its whole domain in the
    fitted law.

    ``convex``: ``ask`` rejects a best fit whose K is not convex; ``require`` also rejects one whose K is not proved convex; ``assume``
    rejects none and only reports the verdicts.

    Raises InputError for points that cannot be used or do not determine the parameters, and for a law that is not suitable: with its
    own slip direction (limit points contain no information about the slip), with corners (max or min of the forces), or with a best fit
    that is not admissible.
    """
    check_convex(convex)
    family = load_formula(law).fix(parameters)
    check_domain(family)
    _check_suited(family)
    _check_count(bootstrap, "bootstrap", MOST_DRAWS)
    _check_count(seed, "seed", 2**63)
    read = Points.of(points, family)
    free = [name for name, domain in family.parameters.items() if domain.value is None]
    if not free:
        raise InputError(f"{family.name} has no free parameter", where="parameters", remedy="leave at least one parameter free")
    if len(read) < len(free):
        counts = "is only 1 point" if len(read) == 1 else f"are only {len(read)} points"
        unknowns = f"{len(free)} unknowns {', '.join(free)}"
        what = f"there {counts} for the {unknowns}"
        raise InputError(what, where=read.where, remedy="add points, or fix a parameter with --set NAME=VALUE")
    from duhem.identification.estimation import estimated  # solvers and deciders, once the points are known to be usable

    return estimated(family, read, robust=robust, bootstrap=bootstrap, seed=seed, convex=convex)


def _check_suited(law: Criterion) -> None:
    if not law.associated:
        what = f"{law.name} has its own slip direction, but limit points contain no information about the slip"
        raise InputError(what, where="law", remedy="choose an associated law, for example antoni2007 or orthotropic")
    forces = set(law.force_symbols())
    if any(node.free_symbols & forces for node in law.g.atoms(sp.Max, sp.Min)):
        what = f"{law.name} has corners, so the distance to the boundary has no derivative"
        raise InputError(what, where="law", remedy="choose a law with a smooth boundary, for example superellipse")


def _check_count(value: int, what: str, most: int) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 0 <= value <= most:
        raise InputError(f"{what} = {value!r} is not a whole number from 0 to {most}", where=what, remedy="give for example 1000")
