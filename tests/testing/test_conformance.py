"""What the conformance suite must accept, and how a failure is told."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

import duhem
from duhem.errors import InputError
from duhem.testing import (
    Case,
    Report,
    Step,
    assert_conforms,
    cases,
    check,
    checks_for,
    conformance,
    decades,
    from_displacements,
    pointwise,
    projection,
    stiffnesses,
    violation,
)
from tests.oracles.routines import (
    DISK,
    ELLIPSE,
    Array,
    ellipse,
    nothing,
    raises,
    wrong_shape,
)

# -- what is right is accepted -----------------------------------------------------------------------------------------


def accepted(report: Report) -> None:
    assert report.ok, str(report)
    assert report.flagged == 0


def test_a_stress_where_g_has_no_gradient_is_admissible() -> None:
    root = duhem.Criterion(name="root", g="sqrt(a**2 + b**2) - 1", forces=("a", "b"), pressure=None)
    zero = np.zeros((1, 2))
    whole = {name: zero for name in ("other", "third", "inside", "beside")}
    case = Case({}, np.eye(2), None, zero, **whole, stretch=np.ones(1), factor=2.0, path=np.zeros((1, 2, 2)), loads=np.zeros((1, 2)))
    assert violation("feasibility", root, lambda trial, pressure, stiffness: trial, case) is None
    outside = Case({}, np.eye(2), None, zero + 1, **whole, stretch=np.ones(1), factor=2.0, path=np.zeros((1, 2, 2)), loads=np.zeros((1, 2)))
    assert violation("feasibility", root, lambda trial, pressure, stiffness: trial, outside) is not None


@pytest.mark.slow
@pytest.mark.parametrize("check", checks_for("coulomb"))
def test_one_test_a_check_as_a_user_writes_it(check: object) -> None:
    def update(trial: Array, pressure: Array, stiffness: Array, mu: float) -> Array:
        """Closed form for a scalar stiffness, by hand."""
        size = np.hypot(*trial.T)
        limit = -mu * pressure
        with np.errstate(all="ignore"):
            return np.where((size > limit)[:, None], trial / size[:, None] * limit[:, None], trial)

    assert_conforms("coulomb", update, checks=[check], stiffness=decades(-3, 3), accuracy=1e-15, max_examples=5)


def test_a_routine_for_one_point() -> None:
    def update(trial: Array, pressure: float, stiffness: Array) -> Array:
        size, limit = float(np.hypot(*trial)), -0.3 * pressure
        return trial * (limit / size) if size > limit else trial

    accepted(conformance("coulomb", pointwise(update), DISK, stiffness=decades(-3, 3), max_examples=3))


def test_a_routine_in_displacements() -> None:
    def update(u: Array, u_in: Array, pressure: Array, stiffness: Array) -> Array:
        return u_in + duhem.project("orthotropic", (u - u_in) @ stiffness, pressure, stiffness, ELLIPSE).slip

    report = conformance("orthotropic", from_displacements(update), ELLIPSE, stiffness=stiffnesses(2, -1, 1), max_examples=3)
    accepted(report)
    assert {"slip", "energy"} <= set(report.passed)


@pytest.mark.slow
def test_a_routine_that_forgets_the_former_slip() -> None:
    def update(u: Array, u_in: Array, pressure: Array, stiffness: Array) -> Array:
        return u_in + duhem.project("orthotropic", u @ stiffness, pressure, stiffness, ELLIPSE).slip

    asked = ["feasibility", "variational-inequality"]
    assert conformance("orthotropic", from_displacements(update), ELLIPSE, checks=asked, max_examples=10, tries=20).failed


@pytest.mark.slow
def test_what_is_not_returned_is_left_out_with_the_reason() -> None:
    report = conformance("orthotropic", ellipse, ELLIPSE, max_examples=1)
    assert {"slip", "energy", "multiplier", "tangent", "slope"} == set(report.left_out)
    assert "by definition" in report.left_out["slip"]
    full = conformance("cohesive", projection("cohesive", tangent=True), max_examples=1)
    assert set(full.left_out) == {"homogeneity"} and "does not scale with the pressure" in full.left_out["homogeneity"]


def test_there_is_no_routine_for_a_law_with_a_flow_of_its_own() -> None:
    with pytest.raises(InputError, match="plesha has its own flow direction"):
        projection("plesha")


@pytest.mark.parametrize("law", ["prager", "perzyna"])
def test_laws_with_a_state_have_no_single_increments_to_test(law: str) -> None:
    with pytest.raises(InputError, match=f"an increment of {law} is more than a closest point of K, but a test"):
        conformance(law, ellipse, max_examples=1)


@pytest.mark.slow
def test_flagged_points_are_counted_and_not_judged() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        right = ellipse(trial, pressure, stiffness)
        bad = trial[:, 0] > 0
        return Step(np.where(bad[:, None], np.nan, right), solved=~bad)

    report = conformance("orthotropic", update, ELLIPSE, max_examples=3)
    assert report.ok and 0.2 < report.flagged_share < 0.8
    with pytest.raises(AssertionError, match="flags"):
        assert_conforms("orthotropic", update, ELLIPSE, max_examples=3, most_flagged=0.1)
    most = [conformance("orthotropic", update, ELLIPSE, checks=["feasibility"], max_examples=3, seed=1, most_flagged=x) for x in (0.1, 0.9)]
    assert [each.ok for each in most] == [False, True] and not most[0].failed
    assert [", more than the allowed fraction 0.1" in str(each).splitlines()[0] for each in most] == [True, False]


@pytest.mark.slow
def test_a_mapping_with_the_names_of_a_step_is_one() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> dict[str, Array]:
        stress = ellipse(trial, pressure, stiffness)
        return {"stress": stress, "slip": np.linalg.solve(stiffness, (trial - stress).T).T, "solved": pressure != -1.0}

    report = conformance("orthotropic", update, ELLIPSE, max_examples=2)
    assert report.ok and {"slip", "energy"} <= {*report.passed} and {"multiplier", "tangent"} <= {*report.left_out}
    wrong = conformance(
        "orthotropic", lambda *given: {**update(*given), "slip": given[0]}, ELLIPSE, checks=["slip"], max_examples=2, tries=5
    )
    assert wrong.failed == {"slip"}
    assert conformance("orthotropic", pointwise(lambda t, p, k: {"stress": 0.0 * t}), ELLIPSE, checks=["feasibility"], max_examples=1).ok


UNREAD: dict[str, tuple[Callable[[Array], object], str]] = {
    "other names": (
        lambda t: {"stress": t, "strain": t},
        "a mapping with strain; what is known is stress, slip, multiplier, tangent, solved",
    ),
    "no stress": (lambda t: {"slip": t}, "a mapping without stress"),
    "rows one by one": (lambda t: (row for row in t), "returned a generator, which gives its rows one by one: return them together"),
}


@pytest.mark.parametrize("name", UNREAD)
def test_what_is_no_step_is_told_as_what_it_is(name: str) -> None:
    answer, said = UNREAD[name]
    report = conformance("orthotropic", lambda t, p, k: answer(t), ELLIPSE, checks=["answers"], max_examples=1, tries=5)
    (failure,) = report.failures
    assert said in failure.message and failure.message.startswith("the routine returned")


def no_numbers(trial: Array, pressure: Array, stiffness: Array) -> object:
    return "stress"


def gives_up(trial: Array, pressure: Array, stiffness: Array) -> Step:
    return Step(trial, solved=np.zeros(len(trial), dtype=bool))


UNANSWERED = {
    raises: "ZeroDivisionError",
    wrong_shape: "has the shape",
    no_numbers: "not made of numbers",
    gives_up: "flags every increment",
}


@pytest.mark.slow
@pytest.mark.parametrize("update", UNANSWERED, ids=lambda f: f.__name__)
def test_what_never_saw_an_answer_has_not_passed(update: Callable[..., object]) -> None:
    report = conformance("orthotropic", update, ELLIPSE, pressure=-1.0, max_examples=2, tries=20)
    demanded = checks_for("orthotropic")
    assert set(report.passed) == {c.name for c in demanded if c.law_only}
    assert report.failed == ({"vacuity"} if update is gives_up else {"answers"})
    assert set(report.left_out) == {c.name for c in demanded} - set(report.passed) - report.failed
    assert f"{len(report.left_out)} skipped" in str(report)
    said = UNANSWERED[update]
    assert said in report.left_out["feasibility"] and f"skipped feasibility: {report.left_out['feasibility']}" in str(report)


@pytest.mark.slow
@pytest.mark.parametrize("update", [raises, wrong_shape, no_numbers])
@pytest.mark.parametrize("name", ["feasibility", "path"])
def test_a_check_asked_for_alone_fails_where_there_is_no_answer(update: Callable[..., object], name: str) -> None:
    report = conformance("orthotropic", update, ELLIPSE, checks=[name], max_examples=2, tries=20)
    (failure,) = report.failures
    assert report.failed == {name} and report.passed == () and UNANSWERED[update] in failure.message
    assert violation(name, "orthotropic", update, failure.case, open_parameters=()) == failure.message


@pytest.mark.slow
def test_an_answer_now_and_then_is_judged() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        if stiffness[0, 0] > 1.0:
            raise ArithmeticError("too stiff")
        return ellipse(trial, pressure, stiffness)

    report = conformance("orthotropic", update, ELLIPSE, max_examples=10, tries=20)
    assert report.failed == {"answers"} and "feasibility" in report.passed


# -- how a failure is told ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_failure_says_what_where_and_how_to_see_it_again() -> None:
    with pytest.raises(AssertionError) as caught:
        assert_conforms("orthotropic", nothing, ELLIPSE, checks=["feasibility"], tries=20)
    text = str(caught.value)
    for part in ("feasibility", "g(sigma, sigma_n) <= 0", "Antoni et al. (2007)", "mu_a = 0.5", "trial [", "to see it again", "Case("):
        assert part in text


@pytest.mark.slow
def test_a_failure_is_shrunk() -> None:
    (failure,) = conformance("coulomb", nothing, DISK, checks=["feasibility"], max_examples=20).failures
    case = failure.case
    assert len(case) == 1
    assert case.pressure.tolist() == [-1.0] and case.stiffness.tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert case.trial.tolist() == [[0.4, 0.4]]  # about twice as far as the boundary


@pytest.mark.slow
def test_the_reproducer_runs() -> None:
    (failure,) = conformance("orthotropic", nothing, ELLIPSE, checks=["feasibility"], max_examples=20).failures
    code = failure.reproducer().replace(f"from {__name__} import nothing as update", "update = lambda trial, pressure, stiffness: trial")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == failure.message


@pytest.mark.slow
def test_a_case_prints_to_the_last_bit() -> None:
    @settings(max_examples=20)
    @given(cases("hosford"))
    def same(case: Case) -> None:
        again = eval(repr(case), {"Case": Case, "nan": np.nan, "inf": np.inf})
        assert repr(again) == repr(case)
        assert all(np.array_equal(getattr(case, n), getattr(again, n)) for n in ("stiffness", "trial", "other", "inside", "path"))

    same()


@pytest.mark.parametrize("asked", ["feasibility", check("feasibility"), ["feasibility"]], ids=["name", "check", "list"])
def test_one_check_may_be_named_alone(asked: object) -> None:
    report = conformance("orthotropic", ellipse, ELLIPSE, checks=asked, max_examples=1)
    assert report.passed == ("feasibility",)
    with pytest.raises(InputError, match="unknown check 'feasible'"):
        conformance("orthotropic", ellipse, ELLIPSE, checks="feasible")


def test_checks_are_described() -> None:
    for known in [*checks_for("coulomb"), check("smoothness")]:
        assert known.statement and known.formula and known.source and known.tolerance
    with pytest.raises(InputError, match=r"unknown check 'convex'.*convexity"):
        check("convex")


@pytest.mark.slow
def test_the_package_and_its_command_do_not_import_hypothesis() -> None:
    code = "import sys, duhem, duhem.projection, duhem.path; from duhem.__main__ import main; sys.exit('hypothesis' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"expected_failed_checks": ["slope"]}, "expected_failed_checks: ['slope'] does not map checks to reasons; "),
        ({"expected_failed_checks": {"slope": None}}, "expected_failed_checks: "),
        ({"most_flagged": "all"}, "most_flagged: 'all' is not a fraction; "),
        ({"accuracy": "1e-9"}, "accuracy: '1e-9' is not a relative error; "),
        ({"accuracy": 0}, "accuracy: the accuracy is not positive; "),
        ({"accuracy": 1.0}, "accuracy: 1.0 is not a relative error; "),
        ({"accuracy": math.nan}, "accuracy: nan is not a relative error; "),
        ({"max_examples": 0}, "max_examples: 0 is too small; give 1 or more"),
        ({"max_examples": 2.0}, "max_examples: 2.0 is not a whole number; "),
        ({"every": 0}, "every: 0 is too small; give 1 or more"),
        ({"rows": 0}, "rows: 0 is too small; give 1 or more"),
        ({"rows": True}, "rows: True is not a whole number; "),
        ({"tries": -1}, "tries: -1 is too small; give 0 or more"),
        ({"seconds": "1"}, "seconds: '1' is not a time; "),
        ({"seed": "x"}, "seed: 'x' is not a whole number; "),
        ({"stiffness": math.nan}, "stiffness: 'nan' is not made of finite numbers; "),
        ({"stiffness": [1.0, 0.0]}, "stiffness: 0.0 is not positive; "),
        ({"stiffness": [[1.0, 2.0], [3.0, 9.0]]}, "stiffness: the matrix is not symmetric; "),
        ({"stiffness": [[1.0, 2.0], [2.0, 1.0]]}, "stiffness: the matrix is not positive definite; "),
        ({"checks": []}, "checks: no check is selected; "),
        ({"checks": [1]}, "checks: 1 is no check; "),
        ({"checks": 1}, "checks: 1 names no checks; "),
        ({"pressure": 1.0}, "pressure: sigma_n = 1.0 is positive; sigma_n <= 0 in compression: give a number <= 0"),
        ({"pressure": [-1.0, -2.0]}, "pressure: pressure has the shape (2,); give one number, "),
    ],
    ids=str,
)
@pytest.mark.parametrize("law", ["coulomb", None])
def test_an_argument_that_cannot_be_used_is_told_before_the_routine_is_asked(law: str | None, given: dict[str, Any], said: str) -> None:
    def update(*given: Any) -> Any:
        raise AssertionError

    options = {"stiffness": [1.0, 1.0]} | given if law is None else given
    with pytest.raises(InputError) as fault:
        assert_conforms(law, update, **options)
    assert str(fault.value).startswith(said)


SHAPE = "stiffness: stiffness has the shape "


@pytest.mark.parametrize(
    ("law", "stiffness", "said"),
    [
        ("coulomb", [1.0, 2.0, 3.0], "(3,); give one number, (2,) or (2, 2)"),
        ("coulomb", [[1.0]], "(1, 1); give one number, (2,) or (2, 2)"),
        (None, 2.0, "(); without a law give (d,) or (d, d)"),
        (None, [], "(0,); without a law give (d,) or (d, d)"),
        (None, [[1.0, 2.0]], "(1, 2); without a law give (d,) or (d, d)"),
    ],
    ids=str,
)
def test_a_stiffness_of_another_shape_is_told(law: str | None, stiffness: Any, said: str) -> None:
    with pytest.raises(InputError) as fault:
        assert_conforms(law, lambda trial, *_: trial, stiffness=stiffness)
    assert str(fault.value) == f"{SHAPE}{said}"


def test_a_case_of_a_law_with_a_fixed_value_that_is_no_double_is_asked_again() -> None:
    def doubled(trial: Any, *_: Any) -> Any:
        return 2.0 * trial

    law = duhem.load("coulomb").fix({"mu": "1/3"})
    failure = conformance(law, doubled, checks=["feasibility"], max_examples=2, rows=5, tries=5, seed=1).failures[0]
    assert violation("feasibility", law, doubled, failure.case, open_parameters=()) == failure.message
