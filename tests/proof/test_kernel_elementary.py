"""The kernel's enclosures of powers and words hold the value, and are narrow; signs of constants by them."""

from __future__ import annotations

import math
from fractions import Fraction as F
from random import Random

import mpmath
import pytest

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, Bounds
from duhem.proof.kernel.constant_value import BITS, Enclosure, enclosed, sign_over
from duhem.proof.kernel.stated_law import without_angles
from duhem.proof.kernel.term import NotWritten, parse
from tests.oracles import drawn_formulas

_MP = mpmath.MPContext()
_MP.dps = 60
WORDS = {
    "exp": _MP.exp, "log": _MP.log, "sin": _MP.sin, "cos": _MP.cos, "tan": _MP.tan, "asin": _MP.asin, "acos": _MP.acos, "atan": _MP.atan,
    "sinh": _MP.sinh, "cosh": _MP.cosh, "tanh": _MP.tanh, "abs": abs, "pos": lambda x: max(x, 0), "neg": lambda x: max(-x, 0),
}  # fmt: skip


def holds(found: Enclosure, value: object) -> bool:
    return bool(found.low <= _MP.mpf(value) * 2**BITS <= found.high)


def points(word: str, rng: Random) -> list[F]:
    exact = [F(0), F(1), F(-1), F(1, 2), F(3, 2), F(10**6 - 1, 10**6), F(-1, 10**9), F(1, 2**90), F(7), F(-30), F(355, 113)]
    drawn = [F(rng.randint(-(10**9), 10**9), 10 ** rng.randint(7, 12)) for _ in range(12)]
    every = [*exact, *drawn]
    return [x for x in every if (x > 0 or word != "log") and (abs(x) <= 1 or word not in ("asin", "acos"))]


@pytest.mark.parametrize("word", WORDS)
def test_a_word_at_a_point_is_known_to_many_digits(word: str) -> None:
    rng, term = Random(3), parse(f"{word}(x)")
    for x in points(word, rng):
        found = enclosed(term, {"x": Enclosure.between(x, x)})
        value = WORDS[word](_MP.mpf(x.numerator) / x.denominator)
        assert holds(found, value), x
        slope = 2.0**20 if word in ("asin", "acos", "log") else max(1.0, float(abs(value)) ** 2)
        assert found.high - found.low <= 2**24 * slope, x


@pytest.mark.parametrize("word", WORDS)
def test_a_word_over_an_interval_holds_all_its_values(word: str) -> None:
    rng, term = Random(4), parse(f"{word}(x)")
    for _ in range(12):
        low, high = sorted(rng.sample(points(word, rng), 2))
        if high - low > 40:
            continue
        try:
            found = enclosed(term, {"x": Enclosure.between(low, high)})
        except ZeroDivisionError:
            assert word == "tan" and high - low > F(1, 10)
            continue
        for share in (F(0), F(1, 7), F(1, 2), F(9, 10), F(1)):
            x = low + share * (high - low)
            assert holds(found, WORDS[word](_MP.mpf(x.numerator) / x.denominator)), (low, high, share)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi", _MP.pi), ("2**(1/6)", _MP.mpf(2) ** (_MP.mpf(1) / 6)), ("(1/3)**-2.5", _MP.mpf(3) ** 2.5), ("0**(2/3)", 0), ("3**0", 1),
        ("norm(1, 2, 2)", 3), ("max(1, sqrt(2), -3) - min(2, exp(1), 7)", _MP.sqrt(2) - 2), ("(-2)**3", -8), ("(-3)**-2", F(1, 9)),
        ("atan2(1, -1)", 3 * _MP.pi / 4), ("atan2(-2, 0)", -_MP.pi / 2), ("atan2(-1, -1)", -3 * _MP.pi / 4), ("sign(-2) + sign(0)", -1),
        ("log10(1000)", 3), ("where(sqrt(2) > 1 and 3**0.5 < 2, 5, 6)", 5), ("cos(3*atan2(1, 1))", -_MP.sqrt(2) / 2),
    ],
)  # fmt: skip
def test_constants(text: str, value: object) -> None:
    for term in (parse(text), without_angles(parse(text))):
        found = enclosed(term, {})
        exact = _MP.mpf(value.numerator) / value.denominator if isinstance(value, F) else value
        assert found.low - 4 <= _MP.mpf(exact) * 2**BITS <= found.high + 4 and found.high - found.low < 2**30


@pytest.mark.parametrize(
    "text",
    [
        "log(0)", "log(-1)", "asin(1.01)", "acos(-1.01)", "sqrt(-1)", "(-1)**(1/3)", "1/0", "0**-0.5", "0**(1 - 1)", "atan2(0, 0)",
        "log(-3)", "exp(2000)", "sin(10**40)", "2**2000", "tan(x)", "log(x)", "asin(2*x)", "1/x", "sqrt(x)", "atan2(x, x)", "x**(1/3)",
    ],
)  # fmt: skip
def test_what_may_be_undefined_or_is_too_large_is_not_enclosed(text: str) -> None:
    """x is from -2 to 2."""
    with pytest.raises((ValueError, ZeroDivisionError)):
        enclosed(parse(text), {"x": Enclosure.between(F(-2), F(2))})


def test_drawn_formulas_over_boxes_hold_their_values() -> None:
    """Formulas of parameters alone, at points of their box: where the oracle has no value, there is no enclosure."""
    rng, held = Random(9), 0
    box = {"e": (F(0), F(1, 2)), "q": (F(-1), F(1)), "p": (F(1), F(4)), "k": (F(-2), F(-1, 2)), "m": (F(1, 10), F(3))}
    for _ in range(400):
        term = parse(drawn_formulas.text(rng, rng.choice((1, 2, 3)))).put(
            {parse(x): parse(y) for x, y in (("a", "q"), ("b", "p"), ("s", "k"))}
        )
        cut = {n: sorted((low + (high - low) * F(rng.randint(0, 8), 8)) for _ in "xy") for n, (low, high) in box.items()}
        try:
            found = enclosed(term, {n: Enclosure.between(*ends) for n, ends in cut.items()})
        except (ValueError, ZeroDivisionError):
            continue
        for _ in range(4):
            at = {n: float(low + (high - low) * F(rng.randint(0, 4), 4)) for n, (low, high) in cut.items()}
            value = drawn_formulas.value(term, at)
            slack = 1e-9 * (1 + abs(value))
            assert found.low / 2.0**BITS - slack <= value <= found.high / 2.0**BITS + slack, (term, at)
            held += 1
    assert held > 300


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("1 - sin(x)", POSITIVE), ("sin(x) - 1", NEGATIVE), ("exp(-x) - 1/2", POSITIVE), ("exp(-x) - 0.9", ANY),
        ("1 - (4/5)**0.229", POSITIVE), ("acos(x) - 1", POSITIVE), ("acos(x) - 1.5", ANY),
        ("2 - cosh(x)", POSITIVE), ("log10(1 + x) + 1/100", POSITIVE), ("sin(x)", ANY),
        ("1 - sin(y)", ANY), ("x - 1", NEGATIVE), ("1 - sin(z)", ANY), ("log(x)", ANY), ("1 - sin(x)*cos(u)", POSITIVE),
        ("tan(x) - 2*u - 3", NEGATIVE), ("tan(x) - 2*u", ANY),
    ],
)  # fmt: skip
def test_signs_of_constants(text: str, sign: int) -> None:
    """0 <= x <= 1/2, y >= 0, z not declared, -1 <= u <= 1; polynomials have rules of their own."""
    bounds = {"x": Bounds(F(0), F(1, 2)), "y": Bounds(F(0), None), "u": Bounds(F(-1), F(1))}
    assert sign_over(parse(text), bounds) == sign


# -- waves of an angle -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "cos(3*atan2(b, a))", "sin(4*atan2(b, a))", "sin(-2*atan2(b, a))", "cos(-atan2(a, b))", "a*sin(2*(3*atan2(b, a - b)))",
        "cos(2*(atan2(b, a) - m))", "sin(1 - 3*atan2(b, a) + m)", "cos(2*(m - 2*(atan2(b, a) + pi/3)))", "sin(4*(atan2(b, a) + m/2) - a)",
        "cos(atan2(b, a) + m + atan2(b, a))", "sin(-2*(m*b - 2*atan2(b, a)))",
    ],
)  # fmt: skip
def test_waves_of_an_angle_are_quotients(text: str) -> None:
    term, algebra = parse(text), without_angles(parse(text))
    assert "atan2" not in repr(algebra)
    for a, b in ((1.0, 2.0), (-1.0, 0.5), (-2.0, -1.0), (0.0, -1.0), (-1.0, 0.0)):
        at = {"a": a, "b": b, "m": 0.7, "pi": math.pi}
        assert drawn_formulas.value(algebra, at) == pytest.approx(drawn_formulas.value(term, at), rel=1e-12, abs=1e-12)
    with pytest.raises((ValueError, ZeroDivisionError)):
        drawn_formulas.value(algebra, {"a": 0.0, "b": 0.0, "m": 0.7, "pi": math.pi})


@pytest.mark.parametrize("text", ["cos(atan2(b, a)/2)", "cos(0*atan2(b, a))", "cos(a*atan2(b, a))", "tan(atan2(b, a))", "cos(2*atan(b/a))"])
def test_what_is_no_whole_multiple_stays(text: str) -> None:
    assert without_angles(parse(text)) == parse(text)


def test_angles_within_angles_do_not_fill_the_memory() -> None:
    text = "a"
    for _ in range(12):
        text = f"cos(5*atan2(b, {text}))"
    with pytest.raises(NotWritten):
        without_angles(parse(text))


def test_pi_is_pi() -> None:
    found = enclosed(parse("pi"), {})
    assert found.low / 2**BITS <= math.pi <= found.high / 2**BITS
