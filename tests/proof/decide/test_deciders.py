"""What is asked of whom and in which order, each way to take a question apart by itself, and what a share of the steps is."""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

import pytest
import sympy as sp
import z3

import duhem.proof.decide as deciders
from duhem.expression import Atan2, symbol
from duhem.proof.decide import Answer, Budget, Question, Sense, _meaningful, _named, by_rules, decide, smt
from duhem.proof.decide.smt import Relation, System, by_smt
from tests.long import long_but

x, y = symbol("x"), symbol("y")
p, n, m = symbol("p", positive=True), symbol("n", nonnegative=True), symbol("m", negative=True)
k = symbol("k", nonpositive=True)
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
SPENT = Answer(None, "smt-z3", reason="its steps are spent")
YES, NO = Answer(True, "told"), Answer(False, "told")
Decider = Callable[[System, Budget], Answer]


def test_what_is_vacuous_or_plain() -> None:
    assert decide(Question(sp.S.NegativeOne, N, (sp.false,))) == Answer(True, "vacuous")
    assert decide(Question(-p, N, (sp.true,))).holds is False
    assert decide(Question(p + n, P)) == Answer(True, "sign-rules")
    assert decide(Question(x - 1, P, (sp.true, sp.Gt(x, 1)))).holds is True


@pytest.mark.parametrize(
    ("expr", "holds"),
    [
        (p + n, ">= >"),
        (n, ">="),
        (n - n, ">= =="),
        (x, ""),
        (p * x + p * y + p * (n - x - y), ">="),  # once p is taken out
        (p * n + p * (n + 1), ">= >"),
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
    ],
)
def test_signs_at_sight(expr: sp.Expr, holds: str) -> None:
    assert [sense.value for sense in (N, P, Z) if by_rules(Question(expr, sense)) == Answer(True, "sign-rules")] == holds.split()
    assert all(by_rules(Question(expr, s)).reason in ("", "a part of it may be undefined") for s in Sense)


def test_what_is_a_number_at_sight() -> None:
    assert all(map(_meaningful, (x**2, 1 / p, n**p, sp.sqrt(n), 1 / (n + 1), sp.log(p), sp.asin(sp.S.Half))))
    assert not any(map(_meaningful, (1 / x, sp.sqrt(x), n**x, 1 / n, sp.log(x), sp.log(n), sp.tan(x))))


def test_products_with_words() -> None:
    def asked(expr: sp.Expr, sense: Sense, *given: sp.Basic) -> bool | None:
        return decide(Question(expr, sense, given)).holds

    grows = sp.exp(x)
    assert asked(grows * (y**2 + 1), P) is True
    assert asked(grows * y, N, sp.Ge(y, 0)) is True and asked(grows * y, P, sp.Ge(y, 0)) is None
    assert asked(grows * (y - 1), P, sp.Gt(y, 1)) is asked((y - 1) * grows * p, P, sp.Gt(y, 1)) is True
    assert asked(grows * y, N, sp.Ge(x + y, 0)) is None and asked(grows * y, Z, sp.Eq(y, 0)) is asked(grows, N) is True
    assert asked(p**x * (y - 1), N, sp.Gt(y, 1)) is True and asked(p**x * (y - 1), N, sp.Ge(y**2, 1)) is None
    assert asked(sp.sinh(x) * sp.log(y), P, sp.Gt(x, 0), sp.Gt(y, 1)) is True and asked(sp.sinh(x) * sp.log(y), P, sp.Gt(y, 1)) is None


@pytest.mark.slow
@pytest.mark.parametrize("scale", long_but([3], [1, -1, 2, -3]))
@pytest.mark.parametrize(
    ("word", "zero", "ends"),
    [(sp.sinh, 0, ()), (sp.tanh, 0, ()), (sp.atan, 0, ()), (sp.asin, 0, (-1, 1)), (sp.acos, 1, (-1, 1)), (sp.log, 1, ())],
)
def test_a_monotone_word_has_the_sign_of_its_argument(word: type, zero: int, ends: tuple[int, ...], scale: int) -> None:
    """On its side of the place where it is 0; it has none where it is not defined."""
    falls = -1 if word is sp.acos else 1

    def asked(sense: Sense, *given: sp.Basic) -> bool:
        return decide(Question(scale * word(x), sense, given)).holds is True

    side = 1 if scale * falls > 0 else -1
    within = (sp.Gt(x, 0),) if word is sp.log else tuple(r for end in ends for r in (sp.Ge(x, -1), sp.Le(x, 1)))
    assert asked(N, sp.Ge(side * (x - zero), 0), *within) and asked(P, sp.Gt(side * (x - zero), 0), *within)
    assert not asked(P, sp.Ge(side * (x - zero), 0), *within)
    if side * zero >= 0:
        assert not asked(N, sp.Ge(side * (x - zero), -1), *within, sp.Lt(side * (x - zero), 1))
    if ends and word is sp.asin:
        assert not asked(N, sp.Ge(side * x, 0), sp.Le(side * x, 2))
    if word is sp.acos and scale > 0:
        assert not asked(N, sp.Le(x, 1)) and not asked(N, sp.Ge(x, -1))
    if word is sp.log and scale < 0:
        assert not asked(N, sp.Le(x, 1)) and not asked(N, sp.Le(x, 1), sp.Ge(x, 0)) and not asked(P, sp.Lt(x, 1))
    assert asked(Z, sp.Eq(x, zero)) and not asked(Z, sp.Ge(x, zero))


def test_words_by_name() -> None:
    def named(expr: sp.Expr, *given: sp.Basic) -> tuple[sp.Expr, list[str]] | None:
        found = _named(Question(expr, P, (sp.Gt(y, 0), *given), (x, y)), Budget(10**6))
        if found is None:
            return None
        assert found.sense is P and found.circle == (x, y) and found.given[0] == sp.Gt(y, 0)
        return found.expr.xreplace({s: sp.Symbol(s.name) for s in found.expr.free_symbols}), [
            f"{r.lhs} {r.rel_op}" for r in found.given[1:]
        ]

    w, own = sp.Symbol("w"), sp.Symbol("x")
    assert named(sp.exp(p) + x) == (w + own, ["_w - 1 >"]) and named(sp.exp(n) + x) == (w + own, ["_w - 1 >="])
    assert named(sp.exp(m) + x) == (w + own, ["1 - _w >"]) and named(sp.exp(k) + x) == (w + own, ["1 - _w >="])
    assert named(sp.exp(x) + x) == (w + own, []) and named(x) is None
    assert named(sp.log(x)) is None and named(sp.log(y)) == (w, ["-_w >="])  # the one may have no value
    assert named(sp.exp(p), sp.Gt(sp.log(x), x)) == (w, ["_w - 1 >"])  # so that it says nothing
    assert named(sp.exp(p), sp.Gt(sp.sin(x), x)) == (w, ["_w >", "_w - 1 >"])
    assert named(sp.sin(x) + sp.sin(x) * y) == (w + w * sp.Symbol("y"), [])  # one name for one word


@pytest.mark.parametrize(
    ("expr", "given", "holds"),
    [
        (y + sp.tan(x), (sp.Ge(x, 0), sp.Le(x, sp.Rational(7, 5)), sp.Ge(y, 0)), True),
        (y + sp.tan(x), (sp.Ge(x, 0), sp.Le(x, sp.Rational(8, 5)), sp.Ge(y, 0)), None),  # beyond a right angle
        (y + sp.tan(x), (sp.Ge(x, sp.Rational(-1, 10)), sp.Le(x, 1), sp.Ge(y, 0)), None),
        (y + sp.tan(x), (sp.Ge(x, 0), sp.Le(x, 1)), None),
        (y - sp.tan(x), (sp.Le(x, 0), sp.Ge(x, -1), sp.Ge(y, 0)), True),
        (y - sp.tan(x), (sp.Le(x, 0), sp.Ge(x, -2), sp.Ge(y, 0)), None),
        (y, (sp.Ge(x, 0), sp.Le(x, 1), sp.Ge(y, sp.tan(x))), True),
        (y, (sp.Ge(x, 0), sp.Le(x, 2), sp.Ge(y, sp.tan(x))), None),
        (y + sp.tan(x), (sp.Ge(x, 0), sp.Le(x, 1), sp.Ge(y + 2 * sp.tan(x), 4 * sp.tan(x))), True),
        (y + sp.tan(x), (sp.Ge(x, 0), sp.Le(x, 1), sp.Ge(y + 4 * sp.tan(x), 2 * sp.tan(x))), None),
        (y + 1 - sp.exp(x), (sp.Le(x, 0), sp.Ge(y, 0)), True),
        (y + 1 - sp.exp(x), (sp.Le(x, 1), sp.Ge(y, 0)), None),
    ],
)
def test_words_are_numbers_on_their_side(expr: sp.Expr, given: tuple[sp.Basic, ...], holds: bool | None) -> None:
    assert decide(Question(expr, N, given)).holds is holds


def test_exponentials_in_a_question() -> None:
    assert decide(Question(1 - sp.exp(-n) + x**2, N)).holds is True and decide(Question(1 - sp.exp(-n), P)).holds is None
    assert decide(Question(1 - sp.exp(-p), P)).holds is True and decide(Question(sp.exp(p) - 2, P)).holds is None


def test_branches_and_what_they_hide() -> None:
    six = Question(sp.Add(*(sp.Abs(symbol(f"x{i}")) for i in range(6))) - x, P)
    assert decide(six) == Answer(None, "branches", reason="more than 32 branches")
    assert decide(Question(sp.Abs(x - 1) - x, N)).holds is False and decide(Question(sp.Abs(x) + 1 - x, P)) == Answer(True, "smt-z3")
    lost = decide(Question(sp.Abs(x - 1) / (x - 1) + 2, P), Budget(10**6))
    assert lost.holds is None and "it is open whether" in lost.reason and "> 0" in lost.reason


# -- polynomial systems with deciders that are told what to say -----------------------------------------------------------


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[tuple[System, int]]]:
    """The deciders say these in turn, whatever they are asked; what they were asked, with how many steps."""

    def put(*answers: Answer) -> list[tuple[System, int]]:
        asked, left = list[tuple[System, int]](), list(answers)

        def one(system: System, budget: Budget) -> Answer:
            asked.append((system, budget.left))
            return left.pop(0)

        monkeypatch.setattr(deciders, "POLYNOMIAL_DECIDERS", (one, one))
        return asked

    return put


def system(goal: sp.Expr, op: str, *given: tuple[sp.Expr, str]) -> System:
    return System(Relation(goal, op), tuple(Relation(*r) for r in given), (), (x, y))


def test_an_open_answer_goes_on_to_the_next_decider(told: Callable[..., list[tuple[System, int]]]) -> None:
    asked = told(Answer(None, "first"), YES)
    assert deciders._decide_system(system(x * y + 1, ">"), Budget(800)) == YES and [steps for _, steps in asked] == [100, 100]
    asked = told(SPENT, Answer(None, "second", reason="tired"))
    assert deciders._decide_system(system(x * y + 1, ">"), Budget(800)).reason == "tired" and len(asked) == 2
    told(Answer(None, "first", reason="tired"), SPENT)
    assert deciders._decide_system(system(x * y + 1, ">"), Budget(800)) == SPENT
    asked = told(NO)
    assert deciders._decide_system(system(x * y + 1, ">"), Budget(800)) == NO and len(asked) == 1


def test_every_obligation_is_met_before_the_goal_is_asked(told: Callable[..., list[tuple[System, int]]]) -> None:
    first, second = system(x * y, "!="), system(x - y, ">=")
    whole = System(Relation(x * y + 1, ">"), (), (first, second), (x, y))
    asked = told(YES, YES, YES)
    assert deciders._decide_system(whole, Budget(10**5)) == YES and [one.goal.op for one, _ in asked] == ["!=", ">=", ">"]
    for said in ([NO], [YES, Answer(None, "told"), Answer(None, "told")]):
        asked = told(*said)
        answer = deciders._decide_system(whole, Budget(10**5))
        assert answer.holds is None and answer.method == "told" and len(asked) == len(said)
        goal = asked[-1][0].goal
        assert answer.reason == f"it is open whether {goal.poly} {goal.op} 0"


def test_a_question_of_no_claim_has_eight_million_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []

    def looked(system: System, budget: Budget) -> Answer:
        seen.append(budget.left)
        return YES

    monkeypatch.setattr(deciders, "_decide_system", looked)
    assert decide(Question(x, N)) == decide(Question(x, N), Budget(7)) == YES and seen == [8_000_000, 7]


def test_thirty_two_branches_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least that is open or violated is the answer, the last method its name."""
    monkeypatch.setattr(deciders, "_decide_system", lambda system, budget: Answer(True, f"on {len(system.given)}"))
    five = sp.Add(*(sp.Abs(symbol(f"x{i}")) for i in range(5)))
    assert decide(Question(five - 1, P)) == Answer(True, "on 5")
    said = [YES, Answer(None, "open", reason="tired"), NO]
    monkeypatch.setattr(deciders, "_decide_system", lambda system, budget: said.pop(0))
    assert decide(Question(sp.Abs(x) - 1, P)) == Answer(None, "open", reason="tired") and said == [NO]


def test_shares_of_the_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """An eighth for polynomials; of what is not algebraic half for words by name, a sixteenth for a sign."""
    seen: list[int] = []

    def looked(question: object, budget: Budget) -> Answer:
        seen.append(budget.left)
        return Answer(None, "told", reason="no")

    monkeypatch.setattr(deciders, "POLYNOMIAL_DECIDERS", (looked,))
    assert decide(Question(x * y + 1, N), Budget(1000)) == Answer(None, "told", reason="no") and seen == [125]
    seen.clear()
    answer = decide(Question(sp.exp(p) - x - 1, N), Budget(1000))
    assert seen == [7, 62] and answer.holds is None


# -- z3 -------------------------------------------------------------------------------------------------------------------

HARD = system(x**4 * y**2 + x**2 * y**4 + 1 - 3 * x**2 * y**2, ">=")


def test_z3_has_all_of_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    nets: list[int] = []
    real = smt._net
    monkeypatch.setattr(smt, "_net", lambda context, most: nets.append(most) or real(context, 10**7))
    budget = Budget(300)
    answer = by_smt(HARD, budget)
    assert answer.holds is None and answer.method == "smt-z3" and answer.reason.startswith("z3: ")
    assert nets == [900] and budget.left == 0
    assert by_smt(HARD, Budget(0)) == SPENT


def test_z3_is_paid_for_what_it_counted() -> None:
    left = []
    for _ in range(2):
        budget = Budget(10**7)
        assert by_smt(system(x**2 + y**2 - x * y + 1, ">"), budget) == Answer(True, "smt-z3")
        left.append(budget.left)
    assert left[0] == left[1] and 10**7 - 100_000 < left[0] < 10**7
    found = by_smt(system(x, ">=", (x**2 - 2, "==")), Budget(10**7))
    assert found.holds is False and found.point is not None and abs(float(found.point[x]) + 2**0.5) < 1e-12


def test_z3_counts_no_further_than_its_words_are_long(monkeypatch: pytest.MonkeyPatch) -> None:
    limits: list[tuple[object, ...]] = []
    real = z3.Solver.set
    monkeypatch.setattr(z3.Solver, "set", lambda solver, *given: limits.append(given) or real(solver, *given))
    monkeypatch.setattr(z3.Solver, "check", lambda solver: z3.unknown)
    budget = Budget(2**40)
    assert by_smt(HARD, budget).holds is None and limits == [("rlimit", 2**32 - 1)] and budget.left == 2**40 - (2**32 - 1)
    limits.clear()
    by_smt(HARD, Budget(80))
    assert limits == [("rlimit", 80)]


def test_z3_stopped_or_broken_decides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(solver: z3.Solver) -> None:
        raise z3.Z3Exception("out of luck")

    monkeypatch.setattr(z3.Solver, "check", broken)
    assert by_smt(HARD, Budget(10**6)) == Answer(None, "smt-z3", reason="out of luck")
    monkeypatch.setattr(z3.Solver, "check", lambda solver: z3.unknown)
    monkeypatch.setattr(z3.Solver, "reason_unknown", lambda solver: "interrupted from keyboard")
    with pytest.raises(KeyboardInterrupt):
        by_smt(HARD, Budget(10**6))


def test_steps_as_the_solver_counts_them() -> None:
    class Solver:
        def __init__(self, **counts: int) -> None:
            self.counts = {name.replace("_", " "): value for name, value in counts.items()}

        def statistics(self) -> Solver:
            return self

        def keys(self) -> list[str]:
            return list(self.counts)

        def get_key_value(self, name: str) -> int:
            return self.counts[name]

    assert smt.counted(Solver(rlimit_count=7), 9) == 7 and smt.counted(Solver(memory=7), 9) == 9


@pytest.mark.slow
@pytest.mark.parametrize(("microseconds", "stopped"), [(0, 1), (50_000, 1), (100_000_000, 0)])
def test_a_net_of_processor_time(microseconds: int, stopped: int) -> None:
    class Context:
        stops = 0

        def interrupt(self) -> None:
            self.stops += 1

    context, end = Context(), process_time() + (0.4 if stopped else 0.2)
    with smt._net(context, microseconds):
        while process_time() < end and context.stops == 0:
            sum(range(1000))
    assert context.stops == stopped
