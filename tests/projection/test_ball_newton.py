"""Where the metric of the stiffness hides a component, answers are right or flagged; what was flagged is found in many digits."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection import closed_form, extended_precision, newton
from duhem.projection.extended_precision import close_look, closest
from duhem.projection.increment import increment
from duhem.projection.residuals import Judge, residuals
from duhem.projection.result import ACCURACY, Residuals, Solution, Status
from tests.campaigns.increments import at_simplest, pressure_of
from tests.campaigns.increments import trials as around
from tests.campaigns.number_families import FAMILIES, Question, mp
from tests.campaigns.numbers import Count, answers, distance, tally
from tests.long import long_but, mostly_long
from tests.projection.test_apexes import APEXES, trials


def flat(formula: str) -> Criterion:
    return Criterion("flat", formula, pressure=None)


@pytest.mark.slow
@pytest.mark.parametrize("power", [2, 3, 4, 6])
@pytest.mark.parametrize("stiff", [1.0, 1e6, 1e12])
def test_flats_that_join_curves(power: int, stiff: float) -> None:
    """x = sigma_a - 1 solves  sigma_a trial - 1 - x = k_a lambda p x^(p - 1),  lambda p b^(p - 1) = trial_b - b,  x^p + b^p = 1."""
    trial = [14.93165762337459, 9.343254542223587]
    done = duhem.project(flat(f"pos(abs(sigma_a) - 1)**{power} + abs(sigma_b)**{power} - 1"), [trial], None, [stiff, 1.0], method="newton")
    first, second = map(mp.mpf, trial)

    def missed(x: Any) -> Any:
        b = (1 - x**power) ** (mp.mpf(1) / power)
        return (first - 1 - x) - stiff * (second - b) * (x / b) ** (power - 1)

    low, high = mp.mpf(0), mp.mpf(1)
    for _ in range(400):
        middle = (low + high) / 2
        low, high = (middle, high) if missed(middle) > 0 else (low, middle)
    assert done.status[0] == Status.SLIP
    assert done.stress[0, 0] == pytest.approx(float(1 + low), rel=ACCURACY)
    assert done.slip[0] == pytest.approx([float((first - 1 - low) / stiff), 9.343254542223587 - done.stress[0, 1]], rel=1e-6)


@pytest.mark.parametrize("ratio", [1e6, 1e8, 1e12])
def test_an_answer_with_one_component_off_is_inaccurate(ratio: float) -> None:
    """The stiffer force of a corner 1e-5 off is 1e-8 of the stress and less in the metric."""
    question = increment(duhem.load("box"), [[2.0, 1.0 + 1e-3]], -1.0, [1.0, ratio], {"mu_a": 1, "mu_b": 1})
    for off, passes in ((0.0, True), (1e-5, False), (1e-6, False), (1e-9, True)):
        stress = np.array([[1.0, 1.0 - off]])
        slip = (question.trial - stress) / [1.0, ratio]
        answer = Solution(stress, slip, slip.sum(axis=1), np.zeros(1, dtype=bool))
        assert (residuals(question, answer).worst()[0] <= ACCURACY) == passes


def test_a_slip_with_one_component_off_is_inaccurate() -> None:
    """The softer displacement carries little of the metric's length."""
    k = np.array([1e12, 1.0])
    question = increment(duhem.load("orthotropic"), [[3e6, 5.0]], -1.0, k, {"mu_a": 1e6, "mu_b": 1.0})
    right = closed_form.solve(question)
    assert residuals(question, right).worst()[0] <= ACCURACY
    wrong = replace(right, stress=right.stress - [[0.0, 1e-4]], slip=right.slip + np.array([[0.0, 1e-4]]))
    assert residuals(question, wrong).worst()[0] > ACCURACY


def test_what_the_judge_looked_for_is_not_looked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a corner of a box, the stiffer force 1e-5 off, which is 1e-8 of the stress in the metric; and beside it a stick."""
    question = increment(duhem.load("box"), [[0.5, 0.0], [2.0, 1.0 + 1e-3]], -1.0, [1.0, 1e6], {"mu_a": 1, "mu_b": 1})
    stress = np.array([[0.5, 0.0], [1.0, 1.0 - 1e-5]])
    slip = (question.trial - stress) / [1.0, 1e6]
    wrong = Solution(stress, slip, slip.sum(axis=1), np.zeros(2, dtype=bool))
    found = residuals(question, wrong)
    _, seen = Judge.of(question, wrong, True).look(wrong, Residuals(*(np.zeros(2) for _ in range(5))))
    assert list(seen) == [1] and seen[1] is not None
    put_right, judged = extended_precision.put_right(question, wrong, found, residuals, seen)
    assert (judged.worst() <= ACCURACY).all()
    assert put_right.stress == pytest.approx(np.array([[0.5, 0.0], [1.0, 1.0]]), rel=1e-12)
    starts = list[Any]()

    def again(_: object, __: object, ___: object, ____: object, start: Any, *_____: object, **______: object) -> None:
        starts.append(start)

    monkeypatch.setattr(extended_precision, "closest", again)
    extended_precision.put_right(question, wrong, found, residuals, seen)
    assert not any(np.array_equal(start, stress[1]) for start in starts)
    extended_precision.put_right(question, wrong, found, residuals, {1: None})
    assert np.array_equal(starts[-1], stress[1])


@pytest.mark.parametrize("how", [1e-5, -1e-5, "turned"])
def test_what_is_plainly_wrong_is_refused_without_many_digits(how: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def looked(*_: object, **__: object) -> None:
        raise AssertionError("looked for")

    monkeypatch.setattr(extended_precision, "closest", looked)
    question = increment(duhem.load("superellipse"), [[2.0, 1.0], [-0.5, 0.6]], -1.0, 1.0, {"mu_a": 0.3, "mu_b": 0.1, "p": 4})
    right = newton.solve(question)
    stress = right.stress * (1.0 + how) if how != "turned" else right.stress[::-1] * [-1.0, 1.0]
    wrong = replace(right, stress=stress, slip=question.trial - stress)
    own = replace(newton.NEWTON, name="own", again=None, solve=lambda *_: wrong)
    done = duhem.project("superellipse", question.trial, -1.0, 1.0, {"mu_a": 0.3, "mu_b": 0.1, "p": 4}, method=own)
    assert (done.status == Status.INACCURATE).all()


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1e6, 1e8])
def test_a_cone_program_is_put_right_in_components(ratio: float) -> None:
    trial = [[2.0, 3.0], [0.2, 3.0], [2.0, 0.2], [2.0, 1.0000001]]
    done = duhem.project("box", trial, -1.0, [1.0, ratio], {"mu_a": 1, "mu_b": 1}, method="cvxpy")
    exact = np.clip(trial, -1.0, 1.0)
    assert (done.status == Status.SLIP).all()
    assert np.abs(done.stress - exact).max() <= 1e-7
    slip = (np.array(trial) - exact) / [1.0, ratio]
    assert (np.abs(done.slip - slip).max(axis=1) <= 1e-6 * slip.max(axis=1)).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([0], ["drucker-prager", "drucker-prager-tensor"]))
@pytest.mark.parametrize("aside", [1e-12, 1e-9, 1e-6])
def test_next_to_the_axis_of_an_apex(name: str, aside: float) -> None:
    law = duhem.load(name)
    trial = np.zeros((1, len(law.forces)))
    trial[0, :3] = 5.0
    trial[0, 2 if len(law.forces) == 3 else 3] += aside
    k = np.where(np.arange(len(law.forces)) < 3, 1.0, 0.5)
    done = duhem.project(law, trial, None, k, {"alpha": 0.2, "k": 1})
    apex = np.where(np.arange(len(law.forces)) < 3, 5 / 3, 0.0)
    assert done.status[0] == Status.SLIP
    assert done.stress[0] == pytest.approx(apex, abs=1e-14)
    assert done.slip[0] == pytest.approx((trial[0] - apex) / k, rel=1e-9, abs=1e-14)


@pytest.mark.slow
def test_a_wrong_answer_is_not_put_right() -> None:
    """Only what is the same in the metric: a method that is wrong stays flagged, and from afar nothing is found or it is far."""
    question = increment(duhem.load("superellipse"), [[2.0, 1.0]], -1.0, 1.0, {"mu_a": 0.3, "mu_b": 0.1, "p": 4})
    right = newton.solve(question)
    for off in (1e-6, 1e-3, 0.3):
        wrong = replace(right, stress=right.stress * [[1.0 - off, 1.0]], slip=right.slip + right.stress * [[off, 0.0]])
        assert residuals(question, wrong).worst()[0] > ACCURACY
    for multiplier in (0.5, 1.001, np.nan):
        assert not residuals(question, replace(right, multiplier=multiplier * right.multiplier)).worst()[0] <= ACCURACY


SHORT = product(["antoni2007", "hosford", "tresca", "box", "matchstick"], [1e-3, 1e-6, 1e-10, 1e-14], [False, True])
KEPT = [("antoni2007", 1e-14, False), ("antoni2007", 1e-6, True), ("tresca", 1e-10, False), ("box", 1e-3, True), ("box", 1e-6, False)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "short", "stiff"), mostly_long(SHORT, *KEPT))
def test_the_multiplier_of_a_short_slip_is_no_other(name: str, short: float, stiff: bool) -> None:
    """It moves the stress by next to nothing, and is as wrong as that of a long one."""
    law = at_simplest(name)
    far, pressure, d = around(law, 1)[:6], pressure_of(law), len(law.forces)
    k = np.diag(np.geomspace(1.0, 1e8 if stiff else 1.0, d))
    there = duhem.project(law, far, pressure, k)
    slips = there.status == Status.SLIP
    trial = there.stress[slips] + (far - there.stress)[slips] * short
    done = duhem.project(law, trial, pressure, k)
    assert len(trial) and (done.status == Status.SLIP).all()
    asked, none = increment(law, trial, pressure, k, None), np.zeros(len(trial), dtype=bool)
    for share, passes in ((1.0, True), (1.0 + 1e-9, True), (1.0 + 1e-4, False), (2.0, False), (0.0, False), (1e5, False)):
        given = Solution(done.stress, done.slip, share * done.multiplier, none)
        assert ((residuals(asked, given).worst() <= ACCURACY) == passes).all()


def test_where_more_sides_meet_than_forces_are_there_are_several_multipliers() -> None:
    law = Criterion("three sides", "max(a - 1, b - 1, a + b - 2)", forces=("a", "b"), pressure=None)
    asked = increment(law, [[1.0 + 1e-9, 1.0 + 1e-9]], None, 1.0, None)
    slip = asked.trial - 1.0
    for multiplier, passes in ((slip.sum(), True), (slip[:, 0].sum(), True), (0.0, False)):
        given = Solution(np.ones((1, 2)), slip, np.array([multiplier]).ravel(), np.zeros(1, dtype=bool))
        assert (residuals(asked, given).worst()[0] <= ACCURACY) == passes


@pytest.mark.parametrize("start", [(0.3, 0.1), (0.299, 0.0999), (0.2, 0.1)])
def test_the_closest_point_in_many_digits(start: tuple[float, float]) -> None:
    question = increment(duhem.load("box"), [[2.0, 0.5]], -1.0, [1.0, 3.0], {"mu_a": "3/10", "mu_b": "1/10"})
    found = closest(close_look(question), question.trial[0], -1.0, question.stiffness, np.array(start), 0.0, 0.25)
    assert found is not None
    stress, slip, multiplier, single = found
    assert single
    assert stress.tolist() == [0.3, 0.1]
    assert slip == pytest.approx([1.7, 0.4 / 3], rel=1e-15)
    assert multiplier == pytest.approx(0.3 * 1.7 + 0.1 * 0.4 / 3, rel=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values", "apex", "wide"), APEXES)
def test_the_apex_of_bent_sides_in_many_digits(name: str, values: dict[str, Any], apex: float, wide: float) -> None:
    """Its half-spaces are found in turn, beside the given stress and then where they meet, which is where K ends."""
    asked = trials(apex, wide)[[0, 3, 8, 11]]
    question = increment(duhem.load(name).fix(values), asked, None, 1.0, None)
    size = 2.0 ** np.floor(np.log2(abs(apex)))
    for trial in asked:
        found = closest(close_look(question), trial, 0.0, question.stiffness, np.full(3, apex) * (1.0 + 4e-16), 0.0, size, patient=False)
        assert found is not None
        np.testing.assert_allclose(found[0], apex, rtol=4e-16)
        np.testing.assert_allclose(found[1], trial - apex, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("far", [1.0, 1e6])
def test_the_tip_of_a_cone_in_the_origin_is_no_stress_in_many_digits(far: float) -> None:
    law = Criterion("cone", "norm(a, b) - c", forces=("a", "b", "c"), pressure=None)
    question = increment(law, far * np.array([[0.3, -0.2, -1.0], [0.3, 0.2, -0.1]]), None, 1.0, {})
    found = [closest(close_look(question), t, 0.0, question.stiffness, np.zeros(3), 0.0, 0.25 * far) for t in question.trial]
    assert found[0] is not None and found[0][0].tolist() == [0.0] * 3 and found[0][1].tolist() == question.trial[0].tolist()
    assert found[1] is None or found[1][0].any()


@pytest.mark.slow
def test_a_number_of_g_beyond_doubles_is_no_hindrance() -> None:
    """k^6 of Drucker's law is 1e1740; g in units of its own holds k alone."""
    law, k = {"c": 2}, 7e289
    trial = np.array([[0.9, -1.1, 0.2]])
    far = duhem.project("drucker1949", trial * k, None, [1.0, 1e3, 1e6], {**law, "k": k})
    near = duhem.project("drucker1949", trial, None, [1.0, 1e3, 1e6], {**law, "k": 1})
    assert far.status[0] == near.status[0] == Status.SLIP
    assert far.stress[0] / k == pytest.approx(near.stress[0], rel=1e-7)


def test_bent_sides_meet_within_a_length_and_not_a_level() -> None:
    """One level is 2^13 times as steep as another: what is nothing of a length is more than that of its number."""
    law = Criterion("bent", "max(s1, 2**24*s2**2, 2**12*s3**2) - 1", forces=("s1", "s2", "s3"), pressure=None)
    stress, slip = np.array([1.0, 2.0**-12, 2.0**-6]), 2.0**-27 * np.array([[1.0, 2.0**13, 2.0**7]])
    question = increment(law, stress + slip, None, 1.0, {})
    right = Solution(stress[None], slip, np.array([3 * 2.0**-27]), np.zeros(1, dtype=bool))
    found = closest(close_look(question), question.trial[0], 0.0, question.stiffness, stress, 0.0, 1.0, patient=False)
    assert found is not None and found[0].tolist() == stress.tolist() and found[1].tolist() == slip[0].tolist()
    assert residuals(question, right, convex=True).worst()[0] <= ACCURACY
    for off in (2e-6, 1e-5, 1e-3):
        assert residuals(question, replace(right, slip=slip * (1.0 + off)), convex=True).worst()[0] > ACCURACY


@pytest.mark.parametrize("off", [5e-8, 2e-6, 1e-5, 1e-3])
def test_a_slip_that_is_right_in_its_components_is_put_right_where_k_is_thin(off: float) -> None:
    """Of a thin K the normal turns by 1e-8 within the rounding of a stress; times k = 1e6 that is no rounding any more."""
    parameters, trial = {"mu_a": 0.3, "mu_b": 1e-7}, np.array([[298.50124958340774, 9.983341664682815e-06]])
    right = duhem.project("orthotropic", trial, -1.0, [1.0, 1e6], parameters, method="closed-form")
    for way in ([0.0, 1.0], [1.0, 0.0], [1.0, 1.0]):
        slip = right.slip + off * right.slip[:, :1] * way
        given = Solution(right.stress, slip, right.multiplier, np.zeros(1, dtype=bool))
        own = replace(newton.NEWTON, name="own", again=None, solve=lambda _, __, given=given: given)
        done = duhem.project("orthotropic", trial, -1.0, [1.0, 1e6], parameters, method=own)
        assert done.status[0] == (Status.SLIP if off < 1e-6 else Status.INACCURATE)
        assert off > 1e-6 or done.slip[0] == pytest.approx(right.slip[0], rel=1e-12)


@pytest.mark.slow
def test_the_soft_part_of_a_long_slip_adds_up_with_its_stress() -> None:
    """It is 1e-12 of the slip, so that 1e-7 of it is within what is vouched for, and more than a stress is."""
    parameters = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 1.5e-13}
    trial = np.array([[-58074584336.011215, -0.10316492387759604]])
    right = duhem.project("antoni2007", trial, -1.0, 1.0, parameters, method="closed-form")
    for off, status in ((0.0, Status.SLIP), (1.4e-8 / 5.8e10, Status.SLIP), (2e-6, Status.INACCURATE), (1e-3, Status.INACCURATE)):
        given = replace(right, stress=np.array([[-0.08, 0.0]]), slip=right.slip + off * right.slip[:, :1] * [[0.0, 1.0]])
        own = replace(
            newton.NEWTON, name="own", again=None, solve=lambda _, __, a=given: Solution(a.stress, a.slip, a.multiplier, a.status < 0)
        )
        done = duhem.project("antoni2007", trial, -1.0, 1.0, parameters, method=own)
        assert done.status[0] == status
        assert status == Status.INACCURATE or done.slip[0] == pytest.approx(right.slip[0], rel=1e-14)


def test_what_rounding_calls_a_point_of_k_speaks_against_no_answer() -> None:
    """In doubles this disk of radius 1e-6 has g < 0 far out on the axes; other answers than the closest are told all the same."""
    law = Criterion("far", "(sigma_a + 1000)**2 + (sigma_b - 500)**2 - 2000*sigma_a + 1000*sigma_b - 1250000 - sigma_n**2")
    angle = np.array([0.1, 0.7, 2.0, 3.9])
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    question = increment(law, 2.3e-6 * way, -1e-6, 1.0, {})
    for turned, right in ((0.0, True), (1e-3, False), (0.5, False)):
        there = 1e-6 * np.stack([np.cos(angle + turned), np.sin(angle + turned)], axis=1)
        slip = question.trial - there
        given = Solution(there, slip, np.linalg.norm(slip, axis=1) / 2e-6, np.zeros(4, dtype=bool))
        assert ((residuals(question, given, convex=True).worst() <= ACCURACY) == right).all()


SAMPLES = [("joined", 6, 25), ("stiff", 51, 20), ("slender", 51, 8), ("stiff", 204, 5)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "every", "right"), mostly_long(SAMPLES, SAMPLES[3]))
def test_families_of_stiffnesses_far_apart(name: str, every: int, right: int) -> None:
    counts: list[Count] = list(tally(iter(list(FAMILIES[name]())[::every]), ["closed-form", "newton"]).values())
    assert sum(c.right for c in counts) >= right
    assert sum(c.wrong_stress + c.wrong_slip + c.right_flagged + c.unvouched_flagged for c in counts) == 0


def test_the_reference_takes_no_piece_that_does_not_hold() -> None:
    """Where a flat joins a cubic, both pieces vanish to third order, and their corner is none."""
    law = flat("pos(abs(sigma_a) - 1)**3 + abs(sigma_b)**3 - 1")
    ((stress, _),) = [a for a in answers(Question(law, {}, np.array([[-1.001, -40.0]]), None, np.array([1e6, 1.0]))) if a]
    assert distance([-1.0000050508925524, -1.0], stress) <= 1e-12
