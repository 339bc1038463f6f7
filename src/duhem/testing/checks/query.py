"""One case put to one routine: each reply is read and asked for once, measured in the energy of the stiffness.

|s| = (s . k^-1 s)^1/2 is the length of a stress.  A routine is held to an error in its stress of

    u = accuracy (|sigma_tr| + |sigma|) + 8 eps cond(k)^1/2 (|sigma_tr| + |sigma| + |K|) + 2 dg/|grad g|,

the second part being what a few roundings of the components of a stress, of the trial and of K, make in that length: a
relative error eps of one component is eps cond(k)^1/2 of the whole.  |K| is the farthest point of K on the axes.  In the
third, dg bounds what g, as the law's formula has it, may be off by in doubles: so far the boundary is not known.

The first part counts the size of the trial, not that of the answer alone: beside a trial 1e8 times as far out as K goes, an accuracy
of 1e-9 is a tenth of K.  A routine that stops where its slip is right to ``accuracy`` and answers sigma_tr - k slip is off by that
much; so is one that answers exactly to a trial that is itself off by ``accuracy``, along a flat face, where |P(x) - P(y)| = |x - y|.
Both keep what is promised, and no answer says whence its error comes, so that to ask for ``accuracy`` |sigma| would accuse them.
Who means 1e-9 of the answer's own size promises an accuracy of 1e-9 |K|/|sigma_tr|; below 1e-15 rounding alone is left.  The
tolerance of each check follows from u by the triangle inequality, and is written where the check is.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, TypeAlias, TypeVar
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from duhem.errors import words_of
from duhem.projection.increment import factors
from duhem.projection.result import Array
from duhem.testing.drawn.case import Case, Region
from duhem.testing.routines import FormerAnswers, NoStep, Overwritten, Step, Unfinished, called, shaped

__all__ = ["NEAR", "UNMEASURED", "Asked", "NoReply", "NothingToCheck", "Query", "Raised", "Reply", "named_by"]

_FEW = 8  # increments that are asked one by one once the routine has raised, so that a call costs one process at most
_Answer = TypeVar("_Answer")
_PATHS = 4  # cases, in one of which some rows follow their paths to the end
NEAR = 1e-6  # of the size of a stress: so near is at the boundary, on a seam, at a corner
UNMEASURED = "squares of the stresses, or K itself, overflow or underflow"
_LEAST, _MOST = 2.0**-480, 2.0**495  # lengths whose squares, and those of what is asked besides, are doubles
_CLOSE, _ASIDE = 1e-7, 0.01  # of a trial stress: closer than six digits tell, and no farther than it may be called close
_SIZE = 20  # bits: the size of K to a part in a thousand

Asked: TypeAlias = tuple[Array, Array | None]  # trial stresses (N, d) and their pressures (N,)


class NoReply(Exception):
    """The routine raised, or returned something that is no stress.

    ``row``: the increment at which it does so alone, None where that is not known; ``case``: the case of that increment, as the one
    that is tried, where it is another than the trial of the row; ``together``: it raises at several asked together, and at none alone.
    """

    case: Case | None = None

    def __init__(self, said: str, row: int | None = None, together: bool = False) -> None:
        super().__init__(said)
        self.row, self.together = row, together


@dataclass
class Raised:
    """What a routine raised, by what tells its increments apart, and how many ``times`` it did."""

    said: dict[Hashable, str] = field(default_factory=dict)
    times: int = 0

    def asked(
        self, ask: Callable[[slice], _Answer], key: Callable[[int], Hashable], count: int, say: Callable[[BaseException], str]
    ) -> _Answer:
        """Return the answer to so many increments asked together.  Raises NoReply and Unfinished with the row that is to blame alone."""

        def alone(row: int) -> None:
            try:
                ask(slice(row, row + 1))
            except Unfinished as fault:
                fault.row = row
                raise
            except (Exception, SystemExit) as fault:
                self.times += 1
                self.said[key(row)] = say(fault)
                raise NoReply(self.said[key(row)], row) from fault

        together = tuple(map(key, range(count))) if self.said else ()
        for row, each in enumerate(together):
            if each in self.said:
                raise NoReply(self.said[each], row)
        if together in self.said:
            raise NoReply(self.said[together], together=True)
        for row in range(count) if self.said and 1 < count <= _FEW else ():
            alone(row)
        try:
            return ask(slice(None))
        except Unfinished as fault:
            for row in range(count if fault.row is None else 0):
                with suppress(NoReply):  # that an increment fails is told when it is asked alone
                    alone(row)
            raise
        except (Exception, SystemExit) as fault:
            self.times += 1
            said = say(fault)
            if count == 1:
                self.said[key(0)] = said
                raise NoReply(said, 0) from fault
        for row in range(count):
            alone(row)
        self.said[tuple(map(key, range(count)))] = said
        raise NoReply(said, together=True)


def named_by(fault: NoReply | Unfinished, case: Case) -> Case:
    """Return the increment of a case that the routine does not answer alone, as the one that is tried."""
    return case.row(fault.row or 0) if fault.case is None else fault.case


@dataclass(frozen=True, eq=False)
class Reply:
    """What the routine returned for ``trial`` (N, d), as arrays; ``solved`` (N,) as it says itself."""

    trial: Array
    stress: Array
    slip: Array | None
    multiplier: Array | None
    tangent: Array | None
    solved: NDArray[np.bool_]

    @property
    def corrector(self) -> Array:
        """sigma_tr - sigma = k slip, a stress (N, d)."""
        return self.trial - self.stress

    def part(self, rows: slice | NDArray[np.intp]) -> Reply:
        """Return the reply to some of the rows."""
        return Reply(*(None if x is None else x[rows] for x in (getattr(self, name) for name in self.__dataclass_fields__)))  # type: ignore[arg-type]

    @classmethod
    def read(cls, step: Step, trial: Array) -> Reply:
        """Return what was answered to ``trial`` (N, d).  Raises NoReply where that has not the shapes it must have."""
        n, d = trial.shape
        shapes = {"stress": (n, d), "slip": (n, d), "multiplier": (n,), "tangent": (n, d, d)}
        parts = {name: shaped(getattr(step, name), name, shape, NoReply) for name, shape in shapes.items()}
        solved = np.ones(n, dtype=np.bool_) if step.solved is None else np.array(step.solved, dtype=np.bool_).reshape(n)
        return cls(trial, **parts, solved=solved)  # type: ignore[arg-type]


class NothingToCheck(Exception):
    """A check has nothing to look at, and why."""


class Query:
    """One case put to one routine, k = L L^T its stiffness.

    ``sound`` (N,) are the rows whose every reply so far the routine stands by; ``points`` and ``flagged`` count replies;
    ``overwritten`` (N,) has the names of what the routine was only given and has changed, "" where nothing; ``unsaid`` (N,) are the
    rows which a check could not judge, since g has no value there; ``tried`` counts what checks looked at more than the
    increments, by their name and that of the thing.

    Of one row in ``every`` more is asked than the trial, and those are a query of their own, :attr:`some`; ``whole`` is the one that
    has them among its own, and ``rows`` (N,) are their places there.  ``turn`` counts the cases of a run: what takes calls of its own
    is asked of some rows in some of the cases only (:meth:`by_turns`).  ``raised`` is what the routine has raised so far, shared by
    the queries of a run; ``answered`` is what it has answered to this query and its parts; ``opening`` is the increment that the
    routine was asked before all others of the run, None where that is this one; ``fixed`` says which of "pressure" and "stiffness"
    is one and the same for all, as the routine may know: no other is asked.  ``axes`` (d, d) are d stresses of length 1, orthogonal
    in the energy: the columns of L; ``pressure`` is sigma_n (N,), zeros for a law without.
    """

    state_moves: NDArray[np.bool_] | None = None  # at which increments (N,) a variable of the state changes, where there are any
    lonely = False  # whether the reply to the trial is one to a call of one increment
    turned = slice(None, None, -1)  # the order in which rows may be asked: the last first

    def __init__(
        self,
        region: Region,
        case: Case,
        update: Callable[..., Any],
        passed: tuple[str, ...],
        accuracy: float,
        every: int = 1,
        turn: int = 0,
        *,
        whole: Query | None = None,
        raised: Raised | None = None,
        opening: Case | None = None,
        fixed: frozenset[str] = frozenset(),
    ) -> None:
        self.region, self.case, self.update, self.passed, self.accuracy = region, case, update, passed, accuracy
        self.every, self.turn, self.whole, self.opening, self.fixed = every, turn, whole, opening, fixed
        self.raised, self.answered, self.rows = Raised() if raised is None else raised, FormerAnswers(), np.arange(len(case))
        if whole is None:
            self._lower, self._inverse = factors(case.stiffness)
        else:
            self.turn, self.raised, self.answered, self.fixed = whole.turn, whole.raised, whole.answered, whole.fixed
            self.rows, self._lower, self._inverse = _some(len(whole.case), whole.every), whole._lower, whole._inverse
        self.pressure = np.zeros(len(case)) if case.pressure is None else case.pressure
        self.axes, self.points, self.flagged = self._lower.T, 0, 0
        self.sound, self.unsaid = np.ones(len(case), dtype=np.bool_), np.zeros(len(case), dtype=np.bool_)
        self.overwritten: Overwritten = np.full(len(case), "", dtype=object)
        self.tried: Counter[tuple[str, str]] = Counter()
        self._units: dict[Reply, Array] = {}
        self._gradients: dict[Reply, Array] = {}

    @cached_property
    def some(self) -> Query:
        """The rows of which more is asked than the trial; this query itself where these are all."""
        rows = _some(len(self.case), self.every)
        return self if len(rows) == len(self.case) else self.of(self.case.rows(rows), self)

    def of(self, case: Case, whole: Query | None = None) -> Query:
        """A query of another case, or of some of the rows of the ``whole``, which has them among its own."""
        told = {"whole": whole, "opening": self.opening, "fixed": self.fixed}
        return Query(self.region, case, self.update, self.passed, self.accuracy, **told)  # type: ignore[arg-type]

    def by_turns(self, cases: int) -> bool:
        """Whether to ask what is asked in the first of so many cases: always, where all the rows are asked for all."""
        return self.whole is None or self.turn % cases == 0

    @property
    def tails(self) -> tuple[str, ...]:
        """The ends of the names of the components of a stress tensor, such as xx; none where the law declares none."""
        law = self.region.law
        return () if law.stress is None else tuple(name.rpartition("_")[2] for name in law.forces)

    @property
    def parts(self) -> tuple[Query, ...]:
        """This query and the one of its rows of which more is asked: the two that have asked the routine."""
        return (self,) if self.some is self else (self, self.some)

    # -- measures ------------------------------------------------------------------------------------------------------

    def inner(self, a: Array, b: Array) -> Array:
        """Return a . k^-1 b (N,)."""
        return np.einsum("ij,ij->i", a @ self._inverse.T, b @ self._inverse.T)

    def length(self, a: Array) -> Array:
        """Return (a . k^-1 a)^1/2 (N,), the length of stresses."""
        return np.asarray(np.linalg.norm(a @ self._inverse.T, axis=1))

    def dual_length(self, slip: Array) -> Array:
        """Return (slip . k slip)^1/2 (N,), the dual length, which is that of gradients of g too."""
        return np.asarray(np.linalg.norm(slip @ self._lower, axis=1))

    def whitened(self, matrices: Array) -> Array:
        """Return L^-1 C L^-T (N, d, d) of tangents C, k = L L^T."""
        return self._inverse @ matrices @ self._inverse.T

    def shadow(self, a: Array) -> Array:
        """Return L^-1 a (N, d), whose Euclidean length is |a|."""
        return a @ self._inverse.T

    def unit(self, reply: Reply) -> Array:
        """Return the error u in stress (N,) that the routine is held to, found once for all checks."""
        if self.whole is not None and reply is self.here:
            return self.whole.unit(self.whole.here)[self.rows]
        if reply not in self._units:
            size = self.length(reply.trial) + self.length(reply.stress)
            steep = self.dual_length(self.gradient(reply))
            blur = self.region.rounding(reply.stress, self.pressure) / np.where(steep > 0.0, steep, np.inf)
            self._units[reply] = self.accuracy * size + self._rounding * (size + self._extent) + 2.0 * blur
        return self._units[reply]

    def gradient(self, reply: Reply) -> Array:
        """Return grad g (N, d) at the stresses of a reply, found once for all checks."""
        if self.whole is not None and reply is self.here:
            return self.whole.gradient(self.whole.here)[self.rows]
        if reply not in self._gradients:
            self._gradients[reply] = self.region.slope(reply.stress, self.pressure)[0]
        return self._gradients[reply]

    @cached_property
    def _rounding(self) -> float:
        return 8.0 * float(np.finfo(np.float64).eps * np.sqrt(np.linalg.cond(self.case.stiffness)))

    @cached_property
    def _extent(self) -> Array:
        """|K| (N,)."""
        if self.whole is not None:
            return self.whole._extent[self.rows]
        ways = np.vstack([np.eye(d := self.case.trial.shape[1]), -np.eye(d)])
        return np.asarray((np.where(np.isfinite(self.reaches), self.reaches, 0.0) * self.length(ways)).max(axis=1))

    @cached_property
    def reaches(self) -> Array:
        """How far K goes from the origin along each axis and then against each (N, 2 d), to a part in a thousand; inf without end."""
        n, d = self.case.trial.shape
        ways = np.vstack([np.eye(d), -np.eye(d)])
        return self.region.reach(np.tile(ways, (n, 1)), np.repeat(self.pressure, 2 * d), _SIZE).reshape(n, 2 * d)

    @cached_property
    def measurable(self) -> NDArray[np.bool_]:
        """The rows (N,) whose stresses have lengths with squares in double precision, and whose K ends where they have.

        A K without an end on any axis may end in overflow where a number of the law is huge.
        """
        if self.whole is not None:
            return self.whole.measurable[self.rows]
        size, huge = self.case.longest(self._inverse), self.region.huge(self.pressure)
        lost = ~np.isfinite(self.reaches).any(axis=1) if huge.any() else huge
        return np.asarray(((size == 0.0) | ((size >= _LEAST) & (size <= _MOST))) & ~(huge & lost))

    def slipping(self, reply: Reply) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return which trial stresses (N,) lie outside K, and which within 1e-6 of the end of K on the ray to them; in doubles."""
        inside, nearer, beyond = (self.region.level(c * reply.trial, self.pressure) <= 0.0 for c in (1.0, 1.0 - NEAR, 1.0 + NEAR))
        return ~inside, nearer & ~beyond

    # -- the law -------------------------------------------------------------------------------------------------------

    def certainly(self, suspects: NDArray[np.bool_], stress: Array, *, outside: bool) -> NDArray[np.bool_]:
        """Return which suspects lie outside K, or inside, in 60 digits: neither rounding of g nor a g without value may accuse anyone."""
        found = np.zeros(len(stress), dtype=np.bool_)
        at = np.flatnonzero(suspects)
        found[at] = self.region.outside(stress[at], self.pressure[at]) == outside
        if outside and found.any():
            found[found] = ~self.region.unknown(stress[found], self.pressure[found])
        return found

    # -- replies -------------------------------------------------------------------------------------------------------

    def ask(self, *trials: Array, pressure: Array | None = None, stiffness: Array | None = None) -> list[Reply]:
        """Return the routine's replies to several trial stresses (N, d) a row, asked in one call."""
        loads = self.case.pressure if pressure is None else pressure
        asked = [(trial, loads) for trial in trials]
        return [self.heeded(reply) for reply in self.together(asked, self.case.stiffness if stiffness is None else stiffness)]

    def heeded(self, reply: Reply) -> Reply:
        """Return a reply to all the rows, of which those that it flags are not judged from here on."""
        self.sound = self.sound & reply.solved
        return reply

    def together(self, asked: Sequence[Asked], stiffness: Array) -> list[Reply]:
        """Return the replies to trial stresses (N, d) under pressures (N,), asked in one call."""
        loads = None if self.case.pressure is None else np.concatenate([pressure for _, pressure in asked if pressure is not None])
        ends = np.cumsum([0, *(len(trial) for trial, _ in asked)]).tolist()
        rows = np.concatenate([np.arange(len(self.case)) if len(trial) == len(self.case) else self.some.rows for trial, _ in asked])
        trials = np.concatenate([trial for trial, _ in asked])
        order = _arranged(len(trials), crc32((self.whole or self).case.trial.tobytes()))
        mixed = self._reply(trials[order], None if loads is None else loads[order], stiffness, rows[order])
        whole = mixed.part(np.unique(order, return_index=True)[1])
        self.points += len(whole.trial)
        self.flagged += int((~whole.solved).sum())
        return [whole.part(slice(start, end)) for start, end in pairwise(ends)]

    def _reply(self, trial: Array, pressure: Array | None, stiffness: Array, rows: NDArray[np.intp], raised: Raised | None = None) -> Reply:
        def ask(at: slice) -> Step:
            return self.answer(trial[at], None if pressure is None else pressure[at], stiffness, rows[at])

        def key(i: int) -> Hashable:
            load = b"" if pressure is None else pressure[i].tobytes()
            return trial[i].tobytes(), load, stiffness.tobytes(), self.told_apart_by(int(rows[i]))

        try:
            step = (raised or self.raised).asked(ask, key, len(trial), self._said)
        except (NoReply, Unfinished) as fault:
            if fault.row is not None:
                at, own = slice(fault.row, fault.row + 1), int(rows[fault.row])
                load = None if pressure is None else pressure[at]
                fault.case = replace(self.case.row(own), trial=trial[at], pressure=load, stiffness=stiffness)
                fault.row = int(self.rows[own])
            raise
        self.note_overwritten(step.overwritten, rows)
        return Reply.read(step, trial)

    def answer(self, trial: Array, pressure: Array | None, stiffness: Array, rows: NDArray[np.intp]) -> Step:
        """Return what the routine answers to some increments of these ``rows``.  An exception that it raises passes through."""
        values = {name: value for name, value in self.region.parameters.items() if name in self.passed}
        return called(self.update, values, trial, pressure, stiffness, self.answered)

    def told_apart_by(self, row: int) -> Hashable:
        """Return what else tells an increment of a row from others with the same trial stress, pressure and stiffness."""
        return tuple(self.region.parameters.values())

    def _said(self, fault: BaseException) -> str:
        if isinstance(fault, NoStep):
            return str(fault)
        return f"the routine raised {type(fault).__name__}: {words_of(fault)}{self._not_passed(fault)}"

    def _not_passed(self, fault: BaseException) -> str:
        """Return a hint where the routine misses an argument that is a parameter of the law with a fixed value; else ""."""
        missed = re.search(r"missing .* argument.*?'(\w+)'", str(fault)) if isinstance(fault, TypeError) else None
        if missed is None or missed[1] not in self.region.parameters or missed[1] in self.passed:
            return ""
        name = missed[1]
        return f" (duhem passes only parameters without a value; {name} has one: leave it open, or give it a default in the routine)"

    def note_overwritten(self, names: Any, rows: NDArray[np.intp]) -> None:
        """Keep the names (M,) that a reply to so many ``rows`` brings."""
        if names is None:
            return
        for name, row in zip(np.asarray(names, dtype=object).tolist(), rows.tolist(), strict=True):
            self.overwritten[row] = self.overwritten[row] or name
        if self.whole is not None:
            self.whole.note_overwritten(names, self.rows[rows])

    @cached_property
    def here(self) -> Reply:
        """The reply to ``trial``."""
        return self.heeded(self._trials["trial"] if self.whole is None else self.whole._trials["trial"].part(self.rows))

    @cached_property
    def first(self) -> list[Reply]:
        """The replies to ``trial``, ``other`` and ``third``, of a query of which all the rows are asked for them."""
        assert self.some is self
        return [self.here, *(self.heeded(self._round_1[name]) for name in ("other", "third"))]

    @cached_property
    def second(self) -> list[Reply]:
        """The replies to the stress found, and to a point on its way to the trial."""
        return [self.heeded(self._round_2[name]) for name in ("stress", "way")]

    @cached_property
    def larger(self) -> Reply:
        """The reply to ``factor`` times the trial under ``factor`` times the pressure."""
        return self.heeded(self._known_or_asked(self._round_1, "larger", self._enlarged))

    @cached_property
    def again(self) -> Reply:
        """The reply to ``trial``, asked after other questions and the last row first."""
        return self.heeded(self._known_or_asked(self._round_2, "again", self._backwards).part(slice(None, None, -1)))

    @cached_property
    def alone(self) -> tuple[int, Reply | str]:
        """A row, another one in each case, and the reply to its trial in a call of its own; what is wrong where there is none.

        Where all replies are to calls of one increment, it is asked in company, which is itself.
        """
        row, own = self.turn % len(self.case), Raised()
        at = np.repeat(row, 2 if self.lonely else 1)
        load = None if self.case.pressure is None else self.case.pressure[at]
        self.points += len(at)
        try:
            reply = self._reply(self.case.trial[at], load, self.case.stiffness, at, own).part(slice(0, 1))
        except NoReply as fault:
            self.raised.times += own.times  # what it said is not kept: among others it answers
            return row, str(fault)
        self.flagged += len(at) * int(not reply.solved[0])
        self.sound = self.sound & (reply.solved | (np.arange(len(self.case)) != row))
        return row, reply

    @cached_property
    def apart(self) -> tuple[Reply, ...]:
        """Replies in calls of one size one after the other: to ``other``, close to ``trial``, ``trial``, ``trial``, ``third``, ``trial``.

        The trial after others, after itself, and after what a routine may take for it, the last row first, so that the first follows
        upon its like; ``third`` under another pressure, if there is one.  None but itself comes four calls after: of four buffers each is
        written over.
        """
        case = self.case
        close = (1.0 - min(max(_CLOSE, 100.0 * self.accuracy), _ASIDE)) * case.trial
        back, load = self.turned, case.pressure
        first = self.ask(case.other)[0]
        beside = self.heeded(self.together([(close[back], None if load is None else load[back])], case.stiffness)[0].part(back))
        trials = self.ask(case.trial)[0], self.ask(case.trial)[0]
        third = self.ask(case.third, pressure=None if case.loads is None else case.loads[:, -1])[0]
        return first, beside, *trials, third, self.ask(case.trial)[0]

    def along_the_path(self) -> Iterator[Reply]:
        """The replies to the increments of ``path``, from no stress on, each from where the one before has ended."""
        stress, steps = np.zeros_like(self.case.trial), self.case.path.shape[1] - 1
        for i in range(1, 1 + (steps if self.by_turns(_PATHS) else min(steps, 2))):  # the first two are asked with the rest
            known = self._round_1 if i == 1 else self._round_2 if i == 2 else {}
            reply = self.heeded(self._known_or_asked(known, "step", self._step(i, stress)))
            yield reply
            stress = reply.stress

    # A routine that works on arrays may spend as long on a call as on its rows: what can be asked at once is.

    @cached_property
    def _trials(self) -> Mapping[str, Reply]:
        """The reply to all trial stresses, and with them those of round 1, if the routine could answer all of it."""
        return self._at_once({"trial": (self.case.trial, self.case.pressure)}, {**self.some._others, **self.some.ahead()})

    @cached_property
    def _round_1(self) -> Mapping[str, Reply]:
        known = {name: reply for name, reply in (self.whole or self)._trials.items() if name != "trial"}
        return known or self._at_once(self._others, self.ahead())

    @property
    def _others(self) -> Mapping[str, Asked]:
        return {"other": (self.case.other, self.case.pressure), "third": (self.case.third, self.case.pressure)}

    @cached_property
    def _round_2(self) -> Mapping[str, Reply]:
        here, load = self.here, self.case.pressure
        stress = np.where(np.isfinite(here.stress), here.stress, here.trial)  # no routine need answer what is no number
        way = stress + self.case.stretch[:, None] * (here.trial - stress)
        more = {"again": self._backwards}
        if "step" in self._round_1 and self.case.path.shape[1] > 2:
            more["step"] = self._step(2, self._round_1["step"].stress)
        return self._at_once({"stress": (stress, load), "way": (way, load)}, more)

    def ahead(self) -> Mapping[str, Asked]:
        """What may be asked with the first, and is needed later, if at all."""
        larger = {"larger": self._enlarged} if self.scales else {}
        return larger | ({"step": self._step(1, np.zeros_like(self.case.trial))} if self.case.path.shape[1] > 1 else {})

    @property
    def scales(self) -> bool:
        """Whether a multiple of the stresses is asked under that multiple of the pressure."""
        return self.region.homogeneous and "pressure" not in self.fixed

    @property
    def _enlarged(self) -> Asked:
        case = self.case
        return case.trial * case.factor, None if case.pressure is None else case.pressure * case.factor

    @property
    def _backwards(self) -> Asked:
        case = self.case
        return case.trial[::-1], None if case.pressure is None else case.pressure[::-1]

    def _step(self, i: int, stress: Array) -> Asked:
        case, known = self.case, np.where(np.isfinite(stress), stress, 0.0)
        return known + (case.path[:, i] - case.path[:, i - 1]), None if case.loads is None else case.loads[:, i]

    def _at_once(self, asked: Mapping[str, Asked], more: Mapping[str, Asked]) -> Mapping[str, Reply]:
        """Return the replies to what is ``asked``, and to ``more`` where the routine can answer all of it."""
        if more:
            try:
                return self._at_once({**asked, **more}, {})
            except NoReply as fault:
                if fault.together:
                    raise
        return dict(zip(asked, self.together([*asked.values()], self.case.stiffness), strict=True))

    def _known_or_asked(self, known: Mapping[str, Reply], name: str, asked: Asked) -> Reply:
        return known[name] if name in known else self.together([asked], self.case.stiffness)[0]


def _arranged(rows: int, case: int) -> NDArray[np.intp]:
    """Return the places of so many rows: the first, up to three of many once more, and in one ``case`` of two the others backwards.

    A loop over several rows at a time leaves every rest, and what is judged most stands at the beginning or at the end.
    """
    others = np.arange(1, rows)
    return np.concatenate([[0], np.arange(case % 4 if rows > _FEW else 0), others[::-1] if case & 4 else others])


def _some(rows: int, every: int) -> NDArray[np.intp]:
    """Return the places of one row in ``every`` of so many, from the middle of the first ones on."""
    return np.arange(min(rows, every) // 2, rows, every)
