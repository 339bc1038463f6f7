"""What is asked of a run as a whole: that it visited something, that its routine keeps nothing between calls and spoils nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from duhem.projection.result import Array
from duhem.testing.checks.query import Query
from duhem.testing.checks.registry import Finding, register
from duhem.testing.checks.visited import Visited

__all__: list[str] = []


_LEAST = 0.01  # of the increments without a law, whose sizes are drawn by what the routine itself shows
_MOST = 0.75  # of the increments that slip: who gives up more has shown what is left, not the rule
_ALONE = 3  # cases, in one of which a row is asked in a call of its own
_APART = 5  # cases, in one of which some rows are asked in calls of one size, one after the other
_CROWD, _MANY = 5, 300  # the case of a run in which some rows are asked so often in one call: more than the 256 of a block


def _visited(visited: Visited) -> str | None:
    shares = visited.shares
    found = visited.searched
    if raised := [said for said in found if said not in ("range", "none")]:
        return f"the search for the elastic range failed: {raised[0]}"
    least = 0.0 if visited.forces else _LEAST
    missing = [name for name in ("slip", "stick")[: 1 if visited.creeps else 2] if shares and shares[name] <= least]
    if not missing:
        given_up = f"{visited.given_up:.2%} of the slipping increments are flagged as not solved, and therefore not tested"
        unknown = "no elastic range was found, so that the size of the increments says nothing of the routine (in Python: scale=STRAIN)"
        return given_up if visited.given_up > _MOST else unknown if found and not found["range"] else None
    few = f"only {shares[missing[0]]:.2g} of them " if shares[missing[0]] else "nothing "
    what = few + {"slip": "slipped", "stick": "stuck"}[missing[0]]
    seen = ", ".join(f"{name} {share:.3g}" for name, share in shares.items())
    return f"{what} in {visited.increments} increments; visited: {seen}"


@register(
    statement="the run contains increments that stick and increments that slip, and the routine solves most of those that slip",
    formula="sigma_tr in K(sigma_n) for some, and not for others",
    source="if nothing slips, a test passes for any routine",
    tolerance="flagged increments do not count; at most three in four of the slipping increments may be flagged",
    whole=_visited,
)
def vacuity(q: Query) -> Finding:
    none = np.zeros(len(q.here.trial))
    return Finding(none, none)


@register(
    statement="the same increment has the same answer, alone, together with others, and after others",
    formula="P(sigma_tr) = P(sigma_tr)",
    source="state that is kept between calls or shared between rows makes an answer depend on the order of the calls",
    tolerance="2 u",
    again=True,
)
def repeatability(q: Query) -> Finding:
    return compared(q, q.here.stress, q.again.stress, 2.0 * q.unit(q.here), _asked_otherwise(q))


def _asked_otherwise(q: Query) -> Iterator[tuple[Array, str]]:
    """Yield further answers to the trial, each with words on how it was asked."""
    if q.by_turns(_APART):
        _, close, *trials, _, last = q.apart
        here = q.here
        sticks = q.region.surely_inside(close.trial, q.pressure) & (q.length(here.stress - here.trial) <= q.unit(here))
        yield here.stress + np.where(sticks[:, None], close.stress - close.trial, 0.0), " of a trial stress close by, which sticks as well"
        for found in (*trials, last):
            yield found.stress, " when asked in calls of one size, one after the other"
    if q.turn == _CROWD and len(q.case) > 1:  # copies of one increment do not tell one row from another
        crowd = q.ask(*[q.case.trial] * -(-_MANY // len(q.case)))
        for found in crowd:
            yield found.stress, f" when asked in a call of {len(crowd) * len(q.case)} increments"


def compared(q: Query, here: Array, again: Array, allowed: Array, otherwise: Iterable[tuple[Array, str]] = ()) -> Finding:
    """The stresses answered to the trial, and those when asked again and ``otherwise``; of one row that asked alone too."""
    apart, how = q.length(_apart(again, here)), np.full(len(here), "", dtype=object)
    if q.by_turns(_ALONE):
        row, alone = q.alone
        at = slice(row, row + 1)
        if isinstance(alone, str):
            apart[row], how[row], otherwise = np.inf, f"; asked as one increment alone, {alone}", ()
        elif not (off := q.length(_apart(alone.stress, here[at]))[0]) <= apart[row]:
            apart[row], how[row] = off, " between the answer among others and that to the increment alone"
    for stress, asked in otherwise:
        farther = q.length(_apart(stress, here))
        worse = ~(farther <= apart)
        apart, how = np.where(worse, farther, apart), np.where(worse, asked, how)
    said = [f"measured {x:.3g}, allowed {most:.3g}{more}" for x, most, more in zip(apart, allowed, how, strict=True)]
    return Finding(apart, allowed, np.array(said, dtype=object))


def _apart(one: Array, other: Array) -> Array:
    """Return their difference, 0 where neither is finite: a nan twice is the same answer."""
    return np.where(~np.isfinite(one) & ~np.isfinite(other), 0.0, one - other)


@register(
    statement="the routine does not change its inputs and its earlier answers, and writes to no other memory",
    formula="sigma_tr, sigma_n and k after the call are those before it, and so are the answers to the calls before",
    source="the caller uses the trial stress, the pressure and the stiffness again, and keeps one answer during the next call",
    tolerance="none: to the last bit; of C and Fortran, all arguments that are not returned, and 64 bytes either side of each array; "
    "an answer may be the array that was given",
)
def inputs(q: Query) -> Finding:
    none = np.zeros(len(q.here.trial))
    if q.some.by_turns(_APART):
        _ = q.some.apart
    return Finding((q.overwritten != "").astype(np.float64), none, "overwritten: " + q.overwritten)
