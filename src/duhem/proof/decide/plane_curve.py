"""Exact decision along a plane curve: signs on p(x, y) = 0, by projection onto x (Collins 1975, in two dimensions).

Between neighbouring real roots of the leading coefficient and discriminant of p (p as a polynomial in y), and of its
resultants with the other polynomials, the curve is a fixed number of graphs on which no sign changes: one rational x
shows them all.  The finitely many x left over are covered in balls.  There a weak goal also follows by continuity: at a
point where p has a gradient the curve is an arc that comes from beside it, and strict hypotheses that hold at the point
hold on the arc.  Zero margins are therefore no obstacle, unlike for enclosures.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import Any

import flint
import sympy as sp

from duhem.expression.balls import certain_sign, precision
from duhem.expression.number import fraction, rational
from duhem.proof.decide.bivariate import DegenerateError, Integral, OpenError, Poly, at_rational, factors, projection, true, univariate
from duhem.proof.decide.budget import Budget, SpentError
from duhem.proof.decide.polynomials import Relation, System
from duhem.proof.decide.question import Answer
from duhem.proof.decide.reduction import variables
from duhem.proof.decide.roots import between, real_roots, square_free

__all__ = ["by_plane"]

_METHOD = "plane-cells"
_BITS = (128, 512, 2048)
_SHEARS = range(6)
_SIGN = 10  # steps of a polynomial's enclosure in a box

Sign = tuple[Poly, str]


def by_plane(system: System, budget: Budget) -> Answer:
    """Decide a question in two variables one of whose hypotheses is an equation; ``holds`` None for any other."""
    relations = [r for r in system.given if r.poly != 0]
    used = variables(system)
    curves = [r for r in relations if r.op == "=="]
    if len(used) != 2 or not curves:
        return Answer(None, _METHOD, reason=f"{len(used)} variables remain" if curves else "no equation among the hypotheses")
    curve = min(curves, key=lambda r: (len(r.poly.free_symbols) < 2, sp.Poly(r.poly, *used).total_degree()))
    if len(curve.poly.free_symbols) < 2:
        return Answer(None, _METHOD, reason="no curve among the hypotheses")
    x, y = sorted(used, key=lambda s: (sp.degree(curve.poly, s), str(s)), reverse=True)  # the projection is along the lower degree
    for shear in _SHEARS:
        polys = Integral(x, y, shear)
        try:
            point = _violation(polys, curve, [r for r in relations if r is not curve], system.goal, budget)
        except DegenerateError:
            continue
        except (OpenError, SpentError) as fault:
            return Answer(None, _METHOD, reason=str(fault))
        if point is None:
            return Answer(True, _METHOD)
        return Answer(False, _METHOD, point={x: rational(point[0] + shear * point[1]), y: rational(point[1])})
    return Answer(None, _METHOD, reason="no projection is in general position")


def _violation(
    polys: Integral, curve: Relation, given: Iterable[Relation], goal: Relation, budget: Budget
) -> tuple[Fraction, Fraction] | None:
    """A point of the curve where every hypothesis holds and the goal fails; None if it is proved that there is none."""
    hypotheses = [(polys(r.poly), r.op) for r in given]
    wanted = (polys(goal.poly), goal.op)
    for factor in factors(polys(curve.poly)):
        component = _component(polys.ring, factor, hypotheses, wanted)
        if component is not None and (point := component.violation(budget)) is not None:
            return point
    return None


def _component(ring: Any, curve: Poly, hypotheses: list[Sign], goal: Sign) -> _Component | None:
    """One irreducible factor of the curve, with what does not vanish on all of it; None if nothing can fail there."""
    left = []
    for poly, op in hypotheses:
        if divmod(poly, curve)[1] == 0:
            if op in (">", "!="):
                return None
        elif not poly.is_constant():
            left.append((poly, op))
        elif not true(int(poly.coeffs()[0]), op):
            return None
    if divmod(goal[0], curve)[1] == 0:
        if goal[1] in (">=", "=="):
            return None
        goal = (ring.constant(-1), ">")
    if curve.degrees()[1] == 0:
        raise DegenerateError
    return _Component(curve, tuple(left), goal)


@dataclass(frozen=True)
class _Component:
    """An irreducible curve of positive degree in y; no other polynomial here vanishes on all of it."""

    curve: Poly
    given: tuple[Sign, ...]
    goal: Sign

    def violation(self, budget: Budget) -> tuple[Fraction, Fraction] | None:
        others = [(p, self.curve) for p, _ in (*self.given, self.goal) if not p.is_constant()]
        special = projection([self.curve], others, budget)
        for bits in _BITS:
            try:
                return self._beside(special, bits, budget) or self._above(special, bits, budget)
            except OpenError:
                if bits == _BITS[-1]:
                    raise
        return None

    def _beside(self, special: Any, bits: int, budget: Budget) -> tuple[Fraction, Fraction] | None:
        """Over one rational x in each cell the signs are exact."""
        for at in between(real_roots(special, bits, budget)):
            here = at_rational(self.curve, at)
            others = [(at_rational(p, at), op) for p, op in self.given]
            wanted = at_rational(self.goal[0], at), self.goal[1]
            for root in real_roots(square_free(here), bits, budget):
                with precision(bits):
                    if all(true(_sign(p(root)), op) for p, op in others) and not true(_sign(wanted[0](root)), wanted[1]):
                        middle = root.mid().fmpq()
                        return at, fraction(middle)
        return None

    def _above(self, special: Any, bits: int, budget: Budget) -> tuple[Fraction, Fraction] | None:
        """Over the roots of the projection: balls on the whole line above each."""
        slopes = (self.curve.derivative(0), self.curve.derivative(1))
        strict = all(op in (">", "!=") for _, op in self.given)
        for root in real_roots(special, bits, budget):
            with precision(bits):
                line = _columns(self.curve, root)
                if line[-1].contains(0):
                    raise DegenerateError
                bound = 1 + max(chain((abs(c / line[-1]).upper() for c in line[:-1]), [flint.arb(0)]))
                above = [(_poly(_columns(p, root)), op) for p, op in self.given]
                goal, curve = _poly(_columns(self.goal[0], root)), _poly(line)
                gradient = [_poly(_columns(p, root)) for p in slopes]
                if not float(bound.upper()) < 1e300:
                    raise OpenError("the curve has a point too far away")
                end = 2.0 ** math.frexp(float(bound.upper()))[1]
                queue, narrowest = [(flint.arb(0), end)], end / 2.0 ** (bits // 3)
                while queue:
                    budget.spend(_SIGN * (len(above) + 4))
                    middle, half = queue.pop()

                    def on_box(poly: Any, middle: Any = middle, half: float = half) -> Any:
                        return poly(flint.arb_poly([middle, 1]))(flint.arb(0, half))  # about the middle: exact to second order

                    if certain_sign(on_box(curve)) or self._settled(on_box, above, goal, gradient, strict):
                        continue
                    if half < narrowest:
                        raise OpenError("a sign over a root of the projection stays open")
                    queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
        return None

    def _settled(self, on_box: Callable[[Any], Any], given: list[tuple[Any, str]], goal: Any, gradient: list[Any], strict: bool) -> bool:
        if _holds(on_box(goal), self.goal[1]):
            return True
        signs = [(on_box(p), op) for p, op in given]
        if any(_fails(value, op) for value, op in signs):
            return True
        if self.goal[1] != ">=" or not any(certain_sign(on_box(d)) for d in gradient):
            return False
        return strict or all(op != "==" and certain_sign(value) for value, op in signs)


def _holds(value: Any, op: str) -> bool:
    return bool(value > 0 if op == ">" else value >= 0 if op == ">=" else value != 0 if op == "!=" else False)


def _fails(value: Any, op: str) -> bool:
    return bool(value < 0 if op == ">=" else value <= 0 if op == ">" else (value > 0 or value < 0) if op == "==" else False)


def _sign(value: Any) -> int:
    sign = certain_sign(value)
    if sign is None:
        raise OpenError("a sign beside the roots stays open")
    return sign


def _columns(poly: Poly, x: Any) -> list[Any]:
    """Coefficients by powers of y over a ball x."""
    by_power: list[dict[int, Any]] = [{} for _ in range(poly.degrees()[1] + 1)]
    for (i, j), c in poly.to_dict().items():
        by_power[j][i] = c
    return [univariate(column)(x) for column in by_power]


def _poly(coefficients: list[Any]) -> Any:
    return flint.arb_poly(coefficients)
