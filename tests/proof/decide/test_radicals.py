"""How far a number with roots is from 0 if it is not 0: the sizes read off its form, the digits asked for, and when they are too many."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import flint
import pytest
import sympy as sp

from duhem.expression import Norm
from duhem.proof.decide import radicals
from duhem.proof.decide.radicals import _sizes, sign_of_radicals

root, HALF = sp.sqrt, sp.S.Half
ONE_AND_ROOT = 1 + root(2)  # of size 2 * sqrt(2)
ZERO = ONE_AND_ROOT**2 - 3 - 2 * root(2)


def _raised(base: Any, exponent: str) -> sp.Expr:
    return sp.Pow(sp.sympify(base), sp.Rational(exponent), evaluate=False)


@pytest.mark.parametrize(
    ("number", "over", "under"),
    [
        (sp.S.Zero, 1, 1),
        (sp.S.NegativeOne, 1, 1),
        (sp.Rational(-7, 3), 7, 3),
        (sp.Rational(1, 2), 1, 2),
        (root(7), 7**0.5, 1),
        (Norm(root(2), root(7)), 3, 1),
        (Norm(sp.Rational(2, 3), root(7)), (4 / 9 + 7) ** 0.5 * 9, 9),
        (_raised(sp.Rational(5, 2), "1/3"), (5 * 2**2) ** (1 / 3), 2),  # the root of 5 * 2^2, over 2
        (_raised(sp.Rational(5, 2), "2/3"), (5 * 2**2) ** (2 / 3), 4),
        (_raised(sp.Rational(5, 2), "-2/3"), 4, (5 * 2**2) ** (2 / 3)),
        (ONE_AND_ROOT, 2 * 2**0.5, 1),  # two parts, the greater sqrt(2)
        (ONE_AND_ROOT**3, 8**1.5, 1),
        (1 / ONE_AND_ROOT, 1, 8**0.5),
        (root(2) / 3 + root(5) / 7, 2 * 7 * 2**0.5, 21),  # 7 sqrt(2) and 3 sqrt(5)
        (root(2) / 7 + root(5) / 3 + 1, 3 * 21, 21),
        (root(2) * root(5 + root(3)) / 3, 2**0.5 * (2 * 5) ** 0.5, 3),
    ],
)
def test_sizes_of_numbers(number: sp.Expr, over: float, under: float) -> None:
    """Never less, and hardly more."""
    sizes = _sizes(number, {})
    assert sizes is not None
    for size, known in zip(sizes, (over, under), strict=True):
        exact = float(sp.log(sp.Float(known, 40), 2)) if known != 1 else 0.0
        assert exact * (1 - 1e-12) <= size <= exact * (1 + 1e-5) and (size > exact or exact == 0)


def test_what_roots_are_taken_of() -> None:
    roots: dict[sp.Expr, int] = {}
    assert _sizes(root(2) + sp.cbrt(2) * root(1 + root(3)) + (1 + root(3)) ** 2 + Norm(root(2), 1), roots) is not None
    assert {base: index for base, index in roots.items() if index > 1} == {sp.Integer(2): 6, sp.Integer(3): 2, 1 + root(3): 2}


def test_what_is_no_number_of_the_kind() -> None:
    for odd in (sp.log(2), root(2) + sp.log(2), root(2) * sp.log(2), root(sp.log(2)), sp.pi, 2 ** root(2), Norm(sp.pi, 1)):
        assert _sizes(odd, {}) is None
    assert _sizes(ONE_AND_ROOT**1000, {}) is not None and _sizes(ONE_AND_ROOT**-1000, {}) is not None
    assert _sizes(ONE_AND_ROOT**1001, {}) is None and _sizes(ONE_AND_ROOT**-1001, {}) is None


@pytest.mark.parametrize(("bits", "sign"), [(7, 0), (6, None)])
def test_only_what_is_closer_to_0_than_others_can_be_is_0(monkeypatch: pytest.MonkeyPatch, bits: int, sign: int | None) -> None:
    """Of size 8 * 3 with one square root: 1/(8 * 3)^(2 - 1) > 2^-6, and every other number is farther from 0."""
    seen: list[int] = []

    def wide(number: sp.Expr, values: object) -> Any:
        seen.append(flint.ctx.prec)
        return flint.arb(0, 2.0**-bits)

    monkeypatch.setattr(radicals, "enclose", wide)
    assert sign_of_radicals(ZERO) is sign
    assert seen == [64, 256, 1024, 6 + 4 + 128]
    seen.clear()
    assert sign_of_radicals(sp.log(2)) is None and seen == [64, 256, 1024]


def test_what_has_no_value_has_no_sign(monkeypatch: pytest.MonkeyPatch) -> None:
    for ball in (flint.arb("nan"), flint.arb(0, "inf"), flint.arb(0, 1)):
        monkeypatch.setattr(radicals, "enclose", lambda number, values, ball=ball: ball)
        assert sign_of_radicals(ZERO) is None


def test_the_digits_that_are_too_many() -> None:
    """1 + 2^-n - 1 needs n of them."""
    most = 1 << 18

    def close(n: int) -> sp.Expr:
        return sp.Add(1, sp.Rational(Fraction(1, 2**n)), -1, evaluate=False)

    assert sign_of_radicals(close(most - 2)) == 1 and sign_of_radicals(close(most - 1)) is None
