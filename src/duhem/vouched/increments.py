"""Slip increments whose status says whether the point is the closest one, or stationary and no more."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from duhem.law.convex import check_convex
from duhem.law.formula_law import Criterion
from duhem.projection.method import Method
from duhem.projection.projector import Projector
from duhem.projection.result import Projection
from duhem.projection.validation import posed
from duhem.vouched.convexity import asked

__all__ = ["project"]


def project(
    law: Criterion | str | Path,
    trial: ArrayLike,
    pressure: ArrayLike | None = None,
    stiffness: ArrayLike = 1.0,
    parameters: Mapping[str, Any] | None = None,
    method: str | Method[Any] = "auto",
    tangent: bool = False,
    convex: str = "ask",
    **options: Any,
) -> Projection:
    """One slip increment: sigma = argmin over K(sigma_n) of (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2.

    The implicit step of u_in' = lambda' dg/dsigma, lambda' >= 0, g <= 0, lambda' g = 0 (Antoni et al. 2007, Eq. 36), with
    sigma_tr = k (u - u_in) of the end of the step.  ``trial`` (N, d) or (d,) in Pa; ``pressure`` sigma_n <= 0 in
    compression, one number or (N,), in Pa; ``stiffness`` k > 0 in Pa/m, one number, (d,) or symmetric (d, d).  Of a declared
    stress one number means k times the strain tensor: a shear stress is k/2 times its conjugate, the engineering strain.
    ``parameters`` a number for each parameter that the law leaves open; an increment is that of the law with every parameter at
    the double nearest to it, so that a slip 1e-12 from the boundary of mu = 3/10 is measured from the double 0.3.
    ``method``: ``closed-form``, ``newton``, ``cvxpy``, ``auto`` for the first of these that applies, or a
    :class:`duhem.projection.method.Method` of your own.  ``tangent`` adds d sigma/d u and d sigma/d sigma_n.  ``options`` are the
    method's.  Points are taken in blocks: with a closed form the work needs some 15 MB a thread beyond what it returns, however many points
    there are.

    Every point has a status of its own and residuals recomputed from the law; a point that is not solved is never
    returned as if it were.  The methods find the closest point of a convex K.  ``convex``: what is known of K, unless the
    method itself shows that it is convex (the closed form and CVXPY).  ``ask`` has :func:`duhem.verify` look for a proof,
    once for a law and its numbers and within few steps; where there is none a slip is ``stationary``, and ``inaccurate`` where a
    nearer point of K is found.  ``require`` raises InputError instead.  ``assume`` asks nobody: such a point counts as a slip unless
    one of the points of K that are tried speaks against it (:class:`duhem.projection.result.Projection`).

    A stress beyond the range that the law declares for a force (its ``domain``) is ``outside``; the trial may lie anywhere.
    Raises InputError for input that cannot be used, naming the first bad entry, for a pressure outside its range, and for a law
    with a flow of its own, which the closest point does not integrate.
    """
    check_convex(convex)
    prepared = Projector.of(law, stiffness, parameters, method)
    question = posed(prepared.setting, trial, pressure)
    if not prepared.method.convex:
        found = asked(question.law, parameters, convex, unloaded=bool(np.any(question.pressure == 0.0)))
        question = replace(question, convexity=found)
    return prepared.at(question, tangent, **options)
