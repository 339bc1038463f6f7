"""Laws with a state along loading paths: steps one after the other, what they dissipate, and the histories that they leave.

What is asked stands in :mod:`duhem.path.state_question`.  From one knot to the next a step is implicit, or extrapolated, or as many of
these as an accuracy takes.  An implicit step has an error of first order.  Extrapolated (Richardson, 1911; Deuflhard, 1983), the ends chi_j
of n_j implicit steps of equal length make sum w_j chi_j, w_j = product over i of n_j/(n_j - n_i), with an error of the order of how many
they are; it is put back into K by an implicit step without time.  Each implicit step satisfies, whatever the energy,

    work = d psi + s dT + dissipation + own dissipation,   work = sigma . du,   dissipation = Y . (lambda h + dt r),

where the own dissipation, 1/2 d . psi'' d of a quadratic energy, and what a bound takes away as its reaction, is ``numerical``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.law.state import prescribed
from duhem.path.history import SUMS, Checkpoint, Due, EndedEarly, Interrupted, LeftDomain, Tabled, told_of
from duhem.path.loading import Path
from duhem.path.run import Run
from duhem.path.state_question import Drive, StateQuestion, inside
from duhem.path.state_step import KKT, Advanced, Flags, own_dissipation
from duhem.projection.increment import beyond, crossed
from duhem.projection.result import Array, Status
from duhem.show.printing import draw

__all__ = ["NoAnswer", "StateHistory", "recalled", "state_history"]

_BLOCK = 2048  # points whose steps are taken together
_SAME = 1e-9  # of prescribed forces, which steps meet to less
_SUMS = SUMS[1:]  # all but the multiplier, of which each surface has one


@dataclass(frozen=True, eq=False, repr=False)
class StateHistory(Tabled):
    """The states of a law at the m knots of a path, knot 0 being the start; of N paths each array has N as its first axis.

    ``state`` (m, variables): observables, internal variables, and the temperature if there is one; ``force`` (m, forces): the Y (sigma of a
    slip) that criterion and flow take; ``stress`` (m, o): d psi/du of the observables, with the names ``stresses``; ``multiplier`` lambda
    (m, surfaces), accumulated; ``psi`` the free energy; ``dissipation`` the integral of Y . d alpha as the law's flow has it, ``work`` that
    of sigma . du, ``numerical`` what the steps themselves lose, all accumulated; ``balance`` the residual of each step,
    d work - d psi - s dT - d dissipation - d numerical.  With a temperature there are
    its ``entropy`` s, and the ``heat`` that flows in, the integral of T ds - dissipation, which is 0 but for rounding of an adiabatic path
    and sum h_k (T_k - T) dt where bodies exchange it.
    ``residual`` is the worst of the optimality conditions of each step, relative to the sizes that the law has there, at most 1e-10.
    ``held`` (m, internal) is where a bound holds a variable.  ``tangent`` (m, o, o) is d sigma/du, where asked for.  ``status`` is a
    :class:`duhem.Status` of the last knot that was ``reached``: numbers, or (N,); states beyond it are nan.  ``source`` is the law,
    ``numbers`` are those of its parameters, (1,) or (N,), and ``accuracy`` what was asked for; None of a history that was read.
    """

    variables: tuple[str, ...]
    stresses: tuple[str, ...]
    state: Array
    force: Array
    residual: Array
    held: NDArray[np.bool_]
    entropy: Array | None
    heat: Array | None
    tangent: Array | None
    status: NDArray[np.int8]
    reached: NDArray[np.intp]
    accuracy: float | None = None
    source: Criterion | None = None
    numbers: Mapping[str, Array] | None = None

    @property
    def many(self) -> bool:
        """Whether it is of many paths."""
        return self.state.ndim == 3

    def __len__(self) -> int:
        return len(self.state)

    def __repr__(self) -> str:
        points = f"{len(self)} points, " if self.many else ""
        return f"<StateHistory of {self.law}: {points}{len(self.time)} knots; {self.method}>"

    def __getitem__(self, name: str) -> Array:
        """A variable or a force, at each knot."""
        named = dict(zip(self.stresses, np.moveaxis(self.stress, -1, 0), strict=True))
        named |= dict(zip(self.forces, np.moveaxis(self.force, -1, 0), strict=True))
        named |= dict(zip(self.variables, np.moveaxis(self.state, -1, 0), strict=True))
        if name not in named:
            raise InputError(f"there is no {name!r}", where=f"history of {self.law}", remedy=f"it has {', '.join(named)}")
        return np.asarray(named[name])

    def point(self, i: int) -> StateHistory:
        """One of many paths by itself."""
        own = {name: getattr(self, name)[i] for name in _LONG if getattr(self, name) is not None}
        if self.numbers is not None:
            own["numbers"] = {name: x if len(x) == 1 else x[i : i + 1] for name, x in self.numbers.items()}
        return replace(self, **own, status=self.status[i], reached=self.reached[i])

    def upto(self, knots: int) -> StateHistory:
        """The first ``knots`` of one path."""
        return replace(self, **{name: getattr(self, name)[:knots] for name in ("time", *_LONG) if getattr(self, name) is not None})

    def columns(self) -> tuple[str, ...]:
        """The names of the table's columns, in order."""
        warm = () if self.entropy is None else ("entropy", "heat")
        pressure = () if self.pressure_name is None else (self.pressure_name,)
        point = ("point",) if self.many else ()
        return (*point, "time", *self.variables, *self.forces, *self._others(), *pressure, *self.multipliers, *_SUMS, *warm)

    @property
    def multipliers(self) -> tuple[str, ...]:
        """The names of the columns of ``multiplier``, one a surface."""
        count = self.multiplier.shape[-1]
        return ("lambda",) if count == 1 else tuple(f"lambda_{i + 1}" for i in range(count))

    def _others(self) -> tuple[str, ...]:
        """The stresses that are no forces of internal variables too."""
        return tuple(name for name in self.stresses if name not in self.forces)

    def plot(self, file: Any = None, **options: Any) -> Any:
        """Draw stress path, hysteresis loops and energies of one path, as :meth:`duhem.History.plot` does, without K, which may change."""
        return draw(self, file, **options)

    def to_array(self) -> Array:
        """The table as one array (m, columns); of many paths point by point, each knot by knot, with nan where it did not come."""
        pressure = [] if self.pressure_name is None else [self.pressure]
        warm = [] if self.entropy is None or self.heat is None else [self.entropy, self.heat]
        others = self.stress[..., [self.stresses.index(name) for name in self._others()]]
        states = [self.state, self.force, others, *pressure, self.multiplier, *(getattr(self, name) for name in _SUMS), *warm]
        if not self.many:
            return np.column_stack([self.time, *states])
        n, m = self.psi.shape
        labels = [np.repeat(np.arange(n, dtype=np.float64), m), np.tile(self.time, n)]
        return np.column_stack([*labels, *(each.reshape(n * m, -1) for each in states)])

    def remark(self) -> str | None:
        """Where bounds held variables, in sentences; None where none did."""
        if self.many:
            count = int(self.held.any(axis=(1, 2)).sum())
            return f"variables of {count} of {len(self)} points came to a bound, which held them" if count else None
        said = []
        inner = self.variables[len(self.variables) - (self.entropy is not None) - self.held.shape[1] :]
        for i, name in zip(range(self.held.shape[1]), inner, strict=False):
            if (rows := np.flatnonzero(self.held[:, i])).size:
                first = rows[0]
                said.append(
                    f"{name} stops at its bound {self[name][first]:g} at time {self.time[first]:g}, and is held there in {rows.size} steps"
                )
        return "; ".join(said) or None


_LONG = ("state", "force", "stress", "pressure", "multiplier", *_SUMS, "residual", "held", "entropy", "heat", "tangent")


class NoAnswer(EndedEarly):
    """A run with a step whose optimality conditions were not met."""

    def __init__(self, history: StateHistory, time: float, residual: float) -> None:
        if np.isnan(residual):
            why = "its parts, however short, do not come to the accuracy"
        elif residual <= KKT:
            why = f"its equations hold to {residual:.1g}, but a criterion, the sign of a multiplier or the energy of its flow does not"
        elif np.isfinite(residual):
            why = f"its optimality conditions are met to {residual:.2g} and not to {KKT:g}"
        else:
            why = "the formulas of its optimality conditions have no value there"
        what = f"the step to time {time:g} has no answer: {why}"
        remedy = "take more substeps; duhem verify says whether energy and criterion are convex, without which there may be no answer"
        super().__init__(history, what, remedy)


def state_history(
    run: Run,
    start: StateHistory | None = None,
    on_step: Callable[[int, int], None] | None = None,
    checkpoint: Checkpoint[StateHistory] | None = None,
) -> StateHistory:
    """What a run of a law with a state leaves behind; errors are those of :func:`duhem.simulate`.

    Raises :class:`NoAnswer` for one path with a step that is not solved; of many such a point ends there, and its status says so.
    """
    question, alone = StateQuestion.of(run), isinstance(run.path, Path)
    size = _BLOCK if question.run.accuracy is None else 1  # of which each has parts of its own
    n, parts = len(question.paths), []
    steps = len(question.paths.time) - 1
    for first in range(0, n, size):
        which = np.arange(first, min(first + size, n))
        block = _Block(question, which)
        if start is not None:
            block.resume(start)
        due = Due(checkpoint)
        try:
            for done in block.advanced():
                if on_step is not None and alone:
                    on_step(done, steps)
                if alone and done < steps:
                    due(block.so_far)
        except KeyboardInterrupt:
            raise Interrupted(block.so_far() if alone else None) from None
        parts.append(block.history())
        if on_step is not None and not alone:
            on_step(int(which[-1]) + 1, n)
    kept = [name for name in (*_LONG, "status", "reached") if getattr(parts[0], name) is not None]
    joined: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in kept}
    whole = replace(parts[0], **joined)
    if not alone:
        return whole
    one = whole.point(0)
    if (reached := int(one.reached)) < steps:
        cut, time = one.upto(reached + 1), float(one.time[reached + 1])
        if one.status == Status.OUTSIDE:
            raise LeftDomain(cut, block.left, time)
        raise NoAnswer(cut, time, block.lost)
    return one


def recalled(run: Run, column: Mapping[str, Array]) -> StateHistory:
    """The history of one path of which the columns of the table were read; which bounds held variables is not among them."""
    block = _Block(StateQuestion.of(run), np.zeros(1, dtype=np.intp))
    n, named = len(column["time"]), block.history()
    columns = {"state": named.variables, "force": named.forces, "stress": named.stresses, "multiplier": named.multipliers}
    for name, array in block.arrays.items():
        if name in columns:
            array[0, :n] = np.array([column[each] for each in columns[name]]).reshape(-1, n).T
        else:
            array[0, :n] = column.get(name, 0.0)
    return replace(block.history().point(0), time=column["time"], method="", source=None, numbers=None, accuracy=None).upto(n)


class _Block:
    """Some points of a run, their arrays over all knots filled step by step."""

    def __init__(self, question: StateQuestion, which: NDArray[np.intp]) -> None:
        own, self.question, self.which = question.law, question, which
        n, m = len(which), len(question.paths.time)
        many, d = len(own.criteria), len(own.order)
        shapes = {
            "state": (len(own.names),), "force": (d,), "stress": (own.observables,), "multiplier": (many,),
            **dict.fromkeys((*_SUMS, "residual", "entropy", "heat"), ()),
            "tangent": (own.observables, own.observables),
        }  # fmt: skip
        self.arrays = {name: np.full((n, m, *shape), np.nan) for name, shape in shapes.items() if name != "tangent" or question.run.tangent}
        self.held = np.zeros((n, m, own.internal), dtype=np.bool_)
        self.status, self.reached = np.full(n, Status.STICK, dtype=np.int8), np.zeros(n, dtype=np.intp)
        self.left, self.lost = "", np.inf
        with np.errstate(all="ignore"):
            psi, forces, entropy = own.stored(question.begun[which], question.at(0, which))
            stress = own.free_energy.first(question.begun[which], question.at(0, which))[1][:, : own.observables]
        first = {"state": question.begun[which], "force": forces, "stress": stress, "psi": psi, "entropy": entropy, "tangent": np.nan}
        for name, array in self.arrays.items():
            array[:, 0] = first.get(name, 0.0)

    def resume(self, start: StateHistory) -> None:
        """Take the rows of an earlier part of the run; InputError where it is none, as far as it tells."""
        question, n, arrays = self.question, len(start.time), self.arrays
        here = self.history().point(0)
        same = (
            not start.many
            and all(getattr(start, name) == getattr(here, name) for name in ("law", "variables", "forces", "stresses", "timed"))
            and 1 <= n <= len(here.time)
            and all(np.array_equal(getattr(start, name), getattr(here, name)[:n]) for name in ("time", "pressure"))
            and np.array_equal(start.state[0], here.state[0])
            and not (question.run.tangent and start.tangent is None)
        )
        if same:
            path, own = np.array([question.paths.at(k)[0] for k in range(n)]), question.law
            given = start.stress if own.stressed else start.state[:, : own.observables]
            given = np.concatenate([given, start.state[:, own.observables + own.internal :]], axis=1)[:, : path.shape[1]]
            same = bool(np.abs(given - path).max() <= (_SAME * np.abs(path).max() if own.stressed else 0.0))
        if same and start.numbers is not None:  # a part that was read does not say of which numbers it is, nor how it was integrated
            same = all(getattr(start, name) == getattr(here, name) for name in ("source", "method", "accuracy"))
            same = same and all(np.array_equal(numbers, question.others[name]) for name, numbers in start.numbers.items())
        if not same:
            raise InputError("the given history belongs to another run", where="start", remedy="start afresh")
        for name in arrays:
            if (old := getattr(start, name)) is not None:
                arrays[name][0, :n] = old
        self.held[0, :n], self.reached[0] = start.held, n - 1

    def advanced(self) -> Iterator[int]:
        """The steps, and how many are done."""
        question, own, alive = self.question, self.question.law, np.arange(len(self.which))
        time = question.paths.time
        for k in range(int(self.reached[0]) + 1, self.arrays["psi"].shape[1]):
            if not alive.size:
                return
            who, base = self.which[alive], self.arrays["state"][alive, k - 1]
            to, dt = question.drive(k, who), float(time[k] - time[k - 1]) if own.timed else 1.0
            with np.errstate(all="ignore"):
                if question.run.method == "implicit":
                    given, others = to(1.0)
                    made = implicit(question, base, given, dt, others, question.run.tangent)
                elif question.run.accuracy is None:
                    made = extrapolated(question, base, to, dt)
                else:
                    psi = self.arrays["psi"][alive[0], :k]
                    made = accurate(question, base, to, dt, question.run.accuracy, float(np.abs(psi - psi[0]).max()))
            alive = self._take(made, k, alive)
            yield k

    def _take(self, made: Made, k: int, alive: NDArray[np.intp]) -> NDArray[np.intp]:
        """Note a step of the points ``alive``, and return those that go on."""
        own, law, end = self.question.law, self.question.law.law, made.end
        failed = end.failed | ~np.isfinite(np.array([end.psi, *made.added])).all(axis=0)
        out = beyond(law, end.forces) & ~failed
        if out.any():
            self.left = crossed(law, end.forces[out])
        for i, name in enumerate(own.names):
            if name in law.variables and not (own.observables <= i < own.observables + own.internal):
                wrong = ~inside(law.variables[name].domain, end.chi[:, i]) & ~failed
                if wrong.any():
                    self.left = f"{name} = {end.chi[wrong, i][0]:g} lies outside its range {law.variables[name].domain.describe()}"
                out |= wrong
        if failed.any():
            self.lost = float(end.worst[failed][0])
        self.status[alive[failed]], self.status[alive[out]] = Status.FAILED, Status.OUTSIDE
        good = ~(failed | out)
        go, part = alive[good], made.end.of(good)
        dissipation, work, numerical, warmed, heat = (x[good] for x in made.added)
        a = self.arrays
        ends = {"state": part.chi, "force": part.forces, "stress": part.observed, "psi": part.psi, "entropy": part.entropy}
        ends |= {"residual": part.worst, "tangent": part.tangent}
        gains = {"multiplier": made.multiplier[good], "dissipation": dissipation, "work": work, "numerical": numerical, "heat": heat}
        ends |= {name: a[name][go, k - 1] + gain for name, gain in gains.items()}
        ends["balance"] = work - (part.psi - a["psi"][go, k - 1]) - warmed - dissipation - numerical
        for name, array in a.items():
            array[go, k] = ends[name]
        self.held[go, k] = part.held
        moved = (part.flow != 0.0).any(axis=1)
        self.status[go], self.reached[go] = np.where(moved, Status.SLIP, Status.STICK), k
        return go

    def so_far(self) -> StateHistory:
        """Of one path, the knots that were reached."""
        return self.history().point(0).upto(int(self.reached[0]) + 1)

    def history(self) -> StateHistory:
        """The knots that are kept."""
        question, own = self.question, self.question.law
        knots, law = question.knots, own.law
        arrays = {name: array[:, knots] for name, array in self.arrays.items()}
        if law.temperature is None:
            arrays["entropy"] = arrays["heat"] = None  # type: ignore[assignment]
        arrays.setdefault("tangent", None)  # type: ignore[arg-type]
        pressures = np.stack([question.paths.pressure_at(k, self.which) for k in knots.tolist()], axis=1)
        return StateHistory(
            variables=own.names,
            stresses=tuple(prescribed(law)),
            time=question.paths.time[knots],
            pressure=pressures,
            held=self.held[:, knots],
            status=self.status,
            reached=self.reached,
            method=question.run.method,
            why=question.why,
            timed=question.paths.timed,
            accuracy=question.run.accuracy,
            source=law,
            numbers=question.others,
            **told_of(law, **arrays),
        )


# -- steps from one knot to the next -----------------------------------------------------------------------------------


_MOST_RUNS = 6  # of 1, 2, 3 ... steps
_LONGER = (8.0, 8.0, 8.0, 4.0, 2.0, 1.2, 0.8)  # the next part, after so many runs: most are made by five of them
_LEAST = 2.0**-27  # of a step of the path: the first part is as short as that, and the one across a place where flow begins or ends
_FASTEST = 2.0**-44  # no part is shorter: what relaxes after a fast load needs such
_MOST_PARTS = 4_000
_SAFE = 0.1  # of the accuracy, which one part may be off by as it seems
_ROUNDED = 1e-13  # of a variable: no difference
_SEEN = 1e-10  # of all the energies of which psi is made: of a change that is less, rounding hides a part


class Made(NamedTuple):
    """A step: where it ends, and (N,) what it adds to dissipation, work, numerical, s dT and heat; ``multiplier`` (N, S)."""

    end: Advanced
    multiplier: Array
    added: tuple[Array, ...]


def implicit(asked: StateQuestion, base: Array, given: Array, dt: float, others: Sequence[Array], tangent: bool = False) -> Made:
    """The implicit step."""
    law, end = asked.law, asked.advance(base, given, dt, others, tangent)
    by, o = end.chi - base, law.observables
    inner = by[:, o : o + law.internal]
    dissipation = (end.forces * end.flow[:, law.order]).sum(axis=1)
    work = (end.observed * by[:, :o]).sum(axis=1)
    numerical = end.numerical + (end.reaction * inner).sum(axis=1)
    if law.law.temperature is None:
        warmed = heat = np.zeros(len(base))
    else:
        warmed = end.entropy * by[:, -1]
        heat = end.chi[:, -1] * (end.entropy - law.stored(base, others)[2]) - dissipation
    return Made(end, end.multiplier, (dissipation, work, numerical, warmed, heat))


class _Divided(NamedTuple):
    """A step in equal parts: what it comes to, and in each part (N, 1 + S + internal) whether something flows, which criteria
    are active and which variables held; ``faint``, whether what flows is rounding, as at the end of a relaxation."""

    made: Made
    patterns: list[Flags]
    faint: list[bool]

    def alike(self, before: _Divided, whole: _Divided) -> list[bool]:
        """Of each part, whether it goes on as ``before``, or as the ``whole`` in one step where rounding flowed before.

        A part in which rounding flows goes on as either.
        """
        loose = before.faint[-1]
        flows, unknown = (whole if loose else before).patterns[-1][:, :1], loose and whole.faint[-1]
        right = np.concatenate([flows, before.patterns[-1][:, 1:]], axis=1)
        return [bool((each == right)[:, int(unknown or faint) :].all()) for each, faint in zip(self.patterns, self.faint, strict=True)]


def _divided(asked: StateQuestion, base: Array, to: Drive, dt: float, n: int) -> _Divided:
    at, parts, inner = base, [], slice(asked.law.observables, asked.law.observables + asked.law.internal)
    for i in range(1, n + 1):
        given, others = to(i / n)
        parts.append(implicit(asked, at, given, dt / n, others))
        at = parts[-1].end.chi
    ends = [part.end for part in parts]
    end = replace(
        ends[-1], failed=np.logical_or.reduce([each.failed for each in ends]), worst=np.maximum.reduce([each.worst for each in ends])
    )
    added = tuple(np.sum(gains, axis=0) for gains in zip(*(part.added for part in parts), strict=True))
    patterns = [np.concatenate([(each.flow != 0.0).any(axis=1, keepdims=True), each.multiplier > 0.0, each.held], axis=1) for each in ends]
    faint = [bool((np.abs(each.flow) <= _ROUNDED * np.abs(each.chi[:, inner])).all() and each.flow.any()) for each in ends]
    return _Divided(Made(end, np.sum([part.multiplier for part in parts], axis=0), added), patterns, faint)


def _weights(parts: Sequence[int]) -> Array:
    """w_j = product of n_j/(n_j - n_i) over the other i."""
    return np.array([np.prod([n / (n - m) for m in parts if m != n]) for n in parts])


def extrapolated(asked: StateQuestion, base: Array, to: Drive, dt: float) -> Made:
    """The step of second order, 2 chi_halves - chi_whole."""
    return _joined(asked, [_divided(asked, base, to, dt, n) for n in (1, 2)], to)


def _joined(asked: StateQuestion, runs: Sequence[_Divided], to: Drive) -> Made:
    """sum w_j chi_j, put back into K; where bounds do not hold the same variables all along, or are passed, the last run alone."""
    law, (given, others), ends = asked.law, to(1.0), [run.made.end for run in runs]
    o, finest = law.observables, ends[-1].chi
    weights = np.repeat(_weights([len(run.patterns) for run in runs])[:, None], len(finest), axis=1)
    beside = np.einsum("jn,jnz->nz", weights, [end.chi for end in ends])
    held = np.array([pattern[:, 1 + len(law.criteria) :] for run in runs for pattern in run.patterns])
    beside[:, o : o + law.internal] = np.where(held.all(axis=0), finest[:, o : o + law.internal], beside[:, o : o + law.internal])
    inner = beside[:, o : o + law.internal]
    stopped = ((inner < law.low) | (inner > law.high) | (held.any(axis=0) & ~held.all(axis=0))).any(axis=1)
    beside[stopped], weights[:, stopped] = finest[stopped], 0.0
    weights[-1, stopped] = 1.0
    back = implicit(asked, beside, given, 0.0, others)
    added = [
        np.einsum("jn,jn->n", weights, gains) + more for *gains, more in zip(*(run.made.added for run in runs), back.added, strict=True)
    ]
    added[2] += sum(w * own_dissipation(law, end.chi, beside, others) for w, end in zip(weights, ends, strict=True))
    sums = np.einsum("jn,jns->ns", weights, [run.made.multiplier for run in runs]) + back.multiplier
    ended = replace(
        back.end,
        failed=np.logical_or.reduce([back.end.failed, *(end.failed for end in ends)]),
        worst=np.maximum.reduce([back.end.worst, *(end.worst for end in ends)]),
        held=back.end.held | ends[-1].held,
        flow=np.where(back.end.flow != 0.0, back.end.flow, ends[-1].flow),
    )
    return Made(ended, sums, tuple(added))


def accurate(asked: StateQuestion, base: Array, to: Drive, dt: float, accuracy: float, stored: float) -> Made:
    """The step of one point in parts, each with an estimated error below the ``accuracy``, relative to ``stored``, the most of psi so far.

    A part is extrapolated from 1, 2, 3 ... implicit steps until leaving out the first of these runs hardly changes it.  That says
    nothing where flow begins or ends within a part: all runs may then agree by chance.  Such a part is made shorter, until what is on
    both sides of that place has parts of its own; the one across it is so short that its error, of second order in it, is rounding.
    """
    at, part, size, before, total = base, 0.0, _LEAST, None, None
    (psi,) = asked.law.stored(base, to(0.0)[1])[0]
    for _ in range(_MOST_PARTS):
        size = 1.0 - part if part + size > 1.0 - min(_LEAST, size) else size
        runs, apart, same, shortest = list[_Divided](), np.inf, [True], size <= 2.0 * _LEAST

        def within(share: float, part: float = part, size: float = size) -> tuple[Array, Sequence[Array]]:
            return to(min(1.0, part + size * share))

        while apart > _SAFE * accuracy and len(runs) < _MOST_RUNS and all(same):
            runs.append(_divided(asked, at, within, size * dt, len(runs) + 1))
            if runs[-1].made.end.failed[0]:
                break
            same = [True] if shortest or before is None else runs[-1].alike(before, runs[0])
            apart = _apart(asked, at, runs, within, size, stored, psi) if len(runs) > 1 else np.inf
        if not all(same):
            size = max(_LEAST, size * (same.index(False) or 0.25) / len(runs))
        elif (lost := bool(runs[-1].made.end.failed[0])) or apart > _SAFE * accuracy:
            if (lost and shortest) or size <= _FASTEST:
                return _failed(runs[-1].made, runs[-1].made.end.worst if lost else np.full(1, np.nan))
            size = max(_LEAST, 0.1 * size) if lost else max(_FASTEST, 0.1 * size if shortest else 0.4 * size)
        else:
            made = _joined(asked, runs, within)
            total = made if total is None else _after(total, made)
            if made.end.failed[0] or part + size >= 1.0:
                return total
            at, part, before = made.end.chi, part + size, runs[-1]
            stored = max(stored, abs(float(made.end.psi[0]) - psi))
            size *= _LONGER[len(runs)]
    assert total is not None
    return _failed(total, np.full(1, np.nan))


def _failed(made: Made, worst: Array) -> Made:
    return made._replace(end=replace(made.end, failed=np.ones(1, dtype=np.bool_), worst=worst))


def _after(one: Made, other: Made) -> Made:
    """Two steps, one after the other."""
    end = replace(other.end, worst=np.maximum(one.end.worst, other.end.worst), held=one.end.held | other.end.held)
    return Made(end, one.multiplier + other.multiplier, tuple(a + b for a, b in zip(one.added, other.added, strict=True)))


def _apart(asked: StateQuestion, base: Array, runs: Sequence[_Divided], to: Drive, part: float, stored: float, begun: float) -> float:
    """How much leaving out the first run changes: in the measure of psi'', and a temperature and what has no energy by themselves.

    These are relative to what they are, or come to in all of the step if they go on as in this ``part`` of it.
    """
    law, chi = asked.law, np.array([run.made.end.chi[0] for run in runs])
    counts = [len(run.patterns) for run in runs]
    whole, fewer = _weights(counts) @ chi, _weights(counts[1:]) @ chi[1:]
    size = np.maximum(np.abs(whole), np.abs(base[0]))
    apart = np.maximum(np.abs(whole - fewer) - _ROUNDED * size, 0.0)
    psi, _, hessian = law.free_energy(whole[None], to(1.0)[1])
    bent = np.abs(hessian[0])
    free, warm = ~bent.any(axis=1), np.zeros(len(size), dtype=np.bool_)
    warm[law.observables + law.internal :] = True
    alone = free | warm
    come = np.maximum(size, np.abs(whole - base[0]) / part)
    own = np.divide(apart, come, out=np.zeros_like(size), where=alone & (come > 0.0)).max()
    bent[alone], bent[:, alone] = 0.0, 0.0
    lost, most = float(apart @ bent @ apart), max(2.0 * max(stored, abs(float(psi[0]) - begun)), _SEEN * float(size @ bent @ size))
    spent = np.array([run.made.added[0][0] for run in runs])
    missed, most_spent = abs(float(_weights(counts) @ spent - _weights(counts[1:]) @ spent[1:])), float(np.abs(spent).max())
    with np.errstate(divide="ignore", invalid="ignore"):
        pairs = (lost, most), (missed - _ROUNDED * most_spent, max(most, most_spent / part))
        energies = [0.0 if less <= 0.0 else less / much for less, much in pairs]
    found = float(max(own, np.sqrt(energies[0]), energies[1]))
    return found if np.isfinite(found) else np.inf
