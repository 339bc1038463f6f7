"""Increments, tangents and loading paths on every law of the atlas that has them, and why the others have none.

Each law is put to the conformance suite with duhem's own routine and its tangent, at the simplest admitted parameters, and
driven once around in the space of its forces.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import find, settings

import duhem
from duhem.errors import InputError
from duhem.law.atlas.entry import groups
from duhem.law.formula_law import Criterion
from duhem.path import Path, simulate
from duhem.testing import conformance, parameters, projection
from tests.long import mostly_long

NAMES = [name for names in groups().values() for name in names]
QUICK = ("howe-cutkosky", "modified-cam-clay", "orowan", "yamada-sun")

# laws without an increment by the closest point, and what duhem says of them
OWN_FLOW = "has a flow of its own"
WITHOUT: dict[str, str] = {
    **dict.fromkeys(("de-saxce-feng", "hjiaj", "michalowski-mroz", "plesha", "zmitrowicz", "zmitrowicz-indefinite"), OWN_FLOW),
    **dict.fromkeys(("armstrong-frederick", "drucker-prager-dilatancy", "mohr-coulomb-dilatancy", "stoughton"), OWN_FLOW),
}


def fixed(name: str) -> Criterion:
    """The law at the simplest admitted values of its parameters."""
    law = duhem.load(name)
    values = find(parameters(law), lambda _: True, settings=settings(database=None, deadline=None))
    return law.fix(values)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([name for name in NAMES if name not in WITHOUT], *QUICK))
def test_the_increments_of_a_law_conform(name: str) -> None:
    law = fixed(name)
    stiffness = np.eye(len(law.forces))
    report = conformance(law, projection(law, tangent=True), max_examples=2, rows=8, stiffness=stiffness, seconds=2)
    assert report.ok, str(report)
    assert report.flagged <= report.points // 50
    assert "tangent" in report.passed


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([name for name in NAMES if name not in WITHOUT], *QUICK))
def test_a_law_is_driven_along_a_path(name: str) -> None:
    law = fixed(name)
    d = len(law.forces)
    knots = np.vstack([np.zeros(d), 3 * np.eye(d), -3 * np.eye(d)])
    history = simulate(law, Path.linear(knots, pressure=-1.0 if law.pressure else None), stiffness=1.0)
    assert np.isfinite(history.stress).all()
    assert (np.diff(history.dissipation) >= -1e-9).all()
    assert np.abs(history.balance).max() < 1e-9 * (1 + history.work.max())


@pytest.mark.parametrize("name", WITHOUT)
def test_what_has_no_increment_says_why(name: str) -> None:
    law = fixed(name)
    with pytest.raises(InputError, match=WITHOUT[name]):
        duhem.project(law, np.ones(len(law.forces)), -1.0 if law.pressure else None)
