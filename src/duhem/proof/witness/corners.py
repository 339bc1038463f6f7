"""Corners and sharp points of the boundary, where no unit normal is continuous.

A corner is held in a box of a plane.  The plane cuts g into smooth pieces.  Two of them that meet along a seam have a common zero in
the box, and there the zeros of each cross the seam: so points of the boundary come to the corner from both sides of it.  At these g is
differentiable in all forces, with gradients that stay bounded and whose parts in the plane are not parallel.

A sharp point is at an exact place: K comes to it along v, and leaves open cones about two directions c v + w and c v - w free, c >= 0.
Were the boundary C^1 there with the outward normal n, K would lie on one side of it, for a ray of points with g < 0 comes to the place:
n . v <= 0.  All rays near the two leave K, so n . u >= 0 for every u near them, and > 0 for these themselves, as n is not 0: so is their
sum, 2 c n . v.  That cannot be.  What g is along x + t v is shown with the least power of t taken out,
over all of 0 < t <= 1/N and all v of a box; where g has no such power, by its derivatives in t.  A maximum is > 0 where one part is,
and < 0 where all are.  A size |t w| is t |w|.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import sympy as sp

from duhem.expression import Neg, Norm, Pos, Where
from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.branches import Seam, almost_everywhere, jacobian, oriented, seams
from duhem.expression.number import plain_exponent, rational
from duhem.expression.text import formula
from duhem.proof.decide import Sense
from duhem.proof.facts.curve_subject import cross
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.plane_section import LocalPiece, PlaneSection, kinks_decided, local_pieces
from duhem.proof.facts.subject import Values, rationals
from duhem.proof.verdict import Witness
from duhem.proof.witness.points import decimal_pair, in_ranges, witness

__all__ = ["corner", "sharp_point"]

_BITS = 256
_BESIDE = Fraction(1, 2**30)  # how far from the corner two more points say in which plane it is seen
_BOXES = ((1000, Fraction(1, 2**30)), (10**25, Fraction(1, 2**40)))  # greatest denominator of the centre, radius
_CONES = tuple((Fraction(1, 2**k), Fraction(1, 2**n)) for k, n in ((3, 6), (5, 10), (8, 16), (11, 22)))  # half width, reach
_MOST_DERIVATIVES = 4
_KINKS = (sp.Abs, sp.Max, sp.Min, Pos, Neg, Where)
_T = sp.Symbol("t", positive=True)
Vector = Sequence[Fraction]


def corner(subject: FormulaSubject, parameters: Values, section: PlaneSection, near: Vector) -> Witness | None:
    """The corner near a place of a plane of forces, on a seam with one switch.

    Where g jumps, one of two boundaries that may meet on the seam, or of one and the seam, which g does not cross.
    """
    for limit, radius in _BOXES:
        place = [c.limit_denominator(limit) for c in near]
        with precision(_BITS):
            centre = {x: ball(c) for x, c in zip(section.at, place, strict=True)}
            box = {x: ball(c - radius, c + radius) for x, c in zip(section.at, place, strict=True)}
            for seam in seams(local_pieces(subject, parameters, section, box), both_ways=True):
                if len(seam.crossed) != 1 or seam.kept:
                    continue
                joined = partial(_joined, subject, parameters, seam, section, box)
                across = _gradient_of_switch(subject, parameters, section, seam)
                if (normals := _normals(joined, seam, section, across, centre, box, radius)) is not None:
                    where = f"on {formula(seam.crossed[0])} = 0" if len(subject.problem.forces) == 2 else "in the plane through it, u and v"
                    told = f"within {radius} of this point the boundary has a corner {where}:{'' if joined() else ' K ends on it, or'}"
                    return _shown(subject, parameters, section, place, normals, told)
    return None


def _defined(piece: LocalPiece, switch: sp.Expr, box: Any) -> bool:
    """Whether the formula as written has a value on this side of the seam, over the box; on the seam itself it may be 0/0."""
    return all(_meets(sense, _beside(expr, switch, piece.signs[switch], box) or None) for expr, sense in piece.needed)


def _meets(sense: Sense, sign: int | None) -> bool:
    """Whether what has a certain sign is as it must be."""
    return sign == 1 or (sign == -1 and sense is Sense.ZERO) or (sign == 0 and sense is Sense.NONNEGATIVE)


def _beside(expr: sp.Expr, switch: sp.Expr, side: int, box: Any) -> int | None:
    """The sign of an expression where the switch has the sign ``side``: powers of the switch are taken out of it."""
    sign = 1
    for factor in sp.Mul.make_args(sp.factor_terms(sp.expand(expr)) if switch.is_Symbol else expr):
        base, exponent = factor.as_base_exp()
        times = sp.cancel(base / switch) if exponent.is_Integer and (base == switch or base.is_polynomial()) else switch
        own = int(sp.sign(times) * side) ** int(exponent % 2) if times.is_number else certain_sign(enclose(factor, box))
        if own is None:
            return None
        sign *= own
    return sign


def _gradient_of_switch(subject: FormulaSubject, parameters: Values, section: PlaneSection, seam: Seam) -> tuple[sp.Expr, ...] | None:
    """The derivatives of the switch crossed by all forces, in the plane; None where it is not seen to be one of g itself."""
    (switch,), place = seam.crossed, section.coordinates()
    if len(section.forces) == 2:
        return tuple(sp.diff(switch, x) for x in section.at)
    if not all(isinstance(side, LocalPiece) and side.of_space for side in (seam.before, seam.after)):
        return None
    for whole in dict.fromkeys(s.subs(rationals(parameters)) for piece in subject.pieces or () for s in piece.signs):
        core, flip = oriented(sp.expand(whole.xreplace(place)))
        if core == switch:
            return tuple(flip * sp.diff(whole, x).xreplace(place) for x in section.forces)
    return None


def _normals(
    joined: Callable[[], bool],
    seam: Seam,
    section: PlaneSection,
    across: Sequence[sp.Expr] | None,
    centre: Any,
    box: Any,
    radius: Fraction,
) -> list[list[Any]] | None:
    """Outward normals of the two sides over the box in all forces, surely not parallel in the plane; None if that is open."""
    (switch,), (before, after) = seam.crossed, (seam.before, seam.after)
    assert isinstance(before, LocalPiece) and isinstance(after, LocalPiece)
    system = [after.expr, switch]
    if (slopes := jacobian(system, section.at)) is None or not _has_zero(sp.Matrix(system), slopes, centre, box, radius):
        return None
    if not all(_defined(piece, switch, box) for piece in (before, after)):
        return None
    along, one, two = ([enclose(sp.diff(e, x), box) for x in section.at] for e in (switch, before.expr, after.expr))
    full = [[enclose(c, box) for c in piece.gradient] for piece in (before, after)]
    side = certain_sign(enclose(before.expr, box))
    if side in (-1, 1) and across is not None:  # K ends on the seam: towards `before` if that is outside, else towards `after`
        one, full[0] = ([-side * after.signs[switch] * c for c in own] for own in (along, [enclose(c, box) for c in across]))
        crossing = [two]
    elif enclose(before.expr - after.expr, box).contains(0) and (len(section.forces) == 2 or joined()):
        crossing = [one, two]
    else:
        return None
    certain = all(certain_sign(cross(n, along)) in (-1, 1) for n in crossing) and certain_sign(cross(one, two)) in (-1, 1)
    return full if certain and all(c.is_finite() for n in full for c in n) else None


def _joined(subject: FormulaSubject, parameters: Values, seam: Seam, section: PlaneSection, box: Any) -> bool:
    """Whether g is continuous across the seam: as no choice is open in the box, or as the pieces are one where their switch is 0."""
    g, around = almost_everywhere(subject.formula_at(parameters)), {x: enclose(form, box) for x, form in section.coordinates().items()}
    if subject.continuous or not kinks_decided(g, around).has(Where):
        return True
    return bool(sp.cancel((seam.before.expr - seam.after.expr) / seam.crossed[0]).is_number)


def _shown(
    subject: FormulaSubject, parameters: Values, section: PlaneSection, place: Vector, normals: list[list[Any]], told: str
) -> Witness:
    at = subject.values_at(parameters, section.point(place))
    one, two = normals
    across, dot = _across(one, two), sum(a * b for a, b in zip(one, two, strict=True))
    points = {"corner": at}
    if len(subject.problem.forces) > 2:
        step = _BESIDE / max(abs(c) for way in section.along for c in way)  # where the law has ranges, they are in them
        spanned = (section.point((place[0] + step, place[1])), section.point((place[0], place[1] + step)))
        points |= {role: subject.values_at(parameters, p) for role, p in zip(("u", "v"), spanned, strict=True)}
    values = {
        "n1 x n2" if len(one) == 2 else "|n1 x n2|^2": decimal_pair(across),
        **{f"n{i}_{x}": decimal_pair(c) for i, n in ((1, one), (2, two)) for x, c in zip(section.forces, n, strict=True)},
    }
    size = abs(float(across.mid())) if len(one) == 2 else math.sqrt(abs(float(across.mid())))
    statement = f"{told} the normals n1, n2 of its two sides are not parallel"
    return witness(subject, points, values, statement, {"corner_degrees": math.degrees(math.atan2(size, float(dot.mid())))})


def _across(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Their cross product; in more than two forces its square, the sum of all minors' squares."""
    if len(a) == 2:
        return cross(a, b)
    minors = [a[i] * b[j] - a[j] * b[i] for j in range(len(a)) for i in range(j)]
    return sum((m * m for m in minors), ball(Fraction(0)))


def _has_zero(system: Any, jacobian: Any, centre: Any, box: Any, radius: Fraction) -> bool:
    """Interval Newton: centre - J(box)^-1 F(centre) inside the box shows exactly one zero there (Moore 1966)."""
    f = [enclose(e, centre) for e in system]
    a, b, c, d = (enclose(e, box) for e in jacobian)
    det = a * d - b * c
    if certain_sign(det) not in (-1, 1):
        return False
    steps = [(d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det]
    return all(step.is_finite() and abs(step) < ball(radius) for step in steps)


def sharp_point(subject: FormulaSubject, parameters: Values, place: Vector, aside: Vector, into: Vector, lean: Fraction) -> Witness | None:
    """Such a point with w = ``aside``, v = ``into`` and c = ``lean`` >= 0; None if that is not certain.  g must be defined and not jump."""
    if lean < 0 or not subject.joined(subject.simple.g):
        return None
    exact = subject.values_at(parameters, place)
    settled = {x: rational(value) for x, value in exact.items() if x not in subject.simple.forces}
    needed = [(o.expr.xreplace(settled), o.sense) for o in subject.doubtful]
    if not all(_meets(sense, certain_sign(enclose(expr.xreplace(rationals(exact)), {}))) for expr, sense in needed):
        return None
    g = _without_root(subject.formula_at(parameters))
    away, opposite = ([lean * v + side * w for v, w in zip(into, aside, strict=True)] for side in (1, -1))
    with precision(_BITS):
        for width, reach in _CONES:
            ends = ((into, Fraction(0), -1), (away, width, 1), (opposite, width, 1))
            far = [[x + reach * (c + side * wide) for x, c in zip(place, way, strict=True)] for way, wide, _ in ends for side in (-1, 1)]
            if not in_ranges(subject, *far):
                continue
            cones = [(_Cone(subject.simple.forces, place, way, wide, reach), sign) for way, wide, sign in ends]
            if all(cone.sign(g) == sign and all(_meets(sense, cone.sign(expr)) for expr, sense in needed) for cone, sign in cones):
                ways = {"corner": [Fraction(0)] * len(away), "outside": away, "opposite": opposite, "inside": into}
                points = {role: [x + reach * c for x, c in zip(place, way, strict=True)] for role, way in ways.items()}
                where = " between" if lean else ""
                statement = (
                    "g > 0 on all of the ways from the corner to `outside` and to `opposite`, and on those beside them (each force by up "
                    f"to {width * reach} at the end), and g < 0 on the way to `inside`{where}: K has no tangent plane at the corner"
                )
                shown = {role: subject.values_at(parameters, point) for role, point in points.items()}
                return witness(subject, shown, {}, statement, {"beside": float(width * reach)})
    return None


class _Cone:
    """The points x + t v with 0 < t <= reach, each component of v within ``width`` of that of ``way``."""

    def __init__(self, forces: Sequence[sp.Symbol], place: Vector, way: Vector, width: Fraction, reach: Fraction) -> None:
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
    parts = [(factor, *factor.as_base_exp()) for factor in sp.Mul.make_args(term)]
    powers = {factor: k for factor, base, exponent in parts if base == _T and (k := plain_exponent(exponent)).is_Rational}
    return sp.Mul(*(factor for factor, *_ in parts if factor not in powers)), sp.Add(*powers.values())
