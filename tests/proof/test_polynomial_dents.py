"""Dents of polynomial laws in any number of forces: found however slight, and none where there is none."""

from __future__ import annotations

from fractions import Fraction

import pytest

from duhem import Criterion, Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import refuters
from duhem.proof.verdict import Evidence
from tests.long import long_but
from tests.oracles import plane_quartics

F = Fraction


def law(g: str, forces: str, **given: object) -> Criterion:
    return Criterion(name="drawn", g=g, forces=tuple(forces.split()), pressure=None, **given)  # type: ignore[arg-type]


def ball(c: Fraction, forces: str) -> str:
    """(s^2 + r^2)^2 - c s^4, s the first force: convex if and only if c <= 8/9."""
    first, *_ = names = forces.split()
    return f"({' + '.join(f'{x}**2' for x in names)})**2 - ({c})*{first}**4"


def dented(stated: Criterion) -> Evidence | None:
    return refuters.convexity_at_deepest_dents(FormulaSubject(stated))


@pytest.mark.parametrize("forces", ["a b c", pytest.param("a b c d", marks=pytest.mark.slow)])
@pytest.mark.parametrize("depth", [F(1, 9), F(1, 10**4), F(1, 10**10)])
def test_a_dent_however_slight_is_found(forces: str, depth: Fraction) -> None:
    found = dented(law(f"{ball(F(8, 9) + depth, forces)} - 1", forces))
    assert found is not None and found.witness is not None
    p, q, middle = ([F(found.witness.points[role][x]) for x in forces.split()] for role in ("p", "q", "midpoint"))
    assert [2 * m for m in middle] == [a + b for a, b in zip(p, q, strict=True)]

    def g(point: list[Fraction]) -> Fraction:
        return sum(x * x for x in point) ** 2 - (F(8, 9) + depth) * point[0] ** 4 - 1

    assert g(p) <= 0 and g(q) <= 0 < g(middle)


@pytest.mark.slow
@pytest.mark.parametrize("depth", [F(0), F(1, 10**10), F(1, 10)])
def test_none_is_found_where_there_is_none(depth: Fraction) -> None:
    assert dented(law(f"{ball(F(8, 9) - depth, 'a b c')} - 1", "a b c")) is None


def test_roots_and_sizes() -> None:
    """The root of a form, of any size, has the dents of the form."""
    size = {"k": Domain(positive=True)}
    assert dented(law(f"({ball(F(9, 10), 'a b c')} + a**4)**(1/4) - k", "a b c", parameters=size)) is None
    assert dented(law(f"({ball(F(9, 10), 'a b c')})**(1/4) - 3", "a b c")) is not None


def test_a_parameter_at_the_end_of_its_range() -> None:
    given = {"c": Domain(low=F(0), high=F(8, 9) + F(1, 10**6))}
    assert dented(law(f"{ball(F(0), 'x y z')} - c*x**4 - 1", "x y z", parameters=given)) is not None


def test_not_of_one_degree() -> None:
    """x^4 - x^2 + y^2 + z^2 <= 1 is waisted at x = 0."""
    assert dented(law("4*x**4 - 2*x**2 + y**2 + z**2 - 1", "x y z")) is not None
    assert dented(law("4*x**4 + 2*x**2 + y**2 + z**2 - 1", "x y z")) is None


def test_the_oracle_knows_known_thresholds() -> None:
    """x^4 + y^4 + c x^2 y^2 + small terms, and the ball above."""
    edge = [F(1), F(0), F(2), F(0), F(1), F(2), F(0), F(2)]
    assert [plane_quartics.convex([*edge, F(1, 9) + e]) for e in (F(1, 10**12), -F(1, 10**12))] == [True, False]
    gotoh = ["1", "-2.60", "3.75", "-2.79", "0.99", "6.29", "-7.72", "6.33", "8.96"]
    assert plane_quartics.convex([F(c) for c in gotoh])
    assert plane_quartics.convex([F(c) for c in ("1", "-2.60", "3.75", "-2.79", "0.99", "6.29", "-7.72", "6.33", "1")]) is False


NARROW = (  # beside a hollow that is broad and lies lower at every start
    "31633830716390426801*sx**4/54975581388800000000 + 389391161791595493199*sx**3*sy/68719476736000000000"
    " + 937049358035860506801*sx**2*sy**2/42949672960000000000"
    " + 4464801847059676615617*sx**2*t**2/1374389534720000000000"
    " + 13228938195145835493199*sx*sy**3/343597383680000000000"
    " + 8527053982299786588413*sx*sy*t**2/1374389534720000000000 + 4497506853339837520403*sy**4/171798691840000000000"
    " + 11853511173861647547607*sy**2*t**2/1374389534720000000000"
    " + 31373806095857290588413*t**4/1374389534720000000000 - 1"
)


def test_a_narrow_dent_beside_a_broad_hollow() -> None:
    stated = law(NARROW, "sx sy t")
    for method in (refuters.convexity_at_clear_dents, refuters.convexity_at_deepest_dents):
        found = method(FormulaSubject(stated))
        assert found is not None and found.witness is not None


@pytest.mark.parametrize(("depth", "seen"), [(F(1, 10**9), True), (F(0), False), (F(-1, 10**9), False)])
def test_what_is_all_but_flat_is_followed_at_once(depth: Fraction, seen: bool) -> None:
    found = refuters.convexity_at_clear_dents(FormulaSubject(law(f"{ball(F(8, 9) + depth, 'a b c')} - 1", "a b c")))
    assert (found is not None) is seen


def long_quartic(depth: Fraction, length: int) -> str:
    """The ball above and a fourth power beside its dents, which leaves two pairs of them; longer along a slanted axis."""
    a, b, c = "(x + 2*y + 2*z)/3", "(2*x + y - 2*z)/3", f"(2*x - 2*y + z)/{3 * length}"
    s, t, u = (f"({i}*{a} + {j}*{b} + {k}*{c})/7" for i, j, k in ((2, 3, 6), (3, -6, 2), (6, 2, -3)))
    return f"(({s})**2 + ({t})**2 + ({u})**2)**2 - ({F(8, 9) + depth})*({s})**4 + ({u})**4/10 - 1"


@pytest.mark.slow
@pytest.mark.parametrize("length", long_but([0], [30, 100]))
@pytest.mark.parametrize(
    ("depth", "seen"), long_but([0, 3], [(F(1, 10**3), True), (F(1, 10**6), True), (F(1, 10**9), True), (F(-1, 10**9), False)])
)
def test_dents_of_long_sets(length: int, depth: Fraction, seen: bool) -> None:
    stated = law(long_quartic(depth, length), "x y z")
    assert (dented(stated) is not None) is seen
    assert (refuters.convexity_at_clear_dents(FormulaSubject(stated)) is not None) is seen
