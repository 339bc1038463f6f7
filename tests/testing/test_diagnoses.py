"""Each suggestion is believed of the routine that does just that, and of no other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import duhem
from duhem.testing import Case, Step, conformance, from_displacements
from duhem.testing.checks.query import Query
from duhem.testing.drawn.case import Region
from duhem.testing.failures.diagnosis import Part, _suggestions, departure, diagnoses
from tests.long import long_but, mostly_long
from tests.oracles.round_numbers import unrounded
from tests.oracles.routines import (
    ELLIPSE,
    MU,
    Array,
    antoni,
    built_in_stress,
    ellipse,
    identity_metric,
    inverse_metric,
    nothing,
    over_projection,
    radial_return,
    reflected,
    swapped_sign,
    to_the_origin,
    with_extras,
)

Routine = Callable[..., object]
K = np.array([[1.0, 0.5], [0.5, 2.0]])


def projected(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE).stress


def of_step(change: Callable[[Array, Array, Array, Array], Array], part: str) -> Routine:
    """The right step with one part made of trial, stress, gradient of g and stiffness."""

    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        found = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE, tangent=True)
        gradient, _ = Region(duhem.load("orthotropic"), ELLIPSE).slope(found.stress, pressure)
        parts = {"slip": found.slip, "multiplier": found.multiplier, "tangent": found.tangent}
        return Step(found.stress, **{**parts, part: change(trial, found.stress, gradient, stiffness)})

    return update


def newton_once(trial: Array, pressure: Array, stiffness: Array) -> Array:
    region = Region(duhem.load("orthotropic"), ELLIPSE)
    level, (normal, _) = region.level(trial, pressure), region.slope(trial, pressure)
    way = normal @ stiffness
    return np.where(level[:, None] > 0, trial - (level / np.einsum("ij,ij->i", normal, way))[:, None] * way, trial)


def forgets(u: Array, u_in: Array, pressure: Array, stiffness: Array) -> Array:
    return u_in + duhem.project("orthotropic", u @ stiffness, pressure, stiffness, ELLIPSE).slip


def rates(trial: Array, stress: Array, gradient: Array, stiffness: Array) -> Array:
    way = gradient @ stiffness
    along = way[:, :, None] * way[:, None, :] / np.einsum("ij,ij->i", gradient, way)[:, None, None]
    return stiffness - np.where((trial != stress).any(axis=1)[:, None, None], along, 0.0)


def secant(trial: Array, stress: Array, gradient: Array, stiffness: Array) -> Array:
    return (np.linalg.norm(stress, axis=1) / np.linalg.norm(trial, axis=1))[:, None, None] * stiffness


def radial_when_far(trial: Array, pressure: Array, stiffness: Array) -> Array:
    """Three times as far out as the boundary."""
    far = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1) > -3.0 * pressure
    return np.where(far[:, None], radial_return(trial, pressure, stiffness), ellipse(trial, pressure, stiffness))


def by_pressure(trial: Array, pressure: Array, stiffness: Array) -> Step:
    """The multiplier of g/|sigma_n|."""
    found = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE)
    return Step(found.stress, multiplier=found.multiplier * np.abs(pressure))


def squared(trial: Array, pressure: Array, stiffness: Array) -> Step:
    """The multiplier of (a/mu_a)^2 + (b/mu_b)^2 - sigma_n^2, where the law has the root."""
    found = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE)
    return Step(found.stress, multiplier=found.multiplier / (2.0 * np.abs(pressure)))


def turned(trial: Array, pressure: Array, stiffness: Array) -> Step:
    """Stresses that derive from no potential, with the transposed of their slope."""
    found, turn = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE, tangent=True), np.array([[1.0, 0.1], [-0.2, 1.0]])
    return Step(found.stress @ turn.T, tangent=np.swapaxes(turn @ found.tangent, 1, 2))


# suggestion: part, routine, what is said
INSTEAD: dict[str, list[tuple[Part, Routine, str]]] = {
    "trial_stress": [("stress", nothing, "returns the trial stress")],
    "no_stress": [("stress", lambda t, p, k: 0.0 * t, "every stress returned is zero")],
    "radial_return": [
        ("stress", radial_return, "radial return"),
        ("stress", radial_when_far, "radial return of trial stresses that lie 3."),
    ],
    "another_metric": [
        ("stress", identity_metric, "computed with the identity"),
        ("stress", lambda t, p, k: projected(t, p, np.diag(np.diag(k))), "only the diagonal of the stiffness"),
        ("stress", inverse_metric, "inverse of the stiffness"),
    ],
    "metric_of_exchanged_entries": [
        ("stress", lambda t, p, k: projected(t, p, k[::-1, ::-1]), "entries of the stiffness for sigma_a and sigma_b exchanged"),
    ],
    "exchanged_components": [
        ("stress", lambda t, p, k: projected(t, p, k)[:, ::-1], "exchanged in the answer"),
    ],
    "another_pressure": [
        ("stress", built_in_stress, "a stress is built in: the pressure is taken with +0.001"),
        ("stress", lambda t, p, k: projected(t, 0.0 * p - 2.0, k), "taken as -2, whatever it is"),
        ("stress", lambda t, p, k: projected(t, 0.5 * p, k), "0.5 times as large"),
    ],
    "opposite_sign": [
        ("stress", swapped_sign, "opposite sign where there is slip"),
        ("stress", lambda t, p, k: -projected(t, p, k), "the stress has the opposite sign"),
    ],
    "lost_sign": [("stress", lambda t, p, k: projected(np.abs(t), p, k), "the signs of the forces are lost")],
    "too_far": [("stress", reflected, "2 times what leads to the closest point")],
    "multiple_of_the_answer": [
        ("stress", over_projection, "0.9 times the closest point"),
        ("stress", to_the_origin, "the stress is zero if there is slip"),
    ],
    "one_newton_step": [("stress", newton_once, "one step of Newton's method")],
    "component_by_component": [
        (
            "stress",
            lambda t, p, k: np.clip(t, [[0.5, 0.1]] * p[:, None], [[-0.5, -0.1]] * p[:, None]),
            "each component is limited separately",
        )
    ],
    "forgotten_slip": [("stress", from_displacements(forgets), "the previous slip is missing")],
    "imprecise": [("stress", lambda t, p, k: ellipse(t, p, k).astype(np.float32), "single precision")],
    "opposite_slip": [("slip", with_extras(slip=np.negative), "the slip has the opposite sign")],
    "no_slip": [("slip", with_extras(slip=lambda x: 0.0 * x), "always zero")],
    "slip_as_a_stress": [("slip", of_step(lambda t, s, g, k: t - s, "slip"), "not divided by the stiffness")],
    "slip_times_the_stiffness": [("slip", of_step(lambda t, s, g, k: (t - s) @ k, "slip"), "a stiffness is taken for a compliance")],
    "slip_of_the_diagonal": [("slip", of_step(lambda t, s, g, k: (t - s) / np.diag(k), "slip"), "diagonal of the stiffness")],
    "slip_as_a_displacement": [
        ("slip", of_step(lambda t, s, g, k: np.linalg.solve(k, s.T).T, "slip"), "the elastic displacement is returned"),
        ("slip", of_step(lambda t, s, g, k: np.linalg.solve(k, t.T).T, "slip"), "the whole displacement is returned"),
    ],
    "multiple_of_the_slip": [("slip", with_extras(slip=lambda x: 0.5 * x), "0.5 times what the stress lacks")],
    "opposite_multiplier": [("multiplier", with_extras(multiplier=np.negative), "the multiplier has the opposite sign")],
    "multiplier_with_a_shift": [("multiplier", with_extras(multiplier=lambda x: x + 1.0), "off by +1 everywhere")],
    "multiple_of_the_multiplier": [
        ("multiplier", with_extras(multiplier=lambda x: 2.0 * x), "2 times the slip over the gradient"),
        ("multiplier", with_extras(multiplier=lambda x: 0.0 * x), "always zero"),
    ],
    "multiplier_of_another_g": [
        ("multiplier", of_step(lambda t, s, g, k: np.linalg.norm(np.linalg.solve(k, (t - s).T), axis=0), "multiplier"), "has length 1"),
        ("multiplier", of_step(lambda t, s, g, k: np.linalg.norm(t - s, axis=1), "multiplier"), "not divided by the stiffness"),
        ("multiplier", squared, "with its parts squared"),
    ],
    "elastic_tangent": [("tangent", of_step(lambda t, s, g, k: np.tile(k, (len(t), 1, 1)), "tangent"), "the elastic stiffness")],
    "no_tangent": [("tangent", with_extras(tangent=lambda x: 0.0 * x), "it is zero")],
    "continuum_tangent": [("tangent", of_step(rates, "tangent"), "the continuum tangent")],
    "tangent_by_the_trial": [("tangent", with_extras(tangent=lambda x: x @ np.linalg.inv(K)), "derivative by the trial stress")],
    "opposite_tangent": [("tangent", with_extras(tangent=np.negative), "the tangent has the opposite sign")],
    "transposed_tangent": [("tangent", turned, "the tangent is transposed")],
    "components": [("tangent", with_extras(tangent=lambda x: x * [[1.0, 1.0], [1.0, 1.01]]), "wrong in 1 of 4 components: (2, 2), ")],
    "secant": [("tangent", of_step(secant, "tangent"), "a secant")],
    "multiple_of_the_tangent": [("tangent", with_extras(tangent=lambda x: 2.0 * x), "2 times the slope of the stress")],
}
WITH_PARAMETERS: dict[str, list[tuple[Part, Routine, str]]] = {
    "exchanged_parameters": [
        ("stress", antoni({**MU, "mu_a_plus": 0.08, "mu_a_minus": 0.2}), "mu_a_plus and mu_a_minus are exchanged"),
    ],
    "exchanged_components": [
        ("stress", lambda t, p, k: antoni(MU)(t[:, ::-1], p, k[::-1, ::-1])[:, ::-1], "sigma_a and sigma_b are exchanged in the set"),
    ],
    "another_parameter": [("stress", antoni({**MU, "mu_a_plus": 0.25}), "mu_a_plus is taken as 0.25, not 0.2, 1.25 times its value")],
}


def asked(
    update: Routine, law: str = "orthotropic", values: dict[str, float] = ELLIPSE, accuracy: float = 1e-9, pressure: float = -1.0
) -> Query:
    trial, zero = np.array([[0.8, 0.3]]), np.zeros((1, 2))
    loads = [[pressure] * 2]
    case = Case(values, K, [pressure], -pressure * trial, -trial, zero, zero, zero, [2.0], 2.0, np.zeros((1, 2, 2)), loads)  # type: ignore[arg-type]
    return Query(Region(duhem.load(law), values), case, update, (), accuracy)


def told(part: Part, query: Query) -> dict[str, str]:
    found = departure(query)
    assert found is not None
    return diagnoses(part, query, found)


EVERY = [(name, *one) for name, each in INSTEAD.items() for one in each]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "part", "update", "said"), mostly_long(EVERY, *EVERY[::4]), ids=lambda x: x if isinstance(x, str) else "")
def test_what_a_routine_does_instead_is_told(name: str, part: Part, update: Routine, said: str) -> None:
    found = told(part, asked(update))
    assert next(iter(found)) == name and said in found[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_PARAMETERS)
def test_which_coefficient_is_another_one_is_told(name: str) -> None:
    for part, update, said in WITH_PARAMETERS[name]:
        found = told(part, asked(update, "antoni2007", MU))
        assert next(iter(found)) == name and said in found[name]


def test_the_multiplier_of_a_formula_over_its_pressure_is_told() -> None:
    found = told("multiplier", asked(by_pressure, pressure=-3.0))
    assert "that of g divided by the pressure" in found["multiplier_of_another_g"]


def test_every_suggestion_has_a_routine_that_does_so() -> None:
    unshown = {"slip_of_the_closest_point", "far_trials", "first_call"}  # below: with a stress that is wrong too, far out, with a memory
    assert {name for each in _suggestions.values() for name in each} == {*INSTEAD, *WITH_PARAMETERS} | unshown


def test_a_slip_that_belongs_to_the_right_stress() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        found = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE)
        return Step(0.7 * found.stress, found.slip)

    assert "slip_of_the_closest_point" in told("slip", asked(update))


def remembers(what: str) -> Routine:
    """Right, but for what it keeps of its first call."""
    kept: dict[str, object] = {}

    def update(trial: Array, pressure: Array, stiffness: Array, mu_a: float, mu_b: float) -> Array:
        now = {"pressure": pressure[0], "stiffness": stiffness, "parameters": {"mu_a": mu_a, "mu_b": mu_b}}
        now[what] = kept.setdefault(what, now[what])
        load = np.full(len(trial), now["pressure"]) if what == "pressure" else pressure
        return duhem.project("orthotropic", trial, load, now["stiffness"], now["parameters"]).stress  # type: ignore[arg-type]

    return update


@pytest.mark.slow
@pytest.mark.parametrize("what", long_but([0], ["pressure", "stiffness", "parameters"]))
@pytest.mark.parametrize("seed", mostly_long(range(6), 0))
def test_what_is_kept_of_the_first_call_is_told_and_shown_by_the_whole_run(what: str, seed: int) -> None:
    run = {"checks": ["feasibility", "variational-inequality", "complementarity"], "max_examples": 7, "rows": 12, "seed": seed}
    report = conformance("orthotropic", remembers(what), tries=40, **run)  # type: ignore[arg-type]
    failure = report.failures[0]
    said, first = failure.diagnosis, "mu_" if what == "parameters" else f"the {what} is taken as "
    if what == "stiffness" and not said.startswith(
        first
    ):  # of the first, a multiple of the identity, routines without a memory say as much
        assert said.startswith(("radial return", "the closest point is computed with the identity")), str(report)
    else:
        assert said.startswith(first) and "of the first call of the run" in said, str(report)
        assert f"seed={seed}" in failure.reproducer()
    assert "conformance(LAW" in failure.replay()
    again = {**run, "checks": [failure.check.name]}
    assert not conformance("orthotropic", remembers(what), **again).ok  # type: ignore[arg-type]
    opening = asked(lambda t, p, k: t)  # which does nothing, as one that keeps a large K seems to
    opening.opening = replace(opening.case, pressure=1e6 * opening.pressure)
    assert "first_call" not in told("stress", opening)


@pytest.mark.slow
@pytest.mark.parametrize("seed", mostly_long(range(1, 5), 1))
def test_what_a_stiffness_of_the_first_call_says_too_is_told_without_it(seed: int) -> None:
    def radial(trial: Array, pressure: Array, stiffness: Array, mu: float) -> Array:
        size, limit = np.hypot(*trial.T), mu * np.abs(pressure)
        return trial * np.divide(limit, size, out=np.ones_like(size), where=size > limit)[:, None]

    (failure,) = conformance("coulomb", radial, checks=["variational-inequality"], max_examples=20, seed=seed, tries=40).failures
    assert failure.alone and failure.diagnosis.startswith("radial return"), str(failure)


@pytest.mark.long
def test_of_the_first_call_what_is_kept_alone_is_named() -> None:
    def only(key: Callable[[Array, float], object]) -> Routine:
        kept: dict[object, float] = {}

        def update(trial: Array, pressure: Array, stiffness: Array, mu_a: float, mu_b: float) -> Array:
            values = {"mu_a": mu_a, "mu_b": kept.setdefault(key(stiffness, mu_a), mu_b)}
            return duhem.project("orthotropic", trial, pressure, stiffness, values).stress

        return update

    run = {"checks": ["feasibility", "complementarity"], "max_examples": 9, "rows": 12, "seed": 0, "tries": 40}
    first = conformance("orthotropic", only(lambda k, mu_a: 0), **run).failures[0].diagnosis  # type: ignore[arg-type]
    assert first.startswith("mu_b is taken as ") and first.endswith(", that of the first call of the run, whatever it is")
    for key in (lambda k, mu_a: k.tobytes(), lambda k, mu_a: mu_a):
        report = conformance("orthotropic", only(key), **run)  # type: ignore[arg-type]
        assert not any("first call" in failure.diagnosis for failure in report.failures), str(report)


@pytest.mark.slow
@pytest.mark.parametrize("factor", long_but([3], [0.9, -1.0, 0.0, 2.0]))
def test_what_is_wrong_without_stress_too_is_shown_where_its_cause_can_be_told(factor: float) -> None:
    update = with_extras(tangent=lambda c: factor * c)
    report = conformance("orthotropic", update, ELLIPSE, checks=["slope"], max_examples=4, rows=12, tries=40, seed=0)
    failure = report.failures[0]
    assert failure.diagnosis and failure.case.trial.any() and unrounded(failure.case) <= 1, str(report)


@pytest.mark.slow
def test_an_answer_that_is_no_number_is_shown_where_it_is_none() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        with np.errstate(all="ignore"):
            size = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1)
            return trial * (np.minimum(size, -pressure) / size)[:, None]  # 0/0

    report = conformance("orthotropic", update, ELLIPSE, max_examples=4, rows=12, tries=40, seed=0)
    failure = report.failures[0]
    assert failure.check.name == "answers" and failure.departure is not None
    assert not np.isfinite(failure.departure.returned).any() and not failure.diagnosis, str(report)


def far_out(change: Callable[[Array], Array], least: float) -> Query:
    """A routine that changes the answers to trial stresses so many times as far out as the boundary, asked at one of 2e5 times."""

    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        found = projected(trial, pressure, stiffness)
        far = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1) > -least * pressure
        return np.where(far[:, None], change(found), found)

    query = asked(update)
    query.case = replace(query.case, trial=5e4 * query.case.trial)
    return query


def test_an_error_of_far_trials_is_a_share_of_the_stress_and_no_lack_of_digits() -> None:
    turned = told("stress", far_out(lambda s: s @ np.array([[1.0, 0.01], [-0.01, 1.0]]), 1e4))
    assert [*turned] == ["far_trials"] and "up to 1.02 times as far rightly" in turned["far_trials"]
    shorter = told("stress", far_out(lambda s: 0.999 * s, 100.0))
    assert "imprecise" not in shorter and "0.999 times the closest point" in shorter["multiple_of_the_answer"]
    assert "right to 1e-05 of the stress" in told("stress", far_out(lambda s: (1.0 - 1e-5) * s, 0.0))["imprecise"]


def test_what_corrects_far_out_does_not_correct_nothing() -> None:
    late = asked(lambda t, p, k: np.where(np.abs(t).max(axis=1, keepdims=True) < 1e3, t, projected(t, p, k)))
    assert told("stress", late)["trial_stress"].endswith("of these, but farther out it does")
    assert told("stress", asked(nothing))["trial_stress"].endswith("without a correction")


def test_a_tangent_of_a_stress_that_is_not_the_closest_point_says_so_first() -> None:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        size, limit = np.hypot(*trial.T), -0.3 * pressure
        share, n = np.minimum(1.0, limit / np.maximum(size, 1e-300)), trial / np.maximum(size, 1e-300)[:, None]
        along = np.where((size > limit)[:, None, None], n[:, :, None] * n[:, None, :], 0.0)
        return Step(share[:, None] * trial, tangent=share[:, None, None] * (np.eye(2) - along) @ stiffness)

    place = {"stiffness": [1.0, 2.0], "pressure": -1.0}
    report = conformance("coulomb", update, {"mu": 0.3}, checks=["tangent"], max_examples=4, tries=20, seed=1, **place)
    assert report.failures[0].diagnosis.startswith("the stress is not the closest point: radial return"), str(report)


UNLIKE: dict[str, tuple[Part, Routine]] = {
    "right": ("stress", ellipse),
    "a shift": ("stress", lambda t, p, k: ellipse(t, p, k) + np.array([[0.01, -0.02]])),
    "turned": ("stress", lambda t, p, k: ellipse(t, p, k) @ np.array([[0.8, 0.6], [-0.6, 0.8]])),
    "nearly radial": ("stress", lambda t, p, k: radial_return(t, p, k) * (1.0 + 1e-6)),
    "radial here, right elsewhere": (
        "stress",
        lambda t, p, k: np.where(np.abs(t - [[0.8, 0.3]]).max(axis=1, keepdims=True) < 1e-9, radial_return(t, p, k), ellipse(t, p, k)),
    ),
    "a slip with noise": ("slip", of_step(lambda t, s, g, k: np.linalg.solve(k, (t - s).T).T + 0.1, "slip")),
    "a tangent with noise": ("tangent", with_extras(tangent=lambda x: x + 0.1)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", UNLIKE)
def test_nothing_is_said_of_a_routine_that_does_none_of_these(name: str) -> None:
    part, update = UNLIKE[name]
    assert told(part, asked(update)) == {}


SOMEWHERE: dict[str, tuple[float, Routine, str]] = {
    "without pressure": (0.0, lambda t, p, k: np.where(p[:, None] == 0.0, t, projected(t, p, k)), "trial_stress"),
    "under little pressure": (-1e-8, lambda t, p, k: np.where(p[:, None] > -1e-6, t, projected(t, p, k)), "trial_stress"),
    "on one side": (-1.0, lambda t, p, k: np.where(t[:, :1] > 0.0, 0.0, projected(t, p, k)), "no_stress"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SOMEWHERE)
def test_what_is_done_at_some_increments_is_not_said_of_all(name: str) -> None:
    pressure, update, what = SOMEWHERE[name]
    query = asked(update, pressure=pressure)
    query = query if pressure else asked_without_pressure(update)
    said = told("stress", query)
    assert all(each.endswith("this happens only for such increments, and others near them are right") for each in said.values()), said
    assert "only for such increments" not in told("stress", asked(nothing if what == "trial_stress" else lambda t, p, k: 0.0 * t))[what]


def asked_without_pressure(update: Routine) -> Query:
    query = asked(update)
    query.case = replace(query.case, pressure=np.zeros(1), loads=np.zeros((1, 2)))
    return query


@pytest.mark.slow
def test_a_failure_shows_stress_closest_point_and_what_the_routine_does_first() -> None:
    asked = ["variational-inequality", "firmness", "potential", "feasibility"]
    report = conformance("orthotropic", radial_return, ELLIPSE, checks=asked, max_examples=4, every=1, tries=20, seed=1)
    (failure,) = report.failures
    assert {failure.check.name, *failure.explains} == report.failed and len(report.failed) >= 2
    lines = str(failure).splitlines()
    assert [line.split()[0] for line in lines[1:7]] == ["likely", "law", "increment", "returned", "closest", "difference"]
    assert "radial return" in lines[1] and "mu_a = 0.5, mu_b = 0.1" in lines[2]
    assert {f.check.name for f in report.explained} == {*failure.explains}
