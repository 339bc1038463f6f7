"""The two kernels of the quarter ellipses, plain and compiled, against many digits; what they cost."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import duhem
from duhem.errors import InputError, MissingExtraError
from duhem.projection import closed_form, code_cache, compiled, quadrants
from duhem.projection.closed_form import ClosedFormOptions
from duhem.projection.in_blocks import BLOCK
from duhem.projection.increment import increment
from duhem.projection.quadrants import Quarters
from duhem.projection.result import Status
from tests.long import long_but
from tests.oracles.projection import Exact, closest
from tests.projection.declared_shapes import EPS, FIGURE_5, MU, WITH_SHAPE, off, values

pytestmark = pytest.mark.usefixtures("many_digits")
KERNELS = pytest.mark.parametrize("fast", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["numpy", "numba"])

# -- against many digits ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("trial", "k", "stress"),
    [
        ((0.3, 0.2), (1, 1), ("0.16948295870263982786", "0.063711769834024715701")),
        ((-0.3, 0.2), (1, 1), ("-0.0626859952990218239", "0.074555673728327216011")),
        ((-0.3, -0.2), (1, 4), ("-0.076140510365716901921", "-0.046028201830649999767")),
        ((0.3, -0.01), (1, 1), ("0.19987561244121522752839620677181", "-0.0052894704439702478874")),
    ],
)
def test_reference_values(trial: tuple[float, float], k: tuple[float, float], stress: tuple[str, str], solved: Kernel) -> None:
    done = duhem.project("antoni2007", trial, -1.0, k, FIGURE_5)
    for i in (0, 1):
        assert abs(done.stress[0, i] - float(stress[i])) <= 1e-15 * abs(float(stress[i]))
    assert done.status[0] == Status.SLIP
    assert done.method == "closed-form"


Kernel = Callable[[Any, Any, Any, Any], tuple[np.ndarray, np.ndarray, np.ndarray]]


@pytest.fixture(params=["numpy", pytest.param("numba", marks=pytest.mark.slow)])  # what is slow is compiling
def solved(request: pytest.FixtureRequest) -> Kernel:
    """Stress, slip and multiplier of a kernel, plain or compiled."""
    if request.param == "numba":
        pytest.importorskip("numba")
    project = compiled.project if request.param == "numba" else quadrants.project

    def run(trial: Any, load: Any, mu: Any, k: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        trial, load = np.asarray(trial, dtype=float), np.asarray(load, dtype=float)
        stress, slip, multiplier = np.empty_like(trial), np.empty_like(trial), np.empty(len(trial))
        project(trial, load, Quarters.of(mu, np.asarray(k, dtype=float)), stress, slip, multiplier)
        return stress, slip, multiplier

    return run


def trials(rng: np.random.Generator, mu: np.ndarray, load: np.ndarray) -> np.ndarray:
    """On, one ulp off, close to and 1e16 radii from the boundary; a third in slivers beside the seams, some on them."""
    n = load.size
    angle = rng.uniform(0.0, 2 * np.pi, n)
    seam = rng.integers(0, 4, n) * (np.pi / 2)
    cos, sin = np.cos(angle), np.sin(angle)
    beside = rng.random(n) < 0.35
    sliver = rng.choice([0.0, -0.0, 1e-300, 1e-17, 1e-9, 1e-3], n) * rng.choice([-1.0, 1.0], n)
    along_a = np.abs(np.cos(seam)) > 0.5
    cos = np.where(beside, np.where(along_a, np.cos(seam), sliver), cos)
    sin = np.where(beside, np.where(along_a, sliver, np.sin(seam)), sin)
    cos, sin = np.where(np.abs(cos) > 0.999999, np.sign(cos), cos), np.where(np.abs(sin) > 0.999999, np.sign(sin), sin)
    where = rng.integers(0, 5, n)
    on, close, away = np.ones(n), 10 ** rng.uniform(-15, 0, n), 10 ** rng.uniform(0, 16, n)
    far = np.choose(where, [on, on + EPS, on + close, away, on - EPS])
    a, b = np.where(cos < 0, mu[1], mu[0]), np.where(sin < 0, mu[3], mu[2])
    return np.stack([a * cos, b * sin], axis=1) * (load * far)[:, None]


def exact(trial: np.ndarray, load: np.ndarray, mu: Any, k: Any) -> list[Exact]:
    numbers, matrix = tuple(map(float, mu)), tuple(map(tuple, np.asarray(k, dtype=float).tolist()))
    return [_closest(tuple(t), e, numbers, matrix) for t, e in zip(trial.tolist(), load.tolist(), strict=True)]


_closest = cache(closest)  # for both kernels


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but(range(16), range(60)))
def test_diagonal_stiffness_componentwise(seed: int, solved: Kernel) -> None:
    """mu ratio up to 1e8, k ratio up to 1e12, |sigma_n| from 1e-290 to 1e290."""
    rng = np.random.default_rng(seed)
    mu = 10 ** rng.uniform(-4, 4, 4) if seed % 2 else 10 ** rng.uniform(-1, 0, 4)
    k = np.diag(10 ** rng.uniform(-6, 6, 2))
    load = 10 ** (rng.uniform(-290, 290, 24) if seed % 3 == 0 else rng.uniform(-3, 3, 24))
    trial = trials(rng, mu, load)
    stress, slip, multiplier = solved(trial, load, mu, k)
    for n, answer in enumerate(exact(trial, load, mu, k)):
        assert answer.slips == (multiplier[n] > 0.0)
        if not answer.slips:
            assert (stress[n] == trial[n]).all() and (slip[n] == 0.0).all()
            continue
        normal = 1e-290 < float(answer.multiplier) < 1e290
        for i in (0, 1):
            if abs(answer.stress[i]) <= max(1e-300, 1e-290 * float(load[n])):  # it, or its share, is no normal number
                continue
            assert off(stress[n, i], answer.stress[i]) <= 8
            if normal and abs(answer.slip[i]) > 1e-300:
                assert off(slip[n, i], answer.slip[i]) <= 16
        if normal:
            assert off(multiplier[n], answer.multiplier) <= 16
        mus = [mpmath.mpf(mu[2 * i + (stress[n, i] < 0)]) for i in (0, 1)]
        gauge = mpmath.sqrt(sum((mpmath.mpf(stress[n, i]) / mus[i]) ** 2 for i in (0, 1)))
        assert abs(gauge / mpmath.mpf(load[n]) - 1) <= 4 * EPS


@pytest.mark.parametrize("power", [-15, -12, -8, -4, -1])
@pytest.mark.parametrize("ratio", [1e-12, 1e-6, 0.3])
def test_at_the_evolute_cusp(power: int, ratio: float, solved: Kernel) -> None:
    """At the centre of curvature of the vertex, where the quartic has a triple root, and within 10^power of it."""
    mu, k = (1.0, 1.0, 1.0, 1.0), np.diag([1.0, ratio])
    cusp = 1.0 - ratio  # for e = 1, p_1 = 0, A = C
    near = np.array([[s * 10.0**power * ratio, max(cusp, 1.0) * (1 + t * 10.0**power)] for s in (0, 1e-3, 1, -1) for t in (1, 1e-3, 2)])
    stress, _, multiplier = solved(near, np.ones(len(near)), mu, k)
    for n, answer in enumerate(exact(near, np.ones(len(near)), mu, k)):
        assert answer.slips == (multiplier[n] > 0.0)
        if answer.slips:
            assert max(off(stress[n, i], answer.stress[i]) for i in (0, 1)) <= 8
            assert off(multiplier[n], answer.multiplier) <= 16


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but(range(10), range(30)))
def test_full_stiffness_normwise(seed: int, solved: Kernel) -> None:
    """Condition up to 1e12; the result may lie in another quadrant than its trial."""
    rng = np.random.default_rng(1000 + seed)
    mu = 10 ** rng.uniform(-4, 4, 4) if seed % 2 else 10 ** rng.uniform(-1, 0, 4)
    angle, soft = rng.uniform(0, np.pi), 10 ** rng.uniform(-12, 0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    k = turn @ np.diag([1.0, soft]) @ turn.T
    k = (k + k.T) / 2
    load = 10 ** rng.uniform(-3, 3, 24)
    trial = trials(rng, mu, load)
    stress, slip, multiplier = solved(trial, load, mu, k)
    for n, answer in enumerate(exact(trial, load, mu, k)):
        assert answer.slips == (multiplier[n] > 0.0)
        if answer.slips:
            at = [mu[2 * i + (answer.stress[i] < 0)] for i in (0, 1)]  # K has the shape of a disk in sigma_i/mu_i and mu_i slip_i
            for got, right, weight in ((stress[n], answer.stress, (1, 1)), (slip[n], answer.slip, at)):
                wrong = max(w * abs(mpmath.mpf(float(x)) - y) for x, y, w in zip(got, right, weight, strict=True))
                assert wrong <= 1e-13 * max(w * abs(y) for y, w in zip(right, weight, strict=True))
            assert off(multiplier[n], answer.multiplier) <= 450


def test_full_stiffness_crosses_a_seam(solved: Kernel) -> None:
    k = np.array([[1.0, 0.9], [0.9, 1.0]])
    trial = np.array([[0.5, 0.3], [0.5, 0.02], [-0.4, 0.02]])
    stress, _, _ = solved(trial, np.ones(3), MU, k)
    assert (np.sign(stress) != np.sign(trial)).any()


def test_full_stiffness_on_a_seam_with_unlike_coefficients(solved: Kernel) -> None:
    """So close to a seam that rounding would take the wrong side's coefficient, eight digits of the multiplier away."""
    mu = (32.9925832402876, 0.00799058912998657, 471.2710847143024, 1528.5132255629605)
    k = [[0.05564165564760973, 0.18146370806520418], [0.18146370806520418, 0.9651307392562352]]
    trial = [[3.0026929941003743e-16, 70.04619479387817]]
    stress, _, multiplier = solved(trial, [0.14863249001653075], mu, k)
    answer = closest(trial[0], 0.14863249001653075, mu, k)
    assert off(multiplier[0], answer.multiplier) <= 16
    assert off(stress[0, 1], answer.stress[1]) <= 8


def test_full_stiffness_with_one_seam_only(solved: Kernel) -> None:
    """Where the two senses of b share a coefficient, a result on the seam of a keeps its b."""
    mu, k = (0.2, 0.1, 0.3, 0.3), np.array([[1.0, 0.6], [0.6, 1.0]])
    n = np.array([0.0, -1.0])  # normal at (0, -0.3)
    trial = np.array([np.array([0.0, -0.3]) + s * (k @ n) for s in (0.1, 1.0, 30.0)])
    stress, _, multiplier = solved(trial, np.ones(3), mu, k)
    assert np.abs(stress - [0.0, -0.3]).max() <= 1e-14
    assert np.allclose(multiplier, np.array([0.1, 1.0, 30.0]) * 0.3, rtol=1e-13)


def test_a_quarter_without_width_is_a_segment(solved: Kernel) -> None:
    stress, slip, multiplier = solved([[3.0, 4.0], [0.1, 4.0], [3.0, -1.0]], np.ones(3), (0.5, 0.5, 0.0, 1.0), np.diag([1.0, 2.0]))
    assert stress[:2].tolist() == [[0.5, 0.0], [0.1, 0.0]]
    assert slip[:2].tolist() == [[2.5, 2.0], [0.0, 2.0]]
    assert multiplier[:2].tolist() == [1.25, 0.0]
    assert stress[2, 1] < 0


def test_no_stick_is_reported_where_a_slip_leaves_the_stress_as_it_was(solved: Kernel) -> None:
    """One ulp outside on an axis: the nearest number to the boundary may be the trial itself."""
    radius = 0.2 * 0.7
    trial = np.array([[x, 0.0] for x in (np.nextafter(radius, 0), radius, np.nextafter(radius, 1), radius * (1 + 4 * EPS))])
    _, _, multiplier = solved(trial, np.full(4, 0.7), (0.2, 0.2, 0.2, 0.2), np.eye(2))
    outside = [mpmath.mpf(x) > mpmath.fmul(0.2, 0.7, exact=True) for x in trial[:, 0].tolist()]
    assert (multiplier > 0.0).tolist() == outside


# -- cost ------------------------------------------------------------------------------------------------------------


def test_memory_beyond_the_results_is_that_of_a_block() -> None:
    n = 300_000
    rng = np.random.default_rng(0)
    trial, load = rng.normal(size=(n, 2)), np.ones(n)
    stress, slip, multiplier = np.empty((n, 2)), np.empty((n, 2)), np.empty(n)
    quarters = Quarters.of(MU, np.array([[2.0, 1.0], [1.0, 3.0]]))
    tracemalloc.start()
    try:
        for start in range(0, n, BLOCK):
            part = slice(start, start + BLOCK)
            quadrants.project(trial[part], load[part], quarters, stress[part], slip[part], multiplier[part])
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 16e6


def test_compiled_kernel_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.setattr(compiled, "compiled_text", code_cache.compiled_text.__wrapped__)  # nothing compiled yet, and what is stays
    monkeypatch.setattr(compiled, "kernel", cache(compiled.kernel.__wrapped__))
    with pytest.raises(MissingExtraError, match=r'pip install "duhem\[fast\]"'):
        duhem.project("antoni2007", [0.3, 0.2], -1.0, parameters=FIGURE_5, compiled=True)


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([1, 3, 4, 7], WITH_SHAPE))
def test_compiled_kernel_agrees(name: str) -> None:
    pytest.importorskip("numba")
    rng = np.random.default_rng(5)
    law = duhem.load(name)
    n, d = 4000, len(law.forces)
    trial, pressure = rng.normal(size=(n, d)) * 10 ** rng.uniform(-3, 3, (n, 1)), -(10 ** rng.uniform(-2, 2, n))
    trial[7], pressure[8], trial[9] = 0.0, -0.0, 1e200  # the last two leave the vectors
    for k in ([1.0] * d, [1.0, 1e6][:d], [[2.0, 1.0], [1.0, 3.0]] if d == 2 else [2.0]):
        plain = duhem.project(law, trial, pressure, k, values(law))
        fast = duhem.project(law, trial, pressure, k, values(law), compiled=True)
        scale = np.abs(plain.stress).max(axis=1, keepdims=True)
        assert (np.abs(fast.stress - plain.stress) <= 16 * EPS * scale).all()
        assert (np.abs(fast.multiplier - plain.multiplier) <= 16 * EPS * plain.multiplier).all()
        assert (fast.status == plain.status).all()


@KERNELS
def test_a_number_out_of_range_fails_its_point_alone(fast: bool) -> None:
    if fast:
        pytest.importorskip("numba")
    trial = np.array([[0.3, 0.2], [1e200, 1.0], [0.3, -0.2]])
    done = duhem.project("antoni2007", trial, -1.0, 1e-200, FIGURE_5, compiled=fast)  # a slip of 1e400
    assert done.status.tolist() == [Status.SLIP, Status.FAILED, Status.SLIP]


@pytest.mark.parametrize("coupled", [0.0, 0.1])
def test_the_multiplier_is_nan_where_a_slip_is_out_of_range(coupled: float, solved: Kernel) -> None:
    k = np.array([[1.0, coupled], [coupled, 1.0]]) * 1e-110
    _, slip, multiplier = solved([[1e200, 1.0], [1e-9, 1e-9]], [1.0, 1.0], (1e-6,) * 4, k)
    assert np.isinf(slip[0]).any() and np.isnan(multiplier[0])  # mu times it is 1e304
    assert multiplier[1] == 0.0


@KERNELS
def test_the_arrays_of_an_earlier_solution_are_used_again(fast: bool) -> None:
    if fast:
        pytest.importorskip("numba")
    rng = np.random.default_rng(6)
    steps = [increment(duhem.load("antoni2007"), rng.normal(size=(3000, 2)), -rng.uniform(0.1, 9.0, 3000), 2.0, FIGURE_5) for _ in range(2)]
    room = closed_form.solve(steps[0], ClosedFormOptions(compiled=fast))
    again = closed_form.solve(steps[1], ClosedFormOptions(compiled=fast, into=room))
    anew = closed_form.solve(steps[1], ClosedFormOptions(compiled=fast))
    assert again is room
    for name in ("stress", "slip", "multiplier", "failed"):
        assert (getattr(again, name) == getattr(anew, name)).all()
    with pytest.raises(InputError, match=r"stress of into has shape \(3000, 2\)"):
        closed_form.solve(increment(duhem.load("antoni2007"), rng.normal(size=(5, 2)), -1.0, 2.0, FIGURE_5), ClosedFormOptions(into=room))
