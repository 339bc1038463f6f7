"""Algebraic questions as polynomials, written out: what is named and how that is defined, what must be shown beside the goal."""

from __future__ import annotations

import pytest
import sympy as sp

from duhem.expression import Norm, symbol
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.decide.smt import NotAlgebraicError, Relation, System, _Names, polynomial_system

x, y = symbol("x"), symbol("y")
p, n = symbol("p", positive=True), symbol("n", nonnegative=True)
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
HALF, THIRD = sp.Rational(1, 2), sp.Rational(1, 3)

ROOT, ROOT1, OVER, OVER1 = (sp.Symbol(name) for name in ("rho0", "rho1", "r0", "r1"))


def asked(expr: sp.Expr, sense: Sense = N, *given: sp.Basic, circle: bool = False) -> System:
    return polynomial_system(Question(expr, sense, given, (x, y) if circle else None))


def plain(relation: Relation) -> str:
    names = {s: sp.Symbol(s.name) for s in relation.poly.free_symbols}
    return f"{sp.expand(relation.poly.xreplace(names))} {relation.op} 0"


def told(system: System) -> tuple[str, list[str], list[str]]:
    """The goal, the hypotheses and the goals of the obligations."""
    return plain(system.goal), [plain(r) for r in system.given], [plain(o.goal) for o in system.obligations]


def line(expr: sp.Expr, op: str) -> str:
    return plain(Relation(sp.sympify(expr), op))


def over(divisor: sp.Expr, name: sp.Symbol = OVER, op: str = "!=") -> list[str]:
    """What defines a reciprocal."""
    return [line(name * divisor - 1, "=="), line(name, op)]


def root(radicand: sp.Expr, q: int = 2, name: sp.Symbol = ROOT) -> list[str]:
    """What defines a root."""
    return [line(name**q - radicand, "=="), line(name, ">=")]


@pytest.mark.parametrize(
    ("expr", "goal", "given", "obligations"),
    [
        (x / y - 1, x * OVER - 1, over(y), [line(y, "!=")]),
        (x / y**3 - 1, x * OVER**3 - 1, over(y), [line(y, "!=")]),
        (x / p - 1, x * OVER - 1, [line(p, ">"), *over(p, op=">")], []),  # positive at sight
        (1 / (n + 1) - x, OVER - x, [line(n, ">="), *over(n + 1, op=">")], []),
        (1 / n - x, OVER - x, [line(n, ">="), *over(n)], [line(n, "!=")]),
        (1 / x + 2 / x, 3 * OVER, over(x), [line(x, "!=")]),
        (1 / (1 / x + 1), OVER1, over(x) + over(OVER + 1, OVER1), [line(x, "!="), line(OVER + 1, "!=")]),
        (x / 2 - THIRD, x / 2 - THIRD, [], []),
        (sp.sqrt(x) - 1, ROOT - 1, root(x), [line(x, ">=")]),
        (sp.sqrt(n) - 1, ROOT - 1, [line(n, ">="), *root(n)], []),
        (x ** (3 * HALF) - 1, ROOT**3 - 1, root(x), [line(x, ">=")]),
        (x**-HALF, OVER1, root(x) + over(ROOT, OVER1), [line(x, ">="), line(ROOT, "!=")]),
        (x ** (4 * THIRD), ROOT**4, root(x, 3), [line(x, ">=")]),
        (sp.sqrt(1 / x), ROOT1, over(x) + root(OVER, name=ROOT1), [line(x, "!="), line(OVER, ">=")]),
        (Norm(x, y), ROOT, root(x**2 + y**2), []),
        (sp.sqrt(sp.Integer(8)) * x, 2 * ROOT * x, root(sp.Integer(2)), []),
        (sp.sqrt(sp.sqrt(x) - y), ROOT1, root(x) + root(ROOT - y, name=ROOT1), [line(x, ">="), line(ROOT - y, ">=")]),
    ],
)
def test_roots_and_quotients_are_named(expr: sp.Expr, goal: sp.Expr, given: list[str], obligations: list[str]) -> None:
    assert told(asked(expr)) == (line(goal, ">="), given, obligations)
    assert told(asked(expr, P))[0] == line(goal, ">") and told(asked(expr, Z))[0] == line(goal, "==")


def test_each_is_asked_about_before_it_is_defined() -> None:
    """With what was shown before: r x = 1 would show that x is not 0."""
    system = asked(sp.sqrt(1 / x), N, sp.Gt(x, 1))
    first, second = system.obligations
    assert [plain(r) for r in first.given] == [line(x - 1, ">")]
    assert [plain(r) for r in second.given] == [line(x - 1, ">"), *over(x)]
    assert all(o.obligations == () and o.variables == system.variables for o in system.obligations)
    assert [s.name for s in system.variables] == ["x", "r0", "rho1"]


def test_what_the_hypotheses_hold_is_named_first_and_asked_about_too() -> None:
    system = asked(1 / x, P, sp.Eq(sp.sqrt(x), 2))
    assert [plain(o.goal) for o in system.obligations] == [line(x, ">="), line(x, "!=")]
    assert plain(system.given[0]) == line(ROOT - 2, "==") and decide(Question(1 / x, P, (sp.Eq(sp.sqrt(x), 2), x >= 0))).holds is True
    assert decide(Question(x + 1, P, (sp.Gt(sp.sqrt(x), 0),))).holds is None  # a hypothesis without a value shows nothing
    assert decide(Question(x, P, (sp.Gt(1 / x, 0),))).holds is None


def test_what_divides_nothing() -> None:
    assert decide(Question(y / ((x + 1) ** 2 - x**2 - 2 * x - 1), N)).holds is None  # 0, which SymPy does not see
    with pytest.raises(NotAlgebraicError, match="division by zero"):
        _Names().reciprocal(sp.S.Zero)


@pytest.mark.parametrize(
    ("relation", "said"),
    [
        (sp.Ge(x, y), line(x - y, ">=")),
        (sp.Le(x, y), line(y - x, ">=")),
        (sp.Gt(x, 1), line(x - 1, ">")),
        (sp.Lt(x, 1), line(1 - x, ">")),
        (sp.Eq(x, y), line(x - y, "==")),
        (sp.Ne(x, y), line(x - y, "!=")),
    ],
)
def test_hypotheses(relation: sp.Basic, said: str) -> None:
    assert told(asked(y, N, relation))[1] == [said]


def test_what_the_symbols_say_of_themselves() -> None:
    t = sp.Dummy("t", positive=True)
    assert told(asked(p + n + x)) == (line(n + p + x, ">="), [line(n, ">="), line(p, ">")], [])
    assert asked(p + n + x).variables == (n, p, x)
    assert told(asked(t + x))[1] == [line(t, ">")]


def test_each_root_has_one_name() -> None:
    names = _Names()
    assert [names.root(sp.Integer(8), 3), names.root(sp.Rational(1, 4), 2)] == [2, HALF] and names.found == {}
    assert names.root(x, 2) is names.root(x, 2) is not names.root(x, 3)
    assert names.root(sp.Integer(2), 2).is_nonnegative and len(names.found) == 3
    assert names.reciprocal(x) is names.reciprocal(x) and names.reciprocal(sp.Integer(-4)) == sp.Rational(-1, 4)
    assert names.rewrite(x ** sp.Rational(1, 12)) in {one.symbol for one in names.found.values()}
    for odd in (x ** sp.Rational(1, 13), x**y, sp.exp(x), sp.pi * x, sp.Abs(x)):
        with pytest.raises(NotAlgebraicError):
            names.rewrite(odd)


def test_on_the_circle() -> None:
    circle = line(x**2 + y**2 - 1, "==")
    assert told(asked(y**3 + x * y**2, circle=True)) == (line(y**3 + x * y**2, ">="), [circle], [])
    assert told(asked(Norm(x, y) - x, circle=True)) == (line(1 - x, ">="), [circle], [])
    assert told(asked(sp.sqrt(y**2 + x**2) - x, circle=True)) == (line(1 - x, ">="), [circle], [])
    assert asked(p, circle=True).variables == (p, x, y)


def test_of_a_square_only_what_it_divides_by_and_takes_a_root_of_is_asked() -> None:
    system = asked((1 / x + sp.sqrt(y)) ** 2)
    assert system.goal == Relation(sp.S.Zero, ">=")
    assert {o.goal for o in system.obligations} == {Relation(x, "!="), Relation(y, ">=")}
    for other in (asked((1 / x + sp.sqrt(y)) ** 3), asked((x - y) ** 2, P), asked((x - y) ** 2, Z), asked((x - y) ** 2 - 1)):
        assert other.goal.poly != 0
