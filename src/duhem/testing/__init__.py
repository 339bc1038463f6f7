"""Tests for a slip-increment routine of your own: Hypothesis strategies for increments, and a conformance suite.

    from duhem.testing import assert_conforms

    def update(trial, pressure, stiffness):  # (N, d), (N,), (d, d) -> (N, d)
        ...

    def test_my_routine():
        assert_conforms("coulomb", update, {"mu": 0.3}, accuracy=1e-10)

or one test a check: ``@pytest.mark.parametrize("check", checks_for("coulomb"))`` and ``assert_conforms(..., checks=[check])``.
"""

from duhem.testing.checks.registry import Check
from duhem.testing.conformance import ACCURACY, RoutineChecks, assert_conforms, check, checks_for, conformance, projection, violation
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.strategies import cases, decades, loadings, parameters, pressures, stiffnesses, trials, ways
from duhem.testing.failures.failure import Failure
from duhem.testing.failures.report import Report
from duhem.testing.routines import Material, MaterialState, Step, Update, from_displacements, from_material, pointwise

__all__ = [
    "ACCURACY", "Case", "Check", "Failure", "Material", "MaterialState", "Report", "RoutineChecks", "Step", "Update", "assert_conforms",
    "cases", "check", "checks_for", "conformance", "decades", "from_displacements", "from_material", "loadings", "parameters", "pointwise",
    "pressures", "projection", "stiffnesses", "trials", "violation", "ways",
]  # fmt: skip
