"""Every check of duhem.testing on duhem's own increments: every admissible law, every method that applies, parameters over their domain.

`python -m pytest tests/testing/test_properties.py --hypothesis-profile deep` draws a hundred times as much and takes an hour.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import settings

import duhem
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.increment import increment
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.proof.verdict import Verdict
from duhem.testing import Report, check, checks_for, conformance, pressures, projection
from tests.long import long_but, mostly_long
from tests.oracles.literature import KNOWN, THRESHOLDS

EPS = float(np.finfo(np.float64).eps)
# A method that is not named in these has the loosest row until it promises more.
LOOSEST = "cvxpy"
# What each method promises, relative; the rounding that ill-conditioned data cause comes on top (duhem.testing.checks.query).
ACCURACY = {
    "closed-form": 16 * EPS,
    "newton": 1e-11,  # the normal is met within 1e-12, or 1e-10 of |s - u| where rounding turns it
    "cvxpy": 1e-6,  # an interior point's square root of the gap; project flags residuals above 1e-7
}
MOST_FLAGGED = {"closed-form": 0.002, "newton": 0.01, "cvxpy": 0.1}  # of a few dozen points only
# Where c is far larger than mu |sigma_n|, rounding hides the boundary of the one; the sextic cone of the other costs the solver
# digits, and residuals of 2e-7 are common.  Measured over thousands of points: 1.0 % and 14 %.
FLAGGED_MORE = {("regularised", "newton"): 0.02, ("drucker1949", "cvxpy"): 0.2}
EXAMPLES = {"closed-form": 3, "newton": 2, "cvxpy": 2}
ROWS = {"closed-form": 60, "newton": 60, "cvxpy": 8}
EVERY = {
    "closed-form": 7,
    "newton": 7,
    "cvxpy": 2,
}  # of these, one is asked what the checks ask again: a solver that flags some leaves others
DEEP = 100 if settings.default.max_examples > 1000 else 1  # the profile `deep`

# The check that a tangent is the slope needs a finite curvature, which a superellipse has from p = 2 on.
EXPONENTS = {"superellipse": {"p": "4"}, "hosford": {"m": "8"}}
ALWAYS: list[tuple[str, dict[str, str]]] = [
    (name, EXPONENTS.get(name, {})) for name, known in KNOWN.items() if Verdict.REFUTED not in (known["convexity"], known.get("normality"))
]
AT_VALUES = [
    (name, values)
    for name, values, claim, verdict in THRESHOLDS
    if claim == "convexity" and verdict is Verdict.PROVED and KNOWN[name]["convexity"] is Verdict.REFUTED
]
# Their boundaries have flat points, near which the slope changes faster than the differences of this check can tell;
# test_newton_tangents.py compares newton's tangents of these laws with differences at increments of moderate size.
FLAT = {"superellipse", "quartic", "matchstick"}
SMOOTH = [name for name, _ in ALWAYS if KNOWN[name]["smoothness"] is Verdict.PROVED]
CORNERS = [name for name, _ in ALWAYS if KNOWN[name]["smoothness"] is Verdict.REFUTED]

CASES = [(*law, method) for law in [*ALWAYS, *AT_VALUES] for method in METHODS]
# Of few laws each run asks a dear method; a method of ones own is asked of all.
SOME = {
    "closed-form": ("antoni2007", "capped", "coulomb", "orthotropic", "shifted-ellipse"),
    "newton": ("cohesive",),
    "cvxpy": ("von-mises",),
}
EVERY_RUN = [(name, values, method) for name, values, method in CASES if name in SOME.get(method, (name,))]
TANGENT = [name for name, imported in METHODS.items() if imported().tangent is not None]


def shown(value: object) -> str | None:
    if isinstance(value, str):
        return value
    return ",".join(f"{k}={v}" for k, v in value.items()) if isinstance(value, dict) else None


def without_reason(law: Criterion, method: str) -> str | None:
    """Why a method does not apply to a law, in its own words."""
    half = {name: 0.5 for name, domain in law.parameters.items() if domain.value is None}
    if "shift" in half:
        half["shift"] = 0.25
    asked = increment(law, np.ones(len(law.forces)), None if law.pressure is None else -1.0, 1.0, half)
    if reason := METHODS[method]().applies(asked):
        with pytest.raises(InputError, match=r"does not apply|curvature"):
            Projector.of(law, 1.0, half, method).at(asked)
    return reason


def of(promises: Mapping[str, float], method: str) -> float:
    return promises.get(method, promises[LOOSEST])


def put(law: Criterion, method: str, **options: object) -> Report:
    return conformance(
        law, projection(law, method), accuracy=of(ACCURACY, method), rows=int(of(ROWS, method)), every=int(of(EVERY, method)), **options
    )


def accepted(report: Report, method: str) -> None:
    assert report.ok, str(report)
    assert report.points > 0
    most = FLAGGED_MORE.get((report.law, method), of(MOST_FLAGGED, method))
    assert report.flagged_share <= most, f"{report.flagged} of {report.points} flagged"


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values", "method"), mostly_long(CASES, *EVERY_RUN), ids=shown)
def test_increments_have_every_property(name: str, values: dict[str, str], method: str) -> None:
    law = duhem.load(name).fix(values)
    if (reason := without_reason(law, method)) is not None:
        pytest.skip(reason)
    asked = checks_for(law)
    examples = (int(of(EXAMPLES, method)) if not values else 1) * DEEP
    report = put(law, method, checks=asked, max_examples=examples)
    accepted(report, method)
    left_out = {"tangent", "slope"} | ({"homogeneity"} if "homogeneity" in report.left_out else set())
    assert set(report.passed) == {c.name for c in asked} - left_out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "method"),
    mostly_long([case for case in CASES if case[2] in TANGENT], *(case for case in EVERY_RUN if case[2] in TANGENT)),
    ids=shown,
)
def test_tangents_are_symmetric_between_0_and_k_and_the_slope(name: str, values: dict[str, str], method: str) -> None:
    law = duhem.load(name).fix(values)
    if (reason := without_reason(law, method)) is not None:
        pytest.skip(reason)
    pressed = pressures().filter(bool) if law.pressure else None  # no slope at the tip of a cone
    update = projection(law, method, tangent=True)
    checks = ["tangent"] if name in FLAT else ["tangent", "slope"]
    report = conformance(
        law,
        update,
        checks=checks,
        pressure=pressed,
        accuracy=of(ACCURACY, method),
        rows=40,
        every=3,
        max_examples=(2 if not values else 1) * DEEP,
    )
    accepted(report, method)
    assert report.passed == tuple(checks)


def cone(trial: np.ndarray, *_: object, **__: object) -> np.ndarray:
    return trial  # the checks of the law never ask


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([2, 6, 10], SMOOTH))
def test_one_normal_at_every_seam(name: str) -> None:
    report = conformance(name, cone, checks=[check("smoothness")], rows=3, max_examples=10 * DEEP)
    assert report.ok, str(report)
    assert report.passed == ("smoothness",) or len(duhem.load(name).forces) == 1


@pytest.mark.long
@pytest.mark.parametrize("name", mostly_long(CORNERS, "box"))
def test_two_normals_at_a_corner(name: str) -> None:
    report = conformance(name, cone, checks=[check("smoothness")], rows=10, max_examples=30, tries=5)  # that it fails is asked, not where
    assert report.failed == {"smoothness"}
