"""What a step takes of the rows that it steps: their displacements and closest points, as columns of many rows or as numbers of one.

Rows are many points at one knot of their paths, or one point at knots in turn, up to its first slip.

Steps fill arrays: of one path row by row, of many points abreast.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import add
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from duhem.path import step_formulas
from duhem.path.closest import Closest, ClosestPoint
from duhem.path.history import SUMS, Histories, History, told_of
from duhem.path.loading import Knot, Which
from duhem.path.run import Plan, Share, energy, times
from duhem.path.step_formulas import balance, on_numbers
from duhem.projection.increment import beyond
from duhem.projection.result import Array, Status

__all__ = [
    "Given", "Ledger", "Looked", "ManyRows", "OneRow", "RowsFound", "Sliding", "States", "Step", "Stepped", "Vector", "Ways", "by_arrays",
]  # fmt: skip

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
        u, stress = block.paths.at(0), block.stress.copy()
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

    def keep(self, out: Histories, points: Which | slice, row: int) -> None:
        """Write the states of these points into a row of ``out``; the balance is summed anew from there."""
        for name in _STATES:
            getattr(out, name)[points, row] = getattr(self, name)[points]
        self.balance[:] = 0.0
