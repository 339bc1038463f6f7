"""Closest points at apexes whose sides are bent, at tips in the origin, and where a formula is 0/0."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection import newton
from duhem.projection.compiled_newton import plain_closest
from duhem.projection.increment import increment
from duhem.projection.residuals import residuals
from duhem.projection.result import ACCURACY, Solution
from tests.long import long_but, mostly_long

HYDROSTATIC = np.ones(3)
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
ROUSSELIER = 1099 / 2000 * np.log(2000 / 901)  # D s1 f exp(p/((1 - f) s1)) = R, at f = 901/2000 and else 1

# law, its parameters, where on the hydrostatic axis it ends, and how far from the axis its slips there may go
APEXES = [
    ("rousselier", {"f": "901/2000", "D": 1, "s1": 1, "R": 1}, ROUSSELIER, 0.2),
    ("bresler-pister", {"a": 1, "b": 1, "c": -1, "fc": 1}, GOLDEN, 0.05),
    ("bresler-pister", {"a": 1, "b": 1, "c": -1, "fc": 1}, -1.0 - GOLDEN, 0.05),
    ("willam-warnke", {}, 5.0 / 3.0, 0.1),
    ("abaqus-linear", {}, 10.0 / 7.0, 0.2),
    ("bigoni-piccolroaz", {}, 0.1, 0.0),
    ("bigoni-piccolroaz", {}, -1.0, 0.0),
]


def trials(apex: float, wide: float) -> np.ndarray:
    """Stresses beyond the apex, at most ``wide`` off the axis, on it first."""
    rng = np.random.default_rng(0)
    off = rng.standard_normal((12, 3))
    off -= off.mean(axis=1, keepdims=True)
    off *= wide / np.linalg.norm(off, axis=1, keepdims=True)
    off[:2] = 0.0
    far = np.array([1.0, 1e-3, *np.geomspace(1e-2, 1e3, 10)])[:, None]
    return apex * HYDROSTATIC + far * (np.sign(apex) * HYDROSTATIC + off)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values", "apex", "wide"), long_but([1, 2, 4, 6], APEXES))
def test_bent_sides_meet_in_an_apex(name: str, values: dict, apex: float, wide: float) -> None:
    law = duhem.load(name).fix(values)
    asked = trials(apex, wide)
    found = newton.solve(increment(law, asked, None, 1.0, None))
    assert not found.failed.any()
    off = np.abs(found.stress - apex).max(axis=1)
    assert (off <= 1e-8 * (1.0 + np.abs(asked).max(axis=1) * 1e-4)).all(), off
    np.testing.assert_allclose(found.slip, asked - apex, rtol=1e-6, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ottosen", "abaqus-linear", "argyris", "bigoni-piccolroaz", "van-eekelen", "willam-warnke-tensor"])
def test_on_the_hydrostatic_axis_a_stress_inside_stays(name: str) -> None:
    law = duhem.load(name)
    law = law.fix({p: 1 if p in "ak" else "4/5" for p, domain in law.parameters.items() if domain.value is None})
    on = np.array([0.0] * len(law.forces))
    on[:3] = 1.0
    asked = np.array([-0.09, 0.0, 0.05])[:, None] * on
    found = newton.solve(increment(law, asked, None, 1.0, None))
    assert not found.failed.any()
    np.testing.assert_array_equal(found.stress, asked)
    assert not found.slip.any()


@pytest.mark.parametrize(
    ("name", "values", "trial"),
    [
        ("sap", {"mu": 1}, [[-0.574, -0.065, -0.877], [0.1, 0.2, -3.0], [1e-9, 0.0, -1.0]]),
        ("dafalias-manzari", {"alpha": 0, "m": "1/2"}, [[-1.0, 0.2], [-3.0, -1.0]]),
        ("teardrop", {}, [[1.0, 0.5], [0.7, 1.1]]),
    ],
)
def test_a_tip_in_the_origin_is_met_exactly(name: str, values: dict, trial: list[list[float]]) -> None:
    law = duhem.load(name).fix(values)
    found = newton.solve(increment(law, trial, None, 1.0, None))
    assert not found.failed.any()
    assert not found.stress.any()


def _clay(p: float, sign: float) -> np.ndarray:
    """s-clay1 of M = 1, alpha = 1/2, pm = 1, by its parameter."""
    return np.array([p, 0.5 * p + sign * np.sqrt(0.75 * max(p * (1.0 - p), 0.0))])


def _teardrop(p: float, sign: float) -> np.ndarray:
    return p * np.array([1.0, 1.0]) + sign * p * np.sqrt(max(1.0 + p, 0.0)) * np.array([1.0, -1.0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "curve", "ends"),
    [
        ("s-clay1", {"M": 1, "alpha": "1/2", "pm": 1}, _clay, (0.0, 1.0)),
        ("teardrop", {}, _teardrop, (-1.0, 0.0)),
    ],
)
def test_a_ray_from_a_boundary_origin_that_misses_the_set(name: str, values: dict, curve, ends: tuple[float, float]) -> None:
    """Where powers of tiny stresses vanish it seems to enter; the closest point is that of the curve, searched along it."""
    law = duhem.load(name).fix(values)
    angle = np.linspace(0.1, 2.0 * np.pi, 17)
    trial = 3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = newton.solve(increment(law, trial, None, 1.0, None))
    assert not found.failed.any()
    for at, stress in zip(trial, found.stress, strict=True):
        nearest = np.inf
        for sign in (1.0, -1.0):
            grid = np.linspace(*ends, 400)
            rough = grid[np.argmin([np.linalg.norm(curve(p, sign) - at) for p in grid])]
            low, high = max(rough - 0.01, ends[0]), min(rough + 0.01, ends[1])
            best = minimize_scalar(
                lambda p, s=sign, t=at: np.linalg.norm(curve(p, s) - t), bounds=(low, high), method="bounded", options={"xatol": 1e-12}
            )
            nearest = min(nearest, best.fun, *(np.linalg.norm(curve(p, sign) - at) for p in (*ends, rough)))
        assert np.linalg.norm(stress - at) == pytest.approx(nearest, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(["ottosen", "abaqus-linear", "bigoni-piccolroaz"], "ottosen", "abaqus-linear"))
def test_a_stress_inside_that_has_no_angle_is_vouched_for(name: str) -> None:
    law = duhem.load(name)
    done = duhem.project(law, np.array([-0.09, 0.0, 0.05])[:, None] * HYDROSTATIC)
    assert (done.status == duhem.Status.STICK).all()
    path = duhem.Path.linear([[0, 0, 0], [-0.05, -0.05, -0.05], [0.01, 0, 0]])
    assert np.isfinite(duhem.simulate(law, path, stiffness=1.0).stress).all()  # from no stress at all


@pytest.mark.long
def test_a_cone_about_the_hydrostatic_axis_in_six_stresses_is_that_of_its_principal_stresses():
    """It fills too little of six dimensions to be met by chance."""
    six = duhem.Criterion(
        name="x", g="max(-principal(s, 3), I1(s)**3 - 60*det(s))", stress={"name": "s", "kind": "3d"}, pressure=None
    )  # fmt: skip
    principal = np.array([[-0.877, -0.191, 0.911], [0.176, 0.718, 2.629]])
    q, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))
    tensors = [(q * p) @ q.T for p in principal]
    done = duhem.project(six, [[t[0, 0], t[1, 1], t[2, 2], t[1, 2], t[0, 2], t[0, 1]] for t in tensors])
    assert (done.status == duhem.Status.SLIP).all()
    found = [np.linalg.eigvalsh([[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]]) for s in done.stress]
    known = duhem.project("lade-duncan", principal, parameters={"k1": 60}).stress
    np.testing.assert_allclose(found, np.sort(known, axis=1), atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("formula", "apex", "pull"),
    [
        pytest.param("norm(sigma_a, sigma_b) - sigma_c", 0.0, (1.0, 1.0), marks=pytest.mark.long),
        ("norm(2*sigma_a, sigma_b) - sigma_c", 0.0, (2.0, 1.0)),
        pytest.param("norm(sigma_a, sigma_b) - sigma_c - 3", -3.0, (1.0, 1.0), marks=pytest.mark.long),
    ],
)
def test_slips_of_a_round_apex_are_told_from_those_beside(formula: str, apex: float, pull: tuple[float, float]) -> None:
    """The normal cone is round: six normals of it span some slips alone, and what is a little outside is none."""
    law = Criterion("round", formula, forces=("sigma_a", "sigma_b", "sigma_c"), pressure=None)
    angle = np.linspace(0.1, 6.3, 3)
    around = np.stack([pull[0] * np.cos(angle), pull[1] * np.sin(angle)], axis=1)
    for share, told in ((0.999, True), (0.6, True), (1.0 + 1e-5, False), (1.3, False)):
        slip = 0.7 * np.hstack([share * around, np.full((len(angle), 1), -1.0)])
        stress = np.tile([0.0, 0.0, apex], (len(angle), 1))
        asked = increment(law, stress + slip, None, 1.0, None)
        right = Solution(stress, asked.trial - stress, np.full(len(angle), 0.7), np.zeros(len(angle), dtype=bool))
        assert ((residuals(asked, right, convex=True).worst() <= ACCURACY) == told).all()
        wrong = replace(right, multiplier=np.full(len(angle), 0.71))
        assert not (residuals(asked, wrong, convex=True).worst() <= ACCURACY).any()


ANGLED = Criterion("angled", "norm(sigma_a, sigma_b)*(1 + cos(2*atan2(sigma_b, sigma_a))/10) + 3/10*sigma_n")


@pytest.mark.slow
@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.long)])
def test_a_law_that_takes_an_angle_has_its_limit_at_no_stress(compiled: bool) -> None:
    done = duhem.project(ANGLED, [[0.0, 0.0], [1e-300, 0.0], [0.1, 0.0], [1.0, 0.3]], -1.0, method="newton", compiled=compiled)
    assert done.status.tolist() == [duhem.Status.STICK] * 3 + [duhem.Status.SLIP]
    assert done.stress[:3].tolist() == [[0.0, 0.0], [1e-300, 0.0], [0.1, 0.0]]
    loop = duhem.Path.circle(0.5, points=9, pressure=-1.0)
    end = duhem.simulate(ANGLED, loop, stiffness=1.0, compiled=compiled).stress[-1]
    radius, angle = np.hypot(*end), np.arctan2(end[1], end[0])
    assert radius * (1.0 + np.cos(2.0 * angle) / 10.0) == pytest.approx(0.3, rel=1e-14)


@pytest.mark.parametrize("stiffness", [(1.0, 1.0), (1.0, 10.0), (10.0, 1.0)])
def test_beside_a_tip_of_a_saddle_the_loop_finds_no_normal_that_is_none(stiffness: tuple[float, float]) -> None:
    """Rothrock's teardrop is a piece of x^2 - y^2 <= 0 beside its tip, where that has every direction for a gradient."""
    law, k = duhem.load("teardrop"), np.diag(stiffness)
    rng = np.random.default_rng(0)
    across = rng.uniform(-1.0, 1.0, (120, 2)) * [1.0, 1e-2]  # slips to one side and to the other, and close to the edges of K there
    asked = np.vstack([across, across[:, ::-1], rng.standard_normal((120, 2))]) * 10.0 ** rng.uniform(-1.0, 1.0, (360, 1)) @ k
    closest = plain_closest(increment(law, asked, None, k, None))
    assert closest is not None
    size = np.linspace(-2.0, 0.0, 4001)  # s1 + s2, to which each side of K has its difference
    aside = -size / 2.0 * np.sqrt(1.0 + size / 2.0)
    inside = np.vstack([np.column_stack([size / 2.0 + sign * aside, size / 2.0 - sign * aside]) for sign in (-1.0, 1.0)])
    tips = unknown = 0
    for trial in asked.tolist():
        if (found := closest(trial, 0.0)) is None:
            unknown += 1
            continue
        stress, slip = np.array(found[0]), np.array(found[1])
        assert ((inside - stress) @ slip).max() <= 1e-7 * np.linalg.norm(slip)
        tips += not stress.any()
    assert tips > 40 and unknown <= 4


MANY = [
    ("dimaggio-sandler", [0.3268697183801355] * 3, 0.1634348591900677 * HYDROSTATIC, 0.3),
    ("abaqus-linear", [4.368044, -1.206235, 6.988313], 10.0 / 7.0 * HYDROSTATIC, 0.3),
    ("menetrey-willam", [0.456368668689227, 0.12212576675334176, 0.9960409467762611], 0.09842009842009841 * HYDROSTATIC, 0.0),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "trial", "apex", "coupled"), MANY)
def test_many_points_are_answered_as_few_are(name: str, trial: list[float], apex: np.ndarray, coupled: float) -> None:
    """What arrays refuse is asked one by one; a half-space beside a point without a normal cuts nothing off K."""
    k = np.diag([1.0, np.sqrt(10.0), 10.0]) + coupled * (np.ones((3, 3)) - np.eye(3))
    for count in (1, 40):
        done = duhem.project(name, np.tile(trial, (count, 1)), stiffness=k)
        assert (done.status == 1).all() and done.stress == pytest.approx(np.tile(apex, (count, 1)), abs=2e-12)


@pytest.mark.slow
def test_a_step_beyond_the_range_of_a_logarithm_is_shortened_by_plain_numbers_too() -> None:
    trial, k = [0.12044543089953348, 0.05475643510808636, -0.18543492319957428], np.diag([1.0, np.sqrt(10.0), 10.0])
    end = [0.05319067738847348, -0.04889797152620212, -0.15497757307562732]  # in many digits
    for count in (1, 40):
        done = duhem.project("original-cam-clay", np.tile(trial, (count, 1)), stiffness=k)
        assert (done.status == 1).all() and done.stress == pytest.approx(np.tile(end, (count, 1)), abs=1e-15)
