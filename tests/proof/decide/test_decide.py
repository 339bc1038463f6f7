"""What is answered: nothing that fails at a known point, enough of what holds, and within the steps that are given."""

from __future__ import annotations

import importlib
import pkgutil
import random
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import is_dataclass
from fractions import Fraction

import pytest
import sympy as sp

from duhem.expression import Atan2, Neg, Norm, Pos, Where, symbol
from duhem.proof import decide as room
from duhem.proof.decide import Answer, Budget, Question, Sense, decide
from duhem.proof.kernel.steps import pay
from tests.proof.decide.questions import GOALS, in_a_box, true_ones, violated_ones
from tests.proof.decide.truth import UnsuitedError, violated

x, y, z = symbol("x"), symbol("y"), symbol("z")
p, n, m = symbol("p", positive=True), symbol("n", nonnegative=True), symbol("m", negative=True)
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
NUMBERS = [Fraction(k, 2) for k in range(-4, 5)]


def holds(expr: sp.Expr, sense: Sense, *given: sp.Basic) -> bool:
    return decide(Question(sp.sympify(expr), sense, given)).holds is True


def test_what_is_vacuous_or_undefined() -> None:
    assert decide(Question(sp.S.NegativeOne, N, (sp.false,))) == Answer(True, "vacuous")
    assert holds(p + n, P, sp.true) and not holds(-p, N, sp.true)
    assert decide(Question(sp.nan, N)).reason == decide(Question(x, N, (sp.Gt(sp.zoo * x, 0),))).reason == "the expression is undefined"


@pytest.mark.parametrize(
    ("expr", "told"),
    [
        (p + n, ">= >"),
        (n, ">="),
        (n - n, ">= =="),
        (x, ""),
        (-m, ">= >"),
        (p * x + p * y + p * (n - x - y), ">="),
        (1 / p, ">= >"),
        (1 / (1 + n), ">= >"),
        (1 / n, ""),
        (1 / n**2, ""),
        (sp.sqrt(n), ">="),
        (sp.sqrt(x) ** 2 + 1, ""),
        (sp.log(1 + p), ">= >"),
        (sp.log(x) ** 2, ""),
        (sp.tan(x) ** 2, ""),
        (sp.asin(x) ** 2 + 1, ""),
        (sp.acos(x) ** 2 + 1, ""),
        (Atan2(x, y) ** 2 + 1, ""),
        (1 - sp.exp(-n) + x**2, ">="),
        (1 - sp.exp(-p), ">= >"),
        (sp.Max(n, -1), ">="),
        (Where(sp.Gt(x, 0), p, n), ">="),
        (Where(sp.Gt(x, 0), sp.log(x) ** 2, 1), ">="),  # a branch needs a value where its condition holds alone
        (Where(sp.Gt(x, 0), 1, sp.log(x) ** 2), ""),
    ],
)
def test_signs_by_the_declared_ones(expr: sp.Expr, told: str) -> None:
    assert [sense.value for sense in (N, P, Z) if holds(expr, sense)] == told.split()


@pytest.mark.parametrize(
    ("word", "zero", "ends"), [(sp.sinh, 0, ()), (sp.tanh, 0, ()), (sp.atan, 0, ()), (sp.asin, 0, (-1, 1)), (sp.log, 1, ())]
)
@pytest.mark.parametrize("scale", [3, -1])
def test_a_word_that_rises_has_the_sign_of_its_argument(word: type, zero: int, ends: tuple[int, ...], scale: int) -> None:
    """On its side of the place where it is 0; it has none where it is not defined."""
    side = 1 if scale > 0 else -1
    within = (sp.Gt(x, 0),) if word is sp.log else tuple(r for end in ends for r in (sp.Ge(x, -1), sp.Le(x, 1)))
    assert holds(scale * word(x), N, sp.Ge(side * (x - zero), 0), *within) and holds(
        scale * word(x), P, sp.Gt(side * (x - zero), 0), *within
    )
    assert not holds(scale * word(x), P, sp.Ge(side * (x - zero), 0), *within)
    assert not holds(scale * word(x), N, sp.Ge(side * (x - zero), -1), sp.Lt(side * (x - zero), 1), *within)
    if ends:
        assert not holds(scale * word(x), N, sp.Ge(side * x, 0), sp.Le(side * x, 2))
    if word is sp.log:
        assert not holds(scale * word(x), N, sp.Ge(side * (x - 1), 0), sp.Ge(x, 0)) or scale > 0


def test_what_relations_say() -> None:
    grows = sp.exp(x)
    assert holds(x - 1, P, sp.Gt(x, 1)) and holds(grows * (y**2 + 1), P) and holds(grows * y, N, sp.Ge(y, 0))
    assert holds(grows * (y - 1), P, sp.Gt(y, 1)) and not holds(grows * y, P, sp.Ge(y, 0)) and not holds(grows * y, N, sp.Ge(x + y, 0))
    assert holds(y, N, sp.And(sp.Ge(y, x), sp.Ge(x, 0))) and holds(x, Z, sp.Ge(x, 0), sp.Le(x, 0)) and holds(x, Z, sp.Eq(x, 0))
    assert not holds(x, P, sp.Ne(x, 0)) and not holds(1 / x, N, sp.Ge(x, 0))
    assert holds(y, P, sp.Gt(sp.log(p), 0), sp.Gt(y, 0)) and not holds(p - 1, N, sp.Gt(sp.log(sp.log(p)), 0))  # may have no value
    assert not holds(y, N, sp.Ge(sp.sqrt(x), 0), sp.Ge(y, sp.sqrt(x)))


def test_symbols_that_nothing_bounds_are_forces_too() -> None:
    """J2^(3/2) is no less than 3 sqrt(3)/2 J3 of principal stresses, as the kernel knows; nor than J3/2."""
    second = ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 6
    third = (2 * x - y - z) * (2 * y - x - z) * (2 * z - x - y) / 27
    for share, said in ((sp.Rational(1, 2), True), (sp.Rational(27, 10), False)):
        assert holds(second ** sp.Rational(3, 2) - share * third, N, sp.Gt(x**2 + y**2 + z**2, 0)) is said


@pytest.mark.parametrize("digits", [10, 40])
def test_a_violation_between_roots_close_together(digits: int) -> None:
    apart = sp.expand((x - 1) * (x - 1 - sp.Rational(1, 10**digits)))
    assert not any(holds(apart, N, *given) for given in ((), (sp.Eq(x**2 + y**2, 4),), (sp.Gt(y, x),)))


@pytest.mark.slow
@pytest.mark.parametrize("kind", GOALS)
def test_nothing_is_said_that_fails_at_a_known_point(kind: str) -> None:
    """Truth is exact evaluation at the point that the question was built around."""
    false = [one for most in (1, 2, 3) for one in violated_ones(f"all/{kind}/{most}", 20, kind, most) if decide(one.question).holds]
    boxed = [one for one in violated_ones(f"box/{kind}", 12, kind) if decide(in_a_box(one.question, one.point)).holds]
    assert false == boxed == []


@pytest.mark.slow
def test_enough_is_said_of_what_holds() -> None:
    answers = Counter(decide(question).holds for most in (1, 2, 3) for question in true_ones(f"true/{most}", 20, most))
    assert answers[True] >= 35 and answers[False] == 0


@pytest.mark.slow
def test_signs_known_from_the_domains() -> None:
    """What is said holds at all points of the domains, and something is said."""
    rng, r = random.Random("rules"), symbol("r")
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
        if expr.has(sp.nan, sp.zoo, sp.oo, sp.I) or decide(question).holds is not True:
            continue
        said += 1
        for _ in range(12):
            at = {s: rng.choice(v) for s, v in values.items()}
            with suppress(UnsuitedError):
                assert not violated(question, at), (question, at)
    assert said >= 30


def test_no_more_steps_are_spent_than_are_given(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, budget = Question(p * n + 1, P), Budget(10**6)
    assert decide(asked, budget) == Answer(True, "signs") and 0 < budget.spent < 10**5
    few = Budget(budget.spent - 1)
    assert decide(asked, few) == Answer(None, "signs", reason="its steps are spent") and few.left == 0
    assert decide(asked, Budget(0)).holds is None
    monkeypatch.setattr(room, "_readings", lambda question: pay(10**9))
    whole = Budget(10**9)
    assert decide(asked, whole).holds is None and whole.spent == 400_000


def test_what_is_handed_on_is_frozen() -> None:
    modules = [importlib.import_module(f"duhem.proof.decide.{found.name}") for found in pkgutil.iter_modules(room.__path__)]
    values = {c for module in modules for c in vars(module).values() if isinstance(c, type) and is_dataclass(c)}
    assert {Answer, Question} <= values and [c for c in values if not c.__dataclass_params__.frozen] == []
