"""Branch and bound in boxes: what a ball says, which box is asked, how it is halved, when it stops and what it costs."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import flint
import pytest
import sympy as sp

from duhem.expression import symbol
from duhem.proof.decide import Answer, Budget, Question, Sense
from duhem.proof.decide.enclosure import _bounds, _holds, by_enclosure

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
    assert _bounds(of, Question(of, P, given)) == span
    assert _bounds(of, Question(of, P, given, (of, z))) == (-1, 1)  # on the circle


def asked(question: Question, steps: int = 100_000) -> Answer:
    return by_enclosure(question, Budget(steps))


def test_what_is_proved_refuted_and_left_open() -> None:
    assert asked(Question(sp.exp(x), P, BOX)) == Answer(True, "interval", reason="1 boxes")
    assert asked(Question(sp.exp(x) - x - sp.Rational(1, 2), P, BOX)).reason == "9 boxes"
    assert asked(Question(x**2, N, BOX)).holds is True and asked(Question(x**2, P, BOX)).holds is None
    assert asked(Question(-sp.exp(x), P, (), (x, y))).holds is None
    assert asked(Question(sp.exp(x + y) - sp.Rational(1, 5), P, (), (x, y))).holds is True  # exp(-sqrt(2)) is the least
    assert asked(Question(sp.exp(x + y) - sp.Rational(1, 4), P, (), (x, y))).holds is None
    assert asked(Question(sp.exp(x - 2 * y) - sp.Rational(1, 5), P, BOX)).reason == "y is not bounded"
    assert asked(Question(x, P, (sp.Ge(x, 1),))) == Answer(None, "interval", reason="x is not bounded")
    assert asked(Question(x, P, (sp.Le(x, 1),))) == Answer(None, "interval", reason="x is not bounded")
    assert asked(Question(sp.S.Zero, Sense.ZERO)) == Answer(None, "interval", reason="an enclosure cannot prove an equality")


@pytest.mark.parametrize(
    ("relation", "excluded"),
    [
        (sp.Gt(x, -2), False),
        (sp.Gt(x, 2), True),  # nowhere
        (sp.Gt(x, sp.S.Half), False),  # somewhere
        (sp.Le(x, 2), False),
        (sp.Ne(x, 2), False),
        (sp.Ne(x, 1), False),
        (sp.Eq(x, 2), True),
        (sp.Eq(x, sp.S.Half), False),
    ],
)
def test_only_where_a_hypothesis_surely_fails_nothing_is_shown(relation: sp.Basic, excluded: bool) -> None:
    for given in ((relation,), (relation, sp.Gt(y, -3)), (sp.Gt(y, -3), relation)):
        assert asked(Question(-1 - x**2 - y**2, N, given, (x, y))).holds is (True if excluded else None)
        assert asked(Question(1 + x**2 + y**2, N, given, (x, y))).holds is True


def test_hypotheses_on_other_symbols_without_bounds_are_left_out() -> None:
    """What holds without them holds with them; what is violated need not be."""
    for given in ((sp.Gt(z, 0),), (sp.Gt(z, x), sp.Gt(z, 5)), (sp.Ge(z, 1), sp.Le(z, sp.exp(x)))):
        assert asked(Question(sp.exp(x), P, (*BOX, *given))).holds is True
        assert asked(Question(sp.exp(z), P, (*BOX, *given))).holds is None


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
