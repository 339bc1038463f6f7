"""The kernel's algebra, exactly: polynomials, signs on intervals and over parameters, enclosures, identities, forms, degrees."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest

from duhem.proof.kernel.angle import without_angles
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.curve import _power as raised
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain, StatedLaw
from duhem.proof.kernel.elementary import _greater, _halved, _over, _shifted, _size, _times_whole, _whole_power
from duhem.proof.kernel.forms import affine, determinant, quadratic
from duhem.proof.kernel.homogeneity import grows_along_rays, potential_flows_outward
from duhem.proof.kernel.identity import multiplied_out, value, vanishes
from duhem.proof.kernel.interval import BITS, AngleJet, Enclosure
from duhem.proof.kernel.line import Line, divides, joined, line, nonnegative, parts, roots, sign_inside
from duhem.proof.kernel.loads import multiple
from duhem.proof.kernel.packed import Packing, is_zero_sum, product, quadratic_form
from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, replaced, slope, times, total, written
from duhem.proof.kernel.polynomial import joined as monomial_product
from duhem.proof.kernel.positivity import RAY, without_content
from duhem.proof.kernel.positivity import nonnegative as nonnegative_over
from duhem.proof.kernel.term import NotWritten, Term, number, parse

F = Fraction
UNIT = 1 << BITS
PARAMETERS = {
    "m": {"positive": True}, "e": {"min": "0", "max": "1/2"}, "q": {"min": "-1", "max": "1"}, "p": {"min": "1", "max": "4"},
    "k": {"min": "-2", "max": "-1/2"}, "u": {}, "w": {"min": "1"}, "v": {"max": "-1"}, "h": {"positive": True, "max": "2"},
}  # fmt: skip


def domain(*constraints: str) -> StatedDomain:
    given: dict[str, Any] = {"forces": ("a", "b"), "pressure": "s", "parameters": PARAMETERS, "constraints": list(constraints)}
    return over(StatedLaw.read({**given, "g": "a", "flow": None}))


def poly(text: str) -> Polynomial:
    return domain().polynomial(parse(text))


# -- polynomials -------------------------------------------------------------------------------------------------------


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
    assert poly("m**-12") == {((parse("m"), -12),): F(1)} and poly("(m + 1)**-1") != poly("m + 1") and poly("1**-99") == ONE
    for too_long in ({(): F(2**9000)}, {(): F(1, 2**9000)}):
        with pytest.raises(NotWritten):
            times(ONE, too_long)
    assert times(ONE, {(): F(2**8000)}) == {(): F(2**8000)}
    with pytest.raises(NotWritten):
        times(poly("(a + b + 1)**12"), times(poly("(a - b + 2)**12"), poly("(a + 2*b + 3)**12")))


# -- on a line: (x - 1)^2 (x + 2)^3 (x - 3), its parts and signs --------------------------------------------------------------


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
    both = joined(line_of(1, 2), line_of(2, 3))
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
    assert nonnegative(p, F(low), F(high)) is weakly
    assert nonnegative(p, F(low), F(high), True) is strictly


def test_roots_are_enclosed_in_order() -> None:
    p = line([F(c) for c in (0, 2, 0, -3, 0, 1)])  # x (x^2 - 1)(x^2 - 2)
    found = list(roots(p, F(-2), F(2)))
    assert [a for a, b in found if a == b] == [-1, 0, 1] and len(found) == 5 and all(one[1] < two[0] for one, two in pairwise(found))
    for a, b in (found[0], found[4]):
        assert min(abs(a), abs(b)) ** 2 < 2 < max(abs(a), abs(b)) ** 2 and 0 < b - a <= F(1, 2**30)
    assert list(roots(p, F(-1), F(1))) == [(0, 0)] and list(roots(p, F(0), F(1))) == [] and list(roots(line_of(5), F(0), F(1))) == []
    assert list(roots(line_of(F(1, 2)), F(0), F(1))) == [(F(1, 2), F(1, 2))]


# -- on an interval, over parameters -----------------------------------------------------------------------------------


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


# -- enclosures --------------------------------------------------------------------------------------------------------


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
        _greater(Enclosure(-1, 5), Enclosure(0, 3)) == (0, 5) and _size(Enclosure(-5, 2)) == (0, 5) and _size(Enclosure(-5, -2)) == (2, 5)
    )
    assert (
        _shifted(Enclosure(1, 2), 3) == (1 + 3 * UNIT, 2 + 3 * UNIT)
        and _over(Enclosure(-1, 1), 3) == (-1, 1)
        and _over(Enclosure(7, 7), 2) == (3, 4)
    )
    assert _times_whole(Enclosure(1, 2), -3) == (-6, -3) and _times_whole(Enclosure(1, 2), 3) == (3, 6)
    two, spread = Enclosure(2 * UNIT, 2 * UNIT), Enclosure(-3 * UNIT, 2 * UNIT)
    assert (
        _whole_power(two, 3) == (8 * UNIT, 8 * UNIT)
        and _whole_power(two, -2) == (UNIT // 4, UNIT // 4)
        and _whole_power(two, 0) == (UNIT, UNIT)
    )
    assert (
        _whole_power(spread, 2) == (0, 9 * UNIT)
        and _whole_power(spread, 3) == (-27 * UNIT, 18 * UNIT)
        and _whole_power(two, 64).low == 2**64 * UNIT
    )
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
    with pytest.raises(ValueError, match="too high"):
        _whole_power(two, 65)


def test_jets_follow_the_rules_of_derivatives() -> None:
    def jet(*values: F | int) -> AngleJet:
        return AngleJet(*(Enclosure.between(F(v), F(v)) for v in values))

    def near(found: AngleJet, *values: F) -> bool:
        return all(abs(end - v * UNIT) <= 64 for part, v in zip(found, values, strict=True) for end in part)

    f, g = jet(4, 2, 3), jet(-1, 5, 7)
    assert f.plus(g) == jet(3, 7, 10) and f.times(g) == jet(-4, 18, 45)
    assert near(f.inverse(), F(1, 4), F(-1, 8), F(-1, 16)) and near(g.inverse(), F(-1), F(-5), F(-57))
    assert near(f.root(), F(2), F(1, 2), F(5, 8))
    with pytest.raises(ZeroDivisionError):
        jet(0, 1, 1).inverse()
    for exponent, power in (
        (F(0), (1, 0, 0)), (F(1), (4, 2, 3)), (F(2), (16, 16, 32)), (F(1, 2), (2, F(1, 2), F(5, 8))), (F(3, 2), (8, 6, F(21, 2))),
        (F(-1), (F(1, 4), F(-1, 8), F(-1, 16))), (F(-1, 2), (F(1, 2), F(-1, 8), F(-3, 32))), (F(-2), (F(1, 16), F(-1, 16), 0)),
    ):  # fmt: skip
        assert near(raised(f, exponent), *map(F, power)), exponent
    for exponent in (F(1, 3), F(13), F(-13), F(25, 2)):
        with pytest.raises(NotWritten):
            raised(f, exponent)
    assert near(raised(jet(1, 0, 0), F(12)), F(1), F(0), F(0))


# -- identities and forms ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "(a + b)**2 - a**2 - 2*a*b - b**2", "norm(a, b)**2 - a**2 - b**2", "abs(a)**2 - a**2", "abs(a)**3 - a**2*abs(a)", "sqrt(m)**2 - m",
        "(m**2)**(1/2) - m",
        "(k**2)**(1/2) + k", "(k**4)**(1/4) + k", "(m**3)**(1/3) - m", "(m**(1/2))**4 - m**2", "1/m + 1/p - (m + p)/(m*p)",
        "norm(a, b)/norm(a, b)**2 - 1/norm(a, b)",
        "1/norm(a, b) - norm(a, b)/(a**2 + b**2)", "m**(2/3)*m**(1/3) - m", "m**(-1/2) - 1/sqrt(m)", "m**(5/2) - m**2*sqrt(m)",
        "1/(1 + m) - 1 + m/(1 + m)",
        "(1 + m)**(-1/2)*(1 + m) - sqrt(1 + m)", "norm(a)**2 - a*a", "(m**(1/3))**2*(m**2)**(2/3) - m**2", "a*abs(a)**-1 - abs(a)/a",
        "sqrt(a**2)**2 - a**2",
        "abs(q)**4 - q**4", "norm(3, 4)**2 - 25", "0*a",
    ],
)  # fmt: skip
def test_what_vanishes(text: str) -> None:
    assert vanishes(parse(text), domain())
    assert not vanishes(parse(f"{text} + 1/10**9"), domain()) and not vanishes(parse(f"{text} + a/10**9"), domain())


@pytest.mark.parametrize(
    "text",
    [
        "(q**2)**(1/2) - q",
        "abs(a)**3 - a**3",
        "norm(a, b) - a - b",
        "sqrt(m) - m",
        "m**(1/2) - m**(1/3)",
        "(q**3)**(1/3) + q",
        "(k**3)**(1/3) + k",
    ],
)
def test_what_does_not_vanish(text: str) -> None:
    assert not vanishes(parse(text), domain())


def test_values() -> None:
    here = domain()
    assert value(parse("2*3 + 1/2"), here) == F(13, 2) and value(parse("m - m"), here) == 0 and value(parse("m"), here) is None
    assert multiplied_out(parse("(a + 1)*(a - 1)"), here) == written(poly("a**2 - 1"))


def test_forms_are_read_off() -> None:
    here = domain()

    def same(term: Term, text: str) -> bool:
        return here.polynomial(term) == poly(text)

    row, offset = affine(parse("m*a - (2*b - 3) + a"), ("a", "b"), here)
    assert same(row[0], "m + 1") and same(row[1], "-2") and same(offset, "3")
    matrix, slant, level = quadratic(parse("3*a**2 + m*a*b - b**2 + 5*a - k*b + 7"), ("a", "b"), here)
    assert [[same(x, y) for x, y in zip(*rows, strict=True)] for rows in zip(matrix, [["3", "m/2"], ["m/2", "-1"]], strict=True)] == [
        [True] * 2
    ] * 2
    assert same(slant[0], "5") and same(slant[1], "-k") and same(level, "7")
    for text in ("a**2", "a*b", "abs(a)", "a**3 - a"):
        with pytest.raises(NotWritten):
            affine(parse(text), ("a", "b"), here)
    for text in ("a**3", "a**2*b", "abs(a)", "a**2*b**2 - a*b", "a**4 - a**2"):
        with pytest.raises(NotWritten):
            quadratic(parse(text), ("a", "b"), here)
    numbers = [[2, 7, 1], [3, -1, 4], [5, 6, -2]]
    assert (
        same(determinant([[number(x) for x in row] for row in numbers]), "161")
        and same(determinant([]), "1")
        and same(determinant([[parse("m")]]), "m")
    )


def test_multiples_of_loads() -> None:
    here = domain()
    for rest, x, share in (
        ("2*a - 2*b", "a - b", "2"), ("m*a - m*b", "a - b", "m"), ("a - b", "m*a - m*b", "1/m"), ("0", "a", "0"), ("q*a", "k*a", "q/k"),
        ("a + b", "a - b", None), ("a", "e*a", None), ("a", "q*a + b", None), ("a + 1", "a", None), ("b", "a", None), ("a*b", "a", None),
    ):  # fmt: skip
        found = multiple(poly(rest), poly(x), here)
        assert found == (None if share is None else poly(share)), (rest, x)


def test_packed_products() -> None:
    packing = Packing()
    a, b, half = (packing.of(poly(text)) for text in ("a - b/3", "a + b/2", "1/2"))
    assert product([]).terms == {0: 1} and product([half, half]).below == 4 and (a.below, b.below) == (3, 2)
    assert is_zero_sum([product([a, b]), packing.of(poly("-(a - b/3)*(a + b/2)"))]) and is_zero_sum([]) and not is_zero_sum([half])
    form = quadratic_form([a, b], [[F(2), F(1, 5)], [F(1, 5), F(3)]])
    assert is_zero_sum([form, packing.of(poly("-2*(a - b/3)**2 - 2/5*(a - b/3)*(a + b/2) - 3*(a + b/2)**2"))])
    assert packing.of(poly("a**2*(a + b)"))  # exponents up to 2^12
    with pytest.raises(NotWritten):
        packing.of({((parse("a"), -4097),): F(1)})
    assert packing.of({((parse("a"), -4096),): F(1)}).below == 1
    for ragged in ([[F(1)]], [[F(1)], [F(1)]], [[F(1)] * 2, [F(1)] * 3], [[F(1)] * 2] * 3):
        with pytest.raises(ValueError, match="zip"):
            quadratic_form([a, b], ragged)
    for too_long in ([[F(2**70000)]], [[F(1, 2**70000)]]):
        with pytest.raises(NotWritten):
            product([quadratic_form([half], too_long), half])


# -- waves and degrees -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "upper"),
    [
        ("cos(atan2(b, a))", "a"), ("sin(atan2(b, a))", "b"), ("cos(2*atan2(b, a))", "a**2 - b**2"), ("sin(2*atan2(b, a))", "2*a*b"),
        ("cos(3*atan2(b, a))", "a**3 - 3*a*b**2"), ("sin(3*atan2(b, a))", "3*a**2*b - b**3"), ("sin(-3*atan2(b, a))", "b**3 - 3*a**2*b"),
        ("cos(-2*atan2(b, a))", "a**2 - b**2"), ("cos(2*(2*atan2(b, a)))", "a**4 - 6*a**2*b**2 + b**4"), ("sin(-atan2(a, 2*b))", "-a"),
    ],
)  # fmt: skip
def test_waves_of_an_angle(text: str, upper: str) -> None:
    found = without_angles(parse(text))
    (wave, over_norm) = found.args[1:]
    assert domain().polynomial(wave) == poly(upper) and over_norm.op == "**" and over_norm.args[0].op == "norm"
    assert over_norm.args[1] == number(-max(sum(n for _, n in m) for m in poly(upper)))


@pytest.mark.parametrize(
    "text",
    [
        "cos(25*atan2(b, a))",
        "cos(atan2(b, a)*atan2(b, a))",
        "cos(2*atan2(b, a) + 1)",
        "exp(2*atan2(b, a))",
        "cos(1.5*atan2(b, a))",
        "cos(2)",
    ],
)
def test_other_waves_stay(text: str) -> None:
    assert without_angles(parse(text)) == parse(text)
    assert without_angles(parse("cos(24*atan2(b, a))")) != parse("cos(24*atan2(b, a))")


@pytest.mark.parametrize(
    ("g", "grows"),
    [
        ("a**2 + b**2 - 1", True), ("a**2 + b**2 - a", False), ("a**2 + b**2 - e", False), ("a**2 - b**2 - 1", True),
        ("norm(a, b) - 1", True), ("1 - norm(a, b)", False),
        ("1 - a**2", False), ("a**3 + b - 1", False), ("a**4 + b**2 - 1", True), ("abs(a)**m + abs(b)**m - 1", False),
        ("max(a, -b) - m", True), ("max(a, b**2) - m", False),
        ("pos(a) + neg(b) - m", True), ("a*abs(b) - s**2", True), ("(a**2 + b**2)**(3/2) - m", True), ("a**2/norm(a, b) - m", True),
        ("exp(a) - 1", False),
        ("m*a**2 + m*b**2 - m", True), ("a**2 + 1", False), ("eigmax(a, b, 0, a, 0, b) - 1", True), ("a**2 + b**4 + a - 1", True),
        ("a**2 + b**2", False),
    ],
)  # fmt: skip
def test_degrees_along_rays(g: str, grows: bool) -> None:
    try:
        found = grows_along_rays(parse(g), domain())
    except (NotWritten, ValueError):  # not of one degree
        found = False
    assert found is grows


@pytest.mark.parametrize(
    ("potential", "g", "share", "outward"),
    [
        ("norm(a, b)", "norm(a, b) - 1", "0", True), ("norm(a, b)", "norm(a, b) - 1", "1", True),
        ("norm(a, b)", "norm(a, b) - 1", "2", False),
        ("-norm(a, b)", "norm(a, b) - 1", "0", False), ("a", "a - 1", "1", True), ("a", "a - 1", "0", False), ("a", "a - e", "1", True),
        ("a", "a + 1", "1", False),
        ("a**2 - b**2", "a**2 - b**2 - m", "2", True), ("a**2 - b**2", "a**2 - b**2 - m", "1", False),
        ("a**2/2 + b", "a**2 + b - 1", "1", True),
        ("a*b", "a*b - m", "2", True), ("a*b", "a*b - q", "2", False), ("exp(a)", "a - 1", "0", None),
        ("norm(a, b)", "exp(a) - 1", "0", None),
        ("norm(a, b)", "norm(a, b) - 1", "a", False), ("norm(a, b)/e", "norm(a, b) - 1", "0", False),
        ("norm(a, b)", "norm(a, b) - 1", "0/e", False),
    ],
)  # fmt: skip
def test_potentials_flow_outward(potential: str, g: str, share: str, outward: bool | None) -> None:
    if outward is None:
        with pytest.raises(NotWritten):
            potential_flows_outward(parse(potential), parse(g), parse(share), domain())
    else:
        assert potential_flows_outward(parse(potential), parse(g), parse(share), domain()) is outward
