"""Loading paths of laws of which it is asked first whether K is convex, from Python and from scenes."""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.convex import check_convex
from duhem.law.domain import by_name
from duhem.law.formula_law import Criterion
from duhem.path.history import Histories, History
from duhem.path.loading import Path, Paths
from duhem.path.run import Run
from duhem.path.scene import Scene
from duhem.path.simulate import Checkpoint, driven
from duhem.projection.increment import Convexity
from duhem.projection.projector import Projector
from duhem.vouched.convexity import asked

__all__ = ["looked_into", "simulate"]


@overload
def simulate(
    law: Criterion | str | pathlib.Path, path: Path, *, stiffness: ArrayLike, parameters: Mapping[str, Any] | None = ...,
    method: str = ..., projection: str = ..., substeps: int = ..., stress: ArrayLike | None = ..., start: History | None = ...,
    on_step: Callable[[int, int], None] | None = ..., keep: int | str = ..., threads: int = ..., compiled: bool = ...,
    checkpoint: Checkpoint | None = ..., convex: str = ...,
) -> History: ...  # fmt: skip
@overload
def simulate(
    law: Criterion | str | pathlib.Path, path: Paths, *, stiffness: ArrayLike, parameters: Mapping[str, Any] | None = ...,
    method: str = ..., projection: str = ..., substeps: int = ..., stress: ArrayLike | None = ..., start: History | None = ...,
    on_step: Callable[[int, int], None] | None = ..., keep: int | str = ..., threads: int = ..., compiled: bool = ...,
    checkpoint: Checkpoint | None = ..., convex: str = ...,
) -> Histories: ...  # fmt: skip
def simulate(
    law: Criterion | str | pathlib.Path,
    path: Path | Paths,
    *,
    stiffness: ArrayLike,
    parameters: Mapping[str, Any] | None = None,
    method: str = "implicit",
    projection: str = "auto",
    substeps: int = 1,
    stress: ArrayLike | None = None,
    start: History | None = None,
    on_step: Callable[[int, int], None] | None = None,
    keep: int | str = 1,
    threads: int = 1,
    compiled: bool = False,
    checkpoint: Checkpoint | None = None,
    convex: str = "ask",
) -> History | Histories:
    """Drive ``law`` along ``path``: sigma = k (u - u_in), u_in' = lambda' dg/dsigma (Antoni et al. 2007, Eqs. 25, 36).

    ``stiffness`` k in Pa/m: a number, (d,) or symmetric positive definite (d, d); ``parameters`` a number for each the law
    leaves open.  ``method``: ``implicit`` (first order in the step), ``extrapolated`` (second order) or ``exact`` (each
    step of the path as one, to rounding; it follows the boundary of a K that is not convex too, and says so in ``why``).
    ``projection`` is the closest point's method, as in :func:`duhem.project`.
    ``substeps`` cuts each step of the path, for the accuracy of the first two and for more rows of all.  ``stress`` (d,) at
    the first knot, inside K; left out, it is zero, or the first knot of a stress path.
    A stress path must stay inside K: there no slip is determined on the boundary, and none is made.

    ``convex`` is as in :func:`duhem.project`, for many points over the range of their numbers: where K is not shown to be convex
    the steps of the first two methods end at stationary points, ``why`` says so, and a step ends the run where a nearer point of K
    is found.  The exact method and a stress path need no closest point, and nothing is asked unless it is ``require``.

    ``start`` is a part of the same run, to go on from; ``on_step(done, all)`` hears of progress.  Raises InputError for what
    cannot be used, for a pressure outside the range that the law declares too; :class:`LeftPrecision` and :class:`LeftDomain`,
    both InputErrors, where numbers grow beyond double precision and where the stress at the end of a step lies outside a declared
    range; and :class:`Interrupted`, a KeyboardInterrupt, all three with the part that is done.

    ``checkpoint``, seconds and a function of one path's history: it is given what is done, no more often than that and in no more than
    a tenth of the time.

    Many points: ``path`` is :class:`Paths`, each of ``parameters`` a number or one a point (N,), ``stress`` (d,) or (N, d), and
    what comes back :class:`Histories`.  The numbers of a point are those of its path by itself, and a point that cannot go on has a
    status that says so, where one path by itself raises.  ``keep`` is every how many knots are kept of each path, or ``"last"``:
    N points with r kept knots take 8 N r (3 d + 7) bytes, 2 GiB at most, and the work besides some 50 MB a thread, or up to
    300 where long paths are each point's own.
    ``threads`` share the work and change no number; ``on_step`` hears of points.  ``exact`` takes one point after the other.

    ``compiled`` runs implicit steps through numba (extra ``fast``; its first use compiles for 15 to 80 seconds), whole
    stretches at once, of one path or many points by any law; of extrapolated steps of many points it finds the closest
    points.  The last digits may differ.  One path takes some 1e6 steps a second so, on a shape that is not declared 1e5 to 1e6; without
    it some 2e4, on a shape that is not declared 5e2 to 2e3; extrapolated a third of these.
    """
    check_convex(convex)
    known = load_formula(law)
    run = Run(known, path, stiffness, parameters, method, projection, substeps, stress, keep, threads, compiled)
    return driven(replace(run, convexity=_known(run, convex)), start, on_step, checkpoint)


def looked_into(scene: Scene) -> Scene:
    """The scene with what is shown of K, as its key ``convex`` asks; InputError where it requires what is not shown."""
    return replace(scene, convexity=_known(scene, scene.convex))


def _known(run: Run, convex: str) -> Convexity | None:
    path, law = run.path, load_formula(run.law)
    follows = run.method == "exact" or (isinstance(path, Path) and path.control == "stress")
    if not isinstance(path, (Path, Paths)) or (convex == "ask" and follows):
        return None
    try:
        given = by_name(run.parameters)
        first = {name: np.ravel(value)[0] if np.ndim(value) and np.size(value) else value for name, value in given.items()}
        if Projector.of(law, run.stiffness, first, run.projection).method.convex:
            return Convexity(loaded=True, unloaded=True)
    except InputError:  # the run itself says what is wrong
        return None
    return asked(law, run.parameters, convex, unloaded=path.pressure is not None and bool((path.pressure == 0.0).any()))
