"""Where a failing routine departs from the closest point, and what it does instead.

Suggestions are tried on increments beside the failing one, and kept only if they give the answers of the routine there.

A suggestion is a few lines: what the routine may be doing, and what it would return then.  It is believed where it gives what
was returned, to within the accuracy the routine is held to, at the failing increment and at every other one beside it that
is wrong, three at the least; so nothing is said of a routine that only resembles one.  Where others beside it are right, and would not be
if the routine did so everywhere, that is said.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from math import isnan
from typing import Any, Literal, TypeAlias

import numpy as np

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.query import NoReply, Query, Reply
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.region import Region
from duhem.testing.failures.causes import likeliest_first
from duhem.testing.failures.failure import Departure, Failure
from duhem.testing.failures.regions import region_of
from duhem.testing.failures.state_suggestions import beside_in_state, of_the_state
from duhem.testing.routines.origin import Origin

__all__ = [
    "CLEAR", "IN_REGION", "Part", "Probe", "constant", "departure", "diagnosed", "diagnoses", "instead", "suggested",
    "suggests",
]  # fmt: skip

Part: TypeAlias = Literal["stress", "slip", "multiplier", "tangent"]

_PARTS: dict[str, Part] = {"slip": "slip", "energy": "slip", "multiplier": "multiplier", "tangent": "tangent", "slope": "tangent"}
_TRIED = 3  # failures of a part of the answer that are diagnosed, until one of them is
_BEYOND = 1.7  # times as far out as the boundary that a routine would keep: it is seen whether that is where it goes back to
_LEAST = 3  # increments that a suggestion has to explain
IN_REGION = "; this explains only the increments "
_ONLY = "; this happens only for such increments, and others near them are right"
CLEAR = 2.0  # times the error that is allowed: farther apart, and two answers are different


def _closest(law: Criterion | None, values: Mapping[str, float], trial: Array, pressure: Array | None, stiffness: Array) -> Array:
    """Return duhem's own closest points (N, d); nan where it flags one, where law, values or stiffness have none, or without a law."""
    if law is not None:
        free = {name: value for name, value in values.items() if law.parameters[name].value is None}
        with suppress(InputError), np.errstate(all="ignore"):
            found = Projector.of(law, stiffness, free)(trial, pressure)
            return np.where((found.status <= Status.SLIP)[:, None], found.stress, np.nan)
    return np.full_like(trial, np.nan)


def departure(query: Query) -> Departure | None:
    """Return the first increment of a case of one at which the answer departs from the closest point, or else that of its trial.

    None where the routine does not answer.
    """
    shown = None
    with suppress(NoReply), np.errstate(all="ignore"):
        for pressure, stiffness, reply in _increments(query):
            load = None if query.case.pressure is None else pressure
            best = _closest(query.region.law, query.region.parameters, reply.trial, load, stiffness)
            known = bool(np.isfinite(best).all())
            off = query.length(reply.stress - best)[0]
            trial, returned, closest = (tuple(stresses[0].tolist()) for stresses in (reply.trial, reply.stress, best))
            apart = known and not off <= CLEAR * query.unit(reply)[0]
            told = trial, None if load is None else float(load[0]), tuple(map(tuple, stiffness.tolist())), returned
            here = Departure(*told, closest if known else None, apart)
            if here.apart:
                return here
            shown = shown or here
    return shown


def _increments(query: Query) -> Iterator[tuple[Array, Array, Reply]]:
    """Yield what the checks ask of a case, in their order: pressure, stiffness and reply; without a law the trial alone."""
    case, p, k = query.case, query.pressure, query.case.stiffness
    yield p, k, query.here
    if query.region.law is None:
        return
    for reply in query.first[1:]:
        yield p, k, reply
    for reply in query.second:
        yield p, k, reply
    if "stiffness" not in query.fixed:
        yield p, k * case.factor, query.ask(case.trial, stiffness=k * case.factor)[0]
    if query.scales:
        yield p * case.factor, k, query.larger
    for i, reply in enumerate(query.along_the_path(), 1):
        yield p if case.loads is None else case.loads[:, i], k, reply


class Probe:
    """The routine asked at N increments beside a failing one, which is the first; ``query`` holds them.

    Arrays: ``trial`` and ``returned`` stresses (N, d), ``pressure`` (N,), ``stiffness`` (d, d).
    """

    def __init__(self, query: Query, reply: Reply) -> None:
        self.query, self.reply, self.trial, self.returned = query, reply, reply.trial, reply.stress
        self.stiffness, self.pressure = query.case.stiffness, query.pressure

    @cached_property
    def closest(self) -> Array:
        """duhem's own answers (N, d)."""
        return self.projected()

    @cached_property
    def gradient(self) -> Array:
        """grad g at the stress returned (N, d)."""
        return self.query.gradient(self.reply)

    @cached_property
    def slip(self) -> Array:
        """k^-1 (sigma_tr - sigma) (N, d)."""
        return np.asarray(np.linalg.solve(self.stiffness, (self.trial - self.returned).T).T)

    @cached_property
    def multiplier(self) -> Array:
        """The slip over grad g (N,)."""
        return self.query.length(self.trial - self.returned) / self.query.dual_length(self.gradient)

    @cached_property
    def slopes(self) -> Array:
        """d sigma/d u (N, d, d) of the routine itself, by central differences; nan where either way has a slope of its own."""
        q = self.query
        h = 1e-6 * np.maximum(q.length(self.trial), q.length(self.returned))[:, None]
        columns = []
        for axis in q.axes:
            ahead, behind = q.ask(self.trial + h * axis, self.trial - h * axis)
            ways = (ahead.stress - self.returned) / h, (self.returned - behind.stress) / h
            smooth = q.length(ways[0] - ways[1]) <= 1e-4
            columns.append(np.where(smooth[:, None], np.mean(ways, axis=0), np.nan))
        return np.asarray(np.stack(columns, axis=2) @ q.axes)  # the axes are L, and along them go steps L^-T of displacement

    def projected(self, trial: Array | None = None, **other: Any) -> Array:
        """Return the closest points (N, d) with another ``pressure``, ``stiffness`` or ``parameters``; nan where they are not known."""
        region = self.query.region
        loads = None if region.law.pressure is None else other.get("pressure", self.pressure)
        values = {**region.parameters, **other.get("parameters", {})}
        return _closest(region.law, values, self.trial if trial is None else trial, loads, other.get("stiffness", self.stiffness))

    @cached_property
    def kept(self) -> list[tuple[str, Mapping[str, Any]]]:
        """What the routine seems to have kept of the first call of the run, in words and as :meth:`projected` takes it."""
        return [(said, given) for said, given in self._of_the_first_call() if self._goes_back_to(given)]

    def _of_the_first_call(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        first = self.query.opening
        if first is None:
            return
        if first.pressure is not None:
            yield f"the pressure is taken as {first.pressure[0]:.6g}, that", {"pressure": np.full_like(self.pressure, first.pressure[0])}
        yield "the stiffness is taken as that", {"stiffness": first.stiffness}
        values = {name: first.parameters[name] for name in self.query.passed}
        for kept in (*({name: value} for name, value in values.items()), *([values] if len(values) > 1 else [])):
            told = " and ".join(f"{name} is taken as {value:.6g}" for name, value in kept.items())
            yield f"{told}, {'that' if len(kept) == 1 else 'those'}", {"parameters": kept}

    def _goes_back_to(self, given: Mapping[str, Any]) -> bool:
        """Return whether trial stresses outside the set that is kept come back to it, under another stiffness too.

        One inside is answered as by a routine that does nothing; another stiffness may have a first call of its own.
        """
        q, k = self.query, self.stiffness
        region = Region(q.region.law, {**q.region.parameters, **given.get("parameters", {})})
        reach = region.reach(self.trial, given.get("pressure", self.pressure))
        known = np.isfinite(reach) & (reach > 0.0)
        beyond = np.where(known, _BEYOND * reach, 1.0)[:, None] * self.trial
        with suppress(NoReply):
            for stiffness in (k,) if "stiffness" in q.fixed else (k, 1.37 * k + 0.61 * np.diag(np.diag(k)) * np.arange(len(k))):
                reply, meant = q.ask(beyond, stiffness=stiffness)[0], self.projected(beyond, **{"stiffness": stiffness, **given})
                allowed = CLEAR * q.unit(reply)
                same, moved = q.length(reply.stress - meant) <= allowed, q.length(meant - beyond) > allowed
                if not (same[known].all() and (moved & known).any()):
                    return False
            return True
        return False


# What a routine may be doing, and the answers (N, ...) it would give then.
Suggest: TypeAlias = Callable[[Probe], Iterable[tuple[str, Array]]]

_suggestions: dict[Part, dict[str, Suggest]] = {"stress": {}, "slip": {}, "multiplier": {}, "tangent": {}}


def suggested(part: Part, **suggestions: Suggest) -> None:
    """Add suggestions by name, after those before; of two that explain as much the first added is told."""
    _suggestions[part] |= suggestions


def suggests(part: Part) -> Callable[[Suggest], Suggest]:
    """Return a decorator that adds a suggestion about what the routine returns as ``part``, by the name of the function."""

    def add(suggest: Suggest) -> Suggest:
        suggested(part, **{suggest.__name__: suggest})
        return suggest

    return add


def diagnoses(part: Part, query: Query, found: Departure, known: Collection[str] = ()) -> dict[str, str]:
    """Return by name what explains the answers beside ``found``, the best explanation first; empty where nothing does.

    Where one of those whose names are ``known`` already explains them, no other is tried.  Where nothing explains all answers that are
    wrong, only those of the region of stress of ``found`` are looked at: elsewhere there may be another mistake.
    """
    with suppress(NoReply, InputError, np.linalg.LinAlgError), np.errstate(all="ignore"):
        probe = _probe(query, found)
        asked = _suggestions[part]
        if believed := _believed(part, probe, {name: suggest for name, suggest in asked.items() if name in known})[0]:
            return believed
        believed, left = _believed(part, probe, asked)
        for thin in (True, False) if not believed else ():
            of = region_of(probe.query, probe.reply, thin)
            if not believed and len(rows := np.flatnonzero(of == of[0])) < len(of):
                own = Probe(probe.query.of(probe.query.case.rows(rows)), probe.reply.part(rows))
                place = "of no special region" if of[0] == "elsewhere" else str(of[0])
                told = _believed(part, own, left)[0].items()
                believed = {name: f"{said}{IN_REGION}{place}" for name, said in told}
        return believed
    return {}


def _believed(part: Part, probe: Probe, asked: Mapping[str, Suggest]) -> tuple[dict[str, str], dict[str, Suggest]]:
    """Return by name what explains the answers at all increments of a probe that are wrong, the first among them.

    Also those of the suggestions ``asked`` that may explain some: what gives the answer to the first, or gives none.
    """
    given, right, allowed = _measured(part, probe)
    wrong = ~(_apart(given, right) <= CLEAR * allowed) & np.isfinite(right).all(axis=1)
    if not wrong[0] or wrong.sum() < _LEAST:
        return {}, {}

    def explains(answers: Array) -> tuple[int, int] | None:
        """Return how many right increments it answers otherwise, and of these those it has an answer for; None if not believed."""
        meant = _in_energy(part, probe, answers)
        same = _apart(given, meant) <= CLEAR * allowed
        first.append(bool(same[0]))
        if not same[wrong].all() or not _apart(meant, right)[0] > CLEAR * allowed[0]:
            return None
        other = ~same & ~wrong
        return int(other.sum()), int((other & np.isfinite(meant).all(axis=1) & np.isfinite(right).all(axis=1)).sum())

    believed, left = list[tuple[int, str, str]](), dict[str, Suggest]()
    for name, suggest in asked.items():
        first: list[bool] = []
        found_of_it = [
            (beyond[0], name, said + (_ONLY if beyond[1] else ""))
            for said, answers in suggest(probe)
            if (beyond := explains(answers)) is not None
        ]
        believed += sorted(found_of_it, key=lambda b: b[0])[:1]  # of equals the one yielded first
        left |= {name: suggest} if any(first) or not first else {}
    believed = [each for each in believed if each[1] != "components"] or believed  # which says where alone, not what is done
    return {name: statement for _, name, statement in sorted(believed, key=lambda b: b[0])}, left


def _apart(a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(a - b, axis=1))


def _measured(part: Part, probe: Probe) -> tuple[Array, Array, Array]:
    """Return what was returned (N, m), what is right (N, m), and the error allowed (N,), as lengths in the energy of the stiffness."""
    q, reply, u = probe.query, probe.reply, probe.query.unit(probe.reply)
    given = getattr(reply, part)
    if given is None:
        raise NoReply(part)
    right = {"stress": "closest", "slip": "slip", "multiplier": "multiplier", "tangent": "slopes"}[part]
    allowed = np.full(len(u), 1e-5 + q.accuracy) if part == "tangent" else u
    return _in_energy(part, probe, given), _in_energy(part, probe, getattr(probe, right)), allowed


def _in_energy(part: Part, probe: Probe, answers: Array) -> Array:
    q = probe.query
    if part == "stress":
        return q.shadow(answers)
    if part == "slip":
        return q.shadow(answers @ probe.stiffness)
    if part == "multiplier":
        return np.asarray((answers * q.dual_length(probe.gradient))[:, None])
    return q.whitened(answers).reshape(len(answers), -1)


def _probe(query: Query, found: Departure) -> Probe:
    """Ask for increments beside, beyond and within, under other pressures too; the numbers are like no others, so that none is special."""
    trial, at = np.array(found.trial), np.array(query.case.trial[0]) if found.closest is None else np.array(found.closest)
    size, d = np.abs(trial).max(), len(trial)
    signs = np.where(np.arange(d) % 2 == 0, 1.0, -1.0)
    beside = [trial * (1.0 + s * 0.0437 * signs) + s * 0.0213 * size * np.roll(signs, i) for i in range(d) for s in (1.0, -1.0)]
    far = [trial * c + 0.0371 * c * size * signs for c in (3.17, 11.3)]
    p, held = found.pressure or 0.0, "pressure" in query.fixed
    asked = [(row, 1.0) for row in (trial, 1.071 * trial, *beside, *far, 1.0193 * at, 0.953 * at)]
    asked += [(1.731 * beside[0], 1.731), (trial, 1.297), (2.93 * beside[1], 0.613)]
    asked += [(m * beside[1], 1.0) for m in (-np.ones(d), *(1.0 - 2.0 * np.eye(d))[: d if d > 1 else 0])]
    asked = [(row, p if held else share * p) for row, share in asked]
    if not held and found.pressure is not None and size > 0.0 and query.region.law is not None:
        own = query.region.law.domain.get(query.region.law.pressure or "")
        far_off = [(beside[0], 0.1 * p), (10.3 * beside[1], 10.0 * p)] if p else [(beside[0], -0.1 * size)]
        far_off += [(beside[0] * (1.0193 / (abs(p) or 0.1 * size)), -1.0)]
        asked += [(row, load) for row, load in far_off if own is None or load in own]
    rows, loads = map(list, zip(*asked, strict=True))
    n = len(rows)
    stacked, zero = np.array(rows), np.zeros((n, d))
    pressure = None if found.pressure is None else np.array(loads)
    case = replace(
        query.case.rows(np.zeros(n, dtype=np.intp)), stiffness=np.array(found.stiffness), pressure=pressure, trial=stacked,
        other=zero, third=zero, inside=zero, beside=zero, stretch=np.ones(n),
    )  # fmt: skip
    if query.region.law is not None:  # else after the path that leads to each
        case = replace(case, path=np.zeros((n, 1, d)), loads=None if pressure is None else pressure[:, None])
    beside_it = query.of(case)
    return Probe(beside_it, beside_it.ask(stacked)[0])


def constant(values: Array, near: float = 1e-6) -> float | None:
    """Return the value that all finite ones have, but for the share ``near`` of it; None where they differ."""
    known = values[np.isfinite(values)]
    if not known.size or np.ptp(known) > near * np.abs(known).max():
        return None
    return float(np.median(known))


def diagnosed(
    failures: Iterable[Failure], asked: Callable[[Case], Query], made: Origin, accused: bool, known: Collection[str] = ()
) -> list[Failure]:
    """Return failures with what the routine returned, asked again; of those of one part of its answer the likeliest are diagnosed.

    ``accused``: a check of the stress has failed; ``known`` are those of :func:`diagnoses`.  Without a law no closest point is known:
    only tangents, and steps of a law that a material is held to, are diagnosed.
    """
    told: list[Failure] = []
    tried: Counter[Part] = Counter()
    of_a_case: dict[tuple[bytes, ...], dict[str, str]] = {}
    for failure in sorted(failures, key=likeliest_first):
        now, lawful = replace(failure, origin=made), failure.law is not None
        gone = lawful and not failure.alone and isnan(failure.measured)  # it did not show when asked again, and would not here
        if not (failure.check.law_only or failure.check.whole or gone) and len(failure.case) == 1:
            part = _part(failure)
            now = replace(now, departure=departure(asked(failure.case)))
            apart = now.departure is not None and (now.departure.apart or part != "stress")
            if failure.check.of_states:
                key = failure.case.path.tobytes(), failure.case.trial.tobytes()
                if key not in of_a_case:
                    query = asked(beside_in_state(failure.case))
                    of_a_case[key] = of_the_state(query) if isinstance(query, HistoryQuery) else {}
                now = replace(now, diagnoses=of_a_case[key])
            elif (lawful or part == "tangent") and apart and tried[part] < _TRIED:
                now = replace(now, diagnoses=instead(now, asked, accused, known))
                tried[part] += _TRIED if now.diagnoses else 1
        told.append(now)
    return told


def instead(failure: Failure, asked: Callable[[Case], Query], accused: bool, known: Collection[str] = ()) -> dict[str, str]:
    """Return by name what the routine does instead, where that is known.

    Of a stress that is not the closest point a tangent says so first, where no check has ``accused`` the stress.
    """
    part, found, query = _part(failure), failure.departure, asked(failure.case)
    if found is None or (part == "stress" and not found.apart):
        return {}
    if part == "tangent" and found.apart and not accused:
        why = next(iter(diagnoses("stress", query, found).values()), "")
        return {"stress": f"the stress is not the closest point{why and ': '}{why}"}
    return diagnoses(part, query, found, known)


def _part(failure: Failure) -> Part:
    return _PARTS.get(failure.check.name, "stress")
