"""One case put to a material of which no law is known: a loading path, then an increment from where it ends.

|s| = (s . k^-1 s)^1/2 is the length of a stress, k the elastic stiffness.  A routine is held to an error in its stress of

    u = accuracy (|sigma_0| + |sigma_tr| + |sigma|) + 8 eps cond(k)^1/2 (|sigma_0| + |sigma_tr| + |sigma|),

sigma_0 the stress at the beginning of the step; the second part is what a few roundings of components make in that length.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from duhem.expression.jets import Choices
from duhem.projection.result import Array
from duhem.testing.checks.law_in_state import LawInState, LawStep
from duhem.testing.checks.query import NEAR, Asked, NoReply, NothingToCheck, Query, Raised, Reply
from duhem.testing.drawn.case import Case, Region
from duhem.testing.routines import ELASTIC, Material, MaterialState, Step, Unfinished, advanced

__all__ = ["FINER", "HistoryQuery"]

FINER = 8  # steps into which a leg of the path is divided where it is to be followed closely


class _Unknown(Region):
    """The K of an unknown law, of which nothing is known; no formula of it can be off."""

    def level(self, stress: Array, pressure: Array) -> Array:
        return np.full(len(stress), np.nan)

    def slope(self, stress: Array, pressure: Array, choices: Choices | None = None) -> tuple[Array, Choices]:
        return np.full_like(stress, np.nan), np.zeros((0, len(stress)), dtype=np.int8)

    def huge(self, pressure: Array) -> NDArray[np.bool_]:
        return np.zeros(len(pressure), dtype=np.bool_)


class HistoryQuery(Query):
    """``first`` and what else a :class:`Query` asks are steps from :attr:`start`, where the path ends.

    ``remembers`` says whether there may be more state than the stress.
    """

    whole: HistoryQuery | None
    turned = slice(None)  # each increment has a state of its own to start from
    _trials: Mapping[str, Reply] = {}  # the path is followed first

    def __init__(
        self,
        material: Material,
        case: Case,
        accuracy: float,
        every: int = 1,
        turn: int = 0,
        *,
        whole: HistoryQuery | None = None,
        raised: Raised | None = None,
        law: LawInState | None = None,
    ) -> None:
        nothing = _Unknown(None, case.parameters)  # type: ignore[arg-type]
        super().__init__(nothing, case, material.advance, (), accuracy, every, turn, whole=whole, raised=raised)
        self.material, self.remembers, self.lonely, self.law = material, material.towards is None, len(case) == 1, law

    def of(self, case: Case, whole: Query | None = None) -> HistoryQuery:
        return HistoryQuery(self.material, case, self.accuracy, whole=whole, law=self.law)  # type: ignore[arg-type]

    @property
    def tails(self) -> tuple[str, ...]:
        return self.material.components

    def together(self, asked: Sequence[Asked], stiffness: Array) -> list[Reply]:
        _ = self.start  # what fails on the way there is no fault of this step
        return super().together(asked, stiffness)

    def ahead(self) -> Mapping[str, Asked]:
        return {}

    def unit(self, reply: Reply) -> Array:
        """Return the error u in stress (N,) that the routine is held to in a step from the start."""
        return self.error(self.start.stress, reply.trial, reply.stress)

    def error(self, *stresses: Array) -> Array:
        """Return by how much (N,) the routine may be off in a step between such stresses, as a length."""
        return np.asarray((self.accuracy + self._rounding) * sum(self.length(s) for s in stresses))

    # -- steps ---------------------------------------------------------------------------------------------------------

    def step(self, before: MaterialState, trial: Array, pressure: Array | None, duration: float = 1.0) -> MaterialState:
        """The points after the increment of strain that asks for the stress ``trial`` (M, d).  What the routine raises passes."""
        duration = duration * self.case.factor
        if self.material.towards is not None:
            return self.material.towards(before, trial, pressure, duration)
        increment: Array = np.asarray(np.linalg.solve(self.case.stiffness, (trial - before.stress).T).T)
        return advanced(self.material, before, increment, pressure, duration, self.answered)

    def counted(
        self, before: MaterialState, trial: Array, pressure: Array | None, duration: float = 1.0, rows: NDArray[np.intp] | None = None
    ) -> MaterialState:
        """:meth:`step` of all the rows, in the order of ``rows``; those that the routine flags are not judged.  Raises NoReply.

        Of M trial stresses, a multiple of N, all the rows are asked several times in one call, ``before`` and ``pressure`` over again.
        """
        rows, many = np.arange(len(trial)) % len(self.case) if rows is None else rows, np.arange(len(trial))
        before = before if len(before) == len(trial) else before.rows(many % len(before))
        pressure = pressure if pressure is None or len(pressure) == len(trial) else pressure[many % len(pressure)]

        def ask(at: slice) -> MaterialState:
            return self.step(before.rows(at), trial[at], None if pressure is None else pressure[at], duration)

        def key(i: int) -> Hashable:
            load = None if pressure is None else pressure[i].tobytes()
            return *(part[i].tobytes() for part in (before.strain, before.stress, before.variables, trial)), load, duration

        try:
            after = self.raised.asked(ask, key, len(trial), self._said)
        except (NoReply, Unfinished) as fault:
            fault.row = None if fault.row is None else int(self.rows[rows[fault.row]])
            raise
        after = after if before.temperature is None else replace(after, temperature=before.temperature)
        self.points += len(after)
        self.note_overwritten(after.overwritten, rows)
        if after.solved is not None:
            self.flagged += int((~after.solved).sum())
            self.sound = self.sound.copy()
            self.sound[rows[~after.solved]] = False
        return after

    def answer(self, trial: Array, pressure: Array | None, stiffness: Array, rows: NDArray[np.intp]) -> Step:
        after = self.step(self.start.rows(rows), trial, pressure)
        return Step(after.stress, after.slip, None, after.tangent, after.solved, after.overwritten)

    def told_apart_by(self, row: int) -> Hashable:
        return self.case.path[row].tobytes(), None if self.case.loads is None else self.case.loads[row].tobytes()

    @property
    def start(self) -> MaterialState:
        """The points where the path ends."""
        return self.course[-1]

    @cached_property
    def course(self) -> list[MaterialState]:
        """The points at the knots of the path, the virgin ones first."""
        return self.along(1) if self.whole is None else [state.rows(self.rows) for state in self.whole.course]

    @cached_property
    def beyond(self) -> MaterialState:
        """The points after the step beyond the path, to the trial stress."""
        return self.counted(self.start, self.case.trial, self.case.pressure) if self.whole is None else self.whole.beyond.rows(self.rows)

    @property
    def timed(self) -> bool:
        """Whether the law depends on the rate."""
        return self.law is not None and self.law.own.timed

    @cached_property
    def law_step(self) -> LawStep:
        """The steps of the path and the one beyond it, all rows a step, against the law.  Raises NothingToCheck without one."""
        if self.law is None:
            raise NothingToCheck("no law with a state is given")
        case, course = self.case, [*self.course, self.beyond]
        before, after = MaterialState.joined(course[:-1]), MaterialState.joined(course[1:])
        loads = None if case.loads is None or case.pressure is None else np.concatenate([*case.loads.T[1:], case.pressure])
        asked = before.stress + (after.strain - before.strain) @ self.case.stiffness
        error = self.error(before.stress, asked, after.stress)
        others, dt = self.law.others(len(after), loads), np.full(len(before), case.factor)
        return LawStep(self.law, before, after, dt, others, error, self.accuracy, self._rounding, len(case))

    @property
    def given_stiffness(self) -> Array | None:
        """The elastic stiffness (d, d) that the routine should have, where it is known."""
        if self.law is not None and self.law.own.law.energy is not None:
            others = self.law.others(1, None if self.case.pressure is None else self.case.pressure[:1])
            chi, back, o = self.law.read(self.material.virgin(1), others), np.argsort(self.law.columns), self.law.own.observables
            return self.law.own.free_energy(chi, others)[2][0, :o, :o][np.ix_(back, back)]
        return None if self.material.stiffness is None else np.asarray(self.material.stiffness)

    @property
    def state_moves(self) -> NDArray[np.bool_] | None:  # type: ignore[override]
        before, after = self.start.variables, self.beyond.variables
        return (before != after).any(axis=1) if before.shape[1] else None

    @cached_property
    def here(self) -> Reply:
        """:attr:`beyond` as a reply to ``trial``."""
        if self.whole is not None:
            return self.heeded(self.whole.here.part(self.rows))
        found = self.beyond
        return self.heeded(Reply.read(Step(found.stress, found.slip, None, found.tangent, found.solved), self.case.trial))

    @cached_property
    def fine(self) -> list[MaterialState]:
        """The points along the path, each leg in ``FINER`` steps."""
        return self.along(FINER) if self.whole is None else [state.rows(self.rows) for state in self.whole.fine]

    def along(self, parts: int, duration: float = 1.0) -> list[MaterialState]:
        """The points along the path, each leg in so many steps, and the virgin ones first; ``duration`` is that of a leg."""
        case, found = self.case, [self.material.virgin(len(self.case))]
        for i in range(1, case.path.shape[1]):
            elastic = (case.path[:, i] - case.path[:, i - 1]) / parts
            for j in range(parts):
                share = (j + 1) / parts
                load = None if case.loads is None else (1.0 - share) * case.loads[:, i - 1] + share * case.loads[:, i]
                trial = found[-1].stress + elastic
                try:
                    found.append(self.counted(found[-1], trial, load, duration / parts))
                except NoReply as fault:
                    if fault.row is not None and self.whole is None and parts == duration == 1.0:
                        fault.case = _up_to(i, case, fault.row, trial)
                    raise
        return found

    @cached_property
    def steps(self) -> tuple[MaterialState, MaterialState]:
        """The points before and after the steps of the path followed closely and the one beyond it, all rows a step."""
        return MaterialState.joined([*self.fine[:-1], self.start]), MaterialState.joined([*self.fine[1:], self.beyond])

    def slipping(self, reply: Reply) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return which increments from the start (N,) are not answered elastically, and which of these are so but for 1e-6."""
        off, size = self.length(reply.corrector), self.length(reply.trial)
        slips = np.asarray(off > 4.0 * self.unit(reply) + ELASTIC * size)
        return slips, slips & (off <= NEAR * size)

    def slip_of(self, before: MaterialState, after: MaterialState) -> Array:
        """Return k times the part of an increment that is not elastic, a stress (N, d)."""
        return np.asarray((after.strain - before.strain) @ self.case.stiffness - (after.stress - before.stress))


def _up_to(i: int, case: Case, row: int, trial: Array) -> Case:
    """The case of one increment of a path, the one from knot i - 1 to knot i, after those before it."""
    at, loads = slice(row, row + 1), case.loads
    before = None if loads is None else loads[at, :i]
    return replace(case.row(row), path=case.path[at, :i], loads=before, trial=trial[at], pressure=None if loads is None else loads[at, i])
