"""Algebraic questions as polynomials, written out: what is cleared, what is named, what must be shown beside the goal."""

from __future__ import annotations

import pytest
import sympy as sp
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyRing

from duhem.expression import Norm, symbol
from duhem.proof.decide import Budget, Question, Sense
from duhem.proof.decide.budget import SpentError
from duhem.proof.decide.polynomials import NotAlgebraicError, Relation, System, _expression, _Products, _Roots, polynomial_system

x, y = symbol("x"), symbol("y")
p, n = symbol("p", positive=True), symbol("n", nonnegative=True)
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
HALF, THIRD = sp.Rational(1, 2), sp.Rational(1, 3)
HIDDEN_ONE = (x + 1) ** 2 - x**2 - 2 * x  # is 1, which SymPy does not see

R, R1 = sp.Symbol("rho0"), sp.Symbol("rho1")


def asked(expr: sp.Expr, sense: Sense = N, *given: sp.Basic, circle: bool = False, steps: int = 10**6) -> System:
    return polynomial_system(Question(expr, sense, given, (x, y) if circle else None), Budget(steps))


def plain(relation: Relation) -> str:
    names = {s: sp.Symbol(s.name) for s in relation.poly.free_symbols}
    return f"{sp.expand(relation.poly.xreplace(names))} {relation.op} 0"


def told(system: System) -> tuple[str, list[str], list[str]]:
    """The goal, the hypotheses and the goals of the obligations."""
    return plain(system.goal), [plain(r) for r in system.given], [plain(o.goal) for o in system.obligations]


def line(expr: sp.Expr, op: str) -> str:
    return plain(Relation(sp.sympify(expr), op))


@pytest.mark.parametrize(
    ("expr", "sense", "goal", "divisors"),
    [
        (x - y, N, x - y, []),
        (x / y - 1, N, (x - y) * y, [y]),  # together with the sign of y
        (x / y - 1, P, (x - y) * y, [y]),
        (x / y - 1, Z, x - y, [y]),
        (x / y**2 - 1, N, x - y**2, [y]),
        (x / y**3 - 1, N, (x - y**3) * y, [y]),
        (x / p - 1, N, x - p, []),  # positive at sight
        (1 / (n + 1) - x, N, 1 - x * (n + 1), []),
        (1 / n - x, N, (1 - x * n) * n, [n]),
        (1 / x + 1 / y, N, (x + y) * x * y, [x, y]),
        (1 / x + 2 / x, N, 3 * x, [x]),
        (1 / x + 1 / x**2, N, x + 1, [x]),
        (1 / (x * (y + 1)) + 1 / x, N, (y + 2) * x * (y + 1), [x, y + 1]),
        (1 / (1 / x + 1), N, x * (x + 1), [x, x + 1]),
        (1 / (1 / x + 1) ** 2, P, x**2, [x, x + 1]),
        (y / HIDDEN_ONE, N, y, []),
        (y / (3 * HIDDEN_ONE) ** 2 - y, N, y / 9 - y, []),
        (((x + 1) / y - x / y) ** -2 - 1, N, y**2 - 1, [y]),
        ((x * y) ** 3 + (x + y) ** 2, N, (x * y) ** 3 + (x + y) ** 2, []),
        (x / 2 - THIRD, P, x / 2 - THIRD, []),
    ],
)
def test_quotients_are_cleared(expr: sp.Expr, sense: Sense, goal: sp.Expr, divisors: list[sp.Expr]) -> None:
    system = asked(expr, sense)
    assert plain(system.goal) == line(goal, sense.value) and system.circle is None
    assert sorted(plain(o.goal) for o in system.obligations) == sorted(line(d, "!=") for d in divisors)
    assert all(o.given == system.given and o.obligations == () and o.variables == system.variables for o in system.obligations)


def test_what_divides_nothing() -> None:
    with pytest.raises(NotAlgebraicError, match="division by zero"):
        asked(y / (HIDDEN_ONE - 1))


@pytest.mark.parametrize(
    ("relation", "cleared"),
    [
        (sp.Ge(x, y), line(x - y, ">=")),
        (sp.Le(x, y), line(y - x, ">=")),
        (sp.Gt(x, 1), line(x - 1, ">")),
        (sp.Lt(x, 1), line(1 - x, ">")),
        (sp.Eq(x, y), line(x - y, "==")),
        (sp.Ne(x, y), line(x - y, "!=")),
        (sp.Gt(1 / x, 1), line((1 - x) * x, ">")),
        (sp.Ne(1 / x, 1), line(1 - x, "!=")),
    ],
)
def test_hypotheses(relation: sp.Basic, cleared: str) -> None:
    assert told(asked(y, N, relation))[1] == [cleared]


def test_what_the_symbols_say_of_themselves() -> None:
    system = asked(p + n + x, N, sp.true)
    assert told(system) == (line(n + p + x, ">="), [line(n, ">="), line(p, ">")], []) and system.variables == (n, p, x)


@pytest.mark.parametrize(
    ("expr", "goal", "given", "obligations"),
    [
        (sp.sqrt(x) - 1, line(R - 1, ">="), [line(R**2 - x, "=="), line(R, ">=")], [line(x, ">=")]),
        (sp.sqrt(n) - 1, line(R - 1, ">="), [line(n, ">="), line(R**2 - n, "=="), line(R, ">=")], []),
        (x ** (3 * HALF) - 1, line(R * x - 1, ">="), [line(R**2 - x, "=="), line(R, ">=")], [line(x, ">=")]),
        (x**-HALF, line(x * 0 + R, ">="), [line(R**2 - x, "=="), line(R, ">=")], [line(x, ">="), line(R, "!=")]),
        (x ** (4 * THIRD), line(R * x, ">="), [line(R**3 - x, "=="), line(R, ">=")], [line(x, ">=")]),
        (sp.sqrt(1 / x), line(R, ">="), [line(x * R**2 - 1, "=="), line(R, ">=")], [line(x, ">="), *[line(x, "!=")] * 2]),
        (Norm(x, y), line(R, ">="), [line(R**2 - x**2 - y**2, "=="), line(R, ">=")], []),
        (Norm(x, y) ** 2 - x, line(x**2 + y**2 - x, ">="), [line(R**2 - x**2 - y**2, "=="), line(R, ">=")], []),
        (sp.sqrt(sp.Integer(8)) * x, line(2 * R * x, ">="), [line(R**2 - 2, "=="), line(R, ">=")], []),
    ],
)
def test_roots_are_named(expr: sp.Expr, goal: str, given: list[str], obligations: list[str]) -> None:
    assert told(asked(expr)) == (goal, given, obligations)


def test_a_root_of_a_root_is_named_after_it_and_asked_about_with_it() -> None:
    system = asked(sp.sqrt(sp.sqrt(x) - y) + sp.sqrt(x))
    first, second = [line(R**2 - x, "=="), line(R, ">=")], [line(R1**2 + y - R, "=="), line(R1, ">=")]
    assert told(system) == (line(R + R1, ">="), first + second, [line(x, ">="), line(R - y, ">=")])
    assert [[plain(r) for r in o.given] for o in system.obligations] == [[], first]
    assert [s.name for s in system.variables] == ["x", "y", "rho0", "rho1"]


def test_each_root_has_one_name() -> None:
    roots = _Roots(None)
    assert [roots.root(sp.Integer(8), 3), roots.root(sp.Rational(1, 4), 2)] == [2, HALF] and roots.found == {}
    assert roots.root(x, 2) is roots.root(x, 2) is not roots.root(x, 3)
    assert roots.root(sp.Integer(2), 2).is_nonnegative and len(roots.found) == 3
    assert roots.rewrite(x ** sp.Rational(1, 12)) in roots.found.values()
    for odd in (x ** sp.Rational(1, 13), x**y, sp.exp(x), sp.pi * x, sp.Abs(x)):
        with pytest.raises(NotAlgebraicError):
            roots.rewrite(odd)


def test_on_the_circle() -> None:
    """y^2 is 1 - x^2, in the goal and under roots."""
    circle = line(x**2 + y**2 - 1, "==")
    assert told(asked(y**3 + x * y**2, circle=True)) == (line(y * (1 - x**2) + x * (1 - x**2), ">="), [circle], [])
    assert told(asked(Norm(x, y) - x, circle=True)) == (line(1 - x, ">="), [circle], [])
    system = asked(sp.sqrt(2 - y**2) + p, P, circle=True)
    assert told(system)[:2] == (line(R + p, ">"), [line(p, ">"), circle, line(R**2 - x**2 - 1, "=="), line(R, ">=")])
    assert system.circle == (x, y) and [s.name for s in system.variables] == ["p", "x", "y", "rho0"]
    assert _Roots((x, y)).on_circle(1 / y) == 1 / y and _Roots(None).on_circle(y**2) == y**2
    assert asked(p, circle=True).variables == (p, x, y)


def test_products_are_paid_for() -> None:
    ring = PolyRing((x, y), sp.QQ, lex)
    (a, b), budget = ring.gens, Budget(1000)
    products = _Products(ring, budget)
    assert products.of([a + b, a - b + 1]) == (a + b) * (a - b + 1) and budget.left == 1000 - 2 * 2 - 2 * 2 * 3
    assert products.power(a, 5) == a**5 and products.power(a + b, 0) == 1 and budget.left == 984
    assert products.power(a + b, 2) == (a + b) ** 2 and budget.left == 984 - 2 * 2 - 2 * 2 * 2
    with pytest.raises(SpentError):
        asked((x + y + 1) ** 9, steps=500)


def test_a_polynomial_of_too_many_terms() -> None:
    class Long(list[int]):
        def as_expr(self) -> sp.Expr:
            return x

    assert _expression(Long(range(3000))) == x
    with pytest.raises(NotAlgebraicError, match="a polynomial has 3001 terms"):
        _expression(Long(range(3001)))


def test_of_a_square_only_what_it_divides_by_and_takes_a_root_of_is_asked() -> None:
    system = asked((1 / x + sp.sqrt(y)) ** 2)
    assert system.goal == Relation(sp.S.Zero, ">=")
    assert {o.goal for o in system.obligations} == {Relation(x, "!="), Relation(y, ">=")}
    for other in (asked((1 / x + sp.sqrt(y)) ** 3), asked((x - y) ** 2, P), asked((x - y) ** 2, Z), asked((x - y) ** 2 - 1)):
        assert other.goal.poly != 0
