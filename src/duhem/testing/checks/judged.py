"""A check put to one case: the row that violates it most."""

from __future__ import annotations

import numpy as np

from duhem.testing.checks.query import NothingToCheck, Query
from duhem.testing.checks.registry import Check
from duhem.testing.drawn.case import Case

__all__ = ["judged"]


def judged(asked: Check, query: Query) -> tuple[Case, str, float, float] | None:
    """The increment of the worst row, a message, what was measured and what is allowed.

    Raises NothingToCheck where no row can be judged, NoReply where the routine gave none.
    """
    query = query.some if asked.again else query
    with np.errstate(all="ignore"):
        finding = asked.measure(query)
    for what, count in finding.tried.items():
        query.tried[asked.name, what] += count
    sound = query.sound if query.whole is None else query.sound & query.whole.sound[query.rows]
    counts = sound | asked.law_only
    if not counts.any():
        raise NothingToCheck("the routine flags every increment as not solved")
    if finding.unknown is not None:
        query.unsaid |= finding.unknown
        counts &= ~finding.unknown
        if not counts.any():
            raise NothingToCheck("g of the law has no value at any of the stresses to be judged")
    bad = finding.violated & counts
    if not bad.any():
        return None
    with np.errstate(all="ignore"):
        excess = np.where(bad, np.nan_to_num(finding.measured - finding.allowed, nan=np.inf, posinf=1e300), -np.inf)
    i = int(np.argmax(excess))
    measured, allowed = float(finding.measured[i]), float(finding.allowed[i])
    said = f"measured {measured:.3g}, allowed {allowed:.3g}" if finding.said is None else str(finding.said[i])
    return (query.case if finding.case is None else finding.case).row(i), said, measured, allowed
