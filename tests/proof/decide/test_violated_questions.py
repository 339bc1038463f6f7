"""No decider says "holds" of a question that is violated at a known point, and each says it often enough of those that hold.

Truth is exact evaluation at the point the question was built around; no decider is the measure of another.
"""

from __future__ import annotations

from collections import Counter
from functools import cache

import pytest

from duhem.proof.decide.smt import System
from tests.long import long_but
from tests.proof.decide.alone import OF_QUESTIONS, OF_SYSTEMS
from tests.proof.decide.questions import GOALS, as_system, in_a_box, is_polynomial, true_ones, violated_ones


@cache
def violated() -> list[System]:
    return [
        as_system(one.question)
        for most in (1, 2, 2, 3)
        for one in violated_ones(f"systems/{most}", 25, "polynomial", most)
        if is_polynomial(one.question)
    ]


@cache
def true() -> list[System]:
    return [as_system(question) for most in (1, 2, 3) for question in true_ones(f"true/{most}", 20, most)]


@pytest.mark.slow
@pytest.mark.parametrize("kind", long_but([1, 2, 4], GOALS))
def test_all_deciders_together(kind: str) -> None:
    assert [one for one in violated_ones(f"all/{kind}", 20, kind) if OF_QUESTIONS["all"](one.question).holds is True] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", GOALS)
@pytest.mark.parametrize("name", ["rules"])
def test_questions_by_itself(name: str, kind: str) -> None:
    boxed = (in_a_box(one.question, one.point) for one in violated_ones(f"alone/{kind}", 12, kind))
    assert [question for question in boxed if OF_QUESTIONS[name](question).holds is True] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_SYSTEMS)
def test_systems_by_itself(name: str) -> None:
    answers = Counter(OF_SYSTEMS[name](system).holds for system in violated())
    assert answers[True] == 0
    assert answers[False] >= {"smt": 75}[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_SYSTEMS)
def test_what_holds(name: str) -> None:
    """Each says so of enough, and denies it of none."""
    answers = Counter(OF_SYSTEMS[name](system).holds for system in true())
    assert answers[False] == 0
    assert answers[True] >= {"smt": 50}[name]
