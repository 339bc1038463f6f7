"""Hypotheses that leave a point, an arc's end, a crossing or a line: what is violated there alone, and what holds there."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy as sp

from duhem.proof.decide.smt import Relation, System
from tests.proof.decide.alone import OF_SYSTEMS
from tests.proof.decide.questions import SYMBOLS
from tests.proof.decide.truth import system_violated

x, y, _ = SYMBOLS
CIRCLE = (x**2 + y**2 - 1, "==")
ISOLATED = (y**2 - x**2 * (x - 1), "==")  # the origin, and a branch with x >= 1
CUSP = (y**2 - x**3, "==")
AXES = (x * y, "==")
TINY = sp.Rational(1, 10**12)

# goal, op, hypotheses, the only point of violation or one of a few
VIOLATED = [
    (y, ">", [CIRCLE, (x - 1, ">=")], (1, 0)),
    (-1, ">=", [CIRCLE, (x - 1, ">=")], (1, 0)),
    (y, "!=", [CIRCLE, (x + 1, "==")], (-1, 0)),
    (1 - x, ">", [CIRCLE], (1, 0)),
    ((1 - x) ** 2, ">", [CIRCLE], (1, 0)),
    (x - 1, ">=", [CIRCLE, (y, ">="), (-y, ">=")], (-1, 0)),
    (y, ">=", [CIRCLE, (x * y, "=="), (x, "==")], (0, -1)),
    (x - sp.Rational(1, 2), ">=", [ISOLATED], (0, 0)),
    (x, ">", [ISOLATED, (x - 1, "!=")], (0, 0)),
    (-1, ">=", [CUSP, (-x, ">=")], (0, 0)),
    (x, ">", [CUSP], (0, 0)),
    (x**2 + y**2, ">", [CUSP, (y, ">=")], (0, 0)),
    (x, ">", [(x**2 + y**2, "==")], (0, 0)),
    (x + y, ">", [AXES, (x, ">="), (y, ">=")], (0, 0)),
    (x + y, ">=", [AXES, (x, ">="), (-y, ">="), (x, "==")], (0, -2)),
    (x, ">=", [CIRCLE, ((x - 1) ** 2 + y**2 - 4, "==")], (-1, 0)),  # two circles that touch
    (x, ">=", [((x - 1) ** 2 + y**2 - 4, ">="), (1 - x**2 - y**2, ">=")], (-1, 0)),
    (y, ">=", [((x**2 + y**2 - 1) * (x - 5), "=="), (x - 5, ">=")], (5, -1)),
    (x, ">", [(y - x**2, "=="), (-y, ">=")], (0, 0)),
    (x + y, ">", [(x**2 + y**2 - 2, "=="), (x - y, "==")], (-1, -1)),
    (x + y, ">", [(x, ">="), (y, ">="), (-x - y, ">=")], (0, 0)),
    (x + y, ">", [(x, ">="), (y, ">=")], (0, 0)),
    ((x - y) ** 2, ">", [(x, ">"), (y, ">")], (1, 1)),
    (x * y - TINY, ">=", [(x, ">"), (y, ">")], (Fraction(1, 10**7), Fraction(1, 10**7))),
    (x**2 + y**2 - TINY, ">", [], (0, 0)),
    (x**2 * y, ">", [(y, ">")], (0, 1)),
    (-(x**2) * y**2, ">=", [(x, "!="), (y, "!=")], (1, 1)),
    (y - 1, "!=", [(x, ">"), (y, ">=")], (1, 1)),
    (x - y, "==", [(x * (x - 1), "=="), (y * (y - 1), "==")], (0, 1)),
    (x, ">=", [(x**2 - 1, "=="), (x - 1, "!=")], (-1, 0)),
    (-1, ">", [(-(x**2), ">="), (-(y**2), ">=")], (0, 0)),
]
HOLDS = [
    (1 - x, ">=", [CIRCLE]),
    (x + y + 2, ">", [CIRCLE]),
    (x * y - 1, "!=", [CIRCLE]),
    (x, ">=", [CUSP]),
    (y - x**3, "==", [(y - x**3, "==")]),
    (-1, ">", [CIRCLE, (x**2 + y**2 - 2, "==")]),
    (-1, ">", [CIRCLE, (x - 2, ">")]),
    (x - 1, ">=", [ISOLATED, (x, ">")]),
    (x**2, ">=", [(x * y - 1, "==")]),
    (x, ">", [(x * y - 1, "=="), (y, ">")]),
    (x**2 + y**2 - x * y + 1, ">", []),
    (x**2 + y**2 - x * y, ">=", [(x, ">="), (y, ">=")]),
    (x * y + 1, ">", [(x, ">"), (y, ">")]),
    (x * y, ">=", [(x, ">="), (1 - x, ">="), (y, ">")]),
    (1 - x * y, ">", [(x, ">="), (1 - x, ">"), (y, ">="), (1 - y, ">=")]),
    (y, ">", [(y**2 - 2, "=="), (y, ">=")]),
    (1 - y**2, ">=", [CIRCLE, (x, "==")]),
    (-1, ">", [CIRCLE, (x, "=="), (y, "==")]),
]


def _system(goal: sp.Expr | int, op: str, given: list[tuple[sp.Expr, str]]) -> System:
    return System(Relation(sp.sympify(goal), op), tuple(Relation(sp.expand(p), o) for p, o in given), (), (x, y))


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_SYSTEMS)
def test_what_is_violated_at_one_point(name: str) -> None:
    for goal, op, given, point in VIOLATED:
        for said in (given, given[::-1]) if len(given) > 1 else (given,):
            system = _system(goal, op, said)
            assert system_violated(system, {x: Fraction(point[0]), y: Fraction(point[1])})
            assert OF_SYSTEMS[name](system).holds is not True, (goal, op, said)


@pytest.mark.parametrize("name", OF_SYSTEMS)
def test_what_holds_there(name: str) -> None:
    for goal, op, given in HOLDS:
        answer = OF_SYSTEMS[name](_system(goal, op, given)).holds
        assert answer is True, (goal, op, given, answer)


@pytest.mark.parametrize("name", OF_SYSTEMS)
def test_what_is_violated_at_irrational_points_alone(name: str) -> None:
    """y = x at -sqrt(2), on a line through it, on the circle through it."""
    for more in ([], [(x - y, "==")], [(x**2 + y**2 - 4, "==")], [(x - y, ">="), (y - x, ">=")]):
        assert OF_SYSTEMS[name](_system(x, ">=", [(x**2 - 2, "=="), *more])).holds is not True
