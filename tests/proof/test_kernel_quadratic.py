"""Quadratic formulas in the kernel: what their matrix shows is so, and nothing beyond the edge of it."""

from __future__ import annotations

from itertools import combinations
from random import Random
from typing import Any

import numpy as np
import pytest

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw
from tests.proof.test_kernel_facts import said

PARAMETERS: dict[str, Any] = {
    "m": {"positive": True}, "p": {"positive": True}, "e": {"min": "0"}, "q": {"min": "-1", "max": "1"}, "u": {},
}  # fmt: skip


def law(g: str, *constraints: str, flow: tuple[str, ...] | None = None) -> StatedLaw:
    given = {"forces": ("a", "b", "c", "d"), "pressure": None, "parameters": PARAMETERS, "constraints": constraints, "g": g}
    return StatedLaw.read({**given, "flow": flow})


def shown(g: str, *constraints: str) -> str:
    stated = law(g, *constraints)
    return said(over(stated).facts(stated.g))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a**2 - a*b + b**2", ">= convex"),
        ("a**2 - 2*a*b + b**2", ">= convex"),
        ("a**2 - 2.001*a*b + b**2", "?"),
        ("a**2 - 2*q*a*b + b**2", ">= convex"),
        ("a**2 - 2.001*q*a*b + b**2", "?"),
        ("a**2 - 2*u*a*b + b**2", "?"),
        ("(a - b)**2/m - a**2/(2*m)", "?"),
        ("2*(a - b)**2/m - a*b/m", "?"),
        ("2*(a - b)**2/m + a*b/m", ">= convex"),
        ("a**2 - a*b + b**2 + 1", "> convex"),
        ("a**2 - a*b + b**2 - 1", "? convex"),
        ("a**2 - a*b + b**2 + a", "? convex"),
        ("a**2 - a*b + b**2 + a + 1/3", ">= convex"),  # least at a = -2/3, b = -1/3
        ("a**2 - a*b + b**2 + a + 1/3 - 1/10**9", "? convex"),
        ("a**2 - a*b + b**2 + abs(c)", ">= convex"),
        ("a**2 - a*b + b**2 - abs(c)", "?"),
        ("a**2 - a*b + b**2 + c*d", "?"),
        ("a**2 - a*b + b**2 + c**2 - 2*c*d + d**2", ">= convex"),  # two blocks
        ("a**2 + b**2 + c**2 - a*b - b*c - c*a", ">= convex"),
        ("a**2 + b**2 + c**2 - 1.001*(a*b + b*c + c*a)", "?"),
        ("a**2 - a*b + b**2 + a**3", "?"),
        ("a**2 - a*b + b**2 + (0/e)*a", "? undefined"),
        ("e*a**2 - e*a*b + e*b**2", ">= convex"),
        ("u*a**2 - u*a*b + u*b**2", "?"),
        ("m*a**2 - 2*a*b + b**2/m", ">= convex"),
        ("m*a**2 - 2*a*b + p*b**2", "?"),
        ("a**2 - 2*m/(1 + m)*a*b + b**2", ">= convex"),  # denominators are multiplied through
        ("a**2 - 2*(2 + m)/(1 + m)*a*b + b**2", "?"),
        ("m*a**2 - 2*q*sqrt(m*p)*a*b + p*b**2", ">= convex"),  # and roots undone
        ("m*a**2 - 2*1.001*sqrt(m*p)*a*b + p*b**2", "?"),
    ],
)
def test_what_a_matrix_shows(text: str, words: str) -> None:
    assert shown(text) == words


def test_constraints_count() -> None:
    assert shown("m*a**2 - 2*a*b + p*b**2", "m*p > 1") == ">= convex"
    assert shown("m*a**2 - 2*a*b + p*b**2", "m*p > 0.999") == "?"
    assert shown("p*a**2 - (u + q)*a*b + m*b**2", "4*m*p > (u + q)**2") == ">= convex"
    assert shown("p*a**2 - (u + q)*a*b + m*b**2", "4.001*m*p > (u + q)**2") == "?"


@pytest.mark.slow
def test_numbers_are_told_exactly() -> None:
    """Random matrices of small numbers, many of them singular: convex exactly where no eigenvalue is < 0."""
    rng, found, n = Random(3), {True: 0, False: 0}, range(3)
    for _ in range(60):
        matrix = [[0] * 3 for _ in n]
        for i, j in [*combinations(n, 2), *((i, i) for i in n)]:
            matrix[i][j] = matrix[j][i] = rng.randint(0, 3) if i == j else rng.randint(-2, 2)
        text = " + ".join(f"({matrix[i][j]})*{'abc'[i]}*{'abc'[j]}" for i in n for j in n)
        convex = bool(np.linalg.eigvalsh(np.array(matrix)).min() > -1e-9)  # of whole numbers: it is 0 or well away from that
        assert shown(text).endswith("convex") is convex, text
        found[convex] += 1
    assert min(found.values()) >= 10


def test_a_power_that_is_a_quadratic_form() -> None:
    """Of a flow that is no multiple of the normal, and may have any size."""
    for factor, right in (("1", True), ("1.999", True), ("2", True), ("2.001", False)):
        stated = law("norm(a, b, c, d) - m", flow=(f"a - {factor}*b", "b", "c", "d"))
        assert bool(objection("dissipation", "boundary-power", frozenset(), stated, {})) is not right, factor
