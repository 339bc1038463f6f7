"""The parts of the exact sign of a number with roots: bounds of its conjugates, enclosures, roots of whole numbers, exponents."""

from __future__ import annotations

from fractions import Fraction
from math import sqrt
from random import Random

import pytest

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO
from duhem.proof.kernel.constant_value import Enclosure, _exponent, _sizes, _whole_root, enclosed, finer, sign_of_radicals
from duhem.proof.kernel.term import Term, parse

DENESTED = "sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6))"


@pytest.mark.parametrize(
    ("text", "over", "under", "roots"),
    [
        ("0", 0, 0, {}), ("1", 0, 0, {}), ("2", 1, 0, {}), ("3", 2, 0, {}), ("4", 2, 0, {}), ("5", 3, 0, {}), ("0.375", 2, 3, {}),
        ("1/3", 0, 2, {}), ("1/2 + 1/3", 3, 3, {}), ("1 + 2 + 1", 3, 0, {}), ("1 + 1 + 1 + 1 + 1", 3, 0, {}), ("3*5*2", 6, 0, {}),
        ("abs(-5)", 3, 0, {}), ("0.375**2", 4, 6, {}), ("0.375**-2", 6, 4, {}), ("5**(1/2)", 2, 0, {"5": 2}), ("5**(1/3)", 1, 0, {"5": 3}),
        ("5**(2/3)", 2, 0, {"5": 3}), ("0.2**(1/2)", 2, 3, {"0.2": 2}), ("0.2**(1/3)", 2, 3, {"0.2": 3}),
        ("0.2**(-2/3)", 6, 4, {"0.2": 3}), ("2**(1/2) + 2**(1/3)", 2, 0, {"2": 6}), ("2**(1/4)*2**(1/6)", 2, 0, {"2": 12}),
        ("(2**0.5 + 3)**0.5", 2, 0, {"2": 2, "2**0.5 + 3": 2}), ("8 - 1/4", 6, 2, {}),
    ],
)  # fmt: skip
def test_how_large_the_conjugates_of_a_number_may_be(text: str, over: int, under: int, roots: dict[str, int]) -> None:
    """Binary logarithms of bounds of U and L, the number being U/L; and what roots are taken, of which index."""
    found = dict[Term, int]()
    assert _sizes(parse(text), found) == (over, under)
    assert found == {parse(base): index for base, index in roots.items()}


@pytest.mark.parametrize(
    "text",
    [
        "3", "-3/7", "sqrt(2)", "sqrt(1/3)", "5**(1/3)", "(2/9)**(3/4)", "7**-1", "(1/7)**(-2/3)", "sqrt(2) - sqrt(3)", "abs(1 - sqrt(2))",
        "abs(sqrt(2) - 1)", "(1 - sqrt(2))*(3 - sqrt(7))", "(1 - sqrt(2))**3", "(1 - sqrt(2))**-3", "10**5*sqrt(2)", "0**(1/3) + 1",
        "1/3 - 1/7", "(1/100)**(1/5)", "2**(-5/2)", "abs(3)", "abs(-1/3)", "norm(1, 0)**0.5",
    ],
)  # fmt: skip
@pytest.mark.parametrize("bits", [16, 40])
def test_numbers_lie_between_their_ends(text: str, bits: int) -> None:
    term = parse(text.replace("norm(1, 0)", "1"))
    (low, high), (least, most) = enclosed(term, {}, finer(bits)), enclosed(term, {}, finer(200))
    assert low << (200 - bits) <= least <= most <= high << (200 - bits)
    exact = eval_of(term)
    assert low / 2**bits - 1e-12 <= exact <= high / 2**bits + 1e-12 and 0 <= high - low <= 40 * (1 + abs(exact)) ** 2


def eval_of(term: Term) -> float:
    if term.op == "number":
        return float(term.value)
    parts = [eval_of(a) for a in term.args]
    if term.op == "+":
        return sum(parts)
    if term.op == "*":
        return parts[0] * eval_of(Term("*", term.args[1:])) if len(parts) > 1 else parts[0]
    return float(abs(parts[0])) if term.op == "abs" else parts[0] ** parts[1]


def test_what_may_be_zero_over_an_interval_holds_zero() -> None:
    """8 digits do not tell sqrt(2) sqrt(3) from sqrt(6)."""
    near = parse("abs(sqrt(2)*sqrt(3) - sqrt(6))")
    unit = finer(8)
    low, high = enclosed(near, {}, unit)
    assert low == 0 and 0 < high < 16
    with pytest.raises(ZeroDivisionError):
        enclosed(parse("1/(sqrt(2)*sqrt(3) - sqrt(6))"), {}, unit)
    with pytest.raises(ValueError, match="root"):
        enclosed(parse("sqrt(sqrt(2)*sqrt(3) - sqrt(6))"), {}, unit)
    for text in ("exp(1)", "x", "pi", "2**sqrt(2)", "max(1, 2)"):
        with pytest.raises(ValueError, match="no enclosure"):
            enclosed(parse(text), {"x": Enclosure(0, 1)}, unit)


def test_whole_roots() -> None:
    random = Random(3)
    for k in (2, 3, 4, 5, 7, 30):
        for x in (0, 1, 2, 3, 7, 8, 9, 2**k - 1, 2**k, 2**k + 1, 5**k - 1, 5**k, 10**40, *(random.getrandbits(90) for _ in range(20))):
            found = _whole_root(x, k)
            assert found**k <= x < (found + 1) ** k


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1/3", Fraction(1, 3)), ("0.25", Fraction(1, 4)), ("-2/5", Fraction(-2, 5)), ("1/2 + 1/6", Fraction(2, 3)),
        ("2*(1/3)*(1/2)", Fraction(1, 3)), ("1/(2*3)", Fraction(1, 6)), ("2**1", Fraction(2)), ("(2/3)**-1", Fraction(3, 2)),
        ("1/200", Fraction(1, 200)), ("200/3", Fraction(200, 3)),
        ("-200", Fraction(-200)), ("2**2", Fraction(4)), ("sqrt(4)", Fraction(2)), ("abs(2)", Fraction(2)),
    ],
)  # fmt: skip
def test_exponents_are_quotients(text: str, value: Fraction) -> None:
    assert _exponent(parse(f"2**({text})")) == value


@pytest.mark.parametrize("text", ["1 - 1", "201", "1/201", "-201/2", "exp(1)", "pi", "sqrt(2)", "1/0"])
def test_other_exponents_are_none(text: str) -> None:
    assert _exponent(parse(f"2**({text})")) is None


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("norm(3, 4) - 5", ZERO), ("norm(3, 4) - 5 + 1/10**50", POSITIVE), ("norm(1, sqrt(2)) - sqrt(3) - 1/10**50", NEGATIVE),
        ("norm(norm(1, 1), 1) - sqrt(3)", ZERO), ("1 - sqrt(2)", NEGATIVE), ("sqrt(2) - 1", POSITIVE), ("2**(1/200) - 1", POSITIVE),
        ("0 - 0*sqrt(2)", ZERO), ("1/0", ANY), ("sqrt(-1)", ANY), ("exp(1)", ANY), ("x - 1", ANY), ("sqrt(exp(1)) - 2", ANY),
        (f"abs({DENESTED})**(1/8)", ANY), (f"-abs({DENESTED})**(1/8)", ANY), (f"1 - abs({DENESTED})", POSITIVE),  # 0, not seen to be
    ],
)  # fmt: skip
def test_signs(text: str, sign: int) -> None:
    assert sign_of_radicals(parse(text)) == sign


@pytest.mark.parametrize("n", [2, 3, 5, 8])
def test_what_is_near_to_zero_is_told_from_it(n: int) -> None:
    """(sqrt(2) - 1)^k = a - b sqrt(2) is as near to 0 as it can be for its size; of the two signs of sqrt(2) - a/b either comes."""
    a, b = 1, 1
    for _ in range(2**n):
        a, b = a + 2 * b, a + b
    sign = POSITIVE if a * a < 2 * b * b else NEGATIVE
    assert sign_of_radicals(parse(f"{b}*sqrt(2) - {a}")) == sign
    assert sign_of_radicals(parse(f"sqrt(2) - {a}/{b}")) == sign
    assert sign_of_radicals(parse(f"{b}*sqrt(2) - {a} - ({b}*sqrt(2) - {a})")) == ZERO
    assert sign_of_radicals(parse(f"({b}*sqrt(2) - {a})*({b}*sqrt(2) + {a}) - ({2 * b * b - a * a})")) == ZERO
    assert abs(sqrt(2) - a / b) < 1 / b**2 + 1e-15
