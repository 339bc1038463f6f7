"""Exported routines against duhem.project where they used to differ: axes, tips, edges, and ways that begin beside the origin."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion
from duhem.projection.ball_newton import closest
from duhem.projection.extended_precision import close_look
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
