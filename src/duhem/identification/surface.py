"""The signed distance of a limit point from the boundary of K, to first order, as a function of the parameters.

    distance = g / |dg/dsigma|,   normal = (dg/dsigma) / |dg/dsigma|,   both at the measured point

It is the orthogonal distance up to a relative error of distance over radius of curvature, whatever multiple or power
of g the law is written with (P. D. Sampson, 1982, Comput. Graph. Image Process. 18, 97-108), positive outside K.
A :class:`Surface` knows it for one law at the prescribed pressures; the parameters are those left free, in order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.jets import JetProgram, formula
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants

__all__ = ["AnyFormula", "QuarterEllipses", "Surface", "free_parameters", "surface"]

Array = NDArray[np.float64]

_STEP = float(np.cbrt(np.finfo(np.float64).eps))


class Surface(Protocol):
    """Distance and its derivatives at ``forces`` (m, d) for the parameters ``names``, of values ``theta`` (p,)."""

    names: tuple[str, ...]

    def distance(self, forces: Array, theta: Array) -> tuple[Array, Array]:
        """Return the signed distance (m,) in the unit of the stresses, and the outward unit normal (m, d)."""
        ...

    def slope(self, forces: Array, theta: Array) -> Array:
        """Return the slopes d distance / d theta (m, p)."""
        ...


def free_parameters(law: Criterion) -> tuple[str, ...]:
    """Return the parameters without a fixed value, in the order of their declaration."""
    return tuple(name for name, domain in law.parameters.items() if domain.value is None)


def surface(law: Criterion, pressure: Array | None) -> Surface:
    """Return the surface of a law: quarter ellipses if the law declares them about the origin, else the surface of its formula."""
    return QuarterEllipses.of(law, pressure) or AnyFormula(law, pressure)


class QuarterEllipses:
    """Quarter ellipses with half-axes mu |sigma_n| about the origin (Antoni et al. 2007, Eq. 35; Coulomb; an interval).

    In w = 1/mu^2 the boundary is linear: q = sum_k w_k A_k = 1, A_k the sum of squares of those sigma_i/|sigma_n| whose
    sign belongs to coefficient k.  ``senses`` has, for each force, the coefficients of its positive and negative values.
    """

    def __init__(self, names: Sequence[str], senses: Mapping[str, tuple[str, str]], fixed: Mapping[str, float], load: Array) -> None:
        self.names, self.load = tuple(names), load
        self._forces, self._senses, self._fixed = tuple(senses), tuple(senses.values()), dict(fixed)

    @classmethod
    def of(cls, law: Criterion, pressure: Array | None) -> QuarterEllipses | None:
        """Return the shape that a law declares, if it is of this kind and each half-axis is a parameter; else None."""
        shape = law.closed_form
        if shape is None or pressure is None or law.pressure is None:
            return None
        table = law.symbols()
        match shape:
            case Interval(plus, minus):
                senses = [(plus, minus)]
            case Disk(coefficient):
                senses = [(coefficient, coefficient)] * 2
            case Quadrants(a_plus, a_minus, b_plus, b_minus) if shape.centre_a == 0 == shape.centre_b:
                senses = [(a_plus, a_minus), (b_plus, b_minus)]
            case _:
                return None
        parameters = {table[name]: name for name in law.parameters}
        entries = {entry for pair in senses for entry in pair}
        if shape.slope != 1 or shape.load != sp.Abs(table[law.pressure]) or not entries <= set(parameters):
            return None
        values = {name: float(domain.value) for name, domain in law.parameters.items() if domain.value is not None}
        named = {force: (parameters[p], parameters[n]) for force, (p, n) in zip(law.forces, senses, strict=True)}
        return cls(free_parameters(law), named, values, np.abs(pressure))

    def senses(self, name: str) -> str:
        """Return where the distance depends on a coefficient, for example ``sigma_a < 0``."""
        signs = [
            (f"{f} {sign} 0", n) for f, pair in zip(self._forces, self._senses, strict=True) for sign, n in zip("><", pair, strict=True)
        ]
        return " or ".join(sense for sense, n in signs if n == name)

    def squares(self, forces: Array) -> tuple[Array, Array, Array]:
        """A (m, p), and what the fixed coefficients add to q and to sum w^2 A (m,)."""
        squared = np.square(forces / self.load[:, None])
        free, fixed, steep = np.zeros((len(forces), len(self.names))), np.zeros(len(forces)), np.zeros(len(forces))
        for i, pair in enumerate(self._senses):
            for name, side in zip(pair, (forces[:, i] > 0.0, forces[:, i] < 0.0), strict=True):
                part = np.where(side, squared[:, i], 0.0)
                if name in self._fixed:
                    w = self._fixed[name] ** -2
                    fixed, steep = fixed + w * part, steep + w * w * part
                else:
                    free[:, self.names.index(name)] += part
        return free, fixed, steep

    def distance(self, forces: Array, theta: Array) -> tuple[Array, Array]:
        a, fixed, steep = self.squares(forces)
        w = theta**-2.0
        gauge, norm = np.sqrt(fixed + a @ w), np.sqrt(steep + a @ (w * w))
        coefficient = dict(zip(self.names, theta, strict=True)) | self._fixed
        gradient = np.empty_like(forces)
        for i, (plus, minus) in enumerate(self._senses):
            gradient[:, i] = forces[:, i] / np.square(np.where(forces[:, i] > 0.0, coefficient[plus], coefficient[minus]))
        return self.load * (gauge - 1.0) * gauge / norm, gradient / (norm * self.load)[:, None]

    def slope(self, forces: Array, theta: Array) -> Array:
        a, fixed, steep = self.squares(forces)
        w = theta**-2.0
        q, s = fixed + a @ w, steep + a @ (w * w)
        gauge, norm = np.sqrt(q), np.sqrt(s)
        by_w = (1.0 - 0.5 / gauge)[:, None] * a / norm[:, None] - ((q - gauge) / (norm * s))[:, None] * a * w
        return np.asarray(self.load[:, None] * by_w * (-2.0 * w / theta))


class AnyFormula:
    """Any law, from its formula: derivatives in the forces by jets, in the parameters by central differences."""

    def __init__(self, law: Criterion, pressure: Array | None) -> None:
        table = law.symbols()
        self.names = free_parameters(law)
        self._jets: JetProgram = formula(
            law.g, law.force_symbols(), [table[n] for n in (*([law.pressure] if law.pressure else []), *law.parameters)]
        )
        self._pressure = [] if pressure is None else [pressure]
        self._fixed = {name: float(domain.value) for name, domain in law.parameters.items() if domain.value is not None}
        self._order = tuple(law.parameters)

    def distance(self, forces: Array, theta: Array) -> tuple[Array, Array]:
        values = dict(zip(self.names, theta.tolist(), strict=True)) | self._fixed
        jet, _ = self._jets(forces, [*self._pressure, *(np.array(values[name]) for name in self._order)], second=False)
        assert jet.gradient is not None
        size = np.linalg.norm(jet.gradient, axis=1)
        with np.errstate(all="ignore"):
            return jet.value / size, jet.gradient / size[:, None]

    def slope(self, forces: Array, theta: Array) -> Array:
        columns = []
        for j, value in enumerate(theta):
            step = np.zeros_like(theta)
            step[j] = _STEP * max(abs(value), _STEP)
            high, low = self.distance(forces, theta + step)[0], self.distance(forces, theta - step)[0]
            columns.append((high - low) / ((theta + step)[j] - (theta - step)[j]))
        return np.column_stack(columns) if columns else np.empty((len(forces), 0))
