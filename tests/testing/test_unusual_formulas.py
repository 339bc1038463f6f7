"""A right routine is not accused for the way in which g is written: without a value at pressure 0, or without a slope on the boundary."""

from __future__ import annotations

import numpy as np
import pytest

from duhem import Criterion
from duhem.testing import Step, Update, conformance, violation
from duhem.testing.conformance import check
from duhem.testing.drawn.case import Region
from duhem.testing.run import ConformanceRun
from tests.long import mostly_long
from tests.testing.test_multipliers import at, refused

FORCES = ("a", "b")
OPTIONS = {"stiffness": 1.0, "pressure": None, "accuracy": 1e-9, "max_examples": 1, "rows": 1}
OTHER_WORDS = {"stiffness": 1e9, "max_examples": 4, "seed": 0, "tries": 5}
WRITTEN = {"relative": "norm(a, b)/(3/10*abs(s)) - 1", "cubed": "(norm(a, b) - 3/10*abs(s))**3"}


def law(name: str) -> Criterion:
    return Criterion(name=name, g=WRITTEN[name], forces=FORCES, pressure="s", parameters={})


def disk(share: float) -> Update:
    def update(trial: np.ndarray, pressure: np.ndarray, stiffness: np.ndarray) -> Step:
        radius, size = 0.3 * share * np.abs(pressure), np.linalg.norm(trial, axis=1)
        return Step(trial * np.where(size > radius, radius / np.maximum(size, 1e-300), 1.0)[:, None])

    return update


@pytest.mark.slow
@pytest.mark.parametrize("name", WRITTEN)
def test_the_disk_of_coulomb_in_other_words(name: str) -> None:
    report = conformance(law(name), disk(1.0), **OTHER_WORDS)
    assert report.ok and {"feasibility", "origin"} <= set(report.passed), str(report)
    assert ("not judged because g has no value there" in report.counted()) == (report.undefined > 0) == (name == "relative")


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(WRITTEN, "relative"))  # to find a small example for the other takes half a minute
def test_a_larger_disk_is_refused_in_other_words(name: str) -> None:
    assert "feasibility" in conformance(law(name), disk(1.0 + 1e-6), checks=["feasibility"], **OTHER_WORDS).failed


def test_a_pole_at_no_pressure_has_the_sign_that_it_has_beside_it() -> None:
    region, stress = Region(law("relative"), {}), np.array([[1.0, 0.0]])
    assert [region.outside(stress, np.array([pressure])).tolist() for pressure in (0.0, -0.0, -1.0, -4.0)] == [[True]] * 3 + [[False]]
    assert region.level(stress, np.zeros(1)) == np.inf


def test_a_stress_next_to_the_boundary_is_admissible_where_the_gradient_vanishes() -> None:
    for angle in np.linspace(0.1, 1.5, 12):
        case = at({}, [np.cos(angle), np.sin(angle)], -1.2e-3, [1.0, 1.0])
        for share, wrong in ((1.0, False), (1.001, True)):
            found = violation("feasibility", law("cubed"), disk(share), case)
            assert (found is not None) == wrong, (angle, found)


def test_a_gradient_that_vanishes_has_no_multiplier() -> None:
    case = at({}, [1.0, 0.0], -1.0, [1.0, 1.0])
    for amount, wrong in ((7.0, False), (np.inf, False), (np.nan, False), (-7.0, True)):
        assert refused(law("cubed"), case, [0.3, 0.0], amount) == wrong
    assert refused(law("relative"), case, [0.3, 0.0], 7.0) and not refused(law("relative"), case, [0.3, 0.0], 0.21)


def test_what_a_routine_raised_is_not_asked_for_by_every_check() -> None:
    asked: list[bytes] = []

    def update(trial: np.ndarray, pressure: np.ndarray, stiffness: np.ndarray) -> Step:
        asked.append(trial.tobytes())
        raise ArithmeticError

    case = at({}, [1.0, 0.0], -1.0, [1.0, 1.0])
    run = ConformanceRun(law("cubed"), update, None, [*map(check, ("answers", "feasibility", "slip", "ray", "path"))], **OPTIONS)
    assert len(list(run.failures(run.query(case), run.asked))) == 1
    assert len(asked) == len(set(asked))
