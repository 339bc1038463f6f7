"""Branch and bound in boxes: what a ball says, which box is asked, how it is halved, when it stops and what it costs."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import flint
import pytest
import sympy as sp

from duhem.expression import symbol
from duhem.proof.decide import Answer, Budget, Question, Sense
from duhem.proof.decide.enclosure import _bounds, _box, _halves, _holds, _middle, _values, _widths, by_enclosure

x, y, z = symbol("x"), symbol("y"), symbol("z")
p, n, m = symbol("p", positive=True), symbol("n", nonnegative=True), symbol("m", negative=True)
N, P = Sense.NONNEGATIVE, Sense.POSITIVE
BOX = (sp.Ge(x, -1), sp.Le(x, 1))


class Ends(NamedTuple):
    """A ball known by its ends, which no ball of the library has at exactly 0."""

    low: int
    high: int

    def is_finite(self) -> bool:
        return True

    def lower(self) -> int:
        return self.low

    def upper(self) -> int:
        return self.high


BALLS = [Ends(-2, -1), Ends(-1, 0), Ends(-1, 1), Ends(0, 0), Ends(0, 1), Ends(1, 2)]
SAID = {  # of each of the balls: yes, no, open
    sp.GreaterThan: "n??yyy",
    sp.StrictGreaterThan: "nn?n?y",
    sp.LessThan: "yy?y?n",
    sp.StrictLessThan: "y??nnn",
    sp.Eq: "n????n",
    sp.Ne: "y????y",
}


@pytest.mark.parametrize("relation", SAID)
def test_what_a_ball_says_of_a_relation(relation: type) -> None:
    said = [_holds(ball, relation) for ball in BALLS]
    assert "".join({True: "y", False: "n", None: "?"}[one] for one in said) == SAID[relation]
    assert _holds(flint.arb("nan"), relation) is None and _holds(flint.arb("inf"), relation) is None


@pytest.mark.parametrize(
    ("of", "given", "span"),
    [
        (x, (), (None, None)),
        (p, (), (0, None)),
        (n, (sp.Le(n, 3),), (0, 3)),
        (n, (sp.Ge(n, 1), sp.Lt(n, 3)), (1, 3)),
        (x, (sp.Gt(x, -1), sp.Ge(x, -2), sp.Le(x, 2), sp.Lt(x, 1)), (-1, 1)),
        (x, (sp.Le(-1, x), sp.Ge(1, x), sp.Le(x, 3)), (-1, 1)),
        (x, (sp.Ge(x, y), sp.Le(x, y)), (None, None)),
        (x, (sp.Ge(y, 0), sp.Le(y, 1)), (None, None)),
        (x, (sp.Eq(x, 1), sp.Ne(x, 2)), (None, None)),
        (x, (sp.Eq(x, 1), sp.Ne(x, 2), *BOX), (-1, 1)),
        (x, (sp.Ge(x, sp.pi), sp.Le(x, sp.Rational(9, 2))), (None, Fraction(9, 2))),
        (x, (sp.Ge(2 * x, 1),), (None, None)),
    ],
)
def test_bounds_among_the_hypotheses(of: sp.Symbol, given: tuple[sp.Basic, ...], span: tuple[int | None, int | None]) -> None:
    assert _bounds(of, given) == span


def test_the_box_has_the_angle_of_the_circle_and_every_other_symbol() -> None:
    box, angle = _box(Question(x + 1, P, (sp.Ge(n, y), sp.Le(n, 2), *(r.xreplace({x: y}) for r in BOX)), (x, p)))
    assert angle is not None and box == {angle: (-1, 1), n: (0, 2), y: (-1, 1)}
    assert _box(Question(n, P, (sp.Le(n, 2),))) == ({n: (0, 2)}, None)
    assert _box(Question(n, P, (sp.Le(n, 2),), (x, y)))[1] is not None


def test_the_angle_runs_once_around_the_circle() -> None:
    """In half turns."""
    question = Question(x, P, (), (x, y))
    _, angle = _box(question)
    assert angle is not None
    for turn, (cos, sin) in {Fraction(0): (1, 0), Fraction(1, 2): (0, 1), Fraction(-1): (-1, 0), Fraction(-1, 2): (0, -1)}.items():
        values = _values({angle: (turn, turn)}, question, angle)
        assert set(values) == {x, y} and values[x].contains(cos) and values[y].contains(sin)
        assert _middle({angle: (turn - 1, turn + 1), n: (Fraction(1), Fraction(2))}, question, angle) == {x: cos, y: sin, n: Fraction(3, 2)}
    sixth = _middle({angle: (Fraction(1, 3), Fraction(1, 3))}, question, angle)
    assert abs(sixth[x] - Fraction(1, 2)) < 1e-12 and abs(sixth[y] ** 2 - Fraction(3, 4)) < 1e-11
    assert _middle({x: (Fraction(1), Fraction(2))}, Question(x, P), None) == {x: Fraction(3, 2)}
    assert set(_values({x: (Fraction(1), Fraction(2))}, Question(x, P), None)) == {x}


def test_halves_across_the_side_that_is_relatively_widest() -> None:
    whole = {x: (Fraction(-3), Fraction(1)), y: (Fraction(0), Fraction(2))}
    assert _widths(whole) == {x: 1.0, y: 2.0}
    assert _widths({x: (Fraction(1), Fraction(2))}) == {x: 0.5}
    assert _halves(whole) == [{**whole, y: (0, 1)}, {**whole, y: (1, 2)}]
    assert _halves({x: (Fraction(1), Fraction(2))}) == [{x: (1, Fraction(3, 2))}, {x: (Fraction(3, 2), 2)}]


def asked(question: Question, steps: int = 100_000) -> Answer:
    return by_enclosure(question, Budget(steps))


def test_what_is_proved_refuted_and_left_open() -> None:
    assert asked(Question(sp.exp(x), P, BOX)) == Answer(True, "interval", reason="1 boxes")
    assert asked(Question(sp.exp(x) - x - sp.Rational(1, 2), P, BOX)).reason == "9 boxes"
    assert asked(Question(x**2, N, BOX)).holds is True and asked(Question(x**2, P, BOX)).holds is None
    assert asked(Question(-sp.exp(x), P, (), (x, y))) == Answer(False, "interval", point={x: 1, y: 0})
    assert asked(Question(x, P, (sp.Ge(x, 1),))) == Answer(None, "interval", reason="x is not bounded")
    assert asked(Question(x, P, (sp.Le(x, 1),))) == Answer(None, "interval", reason="x is not bounded")
    assert asked(Question(sp.S.Zero, Sense.ZERO)) == Answer(None, "interval", reason="an enclosure cannot prove an equality")


@pytest.mark.parametrize(
    ("relation", "holds"),
    [
        (sp.Gt(x, -2), False),
        (sp.Gt(x, 2), True),  # nowhere
        (sp.Gt(x, sp.S.Half), None),  # somewhere
        (sp.Le(x, 2), False),
        (sp.Ne(x, 2), False),
        (sp.Ne(x, 1), False),
        (sp.Eq(x, 2), True),
        (sp.Eq(x, sp.S.Half), None),
    ],
)
def test_only_where_the_hypotheses_surely_hold_is_there_a_violation(relation: sp.Basic, holds: bool | None) -> None:
    for given in ((relation,), (relation, sp.Gt(y, -3)), (sp.Gt(y, -3), relation)):
        assert asked(Question(sp.S.NegativeOne, N, given, (x, y))).holds is holds
        assert asked(Question(sp.S.One, N, given, (x, y))).holds is True


def test_hypotheses_on_other_symbols_without_bounds_are_left_out() -> None:
    """What holds without them holds with them; what is violated need not be."""
    for given in ((sp.Gt(z, 0),), (sp.Gt(z, x), sp.Gt(z, 5)), (sp.Ge(z, 1), sp.Le(z, sp.exp(x)))):
        assert asked(Question(sp.exp(x), P, (*BOX, *given))).holds is True
        assert asked(Question(-sp.exp(x), P, given, (x, y))).holds is None
        assert asked(Question(sp.exp(z), P, (*BOX, *given))).holds is None
    assert asked(Question(-sp.exp(x), P, (), (x, y))).holds is False


def test_no_margin_ends_the_search() -> None:
    reason = "the margin is below the working precision"
    assert asked(Question(sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1, N)) == Answer(None, "interval", reason=reason)
    assert asked(Question(sp.exp(x) - 1, P, (sp.Ge(x, 0), sp.Le(x, 1)))) == Answer(None, "interval", reason=reason)


@pytest.mark.parametrize(("end", "boxes"), [(50, 3), (51, 1)])
def test_the_narrowest_box(end: int, boxes: int) -> None:
    """One of a relative width below 2^-50; the upper half is the first that is asked."""
    question = Question(sp.exp(x) - 1, P, (sp.Ge(x, 0), sp.Le(x, sp.Rational(1, 2**end))))
    budget = Budget(10**5)
    assert by_enclosure(question, budget).reason == "the margin is below the working precision"
    nodes = sum(1 for e in (question.expr, *question.given) for _ in sp.preorder_traversal(e))
    assert 10**5 - budget.left == boxes * (25 + 5 * nodes)


def test_a_point_on_the_circle_has_twelve_digits() -> None:
    question = Question(x, P, (), (x, y))
    angle = sp.Symbol("t")
    point = _middle({angle: (Fraction(1, 3), Fraction(1, 3))}, question, angle)
    assert point[y] == Fraction(3**0.5 / 2).limit_denominator(10**12) and 10**11 < point[y].denominator < 10**12


def test_a_box_costs_what_is_enclosed_over_it() -> None:
    """The first box leaves two, of which the steps pay none: 25 of the box, 5 of each node of the goal and the hypotheses."""
    question = Question(x**2 - x + 1, P, BOX)
    nodes = sum(1 for e in (question.expr, *BOX) for _ in sp.preorder_traversal(e))
    assert nodes == 14
    price = 25 + 5 * nodes
    for boxes, reason in ((1, "2 of 1 boxes still open"), (2, "3 of 2 boxes still open"), (3, "2 of 3 boxes still open")):
        budget = Budget(boxes * price + price - 1)
        answer = by_enclosure(question, budget)
        assert (answer.reason, budget.left) == (reason, price - 1)
