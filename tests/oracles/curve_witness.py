"""A second opinion on witnesses of laws given by a boundary curve: mpmath's intervals, and turns of a polygon."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from mpmath.ctx_iv import MPIntervalContext

from duhem import ParametricCriterion
from duhem.proof.verdict import Witness


def numeric(law: ParametricCriterion, values: Mapping[str, Any], angle: Any) -> list[np.ndarray]:
    """Boundary and flow in floats, by SymPy's own lambdify: neither our NumPy fold nor our balls."""
    table = law.symbols()
    names = [table[law.angle], *(table[n] for n in law.parameters)]
    numbers = [float(Fraction(str(values[n]))) for n in law.parameters]
    flow = law.flow or (sp.diff(law.boundary[1], names[0]), -sp.diff(law.boundary[0], names[0]))
    return [np.broadcast_to(sp.lambdify(names, x)(angle, *numbers), np.shape(angle)) for x in (*law.boundary, *flow)]


IV = MPIntervalContext()
IV.prec = 256
Interval = Any


def _interval(node: Any, values: Mapping[sp.Symbol, Interval]) -> Interval:
    """An expression in mpmath's intervals."""
    if node.is_Symbol:
        return values[node]
    if node.is_Rational:
        return IV.mpf(int(node.p)) / int(node.q)
    if isinstance(node, sp.cos | sp.sin):
        return values[node]
    parts = [_interval(a, values) for a in node.args]
    if node.is_Add:
        return sum(parts, IV.mpf(0))
    if node.is_Mul:
        return math.prod(parts, start=IV.mpf(1))
    if node.is_Pow and node.exp.is_Integer:
        return parts[0] ** int(node.exp)
    if node.is_Pow and abs(node.exp) == sp.S.Half:
        return IV.sqrt(parts[0]) ** (1 if node.exp > 0 else -1)
    raise NotImplementedError(type(node).__name__)


def _at(law: ParametricCriterion, witness: Witness, t: str) -> list[Interval]:
    """Boundary and flow at tan(angle/2) = t: cosine and sine are rational."""
    table = law.symbols()
    half = IV.mpf(Fraction(t).numerator) / Fraction(t).denominator
    turn = table[law.angle]
    values: dict[Any, Interval] = {sp.cos(turn): (1 - half**2) / (1 + half**2), sp.sin(turn): 2 * half / (1 + half**2)}
    for name, value in witness.parameters.items():
        values[table[name]] = IV.mpf(Fraction(value).numerator) / Fraction(value).denominator
    flow = law.flow or (sp.diff(law.boundary[1], turn), -sp.diff(law.boundary[0], turn))
    return [_interval(x, values) for x in (*law.boundary, *flow)]


def _admissible(law: ParametricCriterion, witness: Witness) -> bool:
    at = {law.symbols()[n]: sp.Rational(v) for n, v in witness.parameters.items()}
    inside = all(sp.Rational(v) in law.parameters[n] for n, v in witness.parameters.items())
    return set(witness.parameters) == set(law.parameters) and inside and all(c.subs(at) == sp.true for c in law.constraints)


def _winding(law: ParametricCriterion, witness: Witness, x: float, y: float) -> int:
    """Turns of a polygon of 100 000 points around (x, y).

    Each arc is within an eighth of the second differences at its ends from its chord, and (x, y) farther.
    """
    a, b, *_ = numeric(law, witness.parameters, np.linspace(-np.pi, np.pi, 100_001))
    curve = (a - x) + 1j * (b - y)
    start, chord = curve[:-1], np.diff(curve)
    nearest = start + chord * np.clip(-(np.conj(chord) * start).real / np.abs(chord) ** 2, 0, 1)
    bend = np.abs(np.diff(curve, 2, append=curve[1]))
    assert (np.abs(nearest) > np.maximum(bend, np.roll(bend, 1))).all()
    return round(float(np.sum(np.angle(curve[1:] / curve[:-1])) / (2 * np.pi)))


def _leans(law: ParametricCriterion, witness: Witness) -> bool:
    (sa, sb, da, db), (ta, tb, *_) = (_at(law, witness, witness.points[role][f"tan_half_{law.angle}"]) for role in ("sigma", "tau"))
    return bool((da * (ta - sa) + db * (tb - sb)).a > 0)


def _pushes_back(law: ParametricCriterion, witness: Witness) -> bool:
    a, b, da, db = _at(law, witness, witness.points["sigma"][f"tan_half_{law.angle}"])
    return bool((a * da + b * db).b < 0)


def _hollow(law: ParametricCriterion, witness: Witness) -> bool:
    corners = [_at(law, witness, witness.points[role][f"tan_half_{law.angle}"])[:2] for role in "pmq"]
    z = [Fraction(witness.points["z"][force]) for force in law.forces]
    inner = [IV.mpf(x.numerator) / x.denominator for x in z]
    sides = [
        (b[0] - a[0]) * (inner[1] - a[1]) - (b[1] - a[1]) * (inner[0] - a[0])
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    one_side = all(s.a > 0 for s in sides) or all(s.b < 0 for s in sides)
    return one_side and _winding(law, witness, *(float(x) for x in z)) == 0


def _empty(law: ParametricCriterion, witness: Witness) -> bool:
    return _winding(law, witness, 0.0, 0.0) == 0


CHECKS: dict[str, Callable[[ParametricCriterion, Witness], bool]] = {
    "normality": _leans,
    "dissipation": _pushes_back,
    "convexity": _hollow,
    "origin": _empty,
}


def holds(law: ParametricCriterion, claim: str, witness: Witness) -> bool:
    """Whether a witness violates the claim in intervals of another library, at parameters of the domain."""
    return _admissible(law, witness) and CHECKS[claim](law, witness)
