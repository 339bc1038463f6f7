"""What the kernel's rules ask for besides, each where it alone is wanting: something false would be confirmed, or nonsense read."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from typing import Any

import pytest

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.constant_value import BITS, Enclosure, enclosed
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.deviatoric import Invariants, convex_in_deviator
from duhem.proof.kernel.forms import at_end_of
from duhem.proof.kernel.pieces import CHOICES, pieces
from duhem.proof.kernel.plane_function import plain
from duhem.proof.kernel.plane_gauge import arcs
from duhem.proof.kernel.polynomial import times, total
from duhem.proof.kernel.signs import _quotient
from duhem.proof.kernel.spectrum import freed_of_roots, quasiconvex_with_parts_freed
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.proof.small_laws import confirmed, domain, law, poly
from tests.proof.test_kernel_boundary import DISC, RISES, identity

F = Fraction
UNIT = 1 << BITS


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("abs(a - q*b)", "depends on the constants"), ("a**q", "an exponent is no number"), ("exp(a)", "exp is not read along a ray"),
        ("(a + 2*b)**25", "may be <= 0"), ("norm(a, b) + (a**4 + b**4)**(1/4)", "different roots are added"),
        ("max(norm(a, 2*b), a)", "roots are compared"), ("a*q/e", "a constant may be undefined"), ("sqrt(a)", "under a root may be <= 0"),
        ("1/norm(a, 0)", "what is divided by"),
    ],
)  # fmt: skip
def test_why_a_formula_is_not_read_along_the_rays(text: str, why: str) -> None:
    with pytest.raises(NotWritten, match=why):
        list(arcs(parse(text), ("a", "b"), domain()))


def test_powers_up_to_twelve_are_read_along_the_rays() -> None:
    assert len(list(arcs(parse("(a + 2*b)**12"), ("a", "b"), domain()))) == 2


@pytest.mark.parametrize("text", ["a*sqrt(-2)", "a*sqrt(0)", "a/sqrt(0)", "sqrt(-1)**2"])
def test_roots_of_numbers_that_are_not_positive_are_no_roots_of_primes(text: str) -> None:
    with pytest.raises(NotWritten):
        plain(poly(text), domain())


LONG = "(a + b + m + q + e)**6*(a + 2*b + m + q + e)**6"  # it is not multiplied out


@pytest.mark.parametrize("text", [f"abs({LONG}) + abs(b)", f"abs(a) + {LONG} + b*abs(a)"])
def test_of_what_is_too_long_nothing_is_shown(text: str) -> None:
    for sides in ({}, {parse("a"): False}):
        found = domain().where(sides).facts(parse(text))
        assert found.defined and not (found.convex or found.concave or found.quasiconvex)


def test_where_g_jumps_k_may_end() -> None:
    """K is what of a disc lies beyond a = 1/2: where it ends there the slip is (-1, 0), and its power -1/2."""
    nowhere = identity(["1"], [], [("the boundary", "-1")])  # of g = 1
    evidence = {"outward": [RISES, nowhere]}
    assert confirmed("dissipation", "boundary-power", law(DISC), evidence)
    for g in (f"where(a > 1/2, {DISC}, 1)", f"where(a <= 1/2, 1, {DISC})", f"max({DISC}, where(a > 1/2, -1, 1))"):
        assert not confirmed("dissipation", "boundary-power", law(g), evidence)
        assert not confirmed("smoothness", "regular-value", law(g), evidence)
        assert not confirmed("normality", "parallel", law(g, flow=["a", "b"]), {"along": [RISES, nowhere]}, "convexity")
    assert confirmed("normality", "parallel", law(DISC, flow=["a", "b"]), {"along": [RISES]}, "convexity")


def test_so_it_may_where_an_angle_jumps() -> None:
    """Where a = 0 > b, K = {b angle <= 0} has no neighbours with a < 0; g is < 0 there, and so is the power."""
    shares, jumping = {"share": "1", "rest": "0"}, law("b*atan2(a, k)", flow=["0", "atan2(a, k)"])
    assert not confirmed("dissipation", "power-share", jumping, shares)
    assert not confirmed("dissipation", "boundary-power", jumping, {"outward": [identity(["the goal"], [], [("the boundary", "1")])]})
    assert confirmed("dissipation", "power-share", law("b*atan(a)", flow=["0", "atan(a)"]), shares)


def test_what_is_no_curve_in_the_plane() -> None:
    given: dict[str, Any] = {"pressure": "s", "angle": "phi", "boundary": ["cos(phi)", "sin(phi)"], "constraints": [], "parameters": {}}
    assert StatedCurve.read({**given, "forces": ["a", "b"], "flow": ["1", "phi"]}).flow is not None
    for forces, flow in (
        (["a"], None),
        (["a", "b", "c"], None),
        (["a", "b"], ["1"]),
        (["a", "b"], ["1", "0", "0"]),
        (["a", "b"], ["1", "b"]),
    ):
        with pytest.raises(NotWritten):
            StatedCurve.read({**given, "forces": forces, "flow": flow})


def test_angles_all_around() -> None:
    box = {"x": Enclosure(-2 * UNIT, 2 * UNIT)}
    low, high = enclosed(parse("atan2(x, -1)"), box)
    assert (low, high) == (-high, high) and 0 <= high / UNIT - 3.141592653589793 < 1e-15
    right, above = enclosed(parse("atan2(x, 1)"), box), enclosed(parse("atan2(1, x)"), box)
    assert -1.1072 < right.low / UNIT < -1.1071 and 1.1071 < right.high / UNIT < 1.1072  # atan 2
    assert 0.4636 < above.low / UNIT < 0.4637 and 2.6779 < above.high / UNIT < 2.678
    assert enclosed(parse("atan2(-1, x)"), box) == above.minus()
    for text in ("atan2(x, 0)", "atan2(0, x)", "eigmax(1, 1, 1, 0, 0, 0)"):
        with pytest.raises(ValueError, match=r"angle|eigmax"):
            enclosed(parse(text), box)


def test_invariants_that_depend_on_each_other_tell_a_polynomial_by_some_of_them() -> None:
    a, second = parse("a"), poly("a**2")
    for third in ({}, poly("a**3")):
        k, shares = Invariants((a,), second, third).of(poly("a**6"))
        told = (reduce(times, [second] * ((6 - 3 * j) // 2) + [third] * j, share) for j, share in shares.items())
        assert k == 6 and total(*told) == poly("a**6")


@pytest.mark.parametrize(("p", "q"), [((1, 0, 1), (1, 1)), ((1, 0, 3), (0, 2)), ((0, 1), (1, 1)), ((1, 1), (2, 3))])
def test_what_does_not_divide_has_no_quotient(p: tuple[int, ...], q: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="does not divide"):
        _quotient(p, q)


@pytest.mark.parametrize("load", ["e*a", "q*a + e*b", "(m - p)*a", "a*b", "a**2"])
def test_a_load_that_may_be_no_load_has_no_end(load: str) -> None:
    with pytest.raises(NotWritten):
        at_end_of(parse(load), parse(load), domain())


@pytest.mark.parametrize(
    ("load", "term", "end"),
    [
        ("a - m", "2*a + 3", "2*m + 3"),
        ("m*a + b", "exp(0) - b + pos(b + a*m) - m*a", "1"),
        ("m*a + b", "m*a + b + p", "p"),
        ("k*b - 1", "b*k*2", "2"),
        ("a - b + 1", "abs(b - a)", "1"),
    ],
)
def test_where_a_load_ends(load: str, term: str, end: str) -> None:
    here = domain()
    assert here.polynomial(at_end_of(parse(load), parse(term), here)) == poly(end)
    with pytest.raises(NotWritten):
        at_end_of(parse(load), parse(f"{term} + a + 2*b"), here)


def test_a_choice_by_no_comparison_has_no_pieces() -> None:
    a, b = parse("a"), parse("b")
    with pytest.raises(NotWritten):
        list(pieces(Term("where", (a, a, b)), domain(), CHOICES))


@pytest.mark.parametrize("potential", ["m*norm(x, y) + 0*a", "m*norm(x, y) + 0*z", "m*norm(x, y) + 0*s + z - z"])
@pytest.mark.parametrize("flat", [[], ["0*z"]])
def test_a_support_function_speaks_of_slips_and_parameters(potential: str, flat: list[str]) -> None:
    evidence = {"potential": potential, "slips": {"a": "x", "b": "y"}, "flat": flat}
    stated = law("norm(a, b) - m")
    assert objection("duality", "polar-gauge", frozenset(), stated, evidence) == "the rule 'polar-gauge' does not show it"
    assert confirmed("duality", "polar-gauge", stated, evidence | {"potential": "m*norm(x, y)", "flat": []})


def test_names_that_stand_for_parts_are_not_given_twice() -> None:
    """A rule that is asked again, of a formula in which its own names stand already, would take two parts for one."""
    stated = law("a", ["a", "b", "c"])
    spread, rooted = parse("max(a, b, c) - min(a, b, c)"), parse("exp(norm(a, b)) + exp(-norm(a, b))")
    most, least = "max(a, b, c)", "min(a, b, c)"
    cubes = parse(f"abs({most})**3 + abs({least})**3 + abs(a + b + c - {most} - {least})**3")
    assert quasiconvex_with_parts_freed(cubes, over(stated)) is not None
    for taken in ("greatest of matrix 0", "least of matrix 0"):
        again = over(stated._replace(forces=(*stated.forces, taken)))
        assert quasiconvex_with_parts_freed(cubes, again) is None
    again = over(stated._replace(forces=(*stated.forces, "root 0")))
    for here, name in ((over(stated), "root 0"), (again, "root 0 inside")):
        assert {z.name for freed in freed_of_roots(rooted, here) for z in freed.parts} == {name}
        assert all(freed.domain.law.forces == (*here.law.forces, name) for freed in freed_of_roots(rooted, here))
    known = convex_in_deviator(spread, over(stated))
    assert known is not None and known.convex
    again = over(stated._replace(forces=(*stated.forces, "greatest deviator")))
    assert convex_in_deviator(spread, again) is None


def test_no_more_than_eight_roots_are_freed() -> None:
    stated = law("a", ["a", "b"])
    for count, freed in ((8, 2), (9, 0)):
        term = parse(" + ".join(f"norm(a, b, {i + 1})**3" for i in range(count)))
        assert len([*freed_of_roots(term, over(stated))]) == freed
