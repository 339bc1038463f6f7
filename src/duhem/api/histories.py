"""Loading paths of laws of which it is asked first whether K is convex, from Python and from scenes."""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from duhem.api.convexity import asked
from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.convex import check_convex
from duhem.law.domain import by_name
from duhem.law.formula_law import Criterion
from duhem.law.state import evolves
from duhem.path.history import Checkpoint, Histories, History
from duhem.path.loading import Path, Paths
from duhem.path.run import Run
from duhem.path.scene import Scene
from duhem.path.simulate import driven
from duhem.path.state_path import StateHistory
from duhem.projection.increment import Convexity
from duhem.projection.projector import Projector

__all__ = ["looked_into", "simulate"]


@overload
def simulate(
    law: Criterion | str | pathlib.Path, path: Path, *, stiffness: ArrayLike | None = ..., parameters: Mapping[str, Any] | None = ...,
    method: str = ..., projection: str = ..., substeps: int = ..., stress: ArrayLike | None = ..., start: Any = ...,
    on_step: Callable[[int, int], None] | None = ..., keep: int | str = ..., threads: int = ..., compiled: bool = ...,
    checkpoint: Checkpoint[Any] | None = ..., convex: str = ..., state: Mapping[str, Any] | None = ..., tangent: bool = ...,
    accuracy: float | None = ...,
) -> History | Any: ...  # fmt: skip
@overload
def simulate(
    law: Criterion | str | pathlib.Path, path: Paths, *, stiffness: ArrayLike | None = ..., parameters: Mapping[str, Any] | None = ...,
    method: str = ..., projection: str = ..., substeps: int = ..., stress: ArrayLike | None = ..., start: Any = ...,
    on_step: Callable[[int, int], None] | None = ..., keep: int | str = ..., threads: int = ..., compiled: bool = ...,
    checkpoint: Checkpoint[Any] | None = ..., convex: str = ..., state: Mapping[str, Any] | None = ..., tangent: bool = ...,
    accuracy: float | None = ...,
) -> Histories | Any: ...  # fmt: skip
def simulate(
    law: Criterion | str | pathlib.Path,
    path: Path | Paths,
    *,
    stiffness: ArrayLike | None = None,
    parameters: Mapping[str, Any] | None = None,
    method: str = "implicit",
    projection: str = "auto",
    substeps: int = 1,
    stress: ArrayLike | None = None,
    start: History | StateHistory | None = None,
    on_step: Callable[[int, int], None] | None = None,
    keep: int | str = 1,
    threads: int = 1,
    compiled: bool = False,
    checkpoint: Checkpoint[Any] | None = None,
    convex: str = "ask",
    state: Mapping[str, Any] | None = None,
    tangent: bool = False,
    accuracy: float | None = None,
) -> History | Histories | StateHistory:
    """Compute the path of a law: sigma = k (u - u_in), u_in' = lambda' dg/dsigma (Antoni et al. 2007, Eqs. 25, 36).

    ``stiffness``: k in Pa/m, a number, (d,) or symmetric positive definite (d, d).  ``parameters``: a number for each parameter that
    has no value in the law.  ``method``: ``implicit`` (error of first order in the step), ``extrapolated`` (second order) or ``exact``
    (each step of the path without discretisation error; it also follows the boundary of a K that is not convex, and says so in
    ``why``).  ``projection`` is the method for the closest point, as in :func:`duhem.project`.  ``substeps`` divides each step of the
    path, for accuracy with the first two methods and for more rows with all three.  ``stress`` (d,) is the initial stress, inside K;
    its default is zero, or the first knot of a stress path. A stress path must stay inside K, because the slip on the boundary would
    not be determined; it has no slip.

    ``convex`` is as in :func:`duhem.project`; for many points, K must be convex over the range of their numbers.  If duhem cannot show
    that K is convex, the steps of the first two methods end at stationary points and ``why`` says so; the run ends at a step where
    duhem finds a closer point of K.  The exact method and a stress path need no closest point; for them duhem looks for a proof only
    with ``require``.

    ``start`` is a part of the same run, from which the run continues.  ``on_step(done, all)`` reports progress.  ``checkpoint``, of one
    path, is a pair of seconds and a function: the function is called with the history so far, not more often than that and in at most a
    tenth of the time.  Raises InputError for invalid input and for a pressure outside the range that the law declares;
    :class:`LeftPrecision` if numbers overflow or underflow, and :class:`LeftDomain` if the stress at the end of a step lies outside a
    declared range, both InputErrors; and :class:`Interrupted`, a KeyboardInterrupt.  The last three contain the history so far.

    Many points: ``path`` is :class:`Paths`, each of ``parameters`` is a number or one number per point (N,), ``stress`` is (d,) or (N,
    d), and the result is :class:`Histories`.  Each point has the same numbers as in a path of its own.  If a point cannot continue, its
    status says so; a single path raises an error instead.  ``keep`` = n keeps every n-th knot, ``"last"`` only the last one: N points
    with r knots need 8 N r (3 d + 7) bytes, at most 2 GiB, and the computation needs some 50 MB per thread, or up to 300 MB if each
    point has its own long path. ``threads`` share the work; the numbers do not depend on them.  ``on_step`` then counts points.
    ``exact`` computes one point after the other.

    ``compiled`` uses numba (extra ``fast``; the first use compiles for 3 to 30 seconds) for implicit steps of one path or many points
    with any law, and for the closest points of extrapolated steps of many points.  The last digits may differ.  One path then makes
    some 1e6 steps per second, or 1e5 to 1e6 if the law declares no shape; without numba some 2e4, or 5e2 to 2e3; extrapolated steps a
    third of these.

    A law with variables, an energy, rates or a flow of its own has another step: it satisfies the optimality conditions of the least
    psi(chi) + dt Phi((chi - chi_n)/dt), which suffice where both are convex; with a flow of its own or rates without a multiplier, the
    residual of the step is solved, and ``why`` says which. The result is a :class:`duhem.StateHistory` with all variables and forces.
    The path prescribes the observables in the order of their forces (or, with ``control="stress"``, these forces), and in one more
    column the temperature; without that column it follows from the heat that is dissipated and that bodies exchange. ``state`` has the
    variables that do not begin at 0. An energy contains the stiffness; ``stiffness`` is for laws without one. A law with rates or a
    potential of rates needs the times of the path. ``tangent`` adds d sigma/du at each knot. At a bound of a variable its evolution
    stops, and ``remark()`` says so. ``method`` is ``implicit`` or ``extrapolated``; with the latter, ``accuracy`` (from 1e-10 to 1)
    divides each step of the path until the estimated error of each part, relative to the state, is at most a tenth of it; it finds where
    flow begins or ends. ``threads`` and ``convex`` do not matter, and ``start`` is the :class:`duhem.StateHistory` of a part of one path.
    ``compiled`` makes steps 4 to 16 times as fast (some 12 microseconds each for six components) unless forces are prescribed, heat
    decides the temperature or ``tangent`` is asked for; ``why`` says whether it did. :class:`NoAnswer`, an InputError with the history
    so far, ends a path with a step that is not solved to a residual of 1e-10, or not to the accuracy.
    """
    check_convex(convex)
    known = load_formula(law)
    run = Run(
        known, path, stiffness, parameters, method, projection, substeps, stress, keep, threads, compiled, None, state, tangent, accuracy
    )
    return driven(replace(run, convexity=_known(run, convex)), start, on_step, checkpoint)


def looked_into(scene: Scene) -> Scene:
    """The scene with what is shown of K, as its key ``convex`` asks; InputError where it requires what is not shown."""
    return replace(scene, convexity=_known(scene, scene.convex))


def _known(run: Run, convex: str) -> Convexity | None:
    path, law = run.path, load_formula(run.law)
    if evolves(law):
        if convex == "require":
            what = f"convexity of K is not required of {law.name}, whose steps are no closest points"
            raise InputError(what, where="convex", remedy="remove convex, and ask duhem.verify for convexity, normality and the state laws")
        return None
    follows = run.method == "exact" or (isinstance(path, Path) and path.control == "stress")
    if not isinstance(path, (Path, Paths)) or run.stiffness is None or (convex == "ask" and follows):
        return None
    try:
        given = by_name(run.parameters)
        first = {name: np.ravel(value)[0] if np.ndim(value) and np.size(value) else value for name, value in given.items()}
        if Projector.of(law, run.stiffness, first, run.projection).method.convex:
            return Convexity(loaded=True, unloaded=True)
    except InputError:  # the run itself says what is wrong
        return None
    return asked(law, run.parameters, convex, unloaded=path.pressure is not None and bool((path.pressure == 0.0).any()))
