"""The kernel's enclosures round outward."""

from __future__ import annotations

import math
from fractions import Fraction
from random import Random

import mpmath
import pytest

from duhem.proof.kernel.constant_value import BITS, Enclosure, _greater, _halved, _over, _shifted, _times_whole, enclosed
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO
from duhem.proof.kernel.term import parse

F = Fraction
UNIT = 1 << BITS


def test_enclosures_round_outward() -> None:
    third = Enclosure.between(F(1, 3), F(1, 3))
    assert third == (UNIT // 3, UNIT // 3 + 1) and Enclosure.between(F(-1, 3), F(1, 2)) == (-(UNIT // 3) - 1, UNIT // 2)
    assert third.plus(Enclosure(1, 2)) == (UNIT // 3 + 1, UNIT // 3 + 3) and Enclosure(1, 2).minus() == (-2, -1)
    assert Enclosure(1, 1).times(Enclosure(1, 1)) == (0, 1) and Enclosure(-1, 1).times(Enclosure(3, 5)) == (-1, 1)
    assert Enclosure(2 * UNIT, 3 * UNIT).times(Enclosure(-5 * UNIT, 4 * UNIT)) == (-15 * UNIT, 12 * UNIT)
    assert Enclosure(-3 * UNIT, -2 * UNIT).times(Enclosure(-5 * UNIT, -4 * UNIT)) == (8 * UNIT, 15 * UNIT)
    assert Enclosure(-3 * UNIT, 2 * UNIT).times(Enclosure(-5 * UNIT, 4 * UNIT)) == (-12 * UNIT, 15 * UNIT)
    assert Enclosure(2 * UNIT, 3 * UNIT).inverse() == (UNIT // 3, UNIT // 2) and Enclosure(3 * UNIT, 3 * UNIT).inverse() == (
        UNIT // 3,
        UNIT // 3 + 1,
    )
    assert Enclosure(-3 * UNIT, -2 * UNIT).inverse() == (-UNIT // 2, -(UNIT // 3))
    assert Enclosure(4 * UNIT, 9 * UNIT).root() == (2 * UNIT, 3 * UNIT + 1) and Enclosure(0, 0).root() == (0, 1)
    for low, high, sign in (
        (1, 2, POSITIVE),
        (0, 2, ZERO | POSITIVE),
        (0, 0, ZERO),
        (-1, 0, NEGATIVE | ZERO),
        (-2, -1, NEGATIVE),
        (-1, 1, 7),
    ):
        assert Enclosure(low, high).sign == sign
    for low, high in ((0, 1), (-1, 0), (-1, 1)):
        with pytest.raises(ZeroDivisionError):
            Enclosure(low, high).inverse()


def test_steps_of_series() -> None:
    assert (
        _greater(Enclosure(-1, 5), Enclosure(0, 3)) == (0, 5) and Enclosure(-5, 2).size() == (0, 5) and Enclosure(-5, -2).size() == (2, 5)
    )
    assert (
        _shifted(Enclosure(1, 2), 3) == (1 + 3 * UNIT, 2 + 3 * UNIT)
        and _over(Enclosure(-1, 1), 3) == (-1, 1)
        and _over(Enclosure(7, 7), 2) == (3, 4)
    )
    assert _times_whole(Enclosure(1, 2), -3) == (-6, -3) and _times_whole(Enclosure(1, 2), 3) == (3, 6)
    two, spread = Enclosure(2 * UNIT, 2 * UNIT), Enclosure(-3 * UNIT, 2 * UNIT)
    assert two.power(3) == (8 * UNIT, 8 * UNIT) and two.power(-2) == (UNIT // 4, UNIT // 4) and two.power(0) == (UNIT, UNIT)
    assert spread.power(2) == (0, 9 * UNIT) and spread.power(3) == (-27 * UNIT, 18 * UNIT) and two.power(64).low == 2**64 * UNIT
    for x in (Enclosure(UNIT // 3, UNIT // 3), Enclosure(-5 * UNIT, 3 * UNIT), Enclosure(-1, 0), Enclosure(7 * UNIT, 900 * UNIT)):
        y, k = _halved(x)
        assert (
            max(-y.low, y.high) <= UNIT // 3 + 1
            and y.low << k <= x.low
            and y.high << k >= x.high
            and y.high - y.low <= ((x.high - x.low) >> k) + 2
        )
    with pytest.raises(ValueError, match="too large"):
        _halved(Enclosure(0, 1001 * UNIT))


def test_a_tangent_is_enclosed_by_those_of_its_ends() -> None:
    random, tangent = Random(6), parse("tan(x)")
    for _ in range(100):
        low, high = sorted(F(random.randint(-900, 900), 100) for _ in range(2))
        places = [float(low + (high - low) * F(k, 20)) for k in range(21)]
        if any(low < (k + F(1, 2)) * F(math.pi) < high for k in range(-4, 4)):
            with pytest.raises(ZeroDivisionError):
                enclosed(tangent, {"x": Enclosure.between(low, high)})
        elif min(abs(math.cos(x)) for x in places) > high - low:
            found = enclosed(tangent, {"x": Enclosure.between(low, high)})
            assert all(found.low / UNIT <= math.tan(x) + 1e-9 and math.tan(x) - 1e-9 <= found.high / UNIT for x in places)
            assert found.high - found.low <= (math.tan(high) - math.tan(low) + 1e-9) * UNIT


def test_waves_of_large_angles_lose_whole_turns() -> None:
    random = Random(5)
    for _ in range(300):
        x = F(random.randint(-(10**9), 10**9), random.choice((1, 7, 1000)))
        for word in ("sin", "cos"):
            held = enclosed(parse(f"{word}(({x}))"), {})
            with mpmath.workdps(60):
                value = getattr(mpmath, word)(mpmath.mpf(x.numerator) / x.denominator) * UNIT
                assert held.low <= value <= held.high and held.high - held.low < UNIT >> 50
