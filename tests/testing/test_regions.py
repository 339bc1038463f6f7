"""Two mistakes in two regions of stress: where a check fails is counted, and the second mistake is named too."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis.strategies import sampled_from

import duhem
from duhem.law.formula_law import Criterion
from duhem.testing import Case, conformance
from duhem.testing.checks.query import Query
from duhem.testing.drawn.case import Region
from duhem.testing.failures.diagnosis import region_of
from tests.long import mostly_long

Array = np.ndarray
ELLIPSE = {"mu_a": 0.5, "mu_b": 0.1}
MISES = Criterion("mises", "sqrt(3*J2(sigma)) - 1", pressure=None, stress={"name": "sigma", "kind": "3d"})
K = np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])


def scaled(trial: Array, tension: float, compression: float) -> Array:
    """The radial return of MISES, which K makes the closest point, times a factor where there is slip."""
    mean = trial[:, :3].mean(axis=1, keepdims=True) * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    apart = trial - mean
    size = np.sqrt(1.5 * (apart**2 * [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]).sum(axis=1))[:, None]
    factor = np.where(trial[:, :3].sum(axis=1, keepdims=True) > 0.0, tension, compression)
    with np.errstate(all="ignore"):
        return np.where(size > 1.0, factor * (mean + apart / size), trial)


def by_sign(trial: Array, pressure: object, stiffness: Array) -> Array:
    """In tension too large, in compression too small."""
    return scaled(trial, 1.1, 0.8)


def at_the_tip(trial: Array, pressure: Array, stiffness: Array) -> Array:
    """The identity for the stiffness; at no pressure the trial stress is kept."""
    return np.where(pressure[:, None] == 0.0, trial, duhem.project("orthotropic", trial, pressure, 1.0, ELLIPSE).stress)


TWO: dict[str, tuple[object, Callable[..., Array], dict[str, object], str, str, str]] = {
    "tension": (MISES, by_sign, {"stiffness": K}, "1.1 times the closest point", "0.8 times the closest point", "in tension"),
    "tip": (
        "orthotropic",
        at_the_tip,
        {"parameters": ELLIPSE, "pressure": sampled_from([-1.0, 0.0])},
        "without a correction",
        "the identity instead of the stiffness",
        "at the tip",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("where", mostly_long(TWO, "tip"))
def test_two_mistakes_in_two_regions_are_both_named(where: str) -> None:
    law, update, given, one, other, region = TWO[where]
    report = conformance(law, update, max_examples=6, rows=20, tries=10, seed=1, **given)  # type: ignore[arg-type]
    told = str(report)
    assert one in told and other in told and f" {region}" in " ".join(f.where for f in report.failures), told


@pytest.mark.long
def test_one_mistake_has_one_cause_and_is_counted_where_it_is() -> None:
    def squeezed(trial: Array, pressure: object, stiffness: Array) -> Array:
        return scaled(trial, 1.0, 0.9)

    report = conformance(MISES, squeezed, stiffness=K, max_examples=3, rows=20, tries=10, seed=1)
    assert len(report.failures) == 1 and re.search(r"(^|, )0 of \d+ in tension", report.failures[0].where), str(report)


def test_regions_are_told_by_trial_and_answer() -> None:
    trial = np.array(
        [[1, 1, -3, 0, 0, 0], [1, 2, 4, 0, 0, 0], [-1, -2, -4, 0, 0, 0], [0, 0, 0, 0, 0, 0], [-1, -2, -3, 1, 0, 0]], dtype=float
    )
    zero, n = np.zeros_like(trial), len(trial)
    case = Case({}, K, None, trial, zero, zero, zero, zero, np.ones(n), 2.0, np.zeros((n, 1, 6)), None)  # type: ignore[arg-type]

    def pressed(trial: Array, *_: object) -> Array:
        return np.where(trial[:, 3:4] == 1.0, [-2.0, -2.0, -2.0, 0.0, 0.0, 0.0], trial)

    query = Query(Region(MISES, {}), case, pressed, (), 1e-9)
    assert region_of(query, query.here).tolist() == ["at repeated principal stresses", "in tension", "elsewhere", "near zero", "at the tip"]


def test_no_answer_is_at_no_tip_and_three_forces_are_no_tensor() -> None:
    trial = np.array([[1, 2, 4, 0, 0, 0], [-1, -2, -4, 0, 0, 0], [-1, -2, -4, 1, 0, 0]], dtype=float)
    zero, n = np.zeros_like(trial), len(trial)

    def regions(law: Criterion, d: int) -> list[str]:
        empty, asked = zero[:, :d], np.ascontiguousarray(trial[:, :d])
        case = Case({}, K[:d, :d], None, asked, empty, empty, empty, empty, np.ones(n), 2.0, np.zeros((n, 1, d)), None)
        query = Query(Region(law, {}), case, lambda trial, *_: np.full_like(trial, np.nan), (), 1e-9)
        return region_of(query, query.here).tolist()

    assert regions(MISES, 6) == ["in tension", "elsewhere", "elsewhere"]
    assert (
        regions(Criterion("ball", "sqrt(f_1**2 + f_2**2 + f_3**2) - 1", pressure=None, forces=("f_1", "f_2", "f_3")), 3)
        == ["elsewhere"] * n
    )
