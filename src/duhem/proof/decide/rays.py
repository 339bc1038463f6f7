"""Questions on the circle between rays through 0 whose directions are numbers with roots in them.

What is homogeneous and linear in x and y cuts a sector out of the plane, or a ray: its ends are found exactly.  On a ray a homogeneous
expression has the sign of one number, and in a sector a linear one has those that it has on both ends; else only those relations of
a sector are kept that bound it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from duhem.expression import UNDEFINED
from duhem.expression.weights import degree
from duhem.proof.decide.budget import Budget
from duhem.proof.decide.question import Answer, Question, Sense
from duhem.proof.decide.radicals import sign_of_radicals

__all__ = ["between_rays"]

_METHOD = "rays"
_SIGN = 1_000  # steps of the sign of a number
Ray = tuple[sp.Expr, sp.Expr]  # its direction, or a and b of a x + b y


class _Side(NamedTuple):
    """a x + b y >= 0, or > 0, and the relation that says so."""

    a: sp.Expr
    b: sp.Expr
    strict: bool
    said: sp.Basic

    def at(self, ray: Ray) -> int | None:
        """The sign on a ray."""
        return _at((self.a, self.b), ray)


def between_rays(question: Question, budget: Budget) -> Answer | Question | None:
    """The answer, or the question without relations that say nothing more; None where the rays are no such numbers."""
    circle, sides = question.circle, list[_Side]()
    if circle is None or question.expr.free_symbols - set(circle):
        return None
    for relation in question.given:
        if (read := _read(relation, circle)) is None:
            return None
        sides += read
    if all(c.is_Rational for side in sides for c in (side.a, side.b)):
        return None  # others see that too
    if not budget.pays(_SIGN * len(sides) ** 2):
        return None
    if any(sign_of_radicals(side.a**2 + side.b**2) != 1 for side in sides):
        return None  # 0 >= 0 in disguise has no ends
    ends = [(s * side.b, -s * side.a) for side in sides for s in (1, -1)]
    found = list[Ray]()
    for ray in ends:
        signs = [side.at(ray) for side in sides]
        if None in signs:
            return None
        if all(sign is not None and sign >= 0 for sign in signs) and not any(_alike(ray, other) for other in found):
            found.append(ray)
    if len(found) == 2 and _opposite(*found):  # all sides are along one line; facing one way they leave half of the plane
        across = sides[0].a, sides[0].b
        return _on(question, found, sides) if any(side.at(across) == -1 for side in sides) else None
    if len(found) < 2:
        return _on(question, found, sides)
    if (answer := _linear(question, found, sides)) is not None:
        return answer
    told = [side for side in sides if not all(side.at(ray) == 1 for ray in found)]
    kept = tuple(dict.fromkeys(side.said for side in told))
    return Question(question.expr, question.sense, kept, circle) if len(kept) < len(question.given) else None


def _on(question: Question, rays: Sequence[Ray], sides: Sequence[_Side]) -> Answer | None:
    """On each ray that the strict relations leave."""
    assert question.circle is not None
    for ray in _asked(rays, sides):
        if degree(question.expr, question.circle) is None:
            return None
        value = question.expr.xreplace(dict(zip(question.circle, ray, strict=True)))
        if value.has(*UNDEFINED) or (sign := sign_of_radicals(value)) is None:
            return None
        if not {Sense.NONNEGATIVE: sign >= 0, Sense.POSITIVE: sign > 0, Sense.ZERO: sign == 0}[question.sense]:
            return Answer(False, _METHOD)
    return Answer(True, _METHOD)


def _linear(question: Question, rays: Sequence[Ray], sides: Sequence[_Side]) -> Answer | None:
    """Of a linear expression in a sector: what it is on both ends, which the strict relations may leave out."""
    assert question.circle is not None
    if (line := _line(question.expr, question.circle)) is None:
        return None
    signs = [_at(line, ray) for ray in rays]
    if None in signs:
        return None
    match question.sense:
        case Sense.NONNEGATIVE:
            holds = -1 not in signs
        case Sense.POSITIVE:
            holds = -1 not in signs and 1 in signs and all(_at(line, ray) == 1 for ray in _asked(rays, sides))
        case _:
            holds = signs == [0, 0]
    return Answer(holds, _METHOD)


def _read(relation: sp.Basic, circle: tuple[sp.Symbol, sp.Symbol]) -> list[_Side] | None:
    """A relation as sides; None where it is not linear and homogeneous."""
    if isinstance(relation, sp.Eq):
        expr = relation.lhs - relation.rhs
    elif isinstance(relation, sp.GreaterThan | sp.LessThan | sp.StrictGreaterThan | sp.StrictLessThan):
        expr = relation.gts - relation.lts
    else:
        return None
    if (line := _line(expr, circle)) is None:
        return None
    strict = isinstance(relation, sp.StrictGreaterThan | sp.StrictLessThan)
    return [_Side(s * line[0], s * line[1], strict, relation) for s in ((1, -1) if isinstance(relation, sp.Eq) else (1,))]


def _line(expr: sp.Expr, circle: tuple[sp.Symbol, sp.Symbol]) -> Ray | None:
    """a and b of a x + b y; None for any other expression."""
    if not expr.is_polynomial(*circle):
        return None
    terms = dict(sp.Poly(expr, *circle).terms())
    a, b = (terms.pop(m, sp.S.Zero) for m in ((1, 0), (0, 1)))
    return None if terms or a.free_symbols or b.free_symbols else (a, b)


def _at(line: Ray, ray: Ray) -> int | None:
    """The sign of a x + b y on a ray."""
    return sign_of_radicals(line[0] * ray[0] + line[1] * ray[1])


def _asked(rays: Sequence[Ray], sides: Sequence[_Side]) -> list[Ray]:
    """Without those that a strict relation leaves out."""
    return [ray for ray in rays if not any(side.strict and side.at(ray) == 0 for side in sides)]


def _alike(one: Ray, two: Ray) -> bool:
    return sign_of_radicals(one[0] * two[1] - one[1] * two[0]) == 0 and sign_of_radicals(one[0] * two[0] + one[1] * two[1]) == 1


def _opposite(one: Ray, two: Ray) -> bool:
    return sign_of_radicals(one[0] * two[1] - one[1] * two[0]) == 0
