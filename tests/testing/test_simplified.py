"""A failing case is made short to read, and stays one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from duhem.testing import Case, conformance, violation
from duhem.testing.failures.failure import simplified
from tests.oracles.mutant_routines import MUTANTS
from tests.oracles.round_numbers import unrounded
from tests.oracles.routines import DISK, nothing

ROUGH = np.array([[0.12345, -4.56789]])
CASE = Case(
    {"mu": 0.31234, "given": 0.5432},
    np.array([[1.2345, 0.1], [0.1, 3.4567]]),
    np.array([-7.6543]),
    *[ROUGH * i for i in (1.0, 1.1, 1.2, 0.1, 0.2)],
    stretch=np.array([0.5]),
    factor=4.0,
    path=np.tile(ROUGH, (1, 6, 1)),
    loads=np.full((1, 6), -7.6543),
)


def test_what_a_failure_does_not_need_is_gone() -> None:
    short = simplified(CASE, lambda case: bool(abs(case.trial[0, 1]) > 3.0), lambda values: True, free=("mu",))
    assert unrounded(short) == 1 and short.parameters == {"mu": 1.0, "given": 0.5432}
    assert short.pressure is not None and short.pressure.tolist() == [-1.0] and np.array_equal(short.stiffness, np.eye(2))
    assert short.trial[0, 0] == 0.0 and abs(short.trial[0, 1]) > 3.0
    assert not short.path.any() and not short.other.any() and short.path.shape == (1, 2, 2)


def test_what_is_given_stays() -> None:
    short = simplified(CASE, lambda case: True, lambda values: False, free=("mu",), stiffness=False, pressure=None)
    assert short.parameters == CASE.parameters and np.array_equal(short.stiffness, CASE.stiffness)
    assert short.pressure is not None and short.pressure.tolist() == [-7.6543]


def test_a_stiffness_stays_one() -> None:
    case = replace(CASE, stiffness=[[1.04, 1.049], [1.049, 1.06]])
    short = simplified(case, lambda case: bool(case.stiffness[0, 1] == 1.049), lambda values: True)
    assert (np.linalg.eigvalsh(short.stiffness) > 0.0).all() and short.stiffness[1, 1] == 1.1


def test_nothing_is_changed_that_the_failure_needs() -> None:
    needed = repr(CASE)
    assert repr(simplified(CASE, lambda case: repr(case) == needed, lambda values: True, free=("mu",))) == needed


def test_numbers_of_two_digits_are_round() -> None:
    assert unrounded(CASE) > 10
    assert unrounded(simplified(CASE, lambda case: True, lambda values: True, free=("mu", "given"))) == 0


def test_a_documented_example_has_few_numbers() -> None:
    (failure,) = conformance("coulomb", nothing, DISK, checks=["feasibility"], max_examples=5, tries=20).failures
    assert unrounded(failure.case) == 0
    assert violation("feasibility", "coulomb", nothing, failure.case, open_parameters=()) == failure.message


SHORT = ["slip in units of stress", "an exception"]


@pytest.mark.slow
@pytest.mark.parametrize("name", [pytest.param(m.name, marks=[] if m.name in SHORT else pytest.mark.long) for m in MUTANTS])
def test_a_wrong_routine_is_found_for_its_cause_and_shown_in_few_numbers(name: str) -> None:
    (mutant,) = (m for m in MUTANTS if m.name == name)
    options = {"max_examples": 7, "rows": 28, "seed": 0, **mutant.options}  # fewer than 200 increments
    report = conformance(mutant.law, mutant.routine(), mutant.values, **options)
    assert report.failures[0].check.name in mutant.roots
    if "repeatability" not in mutant.roots:
        assert unrounded(report.failures[0].case) <= 3
