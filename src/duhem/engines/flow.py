"""The slip direction on the boundary: normal to K or not, dissipative or not.

For an associated law the flow is the normality rule itself (Moreau 1970; Antoni et al. 2007, Eqs. 28, 36): it lies in
the normal cone of K exactly when K is convex there.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from duhem.examination import Case
from duhem.examination.bracket import Bracket, bracketed, enclosed_normal, over_box, violation
from duhem.examination.search import choices
from duhem.examination.witness import Values
from duhem.expression.numpy_ import compiled
from duhem.positivity import Sense
from duhem.verdict import Evidence, Verdict, Witness

__all__ = ["dissipation_refuted", "normality", "normality_refuted", "normality_refuted_by_chord"]

_DIRECTIONS = 720
_NORMALITY = "the flow at the boundary point between `inside` and `outside` points towards tau, a point of K: it is not in the normal cone"
_DISSIPATION = "force . flow < 0 at the boundary point between `inside` and `outside`"


def normality(case: Case) -> Evidence | None:
    """A flow of the law's own is parallel to grad g and points the same way, on every branch where g = 0 (K convex)."""
    problem, pieces = case.simple, case.pieces
    if problem.flow is None or pieces is None:
        return None
    for piece in pieces:
        gradient = [sp.diff(piece.expr, x) for x in problem.forces]
        on_boundary = (*piece.conditions(), sp.Eq(piece.expr, 0))
        for i, j in itertools.combinations(range(len(gradient)), 2):
            minor = problem.flow[i] * gradient[j] - problem.flow[j] * gradient[i]
            if case.ask(minor, Sense.ZERO, *on_boundary).holds is not True:
                return None
        along = sum(d * n for d, n in zip(problem.flow, gradient, strict=True))
        if case.ask(along, Sense.NONNEGATIVE, *on_boundary).holds is not True:
            return None
    return Evidence(Verdict.PROVED, "parallel", "the flow is a non-negative multiple of grad g wherever g = 0, and K is convex")


def normality_refuted_by_chord(case: Case, chord: Witness) -> Evidence | None:
    """Associated flow on a non-convex K: where a chord from p to q leaves K, the normal there points towards q."""
    if case.problem.flow is not None:
        return None
    parameters, p, q, middle = _read(case, chord)

    def turned_away(bracket: Bracket) -> sp.Expr | None:
        normal = enclosed_normal(case, bracket)
        return None if normal is None else -sp.Add(*(n * sp.Rational(str(b - a)) for n, a, b in zip(normal, p, q, strict=True)))

    statement = "on the segment from p to q = tau the boundary is crossed outward, so grad g . (tau - sigma) > 0 there: the normal is not in the normal cone of K"
    witness = violation(case, parameters, p, middle, turned_away, "-grad g . (q - p)", statement, target=q)
    return None if witness is None else Evidence(Verdict.REFUTED, "witness-normal", "grad g is not in the normal cone where a chord leaves K", witness)


def _read(case: Case, chord: Witness) -> tuple[Values, list[Fraction], list[Fraction], list[Fraction]]:
    table = case.law.symbols()
    parameters = {table[name]: Fraction(value) for name, value in chord.parameters.items() if table[name] in case.simple.parameters}
    if case.simple.magnitude in case.simple.parameters and case.simple.magnitude is not None:
        parameters[case.simple.magnitude] = -Fraction(chord.points["p"][str(case.law.pressure)])
    points = [[Fraction(chord.points[role][str(x)]) for x in case.simple.forces] for role in ("p", "q", "midpoint")]
    return parameters, points[0], points[1], points[2]


def normality_refuted(case: Case) -> Evidence | None:
    """A boundary point whose flow points towards another point of K, the worst direction first.

    The other point is first sought all along the boundary, then close by, at the scale of the deviation itself.
    """
    if case.simple.flow is None:
        return None
    for parameters in choices(case, most=12):
        scout = _Scout(case, parameters)
        if len(scout.boundary) < 2:
            continue
        for k, target in itertools.chain(scout.far_targets(), scout.near_targets()):
            if witness := _leans_towards(case, scout, parameters, k, target):
                return Evidence(Verdict.REFUTED, "witness-flow", "the flow leaves the normal cone of K", witness)
    return None


def _leans_towards(case: Case, scout: _Scout, parameters: Values, k: int, target: Sequence[Fraction]) -> Witness | None:
    problem = case.simple

    def short(bracket: Bracket) -> sp.Expr:
        assert problem.flow is not None
        return -sp.Add(*(d * (sp.Rational(str(t)) - x) for d, t, x in zip(problem.flow, target, problem.forces, strict=True)))

    start, end = scout.segment(k)
    return violation(case, parameters, start, end, short, "-flow . (tau - sigma)", _NORMALITY, target, lambda b: _angles(case, b))


def dissipation_refuted(case: Case) -> Evidence | None:
    """A boundary point where force . flow < 0."""
    problem = case.simple

    def power(bracket: Bracket) -> sp.Expr | None:
        flow = problem.flow or enclosed_normal(case, bracket)
        return None if flow is None else sp.Add(*(x * d for x, d in zip(problem.forces, flow, strict=True)))

    for parameters in choices(case, most=12):
        scout = _Scout(case, parameters)
        for k in scout.least_power()[:5]:
            start, end = scout.segment(k)
            if witness := violation(case, parameters, start, end, power, "force . flow", _DISSIPATION):
                return Evidence(Verdict.REFUTED, "witness-power", "force . flow is negative on the boundary", witness)
    return None


class _Scout:
    """Boundary points of one parameter choice, in floats, along rays from a point of K."""

    def __init__(self, case: Case, parameters: Values) -> None:
        self.case, self.parameters = case, parameters
        self.exact = {x: sp.Rational(v.numerator, v.denominator) for x, v in parameters.items()}
        self.forces = case.simple.forces
        g = case.simple.g.subs(self.exact)
        self._g = compiled(g, self.forces)
        d = len(self.forces)
        rng = np.random.default_rng(5)
        if d == 2:
            turn = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
            directions = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        else:
            directions = rng.standard_normal((_DIRECTIONS, d))
        self.centre = self._centre(rng, d)
        self.directions = np.round(directions, 6)
        self.boundary, self.low, self.high = self._shoot()

    def value(self, points: Any) -> Any:
        return self._g(*np.moveaxis(np.asarray(points, dtype=float), -1, 0))

    def _centre(self, rng: np.random.Generator, d: int) -> Any:
        if self.value(np.zeros(d)) <= 0:
            return np.zeros(d)
        points = rng.standard_normal((4000, d)) * 10.0 ** rng.uniform(-2, 2, (4000, 1))
        heights = self.value(points)
        best = points[int(np.nanargmin(heights))]
        return np.round(best, 9) if self.value(np.round(best, 9)) <= 0 else None

    def _shoot(self) -> tuple[Any, Any, Any]:
        if self.centre is None:
            return np.zeros((0, len(self.forces))), np.zeros(0), np.zeros(0)
        radii = 10.0 ** np.linspace(-5, 5, 61)
        inside = self.value(self.centre + radii[None, :, None] * self.directions[:, None, :]) <= 0
        keep = ~inside.all(axis=1) & inside[:, 0]
        self.directions = self.directions[keep]
        exits = np.argmin(inside[keep], axis=1)
        low, high = radii[np.maximum(exits - 1, 0)], radii[exits]
        for _ in range(50):
            middle = (low + high) / 2
            inner = self.value(self.centre + middle[:, None] * self.directions) <= 0
            low, high = np.where(inner, middle, low), np.where(inner, high, middle)
        return self.centre + low[:, None] * self.directions, low, high

    def unit_flow(self) -> Any:
        flow = self.case.simple.flow
        if flow is None:
            slips = self._gradient()
        else:
            slips = np.stack([np.broadcast_to(compiled(c.subs(self.exact), self.forces)(*self.boundary.T), len(self.boundary)) for c in flow], axis=1)
        return slips / (np.linalg.norm(slips, axis=1, keepdims=True) + 1e-300)

    def _gradient(self) -> Any:
        step = 1e-6 * (np.linalg.norm(self.boundary, axis=1, keepdims=True) + 1e-300)
        columns = []
        for i in range(len(self.forces)):
            offset = np.zeros(len(self.forces))
            offset[i] = 1.0
            columns.append((self.value(self.boundary + step * offset) - self.value(self.boundary - step * offset)) / (2 * step[:, 0]))
        return np.stack(columns, axis=1)

    def far_targets(self) -> Iterator[tuple[int, list[Fraction]]]:
        """The three boundary points whose flow leans most towards some other sampled point, with that point."""
        slips = self.unit_flow()
        reach = slips @ self.boundary.T - np.sum(slips * self.boundary, axis=1)[:, None]
        sizes = np.linalg.norm(self.boundary[None, :, :] - self.boundary[:, None, :], axis=2) + 1e-300
        for k in np.argsort(-np.nanmax(reach / sizes, axis=1))[:3]:
            best = int(np.nanargmax(reach[k]))
            if reach[k, best] > 0:
                yield int(k), [Fraction(float(c) * (1 - 2.0**-20)).limit_denominator(10**6) for c in self.boundary[best]]

    def near_targets(self) -> Iterator[tuple[int, list[Fraction]]]:
        """In two forces: from the point of largest deviation, boundary points turned by a share of that deviation."""
        if len(self.forces) != 2:
            return
        normals, slips = self._gradient(), self.unit_flow()
        turn = np.arctan2(normals[:, 0] * slips[:, 1] - normals[:, 1] * slips[:, 0], np.sum(normals * slips, axis=1))
        for k in np.argsort(-np.abs(turn))[:3]:
            for share in (1.0, 0.5, 0.25, 0.1):
                angle = Fraction(float(share * turn[k])).limit_denominator(10**12)
                start, end = self.segment(int(k))
                turned = [[p[0] - angle * p[1], p[1] + angle * p[0]] for p in (start, end)]
                if found := bracketed(self.case, self.parameters, turned[0], turned[1], 80):
                    yield int(k), list(found.inside)

    def least_power(self) -> list[int]:
        """Indices of boundary points with negative power, the most negative first."""
        if len(self.boundary) == 0:
            return []
        power = np.sum(self.unit_flow() * self.boundary, axis=1) / (np.linalg.norm(self.boundary, axis=1) + 1e-300)
        order = np.argsort(np.where(np.isfinite(power), power, np.inf))
        return [int(k) for k in order if power[k] < -1e-12]

    def segment(self, k: int) -> tuple[list[Fraction], list[Fraction]]:
        """Exact points on the ray, half-way in and half-way out of the crossing."""
        centre = [Fraction(float(c)).limit_denominator(10**9) for c in self.centre]
        ray = [Fraction(float(c)).limit_denominator(10**6) for c in self.directions[k]]
        near, far = (Fraction(float(s * self.low[k])).limit_denominator(10**12) for s in (1 - 1e-6, 1 + 1e-6))
        return [c + near * r for c, r in zip(centre, ray, strict=True)], [c + far * r for c, r in zip(centre, ray, strict=True)]


def _angles(case: Case, bracket: Bracket) -> dict[str, float]:
    """Deviation of the flow from the normal at the bracketed point, and the flow's own angle (two forces), in degrees."""
    normal = enclosed_normal(case, bracket)
    flow = case.simple.flow
    if normal is None or flow is None:
        return {}
    n, d = ([float(over_box(c, case, bracket).mid()) for c in vector] for vector in (normal, flow))
    cosine = sum(a * b for a, b in zip(n, d, strict=True)) / (math.hypot(*n) * math.hypot(*d))
    measures = {"deviation_degrees": math.degrees(math.acos(max(-1.0, min(1.0, cosine))))}
    if len(d) == 2:
        measures["slip_angle_degrees"] = math.degrees(math.atan2(d[1], d[0]))
    return measures

