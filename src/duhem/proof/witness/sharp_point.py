"""A sharp point of the boundary at an exact place: K comes to it, and leaves open cones about two opposite directions free.

Were the boundary C^1 there with the outward normal n, K would lie on one side of it, for a ray of points with g < 0 comes to the
place.  All rays near w and near -w leave K, so n . v >= 0 for every v near w and near -w: then n = 0.
What g is along x + t v is shown with the least power of t taken out, over all of 0 < t <= 1/N and all v of a box; where g has
no such power, by its derivatives in t.  A maximum is > 0 where one part is, and < 0 where all are.  A size |t w| is t |w|.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression import Neg, Norm, Pos, Where
from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.inert_number import plain_exponent
from duhem.expression.number import rational
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.verdict import Witness
from duhem.proof.witness.rational_points import describe

__all__ = ["sharp_point"]

_BITS = 256
_CONES = tuple((Fraction(1, 2**k), Fraction(1, 2**n)) for k, n in ((3, 6), (5, 10), (8, 16), (11, 22)))  # half width, reach
_MOST_DERIVATIVES = 4
_KINKS = (sp.Abs, sp.Max, sp.Min, Pos, Neg, Where)
_T = sp.Symbol("t", positive=True)


def sharp_point(
    subject: FormulaSubject, parameters: Values, place: Sequence[Fraction], away: Sequence[Fraction], into: Sequence[Fraction]
) -> Witness | None:
    """Such a point with w = ``away`` and the ray ``into`` K; None if that is not certain.  g must be defined and not jump."""
    if subject.doubtful or not subject.joined(subject.simple.g):
        return None
    g = _without_root(subject.formula_at(parameters))
    with precision(_BITS):
        for width, reach in _CONES:
            ends = ((into, Fraction(0), -1), (away, width, 1), ([-c for c in away], width, 1))
            if all(_Cone(subject.simple.forces, place, way, wide, reach).sign(g) == sign for way, wide, sign in ends):
                return _shown(subject, parameters, place, away, into, width, reach)
    return None


def _shown(
    subject: FormulaSubject,
    parameters: Values,
    place: Sequence[Fraction],
    away: Sequence[Fraction],
    into: Sequence[Fraction],
    width: Fraction,
    reach: Fraction,
) -> Witness:
    def at(way: Sequence[Fraction], sign: int = 1) -> dict[sp.Symbol, Fraction]:
        return dict(subject.values_at(parameters, [x + sign * reach * c for x, c in zip(place, way, strict=True)]))

    here = subject.values_at(parameters, place)
    points = {"corner": here, "outside": at(away), "opposite": at(away, -1), "inside": at(into)}
    return Witness(
        parameters=describe(subject, here, forces=False),
        points={role: describe(subject, point) for role, point in points.items()},
        values={},
        statement="g > 0 on all of the ways from the corner to `outside` and to `opposite`, and on those beside them (each force by up to "
        f"{width * reach} at the end), and g < 0 on the way to `inside`: no half-space is tangent to K at the corner",
        measures={"beside": float(width * reach)},
    )


class _Cone:
    """The points x + t v with 0 < t <= reach, each component of v within ``width`` of that of ``way``."""

    def __init__(
        self, forces: Sequence[sp.Symbol], place: Sequence[Fraction], way: Sequence[Fraction], width: Fraction, reach: Fraction
    ) -> None:
        box = {sp.Symbol(f"v {x}", real=True): ball(c - width, c + width) for x, c in zip(forces, way, strict=True)}  # no name of a law
        components = box if width else map(rational, way)  # on a ray itself what is 0 must be seen to be
        self._place: Mapping[sp.Symbol, sp.Expr] = {x: rational(c) + _T * v for x, c, v in zip(forces, place, components, strict=True)}
        self._box = {**box, _T: ball(Fraction(0), reach)}

    def sign(self, g: sp.Expr) -> int | None:
        """That of g in all of it; None if that is open."""
        return self._sign(self._smooth(g))

    def _sign(self, expr: sp.Expr, derivatives: int = 0) -> int | None:
        if isinstance(expr, sp.Max | sp.Min):
            strong = 1 if isinstance(expr, sp.Max) else -1
            signs = [self._sign(a) for a in expr.args]
            return strong if strong in signs else -strong if set(signs) == {-strong} else None
        if expr.has(*_KINKS, sp.nan, sp.zoo, sp.I):
            return None
        if (plain := certain_sign(enclose(expr, self._box))) is not None:
            return plain
        if expr.is_polynomial(_T):
            powers = sp.Poly(expr, _T)
            (least,) = min(powers.monoms())
            return certain_sign(enclose(sp.Add(*(c * _T ** (k - least) for (k,), c in powers.terms())), self._box))
        terms = [_power_taken_out(term) for term in sp.Add.make_args(sp.expand_mul(expr))]
        lowest = min(power for _, power in terms)
        if lowest:
            rest = sp.Add(*(c * _T ** (power - lowest) for c, power in terms))
            sign = certain_sign(enclose(rest, self._box))
            if lowest < 0 or sign is not None:  # what is infinite at 0 has no derivative there
                return sign
        start = expr.subs(_T, 0)
        if derivatives == _MOST_DERIVATIVES or not (start.is_zero or sp.expand(start).is_zero):
            return None
        return self._sign(sp.diff(expr, _T), derivatives + 1)

    def _smooth(self, expr: sp.Expr, inner: bool = False) -> sp.Expr:
        """The formula on the cone, every kink undone whose sides are certain; an outermost maximum or minimum is left."""
        if expr in self._place:
            return self._place[expr]
        if not expr.args or isinstance(expr, Where):
            return expr
        choice = isinstance(expr, sp.Max | sp.Min)
        args = [self._smooth(a, inner or not choice) for a in expr.args]
        if choice:
            return self._greatest(expr.func, args) if inner else expr.func(*args)
        if isinstance(expr, sp.Abs | Pos | Neg) and (sign := self._sign(args[0])) is not None:
            slope = getattr(expr, "slope", sign)
            return slope * args[0] if sign == slope else sp.S.Zero
        if isinstance(expr, sp.Abs) and (rest := _over_t(args[0])) is not None:
            size = sp.Symbol(f"size {len(self._box)}", nonnegative=True)
            self._box[size] = abs(enclose(rest, self._box))
            return _T * size
        if isinstance(expr, Norm):
            return sp.sqrt(sp.factor_terms(sp.expand(sp.Add(*(a**2 for a in args)))))
        if expr.is_Pow and not expr.exp.is_Integer:
            args[0] = sp.factor_terms(sp.expand(args[0]))
            if (rest := _over_t(args[0])) is not None and plain_exponent(args[1]).is_Rational:
                return _T ** plain_exponent(args[1]) * rest ** args[1]
        return sp.expand(expr.func(*args)) if expr.is_Add or expr.is_Mul else expr.func(*args)

    def _greatest(self, kind: Any, args: Sequence[sp.Expr]) -> sp.Expr:
        better = 1 if kind is sp.Max else -1
        for a in args:
            if all(b == a or self._sign(sp.expand(a - b)) == better for b in args):
                return a
        return kind(*args)


def _without_root(g: sp.Expr) -> sp.Expr:
    """x - 1 for x**p - 1, p > 0, which has its sign; g is defined, so that x >= 0."""
    root = g + 1
    if root.is_Pow and not root.exp.is_Integer and plain_exponent(root.exp).is_Rational and root.exp.is_positive:
        return root.base - 1
    return g


def _over_t(expr: sp.Expr) -> sp.Expr | None:
    """The rest of what is t times something in which t is not."""
    if not expr.is_polynomial(_T) or (form := sp.Poly(expr, _T)).monoms() != [(1,)]:
        return None
    return form.LC()


def _power_taken_out(term: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """(c, k) of c t^k, k a fraction; other parts of c may have t in them."""
    power, rest = sp.S.Zero, list[sp.Expr]()
    for factor in sp.Mul.make_args(term):
        base, exponent = factor.as_base_exp()
        if base == _T and plain_exponent(exponent).is_Rational:
            power += plain_exponent(exponent)
        else:
            rest.append(factor)
    return sp.Mul(*rest), power
