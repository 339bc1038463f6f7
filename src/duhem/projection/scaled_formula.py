"""A criterion in units of its own size: g(R s, sigma_n) = R^degree h(s, q), whatever units the stresses come in.

The parts of g that no force enters (mu |sigma_n|, a cohesion, a yield stress) become data q with a weight each, so that
q(R) = q / R^weight carries all units and h is one formula for every pressure and every scale R > 0 (Buckingham 1914).
Where g has no such degree (exp(sigma_a/c), say), h(s; R, sigma_n) = g(R s, sigma_n) with degree 0, R a datum like others.

A :class:`Level` is h at stresses sigma = R s of any size, R a power of two: its sign, its slope dh/ds, and how sure they are.  No power
of a stress leaves the range of doubles, and a value of h over a slope is a length in units of R.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression import Table, fold
from duhem.expression.dimensions import weighing
from duhem.expression.error_bounds import Bounded, BoundedProgram, bounded
from duhem.expression.jets import Choices, Jet, JetProgram, formula, program
from duhem.expression.numpy_ import Program, compiled
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.vocabulary import Neg, Norm, Pos
from duhem.projection.increment import Increment
from duhem.projection.result import Array
from duhem.projection.row_by_row import widest

__all__ = ["Datum", "Level", "ScaledFormula", "grown", "level", "level_of", "may_cancel", "of_pressure_alone", "power_of_two", "scaled"]

_DIGITS = 40  # of a root of a number
_TELLING = 2.0**-40  # of a datum: a value whose rounding may be more than this share of it has lost digits
_BITS = 1600  # of the balls that give them back
_LEAST = 2.0**-1022  # a number with an exponent of its own
_EXPONENT = np.int64(0x7FF << 52)  # of a double, in its bits


@dataclass(frozen=True)
class Datum:
    """A part of g without forces, and the power of R that is its unit."""

    expr: sp.Expr
    weight: sp.Expr


@dataclass(frozen=True)
class ScaledFormula:
    """``expr`` = h over the force symbols and the symbols of ``data``; ``degree`` the power of R that is its unit."""

    expr: sp.Expr
    degree: float
    data: Mapping[sp.Symbol, Datum]
    pressure: sp.Symbol | None

    def unstressed(self, forces: Iterable[sp.Symbol]) -> sp.Expr:
        """h where no force acts, over the data; nan where it is not defined."""
        try:
            found = self.expr.xreplace(dict.fromkeys(forces, sp.S.Zero))
        except (TypeError, ValueError):  # of a word that compares what is infinite, or none
            return sp.nan
        return sp.nan if found.has(sp.AccumBounds) else found  # SymPy's atan of what is infinite to either side

    def values(self, pressure: Array, scale: Array) -> dict[sp.Symbol, Array]:
        """The data at each point, in units of ``scale`` = R > 0 (N,); ``pressure`` sigma_n (N,) in Pa.  Overflow shows as inf."""
        given, found = self._known(pressure), {}
        with np.errstate(all="ignore"):
            for q, d in self.data.items():
                plain = _datum_value(d.expr, tuple(given))
                value = of_pressure_alone(d.expr, given).value if plain is None else plain(*given.values())
                found[q] = _each(value / _unit(d, scale), scale)
        return found

    def bounded(self, pressure: Array, scale: Array) -> dict[sp.Symbol, tuple[Array, Array | float]]:
        """The same, each with a bound of its rounding, 0.0 where there is none."""
        given, found = self._known(pressure), {}
        with np.errstate(all="ignore"):
            for q, d in self.data.items():
                value, off = of_pressure_alone(d.expr, given)
                unit = _unit(d, scale)
                exact = isinstance(off, float) and off == 0.0
                found[q] = _each(value / unit, scale), 0.0 if exact else _each(off / unit, scale)
        return found

    def _known(self, pressure: Array) -> dict[sp.Symbol, Array]:
        return {} if self.pressure is None else {self.pressure: pressure}


def _each(value: Any, scale: Array) -> Array:
    return value if np.shape(value) == scale.shape else np.broadcast_to(value, scale.shape)


def _unit(datum: Datum, scale: Array) -> Array | float:
    return scale if datum.weight == 1 else 1.0 if datum.weight == 0 else np.asarray(scale ** float(datum.weight))


@lru_cache(maxsize=256)
def _datum_value(expr: sp.Expr, known: tuple[sp.Symbol, ...]) -> Program | None:
    """The program of a datum in which nothing can cancel; None for one that is worked out with a bound of its rounding."""
    return None if may_cancel(expr) else compiled(expr, known)


_SAFE = (sp.Symbol, sp.Number, sp.NumberSymbol, sp.Mul, sp.Pow, sp.Abs, sp.Max, sp.Min, Norm, Pos, Neg)


def may_cancel(expr: sp.Basic) -> bool:
    """Whether digits may be lost in it: in a sum whose terms are not known to be of one sign, in an exponent or in a function."""
    if isinstance(expr, sp.Add):
        kept = all(a.is_nonnegative for a in expr.args) or all(a.is_nonpositive for a in expr.args)
    else:
        kept = isinstance(expr, _SAFE) and not (isinstance(expr, sp.Pow) and expr.exp.free_symbols)
    return not kept or any(may_cancel(a) for a in expr.args)


def of_pressure_alone(expr: sp.Expr, given: Mapping[sp.Symbol, Array]) -> Bounded:
    """The value of a formula of the pressure, where there is one, and a bound of its rounding.

    Digits that cancel, as in 1 - exp(-x) at a small x, are worked out in balls.
    """
    value, off = bounded(expr, tuple(given)).found(list(given.values()), [0.0] * len(given))
    if isinstance(off, float) and off == 0.0:
        return Bounded(value, off)
    lost = np.logical_not(off <= _TELLING * np.abs(value))
    if not np.any(lost):
        return Bounded(value, off)
    value, off, lost, *pressures = (np.array(x) for x in np.broadcast_arrays(value, off, lost, *given.values()))
    points = [*zip(*(x[lost].tolist() for x in pressures), strict=True)] or [()] * np.count_nonzero(lost)  # () of one without a pressure
    known = {point: _enclosed(expr, tuple(given), point) for point in set(points)}
    each = np.array([known[point] for point in points]).reshape(-1, 2)
    better = each[:, 1] < off[lost]
    value[lost], off[lost] = np.where(better, each[:, 0], value[lost]), np.where(better, each[:, 1], off[lost])
    return Bounded(value, off)


def _enclosed(expr: sp.Expr, known: tuple[sp.Symbol, ...], point: tuple[float, ...]) -> tuple[float, float]:
    """The double nearest to the value at a point, and how far it may be off; nan where nobody knows."""
    import flint

    with flint.ctx.workprec(_BITS):
        found = _in_balls(expr, known)(*map(flint.arb, point))
        if not found.is_finite():
            return np.nan, np.nan
        value = float(found.mid())
        return value, float(found.rad()) + 2.0**-53 * abs(value) + 2.0**-1074


@lru_cache(maxsize=256)
def _in_balls(expr: sp.Expr, known: tuple[sp.Symbol, ...]) -> Callable[..., Any]:
    from duhem.expression import balls

    return balls.compiled(expr, known)


def power_of_two(size: Array) -> Array:
    """The power of two below, 1 of what is not a positive number: scaling by it is exact."""
    found = np.asarray((np.ascontiguousarray(size).view(np.int64) & _EXPONENT).view(np.float64))  # a number without its digits
    if not (size.min(initial=1.0) >= _LEAST and size.max(initial=1.0) < np.inf):
        sound = np.isfinite(size) & (size > 0.0)
        return np.where(sound, np.ldexp(1.0, np.frexp(np.where(sound, size, 1.0))[1] - 1), 1.0)
    return found


def grown(number: Array, size: Array, power: float) -> Array:
    """number size^power for powers of two ``size``, right where that is a double and size^power is none; inf beyond doubles."""
    exponent = power * (np.frexp(size)[1] - 1)
    whole = np.floor(exponent).astype(np.int32)
    with np.errstate(over="ignore"):
        return np.asarray(np.ldexp(number * np.exp2(exponent - whole), whole))


def scaled(g: sp.Expr, forces: Iterable[sp.Symbol], pressure: sp.Symbol | None) -> ScaledFormula:
    """``g``, a formula over ``forces`` and ``pressure`` with numbers for parameters, as h and the data of h."""
    return _scaled(g, frozenset(forces), pressure)


@lru_cache(maxsize=256)
def _scaled(g: sp.Expr, acting: frozenset[sp.Symbol], pressure: sp.Symbol | None) -> ScaledFormula:
    try:
        weigher = _Weigher(acting, pressure)
        part = fold(recognised(g), weigher.table(), weigher.leaf)
        if part.weight is not None:
            return ScaledFormula(part.expr, float(part.weight), weigher.data, pressure)
    except _NoDegree:
        pass
    size = sp.Dummy("R", positive=True)
    data = {size: Datum(sp.S.One, sp.S.NegativeOne)}
    if pressure is not None and g.has(pressure):
        data[pressure] = Datum(pressure, sp.S.Zero)
    return ScaledFormula(g.xreplace({f: size * f for f in acting}), 0.0, data, pressure)


class _NoDegree(Exception):
    """The formula is not homogeneous in the forces, whatever its data weigh."""


@dataclass(frozen=True)
class _Part:
    """A sub-expression of h and its weight; no weight where no force enters: it takes the one its place asks for."""

    expr: Any
    weight: sp.Expr | None


class _Weigher:
    """Builds h from the leaves up and collects its data."""

    def __init__(self, forces: frozenset[sp.Symbol], pressure: sp.Symbol | None) -> None:
        self.forces, self.pressure = forces, pressure
        self.data: dict[sp.Symbol, Datum] = {}

    def leaf(self, node: Any) -> _Part:
        return _Part(node, sp.S.One if node in self.forces else None)

    def table(self) -> Table[_Part]:
        rows = weighing(
            {
                "alike": self.alike,
                "kept": self.kept,
                "pure": self.free,
                "angle": lambda node, *parts: self.placed(node, *parts, number=True),
                "placed": self.placed,
                "compared": self.free,
                "chosen": self.free,
                "product": self.product,
                "power": self.power,
            }
        )
        return {**rows, PNorm: self.pnorm}

    def free(self, node: sp.Basic, *parts: _Part) -> _Part:
        """A function, a comparison or a choice: fine where no force or only a dimensionless one enters."""
        if any(p.weight not in (None, 0) for p in parts):
            raise _NoDegree
        weight = None if all(p.weight is None for p in parts) else sp.S.Zero
        return _Part(node if weight is None else node.func(*(p.expr for p in parts)), weight)

    def alike(self, node: Any, *parts: _Part) -> _Part:
        return self._gather(node.func, node, parts)

    def pnorm(self, node: Any, p: _Part, *parts: _Part) -> _Part:
        return self._gather(lambda *args: PNorm(p.expr, *args), node, parts)

    def placed(self, node: Any, *parts: _Part, number: bool = False) -> _Part:
        """Of parts of one unit in their places; it is the result's unless that is a ``number``, an angle."""
        weights = {p.weight for p in parts if p.weight is not None}
        if len(weights) > 1:
            raise _NoDegree
        if not weights:
            return _Part(node, None)
        weight = weights.pop()
        whole = node.func(*(self.datum(p.expr, weight) if p.weight is None else p.expr for p in parts))
        return _Part(whole, sp.S.Zero if number else weight)

    def _gather(self, build: Any, node: Any, parts: tuple[_Part, ...]) -> _Part:
        weights = {p.weight for p in parts if p.weight is not None}
        if not weights:
            return _Part(node, None)
        if len(weights) > 1:
            raise _NoDegree
        weight = weights.pop()
        moving, still = ([p.expr for p in parts if (p.weight is None) is free] for free in (False, True))
        return _Part(build(*moving, *([self.datum(build(*still), weight)] if still else [])), weight)

    def kept(self, node: Any, part: _Part) -> _Part:
        return _Part(node, None) if part.weight is None else _Part(node.func(part.expr), part.weight)

    def product(self, node: Any, *parts: _Part) -> _Part:
        moving = [p for p in parts if p.weight is not None]
        if not moving:
            return _Part(node, None)
        factor = sp.Mul(*(p.expr for p in parts if p.weight is None))
        weight = sp.S.Zero if factor.is_number else self._pressure_degree(factor)
        kept = factor if factor.is_number else self.datum(factor, weight)
        return _Part(sp.Mul(kept, *(p.expr for p in moving)), sp.Add(weight, *(p.weight for p in moving)))

    def _pressure_degree(self, factor: sp.Expr) -> sp.Expr:
        """|sigma_n|^n has weight n; any other factor (a coefficient that depends on pressure) is a pure number, weight 0."""
        if self.pressure is None:
            return sp.S.Zero
        base, exponent = factor.as_independent(self.pressure, as_Add=False)[1].as_base_exp()
        return exponent if base in (self.pressure, sp.Mul(-1, self.pressure)) else sp.S.Zero

    def power(self, node: Any, base: _Part, exponent: _Part) -> _Part:
        if base.weight is None and exponent.weight is None:
            return _Part(node, None)
        if base.weight is None or not exponent.expr.is_number:
            raise _NoDegree
        return _Part(base.expr**exponent.expr, base.weight * exponent.expr)

    def datum(self, expr: sp.Expr, weight: sp.Expr) -> sp.Expr:
        """The symbol that stands for ``expr``, of the same sign; zero stays zero."""
        if expr.is_zero or (expr.is_number and weight == 0):
            return expr
        if weight not in (0, 1) and expr.is_Add:
            return sp.Add(*(self.datum(term, weight) for term in expr.args))
        if weight > 0 and weight != 1 and (sense := _sense(expr)):
            return sense * self.datum(_root(expr, weight), sp.S.One) ** weight
        for known, datum in self.data.items():
            if datum == Datum(expr, weight):
                return known
        signs = {"nonnegative": True} if expr.is_nonnegative else {"nonpositive": True} if expr.is_nonpositive else {}
        new = sp.Dummy("q", real=True, **signs)
        self.data[new] = Datum(expr, weight)
        return new


def _sense(expr: sp.Expr) -> int:
    """1 or -1 for what is never on the other side of zero, else 0."""
    return 1 if expr.is_nonnegative else -1 if expr.is_nonpositive else 0


def _root(expr: sp.Expr, weight: sp.Expr) -> sp.Expr:
    """|expr|^(1/weight), taken factor by factor: a load is in the range of doubles, its powers are not."""
    if expr.is_Mul:
        return sp.Mul(*(_root(factor, weight) for factor in expr.args))
    if expr.is_Rational:
        return sp.Rational(str(sp.N(sp.Abs(expr) ** (1 / weight), _DIGITS)))
    base, exponent = expr.as_base_exp()
    return sp.Abs(base) ** (exponent / weight) if exponent.is_number else sp.Abs(expr) ** (1 / weight)


# -- h at stresses of any size -----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Level:
    """One law with numbers for parameters; ``level`` makes one a formula, so that what is cached by it is found again."""

    scaled: ScaledFormula
    forces: int
    value: Program
    bounds: BoundedProgram
    jets: JetProgram
    unstressed: Program

    def __call__(self, *values: Array) -> Array:
        """h over arrays of the forces and the pressure, like a program of the formula, each point in units of its own."""
        stress = np.stack(np.broadcast_arrays(*values), axis=-1)[..., : self.forces].reshape(-1, self.forces)
        size = power_of_two(widest(stress))
        pressure = np.broadcast_to(values[-1], values[0].shape).reshape(-1)
        data = self.scaled.values(pressure, size)
        return self.value(*(stress / size[:, None]).T, *data.values()).reshape(values[0].shape)

    def limit(self, stress: Array, pressure: Array, size: Array) -> Array:
        """h at stresses (N, d), or its limit where it is 0/0; R = ``size`` (N,)."""
        return self.value(*(stress / size[:, None]).T, *self.scaled.values(pressure, size).values())

    def rise(self, pressure: Array, size: Array) -> Array:
        """-h at no stress, one or (N,), R = ``size`` (N,): of a convex h no piece that holds at a stress rises less on the way there."""
        return -self.unstressed(*self.scaled.values(pressure, size).values())

    def bounded(self, stress: Array, pressure: Array, size: Array) -> tuple[Array, Array]:
        """h at stresses (N, d) and a bound of its rounding; R = ``size`` (N,), powers of two."""
        return self.placed(stress, pressure, size).bounded()

    def placed(self, stress: Array, pressure: Array, size: Array) -> Placed:
        """Stresses (N, d) and the data there, in units of R = ``size`` (N,), powers of two."""
        s = np.empty(stress.shape[::-1])
        for row, force in zip(s, stress.T, strict=True):
            np.divide(force, size, out=row)
        return Placed(self, s, tuple(self.scaled.bounded(pressure, size).values()))

    def slopes(self, stress: Array, pressure: Array, size: Array, choices: Choices | None = None) -> tuple[Jet, Choices]:
        """h and its gradient dh/ds (N, d) = R^(1 - degree) dg/dsigma."""
        data = self.scaled.values(pressure, size)
        return self.jets(stress / size[:, None], list(data.values()), choices, second=False)

    def gradient(self, stress: Array, pressure: Array, size: Array) -> Array:
        """dh/ds (N, d) alone; nan where it is infinite, so that no level passes for a small share of it."""
        found = self.slopes(stress, pressure, size)[0].gradient
        return np.where(np.isfinite(found), found, np.nan)

    def hessian(self, stress: Array, pressure: Array, size: Array) -> Array:
        """d^2h/ds^2 (N, d, d)."""
        data = self.scaled.values(pressure, size)
        found = self.jets(stress / size[:, None], list(data.values()), None, second=True)[0].hessian
        assert found is not None
        return found

    def multiplier(self, given: Array, size: Array) -> Array:
        """Multipliers of g (N,) as those of h: the slip is that times dh/ds."""
        return given if self.scaled.degree == 1.0 else grown(given, size, self.scaled.degree - 1.0)

    def own(self, multiplier: Array, size: Array) -> Array:
        """The other way."""
        return multiplier if self.scaled.degree == 1.0 else grown(multiplier, size, 1.0 - self.scaled.degree)


@dataclass(frozen=True, eq=False)
class Placed:
    """Points of one level in units of their own: forces ``s`` (d, N), and each of the ``data`` (N,) with a bound of its rounding."""

    level: Level
    s: Array
    data: tuple[tuple[Array, Array | float], ...]

    def of(self, at: NDArray[np.intp]) -> Placed:
        """Some of the points."""
        data = tuple((v.take(at), b if isinstance(b, float) else b.take(at)) for v, b in self.data)
        return Placed(self.level, self.s.take(at, axis=1), data)

    def bounded(self) -> tuple[Array, Array]:
        """h (N,) and a bound of its rounding."""
        return self.level.bounds([*self.s, *(v for v, _ in self.data)], [*[0.0] * len(self.s), *(b for _, b in self.data)])

    def rise(self) -> Array:
        """As of the level."""
        return -self.level.unstressed(*(v for v, _ in self.data))

    def slopes(self) -> Array:
        """dh/ds (d, N)."""
        return np.asarray(self.level.jets(self.s.T, [v for v, _ in self.data], None, second=False)[0].gradient.T)


def level_of(question: Increment) -> Level:
    """The criterion of some increments."""
    return level(question.g, question.law.force_symbols(), question.pressure_symbol)


@lru_cache(maxsize=256)
def level(g: sp.Expr, forces: tuple[sp.Symbol, ...], pressure: sp.Symbol | None) -> Level:
    """``g`` over ``forces`` and ``pressure``, with numbers for parameters."""
    found = scaled(g, forces, pressure)
    names = (*forces, *found.data)
    jets = formula(found.expr, forces, tuple(found.data))
    unstressed = program(found.unstressed(forces), tuple(found.data))
    return Level(found, len(forces), program(found.expr, names), bounded(found.expr, names), jets, unstressed)
