"""What the kernel reads off a formula, exactly: identities, forms, multiples of loads, waves of an angle, degrees."""

from __future__ import annotations

from fractions import Fraction

import pytest

from duhem.proof.kernel.constant_value import BITS
from duhem.proof.kernel.forms import affine, determinant, multiple, quadratic
from duhem.proof.kernel.homogeneity import grows_along_rays, potential_flows_outward
from duhem.proof.kernel.identity import multiplied_out, signs_as_sizes, value, vanishes
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.stated_law import without_angles
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from tests.proof.small_laws import domain, poly

F = Fraction
UNIT = 1 << BITS


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


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("a*sign(a)", "abs(a)"),
        ("sign(a + b)*a + m*sign(a + b)*a + b*sign(a + b)*(1 + m) + a", "(1 + m)*abs(a + b) + a"),
        ("(b - a/3)*sign(a - 3*b)", "-abs(a - 3*b)/3"),
        ("a*sign(a)*sign(b)", "abs(a)*sign(b)"),  # of which no sign of b is left
    ],
)
def test_a_sign_times_its_argument_is_a_size(text: str, same: str) -> None:
    assert vanishes(signs_as_sizes(parse(f"{text} - ({same})"), domain()), domain())


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("sign(a)**2", "1"),  # 0 at a = 0
        ("a*sign(a)**2", "a"),  # true, and not what is shown
        ("1/sign(a)", "sign(a)"),
        ("sign(a)/a", "1/abs(a)"),  # two poles are no identity of sizes
        ("a*sign(b)", "abs(a)"),
        ("(a + b)*sign(a) ", "abs(a) + b"),
        ("a*sign(a) + sign(a)", "abs(a)"),
    ],
)
def test_a_sign_beside_another_factor_stays(text: str, other: str) -> None:
    assert not vanishes(signs_as_sizes(parse(f"{text} - ({other})"), domain()), domain())


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
        determinant([[number(x) for x in row] for row in numbers], here) == poly("161")
        and determinant([], here) == poly("1")
        and determinant([[parse("m")]], here) == poly("m")
    )


def test_multiples_of_loads() -> None:
    here = domain()
    for rest, x, share in (
        ("2*a - 2*b", "a - b", "2"), ("m*a - m*b", "a - b", "m"), ("a - b", "m*a - m*b", "1/m"), ("0", "a", "0"), ("q*a", "k*a", "q/k"),
        ("a + b", "a - b", None), ("a", "e*a", None), ("a", "q*a + b", None), ("a + 1", "a", None), ("b", "a", None), ("a*b", "a", None),
    ):  # fmt: skip
        found = multiple(poly(rest), poly(x), here)
        assert found == (None if share is None else poly(share)), (rest, x)


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
        "cos(atan2(b, a)/2 + 1)",
        "cos(atan2(b, a) + atan2(a, b))",
        "cos(2*atan2(b, a) - 2*atan2(b, a))",
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
        ("a**2 + b**2 - 1", True), ("a**2 + b**2 - a", True), ("a**2 + b**2 - a**3", False),
        ("a**2 + b**2 - e", False), ("a**2 - b**2 - 1", True),
        ("norm(a, b) - 1", True), ("1 - norm(a, b)", False),
        ("1 - a**2", False), ("a**3 + b - 1", False), ("a**4 + b**2 - 1", True), ("abs(a)**m + abs(b)**m - 1", True),
        ("max(a, -b) - m", True), ("max(a, b**2) - m", False),
        ("pos(a) + neg(b) - m", True), ("a*abs(b) - s**2", True), ("(a**2 + b**2)**(3/2) - m", True), ("a**2/norm(a, b) - m", True),
        ("exp(a) - 1", False),
        ("m*a**2 + m*b**2 - m", True), ("a**2 + 1", False), ("eigmax(a, b, 0, a, 0, b) - 1", True), ("a**2 + b**4 + a - 1", True),
        ("a**2 + b**2", False), ("(a**2 + b**2)**2 - a**2", False), ("abs(a)**s + abs(b)**s - 1", False),
    ],
)  # fmt: skip
def test_degrees_along_rays(g: str, grows: bool) -> None:
    try:
        found = grows_along_rays(parse(g), domain(), steep=True)
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
        ("norm(a, b)", "exp(a) - 1", "0", True), ("norm(a, b)", "where(a > 0, 1, -1)", "0", False),
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
