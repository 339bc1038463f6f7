"""Quadratic forms with parameters in up to six forces, and quotients by products of loads: what is proved, and mutants that stay open."""

from __future__ import annotations

import numpy as np
import pytest

from duhem import Criterion
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection

FROM_1, HALF = Domain.between(1), Domain.between("-1/2", "1/2")
CHAIN = "a**2 + b**2 + c**2 + d**2 + e**2 + f**2 + 2*m*(a*b + b*c + c*d + d*e + e*f) - 1"
ALL = "a**2 + b**2 + c**2 + d**2 + 2*m*(a*b + a*c + a*d + b*c + b*d + c*d) - 1"  # eigenvalues 1 - m and 1 + 3 m
STAR = "sqrt(x*a**2 + b**2 + c**2 + d**2 + e**2 + 2*m*a*(b + c + d + e)) - 1"  # x > 4 m^2
BEAMS = "x*a**2 + y*b**2 + x*c**2 + y*d**2 + 2*m*(a*b + b*c + c*d) - 1"
LADE = "max((a + b + c)**3/(a*b*c) - k, -a, -b, -c)"  # Lade, Duncan (1975)
FORMS = [
    (CHAIN, {"m": HALF}, True),
    (CHAIN, {"m": Domain.between("-3/5", "1/2")}, False),
    (ALL, {"m": Domain.between("-3/10", "9/10")}, True),
    (ALL, {"m": Domain.between("-2/5", "9/10")}, False),
    (ALL, {"m": Domain.between(0, "11/10")}, False),
    (STAR, {"m": HALF, "x": Domain.between("11/10")}, True),
    (STAR, {"m": HALF, "x": Domain.between("9/10")}, False),
    (BEAMS, {"m": Domain.between("-2/5", "2/5"), "x": FROM_1, "y": FROM_1}, True),
    (BEAMS, {"m": Domain.between("-3/4", "3/4"), "x": FROM_1, "y": FROM_1}, False),
    (LADE, {"k": POSITIVE}, True),
    (LADE.replace(", -c)", ")"), {"k": POSITIVE}, False),
    (LADE.replace("**3", "**2"), {"k": POSITIVE}, False),
    (LADE.replace("- k", "- k*a"), {"k": POSITIVE}, False),
    (LADE.replace("(a*b*c)", "(a*b*c)**2"), {"k": POSITIVE}, False),
    (LADE.replace("(a + b + c)**3/(a*b*c) - k", "k - (a + b + c)**3/(a*b*c)"), {"k": POSITIVE}, False),
    ("max((a - b)**4/(a**2*b**2) - k, -a, -b)", {"k": POSITIVE}, True),
    ("max((a - b)**4/(a**2*b**3) - k, -a, -b)", {"k": POSITIVE}, False),
    ("max((a - b)**2/(a*b) - k, -a)", {"k": POSITIVE}, False),
]  # fmt: skip


@pytest.mark.parametrize(("g", "parameters", "proved"), FORMS)
def test_forms_and_quotients_are_convex_by_composition_or_left_open(g: str, parameters: dict[str, Domain], proved: bool) -> None:
    forces = tuple(x for x in "abcdef" if f"{x}" in g.replace("max", "").replace("sqrt", ""))
    law = Criterion("law", g, parameters, forces, None)
    assert (not objection("convexity", "composition", frozenset(), stated(law_as_text(law)), {})) is proved


def test_the_cases_are_as_their_eigenvalues_say() -> None:
    def least(n: int, *entries: tuple[int, int, float]) -> float:
        matrix = np.eye(n)
        for i, j, value in entries:
            matrix[i, j] = matrix[j, i] = value
        return float(np.linalg.eigvalsh(matrix)[0])

    assert least(6, *((i, i + 1, 0.5) for i in range(5))) > 0 > least(6, *((i, i + 1, -0.6) for i in range(5)))
    pairs = [(i, j) for i in range(4) for j in range(i)]
    assert least(4, *((*p, -0.3) for p in pairs)) > 0 > max(least(4, *((*p, m) for p in pairs)) for m in (-0.4, 1.1))
    assert least(5, (0, 0, 1.1), *((0, i, 0.5) for i in range(1, 5))) > 0 > least(5, (0, 0, 0.9), *((0, i, 0.5) for i in range(1, 5)))
    assert least(4, *((i, i + 1, 0.4) for i in range(3))) > 0 > least(4, *((i, i + 1, 0.75) for i in range(3)))
