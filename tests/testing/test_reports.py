"""A report and its failures are values: they don't change, and a copy says the same and shows the same failure again."""

import copy
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from functools import cache

import pytest
from numpy.typing import NDArray

from duhem.testing import Report, conformance, violation


def elastic(trial: NDArray, pressure: NDArray, stiffness: NDArray, **parameters: float) -> NDArray:
    """Wrong wherever there is slip."""
    return trial


def pickled(value: Report) -> Report:
    return pickle.loads(pickle.dumps(value))


@cache
def found() -> Report:
    report = conformance("antoni2007", elastic, {"mu_b_plus": 0.1}, checks=["origin", "feasibility", "slip"], max_examples=5, tries=20)
    assert report.passed == ("origin",) and report.failed == {"feasibility"} and set(report.left_out) == {"slip"}
    return report


@pytest.mark.slow
@pytest.mark.parametrize("copied", [pickled, copy.deepcopy], ids=["pickle", "deepcopy"])
def test_a_copy_says_the_same(copied: Callable[[Report], Report]) -> None:
    report, back = found(), copied(found())
    assert str(back) == str(report) and back.left_out == report.left_out and back.passed == report.passed
    (failure,), (again,) = report.failures, back.failures
    assert again.case is not failure.case and repr(again.case) == repr(failure.case)
    assert again.check == failure.check and again.law == failure.law
    shown = violation(again.check, again.law, elastic, again.case, open_parameters=again.open_parameters, accuracy=again.accuracy)
    assert shown == failure.message != violation("origin", again.law, elastic, again.case)


def test_what_was_found_does_not_change() -> None:
    (failure,) = found().failures
    for value, name in ((found(), "passed"), (failure, "case"), (failure.case, "trial"), (failure.check, "measure")):
        with pytest.raises(FrozenInstanceError):
            setattr(value, name, None)
