"""How large a multiplier is: what slip and gradient of the law's own formula make it, and at corners any of their cone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from duhem import Criterion, Domain, project
from duhem.testing import Case, Step, conformance, violation

SIDES = {"mu_a": 0.3, "mu_b": 0.2}
DISK = "norm(a, b) - r", "norm(a, b)**2 - r**2", "5*norm(a, b) - 5*r", "norm(a, b)/r - 1"


def at(parameters: dict[str, float], trial: list[float], pressure: float | None, k: list[float]) -> Case:
    zero = np.zeros((1, 2))
    load, loads = (None, None) if pressure is None else ([pressure], [[pressure] * 2])
    return Case(parameters, np.diag(k), load, [trial], zero, zero, zero, zero, [2.0], 2.0, np.zeros((1, 2, 2)), loads)


def refused(law: str | Criterion, case: Case, stress: list[float], multiplier: float) -> bool:
    def update(trial: np.ndarray, *_: object, **__: float) -> Step:
        rows = len(trial)
        return Step(np.tile(stress, (rows, 1)), multiplier=np.full(rows, multiplier))

    return violation("multiplier", law, update, case) is not None


@pytest.mark.parametrize("k", [[1.0, 1.0], [2.0, 7.0]])
def test_at_a_corner_any_of_the_cone_will_do(k: list[float]) -> None:
    """Both sides of a box: lambda is the sum of what each side takes, and within what either alone would give."""
    case = at(SIDES, [1.0, 1.0], -1.0, k)
    right = 0.3 * 0.7 / k[0] + 0.2 * 0.8 / k[1]
    assert not refused("box", case, [0.3, 0.2], right)
    assert [refused("box", case, [0.3, 0.2], share * right) for share in (2.0, 0.5, -1.0)] == [True, True, True]


@pytest.mark.parametrize("g", DISK)
def test_it_is_that_of_the_formula_as_it_is_written(g: str) -> None:
    law = Criterion(name="disk", g=g, forces=("a", "b"), pressure=None, parameters={"r": Domain(positive=True)})
    slip, r = 2.0, 3.0
    rates = dict(zip(DISK, (1.0, 2.0 * r, 5.0, 1.0 / r), strict=True))
    case = at({"r": r}, [0.0, r + 4.0 * slip], None, [4.0, 4.0])
    for other, rate in rates.items():
        assert refused(law, case, [0.0, r], slip / rate) == (other != g)
        assert refused(law, case, [0.0, r], slip / rate * (1.0 + 1e-7))


def test_it_is_none_of_its_business_where_the_stress_is_another_one() -> None:
    case = at(SIDES, [1.0, 0.0], -1.0, [1.0, 1.0])
    assert refused("orthotropic", case, [0.3, 0.0], 0.1) and not refused("orthotropic", case, [0.3, 0.0], 0.21)
    for wrong in ([0.2, 0.0], [0.4, 0.0], [0.18, 0.16]):  # inside, outside, on the boundary and not along the normal
        assert not refused("orthotropic", case, wrong, 0.1)


def test_a_set_that_is_one_point_has_none() -> None:
    for amount in (1.0, 2.0, 1e9):
        assert not refused("coulomb", at({"mu": 0.3}, [1.0, 1.0], 0.0, [1.0, 1.0]), [0.0, 0.0], amount)


@pytest.mark.parametrize("trial", [[2.0, 0.82], [2.0, 0.5], [0.5, 0.4]])
@pytest.mark.parametrize("amount", [1.0, 1e9, 6.7e14])
def test_the_node_of_a_curve_has_no_one_multiplier(trial: list[float], amount: float) -> None:
    """One piece of g has no slope there; beside it, on a side of the node, the multiplier is the slip over the slope as elsewhere."""
    assert not refused("teardrop", at({"P": 1.0}, trial, None, [1.0, 1.0]), [0.0, 0.0], amount)
    law = Criterion("node", "max(a + b, -a*b)", forces=("a", "b"), pressure=None)
    beside = at({}, [1.0, -2.0], None, [1.0, 1.0])
    assert refused(law, beside, [0.0, -2.0], amount) and not refused(law, beside, [0.0, -2.0], 0.5)


@pytest.mark.parametrize("below", [0.01, 0.03, 0.1])
@pytest.mark.parametrize("force", [-1e-3, -1e-2])
def test_a_normal_that_turns_within_the_error_in_stress_is_looked_for_there(below: float, force: float) -> None:
    """On a seam where K bends far more on one side the slope along the slip is largest between the seam and the error's end."""
    sizes = {"mu_a_plus": 210.0, "mu_a_minus": 1.0, "mu_b_plus": 1.0, "mu_b_minus": below}
    k = np.array([[0.01, 2.2357347785459702], [2.2357347785459702, 510.0]])
    case = replace(at(sizes, [1e4, force], -1.0, [1.0, 1.0]), stiffness=k)
    right = project("antoni2007", case.trial, -1.0, k, sizes, method="closed-form")
    seam = right.stress * [[1.0, 0.0]]
    assert -1e-6 < right.stress[0, 1] < 0.0
    for share, fails in ((1.0, False), (1.0 - 1e-3, True)):

        def update(trial: np.ndarray, *_: object, share: float = share, **__: float) -> Step:
            return Step(np.tile(seam, (len(trial), 1)), multiplier=np.tile(share * right.multiplier, len(trial)))

        assert (violation("multiplier", "antoni2007", update, case, accuracy=1e-11) is not None) == fails


def test_a_factor_is_told_from_one() -> None:
    def update(trial: np.ndarray, *_: object, **__: float) -> Step:
        size = np.linalg.norm(trial, axis=1)
        stress = trial * (0.3 / np.maximum(size, 0.3))[:, None]
        return Step(stress, multiplier=(1.0 + 1e-7) * np.linalg.norm(trial - stress, axis=1))

    options = {"stiffness": 1.0, "pressure": -1.0, "max_examples": 3, "tries": 5}
    report = conformance("coulomb", update, {"mu": 0.3}, checks=["multiplier"], **options)
    assert report.failures[0].diagnosis == "the multiplier is 1.0000001 times the slip over the gradient of g"
