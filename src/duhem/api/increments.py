"""Slip increments whose status says whether the point is the closest one, or stationary and no more; once, or prepared for many calls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.api.convexity import asked
from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.convex import check_convex
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Increment, posed, setting
from duhem.projection.method import Compiling, Method
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Status

if TYPE_CHECKING:
    from duhem.projection.one_increment import OneIncrement, PointAnswer

__all__ = ["Prepared", "SlipIncrement", "prepare", "project"]


class SlipIncrement(NamedTuple):
    """What a prepared law answers: of many points stress and slip (N, d), multiplier and status (N,); of one (d,) and numbers."""

    stress: Array
    slip: Array
    multiplier: Array | float
    status: NDArray[np.int8] | Status


@dataclass(frozen=True, eq=False)
class Prepared:
    """A law with its stiffness and parameters, checked once: call it with a trial stress and a pressure, as often as there are steps.

    Stresses are in Pa and slips in m, where the stiffness is in Pa/m.  It can be pickled, and threads may share it.
    """

    projector: Projector
    parameters: Mapping[str, Any] | None
    convex: str
    compiled: bool = False

    def __call__(self, trial: ArrayLike, pressure: ArrayLike | None = None) -> SlipIncrement:
        """The slip increments to ``trial``, (d,) or (N, d), under ``pressure``, one number or (N,); errors as :func:`duhem.project`."""
        if (one := self._answer(trial, pressure)) is not None:
            return SlipIncrement(np.asarray(one.stress), np.asarray(one.slip), float(one.multiplier), one.status)
        found = self._project(trial, pressure)
        if np.ndim(trial) == 1 and len(found.multiplier) == 1:
            return SlipIncrement(found.stress[0], found.slip[0], float(found.multiplier[0]), Status(int(found.status[0])))
        return SlipIncrement(found.stress, found.slip, found.multiplier, found.status)

    def project(self, trial: ArrayLike, pressure: ArrayLike | None = None, tangent: bool = False, **options: Any) -> Projection:
        """The same with residuals, dissipation and, where it is asked for, the ``tangent``: what :func:`duhem.project` returns."""
        if not (tangent or options) and (one := self._answer(trial, pressure)) is not None:
            return self._one.projection(one, self.projector.why)
        return self._project(trial, pressure, tangent, **options)

    def _project(self, trial: ArrayLike, pressure: ArrayLike | None, tangent: bool = False, **options: Any) -> Projection:
        question = posed(self.projector.setting, trial, pressure)
        if not self.projector.method.convex:
            found = asked(question.law, self.parameters, self.convex, unloaded=bool(np.any(question.pressure == 0.0)))
            question = replace(question, convexity=found)
        if self.compiled:
            options = {"compiled": True, **options}
        return self.projector.at(question, tangent, **options)

    def _answer(self, trial: ArrayLike, pressure: ArrayLike | None) -> PointAnswer | None:
        """That of one loaded point of a K that is shown to be convex."""
        if isinstance(trial, np.ndarray) and trial.ndim != 1:
            return None
        numbers = self._one.numbers(trial, pressure)
        return self._one.answer(*numbers) if numbers is not None and self._shown_convex else None

    @cached_property
    def _one(self) -> OneIncrement:
        from duhem.projection.one_increment import OneIncrement

        return OneIncrement(self.projector.setting, self.projector.method, self.compiled)

    @cached_property
    def _shown_convex(self) -> bool:
        if self.projector.method.convex:
            return True
        found = asked(self.projector.setting.law, self.parameters, self.convex, unloaded=False)
        return found is not None and found.loaded


def prepare(
    law: Criterion | str | Path,
    stiffness: ArrayLike = 1.0,
    parameters: Mapping[str, Any] | None = None,
    method: str | Method[Any] = "auto",
    convex: str = "ask",
    compiled: bool = False,
) -> Prepared:
    """Return the slip increment of a law as a function (trial, pressure) -> (stress, slip, multiplier, status).

    The law, the stiffness and the parameters are checked only once, here.  Arguments, units and errors are those of
    :func:`duhem.project`, which uses this function.  duhem also decides here whether K is convex, unless the method shows it; only the
    first increment at sigma_n = 0 may need another such decision.

    ``compiled``: compile with numba (extra ``fast``).  This takes 3 to 15 seconds when a law is first prepared on a machine; after
    that, one point is five to twenty times faster.  Raises InputError for a method that cannot be compiled.
    """
    check_convex(convex)
    prepared = Prepared(Projector.of(law, stiffness, parameters, method), parameters, convex, compiled)
    if compiled:
        own = prepared.projector.method
        if not issubclass(own.options, Compiling):
            raise InputError(f"method {own.name} is not compiled", where="compiled", remedy="remove compiled, or use the method newton")
        prepared._one.made()
    if not prepared.projector.method.convex:
        asked(prepared.projector.setting.law, parameters, convex, unloaded=False)
    return prepared


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
    """Compute slip increments: sigma = argmin over K(sigma_n) of (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2.

    K is the set of admissible stresses, and sigma_tr = k (u - u_in) is the trial stress at the end of the step, with the displacement
    u, the slip u_in and the stiffness k.  This is the implicit step of u_in' = lambda' dg/dsigma, lambda' >= 0, g <= 0, lambda' g = 0
    (Antoni et al. 2007, Eq. 36).

    ``trial``: sigma_tr, (N, d) or (d,), in Pa.  ``pressure``: sigma_n <= 0 in compression, one number or (N,), in Pa.  ``stiffness``: k
    > 0 in Pa/m, one number, (d,) or symmetric (d, d).  If the law declares a stress tensor, one number means k times the strain tensor:
    a shear stress is k/2 times the engineering strain.  ``parameters``: a number for each parameter that has no value in the law.
    duhem uses the double nearest to each value: the boundary for mu = 3/10 is that of the double 0.3. ``method``: ``closed-form``,
    ``newton`` or ``cvxpy``; ``auto`` chooses the first of these that applies; or a :class:`duhem.projection.method.Method` of your own,
    with its ``options``.  ``tangent`` adds d sigma/d u and d sigma/d sigma_n. Points are computed in blocks: with a closed form the
    computation needs some 15 MB per thread in addition to its results.

    Each point has its own status, and residuals that are recomputed from the law.  A point that is not solved is never returned as if
    it were.  The methods find the closest point if K is convex.  ``convex`` says what to do if the method itself does not show this
    (the closed form and CVXPY do).  ``ask``: :func:`duhem.verify` looks for a proof with a small budget, once for a law and its
    numbers; if it finds none, a slip has the status ``stationary``, or ``inaccurate`` if a closer point of K is found.  ``require``:
    InputError if there is no proof. ``assume``: no proof is sought, and the point counts as a slip unless duhem finds a closer point of
    K (:class:`duhem.projection.result.Projection`).

    If the stress leaves a range that the law declares for a force (its ``domain``), the status is ``outside``; the trial stress may lie
    anywhere.  Raises InputError for invalid input, naming the first invalid entry, for a pressure outside its range, and for a law with
    its own flow direction, because the closest point is not its slip increment.
    """
    check_convex(convex)
    return _prepared(load_formula(law), stiffness, parameters, method, convex).project(trial, pressure, tangent, **options)


def _prepared(
    law: Criterion, stiffness: ArrayLike, parameters: Mapping[str, Any] | None, method: str | Method[Any], convex: str
) -> Prepared:
    """Made once for increments that follow one another, where the arguments are plain numbers."""
    named = {} if parameters is None else parameters
    if type(named) is dict and {type(stiffness), *map(type, named.values())} <= {float, int}:
        numbers: Any = stiffness, tuple(named.items())
        return _kept(law, *numbers, Projector.chosen(_setting(law, *numbers), method), convex)
    return Prepared(Projector.of(law, stiffness, parameters, method), parameters, convex)


Numbers = tuple[tuple[str, float], ...]


@lru_cache(maxsize=256)
def _setting(law: Criterion, stiffness: float, parameters: Numbers) -> Increment:
    return setting(law, stiffness, dict(parameters))


@lru_cache(maxsize=256)
def _kept(law: Criterion, stiffness: float, parameters: Numbers, chosen: tuple[Method[Any], str], convex: str) -> Prepared:
    return Prepared(Projector(_setting(law, stiffness, parameters), *chosen), dict(parameters), convex)
