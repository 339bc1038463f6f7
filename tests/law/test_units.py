"""Units of parameters, as formulas have them."""

from fractions import Fraction

import pytest

import duhem
from duhem.law.law_sheet import stress_powers, unit_in_words, units_in_words


@pytest.mark.parametrize(
    ("law", "powers"),
    [
        ("cohesive", {"mu": 0, "cohesion": 1}),
        ("capped", {"mu": 0, "tau_max": 1}),
        ("tresca", {"yield_stress": 1}),
        ("superellipse", {"mu_a": 0, "mu_b": 0, "p": 0}),
        ("hosford", {"yield_stress": 1, "m": 0}),
        ("wedge", {"tan_alpha": 0, "tan_beta": 0, "mu_alpha": 0, "mu_beta": 0}),
        ("rotated-flow", {"mu": 0, "delta": None}),  # the formula of K has no delta
        ("hashin", dict.fromkeys(("Xt", "Xc", "Yt", "Yc", "S", "ST"), 1)),
        ("ottosen", {"a": -2, "b": -1, "k1": -1, "k2": 0}),
        ("hill48", dict.fromkeys(("F", "G", "H", "L", "M", "N", "s0"))),  # a factor may carry any unit
        ("yld2000-2d", {"a": 0} | dict.fromkeys(("a1", "a2", "a3", "a4", "a5", "a6", "a7", "a8", "s0"))),
    ],
)
def test_the_formula_says_in_which_power_of_the_unit_a_parameter_is(law: str, powers: dict[str, int | None]) -> None:
    assert stress_powers(duhem.load(law)) == powers


@pytest.mark.parametrize(
    ("g", "power"),
    [
        ("norm(a, b) - q", 1),
        ("q*norm(a, b) - 1", -1),
        ("a**2 + b**2 - q", 2),
        ("sqrt(a**2 + b**2) - exp(q)*sqrt(abs(q*a))", None),  # of unlike terms: the exponent is a number, and q a stress
        ("norm(a, b) - where(a > q, 2*q, q)", 1),
        ("norm(a, b) - where(a > 0, q*abs(a), abs(a))", 0),
        ("max(a - q, b - 2*q, -a - b)", 1),
        ("max((a - q)/q, b - q)", 1),  # which of them is greater is not asked
        ("max(a - q, -a - b - 1)", None),
        ("norm(a, b) - 1 - q", None),
        ("norm(a, b)**q - 3", None),
        ("(norm(a, b)/abs(b - 2*a))**q - 3", 0),
        ("sqrt(abs(a)) - q", Fraction(1, 2)),
    ],
)
def test_sums_and_comparisons_are_of_like_terms(g: str, power: int | Fraction | None) -> None:
    law = duhem.Criterion(name="t", g=g, forces=("a", "b"), pressure=None, parameters={"q": duhem.POSITIVE})
    assert stress_powers(law) == {"q": power}


def test_units_in_words() -> None:
    powers = (None, Fraction(0), Fraction(1), Fraction(-2))
    assert [unit_in_words(power) for power in powers] == [None, "", "unit of stress", "(unit of stress)^(-2)"]
    assert units_in_words(duhem.load("cohesive")) == "mu: pure numbers; cohesion: unit of stress"
    assert units_in_words(duhem.load("ottosen")) == "a: (unit of stress)^(-2); b, k1: (unit of stress)^(-1); k2: pure numbers"
    assert units_in_words(duhem.load("hill48")) == ""


def test_an_angle_of_two_stresses_is_a_pure_number() -> None:
    g, parameters = "norm(a, b)*(1 + e*cos(2*atan2(b, a))) - q", {"q": duhem.POSITIVE, "e": duhem.POSITIVE}
    assert stress_powers(duhem.Criterion("angled", g, forces=("a", "b"), pressure=None, parameters=parameters)) == {"q": 1, "e": 0}
