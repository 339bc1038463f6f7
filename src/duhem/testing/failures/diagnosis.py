"""Where a failing routine departs from the closest point, and what it does instead.

Suggestions are tried on increments beside the failing one, and kept only if they give the answers of the routine there.

A suggestion is a few lines: what the routine may be doing, and what it would return then.  It is believed where it gives what
was returned, to within the accuracy the routine is held to, at the failing increment and at every other one beside it that
is wrong, three at the least; so nothing is said of a routine that only resembles one.  Where others beside it are right, and would not be
if the routine did so everywhere, that is said.

A second mistake often shows where a first one does not: where a check fails in several regions of stress (at tips, near zero, at repeated
principal stresses, in tension, elsewhere), each is asked for its reason.  One failure is likely the cause of others: it is told once, with
the checks that it explains, expected or not.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import chain
from math import isnan
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.query import NEAR, NoReply, Query, Reply
from duhem.testing.checks.registry import Check, violated
from duhem.testing.drawn.case import Case, Region
from duhem.testing.failures.failure import Departure, Failure
from duhem.testing.failures.state_suggestions import beside_in_state, of_the_state
from duhem.testing.routines import Origin

__all__ = [
    "CAUSES", "CLEAR", "FREE_CAUSES", "IN_REGION", "Part", "Probe", "Regions", "as_expected", "by_cause", "constant", "departure",
    "diagnosed", "diagnoses", "instead", "of_stress", "region_of", "suggested", "suggests",
]  # fmt: skip

# -- regions of stress -------------------------------------------------------------------------------------------------


_AXES = {axis: i for i, axes in enumerate(("x1", "y2", "z3")) for axis in axes}


def region_of(query: Query, reply: Reply, thin: bool = True) -> NDArray[np.object_]:
    """The region (N,) of each increment, by its trial stress, and at the tip of a cone by the answer too; the ``thin`` ones first."""
    trial, answer = reply.trial, reply.stress
    found, size = np.full(len(trial), "elsewhere", dtype=object), query.length(trial)
    apex = (query.pressure == 0.0) & (query.case.pressure is not None)
    asked, given = (_tensors(query.tails, stress) for stress in (trial, answer))
    if asked is not None and given is not None:
        principal = np.linalg.eigvalsh(asked)
        scale, apart = np.abs(principal).max(axis=1), np.diff(principal, axis=1)
        found[principal.sum(axis=1) > NEAR * scale] = "in tension"
        found[(apart <= NEAR * scale[:, None]).any(axis=1) & thin] = "at repeated principal stresses"
        known = np.asarray(np.isfinite(given).all(axis=(1, 2)))
        ends = np.linalg.eigvalsh(np.where(known[:, None, None], given, asked))
        apex |= known & (np.ptp(ends, axis=1) <= NEAR * scale) & (apart > NEAR * scale[:, None]).any(axis=1)
    found[size <= NEAR * np.median(size)] = "near zero"
    found[apex] = "at the tip"
    return found


def _tensors(tails: Sequence[str], stresses: Array) -> Array | None:
    """Stresses (N, d) as tensors (N, 3, 3), by the ends of their names, such as xx, xy or 1; None where these tell no tensor."""
    axes = [(tail[0], tail[-1]) for tail in tails if len(tail) in (1, 2)]
    if len(tails) < 3 or len(axes) < len(tails) or not {*chain(*axes)} <= {*_AXES}:
        return None
    found = np.zeros((len(stresses), 3, 3))
    for (one, other), column in zip(axes, stresses.T, strict=True):
        found[:, _AXES[one], _AXES[other]] = found[:, _AXES[other], _AXES[one]] = column
    return found


class Regions:
    """Of one check, by region: how many increments were ``judged``, how many ``failed``, and the one that fails ``worst``."""

    def __init__(self, check: Check) -> None:
        self.check, self.judged, self.failed = check, Counter[str](), Counter[str]()
        self.worst: dict[str, tuple[float, Case]] = {}

    def add(self, query: Query) -> None:
        """Count the increments of a case."""
        query = query.some if self.check.again else query
        finding, bad, counts = violated(self.check, query)
        of, shown = region_of(query, query.here), query.case if finding.case is None else finding.case
        self.judged.update(of[counts].tolist())
        self.failed.update(of[bad].tolist())
        for i in np.flatnonzero(bad).tolist():
            most = float(np.nan_to_num(finding.measured[i] / (finding.allowed[i] or 1.0), nan=np.inf))
            if of[i] not in self.worst or most > self.worst[of[i]][0]:
                self.worst[of[i]] = most, shown.row(i)

    def __iter__(self) -> Iterator[tuple[str, Case]]:
        """Each region in which it fails, and the worst case there."""
        return ((name, case) for name, (_, case) in self.worst.items())

    def __str__(self) -> str:
        """Where it fails, and where not; "" where that says nothing."""
        order = sorted(self.judged, key=lambda name: (-self.failed[name] / self.judged[name], name))
        return ", ".join(map(self.of, order)) if len(order) > 1 and self.failed else ""

    def of(self, name: str) -> str:
        """How many increments of a region fail, in words."""
        return f"{self.failed[name]} of {self.judged[name]} {name}"


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


# -- causes ------------------------------------------------------------------------------------------------------------


_STRESS = (  # of a stress that is not the closest point, what says most of it first
    "feasibility", "idempotence", "homogeneity", "stiffness-scale", "complementarity", "variational-inequality", "dissipation", "ray",
    "non-expansiveness", "firmness", "potential", "path",
)  # fmt: skip
_OUTPUTS = ("slip", "energy", "multiplier", "slope", "tangent")
_SHAPE = (
    "variational-inequality", "non-expansiveness", "firmness", "potential", "ray", "idempotence", "complementarity", "tangent", "slope",
)  # fmt: skip

# The checks that may be the cause, the likeliest first, and those that fail with each.  What is said of the stress comes before what is
# returned beside it.
CAUSES: Mapping[str, tuple[str, ...]] = {
    "vacuity": (),
    "answers": (*_STRESS, *_OUTPUTS, "repeatability"),  # without a stress, they cannot pass
    "origin": _SHAPE,  # if K does not contain the origin, the closest point has none of these properties
    "convexity": _SHAPE,  # if K is not convex, the closest point is not unique and has none of these properties
    "smoothness": (),  # a corner of K affects no other check
    "repeatability": (*_STRESS, *_OUTPUTS),  # an answer that depends on earlier calls cannot satisfy them
    "inputs": (),  # an answer may be right although the routine has changed its inputs
    **{name: _STRESS[i + 1 :] for i, name in enumerate(_STRESS)},  # each of them follows if the stress is the closest point
    "slip": ("energy",),  # the balance of energy uses the returned slip
    "energy": (),
    "multiplier": (),
    "slope": ("tangent",),  # a tangent that is not the slope of the stress need be neither symmetric nor bounded
    "tangent": (),  # where it is the slope of the stress, the stress derives from no potential
}
_STATES = ("kept-state", "stress-of-the-state", "admissibility", "loading", "flow", "evolution", "law-dissipation")
_FREE_STRESS = (*_STATES, "rest", "slip", "stored-energy", "dissipation", "energy", "slope", "subdivision")
_ASSOCIATED = ("associated-symmetry", "associated-non-expansiveness", "associated-potential", "associated-ray")
# The same of the checks that need no law, the likeliest cause first.
FREE_CAUSES: Mapping[str, tuple[str, ...]] = {
    "answers": ("repeatability", "elasticity", "vacuity", "rate", *_FREE_STRESS, *_ASSOCIATED),
    "repeatability": ("elasticity", "vacuity", "rate", *_FREE_STRESS, *_ASSOCIATED),
    "inputs": (),
    "elasticity": ("vacuity", *_FREE_STRESS, "isotropic-plastic-work"),
    "vacuity": (),
    **{name: (*_STATES[i + 1 :], *_FREE_STRESS[len(_STATES) :]) for i, name in enumerate(_STATES)},
    "rate": ("energy", "subdivision"),
    "dissipation": ("energy", "isotropic-plastic-work", "associated-potential"),
    "rest": ("slip", "stored-energy", "energy", "subdivision", *_ASSOCIATED),
    "slip": ("dissipation", "energy"),
    "stored-energy": ("energy",),
    "energy": (),
    "slope": ("associated-symmetry",),
    "subdivision": (),
}
_TABLES = {True: CAUSES, False: FREE_CAUSES}  # with a law, and without
_UNSYMMETRIC = {"potential", "firmness", "variational-inequality"}  # a stress without a potential has no symmetric slope


def by_cause(failures: Sequence[Failure]) -> tuple[tuple[Failure, ...], tuple[Failure, ...]]:
    """Return the failures that are likely causes, the likeliest first, and those that they explain.

    The diagnosis that explains most failures of a kind is taken first, and they are one; the others are ordered by the table.
    """
    left, failed = sorted(failures, key=likeliest_first), {f.check.name for f in failures}
    roots: list[Failure] = []
    explained: list[Failure] = []
    while left:
        root = left[0]
        of_a_kind = [f for f in left if _kind(f) == _kind(root)]
        met = Counter(name for f in of_a_kind for name in f.diagnoses)
        if met and _kind(root):
            told = max(met, key=lambda name: met[name])  # of equals the first met
            root = next(f for f in of_a_kind if told in f.diagnoses)
            root = replace(root, diagnoses={told: root.diagnoses[told], **({} if root.check.of_a_law else root.diagnoses)})
        behind = [f for f in left if f.check != root.check and _explains(root, f, failed)]
        names = tuple(f.check.name for f in behind)
        roots.append(replace(root, explains=names))
        explained += behind
        left = [f for f in left if f.check.name not in (root.check.name, *names)]
    return tuple(sorted(roots, key=likeliest_first)), tuple(explained)


def as_expected(
    reasons: Mapping[str, str], failed: Collection[str], passed: Collection[str], left_out: Mapping[str, str], of_a_law: bool
) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Return the checks that failed as expected, those that passed though they had to fail, and those left out, each with the reason.

    ``reasons`` are those for which checks are known to fail.  Which of the checks that a cause explains fail with it depends on the
    cases that were drawn, so that they may fail or pass.
    """
    causes = [name for name in reasons if name in failed]
    explained = {name: cause for cause in causes[::-1] for name in _explained_by(cause, failed, of_a_law)}
    likely = {name: f"likely for the same reason as [{cause}]" for name, cause in explained.items()}
    met = {name: why for name, why in {**likely, **reasons}.items() if name in failed}
    unmet = {name: why for name, why in reasons.items() if name in passed and name not in likely}
    vain = reasons.keys() - likely.keys()
    told = {name: f"{why}; so it is expected to fail in vain" if name in vain else why for name, why in left_out.items()}
    return met, unmet, told


def _explained_by(check: str, failed: Collection[str], of_a_law: bool) -> tuple[str, ...]:
    """Return the checks that may fail for the reason for which ``check`` does, by the tables; ``failed`` are all that failed with it."""
    behind = _TABLES[of_a_law].get(check, ())
    turned = _UNSYMMETRIC & {check, *behind} & set(failed)
    return (*behind, "tangent") if check in _STRESS and turned and "slope" not in failed else behind


def likeliest_first(failure: Failure) -> tuple[int, int]:
    """Return a key that sorts failures, the likeliest cause first."""
    order = [*_TABLES[failure.check.of_a_law], failure.check.name]
    return _kind(failure), order.index(failure.check.name)


def of_stress(failure: Failure) -> bool:
    """Return whether a failure is one of the stress itself, not of what is returned beside it or of the calls."""
    return failure.check.of_a_law and failure.check.name in _STRESS


def _kind(failure: Failure) -> int:
    """Return 0 for causes of all, 1 for those of stresses, 2 for those of what is returned beside them; without a law always 0."""
    if not failure.check.of_a_law:
        return 0
    name = failure.check.name
    return 1 if of_stress(failure) else 0 if name in _TABLES[True] and name not in _OUTPUTS else 2


def _explains(root: Failure, other: Failure, failed: set[str]) -> bool:
    name = other.check.name
    if _kind(root) == 1:  # a diagnosis may have put it before a check that ranks higher
        return name in _STRESS or (name == "tangent" and "slope" not in failed and bool(failed & _UNSYMMETRIC))
    if root.diagnoses.keys() & other.diagnoses.keys():
        return True
    if root.diagnoses and other.diagnoses and not root.check.of_a_law:
        return False  # another mistake
    return name in _TABLES[root.check.of_a_law].get(root.check.name, ())
