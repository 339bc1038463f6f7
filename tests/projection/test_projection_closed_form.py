"""Closed forms of the slip increment, against 160 digits, theory's reference values, and the laws' own formulas."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable, Iterator
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.errors import InputError, MissingExtraError
from duhem.expression import mpmath_
from duhem.law import catalogue
from duhem.law.formula_law import Criterion, Domain
from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.projection import Status, closed_form, compiled, quadrants
from duhem.projection.quadrants import BLOCK, Quarters
from duhem.projection.validation import increment
from tests.oracles.projection import Exact, closest

EPS = 2.0**-52
FIGURE_5 = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
MU = tuple(FIGURE_5.values())
WITH_SHAPE = [name for name in catalogue.names() if getattr(duhem.load(name), "closed_form", None) is not None]
VALUES = {"mu_a": "0.3", "mu_b": "0.2", "shift": "0.1", "tau_max": "0.4", "c": "0.7", "cohesion": "0.5", "mu": "0.25"}


@pytest.fixture(autouse=True)
def many_digits() -> Iterator[None]:
    with mpmath.workdps(160):
        yield


def values(law: Criterion) -> dict[str, str]:
    """Unlike values for the parameters of a built-in law."""
    return {name: VALUES.get(name, str(sp.Rational(2 + i, 10))) for i, name in enumerate(law.parameters)}


# -- declarations ----------------------------------------------------------------------------------------------------


def test_laws_that_declare_a_shape() -> None:
    expected = {"antoni2007", "antoni2007-1d", "capped", "cohesive", "coulomb", "orthotropic", "regularised", "shifted-ellipse"}
    assert set(WITH_SHAPE) == expected


@pytest.mark.parametrize("name", WITH_SHAPE)
def test_declared_boundary_is_where_g_vanishes_and_declared_slope_is_its(name: str) -> None:
    """g = 0 at gauge 1, and g grows by slope times the gauge's own size, at random boundary points and pressures."""
    law = duhem.load(name)
    assert law.closed_form is not None
    table = law.symbols()
    rng = np.random.default_rng(7)
    for pressure in (-0.3, -1.0, -7.5):
        known = {table[p]: v for p, v in values(law).items()} | {table["sigma_n"]: pressure}

        def at(entry: Any, known: dict[Any, Any] = known) -> Any:
            return mpmath_.evaluate(sp.sympify(entry), known, dps=40)

        def g(point: list[Any], known: dict[Any, Any] = known) -> Any:
            forces = dict(zip(law.force_symbols(), point, strict=True))
            return mpmath_.evaluate(law.g, known | forces, dps=40)

        for point, growth in _boundary(law.closed_form, at, rng):
            assert abs(g(point(1))) < 1e-35
            h = mpmath.mpf(10) ** -15
            rise = (g(point(1 + h)) - g(point(1 - h))) / (2 * h)
            assert abs(rise - growth * at(law.closed_form.slope)) < 1e-12


def _boundary(shape: Any, at: Any, rng: np.random.Generator) -> list[tuple[Any, Any]]:
    """Points by share of the way from the centre, with how fast the shape's gauge grows with that share."""
    load = at(shape.load)
    if isinstance(shape, Interval):
        return [(lambda s: [s * at(shape.plus) * load], load), (lambda s: [-s * at(shape.minus) * load], load)]
    found = []
    for angle in rng.uniform(0.0, 2 * np.pi, 12):
        cos, sin = mpmath.mpf(float(np.cos(angle))), mpmath.mpf(float(np.sin(angle)))
        norm = mpmath.sqrt(cos**2 + sin**2)
        if isinstance(shape, Disk):
            a = b = at(shape.coefficient)
            centre, growth = (0, 0), a * load
        else:
            a, b = at(shape.a_plus if cos > 0 else shape.a_minus), at(shape.b_plus if sin > 0 else shape.b_minus)
            centre, growth = (at(shape.centre_a), at(shape.centre_b)), load
        ray = (a * load * cos / norm, b * load * sin / norm)
        found.append((lambda s, r=ray, c=centre: [c[0] + s * r[0], c[1] + s * r[1]], growth))
    return found


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


@pytest.fixture(params=["numpy", "numba"])
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


def off(x: float, exact: Any) -> float:
    """Relative error in units of eps."""
    if exact == 0:
        return 0.0 if x == 0 else float("inf")
    return float(abs(mpmath.mpf(float(x)) / exact - 1)) / EPS


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
    return [closest(t, e, mu, k) for t, e in zip(trial.tolist(), load.tolist(), strict=True)]


@pytest.mark.parametrize("seed", range(60))
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


@pytest.mark.parametrize("seed", range(30))
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


# -- extreme values --------------------------------------------------------------------------------------------------

TINY = 5e-324


@pytest.mark.parametrize(
    ("trial", "pressure", "k"),
    [
        ((1e200, 2.0), -1e-300, 1.0),
        ((1e200, -3e200), -1.0, 1.0),
        ((1e16, 1.0), -1.0, (1.0, 1e12)),
        ((1.0, 2.0), -1.0, 1e300),
        ((1e300, 2e300), -1e300, 1e300),
        ((1e308, 1e308), -1e308, 1.0),
        ((1e308, 1e308), -1.0, 1.0),
        ((1.0, 2.0), -1e-12, 1.0),
        ((1.0, 2.0), -1.0, 1e-300),
    ],
)
def test_extremes(trial: tuple[float, float], pressure: float, k: Any) -> None:
    done = duhem.project("antoni2007", trial, pressure, k, FIGURE_5)
    answer = closest(trial, -pressure, MU, np.diag(np.broadcast_to(k, 2)))
    assert done.status[0] == Status.SLIP
    for i in (0, 1):
        if abs(answer.stress[i]) > 1e-307:
            assert off(done.stress[0, i], answer.stress[i]) <= 8
        if abs(answer.slip[i]) > 1e-307:
            assert off(done.slip[0, i], answer.slip[i]) <= 16


def test_no_pressure_leaves_no_stress() -> None:
    done = duhem.project("antoni2007", [[1.0, -2.0], [0.0, 0.0]], 0.0, [2.0, 4.0], FIGURE_5)
    assert done.stress.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert np.allclose(done.slip, [[0.5, -0.5], [0.0, 0.0]], rtol=1e-15, atol=0)
    assert done.multiplier[0] == pytest.approx(np.hypot(0.2 * 0.5, 0.15 * 0.5), rel=1e-15)
    assert done.status.tolist() == [Status.SLIP, Status.STICK]


def test_denormal_trials_stick_under_pressure() -> None:
    done = duhem.project("antoni2007", [[TINY, TINY], [TINY, -TINY]], -1.0, parameters=FIGURE_5)
    assert done.status.tolist() == [Status.STICK] * 2


@pytest.mark.parametrize("name", ["coulomb", "capped", "cohesive", "regularised", "orthotropic", "shifted-ellipse"])
@pytest.mark.parametrize("k", [1.0, [1.0, 30.0], [[2.0, 1.0], [1.0, 3.0]]], ids=["isotropic", "diagonal", "full"])
def test_every_plane_law_is_optimal_to_rounding(name: str, k: Any) -> None:
    law = duhem.load(name)
    rng = np.random.default_rng(3)
    trial, pressure = rng.normal(size=(500, 2)) * 10 ** rng.uniform(-2, 2, (500, 1)), -(10 ** rng.uniform(-1.5, 1, 500))
    done = duhem.project(law, trial, pressure, k, values(law))
    assert set(done.status) == {Status.STICK, Status.SLIP}
    assert done.residuals.worst().max() <= (2e-14 if name == "regularised" else 4e-15)  # its g takes the difference of what c adds
    again = duhem.project(law, done.stress, pressure, k, values(law))
    assert np.abs(again.stress - done.stress).max() <= 1e-14 * np.abs(done.stress).max()


def test_interval() -> None:
    at = {"mu_plus": 0.25, "mu_minus": 0.5}
    trial = np.array([[0.25], [np.nextafter(0.25, 1)], [1.0], [-0.5], [-2.0], [0.0]])
    done = duhem.project("antoni2007-1d", trial, -1.0, 2.0, at)
    assert done.stress[:, 0].tolist() == [0.25, 0.25, 0.25, -0.5, -0.5, 0.0]
    assert done.slip[:, 0].tolist() == [0.0, (trial[1, 0] - 0.25) / 2, 0.375, 0.0, -0.75, 0.0]
    assert done.multiplier.tolist() == pytest.approx([0.0, 0.25 * (trial[1, 0] - 0.25) / 2, 0.25 * 0.375, 0.0, 0.5 * 0.75, 0.0], rel=1e-15)


def test_the_plane_law_on_an_axis_is_the_law_along_a_line() -> None:
    along = np.linspace(-1.0, 1.0, 41)
    plane = duhem.project("antoni2007", np.stack([along, 0 * along], axis=1), -1.3, 2.0, FIGURE_5)
    line = duhem.project("antoni2007-1d", along[:, None], -1.3, 2.0, {"mu_plus": 0.2, "mu_minus": 0.08})
    assert np.allclose(plane.stress[:, 0], line.stress[:, 0], rtol=1e-15, atol=0)
    assert np.allclose(plane.slip[:, 0], line.slip[:, 0], rtol=1e-14, atol=0)
    assert np.allclose(plane.multiplier, line.multiplier, rtol=1e-14, atol=0)


def test_zero_coefficients() -> None:
    """Where the domain lets a coefficient be zero, K has no width there."""
    g = "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"
    law = Criterion("maybe-smooth", g, {"mu": Domain.between(0, 1)}, closed_form=Disk("mu"))
    done = duhem.project(law, [[3.0, 4.0]], -1.0, 2.0, {"mu": 0})
    assert done.stress.tolist() == [[0.0, 0.0]]
    assert done.slip.tolist() == [[1.5, 2.0]]
    assert done.multiplier[0] == pytest.approx(2.5, rel=1e-15)
    assert done.status[0] == Status.SLIP


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
    compiled.kernel.cache_clear()
    with pytest.raises(MissingExtraError, match=r'pip install "duhem\[fast\]"'):
        duhem.project("antoni2007", [0.3, 0.2], -1.0, parameters=FIGURE_5, compiled=True)


@pytest.mark.parametrize("name", WITH_SHAPE)
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


@pytest.mark.parametrize("fast", [False, True], ids=["numpy", "numba"])
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


@pytest.mark.parametrize("fast", [False, True], ids=["numpy", "numba"])
def test_the_arrays_of_an_earlier_solution_are_used_again(fast: bool) -> None:
    if fast:
        pytest.importorskip("numba")
    rng = np.random.default_rng(6)
    steps = [increment(duhem.load("antoni2007"), rng.normal(size=(3000, 2)), -rng.uniform(0.1, 9.0, 3000), 2.0, FIGURE_5) for _ in range(2)]
    room = closed_form.solve(steps[0], compiled=fast)
    again = closed_form.solve(steps[1], compiled=fast, into=room)
    anew = closed_form.solve(steps[1], compiled=fast)
    assert again is room
    for name in ("stress", "slip", "multiplier", "failed"):
        assert (getattr(again, name) == getattr(anew, name)).all()
    with pytest.raises(InputError, match=r"stress of into has shape \(3000, 2\)"):
        closed_form.solve(increment(duhem.load("antoni2007"), rng.normal(size=(5, 2)), -1.0, 2.0, FIGURE_5), into=room)


# -- tangents --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("k", [np.eye(2), np.diag([1.0, 7.0]), np.array([[2.0, 1.0], [1.0, 3.0]])], ids=["isotropic", "diagonal", "full"])
def test_tangents_are_derivatives_of_the_exact_step(k: np.ndarray) -> None:
    rng = np.random.default_rng(11)
    trial, load = rng.normal(size=(25, 2)), rng.uniform(0.1, 3.0, 25)
    done = duhem.project("antoni2007", trial, -load, k, FIGURE_5, tangent=True)
    assert done.tangent is not None and done.tangent_pressure is not None
    h = mpmath.mpf(10) ** -25
    for n in np.flatnonzero(done.status == Status.SLIP):
        t, e = [mpmath.mpf(x) for x in trial[n].tolist()], mpmath.mpf(float(load[n]))
        expected = np.empty((2, 3))
        for j in range(2):
            moved = [[t[i] + s * h * mpmath.mpf(float(k[i, j])) for i in (0, 1)] for s in (1, -1)]
            expected[:, j] = _difference(closest(moved[0], e, MU, k), closest(moved[1], e, MU, k), h)
        expected[:, 2] = _difference(closest(t, e - h, MU, k), closest(t, e + h, MU, k), h)  # sigma_n = -e
        got = np.column_stack([done.tangent[n], done.tangent_pressure[n]])
        assert np.abs(got - expected).max() <= 1e-13 * np.abs(expected).max()


def _difference(after: Exact, before: Exact, h: Any) -> list[float]:
    return [float((after.stress[i] - before.stress[i]) / (2 * h)) for i in (0, 1)]


@pytest.mark.parametrize("name", WITH_SHAPE)
def test_tangents_are_symmetric_within_zero_and_k_and_match_differences(name: str) -> None:
    law = duhem.load(name)
    d = len(law.forces)
    k = np.array([[2.0, 0.6], [0.6, 1.5]]) if d == 2 else np.array([[2.0]])
    rng = np.random.default_rng(12)
    trial, pressure = rng.normal(size=(200, d)) * 0.7, -rng.uniform(0.3, 1.5, 200)
    done = duhem.project(law, trial, pressure, k, values(law), tangent=True)
    assert done.tangent is not None and done.tangent_pressure is not None
    assert np.array_equal(done.tangent, np.swapaxes(done.tangent, 1, 2))
    root = np.linalg.inv(np.linalg.cholesky(k))
    shares = np.linalg.eigvalsh(root @ done.tangent @ root.T)
    assert shares.min() >= -1e-14 and shares.max() <= 1 + 1e-14
    assert {bool((t == k).all()) for t in done.tangent} == {True, False}
    h = 1e-6

    def stress(u: np.ndarray, p: np.ndarray) -> np.ndarray:
        return duhem.project(law, trial + u @ k, pressure + p, k, values(law)).stress

    zero = np.zeros(1)
    columns = [(stress(h * v, zero) - stress(-h * v, zero)) / (2 * h) for v in np.eye(d)]
    columns.append((stress(np.zeros(d), zero + h) - stress(np.zeros(d), zero - h)) / (2 * h))
    got = np.concatenate([done.tangent, done.tangent_pressure[:, :, None]], axis=2)
    wrong = np.abs(np.stack(columns, axis=2) - got).max(axis=(1, 2))
    assert np.quantile(wrong, 0.97) <= 1e-6  # all but what crosses from stick to slip or over a kink within h


def test_quadrants_and_disk_agree() -> None:
    g = "norm(sigma_a/mu, sigma_b/mu) - abs(sigma_n)"
    law = Criterion("as-ellipse", g, {"mu": Domain.fixed("0.3")}, closed_form=Quadrants("mu", "mu", "mu", "mu"))
    trial = np.random.default_rng(2).normal(size=(100, 2))
    ellipse, disk = duhem.project(law, trial, -1.0, [1.0, 5.0]), duhem.project("coulomb", trial, -1.0, [1.0, 5.0], {"mu": "0.3"})
    assert np.allclose(ellipse.stress, disk.stress, rtol=1e-15, atol=0)
    assert np.allclose(0.3 * disk.multiplier, ellipse.multiplier, rtol=1e-14, atol=0)
