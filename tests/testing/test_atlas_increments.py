"""Increments, tangents and loading paths on every law of the atlas that has them, and why the others have none.

Each law is put to the conformance suite with duhem's own routine and its tangent, at the simplest admitted parameters, and
driven once around in the space of its forces.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.law.atlas.entry import entries, file_of
from duhem.law.formula_law import Criterion
from duhem.path import Path, simulate
from duhem.testing import checks_for, conformance, projection
from tests.campaigns.increments import at_simplest
from tests.long import mostly_long

ENTRIES = {each.name: each for each in entries()}


def text_of(name: str) -> str:
    """The criterion file of a law; reading it as text is much cheaper than loading the law."""
    file = file_of(name)
    assert file is not None
    return file.read_text("utf-8")


# The closest point integrates the normality rule alone.
OWN_FLOW = [name for name in ENTRIES if re.search(r"^\[flow\]|^potential", text_of(name), flags=re.M)]

# What the suite asks is true of convex K.
NOT_CONVEX = [name for name, said in ENTRIES.items() if said.verdicts["convexity"] == "refuted" and name not in OWN_FLOW]

# A state moves with the stress.
STATES = [name for name in ENTRIES if "[energy]" in text_of(name)]

# It has no K.
OF_RATES = [name for name in ENTRIES if "forces_of_rates" in text_of(name)]

DRIVEN = [name for name in ENTRIES if name not in (*OWN_FLOW, *NOT_CONVEX, *STATES, *OF_RATES)]

# p log p has no value at p = 0, and none beyond: no stress is no stress of the law, and a path starts under pressure.
NO_ORIGIN = ("original-cam-clay",)
# Pushed along an axis, the edge of the normals at its tip, the answer is some 1e-9 beside the tip, and flagged: the run ends.
ON_EDGE = ("teardrop",)
QUICK = ("howe-cutkosky", "yamada-sun")
# The coefficients are 0 at their simplest, and then every stress is one of K: here they are those of an isotropic metal.
ISOTROPIC = {"yld91": "abc", "yld2000-2d": [f"a{i}" for i in range(1, 9)]}
# Zero stress is on the boundary, and few trials lie inside: of two cases none.
AT_END = ("modified-cam-clay", "original-cam-clay")
# Far out on the hydrostatic axis rounding hides K, and with it whether it has an inside: the tangent of a trial that sticks is unknown.
ENDLESS = ("yld2004-18p-tensor",)


def law_of(name: str) -> Criterion:
    """The law at simple parameters, with which some stresses are in K and others are not."""
    if name not in ISOTROPIC:
        return at_simplest(name)
    law = duhem.load(name).fix(dict.fromkeys(ISOTROPIC[name], 1))
    return law.fix({x: 2 if x in ("a", "m") else 1 for x, domain in law.parameters.items() if domain.value is None})


def test_most_laws_are_driven() -> None:
    assert len(DRIVEN) >= 80
    assert {*NO_ORIGIN, *QUICK} <= {*DRIVEN}


def left_out(name: str) -> set[str]:
    """Checks that a law is not put to: an apex has more normals than there are pieces, and the closest point no tangent there."""
    smooth = ENTRIES[name].verdicts["smoothness"] == "proved"
    some = {"origin": name in NO_ORIGIN, "tangent": not smooth or name in ENDLESS, "slope": not smooth}
    return {check for check, left in some.items() if left}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(DRIVEN, *QUICK))
def test_the_increments_of_a_law_conform(name: str) -> None:
    law = law_of(name)
    checks = [check for check in checks_for(law) if check.name not in left_out(name)]
    pressure = -1.0 if law.pressure else None  # at zero pressure K is a point and has no tangent
    size = np.eye(len(law.forces))
    cases = 10 if name in AT_END else 2
    report = conformance(law, projection(law, tangent=True), max_examples=cases, rows=8, stiffness=size, pressure=pressure, checks=checks)
    assert report.ok, str(report)
    assert report.flagged < report.points / 2  # beyond an apex a closest point may be flagged


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([name for name in DRIVEN if name not in ON_EDGE], *QUICK))
def test_a_law_is_driven_along_a_path(name: str) -> None:
    law = law_of(name)
    d = len(law.forces)
    knots = np.vstack([np.zeros(d), np.eye(d), -np.eye(d)])
    start = np.full(d, -0.2) if name in NO_ORIGIN else None
    history = simulate(law, Path.linear(knots, pressure=-1.0 if law.pressure else None), stiffness=1.0, stress=start)
    assert np.isfinite(history.stress).all()
    assert (np.diff(history.dissipation) >= -1e-9).all()
    assert np.abs(history.balance).max() < 1e-9 * (1 + history.work.max())


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(OWN_FLOW, *OWN_FLOW[::4]))
def test_a_law_with_a_flow_of_its_own_has_no_closest_point(name: str) -> None:
    law = at_simplest(name)
    with pytest.raises(InputError, match=r"has its own flow direction|are the gradient of a potential|has rates without a multiplier"):
        duhem.project(law, np.ones(len(law.forces)), -1.0 if law.pressure else None)
