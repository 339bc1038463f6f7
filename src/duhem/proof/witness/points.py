"""The exact check that makes a refutation: signs at rational points and between two of them, in balls of rising precision.

Nothing is refuted by a float.  A candidate is made rational, evaluated in the law as stated (no simplification), and
kept only if every sign is certain; where one stays open the candidate is dropped.  A boundary point that is not rational is
held between two rational ones: by continuity the boundary crosses a segment from a point inside K to one outside, and what is
shown in balls for the whole box around the segment holds at that boundary point.  The two have as few digits as leave it so.

A refutation in a state of a law is shown by signs at plain values of its variables, with the forces that its energy gives.  A state
counts only where the energy has a value; a witness that names some of the variables is completed so that it names all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise, product
from math import isclose, isfinite
from typing import Any, NamedTuple

import sympy as sp

from duhem.expression import EigMax
from duhem.expression.balls import ball, certain_sign, compiled, enclose, precision
from duhem.expression.number import fraction
from duhem.expression.vocabulary import KINKS
from duhem.law.formula_law import Criterion
from duhem.law.frozen_mapping import FrozenMapping
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.plane_section import kinks_decided
from duhem.proof.facts.subject import Point, Values, rationals
from duhem.proof.in_state import Spent, forces_in
from duhem.proof.statement import parsed_as_written
from duhem.proof.verdict import Witness

__all__ = [
    "EnclosedPoint", "chord", "decimal_pair", "enclosed", "enclosed_flow", "enclosed_normal", "in_ranges", "less_than_0", "of_energy",
    "origin_outside", "over_box", "rounded", "sign_at", "two_forces_at", "violation", "with_variables", "witness",
]  # fmt: skip

_PRECISIONS = (64, 128, 256, 512, 1024, 2048)
_WIDTHS = (20, 40, 60, 90, 120)
_DIGITS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24)
_SHIFTS = (1, 3)  # by so many steps of the last digit the two points lie on either side
_MEASURED = 50  # halvings between them, for what is measured at the boundary
_ALIKE = 1e-4  # relative, of what is measured there
_GREATEST = 10**308  # about that of doubles, and 1 over it is about the least


def sign_at(expr: sp.Expr, values: Values, exact: bool = False) -> tuple[int | None, Any]:
    """Certain sign of ``expr`` at exact values (None if no precision settles it) and the enclosure that shows it.

    If ``exact``, also of what is 0 as a fraction, which balls cannot tell.
    """
    enclosure = None
    names, enclosed = _over_balls(expr)
    for bits in _PRECISIONS:
        with precision(bits):
            enclosure = enclosed(*(ball(values[x]) for x in names))
            if (sign := certain_sign(enclosure)) is not None:
                return sign, enclosure
    if exact and enclosure is not None and enclosure.is_finite():
        number = expr.xreplace(rationals(values))
        if number.is_Rational:
            return int(sp.sign(number)), ball(fraction(number))
    return None, enclosure


@lru_cache(maxsize=256)
def _over_balls(expr: sp.Expr) -> tuple[tuple[sp.Symbol, ...], Callable[..., Any]]:
    """The symbols of an expression, and its enclosure as a function of a ball for each: one is asked for at many points."""
    names = tuple(expr.free_symbols)
    return names, compiled(expr, names)


def witness(
    subject: FormulaSubject | GraphSubject,
    points: Mapping[str, Values],
    values: Mapping[str, tuple[str, str]],
    statement: str,
    measures: Mapping[str, float] | None = None,
) -> Witness:
    """A violation at points by role, each with the values of forces, pressure and parameters; these are the same at all of them."""
    own, shown = dict[str, str](), dict[str, dict[str, str]]()
    for role, at in points.items():
        told = {name: str(value) for name, value in subject.named(at).items()}
        own, shown[role] = ({name: x for name, x in told.items() if (name in subject.law.parameters) is c} for c in (True, False))
    return Witness(own, shown, values, statement, measures or {})


def decimal_pair(enclosure: Any) -> tuple[str, str]:
    """The ends of a ball in decimal with 17 digits, rounded outward; a size that no double has, to 0, 1e-308, 1e308 or inf."""
    return _outward(enclosure.lower(), ROUND_FLOOR), _outward(enclosure.upper(), ROUND_CEILING)


def _outward(end: Any, rounding: str) -> str:
    size, sign, grows = abs(end), "-" if end < 0 else "", (end < 0) == (rounding == ROUND_FLOOR)
    if size > _GREATEST:  # it may have more digits than there is memory for
        return sign + ("inf" if grows else "1e308")
    if size > 0 and size * _GREATEST < 1:
        return f"{sign}1e-308" if grows else "0"
    exact = end.fmpq()
    return str(Context(prec=17, rounding=rounding).divide(Decimal(int(exact.p)), Decimal(int(exact.q))))


def chord(
    subject: FormulaSubject | GraphSubject, parameters: Values, p: Sequence[Fraction], q: Sequence[Fraction], touching: bool = False
) -> Witness | None:
    """Non-convexity: g(p) <= 0, g(q) <= 0 and g > 0 at the midpoint, or None if that is not certain.

    If ``touching``, points on the boundary count too where their coordinates show it in fractions.
    """
    middle = [(a + b) / 2 for a, b in zip(p, q, strict=True)]
    points = {role: subject.values_at(parameters, point) for role, point in (("p", p), ("q", q), ("midpoint", middle))}
    if not subject.admits(points["p"]):
        return None
    shown = {}
    for role in ("midpoint", "p", "q"):  # where it fails first, first
        sign, shown[role] = sign_at(subject.stated, points[role], touching)
        if sign is None or (sign > 0) != (role == "midpoint"):
            return None
    values = {f"g({role})": decimal_pair(shown[role]) for role in points}
    return witness(subject, points, values, "g(p) <= 0 and g(q) <= 0, yet g > 0 at the midpoint of p and q: {g <= 0} is not convex")


def origin_outside(subject: FormulaSubject | GraphSubject, parameters: Values) -> Witness | None:
    """g(0) > 0 at admitted parameters, or None if that is not certain."""
    values = subject.values_at(parameters, subject.nowhere)
    sign, enclosure = sign_at(subject.stated, values)
    if sign != 1:
        return None
    return witness(subject, {"origin": values}, {"g(0)": decimal_pair(enclosure)}, "g > 0 at zero force: 0 is not in K")


class EnclosedPoint(NamedTuple):
    """Between ``inside`` and ``outside`` (simple problem's forces), g <= 0 at the one and g > 0 at the other, both certain."""

    parameters: Values
    inside: Point
    outside: Point


def enclosed(subject: FormulaSubject, parameters: Values, start: Point, end: Point, bits: int) -> EnclosedPoint | None:
    """The crossing between ``start`` in K and ``end`` outside, narrowed 2^bits times; None if a sign stays open."""
    return next(_narrowed(subject, parameters, start, end, (bits,)), None)


def _narrowed(subject: FormulaSubject, parameters: Values, start: Point, end: Point, widths: Sequence[int]) -> Iterator[EnclosedPoint]:
    """The crossing after each of so many halvings, which rise; no more where a sign stays open."""
    low, high = Fraction(0), Fraction(1)

    def at(s: Fraction) -> Point:
        return tuple(a + s * (b - a) for a, b in zip(start, end, strict=True))

    def inside(s: Fraction) -> bool | None:
        sign, _ = sign_at(subject.problem.stated, subject.values_at(parameters, at(s)))
        return None if sign is None else sign <= 0

    if inside(low) is not True or inside(high) is not False:
        return
    for done, bits in pairwise((0, *widths)):
        for _ in range(done, bits):
            middle = (low + high) / 2
            here = inside(middle)
            if here is None:
                return
            low, high = (middle, high) if here else (low, middle)
        yield EnclosedPoint(parameters, at(low), at(high))


def over_box(expr: sp.Expr, subject: FormulaSubject, point: EnclosedPoint) -> Any:
    """Ball containing ``expr`` over the box around the point (pressure and parameters exact)."""
    with precision(256):
        return enclose(expr, _box(subject, point))


def _box(subject: FormulaSubject, point: EnclosedPoint) -> dict[sp.Symbol, Any]:
    a, b = subject.values_at(point.parameters, point.inside), subject.values_at(point.parameters, point.outside)
    return {x: ball(min(a[x], b[x]), max(a[x], b[x])) for x in a}


def enclosed_normal(subject: FormulaSubject, point: EnclosedPoint) -> tuple[sp.Expr, ...] | None:
    """Gradient of the one smooth branch of the simple problem that holds on the whole box; None on a seam.

    Where there are too many branches to list, what the box leaves of the formula is that one.
    """
    if subject.pieces is None:
        with precision(256):
            here = kinks_decided(subject.simple.g, _box(subject, point))
        return None if here.has(*KINKS, EigMax) else tuple(sp.diff(here, x) for x in subject.simple.forces)
    for piece in subject.pieces:
        if all(certain_sign(over_box(sign * switch, subject, point)) == 1 for switch, sign in piece.signs.items()):
            return tuple(sp.diff(piece.expr, x) for x in subject.simple.forces)
    return None


def enclosed_flow(subject: FormulaSubject, point: EnclosedPoint) -> tuple[sp.Expr, ...] | None:
    """The slip at the enclosed point: that of the one surface that can be 0 there; None at a corner, or on a seam of a normal."""
    acting = [face for face in subject.simple.faces if all(certain_sign(over_box(other, subject, point)) == -1 for other in face.others)]
    return (acting[0].flow or enclosed_normal(subject, point)) if len(acting) == 1 else None


def violation(
    subject: FormulaSubject,
    parameters: Values,
    start: Point,
    end: Point,
    quantity: Callable[[EnclosedPoint], sp.Expr | None],
    name: str,
    statement: str,
    target: Sequence[Fraction] | None = None,
    measures: Callable[[EnclosedPoint], dict[str, float]] = lambda point: {},
) -> Witness | None:
    """A witness that ``quantity`` is < 0, or > 0 for a target, at the boundary point between ``start`` and ``end``, or at one beside it."""
    if not subject.admits(subject.values_at(parameters, start)):
        return None
    wanted = -1 if target is None else 1
    others: dict[str, Values] = {} if target is None else {"tau": subject.values_at(parameters, target)}
    if any(sign_at(subject.problem.stated, at)[0] not in (-1, 0) for at in others.values()):
        return None

    def seen(point: EnclosedPoint) -> Any:
        expr = quantity(point)
        if expr is None or not all(over_box(tree, subject, point).is_finite() for tree in subject.doubted):
            return None
        value = over_box(expr, subject, point)
        return value if certain_sign(value) == wanted else None

    def measured(point: EnclosedPoint) -> dict[str, float]:
        return measures(enclosed(subject, *point, _MEASURED) or point)

    for found in _narrowed(subject, parameters, start, end, _WIDTHS):
        if seen(found) is not None:
            worst = measured(found)
            within = (short for short in _shorter(subject, found) if in_ranges(subject, short.inside, short.outside))
            fit = (short for short in within if seen(short) is not None and _alike(measured(short), worst))
            point = next(fit, found)
            ends = {"inside": subject.values_at(parameters, point.inside), "outside": subject.values_at(parameters, point.outside)}
            points = {**ends, **others}
            shown = {f"g({role})": decimal_pair(sign_at(subject.problem.stated, at)[1]) for role, at in points.items()}
            return witness(subject, points, {**shown, name: decimal_pair(seen(point))}, statement, measured(point))
    return None


def in_ranges(subject: FormulaSubject, *points: Sequence[Fraction]) -> bool:
    """Whether points lie in the ranges that the forces of the law have."""
    named = (zip(subject.simple.forces, point, strict=True) for point in points)
    return all(c in subject.domain[x.name] for pairs in named for x, c in pairs if x.name in subject.domain)


def _alike(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    return one.keys() == other.keys() and all(isclose(one[name], other[name], rel_tol=_ALIKE) for name in one)


def _shorter(subject: FormulaSubject, point: EnclosedPoint) -> Iterator[EnclosedPoint]:
    """Points inside and outside beside these, of one digit first, then of more."""
    middle = [(a + b) / 2 for a, b in zip(point.inside, point.outside, strict=True)]
    way = [b - a for a, b in zip(point.inside, point.outside, strict=True)]
    if (normal := enclosed_normal(subject, point)) is not None:  # the shortest way out of what is rounded
        slopes = [float(over_box(slope, subject, point).mid()) for slope in normal]
        way = [Fraction(slope) for slope in slopes] if any(slopes) and all(map(isfinite, slopes)) else way
    far = max(map(abs, way))
    for step, times in product(_steps(middle), _SHIFTS):
        ends = (tuple(step * round(x / step + side * times * w / far) for x, w in zip(middle, way, strict=True)) for side in (-1, 1))
        short = EnclosedPoint(point.parameters, *ends)
        inside, outside = (subject.values_at(short.parameters, x) for x in (short.inside, short.outside))
        signs = [sign_at(subject.problem.stated, at)[0] for at in (inside, outside) if subject.admits(at)]
        if signs in ([-1, 1], [0, 1]):
            yield short


def rounded(point: Sequence[Fraction]) -> Iterator[tuple[Fraction, ...]]:
    """Points beside one, of one digit first, then of more; each also rounded towards zero."""
    for step in _steps(point):
        yield tuple(step * round(x / step) for x in point)
        yield tuple(step * int(x / step) for x in point)


def _steps(point: Sequence[Fraction]) -> Iterator[Fraction]:
    """Ever smaller powers of ten, from the size of the greatest coordinate down."""
    size = max(map(abs, point))
    if size:
        first = (Decimal(size.numerator) / Decimal(size.denominator)).adjusted()
        yield from (Fraction(10) ** (first + 1 - digits) for digits in _DIGITS)


# -- in a state of a law -----------------------------------------------------------------------------------------------


def less_than_0(subject: FormulaSubject, spent: Spent, values: Values, name: str, statement: str) -> Witness | None:
    """Return a witness that the power is < 0 in this state; None if that is not certain, or if the state may not be one of the law."""
    sign, power = sign_at(spent.power, values)
    if sign != -1 or not subject.admits(values) or not _has_a_value(spent.energy, values):
        return None
    shown = {name: decimal_pair(power)}
    if spent.bound is not None:
        height, enclosure = sign_at(spent.bound, values, exact=True)
        if height not in ((0,) if spent.on_it else (-1, 0)):
            return None
        shown = {"g": decimal_pair(enclosure), **shown}
    return _in_state(subject.of, values, shown, statement, {x.name: x for x in spent.chosen})


def two_forces_at(subject: FormulaSubject, gaps: Mapping[str, sp.Expr], states: Iterable[Values], statement: str) -> Witness | None:
    """Return a witness from the first state in which a gap that must be 0 is certainly not 0; None where no state shows one."""
    law = subject.of
    stored = None if law.energy is None else parsed_as_written(law, law.energy, law.written_energy, law.symbols())
    for values in states:
        if subject.admits(values) and _has_a_value(stored, values):
            for name, gap in gaps.items():
                sign, enclosure = sign_at(gap, values)
                if sign in (1, -1):
                    return _in_state(law, values, {name: decimal_pair(enclosure)}, statement)
    return None


def _has_a_value(energy: sp.Expr | None, values: Values) -> bool:
    """Return whether the energy certainly has a value in the state; a law without an energy needs none."""
    return energy is None or bool(sign_at(energy, values)[1].is_finite())


def _in_state(
    law: Criterion, values: Values, shown: Mapping[str, tuple[str, str]], statement: str, chosen: Mapping[str, sp.Symbol] = FrozenMapping()
) -> Witness:
    """Return a witness that names all variables, what else is ``chosen``, the pressure, and forces of the energy that are fractions."""
    table, exact = law.symbols(), rationals(values)
    given = {} if law.energy is None else {f: force.xreplace(exact) for f, force in forces_in(law).items()}
    named = {name: values[x] for name, x in {**table, **chosen}.items() if name not in law.parameters and x in values}
    pressed = {str(law.pressure): -v for x, v in values.items() if x.name == f"abs({law.pressure})"}
    variables = {name: values[table[name]] for name in law.variables}
    state = {name: str(v) for name, v in {**variables, **named, **pressed}.items()}
    state |= {f: str(v) for f, v in given.items() if v.is_Rational}
    parameters = {name: str(values[table[name]]) for name in law.parameters if name not in law.variables and table[name] in values}
    return Witness(parameters, {"state": state}, shown, statement)


def of_energy(subject: FormulaSubject, chord: Witness, name: str, statement: str) -> Witness:
    """Return a chord of the epigraph of an energy as a witness about the energy itself, with every variable among its points."""
    states = {x: v for x, v in chord.parameters.items() if x in subject.of.variables}
    shown = {role.replace("g(", f"{name} - z at ").rstrip(")"): value for role, value in chord.values.items()}
    parameters = {x: v for x, v in chord.parameters.items() if x not in states}
    return Witness(parameters, {role: {**states, **point} for role, point in chord.points.items()}, shown, statement)


def with_variables(subject: FormulaSubject, found: Witness) -> Witness:
    """Return the witness completed by all variables and forces, if displacements that are fractions give the forces at each point."""
    law, table = subject.of, subject.of.symbols()
    seen = {own.force: name for name, own in law.variables.items() if own.observable and own.force in subject.law.forces}
    if subject.state is None or not subject.state.onto or law.energy is None:
        return found
    fixed = {table[name]: sp.Rational(v) for name, v in found.parameters.items() if name not in seen.values()}
    forces, points = {f: x.xreplace(fixed) for f, x in forces_in(law).items()}, {}
    for role, point in found.points.items():
        answer = sp.solve([forces[f] - sp.Rational(point[f]) for f in seen], [table[name] for name in seen.values()], dict=True)
        here = fixed | (answer[0] if answer else {})
        given = {**{name: here.get(table[name]) for name in law.variables}, **{f: x.xreplace(here) for f, x in forces.items()}}
        if not all(value is not None and value.is_Rational for value in given.values()):
            return found
        points[role] = {**{name: str(value) for name, value in given.items()}, **point}
    return replace(found, parameters={x: v for x, v in found.parameters.items() if x not in law.variables}, points=points)
