"""One increment after the other goes on plain numbers: its answers are those of arrays, which are asked of all that is unusual."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.projection import closed_form, variational_samples
from duhem.projection.closed_form import CLOSED_FORM
from duhem.projection.one_increment import OneIncrement
from duhem.projection.result import Status
from tests.long import long_at, mostly_long

LAWS: dict[str, tuple[dict[str, float], Any]] = {
    "antoni2007": ({"mu_a_plus": 0.3, "mu_a_minus": 0.2, "mu_b_plus": 0.4, "mu_b_minus": 0.25}, 1.5),
    "orthotropic": ({"mu_a": 0.3, "mu_b": 0.2}, [1.0, 2.0]),
    "coulomb": ({"mu": 0.3}, 2.0),
    "superellipse": ({"mu_a": 0.3, "mu_b": 0.2, "p": 4.0}, 1.0),
    "tresca": ({"yield_stress": 1.0}, 1.0),
    "von-mises": ({"yield_stress": 1.0}, 3.0),
}


def asked(name: str, n: int, seed: int = 0) -> tuple[Any, Any]:
    law, chance = duhem.load(name), np.random.default_rng(seed)
    trial = chance.standard_normal((n, len(law.forces))) * 10.0 ** chance.uniform(-1, 1, (n, 1))
    return trial, (None if law.pressure is None else -(10.0 ** chance.uniform(-2, 2, n)))


@pytest.mark.parametrize("name", LAWS)
def test_the_answers_are_those_of_arrays(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    parameters, stiffness = LAWS[name]
    prepared = duhem.prepare(name, stiffness, parameters)
    trial, pressure = asked(name, 40)
    plain = 0
    for i, t in enumerate(trial):
        q = None if pressure is None else float(pressure[i])
        numbers = prepared._one.numbers(t, q)
        assert numbers is not None
        plain += prepared._one.answer(*numbers) is not None
        one, many = prepared.project(t, q), prepared.project(t[None], q)
        assert one.status.tolist() == many.status.tolist() and one.method == many.method and one.why == many.why
        for field in ("stress", "slip", "multiplier", "dissipation"):
            a, b = getattr(one, field), getattr(many, field)
            assert a.shape == b.shape and a.dtype == b.dtype
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-13 * np.abs(t).max())
        called = prepared(t, q)
        assert called.stress.tolist() == one.stress[0].tolist() and called.status == one.status[0]
        assert duhem.project(name, t, q, stiffness, parameters).stress.tolist() == one.stress.tolist()
    assert plain >= 30  # nearly all: few lie where the judge looks closer


@pytest.mark.parametrize(
    "trial", [[1.0, math.nan], [1.0], [1.0, 2.0, 3.0], [True, 1.0], ["1", 2.0], [1 + 0j, 2.0], [10**400, 1.0], [1.0, None]], ids=repr
)
def test_what_is_no_flat_list_of_finite_numbers_is_told_by_the_checks_of_arrays(trial: Any) -> None:
    parameters, stiffness = LAWS["antoni2007"]
    prepared = duhem.prepare("antoni2007", stiffness, parameters)
    assert prepared._one.numbers(trial, -1.0) is None
    try:
        expected = duhem.project("antoni2007", [trial], -1.0, stiffness, parameters)
    except InputError:
        with pytest.raises(InputError):
            prepared(trial, -1.0)
    else:
        assert prepared(trial, -1.0).stress.tolist() == expected.stress[0].tolist()


@pytest.mark.parametrize("pressure", [0.0, 1.0, math.nan, None, "-1", [-1.0], np.array([-1.0, -2.0])], ids=repr)
def test_other_pressures_are_asked_of_arrays(pressure: Any) -> None:
    parameters, stiffness = LAWS["antoni2007"]
    prepared = duhem.prepare("antoni2007", stiffness, parameters)
    assert prepared._one.numbers([1.0, 2.0], pressure) is None


def test_a_method_with_another_way_to_solve_is_not_passed_over() -> None:
    parameters, stiffness = LAWS["antoni2007"]
    wrong = replace(CLOSED_FORM, solve=lambda question, options: replace(closed_form.solve(question), slip=question.trial))
    assert duhem.prepare("antoni2007", stiffness, parameters, wrong)([1.0, 2.0], -1.0).status == Status.INACCURATE


def test_a_spoilt_answer_is_left_to_the_judge() -> None:
    parameters, stiffness = LAWS["antoni2007"]
    prepared = duhem.prepare("antoni2007", stiffness, parameters)
    right = prepared._one.answer([1.0, 2.0], -1.0)
    assert right is not None
    spoilt = OneIncrement(prepared.projector.setting, prepared.projector.method)
    spoilt.__dict__["_closest"] = lambda *_: ([x * (1.0 + 1e-6) for x in right.stress], right.slip, right.multiplier)
    assert spoilt.answer([1.0, 2.0], -1.0) is None


def test_pressures_that_are_alike_share_what_is_known_of_k(monkeypatch: pytest.MonkeyPatch) -> None:
    parameters, stiffness = LAWS["antoni2007"]
    variational_samples.tips.cache_clear()
    prepared = duhem.prepare("antoni2007", stiffness, parameters)
    for pressure in np.linspace(-15.9, -1.0, 60).tolist():
        assert prepared([5.0, 3.0], pressure).status == Status.SLIP
        assert prepared([[5.0, 3.0]], pressure).status.tolist() == [Status.SLIP]
    assert variational_samples.tips.cache_info().misses <= 5


def test_it_can_be_pickled_after_it_was_used() -> None:
    parameters, stiffness = LAWS["von-mises"]
    prepared = duhem.prepare("von-mises", stiffness, parameters)
    before = prepared([3.0, 0.0, 0.0])
    again = pickle.loads(pickle.dumps(prepared))([3.0, 0.0, 0.0])
    assert again.stress.tolist() == before.stress.tolist()


def test_where_k_is_not_shown_to_be_convex_arrays_are_asked() -> None:
    prepared = duhem.prepare("limacon", 1.0, {"mu": 0.3, "e": 0.9})
    assert not prepared._shown_convex


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(["antoni2007", "tresca"], "antoni2007"))
def test_compiled_answers_are_the_same(name: str) -> None:
    pytest.importorskip("numba")
    parameters, stiffness = LAWS[name]
    plain, compiled = (duhem.prepare(name, stiffness, parameters, compiled=one) for one in (False, True))
    trial, pressure = asked(name, 20, 3)
    for i, t in enumerate(trial):
        q = None if pressure is None else float(pressure[i])
        one, other = plain(t, q), compiled(t, q)
        assert one.status == other.status
        for a, b in zip(one[:3], other[:3], strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-13 * np.abs(t).max())
    load = None if pressure is None else -1.0
    assert compiled.project(trial[0], load).compiled and not plain.project(trial[0], load).compiled
    numbers = compiled._one.numbers(trial[0], load)
    assert numbers is not None and compiled._one.answer(*numbers) is not None
    assert compiled(trial, pressure).status.tolist() == plain(trial, pressure).status.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("power", long_at([0], [1.7, 1.3, 2.5]))
def test_a_power_that_is_no_real_number_is_left_to_arrays(power: float) -> None:
    law = Criterion("open powers", "abs(sigma_a)**m + abs(sigma_b)**m - abs(sigma_n)**m", {"m": Domain.between(1)})
    trials = [[-0.9, 1e-9], [1e4, 1.0], [3.0, -2e-7], [-50.0, 142.0]]
    for trial in trials:
        one, many = (duhem.project(law, [trial] * n if n > 1 else trial, -0.5, 1.0, {"m": power}) for n in (1, 500))
        assert one.status.tolist() == many.status[:1].tolist() == [Status.SLIP]
        np.testing.assert_allclose(one.stress[0], many.stress[0], atol=1e-9)


def test_a_method_that_is_not_compiled_says_so() -> None:
    parameters, stiffness = LAWS["orthotropic"]
    with pytest.raises(InputError, match="cvxpy is not compiled"):
        duhem.prepare("orthotropic", stiffness, parameters, "cvxpy", compiled=True)
