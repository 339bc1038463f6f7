"""The kernel's polynomials, exactly: sums and products, signs on a line, on intervals and over parameters."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from random import Random

import pytest

from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, replaced, slope, times, total, written
from duhem.proof.kernel.polynomial import joined as monomial_product
from duhem.proof.kernel.signs import (
    RAY,
    Line,
    divides,
    line,
    nonnegative_on_the_line,
    parts,
    roots,
    roots_of_both,
    sign_inside,
    without_content,
)
from duhem.proof.kernel.signs import nonnegative as nonnegative_over
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten, parse
from tests.proof.small_laws import domain, poly

F = Fraction


def test_polynomials() -> None:
    a, b = parse("a"), parse("b")
    assert total(poly("a + b"), poly("a - b"), {}) == {((a, 1),): F(2)} and total() == {}
    assert times(poly("a + b"), poly("a - b")) == poly("a**2 - b**2") and times(poly("a"), {}) == {}
    assert monomial_product(((b, 1),), ((a, 2), (b, -1))) == ((a, 2),) and monomial_product(((b, 1),), ((a, 1),)) == ((a, 1), (b, 1))
    assert replaced(poly("a**2*b + a + b"), a, poly("b - 1")) == poly("(b - 1)**2*b + 2*b - 1")
    assert slope(poly("a**3*b + 2*a + b + 5"), a) == poly("3*a**2*b + 2") and slope(poly("1/m"), parse("m")) == poly("-1/m**2")
    assert in_powers(poly("a**2*b - 3*a**2 + b + 1"), a) == [poly("b + 1"), {}, poly("b - 3")] and in_powers({}, a) == [{}]
    assert domain().polynomial(written(poly("a**2/3 - b + 1/m"))) == poly("a**2/3 - b + 1/m") and poly("1") == ONE
    assert poly("a**12") == {((a, 12),): F(1)} and len(poly("(a + b)**12")) == 13 and len(poly("(a + b)**13")) == 1
    assert poly("m**-12") == {((parse("m"), -12),): F(1)} and poly("(m + 1)**-1") != poly("m + 1")
    assert domain().polynomial(parse("1**-99")) == ONE
    for too_long in ({(): F(2**9000)}, {(): F(1, 2**9000)}):
        with pytest.raises(NotWritten):
            times(ONE, too_long)
    assert times(ONE, {(): F(2**8000)}) == {(): F(2**8000)}
    with pytest.raises(NotWritten):
        times(poly("(a + b + 1)**12"), times(poly("(a - b + 2)**12"), poly("(a + 2*b + 3)**12")))


def line_of(*zeros: F | int, scale: int = 1) -> Line:
    found = [F(scale)]
    for zero in zeros:
        shifted = [F(0), *found]
        found = [s - F(zero) * c for s, c in zip(shifted, [*found, F(0)], strict=True)]
    return line(found)


def test_lines() -> None:
    assert line([F(1, 2), F(1, 3), F(0)]) == (3, 2) and line([F(0)]) == () and line([F(-4), F(6)]) == (-2, 3)
    p = line_of(1, 1, -2, -2, -2, 3)
    every, odd = parts(p)
    assert {every, tuple(-c for c in every)} & {line_of(1, -2, 3)} and {odd, tuple(-c for c in odd)} & {line_of(-2, 3)}
    assert parts(line_of(1, 1, 1, 1))[1] in ((1,), (-1,)) and parts(line_of(2)) == (line_of(2), line_of(2))
    assert divides(line_of(1, 3), p) and not divides(line_of(1, 3, 4), p) and not divides(line_of(1, 1, 1), p)
    both = roots_of_both(line_of(1, 2), line_of(2, 3))
    assert {both, tuple(-c for c in both)} & {line_of(1, 2, 3)}
    assert sign_inside(p, F(-3), F(-2)) == 1 and sign_inside(p, F(-2), F(1)) == -1 and sign_inside(p, F(1), F(3)) == -1
    assert sign_inside(line_of(F(1, 2)), F(0), F(1)) in (-1, 1) and sign_inside((-1,), F(0), F(1)) == -1


@pytest.mark.parametrize(
    ("p", "low", "high", "weakly", "strictly"),
    [
        ((), 0, 1, True, False), ((1,), 0, 1, True, True), ((-1,), 0, 1, False, False), (line_of(0), 0, 1, True, False),
        (line_of(0), 1, 1, True, True),
        (line_of(0), 0, 0, True, False), (line_of(0), -1, -1, False, False), (line_of(1), 0, 1, False, False),
        (line_of(1, scale=-1), 0, 1, True, False),
        (line_of(1, 1), 0, 2, True, False), (line_of(1, 1), 2, 3, True, True), (line_of(1, 1, scale=-1), 0, 2, False, False),
        (line_of(1, 1), -1, 1, True, False), (line_of(0, 1), 1, 2, True, False), (line_of(0, 1), F(3, 2), 2, True, True),
        (line_of(0, 1), 0, 1, False, False),
        (line_of(0, 1, scale=-1), 0, 1, True, False), (line_of(1, 1, 1), 0, 2, False, False), (line_of(1, 1, 1), 1, 2, True, False),
        (line_of(1, 1, 1), F(11, 10), 2, True, True), (line_of(1, 1, -2, -2, -2, 3), -3, -2, True, False),
        (line_of(1, 1, -2, -2, -2, 3, scale=-1), -2, 3, True, False),
        (line_of(1, 1, -2, -2, -2, 3), 3, 4, True, False), (line_of(1, 1, -2, -2, -2, 3), 2, 4, False, False),
        (line([F(1), F(0), F(1)]), -5, 5, True, True),
        (line([F(-2), F(0), F(1)]), F(3, 2), 2, True, True), (line([F(-2), F(0), F(1)]), F(7, 5), 2, False, False),
    ],
)  # fmt: skip
def test_signs_of_a_line(p: Line, low: F, high: F, weakly: bool, strictly: bool) -> None:
    assert nonnegative_on_the_line(p, F(low), F(high)) is weakly
    assert nonnegative_on_the_line(p, F(low), F(high), True) is strictly


def test_roots_are_enclosed_in_order() -> None:
    p = line([F(c) for c in (0, 2, 0, -3, 0, 1)])  # x (x^2 - 1)(x^2 - 2)
    found = list(roots(p, F(-2), F(2)))
    assert [a for a, b in found if a == b] == [-1, 0, 1] and len(found) == 5 and all(one[1] < two[0] for one, two in pairwise(found))
    for a, b in (found[0], found[4]):
        assert min(abs(a), abs(b)) ** 2 < 2 < max(abs(a), abs(b)) ** 2 and 0 < b - a <= F(1, 2**30)
    assert list(roots(p, F(-1), F(1))) == [(0, 0)] and list(roots(p, F(0), F(1))) == [] and list(roots(line_of(5), F(0), F(1))) == []
    assert list(roots(line_of(F(1, 2)), F(0), F(1))) == [(F(1, 2), F(1, 2))]


@pytest.mark.parametrize(
    ("text", "weakly", "strictly"),
    [
        ("t", True, False), ("1 + t", True, True), ("t - 1/2", False, False), ("m*t", True, False), ("m*(1 + t)", True, True),
        ("k*t", False, False),
        ("-k*t", True, False), ("k**2*(1 + t)", True, True), ("k**3*(1 + t)", False, False), ("-k**3*(1 + t)", True, True),
        ("m + t", True, True),
        ("e + t", True, False), ("e - t", False, False), ("1 - e - t/2", True, False), ("1 - e*t", True, True), ("1 - 2*e*t", True, False),
        ("1 - 2.001*e*t", False, False), ("1 + q*t", True, False), ("1 - q*t", True, False), ("1 + q*t/2", True, True),
        ("1.001 - q", True, True),
        ("p - t", True, False), ("p - 1", True, False), ("4 - p*t", True, False), ("4.1 - p", True, True), ("w - t", True, False),
        ("w*(2 - t)", True, True),
        ("w - 1 + t", True, False), ("-v - t", True, False), ("v + t", False, False), ("-v*(1 + t)", True, True),
        ("1 + v*t", False, False), ("u*t", False, False),
        ("u**2*t", True, False), ("u**2 + t", True, False), ("u**2 + 1 - t/2", True, True), ("u**2 - 2*u*t + t**2", False, False),
        ("u**2 + u*t + 1", False, False),
        ("2 - h*t", True, False), ("2 - h", True, False), ("2.01 - h", True, True), ("h*(1 + t)", True, True), ("h - t", False, False),
        ("(2 - h)*t + h", True, True),
        ("m*e + t", True, False), ("m*p - e*t*m", True, True), ("m*p - 2.1*e*t*m*p", False, False), ("t/m", True, False),
        ("(1 + t)/k", False, False),
        ("-(1 + t)/k", True, True), ("(1 + t)/k**2", True, True), ("m*q + m", True, False), ("q + 1 + m*t", True, False),
        ("-s - s*t", True, True), ("s*t", False, False),
        ("s**2 + s*t", False, False), ("s**2 - s*t + t**2", True, True),
    ],
)  # fmt: skip
def test_signs_over_parameters(text: str, weakly: bool, strictly: bool) -> None:
    """The variable runs from 0 to 1, the parameters where they may."""
    along = {tuple((RAY if x.name == "t" else x, n) for x, n in m): c for m, c in _with_ray(text).items()}
    for way, expected in ((False, weakly), (True, strictly)):
        assert nonnegative_over(along, (F(0), F(1)), domain(), way) is expected


def _with_ray(text: str) -> Polynomial:
    return domain().polynomial(parse(text).put({parse("t"): RAY}))


@pytest.mark.parametrize(
    ("constraint", "text", "weakly", "strictly"),
    [
        ("m > h", "m - h", True, True), ("m >= h", "m - h", True, False), ("m > h", "h - m", False, False),
        ("m > h", "2*m - h", True, True),
        ("m > h", "m - 2*h", False, False), ("u > m*p", "u - m", True, True), ("u >= m*p", "u - m", True, False),
        ("u >= m*p", "u", True, True),
        ("u > m", "k*(m - u)", True, True), ("u > m", "k*(u - m)", False, False), ("u > m", "q*(u - m)", False, False),
        ("u > m", "u**2 - m*u", True, True),
        ("u > m", "p*u - m", True, True), ("u > m", "u - m*p", False, False), ("u > m", "u - m - e", False, False),
        ("u - m > e", "u - m", True, True),
        ("u > q", "m*u - m*q + e", True, True), ("u >= q", "m*u - m*q + h", True, True), ("u <= q", "1 - u", True, False),
        ("u < q", "1 - u", True, True),
        ("u + q > 3", "u - 2", True, True), ("q*m > h", "q", True, True), ("e*m > h", "e", True, True),
        ("u**2 < 4", "4 - u**2", True, True),
        ("u**2 <= 4", "u + 2", True, False), ("m*u > h*q", "m**2*u - m*h*q", True, True), ("u > v", "(u - v)/m", True, True),
        ("u > v", "(u - v)/q", False, False),
    ],
)  # fmt: skip
def test_signs_by_a_constraint(constraint: str, text: str, weakly: bool, strictly: bool) -> None:
    here = domain(constraint)
    assert here.nonnegative(parse(text)) is weakly
    assert here.nonnegative(parse(text), strict=True) is strictly


@pytest.mark.parametrize("text", ["t/q", "t/e", "t/u"])
def test_nothing_is_divided_by_what_may_be_zero(text: str) -> None:
    with pytest.raises(NotWritten):
        nonnegative_over(_with_ray(text), (F(0), F(1)), domain())
    assert without_content(_with_ray("m**2*k*t + m*k"), domain()) == _with_ray("-m*t - 1")


def test_long_remainders_are_paid_for() -> None:
    """Remainders of a polynomial with coefficients of a thousand digits would take seconds; a short one takes next to no steps."""
    rng = Random(1)
    long = line(F(rng.getrandbits(3000) + 1) for _ in range(30))
    with pytest.raises(TooDearError), within(10_000):
        nonnegative_on_the_line(long, F(0), F(1))
    with within(1_000):
        assert nonnegative_on_the_line(line(map(F, (1, -2, 2))), F(0), F(1), True)
