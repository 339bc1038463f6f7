"""Sets that end round between loads, as the kernel confirms them, and neighbours that have a corner somewhere."""

from __future__ import annotations

import pytest

from duhem.proof.kernel.regularity import smooth_but_where_zero, tips
from duhem.proof.kernel.term import parse
from tests.proof.small_laws import confirmed, domain, law

BETWEEN = "max(-a, a - 1, {})"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "forces", "round_there"),
    [
        (BETWEEN.format("abs(b) - sqrt(a*(1 - a))"), "ab", True),  # a disc
        (BETWEEN.format("abs(b) - (a*(1 - a))**(1/4)"), "ab", True),
        (BETWEEN.format("abs(b) - m*sqrt(a*(1 - a))"), "ab", True),
        (BETWEEN.format("abs(b) + k*sqrt(a*(1 - a))"), "ab", True),
        (BETWEEN.format("abs(b) - sqrt(m*a*(1 - a))"), "ab", True),
        (BETWEEN.format("b**2 - sqrt(a*(1 - a))"), "ab", True),
        (BETWEEN.format("norm(b, 1/100) - sqrt(a*(1 - a))"), "ab", True),  # it does not reach the loads
        (BETWEEN.format("norm(b, c) - sqrt(a*(1 - a))"), "abc", True),
        (BETWEEN.format("abs(b) - sqrt(pos(a*(1 - a)))"), "ab", True),
        (BETWEEN.format("abs(b) - sqrt(a - a**2)"), "ab", True),
        (BETWEEN.format("abs(b) - (a*(1 - a)*(2 - a))**(1/3)"), "ab", True),
        ("max(-a, abs(b) - sqrt(a))", "ab", True),
        # corners
        (BETWEEN.format("abs(b) - sqrt(e*a*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) - e*sqrt(a*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) - q*sqrt(a*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) - sqrt(a)"), "ab", False),  # at a = 1
        (BETWEEN.format("abs(b) - sqrt(1 - a)"), "ab", False),
        (BETWEEN.format("abs(b) - a*(1 - a)"), "ab", False),
        (BETWEEN.format("abs(b) - (a*(1 - a))**p"), "ab", False),
        (BETWEEN.format("abs(b) - (a*(1 - a))**e"), "ab", False),
        (BETWEEN.format("abs(b) - sqrt(a*a*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) - (a*a*(1 - a))**(1/3)"), "ab", False),
        (BETWEEN.format("abs(b) - (a*(1 - a)*(1 - a))**(1/3)"), "ab", False),
        (BETWEEN.format("abs(b) - sqrt(min(a, 1 - a))"), "ab", False),  # at a = 1/2
        (BETWEEN.format("abs(b) + abs(a - 1/2)/10 - sqrt(a*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) + 1/100 - sqrt(a*(1 - a))"), "ab", False),  # at b = 0
        (BETWEEN.format("abs(b) - 1/100 - sqrt(a*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) + abs(c) - sqrt(a*(1 - a))"), "abc", False),
        (BETWEEN.format("b - sqrt(a*(1 - a))"), "ab", True),
        (BETWEEN.format("abs(b) - sqrt(a*(1 - a)), b - 1/4"), "ab", False),
        (BETWEEN.format("abs(b) - sqrt(a*(1 - a)), b**2 - 1/16"), "ab", False),
        (BETWEEN.format("2*a - 2, abs(b) - sqrt(a*(1 - a))"), "ab", False),  # another with the same end: not shown
        (BETWEEN.format("abs(b) - sqrt((a + b/9)*(1 - a))"), "ab", False),
        (BETWEEN.format("abs(b) - sqrt(a*(1 - a)*(2 - abs(b)))"), "ab", False),
        (BETWEEN.format("abs(b) - sqrt(a*(1 - a)) - (a*(1 - a))**(1/4)"), "ab", False),
        ("max(-a, a - 2, abs(b) - sqrt(a*(1 - a)))", "ab", False),
        ("max(-a, a - 1/2, abs(b) - sqrt(a*(1 - a)))", "ab", False),
        ("max(-a, abs(b) - sqrt(a*(1 - a)))", "ab", False),
        ("max(-a, a - 1, abs(b) - a**b)", "ab", False),
        ("abs(b) - sqrt(a*(1 - a))", "ab", False),
        ("max(-a, a - 1)", "ab", False),
    ],
)  # fmt: skip
def test_where_a_set_ends_between_loads(g: str, forces: str, round_there: bool) -> None:
    stated = law(g, list(forces))
    assert confirmed("smoothness", "composition", stated, {"inside": {"a": "1/2"} if "a - 1/2," not in g else {"a": "1/4"}}) is round_there
    if round_there:
        for outside in ({"a": "0"}, {"a": "1/2", "b": "9*p"}):
            assert not confirmed("smoothness", "composition", stated, {"inside": outside})


@pytest.mark.parametrize(
    ("text", "there"),
    [
        ("abs(a)", True), ("norm(a, b)", True), ("pos(a)", True), ("abs(a) + abs(b)", False), ("abs(a) + 1", False), ("abs(a)*b", True),
        ("norm(a, b) + a", True), ("norm(a, b) + 1", False), ("abs(norm(a, b))", True), ("a + b", True),
        ("abs(norm(a, b) - 1)", False), ("pos(norm(a, b) - 1)", True), ("pos(norm(a, b) - 1) + 1", False), ("sqrt(abs(a))", True),
        ("log(1 + abs(a))", False), ("max(a, b)", False), ("norm(abs(a) - 1, b)", False),
    ],
)  # fmt: skip
def test_what_is_smooth_but_where_it_is_zero(text: str, there: bool) -> None:
    here = domain(g=text)
    assert smooth_but_where_zero(parse(text), here) is there
    assert here.facts(parse(text)).defined


def test_where_a_formula_may_be_singular() -> None:
    here = domain()
    assert tips(parse("norm(a, b) + a"), here) == {parse("norm(a, b)")} and tips(parse("a**2 + b"), here) == frozenset()
    assert tips(parse("abs(a) + norm(a, b)"), here) == frozenset() and tips(parse("max(a, b)"), here) == frozenset()
    assert tips(parse("norm(a, b) + norm(a, 2*b) + 1"), here) == {parse("norm(a, b)"), parse("norm(a, 2*b)")}
