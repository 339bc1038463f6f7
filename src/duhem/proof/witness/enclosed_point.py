"""Boundary points that are not rational, held between two rational ones.

By continuity the boundary crosses a segment from a point inside K to one outside.  What is shown in balls for the whole
box around the segment holds at that boundary point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp

from duhem.expression import EigMax
from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.facts.plane_section import KINKS, kinks_decided
from duhem.proof.verdict import Witness
from duhem.proof.witness.rational_points import decimal_pair, describe, sign_at

__all__ = ["EnclosedPoint", "enclosed", "enclosed_flow", "enclosed_normal", "over_box", "violation"]

_WIDTHS = (20, 40, 60, 90, 120)


@dataclass(frozen=True)
class EnclosedPoint:
    """Between ``inside`` and ``outside`` (simple problem's forces), g <= 0 at the one and g > 0 at the other, both certain."""

    parameters: Values
    inside: tuple[Fraction, ...]
    outside: tuple[Fraction, ...]


def enclosed(
    subject: FormulaSubject, parameters: Values, start: Sequence[Fraction], end: Sequence[Fraction], bits: int
) -> EnclosedPoint | None:
    """The crossing between ``start`` in K and ``end`` outside, narrowed 2^bits times; None if a sign stays open."""
    return next(_narrowed(subject, parameters, start, end, (bits,)), None)


def _narrowed(
    subject: FormulaSubject, parameters: Values, start: Sequence[Fraction], end: Sequence[Fraction], widths: Sequence[int]
) -> Iterator[EnclosedPoint]:
    """The crossing after each of so many halvings, which rise; no more where a sign stays open."""
    low, high = Fraction(0), Fraction(1)

    def at(s: Fraction) -> tuple[Fraction, ...]:
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


def over_box(expr: sp.Expr, subject: FormulaSubject, point: EnclosedPoint, bits: int = 256) -> Any:
    """Ball containing ``expr`` over the box around the point (pressure and parameters exact)."""
    a, b = subject.values_at(point.parameters, point.inside), subject.values_at(point.parameters, point.outside)
    with precision(bits):
        return enclose(expr, {x: ball(min(a[x], b[x]), max(a[x], b[x])) for x in a})


def enclosed_normal(subject: FormulaSubject, point: EnclosedPoint) -> tuple[sp.Expr, ...] | None:
    """Gradient of the one smooth branch of the simple problem that holds on the whole box; None on a seam.

    Where there are too many branches to list, what the box leaves of the formula is that one.
    """
    if subject.pieces is None:
        a, b = subject.values_at(point.parameters, point.inside), subject.values_at(point.parameters, point.outside)
        with precision(256):
            here = kinks_decided(subject.simple.g, {x: ball(min(a[x], b[x]), max(a[x], b[x])) for x in a})
        return None if here.has(*KINKS, EigMax) else tuple(sp.diff(here, x) for x in subject.simple.forces)
    for piece in subject.pieces or ():
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
    start: Sequence[Fraction],
    end: Sequence[Fraction],
    quantity: Callable[[EnclosedPoint], sp.Expr | None],
    name: str,
    statement: str,
    wanted: int = -1,
    target: Sequence[Fraction] | None = None,
    measures: Callable[[EnclosedPoint], dict[str, float]] = lambda point: {},
) -> Witness | None:
    """A witness that ``quantity`` has the ``wanted`` sign at the boundary point between ``start`` and ``end``."""
    if not subject.admits(subject.values_at(parameters, start)):
        return None
    others: dict[str, dict[sp.Symbol, Fraction]] = {} if target is None else {"tau": subject.values_at(parameters, target)}
    if any(sign_at(subject.problem.stated, at)[0] not in (-1, 0) for at in others.values()):
        return None
    for point in _narrowed(subject, parameters, start, end, _WIDTHS):
        expr = quantity(point)
        if expr is None or not all(over_box(tree, subject, point).is_finite() for tree in subject.doubted):
            continue
        value = over_box(expr, subject, point)
        if certain_sign(value) == wanted:
            ends = {"inside": subject.values_at(parameters, point.inside), "outside": subject.values_at(parameters, point.outside)}
            shown = {f"g({role})": decimal_pair(sign_at(subject.problem.stated, at)[1]) for role, at in {**ends, **others}.items()}
            return Witness(
                parameters=describe(subject, ends["inside"], forces=False),
                points={role: describe(subject, at) for role, at in {**ends, **others}.items()},
                values={**shown, name: decimal_pair(value)},
                statement=statement,
                measures=measures(point),
            )
    return None
