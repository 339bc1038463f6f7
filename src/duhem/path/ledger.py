"""The arrays that steps fill: of one path row by row, of many points abreast."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import add

import numpy as np
from numpy.typing import NDArray

from duhem.path.history import SUMS, Histories, History, told_of
from duhem.path.loading import Which
from duhem.path.rows import Stepped
from duhem.path.run import Plan, Share, energy, times
from duhem.path.step_formulas import balance
from duhem.projection.declared_ranges import beyond
from duhem.projection.result import Array, Status

__all__ = ["Gains", "Ledger", "States"]

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
