"""Few points are taken one by one, on plain numbers: the answers of arrays to the bit, the judge's statuses; arrays take what raises."""

from __future__ import annotations

import ast
import inspect
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk
from duhem.projection import (
    closed_form,
    compiled_judge,
    compiled_newton,
    judge_kernel,
    newton,
    quadrants,
    slip_kernel,
)
from duhem.projection.closed_form import CLOSED_FORM
from duhem.projection.compiled_judge import told_one_by_one
from duhem.projection.compiled_newton import solved_one_by_one
from duhem.projection.in_blocks import FEW, FEW_SEARCHED
from duhem.projection.increment import increment, posed
from duhem.projection.judge_kernel import UNJUDGED
from duhem.projection.plain_numbers import interpreted, zeros
from duhem.projection.projector import Projector
from duhem.projection.quadrants import Quarters
from duhem.projection.residuals import Judge, residuals
from duhem.projection.result import ACCURACY, Status
from tests.long import long_but, mostly_long

FLAGSHIP = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
SHAPES: dict[str, tuple[tuple[float, ...], Any]] = {
    "plain": ((0.2, 0.08, 0.12, 0.15), np.diag([1.0, 2.0])),
    "oblique": ((0.2, 0.08, 0.12, 0.15), np.array([[2.0, 0.7], [0.7, 1.0]])),
    "round": ((0.5,) * 4, np.diag([3.0, 3.0])),
    "slender": ((1e-6, 1.0, 3.0, 2e5), np.diag([1e-6, 1e6])),
    "one circle of four": ((0.5, 0.5, 0.5, 0.2), np.eye(2)),
}


def drawn(n: int, seed: int = 0) -> tuple[Any, Any]:
    chance = np.random.default_rng(seed)
    trial = chance.standard_normal((n, 2)) * 10.0 ** chance.uniform(-6, 6, (n, 2))
    load = 10.0 ** chance.uniform(-6, 6, n)
    extreme = [
        ((1e308, 1e308), 1.0),
        ((1e-310, 5e-324), 1e-300),
        ((0.0, 0.0), 0.0),
        ((1.0, -2.0), 0.0),
        ((-0.0, 1.0), 1.0),
        ((1e300, 0.0), 1e300),
    ]
    cusp = [((5.63009385e-167, -1.63816600e-175), 3.173766149506887e-169), ((1.0, 1e-9), 1.0), ((1.5, 1e-9), 1.0), ((0.3, 0.4), 1.0)]
    extreme += cusp
    return np.vstack([trial, [t for t, _ in extreme]]), np.append(load, [e for _, e in extreme])


def answers(project: Any, trial: Any, load: Any, quarters: Quarters) -> list[bytes]:
    out = np.empty(trial.shape), np.empty(trial.shape), np.empty(len(load))
    project(trial, load, quarters, *out)
    return [x.tobytes() for x in out]


def arrays(trial: Any, load: Any, quarters: Quarters, *out: Any) -> None:
    with np.errstate(all="ignore"):
        quadrants._project(trial, load, quarters, *out, None)


@pytest.mark.parametrize("shape", long_but([0, 3, 4], SHAPES))
def test_answers_are_those_of_arrays_to_the_bit(shape: str) -> None:
    coefficients, stiffness = SHAPES[shape]
    quarters = Quarters.of(coefficients, stiffness)
    for trial, load in zip(*drawn(400), strict=True):
        for scaled in (trial, trial / max(1e-300, np.hypot(*trial)) * load * coefficients[0] * (1.0 + 1e-15)):  # next to the boundary too
            asked = scaled[None], np.array([load])
            assert answers(quadrants.project, *asked, quarters) == answers(arrays, *asked, quarters), (scaled, load)


@pytest.mark.parametrize(("stress", "slip", "multiplier"), [(1e-6, 0.0, 0.0), (0.0, 1e-5, 0.0), (0.0, 0.0, 1e-5)])
def test_a_spoilt_answer_does_not_pass(stress: float, slip: float, multiplier: float) -> None:
    for trial in ([0.3, 0.1], [-0.5, 0.02], [0.0, -2.0]):
        question = increment_of(trial)
        right = CLOSED_FORM.solve(question, CLOSED_FORM.options_of({}))
        assert told_one_by_one(question, right, Judge.of(question, right, True)).status.tolist() == [Status.SLIP]
        wrong = replace(
            right, stress=right.stress * (1.0 + stress), slip=right.slip * (1.0 + slip), multiplier=right.multiplier * (1.0 + multiplier)
        )
        assert residuals(question, wrong, True).worst()[0] > ACCURACY
        assert told_one_by_one(question, wrong, Judge.of(question, wrong, True)).status.tolist() == [UNJUDGED]


def increment_of(trial: list[float]) -> Any:
    return increment(Projector.of("antoni2007", [1.0, 2.0], FLAGSHIP).setting.law, [trial], -1.0, [1.0, 2.0], FLAGSHIP)


def test_statuses_do_not_depend_on_how_many_points_there_are() -> None:
    trial, load = drawn(60, 3)
    projector = Projector.of("antoni2007", [1.0, 2.0], FLAGSHIP)
    whole = projector(trial, -load)
    for size in range(1, FEW + 1):
        parts = [projector(trial[i : i + size], -load[i : i + size]).status for i in range(0, len(load), size)]
        assert np.concatenate(parts).tolist() == whole.status.tolist()


def test_what_raises_is_left_to_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    projector = Projector.of("antoni2007", [1.0, 2.0], FLAGSHIP)
    expected = projector([0.3, 0.1], -1.0)

    def fails(*_: Any) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(compiled_judge, "interpreted", lambda *_, **__: fails)
    found = projector([0.3, 0.1], -1.0)
    assert found.status.tolist() == expected.status.tolist() == [Status.SLIP]
    assert found.stress.tolist() == expected.stress.tolist()


SEARCHED: list[tuple[str, dict[str, float], Any]] = [
    ("superellipse", {"mu_a": 0.3, "mu_b": 0.2, "p": 4.0}, [1.0, 2.0]),
    ("box", {"mu_a": 0.3, "mu_b": 0.2}, [[2.0, 0.5], [0.5, 1.0]]),
    ("tresca", {"yield_stress": 1.0}, 1.0),
    ("drucker1949", {"c": 2.0, "k": 0.7}, [1.0, 2.0, 5.0]),
]


@pytest.mark.parametrize(("law", "parameters", "stiffness"), mostly_long(SEARCHED, *SEARCHED[1:3]))
def test_newtons_method_finds_what_arrays_find(law: str, parameters: dict[str, float], stiffness: Any) -> None:
    projector = Projector.of(law, stiffness, parameters, "newton")
    chance, known = np.random.default_rng(2), projector.setting.law
    trial = chance.standard_normal((FEW_SEARCHED, len(known.forces))) * 10.0 ** chance.uniform(-1, 2, (FEW_SEARCHED, 1))
    question = posed(projector.setting, trial, None if known.pressure is None else -1.0)
    found, left = solved_one_by_one(question)
    expected = newton.search(question)
    assert not left.size and not expected.failed.any()
    size = np.abs(trial).max(axis=1, keepdims=True)
    assert (np.abs(found.stress - expected.stress) <= 1e-13 * size).all()
    assert (np.abs(found.slip - expected.slip) <= 1e-12 * np.abs(expected.slip).max(axis=1, keepdims=True)).all()
    np.testing.assert_allclose(found.multiplier, expected.multiplier, rtol=1e-12)
    assert (projector.at(question).status != Status.INACCURATE).all()


def test_what_newtons_text_leaves_the_search_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    projector = Projector.of("tresca", 1.0, {"yield_stress": 1.0})
    expected = projector([[2.0, 0.3, 0.1], [0.1, 0.0, 0.2]])

    def fails(*_: Any) -> None:
        raise OverflowError

    monkeypatch.setattr(compiled_newton, "interpreted", lambda *_: fails)
    found = projector([[2.0, 0.3, 0.1], [0.1, 0.0, 0.2]])
    assert found.status.tolist() == expected.status.tolist() == [Status.SLIP, Status.STICK]
    np.testing.assert_allclose(found.stress, expected.stress, rtol=1e-14)


@pytest.mark.slow
def test_what_the_judge_refuses_of_few_points_is_searched_for() -> None:
    """Newton's loop goes from where the way to the trial leaves K to the end of a slot; the search finds the side beside it."""
    slot = Criterion("slot", "max(norm(a, b) - 1, min(2/5 - abs(b), a - 1/2))", forces=("a", "b"), pressure=None)
    projector = Projector.of(slot, 1.0, None)
    alone = replace(projector, method=replace(projector.method, again=None))([2.0, 1.0])
    found = projector([2.0, 1.0])
    assert (alone.status[0], found.status[0]) == (Status.INACCURATE, Status.SLIP)
    np.testing.assert_allclose(found.stress[0], np.array([2.0, 1.0]) / np.sqrt(5.0), rtol=1e-14)
    assert found.residuals.worst()[0] <= ACCURACY


def test_text_runs_on_lists_of_numbers() -> None:
    head = "from numpy import sqrt\nimport numpy as np\n"
    text = f"{head}def f(v, n):\n    a = np.empty((n, n))\n    a[0, 1] = sqrt(v[0, 0])\n    return a[0, 1] + a[1, 1]\n"
    assert interpreted(text, "f")([[4.0, 1.0]], 2) == 2.0
    assert zeros(2) == [0.0, 0.0] and zeros(1, 2) == [[0.0, 0.0]]
    with pytest.raises(ValueError, match="math domain error"):
        interpreted(text, "f")([[-4.0]], 1)


LOOPS = """
A, (B, SMALL) = 3, (2, 1e-3)
MORE = A + B * 2


def f(v, n):
    total = 0.0
    for i in range(A):
        for k in range(i + 1, A):
            total += v[i, k] * (SMALL + i - k)
    for i in range(A):
        if v[i, i] > n:
            break
    for j in range(MORE):
        if j == n:
            return total + 100.0 * i + j
    for k in range(v.shape[0] - 1, -1, -1):
        total = total * 0.5 + v[k, 0] ** 2
    last = 0
    for m in range(B):
        last += m
    return total + last
"""


@pytest.mark.parametrize("n", [2, 6, 20])
def test_loops_that_are_written_out_do_what_they_did(n: int) -> None:
    """Nested ones, those that end early, that go down, and of a size that only the array knows."""
    space: dict[str, Any] = {"A": 3, "B": 2, "SMALL": 1e-3, "MORE": 7}
    exec(LOOPS.partition("\n\n\n")[2], space)
    v = np.arange(9.0).reshape(3, 3) + 0.1
    text = LOOPS.replace("A, (B, SMALL) = 3, (2, 1e-3)", "A, B, SMALL = 3, 2, 1e-3")
    assert interpreted(text, "f")(v.tolist(), n) == space["f"](v, n)
    assert interpreted(text, "f", A=2)(v.tolist(), 20) != space["f"](v, 20)  # a constant of another value


def test_no_counter_of_a_loop_that_runs_to_its_end_is_read_after_it() -> None:
    """Such a loop may be written out, and then there is no counter."""
    sources = (
        judge_kernel,
        slip_kernel,
        *compiled_newton.KERNEL,
    )
    for function in (node for source in sources for node in ast.parse(inspect.getsource(source)).body if isinstance(node, ast.FunctionDef)):
        loops = [node for node in ast.walk(function) if isinstance(node, ast.For) and isinstance(node.target, ast.Name)]
        ended = [node for node in loops if any(isinstance(part, ast.Break | ast.Continue) for part in ast.walk(node))]
        for counter in {node.target.id for node in loops if node not in ended and isinstance(node.target, ast.Name)}:
            own = [node for node in loops if isinstance(node.target, ast.Name) and node.target.id == counter]
            inside = {id(part) for node in own for part in ast.walk(node)}
            reads = [n for n in ast.walk(function) if isinstance(n, ast.Name) and n.id == counter and isinstance(n.ctx, ast.Load)]
            assert all(id(n) in inside for n in reads), (function.name, counter)


def test_text_that_goes_on_has_the_values_that_compiled_code_has() -> None:
    text = "from numpy import log, sqrt\ndef f(v, power):\n    return log(v[0, 0]), sqrt(v[0, 0]), 1.0 / v[0, 1], v[0, 0]**power\n"
    run = interpreted(text, "f", True)
    assert np.array_equal(run([[-4.0, 0.0]], 0.5), [np.nan, np.nan, np.inf, np.nan], equal_nan=True)
    assert run([[0.0, -0.0]], -1.0) == (-np.inf, 0.0, -np.inf, np.inf)
    assert all(type(x) is float for x in run([[4.0, 2.0]], 0.5))
    larger = interpreted("from numpy import maximum\ndef f(a, b):\n    return maximum(a, b)\n", "f", True)
    assert np.isnan([larger(np.nan, 1.0), larger(1.0, np.nan)]).all() and larger(1.0, 2.0) == 2.0


LOADS = ["-sigma_n", "c - tan(phi)*sigma_n", "c + max(-sigma_n - 1, 0)", "c*(1 - exp(sigma_n))", "c*sqrt(1 - sigma_n**2)", "log(-sigma_n)"]


@pytest.mark.parametrize("load", LOADS)
def test_a_load_at_one_pressure_is_that_of_arrays(load: str) -> None:
    parameters = {"c": Domain.fixed("0.7"), "phi": Domain.fixed("0.3")}
    law = Criterion("loaded", f"norm(sigma_a, sigma_b) - ({load})", parameters, closed_form=Disk(1, load=load))
    setting = increment(law, [0.0, 0.0], -1.0, 1.0, {})
    pressure = -np.append(10.0 ** np.random.default_rng(0).uniform(-6, 3, 60), [0.0, 1.0, 1e-300, 1e200])
    load = law.closed_form.load
    with np.errstate(all="ignore"):
        one = [closed_form.of_one_pressure(setting, load)(p) for p in pressure.tolist()]
    assert np.array_equal(one, closed_form.of_pressure(setting, load)(pressure), equal_nan=True)


def test_rooms_of_zeros_have_lists_of_their_own() -> None:
    for sizes in ((3,), (2, 3), (2, 0), (2, 3, 4)):
        room = zeros(*sizes)
        assert np.array_equal(room, np.zeros(sizes))
        flat = np.array([id(row) for row in room]) if len(sizes) > 1 else np.zeros(0)
        assert len(set(flat.tolist())) == len(flat)
