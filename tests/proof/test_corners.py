"""Corners in more than two forces: edges and tips are found and shown, and what only looks like one is not."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from random import Random

import pytest

from duhem import Criterion, Domain, Verdict, verify
from duhem.expression.number import rational
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import refuters
from duhem.proof.search.corners import centred_choices
from tests.long import long_but
from tests.oracles.reevaluation import confirmed

J2 = "((a-b)**2+(b-c)**2+(c-a)**2)/6"
J3 = "(2*a-b-c)*(2*b-c-a)*(2*c-a-b)/27"
POSITIVE = Domain(positive=True)


def law(g, forces=("a", "b", "c"), **parameters):
    """What makes it when a test asks for it."""
    return partial(Criterion, "law", g, parameters, forces=forces, pressure=None)


def long(one):
    return pytest.param(one, marks=pytest.mark.long)


CORNERED = [
    law("max(a, b, c) - f", f=POSITIVE),  # edges
    long(law("abs(a)/m + abs(b)/m + abs(c)/n - 1", m=POSITIVE, n=POSITIVE)),
    law("max(a**2 + b**2 + c**2 - 1, a - 1/2)"),  # a circle cut out of a sphere
    long(law("max(a**2 + b**2 + c**2 - 4, (a - 1)**2 + 2*b**2 + c**2 - 3, a - b - 2)")),  # irrational edges
    long(law("max(a - b + (a + b)*sin(phi), b - c + (b + c)*sin(phi), c - a + (c + a)*sin(phi)) - 1", phi=Domain.between("0.3", "0.4"))),
    law("norm(a, b) - m*c", m=POSITIVE),  # tips
    long(law(f"sqrt({J2}) + h*(a + b + c) - k", h=POSITIVE, k=POSITIVE)),
    long(law("norm(a - b, c) + a + b - 1")),
    long(law(f"sqrt({J2}) - exp(-(a + b + c)/3) + 1")),  # at a place that is no fraction
    long(law(f"sqrt({J2})*(2 + ({J3})/({J2})**(3/2)) + a + b + c - 1")),  # 0/0 at the tip itself
    long(law("min(a**2 + b**2 + c**2 - 1, (a - 1)**2 + b**2 + c**2 - 1)")),  # inward
    long(law("norm(a, b, c) + where(a > 0, a, a/2) - 1")),
    law("abs(a - x) - r - s", forces=("a", "x", "r"), s=POSITIVE),
    long(law("max(abs(a + b - c + d), abs(a - d), abs(b + c))/sqrt(6) - t", forces=("a", "b", "c", "d"), t=POSITIVE)),
]


@pytest.mark.slow
@pytest.mark.parametrize("one", long_but([0, 12], CORNERED))
def test_a_corner_is_shown(one):
    one = one()
    found = refuters.smoothness_at_corners(FormulaSubject(one))
    assert found is not None and found.witness is not None
    assert confirmed(one, "smoothness", found.witness)


SMOOTH = [
    law(f"sqrt({J2} + 1/100) + (a + b + c)/5 - 1"),  # a tip rounded off
    law("a**2 + b**2 + c**2 - 1"),
    law("max(a**2 + b**2 + c**2 - 1, a - 2)"),  # a face that K does not reach
    long(law("max(norm(a, b, c), 1/2) - 1")),  # a kink inside K
    long(law("norm(a, b, c) + pos(norm(a, b, c) - 2) - 1")),  # outside it
    long(law("pos(a)**2 + 2*neg(a)**2 + b**2 + c**2 - 1")),  # the gradient is continuous
    long(law("norm(pos(a)/2 + neg(a)/3, b, c) - 1")),
    long(law("max(norm(a, b, c) - 1, 2*(norm(a, b, c) - 1))")),  # it jumps in size alone
    law("(a**2 + b**2)**(3/2) + c**2 - 1"),  # a root of higher degree, 0 on the boundary
    long(law("max(a**2 + b**2 + c**2 - 1, a**2 + b**2 + 2*c**2 - 1)")),  # two faces that touch
]


@pytest.mark.slow
@pytest.mark.parametrize("one", long_but([1, 8], SMOOTH))
def test_what_is_smooth_has_no_corner(one):
    assert refuters.smoothness_at_corners(FormulaSubject(one())) is None


TWO = ("a", "b")
SHARP = [
    law("norm(a, b) - m*c", m=POSITIVE),
    law("a**2 + b**2 - c**2"),  # two cones
    law("max(-a, -b, -c, a*b*c - a**2*b - b**2*c - c**2*a)"),
    law("b**2 - (1 - a)**3*(1 + a)", TWO),  # a cusp
    law("max(a, a**3 + b**2)", TWO),
    law("exp(norm(a, b)) - 1 + 2*a", TWO),  # no polynomial along a ray
    law("max(((a - b)/2)**2 - ((a + b)/2)**2*(1 + (a + b)/2), a + b)", TWO),
    # cones of odd degree: of two opposite directions one lies in K always
    law("(a + b + c)*(a*b + b*c + c*a) - k*a*b*c", k=Domain.between(10, 20)),  # Matsuoka and Nakai (1974)
    law("k*a*b*c - (a + b + c)**3", k=Domain.between(28, 60)),  # Lade and Duncan (1975)
    law("b*(b - a)*(b + 3*a)", TWO),
    law("b*(b - a)*(b + 3*a) + a**4 - b**5", TWO),
]


@pytest.mark.slow
@pytest.mark.parametrize("one", long_but([1, 3, 5, 6], SHARP))
def test_a_sharp_point_is_shown(one):
    one = one()
    found = refuters.smoothness_at_sharp_points(FormulaSubject(one))
    assert found is not None and found.witness is not None
    assert confirmed(one, "smoothness", found.witness)


NOT_SHARP = [
    law("a**2 + b**2 - 2*a", TWO),  # 0 on a smooth boundary
    law("a**4 + b**4 - a", TWO),  # a flat one
    law("a**3 + a*b**2", TWO),
    law("a**5 + a**3*b**2 + b**6", TWO),
    law("a**3 + b**3", TWO),  # the gradient is 0 and K a half-plane
    law("b**3 - a**5", TWO),  # the gradient is 0, and the boundary C^1
    law("b**3 - a**4 + b**2*a**2", TWO),
    law("max(a**2 + b**2 - 2*a, a**2 + b**2 - 4*a)", TWO),  # two circles that touch
    law("exp(a) - 1 + b**2", TWO),
    law("where(a > 0, a - b**2, a + b**2)", TWO),  # it jumps
    law("a**2 + b**2 - (1/10**9)*a", TWO),
    law("norm(a, b, c) - 1 + a"),
]


@pytest.mark.parametrize("one", NOT_SHARP)
def test_a_smooth_boundary_has_no_sharp_point(one):
    assert refuters.smoothness_at_sharp_points(FormulaSubject(one())) is None


FROM_0 = Domain.between(0)
BETWEEN_0_AND_1 = Domain.between(0, 1)
AT_AN_END = [  # of the range of a: every way that shows it lies in the range, and g has a value on each
    (law("norm(b/h, c) - a*(1 - a)", h=POSITIVE), BETWEEN_0_AND_1),
    (law("(b/h)**2 + c**2 - 2*e*b*c/h - (4*a**p*(1 - a)**p)**2", e=Domain.between("-1/2", "1/2"), h=POSITIVE,
         p=Domain.between("7/10", 1)), BETWEEN_0_AND_1),  # as of Houlsby and Cassidy (2002): at p = 1 alone
    (law("abs(b) - a*(phi + d*exp(-k*a))", TWO, phi=Domain.between("2/5", "3/5"), d=Domain.between("1/20", "1/5"), k=POSITIVE), FROM_0),
    (law("abs(b) - m*a", TWO, m=POSITIVE), FROM_0),
    (law("abs(b) - m*a", TWO, m=BETWEEN_0_AND_1), FROM_0),  # at m = 0 K is a line
    (law("b**2 - a**3", TWO), FROM_0),  # a cusp
    (law("abs(b) - a**(3/2)", TWO), FROM_0),
    (law("abs(b) - (-a)**(3/2)", TWO), Domain.between(None, 0)),
]  # fmt: skip
ROUND_AT_AN_END = [
    (law("abs(b) - a**(1/2)", TWO), FROM_0),
    (law("b**2 + c**2 - a"), FROM_0),
    (law("abs(b)**(3/2) - a", TWO), FROM_0),
    (law("abs(a) + b - 1", TWO), FROM_0),  # its kink is at the end of the range
    (law("b - m*a", TWO, m=POSITIVE), FROM_0),
    (law("max(b - a, b - 2*a)", TWO), FROM_0),  # two pieces that meet at the end of the range
    (law("(b/h)**2 + c**2 - (4*a**p*(1 - a)**p)**2", h=POSITIVE, p=Domain.between("7/10", "9/10")), BETWEEN_0_AND_1),
    (law("norm(a, b) - 1", TWO), Domain.between("1/2")),
]


def within(one, **ranges):
    return replace(one(), domain=ranges)


@pytest.mark.parametrize(("one", "span"), AT_AN_END)
def test_a_sharp_point_at_an_end_of_a_range_is_shown_from_inside_the_range(one, span):
    one = within(one, a=span)
    found = refuters.smoothness_at_sharp_points(FormulaSubject(one))
    assert found is not None and found.witness is not None and confirmed(one, "smoothness", found.witness)
    ways = [point for role, point in found.witness.points.items() if role != "corner"]
    assert all(rational(Fraction(point["a"])) in span for point in ways)
    assert rational(Fraction(found.witness.points["corner"]["a"])) in (span.low, span.high)


@pytest.mark.parametrize(("one", "span"), ROUND_AT_AN_END)
def test_a_boundary_that_is_round_or_flat_at_an_end_of_a_range_has_no_sharp_point(one, span):
    assert refuters.smoothness_at_sharp_points(FormulaSubject(within(one, a=span))) is None


@pytest.mark.parametrize("seed", range(12))
def test_a_power_has_a_sharp_point_at_an_end_of_a_range_from_degree_one_on(seed):
    """|b| <= m a^p, a >= 0, comes to its end along a for p < 1, where it is round, and else in a corner or a cusp."""
    draw = Random(seed)
    p, m = Fraction(draw.randint(3, 24), 12), Fraction(draw.randint(1, 30), 10)
    one = within(law(f"abs(b) - {m}*a**({p})", TWO), a=FROM_0)
    found = verify(one, claims=["smoothness"])["smoothness"]
    assert found.verdict is not Verdict.PROVED and (found.verdict is Verdict.REFUTED) == (p >= 1)


JOINED = [  # two boundaries that meet, or one and the seam, where g jumps
    law("where(b < 1, abs(a) - 1 - b, (a/2)**2 + (b - 1)**2 - 1)", forces=TWO),  # a cone with an elliptic cap
    law("where(a > 0, a**2 + b**2 - 1, 3*(a + abs(b) - 1))", forces=TWO),
    law("where(3*max(a, b) + min(a, b) > 0, max(a, b) - t, (a - b)**2/(8*t) + a + b)", forces=TWO, t=POSITIVE),  # Griffith (1924)
    law("max(where(a > 0, a**2 + c**2, -a), where(b > 0, b**2 + c**2, b**2/4 - b + c**2)) - 1"),  # as of Hashin (1980)
]
KUPFER = "where(A <= 0, (A + B)**2 + B + 3.65*A, where(B <= 0, A - t*(1 + 0.8*B), A - t))"  # Kupfer, Gerstle (1973)
IN_MANY_PIECES = {
    True: [KUPFER, KUPFER.removesuffix("A - t))") + "A + B/2 - t))"],
    False: [
        "where(A <= 0, norm(A, B) - t, where(B <= 0, norm(A, B) - t, sqrt((A**4 + B**4 + 2*A**2*B**2)**(1/2)) - t))",
    ],
}


@pytest.mark.parametrize(("g", "cornered"), [(g, cornered) for cornered, laws in IN_MANY_PIECES.items() for g in laws])
def test_corners_of_a_formula_in_too_many_pieces_are_found_by_going_around_it(g, cornered):
    one = law(g.replace("A", "max(a, b)").replace("B", "min(a, b)"), TWO, t=Domain.between("0.06", "0.12"))()
    subject = FormulaSubject(one)
    assert subject.pieces is None
    found = refuters.smoothness_at_corners(subject)
    assert (found is not None) is cornered
    assert found is None or (found.witness is not None and confirmed(one, "smoothness", found.witness))


SMOOTHLY_JOINED = [  # g jumps, the outward normal does not
    law("where(a > 0, a**2 + b**2 - 1, 5*(a**2 + b**2 - 1))", forces=TWO),
    law("where(a > 0, a**2 + b**2 - 1, abs(b) - 1)", forces=TWO),
    law("where(a > 0, norm(a, b) - 1, a**2 + b**2 - 1)", forces=TWO),
    law("where(a > 0, a**2 + b**2 + c**2 - 1, 5*(a**2 + b**2 + c**2 - 1))"),
]


@pytest.mark.parametrize("one", JOINED)
def test_a_corner_is_shown_where_g_jumps(one):
    one = one()
    found = refuters.smoothness_at_corners(FormulaSubject(one))
    assert found is not None and found.witness is not None and confirmed(one, "smoothness", found.witness)


@pytest.mark.parametrize("one", SMOOTHLY_JOINED)
def test_a_jump_of_g_alone_is_no_corner(one):
    assert refuters.smoothness_at_corners(FormulaSubject(one())) is None


def test_a_root_of_strengths_is_no_polynomial_of_one() -> None:
    """Tsai and Wu (1971) with a free coupling: the determinant of its matrix has powers Xt^(9/2)."""
    domains = {**dict.fromkeys(("Xt", "Xc", "Yt", "Yc"), POSITIVE), "f": Domain(low=-3, high=3)}
    g = "a*(1/Xt - 1/Xc) + b*(1/Yt - 1/Yc) + a**2/(Xt*Xc) + b**2/(Yt*Yc) + f*a*b/sqrt(Xt*Xc*Yt*Yc) - 1"
    one = Criterion("coupled", g, domains, TWO)
    (found,) = verify(one, claims="smoothness").results
    assert found.verdict.value == "refuted" and found.witness is not None and confirmed(one, "smoothness", found.witness)


@pytest.mark.parametrize(("factor", "found"), [("tan(p)", False), ("exp(p)", False), ("sqrt(p)", True), ("p**(1/2)*q**(3/2)", True)])
def test_centres_of_a_quadratic_law_with_words_of_parameters_are_found_where_numbers_are_rational(factor, found):
    known = {"p": Domain.between("1/10", "4/5"), "q": Domain.between(1, 2), "c": Domain.between(-1, 1)}
    subject = FormulaSubject(Criterion("law", f"a**2 + b**2 + {factor}*a*b + 0*q - c", known, ("a", "b"), None))
    zeros = [{str(x): value for x, value in choice.items()}["c"] == 0 for choice in centred_choices(subject)]
    assert any(zeros) is found
