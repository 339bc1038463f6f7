"""A check put to one case: the row that violates it most."""

from __future__ import annotations

import numpy as np

from duhem.testing.checks.query import UNMEASURED, NothingToCheck, Query
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
    counts = counts & query.measurable
    if not counts.any():
        raise NothingToCheck(UNMEASURED)
    boundless = counts & ~np.isfinite(finding.allowed) & (not asked.law_only)
    if boundless.any():
        stress = query.here.stress
        with np.errstate(all="ignore"):
            boundless &= np.isfinite(stress).all(axis=1) & ~np.isfinite(query.length(stress))
    bad = (finding.violated & counts) | boundless
    if not bad.any():
        return None
    with np.errstate(all="ignore"):
        excess = np.where(bad, np.nan_to_num(finding.measured - finding.allowed, nan=np.inf, posinf=1e300), -np.inf)
    i = int(np.argmax(excess))
    measured, allowed = float(finding.measured[i]), float(finding.allowed[i])
    if boundless[i]:
        return query.case.row(i), "the stress returned is so large that its square overflows", measured, allowed
    said = f"measured {measured:.3g}, allowed {allowed:.3g}" if finding.said is None else str(finding.said[i])
    return (query.case if finding.case is None else finding.case).row(i), said, measured, allowed
