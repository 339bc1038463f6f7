"""Laws whose formula has no value at places that K does not reach, or only at its tip: beside each what is almost so and false."""

from __future__ import annotations

import pytest

from duhem import Criterion, Domain, Verdict, verify
from duhem.law.domain import POSITIVE
from tests.campaigns.rewritings import verdicts

UNIT = Domain.between("1/10", "9/10")
AHEAD = {"a": Domain.between(0, None)}
ALL = {"convexity", "smoothness", "normality", "dissipation"}
SHEAR = "((a - b)**2 + (b - c)**2 + (c - a)**2)/6"
THIRD = "(2*a - b - c)*(2*b - c - a)*(2*c - a - b)/27"
LODE = f"(3*sqrt(3)/2*{THIRD}/({SHEAR})**(3/2))"


def proved(g: str, forces: tuple[str, ...] = ("a", "b"), domain: dict[str, Domain] | None = None) -> set[str]:
    parameters = {"e": UNIT} if "e" in g.replace("exp", "").replace("where", "") else {}
    one = Criterion("law", g, parameters, forces=forces, pressure=None, domain=domain or {})
    return {claim for claim, verdict in verdicts(one, whole=False).items() if verdict == "proved"}


@pytest.mark.parametrize(
    ("g", "right", "wrong"),
    [
        ("norm(a, b) - (c + 1)**(4/5)", ALL, set()),
        ("abs(b) - (a + 1)**e", ALL, set()),  # the kink of |b| is where K ends, and is round
        ("b - (a + 1)**e", ALL, set()),  # where K ends b is any that is <= 0
        ("b - (e - 1/2)*(a + 1)**(1/2)", set(), ALL),  # at e = 1/2 it is a quadrant
        ("abs(b) - (a + 1)**(3/2)", set(), {"convexity", "smoothness"}),
        ("abs(b) + (a + 1)**(1/2) - 2", set(), {"convexity", "smoothness"}),
        ("abs(b) - 1 - 0*(a + 1)**(1/2)", set(), {"smoothness"}),  # it ends where b has any value
        ("b - (a - 1)**(1/2)", {"convexity", "normality"}, {"origin", "dissipation"}),
    ],
)
def test_powers_below_one_have_a_value_where_what_is_raised_is_none_below_zero(g: str, right: set[str], wrong: set[str]) -> None:
    found = proved(g, ("a", "b", "c") if "c" in g else ("a", "b"))
    assert right <= found and not wrong & found, found


@pytest.mark.parametrize(
    ("g", "right", "wrong"),
    [
        ("norm(a, b)*exp(e*a/norm(a, b)) - 1", {"origin", "smoothness", "dissipation"}, {"convexity"}),
        ("(a**2 + b**2)*exp(e*a/norm(a, b)) + norm(a, b)*exp(b/norm(a, b)) - 1", {"origin", "smoothness", "dissipation"}, set()),
        ("norm(a, b) - 1 - e*a/norm(a, b)", {"dissipation"}, {"convexity"}),
        ("norm(a, b)*exp(e*a/norm(a, b)) + 1", set(), {"origin"}),
        ("norm(a, b)*exp(a) - e*exp(a/norm(a, b))", set(), {"origin", "dissipation", "smoothness"}),
        ("norm(a, b)*(1 + e*a/abs(a)) - 1", {"dissipation"}, {"convexity", "smoothness"}),  # two half-discs
        ("norm(a - 1, b)*exp(e*(a - 1)/norm(a - 1, b)) - 1", set(), {"smoothness", "dissipation"}),  # it lacks its centre
        ("norm(a - 1, b)**2/norm(a - 1, b) - e*b", set(), {"smoothness"}),  # 0 at its tip
    ],
)
def test_parts_of_degree_above_zero_tend_to_zero_at_zero_force(g: str, right: set[str], wrong: set[str]) -> None:
    found = proved(g)
    assert right <= found and not wrong & found, found


@pytest.mark.parametrize(
    ("g", "right", "wrong"),
    [
        ("b - a*(1 + log(e/a))", {"dissipation"}, {"origin", "smoothness"}),
        ("log(a) + log(1 + b**2/a**2) - e", {"dissipation"}, {"origin", "smoothness"}),
        ("b - (1 + 2*a)/(1 + e*a)", {"origin", "smoothness"}, set()),
        ("abs(b) - a*(1 - log(a))", set(), {"smoothness"}),
        ("a - 1 + b**2/a**2", set(), {"smoothness"}),  # {b^2 <= a^2 (1 - a)} has a corner at 0
        ("a*b - e*b*log(a)", set(), {"smoothness"}),  # two lines cross
    ],
)
def test_within_the_ranges_of_the_forces(g: str, right: set[str], wrong: set[str]) -> None:
    found = proved(g, domain=AHEAD)
    assert right <= found and not wrong & found, found
    assert not right & proved(g) - {"origin", "dissipation"}  # without the range g ends where it has no value


@pytest.mark.parametrize(
    ("g", "convex"),
    [
        ("b - a*(1 + log(e/a))", True),
        ("log(e/a) + b**2", True),
        ("b - a*log((1 + e)/(3*a))", True),
        ("b + a*log(e/a)", False),
        ("log(a/e) + b**2", False),
        ("b - a*(1 + log((e - 1/2)/a))", False),  # a is < 0 where e < 1/2
        ("b - a*log(e/a**2)", False),  # there a may be < 0
        ("log(e/(a*b)) - 1", False),  # two branches of a hyperbola
    ],
)
def test_a_logarithm_of_what_is_divided_by_a_force_is_that_turned(g: str, convex: bool) -> None:
    assert ("convexity" in proved(g)) is convex


@pytest.mark.parametrize(
    ("factor", "right", "wrong"),
    [
        (f"(1 + sqrt(1 + where({SHEAR} > 0, {LODE}, 0)/10))", {"origin"}, set()),
        (f"sqrt(1 + where({SHEAR} > 0, {LODE}, 5)/10)", {"origin"}, set()),  # times 0
        (f"sqrt(1 + where({SHEAR} > 0, {LODE}, 0)*11/10)", set(), ALL),
        (f"cos(acos(e*where({SHEAR} > 0, {LODE}, 0))/3)", {"origin"}, set()),
        (f"cos(acos(2*e*where({SHEAR} > 0, {LODE}, 0))/3)", set(), ALL),
    ],
)
def test_what_is_guarded_by_the_second_invariant(factor: str, right: set[str], wrong: set[str]) -> None:
    found = proved(f"sqrt({SHEAR})*{factor} + (a + b + c)/9 - 1", ("a", "b", "c"))
    assert right <= found and not wrong & found, found


@pytest.mark.parametrize(
    "g",
    [
        f"sqrt({SHEAR} + where({SHEAR} > 0, 0, 5)) - 1",
        f"sqrt({SHEAR} + where({SHEAR} > 0, 1, 5) - 1) - 1",
        f"{SHEAR} + where({SHEAR} > 0, {LODE}, 5) - {LODE} - 1",
        f"norm(sqrt({SHEAR}), where({SHEAR} > 0, 0, 5)) - 1",
        f"max(where({SHEAR} > 0, -1, 1), sqrt({SHEAR}) - 1)",
    ],
)
def test_a_jump_at_the_axis_stays_in_a_sum_where_it_is_nothing_elsewhere(g: str) -> None:
    assert proved(g, ("a", "b", "c")) <= {"dissipation"}  # K is a cylinder without its axis: rays from zero force leave it once


@pytest.mark.parametrize(
    ("g", "known"),
    [
        (f"sqrt({SHEAR})*(1 + e*sin(acos({LODE}))) - 1", True),
        (f"{SHEAR}*cos(acos(e*{LODE})/3)**2 + (a + b + c)**2 + a + b + c", True),
        (f"sqrt({SHEAR})*exp({LODE}) + log(1 + a**2)*tanh(({SHEAR})**2) - 1", True),
        (f"sqrt({SHEAR})*(1 + e*sin(acos({LODE}))) + 1", False),
        (f"cos(acos(e*{LODE})/3) - 2", False),  # of degree 0
        (f"sqrt({SHEAR})*exp({LODE}*a) - 1", False),
    ],
)
def test_what_is_of_one_degree_in_the_deviator_tends_to_zero_with_it(g: str, known: bool) -> None:
    assert ("origin" in proved(g, ("a", "b", "c"))) is known


@pytest.mark.parametrize(
    ("g", "right", "wrong"),
    [
        ("cosh(a/where(a < 0, e, 2)) + b**2 - 3", ALL, set()),
        ("cosh((a + b)*where(a + b < 0, e, 2)) + b**2 - 3", ALL, set()),
        ("exp(a*where(a < 0, e, 2)) + b**2 - 2", {"convexity"}, {"smoothness"}),
        ("exp(a*where(a < 0, 2, e)) + b**2 - 2", set(), {"convexity", "smoothness"}),
        ("cosh((a - 1)*where(a < 0, e, 2)) + b**2 - 3", set(), ALL),  # it jumps
        ("cosh(a*where(a < 0, -e, 2)) + b**2 - 3", ALL, set()),
        ("cosh(a/where(a < 0, e - 1/10, 2)) + b**2 - 3", set(), ALL),  # e = 1/10
        ("cosh(abs(a) + 1) + b**2 - 5", {"convexity"}, {"smoothness"}),
    ],
)
def test_choices_of_constants(g: str, right: set[str], wrong: set[str]) -> None:
    found = proved(g)
    assert right <= found and not wrong & found, found


def test_a_number_that_is_too_large_for_double_precision_leaves_the_other_verdicts() -> None:
    law = Criterion("law", "(a + b)**3*a - m**250 - a*b", {"m": POSITIVE}, forces=("a", "b"), pressure=None)
    found = verify(law, claims=["origin", "convexity", "dissipation"], effort="quick")
    assert found["origin"].verdict is Verdict.PROVED and found["convexity"].verdict is not Verdict.PROVED
