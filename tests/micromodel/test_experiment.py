"""The friction test of the paper: exact geometry, predictions, the local friction both readings allow, and the errata."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from duhem import InputError
from duhem.micromodel.experiment import STEEL_ON_ALUMINIUM as PAPER
from duhem.micromodel.experiment import Experiment, errata
from duhem.micromodel.wedge import coefficients


def apparent(mu, tan_alpha=Fraction(1), tan_beta=Fraction(1, 4)):
    """Eqs. (6), (13), (15) as they are printed, in whatever arithmetic ``mu`` has."""

    def h(x, slope):
        return (x + slope) / (1 - x * slope)

    total = tan_alpha + tan_beta
    plus = (h(mu, tan_alpha) * tan_beta + h(mu, -tan_beta) * tan_alpha) / total
    return plus, (h(mu, tan_beta) * tan_alpha + h(mu, -tan_alpha) * tan_beta) / total


def test_geometry_closes_exactly():
    assert PAPER.tan_beta == sp.Rational(1, 4) and PAPER.mu_limit == 1
    assert float(sp.deg(sp.atan(PAPER.tan_beta))) == pytest.approx(14.0362, abs=5e-5)


@pytest.mark.slow
def test_predictions_against_rational_arithmetic():
    at = PAPER.predicted("1/4")
    assert (at.plus, at.minus) == (sp.Rational(1, 3), sp.Rational(23, 75))
    assert at.load_plus == sp.Rational(1000, 3)
    for mu in (Fraction(23, 100), Fraction(24, 100), Fraction(1, 4), Fraction(29, 100), Fraction(99, 100)):
        exact = apparent(mu)
        found = PAPER.predicted(mu)
        assert (Fraction(int(found.plus.p), int(found.plus.q)), Fraction(int(found.minus.p), int(found.minus.q))) == exact
        double = coefficients(np.pi / 4, np.arctan(0.25), float(mu), float(mu))
        assert [float(x) for x in double] == pytest.approx([float(x) for x in exact], rel=1e-15 if mu < 0.5 else 1e-13)


@pytest.mark.slow
def test_brackets_hold_the_roots():
    """Signs by Fractions at both ends; the root itself from mpmath."""
    for side, target in ((0, "0.33"), (0, "0.32"), (1, "0.29"), (1, "0.229")):
        found = PAPER.local_friction(**{("plus", "minus")[side]: target})
        low, high = (Fraction(int(end.p), int(end.q)) for end in (found.low, found.high))
        assert apparent(low)[side] <= Fraction(target) <= apparent(high)[side] and 0 <= high - low < Fraction(1, 10**14)
        with mpmath.workdps(40):
            root = mpmath.findroot(
                lambda mu, side=side, target=target: apparent(mu, mpmath.mpf(1), mpmath.mpf("0.25"))[side] - mpmath.mpf(target), 0.24
            )
            assert mpmath.mpf(low.numerator) / low.denominator <= root <= mpmath.mpf(high.numerator) / high.denominator
    assert PAPER.local_friction(plus="1/3").low <= sp.Rational(1, 4) <= PAPER.local_friction(plus="1/3").high


@pytest.mark.slow
def test_consistent_local_friction():
    found = PAPER.consistent("0.01")
    assert found.both is not None and sp.Rational(242, 1000) in found.both
    # within the intersection both readings are met, just outside one is missed
    for mu, inside in ((found.both.low.high, True), (found.both.high.low, True), (found.both.low.low - sp.Rational(1, 10**9), False)):
        at = PAPER.predicted(mu)
        misses = [abs(at.plus - PAPER.measured_plus), abs(at.minus - PAPER.measured_minus)]
        assert (max(misses) <= sp.Rational(1, 100)) == inside
    assert PAPER.mu_low < found.both.low.low and found.both.high.high < PAPER.mu_high  # far narrower than the paper's range
    assert PAPER.consistent("0.005").both is None
    exact = PAPER.consistent(0)
    assert exact.both is None and float(exact.by_plus.low) == pytest.approx(float(exact.by_plus.high))
    uneven = PAPER.consistent("0.02", 0)
    assert uneven.both is not None and float(uneven.both.low) == pytest.approx(float(PAPER.local_friction(minus="0.29")))


def test_least_scatter_is_the_least():
    mu, least = PAPER.least_scatter()
    tiny = sp.Rational(1, 10**12)
    assert PAPER.consistent(least.low - tiny).both is None
    both = PAPER.consistent(least.high + tiny).both
    assert both is not None and float(both.low) == pytest.approx(float(mu), abs=1e-9)
    at = PAPER.predicted(mu.low)
    assert float(PAPER.measured_plus - at.plus) == pytest.approx(float(at.minus - PAPER.measured_minus), abs=1e-14)


def test_errata_carry_computed_numbers():
    spring, tip, load, rounded = errata()
    assert spring.numbers["printed less Eq. (10)"] == -2 * sp.Symbol("F_0", real=True, nonpositive=True)
    assert tip.numbers["derivative along +t_a"] == 5 and tip.numbers["derivative along -t_a"] == sp.Rational(25, 2)
    assert load.numbers["229 N over the normal load"] == sp.Rational(229, 1000) and load.numbers["load of 0.29 (N)"] == 290
    assert rounded.numbers["mu_a_plus at 0.25"] == sp.Rational(1, 3) and rounded.numbers["mu_a_minus at 0.25"] == sp.Rational(23, 75)
    assert [round(float(rounded.numbers[f"mu_a_{s} at 0.24"]), 4) for s in ("plus", "minus")] == [0.3188, 0.2944]


def test_errata_follow_the_experiment():
    """Another test gives other numbers: nothing is stored."""
    other = Experiment("0.0003", "0.00004", 1, 500, "0.4", "0.3", "0.2", "0.3")
    assert other.tan_beta == sp.Rational(2, 13)
    _, _, load, rounded = errata(other)
    assert load.numbers["229 N over the normal load"] == sp.Rational(229, 500) and load.numbers["load of 0.29 (N)"] == 150
    assert rounded.numbers["mu_a_plus at 0.25"] == other.predicted("0.25").plus != sp.Rational(1, 3)


@pytest.mark.slow
def test_table_as_text():
    text = PAPER.to_text()
    assert "0.33333     0.30667" in text and "errata of the print" in text and "-2*F_0" in text
    assert "none" in PAPER.to_text("0.001")


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: PAPER.predicted(1), "outside"),
        (lambda: PAPER.predicted("-0.1"), "outside"),
        (lambda: PAPER.predicted("nan"), "not a number"),
        (lambda: PAPER.consistent("-0.1"), "negative"),
        (lambda: PAPER.local_friction(plus="0.3", minus="0.3"), "one of them"),
        (lambda: PAPER.local_friction(plus="-0.3"), "no local coefficient"),
        (lambda: Experiment("0.00004", "0.00004", 1, 1000, "0.33", "0.29", "0.23", "0.29"), "second side"),
        (lambda: Experiment("0.0002", "0.00004", 1, -1000, "0.33", "0.29", "0.23", "0.29"), "not positive"),
        (lambda: Experiment("0.0002", "0.00004", 1, 1000, "0.33", "0.29", "0.23", "1.29"), "stops sliding"),
    ],
)
def test_misuse_is_named(call, words):
    with pytest.raises(InputError, match=words):
        call()
