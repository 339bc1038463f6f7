"""A case: increments of one law at one set of parameters, and what the checks compare them with.

Among this is K(sigma_n) of the law, known by the sign of the law's formula alone: nothing here solves an increment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
import sympy as sp
from mpmath import isfinite
from numpy.typing import NDArray

from duhem.expression import mpmath_
from duhem.expression.error_bounds import bounded
from duhem.expression.jets import Choices, JetProgram, formula
from duhem.expression.numpy_ import Program, filled
from duhem.expression.rays import Rays
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array
from duhem.projection.scaled_formula import scaled

__all__ = ["Case", "Region", "vector"]


@dataclass(frozen=True, eq=False)
class Case:
    """N increments; a case of one prints as Python that builds it again to the last bit.

    ``parameters`` by name; ``stiffness`` (d, d) in Pa/m; ``pressure`` (N,), None for a law without; ``trial``, ``other`` and
    ``third`` (N, d) trial stresses under that pressure; ``inside`` and ``beside`` (N, d) stresses of K; ``stretch`` (N,) >= 0,
    a share of the way from stress to trial; ``factor`` > 0, a change of units; ``path`` (N, m, d) k u along a loading path
    and ``loads`` (N, m) its pressures.  Stresses in Pa.
    """

    parameters: Mapping[str, float]
    stiffness: Array
    pressure: Array | None
    trial: Array
    other: Array
    third: Array
    inside: Array
    beside: Array
    stretch: Array
    factor: float
    path: Array
    loads: Array | None

    def __post_init__(self) -> None:
        for field in fields(self)[1:]:
            value = getattr(self, field.name)
            if value is not None and field.name != "factor":
                object.__setattr__(self, field.name, np.asarray(value, dtype=np.float64))

    def __len__(self) -> int:
        return len(self.trial)

    def row(self, i: int) -> Case:
        """Return the case of one increment alone."""
        return self.rows(slice(i, i + 1))

    def rows(self, which: slice | NDArray[np.intp]) -> Case:
        """Return the case of some of the increments."""
        whole = ("parameters", "stiffness", "factor")
        parts = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in whole}
        rows: dict[str, Any] = {name: None if part is None else part[which] for name, part in parts.items()}
        return replace(self, **rows)

    def longest(self, inverse: Array) -> Array:
        """The length |L^-1 s| of the longest stress of each increment (N,), ``inverse`` that of L; inf where its square overflows."""
        stresses = np.stack([self.trial, self.other, self.third, self.inside, self.beside], axis=1)
        with np.errstate(all="ignore"):
            return np.asarray(np.linalg.norm(np.concatenate([stresses, self.path], axis=1) @ inverse.T, axis=2).max(axis=1))

    def fits(self, law: Criterion) -> bool:
        """Whether its parameters, forces and pressure are those of a law, and the values in its domains."""
        domains, values = law.parameters, self.parameters
        named = {*values} == {*domains} and (self.pressure is None) == (law.pressure is None)
        return named and self.trial.shape[1] == len(law.forces) and all(value in domains[name] for name, value in values.items())

    def __repr__(self) -> str:
        if len(self) > 1:
            return f"<Case of {len(self)} increments, parameters {dict(self.parameters)}>"
        return f"Case({', '.join(self.arguments())})"

    def plain(self) -> dict[str, Any]:
        """Return the fields as numbers, lists and dictionaries, from which the case is built again to the last bit."""
        parts = {f.name: getattr(self, f.name) for f in fields(self)} | {"parameters": dict(self.parameters)}
        return {name: part.tolist() if isinstance(part, np.ndarray) else part for name, part in parts.items()}

    def arguments(self) -> list[str]:
        """Return the arguments that build the case again to the last bit, each as ``name=value``."""
        return [f"{name}={part!r}" for name, part in self.plain().items()]

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """As Hypothesis and IPython print: by the representation above, not field by field."""
        printer.text(repr(self))


def vector(values: Iterable[float]) -> str:
    """Numbers in six digits."""
    return f"[{', '.join(f'{x:.6g}' for x in values)}]"


# -- K of a law at parameter values ------------------------------------------------------------------------------------

_DIGITS = 60
_MOVED = 1e-12  # of the way to a stress inside, beyond which a dent is one
_NUDGED, _WAYS = 1e-50, 12  # of a stress, and how many points about it are asked
_FAR = 2.0**64  # a ray that ends farther out, where g has no value in doubles, ends in overflow
_NEAREST, _FARTHEST = 2.0**-128, 2.0**512  # powers of smaller stresses vanish in double precision, and K is the origin alone


@dataclass(frozen=True)
class Region:
    """{g <= 0}, with a number for every parameter.  Arrays: ``stress`` (N, d) and ``pressure`` (N,) in Pa."""

    law: Criterion
    parameters: Mapping[str, float]

    @property
    def homogeneous(self) -> bool:
        """Whether K(c sigma_n) = c K(sigma_n) for all c > 0: no stress but the pressure sets its size, and none is left out."""
        return _homogeneous(self.law)

    def level(self, stress: Array, pressure: Array) -> Array:
        """g (...), in double precision, of stresses (..., d) and pressures (...); nan where it is undefined."""
        return _programs(self.law)[0](*np.moveaxis(stress, -1, 0), *self._others(pressure))

    def slope(self, stress: Array, pressure: Array, choices: Choices | None = None) -> tuple[Array, Choices]:
        """grad g (N, d) of the smooth piece that holds at each stress, or of the one ``choices`` name, and the piece."""
        jet, taken = _programs(self.law)[1](stress, [np.asarray(x) for x in self._others(pressure)], choices, second=False)
        assert jet.gradient is not None
        return jet.gradient, taken

    def huge(self, pressure: Array) -> NDArray[np.bool_]:
        """Whether the pressure (N,) or a parameter is so large that K may end where the law overflows."""
        return np.asarray(np.maximum(np.abs(pressure), max(map(abs, self.parameters.values()), default=0.0)) > _FAR)

    def outside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        """Whether g > 0 (N,), in 60 digits: the stresses count as exact."""
        return np.array([self._exactly(s, p) for s, p in zip(stress.tolist(), pressure.tolist(), strict=True)], dtype=np.bool_)

    def dented(self, first: Array, last: Array, inner: Array, pressure: float) -> bool:
        """Whether ``first`` and ``last`` (d,) lie in K and their middle, moved by 1e-12 of its way to ``inner``, has g > 0; in 60 digits.

        ``inner`` is a stress that surely lies inside: if K is convex, the point moved lies inside K, and farther than 60 digits round.
        """
        if any(self._exactly(end.tolist(), pressure) for end in (first, last)):
            return False
        number = partial(mpmath_.number, mpmath_.kept_digits(_DIGITS))
        p, q, z = (list(map(number, point.tolist())) for point in (first, last, inner))
        middle = [z_ + ((p_ + q_) / 2 - z_) * (1 - number(_MOVED)) for p_, q_, z_ in zip(p, q, z, strict=True)]
        (level,) = _in_digits(self.law)(*middle, *self._others(pressure))
        return bool(isfinite(level) and level > 0)

    def unknown(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        """Where the law does not say whether a stress is in K (N,): g has no value there, nor at the origin, in 60 digits or as a limit.

        Where g has a value at the origin and none at the stress, that lies beyond the domain of g, and outside K.
        """
        found = np.isfinite(stress).all(axis=1) & np.isnan(self.level(stress, pressure))
        found[found] = np.isnan(self.level(np.zeros_like(stress[found]), pressure[found]))
        at = np.flatnonzero(found)
        found[at] = [self._in_many_digits(s, p) is None for s, p in zip(stress[at].tolist(), pressure[at].tolist(), strict=True)]
        return found

    def rounding(self, stress: Array, pressure: Array) -> Array:
        """A bound (N,) on what evaluating g in doubles may be off by, as the formula is written; 0 where none is known.

        Running bounds (:mod:`duhem.expression.error_bounds`): N. J. Higham (2002), Accuracy and Stability, section 3.3.
        """
        _, bound = self._bounded(stress, pressure)
        return np.where(np.isfinite(bound), bound, 0.0)

    def surely_inside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        """Where the bound of rounding leaves no doubt that g < 0 (N,)."""
        value, bound = self._bounded(stress, pressure)
        return np.asarray(value + 2.0 * bound < 0.0)  # twice: the bound is itself rounded

    def _bounded(self, stress: Array, pressure: Array) -> tuple[Array, Array]:
        values = [np.asarray(x) for x in (*stress.T, *self._others(pressure))]
        return bounded(self.law.g, tuple(self.law.symbols().values()))(values, [0.0] * len(values))

    def reach(self, way: Array, pressure: Array, bits: int = 64) -> Array:
        """The largest r (N,) with r ``way`` in K, from within, to the last digit or so many ``bits`` of 64; 0 without the origin.

        inf where K does not end, or not before powers of the stress overflow.

        K is taken to be star-shaped about the origin, as a convex one is that contains it.  Where the origin lies on the boundary
        rounding of g may seem to admit a little of a ray that leaves K at once: half of it is looked at in 60 digits.
        """

        load, ends = pressure[:, None], np.array([_NEAREST, _FARTHEST])
        rays = Rays(lambda points: self.level(points, load), np.zeros(way.shape[1]), way)
        inside = rays.inside(ends)
        near, far = np.repeat(ends[:, None], len(way), axis=1)
        last, beyond = rays.ended(near, far, bits=bits)
        lost = (last > _FAR) & ~np.isfinite(self.level(rays.at(beyond), pressure))
        found = np.where(~inside[:, 0], 0.0, np.where(inside[:, 1] | lost, np.inf, last))
        edge = np.flatnonzero((found > 0.0) & np.isfinite(found) & ~(self.level(np.zeros_like(way), pressure) < 0.0))
        found[edge[self.outside(0.5 * found[edge, None] * way[edge], pressure[edge])]] = 0.0
        return found

    def _others(self, pressure: Any) -> list[Any]:
        """Pressure 0 as -0.0, the end of those that press: a pole there has the sign that it has beside it."""
        load = np.where(pressure == 0.0, -0.0, pressure)[()]
        return [*([load] if self.law.pressure else []), *(self.parameters[name] for name in self.law.parameters)]

    def _exactly(self, stress: list[float], pressure: float) -> bool:
        level = self._in_many_digits(stress, pressure)
        return level is None or not level <= 0

    def _in_many_digits(self, stress: list[float], pressure: float) -> Any:
        """g, or its limit, if it has one; None where it has neither."""
        (level,) = _in_digits(self.law)(*stress, *self._others(pressure))
        if not isfinite(level):  # mpmath has no -0.0
            level = self.level(np.array([stress]), np.array([pressure]))[0]
        return level if level == level else self._beside(stress, pressure)

    def _beside(self, stress: list[float], pressure: float) -> Any:
        """g as close to the stress as 60 digits tell, where rounding alone took its value: |x| + x is a little below 0 for some x < 0."""
        number, far = partial(mpmath_.number, mpmath_.kept_digits(_DIGITS)), max(map(abs, stress))
        for way in _ways(len(stress)):
            there = [number(x) + number(far) * number(_NUDGED) * number(w) for x, w in zip(stress, way, strict=True)]
            (level,) = _in_digits(self.law)(*there, *self._others(pressure))
            if isfinite(level):
                return level
        return None


@lru_cache(maxsize=8)
def _ways(d: int) -> list[list[float]]:
    return np.random.default_rng(0).standard_normal((_WAYS, d)).tolist()


@lru_cache(maxsize=64)
def _programs(law: Criterion) -> tuple[Program, JetProgram]:
    names = tuple(law.symbols().values())
    forces = law.force_symbols()
    return filled(law.g, names), formula(law.g, forces, names[len(forces) :])


@lru_cache(maxsize=64)
def _in_digits(law: Criterion) -> Callable[..., list[Any]]:
    """g of the values of all symbols, in 60 digits."""
    return mpmath_.compiled([law.g], law.symbols().values(), mpmath_.digits(_DIGITS))


@lru_cache(maxsize=64)
def _homogeneous(law: Criterion) -> bool:
    if law.pressure is None or law.domain:
        return False
    pressure = law.symbols()[law.pressure]
    parts = scaled(law.g, law.force_symbols(), pressure)
    c = sp.Dummy("c", positive=True)
    if any(d.weight.free_symbols for d in parts.data.values()):
        return False
    return all(sp.simplify(d.expr.xreplace({pressure: c * pressure}) - c**d.weight * d.expr) == 0 for d in parts.data.values())
