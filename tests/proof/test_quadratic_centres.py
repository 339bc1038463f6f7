"""Smoothness of K where g is quadratic: what the kernel proves by the value at the centre is what SymPy solves."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest
import sympy as sp

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten

PARAMETERS = {"m": {"positive": True}, "k": {"min": "0"}}


def is_proved(g: str, forces: str = "xy", constraints: list[str] | None = None) -> bool:
    own: dict[str, Any] = {"name": "law", "forces": [*forces], "pressure": None, "parameters": PARAMETERS, "flow": None, "domain": {}}
    law = StatedLaw.read({**own, "g": g, "constraints": constraints or []})
    try:
        return not objection("smoothness", "centre", frozenset(), law, {})
    except NotWritten:
        return False


@pytest.mark.parametrize(
    ("g", "constraints", "proved"),
    [
        ("x**2 - y**2 - m", [], True),
        ("x**2 - y**2 - k", [], False),
        ("y**2 - (m - (k + 1)*x)**2 + m**2", [], True),
        ("y**2 - (m - k*x)**2 + m**2", [], False),  # for k = 0 there is no centre
        ("y**2 - (m - tan(1)*x)**2 + (m - k)**2", ["k < m"], True),
        ("y**2 - (m - tan(1)*x)**2 + (m - k)**2", [], False),
        ("y**2 - (m - (k + 1)*x)**2", [], False),  # two lines that cross
        ("x**2 + y**3 - m", [], False),
        ("abs(x)*y - m", [], False),
    ],
)
def test_a_hyperbola_is_smooth_unless_it_is_two_lines(g: str, constraints: list[str], proved: bool) -> None:
    assert is_proved(g, constraints=constraints) is proved


def test_drawn_quadratics_are_smooth_where_no_place_has_neither_value_nor_slope() -> None:
    found = {True: 0, False: 0}
    for seed in range(120):
        rng = Random(seed)
        forces = "xyz"[: rng.choice((2, 3))]
        symbols = sp.symbols([*forces])
        matrix = sp.Matrix([[rng.randint(-1, 1) for _ in forces] for _ in forces])
        ways = sp.Matrix([rng.randint(-2, 2) for _ in forces])
        at = dict(zip(symbols, ways, strict=True))
        g = sum(c * x * y for (i, x) in enumerate(symbols) for (j, y) in enumerate(symbols) for c in [matrix[i, j]])
        g = sp.expand(g.subs({x: x - at[x] for x in symbols}, simultaneous=True) + rng.choice((0, 0, 1, -2)))
        if not set(symbols) <= g.free_symbols:
            continue
        singular = sp.solve([g, *(sp.diff(g, x) for x in symbols)], symbols, dict=True)
        regular = sp.hessian(g, symbols).det() != 0
        proved = is_proved(str(g), forces)
        assert proved is (regular and not singular), g
        found[proved] += 1
    assert min(found.values()) >= 20
