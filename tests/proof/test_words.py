"""Verdicts on laws with angles, hyperbolic functions, signs and joined conditions, each beside a neighbour of which they are false."""

from __future__ import annotations

import pytest

from duhem import POSITIVE, Criterion, Domain
from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.parse import parse_expression
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.verification import verify
from tests.long import long_but, mostly_long


def verdicts(g: str, claims: tuple[str, ...] = ("convexity",), **domains: Domain) -> tuple[str, ...]:
    found = verify(Criterion("law", g, parameters={"mu": POSITIVE, **domains}, forces=("a", "b"), pressure="s"), claims=claims)
    return tuple(claim.verdict.value for claim in found.results)


def between(low: str, high: str) -> Domain:
    return Domain.between(low, high)


CONVEX = {
    "norm(a, b)*(1 + e*cos(3*atan2(b, a))) - mu*abs(s)": between("0", "1/10"),  # (k^2 - 1) e <= 1
    "(sign(a)*a + abs(b))*(1 + e) - mu*abs(s)": between("0", "1"),
    "cosh(a) + b**2 - 2 - e": between("0", "1"),
    "sinh(abs(a)) + abs(b) - mu*(1 + e)": between("0", "1"),
    "norm(a, b) - acos(e)*mu*abs(s)": between("-1", "1"),
    "where(a > 0 and b > 0 or a < 0 and b < 0, norm(a, b), abs(a) + abs(b)) - mu*(1 + e)*abs(s)": between("0", "1"),
}
NOT_CONVEX = {
    "norm(a, b)*(1 + e*cos(3*atan2(b, a))) - mu*abs(s)": between("0", "1/5"),
    "norm(a, b)*(1 + e*cos(3*atan2(b, a) - 1/2)) - mu*abs(s)": between("1/5", "1/5"),
    "norm(a, b)*(1 + e*atan2(b, a)) - mu*abs(s)": between("1/10", "1/10"),  # jumps on the cut
    "norm(a, b)*(2 + sign(a)) - mu*(1 + e)*abs(s)": between("0", "1"),
    "2 + e - cosh(a) + b**2": between("0", "1"),
    "asin(a) + abs(b) - 1/2 - e": between("0", "0"),
    "where(a > 0 and b > 0 or a < 0 and b < 0, norm(a, b), (sqrt(abs(a)) + sqrt(abs(b)))**2) - mu*abs(s)": between("0", "1"),
    "where(a > 0 or b > 0, max(abs(a), abs(b)), 2*norm(a, b)) - mu*(1 + e)*abs(s)": between("0", "0"),
}


@pytest.mark.slow
@pytest.mark.parametrize("g", mostly_long(CONVEX, *[g for g in CONVEX if not g.startswith(("where", "(sign"))]))
def test_proved(g: str) -> None:
    assert verdicts(g, e=CONVEX[g]) == ("proved",)


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([1, 2, 5, 7], NOT_CONVEX))
def test_refuted(g: str) -> None:
    assert verdicts(g, e=NOT_CONVEX[g]) == ("refuted",)


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    [
        "norm(a, b)*(1 + e*cos(3*atan2(b, a))) - mu*abs(s)",
        "b**2 + 2*e*cosh(a) - 1 - e**2",
        "sinh(abs(a)) + abs(b) - mu*acos(e)*(1 - sin(e))",
    ],
)
def test_the_kernel_has_the_words_too(g: str) -> None:
    law = Criterion("law", g, parameters={"mu": POSITIVE, "e": between("0", "1/10")}, forces=("a", "b"), pressure="s")
    found = verify(law, claims=("origin", "convexity", "normality", "dissipation"))
    assert [(claim.verdict.value, str(claim.trust)) for claim in found.results] == [("proved", "checked")] * 4


@pytest.mark.parametrize("word", ["asin", "acos"])
def test_a_range_left_by_a_parameter_is_an_error(word: str) -> None:
    for domain in (between("-1", "2"), between("-2", "0")):
        with pytest.raises(InputError, match="needs for an arc"):
            verdicts(f"norm(a, b) - (4 + {word}(e))*mu*abs(s)", e=domain)


@pytest.mark.slow
def test_nothing_is_proved_where_an_angle_may_have_no_point() -> None:
    """At e = 0 the second angle is that of (0, 0); the first is of no other point than sigma = 0."""
    assert verdicts("norm(a, b) + cos(2*atan2(e*b, e*a))*e - mu*abs(s) - 1", e=between("0", "1/9")) != ("proved",)
    assert verdicts("norm(a, b) - abs(s)*mu*(2 + cos(atan2(b, b)))", ("origin", "convexity")) != ("proved", "proved")


@pytest.mark.parametrize(
    ("text", "sense", "holds"),
    [
        ("acos(x)", ">=", True), ("acos(x)", ">", None), ("asin(x/2) + 2", ">", True), ("asin(x)", ">=", None), ("acos(2*x)", ">=", None),
        ("acos(x/2)", ">", True), ("asin(1 - x)", ">=", None), ("asin(1/2 - x/2)", ">=", True), ("sinh(1 - x)", ">=", True),
        ("sinh(1 - x)", ">", None), ("log(2 - x)", ">=", True), ("log(2 - x)", ">", None), ("tanh(x)", ">=", None),
        ("acos(x)*(2 - x)", ">=", True),
    ],
)  # fmt: skip
def test_signs_of_monotone_words(text: str, sense: str, holds: bool | None) -> None:
    """Over -1 <= x <= 1; what is not shown is false, at least somewhere, or undefined there."""
    x = symbol("x")
    answer = decide(Question(parse_expression(text, {"x": x}), Sense(sense), (x >= -1, x <= 1)))
    assert (answer.holds is True) == (holds is True)
