"""Where the boundary of K crosses a seam (two forces): the points at which a kink of the formula shows on the boundary."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.branches import Seam, seams
from duhem.expression.gradient import jacobian
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.search.newton import common_zero
from duhem.proof.search.suggestion import Point

__all__ = ["Crossing", "crossings"]

_MOST = 16  # crossings of one seam
_MOST_EXPONENT = 10_000  # SymPy makes polynomials of so high a degree of a power: that took more than a minute
_START = 8_000  # steps from one cell to a crossing, or to none


@dataclass(frozen=True)
class Crossing:
    """``point`` (decimals of high precision) on the boundary, on a seam with one switch."""

    seam: Seam
    point: Point


def crossings(subject: FormulaSubject, parameters: Values, digits: int = 40) -> Iterator[Crossing]:
    """Common zeros of g and of one seam at a parameter choice, to about ``digits`` decimals; found, not certain; while steps are left."""
    exact, forces = rationals(parameters), subject.simple.forces
    exponents = {x for power in subject.simple.g.atoms(sp.Pow) for x in power.exp.free_symbols}
    if any(abs(value.p) > _MOST_EXPONENT for x, value in exact.items() if x in exponents):
        return
    grid = _Grid(forces, subject.formula_at(parameters))
    for seam in seams(subject.pieces or ()):
        if len(seam.crossed) != 1:
            continue
        system = sp.Matrix([seam.after.expr, *seam.crossed]).subs(exact)
        if not (starts := grid.starts(*system)):
            continue
        slopes = jacobian(system, forces)
        known: list[tuple[Fraction, ...]] = []
        for start in starts:
            if any(math.dist(map(float, point), start) < 0.1 * math.hypot(*start) for point in known):
                continue  # a cell beside one that led here
            if not subject.budget.pays(_START):
                return
            if slopes is not None and (point := common_zero(system, slopes, forces, start, digits)) is not None:
                known.append(point)
                yield Crossing(seam, point)


class _Grid:
    """Points on circles of many radii, a little off the axes, with the signs of what was asked there before."""

    def __init__(self, forces: Sequence[sp.Symbol], g: sp.Expr) -> None:
        import numpy as np  # only when something is looked for

        turn = 2 * np.pi * np.arange(721) / 720 + 1e-9
        radii = 10.0 ** np.linspace(-4, 4, 161)
        self._forces = forces
        self._x, self._y = np.outer(radii, np.cos(turn)), np.outer(radii, np.sin(turn))
        self._known: dict[sp.Expr, Any] = {}
        self._outward = self._along_rays(g)

    def starts(self, level: sp.Expr, seam: sp.Expr) -> list[tuple[float, float]]:
        """Cells where the seam changes sign around the circle, and both the level and g along the ray."""
        import numpy as np

        signs = self._signs(seam)
        cells = (signs[:-1, :-1] != signs[:-1, 1:]) & self._along_rays(level) & self._outward
        return [(float(self._x[i, j]), float(self._y[i, j])) for i, j in np.argwhere(cells)[:_MOST]]

    def _along_rays(self, expr: sp.Expr) -> Any:
        """Whether the sign changes in a cell or in one beside it: a kink may shift the crossing by one."""
        signs = self._signs(expr)
        change = signs[:-1, :-1] != signs[1:, :-1]
        wide = change.copy()
        wide[1:] |= change[:-1]
        wide[:-1] |= change[1:]
        wide[:, 1:] |= change[:, :-1]
        wide[:, :-1] |= change[:, 1:]
        return wide

    def _signs(self, expr: sp.Expr) -> Any:
        import numpy as np

        from duhem.expression.numpy_ import compiled

        if expr not in self._known:
            self._known[expr] = np.sign(np.broadcast_to(compiled(expr, self._forces)(self._x, self._y), self._x.shape))
        return self._known[expr]
