"""Who says nothing gets compiled loops from a number of points on, where numba is; the answer says so, and the log that it waits."""

from __future__ import annotations

import importlib.util
import logging
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.projection import code_cache, method
from duhem.projection.closed_form import ClosedFormOptions
from duhem.projection.newton import NewtonOptions

PARAMETERS = {"mu_a": 0.3, "mu_b": 0.2}


@pytest.mark.parametrize("options", [ClosedFormOptions, NewtonOptions])
def test_the_number_of_points_decides_and_numba(options: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    most = method.WORTH_COMPILING
    for installed in (True, False):
        monkeypatch.setattr(method, "find_spec", lambda _, there=installed: object() if there else None)
        assert options().decided(most).compiled is installed
        assert options().decided(most - 1).compiled is False
        assert options(compiled=True).decided(1).compiled is True and options(compiled=False).decided(most).compiled is False


def test_the_answer_says_whether_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    if importlib.util.find_spec("numba") is None:
        pytest.skip("numba is not installed")
    monkeypatch.setattr(method, "WORTH_COMPILING", 50)
    trial = np.random.default_rng(1).standard_normal((60, 2))
    many, few = (duhem.project("orthotropic", trial[:n], -1.0, parameters=PARAMETERS) for n in (60, 49))
    assert many.compiled and not few.compiled
    assert many.to_dict()["compiled"] and "compiled" in str(many.to_text()) and "compiled" not in str(few.to_text())
    np.testing.assert_allclose(many.stress[:49], few.stress, rtol=1e-14, atol=1e-15)


def test_that_it_compiles_is_logged_and_that_it_loads_is_not(monkeypatch: Any, tmp_path: Any, caplog: pytest.LogCaptureFixture) -> None:
    pytest.importorskip("numba")
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    text = "def judge(x):\n    return x / 2\n"
    with caplog.at_level(logging.WARNING, "duhem"):
        for expected in (1, 1, 1):
            run = code_cache.compiled_text.__wrapped__(text, "judge")
            assert run(3.0) == run(3.0) == 1.5
            assert len(caplog.records) == expected
    assert "to compile the check of answers" in caplog.text
