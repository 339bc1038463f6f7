"""Where doubles are at their end an answer is right or flagged, and what is right is not flagged."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection import closed_form, newton
from duhem.projection.extended_precision import as_pairs, close_look, pushed_back
from duhem.projection.increment import increment
from duhem.projection.residuals import residuals
from duhem.projection.result import ACCURACY, Solution, Status
from duhem.projection.scaled_formula import level
from tests.campaigns.number_families import FAMILIES, Question, aspects, disk, mp
from tests.campaigns.numbers import Count, tally
from tests.long import mostly_long


def family(name: str, every: int) -> list[Question]:
    return list(FAMILIES[name]())[::every]


def total(counts: list[Count]) -> Count:
    return sum(counts, Count())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "every", "right"),
    [
        pytest.param("cancelling", 4, 60, marks=pytest.mark.long),
        ("cancelling", 16, 14),
        pytest.param("saturating", 1, 1500, marks=pytest.mark.long),
        ("saturating", 5, 300),
        pytest.param("powers", 7, 200, marks=pytest.mark.long),
        pytest.param("ulps", 15, 50, marks=pytest.mark.long),
    ],
)
def test_families_of_extremes(name: str, every: int, right: int) -> None:
    """A part of ``tests.campaigns.numbers``; the reference has 60 digits and shares nothing with the methods."""
    seen = total(list(tally(iter(family(name, every)), ["closed-form", "newton"]).values()))
    assert seen.right >= right
    assert (seen.wrong_stress, seen.wrong_slip, seen.right_flagged, seen.unvouched_flagged) == (0, 0, 0, 0)


@pytest.mark.slow
@pytest.mark.parametrize("every", mostly_long([1, 29], 29))
def test_ellipses_that_nearly_touch_no_stress_are_right(every: int) -> None:
    seen = total(list(tally(iter(family("grazing", every)), ["closed-form", "newton"]).values()))
    assert seen.points >= 1500 / every and seen.right >= 0.85 * seen.points
    assert (seen.wrong_stress, seen.wrong_slip, seen.right_flagged) == (0, 0, 0)


@pytest.mark.parametrize("yield_stresses", [(1.5, 1.0), (1.001, 1.0), (33.0, 31.0), (70e6, 50e6)])
@pytest.mark.parametrize("stiffness", [1.0, 3e11])
def test_the_tip_of_a_paraboloid_is_seen_from_next_to_it(yield_stresses: tuple[float, float], stiffness: float) -> None:
    """On the hydrostatic axis Raghava's paraboloid ends at I1 = C T/(C - T); what is beyond it by a share of 1e-15 slips."""
    c, t = map(Fraction, yield_stresses)
    tip = c * t / (c - t) / 3
    trial = [[float(tip) * (1.0 + share)] * 3 for share in (1e-15, 1e-14, 2.5e-13, 1e-11, 1e-8, 1e-3, 1.0, 1e3)]
    done = duhem.project("raghava", trial, None, stiffness, {"C": float(c), "T": float(t)})
    beyond = [float((Fraction(x) - tip) / Fraction(stiffness)) for x, *_ in trial]
    assert (done.status == [Status.SLIP if x > 0.0 else Status.STICK for x in beyond]).all()
    np.testing.assert_allclose(done.slip, np.maximum(beyond, 0.0)[:, None] * np.ones(3), rtol=1e-6)
    assert (done.slip > 0.0).any(axis=1).sum() >= 7


@pytest.mark.long
def test_aspects_of_1e12_are_right_or_flagged() -> None:
    seen = total(list(tally(iter(list(aspects())[2::6]), ["closed-form", "newton"]).values()))
    assert seen.points >= 40 and seen.right >= 30
    assert (seen.wrong_stress, seen.wrong_slip) == (0, 0)


@pytest.mark.parametrize("load", [1e-10, 1e-12, 1e-14])
def test_a_formula_that_cancels_vouches_for_nothing(load: float) -> None:
    """Newton's radius of the hyperbola is off, and g, which cancels likewise, is zero there; the closed form's is right."""
    radius = mp.sqrt(mp.mpf(load) ** 2 + 2 * mp.mpf(load))
    trial = disk("regularised", {}, -load, radius, [2.3, 17.0]).trial
    right = duhem.project("regularised", trial, -load, 1.0, {"mu": 1, "c": 1})
    wrong = duhem.project("regularised", trial, -load, 1.0, {"mu": 1, "c": 1}, method="newton")
    assert right.method == "closed-form" and (right.status == Status.SLIP).all()
    off = np.abs(np.linalg.norm(wrong.stress, axis=1) / float(radius) - 1.0)
    assert (off > ACCURACY).any()
    assert (wrong.status[off > ACCURACY] == Status.INACCURATE).all()


@pytest.mark.slow
@pytest.mark.parametrize("load", [1e-290, 1e-80, 1.0, 1e150, 1e290])
def test_powers_beyond_doubles(load: float) -> None:
    """The multiplier of a quartic law is of degree -2: where no double holds it, it is 0 or inf."""
    done = duhem.project("quartic", [[0.9 * load, 1.2 * load], [0.1 * load, 0.0]], -load, 1.0, {"mu": 0.5, "c": 2})
    assert done.status.tolist() == [Status.SLIP, Status.STICK]
    assert done.stress[0] / load == pytest.approx([0.3, 0.4], rel=1e-15)
    assert done.slip[0] / load == pytest.approx([0.6, 0.8], rel=1e-15)
    with np.errstate(over="ignore", under="ignore"):
        assert done.multiplier[0] == pytest.approx(2.0 / np.float64(load) / load, rel=1e-14)


def test_a_multiplier_that_is_not_beyond_doubles_is_asked_for() -> None:
    question = increment(duhem.load("quartic"), [0.9, 1.2], -1.0, 1.0, {"mu": 0.5, "c": 2})
    right = newton.solve(question)
    for wrong in (0.0, np.inf, 1e-300, right.multiplier[0] * 1.001):
        spoilt = Solution(right.stress, right.slip, np.array([wrong]), right.failed)
        assert not residuals(question, spoilt).worst()[0] <= ACCURACY


@pytest.mark.slow
@pytest.mark.parametrize("law", ["coulomb", "limacon", "superellipse"])
@pytest.mark.parametrize("share", [1e-15, 1e-13, 1e-11, 1e-9])
def test_slips_next_to_the_boundary_have_their_digits(law: str, share: float) -> None:
    """The method's own are lost, which the judge sees; what is returned is that of the closest point in many digits."""
    parameters = {"coulomb": {"mu": 0.5}, "limacon": {"mu": 0.5, "e": 0}, "superellipse": {"mu_a": 0.5, "mu_b": 0.5, "p": 2}}[law]
    asked = disk(law, parameters, -1.0, mp.mpf(0.5), [1 + share], 8.0)
    question = increment(duhem.load(law), asked.trial, -1.0, 8.0, parameters)
    raw = newton.solve(question)
    done = duhem.project(law, asked.trial, -1.0, 8.0, parameters, method="newton")
    assert (done.status == Status.SLIP).all()
    lost = 0
    for i, trial in enumerate(asked.trial.tolist()):
        size = mp.sqrt(mp.mpf(trial[0]) ** 2 + mp.mpf(trial[1]) ** 2)
        exact = np.array([float((size - mp.mpf(0.5)) / size * mp.mpf(t) / 8) for t in trial])
        assert done.slip[i] == pytest.approx(exact, rel=1e-9)
        if np.abs(raw.slip[i] - exact).max() > 1e-6 * np.abs(exact).max():
            lost += 1
            alone = increment(duhem.load(law), trial, -1.0, 8.0, parameters)
            row = Solution(*(getattr(raw, name)[i : i + 1] for name in ("stress", "slip", "multiplier", "failed")))
            assert residuals(alone, row).worst()[0] > ACCURACY
    assert lost > 0 or share > 1e-10


def test_a_slip_off_by_a_little_more_than_what_is_vouched_for() -> None:
    """The difference of two slips has a rounding of its own."""
    trial, k = [[0.50000005, 0.50000005, -0.20000002000000003]], [1.0, 1e6, 1e12]
    question = increment(duhem.load("tresca"), trial, None, k, {"yield_stress": 0.7})
    off = np.array([[7.0000000101932871e-20, 0.0, -7.000000010193297e-20]])  # the second component is 1e-6 of the others
    stress = question.trial - off * k
    found = residuals(question, Solution(stress, off, off[:, 0], np.zeros(1, dtype=bool)))
    assert found.worst()[0] > ACCURACY


def test_a_stick_an_ulp_outside_has_lost_its_slip() -> None:
    outside = float(np.nextafter(0.5, 1.0))
    none = np.zeros((2, 2))
    question = increment(duhem.load("coulomb"), [[outside, 0.0], [0.5, 0.0]], -1.0, 1.0, {"mu": 0.5})
    stick = Solution(question.trial.copy(), none, np.zeros(2), np.zeros(2, dtype=bool))
    assert (residuals(question, stick).worst() > ACCURACY).tolist() == [True, False]
    for method in ("closed-form", "newton"):
        done = duhem.project("coulomb", question.trial, -1.0, 1.0, {"mu": 0.5}, method=method)
        assert done.status.tolist() == [Status.SLIP, Status.STICK]
        assert done.slip[0].tolist() == [outside - 0.5, 0.0]


def test_a_slip_that_is_turned_next_to_the_boundary_is_inaccurate() -> None:
    """By a thousandth of itself, 1e-9 of the stress: nothing of it shows in the stress."""
    trial = np.array([[0.3 * (1 + 1e-9), 0.4 * (1 + 1e-9)]])
    question = increment(duhem.load("coulomb"), trial, -1.0, 1.0, {"mu": 0.5})
    right = closed_form.solve(question)
    assert residuals(question, right).worst()[0] <= 1e-14
    across = 1e-3 * right.slip[:, ::-1] * [-1.0, 1.0]
    for slip in (right.slip + across, 1.001 * right.slip):
        wrong = Solution(trial - slip, slip, right.multiplier, right.failed)
        assert residuals(question, wrong).worst()[0] > ACCURACY


def test_at_a_corner_next_to_the_boundary_the_slip_is_between_the_normals() -> None:
    corner, k, step = np.array([0.5, 0.25]), np.array([1.0, 2.0]), 2.0**-28
    trial = corner + np.array([[3.0, 1.0], [3.0, -1.0]]) * step
    done = duhem.project("box", trial, -1.0, k, {"mu_a": 0.5, "mu_b": 0.25})
    assert (done.status == Status.SLIP).all()
    assert done.slip * k == pytest.approx(np.array([[3.0, 1.0], [3.0, 0.0]]) * step, rel=1e-6, abs=1e-6 * step)
    question = increment(duhem.load("box"), trial[1:], -1.0, k, {"mu_a": 0.5, "mu_b": 0.25})
    slip = (trial[1:] - corner) / k
    wrong = Solution(corner[None], slip, np.array([3 * step]), np.zeros(1, dtype=bool))
    assert residuals(question, wrong).worst()[0] > ACCURACY


@pytest.mark.parametrize(
    "trial",
    [
        (-1.0007151752095278, -1.0007151752095278, -0.0007151752095277386),
        (-8.702718699394922e-11, 0.0, 1.0000000000870273),
        (-1e-11, -1e-28, 1.00000000001),
        (-1e-11, 3e-24, 1.00000000001),
    ],
)
def test_where_pieces_meet_next_to_the_boundary_the_slip_is_along_all_of_them(trial: tuple[float, ...]) -> None:
    """The two least of three principal stresses tie, or do so at the end of the slip: of max - min <= 1 both pieces are violated."""
    done = duhem.project("tresca", trial, None, 2.0, {"yield_stress": 1.0}, method="newton")
    first, second, third = (Fraction(float(x)) for x in trial)
    a, b = third - first - 1, third - second - 1  # of both pieces, whose normals have 2 and 1 for products: 2 x + y = a, x + 2 y = b
    x, y = ((2 * a - b) / 3, (2 * b - a) / 3) if 2 * b > a else (a / 2, Fraction(0))
    exact = np.array([float(-x / 2), float(-y / 2), float((x + y) / 2)])
    assert done.status[0] == Status.SLIP
    assert done.slip[0] == pytest.approx(exact, rel=1e-6, abs=1e-6 * exact[2])


def test_a_slip_along_the_wrong_one_of_pieces_that_tie_in_doubles_is_inaccurate() -> None:
    trial = np.array([[-4.424982088183314e-17, 1.0, -5.1618341209954984e-17]])
    question = increment(duhem.load("tresca"), trial, None, [1.0, 6000.0, 10.0], {"yield_stress": 1.0})
    for way, k, passes in (([0.0, 1.0, -1.0], 6010.0, True), ([-1.0, 1.0, 0.0], 6000.0, False)):
        amount = -trial[:, 2] / k
        slip = amount[:, None] * np.array(way)
        answer = Solution(trial - slip * [1.0, 6000.0, 10.0], slip, amount, np.zeros(1, dtype=bool))
        assert (residuals(question, answer).worst()[0] <= ACCURACY) == passes


def test_a_slip_over_both_pieces_that_is_off_is_inaccurate() -> None:
    trial = np.array([[-1e-11, -1e-11, 1.0 + 1e-11]])
    question = increment(duhem.load("tresca"), trial, None, 1.0, {"yield_stress": 1.0})
    done = duhem.project("tresca", trial, None, 1.0, {"yield_stress": 1.0}, method="newton")
    slip = done.slip
    for off in (slip * [1.0 + 1e-5, 1.0, 1.0], slip * [1.0, 1.0, 1.0 + 1e-5], slip * [2.0, 0.0, 1.0], slip * 0.999):
        wrong = Solution(trial - off, off, done.multiplier, np.zeros(1, dtype=bool))
        assert residuals(question, wrong).worst()[0] > ACCURACY


@pytest.mark.parametrize("out", [1e-15, 1e-14, 1e-12, 1e-10])
def test_slips_of_less_than_pairs_tell_are_right(out: float) -> None:
    """At (cap, out cap) the boundary is out^2/2 off: 5e-31 of the stress where out is 1e-15."""
    for method in ("closed-form", "newton"):
        done = duhem.project("capped", [1.0, out], -10.0, 1.0, {"mu": 1.0, "tau_max": 1.0}, method=method)
        assert done.status[0] <= Status.SLIP  # a stick where 1e-27 of the stress counts as nothing
        assert done.slip[0] == pytest.approx(np.array([out**2 / 2, out**3 / 2]), rel=1e-6, abs=1e-27)


def test_a_slip_that_is_a_thousandth_off_is_inaccurate_where_it_is_1e_20_of_the_stress() -> None:
    question = increment(duhem.load("capped"), [[1.0, 2e-10]], -10.0, 1.0, {"mu": 1.0, "tau_max": 1.0})
    right = np.array([[2e-20, 4e-30]])
    for factor, passes in ((1.0, True), (1.001, False), (1.0 - 1e-5, False), (0.0, False)):
        slip = factor * right
        answer = Solution(question.trial - slip, slip, slip[:, 0], np.zeros(1, dtype=bool))
        assert (residuals(question, answer).worst()[0] <= ACCURACY) == passes


def test_a_stick_no_further_outside_than_the_least_double_is_one() -> None:
    done = duhem.project("tresca", [-1.0, 8e-321, -0.003], None, [1.0, 6000.0, 10.0], {"yield_stress": 1.0}, method="newton")
    assert done.status[0] == Status.STICK
    assert not done.slip.any()


def test_a_close_look_is_the_same_by_pairs_and_by_balls() -> None:
    question = increment(
        duhem.load("antoni2007"), [[0.3, -0.2], [0.05, 0.07]], -1.0, [2.0, 3.0], dict(zip(NAMES, (0.2, 0.08, 0.12, 0.15), strict=True))
    )
    size = np.full(2, 0.25)
    look = close_look(question)
    points = pushed_back(question.trial, 0.01 * question.trial, question.stiffness, size)
    told, bound = look.level(points, question.pressure, size)
    enclosed = type(look)(look.forces, look.pressed, look.degree, None, look.doubles, look.balls).level(points, question.pressure, size)[0]
    assert np.abs(told - enclosed).max() <= 1e-25 + 2 * np.spacing(np.abs(told).max()) and bound.max() <= 1e-25
    plain = level(question.g, question.law.force_symbols(), question.law.symbols()["sigma_n"])
    at = as_pairs(question.trial, size)
    assert look.slopes(at, question.pressure, size) == pytest.approx(plain.gradient(question.trial, question.pressure, size), rel=1e-14)


NAMES = ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")


def test_the_level_keeps_the_sign_of_g_at_every_size() -> None:
    law = Criterion("tenth", "sigma_a**10 + sigma_b**10 - sigma_n**10")
    a, b = law.force_symbols()
    found = level(law.g, (a, b), law.symbols()["sigma_n"])
    for load in (1e-300, 1e-33, 1.0, 1e300):
        stress = np.array([[0.9, 0.9], [1.01, 0.2], [-0.2, 0.99]]) * load
        assert np.sign(found(*stress.T, np.full(3, -load))).tolist() == [-1.0, 1.0, -1.0]
