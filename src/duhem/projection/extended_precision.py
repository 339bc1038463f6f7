"""A criterion next to its boundary, and the closest point beside an answer, in as many digits as that takes.

The criterion is asked at points given as sums of two doubles: in pairs of doubles for many points at once, and in balls, one point after
the other, where the formula holds words that pairs lack, or the numbers leave their range.  The parameters are the doubles that the methods
read, taken exactly.

Answers that doubles do not decide are held against the closest point beside them, which is found in some hundred digits.  Lengths in the
metric of k hide a soft force behind a stiff one, and next to the boundary a slip is a small difference of stresses.  The closest point
beside an answer has all digits of every component: the answer is as far off as it is from there, and where both are the same answer to what
is vouched for the better one takes its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from duhem.expression.double_double import Pair, PairProgram, added, paired, product
from duhem.expression.error_bounds import BoundedProgram, bounded
from duhem.law.formula_law import Criterion
from duhem.projection.increment import ROUNDING, Increment, Metric, at_doubles
from duhem.projection.normal_cones import beside
from duhem.projection.result import ACCURACY, Array, Residuals, Solution
from duhem.projection.row_by_row import length, times, widest
from duhem.projection.scaled_formula import Level, level_of, power_of_two, scaled

__all__ = [
    "LEAST_SLIP", "SLIP_SHARE", "CloseLook", "ClosestInDigits", "as_pairs", "close_look", "closest", "closest_beside", "departures",
    "pushed_back", "put_right",
]  # fmt: skip

_BITS = 1600  # of balls: four of 400 bits follow a power, a difference and what cancels
_STEP = -400  # of differences, as a power of two, in sizes of the stress
_FINER = 2.0**-44  # what pairs are off by as a share of what doubles are: 2^-50 an operation, with room
_TELLING = 2.0**-30  # of a value: it has digits enough
_NOTHING = 2.0**-80  # of a stress: what is closer to the boundary than this is on it
_LEAST = 2.0**-1074
_SIZES = 2.0**-100, 2.0**100  # of stresses that pairs are tried for


def as_pairs(stress: Array, size: Array) -> list[Pair]:
    """Stresses (N, d) in units of ``size`` (N,), a pair for each force."""
    return [Pair(x, np.zeros(len(x))) for x in (stress / size[:, None]).T]


def pushed_back(trial: Array, slip: Array, stiffness: Array, size: Array) -> list[Pair]:
    """trial - k slip (N, d) in units of ``size`` (N,), a pair for each force, good to some 30 digits of the trial."""
    exponent = int(np.frexp(np.max(np.diagonal(stiffness)))[1])
    k, moved = np.ldexp(stiffness, -exponent), np.ldexp(slip / size[:, None], exponent)
    found = as_pairs(trial, size)
    for i, row in enumerate(k):
        for j in np.flatnonzero(row):
            part = product(Pair(row[j], 0.0), Pair(moved[:, j], 0.0))
            found[i] = added(found[i], Pair(-part.high, -part.low))
    return found


@dataclass(frozen=True, eq=False)
class CloseLook:
    """``g`` over the forces and, for a law that has one, the pressure; of a degree as a scaled formula has one."""

    forces: int
    pressed: bool
    degree: float
    pairs: PairProgram | None
    doubles: BoundedProgram | None
    balls: Callable[..., Any]

    def level(self, points: Sequence[Pair], pressure: Array, size: Array, steep: Array | float = 1.0) -> tuple[Array, Array]:
        """g/R^degree at ``points`` times R = ``size`` (N,), and a bound of what it is off by; nan and inf where nobody knows.

        ``steep``: by how much g changes over the stress, where that may be little: then a small g is not next to the boundary.
        """
        nothing = np.broadcast_to(_NOTHING * np.fmin(steep, 1.0), len(size))
        value, bound = np.full(len(size), np.nan), np.full(len(size), np.inf)
        near = (size >= _SIZES[0]) & (size <= _SIZES[1])
        if self.pairs is not None and self.doubles is not None and near.any():
            with np.errstate(all="ignore"):
                tail = [Pair(pressure, np.zeros(len(size)))] if self.pressed else []
                real = [*(Pair(p.high * size, p.low * size) for p in points), *tail]
                told, sound = self.pairs(real, len(size))
                rounding = self.doubles([p.high for p in real], [0.0] * len(real))[1]
                unit = size**-self.degree
                value, bound = (np.where(near & sound, x * unit, y) for x, y in ((told.high, value), (_FINER * rounding, bound)))
        for i in np.flatnonzero(~((bound <= _TELLING * np.abs(value)) | (bound <= nothing))).tolist():
            value[i], bound[i] = self._enclosed([_ball(p, i) for p in points], float(pressure[i]), float(size[i]))
        return value, bound

    def holds(self, stress: Array, pressure: float) -> bool:
        """Whether one stress (d,) is shown to lie inside K."""
        import flint

        with _precision():
            found = self.balls(*map(flint.arb, stress.tolist()), *([flint.arb(pressure)] if self.pressed else []))
        return bool(found < 0)

    def slopes(self, points: Sequence[Pair], pressure: Array, size: Array) -> Array:
        """R^(1 - degree) dg/dsigma (N, d) there, by differences in many digits; nan where there are none."""
        found = np.empty((len(size), self.forces))
        for i in range(len(size)):
            found[i] = self._slope([_ball(p, i) for p in points], float(pressure[i]), float(size[i]))
        return found

    def _enclosed(self, s: list[Any], pressure: float, size: float) -> tuple[float, float]:
        with _precision():
            value = self.ball(s, pressure, size)
            middle, radius = float(value.mid()), float(value.rad())
            if middle == 0.0 and not value.is_zero():  # below doubles it may have a sign
                return (_LEAST, 0.0) if value > 0 else (-_LEAST, 0.0) if value < 0 else (0.0, max(radius, _LEAST))
            if np.isfinite(middle) and np.isfinite(radius):
                return middle, radius
            return (np.inf, 0.0) if value > 0 else (-np.inf, 0.0) if value < 0 else (np.nan, np.inf)  # beyond doubles it has a sign

    def _slope(self, s: list[Any], pressure: float, size: float) -> list[float]:
        import flint

        with _precision():
            step = flint.arb(2) ** _STEP
            here = self.ball(s, pressure, size)
            each = [(self.ball([*s[:i], x + step, *s[i + 1 :]], pressure, size) - here) / step for i, x in enumerate(s)]
            return [float(x.mid()) if x.is_finite() and x.rad() < 2.0**-40 * (1 + abs(x.mid())) else np.nan for x in each]

    def ball(self, s: Sequence[Any], pressure: float, size: float) -> Any:
        """g(R s)/R^degree at balls, in the working precision; R = ``size``."""
        import flint

        unit = flint.arb(size)
        found = self.balls(*(unit * x for x in s), *([flint.arb(pressure)] if self.pressed else []))
        return found / unit ** flint.arb(self.degree)


def _precision() -> Any:
    from duhem.expression import balls

    return balls.precision(_BITS)


def _ball(pair: Pair, i: int) -> Any:
    import flint

    with _precision():
        return flint.arb(float(pair.high[i])) + flint.arb(float(pair.low[i]))


def close_look(increment: Increment) -> CloseLook:
    """The law of an increment at its parameters."""
    return _close_look(increment.law, tuple(increment.parameters.items()))


@lru_cache(maxsize=256)
def _close_look(law: Criterion, parameters: tuple[tuple[str, float], ...]) -> CloseLook:
    from duhem.expression import balls

    g, forces = at_doubles(law, dict(parameters)), law.force_symbols()
    pressure = law.symbols()[law.pressure] if law.pressure else None
    names = forces if pressure is None else (*forces, pressure)
    degree = scaled(g, forces, pressure).degree
    pairs = paired(g, names)
    doubles = None if pairs is None else bounded(g, names)
    return CloseLook(len(forces), pressure is not None, degree, pairs, doubles, balls.compiled(g, names))


# -- the closest point beside a given stress ----------------------------------------------------------------------------
# On a smooth piece of g Newton's method on  x + k m n(x) = t,  g(x) = 0  with m >= 0; where pieces meet, half-spaces that support K,
# found one after the other (Y. Haugazeau, 1968).  Slopes are differences; what is found is a closest point by the optimality
# conditions, which are evaluated at it once more.  Lengths are over R, the power of two below the given stress.


class ClosestInDigits(NamedTuple):
    """Stress (d,), slip (d,) and multiplier of dh/ds of a closest point; ``single`` where no other multiplier has this slip."""

    stress: Array
    slip: Array
    multiplier: float
    single: bool


Vector = list[Any]

_NEWTON = 24
_DAMPED = 120
_SHORTER = 24  # times a step is quartered at most
_WILD = 2.0**40  # times the size of the given stress
_PLANES = 40
_SETTLED = 2.0**-150  # of a step, after which the next is rounding
_VANISHING = 2.0**-200  # of a stress
_SAME = 2.0**-40  # of a slope: what the two sides of a point differ by where g is smooth
_LEFT = 2.0**-350  # of the largest component: less is what differences leave
_ASIDE = 2.0**-60  # half-spaces are looked for this close to the given stress
_FAR = 2.0**-20  # from there a point is not beside it
_THERE = 2.0**-100  # of the point where they meet: what touches K this close to it is one of K's there


def closest(
    look: CloseLook, trial: Array, pressure: float, stiffness: Array, start: Array, multiplier: float, size: float, *, patient: bool = True
) -> ClosestInDigits | None:
    """Stress (d,), slip (d,) and multiplier of dh/ds of one ``trial`` (d,), looked for from a stress and its multiplier; None if not found.

    ``patient``: steep slopes are damped, which takes a hundred times as long as the rest where nothing is found.
    ``size`` is R, a power of two, in which h and its slopes are meant.  Each number is the double nearest to the one found.
    """
    import flint

    if not (np.isfinite(start).all() and np.isfinite(trial).all()):
        return None
    far = max(0, int(np.frexp(np.abs(trial).max())[1] - np.frexp(size)[1]))  # the way to the trial makes errors of a slope longer
    with flint.ctx.workprec(_BITS + 3 * far):
        unit = flint.arb(size)
        point = _Point(
            look,
            pressure,
            size,
            [flint.arb(x) / unit for x in trial.tolist()],
            [[flint.arb(x) for x in row] for row in stiffness.tolist()],
            flint.arb(2) ** (_STEP - far),
        )
        x = [flint.arb(x) / unit for x in start.tolist()]
        m = flint.arb(multiplier) / unit if 0.0 < multiplier < np.inf else None
        found = point.on_one_piece(x, m, _NEWTON) or point.where_pieces_meet(x)
        if found is None and point.met is not None:  # a bend too sharp for the given stress
            found = point.on_one_piece(point.met, None, _NEWTON)
        if found is None and patient:
            found = point.on_one_piece(x, None, _DAMPED, damped=True)
        if found is None:
            return None
        stress, pull, m, single = found
        stress = [x if abs(x) > _VANISHING else 0 * x for x in stress]
        return ClosestInDigits(_nearest_doubles(stress, unit), _nearest_doubles(pull, unit), float((m * unit).mid()), single)


def _nearest_doubles(numbers: Vector, unit: Any) -> Array:
    """``numbers`` times the unit; what is left of differences is 0."""
    least = _LEFT * max(abs(x) for x in numbers)
    return np.array([float((x * unit).mid()) if abs(x) > least else 0.0 for x in numbers])


_Found = tuple[Vector, Vector, Any, bool]  # stress, slip and multiplier, all over R, and whether there is no other multiplier


class _Point:
    """One trial ``t`` over R, and g/R^degree in balls."""

    def __init__(self, look: CloseLook, pressure: float, size: float, t: Vector, k: list[Vector], step: Any) -> None:
        import flint

        self.look, self.pressure, self.size = look, pressure, size
        self.t, self.k, self.step = t, k, step
        self.k_matrix = flint.arb_mat(k)
        self.met: Vector | None = None  # where half-spaces met last

    def level(self, x: Vector) -> Any:
        return self.look.ball(x, self.pressure, self.size).mid()

    def slope(self, x: Vector, here: Any, sense: int = 1) -> Vector:
        step = sense * self.step
        return [((self.level([*x[:i], c + step, *x[i + 1 :]]) - here) / step).mid() for i, c in enumerate(x)]

    def pushed(self, n: Vector) -> Vector:
        """k n."""
        return [sum((a * b for a, b in zip(row, n, strict=True)), 0 * n[0]) for row in self.k]

    # -- one piece -----------------------------------------------------------------------------------------------------

    def on_one_piece(self, x: Vector, m: Any, turns: int, damped: bool = False) -> _Found | None:
        """From ``x`` on by Newton's method, where g is smooth at the end of it; ``damped`` for slopes that are steep beside a kink."""
        at = self._stationary(x, m)
        if at is None:
            return None
        for _ in range(turns):
            step = self._newton_step(at)
            if step is None:
                return None
            share, new = 1.0, None
            for _ in range(_SHORTER if damped else 1):
                moved = [(c + share * s).mid() for c, s in zip(at.x, step, strict=False)]
                new = self._stationary(moved, None if damped else (at.m + share * step[-1]).mid())
                if not damped or (new is not None and new.error < at.error):
                    break
                share, new = share / 4, None
            if new is None or max(abs(c) for c in new.x) > _WILD:
                return None
            at = new
            length = max(abs(s) for s in step[:-1])
            if length <= _SETTLED and ((found := self._confirmed(at)) or length <= self.step):
                return found
        return None

    def _stationary(self, x: Vector, m: Any) -> _State | None:
        """Where the iteration stands at ``x``; with the best multiplier where none is given."""
        here = self.level(x)
        n = self.slope(x, here)
        if not _known([here, *x, *n]) or not any(n):
            return None
        push, away = self.pushed(n), [t - c for t, c in zip(self.t, x, strict=True)]
        m = (_dot(n, away) / _dot(n, push)).mid() if m is None else m
        rest = [a - m * p for a, p in zip(away, push, strict=True)]
        error = self.apart(rest) / (1 + self.apart(away)) + abs(here) / _dot(n, push).sqrt().mid()
        return _State(x, here, n, push, m, rest, error.mid())

    def apart(self, stress: Vector) -> Any:
        """The length of a stress in the metric of k."""
        back = _solved(self.k_matrix, stress)
        return self.t[0] * 0 if back is None else abs(_dot(stress, back)).sqrt().mid()

    def _newton_step(self, at: _State) -> Vector | None:
        import flint

        d, bend = len(at.x), self._bend(at.x, at.here, at.n)
        if bend is None:
            return None
        turned = [self.pushed(column) for column in bend]  # k H, column by column, H being symmetric
        rows = [[(at.m * turned[j][i] + (1 if i == j else 0)).mid() for j in range(d)] + [at.push[i].mid()] for i in range(d)]
        rows.append([c.mid() for c in at.n] + [0 * at.here])
        return _solved(flint.arb_mat(rows), [*at.rest, -at.here])

    def _bend(self, x: Vector, here: Any, n: Vector) -> list[Vector] | None:
        """The Hessian by differences."""
        d, s = len(x), self.step
        once = [here + s * c for c in n]
        rows = [[0 * here] * d for _ in range(d)]
        for i in range(d):
            for j in range(i + 1):
                there = list(x)
                there[i] = there[i] + s
                there[j] = there[j] + s
                rows[i][j] = rows[j][i] = ((self.level(there) - once[i] - once[j] + here) / (s * s)).mid()
        return rows if _known([c for row in rows for c in row]) else None

    def _confirmed(self, at: _State) -> _Found | None:
        """The point if g is smooth there, zero, and the way to the trial along its slope, as far as a double can ask."""
        widest = max(abs(c) for c in at.n)
        smooth = self._smooth(at.x, at.here, at.n)
        if smooth and at.m >= 0 and abs(at.here) <= _VANISHING * widest and max(abs(r) for r in at.rest) <= _VANISHING:
            return at.x, [at.m * c for c in at.n], at.m, True
        return None

    def _smooth(self, x: Vector, here: Any, n: Vector) -> bool:
        """Whether g has one slope at ``x``, from both sides; where pieces tie, differences are the slope of none of them."""
        back = self.slope(x, here, -1)
        return _known(back) and max(abs(a - b) for a, b in zip(n, back, strict=True)) <= _SAME * max(abs(c) for c in n)

    # -- where pieces meet ---------------------------------------------------------------------------------------------

    def where_pieces_meet(self, x: Vector) -> _Found | None:
        """The closest point of half-spaces that support K, found from ``x`` on, if it lies on K."""
        skew = _any_way(len(x))
        pool, pressing = self._around(x), list[_Plane]()
        y, weights = self.t, list[Any]()
        for _ in range(_PLANES):
            entering = max(pool, key=lambda plane: plane.excess(y), default=None)
            if entering is None or not entering.excess(y) > _VANISHING:
                beyond = self.level(y)
                if not _known([beyond]):  # 0/0 at an apex
                    beyond = self.level([c + self.step * w for c, w in zip(y, skew, strict=True)])
                if not _known([beyond]):
                    return None
                if beyond <= _VANISHING * max((plane.steep for plane in pressing), default=0):  # a level is no length
                    return self._vouched(y, pressing, weights)
                entering = self._beside(x, y) or self._plane([c + beyond * _ASIDE * w for c, w in zip(y, skew, strict=True)])
                if entering is None or not entering.excess(y) > 0:
                    return None
                pool.append(entering)
            chosen = self._nearest([*pressing, entering])
            if chosen is None:
                return None
            y, pressing, weights = chosen
            self.met = y
        return None

    def _around(self, x: Vector) -> list[_Plane]:
        """The half-spaces of K beside ``x`` on all sides."""
        skew = _any_way(len(x))
        ways = [[w + s / 4 for w, s in zip(way, skew, strict=True)] for way in beside(len(x)).tolist()]
        tried = (self._plane([c + _ASIDE * w for c, w in zip(x, way, strict=True)]) for way in ways)
        return [plane for plane in tried if plane is not None]

    def _beside(self, x: Vector, y: Vector) -> _Plane | None:
        """The half-space that holds K beside ``x`` on the way to a ``y`` far off, if it leaves ``y`` out: the next side of an apex."""
        way = [b - a for a, b in zip(x, y, strict=True)]
        far = max(abs(c) for c in way).mid()
        plane = self._plane([(a + _ASIDE * c / far).mid() for a, c in zip(x, way, strict=True)]) if far > _FAR else None
        return plane if plane is not None and plane.excess(y) > _VANISHING else None

    def _plane(self, x: Vector) -> _Plane | None:
        here = self.level(x)
        n = self.slope(x, here)
        if not _known([here, *n]) or not any(n) or not self._smooth(x, here, n):
            return None
        return _Plane(n, (_dot(n, x) - here).mid(), x, max(abs(c) for c in n))

    def _nearest(self, planes: list[_Plane]) -> tuple[Vector, list[_Plane], Vector] | None:
        """The closest point of some half-spaces, those that press and their weights."""
        import flint

        push = [self.pushed(p.normal) for p in planes]
        for count in range(1, min(len(planes), len(self.t)) + 1):
            for some in combinations(range(len(planes)), count):
                gram = flint.arb_mat([[_dot(planes[i].normal, push[j]).mid() for j in some] for i in some])
                weights = _solved(gram, [(_dot(planes[i].normal, self.t) - planes[i].height).mid() for i in some])
                if weights is None or not all(w > 0 for w in weights):
                    continue
                y = [(t - sum((w * push[j][i] for w, j in zip(weights, some, strict=True)), 0 * t)).mid() for i, t in enumerate(self.t)]
                if all(p.excess(y) <= _VANISHING for p in planes):
                    return y, [planes[i] for i in some], weights
        return None

    def _vouched(self, y: Vector, planes: Sequence[_Plane], weights: Vector) -> _Found | None:
        """The point if every half-space that presses is one of K's right there, in the sense of where it was found."""
        for plane in planes:
            way = [a - b for a, b in zip(plane.touch, y, strict=True)]
            far = max(abs(c) for c in way)
            if far > _THERE:
                near = [c + _ASIDE * _ASIDE * w / far for c, w in zip(y, way, strict=True)]
                n = self.slope(near, self.level(near))
                if not _known(n) or max(abs(a - b) for a, b in zip(n, plane.normal, strict=True)) > _SAME * plane.steep:
                    return None
        slip = [sum((w * p.normal[i] for w, p in zip(weights, planes, strict=True)), 0 * c) for i, c in enumerate(y)]
        return y, slip, sum(weights, 0 * y[0]), self._independent([*planes, *self._around(y)])

    def _independent(self, planes: Sequence[_Plane]) -> bool:
        """Whether no normal of these is another one, nor a sum of others: a slip is made up of such normals in one way."""
        rows = list[Vector]()
        for plane in planes:
            given = [c / plane.steep for c in plane.normal]
            if any(max(abs(a - b) for a, b in zip(given, row, strict=True)) <= _SAME for row in rows):
                continue
            rows.append(given)
            if len(rows) > len(given):
                return False
        import flint

        return not flint.arb_mat([[_dot(a, b) for b in rows] for a in rows]).det() <= _SAME


@dataclass(frozen=True)
class _State:
    """A point ``x``, g and its slope ``n`` there, ``push`` = k n, a multiplier ``m``, ``rest`` = t - x - m k n, and one number of these."""

    x: Vector
    here: Any
    n: Vector
    push: Vector
    m: Any
    rest: Vector
    error: Any


@dataclass(frozen=True)
class _Plane:
    """The half-space normal . x <= height, found at the point ``touch``; ``steep`` the largest component of the normal."""

    normal: Vector
    height: Any
    touch: Vector
    steep: Any

    def excess(self, x: Vector) -> Any:
        return ((_dot(self.normal, x) - self.height) / self.steep).mid()


def _dot(a: Vector, b: Vector) -> Any:
    return sum((x * y for x, y in zip(a, b, strict=True)), 0 * a[0])


def _known(numbers: Vector) -> bool:
    return all(x.is_finite() for x in numbers)


def _solved(matrix: Any, right: Vector) -> Vector | None:
    import flint

    try:
        found = matrix.solve(flint.arb_mat([[x.mid()] for x in right]))
    except ZeroDivisionError:
        return None
    numbers = [x.mid() for x in found.entries()]
    return numbers if _known(numbers) else None


def _any_way(d: int) -> list[float]:
    """A direction along no plane that a formula is likely to hold."""
    return np.cos(1.0 + np.arange(d)).tolist()


# -- answers held against it --------------------------------------------------------------------------------------------

LEAST_SLIP = 1e-21  # of the stress: what a shorter slip counts, so that 1e-27 of a stress is nothing
SLIP_SHARE = 0.1  # what a relative error of a slip counts: it is vouched for to ten times the accuracy of stresses


def closest_beside(
    question: Increment, answer: Solution, multiplier: Array, units: Array, patient: bool = False
) -> list[ClosestInDigits | None]:
    """The closest point beside each answer (N,), None where none is found; ``multiplier`` of h, R = ``units``."""
    look = close_look(question)
    rows = np.column_stack([question.trial, question.pressure, answer.stress, multiplier, units])
    found = dict[bytes, ClosestInDigits | None]()  # points that are alike are one
    for i, row in enumerate(rows):
        if row.tobytes() not in found:
            start = answer.stress[i], float(multiplier[i]), float(units[i])
            asked = look, question.trial[i], float(question.pressure[i]), question.stiffness
            found[row.tobytes()] = closest(*asked, *start, patient=patient)
    return [found[row.tobytes()] for row in rows]


def departures(question: Increment, answer: Solution, multiplier: Array, aside: Array, points: list[ClosestInDigits | None]) -> Array:
    """How far answers (N,) are from the closest points beside them, of the largest component; slips and multipliers count a tenth.

    inf where none was found; nan where stress and slip are right and the multiplier is another one where there are several, as at an
    apex.  ``aside`` (N,) is how far a slip is from the multiplier times the slope of g at the answer, as a share of it: where K is
    thin the slopes of two stresses that are the same to what is vouched for have other lengths.
    """
    found, stiffest = np.full(len(points), np.inf), float(np.max(np.diagonal(question.stiffness)))
    for i, point in enumerate(points):
        if point is not None:
            off = departure(answer.stress[i], answer.slip[i], point.stress, point.slip, stiffest)
            short = SLIP_SHARE * min(_share(abs(multiplier[i] - point.multiplier), point.multiplier), aside[i])
            found[i] = off if short <= ACCURACY or off > ACCURACY else short if point.single or not multiplier[i] > 0.0 else np.nan
    return found


def departure(stress: Array, slip: Array, from_stress: Array, from_slip: Array, stiffest: float) -> float:
    """How far a stress and a slip (d,) are from others, of the largest component of these: a slip counts a tenth.

    ``stiffest``, the largest on the diagonal of k, makes 1e-21 of a stress a slip: a shorter one counts as long as that.
    """
    largest = np.abs(from_stress).max()
    moved = max(np.abs(from_slip).max(), LEAST_SLIP * largest / stiffest)
    off = _share(np.abs(stress - from_stress).max(), largest)
    return max(off, SLIP_SHARE * (_share(np.abs(slip - from_slip).max(), moved) + ROUNDING))


def _share(part: float, whole: float) -> float:
    return 0.0 if part == 0.0 else float(part / whole)


def put_right(
    question: Increment,
    solution: Solution,
    found: Residuals,
    judge: Callable[[Increment, Solution], Residuals],
    seen: Mapping[int, ClosestInDigits | None],
) -> tuple[Solution, Residuals]:
    """The solution and its residuals, with the closest points ``seen`` beside answers, by the place of each, where these are refused.

    Only what is the same answer is taken, and judged like any other: a wrong one stays what it is.  Where the judge saw none it is
    looked for with more patience.
    """
    at = np.array([i for i in seen if found.stationarity[i] > ACCURACY and not solution.failed[i]], dtype=np.intp)
    if not at.size:
        return solution, found
    asked, g, old = question.of(at), level_of(question), solution.of(at)
    units = _units(old.stress, asked.trial)
    new, own = old.copy(), g.multiplier(old.multiplier, units)
    points = [seen[place] for place in at.tolist()]
    if (lost := np.array([i for i, point in enumerate(points) if point is None], dtype=np.intp)).size:
        for i, point in zip(lost, closest_beside(asked.of(lost), old.of(lost), own[lost], units[lost], patient=True), strict=True):
            points[i] = point
    for i, point in enumerate(points):
        if point is not None:
            new.stress[i], new.slip[i], own[i], _ = point
    new = replace(new, multiplier=g.own(own, units))
    with np.errstate(all="ignore"):
        same = np.flatnonzero(_same(Metric.of(asked.stiffness), g, asked, new, old))
    new = new.of(same)
    judged = judge(asked.of(same), new)
    right = judged.worst() <= ACCURACY
    if right.any():
        solution, found = solution.copy(), found.copy()
        solution.put(at[same[right]], new.of(right))
        found.put(at[same[right]], judged.of(right))
    return solution, found


def _units(stress: Array, trial: Array) -> Array:
    return power_of_two(np.where(widest(stress) > 0.0, widest(stress), widest(trial)))


def _same(metric: Metric, g: Level, asked: Increment, new: Solution, old: Solution) -> NDArray[np.bool_]:
    """Where two answers agree, as seen in the metric of k or by their largest components as far as these are vouched for.

    And multipliers, where the slope of g does not tell the stresses apart.  Neither view holds the other: the metric hides a soft
    force behind a stiff one, and in components a slip may be right that a stiffness makes a wrong stress of.
    """
    size, far = _units(new.stress, asked.trial), power_of_two(widest(asked.trial))
    largest = metric.of_slip.max()
    reach, moved = (length(times(x / far[:, None], metric.of_stress)) for x in (new.stress, new.stress - old.stress))
    way, lost = (length(times(x, metric.of_slip / largest) * (largest / far)[:, None]) for x in (new.slip, new.slip - old.slip))
    alike = (moved <= ACCURACY * reach) & (lost <= ACCURACY * (reach + way))
    stiffest = float(np.max(np.diagonal(asked.stiffness)))
    each = zip(old.stress, old.slip, new.stress, new.slip, strict=True)
    alike |= np.array([departure(*one, stiffest) <= ACCURACY for one in each], dtype=np.bool_)
    slope = g.gradient(new.stress, asked.pressure, size)
    turned = widest(slope - g.gradient(old.stress, asked.pressure, size)) > ACCURACY * widest(slope)
    same = np.abs(new.multiplier - old.multiplier) * way <= ACCURACY * new.multiplier * (reach + way)  # a short slip has lost its own too
    return np.asarray(alike & (same | turned))
