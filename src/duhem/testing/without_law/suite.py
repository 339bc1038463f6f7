"""The run of a routine of which no law is known: histories drawn, every check that needs no law, and what was visited."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, cast

import numpy as np
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.testing.checks.judged import judged
from duhem.testing.checks.query import Query
from duhem.testing.checks.raised import NoReply
from duhem.testing.checks.registry import Check
from duhem.testing.checks.reply import Reply
from duhem.testing.checks.visited import Visited
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.decades import Strategy
from duhem.testing.failures.departure import Departure
from duhem.testing.failures.report import Failure
from duhem.testing.routines.material import Material, stateless
from duhem.testing.routines.origin import Origin, origin
from duhem.testing.routines.routine import Update
from duhem.testing.run import ConformanceRun
from duhem.testing.without_law import associated_checks, energy_checks, run_checks, step_checks  # noqa: F401 (they register their checks)
from duhem.testing.without_law.energy_checks import slipped
from duhem.testing.without_law.histories import histories
from duhem.testing.without_law.history import HistoryQuery
from duhem.testing.without_law.registry import registered

__all__ = ["FreeRun", "free_check", "free_checks", "free_violation"]

_EVERY = 2  # so many histories, of which one is asked what the checks ask again
_STRESS = ("rest", "slip", "stored-energy", "dissipation", "energy", "slope", "subdivision")
_ASSOCIATED = ("associated-symmetry", "associated-non-expansiveness", "associated-potential", "associated-ray")
# a check, and those that fail with it for the same reason; the first is told first
_EXPLAINS: dict[str, tuple[str, ...]] = {
    "answers": ("repeatability", "elasticity", "vacuity", "rate", *_STRESS, *_ASSOCIATED),
    "repeatability": ("elasticity", "vacuity", "rate", *_STRESS, *_ASSOCIATED),
    "inputs": (),
    "elasticity": ("vacuity", *_STRESS, "isotropic-plastic-work"),
    "vacuity": (),
    "rate": ("energy", "subdivision"),
    "dissipation": ("energy", "isotropic-plastic-work", "associated-potential"),
    "rest": ("slip", "stored-energy", "energy", "subdivision", *_ASSOCIATED),
    "slip": ("dissipation", "energy"),
    "stored-energy": ("energy",),
    "energy": (),
    "slope": ("associated-symmetry",),
    "subdivision": (),
}


def _known() -> dict[str, Check]:
    """Every check by name, causes first."""
    checks = {c.name: c for c in registered()}
    return {name: checks[name] for name in (*_EXPLAINS, *checks)}


def free_checks(associated: bool = False) -> tuple[Check, ...]:
    """The checks that any routine has to pass, or these and those that only some laws satisfy."""
    return tuple(c for c in _known().values() if c.demanded or associated)


def free_check(name: str) -> Check:
    """A check that needs no law, by name.  Raises InputError for an unknown one."""
    known = _known()
    if name not in known:
        raise InputError(f"unknown check {name!r}", where="without a law", remedy=f"choose one of {', '.join(known)}")
    return known[name]


def free_violation(asked: Check, update: Update | Material, case: Case, accuracy: float) -> str | None:
    """What is wrong with the routine's answer to one case by one check, or None."""
    try:
        found = judged(asked, HistoryQuery(_material(update, case.parameters, case.stiffness), case, accuracy))
    except NoReply as fault:
        return str(fault)
    return None if found is None else found[1]


def _material(update: Update | Material, values: Mapping[str, float], stiffness: Any) -> Material:
    return update if isinstance(update, Material) else stateless(update, stiffness, values)


class _Answered(Visited):
    """What a run has visited, by the routine's own answers: a step slips where it is not answered by the stiffness."""

    def __init__(self, pressed: bool) -> None:
        super().__init__((), pressed)
        for name in ("seam", "corner"):  # those are of a law
            del self._counts[name]

    def _trials(self, query: Query, reply: Reply) -> None:
        history = cast(HistoryQuery, query)
        solved, out, trial = reply.solved, slipped(history), reply.trial
        near = history.length(reply.trial - reply.stress) <= 1e-6 * history.length(reply.trial)
        self._asked += int(solved.sum())
        self._count("stick", ~out & solved)
        self._count("slip", out & solved)
        self._slipping += len(solved)
        self._given_up += int((~solved).sum())
        self._count("boundary", out & near & solved)
        if "tip" in self._counts:
            self._count("tip", (query.pressure == 0.0) & solved)
        for i, column in enumerate(trial.T, start=1):
            self._count(f"{i}+", (column > 0.0) & solved)
            self._count(f"{i}-", (column < 0.0) & solved)

    def _others(self, query: Query) -> None:
        """What is asked beside the trial stress is asked for the checks of associated laws alone."""

    def _answers(self, query: Query, reply: Reply) -> None:
        """What is said of answers is said of seams and corners."""


class FreeRun(ConformanceRun):
    """A run of an update routine or a material without a law."""

    def __init__(
        self,
        update: Update | Material,
        parameters: Mapping[str, Any] | None,
        asked: Sequence[Check],
        *,
        stiffness: ArrayLike | Strategy | None,
        every: int | None = None,
        **options: Any,
    ) -> None:
        if isinstance(update, Material):
            given = {"parameters": parameters, "stiffness": stiffness, "pressure": options["pressure"]}
            if told := [name for name, value in given.items() if value is not None]:
                remedy = "give its parameters where the material is made"
                raise InputError(f"a material has its own {told[0]}", where="conformance without a law", remedy=remedy)
            stiffness = update.elastic
        elif stiffness is None:
            remedy = "give (d,) or (d, d), or a strategy such as stiffnesses(d)"
            raise InputError("without a law the stiffness says how many forces there are", where="conformance without a law", remedy=remedy)
        self.routine = update
        super().__init__(
            None,
            cast(Update, update),
            dict(parameters or {}),
            asked,
            stiffness=stiffness,
            every=_EVERY if every is None else every,
            **options,
        )

    def _open(self) -> tuple[str, ...]:
        return tuple(self.parameters or {})

    def _demanded(self) -> Iterable[Check]:
        return free_checks()

    def _nothing_visited(self) -> Visited:
        return _Answered(self.pressure is not None)

    def _cases(self, parameters: Mapping[str, Any] | None, stiffness: ArrayLike | Strategy | None, rows: int = 1) -> Strategy:
        def made(values: Mapping[str, float], k: Any) -> Material:
            return _material(self.routine, values, k)

        given = stiffness if isinstance(stiffness, st.SearchStrategy) else np.asarray(stiffness, dtype=np.float64)
        return histories(made, dict(parameters or {}), given, self.pressure, rows)

    def query(self, case: Case) -> Query:
        self.last = case
        material = _material(self.routine, case.parameters, case.stiffness)
        return HistoryQuery(material, case, self.accuracy, self.every, self.examples, raised=self.raised)

    def _title(self) -> str:
        return f"{getattr(self.routine, 'name', None) or getattr(self.routine, '__name__', 'update')}, without a law"

    def _causes(self, failures: Sequence[Failure]) -> tuple[tuple[Failure, ...], tuple[Failure, ...]]:
        order = list(_EXPLAINS)
        ranked = sorted(failures, key=lambda f: order.index(f.check.name) if f.check.name in order else len(order))
        roots: dict[str, tuple[Failure, list[str]]] = {}
        explained = []
        for failure in ranked:
            name = failure.check.name
            root = next((r for r in roots if name in _EXPLAINS.get(r, ())), None)
            if root is None:
                roots[name] = failure, []
            else:
                roots[root][1].append(name)
                explained.append(failure)
        return tuple(replace(failure, explains=tuple(names)) for failure, names in roots.values()), tuple(explained)

    def _explained_by(self, check: str, failed: Collection[str]) -> Collection[str]:
        return _EXPLAINS.get(check, ())

    def _origin(self) -> Origin:
        return origin(self.routine, None, None)

    def _told(self, failures: Iterable[Failure]) -> list[Failure]:
        made = self._origin()
        return [replace(failure, origin=made, departure=self._returned(failure)) for failure in failures]

    def _returned(self, failure: Failure) -> Departure | None:
        """What the routine returned; no closest point is known."""
        if failure.check.whole or len(failure.case) != 1:
            return None
        with suppress(NoReply):
            found, load = self.query(failure.case).here, failure.case.pressure
            return Departure(
                trial=tuple(found.trial[0].tolist()),
                pressure=None if load is None else float(load[0]),
                stiffness=tuple(tuple(row) for row in failure.case.stiffness.tolist()),
                returned=tuple(found.stress[0].tolist()),
                closest=None,
                apart=False,
            )
        return None
