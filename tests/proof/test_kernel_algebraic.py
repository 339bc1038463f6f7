"""Polynomials with square roots in the kernel: what they are, their slopes and their signs, held against floating point and by hand."""

from __future__ import annotations

import math
from fractions import Fraction as F
from functools import cache
from itertools import combinations

import pytest

from duhem import Criterion
from duhem.law.domain import Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.identity import alike
from duhem.proof.kernel.plane_function import Signs, inner, plain, roots_in, slope_along, sqrt
from duhem.proof.kernel.polynomial import Polynomial, negated, times, total
from duhem.proof.kernel.signs import RAY, nonnegative
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.proof import small_laws

E = Term("name", name="e")
FAR = F(3, 2)


@cache
def domain(low: str = "1/2", high: str = "1") -> StatedDomain:
    law = Criterion(name="law", g="a + b - e", forces=("a", "b"), pressure=None, parameters={"e": Domain.between(low, high)})
    return over(StatedLaw.read(law_as_text(law)))


def signs(low: str = "1/2", high: str = "1") -> Signs:
    return Signs(domain(low, high), (F(0), FAR))


def poly(*coefficients: int | F, x: Term = RAY) -> Polynomial:
    return {((x, n),) if n else (): F(c) for n, c in enumerate(coefficients) if c}


def value(form: Polynomial, at: dict[Term, float]) -> float:
    def of(x: Term) -> float:
        return at[x] if x in at else math.sqrt(value(inner(x, domain()), at))

    return sum(float(c) * math.prod(of(x) ** n for x, n in m) for m, c in form.items())


ROOT = sqrt(poly(2, 0, 1))  # sqrt(2 + d^2)
((W, _),) = next(iter(ROOT))


def power(n: int) -> Polynomial:
    return {((W, n),): F(1)}


@pytest.mark.parametrize("x", [F(2), F(3, 2), F(6), F(1, 4), F(18), F(50, 27), F(19), F(361), F(38, 7), F(0)])
def test_the_root_of_a_number_is_one_of_primes(x: F) -> None:
    root = sqrt({(): x} if x else {})
    assert value(root, {}) == pytest.approx(math.sqrt(x))
    assert plain(times(root, root), domain()) == ({(): x} if x else {})
    assert len(root) == (x > 0)


def test_what_has_no_root() -> None:
    with pytest.raises(NotWritten):
        sqrt({(): F(-1)})


@pytest.mark.parametrize("n", [-3, -2, -1, 1, 2, 3])
def test_powers_of_roots_of_numbers(n: int) -> None:
    x = Term("**", (parse("3/2"), Term("number", value=F(1, 2))))
    found = plain({((x, n),): F(5)}, domain())
    assert value(found, {}) == pytest.approx(5 * 1.5 ** (n / 2))
    assert all(0 <= k <= 1 for m in found for _, k in m)


@pytest.mark.parametrize("n", [-3, -1, 1, 2, 3, 4])
def test_the_slope_of_powers_of_a_root(n: int) -> None:
    form = total(times(power(n), poly(1, -2, 3)), poly(0, 5))
    step, d = 1e-6, 0.7
    rate = (value(form, {RAY: d + step}) - value(form, {RAY: d - step})) / (2 * step)
    assert value(slope_along(form, domain()), {RAY: d}) == pytest.approx(rate, rel=1e-6)


def test_higher_powers_of_a_root_are_lowered() -> None:
    assert plain(power(3), domain()) == times(ROOT, poly(2, 0, 1))
    assert plain(power(-3), domain()) == power(-3)
    assert signs().split(total(power(-3), poly(1))) == (total(poly(1), times(ROOT, poly(2, 0, 1))), {W: -3})


SIGNED = [
    (total(ROOT, poly(0, 1)), True, True),
    (total(ROOT, poly(0, -1)), True, True),  # sqrt(2 + d^2) > d
    (total(ROOT, poly(0, -2)), False, False),
    (total(ROOT, negated(sqrt({(): F(2)}))), True, False),  # 0 at d = 0
    (total(ROOT, poly(F(-141421, 100000))), True, True),
    (total(ROOT, poly(F(-141422, 100000))), False, False),
    (total(negated(ROOT), poly(2, 1)), True, True),
    (total(negated(ROOT), poly(1, 1)), False, False),
    (total(power(-1), poly(F(-48, 100))), True, True),  # 1/sqrt(17/4) = 0.485...
    (total(power(-1), poly(F(-49, 100))), False, False),
    (total(times(ROOT, poly(-1, 1)), poly(2)), True, True),
    (negated(power(2)), False, False),
    ({}, True, False),
    (power(1), True, True),
    (times(power(1), poly(0, 1)), True, False),
]


@pytest.mark.slow
@pytest.mark.parametrize(("form", "above", "strict"), SIGNED)
def test_signs_in_the_sector(form: Polynomial, above: bool, strict: bool) -> None:
    least = min(value(form, {RAY: 1.5 * k / 300}) for k in range(301))
    assert (least >= -1e-12) is above and (least > 1e-12) is strict
    assert (signs().above(form), signs().above(form, strict=True)) == (above, strict)


def test_a_root_that_may_be_zero_makes_nothing_positive() -> None:
    edge = sqrt(total(poly(-1, x=E), poly(0, 2, x=E)))  # sqrt(2 e - 1), 0 at e = 1/2
    assert signs().above(edge) and not signs().above(edge, strict=True)
    assert signs().above(total(edge, poly(1)), strict=True)
    assert signs().above(total(edge, total(poly(1), poly(0, -1, x=E))), strict=True)  # 1 - e is not 0 there
    assert not signs().above(total(edge, total(poly(F(1, 2)), poly(0, -1, x=E))), strict=True)


@pytest.mark.parametrize(("low", "high", "sign"), [("1/2", "1", 1), ("0", "1/2", -1), ("0", "1", 0)])
def test_the_root_of_a_square_at_a_wall(low: str, high: str, sign: int) -> None:
    """sqrt(6 (2 e - 1)^2 + (d - 3/2)) at d = 3/2."""
    square = total(poly(6, -24, 24, x=E), poly(F(-3, 2), 1))
    found = signs(low, high).at(sqrt(square), FAR)
    expected = times(sqrt({(): F(24)}), poly(F(-1, 2), 1, x=E))
    if sign:
        assert found == plain(expected if sign > 0 else negated(expected), domain())
    else:
        assert [x.op for m in found for x, _ in m] == ["**"] and roots_in(found)


def test_a_root_that_divides_multiplies_the_rest_at_a_wall() -> None:
    assert signs().at(total(power(-1), poly(0, 1)), F(0)) == poly(1)
    far = signs().at(total(power(-1), poly(0, 1)), FAR)  # 1/w + d, times w
    assert value(far, {}) == pytest.approx(1 + 1.5 * math.sqrt(4.25))


@pytest.mark.parametrize(
    ("one", "two", "same"),
    [
        ("abs(a - b)**3", "abs(b - a)**3", True),
        ("(a - b)**4", "(b - a)**4", True),
        ("(a - b)**3", "(b - a)**3", False),
        ("(a - b)**2", "a**2 - 2*a*b + b**2", True),
        ("(a + b)**40 + a", "a + (-b - a)**40", True),  # too long to be multiplied out
        ("(a + b)**40", "(a - b)**40", False),
        ("max(a, b, 0)", "max(0, b, a)", True),
        ("max(a, b)", "min(b, a)", False),
        ("norm(a, -b)", "norm(b, a)", True),
        ("exp(a)", "exp(-a)", False),
    ],
)
def test_formulas_that_are_alike(one: str, two: str, same: bool) -> None:
    assert alike(parse(one), parse(two), domain()) is same


def test_signs_over_many_constants_come_to_an_end(monkeypatch: pytest.MonkeyPatch) -> None:
    names = [poly(0, 1, x=Term("name", name=n)) for n in ("m", "e", "q", "p", "k")]
    form = total(*(times(x, times(y, {((RAY, i),): F(1)} if i else {(): F(1)})) for i, (x, y) in enumerate(combinations(names, 2))))
    over = small_laws.domain()
    assert not nonnegative(form, (F(0), F(1)), over)
    monkeypatch.setattr("duhem.proof.kernel.signs._MOST_SHARES", 25)
    with pytest.raises(NotWritten, match="too much"):
        nonnegative(form, (F(0), F(1)), over)
