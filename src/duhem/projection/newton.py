"""The projection onto any convex K with a formula: supporting half-spaces from outside, Newton's method to finish.

From each trial point a polyhedron around K is built: the nearest point of the polyhedron is pulled back to the boundary
of K towards its centre, and the half-space that supports K there is added.  |s - u| grows towards the distance of K
whatever the shape (Y. Haugazeau 1968; J. E. Kelley 1960), and on polytopes it ends.  At growing intervals Newton's method
on the optimality conditions is tried from where the polyhedron stands: on the piece that holds there, and where pieces
of different formulas press, on their meet.  What it finds is taken only if it satisfies the optimality conditions,
which for a convex K are sufficient; so no iteration is trusted, only its result.  Where planes bound K there is no search: their sets
are few (:mod:`duhem.projection.half_spaces`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.expression.jets import Choices
from duhem.expression.rays import crossing
from duhem.projection.extended_precision import close_look, closest
from duhem.projection.half_spaces import HalfSpaces, faces
from duhem.projection.implicit_tangent import tangent
from duhem.projection.in_blocks import FEW_SEARCHED
from duhem.projection.increment import Increment, too_far_apart
from duhem.projection.method import ClosestPoint, Compiling, Method, Options
from duhem.projection.result import Array, Pointwise, Solution
from duhem.projection.row_by_row import times
from duhem.projection.scaled_formula import grown, power_of_two, scaled
from duhem.projection.whitened_body import Body, Index, body, inner_points, lineality, shrunk, whitening

__all__ = ["NEWTON", "NewtonOptions", "applies", "search", "solve", "tangent"]

# -- Newton's method on the optimality conditions of a projection, on one smooth piece or where several meet ------------
#     s - u = sum lambda_j n_j(u),   level_j(u) = 0        (u whitened, n_j unit normals of the pieces)
#
# Every step is damped until the error falls, so that a curvature without bound (|x|^p, p < 2) does no harm.  Whether the
# end of it is the projection is for the caller to check: multipliers, feasibility, and the pieces being those of K there.

_HALVINGS = 6
_FINISH, _FINISHING = 10, 1e-8  # so many more steps may follow where the error is below the second: it soon is rounding
_ROUNDED = 2e-16  # a distance to the boundary that is rounding, relative to the numbers at hand
_PROGRESS = 0.9  # a step that leaves more of the error is the last: there is a kink in the way


@dataclass(frozen=True)
class _Stationary(Pointwise):
    """How far the points ``x`` (M, d) are from stationary, with the best multipliers (M, J) for the normals there.

    ``away`` (M,) = |s - u|; ``turn`` (M,) = |s - u - sum lambda n| / (1 + |s - u|); ``level`` (M, J) distances to the pieces;
    ``reach`` (M,) = 1 + |u|, of which their rounding is a share.
    """

    x: Array
    multiplier: Array
    normal: Array
    curvature: Array
    slope: Array
    level: Array
    rest: Array
    away: Array
    reach: Array
    choices: Any

    @property
    def turn(self) -> Array:
        return np.linalg.norm(self.rest, axis=1) / (1.0 + self.away)

    @property
    def error(self) -> Array:
        """One number to bring down; never nan."""
        deep = np.max(np.abs(self.level), axis=1)
        hides = (deep <= _ROUNDED * self.reach) & (deep < self.turn)  # rounding hides no turn that is to be taken away
        found = np.hypot(self.turn, np.where(hides, 0.0, deep))
        return np.where(np.isnan(found), np.inf, found)


def _stationary(body: Body, trial: Array, x: Array, at: Index, choices: Choices | None) -> _Stationary:
    """The state at ``x`` (M, d); ``trial`` (M, d) whitened; ``choices`` (M, J, kinks) names the pieces, None the one that holds."""
    count = 1 if choices is None else choices.shape[1]
    pieces = [body.piece(x, at, None if choices is None else choices[:, j]) for j in range(count)]
    normal = np.stack([p.normal for p in pieces], axis=1)
    away = trial - body.whitened(x)
    with np.errstate(all="ignore"):
        multiplier = np.einsum("nd,njd->nj", away, normal)
        if count > 1:
            known = np.where(np.isfinite(normal), normal, 0.0)
            multiplier = np.einsum("ndj,nd->nj", np.linalg.pinv(known, rcond=1e-13), away)
        rest = away - np.einsum("nj,njd->nd", multiplier, normal)
    return _Stationary(
        x.copy(),
        multiplier,
        normal,
        np.stack([p.curvature for p in pieces], axis=1),
        np.stack([p.slope for p in pieces], axis=1),
        np.stack([p.level for p in pieces], axis=1),
        rest,
        np.linalg.norm(away, axis=1),
        _reach(body, x),
        np.stack([p.choices for p in pieces], axis=1),
    )


def _refine(body: Body, trial: Array, x: Array, at: Index, choices: Choices | None = None, steps: int = 15) -> _Stationary:
    """Damped Newton from ``x`` until nothing improves, at most ``steps`` times and a few more at the end; the best state of each point."""
    best = _stationary(body, trial, x, at, choices)
    who = np.flatnonzero(np.isfinite(best.error))
    for step_ in range(steps + _FINISH):
        who = who[(best.error[who] > 1e-17) & ((step_ < steps) | (best.error[who] < _FINISHING))]
        if not who.size:
            break
        step = times(_newton_step(best.of(who)), body.root.T)
        sound = np.all(np.isfinite(step), axis=1)
        who, step = who[sound], step[sound]
        before = best.error[who]
        left, share = np.arange(len(who)), 1.0
        for _ in range(_HALVINGS):
            if not left.size:
                break
            these = who[left]
            found = _stationary(
                body, trial[these], best.x[these] + share * step[left], at[these], None if choices is None else choices[these]
            )
            better = found.error < best.error[these]
            best.put(these[better], found.of(better))
            settled = best.error[these] < 1e-14  # what does not improve here is rounding
            left, share = left[~better & ~settled], share * (0.5 if share > 0.2 else 0.1)
        who = who[best.error[who] < _PROGRESS * before]
    return best


def _newton_step(state: _Stationary) -> Array:
    m, j, d = state.normal.shape
    with np.errstate(all="ignore"):
        matrix = np.zeros((m, d + j, d + j))
        matrix[:, :d, :d] = np.eye(d) + np.einsum("nj,njab->nab", np.maximum(state.multiplier, 0.0), state.curvature)
        matrix[:, :d, d:] = np.swapaxes(state.normal, 1, 2) * (1.0 + state.away)[:, None, None]  # multipliers in their own size
        matrix[:, d:, :d] = state.normal
        matrix[:, d:, d:] = -1e-14 * np.eye(j)
        right = np.concatenate([state.rest, -state.level], axis=1)
        size = np.maximum(np.max(np.abs(matrix), axis=2), 1e-300)  # rows of one size
        matrix, right = matrix / size[:, :, None], right / size
        sound = np.all(np.isfinite(matrix), axis=(1, 2)) & np.all(np.isfinite(right), axis=1)
        step = np.full((m, d), np.nan)
        if sound.any():
            step[sound] = _solved(matrix[sound], right[sound])[:, :d]
    return step


def _solved(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, right[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:  # one of them is singular: least squares for that one
        if len(matrix) > 1:
            return np.concatenate([_solved(matrix[i : i + 1], right[i : i + 1]) for i in range(len(matrix))])
        return np.asarray(np.einsum("nab,nb->na", np.linalg.pinv(matrix), right))


# -- the search ---------------------------------------------------------------------------------------------------------

_TRIES = frozenset({0, 1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 33, 41, 50, 60, 75, 90, 110, 130})
_ROUNDS = 140
_ANGLE = 1e-12  # of slip against the normal cone, relative to 1 + |s - u|
_LOOSE = 1e-10  # the same where the rounding of the point alone turns the normal by more
_NEAR = 2e-13  # distances that count as rounding, relative to the numbers at hand
_SETTLED = 1e-15  # the polyhedron is this close to K, relative likewise: nothing more can be learnt from outside
_EDGE_STEPS = 60
_PATIENCE = 8  # rounds without coming closer after which the same is concluded
_LATE = 50  # rounds after which a corner of the polyhedron is taken for an apex: what is smooth is found before
_NUDGE = 1e-8  # of the numbers at hand: how far beside a point without a normal one is looked for
_STRAIGHT = 1e-5  # over shorter ways a bend could hide in rounding
_BESIDE = 1e-10  # how far the normals at a settled, sharp edge may be taken from beside it
_AROUND = 3e-8  # the same where the point itself has no normal that a formula could tell
_DEPTH = 1e-14  # distances to the boundary, relative to the numbers at hand
_TIP = 1e-14  # a component this small is rounding of the others
_ORIGIN = 1e-12  # a stress this small is none, if none is in K: corners are met less closely than sides
_CLOSE = 1e-9  # of the size of K: what a search that failed may be away from it
_ALIKE = 1e-6  # of two normals that are one: at the tip of a cone a gradient may vanish, and the side's own slope is as good as any
_SUPPORT = 1e-8  # by how much a known point of K may stick out of a supporting half-space


@dataclass(frozen=True)
class NewtonOptions(Compiling):
    """Compiled, the law's formula is made a loop; where nothing is kept on disk that is worth it from some 100,000 points on."""


_DEFAULTS = NewtonOptions()


def applies(increment: Increment) -> str | None:
    """None: every convex law with a formula, in any number of forces.  Convexity itself is the caller's affair."""
    return too_far_apart(increment.stiffness)


def solve(increment: Increment, options: Options = _DEFAULTS) -> Solution:
    """The projection of every trial stress, to rounding; ``failed`` where no point could be shown to be optimal.

    The law is taken as convex.  At corners the slip is a sum over the pieces that meet, and so is the multiplier.
    """
    fast = options if isinstance(options, NewtonOptions) and options.compiled else None
    if fast is None and len(increment.trial) > FEW_SEARCHED:
        return search(increment)
    from duhem.projection.compiled_newton import solved, solved_one_by_one

    solution, left = solved_one_by_one(increment) if fast is None else solved(increment, fast.threads)
    if left.size:
        solution.put(left, search(increment.of(left)))
    return solution


def again(options: NewtonOptions, points: int) -> Callable[[Increment, NewtonOptions], Solution]:
    """The other way: the loop of one point where many were searched for by arrays, else the search."""
    return search if options.compiled or points <= FEW_SEARCHED else _by_the_loop


def _by_the_loop(increment: Increment, _: Options = _DEFAULTS) -> Solution:
    from duhem.projection.compiled_newton import solved_one_by_one

    solution, left = solved_one_by_one(increment)
    solution.failed[left] = True
    return solution


@np.errstate(all="ignore")  # what is out of range fails, and is said to
def search(increment: Increment, _: Options = _DEFAULTS) -> Solution:
    """The same by half-spaces and arrays alone: it finds what the loop of one law leaves, and looks farther on a K that is not convex."""
    trial, n = increment.trial, len(increment.trial)
    stress, slip, multiplier, failed = trial.copy(), np.zeros_like(trial), np.zeros(n), np.zeros(n, dtype=bool)
    solution = Solution(stress, slip, multiplier, failed)
    forces = increment.law.force_symbols()
    formula = scaled(increment.g, forces, increment.pressure_symbol)
    stiffness, root = whitening(increment)
    whole = body(formula, forces, increment.pressure, power_of_two(np.max(np.abs(trial), axis=1)), root)
    level = whole.level(trial / whole.size[:, None], np.arange(n))
    failed |= ~np.all(np.isfinite(trial), axis=1) | ~np.all([np.isfinite(q) for q in (increment.pressure, *whole.data)], axis=0)
    who = np.flatnonzero((level > 0) & ~failed)
    if who.size and (sides := faces(formula.expr, forces, tuple(formula.data))) is not None:
        known = [data[who] for data in whole.data]
        size = whole.size[who]
        near, moved, weight, solved = sides.closest(trial[who] / size[:, None], sides.at(known, who.size), increment.stiffness)
        stress[who], slip[who], multiplier[who] = near * size[:, None], moved * size[:, None], grown(weight, size, 2.0 - formula.degree)
        who = who[~solved]
    if not who.size:
        return solution
    sized, centre, none = _measured(whole.of(who), trial[who], increment.pressure[who])
    if none.any():
        solution.put(who[none], _without_centre(increment, who[none]))
    who, inner, centre = who[~none], sized.of(np.flatnonzero(~none)), centre[~none]
    if not who.size:
        return solution
    size = inner.size
    found = _project(inner, trial[who] / size[:, None], centre)
    _snap(inner, found.x)
    stress[who] = found.x * size[:, None]
    slip[who] = times(found.normal, np.asarray(np.linalg.inv(root))) * (size / stiffness)[:, None]
    multiplier[who] = grown(found.weight / stiffness, size, 2.0 - formula.degree)
    failed[who] |= found.failed
    _in_many_digits(increment, solution, formula.degree, who[found.failed & (found.gap <= _CLOSE)])
    return solution


def _without_centre(increment: Increment, at: Index) -> Solution:
    """The answers to the points ``at``, for which no inner point of K was sampled: K has none, or is far from the origin for its size.

    The loop of one point walks to a K that is far off.  At zero pressure K is the origin alone as a rule, and the loop is not asked.
    """
    from duhem.projection.compiled_newton import solved_one_by_one

    n, d = at.size, increment.trial.shape[1]
    found, bare = Solution(np.empty((n, d)), np.empty((n, d)), np.empty(n), np.zeros(n, dtype=bool)), np.ones(n, dtype=bool)
    if (pressed := np.flatnonzero(increment.pressure[at] != 0.0) if increment.law.pressure else np.arange(n)).size:
        walked, left = solved_one_by_one(increment.of(at[pressed]))
        found.put(pressed, walked)
        bare[pressed] = np.isin(np.arange(pressed.size), left)
    if (rest := np.flatnonzero(bare)).size:
        found.put(rest, shrunk(increment, at[rest], search))
    return found


def _in_many_digits(increment: Increment, solution: Solution, degree: float, at: Index) -> None:
    """Put in place, one by one, what the search came close to and could not show: next to the axis of an apex, say."""
    size = power_of_two(np.max(np.abs(solution.stress[at]), axis=1, initial=0.0))
    for i, unit in zip(at, size, strict=True):
        asked = increment.trial[i], float(increment.pressure[i]), increment.stiffness
        if found := closest(close_look(increment), *asked, solution.stress[i], 0.0, float(unit), patient=False):
            solution.stress[i], solution.slip[i], weight, _ = found
            solution.multiplier[i] = grown(np.array([weight]), np.array([unit]), 1.0 - degree)[0]
            solution.failed[i] = False


def _measured(k: Body, trial: Array, pressure: Array) -> tuple[Body, Array, NDArray[np.bool_]]:
    """The bodies by their own sizes, a centre of each (M, d) in these, and where there is none."""
    everyone, origin = np.arange(len(trial)), np.zeros_like(trial)
    for _ in range(2):  # the first centre is sought around the origin, in sizes of the trial if the origin is outside
        x = trial / k.size[:, None]
        share, missed = crossing(k.level, origin, x)
        near = np.max(np.abs(origin + share[:, None] * (x - origin)), axis=1)
        half = origin + 0.5 * share[:, None] * (x - origin)
        seen = ~missed & (k.level(half, everyone) < 0)  # where powers vanish, a ray that misses K seems to enter it
        grown = np.where(seen, power_of_two(near), 1.0)
        k, origin = k.resized(pressure, k.size * grown), origin / grown[:, None]
        centre, none = inner_points(k, everyone)
        if not (centre != origin).any():
            break
        origin = centre
    return k, centre, none | missed


def _snap(k: Body, x: Array) -> None:
    """Components that are rounding become 0 where only that keeps the point inside, a face through 0, and all of them at a tip."""
    none = np.abs(x).max(axis=1, keepdims=True) <= _ORIGIN
    clean = np.where(none | (np.abs(x) <= _TIP * _reach(k, x)[:, None]), 0.0, x)
    at = np.flatnonzero(np.any(clean != x, axis=1))
    better = at[((k.level(x[at], at) > 0) | ~clean[at].any(axis=1)) & (k.level(clean[at], at) <= 0)]
    x[better] = clean[better]


@dataclass(frozen=True)
class _Found(Pointwise):
    """``x`` (M, d) on the boundary; ``normal`` (M, d) = s - u as sum of multipliers and normals; ``weight`` (M,) the sum of
    the multipliers of the unscaled gradients; ``gap`` (M,) how far the search was from K where it failed."""

    x: Array
    normal: Array
    weight: Array
    failed: NDArray[np.bool_]
    gap: Array


@dataclass(frozen=True)
class _Cuts:
    """Where each half-space touches K: points (N, m, d), slopes (N, m) and pieces (N, m, kinks)."""

    x: Array
    slope: Array
    choices: Choices


def _project(k: Body, trial: Array, centre: Array) -> _Found:
    """Across the endless directions of K first; where the result does not stand the full formula, in all directions."""
    endless = lineality(k)
    if not endless.shape[1]:
        return _search(k, trial, centre)
    along = times(times(k.whitened(trial - centre), endless), endless.T @ k.root.T)
    found = _search(k, trial - along, centre)
    x = found.x + along
    level = k.piece(x, np.arange(len(x)), second=False).level
    doubtful = found.failed | ~(np.abs(level) <= _DEPTH * _reach(k, x))
    found.x[:] = x
    if doubtful.any():
        who = np.flatnonzero(doubtful)
        found.put(who, _search(k.of(who), trial[who], centre[who]))
    return found


def _reach(k: Body, x: Array) -> Array:
    """The size of the numbers a point is made of: its rounding is a few 1e-16 of it."""
    return 1.0 + np.asarray(np.linalg.norm(k.whitened(x), axis=1))


def _search(k: Body, trial: Array, centre: Array) -> _Found:
    n, d = trial.shape
    s = k.whitened(trial)
    outer = HalfSpaces.around(s)
    m = outer.held.shape[1]
    cuts = _Cuts(np.zeros((n, m, d)), np.ones((n, m)), np.zeros((n, m, k.jets.kinks), dtype=np.int8))
    found = _Found(trial.copy(), np.zeros((n, d)), np.zeros(n), np.ones(n, dtype=bool), np.full(n, np.inf))
    since = np.zeros(n, dtype=int)
    left, sharp = np.arange(n), np.zeros(n, dtype=bool)
    for round_ in range(_ROUNDS):
        if not left.size:
            break
        y = times(outer.point[left], k.root.T)
        x = _pulled(k, y, centre[left], left)
        found.x[left] = x
        gap = np.linalg.norm(k.whitened(x - y), axis=1)
        since[left] = np.where(gap < 0.5 * found.gap[left], 0, since[left] + 1)
        found.gap[left] = np.minimum(gap, found.gap[left])
        settled = (gap <= _SETTLED * _reach(k, x)) | ((since[left] > _PATIENCE) & (gap <= _NEAR * _reach(k, x)))
        _accept_polyhedron(found, k, left, x, gap, settled, outer, cuts)
        sharp[left] = ~found.failed[left]
        now = settled | (round_ in _TRIES)
        tried = np.flatnonzero(found.failed[left] & now)
        _accept(found, k, _refine(k, s[left[tried]], x[tried], left[tried]), left[tried], outer, cuts)
        _try_meets(found, k, s, left[found.failed[left] & now], outer, cuts)
        lost = np.flatnonzero(found.failed[left] & (settled | (round_ >= _LATE)))
        _accept_vertex(found, k, left[lost], x[lost], gap[lost], outer, cuts)
        sharp[left[lost]] = ~found.failed[left[lost]]
        touch = k.piece(x, left, second=False)
        bare = ~np.isfinite(touch.normal).all(axis=1)
        lost = np.flatnonzero(found.failed[left] & settled & bare)
        _accept_polyhedron(found, k, left[lost], x[lost], gap[lost], settled[lost], outer, cuts, _AROUND)
        if (aside := np.flatnonzero(found.failed[left] & ~settled & bare)).size:
            nudge = _NUDGE * _reach(k, x[aside])[:, None] * _any_way(round_, s.shape[1])
            x[aside] = _pulled(k, y[aside] + nudge, centre[left[aside]], left[aside])
            touch = k.piece(x, left, second=False)
        open_ = found.failed[left] & ~settled & np.all(np.isfinite(touch.normal), axis=1)
        left, x = left[open_], x[open_]
        slot = outer.free_slot(left)
        cuts.x[left, slot], cuts.slope[left, slot], cuts.choices[left, slot] = x, touch.slope[open_], touch.choices[open_]
        normal, level = touch.normal[open_], touch.level[open_]
        inner = np.where(level < -_DEPTH * _reach(k, x), level, 0.0)  # one beside a point without a normal may lie in K
        outer.add(left, slot, normal, np.einsum("nd,nd->n", normal, k.whitened(x)) - inner)
    edge = np.flatnonzero(sharp & ~found.failed)  # round after all, perhaps, at a scale far below the rounding of the others
    _accept(found, k, _refine(k, s[edge], found.x[edge], edge, steps=_EDGE_STEPS), edge, outer, cuts)
    return found


def _pulled(k: Body, y: Array, centre: Array, at: Index) -> Array:
    """The points of the boundary between the centre and ``y``; ``y`` itself where it lies in K."""
    x = y.copy()
    out = np.flatnonzero(k.level(y, at) > 0)
    share, _ = crossing(lambda z, who: k.level(z, at[out[who]]), centre[out], y[out])
    x[out] = centre[out] + share[:, None] * (y[out] - centre[out])
    return x


def _accept(found: _Found, k: Body, state: _Stationary, at: Index, outer: HalfSpaces, cuts: _Cuts) -> None:
    """Take the points that satisfy the optimality conditions of a convex K."""
    scale, depth = 1.0 + state.away, _DEPTH * state.reach
    rounding = 1e-15 * state.reach * np.max(np.abs(state.curvature), axis=(1, 2, 3), initial=0.0)
    good = (state.turn <= np.clip(rounding, _ANGLE, _LOOSE)) & (np.max(np.abs(state.level), axis=1) <= depth)
    good &= np.all(state.multiplier >= -_ANGLE * scale[:, None], axis=1)
    apart = np.linalg.norm(state.normal[:, :, None] - state.normal[:, None], axis=3)  # the smaller, the closer their levels must be
    levels = np.abs(state.level[:, :, None] - state.level[:, None])
    good &= np.all(levels <= depth[:, None, None] * np.minimum(apart, 1.0), axis=(1, 2))
    who = np.flatnonzero(good)
    if not who.size:
        return
    state, at, depth = state.of(who), at[who], depth[who]
    holds = k.piece(state.x, at, second=False)
    feasible = np.abs(holds.level) <= depth
    known = k.whitened(cuts.x[at].reshape(-1, state.x.shape[1])).reshape(cuts.x[at].shape) - k.whitened(state.x)[:, None, :]
    sticks = np.max(np.where(outer.held[at][:, :, None], np.einsum("nmd,njd->nmj", known, state.normal), -np.inf), axis=(1, 2))
    feasible &= sticks <= _SUPPORT * (1.0 + np.max(np.abs(known), axis=(1, 2)))
    state, at = state.of(feasible), at[feasible]
    multiplier = np.maximum(state.multiplier, 0.0)
    found.x[at] = state.x
    found.normal[at] = np.einsum("nj,njd->nd", multiplier, state.normal)
    found.weight[at] = np.sum(multiplier / state.slope, axis=1)
    found.failed[at] = False


def _accept_polyhedron(
    found: _Found, k: Body, at: Index, x: Array, gap: Array, settled: NDArray[np.bool_], outer: HalfSpaces, cuts: _Cuts,
    beside: float = _BESIDE,
) -> None:  # fmt: skip
    """Take the nearest point of the polyhedron where it lies on K, and every half-space that presses touches K right there."""
    if not at.size:
        return
    active = outer.active[at] & (outer.multipliers[at] > 0)
    d = x.shape[1]
    apart = np.linalg.norm(k.whitened((cuts.x[at] - x[:, None, :]).reshape(-1, d)).reshape(len(at), -1, d), axis=2)
    reach = _reach(k, x)[:, None]
    close = (apart <= _NEAR * reach) & (gap[:, None] <= _NEAR * reach) | (apart <= beside * reach) & settled[:, None]
    for i, slot in zip(*np.nonzero(active & ~close & settled[:, None]), strict=True):
        close[i, slot] = _flat(k, at[i : i + 1], x[i], cuts.x[at[i], slot], apart[i, slot])
    good = active.any(axis=1) & np.all(close | ~active, axis=1)
    _take(found, k, at[good], x[good], outer, cuts)


def _accept_vertex(found: _Found, k: Body, at: Index, x: Array, gap: Array, outer: HalfSpaces, cuts: _Cuts) -> None:
    """Take the corners y of the polyhedron that lie on K to rounding, wherever its sides touch K: an apex of bent sides.

    The closest point p of K lies in the polyhedron, n_i . (p - y) = -t_i <= 0, and |s - p| <= |s - y| + gap.  With
    s - y = sum mu_i n_i this leaves mu_i t_i <= |s - y| gap, and d normals bound p - y by the t_i.  Where the origin is as near
    as that, and in K, it is meant.
    """
    d = x.shape[1]
    presses = outer.active[at] & (outer.multipliers[at] > 0)
    who = np.flatnonzero(presses.sum(axis=1) == d)
    if not who.size:
        return
    at, x, presses, gap = at[who], x[who], presses[who], gap[who]
    normals = outer.normals[at][presses].reshape(-1, d, d)
    multipliers = outer.multipliers[at][presses].reshape(-1, d)
    reach = _reach(k, x)
    away = np.linalg.norm(np.einsum("nj,njd->nd", multipliers, normals), axis=1)
    spread = np.linalg.svd(normals, compute_uv=False)[:, -1]
    with np.errstate(all="ignore"):
        off = np.linalg.norm(1.0 / multipliers, axis=1) * away * np.maximum(gap, _SETTLED * reach) / spread
    good = off * np.linalg.cond(k.root) <= _BESIDE * reach  # as a share of the least component of a stress
    at, x, off = at[good], x[good], off[good] + gap[good]
    tip = (np.linalg.norm(k.whitened(x), axis=1) <= off) & (k.level(np.zeros_like(x), at) <= 0)
    _take(found, k, at, np.where(tip[:, None], 0.0, x), outer, cuts)


def _take(found: _Found, k: Body, at: Index, x: Array, outer: HalfSpaces, cuts: _Cuts) -> None:
    """Keep the points ``x`` with the half-spaces that press, and the slopes that their pieces have there.

    Where the way to the trial is along the one normal there, that normal's slope is meant, however many half-spaces press.
    """
    multiplier, slope = np.where(outer.active[at], outer.multipliers[at], 0.0), cuts.slope[at]
    for slot in np.flatnonzero((multiplier > 0.0).any(axis=0)):
        own = np.flatnonzero(multiplier[:, slot] > 0.0)
        here = k.piece(x[own], at[own], cuts.choices[at[own], slot], second=False)
        alike = np.linalg.norm(here.normal - outer.normals[at[own], slot], axis=1) <= _ALIKE
        slope[own[alike], slot] = here.slope[alike]
    total = np.einsum("nm,nmd->nd", multiplier, outer.normals[at])
    far, here = np.linalg.norm(total, axis=1), k.piece(x, at, second=False)
    along = np.linalg.norm(total - far[:, None] * here.normal, axis=1) <= _ALIKE * far
    found.x[at] = x
    found.normal[at] = total
    found.weight[at] = np.where(along, far / here.slope, np.sum(multiplier / slope, axis=1))
    found.failed[at] = False


def _any_way(round_: int, d: int) -> Array:
    """A direction (d,) with nothing to it, another each round and the same each time."""
    way = np.random.default_rng(round_).standard_normal(d)
    return np.asarray(way / np.linalg.norm(way))


def _flat(k: Body, at: Index, x: Array, touch: Array, apart: float) -> bool:
    """Whether the boundary is straight between two points, so that the normal at one is normal at the other: a cone's side."""
    reach = float(_reach(k, x[None])[0])
    if apart < _STRAIGHT * reach:
        return False
    between = x + np.array([[0.5], [0.0625], [0.0078125]]) * (touch - x)
    level = k.piece(between, np.repeat(at, 3), second=False).level
    return bool(np.all(np.abs(level) <= 1e-15 * reach + _LOOSE * apart * np.array([0.25, 0.05, 0.005])))


def _try_meets(found: _Found, k: Body, s: Array, at: Index, outer: HalfSpaces, cuts: _Cuts) -> None:
    """Newton where the pieces of the pressing half-spaces meet, for the points that more than one piece presses on."""
    groups: dict[int, list[tuple[int, list[int]]]] = {}
    for p in at:
        slots = np.flatnonzero(outer.active[p] & (outer.multipliers[p] > 0))
        distinct = {cuts.choices[p, i].tobytes(): int(i) for i in slots}
        if len(distinct) > 1:
            groups.setdefault(len(distinct), []).append((int(p), list(distinct.values())))
    for members in groups.values():
        who = np.array([p for p, _ in members])
        choices = np.stack([cuts.choices[p, slots] for p, slots in members])
        state = _refine(k, s[who], times(outer.point[who], k.root.T), who, choices)
        _accept(found, k, state, who, outer, cuts)
        seam = np.flatnonzero(found.failed[who] & (state.error < _FINISHING))  # pieces that touch: it is round there
        _accept(found, k, _refine(k, s[who[seam]], state.x[seam], who[seam]), who[seam], outer, cuts)


def plain(increment: Increment, compiled: bool = False) -> ClosestPoint | None:
    """The closest point to one trial by the law's loop on plain numbers; None for a word that the loop lacks."""
    from duhem.projection.compiled_newton import compiled_closest, plain_closest

    return compiled_closest(increment) if compiled else plain_closest(increment)


NEWTON = Method("newton", applies, solve, NewtonOptions, tangent, again=again, plain=plain)
