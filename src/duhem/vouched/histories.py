"""Loading paths of laws of which it is asked first whether K is convex, from Python and from scenes."""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from numpy.typing import ArrayLike

from duhem.law.catalogue import load_formula
from duhem.law.convex import check_convex
from duhem.law.formula_law import Criterion
from duhem.path import simulate as integrated
from duhem.path.history import History
from duhem.path.loading import Path
from duhem.path.plan import Plan
from duhem.path.scene import Scene
from duhem.projection.increment import Convexity
from duhem.projection.projector import Projector
from duhem.vouched.convexity import asked

__all__ = ["looked_into", "simulate"]


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
    convex: str = "ask",
) -> History:
    """Drive ``law`` along ``path``: sigma = k (u - u_in), u_in' = lambda' dg/dsigma (Antoni et al. 2007, Eqs. 25, 36).

    ``stiffness`` k in Pa/m: a number, (d,) or symmetric positive definite (d, d); ``parameters`` a number for each the law
    leaves open.  ``method``: ``implicit`` (first order in the step), ``extrapolated`` (second order) or ``exact`` (each
    step of the path as one, to rounding; it follows the boundary of a K that is not convex too, and says so in ``why``).
    ``projection`` is the closest point's method, as in :func:`duhem.project`.
    ``substeps`` cuts each step of the path, for the accuracy of the first two and for more rows of all.  ``stress`` (d,) at
    the first knot, inside K; left out, it is zero, or the first knot of a stress path.
    A stress path must stay inside K: there no slip is determined on the boundary, and none is made.

    ``convex`` is as in :func:`duhem.project`: where K is not shown to be convex the steps of the first two methods end at
    stationary points, ``why`` says so, and a step ends the run where a nearer point of K is found.  The exact method and a
    stress path need no closest point, and nothing is asked unless it is ``require``.

    ``start`` is a part of the same run, to go on from; ``on_step(done, all)`` hears of progress.  Raises InputError for what
    cannot be used, for a pressure outside the range that the law declares too; :class:`LeftPrecision` and :class:`LeftDomain`,
    both InputErrors, where numbers grow beyond double precision and where the stress at the end of a step lies outside a declared
    range; and :class:`Interrupted`, a KeyboardInterrupt, all three with the part that is done.
    """
    known = load_formula(law)
    plan = Plan.of(known, path, stiffness=stiffness, parameters=parameters, projection=projection, substeps=substeps)
    return integrated(
        known,
        path,
        stiffness=stiffness,
        parameters=parameters,
        method=method,
        projection=projection,
        substeps=substeps,
        stress=stress,
        start=start,
        on_step=on_step,
        convexity=_known(plan, parameters, method, convex),
    )


def looked_into(scene: Scene) -> Scene:
    """The scene with what is shown of K, as its key ``convex`` asks; InputError where it requires what is not shown."""
    return replace(scene, convexity=_known(scene.plan(), scene.parameters, scene.method, scene.convex))


def _known(plan: Plan, parameters: Mapping[str, Any] | None, method: str, convex: str) -> Convexity | None:
    check_convex(convex)
    if convex == "ask" and (method == "exact" or plan.path.control == "stress"):
        return None
    question = plan.increment
    if Projector.of(question.law, question.stiffness, parameters, plan.projection).method.convex:
        return Convexity(loaded=True, unloaded=True)
    return asked(question.law, parameters, convex, unloaded=bool((question.pressure == 0.0).any()))
