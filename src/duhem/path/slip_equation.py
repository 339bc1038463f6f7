"""Exact motion for any law with a smooth boundary: the slipping stress as an ordinary differential equation.

sigma' = k (u' - lambda' g_sigma),  lambda' = (g_sigma . k u' + g_n sigma_n')/(g_sigma . k g_sigma) > 0,

solved to rounding by Dormand and Prince's method of order 8 (Hairer, Norsett and Wanner, 1993, section II.10).  It stops and
starts again where the formula has a kink (a seam between quadrants) and where slip begins or ends.

Contact is lost or regained on steps at whose ends the pressure vanishes, or all along them.  Where sigma_n = 0 the set K is the
origin alone: stress is zero and everything slips.  Towards it the slipping stress settles faster and faster, on a scale of
|sigma_n|; away from it, from zero stress, K grows in proportion at first and the implicit step is the motion itself.  So the last or
first 2^-30 of such a step is an implicit one, of which stress and slip are exact and the sums off by no more than the square of that
share; the rest is the equation's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import combinations
from math import inf, isfinite, sqrt, ulp
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from duhem.errors import DuhemError, InputError
from duhem.expression import EigMax, Neg, Norm, Pos, Where
from duhem.expression.angles import algebraic_angles
from duhem.expression.elementary import imports
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.scalar_bounds import FUNCTIONS
from duhem.expression.scalar_jets import scalar_values
from duhem.path.elementary_steps import Move, Pair
from duhem.path.run import Plan
from duhem.path.step_formulas import inner, times, written
from duhem.projection.code_cache import interpreted_text
from duhem.projection.increment import Increment
from duhem.projection.plain_numbers import FAULTS, interpreted
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.projection.scaled_formula import may_cancel, of_pressure_alone, scaled

__all__ = ["Boundary", "Followed", "Motion", "OpenContact", "State", "boundary", "corner", "followed", "moves"]

# -- Dormand and Prince's method of order 8 on plain numbers, up to an event --------------------------------------------
# One step is written down as lines, without the coefficients that are 0: for the few numbers of one point arrays take longer to call than
# to compute.  What lies within a step is the method's own interpolation, of order 7.

State = Sequence[float]
Slope = Callable[[float, State], State]  # of a state at a time
Event = Callable[[float, State], float]  # it ends the way where it rises through 0

_RTOL = 2.5e-14
_LEAST, _MOST, _SAFETY = 0.2, 10.0, 0.9  # by which a step changes
_STEPS = 50_000  # some seconds; a very stiff way under a pressure that goes to a billionth takes ten thousand


class Followed(NamedTuple):
    """The time and state where a way ends, whether by the first of the events, and the steps it took."""

    time: float
    state: State
    first: bool
    steps: Sequence[_Stride]

    def at(self, time: float) -> Array:
        """The state on the way, and at the end the one that was integrated."""
        if time == self.time:
            return np.array(self.state)
        return next(step for step in self.steps if time <= step.time + step.size).at(time)


@dataclass(eq=False)
class _Stride:
    """One step from a time over a size: its slopes are those of 13 stages."""

    slope: Slope
    time: float
    size: float
    start: State
    end: State
    slopes: Sequence[State]
    _powers: Array | None = None

    def at(self, time: float) -> Array:
        """The state within it."""
        if self._powers is None:
            from scipy.integrate import DOP853

            y, change, stages = np.array(self.start), np.subtract(self.end, self.start), np.array(self.slopes)
            for row, part in zip(DOP853.A_EXTRA, DOP853.C_EXTRA, strict=True):
                near = y + self.size * (row[: len(stages)] @ stages)
                stages = np.vstack([stages, self.slope(self.time + part * self.size, near.tolist())])
            first, last = self.size * stages[0], self.size * stages[12]
            self._powers = np.vstack([change, first - change, 2.0 * change - last - first, self.size * (DOP853.D @ stages)])
        x, found = (time - self.time) / self.size, np.zeros(len(self.start))
        for i, power in enumerate(self._powers[::-1]):
            found = (found + power) * (1.0 - x if i % 2 else x)
        return np.asarray(self.start + found)


def followed(slope: Slope, time: float, state: State, atol: State, events: Sequence[Event], kept: bool) -> Followed:
    """From ``time`` to 1, or to the first event on the way; ``kept``: with all steps, for what lies between.  DuhemError where it fails."""
    n = len(state)
    step, steps, last = _step(n), list[_Stride](), slope(time, state)
    sizes = [(a + _RTOL * abs(x)) for a, x in zip(atol, state, strict=True)]
    far, fast = (sqrt(sum((x / size) ** 2 for x, size in zip(each, sizes, strict=True))) for each in (state, last))
    h, high = min(0.01 * far / fast if fast > 0.0 else inf, 1.0 - time), inf
    before = [event(time, state) for event in events]
    tried = 0
    while time < 1.0:
        h, tried = min(h, 1.0 - time), tried + 1
        if h < 10.0 * ulp(time) or tried > _STEPS:
            raise DuhemError("the slipping stress could not be followed: steps become too small", remedy='use method="implicit"')
        try:
            end, slopes, e5, e3 = step(slope, time, h, state, last)
            error = _error(h, state, end, e5, e3, atol)
        except FAULTS:
            error = inf
        if not error < 1.0:
            h, high = h * (max(_LEAST, _SAFETY * error**-0.125) if error < inf else _LEAST), 1.0
            continue
        made = _Stride(slope, time, h, state, end, slopes)
        after = [event(time + h, end) for event in events]
        risen = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a <= 0.0 <= b]
        if kept:
            steps.append(made)
        if risen:
            found = [(_rise(events[i], made), i) for i in risen]
            time, i = min(found)
            return Followed(time, made.at(time).tolist(), i == 0, steps)
        time = 1.0 if h == 1.0 - time else time + h
        state, last, before = end, slopes[-1], after
        h *= min(high, _MOST, _SAFETY * error**-0.125) if error > 0.0 else min(high, _MOST)
        high = inf
    return Followed(time, state, False, steps)


def _error(h: float, state: State, end: State, e5: State, e3: State, atol: State) -> float:
    """The error of a step over what is allowed; inf where it is no number."""
    five = three = 0.0
    for x, y, a, b, least in zip(state, end, e5, e3, atol, strict=True):
        size = least + _RTOL * max(abs(x), abs(y))
        five += (a / size) ** 2
        three += (b / size) ** 2
    if five == 0.0 and three == 0.0:
        return 0.0
    error = h * five / sqrt((five + 0.01 * three) * len(state))
    return error if isfinite(error) else inf


def _rise(event: Event, step: _Stride) -> float:
    """When an event happens within a step."""
    from scipy.optimize import brentq

    end = step.time + step.size

    def value(time: float) -> float:
        return event(time, step.end if time == end else step.start if time == step.time else step.at(time).tolist())

    tight = 4.0 * np.finfo(float).eps
    return float(brentq(value, step.time, end, xtol=tight, rtol=tight))


@lru_cache(maxsize=16)
def _step(n: int) -> Callable[..., Any]:
    """``step(slope, t, h, y, f)`` for n numbers: the end, the 13 slopes, and what the embedded methods of order 5 and 3 differ by."""
    from scipy.integrate import DOP853

    every = range(n)

    def tuple_of(texts: Sequence[str]) -> str:
        return f"({''.join(f'{text}, ' for text in texts)})"

    def names(stage: int) -> str:
        return tuple_of([f"k{stage}_{i}" for i in every])

    def summed(weights: Array, i: int) -> str:
        return " + ".join(f"{weight!r} * k{j}_{i}" for j, weight in enumerate(weights.tolist()) if weight)

    lines = [f"{tuple_of([f'y{i}' for i in every])} = y", f"{names(0)} = f"]
    for stage in range(1, 12):
        near = [f"y{i} + h * ({summed(DOP853.A[stage, :stage], i)})" for i in every]
        lines.append(f"{names(stage)} = slope(t + {float(DOP853.C[stage])!r} * h, {tuple_of(near)})")
    lines.append(f"z = {tuple_of([f'y{i} + h * ({summed(DOP853.B, i)})' for i in every])}")
    lines.append(f"{names(12)} = slope(t + h, z)")
    errors = [tuple_of([summed(weights, i) for i in every]) for weights in (DOP853.E5, DOP853.E3)]
    lines.append(f"return z, {tuple_of([names(stage) for stage in range(13)])}, {', '.join(errors)}")
    return interpreted_text("def step(slope, t, h, y, f):\n    " + "\n    ".join(lines), "step")


# -- slip as an equation ------------------------------------------------------------------------------------------------

_SMOOTHING = (Norm, PNorm)
_HEAD = f"import numpy as np\n{imports(FUNCTIONS)}\nfrom duhem.expression.principal_axes import principal_axes\n"
_MOST_EVENTS = 1000
_GLANCE = 1e-10
_BIT = 2.0**-30  # of a step on which contact is lost or regained, which is an implicit one
_SAMPLES = np.linspace(0.0, 1.0, 65)

Values = Callable[[Any, float], list[float]]  # formulas at one stress and pressure; nan or infinite where they are undefined


class Motion(NamedTuple):
    """A step: the displacement since tau = 0 at tau in [0, 1], and its rate on plain numbers."""

    moved: Callable[[float], Array]
    rate: Callable[[float], Sequence[float]]


def corner(increment: Increment) -> str | None:
    """A part of g that may make a corner, in words; None if there is none and the boundary is smooth away from 0."""
    forces = set(increment.law.force_symbols())

    def found(node: Any, smoothed: bool) -> Iterator[str]:
        if not node.free_symbols & forces:
            return
        if isinstance(node, (sp.Max, sp.Min, EigMax, Where, sp.core.relational.Relational)):
            yield str(node)
            return
        if isinstance(node, (sp.Abs, Pos, Neg)) and not smoothed:
            yield str(node)
            return
        inner = isinstance(node, _SMOOTHING) or (isinstance(node, sp.Pow) and bool(node.exp > 1))
        for arg in node.args:
            yield from found(arg, inner or (smoothed and isinstance(node, (sp.Mul, sp.Add, sp.Abs, Pos, Neg))))

    if len(forces) == 1:
        return None
    return next(found(recognised(algebraic_angles(increment.g)), False), None)


@dataclass(frozen=True, eq=False)
class Boundary:
    """g, its derivatives in the forces and then in the pressure, and its seams, at one stress and pressure."""

    g: Values
    slopes: Values
    seams: tuple[Values, ...]
    stiffness: Array

    def value(self, stress: Array, pressure: float) -> float:
        return self.g(stress, pressure)[0]

    def normal(self, stress: Array, pressure: float) -> Array:
        return np.array(self.slopes(stress, pressure)[:-1])


def boundary(increment: Increment) -> Boundary:
    """The programs of a law with numbers in place.  InputError where g may have a corner."""
    if (sharp := corner(increment)) is not None:
        raise InputError(
            f"the exact path needs a smooth boundary, and {increment.law.name} may have a corner in {sharp}",
            where="method",
            remedy='use method="implicit" or "extrapolated"',
        )
    forces = increment.law.force_symbols()
    name = increment.law.pressure
    pressure = increment.law.symbols()[name] if name else sp.Dummy("sigma_n", nonpositive=True)
    order = (*forces, pressure)
    kinks = {node.args[0] for node in increment.g.atoms(Pos, Neg, sp.Abs) if node.free_symbols & set(forces)}
    kinks |= _of_the_load(increment.g, pressure)
    g, parts = _apart(increment.g, forces, pressure)
    opening = sum((_derivative(g, q) * _derivative(part, pressure) for q, part in parts.items()), _derivative(g, pressure))
    return Boundary(
        g=_values([g], order, parts),
        slopes=_values([*(_derivative(g, x) for x in forces), opening], order, parts),
        seams=tuple(_values([kink], order, {}) for kink in sorted(kinks, key=str)),
        stiffness=increment.stiffness,
    )


Parts = Mapping[sp.Symbol, sp.Expr]


def _apart(g: sp.Expr, forces: Sequence[sp.Symbol], pressure: sp.Symbol) -> tuple[sp.Expr, Parts]:
    """g over the forces, the pressure and names for those parts of the pressure alone in which digits may cancel."""
    formula = scaled(g, forces, pressure)
    parts = {q: datum.expr for q, datum in formula.data.items() if may_cancel(datum.expr)}
    if not parts:
        return g, {}
    return formula.expr.xreplace({q: datum.expr for q, datum in formula.data.items() if q not in parts}), parts


def _values(formulas: Sequence[sp.Expr], order: Sequence[sp.Symbol], parts: Parts) -> Values:
    """Formulas as lines of Python over plain numbers: at one point arrays take ten times as long."""
    text, constants = scalar_values("values", formulas, [*order, *parts])
    run, plain = interpreted_text(f"{_HEAD}{text}\n", "values"), interpreted(f"{_HEAD}{text}\n", "values")

    @lru_cache(maxsize=64)
    def told(pressure: float) -> list[float]:
        given = {order[-1]: np.array([pressure])}
        with np.errstate(all="ignore"):
            return [float(np.ravel(of_pressure_alone(part, given).value)[0]) for part in parts.values()]

    def at(stress: Sequence[float], pressure: float) -> list[float]:
        found, given = [0.0] * len(formulas), [*map(float, stress), pressure, *(told(pressure) if parts else ()), *constants]
        try:
            plain(given, found)
        except FAULTS:  # what has no value is nan or infinite
            with np.errstate(all="ignore"):
                run([*map(np.float64, given)], found)
        return found

    return at


def _of_the_load(g: sp.Expr, pressure: sp.Symbol) -> set[sp.Expr]:
    """Where a maximum or minimum of loads changes its part, as at the cap of a friction, and other kinks in the pressure alone."""
    alone = [node for node in g.atoms(sp.Max, sp.Min, Pos, Neg, sp.Abs) if node.free_symbols == {pressure}]
    pairs = {a - b for node in alone if isinstance(node, (sp.Max, sp.Min)) for a, b in combinations(node.args, 2)}
    single = {node.args[0] for node in alone if not isinstance(node, (sp.Max, sp.Min)) and node.args[0] != pressure}
    return {kink for kink in pairs | single if kink.has(pressure)}


def _derivative(g: sp.Expr, x: sp.Symbol) -> sp.Expr:
    """dg/dx with the sign of each argument of |.| in words of the vocabulary: 0 at 0, where a quotient x/|x| would be no number.

    A maximum of loads alone, a cap on the pressure say, has the slope of the first where it is the larger.
    """
    slope = sp.diff(g, x).replace(lambda e: isinstance(e, sp.Heaviside), lambda e: Where(e.args[0] > 0, 1, 0))
    return slope.replace(lambda e: isinstance(e, sp.sign), lambda e: Where(e.args[0] > 0, 1, Where(e.args[0] < 0, -1, 0)))


def moves(on: Boundary, stress: Array, drive: Motion, pressures: tuple[float, float], parts: Sequence[float]) -> list[Move]:
    """From ``stress`` in K over the step tau in [0, 1], the pressure going straight from the first to the second.

    What was done until each of ``parts``, increasing in (0, 1]; those before 1 are read off the method's own interpolation,
    of order 7, and change none of its steps.
    """
    k, rate = on.stiffness, pressures[1] - pressures[0]
    size = float(np.abs(stress).max() + np.abs(k @ drive.moved(1.0)).max()) or 1.0
    length = size / float(np.abs(k).max())
    d, rows, running = len(stress), k.tolist(), written(_running, len(stress))

    def load(tau: float) -> float:
        return pressures[0] + tau * rate

    def pushed(tau: float, s: Sequence[float]) -> Sequence[Any]:
        *normal, opening = on.slopes(s[:d], load(tau))
        return running(s[:d], drive.rate(tau), normal, opening * rate, rows)

    def slipping(tau: float, state: Sequence[float]) -> Sequence[float]:
        rates: Sequence[float] = pushed(tau, state)[0]
        return rates

    def unloads(tau: float, state: Sequence[float]) -> float:
        return -pushed(tau, state)[1]

    def seam(kink: Values, sign: float) -> Event:
        return lambda tau, state: sign * kink(state[:d], load(tau))[0]

    reached: list[Move] = []

    def passed(upto: float, at: Callable[[float], Array], free: float, resting: float | None = None) -> None:
        """Note the parts up to ``upto`` that have not been noted; ``free`` so far, and since the time ``resting``."""
        for part in parts[len(reached) :]:
            if part > upto:
                return
            y = at(part)
            rested = free if resting is None else free + part - resting
            reached.append(Move(tuple(y[:d].tolist()), float(y[d]), float(y[d + 1]), float(y[d + 2]), rested))

    tau, state, free = 0.0, np.concatenate([stress, np.zeros(3)]), 0.0
    atol = [1e-16 * size] * d + [1e-16 * length, 1e-16 * size * length, 1e-16 * size * length]
    released = False
    for _ in range(_MOST_EVENTS):
        if not released or unloads(tau, state.tolist()) >= 0.0:
            stop = _leaving(on, state[:d], drive, load, tau)
            if stop > tau:
                passed(stop, partial(_at_rest, k, drive, tau, state), free, tau)
                state = _at_rest(k, drive, tau, state, stop)
                free, tau = free + stop - tau, stop
            if tau >= 1.0:
                break
        n = on.normal(state[:d], load(tau))
        if not (np.isfinite(n).all() and n.any()):
            at = ", ".join(f"{x:g}" for x in state[:d])
            raise DuhemError(f"the boundary of K has no normal at the stress ({at}), where slip begins", remedy='use method="implicit"')
        state[:d] -= on.value(state[:d], load(tau)) * n / float(n @ n)
        ahead = state[:d] + _GLANCE * (1.0 - tau) * np.array(
            slipping(tau, state.tolist())[:d]
        )  # on a seam, it is watched from where the stress goes
        soon = load(tau + _GLANCE * (1.0 - tau))
        signs = [float(np.sign(kink(ahead, soon)[0])) for kink in on.seams]
        watched = [seam(kink, -s) for kink, s in zip(on.seams, signs, strict=True) if s != 0.0]
        inner = len(reached) < len(parts) and parts[len(reached)] < 1.0
        run = followed(slipping, tau, state.tolist(), atol, [unloads, *watched], inner)
        tau, state = run.time, np.array(run.state)
        passed(tau, run.at, free)
        if tau >= 1.0:
            break
        released = not run.first
    else:
        raise DuhemError(f"more than {_MOST_EVENTS} events in one step", remedy="take smaller steps")
    return reached


def _running(power: Any, du: Any, normal: Any, opening: Any, k: Any) -> tuple[list[Any], Any]:
    """The rates of stress, multiplier, dissipation and work while it slips, and what pushes: slip ends where that falls to 0."""
    kn = times(normal, k)
    push = inner(kn, du) + opening
    multiplier = push / inner(normal, kn)
    moved = [pulled - multiplier * held for pulled, held in zip(times(du, k), kn, strict=True)]
    return [*moved, multiplier, multiplier * inner(power, normal), inner(power, du)], push


def _at_rest(k: Array, drive: Motion, tau: float, state: Array, until: float) -> Array:
    """The state (stress, multiplier, dissipation, work) after no slip from ``tau`` on."""
    d = len(state) - 3
    du = drive.moved(until) - drive.moved(tau)
    dsigma = k @ du
    new = state.copy()
    new[-1] += float((state[:d] + 0.5 * dsigma) @ du)
    new[:d] += dsigma
    return new


def _leaving(on: Boundary, stress: Array, drive: Motion, load: Callable[[float], float], tau: float) -> float:
    """The first time from ``tau`` at which the stress without slip leaves K; 1 if it does not."""
    from scipy.optimize import brentq

    start = drive.moved(tau)

    def excess(t: float) -> float:
        return on.value(stress + on.stiffness @ (drive.moved(t) - start), load(t))

    slack = abs(on.value(stress, load(tau)))
    times = tau + (1.0 - tau) * _SAMPLES**2  # dense where the last contact was
    inside = tau
    for t in times[1:].tolist():
        if excess(t) > 0.0:
            if inside == tau and excess(tau) >= 0.0:
                return tau
            if inside == tau and slack <= 1e-13 * float(np.abs(stress).max() * np.abs(on.normal(stress, load(tau))).max()):
                probe = tau + 1e-6 * (t - tau)
                if excess(probe) > 0.0:
                    return tau
                inside = probe
            return float(brentq(excess, inside, t, xtol=1e-16, rtol=8.9e-16))
        inside = t
    return 1.0


class OpenContact:
    """Steps of ``plan`` at whose ends the pressure may vanish.  InputError where K then is more than the origin."""

    def __init__(self, plan: Plan, on: Boundary) -> None:
        self.plan, self.on, increment = plan, on, plan.increment
        self.prepared = Projector.of(increment.law, increment.stiffness, increment.parameters, plan.projection)
        sides = np.concatenate([np.eye(len(increment.law.forces)), -np.eye(len(increment.law.forces))])
        found = self.prepared.at(replace(increment, trial=sides, pressure=np.zeros(len(sides))))
        if found.stress.any():
            raise InputError(
                f"K of {increment.law.name} is neither the origin nor a disk at zero pressure",
                where=f"pressure[{int(np.flatnonzero(increment.pressure == 0.0)[0])}]",
                remedy='use method="implicit"',
            )

    def moves(self, stress: Array, drive: Motion, loads: Pair, parts: Sequence[float]) -> list[Move]:
        """As :func:`moves` where a load is zero."""
        if loads == (0.0, 0.0):
            du = drive.moved(1.0)
            if not np.array_equal(drive.moved(0.5) * 2.0, du):
                raise InputError("open contact on an arc", where="path", remedy='use method="implicit", or chords=True')
            return [self._bit(stress, part * du, 0.0, part) for part in parts]
        first, last = (_BIT, 1.0) if loads[0] == 0.0 else (0.0, 1.0 - _BIT)
        at = (loads[1] * _BIT, loads[1]) if loads[0] == 0.0 else (loads[0], loads[0] * _BIT)
        begun = Move(tuple(stress.tolist()), 0.0, 0.0, 0.0, 0.0)
        if first > 0.0:
            begun = self._bit(stress, drive.moved(first), at[0], first)
        start, share = drive.moved(first), last - first

        between = Motion(
            lambda tau: drive.moved(first + share * tau) - start, lambda tau: [share * rate for rate in drive.rate(first + share * tau)]
        )
        inside = [part for part in parts if first < part < last]
        whole = moves(self.on, np.array(begun.stress), between, at, [*((part - first) / (last - first) for part in inside), 1.0])
        reached = [_after(begun, move, last - first) for move in whole]
        end = reached[-1]
        if last < 1.0:
            end = _after(end, self._bit(np.array(end.stress), drive.moved(1.0) - drive.moved(last), 0.0, 1.0 - last), 1.0)
        early = [self._bit(stress, drive.moved(part), part * loads[1], part) for part in parts if part <= first]
        return [*early, *reached[:-1], *(end for part in parts if part >= last)]

    def _bit(self, stress: Array, du: Array, pressure: float, part: float) -> Move:
        """An implicit step over a ``part`` of the whole that ends under ``pressure``, the stress going straight."""
        increment = self.plan.increment
        trial = stress + self.plan.stiffness @ du
        found = self.prepared.at(replace(increment, trial=trial[None], pressure=np.array([pressure])))
        if found.status[0] > Status.SLIP and found.status[0] != Status.OUTSIDE:
            raise DuhemError("the closest point where contact opens or closes was not found", remedy='use method="implicit"')
        end, slip = found.stress[0], found.slip[0]
        mean = 0.5 * (stress + end)
        free = part if not found.multiplier[0] > 0.0 else 0.0
        return Move(tuple(end.tolist()), float(found.multiplier[0]), float(mean @ slip), float(mean @ du), free)


def _after(before: Move, move: Move, share: float) -> Move:
    """Two moves in turn; what is free in the second is a part of ``share`` of the step."""
    return Move(
        move.stress,
        before.multiplier + move.multiplier,
        before.dissipation + move.dissipation,
        before.work + move.work,
        before.free + share * move.free,
    )
