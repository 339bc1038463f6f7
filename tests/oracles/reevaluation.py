"""A second opinion on witnesses: outward-rounded intervals of mpmath with derivatives carried along.

Shares nothing with duhem but the tree of the formula and its node classes: another arithmetic (mpmath.iv, not Arb),
another interpreter, derivatives by forward differentiation instead of symbolically.  Rational points enter exactly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import mpmath
import sympy as sp
from mpmath.ctx_iv import MPIntervalContext
from mpmath.libmp import from_rational, round_ceiling, round_floor

from duhem import Criterion, Domain, Witness
from duhem.expression import Neg, Norm, Pos, Where
from duhem.expression.number import InertNumber
from duhem.expression.vocabulary import EigMax

__all__ = ["Interval", "confirmed", "gradient", "value"]

_DIGITS = 100
_HALVINGS = 60
_TURNS = 720
_IV = MPIntervalContext()
_IV.dps = _DIGITS
_MP = mpmath.MPContext()
_MP.dps = 50

Interval = Any  # mpmath's ivmpf
Span = tuple[Fraction, Fraction]


def _rational(x: Fraction) -> Interval:
    p, q = x.numerator, x.denominator
    return _IV.make_mpf((from_rational(p, q, _IV.prec, round_floor), from_rational(p, q, _IV.prec, round_ceiling)))


def _span(low: Fraction, high: Fraction) -> Interval:
    if low == high:
        return _rational(low)
    return _IV.mpf([_rational(low).a, _rational(high).b])


def _hull(*parts: Interval) -> Interval:
    return _IV.mpf([min(p.a for p in parts), max(p.b for p in parts)])


class _Jet:
    """A value and its partial derivatives (generalised at kinks: the hull of the one-sided ones)."""

    def __init__(self, value: Interval, slopes: Sequence[Interval]) -> None:
        self.value, self.slopes = value, tuple(slopes)

    def through(self, value: Interval, slope: Interval) -> _Jet:
        """Chain rule for a function with this ``value`` and derivative ``slope`` here."""
        return _Jet(value, [slope * s for s in self.slopes])

    def __add__(self, other: _Jet) -> _Jet:
        return _Jet(self.value + other.value, [a + b for a, b in zip(self.slopes, other.slopes, strict=True)])

    def __mul__(self, other: _Jet) -> _Jet:
        return _Jet(
            self.value * other.value,
            [a * other.value + self.value * b for a, b in zip(self.slopes, other.slopes, strict=True)],
        )

    def hull(self, other: _Jet) -> _Jet:
        return _Jet(_hull(self.value, other.value), [_hull(a, b) for a, b in zip(self.slopes, other.slopes, strict=True)])


class OpenError(Exception):
    """An interval leaves open what is asked: a root of, a division by or the direction of something that may be 0."""


def _power(base: _Jet, exponent: Fraction, jets: bool) -> _Jet:
    if exponent == 0:
        return base.through(_IV.mpf(1), _IV.mpf(0))
    x = base.value
    if exponent.denominator == 1:
        n = exponent.numerator
        if n < 0:
            if 0 in x:
                raise OpenError
            return base.through(1 / x**-n, n / x ** (1 - n) if jets else _IV.mpf(0))
        return base.through(x**n, n * x ** (n - 1) if jets and n > 1 else _IV.mpf(1))
    return _raised(base, _rational(exponent), jets)


def _raised(base: _Jet, p: Interval, jets: bool) -> _Jet:
    """To any constant power, of what is not < 0; to one that is a whole number at this place, of anything."""
    if p.a == p.b and (whole := round(float(p.a))) == p.a:
        return _power(base, Fraction(whole), jets)
    x = base.value
    if x.b < 0 or (x.a <= 0 and (p.a <= 0 or (jets and p.a < 1))):
        raise OpenError
    x = _IV.mpf([max(x.a, 0), x.b])

    def raised(q: Interval) -> Interval:
        top = _IV.exp(q * _IV.log(_IV.mpf([x.b, x.b]))) if x.b > 0 else _IV.mpf(0)
        bottom = _IV.exp(q * _IV.log(_IV.mpf([x.a, x.a]))) if x.a > 0 else _IV.mpf(0)
        return _hull(top, bottom)

    return base.through(raised(p), p * raised(p - 1) if jets else _IV.mpf(0))


def _ramp(x: _Jet, left: int, right: int) -> _Jet:
    """left * x where x < 0, right * x where x > 0."""
    if x.value.a >= 0:
        return x.through(right * x.value, _IV.mpf(right))
    if x.value.b <= 0:
        return x.through(left * x.value, _IV.mpf(left))
    ends = [left * x.value.a, right * x.value.b, _IV.mpf(0)]
    return x.through(_hull(*map(_IV.mpf, ends)), _IV.mpf([min(left, right), max(left, right)]))


def _choose(a: _Jet, b: _Jet, first: bool | None) -> _Jet:
    return a.hull(b) if first is None else a if first else b


def _compare(relation: Any, values: Mapping[sp.Basic, _Jet], jets: bool) -> bool | None:
    gap = (_jet(relation.gts, values, jets) + _jet(-relation.lts, values, jets)).value
    strict = isinstance(relation, sp.StrictGreaterThan | sp.StrictLessThan)
    if gap.a > 0 or (not strict and gap.a >= 0):
        return True
    if gap.b < 0 or (strict and gap.b <= 0):
        return False
    return None


def _greatest_eigenvalue(parts: Sequence[_Jet], jets: bool) -> _Jet:
    """By Weyl no eigenvalue moves by more than the norm of what is added to the matrix, by Davis and Kahan the normal of the
    greatest by no more than twice that, over the gap to the next; the rounding is far below 1e-40.
    """
    middle = [_MP.mpf(p.value.mid) for p in parts]
    x, y, z, yz, xz, xy = middle
    values, vectors = _MP.eigsy(_MP.matrix([[x, xy, xz], [xy, y, yz], [xz, yz, z]]))
    moved = 2 * sum(_MP.mpf((abs(p.value - m)).b) for p, m in zip(parts, map(_IV.mpf, middle), strict=True))
    moved += _MP.mpf("1e-40") * (1 + sum(map(abs, middle)))
    value = _IV.mpf([values[2] - moved, values[2] + moved])
    if not jets:
        return parts[0].through(value, _IV.mpf(0))
    if (gap := values[2] - values[1] - 2 * moved) <= 0:
        raise OpenError
    around = _IV.mpf([-4 * moved / gap, 4 * moved / gap])
    n = [vectors[i, 2] for i in range(3)]
    slopes = [(1 + (i != j)) * (_IV.mpf(n[i] * n[j]) + around) for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    moving = reduce(_Jet.__add__, (p.through(p.value, c) for p, c in zip(parts, slopes, strict=True)))
    return _Jet(value, moving.slopes)


def _jet(node: Any, values: Mapping[sp.Basic, _Jet], jets: bool) -> _Jet:
    some = next(iter(values.values()))
    if isinstance(node, InertNumber):
        node = node.value
    if (known := values.get(node)) is not None:
        return known
    if node.is_Rational:
        return some.through(_rational(Fraction(int(node.p), int(node.q))), _IV.mpf(0))
    if isinstance(node, Where):
        condition, a, b = node.args
        side = _compare(condition, values, jets)
        if side is not None:
            return _jet(a if side else b, values, jets)
        return _jet(a, values, jets).hull(_jet(b, values, jets))
    if node.is_Pow:
        number = node.exp.value if isinstance(node.exp, InertNumber) else node.exp
        if not number.is_Rational:
            exponent = _jet(node.exp, values, jets)
            if jets and any(slope.a < 0 or slope.b > 0 for slope in exponent.slopes):
                raise OpenError
            return _raised(_jet(node.base, values, jets), exponent.value, jets)
        return _power(_jet(node.base, values, jets), Fraction(int(number.p), int(number.q)), jets)
    parts = [_jet(a, values, jets) for a in node.args]
    if node.is_Add:
        return reduce(_Jet.__add__, parts)
    if node.is_Mul:
        return reduce(_Jet.__mul__, parts)
    if isinstance(node, sp.Abs):
        return _ramp(parts[0], -1, 1)
    if isinstance(node, Pos):
        return _ramp(parts[0], 0, 1)
    if isinstance(node, Neg):
        return _ramp(parts[0], -1, 0)
    if isinstance(node, Norm):
        return _power(reduce(_Jet.__add__, [_power(p, Fraction(2), jets) for p in parts]), Fraction(1, 2), jets)
    if isinstance(node, sp.Max | sp.Min):
        largest = isinstance(node, sp.Max)

        def pick(a: _Jet, b: _Jet) -> _Jet:
            gap = a.value - b.value
            return _choose(a, b, largest if gap.a >= 0 else not largest if gap.b <= 0 else None)

        return reduce(pick, parts)
    if isinstance(node, EigMax):
        return _greatest_eigenvalue(parts, jets)
    if isinstance(node, sp.exp):
        grown = _IV.exp(parts[0].value)
        return parts[0].through(grown, grown)
    if isinstance(node, sp.log):
        if parts[0].value.a <= 0:
            raise OpenError
        return parts[0].through(_IV.log(parts[0].value), 1 / parts[0].value)
    if isinstance(node, sp.cosh | sp.sinh):
        up, down = _IV.exp(parts[0].value), _IV.exp(-parts[0].value)
        even, odd = (up + down) / 2, (up - down) / 2
        return parts[0].through(even, odd) if isinstance(node, sp.cosh) else parts[0].through(odd, even)
    if isinstance(node, sp.cos | sp.sin):
        c, s = _IV.cos(parts[0].value), _IV.sin(parts[0].value)
        return parts[0].through(c, -s) if isinstance(node, sp.cos) else parts[0].through(s, c)
    if isinstance(node, sp.tanh):
        twice = _IV.exp(2 * parts[0].value)
        t = 1 - 2 / (twice + 1)
        return parts[0].through(t, 1 - t**2)
    raise NotImplementedError(f"no second opinion on {type(node).__name__}")


def _evaluate(law: Criterion, expr: sp.Expr, at: Mapping[str, Span], jets: bool) -> _Jet:
    table = law.symbols()
    if not jets and all(low == high for low, high in at.values()):
        return _jet(expr, _AtPoint({table[name]: low for name, (low, _) in at.items()}), jets)
    values: dict[sp.Basic, _Jet] = {}
    for name, span in at.items():
        seed = [_IV.mpf(int(name == force)) for force in law.forces] if jets else ()
        values[table[name]] = _Jet(_span(*span), seed)
    return _jet(expr, values, jets)


class _AtPoint(dict[sp.Basic, _Jet]):
    """Values at an exact point, where all that is a fraction enters as one: what is 0 is seen to be, whatever the numbers."""

    def __init__(self, at: Mapping[sp.Symbol, Fraction]) -> None:
        self.exact: dict[sp.Basic, Fraction | None] = {**at}
        super().__init__((x, _Jet(_rational(v), ())) for x, v in at.items())

    def get(self, node: Any, default: Any = None) -> Any:
        found = super().get(node)
        if found is None and isinstance(node, sp.Expr) and (known := _exactly(node, self.exact)) is not None:
            self[node] = found = _Jet(_rational(known), ())
        return found


def _point(at: Mapping[str, Fraction]) -> dict[str, Span]:
    return {name: (x, x) for name, x in at.items()}


def value(law: Criterion, at: Mapping[str, Fraction], expr: sp.Expr | None = None) -> Interval:
    """Interval with g (or ``expr``) at exact values of every name."""
    return _evaluate(law, law.g if expr is None else expr, _point(at), jets=False).value


def _exactly(node: Any, values: dict[sp.Basic, Fraction | None]) -> Fraction | None:
    """The value in fractions, where sums, products, whole powers, sizes and norms that are fractions make it one; kept for each node."""
    if node not in values:
        values[node] = _made_exactly(node, values)
    return values[node]


def _made_exactly(node: Any, values: dict[sp.Basic, Fraction | None]) -> Fraction | None:
    if node.is_Rational:
        return Fraction(int(node.p), int(node.q))
    if node.is_Pow:
        base = _exactly(node.base, values)
        return base ** int(node.exp) if base is not None and node.exp.is_Integer and node.exp > 0 else None
    parts = [_exactly(a, values) for a in node.args]
    known = [x for x in parts if x is not None]
    if not known or len(known) < len(parts):
        return None
    if isinstance(node, Norm):
        square = sum((x * x for x in known), Fraction(0))
        root = Fraction(math.isqrt(square.numerator), math.isqrt(square.denominator))
        return root if root * root == square else None
    if isinstance(node, EigMax):
        return None if any(known[3:]) else max(known[:3])
    kinds = ((sp.Add, sum), (sp.Mul, math.prod), (sp.Max, max), (sp.Min, min), (sp.Abs, lambda some: abs(some[0])))
    return next((Fraction(of(known)) for kind, of in kinds if isinstance(node, kind)), None)


def gradient(law: Criterion, at: Mapping[str, Span]) -> tuple[Interval, ...]:
    """Intervals with the partial derivatives of g by the forces, anywhere in the box."""
    return _evaluate(law, law.g, at, jets=True).slopes


# -- witnesses --------------------------------------------------------------------------------------------------------


def confirmed(law: Criterion, claim: str, witness: Witness) -> bool:
    """Whether the witness, read as exact rationals, violates ``claim`` of ``law`` by this module's own arithmetic."""
    if claim == "state_laws":
        return confirmed(_epigraph(law), "convexity", witness)
    fixed = {name: domain.value for name, domain in law.parameters.items() if domain.value is not None}
    parameters = {name: Fraction(int(v.p), int(v.q)) for name, v in fixed.items()} | {n: Fraction(v) for n, v in witness.parameters.items()}
    if law.forces_of_rates:  # its state stands among the points
        parameters |= {n: Fraction(x) for point in witness.points.values() for n, x in point.items() if n in law.variables}
    if set(parameters) != set(law.parameters) or not _admissible(law, parameters):
        return False
    points = {role: parameters | {n: Fraction(x) for n, x in point.items()} for role, point in witness.points.items()}
    if law.forces_of_rates and claim == "normality":
        return _falls(law, points["state"])
    names = set(law.symbols())
    if any(set(p) != names for p in points.values()):
        return False
    if any(sp.Rational(p[x].numerator, p[x].denominator) not in own for p in points.values() for x, own in law.domain.items()):
        return False
    if law.pressure is not None:
        pressures = {p[law.pressure] for p in points.values()}
        if len(pressures) != 1 or min(pressures) >= 0:
            return False
    return _CHECKS[claim](law, points, witness)


def _falls(law: Criterion, at: Mapping[str, Fraction]) -> bool:
    """Whether the forces at the rates and those at the other rates have a negative product with what the rates differ by."""
    one = {name: x for name, x in at.items() if name in law.symbols()}
    other = one | {rate: at[f"{rate} of the other"] for rate in law.velocities.values()}
    gaps = {force: _rational(one[rate]) - _rational(other[rate]) for force, rate in law.velocities.items()}
    own = law.forces_of_rates
    return bool(sum(gaps[f] * (value(law, one, own[f]) - value(law, other, own[f])) for f in own).b < 0)


def _epigraph(law: Criterion) -> Criterion:
    """{psi <= z} in the variables of a law without a temperature, their ranges as constraints."""
    heights, table = {name: sp.Symbol(name, real=True) for name in (*law.variables, "z")}, law.symbols()
    assert law.energy is not None and law.temperature is None
    g = law.energy.xreplace({table[name]: x for name, x in heights.items() if name in table}) - heights["z"]
    rest = {name: own for name, own in law.parameters.items() if name not in law.variables}
    ranges = {name: law.parameters[name] for name in law.variables if law.parameters[name] != Domain()}
    return Criterion(law.name, g, rest, tuple(heights), None, law.constraints, domain=ranges)


def _admissible(law: Criterion, parameters: Mapping[str, Fraction]) -> bool:
    table = law.symbols()
    exact = {table[n]: sp.Rational(v.numerator, v.denominator) for n, v in parameters.items()}
    inside = all(exact[table[n]] in domain for n, domain in law.parameters.items())
    return inside and all(c.subs(exact) == sp.true for c in law.constraints)


Points = Mapping[str, Mapping[str, Fraction]]


def _inside(law: Criterion, at: Mapping[str, Fraction]) -> bool:
    return bool(value(law, at).b <= 0)


def _outside(law: Criterion, at: Mapping[str, Fraction]) -> bool:
    return bool(value(law, at).a > 0)


def _chord(law: Criterion, points: Points, witness: Witness) -> bool:
    p, q, middle = (points[role] for role in ("p", "q", "midpoint"))
    halfway = all(2 * middle[n] == p[n] + q[n] for n in middle)
    return halfway and _inside(law, p) and _inside(law, q) and _outside(law, middle)


def _origin(law: Criterion, points: Points, witness: Witness) -> bool:
    (at,) = points.values()
    return all(at[f] == 0 for f in law.forces) and _outside(law, at)


def _box(law: Criterion, points: Points) -> dict[str, Span] | None:
    """A box around a crossing of the boundary between inside and outside; None if an end is on the wrong side.

    The segment is halved further, by this module's own signs, so that the box is as small as the quantity needs.
    """
    a, b = points["inside"], points["outside"]
    if not (_inside(law, a) and _outside(law, b)):
        return None
    for _ in range(_HALVINGS):
        middle = {n: (a[n] + b[n]) / 2 for n in a}
        g = value(law, middle)
        if g.b <= 0:
            a = middle
        elif g.a > 0:
            b = middle
        else:
            break
    return {n: (min(a[n], b[n]), max(a[n], b[n])) for n in a}


def _slip(law: Criterion, box: Mapping[str, Span]) -> tuple[Interval, ...]:
    """Of several surfaces that of the only one that may be 0 in the box; OpenError where there are more."""
    g, flow = law.g, law.flow
    if law.surfaces:
        met = [s for s in law.surfaces if _evaluate(law, s.g, box, jets=False).value.b >= 0]
        if len(met) != 1:
            raise OpenError
        g, flow = met[0].g, met[0].flow
    if flow is None:
        return _evaluate(law, g, box, jets=True).slopes
    return tuple(_evaluate(law, component, box, jets=False).value for component in flow)


def _none(slip: Sequence[Interval]) -> bool:
    """False; OpenError where the slip may be 0 in the box, as the gradient of a cube is where it is 0: it has no direction then."""
    if all(d.a <= 0 <= d.b for d in slip):
        raise OpenError
    return False


def _power_at(law: Criterion, points: Points, witness: Witness) -> bool:
    box = _box(law, points)
    if box is None:
        return False
    slip = _slip(law, box)
    power = sum((_span(*box[f]) * d for f, d in zip(law.forces, slip, strict=True)), _IV.mpf(0))
    return bool(power.b < 0) or _none(slip)


def _towards(law: Criterion, points: Points, witness: Witness) -> bool:
    box = _box(law, points)
    tau = points["tau"]
    if box is None or not _inside(law, tau):
        return False
    slip = _slip(law, box)
    lean = sum(((_rational(tau[f]) - _span(*box[f])) * d for f, d in zip(law.forces, slip, strict=True)), _IV.mpf(0))
    return bool(lean.a > 0) or _none(slip)


def _corner(law: Criterion, points: Points, witness: Witness) -> bool:
    """Around the corner K fills a sector whose opening is not 180 degrees: the difference is the angle of the normals.

    In more than two forces that is looked at in the plane of the corner and the points u and v.
    """
    if "outside" in points:
        return _sharp(law, points, witness)
    at, x, y = points["corner"], law.forces[0], law.forces[1]
    ways = [{x: Fraction(1), y: Fraction(0)}, {x: Fraction(0), y: Fraction(1)}]
    expected = witness.measures["corner_degrees"]
    if "u" in points:
        ways = [{f: points[role][f] - at[f] for f in law.forces} for role in ("u", "v")]
        one, two = ([sum(float(witness.values.get(f"n{i}_{f}", (0,))[0]) * float(c) for f, c in w.items()) for w in ways] for i in (1, 2))
        expected = math.degrees(math.atan2(abs(one[0] * two[1] - one[1] * two[0]), one[0] * two[0] + one[1] * two[1]))
    size = max(*(abs(at[f]) for f in law.forces), Fraction(1, 10**6)) / max(abs(c) for w in ways for c in w.values())
    reach = _MP.mpf(size.numerator) / size.denominator / 10**5

    def level(angle: Any) -> bool:
        shift = [Fraction(int(_MP.nint(reach * c * 10**40)), 10**40) for c in (_MP.cos(angle), _MP.sin(angle))]
        there = {f: at[f] + sum(s * w.get(f, Fraction(0)) for s, w in zip(shift, ways, strict=True)) for f in law.forces}
        return bool(value(law, {**at, **there}).mid <= 0)

    turns = [2 * _MP.pi * (k + _MP.mpf(1) / 3) / _TURNS for k in range(_TURNS + 1)]
    inside = [level(t) for t in turns]
    changes = [k for k in range(_TURNS) if inside[k] != inside[k + 1]]
    if len(changes) != 2:
        return False
    ends = []
    for k in changes:
        low, high = turns[k], turns[k + 1]
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (middle, high) if level(middle) == inside[k] else (low, middle)
        ends.append(low)
    sector = math.degrees(float(ends[1] - ends[0]))
    bend = abs(180 - sector)
    return bend > 0.01 and math.isclose(bend, expected, rel_tol=0.02, abs_tol=0.02)


def _sharp(law: Criterion, points: Points, witness: Witness) -> bool:
    """g > 0 on the ways to `outside` and to `opposite` and beside them, g < 0 on that to `inside`: at a few places of each.

    The sum of the first two ways is the last, taken so many times, which may be 0 times.
    """
    at, beside = points["corner"], Fraction(witness.measures["beside"])

    def on(end: Mapping[str, Fraction], share: Fraction, shift: Sequence[Fraction]) -> Mapping[str, Fraction]:
        return {**at, **{f: at[f] + share * (end[f] - at[f] + s) for f, s in zip(law.forces, shift, strict=True)}}

    none = [Fraction(0)] * len(law.forces)
    shifts = [none, *([c * beside * (i == k) for i in range(len(none))] for k in range(len(none)) for c in (1, -1))]
    shares = [Fraction(1, 2**k) for k in (0, 3, 9, 30)]
    free = all(value(law, on(points[r], s, shift)).a > 0 for r in ("outside", "opposite") for s in shares for shift in shifts)
    both = [points["outside"][f] + points["opposite"][f] - 2 * at[f] for f in law.forces]
    into = [points["inside"][f] - at[f] for f in law.forces]
    times = next(b / v for b, v in zip(both, into, strict=True) if v)
    between = times >= 0 and both == [times * v for v in into]
    return free and between and all(value(law, on(points["inside"], s, none)).b < 0 for s in shares)


_CHECKS = {"convexity": _chord, "origin": _origin, "dissipation": _power_at, "normality": _towards, "smoothness": _corner}
