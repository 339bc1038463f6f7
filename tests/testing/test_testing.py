"""The conformance suite itself: what it must accept, what it must refuse, which check refuses it, and how the failure is told."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable

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
    loadings,
    parameters,
    pointwise,
    pressures,
    projection,
    stiffnesses,
    trials,
    violation,
)

Array = np.ndarray
MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
ELLIPSE = {"mu_a": 0.5, "mu_b": 0.1}
DISK = {"mu": 0.3}


# -- routines, right and wrong -----------------------------------------------------------------------------------------


def antoni(values: dict[str, float]) -> Callable[..., Array]:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        return duhem.project("antoni2007", trial, pressure, stiffness, values).stress

    return update


def ellipse(trial: Array, pressure: Array, stiffness: Array) -> Array:
    """The closest point, right."""
    return duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE).stress


def radial_return(trial: Array, pressure: Array, stiffness: Array) -> Array:
    gauge = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1)
    share = np.where(gauge > -pressure, -pressure / np.where(gauge > 0, gauge, 1.0), 1.0)
    return trial * share[:, None]


def identity_metric(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return duhem.project("orthotropic", trial, pressure, 1.0, ELLIPSE).stress


def inverse_metric(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return duhem.project("orthotropic", trial, pressure, np.linalg.inv(stiffness), ELLIPSE).stress


def nothing(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return trial


def over_projection(trial: Array, pressure: Array, stiffness: Array) -> Array:
    right = ellipse(trial, pressure, stiffness)
    return np.where(right == trial, trial, 0.9 * right)


def to_the_origin(trial: Array, pressure: Array, stiffness: Array) -> Array:
    right = ellipse(trial, pressure, stiffness)
    return np.where((right == trial).all(axis=1, keepdims=True), trial, 0.0)


def swapped_sign(trial: Array, pressure: Array, stiffness: Array) -> Array:
    right = ellipse(trial, pressure, stiffness)
    return np.where((right == trial).all(axis=1, keepdims=True), trial, -right)


def reflected(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return trial + 2.0 * (ellipse(trial, pressure, stiffness) - trial)


def built_in_stress(trial: Array, pressure: Array, stiffness: Array) -> Array:
    """A cohesion of 1e-3 Pa that the law does not have, kept from below."""
    return duhem.project("orthotropic", trial, np.minimum(pressure + 1e-3, 0.0), stiffness, ELLIPSE).stress


def not_a_number(trial: Array, pressure: Array, stiffness: Array) -> Array:
    with np.errstate(all="ignore"):
        gauge = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1)
        return np.where((gauge <= -pressure)[:, None], trial, trial * (-pressure / gauge)[:, None]) + 0.0 * (1.0 / gauge)[:, None]


def raises(trial: Array, pressure: Array, stiffness: Array) -> Array:
    raise ZeroDivisionError("no pressure")


def wrong_shape(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return trial[:, 0]


def with_extras(**change: Callable[..., Array]) -> Callable[..., Step]:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        found = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE, tangent=True)
        parts = {"slip": found.slip, "multiplier": found.multiplier, "tangent": found.tangent}
        return Step(found.stress, **{name: change.get(name, lambda x: x)(part) for name, part in parts.items()})

    return update


def skewed(tangent: Array) -> Array:
    return tangent + np.array([[0.0, 1e-3], [-1e-3, 0.0]]) * np.abs(tangent).max(axis=(1, 2), keepdims=True)


# routine: (law, values), the checks that must refuse it, the checks that it satisfies by construction
MUTANTS: dict[str, tuple[Callable[..., object], str, dict[str, float], set[str], set[str]]] = {
    "radial return on an ellipse": (
        radial_return,
        "orthotropic",
        ELLIPSE,
        {"variational-inequality", "non-expansiveness", "firmness", "potential"},
        {"feasibility", "idempotence", "complementarity", "homogeneity", "stiffness-scale"},
    ),
    "a coefficient too large in one quadrant": (
        antoni({**MU, "mu_b_minus": 0.18}),
        "antoni2007",
        MU,
        {"feasibility"},
        {"idempotence", "non-expansiveness", "firmness", "potential", "ray", "homogeneity", "dissipation"},
    ),
    "a coefficient too small in one quadrant": (
        antoni({**MU, "mu_b_minus": 0.12}),
        "antoni2007",
        MU,
        {"complementarity", "variational-inequality"},
        {"feasibility", "non-expansiveness", "homogeneity", "dissipation"},
    ),
    "no projection": (
        nothing,
        "orthotropic",
        ELLIPSE,
        {"feasibility"},
        {
            "idempotence",
            "non-expansiveness",
            "firmness",
            "potential",
            "variational-inequality",
            "ray",
            "dissipation",
            "complementarity",
            "path",
        },
    ),
    "over-projection": (over_projection, "orthotropic", ELLIPSE, {"complementarity", "ray"}, {"feasibility", "dissipation", "path"}),
    "all stress gone": (
        to_the_origin,
        "orthotropic",
        ELLIPSE,
        {"complementarity", "variational-inequality", "non-expansiveness"},
        {"feasibility", "idempotence", "dissipation"},
    ),
    "a swapped sign": (
        swapped_sign,
        "orthotropic",
        ELLIPSE,
        {"dissipation", "variational-inequality", "firmness"},
        {"feasibility"},
    ),
    "reflection": (
        reflected,
        "orthotropic",
        ELLIPSE,
        {"idempotence", "variational-inequality", "firmness"},
        {"homogeneity", "non-expansiveness", "stiffness-scale"},
    ),
    "the metric of no stiffness": (
        identity_metric,
        "orthotropic",
        ELLIPSE,
        {"variational-inequality", "firmness"},
        {"feasibility", "idempotence", "homogeneity", "stiffness-scale", "complementarity"},
    ),
    "the metric of the inverse stiffness": (
        inverse_metric,
        "orthotropic",
        ELLIPSE,
        {"variational-inequality", "firmness"},
        {"feasibility", "idempotence", "homogeneity", "stiffness-scale"},
    ),
    "a stress built in": (
        built_in_stress,
        "orthotropic",
        ELLIPSE,
        {"homogeneity", "complementarity"},
        {"feasibility", "non-expansiveness", "dissipation"},
    ),
    "0/0 without stress": (not_a_number, "orthotropic", ELLIPSE, {"answers"}, {"convexity", "origin"}),
    "an exception": (raises, "orthotropic", ELLIPSE, {"answers"}, {"convexity", "origin"}),
    "an array of the wrong shape": (wrong_shape, "orthotropic", ELLIPSE, {"answers"}, {"convexity", "origin"}),
    "slip of the wrong sign": (with_extras(slip=np.negative), "orthotropic", ELLIPSE, {"slip", "energy"}, {"feasibility", "multiplier"}),
    "a negative multiplier": (with_extras(multiplier=np.negative), "orthotropic", ELLIPSE, {"multiplier"}, {"slip", "energy"}),
    "a multiplier without slip": (with_extras(multiplier=lambda x: x + 1.0), "orthotropic", ELLIPSE, {"multiplier"}, {"slip", "energy"}),
    "a tangent that is not symmetric": (with_extras(tangent=skewed), "orthotropic", ELLIPSE, {"tangent"}, {"slip", "multiplier"}),
    "the elastic tangent": (
        with_extras(tangent=lambda x: 0.0 * x + np.eye(2)),
        "orthotropic",
        ELLIPSE,
        {"slope"},
        {"slip", "multiplier"},
    ),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_a_wrong_routine_is_refused_by_the_right_checks(name: str) -> None:
    update, law, values, must, cannot = MUTANTS[name]
    stiff = 1.0 if name == "the elastic tangent" else None
    asked = [c for c in checks_for(law) if c.name in must | cannot]
    report = conformance(law, update, values, checks=asked, stiffness=stiff, max_examples=6, rows=60, seconds=0.2)
    assert must <= report.failed, f"not refused by {sorted(must - report.failed)}"
    assert not cannot & report.failed, str(report)
    for failure in report.failures:
        assert len(failure.case) == 1
        assert violation(failure.check, law, update, failure.case, open_parameters=())


@pytest.mark.parametrize(
    ("law", "values"),
    [
        ("limacon", {"e": "0.6"}),
        ("limacon", {"e": "99/100"}),
        ("matchstick", {"mu_a": "1", "mu_b": "2"}),
        ("quartic", {"c": "30"}),
        ("quartic", {"c": "-1"}),
        ("lobes", {"e": "0.3"}),
        ("drucker1949", {"c": "4"}),
        ("drucker1949", {"c": "-10"}),
    ],
    ids=str,
)
def test_a_set_that_is_not_convex_is_refused(law: str, values: dict[str, str]) -> None:
    report = conformance(law, nothing, values, checks=["convexity", "origin"], max_examples=30, rows=60, seconds=0.5)
    assert report.failed == {"convexity"}
    (failure,) = report.failures
    case, known = failure.case, duhem.load(law).fix(values)
    table = known.symbols()
    exact = {table[n]: float(case.parameters[n]) for n in known.parameters} | (
        {table[known.pressure]: case.pressure[0]} if known.pressure else {}
    )
    level = [
        float(known.g.subs(exact | dict(zip(known.force_symbols(), point, strict=True))))
        for point in (case.inside[0], case.beside[0], (case.inside[0] + case.beside[0]) / 2)
    ]
    assert max(level[:2]) <= 1e-12 * abs(level[2]) and level[2] > 0


@pytest.mark.parametrize("law", ["radial-flow", "rotated-flow"])
def test_a_flow_that_is_not_normal_is_refused(law: str) -> None:
    """The implicit step of each flow rule for k = 1, by hand: both stay in K and dissipate, and neither is a closest point."""
    values = {"radial-flow": {"mu_a": 0.5, "mu_b": 0.1}, "rotated-flow": {"mu": 0.3, "delta": 0.5}}[law]

    def rotated(trial: Array, pressure: Array, stiffness: Array) -> Array:
        size, e = np.hypot(*trial.T), -0.3 * pressure
        out = size > e
        # sigma + l R(delta) sigma = trial with |sigma| = e: 1 + 2 l cos(delta) + l^2 = (|trial|/e)^2
        q = np.where(out & (e > 0), (size / np.where(e > 0, e, 1.0)) ** 2 - 1.0, 0.0)
        slide = q / (np.cos(0.5) + np.sqrt(np.cos(0.5) ** 2 + q))
        z = (trial[:, 0] + 1j * trial[:, 1]) / (1.0 + slide * np.exp(0.5j))
        z = np.where(out & (e == 0), 0.0, z)
        return np.stack([z.real, z.imag], axis=1)

    update = {"radial-flow": radial_return, "rotated-flow": rotated}[law]
    report = conformance(law, update, values, stiffness=1.0, max_examples=6, rows=60, seconds=0.2)
    assert {"variational-inequality", "firmness", "potential"} <= report.failed
    assert not {"feasibility", "idempotence", "dissipation", "path", "homogeneity", "complementarity", "convexity"} & report.failed, str(
        report
    )


# -- what is right is accepted -----------------------------------------------------------------------------------------


def accepted(report: Report) -> None:
    assert report.ok, str(report)
    assert report.flagged == 0


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


def test_a_routine_that_forgets_the_former_slip() -> None:
    def update(u: Array, u_in: Array, pressure: Array, stiffness: Array) -> Array:
        return u_in + duhem.project("orthotropic", u @ stiffness, pressure, stiffness, ELLIPSE).slip

    asked = ["feasibility", "variational-inequality"]
    assert conformance("orthotropic", from_displacements(update), ELLIPSE, checks=asked, max_examples=10, seconds=0.3).failed


def test_what_is_not_returned_is_left_out_with_the_reason() -> None:
    report = conformance("orthotropic", ellipse, ELLIPSE, max_examples=1)
    assert {"slip", "energy", "multiplier", "tangent", "slope"} == set(report.left_out)
    assert "by definition" in report.left_out["slip"]
    full = conformance("cohesive", projection("cohesive", tangent=True), max_examples=1)
    assert set(full.left_out) == {"homogeneity"} and "size of its own" in full.left_out["homogeneity"]


def test_flagged_points_are_counted_and_not_judged() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        right = ellipse(trial, pressure, stiffness)
        bad = trial[:, 0] > 0
        return Step(np.where(bad[:, None], np.nan, right), solved=~bad)

    report = conformance("orthotropic", update, ELLIPSE, max_examples=3)
    assert report.ok and 0.2 < report.flagged_share < 0.8
    with pytest.raises(AssertionError, match="flags"):
        assert_conforms("orthotropic", update, ELLIPSE, max_examples=3, most_flagged=0.1)


# -- how a failure is told ---------------------------------------------------------------------------------------------


def test_a_failure_says_what_where_and_how_to_see_it_again() -> None:
    with pytest.raises(AssertionError) as caught:
        assert_conforms("orthotropic", nothing, ELLIPSE, checks=["feasibility"], seconds=2.0)
    text = str(caught.value)
    for part in ("feasibility", "g(sigma, sigma_n) <= 0", "Antoni et al. (2007)", "mu_a = 0.5", "trial [", "to see it again", "Case("):
        assert part in text


def test_a_failure_is_shrunk() -> None:
    (failure,) = conformance("coulomb", nothing, DISK, checks=["feasibility"], max_examples=20, seconds=4.0).failures
    case = failure.case
    assert len(case) == 1
    assert case.pressure.tolist() == [-1.0] and case.stiffness.tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert np.hypot(*case.trial[0]) == pytest.approx(0.6)  # twice as far as the boundary


def test_the_reproducer_runs() -> None:
    (failure,) = conformance("orthotropic", nothing, ELLIPSE, checks=["feasibility"], max_examples=20, seconds=0.3).failures
    code = failure.reproducer().replace(f"from {__name__} import nothing as update", "update = lambda trial, pressure, stiffness: trial")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == failure.message


def test_a_case_prints_to_the_last_bit() -> None:
    @settings(max_examples=20)
    @given(cases("hosford"))
    def same(case: Case) -> None:
        again = eval(repr(case), {"Case": Case, "nan": np.nan, "inf": np.inf})
        assert repr(again) == repr(case)
        assert all(np.array_equal(getattr(case, n), getattr(again, n)) for n in ("stiffness", "trial", "other", "inside", "path"))

    same()


def test_checks_are_described() -> None:
    for known in [*checks_for("coulomb"), check("smoothness")]:
        assert known.statement and known.formula and known.source and known.tolerance
    with pytest.raises(InputError, match=r"unknown check 'convex'.*convexity"):
        check("convex")


# -- strategies --------------------------------------------------------------------------------------------------------


def drawn(strategy: object, n: int = 400) -> list[object]:
    found: list[object] = []

    @settings(max_examples=n)
    @given(strategy)
    def take(value: object) -> None:
        found.append(value)

    take()
    return found


def test_every_decade_is_drawn() -> None:
    sizes = np.abs(np.array(drawn(decades(-6, 6, signed=True), 1000)))
    counts = np.bincount(np.floor(np.log10(sizes * (1 + 1e-15))).astype(int) + 6, minlength=13)
    assert counts.min() >= 15


def test_pressures_are_compressive_and_sometimes_none() -> None:
    found = np.array(drawn(pressures()))
    assert (found <= 0.0).all() and (found == 0.0).any() and found.min() < -1e5 and found[found < 0].max() > -1e-5


@pytest.mark.parametrize("d", [1, 2, 3])
def test_stiffnesses_are_positive_definite_in_three_forms(d: int) -> None:
    found = drawn(stiffnesses(d), 200)
    assert all(np.linalg.eigvalsh(k / np.sqrt(np.outer(np.diag(k), np.diag(k)))).min() > 0 for k in found)
    full = sum(bool((k != np.diag(np.diag(k))).any()) for k in found)
    assert (full > 20) == (d > 1)


@pytest.mark.parametrize("law", ["shifted-ellipse", "superellipse", "limacon", "lobes", "drucker1949"])
def test_parameters_lie_in_the_domain(law: str) -> None:
    known = duhem.load(law)
    for values in drawn(parameters(law), 60):
        assert known.fix(values)
        duhem.project(law, np.ones(len(known.forces)), -1.0 if known.pressure else None, 1.0, values, method="newton")
        break  # the constraints themselves are project's to check: once is enough to see that it agrees
    table = known.symbols()
    for values in drawn(parameters(law), 60):
        assert all(bool(c.subs({table[n]: v for n, v in values.items()})) for c in known.constraints)


def test_trials_lie_on_next_to_and_far_from_the_boundary() -> None:
    found = np.array(drawn(trials("coulomb", DISK, -1.0), 800))
    gap = np.hypot(*found.T) / 0.3 - 1.0
    ulps = np.abs(gap) / np.finfo(float).eps
    assert (ulps <= 3).sum() > 30 and (gap > 100).any() and (gap < -0.99).any()
    assert ((np.abs(gap) > 1e-13) & (np.abs(gap) < 1e-5)).sum() > 20
    on, beside = (found == 0.0).any(axis=1), (np.abs(found) < 1e-300).any(axis=1)
    assert on.sum() > 20 and (beside & ~on).sum() > 20


def test_loading_paths_start_at_rest_and_are_of_three_kinds() -> None:
    found = drawn(loadings(2), 200)
    assert all(path[0].tolist() == [0.0, 0.0] and np.abs(path).max() <= 3.0 for path in found)
    closed = sum(bool(np.abs(path[-1]).max() < 1e-12) for path in found)
    assert 20 < closed < 180


def test_the_package_and_its_command_do_not_import_hypothesis() -> None:
    code = "import sys, duhem, duhem.projection, duhem.path; from duhem.__main__ import main; sys.exit('hypothesis' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0
