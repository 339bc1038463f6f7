"""The numbers beside a witness are written in 17 digits, also those that no double has."""

from __future__ import annotations

from fractions import Fraction

import flint
import pytest

from duhem import Criterion, verify
from duhem.law.domain import Domain
from duhem.proof.witness.points import decimal_pair

HUGE = flint.arb(10) ** 400


@pytest.mark.parametrize(
    ("ball", "ends"),
    [
        (flint.arb(3), ("3", "3")),
        (HUGE, ("1e308", "inf")),
        (-HUGE, ("-inf", "-1e308")),
        (1 / HUGE, ("0", "1e-308")),
        (-1 / HUGE, ("-1e-308", "0")),
        (flint.arb(0), ("0", "0")),
    ],
)
def test_ends_are_rounded_outward_whatever_their_size(ball: flint.arb, ends: tuple[str, str]) -> None:
    assert decimal_pair(ball) == ends


def test_a_formula_with_values_beyond_all_measure_has_an_answer() -> None:
    square = {name: Domain.between(-2, Fraction(2)) for name in ("s", "t")}
    law = Criterion("fast", "exp(s**3 + t**2) - 2", {}, ("s", "t"), None, domain=square)
    assert verify(law, claims=["convexity"])["convexity"].verdict.value != "proved"
