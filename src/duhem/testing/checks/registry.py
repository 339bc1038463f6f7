"""The registry of checks, of routines with a law and without; each says what it demands, and a function measures it on a case.

With it stands what a run has visited: shares of the increments that stick, slip, lie at the boundary, a seam or a corner, and their
decades.  A test that never slipped says nothing of slip; these shares are what one reads to know.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.checks.query import NEAR, UNMEASURED, NoReply, NothingToCheck, Query, Reply
from duhem.testing.drawn.case import Case

__all__ = ["Check", "Finding", "Visited", "enter", "judged", "register", "registered", "violated", "worst"]


@dataclass(frozen=True)
class Finding:
    """What a check measured at each row (N,) and what it allows; more, or nan, is a violation; ``said`` (N,) instead of the numbers.

    ``unknown`` (N,): the rows of which the law does not say, as its g has no value there; they are not judged.
    ``tried``: of what it looked at more than the increments, how many, by name.  ``case``: the increments as they show what was
    found, where that was not drawn with them.
    """

    measured: Array
    allowed: Array
    said: NDArray[np.object_] | None = None
    unknown: NDArray[np.bool_] | None = None
    tried: Mapping[str, int] = field(default_factory=dict)
    case: Case | None = None


@dataclass(frozen=True)
class Check:
    """A fact every slip increment of a generalized standard law has.

    ``tolerance`` says what it is compared with and why; |s| = (s . k^-1 s)^1/2, and u is the error in stress
    the routine is held to (:mod:`duhem.testing.checks.query`).  ``law_only``: it looks at the law and never asks the routine.
    ``demanded``: the theory asks it of every law; the others are run where asked for by name.  ``whole``, of a check that no
    single case can fail, says at the end what is wrong with all that was visited, or None.  ``again``: it asks the routine for
    more than the answer to each trial, and so of some rows only (:attr:`duhem.testing.checks.query.Query.some`).
    ``needs``: what it must know to try all that it counts as tried, told where it could not.  ``of_a_law``: it compares a routine with
    a law; the others need none.  ``of_states``: it compares a material with a law of which it keeps the state.
    """

    name: str
    statement: str
    formula: str
    source: str
    tolerance: str
    measure: Callable[[Query], Finding]
    law_only: bool = False
    demanded: bool = True
    whole: Callable[[Visited], str | None] | None = None
    again: bool = False
    needs: str = ""
    of_a_law: bool = True
    of_states: bool = False

    def applies(self, of_a_law: bool, of_states: bool) -> bool:
        """Whether it is one of routines with a law or without, or of a material that is held to a law (``of_states``)."""
        return self.of_a_law == (of_a_law and not of_states) and of_states >= self.of_states

    @property
    def __name__(self) -> str:  # pytest names parametrised tests by it
        return self.name

    def __str__(self) -> str:
        return f"{self.name}: {self.statement}"


_checks: dict[tuple[bool, str], Check] = {}


def enter(check: Check) -> None:
    """Add a check to the registry."""
    _checks[check.of_a_law, check.name] = check


def register(**said: Any) -> Callable[[Callable[[Any], Finding]], Callable[[Any], Finding]]:
    """Return a decorator that enters a function as the check of its name; ``said`` are further fields of :class:`Check`, or the name."""

    def add(measure: Callable[[Any], Finding]) -> Callable[[Any], Finding]:
        enter(Check(measure=measure, **{"name": measure.__name__.replace("_", "-"), **said}))
        return measure

    return add


def registered(of_a_law: bool = True, of_states: bool = False) -> dict[str, Check]:
    """Return the checks of routines with a law or without, by name; those that look at the law alone come first, as they cost least.

    Those of a material and a law of which it keeps the state (``of_states``) are those that need none, and more.
    """
    found = [check for check in _checks.values() if check.applies(of_a_law, of_states)]
    return {check.name: check for check in sorted(found, key=lambda c: not c.law_only)}


def worst(pairs: Iterable[Iterable[Array]]) -> Finding:
    """Return, of several pairs measured (N,) and allowed (N,), for each row the pair that exceeds most; a nan exceeds all."""
    measured, allowed = (np.stack(each) for each in zip(*pairs, strict=True))
    with np.errstate(all="ignore"):
        at = np.argmax(np.nan_to_num(measured - allowed, nan=np.inf), axis=0), np.arange(measured.shape[1])
    return Finding(measured[at], allowed[at])


def violated(asked: Check, query: Query) -> tuple[Finding, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return what a check finds at the rows of a case, which of them (N,) violate it, and which were judged.

    Raises NothingToCheck where no row can be judged, NoReply where the routine gave none.
    """
    with np.errstate(all="ignore"):
        finding = asked.measure(query)
    for what, count in finding.tried.items():
        query.tried[asked.name, what] += count
    sound = query.sound if query.whole is None else query.sound & query.whole.sound[query.rows]
    counts = sound | asked.law_only
    if not counts.any():
        raise NothingToCheck("the routine flags every increment as not solved")
    if finding.unknown is not None:
        query.unsaid |= finding.unknown
        counts &= ~finding.unknown
        if not counts.any():
            raise NothingToCheck("g of the law has no value at any of the stresses to be judged")
    counts = counts & query.measurable
    if not counts.any():
        raise NothingToCheck(UNMEASURED)
    boundless = counts & ~np.isfinite(finding.allowed) & (not asked.law_only)
    if boundless.any():
        stress = query.here.stress
        with np.errstate(all="ignore"):
            boundless &= np.isfinite(stress).all(axis=1) & ~np.isfinite(query.length(stress))
        said = np.where(boundless, "the stress returned is so large that its square overflows", _said(finding))
        finding = replace(finding, said=said)
    return finding, (~(finding.measured <= finding.allowed) & counts) | boundless, counts


def _said(finding: Finding) -> NDArray[np.object_]:
    """What is said of each row."""
    if finding.said is not None:
        return finding.said
    pairs = zip(finding.measured.tolist(), finding.allowed.tolist(), strict=True)
    return np.array([f"measured {measured:.3g}, allowed {allowed:.3g}" for measured, allowed in pairs], dtype=object)


def judged(asked: Check, query: Query) -> tuple[Case, str, float, float] | None:
    """Return the increment of the row that violates a check most, a message, what was measured and what is allowed; None where none does.

    Raises NothingToCheck where no row can be judged, NoReply where the routine gave none.
    """
    query = query.some if asked.again else query
    finding, bad, _ = violated(asked, query)
    if not bad.any():
        return None
    with np.errstate(all="ignore"):
        excess = np.where(bad, np.nan_to_num(finding.measured - finding.allowed, nan=np.inf, posinf=1e300), -np.inf)
    i = int(np.argmax(excess))
    case = (query.case if finding.case is None else finding.case).row(i)
    return case, str(_said(finding)[i]), float(finding.measured[i]), float(finding.allowed[i])


# -- what a run has visited --------------------------------------------------------------------------------------------


_TURNED = 1e-3  # a normal that turns by more than this over such a way has jumped


class Visited:
    """Counts over the increments that the routine stands by; those it flags are judged by nobody.

    ``stick``, ``slip`` and ``boundary`` are what :meth:`Query.slipping` makes of a trial stress; ``tip``: without pressure; ``NAME+``
    and ``NAME-``: the sign of a force.  ``seam``: slip that ends within 1e-6 of where the formula changes its piece; ``corner``: where
    the normal jumps there; both are shares of the answers looked at.
    ``increments``: how many were counted; ``decades``: first and last power of ten of stresses, pressures and stiffnesses that are
    not zero.  Without a law (``forces`` is empty) forces are counted by their place, and there is no seam and no corner.
    ``state`` is the share of the increments in which a variable of the state changes.  ``searched`` counts
    what the search for the elastic range found, "range" or "none", or raised.
    ``creeps``: whether all increments may slip.
    ``unmeasured``: how many of the drawn increments cannot be judged, whatever is answered (:attr:`Query.measurable`).
    """

    def __init__(self, forces: tuple[str, ...], pressed: bool, creeps: bool = False) -> None:
        self.forces, self.creeps = forces, creeps
        names = ["stick", "slip", "boundary", *(["tip"] if pressed else []), *(["seam", "corner"] if forces else [])]
        self._counts = Counter(dict.fromkeys([*names, *(f"{name}{sign}" for name in forces for sign in "+-")], 0))
        self.unmeasured = self._drawn = 0
        self.increments = self._looked = self._slipping = self._given_up = 0
        self.decades: dict[str, tuple[int, int]] = {}
        self.searched: Counter[str] = Counter()

    @property
    def shares(self) -> Mapping[str, float]:
        """The shares by name, between 0 and 1; empty where the routine has answered nothing."""
        if not self.increments:
            return {}
        base = {"seam": self._looked, "corner": self._looked}
        return {name: count / max(base.get(name, self.increments), 1) for name, count in self._counts.items()}

    @property
    def given_up(self) -> float:
        """The share of the increments that slip which the routine flags as not solved; without a law, of all increments."""
        return self._given_up / self._slipping if self._slipping else 0.0

    def measure(self, query: Query) -> None:
        """Count the increments of a case that has been drawn, and those that cannot be judged."""
        self._drawn += len(query.case)
        self.unmeasured += int((~query.measurable).sum())

    def demand_measured(self, where: str) -> None:
        """Raise InputError where increments were drawn, and none of them could be judged."""
        if self._drawn and self.unmeasured == self._drawn:
            remedy = "give pressure, stiffness and parameters in other units"
            raise InputError(f"none of {self._drawn} increments can be judged: {UNMEASURED}", where=where, remedy=remedy)

    def add(self, query: Query) -> None:
        """Count the increments of a case that has been asked."""
        with np.errstate(all="ignore"):
            self._trials(query, query.here)
            if self.forces:
                with suppress(NoReply):
                    for reply in query.some.first[1:]:
                        self._trials(query.some, reply)
                self._answers(query, query.here)
        case = query.case
        strain = None if self.forces else np.linalg.solve(case.stiffness, case.trial.T)
        spread = {"stress": case.trial, "strain": strain, "pressure": case.pressure, "stiffness": np.diag(case.stiffness)}
        for name, values in spread.items():
            sizes = np.abs([] if values is None else values)
            sizes = sizes[(sizes > 0.0) & np.isfinite(sizes)]
            if sizes.size:
                low, high = (int(np.floor(np.log10(x))) for x in (sizes.min(), sizes.max()))
                before = self.decades.get(name, (low, high))
                self.decades[name] = min(low, before[0]), max(high, before[1])

    def _trials(self, query: Query, reply: Reply) -> None:
        solved, trial = reply.solved, reply.trial
        slips, boundary = query.slipping(reply)
        self.increments += int(solved.sum())
        may_slip = slips | (not self.forces)  # an answer that is given up does not say whether it slips
        self._slipping += int(may_slip.sum())
        self._given_up += int((may_slip & ~solved).sum())
        found = {"stick": ~slips, "slip": slips, "boundary": boundary}
        found |= {} if (moved := query.state_moves) is None else {"state": moved}
        found |= {"tip": query.pressure == 0.0} if "tip" in self._counts else {}
        for name, column in zip(self.forces or range(1, 1 + trial.shape[1]), trial.T, strict=True):
            found |= {f"{name}+": column > 0.0, f"{name}-": column < 0.0}
        self._counts.update({name: int((which & solved).sum()) for name, which in found.items()})

    def _answers(self, query: Query, reply: Reply) -> None:
        at = np.flatnonzero(reply.solved & np.isfinite(reply.stress).all(axis=1))
        self._looked += len(at)
        at = at[(reply.stress[at] != reply.trial[at]).any(axis=1) & (reply.stress[at] != 0.0).any(axis=1)]
        if not at.size:
            return
        stress, pressure = reply.stress[at], query.pressure[at]
        d, size = stress.shape[1], NEAR * np.abs(stress).max(axis=1)
        ways = np.vstack([np.eye(d), -np.eye(d)])
        points = (stress[None] + size[None, :, None] * ways[:, None, :]).reshape(-1, d)
        gradient, pieces = query.region.slope(points, np.tile(pressure, 2 * d))
        if not pieces.shape[1]:
            return
        around = pieces.reshape(2 * d, len(at), -1)
        seam = (around != around[0]).any(axis=(0, 2))
        normal = (gradient / np.linalg.norm(gradient, axis=1, keepdims=True)).reshape(2 * d, len(at), d)
        turned = np.linalg.norm(normal - normal[0], axis=2).max(axis=0)
        self._counts.update(seam=int(seam.sum()), corner=int((seam & (turned > _TURNED)).sum()))
