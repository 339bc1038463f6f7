"""The arrays that an integrator fills, row by row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from duhem.path.history import SUMS, History
from duhem.path.run import Plan, inner, times
from duhem.projection.result import Array

__all__ = ["Ledger"]


@dataclass(eq=False)
class Ledger:
    """The run so far: rows up to ``done`` hold states and accumulated quantities, as in :class:`duhem.path.history.History`."""

    stress: Array
    slip: Array
    psi: Array
    multiplier: Array
    dissipation: Array
    work: Array
    numerical: Array
    balance: Array
    done: int = 1

    @classmethod
    def begun(cls, plan: Plan, stress: Array) -> Ledger:
        """Room for the whole path, at its start under ``stress``."""
        m, d = plan.path.values.shape
        sums = [np.zeros(m) for _ in range(6)]
        blank = cls(np.empty((m, d)), np.empty((m, d)), sums[0], sums[1], sums[2], sums[3], sums[4], sums[5])
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

    def sticks(self, plan: Plan, first: int, last: int, stress: Array) -> None:
        """Rows ``first`` to ``last`` - 1 without slip, at ``stress`` (n, d)."""
        before = np.vstack([self.stress[first - 1], stress[:-1]])
        gained = inner(0.5 * (before + stress), times(stress - before, plan.compliance))
        none = np.zeros(last - first)
        self.rows(plan, stress, np.zeros_like(stress), (none, none, gained, none))

    def step(self, plan: Plan, stress: Array, slip: Array, gains: tuple[float, float, float, float]) -> None:
        """One more row, from what its step adds: slip, and multiplier, dissipation, work and numerical loss."""
        i = self.done
        self.stress[i], self.slip[i], self.psi[i] = stress, self.slip[i - 1] + slip, plan.psi(stress)
        for sums, gain in zip((self.multiplier, self.dissipation, self.work, self.numerical), gains, strict=True):
            sums[i] = sums[i - 1] + gain
        self.balance[i] = gains[2] - (self.psi[i] - self.psi[i - 1]) - gains[1] - gains[3]
        self.done = i + 1

    def rows(self, plan: Plan, stress: Array, slip: Array, gains: tuple[Array, Array, Array, Array]) -> None:
        """As :meth:`step` for many rows (n, ...) at once, added one after the other."""
        i, last = self.done - 1, self.done + len(stress)
        block = slice(i + 1, last)
        self.stress[block], self.psi[block] = stress, plan.psi(stress)
        self.slip[block] = np.cumsum(np.vstack([self.slip[i], slip]), axis=0)[1:]
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
        rows = [getattr(self, name) for name in ("stress", "slip", *SUMS)]
        bad = ~np.isfinite(np.column_stack(rows)[: self.done]).all(axis=1)
        self.done = int(np.argmax(bad)) if bad.any() else self.done
        return self

    def resume(self, start: History) -> None:
        """The rows of an earlier part of the same run."""
        n = len(start)
        for name in ("stress", "slip", *SUMS):
            getattr(self, name)[:n] = getattr(start, name)
        self.done = n
