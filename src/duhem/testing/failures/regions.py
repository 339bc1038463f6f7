"""In which regions of stress a check fails: at tips, near zero, at repeated principal stresses, in tension, elsewhere.

A second mistake often shows where a first one does not: where a check fails in several regions, each is asked for its reason.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NEAR, Query, Reply
from duhem.testing.checks.registry import Check, violated
from duhem.testing.drawn.case import Case

__all__ = ["Regions", "region_of"]

_AXES = {axis: i for i, axes in enumerate(("x1", "y2", "z3")) for axis in axes}


def region_of(query: Query, reply: Reply, thin: bool = True) -> NDArray[np.object_]:
    """The region (N,) of each increment, by its trial stress, and at the tip of a cone by the answer too; the ``thin`` ones first."""
    trial, answer = reply.trial, reply.stress
    found, size = np.full(len(trial), "elsewhere", dtype=object), query.length(trial)
    apex = (query.pressure == 0.0) & (query.case.pressure is not None)
    asked, given = (_tensors(query.tails, stress) for stress in (trial, answer))
    if asked is not None and given is not None:
        principal = np.linalg.eigvalsh(asked)
        scale, apart = np.abs(principal).max(axis=1), np.diff(principal, axis=1)
        found[principal.sum(axis=1) > NEAR * scale] = "in tension"
        found[(apart <= NEAR * scale[:, None]).any(axis=1) & thin] = "at repeated principal stresses"
        known = np.asarray(np.isfinite(given).all(axis=(1, 2)))
        ends = np.linalg.eigvalsh(np.where(known[:, None, None], given, asked))
        apex |= known & (np.ptp(ends, axis=1) <= NEAR * scale) & (apart > NEAR * scale[:, None]).any(axis=1)
    found[size <= NEAR * np.median(size)] = "near zero"
    found[apex] = "at the tip"
    return found


def _tensors(tails: Sequence[str], stresses: Array) -> Array | None:
    """Stresses (N, d) as tensors (N, 3, 3), by the ends of their names, such as xx, xy or 1; None where these tell no tensor."""
    axes = [(tail[0], tail[-1]) for tail in tails if len(tail) in (1, 2)]
    if len(tails) < 3 or len(axes) < len(tails) or not {*chain(*axes)} <= {*_AXES}:
        return None
    found = np.zeros((len(stresses), 3, 3))
    for (one, other), column in zip(axes, stresses.T, strict=True):
        found[:, _AXES[one], _AXES[other]] = found[:, _AXES[other], _AXES[one]] = column
    return found


class Regions:
    """Of one check, by region: how many increments were ``judged``, how many ``failed``, and the one that fails ``worst``."""

    def __init__(self, check: Check) -> None:
        self.check, self.judged, self.failed = check, Counter[str](), Counter[str]()
        self.worst: dict[str, tuple[float, Case]] = {}

    def add(self, query: Query) -> None:
        """Count the increments of a case."""
        query = query.some if self.check.again else query
        finding, bad, counts = violated(self.check, query)
        of, shown = region_of(query, query.here), query.case if finding.case is None else finding.case
        self.judged.update(of[counts].tolist())
        self.failed.update(of[bad].tolist())
        for i in np.flatnonzero(bad).tolist():
            most = float(np.nan_to_num(finding.measured[i] / (finding.allowed[i] or 1.0), nan=np.inf))
            if of[i] not in self.worst or most > self.worst[of[i]][0]:
                self.worst[of[i]] = most, shown.row(i)

    def __iter__(self) -> Iterator[tuple[str, Case]]:
        """Each region in which it fails, and the worst case there."""
        return ((name, case) for name, (_, case) in self.worst.items())

    def __str__(self) -> str:
        """Where it fails, and where not; "" where that says nothing."""
        order = sorted(self.judged, key=lambda name: (-self.failed[name] / self.judged[name], name))
        return ", ".join(map(self.of, order)) if len(order) > 1 and self.failed else ""

    def of(self, name: str) -> str:
        """How many increments of a region fail, in words."""
        return f"{self.failed[name]} of {self.judged[name]} {name}"
