"""The convex hull of K of more than two forces, where it follows from that of a section by the plane of two.

If the square of the gauge is gamma(x, y)^2 + (z/Z)^2 + ..., that of the hull is so too, with the gauge of the section's hull in place
of gamma: the squares of the support functions add up.  If g is gamma(s) + h(p), gamma a symmetric gauge of the deviator s and p the mean
stress, all sections across the hydrostatic axis are alike, and so are their hulls.  Both are looked for in floating point; what is proved
is proved of the text.
"""

from __future__ import annotations

from itertools import combinations, permutations

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.numpy_ import evaluate
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.regions.mending.by_hull import polygon
from duhem.regions.mending.formulas import decimal, greatest, linear, total
from duhem.regions.mending.limit_load import ScaledLaw, limit_loads, scale_of

__all__ = ["by_sections"]

Array = NDArray[np.float64]
_ALIKE, _FAR = 1e-9, 5e-3


def by_sections(scaled: ScaledLaw) -> tuple[str, str]:
    """g of a law whose K contains the hull closely, and what it is; InputError where the hull does not follow from a section."""
    if (found := _of_a_deviator(scaled) or _of_squares(scaled)) is None:
        what = "of more than two forces, the hull is known of sums of squares and of cones about the hydrostatic axis"
        raise InputError(what, where=scaled.law.name, remedy="mend it by parameters or coefficients")
    return found


def _of_squares(scaled: ScaledLaw) -> tuple[str, str] | None:
    law, ways, n = scaled.law, scaled.ways, len(scaled.law.forces)
    ends = limit_loads(law, scaled.values, np.eye(n)) / scaled.size
    for pair in combinations(range(n), 2):
        rest = [k for k in range(n) if k not in pair]
        flat = np.where(np.isin(np.arange(n), pair), ways, 0.0)
        lengths = np.linalg.norm(flat, axis=1)
        loads = limit_loads(law, scaled.values, flat / lengths[:, None]) / scaled.size
        squares = (lengths / loads) ** 2 + np.sum((ways[:, rest] / ends[rest]) ** 2, axis=1)
        if np.allclose(squares * scaled.loads**2, 1.0, rtol=_ALIKE):
            forces, symbols = tuple(law.forces[k] for k in pair), law.force_symbols()
            free = {name: own for name, own in law.parameters.items() if own.value is None}
            round_ = {symbols[k]: sp.Rational(decimal(ends[k])) * symbols[k] for k in pair}  # that long sets are seen as well as others
            g = law.g.xreplace({**law.settled(), **round_, **{symbols[k]: sp.S.Zero for k in rest}})
            section = scale_of(Criterion(law.name, formula(g), free, forces, law.pressure))
            sides, told = polygon(section, far=_FAR * float(scaled.loads.mean() / scaled.loads.max()))
            others = (f"({law.forces[k]}/{decimal(ends[k])})**2" for k in rest)
            face = f"pos({greatest(linear(side / ends[list(pair)], forces) for side in sides)})**2"
            return f"{total([face, *others])} - ({scaled.text})**2", f"{told}, in the plane of {' and '.join(forces)}"
    return None


def _of_a_deviator(scaled: ScaledLaw) -> tuple[str, str] | None:
    law, symbols = scaled.law, scaled.law.force_symbols()
    if law.stress is None or law.stress.kind != "principal" or scaled.powers:
        return None
    g, mean = law.g.xreplace(law.settled()), sp.Symbol("mean", real=True)
    x, y, z = symbols
    gauge = g.xreplace({z: -x - y}) - g.xreplace(dict.fromkeys(symbols, sp.S.Zero))
    axis = g.xreplace(dict.fromkeys(symbols, mean))
    points = scaled.ways * np.abs(evaluate(g, dict.fromkeys(symbols, 0.0)))

    def level(points: Array) -> Array:
        return evaluate(gauge, dict(zip((x, y), (points - points.mean(axis=1, keepdims=True)).T, strict=False)))

    own, whole = level(points), evaluate(g, dict(zip(symbols, points.T, strict=True)))
    alike = [level(2.0 * points) / 2.0, whole - evaluate(axis, {mean: points.mean(axis=1)})]
    if not all(np.allclose(own, other, atol=_ALIKE) for other in (*alike, *(level(points[:, list(p)]) for p in permutations(range(3))))):
        return None
    sides, told = polygon(scale_of(Criterion(law.name, f"{formula(gauge)} - 1", {}, law.forces[:2], None)))
    weights = np.column_stack([sides, np.zeros(len(sides))])
    weights = -np.sort(weights.mean(axis=1, keepdims=True) - weights, axis=1)  # of stresses in order: the greatest of all permutations
    stresses = [f"principal({law.stress.name}, {k})" for k in (1, 2, 3)]
    rest = formula(axis.xreplace({mean: sp.Add(*symbols) / 3}))
    return f"{greatest(linear(row, stresses) for row in weights)} + {rest}", f"{told}, across the hydrostatic axis"
