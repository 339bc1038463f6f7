"""Beside what a rule of the kernel shows, what it must not: each pair differs where one of the rule's conditions is wanting."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.constant_value import BITS, Enclosure, _odd_series, _series, enclosed
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import line, sign_at
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten

UNIT = 1 << BITS
PARAMETERS = {
    "q": {"min": "-1", "max": "1"},
    "n": {"min": "1", "max": "2"},
    "m": {"positive": True},
    "e": {"min": "0", "max": "1/2"},
}


def confirmed(claim: str, rule: str, g: str, evidence: Any = None, settled: str = "origin", forces: str = "abp", **more: Any) -> bool:
    given = {"forces": [*forces], "pressure": None, "parameters": PARAMETERS, "constraints": [], "g": g, "flow": None, **more}
    return not objection(claim, rule, frozenset(settled.split()), StatedLaw.read(given), evidence or {})


# -- numbers -----------------------------------------------------------------------------------------------------------


def test_what_a_series_leaves_out_is_allowed_for_on_both_sides() -> None:
    one, nothing = Enclosure(UNIT, UNIT), Enclosure(0, 0)
    assert _series(nothing, lambda i: i) == _odd_series(one, nothing) == (UNIT - 1, UNIT + 1)


@pytest.mark.parametrize("b", range(-3, 4))
@pytest.mark.parametrize("a", [-2, -1, 1, 3])
def test_a_root_of_second_degree_is_written_with_a_root(a: int, b: int) -> None:
    for c in (-5, -2, 2, 5):
        poly = line([Fraction(x) for x in (c, b, a)])
        ends = [(Fraction(k, 4), Fraction(k + 1, 4)) for k in range(-40, 40)]
        for low, high in ends:
            if sign_at(poly, low) * sign_at(poly, high) < 0:
                value = enclosed(RealRoot(poly, low, high).term(), {})
                assert low * UNIT < value.low <= value.high < high * UNIT
    for wrong in (line(map(Fraction, (-2, 0, 0, 1))), line(map(Fraction, (-1, 0, 0, 0, 2)))):
        with pytest.raises(NotWritten):
            RealRoot(wrong, Fraction(0), Fraction(2)).term()


# -- regions -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("g", "right"),
    [
        ("max(norm(a, b) + 0*p**n - 1, -p)", True),
        ("max(norm(a, b) + 0*p**q - 1, -p)", False),  # no value at p = 0, where K has points
        ("max(2*norm(a, b) - 1 + 0*p**q, -p)", False),
        ("max((norm(a, b) + 0*p**q)*m - 1, -p)", False),
        ("max((norm(a, b)/p)**n - 1, -p)", True),
        ("max((abs(a)/p)**n - p, -p)", False),
        ("max((abs(a)/p)**n + b - 1, -p)", False),
        ("max((abs(a)/p)**(n/2) + p - 1, -p)", False),
        ("max((abs(a)/abs(p))**n + p - 1, -p)", False),
        ("max((a/p)**n + p - 1, -p)", False),
        ("max((norm(a, b)/p)**n*(a/p) - 1, -p)", False),
        ("max(a**2/p + b**2 - m, -p)", True),
        ("max(a**3/p + b**2 - m, -p)", False),
        ("max(a**2/p**2 + b**2 - m, -p)", False),
        ("max(-a**2/p + b**2 - m, -p)", False),
    ],
)
def test_where_a_load_divides(g: str, right: bool) -> None:
    assert confirmed("convexity", "composition", g) is right
