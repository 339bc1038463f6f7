"""Where a failing routine departs from the closest point: one increment of the case, its answer, and duhem's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.testing.checks.query import Query
from duhem.testing.checks.raised import NoReply
from duhem.testing.checks.reply import Reply

__all__ = ["Departure", "closest", "departure"]

_CLEAR = 2.0  # times the error that the routine is held to: farther off, and the two are different stresses

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Departure:
    """One increment: stresses ``trial``, ``returned`` and ``closest`` (None where none is known) in the units of the law.

    ``apart``: ``returned`` is farther from ``closest`` than the routine is allowed to be.
    """

    trial: Numbers
    pressure: float | None
    stiffness: tuple[Numbers, ...]
    returned: Numbers
    closest: Numbers | None
    apart: bool

    @property
    def difference(self) -> Numbers | None:
        """``returned`` less ``closest``."""
        return None if self.closest is None else tuple(np.subtract(self.returned, self.closest).tolist())


def closest(law: Criterion, values: Mapping[str, float], trial: Array, pressure: Array | None, stiffness: Array) -> Array:
    """duhem's own closest points (N, d); nan where it flags one, or the law, its values or the stiffness have none."""
    free = {name: value for name, value in values.items() if law.parameters[name].value is None}
    with suppress(InputError), np.errstate(all="ignore"):
        found = Projector.of(law, stiffness, free)(trial, pressure)
        return np.where((found.status <= Status.SLIP)[:, None], found.stress, np.nan)
    return np.full_like(trial, np.nan)


def departure(query: Query) -> Departure | None:
    """The first increment of a case of one at which the answer departs from the closest point, or else its trial.

    None where the routine does not answer.
    """
    shown = None
    with suppress(NoReply), np.errstate(all="ignore"):
        for pressure, stiffness, reply in _increments(query):
            load = None if query.case.pressure is None else pressure
            best = closest(query.region.law, query.region.parameters, reply.trial, load, stiffness)
            known = bool(np.isfinite(best).all())
            off = query.length(reply.stress - best)[0]
            here = Departure(
                trial=tuple(reply.trial[0].tolist()),
                pressure=None if load is None else float(load[0]),
                stiffness=tuple(tuple(row) for row in stiffness.tolist()),
                returned=tuple(reply.stress[0].tolist()),
                closest=tuple(best[0].tolist()) if known else None,
                apart=known and not off <= _CLEAR * query.unit(reply)[0],
            )
            if here.apart:
                return here
            shown = shown or here
    return shown


def _increments(query: Query) -> Iterator[tuple[Array, Array, Reply]]:
    """What the checks ask of a case, in their order: pressure, stiffness and reply."""
    case, p, k = query.case, query.pressure, query.case.stiffness
    for reply in query.first:
        yield p, k, reply
    for reply in query.second:
        yield p, k, reply
    if "stiffness" not in query.fixed:
        yield p, k * case.factor, query.ask(case.trial, stiffness=k * case.factor)[0]
    if query.scales:
        yield p * case.factor, k, query.larger
    for i, reply in enumerate(query.along_the_path(), 1):
        yield p if case.loads is None else case.loads[:, i], k, reply
