"""Polynomial identities: what the kernel confirms by them is true, what is changed in them is refused."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from fractions import Fraction
from random import Random
from typing import Any

import pytest
import sympy as sp

from duhem import POSITIVE, Criterion, Domain, verify
from duhem.expression.parse import parse_expression
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel import claims as kernel_claims
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.search.boundary_identities import composed_of_sums, convex_sums, directions, inward, outward
from duhem.proof.verdict import Verdict
from tests.long import long_but, mostly_long

F = Fraction


def law(g: str, **given: Any) -> Criterion:
    return Criterion(name="drawn", g=g, **{"forces": ("a", "b"), "pressure": None, **given})


def confirmed(claim: str, rule: str, stated: Criterion, evidence: dict[str, Any]) -> bool:
    return not kernel_claims.objection(claim, rule, frozenset(), StatedLaw.read(law_as_text(stated)), evidence)


def quartic(c: F | str) -> Criterion:
    return law(f"a**4 + ({c})*a**2*b**2 + b**4 - 1")


def convex(stated: Criterion) -> dict[str, Any]:
    """What the search offers for the convexity of the sums."""
    return {"directions": directions(stated), "convex sums": [x for both in convex_sums(FormulaSubject(stated)).values() for x in both]}


def curved(stated: Criterion) -> dict[str, Any]:
    subject = FormulaSubject(stated)
    return {"outward": list(outward(subject)), "directions": directions(stated), "inward": list(inward(subject))}


def is_convex(stated: Criterion, evidence: dict[str, Any]) -> bool:
    return confirmed("convexity", "composition", stated, evidence)


# -- thresholds --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("gap", [F(1, 10**k) for k in (3, 6, 9)])
def test_the_quartic_is_convex_up_to_six(gap: F) -> None:
    for c in (6 - gap, F(6), gap, F(0)):
        assert is_convex(quartic(c), convex(quartic(c)))
    for c in (6 + gap, -gap):
        assert convex(quartic(c))["convex sums"] == []
        for near in (F(6), F(0)):
            assert not is_convex(quartic(c), convex(quartic(near)))


@pytest.mark.slow
def test_the_quartic_over_a_range_is_convex_up_to_six() -> None:
    g = "a**4 + c*a**2*b**2 + b**4 - 1"
    whole = law(g, parameters={"c": Domain.between(0, 6)})
    assert is_convex(whole, convex(whole))
    for low, high in (("0", "6.000000001"), ("-0.000000001", "6")):
        wider = law(g, parameters={"c": Domain.between(low, high)})
        assert not is_convex(wider, convex(whole))
    assert convex(wider)["convex sums"] == []


def test_a_gram_matrix_that_is_not_positive_by_a_trillionth_is_refused() -> None:
    """v . Hess g v = z' G z either way; G is semidefinite for c = 6 and not for c = 6 + e."""

    def evidence(c: F) -> dict[str, Any]:
        one = {"times": [], "of": ["a*v", "b*w"], "gram": [["12", str(2 * c)], [str(2 * c), "12"]]}
        two = {"times": [], "of": ["a*w", "b*v"], "gram": [[str(2 * c)] * 2] * 2}
        return {"directions": ["v", "w"], "convex sums": [{"strict": ["the goal"], "sums": [one, two], "multiples": []}]}

    assert is_convex(quartic(F(6)), evidence(F(6)))
    assert not is_convex(quartic(6 + F(1, 2 * 10**12)), evidence(6 + F(1, 2 * 10**12)))


@pytest.mark.slow
@pytest.mark.parametrize("gap", [F(0), F(1, 10**3), F(1, 10**9)])
def test_a_root_of_a_quadratic_form_is_convex_where_the_form_is_positive(gap: F) -> None:
    """Von Mises in plane stress spells it so."""

    def mises(e: F) -> Criterion:
        return law(f"sqrt(a**2 - ({e})*a*b + b**2 + 3*t**2) + a/5 - k", forces=("a", "b", "t"), parameters={"k": POSITIVE})

    def evidence(e: F) -> dict[str, Any]:
        return dict(composed_of_sums(FormulaSubject(mises(e))))

    inside = mises(2 - gap)
    assert is_convex(inside, evidence(2 - gap))
    assert is_convex(inside, {})  # the minors of its matrix show it too
    if gap:
        assert evidence(2 + gap) == {}
        assert not is_convex(mises(2 + gap), evidence(F(2)))
        assert not is_convex(mises(2 + gap), {})


def test_a_root_of_anything_else_is_not() -> None:
    """|a^2 - 1| <= 1/2 is a pair of strips, though what is under the root is >= 0 and its root is above a quadratic form's."""
    above = {"strict": ["the goal"], "sums": [{"times": [], "of": ["1", "a**2"], "gram": [["1", "-1"], ["-1", "1"]]}], "multiples": []}
    evidence = {"directions": ["v", "w"], "convex sums": [above, *convex(quartic(F(6)))["convex sums"]]}
    assert not is_convex(law("sqrt(a**4 - 2*a**2 + 1) - 1/2"), evidence)
    assert not is_convex(law("sqrt(a**4 - 2*a**2 + 1) + abs(b) - 1/2"), evidence)


@pytest.mark.parametrize("low", ["-1", "-3"])
def test_an_interval_needs_no_curvature(low: str) -> None:
    one = law("a**4 + c*a**2 - 1", forces=("a",), parameters={"c": Domain.between(low, 1)})
    rising = {"outward": list(outward(FormulaSubject(one)))}
    assert confirmed("convexity", "implicit-curvature", one, rising)
    assert not confirmed("convexity", "implicit-curvature", law("(a**2 - 1)*(a - 3)*(a - 4) - 12", forces=("a",)), rising)
    assert not confirmed("convexity", "implicit-curvature", law("a**4 - 3*a**2 + 1", forces=("a",)), rising)


# -- tampering ---------------------------------------------------------------------------------------------------------


def changed(value: Any) -> Iterator[Any]:
    """The value with one thing in it changed: a number, a name, a formula, a part left out."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from ({**value, key: other} for other in changed(part))
    elif isinstance(value, list):
        for i, part in enumerate(value):
            yield value[:i] + value[i + 1 :]
            yield from ([*value[:i], other, *value[i + 1 :]] for other in changed(part))
    elif value.lstrip("-").replace("/", "").isdigit():
        yield str(F(value) + F(1, 10**9))
    else:
        yield from ("the goal", "the boundary", "-1", "1 - a**2", "1/a", "a**(1/2)")


MIXED = law("a**4 + a**2*b**2 + b**4 + a**3 + a**2 - 1")  # convex, its part of degree 3 is not
BENT = law("a**4 + 9*a**2*b**2 + 4*b**4 + (2*a**2 + b**2)*abs(n)**2 - abs(n)**4", pressure="n")  # convex, g is not


@pytest.mark.slow
@pytest.mark.parametrize("most", mostly_long((20, 60), 20))
def test_what_is_changed_in_an_identity_is_refused(most: int) -> None:
    cases = [
        ("convexity", "composition", MIXED, convex(MIXED)),
        ("convexity", "implicit-curvature", BENT, curved(BENT)),
        ("dissipation", "boundary-power", BENT, {"outward": curved(BENT)["outward"]}),
    ]
    for claim, rule, stated, evidence in cases:
        assert confirmed(claim, rule, stated, evidence)
        others = [other for other in changed(copy.deepcopy(evidence)) if other != evidence]
        for other in Random(5).sample(others, min(most, len(others))):
            assert not confirmed(claim, rule, stated, other), other


@pytest.mark.parametrize("names", [["v"], ["v", "v"], ["a", "b"], ["v", "b"], ["v", "w", "u"], ["v", "c"], "vw", []])
def test_directions_have_names_of_their_own(names: Any) -> None:
    """A direction that is a force, a parameter or one too many would make another quadratic form."""
    stated = law("a**4 + 7*a**2*b**2 + b**4 + c - 1", parameters={"c": Domain.between(0, "1/2")})
    offered = [{"strict": ["the goal"], "sums": [], "multiples": []}, *convex(quartic(F(6)))["convex sums"]]
    assert not is_convex(stated, {"directions": names, "convex sums": offered})


# -- premises ----------------------------------------------------------------------------------------------------------


def test_a_second_piece_of_k_is_seen() -> None:
    """Two discs, each convex: the boundary curves inward everywhere, and no ray may leave K twice."""
    two = law("(a**2 + b**2 - 1)*((a - 5)**2 + b**2 - 1)")
    offered = curved(two)
    assert offered["outward"] == []
    disc = curved(law("a**2 + b**2 - 1"))
    assert not confirmed("convexity", "implicit-curvature", two, {**offered, "outward": disc["outward"], "inward": disc["inward"]})


def test_a_gradient_that_vanishes_on_the_boundary_is_seen() -> None:
    disc = {"outward": list(outward(FormulaSubject(law("a**2 + b**2 - 1"))))}
    assert confirmed("smoothness", "regular-value", law("a**2 + b**2 - 1"), disc)
    for g in ("(a**2 + b**2 - 1)**3", "(a**2 + b**2 - 1)**2", "(a**2 + b**2 - 1)*(a**2 + b**2)"):
        assert outward(FormulaSubject(law(g))) == ()
        cubed = g.endswith("3")  # the kernel undoes what keeps the sign: the boundary is that of the disc
        assert confirmed("smoothness", "regular-value", law(g), disc) is cubed


def test_a_boundary_through_the_origin_does_not_rise() -> None:
    for g in ("a**2 + b**2", "a**2 + b**2 - a", "a**4 + b**4 - a**2"):
        assert outward(FormulaSubject(law(g))) == ()


def test_what_is_undefined_somewhere_proves_nothing() -> None:
    evidence = convex(quartic(F(6)))
    assert not is_convex(law("a**5/a + 6*a**2*b**2 + b**4 - 1"), evidence)
    assert not is_convex(law("a**4 + 6*a**2*b**2 + b**4 - 1 + 0*log(c)", parameters={"c": Domain.between(0, 1)}), evidence)


@pytest.mark.slow
def test_each_piece_must_rise() -> None:
    """A union of half-planes and a disc; one of the faces has the origin behind it."""
    for last, holds in (("a + b - 1", True), ("a + b + 1", False)):
        stated = law(f"min(max(a - 2, -a - 3, b - 4), a**2 + b**2 - 4, {last})")
        offered = list(outward(FormulaSubject(stated)))
        assert bool(offered) is holds
        assert confirmed("dissipation", "boundary-power", stated, {"outward": offered}) is holds
        if holds:
            for i in range(len(offered)):
                assert not confirmed("dissipation", "boundary-power", stated, {"outward": offered[:i] + offered[i + 1 :]})


@pytest.mark.parametrize(("end", "holds"), [("3/2", True), ("8/5", False), ("31416/20000", False)])
def test_a_flow_turned_by_less_than_a_right_angle_dissipates(end: str, holds: bool) -> None:
    turned = ("a*cos(d) - b*sin(d)", "a*sin(d) + b*cos(d)")
    for low in (0, "-" + end):
        stated = law("norm(a, b) - 1", flow=turned, parameters={"d": Domain.between(low, end)})
        assert confirmed("dissipation", "boundary-power", stated, {}) is holds


def test_a_flow_of_its_own_may_need_the_boundary() -> None:
    """sigma . d = a^4 + b^4 - (1 - e)/2 on the circle, where a^4 + b^4 >= 1/2."""
    for e, holds in (("0", True), ("1/1000000", True), ("-1/1000000", False)):
        stated = law("a**2 + b**2 - 1", flow=(f"a**3 - a*(1 - ({e}))/2", f"b**3 - b*(1 - ({e}))/2"))
        offered = list(outward(FormulaSubject(stated)))
        assert bool(offered) is holds
        assert confirmed("dissipation", "boundary-power", stated, {"outward": offered}) is holds


# -- against exact chords ----------------------------------------------------------------------------------------------


def value(terms: dict[tuple[int, ...], F], point: tuple[F, ...]) -> F:
    total = F(0)
    for m, c in terms.items():
        for x, k in zip(point, m, strict=True):
            c *= x**k
        total += c
    return total


def drawn(random: Random, forces: int) -> dict[tuple[int, ...], F]:
    """A quartic near the edge of convexity: squares of quadratics and some odd terms."""
    m = [tuple((i == j) + (i == k) for i in range(forces)) for j in range(forces) for k in range(j, forces)]
    terms: dict[tuple[int, ...], F] = {}
    for _ in range(3):
        square = {k: F(random.randint(-4, 4), 2) for k in m}
        for p, c in square.items():
            for q, d in square.items():
                k = tuple(map(int.__add__, p, q))
                terms[k] = terms.get(k, F(0)) + c * d
    for i in range(forces):
        k = tuple(4 * (i == j) for j in range(forces))
        terms[k] = terms.get(k, F(0)) + random.randint(0, 12)
    return terms


@pytest.mark.slow
def test_no_chord_leaves_what_is_confirmed() -> None:
    random, seen = Random(9), {True: 0, False: 0}
    for forces in (2, 2, 3) * 6:
        terms, names = drawn(random, forces), "abc"[:forces]
        text = " + ".join("*".join([f"({c})", *(f"{x}**{k}" for x, k in zip(names, m, strict=True))]) for m, c in terms.items())
        stated = law(f"{text} - 1", forces=tuple(names))
        holds = is_convex(stated, convex(stated))
        seen[holds] += 1
        for _ in range(200 if holds else 0):
            p, q = (tuple(F(random.randint(-9, 9), random.randint(1, 4)) for _ in names) for _ in "pq")
            middle = tuple((x + y) / 2 for x, y in zip(p, q, strict=True))
            assert 2 * value(terms, middle) <= value(terms, p) + value(terms, q)
    assert min(seen.values()) > 2


# -- as a whole --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_polynomial_law_is_proved_and_checked() -> None:
    """Three forces and a parameter: the quartic of Gotoh (1977) for steel, of any size."""
    p = "sx**4 - 2.6*sx**3*sy + 3.75*sx**2*sy**2 - 2.79*sx*sy**3 + 0.99*sy**4 + (6.29*sx**2 - 7.72*sx*sy + 6.33*sy**2)*t**2 + 8.96*t**4"
    found = verify(law(f"{p} - k**4", forces=("sx", "sy", "t"), parameters={"k": POSITIVE}), claims=["convexity"])["convexity"]
    assert (found.verdict, found.method, found.trust) == (Verdict.PROVED, "composition", "checked")


@pytest.mark.long
def test_zeros_of_the_second_derivative_in_skew_coordinates() -> None:
    """A sum of few fourth powers, and (s^2 + r^2)^2 - c s^4 at its edge c = 8/9: the squares must vanish at zeros far from any axis."""
    powers = " + ".join(f"({a}*x + ({b})*y + ({c})*z)**4" for a, b, c in ((1, 2, -1), (F(3, 2), -1, 4), (-2, F(1, 3), 1), (1, 1, 5)))
    s, r, q = "(2*x - y/2 + z)", "(x + 5/2*y - z/2)", "(3/2*x - 2*y + z)"
    for p, holds in (
        (powers, True),
        (f"({s}**2 + {r}**2 + {q}**2)**2 - 8/9*{s}**4", True),
        (f"({s}**2 + {r}**2 + {q}**2)**2 - (8/9 + 1/10**9)*{s}**4", False),
    ):
        stated = law(f"{sp.expand(parse_expression(p, {x: sp.Symbol(x, real=True) for x in 'xyz'}))} - 1", forces=("x", "y", "z"))
        evidence = convex(stated)
        assert bool(evidence["convex sums"]) == is_convex(stated, evidence) == holds


def test_a_sum_that_does_not_change_along_a_direction() -> None:
    """Of three principal stresses only the differences count, with a fourth force beside them; what is left out is left out soundly."""
    u, v = "(s1 - s3)", "(s2 - s3)"
    for c, holds in (("6", True), ("7", False)):
        stated = law(f"{u}**4 + {c}*{u}**2*{v}**2 + {v}**4 + t**4 - 1", forces=("s1", "s2", "s3", "t"))
        evidence = convex(stated)
        assert is_convex(stated, evidence) == holds
    other = law(f"{u}**4 + 6*{u}**2*{v}**2 + {v}**4 + t**4 - s3**4/10**6 - 1", forces=("s1", "s2", "s3", "t"))
    good = law(f"{u}**4 + 6*{u}**2*{v}**2 + {v}**4 + t**4 - 1", forces=("s1", "s2", "s3", "t"))
    assert not is_convex(other, convex(good))


@pytest.mark.slow
@pytest.mark.parametrize(("over", "holds"), long_but([0], [(-F(1, 10**9), True), (F(1, 10**9), False)]))
def test_a_margin_in_which_a_solver_drowns(over: Fraction, holds: bool) -> None:
    """The same beside the edge, in four forces: the numbers are of one size only in units of their own."""
    s, r, q, p = "(2*x - y/2 + z)", "(x + 5/2*y - z/2)", "(3/2*x - 2*y + z + w)", "(x - w)"
    form = parse_expression(
        f"({s}**2 + {r}**2 + {q}**2 + {p}**2)**2 - (8/9 + ({over}))*{s}**4", {x: sp.Symbol(x, real=True) for x in "xyzw"}
    )
    stated = law(f"{sp.expand(form)} - 1", forces=("x", "y", "z", "w"))
    assert is_convex(stated, convex(stated)) == holds


@pytest.mark.parametrize(
    "long",
    [
        "(1 + a + b + c + d + e + f)**60",  # two hundred million terms
        "(a + b + cos(a)*(a**2 + b**2 + c**2 + d**2 + e**2 + f**2))**16",  # a polynomial in cos a, though none in the forces
        pytest.param("(1 + (a + b + c)**50)**19", marks=pytest.mark.long),
    ],
)
def test_what_is_too_long_or_no_polynomial_is_not_multiplied_out(long: str) -> None:
    """It would not end."""
    stated = law(f"{long} + ((a**2 + b**2)**3 + a**6)**2 - 1", forces=("a", "b", "c", "d", "e", "f"))
    a, b = stated.force_symbols()[:2]
    assert {(a**2 + b**2) ** 3 + a**6, a**2 + b**2} <= set(convex_sums(FormulaSubject(stated)))
