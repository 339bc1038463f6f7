"""Where the boundary around 0 bends outward most, in any number of forces, and chords across it.

At the point of the boundary in each direction the least second derivative along a tangent, lambda = min v . Hess g v over
v . grad g = 0, is minimised over the directions of the sphere: many starts in floats, then Newton's method on a quadratic through
nearby values.  Where K is long that is done in coordinates in which it is round: the least ellipsoid with centre 0 around points
of the boundary is their unit ball, and a set that is the same on both sides holds the ball of radius 1/sqrt(n) (John 1948).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.jets import formula
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import crossing, first_exit
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_points import Chord
from duhem.proof.search.precise_chords import dent_chords

__all__ = ["chords_across_dents", "chords_across_smooth_dents", "round_coordinates"]

Array = NDArray[np.float64]
_RADII = 10.0 ** np.linspace(-6, 6, 49)
_STARTS, _FOLLOWED, _STEPS = 240, 6, 40  # directions a force, how many of them are followed, and for how long
_BESIDE = 3  # of so many others a force is it the lowest
_CLEAR = -1e-4  # a dent that deep needs no more search
_ALL_BUT_FLAT = 0.03  # the least bend of a start beside a minimum that may be a dent; that of a sphere is 1
_NOISE = 1e-12  # a bend above this is taken for one inward
_CLOSEST = 1e-5  # no quadratic is laid through closer values
_LONG = 15  # times the shortest ray, over the number of forces, is a longest of a long K: of many rays in many forces few come near it
_ROUNDS, _TURNS = 4, 20
_PRICE = 2  # steps of a direction and a term, twice where K is long
_SOUGHT = 15  # what it takes to follow minima of what is no polynomial, in terms of that


def chords_across_dents(subject: FormulaSubject, most: int, thorough: bool) -> Iterator[Chord]:
    """Chords at the lowest bends, at so many choices of the parameters; none where g is no polynomial in the forces with g(0) < 0.

    Only ``thorough`` are minima sought wherever they may be; without it the starts alone are looked at, for a dent that is clear,
    and minima where one of them is all but flat: then a dent is found sooner than a proof is given up.
    """
    forces, seen = subject.simple.forces, set[sp.Expr]()
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        g = subject.formula_at(parameters)
        if g in seen:
            continue  # the choices differ in what g does not depend on
        terms = _terms(g, forces)
        price = _PRICE * _STARTS * len(forces) * terms * (6 if thorough else 1)
        if not terms or not subject.budget.pays(price):
            return
        seen.add(g)
        if (BoundaryBends, g) not in subject.known:
            subject.known[BoundaryBends, g] = BoundaryBends(g, forces)
        boundary: BoundaryBends = subject.known[BoundaryBends, g]
        searched = [boundary]
        if boundary.doubtful(thorough) and boundary.long and subject.budget.pays(price):
            searched = [boundary.rounder, *searched[:thorough]]
        for direction in (found for each in searched for found in each.lowest(thorough)):
            yield from dent_chords(subject, parameters, direction)


def chords_across_smooth_dents(subject: FormulaSubject, most: int = 2) -> Iterator[Chord]:
    """The same for what is no polynomial, where it has second derivatives; 0 must be inside K."""
    forces = subject.simple.forces
    price = _PRICE * _STARTS * len(forces) * sum(1 for _ in sp.preorder_traversal(subject.simple.g))
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        if not (subject.budget.pays(price) and subject.whole.pays(_SOUGHT * price)):
            return
        for direction in BoundaryBends(subject.formula_at(parameters), forces).lowest(True):
            yield from dent_chords(subject, parameters, direction)


def _terms(g: sp.Expr, forces: Sequence[sp.Symbol]) -> int:
    """How many a polynomial of degree 3 or more has that is < 0 at 0, and so a positive power of it less a number; of others, 0."""
    constant, rest = g.as_independent(*(g.atoms(sp.Pow) or {g}), as_Add=True) if g.is_Add else (sp.S.Zero, g)
    if rest.is_Pow and rest.exp.is_Rational and 0 < rest.exp < 1 and constant.is_negative:
        g = rest.base - (-constant) ** (1 / rest.exp)
    if not g.is_polynomial(*forces) or (poly := sp.Poly(g, *forces)).domain not in (sp.ZZ, sp.QQ) or poly.total_degree() < 3:
        return 0
    return len(poly.terms()) if poly.eval(dict.fromkeys(forces, 0)) < 0 else 0


class BoundaryBends:
    """The boundary around 0 of {g <= 0}, g < 0 at 0, in floats and at many points at once."""

    def __init__(self, g: sp.Expr, forces: Sequence[sp.Symbol], axes: Array | None = None) -> None:
        self.g, self.forces, self.n = g, forces, len(forces)
        self._axes = np.eye(self.n) if axes is None else axes  # the forces are L times the coordinates
        self._level, self._jets = compiled(g, forces), formula(g, forces, (), strict=True)
        self._longest = _LONG / self.n

    def doubtful(self, thorough: bool) -> bool:
        """Whether more is worth a look than the starts."""
        lowest = self._starts[1][0]
        return bool(_CLEAR <= lowest < (np.inf if thorough else _ALL_BUT_FLAT))

    @property
    def long(self) -> bool:
        """Whether K is much longer in one direction than in another."""
        met = self._starts[2][np.isfinite(self._starts[2])]
        return bool(len(met) and met.max() > self._longest * met.min())

    @cached_property
    def rounder(self) -> BoundaryBends:
        """The same in coordinates in which K is round."""
        axes = round_coordinates(self.reach, self._starts[0][::3], self._longest)
        return self if axes is None else BoundaryBends(self.g, self.forces, axes)

    def lowest(self, thorough: bool) -> list[list[float]]:
        """Directions of boundary points that seem to bend outward, the lowest first."""
        starts, bends, _ = self._starts
        if bends[0] < _CLEAR:
            found = starts[:1]
        elif self.doubtful(thorough):
            found = self._minima[0][self._minima[1] < (_NOISE if thorough else -_NOISE)]
        else:
            return []
        return [list(map(float, direction)) for direction in found @ self._axes.T]

    @cached_property
    def _starts(self) -> tuple[Array, Array, Array]:
        """Directions, their bends and the distances of the boundary, the lowest first."""
        n = self.n
        units, rng = np.eye(n), np.random.default_rng(5)
        diagonals = [units[i] + s * units[j] for i, j in combinations(range(n), 2) for s in (1, -1)]
        starts = np.vstack([units, -units, *diagonals, rng.standard_normal((_STARTS * n, n))])
        return self._sorted(starts / np.linalg.norm(starts, axis=1, keepdims=True))

    @cached_property
    def _minima(self) -> tuple[Array, Array, Array]:
        """The same of minima that are found from the lowest of the starts that are lower than those beside them."""
        starts, bends, distances = self._starts
        low = len(starts) // 4
        near = starts[:low] @ starts.T
        if np.allclose(self.reach(-starts[:low]), distances[:low]):
            near = np.abs(near)  # so are the bends on both sides alike
        beside = np.argpartition(-near, _BESIDE * self.n, axis=1)[:, : _BESIDE * self.n + 1]
        lowest = np.flatnonzero((bends[:low, None] <= bends[beside]).all(axis=1))[:_FOLLOWED]
        return self._sorted(self._followed(starts[lowest]))

    def _sorted(self, directions: Array) -> tuple[Array, Array, Array]:
        bends, distances = self.bends(directions)
        order = np.argsort(bends, kind="stable")
        return directions[order], bends[order], distances[order]

    def _followed(self, starts: Array) -> Array:
        """Each to a minimum near by: the minimum of a quadratic through the values around, as long as that is lower, ever closer."""
        found, widths, m = starts.copy(), np.full(len(starts), 0.05), self.n - 1
        pairs = list(combinations(range(m), 2))
        steps = np.vstack([np.zeros(m), np.eye(m), -np.eye(m), *([np.eye(m)[i] + np.eye(m)[j]] for i, j in pairs)])
        for _ in range(_STEPS):
            going = np.flatnonzero(widths >= _CLOSEST)
            if not len(going):
                break
            here, width = found[going], widths[going]
            frames = width[:, None, None] * np.linalg.svd(here[:, None, :])[2][:, 1:]
            around, values = self._beside(here, steps @ frames)
            inside = np.asarray(np.isfinite(values).all(axis=1))
            values = np.where(inside[:, None], values, 0.0)
            one, other = values[:, 1 : m + 1], values[:, m + 1 : 2 * m + 1]
            slope, curve = (one - other) / 2, np.zeros((len(going), m, m))
            curve[:, range(m), range(m)] = one + other - 2 * values[:, :1]
            for k, (i, j) in enumerate(pairs):
                curve[:, i, j] = curve[:, j, i] = values[:, 2 * m + 1 + k] - one[:, i] - one[:, j] + values[:, 0]
            sizes, axes = np.linalg.eigh(curve)
            least = 1e-3 * np.maximum(1e-12, np.abs(sizes).max(axis=1))
            step = -np.einsum("pij,pj->pi", axes, np.einsum("pji,pj->pi", axes, slope) / np.maximum(np.abs(sizes), least[:, None]))
            length = np.linalg.norm(step, axis=1)
            step *= np.minimum(1.0, 3 / np.maximum(length, 1e-300))[:, None]
            tried, lower = self._beside(here, np.array([1.0, 0.5, 0.2])[:, None] * np.einsum("pi,pin->pn", step, frames)[:, None])
            low, row = values.argmin(axis=1), np.arange(len(going))
            tried, lower = np.concatenate([tried, around[row, low, None]], axis=1), np.column_stack([lower, values[row, low]])
            best = lower.argmin(axis=1)
            better = inside & (lower[row, best] < values[:, 0])
            found[going] = np.where(better[:, None], tried[row, best], here)
            widths[going] = np.where(inside, np.where((length < 1) | ~better, width / 3, width), width / 4)
        return found

    def _beside(self, here: Array, steps: Array) -> tuple[Array, Array]:
        """The directions some steps away from each of several, and their bends."""
        x = here[:, None, :] + steps
        x /= np.linalg.norm(x, axis=2, keepdims=True)
        return x, self.bends(x.reshape(-1, self.n))[0].reshape(x.shape[:2])

    def _levels(self, points: Array) -> Array:
        """g at points (..., n)."""
        return np.asarray(self._level(*np.moveaxis(points, -1, 0)))

    def reach(self, u: Array) -> Array:
        """The distance at which each ray first leaves K; infinite where it does not."""
        ways = u @ self._axes.T
        last, first = first_exit(self._levels(_RADII[:, None] * ways[:, None, :]) <= 0, _RADII)
        left = np.flatnonzero((last > 0) & (last < first))  # not where 0 is outside
        shares, none = crossing(lambda points, _: self._levels(points), np.zeros((len(left), self.n)), first[left, None] * ways[left])
        found = np.full(len(u), np.inf)
        found[left[~none]] = first[left[~none]] * shares[~none]
        return found

    @np.errstate(all="ignore")
    def bends(self, u: Array) -> tuple[Array, Array]:
        """r lambda/(u . grad g) at the boundary in each direction, and r; infinite where there is none."""
        distances = self.reach(u)
        there = np.isfinite(distances)
        r = np.where(there, distances, 1.0)
        jet = self._jets(r[:, None] * u @ self._axes.T, ())[0]
        assert jet.gradient is not None and jet.hessian is not None
        gradient, hessian = jet.gradient @ self._axes, self._axes.T @ jet.hessian @ self._axes
        rise = (u * gradient).sum(axis=1)
        good = there & (rise > 0) & np.isfinite(hessian).all(axis=(1, 2)) & np.isfinite(gradient).all(axis=1)
        hessian, size = np.where(good[:, None, None], hessian, 0.0), np.linalg.norm(gradient, axis=1)
        normal = np.where(good[:, None], gradient / size[:, None], 0.0)
        flat = np.eye(self.n) - normal[:, :, None] * normal[:, None, :]
        out = np.abs(hessian).sum(axis=(1, 2)) + 1  # beyond every tangential value: the normal is not chosen
        least = np.linalg.eigvalsh(flat @ hessian @ flat + out[:, None, None] * normal[:, :, None] * normal[:, None, :])[:, 0]
        return np.where(good, r * least / rise, np.inf), distances


def round_coordinates(reach: Any, directions: Array, long: float) -> Array | None:
    """L of coordinates w, x = L w, in which no ray is ``long`` times another, if some such are found; None where there are none.

    ``reach(u)`` is the distance of the boundary along each direction; infinite is no point of it.
    """
    n, axes = directions.shape[1], np.eye(directions.shape[1])
    for _ in range(_ROUNDS):  # from few points along an axis that is long, the next ellipsoid is found from more
        rays = directions @ axes.T
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        distance = reach(rays)
        met = np.isfinite(distance)
        points = np.linalg.solve(axes, (distance[met, None] * rays[met]).T).T
        lengths = np.linalg.norm(points, axis=1)
        if len(points) <= n or lengths.max() <= long * lengths.min():
            break
        axes = axes @ np.linalg.cholesky(n * _around(points))
    return None if np.array_equal(axes, np.eye(n)) else axes


def _around(points: Array) -> Array:
    """M of the ellipsoid x . M^-1 x = n that holds the points, all but the least (Titterington 1976)."""
    weights = np.full(len(points), 1 / len(points))
    for _ in range(_TURNS):
        moment = (weights[:, None] * points).T @ points
        weights *= (points * np.linalg.solve(moment, points.T).T).sum(axis=1) / points.shape[1]
    return np.asarray((weights[:, None] * points).T @ points)
