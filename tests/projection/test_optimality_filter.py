"""The first look at a block says of a point that it is plainly right, or nothing; and then what the judge says who looks closely."""

from __future__ import annotations

from dataclasses import fields, replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.projection import closed_form, newton
from duhem.projection.increment import Increment, posed, setting
from duhem.projection.projector import Projector
from duhem.projection.residuals import Judge
from duhem.projection.result import ACCURACY, Residuals, Solution
from tests.long import long_but
from tests.projection.drawn_questions import drawn, spoilt

LAWS: dict[str, dict[str, float]] = {
    "antoni2007": {"mu_a_plus": 0.3, "mu_a_minus": 0.2, "mu_b_plus": 0.1, "mu_b_minus": 0.4}, "regularised": {"mu": 0.3, "c": 0.1},
    "superellipse": {"mu_a": 0.3, "mu_b": 0.2, "p": 3}, "limacon": {"mu": 0.3, "e": 0.4}, "hosford": {"yield_stress": 0.3, "m": 8},
    "drucker1949": {"k": 0.3, "c": 2}, "capped": {"mu": 0.3, "tau_max": 0.2},
    "cohesive": {"mu": 0.3, "cohesion": 0.1}, "antoni2007-1d": {"mu_plus": 0.3, "mu_minus": 0.1},
}  # fmt: skip

FLAGSHIP = LAWS["antoni2007"]


def _question(name: str, n: int, full: bool) -> Increment:
    law, rng, stiffness = drawn(name, 3, full)
    trial = rng.normal(size=(n, len(law.forces))) * 10.0 ** rng.uniform(-1.0, 1.0, n)[:, None]
    return posed(setting(law, stiffness, LAWS[name]), 0.4 * trial, -rng.uniform(0.2, 1.2, n) if law.pressure else None)


def _both(question: Increment, solution: Solution, convex: bool = True) -> tuple[Residuals, Residuals, np.ndarray[Any, Any]]:
    """Residuals with a first look and without, and the points that it says nothing of."""
    judge, n = Judge.of(question, solution, convex), len(solution.multiplier)
    first, close, alone = (Residuals(*(np.zeros(n) for _ in range(5))) for _ in range(3))
    judge.look(solution, first)
    judge.look(solution, close, np.arange(n))
    with np.errstate(all="ignore"):
        left = np.concatenate(judge.first.left(question, solution, alone))
    return first, close, left


@pytest.mark.slow
@pytest.mark.parametrize("full", [False, True], ids=["diagonal", "full"])
@pytest.mark.parametrize("name", LAWS)
def test_it_says_what_the_judge_says(name: str, full: bool) -> None:
    question = _question(name, 40, full)
    solution = newton.solve(question)
    for convex in (True, False):
        first, close, left = _both(question, solution, convex)
        assert len(left) <= 6  # in corners it leaves more
        for field in fields(Residuals):
            assert getattr(first, field.name) == pytest.approx(getattr(close, field.name), abs=2e-13), field.name


SPOILT = ["stress out", "stress in", "slip turned", "slip longer", "multiplier", "negative", "stick", "nan", "inf"]


SOME = ("antoni2007", "superellipse", "hosford")


@pytest.mark.slow
@pytest.mark.parametrize(("name", "how"), long_but([0, 10, 16, 23, 26], product(SOME, SPOILT)))
def test_what_is_spoilt_is_left_or_has_the_same_residuals(name: str, how: str) -> None:
    question = _question(name, 8, full=False)
    right = newton.solve(question)
    moves = np.flatnonzero(right.multiplier > 0.0)
    question = replace(question, trial=question.trial[moves], pressure=question.pressure[moves])
    right = Solution(*(getattr(right, f.name)[moves] for f in fields(Solution)))
    for size in (1e-6, 1e-8, 1e-12):
        first, close, left = _both(question, spoilt(how, size, right))
        assert ((first.worst() <= ACCURACY) == (close.worst() <= ACCURACY)).all()
        said = np.setdiff1d(np.arange(len(moves)), left)
        assert (close.worst()[said] <= ACCURACY).all()
        for field in fields(Residuals):
            assert getattr(first, field.name)[said] == pytest.approx(getattr(close, field.name)[said], abs=2e-13), field.name
        if size == 1e-6 or how not in ("stress out", "stress in", "slip turned", "slip longer", "multiplier"):
            assert not said.size


def _on_a_side(stress: tuple[float, float], slip: float, multiplier: float = 1.0) -> tuple[Increment, Solution]:
    """A box of half widths 0.3 and 0.2 that slips across its upper side, the second stiffness a hundred times the first."""
    slips, k = np.array([[0.0, slip]]), np.array([1.0, 100.0])
    question = posed(setting(duhem.load("box"), k, {"mu_a": 0.3, "mu_b": 0.2}), np.array([stress]) + slips * k, -1.0)
    return question, Solution(np.array([stress]), slips, np.array([multiplier * slip * 0.2]), np.zeros(1, dtype=bool))


def _left(question: Increment, solution: Solution) -> bool:
    return bool(_both(question, solution)[2].size)


def test_what_only_the_components_tell_is_left() -> None:
    """In the metric the stress is off by a hundred-millionth, in its stiff component by more than a ten-millionth."""
    asked = _on_a_side((0.19, 0.2), 0.01)
    assert not _left(*asked)
    first, close, left = _both(*_on_a_side((0.19, 0.2 * (1.0 - 1.2e-7)), 0.01))
    assert left.size and (first.worst() > ACCURACY).all() and (close.worst() > ACCURACY).all()


@pytest.mark.parametrize("past", [0.8, 1.2])
def test_it_stays_within_the_thresholds_of_the_judge(past: float) -> None:
    """Next to each of them, on either side, a point is left: they are halved."""
    assert _left(*_on_a_side((0.19, 0.2 * (1.0 - past * 7e-8)), 0.01))  # 1e-8/sqrt(2) of the stress in the metric, the first threshold
    assert _left(*_on_a_side((0.1, 0.2), 0.1, 1.0 + past * 1e-10))  # multiplier and slip apart by 1e-9 of the stress
    question, got = _on_a_side((0.1, 0.2), 0.1)
    assert _left(replace(question, trial=question.trial * (1.0 + past * 2e-10)), got)  # and what does not add up


def test_next_to_the_boundary_a_stick_is_looked_at_closely() -> None:
    question = posed(setting(duhem.load("antoni2007"), 1.0, FLAGSHIP), np.array([[0.3 * (1.0 - x), 0.0] for x in (1e-3, 5e-16)]), -1.0)
    still = Solution(question.trial, np.zeros((2, 2)), np.zeros(2), np.zeros(2, dtype=bool))
    assert _both(question, still)[2].tolist() == [1]


@pytest.mark.parametrize("scale", [1e-290, 1e-140, 1e140, 1e290])
def test_what_cannot_be_squared_is_left(scale: float) -> None:
    question = posed(setting(duhem.load("antoni2007"), 1.0, FLAGSHIP), np.array([[0.5, 0.3], [0.1, 0.01]]) * scale, -scale)
    first, close, left = _both(question, closed_form.solve(question))
    assert left.tolist() == [0]
    assert (first.worst() <= ACCURACY).all() and (close.worst() <= ACCURACY).all()


def test_a_point_has_the_same_answer_alone_in_a_batch_and_on_any_number_of_threads() -> None:
    rng = np.random.default_rng(0)
    trial, pressure = rng.normal(size=(40_000, 2)) * 0.3, -rng.uniform(0.5, 1.5, 40_000)
    increments = Projector.of("antoni2007", 1.0, FLAGSHIP)
    one, two = (increments(trial, pressure, threads=threads) for threads in (1, 2))
    few = np.arange(3, 40_000, 1999)
    part, alone = increments(trial[few], pressure[few]), [increments(trial[i], pressure[i]) for i in few[:4]]
    for found in (lambda x: x.stress, lambda x: x.status, lambda x: x.dissipation, lambda x: x.residuals.worst()):
        assert (found(one) == found(two)).all()
        assert (found(one)[few] == found(part)).all()
    for found in (lambda x: x.stress, lambda x: x.slip, lambda x: x.multiplier, lambda x: x.status, lambda x: x.dissipation):
        assert (found(one)[few[:4]] == np.concatenate([found(x) for x in alone])).all()
    worst = np.concatenate([x.residuals.worst() for x in alone])  # few points are judged on plain numbers, whose last digits are others
    assert worst == pytest.approx(one.residuals.worst()[few[:4]], abs=4e-15)
