"""What an examination may cost is counted in steps: the same on every machine, busy or idle."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import flint
import pytest
import sympy as sp

import duhem.proof
from duhem import InputError, verify
from duhem.cli.verbs.verify import verify as command
from duhem.law.formula_law import Criterion
from duhem.proof.decide import EFFORTS, Answer, Budget, Question, Sense, decide
from duhem.proof.facts import subject as subject_module
from duhem.proof.facts.formula_subject import FormulaSubject

ROOM = Path(duhem.proof.__file__).parent
x, y, z = sp.symbols("x y z", real=True)
MOTZKIN = sp.expand(x**4 * y**2 + x**2 * y**4 + z**6 - 3 * x**2 * y**2 * z**2)  # >= 0, but no sum of squares
ROUND = Criterion("round", "norm(a, b) - 1", forces=("a", "b"))


def test_a_part_draws_on_the_whole() -> None:
    whole = Budget(10)
    part = whole.part(6)
    assert part.pays(4) and (part.left, whole.left) == (2, 6)
    assert whole.pays(5) and (part.left, whole.left) == (1, 1)
    assert not part.pays(2) and (part.left, whole.left) == (1, 1)
    assert Budget(3).part(5).left == 3


def _clocks(path: Path) -> Iterator[str]:
    """What a module imports of the clock."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module in ("time", "timeit", "datetime"):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name in ("time", "timeit", "datetime"))


@pytest.mark.slow
def test_no_clock_is_read() -> None:
    read = {str(path.relative_to(ROOM)): sorted(_clocks(path)) for path in ROOM.rglob("*.py")}
    assert {path: names for path, names in read.items() if names} == {
        "verification.py": ["time"],  # for the report
    }
    text = "".join(path.read_text("utf-8") for path in ROOM.rglob("*.py"))
    assert '"timeout"' not in text


@pytest.mark.parametrize("steps", [0, 1_000, 100_000])
def test_a_question_costs_no_more_than_it_is_given_and_the_same_each_time(steps: int) -> None:
    left = []
    for _ in range(2):
        budget = Budget(steps)
        assert decide(Question(MOTZKIN, Sense.NONNEGATIVE), budget).holds is None
        left.append(budget.left)
    assert left[0] == left[1] >= 0


def test_more_steps_decide_it() -> None:
    question = Question(x**2 - x * y + 2 * y**2 + 1, Sense.NONNEGATIVE)
    assert [decide(question, Budget(steps)).holds for steps in (1, 1_000_000)] == [None, True]


def test_an_open_answer_is_kept_where_it_had_all_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def shrug(question: Question, budget: Budget) -> Answer:
        asked.append(budget.left)
        return Answer(None)

    monkeypatch.setattr(subject_module, "decide", shrug)
    subject = FormulaSubject(ROUND)
    question = Question(x, Sense.POSITIVE)
    subject.allow(10)
    subject.decided(question)
    subject.allow(10**9)
    assert [subject.decided(question).holds for _ in range(2)] == [None, None]
    assert len(asked) == 2 and asked[0] == 10 < asked[1]


def test_effort_multiplies_the_steps() -> None:
    budgets = []
    for factor in EFFORTS.values():
        subject = FormulaSubject(ROUND, factor)
        subject.allow(800)
        budgets.append(subject.budget.left)
    assert budgets == [100, 800, 6400]
    option = next(p for p in command.params if p.name == "effort")
    assert tuple(option.type.choices) == tuple(EFFORTS)  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="unknown effort 'most'"):
        verify(ROUND, effort="most")


def test_the_report_names_an_effort_that_is_not_normal() -> None:
    normal, quick = (verify(ROUND, claims=["origin"], effort=effort).to_dict() for effort in ("normal", "quick"))
    assert "effort" not in normal and quick["effort"] == "quick"


def test_the_precision_of_the_process_is_neither_used_nor_changed() -> None:
    bumpy = Criterion("bumpy", "exp(a/2) + exp(-a) + b**2 - 3", forces=("a", "b"))
    alone = [(r.verdict, r.method, r.detail) for r in verify(bumpy, claims=["origin"]).results]
    before = flint.ctx.prec
    try:
        flint.ctx.prec = 7
        assert [(r.verdict, r.method, r.detail) for r in verify(bumpy, claims=["origin"]).results] == alone
        assert flint.ctx.prec == 7
    finally:
        flint.ctx.prec = before
