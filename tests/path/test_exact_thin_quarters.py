"""Exact steps into quarters a million million times thinner than the one before, and steps that hold, against 60 digits."""

import math
import warnings
from itertools import product

import numpy as np
import pytest
from mpmath import MPContext

from duhem import Path, simulate
from duhem.path.elementary_steps import on_ellipse

mp = MPContext()
mp.dps = 60
RATIOS = [10.0**-i for i in (2, 4, 5, 7, 8, 10, 12)]


def quadrature(stress, du, load, mu, k, signs):
    """Stress, multiplier and work of a step that leaves K in the quarter of these signs and slips within it, in y = ln tan(|delta|/2).

    The exit is the root of the quadratic as it stands, and the time and the power are integrals of their rates.
    """
    stress, du, k = ([mp.mpf(float(x)) for x in pair] for pair in (stress, du, k))
    half = [mp.mpf(mu[2 * i + (signs[i] < 0)]) for i in (0, 1)]
    p, r = ([x / (h * load) for x, h in zip(pair, half, strict=True)] for pair in (stress, [k[i] * du[i] for i in (0, 1)]))
    a, b, c = mp.fdot(r, r), mp.fdot(p, r), mp.fdot(p, p) - 1
    free = (mp.sqrt(b * b - a * c) - b) / a
    start = mp.atan2(p[1] + free * r[1], p[0] + free * r[0])
    rate = [half[i] * du[i] for i in (0, 1)]
    speed, towards = mp.hypot(*rate), mp.atan2(rate[1], rate[0])
    lean = towards - start - 2 * mp.pi * mp.nint((towards - start) / (2 * mp.pi))
    y0, squares = mp.log(mp.tan(abs(lean) / 2)), [load * h * h / x for h, x in zip(half, k, strict=True)]

    def angle(y):
        return towards - mp.sign(lean) * 2 * mp.atan(mp.exp(y))

    def slowness(y):
        return squares[0] * mp.sin(angle(y)) ** 2 + squares[1] * mp.cos(angle(y)) ** 2

    mp.dps, y, passed = 25, y0, mp.mpf(0)
    for _ in range(40):
        step = ((1 - free) * speed - passed) / slowness(y)
        passed += mp.quad(slowness, [y - step, y], maxdegree=5)
        y -= step
        if abs(step) < 1e-18:
            break
    power = mp.quad(lambda z: slowness(z) * mp.cos(2 * mp.atan(mp.exp(z))), [y, y0], maxdegree=5)  # of the stress while it slips
    end = [half[0] * load * mp.cos(angle(y)), half[1] * load * mp.sin(angle(y))]
    mp.dps = 60
    multiplier = power - (squares[1] - squares[0]) * (mp.sin(angle(y)) ** 2 - mp.sin(start) ** 2) / 2  # less what is stored
    work = free * sum((s + free * x * d / 2) * d for s, x, d in zip(stress, k, du, strict=True)) + load * power
    return free, end, multiplier, work


@pytest.mark.parametrize(("across", "thin"), list(product([0, 1], [1, -1])))
def test_a_step_across_a_seam_into_a_thin_quarter_keeps_its_digits(across, thin):
    draw, seen = np.random.default_rng(2 * across + (thin > 0)), 0
    for ratio, other in product(RATIOS, [1.0, -1.0]):
        mu, k, load = draw.uniform(0.3, 1.0, 4), draw.uniform(0.5, 2.0, 2), 10 ** draw.uniform(-3, 3)
        mu[2 * across + (thin < 0)] *= ratio
        signs, stress, q = np.empty(2), np.empty(2), np.empty(2)
        signs[across], signs[1 - across] = thin, other
        wide, beside = mu[2 * across + (thin > 0)] * load, mu[2 * (1 - across) + (other < 0)] * load
        stress[across], stress[1 - across] = -thin * wide * draw.uniform(0.1, 0.7), other * beside * draw.uniform(0.3, 0.7)
        q[across] = thin * wide * draw.uniform(1.0, 2.0)
        q[1 - across] = -other * beside * draw.uniform(0.02, 0.2)
        du = q / k
        free, end, multiplier, work = quadrature(stress, du, load, mu, k, signs)
        assert all(float(x) * sign > 0 for x, sign in zip(end, signs, strict=True))
        moved = on_ellipse(tuple(stress.tolist()), tuple(du.tolist()), load, mu.tolist(), tuple(k.tolist()))
        energy = load * np.abs(du).max()
        assert abs(moved.free - float(free)) <= 1e-15
        assert max(abs(x - float(y)) for x, y in zip(moved.stress, end, strict=True)) <= 1e-14 * load
        assert abs(moved.stress[across] - float(end[across])) <= 1e-13 * abs(float(end[across]))
        assert moved.multiplier == pytest.approx(float(multiplier), rel=1e-12, abs=0.0)
        assert abs(moved.work - float(work)) <= 1e-14 * energy
        seen += 1
    assert seen == 14


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-200, 1e-160, 1e-100, 1e-20])
def test_a_step_of_nothing_after_slip_changes_nothing(size):
    """Even where rounding has put the stress outside of K, and whichever way a step leads whose square underflows."""
    draw, outside = np.random.default_rng(7), 0
    for _ in range(300):
        mu, k = draw.uniform(0.1, 0.5, 4).tolist(), tuple(draw.uniform(0.5, 2.0, 2).tolist())
        before = on_ellipse((0.0, 0.0), tuple((3.0 * draw.standard_normal(2)).tolist()), 1.0, mu, k).stress
        outside += math.hypot(*(s / mu[2 * i + (s < 0)] for i, s in enumerate(before))) > 1.0
        moved = on_ellipse(before, tuple((size * draw.standard_normal(2)).tolist()), 1.0, mu, k)
        assert np.abs(np.subtract(moved.stress, before)).max() <= 2e-16 + 2.0 * size
        assert 0.0 <= moved.multiplier <= 3.0 * size and 0.0 <= moved.free <= 1.0
        assert size > 0.0 or moved.free == 1.0
    assert outside > 10


@pytest.mark.parametrize(
    ("law", "parameters"),
    [
        ("coulomb", {"mu": 0.303133416869351}),
        ("shifted_ellipse", {"mu_a": 0.17, "mu_b": 0.39, "shift": 0.085}),
        ("capped", {"mu": 0.42508108723615345, "tau_max": 0.2}),
    ],
)
def test_a_load_into_slip_can_be_held(law, parameters):
    for angle in np.linspace(0.0, 6.2, 40):
        there = [5.0 * math.cos(angle), 5.0 * math.sin(angle)]
        history = simulate(law, Path.linear([[0, 0], there, there], pressure=-1.0), stiffness=1.0, parameters=parameters, method="exact")
        assert history.stress[2].tolist() == history.stress[1].tolist() and history.slip[2].tolist() == history.slip[1].tolist()
        assert history.work[2] == history.work[1] and history.dissipation[2] == history.dissipation[1]


@pytest.mark.parametrize("size", [1.0, 1e155, 1e250])
def test_a_load_linear_in_any_pressure_is_seen_to_be(size):
    path = Path.linear([[0.0], [0.5], [-0.3], [0.2]], pressure=[-size, -2 * size, -0.5 * size, -size])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        history = simulate("antoni2007_1d", path, stiffness=size, parameters={"mu_plus": 0.2, "mu_minus": 0.1}, method="exact")
    assert history.why == "elementary functions on each straight piece"
    assert history.stress[:, 0] / size == pytest.approx([0.0, 0.4, -0.05, 0.2], rel=1e-15)
