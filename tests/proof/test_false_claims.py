"""False claims of which the counterexample is known by hand and lies where no plain choice of parameters or points is.

It is at ends of several ranges together, at equal parameters, in another part of K, at a hole, or on a small cap.  Each witness is
confirmed by the arithmetic of the oracle too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import pytest

from duhem import Criterion, Domain, Verdict, verify
from duhem.law.domain import POSITIVE
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import refuters
from duhem.proof.search import corners
from tests.long import long_at
from tests.oracles.reevaluation import confirmed

TWO, THREE = ("x", "y"), ("x", "y", "z")
PRINCIPAL = tuple(f"s{i}" for i in (1, 2, 3))
SHEAR = "sqrt(((s1 - s2)**2 + (s2 - s3)**2 + (s3 - s1)**2)/2)"


def law(
    g: str,
    forces: tuple[str, ...] = TWO,
    *,
    flow: tuple[str, ...] | None = None,
    potential: str | None = None,
    start: str = "",
    positive: str = "",
    **ranges: tuple[str, str],
) -> Criterion:
    """A law without a pressure; the force ``start`` is >= 0, and ``positive`` are parameters without another range."""
    parameters = {**{name: Domain.between(*ends) for name, ends in ranges.items()}, **dict.fromkeys(positive, POSITIVE)}
    domain = {start: Domain.between(0)} if start else {}
    return Criterion("law", g, parameters, forces, None, flow=flow, potential=potential, domain=domain)


def refuted(one: Criterion, claim: str) -> dict[str, Fraction]:
    """The parameters of the witness against a claim, which the oracle confirms."""
    found = verify(one, claims=[claim])[claim]
    assert found.verdict is Verdict.REFUTED and found.witness is not None
    assert confirmed(one, claim, found.witness)
    return {name: Fraction(value) for name, value in found.witness.parameters.items()}


ORIGIN: list[tuple[Criterion, Callable[..., float]]] = [  # with g at zero force
    (
        law("x**2 + y**2 + exp(-1000*(a - b)**2) - 99/100", a=("1/10", "9/10"), b=("1/4", "2")),
        lambda a, b: math.exp(-1000 * (a - b) ** 2) - 0.99,
    ),
    (law("x**2 + y**2 + exp(-20*(a - 37/100)**2) - 99/100", a=("0", "1")), lambda a: math.exp(-20 * (a - 0.37) ** 2) - 0.99),
]


@pytest.mark.parametrize(("one", "at_zero"), ORIGIN)
def test_zero_force_is_outside_at_equal_parameters_or_at_one_value(one: Criterion, at_zero: Callable[..., float]) -> None:
    assert at_zero(**{name: float(value) for name, value in refuted(one, "origin").items()}) > 0


PARTS = [  # another part of K, and holes in it, beyond what rays from zero force meet
    law("(x**2 + y**2 - 1)*((x - 37)**2 + (y - 21)**2 - 1/100)"),
    law("(x**2 + y**2 + z**2 - 1)*((x - 9)**2 + (y - 8)**2 + (z - 7)**2 - 1/4)", THREE),
    law("max(norm(x, y) - 2, 1/100 - norm(x - 13/10, y - 2/5))"),
    law("max(norm(x, y) - 1, 1/20 - norm(x - 7/10, y - 9/20))"),
    law("max(norm(x, y, z) - 2, 1/10 - norm(x - 11/10, y - 7/10, z + 3/5))", THREE),
    law("max(norm(x, y, z) - 1, sin(20*(x + y + z))/5 + x + y + z - 3/2)", THREE),  # slabs
]


@pytest.mark.parametrize("one", PARTS)
def test_another_part_of_k_or_a_hole_is_found(one: Criterion) -> None:
    refuted(one, "convexity")


@pytest.mark.parametrize("one", PARTS[:1] + PARTS[3:5])
def test_where_k_is_entered_again_less_than_0_is_dissipated(one: Criterion) -> None:
    refuted(one, "dissipation")


@pytest.mark.long
def test_a_power_with_a_whole_number_at_the_end_of_its_range_has_another_lobe() -> None:
    footing = law("x**2 + y**2 - (z**b*(1 - z)**c)**2", THREE, start="z", b=("4/5", "1"), c=("4/5", "1"))
    assert refuted(footing, "convexity")["c"] == 1  # for z > 1 no other power has a value
    assert refuted(footing, "dissipation")["c"] == 1


SPENT: list[tuple[Criterion, Callable[..., bool]]] = [  # with what the parameters must be for it
    (
        law("abs(y) - mu*(x + be)*(1 - x)", potential="abs(y) - mt*(x + bt)*(1 - x)", mu=("3/10", "3/5"), be=("0", "1/5"),
            mt=("1/10", "3/5"), bt=("0", "1/5")),
        lambda mu, be, mt, bt: mu < mt * (1 - bt) or be > 0,  # near x = 0 the power is (mu - mt (1 - bt)) x + be mu
    ),
    (
        law("abs(y) - (x*(1 - x)**(3/2)*3/5 + (1 - (1 - x)**(3/2))*(x*m + c))/(1 - n*(1 - x)**(11/2))", start="x", m=("1/2", "4/5"),
            c=("1/100", "1/10"), n=("1/20", "1/4")),
        lambda m, c, n: m > 0.5,  # the second derivative of the strength at 0 must be > 0
    ),
]  # fmt: skip


@pytest.mark.parametrize(("one", "possible"), SPENT)
def test_ends_of_several_ranges_together_dissipate_less_than_0(one: Criterion, possible: Callable[..., bool]) -> None:
    assert possible(**{name: float(value) for name, value in refuted(one, "dissipation").items()})


@pytest.mark.long
def test_a_flow_that_leans_at_ends_of_ranges_alone_is_not_normal() -> None:
    ellipse = law("x**2/a**2 + y**2 - 1", flow=("x/a**2", "y*(1 + pos(a*m - 59/10))"), a=("1", "3"), m=("1", "2"))
    found = refuted(ellipse, "normality")
    assert found["a"] * found["m"] > Fraction(59, 10)
    cone = law(f"{SHEAR} + a*(s1 + s2 + s3) - c", PRINCIPAL, potential=f"{SHEAR} + min(a, b)*(s1 + s2 + s3)", a=("1/10", "1/2"),
               b=("49/100", "3/5"), positive="c")  # fmt: skip
    found = refuted(cone, "normality")
    assert found["b"] < found["a"]


CAPS: list[tuple[Criterion, Callable[..., bool]]] = [
    (law("max(norm(x, y, z) - 1, x - c)", THREE, c=("99/100", "2")), lambda c: c < 1),
    (law("norm(x, y, z) - 1 + pos(x + y + z - 17/10)/5", THREE), lambda: True),
    (
        law("max(2*(x + y + z)*(1/t - 1/c) + ((x - y)**2 + (y - z)**2 + (z - x)**2)/(t*c) - 2, where(t <= c/2, max(x, y, z) - t, -1))",
            THREE, positive="tc"),
        lambda t, c: t <= c / 2,
    ),
]  # fmt: skip


@pytest.mark.parametrize(("one", "possible"), long_at((2,), CAPS))
def test_a_corner_of_a_small_cap_or_at_few_parameters_is_shown(one: Criterion, possible: Callable[..., bool]) -> None:
    assert possible(**{name: float(value) for name, value in refuted(one, "smoothness").items()})


@pytest.mark.parametrize(
    "g",
    [
        "x**2 + (z*(1 - a*y*z/(abs(y)*abs(z))))**2 + abs(y)**3 - 1",
        "x**2 + y**2 + z**2*where(z > 0, 1, 2) + a*where(z > 0, x, 0) - 1",
        "where(x > a, x**2 + y**2 + z**2 - 9/10, x**2 + y**2 + z**2 - 1)",
    ],
)
def test_k_of_three_forces_has_a_corner_where_it_ends_at_a_jump(g: str) -> None:
    one = law(g, THREE, a=("1/10", "2/5"))
    found = verify(one, claims=["smoothness"])["smoothness"]
    assert (found.verdict, found.method) == (Verdict.REFUTED, "witness-corner") and found.witness is not None
    n1, n2 = ([sum(map(float, found.witness.values[f"n{i}_{x}"])) / 2 for x in THREE] for i in (1, 2))
    along = sum(a * b for a, b in zip(n1, n2, strict=True)) / (math.hypot(*n1) * math.hypot(*n2))
    assert math.degrees(math.acos(along)) == pytest.approx(found.witness.measures["corner_degrees"])
    assert abs(along) < 1


SMOOTH = [
    "norm(x, y, z) - 1",
    "max(x**2 + y**2 + z**2 - 1, x - 2)",
    "norm(x, y, z) - 1 + pos(x + y + z - 17/10)**2/5",
    "where(x > 0, x**2 + y**2 + z**2 - 1, 5*(x**2 + y**2 + z**2 - 1))",  # g jumps, the boundary does not
]


@pytest.mark.parametrize("g", SMOOTH)
def test_no_corner_is_seen_across_the_switches_of_what_is_smooth(g: str) -> None:
    assert refuters.smoothness_at_switches(FormulaSubject(law(g, THREE))) is None


TRUE = [
    law("x**2/a**2 + y**2/b**2 - 1", a=("1/10", "9/10"), b=("1/4", "2")),
    law("norm(x, y, z) + a*abs(x - y) - 1", THREE, a=("0", "1")),
    law("abs(y) - mu*x*(1 - x)", start="x", mu=("1/10", "1")),
    law("exp(x) + exp(-x) + y**2 - c", c=("5/2", "9")),
]


@pytest.mark.parametrize("one", TRUE)
def test_what_holds_is_not_refuted(one: Criterion) -> None:
    subject = FormulaSubject(one)
    assert refuters.convexity_by_thorough_scouting(subject) is None
    spent = refuters.dissipation_by_sampling(subject)
    assert spent is None or spent.verdict is Verdict.TESTED


def test_a_number_of_thousands_of_digits_is_no_error() -> None:
    g = "norm(x, y) - 1 + exp(-10000*((x - 955336/10**6)**2 + (y - 29552/10**5)**2))/100"
    refuted(law(g), "convexity")


def test_a_place_of_which_sympy_cannot_sort_the_digits_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of Leblond, Perrin and Suquet (1994), where a number in a plane is raised to 1981/100."""
    subject = FormulaSubject(law("norm(x, y) + abs(z) - 1", ("x", "y", "z")))
    assert refuters.smoothness_at_corners(subject) is not None

    def too_long(*_: object, **__: object) -> None:
        raise ValueError("Exceeds the limit (4300 digits) for integer string conversion")

    monkeypatch.setattr(corners, "local_pieces", too_long)
    assert [*corners.section_corners(subject, {})] == []
