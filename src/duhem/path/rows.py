"""What a step takes of the rows that it steps: their displacements and closest points, as columns of many rows or as numbers of one.

Rows are many points at one knot of their paths, or one point at knots in turn, up to its first slip.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from duhem.path import step_formulas
from duhem.path.batch import Share
from duhem.path.closest import Closest
from duhem.path.paths import Knot, Which

__all__ = ["Given", "Looked", "ManyRows", "RowsFound", "Sliding", "Step", "Stepped", "Vector", "Ways", "by_arrays"]

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
