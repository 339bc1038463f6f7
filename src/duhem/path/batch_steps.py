"""Steps of many points abreast: at each knot the closest points of all that still go on, and what the step adds to their sums.

The numbers of a point are those of its path by itself: see :mod:`duhem.path.implicit` and :mod:`duhem.path.extrapolated`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.path.batch import Share
from duhem.path.batch_projection import BatchClosest, Which
from duhem.path.extrapolated import sums_of
from duhem.path.history import STATES, Histories
from duhem.path.implicit import energies
from duhem.path.run import energy, inner, times
from duhem.projection.declared_ranges import beyond
from duhem.projection.result import Array, Status

__all__ = ["States", "extrapolated", "implicit"]

Gains = tuple[Array, Array, Array, Array]  # multiplier, dissipation, work, numerical loss, (n,) each
Step = tuple[Array, Array, Gains, NDArray[np.bool_], NDArray[np.int8]]  # stress, slip, gains, slips, status where lost


@dataclass(eq=False)
class States:
    """Where n points are: their states as in :class:`Histories`, and the knot from which each has not slipped.

    Trials are taken from there, so that no rounding gathers while a point sticks.
    """

    displacement: Array
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
        u, stress = np.array(np.broadcast_to(block.paths.at(0), block.stress.shape)), block.stress.copy()
        zero = [np.zeros(len(block)) for _ in range(5)]
        return cls(
            displacement=u,
            slip=u - times(stress, block.compliance),
            stress=stress,
            multiplier=zero[0],
            psi=energy(stress, block.compliance),
            dissipation=zero[1],
            work=zero[2],
            numerical=zero[3],
            balance=zero[4],
            anchor_stress=stress.copy(),
            anchor=u.copy(),
            status=np.full(len(block), Status.STICK, dtype=np.int8),
            reached=np.zeros(len(block), dtype=np.intp),
        )

    def take(self, block: Share, which: Which, u: Array, step: Step) -> None:
        """One step of the points ``which``; those that are lost stay where they were."""
        stress, slip, (multiplier, dissipation, work, numerical), slips, lost = step
        psi = energy(stress, block.compliance)
        balance = work - (psi - self.psi[which]) - dissipation - numerical
        new = {
            "slip": self.slip[which] + slip,
            "stress": stress,
            "multiplier": self.multiplier[which] + multiplier,
            "psi": psi,
            "dissipation": self.dissipation[which] + dissipation,
            "work": self.work[which] + work,
            "numerical": self.numerical[which] + numerical,
            "balance": self.balance[which] + balance,
        }
        finite = np.isfinite(np.column_stack(list(new.values()))).all(axis=1)
        ends = np.where(finite | (lost > 0), lost, Status.FAILED)
        if (law := block.members[0].law).domain:
            ends = np.where((ends == 0) & beyond(law, stress), Status.OUTSIDE, ends)
        on = np.flatnonzero(ends == 0)
        go = which[on]
        for name, values in new.items():
            getattr(self, name)[go] = values[on]
        self.displacement[go] = u[on]
        self.status[which] = np.where(ends == 0, np.where(slips, Status.SLIP, Status.STICK), ends)
        self.reached[go] += 1
        slipped = on[slips[on]]
        self.anchor_stress[which[slipped]], self.anchor[which[slipped]] = stress[slipped], u[slipped]

    def keep(self, out: Histories, row: int, knot: int, pressure: Array) -> None:
        """Write the states into a row of ``out``; nan for the points that have not come so far."""
        for name in _STATES:
            getattr(out, name)[:, row] = getattr(self, name)
        out.pressure[:, row] = pressure
        if (gone := np.flatnonzero(self.reached < knot)).size:
            for name in _STATES:
                getattr(out, name)[gone, row] = np.nan
        self.balance[:] = 0.0


_STATES = tuple(name for name in STATES if name != "pressure")


def run(block: Share, out: Histories, halves: int, step: Callable[[States, Which, int], tuple[Array, Step]]) -> None:
    """From the first knot to the last; the block has ``halves`` rows of its paths a step."""
    states, row = States.begun(block), 0
    kept = set(out.knots.tolist())
    which = np.arange(len(block))
    for knot in range(int(out.knots[-1]) + 1):
        if knot:
            if which.size:
                states.take(block, which, *step(states, which, knot))
            which = which[states.reached[which] == knot]
        if knot in kept:
            states.keep(out, row, knot, block.pressure(knot * halves))
            row += 1
    out.status[:], out.reached[:] = states.status, states.reached


def implicit(block: Share, at: BatchClosest) -> Callable[[States, Which, int], tuple[Array, Step]]:
    """The implicit step of many points."""
    k, c = block.members[0].stiffness, block.compliance

    def step(states: States, which: Which, knot: int) -> tuple[Array, Step]:
        u = _of(block, knot, which)
        before, du = states.stress[which], u - states.displacement[which]
        trial = states.anchor_stress[which] + times(u - states.anchor[which], k)
        stress, slip, multiplier, lost = at(trial, knot, which)
        slips = (slip != 0.0).any(axis=1) | (multiplier > 0.0)
        stress = np.where(slips[:, None], stress, trial)
        dissipation, work, numerical = energies(k, stress, slip, du)
        gained = inner(0.5 * (before + stress), times(stress - before, c))
        gains = multiplier, np.where(slips, dissipation, 0.0), np.where(slips, work, gained), np.where(slips, numerical, 0.0)
        return u, (stress, slip, gains, slips, lost)

    return step


def extrapolated(block: Share, at: BatchClosest) -> Callable[[States, Which, int], tuple[Array, Step]]:
    """The extrapolated step of many points, over paths with two rows a step."""
    k, c = block.members[0].stiffness, block.compliance

    def step(states: States, which: Which, knot: int) -> tuple[Array, Step]:
        middle, u = _of(block, 2 * knot - 1, which), _of(block, 2 * knot, which)
        before, start = states.stress[which], states.displacement[which]
        trial = states.anchor_stress[which] + times(u - states.anchor[which], k)
        half = states.anchor_stress[which] + times(middle - states.anchor[which], k)
        looks = [at(half, 2 * knot - 1, which), at(trial, 2 * knot, which)]
        slips = np.any([(slip != 0.0).any(axis=1) | (multiplier > 0.0) for _, slip, multiplier, _ in looks], axis=0)
        lost = np.maximum(looks[0][3], looks[1][3])
        stress, slip = trial, np.zeros_like(trial)
        gains = np.zeros((4, len(which)))
        gains[2] = inner(0.5 * (before + trial), times(trial - before, c))
        if (go := np.flatnonzero(slips & (lost == 0))).size:
            own, s = which[go], before[go]
            du, d1, d2 = (u - start)[go], (middle - start)[go], (u - middle)[go]
            whole = at(s + times(du, k), 2 * knot, own)
            first = at(s + times(d1, k), 2 * knot - 1, own)
            second = at(first[0] + times(d2, k), 2 * knot, own)
            end = at(2.0 * second[0] - whole[0], 2 * knot, own)
            one = np.array([whole[2], *energies(k, whole[0], whole[1], du)])
            parts = [energies(k, *found[:2], d) for found, d in ((first, d1), (second, d2))]
            two = np.array([first[2] + second[2], *np.add(parts[0], parts[1])])
            stress = stress.copy()
            stress[go], slip[go] = end[0], du - times(end[0] - s, c)
            gains[:, go] = sums_of(one, two)
            lost[go] = np.max([found[3] for found in (whole, first, second, end)], axis=0)
        return u, (stress, slip, (gains[0], gains[1], gains[2], gains[3]), slips, lost)

    return step


def _of(block: Share, row: int, which: Which) -> Array:
    u = block.paths.at(row)
    return u[which] if len(u) > 1 else np.broadcast_to(u, (len(which), u.shape[1]))
