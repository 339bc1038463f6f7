"""A prepared law answers as the call does, alone and in a batch, in other processes and in threads."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import InputError, Status
from duhem.law.formula_law import Criterion
from tests.long import mostly_long

FLAGSHIP = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
ASKED: list[tuple[str, Any, dict[str, float]]] = [
    ("antoni2007", [1.0, 2.0], FLAGSHIP),
    ("antoni2007", [[2.0, 0.5], [0.5, 1.0]], FLAGSHIP),
    ("coulomb", 3e11, {"mu": 0.5}),
    ("shifted-ellipse", [1.0, 2.0], {"mu_a": 0.3, "mu_b": 0.1, "shift": 0.125}),
    ("superellipse", 1.0, {"mu_a": 0.3, "mu_b": 0.1, "p": 4.0}),
    ("box", [1.0, 2.0], {"mu_a": 0.3, "mu_b": 0.1}),
    ("tresca", 1.0, {"yield_stress": 0.7}),
]


def drawn(law: str, n: int) -> tuple[Any, Any]:
    chance, known = np.random.default_rng(5), duhem.load(law)
    trial = chance.standard_normal((n, len(known.forces))) * 10.0 ** chance.uniform(-1.5, 1.5, (n, 1))
    return trial, (None if known.pressure is None else -chance.uniform(0.1, 3.0, n))


@pytest.mark.parametrize(("law", "stiffness", "parameters"), mostly_long(ASKED, *ASKED[:4]))
def test_it_answers_as_the_call_does(law: str, stiffness: Any, parameters: dict[str, float]) -> None:
    trial, pressure = drawn(law, 24)
    prepared = duhem.prepare(law, stiffness, parameters)
    asked = duhem.project(law, trial, pressure, stiffness, parameters)
    found = prepared(trial, pressure)
    for given, expected in zip(found, (asked.stress, asked.slip, asked.multiplier, asked.status), strict=True):
        np.testing.assert_array_equal(given, expected)
    assert {*asked.status.tolist()} == {Status.STICK, Status.SLIP}
    copy = pickle.loads(pickle.dumps(prepared))
    for i, one in enumerate(trial):
        stress, slip, multiplier, status = copy(one, None if pressure is None else pressure[i])
        assert (stress.tolist(), slip.tolist()) == (asked.stress[i].tolist(), asked.slip[i].tolist())
        assert (multiplier, status) == (asked.multiplier[i], asked.status[i]) and isinstance(multiplier, float)


@pytest.mark.long
def test_threads_may_share_it() -> None:
    trial, pressure = drawn("antoni2007", 200)
    prepared = duhem.prepare("antoni2007", [1.0, 2.0], FLAGSHIP)
    with ThreadPoolExecutor(4) as pool:
        found = [*pool.map(prepared, trial, pressure)]
    np.testing.assert_array_equal([one.stress for one in found], prepared(trial, pressure).stress)


def test_what_cannot_be_used_is_said_where_it_is_given() -> None:
    with pytest.raises(InputError, match="no value is given for mu"):
        duhem.prepare("coulomb")
    with pytest.raises(InputError, match="not positive"):
        duhem.prepare("coulomb", -1.0, {"mu": 0.5})
    prepared = duhem.prepare("coulomb", 1.0, {"mu": 0.5})
    with pytest.raises(InputError, match=r"trial\[1\] is nan"):
        prepared([1.0, np.nan], -1.0)
    with pytest.raises(InputError, match=r"pressure is 1\.0 > 0"):
        prepared([1.0, 0.0], 1.0)


@pytest.mark.slow
def test_whether_k_is_convex_is_asked_before() -> None:
    bean = Criterion("bean", "(norm(sigma_a, sigma_b)**2 - sigma_a)**2 - norm(sigma_a, sigma_b)**2", pressure=None)
    with pytest.raises(InputError, match="convex"):
        duhem.prepare(bean, convex="require")
    assert duhem.prepare(bean)([5.0, 1.0]).status == Status.STATIONARY
    assert duhem.prepare(bean, convex="assume")([5.0, 1.0]).status == Status.SLIP
