"""What a run has visited: shares of the increments that stick, slip, lie at the boundary, a seam or a corner, and their decades.

A test that never slipped says nothing of slip; these shares are what one reads to know.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from duhem.errors import InputError
from duhem.testing.checks.query import NEAR, UNMEASURED, NoReply, Query, Reply

__all__ = ["Visited"]


_TURNED = 1e-3  # a normal that turns by more than this over such a way has jumped


class Visited:
    """Counts over the increments that the routine stands by; those it flags are judged by nobody.

    ``stick``, ``slip`` and ``boundary`` are what :meth:`Query.slipping` makes of a trial stress; ``tip``: without pressure; ``NAME+``
    and ``NAME-``: the sign of a force.  ``seam``: slip that ends within 1e-6 of where the formula changes its piece; ``corner``: where
    the normal jumps there; both are shares of the answers looked at.
    ``increments``: how many were counted; ``decades``: first and last power of ten of stresses, pressures and stiffnesses that are
    not zero.  Without a law (``forces`` is empty) forces are counted by their place, and there is no seam and no corner.
    ``state`` is the share of the increments in which a variable of the state changes.  ``searched`` counts
    what the search for the elastic range found, "range" or "none", or raised.
    ``creeps``: whether all increments may slip.
    ``unmeasured``: how many of the drawn increments cannot be judged, whatever is answered (:attr:`Query.measurable`).
    """

    def __init__(self, forces: tuple[str, ...], pressed: bool, creeps: bool = False) -> None:
        self.forces, self.creeps = forces, creeps
        names = ["stick", "slip", "boundary", *(["tip"] if pressed else []), *(["seam", "corner"] if forces else [])]
        self._counts = Counter(dict.fromkeys([*names, *(f"{name}{sign}" for name in forces for sign in "+-")], 0))
        self.unmeasured = self._drawn = 0
        self.increments = self._looked = self._slipping = self._given_up = 0
        self.decades: dict[str, tuple[int, int]] = {}
        self.searched: Counter[str] = Counter()

    @property
    def shares(self) -> Mapping[str, float]:
        """The shares by name, between 0 and 1; empty where the routine has answered nothing."""
        if not self.increments:
            return {}
        base = {"seam": self._looked, "corner": self._looked}
        return {name: count / max(base.get(name, self.increments), 1) for name, count in self._counts.items()}

    @property
    def given_up(self) -> float:
        """The share of the increments that slip which the routine flags as not solved; without a law, of all increments."""
        return self._given_up / self._slipping if self._slipping else 0.0

    def measure(self, query: Query) -> None:
        """Count the increments of a case that has been drawn, and those that cannot be judged."""
        self._drawn += len(query.case)
        self.unmeasured += int((~query.measurable).sum())

    def demand_measured(self, where: str) -> None:
        """Raise InputError where increments were drawn, and none of them could be judged."""
        if self._drawn and self.unmeasured == self._drawn:
            remedy = "give pressure, stiffness and parameters in other units"
            raise InputError(f"none of {self._drawn} increments can be judged: {UNMEASURED}", where=where, remedy=remedy)

    def add(self, query: Query) -> None:
        """Count the increments of a case that has been asked."""
        with np.errstate(all="ignore"):
            self._trials(query, query.here)
            if self.forces:
                with suppress(NoReply):
                    for reply in query.some.first[1:]:
                        self._trials(query.some, reply)
                self._answers(query, query.here)
        case = query.case
        strain = None if self.forces else np.linalg.solve(case.stiffness, case.trial.T)
        spread = {"stress": case.trial, "strain": strain, "pressure": case.pressure, "stiffness": np.diag(case.stiffness)}
        for name, values in spread.items():
            sizes = np.abs([] if values is None else values)
            sizes = sizes[(sizes > 0.0) & np.isfinite(sizes)]
            if sizes.size:
                low, high = (int(np.floor(np.log10(x))) for x in (sizes.min(), sizes.max()))
                before = self.decades.get(name, (low, high))
                self.decades[name] = min(low, before[0]), max(high, before[1])

    def _trials(self, query: Query, reply: Reply) -> None:
        solved, trial = reply.solved, reply.trial
        slips, boundary = query.slipping(reply)
        self.increments += int(solved.sum())
        may_slip = slips | (not self.forces)  # an answer that is given up does not say whether it slips
        self._slipping += int(may_slip.sum())
        self._given_up += int((may_slip & ~solved).sum())
        found = {"stick": ~slips, "slip": slips, "boundary": boundary}
        found |= {} if (moved := query.state_moves) is None else {"state": moved}
        found |= {"tip": query.pressure == 0.0} if "tip" in self._counts else {}
        for name, column in zip(self.forces or range(1, 1 + trial.shape[1]), trial.T, strict=True):
            found |= {f"{name}+": column > 0.0, f"{name}-": column < 0.0}
        self._counts.update({name: int((which & solved).sum()) for name, which in found.items()})

    def _answers(self, query: Query, reply: Reply) -> None:
        at = np.flatnonzero(reply.solved & np.isfinite(reply.stress).all(axis=1))
        self._looked += len(at)
        at = at[(reply.stress[at] != reply.trial[at]).any(axis=1) & (reply.stress[at] != 0.0).any(axis=1)]
        if not at.size:
            return
        stress, pressure = reply.stress[at], query.pressure[at]
        d, size = stress.shape[1], NEAR * np.abs(stress).max(axis=1)
        ways = np.vstack([np.eye(d), -np.eye(d)])
        points = (stress[None] + size[None, :, None] * ways[:, None, :]).reshape(-1, d)
        gradient, pieces = query.region.slope(points, np.tile(pressure, 2 * d))
        if not pieces.shape[1]:
            return
        around = pieces.reshape(2 * d, len(at), -1)
        seam = (around != around[0]).any(axis=(0, 2))
        normal = (gradient / np.linalg.norm(gradient, axis=1, keepdims=True)).reshape(2 * d, len(at), d)
        turned = np.linalg.norm(normal - normal[0], axis=2).max(axis=0)
        self._counts.update(seam=int(seam.sum()), corner=int((seam & (turned > _TURNED)).sum()))
