"""Exact paths against 30 digits, against each other, and against the closed forms of the plane."""

import math
from itertools import product
from typing import Any

import numpy as np
import pytest

from duhem import Criterion, DuhemError, Path, simulate
from duhem.path.elementary_steps import on_disk, on_ellipse
from tests.long import long_at, long_but, mostly_long
from tests.oracles.path import drive

NAMES = ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")


def polygon(seed):
    """A random law, stiffness and path of six straight steps, most of them long enough to slip across seams."""
    draw = np.random.default_rng(seed)
    mu, k = 10 ** draw.uniform(-1, 0, 4), 10 ** draw.uniform(-0.5, 0.5, 2)
    return mu, k, Path.random(seed=seed, points=6, scale=mu.mean() / k * 10 ** draw.uniform(-0.3, 0.5), pressure=-1.0)


def exact(mu, k, path, **options):
    return simulate("antoni2007", path, stiffness=k, parameters=dict(zip(NAMES, map(float, mu), strict=True)), method="exact", **options)


# -- straight steps -----------------------------------------------------------------------------------------------


def test_a_root_at_the_end_of_its_bracket_keeps_its_digits():
    """On a circle it lies there to rounding, and a step of Newton's method leaves the bracket by one unit in the last place."""
    draw, worst = np.random.default_rng(1), 0.0
    for turn, lean, size in zip(draw.uniform(-0.7, 0.7, 800), draw.uniform(-1, 1, 800), 10 ** draw.uniform(-2, 1, 800), strict=True):
        towards = turn + lean
        moved = on_ellipse(
            (math.cos(turn), math.sin(turn)), (size * math.cos(towards), size * math.sin(towards)), 1.0, (1.0,) * 4, (1.0, 1.0)
        )
        if moved.free == 0.0:
            left = towards + 2 * math.atan(math.tan(-lean / 2) * math.exp(-size))
            worst = max(worst, abs(moved.stress[0] - math.cos(left)), abs(moved.stress[1] - math.sin(left)))
    assert 0.0 < worst <= 4e-15


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but([4], [0, 10, 33, 35, 36]))
def test_one_step_a_segment_agrees_with_thirty_digits(seed):
    mu, k, path = polygon(seed)
    history = exact(mu, k, path)
    assert history.why == "elementary functions on each straight piece"
    for i, (stress, multiplier, dissipation, work) in enumerate(drive(path.values, mu, 1.0, k), 1):
        assert np.abs(history.stress[i] - [float(s) for s in stress]).max() <= 1e-14 * mu.max()
        assert history.multiplier[i] == pytest.approx(float(multiplier), rel=1e-13)
        assert history.dissipation[i] == pytest.approx(float(dissipation), rel=1e-13)
        assert history.work[i] == pytest.approx(float(work), rel=1e-13)


@pytest.mark.long
def test_the_random_paths_cross_seams_unload_and_stick():
    seams = sticks = 0
    for seed in (0, 10, 33, 35, 36):
        history = exact(*polygon(seed), substeps=200)
        slips = np.diff(history.multiplier) > 0.0
        quadrant = np.sign(history.stress[1:])
        seams += int(((quadrant[1:] != quadrant[:-1]).any(axis=1) & slips[1:] & slips[:-1]).sum())
        sticks += int((slips[:-1] & ~slips[1:]).sum())  # slip, then none: the path turned inward
    assert seams >= 5 and sticks >= 5


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but([0, 2, 5], range(6)))
def test_many_steps_or_one_are_the_same(seed):
    mu, k, path = polygon(seed)
    one, many = exact(mu, k, path), exact(mu, k, path, substeps=97)
    for name in ("stress", "slip", "multiplier", "dissipation", "work"):
        assert np.allclose(getattr(one, name), getattr(many, name)[::97], rtol=0, atol=2e-13)


@pytest.mark.parametrize("ratio", [1.0, 1e-4, 1e4, 1e-8, 1e8])
@pytest.mark.parametrize("length", [1e-12, 1.0, 1e3, 1e12])
def test_extreme_shapes_and_steps_stay_on_the_boundary(ratio, length):
    mu = (0.3, 0.3 * ratio, 0.2 * ratio, 0.2)
    state = (0.0, 0.0)
    for angle in np.linspace(0.1, 12.0, 25):
        du = (length * math.cos(angle), length * math.sin(angle))
        moved = on_ellipse(state, du, 1.0, mu, (1.0, 2.0))
        state = moved.stress
        size = math.hypot(*(s / mu[2 * i + (s < 0)] for i, s in enumerate(state)))
        assert size <= 1 + 1e-14 and moved.multiplier >= 0.0 and 0.0 <= moved.free <= 1.0


# of these, half hold every value of one beside every value of each other
TANGENT = list(product([0, 1], [1.0, -1.0], [1.0, -1.0], [1.0, 1.5]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("along", "side", "turn", "overshoot"),
    long_but([0, 3, 6, 9], TANGENT),
)
def test_a_step_that_starts_tangent_to_the_boundary_slips(along, side, turn, overshoot):
    """To an end of an axis of K (or beyond it), then straight along the tangent there: the corners of a rectangular path."""
    mu, k, across = [0.25, 0.0625, 0.125, 0.5], [2.0, 1.0], 1 - along
    end, turned = np.zeros(2), np.zeros(2)
    end[along] = side * overshoot * mu[2 * along + (side < 0)] / k[along]
    turned[across] = turn * 0.3
    history = exact(mu, k, Path.linear([[0, 0], end, end + turned], pressure=-1.0))
    (_, (stress, multiplier, _, _)) = drive(history.displacement, mu, 1.0, k)
    assert multiplier > 0
    assert np.abs(history.stress[-1] - [float(s) for s in stress]).max() <= 1e-14
    assert history.multiplier[-1] == pytest.approx(float(multiplier), rel=1e-13)


def test_krieg_and_krieg_on_the_disk():
    mu, k, du = 0.3, 2.0, np.array([0.4, 0.1])
    start = 0.3 * np.array([math.cos(2.0), math.sin(2.0)])
    du = du if start @ du > 0 else -du
    history = simulate(
        "coulomb", Path.linear([[0, 0], du], pressure=-1.0), stiffness=k, parameters={"mu": mu}, method="exact", stress=start * (1 - 1e-16)
    )
    direction = math.atan2(du[1], du[0])
    before, after = (math.remainder(math.atan2(s[1], s[0]) - direction, 2 * math.pi) for s in (start, history.stress[-1]))
    assert abs(before) > 0.5
    assert math.tan(after / 2) == pytest.approx(math.tan(before / 2) * math.exp(-k * np.hypot(*du) / mu), rel=1e-12)


# -- arcs ---------------------------------------------------------------------------------------------------------


KAPPA = [0.3, 0.9, 0.999, 1.0, 1.001, 1.5, 3.0, 40.0]


@pytest.mark.slow
@pytest.mark.parametrize(("kappa", "turns"), long_but([0, 3, 7, 8], product(KAPPA, (1.7, -1.7))))
def test_adlers_equation_against_many_chords(kappa, turns):
    limit, k = 0.25, 1.5
    radius = kappa * limit / k
    arguments = {"stiffness": k, "parameters": {"mu": limit}, "method": "exact", "stress": [0.2 * limit, 0.5 * limit]}
    arc = simulate("coulomb", Path.circle(radius, points=1, turns=turns, pressure=-1.0, start=0.4), **arguments)
    assert arc.why == "Adler's equation on each arc"
    polygons = [Path.circle(radius, points=n, turns=turns, pressure=-1.0, start=0.4, chords=True) for n in (300, 600)]
    chords = [simulate("coulomb", polygon, **arguments) for polygon in polygons]
    errors = [np.abs(c.stress[-1] - arc.stress[-1]).max() / limit for c in chords]
    assert errors[1] <= 2e-4 * kappa and errors[1] <= 0.3 * errors[0] + 1e-13
    assert abs(chords[1].dissipation[-1] - arc.dissipation[-1]) <= 1e-4 * (1 + chords[1].dissipation[-1])
    assert abs(arc.work[-1] - arc.psi[-1] + arc.psi[0] - arc.dissipation[-1]) <= 1e-15 * (1 + kappa)


@pytest.mark.slow
@pytest.mark.parametrize("kappa", [0.5, 0.95, 1.0, 1.2, 8.0])
def test_arcs_are_the_same_in_one_step_or_many_and_by_the_differential_equation(kappa):
    limit, k = 0.25, 1.5
    path = Path.circle(kappa * limit / k, points=3, turns=1.0, pressure=-1.0)
    arguments = {"stiffness": k, "method": "exact", "stress": [0.0, 0.9 * limit]}
    one, many = (simulate("coulomb", path, parameters={"mu": limit}, substeps=n, **arguments) for n in (1, 50))
    assert np.abs(one.stress - many.stress[::50]).max() < 1e-13
    general = simulate("antoni2007", path, parameters=dict.fromkeys(NAMES, limit), **arguments)
    assert general.why.startswith("Dormand-Prince")
    assert np.abs(one.stress - general.stress).max() < 1e-11
    assert abs(one.dissipation[-1] - general.dissipation[-1]) < 1e-11


def test_the_lag_of_steady_rotation():
    stress, k, radius, limit = (0.2, 0.0), 1.0, 0.6, 0.2
    moved = on_disk(stress, radius, 0.0, 20.0, limit, k)
    lag = 20.0 + math.pi / 2 - math.atan2(moved.stress[1], moved.stress[0])
    assert math.sin(lag) == pytest.approx(limit / (k * radius), rel=1e-13)


def circle_errors(n, kappa=2.0, turns=1.0):
    """Largest error of the stress over one turn, relative to the radius of the disk, of the three ways with n steps."""
    limit = 0.2
    arguments = {"stiffness": 1.0, "parameters": {"mu": limit}}
    circle = {"radius": kappa * limit, "points": n, "turns": turns, "pressure": -1.0}
    true = simulate("coulomb", Path.circle(**circle), method="exact", **arguments)
    chords = Path.circle(**circle, chords=True)
    return [
        np.hypot(*(simulate("coulomb", chords, method=m, **arguments).stress - true.stress).T).max() / limit
        for m in ("implicit", "extrapolated", "exact")
    ]


@pytest.mark.slow
def test_orders_on_the_circle():
    """In steady rotation an implicit step lags by half the step, pi/n; chords and extrapolation err by the square of it."""
    coarse, fine = np.array(circle_errors(200)), np.array(circle_errors(400))
    assert np.abs(np.log2(coarse / fine) - [1.0, 2.0, 2.0]).max() < 0.1
    assert fine[0] * 400 == pytest.approx(math.pi, rel=0.1)


@pytest.mark.slow
def test_constants_of_the_errors_at_the_end_of_three_quarters_of_a_turn():
    """k rho/a = 3: implicit 2.4/n, two implicit runs extrapolated 1.5/n^2, exact on each chord 5.9/n^2."""
    n, limit = 300, 0.2
    arguments = {"stiffness": 1.0, "parameters": {"mu": limit}}

    def end(points, method, **options):
        path = Path.circle(3 * limit, points=points * 4 // 3, turns=0.75, pressure=-1.0, **options)
        assert len(path.time) == points + 1
        return simulate("coulomb", path, method=method, **arguments).stress[-1]

    true = end(n, "exact")
    found = {
        "implicit": np.hypot(*(end(n, "implicit") - true)) / limit * n,
        "two runs": np.hypot(*(2 * end(2 * n, "implicit") - end(n, "implicit") - true)) / limit * n**2,
        "chords": np.hypot(*(end(n, "exact", chords=True) - true)) / limit * n**2,
    }
    assert {name: round(float(c), 1) for name, c in found.items()} == {"implicit": 2.4, "two runs": 1.5, "chords": 5.9}


# -- other shapes -------------------------------------------------------------------------------------------------


CURVED: list[Any] = [
    ("antoni2007", dict(zip(NAMES, (0.2, 0.08, 0.12, 0.15), strict=True)), [[1.0, 0.3], [0.3, 2.0]], -1.0),
    ("antoni2007", dict(zip(NAMES, (0.2, 0.08, 0.12, 0.15), strict=True)), [1.0, 2.0], (-2.0, -0.5)),
    ("shifted-ellipse", {"mu_a": 0.2, "mu_b": 0.1, "shift": 0.05}, [1.0, 2.0], -1.0),
    ("cohesive", {"mu": 0.2, "cohesion": 0.1}, [1.0, 2.0], (-2.0, -0.5)),
    ("quartic", {"mu": 0.2, "c": 1}, 1.0, -1.0),
    ("von-mises", {"yield_stress": 0.2}, 1.0, None),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "parameters", "k", "pressure"),
    long_but([3, 5], CURVED),
)
def test_extrapolated_steps_converge_to_the_exact_path(law, parameters, k, pressure):
    path = Path.random(seed=1, points=2, scale=0.3, pressure=pressure, dimension=3 if law == "von-mises" else 2)
    arguments = {"stiffness": k, "parameters": parameters}
    true = simulate(law, path, method="exact", **arguments)
    assert np.abs(true.balance).max() < 1e-13 and true.dissipation[-1] > 0.0
    cheap = law not in ("quartic", "von-mises")
    coarse, fine = (
        np.abs(simulate(law, path, method="extrapolated", substeps=n, **arguments).stress[-1] - true.stress[-1]).max()
        for n in ((100, 400) if cheap else (8, 32))
    )
    assert fine < coarse / 10 and fine < (2e-5 if cheap else 2e-3)


def test_the_differential_equation_agrees_with_the_elementary_functions():
    mu, k, path = polygon(7)
    parameters = dict(zip(NAMES, map(float, mu), strict=True))
    nudged = [[k[0], 1e-15 * k[0]], [1e-15 * k[0], k[1]]]  # couples the forces by a rounding, so that the general way is taken
    a = simulate("antoni2007", path, stiffness=k, parameters=parameters, method="exact")
    b = simulate("antoni2007", path, stiffness=nudged, parameters=parameters, method="exact")
    assert b.why.startswith("Dormand-Prince")
    assert np.abs(a.stress - b.stress).max() < 1e-12 and abs(a.dissipation[-1] - b.dissipation[-1]) < 1e-11


WAYS = {
    "along a": [[0, 0], [3e-4, 0], [3e-4, 2e-4]],
    "along b": [[0, 0], [0, 3e-4], [2e-4, 3e-4]],
    "back along a": [[0, 0], [3e-4, 0], [-3e-4, 0], [-3e-4, -2e-4]],
    "across a": [[0, 0], [3e-4, 1e-4], [3e-4, -2e-4]],
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "way"),
    mostly_long(product(("2.5", "3", "5", "6"), WAYS), ("5", "across a"), ("6", "along b")),
)
def test_powers_of_every_kind_go_along_and_across_the_axes(p, way):
    """|x|^p has a derivative on its axis, 0, whichever way it is written; small second-order steps come to the same stress."""
    given = {"stiffness": [1e9, 2e9], "parameters": {"mu_a": "0.1", "mu_b": "0.2", "p": p}}
    path = Path.linear(WAYS[way], pressure=-1e6)
    exact = simulate("superellipse", path, method="exact", **given)
    shape = np.sum(np.abs(exact.stress / [1e5, 2e5]) ** float(p), axis=1)
    assert np.all(shape <= 1 + 1e-12) and np.abs(exact.balance).max() < 1e-12 * np.abs(exact.work).max()
    small = simulate("superellipse", path, method="extrapolated", substeps=10, **given)
    assert np.allclose(exact.stress, small.stress[::10], rtol=0, atol=0.005 * 2e5)


def test_a_cap_on_the_load_has_a_slope() -> None:
    """Orowan's tau = min(mu |sigma_n|, k): straight slip under growing pressure, stopped where the cap is reached."""
    path = Path.linear([[0, 0], [3, 4], [6, 8]], pressure=[-0.5, -0.5, -2.0])
    done = simulate("orowan", path, stiffness=1.0, parameters={"mu": 1, "k": 1}, method="exact", substeps=6)
    limit = np.minimum(np.abs(done.pressure), 1.0)[1:]
    np.testing.assert_allclose(done.stress[1:], limit[:, None] * [0.6, 0.8], rtol=1e-9)
    assert np.abs(done.balance).max() < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(("waist", "convex"), [("20", True), ("1/5", False)])
def test_a_set_that_is_not_convex_is_said_to_be_none(waist: str, convex: bool) -> None:
    """Cassini's ovals round the foci +-1: they are convex from (1 + c)^2 = 4 on."""
    law = Criterion("oval", f"(a**2 + b**2)**2 - 2*(a**2 - b**2) - {waist}", forces=("a", "b"), pressure=None)
    done = simulate(law, Path.linear([[0, 0], [0.5, 3.0], [4.0, 1.0]]), stiffness=1.0, method="exact")
    assert ("K is not convex" in done.why) is not convex


@pytest.mark.slow
def test_slip_that_begins_at_a_tip_has_no_direction() -> None:
    with pytest.raises(DuhemError, match="the boundary of K has no normal at the stress"):
        simulate("sap", Path.linear([[0, 0, 0], [1, 0, 0]]), stiffness=1.0, parameters={"mu": 1}, method="exact")


@pytest.mark.parametrize("load", long_at([1], [1.0, 1e-10, 1e-17]))
def test_a_friction_in_which_digits_cancel_keeps_them(load: float) -> None:
    """1 - exp(-x) has no digit of its own at a small x; under one pressure Shaw's law is Coulomb's of the same radius."""
    path = Path.circle(0.5 * load, points=9, pressure=-load)
    found = simulate("shaw", path, stiffness=[1.0, 2.0], parameters={"mu": 0.25, "k": 1.0}, method="exact")
    same = {"mu": -math.expm1(-load / 4) / load}
    expected = simulate("coulomb", path, stiffness=[1.0, 2.0], parameters=same, method="exact")
    np.testing.assert_allclose(found.stress, expected.stress, atol=1e-12 * load)
