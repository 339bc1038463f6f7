"""Implicit steps through numba, for the shapes a law declares: whole stretches of paths without a word of Python in between.

One loop takes points from knot to knot abreast, so that the compiled kernel of the quarter ellipses sees rows of them; points with
numbers of their own ask for their closest points one by one.  The sums are those of :mod:`duhem.path.step_formulas`; the closest points
differ from NumPy's in the last digits.
"""

from __future__ import annotations

import hashlib
import inspect
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

import numpy as np

from duhem.path import step_formulas
from duhem.path.step_formulas import FORMULAS, written
from duhem.projection import compiled, one_point, quadrants, quarter_ellipse
from duhem.projection.compiled import kernels
from duhem.projection.kept_code import compiled_text
from duhem.projection.quarter_ellipse import formulas
from duhem.projection.result import Status

__all__ = ["Loops", "loops", "made"]

_ROW = 504  # points abreast: as many as the kernel looks at together
_STICK, _SLIP, _FAILED = int(Status.STICK), int(Status.SLIP), int(Status.FAILED)


@dataclass(frozen=True)
class Loops:
    """``abreast`` for points of one law on quarter ellipses, ``quarters`` and ``interval`` for points with constants of their own.

    Arguments: ``values`` (n, m, d) and ``factor`` (n, 1, d), whose product is the displacement; ``load``, ``share`` (n, m) and
    ``centre`` (n, m, d) of K, with one row or column where all are alike; stiffness and compliance (2, 2).  ``state`` (n, 14), of one
    force with zeros for the second: stress, slip, stress and displacement from which nothing has slipped, then multiplier, psi,
    dissipation, work, numerical loss and balance; ``status``, ``reached`` (n,).  The constants of the shapes and which of them each
    point has.  The first knot and the one not to reach any more; ``row`` (m,) of each knot in what is kept, -1 for none; and what is
    kept: stress and slip (n, r, d) and the six sums (n, r), nan for points that have failed.  States and what is kept are written to.
    """

    abreast: Callable[..., None]
    quarters: Callable[..., None]
    interval: Callable[..., None]


_KEPT = """\
# {stamp}
from duhem.path.compiled_run import made

inner = made().{name}


def run({names}):
    inner({names})
"""
_NAMES = "values, factor, load, share, centre, k, c, state, status, reached, shape, members, first, last, row, stress, slip, sums"


@cache
def loops() -> Loops:
    """The compiled loops: compiled at their first use (tens of seconds), then kept on disk; MissingExtraError without numba.

    What is kept belongs to the text of the modules that it was made of.
    """
    texts = map(inspect.getsource, (sys.modules[__name__], step_formulas, compiled, one_point, quadrants, quarter_ellipse))
    stamp = hashlib.sha256("".join(texts).encode()).hexdigest()
    return Loops(*(compiled_text(_KEPT.format(stamp=stamp, name=field.name, names=_NAMES), "run") for field in fields(Loops)))


@cache
def made() -> Loops:
    """The loops, made anew in each process: what is kept of them calls these."""
    import numba

    jit: Callable[[Any], Any] = numba.njit(error_model="numpy", forceinline=True)
    free: Callable[[Any], Any] = numba.njit(error_model="numpy", nogil=True)
    run, single = kernels()

    @jit
    def where(condition: bool, a: float, b: float) -> float:
        return a if condition else b

    product = formulas(jit, where).product
    drawn, made_of, left = (jit(written(FORMULAS[name], 2)) for name in ("pulled", "booked", "balance"))

    @jit
    def taken(array: Any, begin: int, size: int, knot: int, s: Any, row: int) -> None:
        """A number a point of an array (n, m) with one row or column where all are alike, into a row of ``s``."""
        column = knot if array.shape[1] > 1 else 0
        if array.shape[0] > 1:
            for j in range(size):
                s[row, j] = array[begin + j, column]
        else:
            alike = array[0, column]
            for j in range(size):
                s[row, j] = alike

    @jit
    def placed(array: Any, begin: int, size: int, knot: int, s: Any, row: int) -> None:
        """The numbers of a point of an array (n, m, d) likewise, for d = 1 a zero in the second row."""
        column, two = knot if array.shape[1] > 1 else 0, array.shape[2] > 1
        if array.shape[0] > 1:
            for j in range(size):
                s[row, j], s[row + 1, j] = array[begin + j, column, 0], array[begin + j, column, 1] if two else 0.0
        else:
            a, b = array[0, column, 0], array[0, column, 1] if two else 0.0
            for j in range(size):
                s[row, j], s[row + 1, j] = a, b

    @jit
    def pulled(s: Any, k: Any, size: int, moved: bool, trial: Any) -> None:
        """The displacements in rows 16 and 17, the trial stresses, and those about the centre."""
        stiffness = (k[0, 0], k[0, 1]), (k[1, 0], k[1, 1])
        for j in range(size):
            s[16, j], s[17, j] = s[16, j] * s[26, j], s[17, j] * s[27, j]
            s[18, j], s[19, j] = drawn((s[4, j], s[5, j]), (s[16, j], s[17, j]), (s[6, j], s[7, j]), stiffness)
        for j in range(size):
            trial[2 * j], trial[2 * j + 1] = s[18, j], s[19, j]
        if moved:
            for j in range(size):
                trial[2 * j] -= s[23, j]
                trial[2 * j + 1] -= s[24, j]

    @jit
    def booked(s: Any, k: Any, c: Any, size: int, moved: bool, stress: Any, slip: Any, lam: Any) -> None:
        """What the step adds.  Rows of ``s``: 0 stress, 2 slip, 4 and 6 anchor, 8 the six sums, 14 on its way, 15 slips, 20 where it was,
        22 steps, 23 centre, 25 the share of the multiplier, 26 the factor of the displacement."""
        stiffness, compliance = ((k[0, 0], k[0, 1]), (k[1, 0], k[1, 1])), ((c[0, 0], c[0, 1]), (c[1, 0], c[1, 1]))
        if moved:
            for j in range(size):
                stress[2 * j] += s[23, j]
                stress[2 * j + 1] += s[24, j]
        for j in range(size):
            p1, p2, multiplier = slip[2 * j], slip[2 * j + 1], lam[j] * s[25, j]
            slips = (p1 != 0.0) | (p2 != 0.0) | (multiplier > 0.0)
            b1, b2, u1, u2, before = s[0, j], s[1, j], s[16, j], s[17, j], s[9, j]
            trial, near = (s[18, j], s[19, j]), (stress[2 * j], stress[2 * j + 1])
            way = (u1, u2), (s[20, j], s[21, j])
            (t1, t2), psi, added = made_of((b1, b2), trial, near, (p1, p2), multiplier, slips, way[0], way[1], stiffness, compliance)
            balance = s[13, j] + left(before, psi, added)
            q1, q2, multiplier = s[2, j] + p1, s[3, j] + p2, s[8, j] + multiplier
            lost, work, numerical = s[10, j] + added[1], s[11, j] + added[2], s[12, j] + added[3]
            states = (t1 * 0.0 + t2 * 0.0) + (q1 * 0.0 + q2 * 0.0)
            whole = (states + (multiplier * 0.0 + psi * 0.0)) + ((lost * 0.0 + work * 0.0) + (numerical * 0.0 + balance * 0.0))
            go = (s[14, j] > 0.0) & (whole == 0.0)
            released = go & slips
            s[4, j], s[5, j] = where(released, t1, s[4, j]), where(released, t2, s[5, j])
            s[6, j], s[7, j] = where(released, u1, s[6, j]), where(released, u2, s[7, j])
            s[0, j], s[1, j] = where(go, t1, b1), where(go, t2, b2)
            s[2, j], s[3, j] = where(go, q1, s[2, j]), where(go, q2, s[3, j])
            s[8, j], s[9, j] = where(go, multiplier, s[8, j]), where(go, psi, before)
            s[10, j], s[11, j] = where(go, lost, s[10, j]), where(go, work, s[11, j])
            s[12, j], s[13, j] = where(go, numerical, s[12, j]), where(go, balance, s[13, j])
            on = where(go, 1.0, 0.0)
            s[14, j], s[15, j], s[22, j] = on, where(slips, 1.0, 0.0), s[22, j] + on
            s[20, j], s[21, j] = u1, u2

    @jit
    def together(quarters: Any, members: Any, begin: int, trial: Any, load: Any, stress: Any, slip: Any, lam: Any) -> None:
        mu, axes, low, ratio, compliance, power, place = quarters
        run(trial, load, mu, axes, low, ratio, compliance, power, place, stress, slip, lam)

    @jit
    def each(quarters: Any, members: Any, begin: int, trial: Any, load: Any, stress: Any, slip: Any, lam: Any) -> None:
        mu, axes, low, ratio, compliance, power, place = quarters
        for j in range(len(load)):
            o = slice(4 * members[begin + j], 4 * members[begin + j] + 4)
            single(j, trial, load, mu[o], axes[o], low[o], ratio[o], compliance[o], power[o], place[o], stress, slip, lam)

    @jit
    def clamped(intervals: Any, members: Any, begin: int, trial: Any, load: Any, stress: Any, slip: Any, lam: Any) -> None:
        """As :func:`duhem.projection.quadrants.clamped`."""
        mu, k = intervals
        for j in range(len(load)):
            t, e = trial[j, 0], load[j]
            m = mu[members[begin + j], 1 if t < 0.0 else 0]
            size = abs(t)
            scale = math.frexp(max(size, e))[1]
            limit, low = product(m, math.ldexp(e, -scale))
            excess = (math.ldexp(size, -scale) - limit) - low
            stress[j, 0], slip[j, 0], lam[j] = t, 0.0, 0.0
            stress[j, 1], slip[j, 1] = 0.0, 0.0
            if excess > 0.0 or excess != excess:
                length = math.ldexp(excess, scale) / k
                stress[j, 0], slip[j, 0], lam[j] = math.copysign(m * e, t), math.copysign(length, t), m * length

    def loop(closest: Any) -> Callable[..., None]:
        @free
        def along(
            values: Any, factor: Any, load: Any, share: Any, centre: Any, k: Any, c: Any, state: Any, status: Any, reached: Any,
            shape: Any, members: Any, first: int, last: int, row: Any, stress: Any, slip: Any, sums: Any,
        ) -> None:  # fmt: skip
            n, moved = state.shape[0], bool(np.any(centre != 0.0))
            multiplier, psi, dissipation, work, numerical, balance = sums
            wide = min(_ROW, n)
            s, lengths, loads = np.empty((28, wide)), np.empty(wide), np.empty((1, wide))
            trials, nears, slips = np.empty((wide, 2)), np.empty((wide, 2)), np.empty((wide, 2))
            for begin in range(0, n, wide):
                size = min(wide, n - begin)
                trial, near, gone, lam, e = trials[:size], nears[:size], slips[:size], lengths[:size], loads[0, :size]
                flat_trial, flat_near, flat_gone = trial.reshape(-1), near.reshape(-1), gone.reshape(-1)
                for j in range(size):
                    for i in range(14):
                        s[i, j] = state[begin + j, i]
                    s[14, j], s[15, j], s[22, j] = 1.0, 0.0, 0.0
                placed(factor, begin, size, 0, s, 26)
                placed(values, begin, size, first - 1, s, 20)
                for j in range(size):
                    s[20, j], s[21, j] = s[20, j] * s[26, j], s[21, j] * s[27, j]
                for knot in range(first, last):
                    placed(values, begin, size, knot, s, 16)
                    taken(load, begin, size, knot, loads, 0)
                    if moved:
                        placed(centre, begin, size, knot, s, 23)
                    pulled(s, k, size, moved, flat_trial)
                    closest(shape, members, begin, trial, e, near, gone, lam)
                    taken(share, begin, size, knot, s, 25)
                    booked(s, k, c, size, moved, flat_near, flat_gone, lam)
                    r = row[knot]
                    if r >= 0:
                        for j in range(size):
                            at, ok = begin + j, s[14, j] > 0.0
                            for i in range(stress.shape[2]):
                                stress[at, r, i], slip[at, r, i] = s[i, j] if ok else np.nan, s[2 + i, j] if ok else np.nan
                            multiplier[at, r], psi[at, r] = s[8, j] if ok else np.nan, s[9, j] if ok else np.nan
                            dissipation[at, r], work[at, r] = s[10, j] if ok else np.nan, s[11, j] if ok else np.nan
                            numerical[at, r], balance[at, r] = s[12, j] if ok else np.nan, s[13, j] if ok else np.nan
                            s[13, j] = 0.0
                for j in range(size):
                    reached[begin + j] += np.int64(s[22, j])
                    status[begin + j] = (_SLIP if s[15, j] > 0.0 else _STICK) if s[14, j] > 0.0 else _FAILED
                    for i in range(14):
                        state[begin + j, i] = s[i, j]

        return along

    return Loops(loop(together), loop(each), loop(clamped))
