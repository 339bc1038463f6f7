"""The slip increment in some fifty digits: the optimality conditions of the closest point, solved from the formula.

Directions along which K does not end are taken out, what is left is scaled to size 1 and handed to the search.

What counts is the residual that comes with each answer: for a convex K the optimality conditions are sufficient, and the
error of the stress in the metric of k^-1 is at most the residual's share of the way to the trial stress.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from mpmath import MPContext

from duhem.benchmark.reference.formula import NoReference, PreciseFormula, Slice, within_reach
from duhem.benchmark.reference.ray import extents
from duhem.benchmark.reference.search import Search
from duhem.expression.lineality import invariant_directions
from duhem.expression.mpmath_ import number

__all__ = ["Closest", "ReferenceIncrement", "distance"]

_GUARD = 3  # times the digits asked for: differences take a part of them, extreme aspects another


@dataclass(frozen=True)
class ReferenceIncrement:
    """Stress (Pa), slip k^-1 (trial - stress) and multiplier of g, as ``mpf``; ``slips`` whether the trial lies outside K.

    ``residual``: the optimality conditions, relative to the slip and to the size of K: the reference's own error, never less
    than the rounding of the differences it rests on.
    """

    stress: tuple[Any, ...]
    slip: tuple[Any, ...]
    multiplier: Any
    slips: bool
    residual: float


def distance(got: Sequence[float], exact: Sequence[Any], unit: Any = None) -> float:
    """The largest |got - exact| relative to ``unit``, by default the largest |exact|; the difference is taken in many digits."""
    off = max(abs(float(a) - b) for a, b in zip(got, exact, strict=True))
    size = max(abs(b) for b in exact) if unit is None else unit
    return float("nan") if off != off else 0.0 if off == 0 else float("inf") if size == 0 else float(off / size)


class Closest:
    """Closest points of one law with numbers for parameters: ``g`` over ``forces`` and ``pressure``, convex in the forces.

    ``stiffness`` (d, d) in Pa/m.  Floats are taken exactly.  Raises NoReference where K has more than two bounded
    directions, or does not contain the origin, and where its digits do not suffice.
    """

    def __init__(
        self, g: sp.Expr, forces: Sequence[sp.Symbol], pressure: sp.Symbol | None, stiffness: Sequence[Sequence[float]], digits: int = 50
    ) -> None:
        self.digits, self.context = digits, MPContext()
        self.context.dps = _GUARD * digits
        self.formula = PreciseFormula(g, (*forces, *([] if pressure is None else [pressure])), self.context)
        mp, d = self.context, len(forces)
        k = mp.matrix([[mp.mpf(float(x)) for x in row] for row in stiffness])
        with within_reach(mp.dps):
            self.compliance = k**-1
        endless = [mp.matrix([int(c) for c in v]) for v in invariant_directions(g, forces)]
        self.endless = endless
        self.columns = mp.eye(d) if not endless else k * _normals(mp, endless, d)
        if self.columns.cols > 2:
            raise NoReference(f"the reference handles two bounded directions, K has {self.columns.cols}")

    def __call__(self, trial: Sequence[float], pressure: float | None = None) -> ReferenceIncrement:
        """The closest point to ``trial`` (d,) in Pa under ``pressure`` sigma_n <= 0 in Pa."""
        with within_reach(self.context.dps):
            return self._found(trial, pressure)

    def _found(self, trial: Sequence[float], pressure: float | None) -> ReferenceIncrement:
        mp = self.context
        x = mp.matrix([mp.mpf(float(t)) for t in trial])
        tail = [] if pressure is None else [mp.mpf(float(pressure))]
        level = self.formula.read([*x, *tail]).value
        if mp.isnan(level):
            raise NoReference("g is not defined at the trial stress")
        if level <= 0:
            zero = mp.mpf(0)
            return ReferenceIncrement(tuple(x), (zero,) * len(x), zero, False, 0.0)
        aim = x - self._along(x)
        b = self.columns
        metric = b.T * self.compliance * b
        y = list(mp.lu_solve(metric, b.T * self.compliance * aim))
        plain = Slice(self.formula, b.tolist(), tail)
        size = extents(plain, y)
        if size is None:  # K is the origin alone
            return ReferenceIncrement((mp.mpf(0),) * len(x), tuple(self.compliance * x), mp.nan, True, 0.0)
        sliced = Slice(self.formula, [[c * s for c, s in zip(row, size, strict=True)] for row in b.tolist()], tail)
        scaled = [[metric[i, j] * size[i] * size[j] for j in range(len(y))] for i in range(len(y))]
        unit = max(scaled[i][i] for i in range(len(y)))
        scaled = [[c / unit for c in row] for row in scaled]
        target = [c / s for c, s in zip(y, size, strict=True)]
        found = Search(sliced, scaled, target, self.digits).run()
        stress = mp.matrix(sliced.forces(found.w)) + self._along(x)
        return ReferenceIncrement(
            tuple(stress),
            tuple(self.compliance * (x - stress)),
            found.multiplier * unit,
            True,
            float(max(found.residual, self.formula.step**2)),
        )

    def _along(self, x: Any) -> Any:
        """The part of ``x`` along which K does not end, in the metric of k^-1."""
        mp = self.context
        if not self.endless:
            return mp.matrix(len(x), 1)
        lines = mp.matrix([list(v) for v in self.endless]).T
        return lines * mp.lu_solve(lines.T * self.compliance * lines, lines.T * self.compliance * x)


def _normals(mp: Any, endless: Sequence[Any], d: int) -> Any:
    """A basis (d, d - r) of what is orthogonal to the endless directions."""
    space = sp.Matrix([[int(c) for c in v] for v in endless]).nullspace()
    return mp.matrix([[number(mp, v[i]) for v in space] for i in range(d)])
