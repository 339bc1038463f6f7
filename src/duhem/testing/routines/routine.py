"""The routine under test: what it is given, what it may answer, adapters for other shapes of routine, and duhem's own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import simple_points
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.projection.validation import check_associated
from duhem.testing.routines.origin import law_as_written, made_by
from duhem.testing.routines.overwritten import FormerAnswers, changed, overwritten

__all__ = ["PROMISED", "NoStep", "Step", "Update", "called", "from_displacements", "named_after", "own_solvers", "pointwise", "projection"]


@dataclass(frozen=True)
class Step:
    """What a routine may return besides the stress (N, d) in Pa, or a mapping with these names; None for what it does not compute.

    ``slip`` (N, d) in m, taken to be k^-1 (sigma_tr - sigma) where left out; ``multiplier`` lambda (N,) with
    slip = lambda dg/dsigma; ``tangent`` d sigma/d u (N, d, d) in Pa/m; ``solved`` (N,), False where the routine itself says
    that it found no answer: such points are counted and not judged.  An array may be the one that was given, and has to stay as it
    is once it is returned.  ``overwritten`` (N,), set by what calls routines of other
    languages: the names of what they were only given and have changed, "" where nothing; ``returned``, set by what makes the step
    of something else: what the routine itself has returned, by name.
    """

    stress: ArrayLike
    slip: ArrayLike | None = None
    multiplier: ArrayLike | None = None
    tangent: ArrayLike | None = None
    solved: ArrayLike | None = None
    overwritten: ArrayLike | None = None
    returned: Mapping[str, Any] | None = None


# update(trial (N, d), pressure (N,) or None for a law without, stiffness (d, d), **parameters left open) -> stress, Step or its mapping
Update: TypeAlias = Callable[..., ArrayLike | Step | Mapping[str, ArrayLike | None]]


class NoStep(Exception):
    """What a routine returned can be read neither as a stress nor as a :class:`Step`."""


def _as_step(answer: Any) -> Step:
    """What a routine returned.  Raises NoStep."""
    if isinstance(answer, Step):
        return answer
    if isinstance(answer, Mapping):
        names = [*Step.__dataclass_fields__]
        if unknown := [str(name) for name in answer if name not in names]:
            raise NoStep(f"the routine returned a mapping with {', '.join(unknown)}; what is known is {', '.join(names[:-2])}")
        if "stress" not in answer:
            raise NoStep("the routine returned a mapping without stress")
        return Step(**answer)
    if isinstance(answer, Iterator):
        what = type(answer).__name__
        raise NoStep(f"the routine returned a {what}, which gives its rows one by one: return them together, as an array or a list")
    return Step(answer)


def _parts(answer: Any) -> Mapping[str, Any]:
    """What a routine returned, by name.  Raises NoStep."""
    parts = dict(vars(_as_step(answer)))
    return parts | (parts.pop("returned") or {})


def pointwise(step: Callable[..., Any]) -> Update:
    """A routine for one increment, ``step(trial (d,), pressure, stiffness (d, d), **parameters) -> stress (d,) or Step``, for many."""

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Step:
        loads = [None] * len(trial) if pressure is None else pressure.tolist()
        answered, each, spoilt = FormerAnswers(), [], []
        for t, p in zip(trial, loads, strict=True):
            answer = step(t.copy(), p, stiffness.copy(), **parameters)
            spoilt.append(answered.spoilt(1, partial(_parts, answer)))
            each.append({name: None if part is None else np.array(part) for name, part in _parts(answer).items()})

        def together(name: str) -> Any:
            parts = [parts.get(name) for parts in each]
            return None if any(p is None for p in parts) else np.array(parts)

        whole = Step(*(together(name) for name in Step.__dataclass_fields__))
        return replace(whole, overwritten=np.array(spoilt, dtype=object)) if any(spoilt) else whole

    return named_after(update, step, "pointwise")


def from_displacements(step: Callable[..., ArrayLike]) -> Update:
    """A routine ``step(u (N, d), u_in (N, d), pressure, stiffness, **parameters) -> u_in (N, d)`` at the end of the increment.

    It is given a former slip that is not zero, u_in = the elastic displacement with its components reversed: a routine
    that forgets what has slipped before is found out.
    """

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Step:
        elastic = np.linalg.solve(stiffness, trial.T).T
        before = elastic[:, ::-1].copy()
        answer = step(elastic + before, before.copy(), pressure, stiffness, **parameters)
        slip = np.asarray(answer) - before
        return Step(trial - slip @ stiffness, slip, returned={"u_in": answer})

    return named_after(update, step, "from_displacements")


def projection(law: Criterion | str | Path, method: str = "auto", *, tangent: bool = False) -> Update:
    """duhem's own routine for ``law`` (:func:`duhem.project`); flagged points count as not solved.

    InputError for a law with a flow of its own, which has no such routine.
    """
    check_associated(load(law))

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: Any) -> Step:
        found = Projector.of(law, stiffness, parameters, method)(trial, pressure, tangent)
        solved: NDArray[np.bool_] = found.status <= Status.SLIP
        return Step(found.stress, found.slip, found.multiplier, found.tangent, solved)

    update.__qualname__ = f"projection.{method}"
    if named := law_as_written(load(law), law):
        again = f"update = projection({named}, {method!r}, tangent={tangent!r})"
        names = "from duhem import load\n" if named.startswith("load(") else ""
        if names or not named.startswith("Criterion("):
            update.__duhem_import__ = f"{names}from duhem.testing import projection\n\n{again}"  # type: ignore[attr-defined]
    return update


def named_after(update: Update, step: Callable[..., Any], adapter: str) -> Update:
    """An adapted routine with the name of what it adapts, and the Python that makes it again."""
    update.__name__, update.__wrapped__ = getattr(step, "__name__", "update"), step  # type: ignore[attr-defined]
    if making := made_by(step):
        update.__duhem_import__ = f"{making}\nfrom duhem.testing import {adapter}\n\nupdate = {adapter}(update)"  # type: ignore[attr-defined]
    return update


def called(
    update: Update, values: Mapping[str, float], trial: Array, pressure: Array | None, stiffness: Array, answered: FormerAnswers
) -> Step:
    """What a routine answers, called on copies, and which of them, or of what it has ``answered`` before, it has overwritten."""
    given = trial.copy(), None if pressure is None else pressure.copy(), stiffness.copy()
    answer = update(*given, **values)
    step, spoilt = _as_step(answer), answered.spoilt(len(trial), partial(_parts, answer))
    pairs = {"trial": (given[0], trial)}
    if pressure is not None and given[1] is not None:
        pairs["pressure"] = given[1], pressure
    found = changed(pairs | {"stiffness": (given[2], stiffness)})
    if "stiffness" in found:
        found["stiffness"] = np.full(len(trial), found["stiffness"].any())
    found |= {spoilt: np.full(len(trial), True)} if spoilt else {}
    return step if (said := overwritten(found)) is None else replace(step, overwritten=said)


PROMISED = {"cvxpy": 1e-6}  # relative errors in stress of methods that are less accurate than others: the root of a solver's gap


def own_solvers(law: Criterion) -> Iterator[tuple[str, Update | str]]:
    """Methods by name, with their routine, or the reason why they do not take the law.

    InputError for a law with a flow of its own, which none takes.
    """
    check_associated(law)
    point = {str(symbol): value for symbol, value in next(iter(simple_points(law)), {}).items()}
    values = {name: point[name] for name, domain in law.parameters.items() if domain.value is None and name in point}
    for method in METHODS:
        try:
            Projector.of(law, 1.0, values, method)
        except InputError as reason:
            yield method, str(reason)
        else:
            yield method, _answering(projection(law, method))


def _answering(routine: Update) -> Update:
    """The routine, which says of parameters at which its method does not apply that they are not solved."""

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> object:
        try:
            return routine(trial, pressure, stiffness, **parameters)
        except InputError:
            return Step(np.full_like(trial, np.nan), solved=np.zeros(len(trial), dtype=np.bool_))

    update.__wrapped__ = routine  # type: ignore[attr-defined]
    update.__duhem_import__ = getattr(routine, "__duhem_import__", "")  # type: ignore[attr-defined]
    return update  # type: ignore[return-value]
