"""duhem.project: what it refuses, how it chooses, that it never passes a wrong answer on, and the command."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.__main__ import main
from duhem.errors import InputError
from duhem.law.formula_law import Criterion, Domain
from duhem.projection import Status, closed_form, newton, projector
from duhem.projection.increment import Increment
from duhem.projection.metric import factors
from duhem.projection.residuals import residuals
from duhem.projection.result import Solution
from duhem.projection.validation import increment as checked

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
nan, inf = float("nan"), float("inf")
METHODS = ("closed-form", "newton", "cvxpy")


# -- input -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"trial": [[1, 2], [3, 4], [5, 6], [7, nan]]}, r"trial\[3, 1\] is nan"),
        ({"trial": [inf, 1]}, r"trial\[0\] is inf"),
        ({"trial": [1, 2, 3]}, r"trial has the shape \(3,\).*\(N, 2\) or \(2,\)"),
        ({"trial": [[1, 2], [3]]}, "trial: .*rectangular"),
        ({"trial": ["a", "b"]}, "trial: .*real numbers"),
        ({"trial": [1j, 2]}, "trial: .*real numbers"),
        ({"trial": 1.0}, "trial has the shape"),
        ({"pressure": nan}, "pressure is nan"),
        ({"pressure": [-1, -inf]}, r"pressure\[1\] is -inf"),
        ({"pressure": 0.5}, r"pressure is 0\.5 > 0; sigma_n <= 0 in compression"),
        ({"pressure": [-1, 2]}, r"pressure\[1\] is 2\.0 > 0"),
        ({"trial": np.ones((3, 2)), "pressure": [-1, -2]}, "3 trial stresses and 2 pressures do not broadcast"),
        ({"pressure": [[-1]]}, r"pressure has the shape \(1, 1\)"),
        ({"pressure": None}, "needs the pressure sigma_n"),
        ({"stiffness": 0}, "stiffness is 0.0, not positive"),
        ({"stiffness": [1, -2]}, r"stiffness\[1\] is -2.0, not positive"),
        ({"stiffness": [[1, 0], [0, nan]]}, r"stiffness\[1, 1\] is nan"),
        ({"stiffness": [[1, 0.5], [0.4, 1]]}, r"stiffness\[0, 1\] is 0.5 and stiffness\[1, 0\] is 0.4.*symmetric"),
        ({"stiffness": [[1, 2], [2, 1]]}, "stiffness: .*positive definite"),
        ({"stiffness": [1, 2, 3]}, r"stiffness has the shape \(3,\)"),
        ({"parameters": {**MU, "mu_a_plus": -0.1}}, "mu_a_plus = -1/10 lies outside its domain positive"),
        ({"parameters": {**MU, "mu_a_plus": 0}}, "mu_a_plus = 0 lies outside its domain positive"),
        ({"parameters": {**MU, "mu_a_plus": nan}}, "parameter mu_a_plus: 'nan' is not a number"),
        ({"parameters": {**MU, "mu": 1}}, "unknown parameter 'mu'"),
        ({"parameters": {"mu_a_plus": 1, "mu_b_plus": 1}}, "no value is given for mu_a_minus, mu_b_minus"),
        ({"parameters": {**MU, "mu_a_plus": "1e-350"}}, "beyond double precision"),
        ({"method": "exact"}, "unknown method 'exact'.*closed-form"),
        ({"depth": 3}, "takes no such option"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_input_that_cannot_be_used(change: dict[str, Any], message: str) -> None:
    asked = {"trial": [0.3, 0.2], "pressure": -1.0, "stiffness": 1.0, "parameters": MU} | change
    with pytest.raises(ValueError, match=message) as caught:
        duhem.project("antoni2007", **asked)
    assert isinstance(caught.value, InputError)
    assert "\n" not in str(caught.value)


def test_constraints_between_parameters() -> None:
    with pytest.raises(InputError, match="shift < mu_a does not hold at mu_a = 1/10, shift = 1/5"):
        duhem.project("shifted-ellipse", [1, 1], -1, parameters={"mu_a": 0.1, "mu_b": 1, "shift": 0.2})


def test_a_formula_that_a_zero_coefficient_breaks() -> None:
    law = Criterion("thin", "norm(sigma_a/mu, sigma_b) - abs(sigma_n)", {"mu": Domain.between(0, 1)})
    with pytest.raises(InputError, match="g is not defined at mu = 0"):
        duhem.project(law, [1, 1], -1, parameters={"mu": 0})


@pytest.mark.parametrize("name", ["radial-flow", "rotated-flow"])
def test_a_flow_of_its_own_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=r"flow of its own.*associated laws only.*integrate its flow rule"):
        duhem.project(name, [1, 1], -1)


def test_a_law_without_pressure() -> None:
    with pytest.raises(InputError, match="von-mises has no pressure; leave it out"):
        duhem.project("von-mises", [1, 0, 0], -1, parameters={"yield_stress": 1})


def test_shapes_broadcast_and_parameters_may_be_fixed_in_the_law() -> None:
    law = duhem.load("coulomb").fix({"mu": "0.3"})
    assert duhem.project(law, [1.0, 0.0], [-1.0, -2.0, 0.0]).stress.tolist() == [[0.3, 0.0], [0.6, 0.0], [0.0, 0.0]]
    assert duhem.project(law, [[1.0, 0.0], [0.1, 0.0]], -1.0).stress.tolist() == [[0.3, 0.0], [0.1, 0.0]]
    assert duhem.project(law, np.ones((1, 2), dtype=np.float32), [-1]).stress.shape == (1, 2)
    empty = duhem.project(law, np.empty((0, 2)), -1.0)
    assert empty.stress.shape == (0, 2) and empty.status.shape == (0,)


def test_stiffness_in_its_three_forms() -> None:
    trial = np.random.default_rng(0).normal(size=(50, 2))
    forms: list[Any] = [2.0, [2.0, 2.0], [[2.0, 0.0], [0.0, 2.0]]]
    first, *others = (duhem.project("antoni2007", trial, -1.0, k, MU) for k in forms)
    for other in others:
        assert np.array_equal(first.stress, other.stress) and np.array_equal(first.slip, other.slip)


def test_arguments_are_left_as_they_were() -> None:
    trial, pressure, k = np.array([[1.0, 2.0], [0.0, 0.0]]), np.array([-1.0, -2.0]), np.eye(2)
    given = [a.copy() for a in (trial, pressure, k)]
    done = duhem.project("antoni2007", trial, pressure, k, MU)
    done.stress[:] = 7.0
    assert all(np.array_equal(a, b) for a, b in zip((trial, pressure, k), given, strict=True))


# -- method ----------------------------------------------------------------------------------------------------------


def test_auto_takes_the_cheapest_and_says_why() -> None:
    done = duhem.project("antoni2007", [1, 1], -1, parameters=MU)
    assert (done.method, done.why) == ("closed-form", "the cheapest method that applies")
    other = duhem.project("von-mises", [1, 0, 0], parameters={"yield_stress": 0.5})
    assert other.method != "closed-form"
    assert "not closed-form: von-mises declares no closed form" in other.why
    assert duhem.project("antoni2007", [1, 1], -1, parameters=MU, method="closed-form").why == "asked for"
    with pytest.raises(InputError, match="method closed-form does not apply: box declares no closed form"):
        duhem.project("box", [1, 1], -1, parameters={"mu_a": 1, "mu_b": 1}, method="closed-form")


def test_a_formula_alone_needs_no_declaration() -> None:
    """The same numbers whether the closed form is declared or not: leaving it out costs time only."""
    law = duhem.load("antoni2007")
    trial = np.random.default_rng(1).normal(size=(40, 2))
    with_, without = (duhem.project(x, trial, -1.0, [1.0, 3.0], MU) for x in (law, replace(law, closed_form=None)))
    assert without.method == "newton"
    assert np.abs(with_.stress - without.stress).max() <= 1e-12
    assert np.abs(with_.multiplier - without.multiplier).max() <= 1e-12


# -- status ----------------------------------------------------------------------------------------------------------

Spoil = Callable[[Solution], Solution]


def _turned(by: float) -> Spoil:
    """The stress moved along the boundary, with the slip that balances it."""

    def spoil(s: Solution) -> Solution:
        stress = s.stress.copy()
        angle = np.arctan2(stress[:, 1] / 0.2, stress[:, 0] / 0.3) + by
        stress = np.stack([0.3 * np.cos(angle), 0.2 * np.sin(angle)], axis=1)
        return replace(s, stress=stress, slip=s.slip + s.stress - stress)

    return spoil


@pytest.mark.parametrize(
    ("spoil", "residual"),
    [
        (lambda s: replace(s, stress=s.stress * (1 + 1e-6)), "feasibility"),
        (lambda s: replace(s, multiplier=-s.multiplier), "multiplier_sign"),
        (lambda s: replace(s, stress=s.stress * 0.9), "complementarity"),
        (lambda s: replace(s, slip=s.slip * (1 + 1e-6)), "stationarity"),
        (lambda s: replace(s, multiplier=s.multiplier * 1.001), "stationarity"),
        (_turned(1e-5), "stationarity"),
        (_turned(0.7), "variational"),
        (lambda s: replace(s, slip=0 * s.slip, multiplier=0 * s.multiplier), "stationarity"),
    ],
    ids=["outside", "negative", "inside", "slip", "multiplier", "turned", "far", "no-slip"],
)
def test_a_wrong_answer_is_inaccurate(monkeypatch: pytest.MonkeyPatch, spoil: Spoil, residual: str) -> None:
    right = closed_form.solve
    monkeypatch.setattr(closed_form, "solve", lambda question: spoil(right(question)))
    angle = np.linspace(0.05, 1.5, 8)
    trial = 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    done = duhem.project("orthotropic", trial, -1.0, parameters={"mu_a": 0.3, "mu_b": 0.2})
    assert (getattr(done.residuals, residual) > 1e-7).any()
    assert (done.status[getattr(done.residuals, residual) > 1e-7] == Status.INACCURATE).all()
    if residual != "variational":
        assert (done.status == Status.INACCURATE).all()


@pytest.mark.parametrize("field", ["stress", "slip", "multiplier"])
@pytest.mark.parametrize("value", [nan, inf])
def test_what_is_not_finite_has_failed(monkeypatch: pytest.MonkeyPatch, field: str, value: float) -> None:
    right = closed_form.solve

    def broken(question: Increment) -> Solution:
        solution = right(question)
        getattr(solution, field)[1] = value
        return solution

    monkeypatch.setattr(closed_form, "solve", broken)
    done = duhem.project("coulomb", [[1.0, 2.0], [1.0, 3.0], [0.01, 0.0]], -1.0, parameters={"mu": 0.3})
    assert done.status.tolist() == [Status.SLIP, Status.FAILED, Status.STICK]


def test_a_stick_outside_is_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    def lazy(q: Increment) -> Solution:
        n = len(q.trial)
        return Solution(q.trial.copy(), np.zeros_like(q.trial), np.zeros(n), np.zeros(n, dtype=bool))

    monkeypatch.setattr(closed_form, "solve", lazy)
    done = duhem.project("coulomb", [[0.30001, 0.0], [0.29, 0.0]], -1.0, parameters={"mu": 0.3})
    assert done.status.tolist() == [Status.INACCURATE, Status.STICK]


def test_corners_are_judged_by_their_cone(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a corner of the box any slip between the two normals is right, and no other."""
    law = Criterion("corner", "max(abs(sigma_a), abs(sigma_b)) - abs(sigma_n)", {})
    for trial, right in (((3.0, 2.0), True), ((3.0, 0.5), False)):

        def at_corner(q: Increment, t: tuple[float, float] = trial) -> Solution:
            slip = np.array([[t[0] - 1.0, t[1] - 1.0]])
            return Solution(np.array([[1.0, 1.0]]), slip, np.abs(slip).sum(axis=1), np.zeros(1, dtype=bool))

        monkeypatch.setattr(closed_form, "applies", lambda q: None)
        monkeypatch.setattr(closed_form, "solve", at_corner)
        status = duhem.project(law, trial, -1.0).status[0]
        assert status == (Status.SLIP if right else Status.INACCURATE)


def test_residuals_are_pure_numbers() -> None:
    trial = np.random.default_rng(4).normal(size=(200, 2))
    for unit in (1e-9, 1.0, 1e9):
        done = duhem.project("antoni2007", trial * unit, -unit, [1e11, 3e11], MU)
        assert done.residuals.worst().max() <= 2e-15


@pytest.mark.parametrize("seed", range(12))
def test_no_right_answer_is_called_inaccurate(seed: int) -> None:
    """mu ratio 1e8, |sigma_n| 1e-200 ... 1e200, trials to 1e16 radii, stiffness of condition 1e12 in any unit."""
    rng = np.random.default_rng(seed)
    mu = dict(zip(MU, (10 ** rng.uniform(-4, 4, 4)).tolist(), strict=True))
    angle, soft = rng.uniform(0, np.pi), 10 ** rng.uniform(-12, -8)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    k = turn @ np.diag([1.0, soft]) @ turn.T * 10 ** rng.uniform(-9, 12)
    load, way = 10 ** rng.uniform(-200, 200, 200), rng.normal(size=(200, 2))
    radius = 1 / np.hypot(*(np.where(way < 0, way / -mu[f"mu_{i}_minus"], way / mu[f"mu_{i}_plus"])[:, j] for j, i in enumerate("ab")))
    far = np.where(rng.random(200) < 0.5, 10 ** rng.uniform(-1, 16, 200), 1 + 10 ** rng.uniform(-16, 0, 200))
    done = duhem.project("antoni2007", way * (radius * load * far)[:, None], -load, (k + k.T) / 2, mu)
    assert set(done.status) == {Status.STICK, Status.SLIP}


@pytest.mark.parametrize(
    ("mu", "k", "trial", "pressure"),
    [
        (
            (1e-6, 12.0, 1e-6, 12.0),
            (2.0163991891162093e-04, 4.1648283358679095e04),
            (30519.064159532085, -34611.77821855558),
            -0.1955379819,
        ),
        ((12.0, 12.0, 1e-6, 1e-6), (1.0, 1.0), (1e7, 3e6), -1.0),
        ((12.0, 12.0, 1e-6, 1e-6), (1.0, 1.0), (4.0, 2e-6), -1.0),
    ],
)
@pytest.mark.parametrize("shift", [1e-2, 1e-4, 1e-5])
def test_a_stress_shifted_along_a_flat_side_is_inaccurate(
    mu: tuple[float, ...], k: tuple[float, float], trial: tuple[float, float], pressure: float, shift: float
) -> None:
    """On a flat side the normal hardly turns: a slip along it and balanced to 1e-8 of the trial says little of the place."""
    question = checked(duhem.load("antoni2007"), trial, pressure, k, dict(zip(MU, mu, strict=True)))
    right = closed_form.solve(question)
    assert residuals(question, right).worst()[0] <= 1e-14
    i = int(np.argmax(np.abs(right.stress[0]) / np.sqrt(k)))  # the long way, in the metric of k
    stress = right.stress.copy()
    stress[0, i] *= 1 - shift
    axes = np.array([mu[2 * j + (stress[0, j] < 0)] for j in (0, 1)]) * -pressure
    stress[0, 1 - i] = np.copysign(axes[1 - i] * np.sqrt(1 - (stress[0, i] / axes[i]) ** 2), stress[0, 1 - i])
    normal = stress / axes**2
    amount = (normal / k * (question.trial - stress)).sum() / (normal**2 / k * k).sum()
    for slip in (amount * normal, (question.trial - stress) / k):  # along the normal, or in balance
        length = np.linalg.norm(slip * np.sqrt(k)) / np.linalg.norm(normal * np.sqrt(k))
        gradient = np.linalg.norm(normal * np.sqrt(k)) * length / np.linalg.norm(stress / axes**2 / -pressure * np.sqrt(k) * pressure**2)
        wrong = Solution(stress, slip, np.array([gradient]), np.zeros(1, dtype=bool))
        assert residuals(question, wrong).worst()[0] > min(shift / 100, 1e-6)


PERTURBED: list[tuple[str, dict[str, Any], float | None]] = [
    ("antoni2007", MU, -1.0),
    ("antoni2007", dict(zip(MU, (12.0, 12.0, 1e-6, 2e-6), strict=True)), -1.0),
    ("superellipse", {"mu_a": 0.2, "mu_b": 0.1, "p": "1.01"}, -1.0),
    ("superellipse", {"mu_a": 0.2, "mu_b": 0.1, "p": 50}, -1.0),
    ("box", {"mu_a": 0.2, "mu_b": 0.3}, -1.0),
    ("hosford", {"yield_stress": 0.1, "m": "1.1"}, None),
    ("tresca", {"yield_stress": 0.1}, None),
]


@pytest.mark.parametrize(("law", "parameters", "pressure"), PERTURBED, ids=lambda x: x if isinstance(x, str) else "")
@pytest.mark.parametrize("condition", [1.0, 1e6])
def test_no_stress_that_is_off_by_more_than_a_millionth_passes(
    law: str, parameters: dict[str, Any], pressure: float | None, condition: float
) -> None:
    """Right answers pass; pushed aside on the boundary they do not, however sharp or flat it is there."""
    rng = np.random.default_rng(3)
    d = len(duhem.load(law).forces)
    turn, _ = np.linalg.qr(rng.standard_normal((d, d)))
    k = (turn * np.geomspace(1.0, condition, d)) @ turn.T
    lower, inverse = factors((k + k.T) / 2)
    size = 0.1 if pressure is None else 1.0
    trial = size * rng.standard_normal((80, d)) * 10 ** rng.uniform(-1, 4, 80)[:, None]
    question = checked(duhem.load(law), trial, pressure, (k + k.T) / 2, parameters)
    right = newton.solve(question)
    slips = np.flatnonzero((right.multiplier > 0) & ~right.failed & (residuals(question, right).worst() <= 1e-7))
    assert len(slips) > 30
    question = replace(question, trial=question.trial[slips], pressure=question.pressure[slips])
    stress, multiplier = right.stress[slips], right.multiplier[slips]
    reach = np.linalg.norm(stress @ inverse.T, axis=1)
    seen = 0
    for shift in (1e-3, 1e-5, 1e-6):
        way = rng.standard_normal((len(slips), d))
        moved = stress + shift * reach[:, None] * (way / np.linalg.norm(way, axis=1)[:, None]) @ lower.T
        aside = newton.solve(replace(question, trial=moved)).stress
        slip = np.linalg.solve(question.stiffness, (question.trial - aside).T).T
        wrong = residuals(question, Solution(aside, slip, multiplier, np.zeros(len(slips), dtype=bool))).worst()
        off = np.linalg.norm((aside - stress) @ inverse.T, axis=1) / reach > 1e-6
        seen += int(off.sum())
        assert not (wrong[off] <= 1e-7).any()
    assert seen > 20


POINTS: list[tuple[str | Criterion, dict[str, Any], tuple[float, float]]] = [
    ("antoni2007", MU, (0, 0)),
    ("polygon", {"mu": 0.2}, (0, 0)),
    ("regularised", {"mu": 0.2, "c": 0.1}, (0, 0)),
    ("quartic", {"mu": 0.2, "c": 1}, (0, 0)),
    ("limacon", {"mu": 0.2, "e": 0.5}, (0, 0)),
    ("matchstick", {"mu_a": 0.2, "mu_b": 0.15}, (0, 0)),
    ("superellipse", {"mu_a": 0.2, "mu_b": 0.1, "p": "1.01"}, (0, 0)),
    (Criterion("cone", "norm(sigma_a - 1/10, sigma_b) - abs(sigma_n)"), {}, (0.1, 0)),
    (Criterion("bowl", "(sigma_a - 1/10)**2 + sigma_b**2 - sigma_n**2"), {}, (0.1, 0)),
    (Criterion("pyramid", "max(abs(sigma_a - 1/7), abs(sigma_b + 1/3)) - abs(sigma_n)"), {}, (1 / 7, -1 / 3)),
]


DRAWN = ("polygon", "quartic", "limacon", "matchstick", "superellipse", "cone", "bowl", "pyramid")  # declare no closed form


@pytest.mark.parametrize(("law", "parameters", "point"), POINTS, ids=lambda x: x if isinstance(x, str) else getattr(x, "name", ""))
@pytest.mark.parametrize("method", METHODS)
def test_where_k_is_one_point_every_slip_goes(
    law: str | Criterion, parameters: dict[str, Any], point: tuple[float, float], method: str
) -> None:
    trial, k = np.array([[0.3, -0.4], [-2.0, 1e5], [2.0, 0.7]]), np.array([3.0, 1.0])
    if getattr(law, "name", law) in {"closed-form": DRAWN, "cvxpy": ("quartic",), "newton": ()}[method]:
        with pytest.raises(InputError):
            duhem.project(law, trial, 0.0, k, parameters, method=method)
        return
    done = duhem.project(law, trial, 0.0, k, parameters, method=method)
    assert (done.status == Status.SLIP).all()
    assert np.abs(done.stress - point).max(axis=1) == pytest.approx(0.0, abs=1e-15 + 1e-14 * np.abs(trial * np.any(point)).max())
    assert np.abs(done.slip - (trial - point) / k).max() <= 1e-13 * np.abs(trial).max()
    assert (done.multiplier > 0).all() and np.isfinite(done.multiplier).all()


def test_multipliers_where_k_is_one_point() -> None:
    """At the tip of a cone the dissipation potential at unit pressure; where g has no slope, the length of the slip."""
    trial = np.array([[0.3, -0.4], [-2.0, 30.0]])
    exact = [np.hypot(0.2 * 0.3, 0.15 * 0.4), np.hypot(0.08 * 2.0, 0.12 * 30.0)]
    for method, digits in (("closed-form", 1e-15), ("newton", 1e-8), ("cvxpy", 1e-6)):
        assert duhem.project("antoni2007", trial, 0.0, 1.0, MU, method=method).multiplier == pytest.approx(exact, rel=digits)
        smooth = duhem.project("regularised", trial, 0.0, 2.0, {"mu": 0.2, "c": 0.1}, method=method)
        assert smooth.multiplier == pytest.approx(np.hypot(*trial.T) / 2, rel=1e-14)


def test_a_wrong_point_at_no_pressure_is_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    """A line is no point: the origin is right for one slip only."""
    law = Criterion("line", "abs(sigma_a - 2*sigma_b) - abs(sigma_n)")
    trial = np.array([[1.0, -2.0], [1.0, -1.0], [1.0, 2.0]])
    assert duhem.project(law, trial, 0.0, method="newton").stress == pytest.approx(trial - (trial @ [0.2, -0.4])[:, None] * [1, -2])

    def origin(q: Increment) -> Solution:
        return Solution(np.zeros_like(q.trial), q.trial.copy(), np.linalg.norm(q.trial, axis=1), np.zeros(len(q.trial), dtype=bool))

    monkeypatch.setattr(newton, "solve", origin)
    assert duhem.project(law, trial, 0.0, method="newton").status.tolist() == [Status.SLIP, Status.INACCURATE, Status.INACCURATE]


# -- prepared --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_a_projector_gives_the_numbers_of_project(method: str) -> None:
    trial = np.random.default_rng(2).normal(size=(6, 2))
    prepared = projector("antoni2007", [1.0, 3.0], MU, method)
    for pressure in (-1.0, -0.2):
        at_once, later = duhem.project("antoni2007", trial, pressure, [1.0, 3.0], MU, method), prepared(trial, pressure)
        for name in ("stress", "slip", "multiplier", "status"):
            assert np.array_equal(getattr(at_once, name), getattr(later, name))
        assert (at_once.method, at_once.why) == (later.method, later.why)
    with pytest.raises(InputError, match=r"pressure is 1\.0 > 0"):
        prepared(trial, 1.0)
    with pytest.raises(InputError, match="trial has the shape"):
        prepared([1.0, 2.0, 3.0], -1.0)


# -- facts of the step -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("k", [np.eye(2), np.array([[2.0, 1.2], [1.2, 1.0]])], ids=["isotropic", "full"])
def test_facts_of_the_step(k: np.ndarray) -> None:
    """Idempotent, non-expansive in k^-1, dissipative, dissipation lambda |sigma_n|, rate independent."""
    rng = np.random.default_rng(9)
    trial = rng.normal(size=(400, 2))
    done = duhem.project("antoni2007", trial, -0.8, k, MU)
    again = duhem.project("antoni2007", done.stress, -0.8, k, MU)
    assert np.abs(again.stress - done.stress).max() <= 1e-15
    metric = np.linalg.inv(k)

    def size(v: np.ndarray) -> np.ndarray:
        return np.asarray(np.einsum("ni,ij,nj->n", v, metric, v))

    before, after = trial - np.roll(trial, 1, axis=0), done.stress - np.roll(done.stress, 1, axis=0)
    assert (size(after) <= size(before) * (1 + 1e-13)).all()
    assert (done.dissipation >= 0).all()
    assert np.allclose(done.dissipation, 0.8 * done.multiplier, rtol=1e-13, atol=0)
    assert np.abs(trial - done.stress - done.slip @ k).max() <= 1e-14


# -- lean, and the command -------------------------------------------------------------------------------------------


def test_the_closed_form_imports_no_solver() -> None:
    code = (
        "import sys, duhem; duhem.project('antoni2007', [[1, 2]], -1, parameters=dict.fromkeys(duhem.load('antoni2007').parameters, 1));"
        "print([m for m in ('cvxpy', 'clarabel', 'scipy', 'z3', 'hypothesis', 'numba') if m in sys.modules])"
    )
    source = str(Path(duhem.__path__[0]).parent)
    done = subprocess.run([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": source}, capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "[]", done.stderr


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Exit code, standard output and standard error of `duhem project ARGUMENTS`."""

    def call(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["duhem", "project", *arguments])
        code = main()
        return code, *capsys.readouterr()

    return call


SET = [x for name, value in MU.items() for x in ("--set", f"{name}={value}")]


def test_command_prints_the_step_and_its_residuals(run: Run) -> None:
    code, out, err = run("antoni2007", *SET, "--trial", "0.3", "-0.01", "--pressure", "-1", "--tangent")
    assert (code, err) == (0, "")
    for piece in ("0.199875612441215", "-0.00528947044397025", "slip", "closed-form", "stationarity", "variational", "d stress/d sigma_n"):
        assert piece in out
    assert max(map(len, out.splitlines())) <= 100


def test_command_in_json(run: Run) -> None:
    code, out, _ = run("antoni2007", *SET, "--pressure", "-1", "--stiffness", "1", "4", "--format", "json", "--trial", "-0.3", "-0.2")
    report = json.loads(out)
    assert code == 0
    assert report["stress"] == pytest.approx([-0.076140510365716902, -0.04602820183065], rel=1e-14)
    assert report["status"] == "slip"
    assert set(report["residuals"]) == {"feasibility", "multiplier_sign", "complementarity", "stationarity", "variational"}


def test_command_takes_a_matrix_and_fractions(run: Run) -> None:
    matrix = run("coulomb", "--set", "mu=0.3", "--trial=1/2,1", "--pressure", "-1", "--stiffness", "2", "-1", "-1", "2", "--format", "json")
    done = duhem.project("coulomb", [0.5, 1.0], -1.0, [[2.0, -1.0], [-1.0, 2.0]], {"mu": "0.3"})
    assert json.loads(matrix[1])["stress"] == done.stress[0].tolist()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["coulomb", "--set", "mu=1", "--trial", "1", "2", "--pressure", "1"], "pressure is 1.0 > 0"),
        (["coulomb", "--set", "mu=1", "--trial", "1", "nan", "--pressure", "-1"], "--trial: 'nan' is not a number"),
        (["coulomb", "--set", "mu=1", "--trial", "1", "2", "3", "--pressure", "-1"], "trial has the shape"),
        (["coulomb", "--trial", "1", "2", "--pressure", "-1"], "no value is given for mu"),
        (["coulomb", "--set", "mu=1", "--trial", "1", "2", "--pressure", "-1,-2"], "2 numbers are given"),
        (["coulomb", "--set", "mu=1", "--pressure", "-1"], "--trial"),
    ],
)
def test_command_refuses(run: Run, arguments: list[str], message: str) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err


def test_command_ends_with_4_where_the_point_is_not_solved(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    right = closed_form.solve
    monkeypatch.setattr(closed_form, "solve", lambda q: replace(right(q), stress=right(q).stress * 1.1))
    code, out, _ = run("coulomb", "--set", "mu=0.3", "--trial", "1", "2", "--pressure", "-1")
    assert code == 4
    assert "inaccurate" in out
