"""The reference projection against truths of other origin: printed values, closed forms in 60 digits, brute force."""

from __future__ import annotations

import math
from typing import Any

import cvxpy as cp
import mpmath
import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection import conic_solvers, cvxpy_method
from duhem.projection.conic_solvers import rungs
from duhem.projection.cvxpy_method import CVXPY, applies
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Solution, Status
from tests.long import mostly_long
from tests.oracles.laws_by_hand import ANTONI, FULL, LAWS, Law, increment, norm, question

DEAR = ("hosford", "box", "capped", "cohesive", "regularised", "quartic")  # of their kind others stay
EACH_LAW = pytest.mark.parametrize("law", mostly_long(LAWS, *(law for law in LAWS if law.name not in DEAR)), ids=Law.label)


def solve(question: Increment, **options: Any) -> Solution:
    """The method alone, unjudged."""
    return CVXPY.solve(question, CVXPY.options_of(options))


# -- truths ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "trial, k, sigma",
    [
        ((0.3, 0.2), (1, 1), (0.16948295870263982786, 0.063711769834024715701)),
        ((-0.3, 0.2), (1, 1), (-0.0626859952990218239, 0.074555673728327216011)),
        ((-0.3, -0.2), (1, 4), (-0.076140510365716901921, -0.046028201830649999767)),
        ((0.3, -0.01), (1, 1), (0.19987561244121522753, -0.0052894704439702478874)),
    ],
)
def test_reference_values(trial: Any, k: Any, sigma: Any) -> None:
    answer = solve(increment("antoni2007", trial, -1.0, np.diag(k), ANTONI))
    assert not answer.failed.any()
    np.testing.assert_allclose(answer.stress[0], sigma, rtol=0, atol=1e-9)
    np.testing.assert_allclose(answer.slip[0], (np.array(trial) - sigma) / k, rtol=0, atol=1e-9)
    gradient = [s / m**2 for s, m in zip(sigma, (0.2 if sigma[0] > 0 else 0.08, 0.12 if sigma[1] > 0 else 0.15), strict=True)]
    np.testing.assert_allclose(answer.multiplier * gradient, answer.slip[0], rtol=0, atol=1e-9)


def ellipse_point(trial: Array, k: Array, mu: tuple[float, float]) -> list[float]:
    """sigma_i = t_i/(1 + nu k_i/mu_i^2) on the ellipse of half-axes mu, nu by bisection in 60 digits."""
    with mpmath.workdps(60):
        t, stiff, half = ([mpmath.mpf(float(x)) for x in v] for v in (trial, k, mu))

        def point(nu: Any) -> list[Any]:
            return [a / (1 + nu * c / m**2) for a, c, m in zip(t, stiff, half, strict=True)]

        def outside(nu: Any) -> bool:
            return mpmath.fsum((s / m) ** 2 for s, m in zip(point(nu), half, strict=True)) > 1

        low, high = mpmath.mpf(0), mpmath.mpf(1)
        while outside(high):
            high *= 4
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if outside(middle) else (low, middle)
        return [float(s) for s in point(low)]


@pytest.mark.parametrize("ratio", [1.0, 1e-4, 1e6])
def test_ellipse_in_sixty_digits(ratio: float) -> None:
    trial = np.random.default_rng(2).normal(size=(12, 2))
    trial = trial[norm(trial[:, 0] / 0.3, trial[:, 1] / 0.1) > 1]
    k = np.array([1.0, ratio])
    answer = solve(increment("orthotropic", trial, -1.0, np.diag(k), {"mu_a": 0.3, "mu_b": 0.1}))
    expected = [ellipse_point(t, k, (0.3, 0.1)) for t in trial]
    np.testing.assert_allclose(answer.stress, expected, rtol=0, atol=1e-8)


def test_disk_and_box_in_closed_form() -> None:
    trial = np.random.default_rng(3).normal(size=(9, 2))
    disk = solve(increment("coulomb", trial, -1.0, 5.0, {"mu": 0.1}))
    np.testing.assert_allclose(disk.stress, 0.1 * trial / norm(*trial.T)[:, None], atol=1e-9)
    np.testing.assert_allclose(disk.multiplier, (norm(*trial.T) - 0.1) / 5.0, rtol=1e-8)
    box = solve(increment("box", trial, -1.0, np.diag([5.0, 7.0]), {"mu_a": 0.1, "mu_b": 0.2}))
    np.testing.assert_allclose(box.stress, np.clip(trial, [-0.1, -0.2], [0.1, 0.2]), atol=1e-9)


def test_line() -> None:
    trial = np.array([[0.5], [-0.5], [0.1], [-0.15]])
    answer = solve(increment("antoni2007-1d", trial, -1.0, 4.0, {"mu_plus": 0.2, "mu_minus": 0.1}))
    np.testing.assert_allclose(answer.stress[:, 0], [0.2, -0.1, 0.1, -0.1], atol=1e-10)
    np.testing.assert_allclose(answer.multiplier, [0.3 / 4 * 0.2, 0.4 / 4 * 0.1, 0.0, 0.05 / 4 * 0.1], atol=1e-10)


@pytest.mark.slow
@EACH_LAW
def test_every_law_against_brute_force(law: Law) -> None:
    asked = question(law)
    answer = solve(asked.asked)
    assert not answer.failed.any()
    stress = asked.stresses(answer)
    slipping = np.array([not asked.inside(t) for t in asked.plane])
    assert slipping.sum() > 5
    np.testing.assert_allclose(stress, [asked.closest(t) for t in asked.plane], rtol=0, atol=2e-6)
    assert np.max(asked.violation(stress)) < 1e-6
    np.testing.assert_array_equal(answer.multiplier[~slipping], 0.0)
    work = np.sum((answer.stress - (np.array(law.centre) * asked.load if not law.principal else 0)) * answer.slip, axis=1)
    euler = (law.euler or law.radius)(asked.load)
    np.testing.assert_allclose(answer.multiplier, work / euler, rtol=0, atol=1e-5 * np.max(work / euler))


@pytest.mark.slow
@EACH_LAW
def test_the_unit_does_not_matter(law: Law) -> None:
    reference = solve(question(law).asked)
    for scale in (1e-9, 1e-6, 1e6, 1e9):
        answer = solve(question(law, scale).asked)
        assert not answer.failed.any()
        np.testing.assert_allclose(answer.stress / scale, reference.stress, rtol=0, atol=2e-6)
        np.testing.assert_allclose(answer.slip / scale, reference.slip, rtol=0, atol=2e-6)
        most = np.max(reference.multiplier)
        np.testing.assert_allclose(answer.multiplier / scale ** (2 - law.degree), reference.multiplier, rtol=0, atol=1e-5 * most)


@pytest.mark.parametrize("scale", [1e-290, 1e-100, 1e100, 1e290])
@pytest.mark.parametrize("k", [1e-12, 1e12])
def test_units_of_any_size(scale: float, k: float) -> None:
    plain = solve(increment("antoni2007", [[0.3, 0.2], [-0.3, -0.2]], -1.0, FULL, ANTONI))
    other = solve(increment("antoni2007", np.array([[0.3, 0.2], [-0.3, -0.2]]) * scale, -scale, FULL * k, ANTONI))
    np.testing.assert_allclose(other.stress / scale, plain.stress, rtol=1e-7)
    np.testing.assert_allclose(other.multiplier / scale * k, plain.multiplier, rtol=1e-7)


@pytest.mark.slow
def test_a_far_trial_finds_the_exposed_point() -> None:
    """As the trial goes away, sigma tends to the point of K that maximises sigma . k^-1 sigma_tr."""
    far = np.array([[0.3, 0.2], [-0.3, -0.2], [0.1, -0.4]])
    push = far @ np.linalg.inv(FULL)
    square = np.where(push > 0, [0.2, 0.12], [0.08, 0.15]) ** 2
    expected = square * push / np.sqrt(np.sum(square * push**2, axis=1))[:, None]
    for distance in (1e12, 1e200):
        answer = solve(increment("antoni2007", far * distance, -1.0, FULL, ANTONI))
        np.testing.assert_allclose(answer.stress, expected, rtol=1e-6)


def test_without_pressure_nothing_is_carried() -> None:
    trial = [[0.3, 0.2], [-0.3, 0.1], [0.0, -0.2]]
    answer = solve(increment("antoni2007", trial, 0.0, FULL, ANTONI))
    assert np.max(np.abs(answer.stress)) < 1e-9
    np.testing.assert_allclose(answer.slip, np.array(trial) @ np.linalg.inv(FULL), rtol=1e-8)
    assert np.all(answer.multiplier >= 0)


def test_trial_inside_is_kept_to_the_last_bit() -> None:
    trial = np.array([[0.1, 0.05], [0.0, 0.0], [-0.05, 0.01]])
    answer = solve(increment("antoni2007", trial, -1.0, FULL, ANTONI))
    np.testing.assert_array_equal(answer.stress, trial)
    assert not answer.slip.any() and not answer.multiplier.any() and not answer.failed.any()


@pytest.mark.slow
@pytest.mark.parametrize("law", [LAWS[2], LAWS[5], LAWS[10]], ids=Law.label)
def test_a_batch_is_its_points(law: Law) -> None:
    trial = np.random.default_rng(4).normal(size=(11, 2))
    pressure = -np.geomspace(1e-3, 1e3, 11)
    asked = increment(law.name, trial, pressure, FULL, law.parameters)
    single = solve(asked, batch=1)
    for batch in (4, 11, 100):
        stacked = solve(asked, batch=batch)
        np.testing.assert_allclose(stacked.stress, single.stress, rtol=0, atol=1e-6)
        np.testing.assert_allclose(stacked.multiplier, single.multiplier, rtol=1e-4, atol=1e-6)


# -- laws that are no norm ---------------------------------------------------------------------------------------------


def test_five_forces() -> None:
    names = tuple(f"s{i}" for i in range(5))
    law = Criterion("ball", "norm(s0, s1, s2, s3, s4) + sigma_n", forces=names)
    trial = np.array([[1.0, 2.0, 3.0, 4.0, 5.0]])
    np.testing.assert_allclose(solve(increment(law, trial, -1.0)).stress, trial / np.linalg.norm(trial), atol=1e-9)


def test_a_law_that_has_no_scale_of_its_own() -> None:
    law = Criterion("exponential", "exp(sigma_a/0.3) + abs(sigma_b) + sigma_n")
    answer = solve(increment(law, [[2.0, 0.0]], [-3.0], 4.0))
    np.testing.assert_allclose(answer.stress, [[0.3 * math.log(3.0), 0.0]], atol=1e-8)
    np.testing.assert_allclose(answer.multiplier, (2.0 - 0.3 * math.log(3.0)) / 4.0 * 0.1, rtol=1e-7)


def test_a_case_distinction_on_the_pressure_is_one_problem_a_pressure() -> None:
    law = Criterion("two-regimes", "norm(sigma_a, sigma_b) - where(sigma_n < -1, 0.5, 0.25)*abs(sigma_n)")
    answer = solve(increment(law, [[3.0, 4.0]] * 3, [-1.0, -2.0, -1.0]))
    np.testing.assert_allclose(answer.stress, [[0.15, 0.2], [0.6, 0.8], [0.15, 0.2]], atol=1e-9)


def test_a_set_without_the_origin() -> None:
    law = Criterion("far-disk", "norm(sigma_a - 5, sigma_b) - 1")
    answer = solve(increment(law, [[0.0, 0.0], [9.0, 0.0], [5.0, 0.5]], -1.0))
    np.testing.assert_allclose(answer.stress, [[4.0, 0.0], [6.0, 0.0], [5.0, 0.5]], atol=1e-8)


def test_an_empty_set_is_a_failure_of_its_point_alone() -> None:
    law = Criterion("needs-pressure", "norm(sigma_a, sigma_b) + 1 + sigma_n")
    answer = solve(increment(law, [[3.0, 4.0], [3.0, 4.0]], [-2.0, -0.5]))
    np.testing.assert_array_equal(answer.failed, [False, True])
    np.testing.assert_allclose(answer.stress[0], [0.6, 0.8], atol=1e-9)
    assert np.isnan(answer.stress[1]).all()


@pytest.mark.parametrize(
    "name, parameters, part",
    [
        ("limacon", {"mu": 0.3, "e": 0.4}, "norm(sigma_a, sigma_b)"),
        ("quartic", {"mu": 0.3, "c": 3}, "3*sigma_a**2*sigma_b**2"),
        ("matchstick", {"mu_a": 0.3, "mu_b": 0.25}, "norm(sigma_a, sigma_b)"),
    ],
)
def test_what_is_not_dcp_is_named_with_another_method(name: str, parameters: dict[str, float], part: str) -> None:
    asked = increment(name, [[1.0, 1.0]], -1.0, parameters=parameters)
    reason = applies(asked)
    assert reason is not None and part in reason and "method='newton'" in reason
    with pytest.raises(InputError, match="newton"):
        solve(asked)


def test_a_flow_of_its_own_is_not_the_closest_point() -> None:
    reason = applies(increment("radial-flow", [[1.0, 1.0]], -1.0, parameters={"mu_a": 0.3, "mu_b": 0.2}))
    assert reason is not None and "flow" in reason


# -- solvers and their options -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", cp.installed_solvers())
@pytest.mark.parametrize("law", [LAWS[2], LAWS[3], LAWS[10]], ids=Law.label)
def test_every_installed_solver_answers_or_says_why_not(law: Law, solver: str) -> None:
    asked = question(law, count=4)
    try:
        answer = solve(asked.asked, solver=solver.lower())
    except InputError as error:
        assert solver != "CLARABEL" and solver in str(error)
        return
    assert np.max(asked.violation(asked.stresses(answer))) < 1e-5


def test_a_poor_answer_shows_in_its_residuals() -> None:
    asked = question(LAWS[2])
    fine, poor = (solve(asked.asked, tolerance=tolerance) for tolerance in (None, 1e-2))
    assert not poor.failed.any()
    assert np.max(asked.violation(asked.stresses(fine))) < 1e-7
    assert np.max(asked.violation(asked.stresses(poor))) > 1e-5


def test_a_tighter_tolerance_is_a_closer_answer() -> None:
    asked = question(LAWS[2]).asked
    best = solve(asked).stress
    errors = [np.max(np.abs(solve(asked, tolerance=tolerance).stress - best)) for tolerance in (1e-2, 1e-5, 1e-8, 1e-11)]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 1e-2 * errors[0]


def test_a_warm_start_changes_no_more_than_the_tolerance() -> None:
    asked = question(LAWS[2])
    np.testing.assert_allclose(solve(asked.asked, warm_start=True, batch=2).stress, solve(asked.asked).stress, atol=1e-7)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"solver": "NOSUCH"}, "solver: the solver 'NOSUCH' is not installed; installed are .*CLARABEL"),
        ({"tolerance": 0.0}, "tolerance: the tolerance 0.0 is not a positive number"),
        ({"tolerance": math.nan}, "tolerance: the tolerance nan is not a positive number"),
        ({"batch": 0}, "batch: batch 0 is not a count of points"),
        ({"batch": 2.5}, "batch: batch 2.5 is not a count of points"),
    ],
)
def test_bad_options_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        solve(increment("coulomb", [[1.0, 0.0]], -1.0, parameters={"mu": 0.3}), **options)


def test_a_tolerance_needs_a_solver_whose_word_for_it_is_known() -> None:
    with pytest.raises(InputError, match="does not know the tolerance option of"):
        rungs("NOSUCH", 1e-6)


# -- compiled once -----------------------------------------------------------------------------------------------------


def test_a_problem_is_compiled_once_for_a_law_and_a_stiffness(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other points and pressures only change its parameters, and the numbers do not depend on what was solved before."""
    posed: list[Any] = []
    right = cp.Problem
    monkeypatch.setattr(cp, "Problem", lambda *a: posed.append(a) or right(*a))
    k = [1.0, 2.718281828]  # asked for by no other test
    first = duhem.project("antoni2007", [0.3, 0.2], -1.0, k, ANTONI, method="cvxpy")
    assert len(posed) == 1
    duhem.project("antoni2007", [9.0, 6.0], -2.0, k, ANTONI, method="cvxpy")
    again = duhem.project("antoni2007", [0.3, 0.2], -1.0, k, ANTONI, method="cvxpy")
    assert len(posed) == 1
    assert np.array_equal(first.stress, again.stress) and np.array_equal(first.multiplier, again.multiplier)
    duhem.project("antoni2007", [0.3, 0.2], -1.0, [1.0, 2.5], ANTONI, method="cvxpy")
    assert len(posed) == 2


def test_a_block_that_comes_again_is_not_put_to_the_solver_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """With another tolerance, say; and no block is answered for another."""
    made: list[Any] = []
    right = conic_solvers.compiled
    monkeypatch.setattr(conic_solvers, "compiled", lambda *a: made.append(a) or right(*a))
    monkeypatch.setattr(cvxpy_method, "_KEPT", 2)
    near, far, beside = (
        increment("antoni2007", [trial], -1.0, np.diag([1.0, 3.141592]), ANTONI) for trial in ([0.3, 0.2], [9.0, 6.0], [0.6, 0.4])
    )
    first = solve(near, tolerance=1e-10)
    solve(near, tolerance=1e-6)
    other = solve(far, tolerance=1e-10)
    assert len(made) == 2 and np.abs(other.stress - first.stress).max() > 0.01
    again = solve(near, tolerance=1e-10)
    assert len(made) == 2 and np.array_equal(first.stress, again.stress) and np.array_equal(first.multiplier, again.multiplier)
    solve(beside, tolerance=1e-10)
    assert len(made) == 3
    again = solve(near, tolerance=1e-10)
    assert len(made) == 4 and np.array_equal(first.stress, again.stress)  # what came first has made room


@pytest.mark.parametrize("beyond", [1e-7, 1e-9, 1e-11])
def test_lost_slips_are_put_right_without_asking_again(beyond: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Next to the boundary no tolerance finds the slip, so the solver is asked once for all points."""
    asked: list[Any] = []
    right = conic_solvers.ran
    monkeypatch.setattr(conic_solvers, "ran", lambda *a, **k: asked.append(a) or right(*a, **k))
    turn = np.linspace(0.1, 6.0, 8)
    trial = 0.4 * (1.0 + beyond) * np.column_stack([np.cos(turn), np.sin(turn)])
    answer = duhem.project("coulomb", trial, -1.0, [1.0, 3.0], {"mu": 0.4}, method="cvxpy")
    assert (answer.status == Status.SLIP).all() and len(asked) == 1
