"""Signs that are shown exactly, each against what is known beforehand: close roots, declared domains, affine relations."""

from __future__ import annotations

import random
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise

import pytest
import sympy as sp

from duhem.expression import Neg, Norm, Pos, Where, symbol
from duhem.expression.number import rational
from duhem.proof.decide import Budget, Question, Sense, by_rules, decide
from tests.oracles.prover.affine import Affine
from tests.proof.decide.truth import UnsuitedError, value, violated

x, y = symbol("x"), symbol("y")
NUMBERS = [Fraction(n, 2) for n in range(-4, 5)]


@pytest.mark.parametrize("digits", [10, 20, 40, 100])
def test_a_violation_between_roots_close_together(digits: int) -> None:
    apart = sp.expand((x - 1) * (x - 1 - sp.Rational(1, 10**digits)))
    for given in ((), (sp.Eq(x**2 + y**2, 4),), (sp.Gt(y, x),)):
        assert decide(Question(apart, Sense.NONNEGATIVE, given)).holds is not True
    assert decide(Question(apart, Sense.NONNEGATIVE)).holds is False


@pytest.mark.slow
def test_signs_known_from_the_domains() -> None:
    """What the sign rules say holds at all points of the domains, and they say something."""
    rng = random.Random("rules")
    p, n, m, r = symbol("p", positive=True), symbol("n", nonnegative=True), symbol("m", negative=True), symbol("r")
    values = {p: NUMBERS[5:], n: NUMBERS[4:], m: NUMBERS[:4], r: NUMBERS}

    leaves = (p, n, m, r, r, sp.Integer(1), sp.Rational(-1, 2))
    ways: tuple[Callable[[sp.Expr, sp.Expr], sp.Expr], ...] = (
        lambda a, b: a + b,
        lambda a, b: a * b,
        lambda a, b: a - b,
        lambda a, b: a**2,
        lambda a, b: a / b,
        lambda a, b: 1 / (a + 1),
        lambda a, b: sp.sqrt(a) + b,
        lambda a, b: b / sp.sqrt(a),
        lambda a, b: sp.Abs(a) * Pos(b),
        lambda a, b: Neg(a) + Norm(a, b),
        lambda a, b: sp.Max(a, b, 1),
        lambda a, b: sp.Abs(sp.Min(a, b)),
        lambda a, b: sp.Abs(sp.log(a)) + b**2,
        lambda a, b: Where(sp.Gt(r, 0), a, b),
        lambda a, b: sp.Max(a**p, b),
        lambda a, b: sp.Abs(a**r) + 1,
    )

    def grown(depth: int) -> sp.Expr:
        return rng.choice(ways)(grown(depth - 1), grown(depth - 1)) if depth else rng.choice(leaves)

    said = 0
    for _ in range(200):
        try:
            expr = grown(rng.randint(1, 2))
        except (ValueError, TypeError):  # max(1, zoo)
            continue
        question = Question(expr, rng.choice(list(Sense)))
        if expr.has(sp.nan, sp.zoo, sp.oo, sp.I) or by_rules(question).holds is not True:
            continue
        said += 1
        for _ in range(12):
            at = {s: rng.choice(v) for s, v in values.items()}
            with suppress(UnsuitedError):
                assert not violated(question, at), (question, at)
    assert said >= 30


def test_affine_relations() -> None:
    """Never without a solution where there is one; a solution found is one."""
    rng = random.Random("affine")
    for _ in range(8):
        at = {x: rng.choice(NUMBERS), y: rng.choice(NUMBERS)}
        terms = [rng.choice((x, y, sp.Abs(x - y), Pos(x), Neg(y + 1), sp.Max(x, 2 * y), sp.Min(x, y, 1))) for _ in range(6)]
        pairs = [2 * a - b / 2 for a, b in pairwise(terms)]
        relations = [(e - rational(value(e, at)), rng.choice((">=", "==", "<="))) for e in pairs]
        relations += [(e - rational(value(e, at)) + 1, rng.choice((">", "!="))) for e in pairs[:2]]
        solution = Affine((x, y), Budget(10**6)).solution(*relations)
        assert isinstance(solution, dict)
        for e, op in relations:
            gap = value(e, {s: Fraction(int(v.p), int(v.q)) for s, v in solution.items()})
            assert {">=": gap >= 0, ">": gap > 0, "==": gap == 0, "<=": gap <= 0, "!=": gap != 0}[op]
    assert Affine((x, y), Budget(10**6)).solution((sp.Abs(x), "<")) is False
    assert Affine((x, y), Budget(10**6)).solution((2 * x + 3, ">"), (-x / 2, ">="), (y, "==")) not in (False, None)
    assert Affine((x, y), Budget(10**6)).solution((x + y * x, ">")) is Affine((x, y), Budget(10**6)).solution((sp.pi * x, ">")) is None
    assert Affine((x, y), Budget(10**6)).solution((x * y, "<")) is None
    assert Affine((x, y), Budget(10**6)).solution((x**2, "<")) is None
    for odd in (x + sp.pi, sp.Float(0.5) * x, sp.sqrt(2) * x, 2 * x * y, 2 * sp.sqrt(x), Neg(x * y), x / y, Norm(x, y)):
        assert Affine((x, y), Budget(10**6)).solution((x, ">"), (odd, "<")) is None, odd
    for plain in (-3 * (x + y), sp.Mul(2, x - 1, evaluate=False), 2 * sp.Max(x, -y / 7), sp.S.Half, x):
        assert isinstance(Affine((x, y), Budget(10**6)).solution((plain, "!=")), dict), plain


def test_affine_relations_have_two_hundred_thousand_steps_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    import z3

    limits: list[tuple[object, ...]] = []
    real = z3.Solver.set
    monkeypatch.setattr(z3.Solver, "set", lambda solver, *given: limits.append(given) or real(solver, *given))
    for steps in (10**6, 203_001, 13_000):
        assert isinstance(Affine((x, y), Budget(steps)).solution((x, ">")), dict)
    assert limits == [("rlimit", 200_000), ("rlimit", 200_000), ("rlimit", 10_000)]
    monkeypatch.setattr(z3.Solver, "check", lambda solver: z3.unknown)
    budget = Budget(10**6)
    assert Affine((x, y), budget).solution((x, ">")) is None and budget.left < 10**6 - 3_000


def test_affine_relations_cost_what_z3_counted() -> None:
    """Three thousand steps to state them, and no more than are there: whatever was asked before."""
    relations = (sp.Abs(x) + y - 3, "=="), (y, ">"), (sp.Max(x, y) - 1, "<")
    budget, costs = Budget(10**6), []
    space = Affine((x, y), budget)
    for _ in range(3):
        before = budget.left
        assert isinstance(space.solution(*relations), dict)
        costs.append(before - budget.left)
    assert costs[0] == costs[1] == costs[2] and 3_000 < costs[0] < 10_000
    few = Budget(3_100)
    assert Affine((x, y), few).solution(*relations) is None and few.left == 0
    for steps, left in ((2_999, 2_999), (3_000, 0)):
        short = Budget(steps)
        assert Affine((x, y), short).solution(*relations) is None and short.left == left
