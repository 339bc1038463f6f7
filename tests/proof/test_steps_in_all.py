"""A verdict within so many steps: all that is done for it is counted, wherever it is done, and no clock has a part in it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable

import pytest

import duhem
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.proof import verification
from duhem.proof.decide import ANY_STEPS, Budget
from duhem.proof.kernel import steps as kernel_steps
from duhem.proof.verdict import Verdict
from duhem.proof.verification import verdict_within
from tests.long import mostly_long

ONE_MORE = 30_000  # the kernel and z3 count what they do while they do it: the last piece may be beyond
ROUND = Criterion("round", "norm(a, b) - k", {"k": Domain(positive=True)}, forces=("a", "b"), pressure=None)
EVEN = Criterion("even", "a**4 + 4*a**2*b**2 + b**4 + a**2 - 1", forces=("a", "b"), pressure=None)
LAWS: dict[str, Criterion] = {"even": EVEN, **{name: duhem.load(name) for name in ("hoffman", "lobes", "puck", "tsai-hill-signed")}}


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Callable[[Criterion, int], int]:
    """How many steps a verdict took, by the kernel's own count and that of every budget which is no part of another."""
    purses: list[kernel_steps.Purse] = []
    subjects: list[Budget] = []

    class Watched(kernel_steps.Purse):
        def __init__(self, steps: int) -> None:
            super().__init__(steps)
            purses.append(self)

    pays = Budget.pays

    def paid(self: Budget, steps: int) -> bool:
        if self not in subjects:
            subjects.append(self)
        return pays(self, steps)

    monkeypatch.setattr(kernel_steps, "Purse", Watched)
    monkeypatch.setattr(Budget, "pays", paid)

    def steps(law: Criterion, most: int) -> int:
        purses.clear()
        subjects.clear()
        verdict_within(law, "convexity", most)
        by_kernel = sum(purse.spent for purse in purses)
        others = sum(one.spent for one in subjects if one._whole is None)  # the kernel's steps are paid there too
        return max(by_kernel, others)

    return steps


@pytest.mark.parametrize("steps", [1_000, 30_000, 200_000])
@pytest.mark.parametrize("name", LAWS)
def test_no_more_is_spent_than_is_given(name: str, steps: int, counted: Callable[[Criterion, int], int]) -> None:
    assert counted(LAWS[name], steps) <= steps + ONE_MORE


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(["hoffman", "lobes"], "lobes"))
def test_one_that_is_endless_would_be_seen(name: str, counted: Callable[[Criterion, int], int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "Budget", lambda steps: Budget(ANY_STEPS))
    assert counted(LAWS[name], 200_000) > 200_000 + ONE_MORE


@pytest.mark.slow
def test_more_steps_prove_more() -> None:
    assert [verdict_within(ROUND, "convexity", steps) for steps in (0, 100, 100_000)] == [Verdict.UNDECIDED] * 2 + [Verdict.PROVED]
    assert [verdict_within(LAWS["puck"], "convexity", steps) for steps in (100_000, 600_000)] == [Verdict.UNDECIDED, Verdict.PROVED]


def test_what_is_plainly_false_is_refuted_and_what_a_finder_proves_is_proved() -> None:
    for claim in ("convexity", "normality"):  # the second at the chord that refutes the first
        assert verdict_within(duhem.load("hu"), claim, 600_000) is Verdict.REFUTED
    assert verdict_within(duhem.load("gotoh"), "convexity", 600_000) is Verdict.PROVED


def test_a_formula_without_a_value_shows_nothing() -> None:
    for g, k in (("norm(a, b)/(k - 1) - 1", 1), ("log(k)*norm(a, b) - 1", -1), ("sqrt(k)*(a**4 + b**4) - 1", -1)):
        law = Criterion("odd", g, {"k": Domain.fixed(k)}, forces=("a", "b"), pressure=None)
        assert verdict_within(law, "convexity", 600_000) is Verdict.UNDECIDED


PROCESS = """
import sys
import time
import duhem
from duhem.proof import verification
from duhem.proof.decide import Budget
made = []
verification.Budget = lambda steps: made.append(Budget(steps)) or made[-1]
time.perf_counter = time.process_time = lambda: float(sys.argv[1])  # a clock that stands, at another hour in each process
for name in ("von-mises", "gotoh", "hoffman", "lobes", "limacon"):
    print(name, verification.verdict_within(duhem.load(name), "convexity", 150_000), made[-1].spent)
"""


@pytest.mark.long
@pytest.mark.slow
def test_two_processes_spend_the_same_and_find_the_same() -> None:
    done = [
        subprocess.run([sys.executable, "-c", PROCESS, seed], capture_output=True, text=True, env={**os.environ, "PYTHONHASHSEED": seed})
        for seed in ("1", "2000")
    ]
    assert done[0].returncode == 0, done[0].stderr
    assert done[0].stdout == done[1].stdout and "gotoh proved" in done[0].stdout and "hoffman undecided" in done[0].stdout
