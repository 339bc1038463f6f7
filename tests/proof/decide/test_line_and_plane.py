"""The exact deciders on the line and in the plane, piece by piece: signs, cells, projections, what lies over their roots."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import flint
import pytest
import sympy as sp

from duhem.expression import symbol
from duhem.proof.decide import Answer, Budget, line_cells, plane_curve, plane_region
from duhem.proof.decide.bivariate import DegenerateError, Integral, OpenError, _bits, _bound, _joined, _leading, _price, projection, true
from duhem.proof.decide.line_cells import by_cells
from duhem.proof.decide.plane_curve import _columns, _Component, _component, by_plane
from duhem.proof.decide.plane_region import by_region
from duhem.proof.decide.polynomials import Relation, System
from duhem.proof.decide.roots import _plain, between, real_roots

x, y, z = (symbol(name) for name in "xyz")
ONE, MINUS, ZERO = flint.arb(1), flint.arb(-1), flint.arb(0)
OPEN, WEAK = flint.arb(0, 1), flint.arb(0, 1).nonnegative_part()
POLYS = Integral(x, y)
Row = tuple[sp.Expr | int, str]


def system(goal: Row, *given: Row) -> System:
    relations = tuple(Relation(sp.expand(sp.sympify(p)), op) for p, op in given)
    return System(Relation(sp.expand(sp.sympify(goal[0])), goal[1]), relations, (), (x, y, z), None)


def near(answer: Answer, at: dict[sp.Symbol, Any]) -> bool:
    """Whether it says no, at this point."""
    point = answer.point or {}
    return answer.holds is False and all(abs(sp.N(point[s] - v, 30)) < 1e-15 for s, v in at.items())


# -- roots and cells --------------------------------------------------------------------------------------------------


def test_between_roots_and_beyond() -> None:
    roots = real_roots(flint.fmpz_poly([55, -32, 4]), 64, Budget(10**4))  # 5/2 and 11/2
    assert between(roots) == [1, 4, 7]
    assert between([]) == [0]
    assert between([flint.arb(-4, 3), flint.arb(0), flint.arb(4, 3)]) == [-9, Fraction(-1, 2), Fraction(1, 2), 9]  # balls, not middles
    assert between(real_roots(flint.fmpz_poly([1, 2]), 64, Budget(10**4))) == [-2, 1]


@pytest.mark.parametrize(
    ("low", "high", "middle"),
    [
        (1, 2, Fraction(3, 2)),
        (0, 101, 50),
        (0, 1, Fraction(1, 2)),
        (Fraction(1, 3), Fraction(1, 2), Fraction(5, 12)),
        (Fraction(1, 10**6), Fraction(7, 10**6), Fraction(1, 250_000)),
        (Fraction(314159, 10**5), Fraction(314160, 10**5), Fraction(628319, 200_000)),
        (Fraction(314159, 10**5), Fraction(3147, 10**3), Fraction(937, 298)),
        (Fraction(314159, 10**5), Fraction(3141597, 10**6), Fraction(5227998, 1664123)),
    ],
)
def test_a_plain_number_between(low: Fraction, high: Fraction, middle: Fraction) -> None:
    assert _plain(Fraction(low), Fraction(high)) == middle


def test_roots_are_paid_for_by_degree_and_precision() -> None:
    budget = Budget(1000)
    real_roots(flint.fmpz_poly([-2, 0, 0, 1]), 256, budget)
    assert budget.left == 1000 - (10 + 9 * 356 // 25)
    assert real_roots(flint.fmpz_poly([7]), 256, budget) == [] and budget.left == 862
    budget = Budget(10**4)
    assert len(real_roots(flint.fmpz_poly([-2, *[0] * 9, 1]), 1000, budget)) == 2 and budget.left == 10**4 - 10 - 4_400


def test_signs_at_roots_and_beside() -> None:
    assert list(line_cells._integral(x / 2 - sp.Rational(1, 3), x)) == [-2, 3]
    assert list(line_cells._integral(sp.Rational(3, 2) * x**2 + 6, x)) == [12, 0, 3]
    two = flint.fmpz_poly([-2, 0, 1])
    assert [line_cells._sign_at(two, Fraction(n, 10)) for n in (14, 15, -15)] == [-1, 1, 1]
    assert [line_cells._sign_at(flint.fmpz_poly([-1, 2]), Fraction(n, 2)) for n in (0, 1, 2)] == [-1, 0, 1]
    (_, root) = real_roots(two, 64, Budget(10**4))
    third, product = flint.fmpz_poly([-1, 1]), two * flint.fmpz_poly([-5, 1])
    assert [line_cells._sign_at_root(p, two, root) for p in (two, product, third, -third)] == [0, 0, 1, -1]
    close = flint.fmpz_poly([-int(sp.floor(sp.sqrt(2) * 10**30)), 10**30])
    with pytest.raises(OpenError):
        line_cells._sign_at_root(close, two, root)
    assert line_cells._factors([product * product, flint.fmpz_poly([4]), 2 * two]) == [two, flint.fmpz_poly([-5, 1])] or (
        line_cells._factors([product * product, flint.fmpz_poly([4]), 2 * two]) == [flint.fmpz_poly([-5, 1]), two]
    )


@pytest.mark.parametrize(("op", "truth"), [(">=", "nyy"), (">", "nny"), ("==", "nyn"), ("!=", "yny")])
def test_truth_of_a_sign(op: str, truth: str) -> None:
    assert [true(sign, op) for sign in (-1, 0, 1)] == [t == "y" for t in truth]
    assert [Relation(sp.Integer(sign), op).holds() for sign in (-1, 0, 1)] == [t == "y" for t in truth]


def test_signs_at_roots_in_sixteen_thousand_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []

    def stays_open(p: Any, factor: Any, root: Any) -> int:
        seen.append(flint.ctx.prec)
        raise OpenError("open")

    monkeypatch.setattr(line_cells, "_sign_at_root", stays_open)
    answer = by_cells(system((x + 3, ">"), (x**2 - 2, "==")), Budget(10**6))
    assert answer == Answer(None, "sturm", reason="a sign at a root stays open") and seen == [64, 1024, 16384]


def test_on_the_line() -> None:
    def asked(goal: Row, *given: Row) -> Answer:
        return by_cells(system(goal, *given), Budget(10**5))

    assert asked((x**2 + 1, ">")) == Answer(True, "sturm")
    assert asked((x + y, ">")) == Answer(None, "sturm", reason="2 variables remain")
    assert near(asked((x - 4, ">="), (x, ">"), (x - 3, "!=")), {}) and near(asked((x**2 - 5, "!="), (x, ">=")), {x: sp.sqrt(5)})
    assert near(asked((x, ">"), (x**2 - 4, "=="), (x - 2, "!=")), {x: -2})
    assert asked((1, ">"), (x, ">")).holds is True and asked((-1, ">"), (x**2, ">=")).holds is False
    below, above = (sp.Rational(int(sp.floor(sp.sqrt(2) * 10**90)) + k, 10**90) for k in (0, 1))
    for end, holds in ((below, True), (above, False)):  # a sign at a root that shows in many digits
        assert asked((x - end, ">"), (x**2 - 2, "=="), (x, ">")).holds is holds
    # steps of its one factor, twice: between its roots and at them
    budget = Budget(10**5)
    by_cells(system((x**2 - 2 * x + 2, ">")), budget)
    assert budget.left == 10**5 - 2 * (10 + 4 * 164 // 25)


# -- projections ------------------------------------------------------------------------------------------------------


def test_what_a_resultant_may_cost() -> None:
    one, two = POLYS(10**60 * y**2 + x**2 - 1), POLYS(2 * y - x**3)
    assert (_bits(one), _bits(two), _bits(POLYS(sp.Integer(0)))) == (202, 4, 2)
    assert _bound(one, two) == 2 * 1 + 3 * 2 == _bound(two, one)
    assert _price(one, two) == 10 + 8 * (1 * 202 + 2 * 4) * 2**3 // 1000 == _price(two, one) == 23
    assert _price(one, one) == 10 + 8 * (4 * 202) * 2**3 // 1000
    high, low = POLYS(10**60 * y**6 + x**30), POLYS(y**3 - x)
    assert _price(high, low) == 10 + 96 * (3 * 202 + 6 * 3) * 6**3 // 1000 == 12_949
    budget = Budget(100)
    projection([one, two], [(one, two)], budget)
    assert budget.left == 100 - 23 - 61


def test_a_projection_beyond_its_degree_is_not_begun() -> None:
    for curve in (y**2 - x**100, y - x**500):
        projection([POLYS(curve)], [], Budget(10**6))
    with pytest.raises(OpenError, match="degree 404"):
        projection([POLYS(y**2 - x**101)], [], Budget(10**9))
    with pytest.raises(OpenError, match="degree 500"):
        projection([], [(POLYS(y - x**500), POLYS(y - 1))], Budget(10**9))
    with pytest.raises(OpenError, match="degree 401"):
        projection([], [(POLYS(y - x**401), POLYS(y - 1))], Budget(10**9))


def test_the_parts_of_a_projection() -> None:
    assert _leading(POLYS((x**2 - 1) * y**3 + 5 * x * y + 2)) == POLYS(x**2 - 1)
    squares = _joined([POLYS((x - 1) ** 2 * (x - 2)), POLYS((x - 2) * x**3), POLYS(sp.Integer(3))])
    assert squares.degree() == 3 and [squares(k) for k in (0, 1, 2)] == [0, 0, 0]
    with pytest.raises(DegenerateError):
        _joined([POLYS(x), POLYS(sp.Integer(0))])


# -- along a curve ----------------------------------------------------------------------------------------------------

HELD = {">": "y....", ">=": "y.y.y", "!=": "yy...", "==": "....."}
FAILED = {">": ".yy..", ">=": ".y...", "==": "yy...", "!=": "....."}


@pytest.mark.parametrize("op", HELD)
def test_what_a_ball_shows(op: str) -> None:
    balls = (ONE, MINUS, ZERO, OPEN, WEAK)
    assert "".join("y" if plane_curve._holds(ball, op) else "." for ball in balls) == HELD[op]
    assert "".join("y" if plane_curve._fails(ball, op) else "." for ball in balls) == FAILED[op]
    assert plane_curve._fails(-WEAK, op) is (op == ">")


def test_a_sign_that_must_be_sure() -> None:
    assert [plane_curve._sign(ball) for ball in (ONE, MINUS, ZERO)] == [1, -1, 0]
    assert [plane_region._sign(flint.fmpq(n, 3)) for n in (2, -2, 0)] == [1, -1, 0]
    with pytest.raises(OpenError):
        plane_curve._sign(OPEN)


@pytest.mark.parametrize(
    ("op", "goal", "given", "gradient", "settled"),
    [
        (">=", WEAK, [], [ZERO, ZERO], True),  # the goal holds
        (">", WEAK, [(MINUS, ">=")], [ZERO, ZERO], True),  # a hypothesis fails
        (">", WEAK, [(ONE, ">=")], [ONE, ONE], False),  # no word on a strict goal from beside
        ("==", ZERO, [], [ONE, ONE], False),
        (">=", OPEN, [], [ONE, ZERO], True),
        (">=", OPEN, [], [OPEN, MINUS], True),
        (">=", OPEN, [], [OPEN, ZERO], False),  # perhaps no arc comes from beside
        (">=", OPEN, [(OPEN, ">")], [ONE, ONE], True),
        (">=", OPEN, [(OPEN, "!=")], [ONE, ONE], True),
        (">=", OPEN, [(OPEN, ">=")], [ONE, ONE], False),  # perhaps it holds at the point and not beside
        (">=", OPEN, [(ONE, ">=")], [ONE, ONE], True),
        (">=", OPEN, [(ONE, ">="), (OPEN, ">")], [ONE, ONE], False),
        (">=", OPEN, [(ONE, ">="), (MINUS, "!=")], [MINUS, ZERO], True),
        (">=", OPEN, [(ONE, ">="), (ONE, ">")], [ONE, ONE], True),
        (">=", OPEN, [(OPEN, "==")], [ONE, ONE], False),
        (">=", OPEN, [(ZERO, "==")], [ONE, ONE], False),
    ],
)
def test_what_is_settled_in_a_box_over_a_root(op: str, goal: Any, given: list[tuple[Any, str]], gradient: list[Any], settled: bool) -> None:
    component = _Component(POLYS(y), (), (POLYS(x), op))
    strict = all(op in (">", "!=") for _, op in given)
    assert component._settled(lambda ball: ball, given, goal, gradient, strict) is settled


def test_one_component_keeps_what_does_not_vanish_on_it() -> None:
    circle, line, number = POLYS(x**2 + y**2 - 1), POLYS(x - y), POLYS.ring.constant
    goal = (POLYS(y), ">=")

    def left(*given: tuple[Any, str], goal: Any = goal) -> Any:
        found = _component(POLYS.ring, circle, list(given), goal)
        return found and (found.given, found.goal)

    assert left((line, ">"), (circle, ">="), (2 * circle, "=="), (number(3), ">")) == (((line, ">"),), goal)
    for nowhere in ((circle, ">"), (circle, "!="), (number(-1), ">="), (number(0) - 1, "=="), (number(2), "==")):
        assert left((line, ">"), nowhere) is None, nowhere
    assert left(goal=(circle * line, ">=")) is None and left(goal=(circle, "==")) is None
    for op in (">", "!="):
        assert left(goal=(circle, op)) == ((), (number(-1), ">"))
    with pytest.raises(DegenerateError):
        _component(POLYS.ring, POLYS(x - 1), [], goal)
    assert _component(POLYS.ring, POLYS(x - 1), [(POLYS(x - 1), ">")], goal) is None


def test_coefficients_over_a_point() -> None:
    columns = _columns(POLYS(x**2 * y**2 + 3 * x**2 - x + 5), flint.arb(2))
    assert [int(c.unique_fmpz()) for c in columns] == [15, 0, 4]


def along(goal: Row, *given: Row, steps: int = 10**6) -> Answer:
    return by_plane(system(goal, *given), Budget(steps))


CIRCLE = (x**2 + y**2 - 1, "==")


def test_what_is_no_question_along_a_curve() -> None:
    assert along((y, ">=")) == Answer(None, "plane-cells", reason="no equation among the hypotheses")
    assert along((y, ">="), (z, "=="), CIRCLE) == Answer(None, "plane-cells", reason="3 variables remain")
    assert along((1, ">"), (x - 1, "==")) == Answer(None, "plane-cells", reason="1 variables remain")
    assert along((y, ">"), (x**2 - 2, "==")) == Answer(None, "plane-cells", reason="no curve among the hypotheses")
    assert along((y + 2, ">"), (x - 1, "=="), CIRCLE, (0, "==")) == Answer(True, "plane-cells")


def test_which_curve_is_followed_and_how_it_is_sheared(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of those in both variables one of the lowest degree; along the variable that has the lower degree in it."""
    asked: list[tuple[Any, ...]] = []
    raised: list[Exception] = []

    def noted(polys: Integral, curve: Relation, given: list[Relation], goal: Relation, budget: Budget) -> None:
        asked.append((polys.x, polys.y, curve.poly, [r.poly for r in given]))
        if raised:
            raise raised[0]

    monkeypatch.setattr(plane_curve, "_violation", noted)
    cubic, line, flat = x**3 + y, x + 2 * y - 3, y - 1
    along((x, ">"), (cubic, "=="), (flat, "=="), (line, ">"), (0, ">="))
    along((x, ">"), (cubic, "=="), (x * y - 1, "=="), (line, "=="), (flat, ">"))
    along((x, ">"), (x - y**2, "=="))
    assert asked == [(x, y, cubic, [flat, line]), (y, x, line, [cubic, x * y - 1, flat]), (y, x, x - y**2, [])]
    asked.clear()
    raised.append(DegenerateError())
    answer = along((x, ">"), CIRCLE)
    assert answer == Answer(None, "plane-cells", reason="no projection is in general position") and len(asked) == 6
    asked.clear()
    raised[0] = OpenError("dark")
    assert along((x, ">"), CIRCLE) == Answer(None, "plane-cells", reason="dark") and len(asked) == 1


def test_violations_along_a_curve() -> None:
    assert near(along((x - 1, ">="), (x - y**2 + 3, "=="), (y - 1, ">"), (2 - y, ">=")), {})
    assert along((3 - x, ">="), (y**2 - x, "=="), (y + 1, ">"), (1 - y, ">")).holds is True
    for goal, given in (((y - 2, ">="), (y + x**2 - y**3, "==")), ((2 * x - y, ">="), (x * y - 1, "=="))):
        answer = along(goal, given)
        assert answer.holds is False and answer.point is not None
        assert abs(sp.N(given[0].subs(answer.point), 40)) < 1e-25 and goal[0].subs(answer.point) < 0


@pytest.mark.parametrize("far", [3, 7])
def test_a_sheared_plane_is_turned_back(far: int) -> None:
    """An upright line hides from the projection along y."""
    answer = along((x - 1, ">="), (x * (x**2 + y**2 + 1), "=="), (y - far, ">"))
    assert near(answer, {x: 0}) and answer.point is not None and answer.point[y] > far
    assert along((x, "=="), (x * (x**2 + y**2 + 1), "=="), (y - far, ">")).holds is True


@pytest.mark.slow
@pytest.mark.parametrize("centre", [Fraction(c) for c in ("-7/3", "-1", "-2/5", "0", "3/10", "1", "2", "11/3", "5", "40")])
def test_no_point_over_a_root_is_left_out(centre: Fraction) -> None:
    """The top of the circle about (c, 0) and nothing else, wherever c is; and so for an isolated point."""
    c = sp.Rational(centre.numerator, centre.denominator)
    assert along((1 - y, ">"), ((x - c) ** 2 + y**2 - 1, "=="), steps=20_000).holds is not True
    assert along((1 - y, ">"), ((x - c) ** 2 + y**2 - 1, "=="), (x - c - 1, "!="), steps=20_000).holds is not True
    assert along((2 - y, ">"), ((x - c) ** 2 + y**2 - 1, "=="), steps=20_000).holds is True
    assert along((y - 1, ">="), ((x - c) ** 2 - y**2 * (y - 1), "=="), steps=20_000).holds is not True


@pytest.mark.slow
@pytest.mark.parametrize("far", [Fraction(c) for c in ("1/1000", "1/7", "1", "3", "7/2", "8", "100", "12345")])
def test_a_point_near_or_far_over_a_root_is_not_left_out(far: Fraction) -> None:
    """At (0, f) and (0, -f) of a circle, and at (1/f, f) of a hyperbola, whose leading coefficient is small there."""
    f = sp.Rational(far.numerator, far.denominator)
    circle, middle = (x**2 + y**2 - f**2, "=="), (x, "==")
    for up in (1, -1):
        assert along((f - up * y, ">"), circle, middle).holds is not True
        assert along((f - up * y + f / 100, ">"), circle, middle).holds is True
        hyperbola, there = (x * y - 1, "=="), (f * x - up, "==")
        assert along((-1, ">"), hyperbola, there).holds is not True
        assert along((f * up - y, "!="), hyperbola, there).holds is not True
        assert along((f * up - y + f / 100, "!="), hyperbola, there).holds is True


def test_a_point_beyond_all_floats() -> None:
    answer = along((-1, ">"), (x * y - 10**310, "=="), (x - 1, "=="))
    assert answer == Answer(None, "plane-cells", reason="the curve has a point too far away")


def test_a_root_near_the_end_of_what_bounds_them() -> None:
    """Over y = 0 the greater root of 50 x^2 - 99 x - 99 is 2.71, the largest of its quotients of coefficients 1.98."""
    curve = (50 * x**2 - 99 * x - 99 - y**2 - y, "==")
    assert along((y**2, ">"), curve, (x, ">")).holds is not True and along((y**2, ">"), curve, (-x, ">")).holds is not True
    assert along((y**2, ">"), curve, (x, ">"), (x - sp.Rational(27, 10), "!="), (x - 3, ">")).holds is True


def test_what_a_curve_costs() -> None:
    """The projection, the roots of it and beside them, and the boxes over them: the same each time."""
    left = []
    for goal, given in (((2 - y, ">"), CIRCLE), ((1 - y, ">="), CIRCLE)):
        budget = Budget(10**6)
        assert by_plane(system(goal, given), budget).holds is True
        left.append(10**6 - budget.left)
    assert left == [908, 330]
    for goal, given, holds, steps in (
        ((1 - y, ">"), [CIRCLE], None, 74_430),  # in ever smaller boxes
        ((x + y**3 + 3, ">"), [(x**4 + y**4 - 1, "==")], True, 5_561),
        ((x**3 + 5, ">="), [(x**5 + y**3 + x - 7, "=="), (-x, ">=")], False, 897),
    ):
        budget = Budget(10**6)
        assert by_plane(system(goal, *given), budget).holds is holds and 10**6 - budget.left == steps
    assert along((2 - y, ">"), CIRCLE, steps=50) == Answer(None, "plane-cells", reason="its steps are spent")


# -- in a region ------------------------------------------------------------------------------------------------------


def inside(goal: Row, *given: Row, steps: int = 10**6) -> Answer:
    return by_region(system(goal, *given), Budget(steps))


def test_what_is_no_question_about_a_region() -> None:
    no = Answer(None, "plane-cells", reason="it is no question about an open region of the plane")
    assert inside((x, ">=")) == inside((x + y + z, ">=")) == inside((x + y, "==")) == inside((x + y, "!=")) == no
    assert inside((x + y, ">="), (x * y, ">=")) == no
    assert inside((x + y**2, ">="), (x**3 - y, ">"), steps=20) == Answer(None, "plane-cells", reason="its steps are spent")


def test_in_a_region() -> None:
    assert inside((0, ">="), (x, ">"), (y, ">")) == Answer(True, "plane-cells")
    assert inside((x**2 + y**2, ">=")) == Answer(True, "plane-cells")
    assert inside((x**2 + y**2, ">")).holds is not True and inside((x**2 + y**2 + 1, ">")).holds is True
    assert inside((x * y, ">="), (x - 1, "!="), (y, "!=")).holds is False
    for goal, *given in (((y - x**2, ">="), (x + y - 1, ">")), ((x - y**3, ">"), (x - 5, ">="), (y - 1, ">="), (3 - y, ">="))):
        answer = inside(goal, *given)
        assert answer.holds is False and answer.point is not None and set(answer.point) == {x, y}
        assert goal[0].subs(answer.point) < 0 and all(p.subs(answer.point) > 0 for p, _ in given)
    assert inside((y - x**2, ">="), (y - x**2 - 1, ">")).holds is True and inside((x - y, ">="), (x - y, ">="), (x, ">=")).holds is None
    assert inside((9 - x, ">="), (x, ">="), (y - x, ">"), (9 - y, ">")).holds is True


def test_what_a_region_costs_and_which_way_it_is_cut() -> None:
    """Along the variable of the lower degree in the goal."""
    for goal, given, holds, steps in (
        ((x**4 + y**4 + x * y + 5, ">="), [], True, 2_388),
        ((x**4 + y**4 + x * y**2 + 5, ">"), [(y**3 - x, ">")], True, 19_495),
        ((x * y**3 + 5, ">="), [(x**2 + y**2 - 3, ">")], False, 1_892),
    ):
        budget = Budget(10**6)
        answer = by_region(system(goal, *given), budget)
        assert answer.holds is holds and 10**6 - budget.left == steps
    assert answer.point == {x: 2, y: -3}


def test_a_region_says_why_it_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    for fault, reason in ((DegenerateError(), "degenerate"), (OpenError("dark"), "dark")):

        def fails(*given: Any, fault: Exception = fault) -> None:
            raise fault

        monkeypatch.setattr(plane_region, "_violation", fails)
        assert inside((x + y, ">=")) == Answer(None, "plane-cells", reason=reason)
