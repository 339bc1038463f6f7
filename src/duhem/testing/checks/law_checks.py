"""What K itself must be, whatever routine is used.  Exact: a violation is confirmed in 60 digits, so nothing is allowed for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from duhem.expression.jets import Choices
from duhem.expression.rays import evenly_between
from duhem.projection.result import Array
from duhem.testing.checks.dents import Dents
from duhem.testing.checks.query import NothingToCheck, Query
from duhem.testing.checks.registry import Finding, register

__all__: list[str] = []

_EPS = float(np.finfo(np.float64).eps)
_PARTS = 16  # of the way to a seam, looked at in one round


@register(
    "origin",
    statement="the stress-free state is admissible",
    formula="0 in K(sigma_n)",
    source="Antoni et al. (2007), Eqs. 27, 28: Phi* least at 0",
    tolerance="none: 60 digits",
    law_only=True,
)
def origin(q: Query) -> Finding:
    zero = np.zeros_like(q.case.trial)
    out = q.certainly(~q.region.surely_inside(zero, q.pressure), zero, outside=True)
    return Finding(out.astype(np.float64), np.zeros(len(zero)), unknown=q.region.unknown(zero, q.pressure))


@register(
    "convexity",
    statement="the middle of two stresses of K lies in K",
    formula="p, q in K(sigma_n) => (p + q)/2 in K(sigma_n)",
    source="Antoni et al. (2007), Eq. 34; Rockafellar (1970), section 2",
    tolerance="none: p, q and their middle are judged in 60 digits (the middle of two doubles, rounded once, within 4 eps of |p| + |q|; "
    "of two boundary points, moved by 1e-12 of its way to a stress inside)",
    law_only=True,
    needs="a stress that surely lies inside K, where none is known",
)
def convexity(q: Query) -> Finding:
    p, other = q.case.inside, q.case.beside
    shrink = 1.0 - 4.0 * _EPS
    middle = 0.5 * (p + other) * shrink  # in K with p, q and 0, and farther inside than its rounding
    found = q.certainly(~(q.region.level(middle, q.pressure) <= 0.0), middle, outside=True)
    for end in (p, other, np.zeros_like(p)):
        found = q.certainly(found, end, outside=False)
    dents = Dents(q)
    tried = {"pairs of stresses": len(p)} | ({"pairs of boundary points": dents.pairs} if p.shape[1] > 1 else {})
    if pairs := dents.deepest():
        rows = list(pairs)
        p, other = p.copy(), other.copy()
        p[rows], other[rows] = (np.array(each) for each in zip(*pairs.values(), strict=True))
        found[rows] = True
    told = np.array([_told(*pair) if bad else "" for bad, *pair in zip(found, p, other, strict=True)], dtype=object)
    shown = replace(q.case, inside=p, beside=other) if pairs else None
    return Finding(found * q.length(p - other), np.zeros(len(p)), told, tried=tried, case=shown)


def _told(first: Array, last: Array) -> str:
    one, other, middle = (f"[{', '.join(f'{x:.6g}' for x in each)}]" for each in (first, last, 0.5 * (first + last)))
    return f"{one} and {other} lie in K, and their middle {middle} does not"


@register(
    "smoothness",
    statement="the boundary has one normal at a seam, whichever side it is taken from",
    formula="n from the left = n from the right, where the piece of g changes",
    source="theory of gauges: gamma' continuous across seams (Antoni et al. 2007, Eq. 35)",
    tolerance="64 eps + what the normal of either piece turns over 16 eps, which is how far the point may lie off the seam",
    law_only=True,
    demanded=False,
)
def smoothness(q: Query) -> Finding:
    if q.case.trial.shape[1] < 2:
        raise NothingToCheck("in one dimension the boundary is two points")
    first, last = _directed(q.case.inside), _directed(q.case.beside)
    rows = np.arange(len(first))
    low, high = np.zeros(len(first)), np.ones(len(first))

    def towards(share: Array, who: NDArray[np.intp] = rows) -> Array:
        return np.asarray((1.0 - share)[:, None] * first[who] + share[:, None] * last[who])

    def at(share: Array, who: NDArray[np.intp] = rows) -> Array:
        way = towards(share, who)
        reach = q.region.reach(way, q.pressure[who])
        return np.where(np.isfinite(reach), reach, 1.0)[:, None] * way

    _, here = q.region.slope(at(low), q.pressure)
    _, there = q.region.slope(at(high), q.pressure)
    apart = (here != there).any(axis=1)
    if not apart.any():
        return Finding(np.zeros(len(first)), np.zeros(len(first)))
    while ((np.nextafter(low, 1.0) < high) & apart).any():  # in some 16 rounds down to neighbouring numbers, denormal ones too
        between = evenly_between(low, high, _PARTS)
        who = np.repeat(rows, between.shape[1])
        pieces = q.region.slope(at(between.ravel(), who), q.pressure[who])[1].reshape(*between.shape, -1)
        other = np.column_stack([(pieces != here[:, None]).any(axis=2), np.ones(len(rows), dtype=np.bool_)])
        met, ends = np.argmax(other, axis=1), np.column_stack([low, between, high])  # the first that is of another piece
        there = np.concatenate([pieces, there[:, None]], axis=1)[rows, met]
        low, high = ends[rows, met], ends[rows, met + 1]
    seam = at(low)
    blur = 16.0 * _EPS * np.linalg.norm(seam, axis=1) / np.maximum(np.linalg.norm(towards(low), axis=1), _EPS)
    beside = seam + blur[:, None] * _directed(last - first)

    def normal(point: Array, piece: Choices) -> Array:
        return _directed(q.region.slope(point, q.pressure, choices=piece)[0])

    jump = np.linalg.norm(normal(seam, here) - normal(seam, there), axis=1)
    turn = np.maximum(*(np.linalg.norm(normal(seam, side) - normal(beside, side), axis=1) for side in (here, there)))
    whole = (np.abs(seam).max(axis=1) > 0.0) & apart & np.isfinite(jump) & np.isfinite(turn)
    return Finding(np.where(whole, jump, 0.0), 64.0 * _EPS + np.where(whole, turn, 0.0))


def _directed(vectors: Array) -> Array:
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    with np.errstate(all="ignore"):
        return np.where(size > 0.0, vectors / size, vectors)
