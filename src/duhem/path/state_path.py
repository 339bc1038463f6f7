"""Laws with a state along loading paths: steps one after the other, what they dissipate, and the histories that they leave.

An implicit step has an error of first order.  The extrapolated step, of second order, is 2 chi_halves - chi_whole (Richardson, 1911), put
back into K by an implicit step without time.  Each implicit step satisfies, whatever the energy,

    work = d psi + s dT + dissipation + own dissipation,   work = sigma . du,   dissipation = Y . (lambda h + dt r),

where the own dissipation, 1/2 d . psi'' d of a quadratic energy, and what a bound takes away as its reaction, is ``numerical``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.number import exact_number
from duhem.expression.numpy_ import compiled
from duhem.expression.spelling import respelled
from duhem.law.catalogue import load_formula
from duhem.law.domain import by_name
from duhem.law.formula_law import Criterion
from duhem.path.compiled_state import StateLoop
from duhem.path.history import SUMS, Interrupted, LeftDomain, Tabled
from duhem.path.loading import Path, Paths, checked_count, given_numbers
from duhem.path.run import Run, as_paths, kept_knots
from duhem.path.state_step import KKT, Advanced, StateLaw, own_dissipation
from duhem.projection.declared_ranges import beyond, crossed, refused
from duhem.projection.increment import stiffness_of
from duhem.projection.result import Array, Status

__all__ = ["NoAnswer", "StateHistory", "StateQuestion", "state_history"]

_BLOCK = 2048  # points whose steps are taken together
_ORDERS = {"implicit": 1, "extrapolated": 2}
_SUMS = SUMS[1:]  # all but the multiplier, of which each surface has one


@dataclass(frozen=True, eq=False, repr=False)
class StateHistory(Tabled):
    """The states of a law at the m knots of a path, knot 0 being the start; of N paths each array has N as its first axis.

    ``state`` (m, variables): observables, internal variables, and the temperature if there is one; ``force`` (m, forces): the Y (sigma of a
    slip) that criterion and flow take; ``multiplier`` lambda (m, surfaces), accumulated; ``psi`` the free energy; ``dissipation`` the
    integral of Y . d alpha as the law's flow has it, ``work`` that of sigma . du, ``numerical`` what the steps themselves lose, all
    accumulated; ``balance`` the residual of each step, d work - d psi - s dT - d dissipation - d numerical.  With a temperature there are
    its ``entropy`` s, and the ``heat`` that flows in, the integral of T ds - dissipation, which is 0 but for rounding of an adiabatic path
    and sum h_k (T_k - T) dt where bodies exchange it.
    ``residual`` is the worst of the optimality conditions of each step, relative to the sizes that the law has there, at most 1e-10.
    ``held`` (m, internal) is where a bound holds a variable.  ``tangent`` (m, o, o) is d sigma/du, where asked for.  ``status`` is a
    :class:`duhem.Status` of the last knot that was ``reached``: numbers, or (N,); states beyond it are nan.
    """

    printed_by: ClassVar[str] = "duhem.path.picture"

    law: str
    variables: tuple[str, ...]
    forces: tuple[str, ...]
    pressure_name: str | None
    time: Array
    state: Array
    force: Array
    pressure: Array
    multiplier: Array
    psi: Array
    dissipation: Array
    work: Array
    numerical: Array
    balance: Array
    residual: Array
    held: NDArray[np.bool_]
    entropy: Array | None
    heat: Array | None
    tangent: Array | None
    status: NDArray[np.int8]
    reached: NDArray[np.intp]
    method: str
    why: str
    timed: bool = True

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
        named = {**dict(zip(self.forces, np.moveaxis(self.force, -1, 0), strict=True))}
        named |= dict(zip(self.variables, np.moveaxis(self.state, -1, 0), strict=True))
        if name not in named:
            raise InputError(f"there is no {name!r}", where=f"history of {self.law}", remedy=f"it has {', '.join(named)}")
        return np.asarray(named[name])

    def point(self, i: int) -> StateHistory:
        """One of many paths by itself."""
        own = {name: getattr(self, name)[i] for name in _LONG if getattr(self, name) is not None}
        return replace(self, **own, status=self.status[i], reached=self.reached[i])

    def upto(self, knots: int) -> StateHistory:
        """The first ``knots`` of one path."""
        return replace(self, **{name: getattr(self, name)[:knots] for name in ("time", *_LONG) if getattr(self, name) is not None})

    def columns(self) -> tuple[str, ...]:
        """The names of the table's columns, in order."""
        count = self.multiplier.shape[-1]
        multipliers = ("lambda",) if count == 1 else tuple(f"lambda_{i + 1}" for i in range(count))
        warm = () if self.entropy is None else ("entropy", "heat")
        pressure = () if self.pressure_name is None else (self.pressure_name,)
        point = ("point",) if self.many else ()
        return (*point, "time", *self.variables, *self.forces, *pressure, *multipliers, *_SUMS, *warm)

    def _table(self) -> tuple[tuple[str, ...], list[Array]]:
        pressure = [] if self.pressure_name is None else [self.pressure]
        warm = [] if self.entropy is None or self.heat is None else [self.entropy, self.heat]
        states = [self.state, self.force, *pressure, self.multiplier, *(getattr(self, name) for name in _SUMS), *warm]
        if not self.many:
            return self.columns(), [self.time, *states]
        n, m = self.psi.shape  # point by point, each knot by knot, with nan where it did not come
        labels = [np.repeat(np.arange(n, dtype=np.float64), m), np.tile(self.time, n)]
        return self.columns(), [*labels, *(each.reshape(n * m, -1) for each in states)]

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


_LONG = ("state", "force", "pressure", "multiplier", *_SUMS, "residual", "held", "entropy", "heat", "tangent")


class NoAnswer(InputError):
    """A run with a step whose optimality conditions were not met; ``history`` is what was done before."""

    def __init__(self, history: StateHistory, time: float, residual: float) -> None:
        self.history = history
        if residual <= KKT:
            why = f"its equations hold to {residual:.1g}, but a criterion, the sign of a multiplier or the energy of its flow does not"
        elif np.isfinite(residual):
            why = f"its optimality conditions are met to {residual:.2g} and not to {KKT:g}"
        else:
            why = "the formulas of its optimality conditions have no value there"
        what = f"the step to time {time:g} has no answer: {why}"
        remedy = "take more substeps; duhem verify says whether energy and criterion are convex, without which there may be no answer"
        super().__init__(what, where=f"path, step {len(history)}", remedy=remedy)


@dataclass(frozen=True, eq=False)
class StateQuestion:
    """What is asked of a law with a state, checked: ``begun`` (N, n) is the first state, ``others`` (N,) the numbers of its formulas."""

    law: StateLaw
    paths: Paths
    others: Mapping[str, Array]
    begun: Array
    order: int
    alone: bool
    knots: NDArray[np.intp]
    tangent: bool
    compiled: bool

    @classmethod
    def of(cls, run: Run) -> StateQuestion:
        """The run, checked; InputError for what does not fit."""
        law, path = load_formula(run.law), run.path
        if not isinstance(path, Path | Paths):
            what = f"{type(path).__name__} is no loading path"
            raise InputError(what, where="path", remedy="make one with Path.linear(points, pressure=...) or Path.from_csv(file)")
        if not isinstance(run.method, str) or run.method not in _ORDERS:
            what = f"{law.name} has a state or a flow of its own, and no method {run.method!r}"
            raise InputError(what, where="method", remedy=f"choose {', '.join(_ORDERS)}")
        if run.stress is not None:
            what = f"the start of {law.name} is a state"
            raise InputError(what, where="stress", remedy='give the variables that do not begin at 0, such as state={"alpha": 0.1}')
        checked_count(run.substeps, "substeps", 1)
        if run.tangent and run.method == "extrapolated":
            raise InputError("an extrapolated step has no tangent here", where="tangent", remedy='use method="implicit"')
        stressed = isinstance(path, Path) and path.control == "stress"
        if law.energy is not None and run.stiffness is not None:
            raise InputError(f"{law.name} has an energy", where="stiffness", remedy="remove the stiffness: the energy has it")
        stiffness = None if law.energy is not None else stiffness_of(law, run.stiffness)[0]
        alone = isinstance(path, Path)
        if isinstance(path, Path):
            knots = np.arange((len(path.time) - 1) * run.substeps + 1)
            if run.keep != 1:
                raise InputError("keep applies only to many points", where="keep", remedy="remove it, or give Paths")
        else:
            knots = kept_knots(run.keep, (len(path.time) - 1) * run.substeps)
        width = path.values.shape[-1]
        own = StateLaw.of(law, stiffness, stressed, width)
        if width not in (own.observables, own.observables + (law.temperature is not None)):
            names = ", ".join(own.names[: own.observables])
            warm = "" if law.temperature is None else f", and one more for {law.temperature}, or none where the path is adiabatic"
            raise InputError(f"the path has {width} columns", where="path", remedy=f"give one for each of {names}{warm}")
        if own.timed and not path.timed:
            raise InputError(f"{law.name} depends on the rate, and the path states no times", where="path", remedy="give time=")
        if (law.pressure is None) != (path.pressure is None):
            what = f"{law.name} has no pressure" if law.pressure is None else f"{law.name} needs the pressure {law.pressure}"
            raise InputError(what, where="pressure", remedy="remove it" if law.pressure is None else "give pressure= in the path")
        order = _ORDERS[run.method]
        paths = as_paths(path.refined(run.substeps).refined(order))
        if paths.pressure is not None and refused(law, paths.pressure).any():
            name = law.pressure or ""
            what = f"a pressure lies outside the range of {law.domain[name].stated(name)}"
            raise InputError(what, where="path", remedy="keep to the range, or declare a wider one in the law's domain")
        others = _numbers(law, run.parameters, len(paths))
        made = cls(own, paths, others, np.zeros((len(paths), len(own.names))), order, alone, knots, run.tangent, run.compiled)
        return made._started(run.state)

    def _started(self, given: Mapping[str, Any] | None) -> StateQuestion:
        """The question with the state at the first knot, checked."""
        own, law, begun = self.law, self.law.law, self.begun.copy()
        names = own.names[own.observables :] if not own.stressed else own.names
        ends = {name: v.domain for name, v in law.variables.items()}
        if given is not None and not isinstance(given, Mapping):
            raise InputError(f"{type(given).__name__} is no mapping", where="state", remedy='give variables by name, {"alpha": 0.1}')
        for name, value in respelled(given or {}, "state").items():
            if name not in names or (name == law.temperature and not own.adiabatic):
                what = f"{name!r} is not a variable that begins somewhere"
                raise InputError(what, where="state", remedy=f"these are: {', '.join(names)}")
            numbers = given_numbers(value, name)
            if numbers.shape not in ((), (len(begun),)):
                raise InputError(f"{name} has the shape {numbers.shape}", where="state", remedy="give one number, or one a point")
            begun[:, own.names.index(name)] = numbers
        values = self.paths.at(0)
        if not own.stressed:
            begun[:, : own.observables] = values[:, : own.observables]
        if values.shape[1] > own.observables:
            begun[:, -1] = values[:, -1]
        for i, name in enumerate(own.names):
            columns = begun[:, i]
            if name in own.names[: own.observables] and not own.stressed:
                columns = np.array([self.paths.at(k)[:, i] for k in range(len(self.paths.time))])
            elif name == law.temperature and not own.adiabatic:
                columns = np.array([self.paths.at(k)[:, -1] for k in range(len(self.paths.time))])
            if name in ends and (wrong := np.ravel(columns)[~_inside(ends[name], np.ravel(columns))]).size:
                what = f"{name} = {wrong[0]:g} is outside its range {ends[name].describe()}"
                remedy = f"give it a value there, state={{{name!r}: ...}}" if name in names else "stay inside the range"
                raise InputError(what, where="state" if name in names else "path", remedy=remedy)
        others = self._at(0, np.arange(len(begun)))
        if own.stressed:
            first = own.advance(begun, values, 0.0, others)
            if first.failed.any() or first.multiplier.any():
                raise InputError("no displacement has the forces at the first knot without flow", where="path", remedy="begin inside K")
            begun = first.chi
        _, forces, _ = own.stored(begun, others)
        if not np.isfinite(forces).all():
            raise InputError("the energy or its forces have no value at the start", where="state", remedy="give the variables other values")
        if (out := own.outside(begun, others)).max(initial=0.0) > KKT:  # a bound may hold what would flow
            end = own.advance(begun, values, 0.0, others)
            out[~end.failed & (np.abs(end.chi - begun) <= KKT * np.abs(begun)).all(axis=1)] = 0.0
        if out.max(initial=0.0) > KKT:
            what = f"the forces {dict(zip(law.forces, forces[np.argmax(out)].tolist(), strict=True))} at the start lie outside K"
            raise InputError(what, where="state", remedy="give state= and a first knot inside K")
        return replace(self, begun=begun)

    def _at(self, knot: int, which: NDArray[np.intp]) -> list[Array]:
        """The numbers of the formulas of some points at a knot of the refined path."""
        named = dict(self.others)
        if self.law.law.pressure is not None:
            named[self.law.law.pressure] = self.paths.pressure_at(knot, np.arange(len(self.paths)))
        return [np.broadcast_to(named[name], len(self.paths))[which] for name in self.law.others]

    @cached_property
    def loop(self) -> StateLoop | None:
        """Machine code for the steps, where that was asked for and the law has some; MissingExtraError without numba."""
        return StateLoop.of(self.law) if self.compiled and not self.tangent else None

    def advance(self, base: Array, given: Array, dt: float, others: Sequence[Array], tangent: bool) -> Advanced:
        """A step, by machine code where there is some."""
        return self.law.advance(base, given, dt, others, tangent) if self.loop is None else self.loop.advance(base, given, dt, others)

    @property
    def why(self) -> str:
        """How steps are taken, in words."""
        own = self.law
        if own.minimum:
            how = "Newton's method on the optimality conditions of the step, which is the least of psi + dt Phi where both are convex"
        else:
            law = own.law
            what = [] if law.associated else ["a flow of its own"]
            what += ["rates without a multiplier"] * bool(law.rates) + ["a rate that belongs to no force"] * bool(law.unforced)
            how = f"Newton's method on the residual of the step, which is no minimum: the law has {' and '.join(what)}"
        if self.loop is not None:
            how = f"{how}, compiled"
        if own.exchange is not None:
            return f"{how}; heat flows from {', '.join(own.law.heat)}"
        return f"{how}; adiabatic" if own.adiabatic else how


def _inside(domain: Any, values: Array) -> NDArray[np.bool_]:
    low, high = domain.ends
    return np.asarray(((values > low) if domain.positive else (values >= low)) & (values <= high))


def _numbers(law: Criterion, given: Mapping[str, Any] | None, n: int) -> dict[str, Array]:
    """The numbers of each parameter, (1,) or (N,), inside the domain and the constraints."""
    found: dict[str, Array] = {}
    for name, value in by_name(given).items():
        if name in law.variables:
            raise InputError(
                f"{name} is a variable of {law.name}", where="parameters", remedy=f"state={{{name!r}: ...}} says where it begins"
            )
        if not np.ndim(value):
            law.fix({name: value})
            found[name] = np.array([float(exact_number(value))])
            continue
        found[name] = given_numbers(value, name)
        if found[name].shape != (n,):
            raise InputError(
                f"{name} has the shape {found[name].shape} for {n} points", where="parameters", remedy=f"give one number, or ({n},)"
            )
        for end in (found[name].min(), found[name].max()):
            law.fix({name: float(end)})
    for name, domain in law.parameters.items():
        if name not in law.variables and domain.value is not None:
            found[name] = np.array([float(domain.value)])
    if missing := [name for name in law.parameters if name not in found and name not in law.variables]:
        remedy = f"give parameters={{{', '.join(f'{name!r}: ...' for name in missing)}}}"
        raise InputError(f"no value is given for {', '.join(missing)}", where=f"parameters of {law.name}", remedy=remedy)
    for relation in law.constraints:
        names = sorted(map(str, relation.free_symbols))
        if not compiled(relation, [law.symbols()[name] for name in names])(*(found[name] for name in names)).all():
            raise InputError(f"{relation} does not hold", where=f"parameters of {law.name}", remedy="choose values that satisfy it")
    return found


# -- steps -------------------------------------------------------------------------------------------------------------


class _Made(NamedTuple):
    """A step: where it ends, and (N,) what it adds to dissipation, work, numerical, s dT and heat; ``multiplier`` (N, S)."""

    end: Advanced
    multiplier: Array
    added: tuple[Array, ...]


def _implicit(asked: StateQuestion, base: Array, given: Array, dt: float, others: Sequence[Array], tangent: bool = False) -> _Made:
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
    return _Made(end, end.multiplier, (dissipation, work, numerical, warmed, heat))


def _extrapolated(asked: StateQuestion, base: Array, ways: Sequence[Array], dt: float, numbers: Sequence[Any], tangent: bool) -> _Made:
    """2 chi_halves - chi_whole, put back into K; where that passes a bound of a variable, the two halves."""
    law, (middle, end) = asked.law, numbers
    whole = _implicit(asked, base, ways[1], dt, end)
    first = _implicit(asked, base, ways[0], dt / 2.0, middle)
    second = _implicit(asked, first.end.chi, ways[1], dt / 2.0, end)
    o = law.observables
    beside = 2.0 * second.end.chi - whole.end.chi
    inner = beside[:, o : o + law.internal]
    stopped = (inner < law.low) | (inner > law.high) | whole.end.held | first.end.held | second.end.held
    free = np.asarray(~stopped.any(axis=1))
    beside = np.where(free[:, None], beside, second.end.chi)
    back = _implicit(asked, beside, ways[1], 0.0, end, tangent)
    two = np.where(free, 2.0, 1.0)
    added = [two * (a + b) + (1.0 - two) * w + p for a, b, w, p in zip(first.added, second.added, whole.added, back.added, strict=True)]
    added[2] += two * own_dissipation(law, second.end.chi, beside, end) + (1.0 - two) * own_dissipation(law, whole.end.chi, beside, end)
    sums = two[:, None] * (first.multiplier + second.multiplier) + (1.0 - two)[:, None] * whole.multiplier + back.multiplier
    parts = (whole.end, first.end, second.end)
    ended = replace(
        back.end,
        failed=back.end.failed | np.logical_or.reduce([part.failed for part in parts]),
        worst=np.maximum.reduce([back.end.worst, *(part.worst for part in parts)]),
        held=back.end.held | second.end.held,
    )
    return _Made(ended, sums, tuple(added))


def state_history(run: Run, on_step: Callable[[int, int], None] | None = None) -> StateHistory:
    """What a run of a law with a state leaves behind; errors are those of :func:`duhem.simulate`.

    Raises :class:`NoAnswer` for one path with a step that is not solved; of many such a point ends there, and its status says so.
    """
    question = StateQuestion.of(run)
    n, parts, done = len(question.paths), [], 0
    steps = (len(question.paths.time) - 1) // question.order
    for first in range(0, n, _BLOCK):
        which = np.arange(first, min(first + _BLOCK, n))
        block = _Block(question, which)
        try:
            for done in block.advanced():
                if on_step is not None and question.alone:
                    on_step(done, steps)
        except KeyboardInterrupt:
            made = block.history(run.method)
            raise Interrupted(made.point(0).upto(done + 1) if question.alone else None) from None
        parts.append(block.history(run.method))
        if on_step is not None and not question.alone:
            on_step(int(which[-1]) + 1, n)
    kept = [name for name in (*_LONG, "status", "reached") if getattr(parts[0], name) is not None]
    joined: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in kept}
    whole = replace(parts[0], **joined)
    if not question.alone:
        return whole
    one = whole.point(0)
    if (reached := int(one.reached)) < steps:
        cut, time = one.upto(reached + 1), float(one.time[reached + 1])
        if one.status == Status.OUTSIDE:
            raise LeftDomain(cut, block.left, time)
        raise NoAnswer(cut, time, block.lost)
    return one


class _Block:
    """Some points of a run, their arrays over all knots filled step by step."""

    def __init__(self, question: StateQuestion, which: NDArray[np.intp]) -> None:
        own, self.question, self.which = question.law, question, which
        n, m = len(which), (len(question.paths.time) - 1) // question.order + 1
        many, d = len(own.criteria), len(own.order)
        shapes = {
            "state": (len(own.names),), "force": (d,), "multiplier": (many,), **dict.fromkeys((*_SUMS, "residual", "entropy", "heat"), ()),
            "tangent": (own.observables, own.observables),
        }  # fmt: skip
        self.arrays = {name: np.full((n, m, *shape), np.nan) for name, shape in shapes.items() if name != "tangent" or question.tangent}
        self.held = np.zeros((n, m, own.internal), dtype=np.bool_)
        self.status, self.reached = np.full(n, Status.STICK, dtype=np.int8), np.zeros(n, dtype=np.intp)
        self.left, self.lost = "", np.inf
        with np.errstate(all="ignore"):
            psi, forces, entropy = own.stored(question.begun[which], question._at(0, which))
        first = {"state": question.begun[which], "force": forces, "psi": psi, "entropy": entropy, "tangent": np.nan}
        for name, array in self.arrays.items():
            array[:, 0] = first.get(name, 0.0)

    def advanced(self) -> Iterator[int]:
        """The steps, and how many are done."""
        question, own, alive = self.question, self.question.law, np.arange(len(self.which))
        time, order = question.paths.time, question.order
        for k in range(1, self.arrays["psi"].shape[1]):
            if not alive.size:
                return
            who, end = self.which[alive], order * k
            base, others = self.arrays["state"][alive, k - 1], question._at(end, who)
            dt = float(time[end] - time[end - order]) if own.timed else 1.0
            ways = [question.paths.at(end - back, who) for back in range(order - 1, -1, -1)]
            with np.errstate(all="ignore"):
                if order == 1:
                    made = _implicit(question, base, ways[0], dt, others, question.tangent)
                else:
                    made = _extrapolated(question, base, ways, dt, (question._at(end - 1, who), others), question.tangent)
            alive = self._take(made, k, alive)
            yield k

    def _take(self, made: _Made, k: int, alive: NDArray[np.intp]) -> NDArray[np.intp]:
        """Note a step of the points ``alive``, and return those that go on."""
        own, law, end = self.question.law, self.question.law.law, made.end
        failed = end.failed | ~np.isfinite(np.array([end.psi, *made.added])).all(axis=0)
        out = beyond(law, end.forces) & ~failed
        if out.any():
            self.left = crossed(law, end.forces[out])
        for i, name in enumerate(own.names):
            if name in law.variables and not (own.observables <= i < own.observables + own.internal):
                wrong = ~_inside(law.variables[name].domain, end.chi[:, i]) & ~failed
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
        a["state"][go, k], a["force"][go, k], a["psi"][go, k], a["entropy"][go, k] = part.chi, part.forces, part.psi, part.entropy
        for name, gain in (
            ("multiplier", made.multiplier[good]),
            ("dissipation", dissipation),
            ("work", work),
            ("numerical", numerical),
            ("heat", heat),
        ):
            a[name][go, k] = a[name][go, k - 1] + gain
        a["balance"][go, k] = work - (a["psi"][go, k] - a["psi"][go, k - 1]) - warmed - dissipation - numerical
        a["residual"][go, k], self.held[go, k] = part.worst, part.held
        if self.question.tangent:
            a["tangent"][go, k] = part.tangent
        moved = (part.flow != 0.0).any(axis=1)
        self.status[go], self.reached[go] = np.where(moved, Status.SLIP, Status.STICK), k
        return go

    def history(self, method: str) -> StateHistory:
        """The knots that are kept."""
        question, own = self.question, self.question.law
        knots, law, order = question.knots, own.law, question.order
        arrays = {name: array[:, knots] for name, array in self.arrays.items()}
        if law.temperature is None:
            arrays["entropy"] = arrays["heat"] = None  # type: ignore[assignment]
        arrays.setdefault("tangent", None)  # type: ignore[arg-type]
        pressures = np.stack([question.paths.pressure_at(order * k, self.which) for k in knots.tolist()], axis=1)
        return StateHistory(
            law=law.name,
            variables=own.names,
            forces=law.forces,
            pressure_name=law.pressure,
            time=question.paths.time[order * knots],
            pressure=pressures,
            held=self.held[:, knots],
            status=self.status,
            reached=self.reached,
            method=method,
            why=question.why,
            timed=question.paths.timed,
            **arrays,
        )
