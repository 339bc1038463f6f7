"""The generic projector against closed forms, brute force, high precision and its own optimality conditions."""

from __future__ import annotations

from itertools import cycle, pairwise

import mpmath as mp
import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection import newton
from duhem.projection.half_spaces import HalfSpaces
from duhem.projection.result import Status
from duhem.projection.whitened_body import lineality
from tests.campaigns.yield_surfaces import YIELD, campaign
from tests.long import long_but, mostly_long
from tests.oracles.optimality import ANTONI, CONVEX, R, increment, radii, shortfall, stiffnesses

STIFFNESSES = ("unit", "diagonal", "full")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "values", "kind"),
    mostly_long(
        [(*law, kind) for law in CONVEX for kind in STIFFNESSES],
        *[(*law, kind) for law, kind in zip(CONVEX, cycle(STIFFNESSES), strict=False)][::2],
    ),
    ids=lambda x: x if isinstance(x, str) else "-".join(str(v) for v in x.values()),
)
def test_every_convex_law_from_near_and_far(law, values, kind):
    rng = np.random.default_rng(5)
    d, n = len(duhem.load(law).forces), 30
    directions = rng.standard_normal((n, d))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reach = radii(increment(law, directions, -1.0, **values), directions)
    away = 10.0 ** rng.uniform(-7, 6, n)
    trial = directions * (np.where(np.isinf(reach), 1.0, reach) * (1 + away))[:, None]
    question = increment(law, trial, -1.0, stiffnesses(d, rng)[kind], **values)
    got = newton.solve(question)
    assert not got.failed.any()
    assert (got.multiplier >= 0).all() and (got.multiplier > 0).sum() > n / 2
    on = directions[np.isfinite(reach)] * reach[np.isfinite(reach), None]
    far = np.abs(got.stress).max(axis=1)
    # Rounding of a stress far along a K without an end, as of metals in principal stresses, turns the normal that the slip is made of.
    endless = np.isinf(radii(increment(law, np.ones((1, d)), -1.0, **values), np.ones((1, d)))).any()
    turned = np.finfo(float).eps * far.max() / reach.min() if endless else 0.0
    assert shortfall(question, got, on) < max(1e-11, turned)
    excess = radii(question, got.stress) - 1  # the stress lies on the boundary: its own ray ends there
    small = (got.multiplier > 0) & (far < 10)
    assert np.abs(excess[small]).max() < 1e-11


@pytest.mark.parametrize(
    ("trial", "stiffness", "stress"),
    [
        ((0.3, 0.2), (1.0, 1.0), (0.16948295870263982786, 0.063711769834024715701)),
        ((-0.3, 0.2), (1.0, 1.0), (-0.0626859952990218239, 0.074555673728327216011)),
        ((-0.3, -0.2), (1.0, 4.0), (-0.076140510365716901921, -0.046028201830649999767)),
    ],
)
def test_reference_values(trial, stiffness, stress):
    got = newton.solve(increment("antoni2007", trial, -1.0, stiffness, **ANTONI))
    np.testing.assert_allclose(got.stress[0], stress, rtol=1e-14)


@pytest.mark.slow
def test_quarter_ellipses_against_a_scalar_root_in_high_precision():
    rng = np.random.default_rng(2)
    trial, k = rng.standard_normal((30, 2)), (1.0, 7.0)
    got = newton.solve(increment("antoni2007", trial, -1.0, k, **ANTONI))
    with mp.workdps(40):
        for t, stress, slip, multiplier in zip(trial, got.stress, got.slip, got.multiplier, strict=True):
            mu = [ANTONI[f"mu_{i}_{'plus' if x >= 0 else 'minus'}"] for i, x in zip("ab", t, strict=True)]
            c = [mp.mpf(ki) / (mp.mpf(int(m.p)) / int(m.q)) ** 2 for ki, m in zip(k, mu, strict=True)]
            y = [mp.mpf(x) * int(m.q) / int(m.p) for x, m in zip(t, mu, strict=True)]

            z = mp.mpf(0)
            for _ in range(200):  # Newton from the left of a convex, decreasing function is monotone
                f = sum((yi / (1 + ci * z)) ** 2 for yi, ci in zip(y, c, strict=True)) - 1
                z += f / sum(2 * ci * yi**2 / (1 + ci * z) ** 3 for yi, ci in zip(y, c, strict=True))
            assert z > 0 and abs(f) < mp.mpf(10) ** -35
            exact = [mp.mpf(x) / (1 + ci * z) for x, ci in zip(t, c, strict=True)]
            for i in range(2):
                assert abs(stress[i] - exact[i]) < 1e-15
                assert abs(slip[i] - (mp.mpf(t[i]) - exact[i]) / k[i]) < 1e-14
            assert abs(multiplier - z) < 1e-14


def by_bisection(low, high, rises):
    """Where ``rises`` turns false, in 50 digits."""
    low, high = mp.mpf(low), mp.mpf(high)
    for _ in range(190):
        middle = (low + high) / 2
        low, high = (middle, high) if rises(middle) else (low, middle)
    return low


def on_superellipse(trial, k, mu, p):
    """The closest point from the curve alone: |sigma_i|/mu_i = shares^(1/p), the shares a logistic function of one number."""

    def at(s):
        a, b = 1 / (1 + mp.exp(s)), 1 / (1 + mp.exp(-s))
        return (mu[0] * a ** (1 / p), mu[1] * b ** (1 / p)), (-mu[0] * a ** (1 / p) * b, mu[1] * b ** (1 / p) * a)

    def nearer(s):
        return sum((abs(mp.mpf(t)) - x) / ki * dx for t, ki, x, dx in zip(trial, k, *at(s), strict=True)) > 0

    return [mp.sign(t) * x for t, x in zip(trial, at(by_bisection(-20000, 20000, nearer))[0], strict=True)]


def on_hosford(trial, limit, m):
    """The closest point for k = 1, by the angle in the plane without pressure."""
    trial = [mp.mpf(x) for x in trial]
    mean = sum(trial) / 3
    first = [x - mean for x in trial]
    second = [first[1] - first[2], first[2] - first[0], first[0] - first[1]]
    first, second = ([x / mp.norm(v) for x in v] for v in (first, second))

    def at(angle):
        u = [mp.cos(angle) * a + mp.sin(angle) * b for a, b in zip(first, second, strict=True)]
        parts = [u[0] - u[1], u[1] - u[2], u[2] - u[0]]
        w = [mp.sign(x) * abs(x) ** (m - 1) for x in parts]
        gauge = (sum(abs(x) ** m for x in parts) / 2) ** (1 / m)
        return [x * limit / gauge for x in u], [w[0] - w[2], w[1] - w[0], w[2] - w[1]]

    def turns(angle):
        stress, normal = at(angle)
        push = [t - mean - x for t, x in zip(trial, stress, strict=True)]
        (a, b), (c, d) = ([mp.fdot(v, e) for e in (first, second)] for v in (push, normal))
        return a * d - b * c < 0

    return [x + mean for x in at(by_bisection(-mp.pi / 2, mp.pi / 2, turns))[0]]


@pytest.mark.slow
@pytest.mark.parametrize("exponent", long_but([4], ["1.001", "1.01", "1.1", "4", "100"]))
def test_exponents_next_to_one_and_high_in_high_precision(exponent):
    """Bends sharper than the digits of a stress: right to rounding, and known to be right."""
    rng = np.random.default_rng(0)
    plane, space = (rng.standard_normal((10, d)) * 10 ** rng.uniform(-0.3, 2, 10)[:, None] for d in (2, 3))
    k = [1.0, 7.0]
    got = duhem.project("superellipse", plane, -1.0, k, {"mu_a": "1/4", "mu_b": "1/8", "p": exponent}, method="newton")
    there = duhem.project("hosford", space, None, 1.0, {"yield_stress": "1/4", "m": exponent}, method="newton")
    assert (got.status <= 1).all() and (there.status <= 1).all()
    with mp.workdps(50):
        p = mp.mpf(exponent)
        for trial, stress in zip(plane[got.status == 1], got.stress[got.status == 1], strict=True):
            exact = on_superellipse(trial, k, (mp.mpf(1) / 4, mp.mpf(1) / 8), p)
            # At a tip of exponent 1.1 the corner that bounds K there is as near to the trial, to rounding, as the bend 1e-13 of K away.
            assert max(abs(x - y) for x, y in zip(stress, exact, strict=True)) < (5e-14 if exponent == "1.1" else 2e-14)
            one, other = (
                mp.sqrt(sum((t - x) ** 2 / ki for t, x, ki in zip(map(mp.mpf, trial), s, k, strict=True))) for s in (stress, exact)
            )
            assert abs(one - other) < 2e-15 * max(1, other)
        for trial, stress in zip(space[there.status == 1], there.stress[there.status == 1], strict=True):
            exact = on_hosford(trial, mp.mpf(1) / 4, p)
            assert max(abs(x - y) for x, y in zip(stress, exact, strict=True)) < (2e-11 if p < 2 else 2e-13) * max(1.0, np.abs(trial).max())


def test_disk_by_radial_return_and_box_by_clamping():
    trial = np.random.default_rng(3).standard_normal((200, 2))
    got = newton.solve(increment("coulomb", trial, -1.0, mu=R(1, 2)))
    length = np.linalg.norm(trial, axis=1)
    np.testing.assert_allclose(got.stress, trial * np.minimum(1, 0.5 / length)[:, None], atol=4e-16)
    np.testing.assert_allclose(got.multiplier, np.maximum(length - 0.5, 0), atol=4e-16)
    got = newton.solve(increment("box", trial, -1.0, (1.0, 3.0), mu_a=R(1, 2), mu_b=R(1, 4)))
    clamped = np.clip(trial, [-0.5, -0.25], [0.5, 0.25])
    np.testing.assert_allclose(got.stress, clamped, rtol=4e-16)
    slip = (trial - clamped) / [1.0, 3.0]
    np.testing.assert_allclose(got.slip, slip, atol=1e-15)
    np.testing.assert_allclose(got.multiplier, np.abs(slip) @ [0.5, 0.25], atol=1e-15)  # g = |sigma_i|/mu_i: branch by branch


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["octahedron", "cube"])
def test_polytopes_in_six_forces(kind):
    names = tuple(f"s{i}" for i in range(6))
    parts = [f"abs({x})" for x in names]
    g = " + ".join(parts) if kind == "octahedron" else f"max({', '.join(parts)})"
    law = Criterion("solid", f"{g} - 1", forces=names, pressure=None)
    trial = np.random.default_rng(1).standard_normal((25, 6)) * 3
    got = newton.solve(increment(law, trial))
    assert not got.failed.any()
    for t, stress in zip(trial, got.stress, strict=True):
        sizes = np.sort(np.abs(t))[::-1]
        shifts = (np.cumsum(sizes) - 1) / np.arange(1, 7)
        shift = max(shifts.max(), 0.0)  # the projection onto the ball of the 1-norm shrinks every component by this
        exact = np.sign(t) * np.maximum(np.abs(t) - shift, 0) if kind == "octahedron" else np.clip(t, -1, 1)
        np.testing.assert_allclose(stress, exact, atol=2e-14)


def test_curved_edges_and_their_normal_cones():
    """Where two cylinders meet the stress is on both and the slip between their normals."""
    law = Criterion("edges", "max(norm(s1, s2), norm(s2, s3)) - 1", forces=("s1", "s2", "s3"), pressure=None)
    trial = np.array([[2.0, 0.3, 1.9], [3.0, -1.0, 2.5]])
    got = newton.solve(increment(law, trial))
    for stress, slip, multiplier in zip(got.stress, got.slip, got.multiplier, strict=True):
        assert abs(np.hypot(stress[0], stress[1]) - 1) < 1e-15 and abs(np.hypot(stress[1], stress[2]) - 1) < 1e-15
        first, third = slip[0] / stress[0], slip[2] / stress[2]  # multipliers of the two normals
        assert first > 0 and third > 0
        assert abs(slip[1] - (first + third) * stress[1]) < 1e-14
        assert abs(multiplier - first - third) < 1e-14
    np.testing.assert_allclose(got.stress + got.slip, trial, atol=1e-14)


def test_tip_of_a_cone():
    law = Criterion("cone", "norm(s1, s2) + s3 - 1", forces=("s1", "s2", "s3"), pressure=None)
    got = newton.solve(increment(law, [[0.3, -0.2, 5.0], [1.0, 2.0, 1e4]]))
    assert not got.failed.any()
    np.testing.assert_allclose(got.stress, [[0, 0, 1], [0, 0, 1]], atol=1e-15)


@pytest.mark.parametrize(
    ("g", "trial", "stress"),
    [
        ("s1 + 2*s2 - 1", [3.0, 4.0], [1.0, 0.0]),
        ("max(s1, s2)", [3.0, -2.0], [0.0, -2.0]),  # the origin is its corner
        ("max(s1, s2)", [3.0, 2.0], [0.0, 0.0]),
        ("abs(s1) - 1", [-3.0, 1e5], [-1.0, 1e5]),
        ("max(s1 + 5, abs(s2)) - 1", [0.0, 3.0], [-4.0, 1.0]),  # the origin is outside
    ],
)
def test_unbounded_sets_and_odd_origins(g, trial, stress):
    got = newton.solve(increment(Criterion("set", g, forces=("s1", "s2"), pressure=None), trial))
    assert not got.failed.any()
    np.testing.assert_allclose(got.stress[0], stress, atol=1e-13)


def test_inside_on_and_just_outside():
    trial = np.array([[0.0, 0.0], [0.1, -0.02], [0.2, 0.0], [np.nextafter(0.2, 1), 0.0], [0.2 * (1 + 1e-12), 0.0], [0.0, -0.15]])
    got = newton.solve(increment("antoni2007", trial, -1.0, **ANTONI))
    assert not got.failed.any()
    np.testing.assert_array_equal(got.stress[:3], trial[:3])
    assert (got.slip[:2] == 0).all() and (got.multiplier[:2] == 0).all()
    np.testing.assert_allclose(got.stress[3:5], [[0.2, 0.0]] * 2, rtol=4e-16)
    np.testing.assert_allclose(got.multiplier[4], 0.2 * 1e-12 * 0.2, rtol=1e-3)


def test_seams_of_the_flagship():
    trial = np.array([[0.5, 0.0], [0.5, 1e-18], [0.5, -1e-18], [0.0, 0.4], [-1e-300, -0.4]])
    got = newton.solve(increment("antoni2007", trial, -1.0, **ANTONI))
    np.testing.assert_allclose(got.stress, [[0.2, 0], [0.2, 0], [0.2, 0], [0, 0.12], [0, -0.15]], atol=1e-16)


def test_no_pressure_leaves_the_origin_alone():
    trial = np.array([[0.3, -0.4], [1e-3, 0.0]])
    got = newton.solve(increment("antoni2007", trial, 0.0, (2.0, 1.0), **ANTONI))
    assert not got.failed.any()
    np.testing.assert_array_equal(got.stress, 0.0)
    slip = trial / [2.0, 1.0]
    np.testing.assert_allclose(got.slip, slip, rtol=1e-15)
    mu = np.where(slip >= 0, [0.2, 0.12], [0.08, 0.15])
    np.testing.assert_allclose(got.multiplier, np.linalg.norm(mu * slip, axis=1), rtol=1e-8)  # the dissipation potential at |sigma_n| = 1


@pytest.mark.parametrize("away", [1e9, 1e12, 1e15])
def test_trials_very_far_away(away):
    trial = np.random.default_rng(4).standard_normal((20, 2)) * away
    got = newton.solve(increment("antoni2007", trial, -1.0, (2.0, 1.0), **ANTONI))
    assert not got.failed.any()
    slip = trial / [2.0, 1.0]  # so far away the stress maximises the dissipation of the slip
    mu = np.where(slip >= 0, [0.2, 0.12], [0.08, 0.15])
    force = mu * slip
    np.testing.assert_allclose(got.stress, mu * force / np.linalg.norm(force, axis=1)[:, None], atol=100 / away + 1e-13)
    np.testing.assert_allclose(got.multiplier, np.linalg.norm(force, axis=1), rtol=100 / away + 1e-14)


@pytest.mark.slow
def test_units_do_not_matter():
    trial = np.random.default_rng(4).standard_normal((50, 3))
    for law, values in (("hosford", {"m": R(100)}), ("drucker1949", {"c": R(9, 4)})):
        name = "k" if law == "drucker1949" else "yield_stress"
        here = newton.solve(increment(law, trial, **values, **{name: R(1, 4)}))
        assert not here.failed.any()
        for unit in (2.0**-100, 2.0**100):
            there = newton.solve(increment(law, trial * unit, **values, **{name: R(unit) / 4}))
            assert not there.failed.any()
            np.testing.assert_allclose(there.stress / unit, here.stress, atol=1e-13)


def test_bad_numbers_fail_alone():
    trial = np.array([[0.0, np.nan], [np.inf, 0.0], [3.0, 4.0], [0.1, 0.1]])
    got = newton.solve(increment("coulomb", trial, -1.0, mu=1))
    np.testing.assert_array_equal(got.failed, [True, True, False, False])
    np.testing.assert_allclose(got.stress[2:], [[0.6, 0.8], [0.1, 0.1]], rtol=1e-15)


def test_sets_that_are_not_convex_end_in_stationary_points_or_failures():
    law = Criterion("heart", "min(norm(s1 - 1, s2), norm(s1 + 1, s2)) - 1.2", forces=("s1", "s2"), pressure=None)
    trial = np.random.default_rng(0).standard_normal((100, 2)) * 3
    got = newton.solve(increment(law, trial))
    kept = ~got.failed & (got.multiplier > 0)
    assert kept.sum() > 50
    centre = np.where(got.stress[:, :1] > 0, [[1.0, 0.0]], [[-1.0, 0.0]])
    normal = (got.stress - centre)[kept] / 1.2
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(got.slip[kept], got.multiplier[kept, None] * normal, atol=1e-12)
    np.testing.assert_allclose((got.stress + got.slip)[kept], trial[kept], atol=1e-11)


@pytest.mark.slow
def test_a_set_without_points_and_one_of_a_single_point():
    empty = Criterion("empty", "norm(a, b) + 1", forces=("a", "b"), pressure=None)
    trials = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, -0.4]])
    assert (duhem.project(empty, trials, None, 1.0).status == Status.FAILED).all()
    point = Criterion("point", "norm(a - 1, b)", forces=("a", "b"), pressure=None)
    found = duhem.project(point, trials, None, 1.0)
    np.testing.assert_array_equal(found.stress, [[1.0, 0.0]] * 3)
    np.testing.assert_array_equal(found.slip, trials - [1.0, 0.0])


def test_projection_does_not_expand_and_is_its_own_fixed_point():
    rng = np.random.default_rng(6)
    trial = rng.standard_normal((60, 3))
    k = stiffnesses(3, rng)["diagonal"]
    once = newton.solve(increment("hosford", trial, 0.0, k, m=R(20), yield_stress=R(1, 2)))
    twice = newton.solve(increment("hosford", once.stress, 0.0, k, m=R(20), yield_stress=R(1, 2)))
    np.testing.assert_allclose(twice.stress, once.stress, atol=1e-14)
    metric = 1 / np.sqrt(np.diag(k))
    for i, j in pairwise(range(60)):
        assert np.linalg.norm((once.stress[i] - once.stress[j]) * metric) <= np.linalg.norm((trial[i] - trial[j]) * metric) * (1 + 1e-12)


def test_nearest_point_of_half_spaces_by_brute_force():
    rng = np.random.default_rng(9)
    normals = rng.standard_normal((5, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    start = rng.standard_normal((50, 3)) * 3
    nearest = HalfSpaces.around(start)
    everyone = np.arange(50)
    for normal in normals:
        nearest.add(everyone, nearest.free_slot(everyone), np.tile(normal, (50, 1)), np.ones(50))
    for s, u in zip(start, nearest.point, strict=True):
        assert (normals @ u <= 1 + 1e-13).all()
        best = np.inf
        for code in range(32):  # every set of active half-spaces
            chosen = normals[[bool(code >> i & 1) for i in range(5)]]
            v = s + np.linalg.pinv(chosen) @ (1 - chosen @ s) if len(chosen) else s
            if (normals @ v <= 1 + 1e-12).all():
                best = min(best, np.linalg.norm(s - v))
        assert abs(np.linalg.norm(s - u) - best) < 1e-12


def test_endless_directions():
    from duhem.projection.scaled_formula import scaled
    from duhem.projection.whitened_body import body

    def found(question):
        forces = question.law.force_symbols()
        return lineality(body(scaled(question.g, forces, None), forces, question.pressure, np.ones(1), np.eye(len(forces))))

    np.testing.assert_allclose(np.abs(found(increment("tresca", [[1.0, 0.0, 0.0]], yield_stress=1))), np.full((3, 1), 3**-0.5), atol=1e-12)
    ball = Criterion("ball", "norm(s1, s2) - 1", forces=("s1", "s2"), pressure=None)
    assert found(increment(ball, [[1.0, 0.0]])).shape == (2, 0)


@pytest.mark.slow
@pytest.mark.parametrize(("law", "values"), long_but([0, 2, 4], YIELD), ids=lambda x: x if isinstance(x, str) else str(x.get("m", "")))
@pytest.mark.parametrize("size", long_but([1], [5e-3, 5e-2]))
def test_yield_surfaces_without_a_failure(law, values, size):
    failures, worst, _ = campaign(law, values, size, 1000)
    assert failures == 0
    assert worst < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("slender", [1e-1, 1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("name", ["box", "superellipse"])
def test_a_slender_set_ends_at_its_short_sides_too(name: str, slender: float) -> None:
    """Few samples of a slender set meet its short sides: they must not be taken for missing."""
    trial = np.array([[1.001, 1e-4], [1.1, 0.5], [3.0, 0.1], [3.0, 2.0], [0.5, 2.0], [-1.0 - 1e-9, 0.0]]) * [1.0, slender]
    values = {"mu_a": 1.0, "mu_b": slender} | ({"p": 4} if name == "superellipse" else {})
    for order in (1, -1):  # the short side first, or last
        given = {"mu_a": values["mu_b"], "mu_b": values["mu_a"]} if order < 0 else {}
        done = duhem.project(name, trial[:, ::order], -1.0, [1.0, slender**2][::order], values | given, method="newton")
        assert (done.status == Status.SLIP).all()
        if name == "box":
            assert (
                np.abs(done.stress[:, ::order] - np.clip(trial, [-1.0, -slender], [1.0, slender])) <= 2.0**-52 * np.array([1.0, slender])
            ).all()


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [np.diag([1.0, 4.0, 1.0]), np.array([[3.0, -1.0, -1.0], [-1.0, 3.0, -1.0], [-1.0, -1.0, 3.0]])])
@pytest.mark.parametrize("far", [300.0, 480.0, 700.0, 900.0])
def test_slopes_whose_squares_are_beyond_doubles(stiffness: np.ndarray, far: float) -> None:
    """g is a double there and the square of its slope is none: it is outside all the same.  The answer against CVXPY's."""
    trial = far * np.array([[0.05, 0.5, 0.45], [-0.45, 0.1, -0.7], [0.3, 0.3, 0.3]])
    asked = dict(stiffness=stiffness, parameters={"sy": 1, "f": "1/2"})
    newton, reference = (duhem.project("gurson", trial, method=method, **asked) for method in ("newton", "cvxpy"))
    assert (newton.status == Status.SLIP).all() and np.abs(newton.stress).max() < 10.0
    assert np.allclose(newton.stress, reference.stress, rtol=0.0, atol=1e-5)


CAPPED = [  # cones without roots, cut off: the slope of their sides grows along them; the corner, and slip = m dg + n dcap there
    ("max(x**2 - (y + 1)**2, -y - 1, y - 3)", ("x", "y"), [6.0, 10.0], [4.0, 3.0], 1.0 / 4.0 + 9.0),
    ("max(x**2 + y**2 - (z + 1)**2, -z - 1, z - 3)", ("x", "y", "z"), [6.0, 8.0, 10.0], [2.4, 3.2, 3.0], 3.0 / 4.0 + 13.0),
]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "forces", "trial", "corner", "weight"), CAPPED)
def test_multipliers_at_a_corner_are_those_of_the_slopes_there(g, forces, trial, corner, weight):
    law = Criterion(name="capped-cone", g=g, forces=forces, pressure=None)
    for found in (duhem.project(law, trial), duhem.project(law, np.tile(trial, (40, 1)))):
        assert (found.status == Status.SLIP).all()
        np.testing.assert_allclose(found.stress, np.broadcast_to(corner, found.stress.shape), rtol=1e-14)
        np.testing.assert_allclose(found.slip, found.stress * 0.0 + np.subtract(trial, corner), rtol=1e-14)
        np.testing.assert_allclose(found.multiplier, weight, rtol=1e-13)
    rng = np.random.default_rng(0)
    far = rng.standard_normal((60, len(forces))) * 10.0 ** rng.uniform(0, 3, (60, 1))
    assert (duhem.project(law, far).status <= Status.SLIP).all()


@pytest.mark.parametrize("far", [1e1, 1e3, 1e4, 1e6])
def test_far_from_a_set_that_is_small_and_off_the_origin(far):
    """No sample of the way from the origin meets it; its multiplier is that of its slope."""
    law = Criterion(name="off-the-origin", g="(a - 2*abs(p))**2 + 4*b**2 - p**2", forces=("a", "b"), pressure="p")
    rng = np.random.default_rng(1)
    trial, pressure, k = rng.standard_normal((60, 2)) * far, -rng.uniform(0.5, 2.0, 60), rng.uniform(0.2, 5.0, 2)
    found = duhem.project(law, trial, pressure, k)
    assert (found.status <= Status.SLIP).all()
    slope = np.stack([2.0 * (found.stress[:, 0] + 2.0 * pressure), 8.0 * found.stress[:, 1]], axis=1)
    slips = found.status == Status.SLIP
    np.testing.assert_allclose((found.multiplier[:, None] * slope)[slips], found.slip[slips], rtol=1e-6, atol=1e-9 * far)
