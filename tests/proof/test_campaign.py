"""A fixed part of the campaign: no wrong answer, and few open ones; the whole is ``python -m tests.campaigns.verdicts``."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

import pytest
import sympy as sp

from tests.campaigns.families.table import FAMILIES, trials
from tests.campaigns.families.trial import Trial
from tests.campaigns.verdicts import Outcome, judge
from tests.long import mostly_long
from tests.oracles.fourier_series import half_angle
from tests.oracles.level_curve import curvature_form, on_line
from tests.oracles.real_line import T, nonnegative_on_the_line

COUNT = 54
EVERY_RUN = (*range(1, 5), 6, 8, 11, 13)  # a law of each family but three dear ones, and of two another; the others are asked for


@cache
def drawn(count: int) -> list[Trial]:
    """The laws; not drawn before a test asks, for deciding what is true of them takes seconds."""
    return list(trials(count, seed=2))


@cache
def outcome(place: int) -> Outcome:
    return judge(drawn(27 if place < 27 else COUNT)[place])


@pytest.mark.slow
@pytest.mark.parametrize(
    "place",
    mostly_long(range(COUNT), *EVERY_RUN),
    ids=lambda k: f"{[*FAMILIES][k % len(FAMILIES)].replace(' ', '-')}-{k // len(FAMILIES)}",
)
def test_no_verdict_is_wrong(place: int) -> None:
    assert outcome(place).wrong == {}


@pytest.mark.slow
@pytest.mark.parametrize("places", [pytest.param(EVERY_RUN, id="some"), pytest.param(range(COUNT), id="all", marks=pytest.mark.long)])
def test_few_claims_stay_open(places: Sequence[int]) -> None:
    marks = [text for place in places for text in outcome(place).claims.values()]
    assert marks.count("open") <= len(marks) // 50


@pytest.mark.long
def test_the_campaign_repeats_itself() -> None:
    first = drawn(27)[:9]
    assert [t.law for t in trials(9, seed=2)] == [t.law for t in first]
    assert all(t.law.g != other.law.g for t, other in zip(first, trials(9, seed=3), strict=True))


@pytest.mark.slow
def test_every_family_has_true_and_false_laws() -> None:
    seen: dict[str, set[bool]] = {family: set() for family in FAMILIES}
    for trial in drawn(27):
        seen[trial.family] |= set(trial.truth.values())
    assert seen == {family: {True, False} for family in FAMILIES}


# -- the campaign's own arithmetic ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("p", "true"),
    [
        (T**2, True),
        (T**2 - sp.Rational(1, 10**30), False),
        ((T - 1) ** 2 * (T**2 + 1), True),
        ((T - 1) ** 3 * (T + 1), False),
        ((T**2 - 2) ** 2, True),
        (-(T**2), False),
        (T**3, False),
        (sp.Integer(0), True),
        (sp.Integer(-1), False),
        (sp.Integer(2), True),
    ],
)
def test_nonnegativity_is_decided_exactly(p: sp.Expr, true: bool) -> None:
    assert nonnegative_on_the_line(sp.Poly(p, T, domain="QQ")) is true


def test_thresholds_lie_where_the_theory_says() -> None:
    """x^4 + c x^2 y^2 + y^4 is convex on 0 <= c <= 6; 1 + e cos k theta as a gauge for e <= 1/(k^2 - 1)."""
    x, y = sp.symbols("x y", real=True)
    for c, convex in ((0, True), (6, True), (3, True), (Fraction(6) + Fraction(1, 10**12), False), (Fraction(-1, 10**12), False)):
        form = x**4 + sp.Rational(*Fraction(c).as_integer_ratio()) * x**2 * y**2 + y**4
        assert nonnegative_on_the_line(on_line(curvature_form(form, form))) is convex
    for k in range(2, 6):
        for excess, convex in ((Fraction(0), True), (Fraction(1, 10**12), False), (Fraction(-1, 10**12), True)):
            series = {0: (Fraction(1), Fraction(0)), k: (Fraction(1, k * k - 1) + excess, Fraction(0))}
            assert nonnegative_on_the_line(half_angle(series, lambda j: Fraction(1 - j * j))) is convex
