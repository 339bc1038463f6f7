"""One row of one path on plain numbers, and by arrays: the same to the last bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Path
from duhem.path import integrators
from duhem.path.rows import Ledger, Stepped

FLAGSHIP = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
ELLIPSE = {"mu_a": 0.2, "mu_b": 0.15}
CASES: dict[str, tuple[str, int, Any, dict[str, float]]] = {
    "quarters": ("antoni2007", 2, [1.0, 2.0], FLAGSHIP),
    "coupled": ("antoni2007", 2, [[1.0, 0.3], [0.3, 2.0]], FLAGSHIP),
    "shifted": ("shifted-ellipse", 2, 1.0, ELLIPSE | {"shift": 0.1}),
    "disk": ("coulomb", 2, 1.0, {"mu": 0.3}),
    "interval": ("antoni2007-1d", 1, 2.0, {"mu_plus": 0.3, "mu_minus": 0.2}),
    "judged": ("superellipse", 2, [1.0, 2.0], ELLIPSE | {"p": 3}),
    "corners": ("box", 2, [1.0, 2.0], ELLIPSE),
}


def tables(case: str, method: str, substeps: int) -> Any:
    """Of a path whose pressure changes and that sticks in parts of it."""
    law, d, stiffness, parameters = CASES[case]
    draw = np.random.default_rng(7)
    points = np.cumsum(draw.normal(size=(9, d)) * 0.2, axis=0)
    points[3:5] = points[2] + 1e-3 * draw.normal(size=(2, d))
    path = Path.linear(points, pressure=-draw.uniform(0.5, 2.0, 9))
    return duhem.simulate(law, path, stiffness=stiffness, parameters=parameters, method=method, substeps=substeps).to_array()


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated"])
@pytest.mark.parametrize("case", CASES)
def test_plain_numbers_take_the_steps_of_arrays(case: str, method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rows, booked = list[bool](), Ledger.row

    def row(ledger: Ledger, made: Stepped) -> None:
        rows.append(bool(made.slips))
        booked(ledger, made)

    monkeypatch.setattr(Ledger, "row", row)
    plain = tables(case, method, 3)
    assert any(rows)
    assert not all(rows)
    seen = len(rows)
    monkeypatch.setattr(integrators, "closest_point", lambda *_: None)
    np.testing.assert_array_equal(plain, tables(case, method, 3))
    assert len(rows) == seen


def test_where_plain_numbers_have_no_answer_arrays_are_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tables("quarters", "extrapolated", 2)
    asked = []

    def silent(quarters: object, trial: list[float], load: float) -> None:
        asked.append(load)

    monkeypatch.setattr("duhem.path.closest.quadrants.plain_closest", silent)
    np.testing.assert_array_equal(whole, tables("quarters", "extrapolated", 2))
    assert asked
