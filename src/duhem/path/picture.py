"""How a history is shown: as pictures of stress path, hysteresis and energies (extra plot), and as a sheet of some of its knots.

Between the knots of a history lies the integrator's own curve, at as many points as a drawing needs.
"""

from __future__ import annotations

import os
import pathlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.law.outline import outline
from duhem.path.elementary_steps import Move
from duhem.path.exact import Piece, Reached
from duhem.path.history import STATES, Histories, History, Tabled
from duhem.path.integrators import INTEGRATORS
from duhem.path.run import Plan
from duhem.path.state_path import StateHistory
from duhem.projection.result import Array, Status
from duhem.show import figure
from duhem.show.printing import Sheet, draw, latex_name, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Trajectory", "as_sheet", "as_sheet_of_many", "energies", "hysteresis", "picture", "stress_path", "trajectory"]

_MARKED = 200  # knots, beyond which marks would hide the lines
_TELLING = 9  # marks of a line among others that has more knots, so that they are told apart without colour
_HEADS, _SHORT = 7, 0.005  # arrow heads on a line; their length before it, as a share of the whole
_NAMED = 4  # forces, beyond which an axis does not name each
_UNITS = "Pa", "m"  # of stress and length, where nobody names others
_FIXED: dict[str, Any] = {"color": figure.GREY, "linewidth": 1.0}
_VARIED: dict[str, Any] = {"color": "black", "linewidth": 1.2, "linestyle": (0, (5, 2)), "zorder": 2.5}  # over the path, which may hide one
_START: dict[str, Any] = {"marker": "o", "linestyle": "none", "color": "white", "markeredgecolor": "black", "markersize": 8.0}
_SUMS = {"work": "work", "psi": r"free energy $\psi$", "dissipation": "dissipation", "numerical": "numerical loss of implicit steps"}


@draw.register(History)
def picture(
    history: History,
    file: figure.Target | None = None,
    *,
    ax: Axes | None = None,
    axes: Iterable[Axes] | None = None,
    law: Criterion | str | os.PathLike[str] | None = None,
    units: tuple[str, str] = _UNITS,
    **parameters: float,
) -> Axes | tuple[Axes, ...]:
    """The stress path on ``ax``, or three pictures side by side, on ``axes`` or a sheet of their own; what was drawn on.

    Left out, ``law`` and its ``parameters`` are those of the run.  ``units`` of stress and of length are any texts.  Raises
    MissingExtraError without matplotlib, InputError for a file or format that cannot be written and a history that is not finite.
    """
    if ax is not None and axes is not None:
        raise InputError("both ax and axes are given", where="plot", remedy="give ax for the stress path alone, or axes for all three")
    seen = _seen(history)
    over = _over(history, law, parameters)
    if ax is not None:
        return figure.drawn(lambda place: stress_path(place, seen, over, parameters, units[0]), file, [ax])[0]

    return _three(seen, over, parameters, units, None, file, axes)


def _seen(history: History) -> Trajectory:
    """The history and what lies between its knots; InputError where it is not finite."""
    if not np.isfinite(history.to_array()).all():
        raise InputError("the history holds numbers that are not finite", where="plot", remedy="use other units, or draw only a part of it")
    return trajectory(history)


def _three(
    seen: Trajectory,
    law: Criterion | None,
    parameters: Mapping[str, float],
    units: tuple[str, str],
    shifts: Sequence[str] | None,
    file: figure.Target | None,
    axes: Iterable[Axes] | None,
) -> tuple[Axes, ...]:
    def paint(left: Axes, middle: Axes, right: Axes) -> None:
        stress_path(left, seen, law, parameters, units[0])
        hysteresis(middle, seen, units, shifts)
        energies(right, seen, units)

    title = f"{seen.states.law}: {seen.states.method}, {seen.states.why}"
    return figure.drawn(paint, file, axes, panels=3, size=(4.6, 4.4), title=title)


@draw.register(StateHistory)
def picture_of_state(
    history: StateHistory, file: figure.Target | None = None, *, axes: Iterable[Axes] | None = None, units: tuple[str, str] = _UNITS
) -> Axes | tuple[Axes, ...]:
    """The same three pictures, without K, which may change with the state; errors are those of :func:`picture`."""
    if history.many:
        raise InputError("a picture can show only one point", where="plot", remedy="draw history.point(i)")
    o, moved = len(history.stresses), np.any(np.diff(history.state[:, len(history.stresses) :], axis=0) != 0.0, axis=1)
    names = ("psi", "dissipation", "work", "numerical", "balance", "time", "pressure", "law", "pressure_name", "method", "why", "timed")
    shown = History(
        **{name: getattr(history, name) for name in names},
        forces=history.stresses,
        stress=history.stress,
        displacement=history.state[:, :o],
        slip=np.zeros_like(history.stress),
        multiplier=np.append(0.0, np.cumsum(moved)),  # it grows where the state moves
    )
    return _three(_seen(shown), None, {}, units, history.variables[:o], file, axes)


def _over(history: History, law: Criterion | str | os.PathLike[str] | None, parameters: dict[str, Any]) -> Criterion | None:
    """The criterion to draw, its numbers in ``parameters``; that of the run where none is given."""
    if law is None:
        if parameters:
            taken = "file, ax, axes, units, law, and with law its parameters"
            raise InputError(f"unknown option {', '.join(parameters)}", where="plot", remedy=f"it takes {taken}")
        if history.plan is None:
            return None
        parameters |= history.plan.increment.parameters
        return history.plan.increment.law
    known = load_formula(law if isinstance(law, str | Criterion) else pathlib.Path(law))
    if known.forces != history.forces or (known.pressure is not None and history.pressure_name is None):
        theirs, ours = ", ".join(known.forces), ", ".join(history.forces)
        raise InputError(f"{known.name} has the forces {theirs}, the history {ours}", where="law", remedy="use a law with the same forces")
    fixed = known.fix(parameters)
    if absent := [name for name, domain in fixed.parameters.items() if domain.value is None]:
        raise InputError(f"{known.name} needs {', '.join(absent)}", where="plot", remedy="give each by name")
    parameters |= {name: float(domain.value) for name, domain in fixed.parameters.items() if domain.value is not None}
    return known


def stress_path(
    axes: Axes, seen: Trajectory, law: Criterion | None = None, parameters: Mapping[str, float] | None = None, unit: str = "Pa"
) -> None:
    """The first two forces, over the boundary of K at the extreme pressures where ``law`` is given and has two forces.

    One force alone is drawn over time or, where the path states none, its steps.  Stresses in their ``unit``.
    """
    states, forces = seen.states, [f"${latex_name(name)}$" for name in seen.states.forces]
    size, edges = float(np.abs(states.stress[:, :2]).max()), []
    if law is not None and len(law.forces) == 2:
        edges = _boundaries(states, law, parameters or {})
        size = max([size, *(float(np.abs(line).max()) for line in edges)])
    scale = figure.outsize(size)
    stress = states.stress / scale
    x, y = (states.time, stress[:, 0]) if len(forces) == 1 else (stress[:, 0], stress[:, 1])
    look, named = (_VARIED, "$K$ at extreme pressures") if np.ptp(states.pressure) > 0.0 else (_FIXED, "boundary of $K$")
    for i, line in enumerate(edges):
        axes.plot(*(line / scale).T, **look, label="_" if i else named)
    _line(axes, seen, x, y, 0, heads=len(forces) > 1)
    axes.plot(x[0], y[0], **_START)
    if len(forces) == 1:
        _time(axes, states)
    else:
        axes.set_aspect("equal", adjustable="datalim")
        figure.measure(axes.xaxis, forces[0], unit, size)
    figure.measure(axes.yaxis, forces[min(1, len(forces) - 1)], unit, size)
    _key(axes, seen)
    figure.legend(axes)


def hysteresis(axes: Axes, seen: Trajectory, units: tuple[str, str] = _UNITS, shifts: Sequence[str] | None = None) -> None:
    """Each force over its own displacement, in their units; ``shifts`` are the names of these."""
    states = seen.states
    forces, shifts = states.forces, shifts or [f"u_{name.removeprefix('sigma_')}" for name in states.forces]
    size, reach = float(np.abs(states.stress).max()), float(np.abs(states.displacement).max())
    stress, displacement = states.stress / figure.outsize(size), states.displacement / figure.outsize(reach)
    for i, (force, shift) in enumerate(zip(forces, shifts, strict=True)):
        _line(axes, seen, displacement[:, i], stress[:, i], i, f"${latex_name(force)}$ over ${latex_name(shift)}$")
    figure.measure(axes.xaxis, _symbols("displacement", shifts), units[1], reach)
    figure.measure(axes.yaxis, _symbols("stress", forces), units[0], size)
    figure.legend(axes)


def energies(axes: Axes, seen: Trajectory, units: tuple[str, str] = _UNITS) -> None:
    """Work, free energy and dissipation over time, each over the area of contact: 1 Pa m = 1 J/m²."""
    states = seen.states
    shown = [name for name in _SUMS if name != "numerical" or states.numerical.any()]
    size = max(float(np.abs(getattr(states, name)).max()) for name in shown)
    for i, name in enumerate(shown):
        _line(axes, seen, states.time, getattr(states, name) / figure.outsize(size), i, _SUMS[name], heads=False)
    _time(axes, states)
    figure.measure(axes.yaxis, "energy over area", "J/m²" if units == _UNITS else " ".join(units), size)
    figure.legend(axes)


def _time(axes: Axes, states: History) -> None:
    """The axis of time in s, or of steps where the path states no times."""
    if states.timed:
        figure.measure(axes.xaxis, "time $t$", "s")
    else:
        figure.measure(axes.xaxis, "step of the path")


def _symbols(word: str, names: Iterable[str]) -> str:
    every = [f"${latex_name(name)}$" for name in names]
    return ", ".join(every) if len(every) <= _NAMED else word


def _line(axes: Axes, seen: Trajectory, x: Array, y: Array, hue: int, label: str = "", *, heads: bool = True) -> None:
    """Dashed where the law sticks, solid where it slips, and thick where its curve is known between the knots; marked at them.

    ``heads`` show the sense of time.
    """
    colour, mark = figure.palette(hue), figure.pen(hue)["marker"]
    for slips in (False, True):
        axes.plot(*_stretches(x, y, seen.slips[1:] == slips), color=colour, **_look(seen, slips))
    knots = seen.knots
    if len(knots) > _MARKED:  # of a line alone none
        knots = knots[np.linspace(0, len(knots) - 1, _TELLING if label else 0).astype(int)]
    axes.plot(x[knots], y[knots], mark, color=colour)
    if heads:
        _heads(axes, x, y, colour)
    if label:
        axes.plot([], [], color=colour, marker=mark, label=label)


def _heads(axes: Axes, x: Array, y: Array, colour: str) -> None:
    """Arrow heads in the sense of time, evenly along the line as it is seen."""
    spans = np.ptp(x), np.ptp(y)
    steps = np.hypot(*(np.diff(part) / (span or 1.0) for part, span in zip((x, y), spans, strict=True)))
    passed = np.concatenate([[0.0], np.cumsum(steps)])
    if not 0.0 < passed[-1] < np.inf:
        return
    for place in (np.arange(_HEADS) + 0.5) * passed[-1] / _HEADS:
        ends = [(np.interp(at, passed, x), np.interp(at, passed, y)) for at in (place - _SHORT * passed[-1], place)]
        look = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 15.0, "linewidth": 0.0}
        axes.annotate("", ends[1], ends[0], arrowprops=look)


def _stretches(x: Array, y: Array, chosen: Array) -> tuple[Array, Array]:
    """The line through the points (n,), where its pieces (n - 1,) are chosen; nan parts the stretches."""
    ends = [0, *(np.flatnonzero(np.diff(chosen)) + 1).tolist(), len(chosen)]
    rows = [row for a, b in pairwise(ends) if b > a and chosen[a] for row in (*range(a, b + 1), -1)]
    gap = np.array(rows, dtype=int)
    return np.where(gap < 0, np.nan, x[gap]), np.where(gap < 0, np.nan, y[gap])


def _look(seen: Trajectory, slips: bool) -> dict[str, Any]:
    if not slips:
        return {"linestyle": (0, (3, 1.5)), "linewidth": 1.1}
    return {"linewidth": 2.2 if _known(seen) else 1.1}


def _known(seen: Trajectory) -> bool:
    """Whether there is a curve between the knots; else they are joined straight, and what is in between is not known."""
    return len(seen.states) > len(seen.knots)


def _key(axes: Axes, seen: Trajectory) -> None:
    """What the looks of a line mean."""
    for slips, word in ((False, "sticks"), (True, "slips" if _known(seen) else "slips, knots joined")):
        if (seen.slips[1:] == slips).any():
            axes.plot([], [], color="black", label=word, **_look(seen, slips))
    axes.plot([], [], label="start", **_START)
    if len(seen.knots) <= _MARKED:
        axes.plot([], [], "o", color=figure.palette(0), label="knot")


def _boundaries(states: History, law: Criterion, parameters: Mapping[str, float]) -> list[Array]:
    """The boundary of K at the extreme pressures."""
    extremes = sorted({float(states.pressure.min()), float(states.pressure.max())}) if law.pressure else [None]
    size = float(np.abs(states.stress).max()) or float(np.abs(states.pressure).max()) or 1.0
    return [line for pressure in extremes for line in outline(law, parameters, pressure, size)]


_MOST = 12  # knots or points of which a sheet has a row


@sheet.register(Tabled)
def as_sheet(history: Tabled) -> Sheet:
    """The knots, or of many some from the first to the last, with the columns of the table."""
    table = history.to_array()
    shown = np.unique(np.linspace(0, len(table) - 1, min(len(table), _MOST)).round().astype(int))
    rows = tuple((str(i), *(f"{x:.6g}" for x in table[i].tolist())) for i in shown)
    fewer = (f"{len(shown)} of {len(table)} knots; to_dict() and the arrays have all",) if len(shown) < len(table) else ()
    return Sheet(
        f"History of {history.law}: {len(table)} knots",
        (("method", f"{history.method} ({history.why})" if history.why else history.method),),
        ("knot", *history.to_dict()),
        rows,
        (("Shown", fewer),),
    )


@sheet.register(Histories)
def as_sheet_of_many(found: Histories) -> Sheet:
    """The last knot that each point reached, with its status; of many points the first."""
    count = min(len(found), _MOST)
    table = found.to_array(slice(0, count)).reshape(count, len(found.knots), -1)
    last = np.searchsorted(found.knots, found.reached, side="right") - 1
    rows = tuple(
        (str(found.points[i]), Status(found.status[i]).name.lower(), *(f"{x:.6g}" for x in table[i, last[i], 1:].tolist()))
        for i in range(count)
    )
    fewer = (f"the first {_MOST} of {len(found)} points; to_dict() and the arrays have all",) if len(found) > _MOST else ()
    return Sheet(
        f"Histories of {found.law}: {len(found)} points, {len(found.knots)} knots each",
        (("method", f"{found.method} ({found.why})" if found.why else found.method), ("ended early", str(found.ended_early()))),
        ("point", "status", *found.columns()[1:]),
        rows,
        (("Shown", fewer),),
    )


# -- between the knots -------------------------------------------------------------------------------------------------


_POINTS = 4096  # about how many in all, where nobody says how many a step
_MOST_A_STEP = 48
_NEAR = 1 / 50  # of the range of the stresses: farther apart, two neighbours have rows put between them
_MOST_MORE = 8  # times as many rows, at most, as there are in equal parts
_ROUNDS = 12
_APART = 1e-9  # parts of a step closer than this, as seen from its start, are one


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A history with rows between its knots.

    ``states`` holds all rows; ``knots`` the row numbers of those of the history, which are the same to the last bit;
    ``slips`` whether the law slips on the way to each row (the first: never).  The balance of a row between two knots is
    that since the knot before it.
    """

    states: History
    knots: NDArray[np.intp]
    slips: NDArray[np.bool_]


def trajectory(history: History, samples: int | None = None) -> Trajectory:
    """The states that the law goes through on the way from knot to knot, each step in ``samples`` parts of equal time.

    An exact path is evaluated anew between its knots: stress, slip, multiplier and energies are those of the law there, and
    one more row stands wherever slip begins or ends.  So it is with a prescribed stress.  Implicit and extrapolated steps
    know their knots only, and have no rows in between.  Left out, ``samples`` is what makes about 4,000 rows, at most 48 a step,
    and more rows stand where neighbouring stresses would differ by more than 1/50 of the range of all: a step may be long
    against the way on which the stress settles, at most eight times as many.
    """
    if samples is not None and (isinstance(samples, bool) or not isinstance(samples, int) or samples < 1):
        raise InputError(f"samples = {samples!r}", where="trajectory", remedy="give a whole number >= 1")
    steps = len(history) - 1
    each = samples if samples is not None else min(max(_POINTS // max(steps, 1), 1), _MOST_A_STEP)
    along = None if history.plan is None else _along(history.plan, history.method)
    if history.plan is None or along is None or each == 1:
        return Trajectory(history, np.arange(len(history)), np.diff(history.multiplier, prepend=history.multiplier[0]) > 0.0)
    even = [j / each for j in range(1, each)]
    more = _MOST_MORE * each if samples is None else 0
    rows, knots, slips = [_row(history, 0)], [0], [False]
    for i in range(1, len(history)):
        parts, found = _sampled(along, history, history.plan, i, even, more)
        inner = [_between(history, history.plan, i, part, reached) for part, reached in zip(parts, found[:-1], strict=False)]
        rows += [*inner, _row(history, i)]
        knots.append(len(rows) - 1)
        free = np.diff([0.0, *(moved.free for _, moved in found)])
        slips += (free < 0.5 * np.diff([0.0, *parts, 1.0])).tolist()
    columns: dict[str, Any] = {name: np.array(column) for name, column in zip(_COLUMNS, zip(*rows, strict=True), strict=True)}
    states = replace(history, **columns)
    return Trajectory(states, np.array(knots), np.array(slips))


def _along(plan: Plan, method: str) -> Piece | None:
    """What moves the stress within a step; None where only the knots are known."""
    if method in INTEGRATORS:
        pieces = INTEGRATORS[method].piece
        return None if pieces is None else pieces(plan)
    if plan.path.control == "stress":
        values, c = plan.path.values, plan.compliance

        def elastic(stress: Sequence[float], i: int, parts: Sequence[float]) -> list[Reached]:
            grown = [part * (values[i] - values[i - 1]) for part in parts]
            works = [float((stress + 0.5 * dsigma) @ c @ dsigma) for dsigma in grown]
            return [(stress + dsigma, Move((), 0.0, 0.0, work, part)) for dsigma, work, part in zip(grown, works, parts, strict=True)]

        return elastic
    return None


def _sampled(along: Piece, history: History, plan: Plan, i: int, even: list[float], more: int) -> tuple[list[float], list[Reached]]:
    """Where step i is looked at before its end, and what has been reached there and at its end.

    Where an interval is neither all slip nor all rest, the time it rests is known, so that the change lies that far behind
    its beginning or before its end: one more look at each.  Then up to ``more`` looks between neighbours that are far apart.
    """
    stress, parts = history.stress[i - 1].tolist(), np.array([*even, 1.0])
    found = along(stress, i, parts.tolist())
    starts, free = np.array([0.0, *even]), np.array([0.0, *(moved.free for _, moved in found)])
    rest = np.diff(free)
    mixed = (rest > _APART * free[1:]) & (rest < (parts - starts) * (1.0 - _APART))
    changes = np.sort(np.concatenate([(starts + rest)[mixed], (parts - rest)[mixed]]))
    if changes.size:
        every = np.sort(np.concatenate([parts, changes]))
        parts = np.append(every[:-1][np.diff(every) > _APART * every[1:]], 1.0)
        found = along(stress, i, parts.tolist())
    room = len(parts) + more
    for _ in range(_ROUNDS if more else 0):
        wanted = _wanted(history, plan, i, parts, found, np.append(0.0, changes))[: room - len(parts)]
        if not wanted:
            break
        looks = [*zip(parts.tolist(), found, strict=True), *zip(wanted, along(stress, i, wanted), strict=True)]
        looks.sort(key=lambda look: look[0])
        parts, found = np.array([part for part, _ in looks]), [reached for _, reached in looks]
    return parts[:-1].tolist(), found


def _wanted(history: History, plan: Plan, i: int, parts: Array, found: list[Reached], changes: Array) -> list[float]:
    """Parts of step i between neighbours whose stresses are far apart.

    From each change between rest and slip on, the stress settles over a way that may be any fraction of the step: looks
    stand farther apart the farther they are from it, beginning with the part in which the stress without slip would go
    through the range of all.
    """
    path, seen = plan.path, np.array([history.stress[i - 1], *(stress for stress, _ in found)])
    reach = float(np.ptp(np.concatenate([history.stress, seen]), axis=0).max())
    way = np.array([path.between(i, part)[1] - path.values[i - 1] for part in parts])
    pull = float(np.abs(way @ plan.stiffness).max()) if path.control == "displacement" else 0.0
    scale = reach / pull if pull > reach else 1.0
    wanted = []
    starts, apart = np.append(0.0, parts[:-1]), np.abs(np.diff(seen, axis=0)).max(axis=1)
    for j in np.flatnonzero(apart > _NEAR * reach):
        start, end = float(starts[j]), float(parts[j])
        since = float(changes[changes <= start].max())
        near, far = max(start - since, scale / _MOST_A_STEP), end - since
        count = min(int(np.ceil(apart[j] / (_NEAR * reach))), _MOST_A_STEP)
        if far > 2.0 * near:
            looks = since + np.geomspace(near, far, count + 1)[start >= since + near : -1]
        else:
            looks = np.linspace(start, end, count + 1)[1:-1]
        wanted += [part for part in looks.tolist() if start * (1.0 + 1e-15) < part < end * (1.0 - 1e-15)]
    return wanted


_COLUMNS = ("time", *STATES)


def _row(history: History, i: int) -> tuple[Array | float, ...]:
    return tuple(getattr(history, name)[i] for name in _COLUMNS)


def _between(history: History, plan: Plan, i: int, part: float, reached: Reached) -> tuple[Array | float, ...]:
    """The row at a part of step i."""
    stress, moved = np.array(reached[0]), reached[1]
    path, before = plan.path, i - 1
    time, values, pressure = path.between(i, part)
    strained = plan.compliance @ (stress - history.stress[before])
    if path.control == "stress":
        displacement, slip = history.displacement[before] + strained, history.slip[before]
    else:
        displacement = values
        slip = history.slip[before] + (0.0 if moved.free >= part else values - path.values[before] - strained)
    psi = float(plan.psi(stress))
    return (
        time,
        displacement,
        slip,
        stress,
        pressure,
        history.multiplier[before] + moved.multiplier,
        psi,
        history.dissipation[before] + moved.dissipation,
        history.work[before] + moved.work,
        history.numerical[before],
        moved.work - (psi - history.psi[before]) - moved.dissipation,
    )
