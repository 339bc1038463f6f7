"""Exported routines against duhem.project where they used to differ: axes, tips, edges, and ways that begin beside the origin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion
from duhem.export.routine import routine
from duhem.law.shapes import Disk, Quadrants
from duhem.projection.extended_precision import close_look, closest
from duhem.projection.increment import posed, setting
from duhem.projection.result import Array
from tests.export.shared_library import OPTIMISED, compiled

EYE, APART = np.eye(3), np.diag([1.0, np.sqrt(10.0), 10.0])
COUPLED = APART + 0.3 * (np.ones((3, 3)) - EYE)


def in_many_digits(law: Criterion, trial: list[float], k: Array, start: Array) -> Array:
    """The closest point (3,) beside ``start``."""
    question = posed(setting(law, k, {}), np.array([trial]), None)
    found = closest(close_look(question), np.array(trial), 0.0, k, start, 0.0, 1.0)
    assert found is not None
    return found[0]


@pytest.mark.slow
def test_where_the_formula_has_no_value_a_trial_between_points_of_k_stays() -> None:
    """On the hydrostatic axis the Lode angle is 0/0."""
    run = compiled(duhem.load("abaqus-linear"), options=OPTIMISED)
    for size in (-0.5, -900.0, 1.4):
        status, stress, *_ = run.one(np.full(3, size), 0.0, COUPLED, [])
        assert status == 0 and stress == pytest.approx([size] * 3, abs=0.0)
    status, stress, *_ = run.one(np.full(3, 1.5), 0.0, COUPLED, [])
    assert status == 1 and stress == pytest.approx([10.0 / 7.0] * 3, rel=1e-14)


@pytest.mark.slow
def test_a_way_that_leaves_k_close_to_an_origin_without_a_value_is_begun_elsewhere() -> None:
    """x log x: towards most trials K ends next to the origin, and the closest point is far from there."""
    law = duhem.load("original-cam-clay")
    run = compiled(law, options=OPTIMISED)
    for trial in ([1.2219892, 0.148975, -1.5791622], [1.5578541, -0.9934683, -0.7715671], [-0.2369465, -0.1109198, 0.3031853]):
        for k in (EYE, COUPLED):
            status, stress, slip, _, tangent = run.one(np.array(trial), 0.0, k, [])
            assert status == 1 and np.isfinite(tangent).all() and k @ slip == pytest.approx(trial - stress, abs=1e-14)
            assert stress == pytest.approx(in_many_digits(law, trial, k, stress), abs=1e-14)


@pytest.mark.slow
def test_a_point_beside_a_tip_is_not_taken_for_the_tip() -> None:
    """As close as 1e-11 to the tip of a cubic cone its level is below rounding, and surfaces within K have every normal."""
    run = compiled(duhem.load("lade-duncan"), options=OPTIMISED)
    for trial, k in (([-9.087894168, 1.79034394, -3.768931966], COUPLED), ([-8.159066, 4.383017, -3.770783], APART)):
        status, stress, _, _, tangent = run.one(np.array(trial), 0.0, k, [])
        assert status == 1 and stress == pytest.approx(np.zeros(3), abs=1e-15) and not tangent.any()


@pytest.mark.slow
def test_a_tip_is_met_where_one_normal_presses_little() -> None:
    """Trials next to the edge of the cone of normals, and, in the middle of it, those on the axis, whose tangent is 0 as well."""
    law = duhem.load("menetrey-willam")
    run, tip = compiled(law, options=OPTIMISED), np.full(3, 0.09842009842009841)
    edge = [[0.46850821177077245, 0.09864470280967588, 0.9958006870554186], [0.111674, 0.999164, 0.121425]]
    for k, trials in ((EYE, edge), (APART, [[0.1984855782494276, 0.1002591751305215, 0.13571441607128365]]), (EYE, [[0.2, 0.2, 0.2]])):
        for trial in trials:
            status, stress, *_, tangent = run.one(np.array(trial), 0.0, k, [])
            assert status == 1 and stress == pytest.approx(tip, abs=1e-13) and not tangent.any()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "trial", "k"),
    [
        ("yu", {"st": 1}, [-0.00454695238826515, 1.9317394790330369, 2.030720046192283], EYE),
        ("hoek-brown-2002", {"a": "0.583", "mb": 1, "s": 1, "sci": 1}, [-6.138176912352113, -4.276799189825184, -0.395690788987914], EYE),
        ("nielsen", dict.fromkeys(("px", "py", "nx", "ny"), 1), [5.255587108052355, -5.258168538642183, -8.505258544597416], APART),
    ],
)
def test_pieces_that_half_spaces_touch_are_tried_where_they_meet(name: str, values: dict[str, Any], trial: list[float], k: Array) -> None:
    """Edges that are passed from every single piece: Newton's method is begun where they meet."""
    law = duhem.load(name).fix(values)
    status, stress, slip, _, tangent = compiled(law, options=OPTIMISED).one(np.array(trial), 0.0, k, [])
    known = duhem.project(law, np.tile(trial, (40, 1)), stiffness=k, tangent=True)
    assert known.tangent is not None
    assert status == known.status[0] == 1 and np.linalg.matrix_rank(tangent, 1e-9) == 1
    assert stress == pytest.approx(known.stress[0], abs=1e-13) and slip == pytest.approx(known.slip[0], abs=1e-12)
    assert tangent == pytest.approx(known.tangent[0], abs=1e-11)


def quarters(mu: list[float], k: list[float], load: float) -> tuple[Array, Array, Array]:
    """Trials (n, 2) from next to the boundary of four quarter ellipses to far beyond it, on axes too; their stresses and slips.

    Made from the answers: a stress on the boundary, and a slip along the normal there.
    """
    angle = np.concatenate([np.linspace(0.0, 2.0 * np.pi, 41), np.arange(4) * 0.5 * np.pi + 1e-7])
    way = np.round(np.stack([np.cos(angle), np.sin(angle)], axis=1), 15)
    own = np.stack([np.where(way[:, i] < 0.0, mu[2 * i + 1], mu[2 * i]) for i in (0, 1)], axis=1)
    far = 10.0 ** np.array([-30.0, -12.0, -7.0, -3.0, 0.0, 2.0])[:, None, None] * load / np.max(np.divide(own, k) * k / own**2)
    stress, slip = np.broadcast_arrays(own * load * way, far * way / own)
    return (stress + slip * k).reshape(-1, 2), stress.reshape(-1, 2), slip.reshape(-1, 2)


@pytest.mark.slow
@pytest.mark.parametrize("mu", [[0.4, 0.25, 0.3, 0.15], [1.0, 1.0, 1.0, 1.0], [1.0, 1e-3, 2e3, 1e4]])
def test_quarter_ellipses_have_the_closed_form_and_fall_back_where_it_does_not_tell(mu: list[float]) -> None:
    """Beside the boundary, seams and evolute, at any size: answers from which the trials were made, and those of Newton's method."""
    law = duhem.load("antoni2007")
    run, values = compiled(law, options=OPTIMISED), dict(zip(law.parameters, mu, strict=True))
    for k in ([1.0, 2.0], [3.0, 3.0], [1.0, 1e6]):
        for load in (1.0, 1e-50, 1e50):
            trial, stress, slip = quarters(mu, k, load)
            found = run(trial, np.full(len(trial), -load), np.diag(k), **values)
            size, clear = np.abs(trial).max(axis=1), np.abs(slip * k).max(axis=1) > 1e-5 * np.abs(stress).max(axis=1)
            off = np.maximum(np.abs(found.stress - stress), np.abs((found.slip - slip) * k)).max(axis=1) / size
            assert np.all(found.solved, where=clear) and off[clear].max() <= 1e-14
            assert off[found.solved].max() <= 1e-13
            if load == 1.0:
                other = duhem.project(law, trial[clear], -load, k, values, method="newton", tangent=True).tangent
                assert other is not None and np.nanmax(np.abs(np.asarray(found.tangent)[clear] - other)) <= 1e-9 * max(k)


@pytest.mark.slow
def test_a_closed_form_that_is_not_that_of_the_formula_is_not_believed() -> None:
    """An answer off the boundary of g <= 0 or its normal, and a trial that sticks outside of it, are left to Newton's method."""
    law = duhem.load("coulomb").fix({"mu": "1/2"})
    trial = np.random.default_rng(1).normal(size=(200, 2))
    known = duhem.project(law, trial, -1.0, 1.0)
    for wrong in (Disk("1"), Disk("1/4"), Quadrants("1/2", "1/2", "1/2", "1"), Disk("1/2", load="2*abs(sigma_n)")):
        found = compiled(replace(law, closed_form=wrong, name="wrong"))(trial, np.full(200, -1.0), np.eye(2))
        assert np.all(found.solved) and np.abs(found.stress - known.stress).max() <= 1e-14


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "closed"), [("antoni2007", True), ("coulomb", True), ("cohesive", True), ("shifted-ellipse", False), ("box", False)]
)
def test_which_routines_have_the_closed_form(name: str, closed: bool) -> None:
    assert ("on_quarters(" in routine(duhem.load(name)).text) is closed


@pytest.mark.slow
def test_answers_do_not_depend_on_what_the_memory_held_before() -> None:
    """Rows of pieces that nothing was written to were once read: the slip was then wrong for stiffnesses that couple the components.

    A compiler that fills all variables with zeros, and with a pattern, must give the same answers; and the dissipation must be the
    greatest power of the slip over K.
    """
    law, draw = duhem.load("antoni2007"), np.random.default_rng(5)
    runs = [compiled(law, options=(*OPTIMISED, f"-ftrivial-auto-var-init={fill}")) for fill in ("zero", "pattern")]
    slips = 0
    for _ in range(3_000):
        mu, trial = 10.0 ** draw.uniform(-1.0, 1.0, 4), draw.normal(size=2) * 10.0 ** draw.uniform(-1.0, 2.0)
        far = 10.0 ** draw.uniform(-1.0, 1.0)
        coupled = draw.uniform(-0.9, 0.9) * np.sqrt(far)
        one, two = (run.one(trial, -1.0, np.array([[1.0, coupled], [coupled, far]]), list(mu)) for run in runs)
        assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, two, strict=True))
        status, _, slip, power, _ = one
        if status == 1:
            slips += 1
            most = np.hypot(*(np.where(slip >= 0.0, mu[[0, 2]], mu[[1, 3]]) * slip))
            assert power == pytest.approx(most, rel=1e-9)
    assert slips > 1_500
