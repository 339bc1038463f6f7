"""A polynomial question made smaller: each part as it is written down, and the way back to a point of the whole."""

from __future__ import annotations

import pytest
import sympy as sp

from duhem.expression import symbol
from duhem.proof.decide import Budget, reduction
from duhem.proof.decide.exact import by_exact
from duhem.proof.decide.polynomials import Relation, System
from duhem.proof.decide.reduction import Reduction, _is_circle, _rational_roots, _terms, _turned, parts, variables

x, y, z = (symbol(name) for name in "xyz")
CIRCLE = Relation(x**2 + y**2 - 1, "==")
HALF = sp.Rational(1, 2)
Row = tuple[sp.Expr, str]


def system(goal: Row, *given: Row, circle: bool = False, symbols: tuple[sp.Symbol, ...] = (x, y, z)) -> System:
    relations = tuple(Relation(sp.expand(sp.sympify(p)), op) for p, op in given)
    return System(
        Relation(sp.sympify(goal[0]), goal[1]), (*relations, CIRCLE) if circle else relations, (), symbols, (x, y) if circle else None
    )


def told(part: Reduction) -> tuple[Row, list[Row]]:
    goal = part.system.goal
    return (goal.poly, goal.op), [(r.poly, r.op) for r in part.system.given]


GOAL = (x + y, ">=")


@pytest.mark.parametrize(
    ("given", "goals"),
    [
        ([(y - x**2, ">=")], [x + y]),
        ([(2 * x - 1, "==")], [y + HALF]),
        ([(x * (x - 1) * (x + 3), "==")], [y - 3, y + 1, y]),
        ([(x * (x - 1) * (x**2 + 1), "==")], [y, y + 1]),
        ([((x - 1) ** 2, "==")], [y + 1]),
        ([(x**2 + 1, "==")], []),  # no value at all
        ([(x**2 - 2, "==")], [x + y]),  # no rational value
        ([(x * (x**2 - 2), "==")], [x + y]),
        ([(2 * x + y - 3, "==")], [(y + 3) / 2]),
        ([(x**2 + 2 * y, "==")], [x - x**2 / 2]),
        ([(x * y - 1, "==")], [x + y]),  # linear, with a factor that may be 0
        ([(x * y + x, "==")], [x + y]),
        ([(x, ">="), (-x, ">=")], [y]),
        ([(x, ">="), (-x, ">")], [x + y]),
        ([(x, "!="), (-x, "!=")], [x + y]),
        ([(x - 1, ">="), (1 - x, ">="), (y - x, "==")], [sp.Integer(2)]),
        ([(x**2 - 1, "=="), (x, ">")], [y + 1]),
        ([(x**2 - 1, "=="), (x, "!="), (y - x, ">=")], [y - 1, y + 1]),
        ([(x * (x - 1), "=="), (y * (y - 2), "==")], [sp.Integer(0), sp.Integer(1), sp.Integer(2), sp.Integer(3)]),
        ([(x, "=="), (x - 1, "==")], []),
        ([(y, ">="), (x - y**2, "!="), (2 * x - 1, "==")], [y + HALF]),  # after what is no equation,
        ([(x * y - 1, "=="), (y - 2, "==")], [5 * HALF]),  # or gives no value
        ([(x**2 - 2, "=="), (x * y - 1, "=="), (2 * y - x, "==")], [3 * y]),
    ],
)
def test_equations_are_put_in_place(given: list[Row], goals: list[sp.Expr]) -> None:
    found = [told(part)[0] for part in parts(system(GOAL, *given))]
    assert {sp.expand(poly) for poly, _ in found} == {sp.expand(goal) for goal in goals}
    assert len(found) == len(goals) and {op for _, op in found} <= {">="}


def test_what_is_put_in_place_leaves_the_other_hypotheses() -> None:
    (part,) = parts(system((z, ">"), (x - 2, "=="), (x, ">"), (x * y, ">="), (2 * y, ">="), (2 * y, ">="), (y - z, "!=")))
    assert told(part) == ((z, ">"), [(2 * y, ">="), (y - z, "!=")])
    assert part.system.variables == (y, z) and part.steps == ((x, 2),) and variables(part.system) == {y, z}
    assert part.restored({z: sp.Integer(5)}) == {x: 2, y: 0, z: 5}


def test_the_way_back_goes_through_every_step() -> None:
    (part,) = parts(system((z, ">"), (y - x**2 - z, "=="), (x - 3, "==")))
    assert part.system.variables == (z,) and part.restored({z: sp.Integer(4)}) == {x: 3, y: 13, z: 4}
    chain = Reduction(system((z, ">")), ((y, z + 1), (x, 2 * y)))
    assert chain.restored({z: sp.Integer(1)}) == {x: 4, y: 2, z: 1}


def test_a_value_that_a_hypothesis_denies_is_no_part() -> None:
    whole = Reduction(system((z, ">"), (x, ">"), (x * y, ">"), circle=True))
    assert whole.at(x, sp.S.NegativeOne) is None and whole.at(x, sp.S.Zero) is None
    inside = whole.at(x, HALF)
    assert inside is not None and inside.system.circle is None and inside.system.variables == (y, z)
    assert told(inside) == ((z, ">"), [(y / 2, ">"), (y**2 - sp.Rational(3, 4), "==")])
    beside = whole.at(z, sp.S.One)
    assert beside is not None and beside.system.circle == (x, y) and beside.system.goal == Relation(sp.S.One, ">")


def test_the_circle_by_its_half_angle() -> None:
    """(1 + t^2) (x + 1) = 2; and the point (-1, 0), which has no t."""
    west, turned = parts(system((x + 1, ">"), (y, ">="), circle=True))
    assert told(west) == ((sp.Integer(0), ">"), []) and west.system.circle is None
    assert west.restored({}) == {x: -1, y: 0, z: 0}
    (t,) = variables(turned.system)
    assert t.is_real
    assert told(turned) == ((sp.Integer(2), ">"), [(2 * t, ">=")]) and turned.system.variables == (z, t) and turned.system.circle is None
    assert turned.restored({t: sp.Rational(1, 3)}) == {x: sp.Rational(4, 5), y: sp.Rational(3, 5), z: 0, t: sp.Rational(1, 3)}


def test_the_point_without_a_half_angle_is_asked_about_where_it_may_be() -> None:
    assert len(parts(system((x, ">"), (x, ">="), circle=True))) == 1
    assert len(parts(system((x, ">"), (y, ">"), circle=True))) == 1
    assert len(parts(system((x, ">"), (-x, ">"), circle=True))) == 2


def test_on_the_circle_only_what_says_a_number_is_put_in_place() -> None:
    assert {told(part)[0][0] for part in parts(system((x, ">"), (y, "=="), circle=True))} == {1, -1}
    assert len(parts(system((x + z, ">"), (x + z, "=="), circle=True))) == 2  # its half-angle and the point without one
    found = parts(system((x + z, ">"), (2 * z - 1, "=="), circle=True))
    assert [told(part)[0][0] for part in found] == [-HALF, 3 * HALF - variables(found[1].system).pop() ** 2 / 2]
    free = system((z, ">="), (z - 1, "!="))
    (alone,) = parts(System(free.goal, free.given, (), (x, y, z), (x, y)))
    assert told(alone) == ((z, ">="), [(z - 1, "!=")])


def test_what_is_the_circle() -> None:
    assert _is_circle(CIRCLE, x, y) and _is_circle(Relation(sp.S.Zero, ">="), x, y)
    for poly, op in ((CIRCLE.poly, ">="), (x**2 + y**2, "=="), (x**2 + y - 1, "=="), (x**2 + 2 * y**2 - 1, "=="), (x + y, "==")):
        assert not _is_circle(Relation(poly, op), x, y)


def test_a_polynomial_of_the_half_angle() -> None:
    """Times (1 + t^2)^n: of degree n in x and y, whatever its degree in the rest."""
    t = sp.Symbol("t", real=True)
    assert _turned(x * y + z**3, x, y, t) == sp.expand(2 * t * (1 - t**2) + z**3 * (1 + t**2) ** 2)
    assert _turned(x**3 - 3 * y, x, y, t) == sp.expand((1 - t**2) ** 3 - 6 * t * (1 + t**2) ** 2)
    assert _turned(z + 1, x, y, t) == z + 1 and _turned(sp.S.Zero, x, y, t) == 0


def test_roots_that_are_rational() -> None:
    def found(poly: sp.Expr) -> list[sp.Rational] | None:
        roots = _rational_roots(sp.Poly(poly, x, domain="QQ"))
        return roots and sorted(roots)

    assert found((x - 1) ** 3 * (3 * x + 2) * (x**2 + 1)) == [sp.Rational(-2, 3), 1] and found(x**2 + 1) == []
    assert found((x - 1) * (x**2 - 2)) is None and found(x**3 - 2) is None and found(x**5) == [0]


def test_a_value_with_too_many_terms_is_not_put_in_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """A power n of a sum of k terms has as many as n things can be shared out to k."""
    asked = system((x**2 * y + y, ">="), (x * y - 1, ">="), (z, ">="), (sp.S.Zero, "=="))
    assert [_terms(asked, x, count) for count in (1, 2, 3)] == [2 + 2 + 1 + 1, 2 * 3 + 2 * 2 + 1 + 1, 2 * 6 + 2 * 3 + 1 + 1]
    seen: list[tuple[sp.Symbol, int]] = []
    for most, count in ((20_000, 1), (20_001, 0)):
        monkeypatch.setattr(reduction, "_terms", lambda whole, of, count, most=most: seen.append((of, count)) or most)
        (part,) = parts(system(GOAL, (z - x**2 - y - 1, "==")))
        assert len(part.steps) == count
    assert seen == [(y, 3), (y, 3), (z, 3)]  # of two that may be put in place the first by its name


def test_only_so_many_parts() -> None:
    symbols = [symbol(f"x{i}") for i in range(6)]
    found = parts(System(Relation(sp.Add(*symbols), ">="), tuple(Relation(s * (s - 1), "==") for s in symbols), (), tuple(symbols), None))
    assert len(found) == 33 == len({part.steps for part in found})


@pytest.mark.parametrize(
    ("goal", "given", "method"),
    [
        ((x**2 + 1, ">"), [], "sturm"),
        ((x + 2, ">"), [(x**2 - 1, "==")], "sturm"),
        ((x**2 + y**2 + 1, ">"), [], "plane-cells"),
        ((x + y + 3, ">="), [(x**2 + y**2 - 4, "==")], "plane-cells"),
        ((x + z**2 + y**2, ">="), [(x * (x - 1), "==")], "plane-cells"),
    ],
)
def test_the_answer_names_the_decider_of_the_hardest_part(goal: Row, given: list[Row], method: str) -> None:
    answer = by_exact(system(goal, *given), Budget(10**6))
    assert (answer.holds, answer.method) == (True, method)


def test_a_violation_of_a_part_is_one_of_the_whole() -> None:
    answer = by_exact(system((x, ">="), (x**2 - 1, "=="), (y - 3 * x, "==")), Budget(10**6))
    assert answer.holds is False and answer.point is not None and [answer.point[s] for s in (x, y, z)] == [-1, -3, 0]
    assert by_exact(system((x * y * z + x + y, ">=")), Budget(10**6)).holds is None
