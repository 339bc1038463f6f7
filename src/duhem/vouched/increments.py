"""Slip increments whose status says whether the point is the closest one, or stationary and no more; once, or prepared for many calls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.convex import check_convex
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Increment, posed, setting
from duhem.projection.method import Compiling, Method
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Status
from duhem.vouched.convexity import asked

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
    """The slip increment of a law as a callable ``(trial, pressure) -> (stress, slip, multiplier, status)``, checked once.

    Arguments, units and errors are those of :func:`duhem.project`, which stands on it.  Whether K is convex is asked here, where the
    method does not show it, so that no increment waits for the answer but the first one at sigma_n = 0.

    ``compiled``: by numba (extra ``fast``), which takes 20 to 70 seconds the first time that a law is prepared on a machine, and then
    answers one point five to twenty times sooner.  InputError for a method that is not compiled.
    """
    check_convex(convex)
    prepared = Prepared(Projector.of(law, stiffness, parameters, method), parameters, convex, compiled)
    if compiled:
        own = prepared.projector.method
        if not issubclass(own.options, Compiling):
            raise InputError(f"method {own.name} is not compiled", where="compiled", remedy="leave it out, or take method newton")
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
