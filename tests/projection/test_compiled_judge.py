"""The loop that says which points are plainly right: its text run as it is, and compiled, against the judge on arrays."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from dataclasses import fields, replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, InputError
from duhem.projection import compiled_judge, judge_kernel, newton
from duhem.projection.in_blocks import evenly, in_blocks
from duhem.projection.increment import Increment, posed, setting
from duhem.projection.method import Compiling
from duhem.projection.methods import METHODS
from duhem.projection.newton_step import below
from duhem.projection.residuals import Judge, residuals
from duhem.projection.result import ACCURACY, Residuals, Solution, Status
from tests.long import long_but
from tests.projection.drawn_questions import LAWS, drawn, spoilt
from tests.projection.loop_as_text import as_text

N = 16


def _question(name: str, n: int, seed: int = 0, full: bool = False) -> Increment:
    law, rng, stiffness = drawn(name, seed, full)
    trial = rng.normal(size=(n, len(law.forces))) * 10.0 ** rng.uniform(-1.0, 1.0, n)[:, None]
    return posed(setting(law, stiffness, LAWS[name]), 0.4 * trial, -rng.uniform(0.2, 1.2, n) if law.pressure else None)


@pytest.mark.slow
@pytest.mark.parametrize("full", [False, True], ids=["diagonal", "full"])
@pytest.mark.parametrize("name", long_but([0, 2, 4, 5, 7, 8, 11, 13], LAWS))
def test_what_it_calls_right_the_judge_does_too(name: str, full: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    question = _question(name, N, full=full)
    solution = newton.solve(question)
    told, known = as_text(monkeypatch, question, solution, convex=False), residuals(question, solution)
    assert told.left is not None
    judged = np.setdiff1d(np.arange(N), told.left)
    assert len(judged) >= N - 4
    assert (known.worst()[judged] <= ACCURACY).all()
    assert (told.status[judged] == np.where(solution.multiplier[judged] > 0.0, Status.SLIP, Status.STICK)).all()
    assert told.dissipation == pytest.approx(np.einsum("ij,ij->i", solution.stress, solution.slip), rel=1e-14, abs=1e-17)
    for field in fields(Residuals):
        there, here = getattr(told.residuals, field.name)[judged], getattr(known, field.name)[judged]
        assert there == pytest.approx(here, abs=2e-13), field.name


SPOILT = ["stress out", "stress in", "slip turned", "slip longer", "multiplier", "negative", "stick that slips", "no number"]


SOME = ("antoni2007", "superellipse", "hosford", "box", "tresca", "limacon")


@pytest.mark.slow
@pytest.mark.parametrize(("name", "how"), long_but([6, 15, 27, 45], product(SOME, SPOILT)))
def test_what_is_wrong_is_left_to_the_judge(name: str, how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    question = _question(name, 12, seed=1)
    right = newton.solve(question)
    slips = np.flatnonzero(right.multiplier > 0.0)
    question = replace(question, trial=question.trial[slips], pressure=question.pressure[slips])
    right = Solution(*(getattr(right, f.name)[slips] for f in fields(Solution)))
    for size in (1e-3, 1e-6, 1.5e-7):
        solution = spoilt(how, size, right)
        told, known = as_text(monkeypatch, question, solution, convex=False), residuals(question, solution)
        assert told.left is not None
        judged = np.setdiff1d(np.arange(len(slips)), told.left)
        assert (known.worst()[judged] <= ACCURACY).all()
        if size == 1e-3 and how != "slip turned":  # at a corner a slip may turn
            assert not judged.size


ON_THE_BOUNDARY = {
    "sap": Criterion("cone", "norm(a, b) - c", forces=("a", "b", "c"), pressure=None),
    "parabola": Criterion("parabola", "max(a - 1, b - 1, a + b + (a - b)**2/8)", forces=("a", "b"), pressure=None),
    "wedge": Criterion("wedge", "abs(a) - b/2", forces=("a", "b"), pressure=None),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ON_THE_BOUNDARY)
def test_where_no_stress_is_on_the_boundary_k_is_seen_from_within(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ordinary points pass both looks, and what is off by more than is vouched for passes neither."""
    law = ON_THE_BOUNDARY[name]
    trial = np.array([[1.0, 0.3, 0.2], [-0.5, 2.0, 1.7], [3.0, -2.0, 9.0], [0.1, 0.02, 0.03]])[:, -len(law.forces) :]
    question = posed(setting(law, 1.0, {}), np.abs(trial) if name == "parabola" else trial * [*[4.0] * (len(law.forces) - 1), 1.0], None)
    right = newton.solve(question)
    slips = (np.abs(right.stress) > 1e-3).any(axis=1) & (right.multiplier > 0.0)
    assert slips.sum() >= 2
    for off in (0.0, 1.5e-7, 1e-5):
        given = replace(right, stress=right.stress * (1.0 - off))
        told, judge = as_text(monkeypatch, question, given, convex=True), Judge.of(question, given, True)
        assert told.left is not None
        with np.errstate(all="ignore"):
            _, left = judge.first.left(question, given, Residuals(*(np.zeros(len(trial)) for _ in range(5))))
        for some in (told.left, left):
            assert np.isin(np.flatnonzero(slips), some).all() if off else not np.isin(np.flatnonzero(slips), some).any()


@pytest.mark.parametrize("name", ["antoni2007", "box"])
def test_a_point_is_told_the_same_in_any_chunk(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    question = _question(name, 8)
    solution = newton.solve(question)
    together, apart = (as_text(monkeypatch, question, solution, True, chunk) for chunk in (128, 3))
    assert together.dissipation.tobytes() == apart.dissipation.tobytes() and together.status.tobytes() == apart.status.tobytes()
    for field in fields(Residuals):
        assert getattr(together.residuals, field.name).tobytes() == getattr(apart.residuals, field.name).tobytes(), field.name


@pytest.mark.parametrize("load", ["abs(p)/3", "abs(p)**(1/3)/3 + 1/7", "tanh(abs(p)/3) + 1/5"])
def test_what_depends_on_the_pressure_is_told_like_the_judge_says(load: str, monkeypatch: pytest.MonkeyPatch) -> None:
    law = Criterion(name="loaded", g=f"norm(a, 2*b) - ({load})", forces=("a", "b"), pressure="p")
    rng = np.random.default_rng(3)
    sizes = np.where(np.arange(N) % 3, 1.0, 0.01)[:, None]
    question = posed(setting(law, [1.0, 2.0], {}), sizes * rng.normal(size=(N, 2)), -rng.uniform(0.1, 2.0, N))
    solution = newton.solve(question)
    told, known = as_text(monkeypatch, question, solution, convex=True), residuals(question, solution, convex=True)
    assert told.left is not None and not told.left.size and set(told.status) == {Status.STICK, Status.SLIP}
    assert told.residuals.worst() == pytest.approx(known.worst(), abs=2e-13)
    elsewhere = replace(question, pressure=question.pressure * np.where(solution.multiplier > 0.0, 1.0 + 1e-5, 1.0))
    left = as_text(monkeypatch, elsewhere, solution, convex=True).left
    assert left is not None and set(left) == set(np.flatnonzero(solution.multiplier > 0.0))


@pytest.mark.parametrize("past", [1.0, 1.0 + 1e-9, 1.0 - 3e-16])
def test_a_stick_on_the_boundary_or_beyond_is_left(past: float, monkeypatch: pytest.MonkeyPatch) -> None:
    question = posed(setting(duhem.load("antoni2007"), 1.0, LAWS["antoni2007"]), np.array([[0.3 * past, 0.0], [0.29, 0.0]]), -1.0)
    still = Solution(question.trial, np.zeros((2, 2)), np.zeros(2), np.zeros(2, dtype=bool))
    told = as_text(monkeypatch, question, still, convex=True)
    assert told.left is not None and told.left.tolist() == [0] and told.status[1] == Status.STICK


def _on_a_side(stress: tuple[float, float], slip: float, multiplier: float = 1.0) -> tuple[Increment, Solution]:
    """A box of half widths 0.3 and 0.2 that slips across its upper side, the second stiffness a hundred times the first."""
    slips, k = np.array([[0.0, slip]]), np.array([1.0, 100.0])
    question = posed(setting(duhem.load("box"), k, LAWS["box"]), np.array([stress]) + slips * k, -1.0)
    return question, Solution(np.array([stress]), slips, np.array([multiplier * slip * 0.2]), np.zeros(1, dtype=bool))


@pytest.mark.parametrize("past", [0.8, 1.2])
def test_it_stays_within_the_thresholds_of_the_judge(past: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Next to each of them, on either side, a point is left: they are halved."""

    def left(question: Increment, solution: Solution) -> bool:
        found = as_text(monkeypatch, question, solution, convex=True).left
        return found is not None and bool(found.size)

    assert not left(*_on_a_side((0.19, 0.2), 0.01))
    assert left(*_on_a_side((0.19, 0.2 * (1.0 - past * 7e-8)), 0.01))  # 1e-8/sqrt(2) of the stress in the metric, the first threshold
    assert not left(*_on_a_side((0.19, 0.2), 0.5))  # of a long slip the stress alone counts
    assert left(*_on_a_side((0.19, 0.2 * (1.0 - past * 7e-8)), 0.5))
    assert left(*_on_a_side((0.1, 0.2), 0.1, 1.0 + past * 1e-8))  # multiplier and slip apart by 1e-7 of the stress
    question, got = _on_a_side((0.1, 0.2), 0.1)
    assert left(replace(question, trial=question.trial * (1.0 + past * 1e-7)), got)  # and what does not add up


def test_residuals_beyond_rounding_are_those_of_the_judge(monkeypatch: pytest.MonkeyPatch) -> None:
    question, solution = _on_a_side((0.1, 0.2 * (1.0 - 1e-9)), 0.5, 1.0 + 1e-11)
    told, known = as_text(monkeypatch, question, solution, convex=True), residuals(question, solution, convex=True)
    assert told.left is not None and not told.left.size
    assert told.residuals.stationarity == pytest.approx(known.stationarity, rel=1e-4) and known.stationarity > 1e-11
    assert told.residuals.complementarity == pytest.approx(known.complementarity, rel=1e-4) and known.complementarity > 1e-11


@pytest.mark.parametrize("sides", [(3.0, 4.0), (-1e-140, 1e-150), (0.0, -2.0), (0.0, 0.0), (1e150, 1.0)])
def test_a_hypotenuse_in_range_is_right(sides: tuple[float, float]) -> None:
    assert abs(judge_kernel.hypot(*sides) - math.hypot(*sides)) <= 2.0**-51 * math.hypot(*sides)


@pytest.mark.parametrize("sides", [(1e-160, 0.0), (1e155, 1.0), (np.inf, 1.0), (np.nan, 1.0)])
def test_a_hypotenuse_out_of_range_is_none(sides: tuple[float, float]) -> None:
    with np.errstate(over="ignore"):
        assert np.isnan(judge_kernel.hypot(*map(np.float64, sides)))


@pytest.mark.parametrize("threads", [1, 3])
def test_blocks_are_done_once_each(threads: int) -> None:
    done: list[int] = []
    in_blocks(10, 3, lambda block: done.extend(range(block.start, block.stop)), threads)
    assert sorted(done) == list(range(10))


@pytest.mark.parametrize(("n", "size"), [(0, 1_000), (900, 1_000), (3_000, 1_000), (10_000, 1_250), (32_000, 4_000), (33_000, 2_063)])
def test_two_four_and_eight_threads_have_as_much_to_do_as_each_other(n: int, size: int) -> None:
    assert evenly(n, 4_000, 1_000) == size
    shares = -(-n // size)
    assert size == 1_000 or shares % 8 == 0


def test_a_stationary_point_that_is_not_the_closest_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    law = Criterion(name="two", g="min(norm(a - 3, b), norm(a + 3, b)) - 1", forces=("a", "b"), pressure=None)
    question = posed(setting(law, 1.0, {}), np.array([[0.5, 0.0]]), None)
    far = Solution(np.array([[-2.0, 0.0]]), np.array([[2.5, 0.0]]), np.array([2.5]), np.zeros(1, dtype=bool))
    told = as_text(monkeypatch, question, far, convex=False)
    assert told.left is not None and told.left.tolist() == [0]


def test_what_a_method_gave_up_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    question = _question("coulomb", 4)
    solution = replace(newton.solve(question), failed=np.array([True, False, True, False]))
    told = as_text(monkeypatch, question, solution, convex=False)
    assert told.left is not None and {0, 2} <= set(told.left.tolist())


def test_a_formula_without_text_leaves_all_to_the_judge(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled_judge, "_text", lambda *_: None)
    question = _question("coulomb", 2)
    solution = newton.solve(question)
    assert compiled_judge.told(question, solution, Judge.of(question, solution, False)).left is None


@pytest.mark.parametrize("size", [1.0, 1.5, 2.0**-1022, 0.1, 1e308, 3.0])
def test_powers_of_two_below(size: float) -> None:
    assert below(size) <= size < 2.0 * below(size) and np.frexp(below(size))[0] == 0.5
    assert below(5e-324) == 2.0**-1022


@pytest.mark.parametrize("threads", [0, -1, 1.5, "two"])
def test_threads_are_counted(threads: Any) -> None:
    with pytest.raises(InputError, match="threads"):
        duhem.project("coulomb", [1.0, 0.0], -1.0, parameters={"mu": 0.3}, compiled=True, threads=threads)


def test_passes_of_numpy_start_threads_only_where_they_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    trial = np.full((30_000, 2), 0.1)

    def begun(*_: object) -> None:
        raise RuntimeError("threads")

    monkeypatch.setattr("concurrent.futures.ThreadPoolExecutor", begun)
    assert (duhem.project("coulomb", trial, -1.0, parameters={"mu": 0.3}).status == Status.STICK).all()
    with pytest.raises(RuntimeError, match="threads"):
        duhem.project("coulomb", trial, -1.0, parameters={"mu": 0.3}, threads=2)
    assert Compiling(compiled=True).sharing is None and Compiling(compiled=True, threads=3).sharing == Compiling(threads=3).sharing == 3


def test_every_method_that_compiles_takes_the_same_options() -> None:
    found = {name for name, method in METHODS.items() if issubclass(method().options, Compiling)}
    assert found == {"closed-form", "newton"}


SCRIPT = """
import numpy as np, duhem
from dataclasses import astuple
rng = np.random.default_rng(0)
n = 40_000
trial, pressure = rng.normal(size=(n, 2)), -rng.uniform(0.2, 1.0, n)
trial[::7] = 0.0
for law, own in (("antoni2007", dict(mu_a_plus=0.3, mu_a_minus=0.2, mu_b_plus=0.1, mu_b_minus=0.4)), ("box", dict(mu_a=0.3, mu_b=0.2))):
    one, two, five = (duhem.project(law, trial, pressure, [1.0, 2.0], own, compiled=True, threads=k) for k in (1, 2, 5))
    for other in (two, five):
        for name in ("stress", "slip", "multiplier", "dissipation", "status"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
        assert all(a.tobytes() == b.tobytes() for a, b in zip(astuple(one.residuals), astuple(other.residuals)))
    few = slice(39_000, None)
    slow = duhem.project(law, trial[few], pressure[few], [1.0, 2.0], own)
    assert (slow.status == one.status[few]).all() and set(slow.status.tolist()) == {0, 1}
    assert abs(slow.dissipation - one.dissipation[few]).max() < 1e-13
    assert max(abs(a - b[few]).max() for a, b in zip(astuple(slow.residuals), astuple(one.residuals))) < 2e-13
"""


@pytest.mark.long
def test_compiled_it_does_not_depend_on_the_threads(tmp_path: Any) -> None:
    pytest.importorskip("numba")
    environment = {**os.environ, "DUHEM_CACHE_DIR": str(tmp_path / "kept")}
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
