"""What a step takes of the rows that it steps: their displacements and closest points, as columns of many rows or as numbers of one.

Rows are many points at one knot of their paths, or one point at knots in turn, up to its first slip.  Each is the trial of one point at one
knot, with the numbers of its own; what K needs of the pressure is known before the first step.

Steps fill arrays: of one path row by row, of many points abreast.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from operator import add, sub
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import DuhemError
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.path import step_formulas
from duhem.path.history import SUMS, Histories, History, told_of
from duhem.path.loading import Knot, Which, in_rows
from duhem.path.run import Plan, Share, energy, times
from duhem.path.step_formulas import balance, on_numbers
from duhem.projection import closed_form, compiled, quadrants
from duhem.projection.closed_form import centre, in_columns
from duhem.projection.increment import Increment, beyond
from duhem.projection.method import Compiling
from duhem.projection.one_increment import OneIncrement
from duhem.projection.projector import Projector
from duhem.projection.result import NOT_CLOSEST, NOT_SHOWN, Array, Projection, Status
from duhem.projection.row_by_row import widest
from duhem.projection.scaled_formula import level_of, power_of_two

__all__ = [
    "LOST", "Closest", "ClosestPoint", "ClosestPoints", "Given", "Ledger", "Looked", "ManyRows", "OneRow", "RowsFound", "ShapeNumbers",
    "Sliding", "States", "Step", "Stepped", "Vector", "Ways", "by_arrays", "closest_by", "closest_point", "outside", "shape_by",
    "shape_name", "shape_numbers", "vouched",
]  # fmt: skip

LOST = (Status.INACCURATE, Status.FAILED)
_TOLERANCE = 1e-12  # how far outside K a given stress may lie, relative to its size: what rounding explains


class ClosestPoints(NamedTuple):
    """The closest points of n rows: ``stress``, ``slip`` (n, d), ``multiplier`` (n,); ``lost`` is the status of what is not found, else 0.

    ``judged`` is the projection that found them, of the last set of parameters where there are several; None for declared shapes.
    """

    stress: Array
    slip: Array
    multiplier: Array
    lost: NDArray[np.int8]
    judged: Projection | None = None

    def slips(self) -> NDArray[np.bool_]:
        """The rows that slip (n,)."""
        return (self.slip != 0.0).any(axis=1) | (self.multiplier > 0.0)


Closest = Callable[[Array, Knot, Which], ClosestPoints]  # trial stresses (n, d), the knots of their rows, and their points in the block


@dataclass(frozen=True, eq=False)
class ShapeNumbers:
    """The declared shape of each point's K along its path: semi-axes coefficient x load about a centre.

    ``coefficients`` (members, 2 or 4); ``load``, ``share`` (n, m) and ``centre`` (n, m, d), with one row or one column where
    all are alike.  ``share`` turns the multiplier of the gauge built from the coefficients into that of the law's g.
    """

    coefficients: Array
    load: Array
    share: Array
    centre: Array

    def along(self, m: int) -> tuple[Array, Array, Array]:
        """Load (m,), share (m,) and centre (m, d) of one point at the m knots of its path."""
        every, point = np.arange(m), np.zeros(m, dtype=np.intp)
        return in_rows(self.load, every, point), in_rows(self.share, every, point), in_rows(self.centre, every, point)


def shape_numbers(block: Share) -> ShapeNumbers | None:
    """The numbers of a block; None where the law declares no shape that fits."""
    first, law = block.members[0], block.members[0].law
    if law.closed_form is None or closed_form.applies(first) is not None:
        return None
    load = np.zeros((1, 1)) if block.paths.pressure is None else block.paths.pressure
    own = block.own if len(block.members) > 1 else np.zeros(1, dtype=np.intp)
    load = np.broadcast_to(load, (max(len(own), len(load)), load.shape[1]))
    parameters = [np.array([member.parameters[name] for member in block.members]) for name in law.parameters]
    at_points = [values[own, None] for values in parameters]
    none = np.zeros(len(block.members))

    def alone(*entries: object) -> Array:
        return np.stack([in_columns(law, entry, parameters, none) for entry in entries], axis=1)

    def along(entry: object) -> Array:
        return in_columns(law, entry, at_points, load)

    scale, empty = np.ones(len(block.members)), np.zeros(len(block.members), dtype=np.bool_)
    match shape := law.closed_form:
        case Interval():
            coefficients = alone(shape.plus, shape.minus)
        case Disk():
            found = alone(shape.coefficient)
            empty = ~(found[:, 0] > 0.0)  # K is a point
            coefficients = np.repeat(np.where(empty[:, None], 1.0, found), 4, axis=1)
            scale = coefficients[:, 0]
        case Quadrants():
            coefficients = alone(shape.a_plus, shape.a_minus, shape.b_plus, shape.b_minus)
    if not first.diagonal and (coefficients == 0.0).any():
        return None
    slope, middles = along(shape.slope), centre(shape)
    return ShapeNumbers(
        coefficients=coefficients,
        load=along(shape.load) * ~empty[own, None],
        share=1.0 / (np.where(slope > 0.0, slope, 1.0) * scale[own, None]),
        centre=np.stack([along(entry) for entry in middles], axis=2) if middles else np.zeros((1, 1, len(law.forces))),
    )


def shape_name(law: Criterion) -> str:
    """How the closest point of a declared shape is found."""
    match law.closed_form:
        case Interval():
            return "closed form on an interval"
        case Disk():
            return "closed form on a disk"
    return "closed form on four quarter ellipses"


def shape_by(block: Share, method: str) -> ShapeNumbers | None:
    """The numbers of the shape by which a method finds the closest points of a block; None where it asks a projection."""
    return shape_numbers(block) if method in ("auto", "closed-form") else None


def closest_by(block: Share, method: str, shape: ShapeNumbers | None, compiled: bool = False) -> tuple[Closest, str]:
    """The closest points of a block's rows by its shape (:func:`shape_by`), and the name of the method."""
    if shape is None:
        return _by_projection(block, method, compiled)
    law = block.members[0].law
    at = _on_intervals(block, shape) if isinstance(law.closed_form, Interval) else _on_quarters(block, shape, compiled)
    return at, shape_name(law)


def vouched(at: Closest) -> Closest:
    """The same of one path: a row that is not found ends the run, with the error that says why."""

    def closest(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        found = at(trial, knot, which)
        if found.judged is None or not found.lost.any():
            return found
        in_turn = np.argsort(knot)
        slips = np.flatnonzero(found.slips()[in_turn])
        read = in_turn[: slips[0] + 1] if slips.size else in_turn  # a run takes a block no further than its first slip
        if (lost := read[found.lost[read] > 0]).size:
            row, status = int(np.broadcast_to(knot, len(which))[lost[0]]), Status(int(found.lost[lost[0]])).name.lower()
            reason, remedy = found.judged.remark(int(lost[0])), "choose another projection, or smaller steps"
            if reason == NOT_CLOSEST:
                remedy = "verify the convexity of the law, and choose parameters for which K is convex"
            what = f"the closest point under method {found.judged.method} is {status}: {reason}"
            raise DuhemError(what, where=f"step {row}", remedy=remedy)
        return found

    return closest


def outside(block: Share, method: str, stress: Array, knot: Knot, which: Which) -> NDArray[np.bool_]:
    """Which of the stresses (n, d) of a block's rows lie outside K by more than rounding."""
    if len(block.members) == 1 and block.members[0].g is not sp.nan:  # the sign of g tells sooner than the closest point
        value, hidden = level_of(block.members[0]).bounded(stress, block.paths.pressure_at(knot, which), power_of_two(widest(stress)))
        if (value < -hidden).all():
            return np.zeros(len(stress), dtype=np.bool_)
    found = closest_by(block, method, shape_by(block, method))[0](stress, knot, which).stress
    size = np.maximum(np.abs(stress).max(axis=1), np.abs(found).max(axis=1))
    return np.asarray(~(np.abs(found - stress).max(axis=1) <= _TOLERANCE * size))


def _on_quarters(block: Share, shape: ShapeNumbers, fast: bool) -> Closest:
    quarters = quadrants.stacked([quadrants.Quarters.of(mu, block.members[0].stiffness) for mu in shape.coefficients.tolist()])
    moved, several = bool(shape.centre.any()), len(block.members) > 1

    def at(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        stress, slip, multiplier = np.empty(trial.shape), np.empty(trial.shape), np.empty(len(trial))
        load, middle = in_rows(shape.load, knot, which), in_rows(shape.centre, knot, which) if moved else 0.0
        about = trial - middle if moved else trial
        if fast and not several:
            compiled.project(about, load, quarters, stress, slip, multiplier)
        else:
            quadrants.project(about, load, quarters, stress, slip, multiplier, block.own[which] if several else None)
        if moved:
            stress = np.where((multiplier > 0.0)[:, None], stress + middle, trial)
        return _finite(stress, slip, multiplier * in_rows(shape.share, knot, which))

    return at


def _on_intervals(block: Share, shape: ShapeNumbers) -> Closest:
    plus, minus = shape.coefficients.T
    k = float(block.members[0].stiffness[0, 0])

    def at(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        own = block.own[which]
        mu = np.where(trial[:, 0] < 0.0, minus[own], plus[own])
        stress, slip, multiplier = quadrants.clamped(trial[:, 0], mu, in_rows(shape.load, knot, which), k)
        return _finite(stress[:, None], slip[:, None], multiplier * in_rows(shape.share, knot, which))

    return at


def _finite(stress: Array, slip: Array, multiplier: Array) -> ClosestPoints:
    return ClosestPoints(stress, slip, multiplier, (~np.isfinite(multiplier)).view(np.int8) * np.int8(Status.FAILED))


def _by_projection(block: Share, method: str, fast: bool) -> tuple[Closest, str]:
    """Through :class:`duhem.projection.projector.Projector`, which judges each answer."""
    prepared = [Projector.of(member.law, member.stiffness, member.parameters, method) for member in block.members]
    options = {"compiled": fast} if issubclass(prepared[0].method.options, Compiling) else {}

    def at(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        found = ClosestPoints(np.empty_like(trial), np.empty_like(trial), np.empty(len(trial)), np.zeros(len(trial), dtype=np.int8))
        pressure, own = block.paths.pressure_at(knot, which), block.own[which]
        for i, projector in enumerate(prepared):
            if not (mine := np.flatnonzero(own == i)).size:
                continue
            posed, known = np.ascontiguousarray(trial[mine]), block.members[i].convexity
            judged = projector.at(replace(projector.setting, trial=posed, pressure=pressure[mine], convexity=known), **options)
            found.stress[mine], found.slip[mine], found.multiplier[mine] = judged.stress, judged.slip, judged.multiplier
            found.lost[mine] = np.where(np.isin(judged.status, LOST), judged.status, 0)
            found = found._replace(judged=judged)
        return found

    load = block.paths.pressure
    return at, _named(prepared[0], replace(block.members[0], pressure=np.zeros(1) if load is None else load.ravel()))


def _named(projector: Projector, question: Increment) -> str:
    """The method, and what it leaves open under the pressures of a question."""
    known = projector.method.convex or question.convexity is None or question.shown_convex().all()
    return f"projection by {projector.method.name}{'' if known else f'; {NOT_SHOWN}'}"


# -- what a step takes of its rows -------------------------------------------------------------------------------------

Vector = Any  # d components, each a number, or (n,) numbers of the rows


class RowsFound(NamedTuple):
    """Closest points: stress, slip, multiplier, which slip, and the status of what is not found, else 0."""

    stress: Vector
    slip: Vector
    multiplier: Any
    slips: Any
    lost: Any


class Stepped(NamedTuple):
    """What a step makes of rows: displacement, stress, slip, psi, what it adds to the four sums, which slip, the status where lost."""

    displacement: Vector
    stress: Vector
    slip: Vector
    psi: Any
    added: Any
    slips: Any
    lost: Any


Step = Callable[[Vector, Vector, Vector, Knot, Which], Any]
"""(stress and displacement where each row last slipped, stress before, knots, points) -> what the step makes of them, Stepped;
``before`` has one row where these are knots of one point in turn.  None where plain numbers have no answer, and arrays are to be asked."""

Ways = Sequence[Vector]  # displacements at the start, the middle and the end of a step
Given = tuple[Vector, Ways, Knot, Which]  # the stress before a step, its displacements, the knot of its end and the points
Sliding = Callable[..., Any]
Looked = tuple[RowsFound, RowsFound]  # at the first half of a step and at the whole


class ManyRows:
    """Many rows, as columns of arrays."""

    formulas: Any = step_formulas

    def __init__(self, block: Share, at: Closest) -> None:
        self.k, self.c = block.members[0].stiffness[:, :, None], block.compliance[:, :, None]
        self.none = np.zeros((len(self.k), 1))
        self._paths, self._at = block.paths, at

    def displacement(self, knot: Knot, which: Which) -> Vector:
        """At the knots of the rows."""
        return np.ascontiguousarray(self._paths.at(knot, which).T)

    def closest(self, trial: Vector, knot: Knot, which: Which) -> RowsFound:
        """The closest points to trial stresses."""
        found = self._at(np.ascontiguousarray(trial.T), knot, which)
        return RowsFound(
            np.ascontiguousarray(found.stress.T), np.ascontiguousarray(found.slip.T), found.multiplier, found.slips(), found.lost
        )

    def both(self, half: Vector, trial: Vector, end: Knot, which: Which) -> tuple[RowsFound, RowsFound]:
        """The same of two trials a row, the first of them one knot before the end."""
        n = len(which)
        knots = np.concatenate([np.broadcast_to(end - 1, n), np.broadcast_to(end, n)])
        found = self.closest(np.concatenate([half, trial], axis=1), knots, np.concatenate([which, which]))
        return RowsFound(*(each[..., :n] for each in found)), RowsFound(*(each[..., n:] for each in found))

    def preceding(self, before: Vector, trial: Vector) -> Vector:
        """The stress before each row."""
        missing = trial.shape[1] - before.shape[1]  # up to its first slip each row begins where the one before it stuck
        return np.concatenate([before, trial[:, :missing]], axis=1) if missing else before

    def worst(self, *found: RowsFound) -> Any:
        """The status of what is not found among several."""
        return np.max([each.lost for each in found], axis=0)

    def sliding(self, sticks: Stepped, looked: Looked, begun: Sliding, slid: Sliding, anchor: Vector, given: Given) -> Stepped:
        """Where rows slip what ``slid`` makes of them, and the others as they are.

        ``looked`` are the closest points as seen from where each row last slipped: a row that slips is ``begun`` anew from its own start.
        """
        before, ways, end, which = given
        go = np.flatnonzero(sticks.slips)
        if np.ndim(end):  # of one point nothing is asked behind the first slip, and what is lost there is asked again, which ends the run
            go = go[:1]
            end = np.asarray(end)[go]
        else:
            go = go[sticks.lost[go] == 0]
        whole = sticks._replace(slip=np.zeros_like(sticks.stress), added=np.zeros((4, len(which))))
        whole.added[2] = sticks.added[2]
        if go.size:
            slipping = before[:, go], [way[:, go] for way in ways], end, which[go]
            looked = begun(*slipping)
            if np.ndim(end) and self.worst(*looked).any():  # beyond double precision, as the trial is
                return whole
            made = slid(*slipping, *looked)
            for name in ("stress", "slip", "psi", "added", "lost"):
                getattr(whole, name)[..., go] = getattr(made, name)
        return whole


def by_arrays(step: Step) -> Step:
    """The step of columns for rows (n, d)."""

    def stepped(anchor_stress: Vector, anchor: Vector, before: Vector, knot: Knot, which: Which) -> Stepped:
        begun, fixed, last = (np.ascontiguousarray(rows.T) for rows in (anchor_stress, anchor, before))
        u, stress, slip, psi, added, slips, lost = step(begun, fixed, last, knot, which)
        return Stepped(u.T, stress.T, slip.T, psi, added, slips, lost)

    return stepped


# -- one row of one path on plain numbers: where a step has one row, arrays take longer to call than to compute ---------
# What has no answer on plain numbers is None, and arrays are asked.

Answer = tuple[Sequence[float], Sequence[float], float]  # stress, slip and multiplier
ClosestPoint = Callable[[Vector, Any], Answer | None]  # of a trial stress at a knot


# -- the closest point -------------------------------------------------------------------------------------------------


def closest_point(block: Share, method: str, shape: ShapeNumbers | None, by_arrays: Closest) -> ClosestPoint | None:
    """The closest point of the one point of a block at one of its knots; None where plain numbers do not do.

    What has no answer on them is asked of arrays, and has none where it is lost.
    """
    if shape is None:
        plain = _judged(block, method)
    else:
        plain = (_on_interval if isinstance(block.members[0].law.closed_form, Interval) else _point_on_quarters)(block, shape)
    if plain is None:
        return None
    which = np.zeros(1, dtype=np.intp)

    def at(trial: Vector, knot: int) -> Answer | None:
        if (answer := plain(trial, knot)) is not None:
            return answer
        found = by_arrays(np.array([trial]), knot, which)
        return None if found.lost.any() else (found.stress[0].tolist(), found.slip[0].tolist(), float(found.multiplier[0]))

    return at


def _point_on_quarters(block: Share, shape: ShapeNumbers) -> ClosestPoint | None:
    quarters = quadrants.Quarters.of(shape.coefficients[0].tolist(), block.members[0].stiffness)
    if quarters.flat.any():
        return None
    load, share, centre = (_along(array) for array in (shape.load, shape.share, shape.centre))
    moved = bool(shape.centre.any())

    def at(trial: Vector, knot: int) -> Answer | None:
        middle = centre(knot)
        found = quadrants.plain_closest(quarters, list(map(sub, trial, middle)) if moved else trial, load(knot))
        if found is None or not isfinite(found[2]):
            return None
        stress, slip, multiplier = found
        if moved:
            stress = list(map(add, stress, middle)) if multiplier > 0.0 else list(trial)
        return stress, slip, multiplier * share(knot)

    return at


def _on_interval(block: Share, shape: ShapeNumbers) -> ClosestPoint:
    load, share = _along(shape.load), _along(shape.share)
    (plus, minus), k = shape.coefficients[0].tolist(), float(block.members[0].stiffness[0, 0])

    def at(trial: Vector, knot: int) -> Answer | None:
        found = quadrants.plain_clamped(trial[0], minus if trial[0] < 0.0 else plus, load(knot), k)
        if found is None or not isfinite(found[2]):
            return None
        return found[:1], found[1:2], found[2] * share(knot)

    return at


def _along(array: Array) -> Callable[[int], Any]:
    """Its numbers at a knot, (1, m) or (1, m, d); of one column where all are alike."""
    if array.shape[1] > 1:
        return lambda knot: array[0, knot].tolist()
    always = array[0, 0].tolist()
    return lambda _: always


def _judged(block: Share, method: str) -> ClosestPoint | None:
    """By a method for any law, each answer judged; None without plain numbers, and where K is not shown to be convex."""
    member, pressure = block.members[0], block.paths.pressure
    prepared, known = Projector.of(member.law, member.stiffness, member.parameters, method), member.convexity
    one = OneIncrement(prepared.setting, prepared.method)
    if not (prepared.method.convex or (known is not None and known.loaded)) or not one.made():
        return None
    load = None if pressure is None else _along(pressure)

    def at(trial: Vector, knot: int) -> Answer | None:
        if (numbers := one.numbers(trial, None if load is None else load(knot))) is None or (found := one.answer(*numbers)) is None:
            return None
        return found.stress, found.slip, found.multiplier

    return at


# -- the rows of steps ---------------------------------------------------------------------------------------------------


class OneRow:
    """One row of the one point of a block, on plain numbers: vectors are lists or tuples of them.

    Its methods say what those of :class:`ManyRows` say, or None where plain numbers have no answer.
    """

    def __init__(self, block: Share, at: ClosestPoint) -> None:
        stiffness = block.members[0].stiffness
        self.formulas: Any = on_numbers(len(stiffness))
        self.k, self.c, self.none = stiffness.tolist(), block.compliance.tolist(), [0.0] * len(stiffness)
        self._values, self._at = block.paths.values[0], at

    def displacement(self, knot: Knot, which: Which) -> Vector:
        return self._values[knot].tolist()

    def closest(self, trial: Vector, knot: Knot, which: Which) -> RowsFound | None:
        if (answer := self._at(trial, knot)) is None:
            return None
        stress, slip, multiplier = answer
        return RowsFound(stress, slip, multiplier, multiplier > 0.0 or any(slip), 0)

    def both(self, half: Vector, trial: Vector, end: Knot, which: Which) -> tuple[RowsFound, RowsFound] | None:
        first, whole = self.closest(half, end - 1, which), self.closest(trial, end, which)
        return None if first is None or whole is None else (first, whole)

    def preceding(self, before: Vector, trial: Vector) -> Vector:
        return before

    def worst(self, *found: RowsFound) -> int:
        return 0

    def sliding(self, sticks: Stepped, looked: Looked, begun: Sliding, slid: Sliding, anchor: Vector, given: Given) -> Stepped | None:
        if not sticks.slips:
            return sticks
        found = looked if anchor == given[1][0] else begun(*given)
        return None if found is None else slid(*given, *found)


# -- the arrays that steps fill: of one path row by row, of many points abreast ----------------------------------------


Gains = Sequence[Array] | Array  # what steps add to multiplier, dissipation, work and numerical loss (4, n)
Flags = NDArray[np.bool_]
_ADDED = ("slip", "multiplier", "dissipation", "work", "numerical", "balance")
_STATES = ("slip", "stress", *SUMS)


@dataclass(eq=False)
class _Sums:
    """Stress and slip, and what is added up: of one path, or of many points."""

    slip: Array
    stress: Array
    multiplier: Array
    psi: Array
    dissipation: Array
    work: Array
    numerical: Array
    balance: Array


@dataclass(eq=False)
class Ledger(_Sums):
    """The run so far: rows up to ``done`` hold states and accumulated quantities, as in :class:`duhem.path.history.History`.

    Of one path they are the first axis, of many points the second.  ``added`` are the four sums that steps add to.
    """

    added: Array
    compliance: Array
    done: int = 1

    @classmethod
    def begun(cls, m: int, displacement: Array, stress: Array, compliance: Array) -> Ledger:
        """Room for m knots, at the first of them; ``displacement`` and ``stress`` (d,) of one path, (n, d) of many points."""
        *each, d = stress.shape
        added = np.zeros((4, *each, m))
        sums = dict(zip(_ADDED[1:5], added, strict=True)) | {name: np.zeros((*each, m)) for name in ("psi", "balance")}
        blank = cls(np.empty((*each, m, d)), np.empty((*each, m, d)), **sums, added=added, compliance=compliance)
        blank.stress[..., 0, :], blank.psi[..., 0] = stress, energy(stress, compliance)
        blank.slip[..., 0, :] = displacement - times(stress, compliance)
        return blank

    @property
    def anchor(self) -> int:
        """The last row at which something slipped, or the first."""
        i = self.done - 1
        while i > 0 and (self.slip[i] == self.slip[i - 1]).all() and self.multiplier[i] == self.multiplier[i - 1]:
            i -= 1
        return i

    def rows(self, stress: Array, slip: Array, gains: Gains) -> None:
        """Further rows, from what their steps add: slip, and multiplier, dissipation, work and numerical loss."""
        i, last = self.done - 1, self.done + stress.shape[-2]
        self.stress[..., i + 1 : last, :], self.psi[..., i + 1 : last] = stress, energy(stress, self.compliance)
        self.slip[..., i + 1 : last, :] = slip
        np.add.accumulate(self.slip[..., i:last, :], axis=-2, out=self.slip[..., i:last, :])
        self.added[..., i + 1 : last] = gains
        np.add.accumulate(self.added[..., i:last], axis=-1, out=self.added[..., i:last])
        self.balance[..., i + 1 : last] = balance(self.psi[..., i : last - 1], self.psi[..., i + 1 : last], gains)
        self.done = last

    def row(self, made: Stepped) -> None:
        """One row of one path, from plain numbers."""
        i = self.done
        self.stress[i], self.psi[i] = made.stress, made.psi
        self.slip[i] = list(map(add, self.slip[i - 1].tolist(), made.slip))
        self.added[:, i] = list(map(add, self.added[:, i - 1].tolist(), made.added))
        self.balance[i] = balance(float(self.psi[i - 1]), made.psi, made.added)
        self.done = i + 1

    def keep(self, out: Histories, points: Which | int) -> None:
        """Write the kept knots of the rows done into the histories of these points; the balance is summed since the kept knot before."""
        kept = out.knots[out.knots < self.done]
        for name in _STATES:
            array = getattr(self, name)
            if name == "balance" and len(kept) > 1:
                getattr(out, name)[points, : len(kept)] = np.add.reduceat(array[..., : self.done], np.append(0, kept[:-1] + 1), axis=-1)
            else:
                getattr(out, name)[points, : len(kept)] = np.take(array, kept, axis=-2 if name in ("slip", "stress") else -1)
        slips = np.diff(self.multiplier[..., max(self.done - 2, 0) : self.done], axis=-1).any(axis=-1)
        out.status[points], out.reached[points] = np.where(slips, Status.SLIP, Status.STICK), self.done - 1

    def history(self, plan: Plan, method: str, why: str) -> History:
        """The rows done."""
        law, path, n = plan.increment.law, plan.path, self.done
        stress, slip = self.stress[:n], self.slip[:n]
        return History(
            time=path.time[:n],
            timed=path.timed,
            displacement=path.values[:n] if path.control == "displacement" else slip + times(stress, plan.compliance),
            slip=slip,
            stress=stress,
            pressure=plan.increment.pressure[:n],
            **told_of(law, **{name: getattr(self, name)[:n] for name in SUMS}),
            method=method,
            why=why,
            plan=plan,
        )

    def finite(self) -> Ledger:
        """This ledger, done up to the first row that holds a number beyond double precision."""
        bad = ~self.sound()[: self.done]
        self.done = int(np.argmax(bad)) if bad.any() else self.done
        return self

    def sound(self) -> Flags:
        """The rows whose numbers are all finite."""
        vectors = np.isfinite(self.stress).all(axis=-1) & np.isfinite(self.slip).all(axis=-1)
        return np.logical_and.reduce([vectors, *(np.isfinite(getattr(self, name)) for name in SUMS)])

    def resume(self, start: History) -> None:
        """The rows of an earlier part of the same run."""
        self.done = len(start)
        for name in _STATES:
            getattr(self, name)[: self.done] = getattr(start, name)


@dataclass(eq=False)
class States(_Sums):
    """Where n points are: their states as in :class:`Histories`, and the knot from which each has not slipped."""

    anchor_stress: Array
    anchor: Array
    status: NDArray[np.int8]
    reached: NDArray[np.intp]

    @classmethod
    def begun(cls, block: Share) -> States:
        """At the first knot."""
        n = len(block)
        u, stress = block.paths.at(0, np.arange(n)), block.stress.copy()
        blank = cls(
            slip=u - times(stress, block.compliance),
            stress=stress,
            anchor_stress=stress.copy(),
            anchor=np.array(u),
            status=np.full(n, Status.STICK, dtype=np.int8),
            reached=np.zeros(n, dtype=np.intp),
            **{name: np.zeros(n) for name in SUMS},
        )
        blank.psi[:] = energy(stress, block.compliance)
        return blank

    def take(self, block: Share, which: Which, made: Stepped) -> None:
        """One step of the points ``which``; those that are ``lost`` stay where they were."""
        u, stress, slip, psi, gains, slips, lost = made
        added = dict(zip(_ADDED, (slip, *gains, balance(self.psi[which], psi, gains)), strict=True))
        new = {name: getattr(self, name)[which] + gain for name, gain in added.items()} | {"stress": stress, "psi": psi}
        finite = np.isfinite(np.column_stack(list(new.values()))).all(axis=1)
        ends = np.where(finite | (lost > 0), lost, Status.FAILED)
        if (law := block.members[0].law).domain:
            ends = np.where((ends == 0) & beyond(law, stress), Status.OUTSIDE, ends)
        on = np.flatnonzero(ends == 0)
        go = which[on]
        for name, values in new.items():
            getattr(self, name)[go] = values[on]
        self.status[which] = np.where(ends == 0, np.where(slips, Status.SLIP, Status.STICK), ends)
        self.reached[go] += 1
        slipped = on[slips[on]]
        self.anchor_stress[which[slipped]], self.anchor[which[slipped]] = stress[slipped], u[slipped]

    def keep(self, out: Histories, points: Which, row: int) -> None:
        """Write the states of these points into a row of ``out``; the balance is summed anew from there."""
        for name in _STATES:
            getattr(out, name)[points, row] = getattr(self, name)[points]
        self.balance[:] = 0.0
