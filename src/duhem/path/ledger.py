"""The arrays that steps fill: of one path row by row, of many points abreast."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.path.batch import Share
from duhem.path.history import SUMS, Histories, History
from duhem.path.paths import Which
from duhem.path.run import Plan, energy, times
from duhem.projection.declared_ranges import beyond
from duhem.projection.result import Array, Status

__all__ = ["Gains", "Ledger", "States"]

Gains = Sequence[Array] | Array  # what steps add to multiplier, dissipation, work and numerical loss (4, n)
Flags = NDArray[np.bool_]
_ADDED = ("slip", "multiplier", "dissipation", "work", "numerical", "balance")
_STATES = ("slip", "stress", *SUMS)


@dataclass(eq=False)
class Ledger:
    """The run so far: rows up to ``done`` hold states and accumulated quantities, as in :class:`duhem.path.history.History`."""

    stress: Array
    slip: Array
    multiplier: Array
    psi: Array
    dissipation: Array
    work: Array
    numerical: Array
    balance: Array
    done: int = 1

    @classmethod
    def begun(cls, plan: Plan, stress: Array) -> Ledger:
        """Room for the whole path, at its start under ``stress``."""
        m, d = plan.path.values.shape
        blank = cls(stress=np.empty((m, d)), slip=np.empty((m, d)), done=1, **{name: np.zeros(m) for name in SUMS})
        blank.stress[0], blank.psi[0] = stress, plan.psi(stress)
        blank.slip[0] = 0.0 if plan.path.control == "stress" else plan.path.values[0] - times(stress, plan.compliance)
        return blank

    @property
    def anchor(self) -> int:
        """The last row at which something slipped, or the first."""
        i = self.done - 1
        while i > 0 and (self.slip[i] == self.slip[i - 1]).all() and self.multiplier[i] == self.multiplier[i - 1]:
            i -= 1
        return i

    def rows(self, plan: Plan, stress: Array, slip: Array, gains: Gains) -> None:
        """Further rows (n, ...), from what their steps add: slip, and multiplier, dissipation, work and numerical loss."""
        i, last = self.done - 1, self.done + len(stress)
        block = slice(i + 1, last)
        self.stress[block], self.psi[block] = stress, plan.psi(stress)
        self.slip[block] = np.cumsum(np.concatenate([self.slip[i : i + 1], slip]), axis=0)[1:]
        for sums, gain in zip((self.multiplier, self.dissipation, self.work, self.numerical), gains, strict=True):
            sums[block] = np.cumsum(np.concatenate([sums[i : i + 1], gain]))[1:]
        self.balance[block] = gains[2] - np.diff(self.psi[i:last]) - gains[1] - gains[3]
        self.done = last

    def history(self, plan: Plan, method: str, why: str) -> History:
        """The rows done."""
        law, path, n = plan.increment.law, plan.path, self.done
        stress, slip = self.stress[:n], self.slip[:n]
        return History(
            law=law.name,
            forces=law.forces,
            pressure_name=law.pressure,
            time=path.time[:n],
            timed=path.timed,
            displacement=path.values[:n] if path.control == "displacement" else slip + times(stress, plan.compliance),
            slip=slip,
            stress=stress,
            pressure=plan.increment.pressure[:n],
            **{name: getattr(self, name)[:n] for name in SUMS},
            method=method,
            why=why,
            plan=plan,
        )

    def finite(self) -> Ledger:
        """This ledger, done up to the first row that holds a number beyond double precision."""
        bad = ~np.isfinite(np.column_stack([getattr(self, name) for name in _STATES])[: self.done]).all(axis=1)
        self.done = int(np.argmax(bad)) if bad.any() else self.done
        return self

    def resume(self, start: History) -> None:
        """The rows of an earlier part of the same run."""
        self.done = len(start)
        for name in _STATES:
            getattr(self, name)[: self.done] = getattr(start, name)


@dataclass(eq=False)
class States:
    """Where n points are: their states as in :class:`Histories`, and the knot from which each has not slipped."""

    slip: Array
    stress: Array
    multiplier: Array
    psi: Array
    dissipation: Array
    work: Array
    numerical: Array
    balance: Array
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

    def take(
        self, block: Share, which: Which, u: Array, stress: Array, slip: Array, gains: Gains, slips: Flags, lost: NDArray[np.int8]
    ) -> None:
        """One step of the points ``which``, to the displacements ``u``; those that are ``lost`` stay where they were."""
        multiplier, dissipation, work, numerical = gains
        psi = energy(stress, block.compliance)
        balance = work - (psi - self.psi[which]) - dissipation - numerical
        added = {
            "slip": slip,
            "multiplier": multiplier,
            "dissipation": dissipation,
            "work": work,
            "numerical": numerical,
            "balance": balance,
        }
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

    def keep(self, out: Histories, row: int) -> None:
        """Write the states into a row of ``out``; the balance is summed anew from there."""
        for name in _STATES:
            getattr(out, name)[:, row] = getattr(self, name)
        self.balance[:] = 0.0
