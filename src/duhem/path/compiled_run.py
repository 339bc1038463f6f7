"""Compiled implicit steps: loops for declared shapes and for any other law, and how points and paths are taken through them.

On a declared shape one path is a share of one point.  Any other law's own loop takes long stretches, which are then judged together:
what the loop leaves, and what the judge does not take as it is, is one step of the search, from which the loop goes on.  Steps do not
depend on where a stretch begins.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.shapes import Interval
from duhem.path import step_formulas
from duhem.path.closest import LOST, ClosestPoints, ShapeNumbers, shape_by
from duhem.path.history import SUMS, Histories
from duhem.path.integrators import STEPS, stretch
from duhem.path.loading import Paths, Which
from duhem.path.rows import Ledger, States
from duhem.path.run import Plan, Share, columns
from duhem.path.step_formulas import FORMULAS, booked, written
from duhem.projection import compiled, quadrants, quarter_ellipse
from duhem.projection.compiled import kept_function, kernels
from duhem.projection.compiled_newton import Loop
from duhem.projection.increment import Convexity, Increment, beyond
from duhem.projection.newton_kernel import KINKS, LEFT, SLIP, solved
from duhem.projection.newton_step import DATA, MATRICES, ROWS, D
from duhem.projection.projector import Projector
from duhem.projection.quadrants import Quarters, stacked
from duhem.projection.quarter_ellipse import formulas
from duhem.projection.result import Array, Projection, Solution, Status

__all__ = ["Loops", "advance", "fill", "looped", "loops", "made", "reason"]

# -- the loops of declared shapes: whole stretches of paths without a word of Python in between -------------------------
# One loop takes points from knot to knot abreast, so that the compiled kernel of the quarter ellipses sees rows of them; points with
# numbers of their own ask for their closest points one by one.  The sums are those of :mod:`duhem.path.step_formulas`; the closest points
# differ from NumPy's in the last digits.

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


_NAMES = "values, factor, load, share, centre, k, c, state, status, reached, shape, members, first, last, row, stress, slip, sums"


@cache
def loops() -> Loops:
    """The compiled loops: compiled at their first use (tens of seconds), then kept on disk; MissingExtraError without numba."""
    made_of = sys.modules[__name__], step_formulas, compiled, quadrants, quarter_ellipse
    return Loops(*(kept_function(__name__, f"made().{field.name}", _NAMES, made_of) for field in fields(Loops)))


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
        taken(array[:, :, 0], begin, size, knot, s, row)
        if array.shape[2] > 1:
            taken(array[:, :, 1], begin, size, knot, s, row + 1)
        else:
            s[row + 1, :size] = 0.0

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
            wide = min(_ROW, n)  # the length of a row of s is a constant, so that the compiler uses vector instructions
            s, lengths, loads = np.empty((28, _ROW)), np.empty(wide), np.empty((1, wide))
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


# -- these put to use ---------------------------------------------------------------------------------------------------

_STEPS = 65_536  # of one path without looking up, so that it can be interrupted
_FEW = 64  # steps after one that the loop did not take


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """As the implicit integrator's, in long stretches.  InputError for what has no compiled loop."""
    share = Share.alone(plan)
    shape = shape_by(share, plan.projection)
    return _by_loop(plan, ledger) if shape is None else _by_shape(plan, ledger, share, shape)


def _missing(why: str) -> InputError:
    return InputError(f"a compiled path is not possible: {why}", where="compiled", remedy="leave compiled out")


# -- declared shapes -----------------------------------------------------------------------------------------------------


def reason(share: Share, shape: ShapeNumbers) -> str | None:
    """None where the compiled loops apply to a declared shape, else why not."""
    law = share.members[0].law
    if not isinstance(law.closed_form, Interval) and not shape.coefficients.all():
        return "K is flat in a quadrant"
    if any(force in law.domain for force in law.forces):
        return "the law declares a range of stresses"
    return None


def fill(share: Share, shape: ShapeNumbers, out: Histories) -> None:
    """The histories of a share of many points."""
    states, m = States.begun(share), len(share.paths.time)
    row = np.full(m, -1, dtype=np.intp)
    row[out.knots] = np.arange(len(out.knots))
    states.keep(out, slice(None), 0)
    vectors = states.stress, states.slip, states.anchor_stress, states.anchor
    state = np.concatenate([*map(_two, vectors), *(getattr(states, name)[:, None] for name in SUMS)], axis=1)
    _run(share, shape, state, (states.status, states.reached), (1, m), row, out)
    out.status[:], out.reached[:] = states.status, states.reached


def _by_shape(plan: Plan, ledger: Ledger, share: Share, shape: ShapeNumbers) -> Iterator[int]:
    """One path on a declared shape, as a share of one point whose table is the ledger."""
    if (why := reason(share, shape)) is not None:
        raise _missing(why)
    m, i, anchor = len(plan.path.time), ledger.done - 1, ledger.anchor
    vectors = ledger.stress[i], ledger.slip[i], ledger.stress[anchor], plan.path.values[anchor]
    sums = [0.0 if name == "balance" else getattr(ledger, name)[i] for name in SUMS]
    state = np.concatenate([*map(_two, vectors), sums])[None]
    ends = np.full(1, int(Status.STICK), dtype=np.int8), np.full(1, i, dtype=np.intp)
    table = replace(ledger, **{name: getattr(ledger, name)[None] for name in ("stress", "slip", *SUMS)})
    while ledger.done < m and ends[0][0] != Status.FAILED:
        first, last = ledger.done, min(ledger.done + _STEPS, m)
        _run(share, shape, state, ends, (first, last), np.arange(m), table)
        ledger.done = last
        yield last


def _two(array: Array) -> Array:
    """An array (..., d) of d <= 2 components, with zeros for the second where there is one."""
    return array if array.shape[-1] == 2 else np.concatenate([array, np.zeros_like(array)], axis=-1)


def _run(share: Share, shape: ShapeNumbers, state: Array, ends: tuple[Any, Any], knots: tuple[int, int], row: Any, out: Any) -> None:
    paths, member, d = share.paths, share.members[0], share.paths.values.shape[2]
    k, c = np.zeros((2, 2)), np.zeros((2, 2))
    k[:d, :d], c[:d, :d] = member.stiffness, share.compliance
    along = paths.values, paths.factor[:, None], shape.load, shape.share, shape.centre
    driven = *map(np.ascontiguousarray, along), k, c, state, *ends
    kept = share.own, *knots, row, out.stress, out.slip, tuple(getattr(out, name) for name in SUMS)
    made = loops()
    if isinstance(member.law.closed_form, Interval):
        made.interval(*driven, (np.ascontiguousarray(shape.coefficients), float(k[0, 0])), *kept)
        return
    q = stacked([Quarters.of(mu, member.stiffness) for mu in shape.coefficients.tolist()])
    quarters = tuple(map(np.ascontiguousarray, (q.mu, q.axes, q.axes_low, q.ratio, q.compliance, q.power, q.first)))
    alike = len(share.members) == 1 and len(share) > 1 and q.diagonal
    (made.abreast if alike else made.quarters)(*driven, quarters, *kept)


# -- any other law -------------------------------------------------------------------------------------------------------


def _loop(member: Increment, projection: str) -> tuple[Projector, Loop] | str:
    """The judge of a law with numbers in place and the loop that is made for it, or in words why there is none."""
    prepared = Projector.of(member.law, member.stiffness, member.parameters, projection)
    if prepared.method.name != "newton":
        return f"projection by {prepared.method.name} has none"
    loop = Loop.of(prepared.setting, "along", sys.modules[__name__])
    return "a function in the formula has no derivative in compiled form" if loop is None else (prepared, loop)


def looped(share: Share, projection: str, out: Histories) -> Which | None:
    """The histories of the points whose paths the loop of their law takes to the end, and which others are left; None without a loop."""
    paths, m, left = share.paths, len(share.paths.time), np.ones(len(share), dtype=np.bool_)
    for i, member in enumerate(share.members):
        if isinstance(made := _loop(member, projection), str):
            return None
        mine, each = np.flatnonzero(share.own == i), max(1, _STEPS // m)
        for some in (mine[first : first + each] for first in range(0, len(mine), each)):
            stress, u = share.stress[some], paths.at(0, some)
            found, taken = _taken(*made, member.convexity, paths, some, (stress, u), (1, m))
            whole = np.flatnonzero(taken == m - 1)
            if not whole.size:
                continue
            rows = whole[:, None] * (m - 1) + np.arange(m - 1)
            ledger = Ledger.begun(m, u[whole], stress[whole], share.compliance)
            along = paths.at(np.tile(np.arange(m), len(whole)), np.repeat(some[whole], m))
            _book(ledger, member.stiffness, stress[whole], along.reshape(len(whole), m, -1), found, rows)
            sound = ledger.sound().all(axis=1) & ~beyond(member.law, found.stress).reshape(-1, m - 1)[whole].any(axis=1)
            ledger.keep(out, some[whole])
            left[some[whole[sound]]] = False
    return np.flatnonzero(left)


def _by_loop(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """One path by the loop that is made for its law."""
    if isinstance(made := _loop(plan.increment, plan.projection), str):
        raise _missing(made)
    paths, one, both = Share.alone(plan).paths, np.zeros(1, dtype=np.intp), None
    values, m = plan.path.values, len(plan.path.values)
    anchor, ahead = ledger.anchor, _STEPS
    while ledger.done < m:
        first, last = ledger.done, min(ledger.done + ahead, m)
        begun = ledger.stress[anchor : anchor + 1], values[anchor : anchor + 1]
        found, taken = _taken(*made, plan.increment.convexity, paths, one, begun, (first, last))
        if n := int(taken[0]):
            slips = _book(ledger, plan.stiffness, ledger.stress[first - 1], values[first - 1 : first + n], found, np.arange(n))
            anchor = first + int(np.flatnonzero(slips)[-1]) if slips.any() else anchor
        ahead = min(2 * ahead, _STEPS)
        if not n:  # one step by the search, which ends the run if it finds nothing
            both = both or STEPS["implicit"].steps(plan)
            anchor, ahead = first if stretch(plan, ledger, both, anchor, 1) else anchor, _FEW
        yield ledger.done


def _book(ledger: Ledger, k: Array, stress: Array, values: Array, found: ClosestPoints, rows: Which) -> NDArray[np.bool_]:
    """Put what was found at ``rows`` (..., m) into the ledger, from the stress and along the m + 1 displacements; which of them slip."""
    slips, near = found.slips()[rows], found.stress[rows]
    before, trial = columns(np.concatenate([stress[..., None, :], near[..., :-1, :]], axis=-2)), columns(near)
    slip, multiplier = columns(found.slip[rows]), found.multiplier[rows].ravel()
    end, begin, matrices = columns(values[..., 1:, :]), columns(values[..., :-1, :]), (k[:, :, None], ledger.compliance[:, :, None])
    _, _, added = booked(before, trial, trial, slip, multiplier, slips.ravel(), end, begin, *matrices)
    ledger.rows(near, found.slip[rows], np.reshape(added, (4, *slips.shape)))
    return slips


def _taken(
    prepared: Projector, loop: Loop, known: Convexity | None, paths: Paths, which: Which, begun: tuple[Array, Array], knots: tuple[int, int]
) -> tuple[ClosestPoints, Which]:
    """What the loop finds of points from the first of ``knots`` to before the last, from where they last slipped, point by point.

    How many knots of each the judge takes as they are; nothing slips where it sticks.
    """
    n, m = len(which), knots[1] - knots[0]
    every, point = np.tile(np.arange(*knots), n), np.repeat(which, m)
    values, pressure = paths.at(every, point), paths.pressure_at(every, point)
    trial, stress, slip = (np.empty_like(values) for _ in range(3))
    multiplier, state = np.empty(n * m), np.empty(n * m, dtype=np.int8)
    k, data = np.array(prepared.setting.stiffness, order="C"), loop.data(pressure)
    for i in range(n):
        own = slice(i * m, (i + 1) * m)
        given = values[own], k, begun[0][i].copy(), begun[1][i].copy(), data[own], loop.constants, loop.root, loop.inverse
        loop.run(*given, loop.formula.degree, trial[own], stress[own], slip[own], multiplier[own], state[own])
    seen = np.flatnonzero(state != LEFT)
    solution = Solution(stress[seen], slip[seen] / loop.mean, multiplier[seen] / loop.mean, np.zeros(len(seen), dtype=np.bool_))
    judged = _judged(prepared, known, solution, trial[seen], pressure[seen])
    found = ClosestPoints(stress, slip, multiplier, state)
    found.stress[seen], found.slip[seen], found.multiplier[seen] = judged.stress, judged.slip, judged.multiplier
    good = np.zeros((n, m), dtype=np.bool_)
    same = (judged.stress == solution.stress).all(axis=1) & (found.slips()[seen] == (state[seen] == SLIP))
    good.reshape(-1)[seen] = same & ~np.isin(judged.status, LOST)
    return found, np.where(good.all(axis=1), m, np.argmin(good, axis=1))


def _judged(prepared: Projector, known: Convexity | None, solution: Solution, trial: Array, pressure: Array) -> Projection:
    """The solution as any other answer of the method."""
    question = replace(prepared.setting, trial=trial, pressure=pressure, convexity=known)
    given = replace(prepared.method, solve=lambda asked, options: solution, again=None)
    return replace(prepared, method=given).at(question, compiled=True, threads=1)


# -- compiled from here, with the law's functions and the sources of its loop ------------------------------------------------


def along(
    values: Any, stiffness: Any, stress_anchor: Any, anchor: Any, data: Any, constants: Any, root: Any, inverse: Any, degree: float,
    trial: Any, stress: Any, slip: Any, multiplier: Any, state: Any,
) -> None:  # fmt: skip
    """The closest points along the displacements ``values`` (n, D), from the stress and displacement that last slipped.

    Trial stresses and what is found are written, up to the first that is left: its state and those after it are LEFT.  Slips and
    multipliers are those of a stiffness of mean 1.  Both anchors (D,) are moved.
    """
    v, m, a = np.empty((ROWS, D)), np.empty((MATRICES, D, D)), np.empty((2 * D, 2 * D + 1))
    q = np.empty(DATA + len(constants))
    for k in range(len(constants)):
        q[DATA + k] = constants[k]
    held = np.empty((D + 1, KINKS), np.int8)
    for n in range(len(state)):
        state[n] = LEFT
    for n in range(len(state)):
        for i in range(D):
            pulled = 0.0
            for j in range(D):
                pulled += (values[n, j] - anchor[j]) * stiffness[j, i]
            trial[n, i] = stress_anchor[i] + pulled
        found = solved(trial, data, n, degree, v, m, a, q, held, root, inverse, stress, slip, multiplier)
        if found == LEFT:
            return
        state[n] = found
        if found == SLIP:
            for i in range(D):
                stress_anchor[i], anchor[i] = stress[n, i], values[n, i]
