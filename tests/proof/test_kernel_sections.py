"""What the kernel shows of functions of J2 and J3, exactly, and the parts it is made of: invariants, and functions of cos 3 theta."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import sign_on_axis
from duhem.proof.kernel.deviatoric import Invariants, convex_in_deviator, deviatoric_readers, invariants
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.plane_function import Base, PlaneFunction, added, base_of, multiplied, plain, power_of, raised_to, widened
from duhem.proof.kernel.polynomial import ONE, Polynomial, slope, times, total
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.long import long_but
from tests.proof.test_kernel_facts import said

F = Fraction
J2, J3 = "(((a-b)**2 + (b-c)**2 + (c-a)**2)/6)", "((2*a-b-c)*(2*b-c-a)*(2*c-a-b)/27)"
PARAMETERS = {
    "m": {"positive": True},
    "e": {"min": "0", "max": "1/2"},
    "q": {"min": "-1", "max": "1"},
    "r": {"min": "7/9", "max": "1"},
}


def domain(g: str, *forces: str) -> tuple[Term, StatedDomain]:
    given: dict[str, Any] = {"pressure": "s", "parameters": PARAMETERS, "constraints": [], "g": g, "flow": None}
    law = StatedLaw.read({"forces": forces, **given})
    return law.g, over(law)


def law(text: str) -> StatedLaw:
    text = text.replace("C3", "(3*sqrt(3)/2*J3/J2**(3/2))").replace("J2", J2).replace("J3", J3)
    given: dict[str, Any] = {"pressure": "s", "parameters": PARAMETERS, "constraints": [], "flow": None}
    return StatedLaw.read({"forces": ("a", "b", "c"), "g": text, **given})


# thresholds: Gudehus' and Argyris' 7/9, 1/8 of a first harmonic, 2/7 under a root, c = 10, 0 <= b <= pi/3
SHOWN = [
    ("J2", ">= convex"), ("J3", ""), ("J2**2", ">= convex"), ("J2*J3", ""), ("J3**2", ""), ("J2**(1/2)", ">= convex"),
    ("J2**(3/2)", ">= convex"), ("J2**(1/3)", ">= quasiconvex"), ("J2**(2/3)", ">= convex"), ("J2**-1", ""), ("sqrt(3*J2)", ">= convex"),
    ("sqrt(J2) + a + b + c", "? convex"), ("sqrt(J2) - a", "? convex"), ("J2**(3/2) + J3", ">= convex"), ("J2**(3/2) - 1.3*J3", ""),
    ("J2**(3/2) + 3/2*sqrt(3)*J3", ""), ("J2**(3/2) + sqrt(3)/2*J3", ">= convex"), ("J2**(3/2) - 2.598*J3", ""),
    ("J2**(3/2) - 2.599*J3", ""), ("J2**3 + 9/4*J3**2", ">= convex"), ("J2**3 - 9/4*J3**2", ">= convex"), ("J2**3 - 2.26*J3**2", ""),
    ("J2**3 + 27/8*J3**2", ">= convex"), ("J2**3 + 3.38*J3**2", ""), ("(J2**3 - 9/4*J3**2)**(1/6)", ">= convex"),
    ("(J2**3 - 2.26*J3**2)**(1/6)", ""), ("(J2**3 - 9/4*J3**2)**(1/3)", ">= convex"), ("(J2**3 - 9/4*J3**2)**(1/12)", ">= quasiconvex"),
    ("(J2**3 - J3**2)**(1/6) + sqrt(J2)", ">= convex"), ("(J2**3 - J3**2)**(1/6) + J2", ">= convex"),
    ("(J2**3 - J3**2)**(1/6) - sqrt(J2)", ""), ("sqrt(J2) - (J2**3 - J3**2)**(1/6)", ""), ("sqrt(J2) - J2", ""),
    ("sqrt(J2)*(1 + C3/8)", ">= convex"), ("sqrt(J2)*(1 - C3/8)", ">= convex"), ("sqrt(J2)*(1 + C3/7.99)", ""), ("sqrt(J2)*(1 + C3)", ""),
    ("sqrt(J2)*(2 - C3)**(1/2)", ""), ("sqrt(J2)*(2 - C3)**(1/4)", ">= convex"), ("sqrt(J2)*(2 - C3)**-1", ""),
    ("sqrt(J2)*(10 - C3)**-1", ">= convex"), ("J2*(1 + C3/8)", ">= convex"), ("J2*(1 + C3/3)", ""), ("J2*(1 + C3/2)", ""),
    ("J2*(1 - C3)", ""), ("J2*(1 - 2*C3)", ""), ("J2*(1 - C3)**(1/2)", ""), ("sqrt(J2)*(2 - C3)**e", ""), ("sqrt(J2)*(9 - C3)**q", ""),
    ("sqrt(J2)*(1 + q*C3/8)", ">= convex"), ("sqrt(J2)*(1 + q*C3/7)", ""), ("sqrt(J2)*(1 + e*C3/4)", ">= convex"),
    ("sqrt(J2)*(1 + r)/(2*r) - (1 - r)/(2*r)*(3*sqrt(3)/2)*J3/J2", ">= convex"), ("sqrt(J2)*m*(2 + C3/5)", ">= convex"),
    ("-sqrt(J2)*m*(2 + C3/5)", ""), ("sqrt(J2)*(sqrt(2) + C3/8)", ">= convex"),
    ("sqrt(J2)*(sqrt(2) + C3/5)", ""), ("sqrt(J2)*(sqrt(4) + C3/8)", ">= convex"),
    ("sqrt(J2)*(sqrt(12) + C3/8)", ">= convex"), ("sqrt(J2)*(sqrt(1/3) + C3/14)", ">= convex"), ("sqrt(J2)*(sqrt(1/3) + C3/13)", ""),
    ("(J2*sqrt(3))**(1/2)", ">= convex"), ("(J2*4)**(1/2)", ">= convex"), ("(J2**2*9)**(1/4)", ">= convex"),
    ("sqrt(J2)*sqrt(3) + sqrt(J2)*C3/5", ">= convex"), ("J2 + J3", ""), ("J2 - J3/sqrt(J2)", ""),
    ("sqrt(J2)*cos(acos(C3)/3)", ">= convex"), ("sqrt(J2)*cos(pi/3 - acos(C3)/3)", ">= convex"),
    ("sqrt(J2)*cos(pi/3 + 0.001 - acos(C3)/3)", ""), ("sqrt(J2)*cos(-0.001 - acos(C3)/3)", ""),
    ("sqrt(J2)*cos(acos(C3)/3 - pi/6)", ">= convex"), ("sqrt(J2)*cos(acos(C3)/3 - pi/6 + q)", ""),
    ("sqrt(J2)*cos(acos(C3)/3 - e)", ">= convex"), ("sqrt(J2)*cos(acos(C3)/3 - 2.1*e)", ""),
    ("sqrt(J2)*cos(acos(-C3)/3 - e)", ">= convex"), ("sqrt(J2)*cos(acos(-C3)/3 - 2.1*e)", ""),
    ("sqrt(J2)*cos(acos(q*C3)/3 - e)", ">= convex"), ("sqrt(J2)*cos(acos(q*C3)/3 - 2.1*e)", ""),
    ("sqrt(J2)*cos(acos(2*q*C3)/3 - e)", ""),
    ("sqrt(J2)*cos(acos(C3)/2 - e)", ""), ("sqrt(J2)*cos(2*acos(C3)/3 - e)", ""), ("sqrt(J2)*cos(acos(C3**2)/3 - e)", ""),
    ("sqrt(J2)*cos(acos(C3 + 1)/3 - e)", ""), ("sqrt(J2)*cos(acos(C3*J2)/3 - e)", ""), ("sqrt(J2)*cos(asin(C3)/3 - e)", ">= convex"),
    ("sqrt(J2)*cos(asin(C3)/3 + 2*e)", ""),
    ("sqrt(J2)*cos(pi/6 + atan(0.9*C3/sqrt(1 - 0.81*C3**2))/3)", ">= convex"),
    ("sqrt(J2)*cos(pi/6 - atan(0.9*C3/sqrt(1 - 0.81*C3**2))/3)", ">= convex"),
    ("sqrt(J2)*cos(pi/6 - atan(0.9*C3/sqrt(1 - 0.8*C3**2))/3)", ""), ("sqrt(J2)*cos(pi/6 - atan(0.9*C3/sqrt(1 - 0.81*C3**2))/2)", ""),
    ("J2*cos(acos(C3)/3 - pi/6)", ">= convex"), ("J2*cos(acos(C3)/3 - pi/6)**4", ""),
    ("sqrt(J2)*m*cos(acos(C3)/3 - pi/6)", ">= convex"), ("sqrt(J2)*q*cos(acos(C3)/3 - pi/6)", ""),
    ("sqrt(J2)*C3*cos(acos(C3)/3 - pi/6)", ""), ("sqrt(J2)*cos(acos(C3)/3 - pi/6)*cos(acos(C3)/3)", ""),
    ("sqrt(J2)*cos(acos(C3)/3 - pi/6) + J2 + a**2", ">= convex"), ("sqrt(J2)*cos(acos(C3)/3 - pi/6) + J2 + a**3", ""), ("a*J2 + b", ""),
    ("sqrt(J2)*(1 + a*C3)", ""), ("abs(sqrt(J2) - 1) + J2", ""), ("sqrt(J2)*log(e)", ""), ("sqrt(J2)*(2 + C3)**a", ""),
    ("sqrt(J2)*(2 + C3) + log(1 + abs(a))", ""), ("(J2**(3/2)*(4 + C3))**(1/3)", ">= convex"),
    ("(J2**(3/2)*(4 + C3)/(5 - C3))**(1/3)", ""), ("(J2**(3/2)*(20 + C3)/(30 - C3))**(1/3)", ">= convex"),
    ("sqrt(J2)*((4 + C3)**2 + (4 + C3))**(1/2)", ""), ("sqrt(J2)*((20 + C3)**2 + (20 + C3))**(1/2)", ">= convex"),
    ("sqrt(J2)*((20 + C3)**(3/2) + (20 + C3)**(1/2))**(2/3)", ">= convex"), ("sqrt(J2)*((20 + C3)**(1/3) + (20 + C3)**(1/2))", ""),
    ("sqrt(J2)*((20 + C3)**(1/2)*(20 + C3)**(1/2))**(1/1)", ">= convex"), ("sqrt(J2)*(9.99 - C3)**-1", ""),
    ("J2*(1 + 2*C3/7)", ">= convex"), ("J2*(1 + C3/3.49)", ""), ("sqrt(J2)*(2 + C3)**(m - m)", ">= convex"),
    ("sqrt(J2)*(10 - C3)**(m - m - 1)", ">= convex"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "expected"),
    long_but(
        [
            0,
            2,
            4,
            6,
            8,
            10,
            12,
            14,
            16,
            18,
            20,
            22,
            24,
            26,
            28,
            30,
            32,
            34,
            36,
            38,
            40,
            42,
            44,
            46,
            48,
            50,
            52,
            54,
            56,
            58,
            60,
            62,
            64,
            66,
            68,
            70,
            72,
            74,
            76,
            78,
            80,
            82,
            84,
            86,
            88,
            90,
            92,
            94,
            96,
            98,
            100,
            102,
            104,
            106,
            108,
            110,
            112,
            114,
        ],
        SHOWN,
    ),
)
def test_what_is_shown_of_sections(text: str, expected: str) -> None:
    stated = law(text)
    found = convex_in_deviator(stated.g, over(stated))
    assert (said(found) if found else "") == expected


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "origin", "smooth"),
    long_but([0, 3, 4, *range(8, 12), 15], [
        ("sqrt(J2)*(1 + C3/8) - m", True, True), ("sqrt(J2)*(1 + C3/8) - e", True, False), ("sqrt(J2)*(1 + C3/8) + m", False, True),
        ("sqrt(J2)*(1 + C3/8) + a - m", True, False), ("sqrt(J2)*(1 + C3/8) + a", True, False), ("J2*C3 - m", True, True),
        ("sqrt(J2)*cos(acos(C3)/3 - pi/6) - m", True, False), ("C3 + J2 - m", False, False), ("J2 + 1/J2 - m", False, False),
        ("sqrt(J2)*(2 + C3)**0.3 - m", True, True), ("sqrt(J2 + J3**2) - m", True, True), ("sqrt(J2) + abs(J3) - m", True, False),
        ("where(J2 > 0, 5, -1) + sqrt(J2)*(1 + C3/8)", False, False), ("where(J2 <= 0, -1, 5) + sqrt(J2)*(1 + C3/8)", False, False),
        ("exp(sqrt(J2)*(1 + C3/8)) - 2", True, True), ("exp(sqrt(J2)*(1 + C3/8)) - 1", True, False),
    ]),
)  # fmt: skip
def test_on_the_axis_sections_are_zero(text: str, origin: bool, smooth: bool) -> None:
    stated = law(text)
    assert (not objection("origin", "evaluation", frozenset(), stated, {})) is origin
    assert smooth_near_the_boundary(stated.g, over(stated)) is smooth


# -- invariants --------------------------------------------------------------------------------------------------------


def at(poly: Polynomial, point: dict[Term, Fraction]) -> Fraction:
    found = F(0)
    for m, c in poly.items():
        for x, n in m:
            c *= point[x] ** n
        found += c
    return found


def of_tensor(xx: F, yy: F, zz: F, yz: F | int = 0, zx: F | int = 0, xy: F | int = 0) -> tuple[F, F]:
    mean = (xx + yy + zz) / 3
    x, y, z = xx - mean, yy - mean, zz - mean
    second = (x * x + y * y + z * z) / 2 + yz * yz + zx * zx + xy * xy
    return second, x * y * z + 2 * yz * zx * xy - x * yz**2 - y * zx**2 - z * xy**2


def test_invariants_are_those_of_the_tensor() -> None:
    rng, zero = Random(1), F(0)
    for n, tensors in (
        (1, []), (2, [lambda a, b: (a, b, zero)]), (3, [lambda a, b, c: (a, b, c), lambda a, b, t: (a, b, zero, zero, zero, t)]),
        (4, [lambda a, b, c, t: (a, b, c, zero, zero, t)]), (5, []),
        (6, [lambda *x, p=p: (*x[:3], *(x[3 + i] for i in p)) for p in permutations(range(3))]),
    ):  # fmt: skip
        names = [f"s{i}" for i in range(n)]
        found = list(invariants(names))
        assert len(found) == len(tensors)
        for meaning, tensor in zip(found, tensors, strict=True):
            assert meaning.forces == tuple(Term("name", name=x) for x in names)
            for _ in range(4):
                values = [F(rng.randint(-5, 5)) for _ in names]
                point = dict(zip(meaning.forces, values, strict=True))
                assert (at(meaning.second, point), at(meaning.third, point)) == of_tensor(*tensor(*values))


def principal() -> Invariants:
    return next(invariants(("a", "b", "c")))


@pytest.mark.parametrize(
    ("text", "degree", "shares"),
    [
        ("3", 0, {0: "3"}), (f"2*q*{J2}", 2, {0: "2*q"}), (f"{J3}/m", 3, {1: "1/m"}), (f"{J2}*{J3}", 5, {1: "1"}), ("0*a + q", 0, {0: "q"}),
        (f"q*{J2}**3 - {J3}**2/m", 6, {0: "q", 2: "-1/m"}), (f"{J2}**3", 6, {0: "1", 2: "0"}), (f"{J3}**2", 6, {0: "0", 2: "1"}),
        (f"{J2}**4", 8, {0: "1", 2: "0"}), (f"{J3}*({J2}**3 + q*{J3}**2)", 9, {1: "1", 3: "q"}),
        (f"{J2}**6 + 2*{J2}**3*{J3}**2 - m*{J3}**4", 12, {0: "1", 2: "2", 4: "-m"}),
    ],
)  # fmt: skip
def test_polynomials_are_written_in_invariants(text: str, degree: int, shares: dict[int, str]) -> None:
    term, here = domain(f"a*0 + {text}", "a", "b", "c")
    assert principal().of(here.polynomial(term)) == (degree, {j: here.polynomial(parse(share)) for j, share in shares.items()})


@pytest.mark.parametrize(
    "text", ["a", "a + b + c", "a*b*c", f"{J2} + 1", f"{J2} + {J3}", f"{J2}**2 + a**4", f"{J2}**2*{J3}**3", f"{J2}**3 + a**6/10**9", "0*a"]
)
def test_what_is_no_homogeneous_polynomial_in_them_is_not(text: str) -> None:
    term, here = domain(text, "a", "b", "c")
    with pytest.raises(NotWritten):
        principal().of(here.polynomial(term))


# -- functions of an angle ------------------------------------------------------------------------------------------------


def drawn(rng: Random, degree: int) -> Polynomial:
    return total({(): F(30)}, *({((RAY, i),) if i else (): F(rng.randint(-4, 4), rng.randint(1, 3))} for i in range(degree + 1)))


def test_the_bend_of_products_of_powers() -> None:
    """With whole exponents the function is a polynomial f, and D^2 ((3 + v^2) f'' - 2 v f' + 2 f) is the bend times W."""
    rng, stated = Random(2), law("J2 + 0")
    (reader,) = deviatoric_readers(stated.g, over(stated))
    for _ in range(12):
        poly, bases = drawn(rng, 3), [drawn(rng, rng.randint(1, 2)) for _ in range(rng.randint(0, 3))]
        exponents = [rng.randint(1, 3) for _ in bases]
        powers: dict[Base, Polynomial] = {base_of(base): {(): F(e)} for base, e in zip(bases, exponents, strict=True)}
        weight, square = ONE, ONE
        for base, e in zip(bases, exponents, strict=True):
            weight, square = times(weight, power_of(base, e)), times(square, power_of(base, 2))
        f = times(poly, weight)
        first, second = slope(f, RAY), slope(slope(f, RAY), RAY)
        wanted = total(times({(): F(3), ((RAY, 2),): F(1)}, second), times({((RAY, 1),): F(-2)}, first), times({(): F(2)}, f))
        assert times(reader.bend(PlaneFunction(F(1), poly, powers)), weight) == times(square, wanted)


def valued(section: PlaneFunction, c: F) -> float:
    found = float(at(section.poly, {RAY: c}))
    for base, e in section.powers.items():
        found *= float(at(dict(base), {RAY: c})) ** float(at(e, {}))
    return found


def test_sums_and_products_have_the_values_of_their_parts() -> None:
    rng = Random(3)
    for _ in range(10):
        base, other = base_of(drawn(rng, 1)), base_of(drawn(rng, 2))
        half: Polynomial = {(): F(1, 2)}
        one = PlaneFunction(F(1), drawn(rng, 2), {base: half})
        two = PlaneFunction(F(1), drawn(rng, 1), {base: {(): F(-3, 2)}, other: {(): F(2)}})
        for c in (F(-1), F(1, 3), F(1)):
            assert valued(added([one, two]), c) == pytest.approx(valued(one, c) + valued(two, c), rel=1e-12)
            assert valued(multiplied([one, two]), c) == pytest.approx(valued(one, c) * valued(two, c), rel=1e-12)
        assert added([one, two]).degree == 1 and multiplied([one, two, one]).degree == 3
        assert multiplied([one, PlaneFunction(F(0), ONE, {base: {(): F(-1, 2)}})]).powers == {}
        nothing = PlaneFunction(F(5), {}, {other: half})
        assert added([nothing, one, nothing]) == one and added([nothing, nothing]).degree == 5
        for wrong in (one._replace(degree=F(2)), one._replace(powers={}), one._replace(powers={base: half, other: half})):
            with pytest.raises(NotWritten):
                added([one, wrong])
    assert widened({base: half}, dict(base), half) == {base: ONE} and widened({base: half}, dict(base), {(): F(-1, 2)}) == {}
    assert widened({}, ONE, half) == {} and raised_to({base: half}, {(): F(4)}) == {base: {(): F(2)}}
    with pytest.raises(NotWritten):
        power_of({((RAY, 1),): F(1)}, 25)
    assert power_of({((RAY, 1),): F(1)}, 12) == {((RAY, 12),): F(1)} and power_of({}, 0) == ONE


@pytest.mark.parametrize(
    ("text", "simple"),
    [
        ("sqrt(3)", "r3"), ("sqrt(12)", "2*r3"), ("sqrt(4)", "2"), ("sqrt(0.75)", "r3/2"), ("sqrt(2.25)", "3/2"), ("sqrt(6.75)", "3/2*r3"),
        ("sqrt(3)*sqrt(12)", "6"), ("3*sqrt(3)**3", "9*r3"), ("q*sqrt(3)**2", "3*q"), ("sqrt(3)**-1", "r3/3"), ("1/sqrt(12)**2", "1/12"),
        ("sqrt(3)**5*sqrt(4)**3", "72*r3"), ("sqrt(3)**-3", "r3/9"), ("sqrt(4)**-1", "1/2"), ("sqrt(3)*q + sqrt(27)", "q*r3 + 3*r3"),
    ],
)  # fmt: skip
def test_roots_of_squares_and_of_three_squares(text: str, simple: str) -> None:
    term, here = domain(f"{text} + a*0", "a")
    wanted = here.polynomial(parse(simple).put({parse("r3"): parse("3**0.5")}))
    assert plain(here.polynomial(term), here) == wanted


@pytest.mark.parametrize("text", ["sqrt(2)", "3**(1/3)", "4**(1/4)", "sqrt(m)", "3**q"])
def test_other_roots_stay(text: str) -> None:
    term, here = domain(f"{text} + a*0", "a")
    assert plain(here.polynomial(term), here) == here.polynomial(parse(text))


def test_beside_the_axis_what_is_compared_may_have_another_sign() -> None:
    for text, sign in (("sqrt(J2)*(1 + C3/8) - 1", NEGATIVE), ("exp(J2)*(1 + sqrt(J2)*C3)", POSITIVE), ("where(J2 > 0, 5, -1) + J3", ANY)):
        stated = law(text)
        assert sign_on_axis(stated.g, law("J2").g, over(stated)) == sign
        assert sign_on_axis(stated.g, law("J3").g, over(stated)) == ANY
