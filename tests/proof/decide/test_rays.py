"""Numbers with roots have one exact sign, and so has what is asked in sectors and on rays between such directions."""

from __future__ import annotations

import pytest
import sympy as sp

from duhem import Criterion, verify
from duhem.expression import Norm
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Verdict
from tests.long import long_at, long_but
from tests.oracles.prover import polar
from tests.oracles.prover.polar_form import polar_form

x, y = sp.symbols("x y", real=True)
root, tiny = sp.sqrt, sp.Rational(1, 10**80)
DENESTED = root(2) + root(3) - root(5 + 2 * root(6))
SENSES = (Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO)


@pytest.mark.parametrize(
    ("number", "sign"),
    long_but(
        [1, 4, 5, 8, 10, 11],
        [
            (DENESTED, 0),
            (DENESTED + tiny, 1),
            (DENESTED - tiny, -1),
            pytest.param(root(2) + root(3) - root(5 + 2 * root(6) + tiny), -1, marks=pytest.mark.long),
            (1 / (root(2) - 1) - root(2) - 1, 0),
            (1 / (root(2) - 1) - root(2) - 1 - tiny, -1),
            (sp.cbrt(2 + root(5)) - sp.cbrt(root(5) - 2) - 1, 0),  # Cardano's formula
            (sp.cbrt(2 + root(5)) - sp.cbrt(root(5) - 2) - 1 + tiny, 1),
            (sp.Rational(7, 3) ** sp.Rational(3, 4) * sp.Rational(7, 3) ** sp.Rational(-1, 4) - root(21) / 3, 0),
            (Norm(root(2), root(7)) - 3, 0),
            (Norm(root(2), root(7)) - 3 + tiny, 1),
            (sp.S.Zero, 0),
            (sp.log(2), 1),
        ],
    ),
)
def test_the_sign_of_a_number(number: sp.Expr, sign: int) -> None:
    answers = [decide(Question(number, sense)).holds is True for sense in SENSES]
    assert answers == [sign >= 0, sign > 0, sign == 0]


SEAM = root(2) * x - root(3) * y


@pytest.mark.parametrize(
    ("expr", "sense", "given", "holds"),
    long_at(
        [7],
        [
            (root(3) * x - 3 * y / root(2), Sense.ZERO, (SEAM >= 0, SEAM <= 0), True),
            (root(3) * x - 3 * y / root(2), Sense.ZERO, (sp.Eq(SEAM, 0),), True),
            (root(3) * x - 3 * y / root(2) + tiny * x, Sense.ZERO, (sp.Eq(SEAM, 0),), False),
            (x + y, Sense.POSITIVE, (sp.Eq(SEAM, 0),), False),  # there are two rays
            (x + y, Sense.POSITIVE, (sp.Eq(SEAM, 0), y > 0), True),
            (root(5 * x**2) - root(3) * x - root(2) * root(y**2), Sense.POSITIVE, (sp.Eq(SEAM, 0), x >= 0), False),
            (root(x**2 + y**2) - root(5) * y / root(2), Sense.NONNEGATIVE, (sp.Eq(SEAM, 0), x >= 0), True),
            (root(x**2 + y**2) - root(5) * y / root(2) - tiny * y, Sense.NONNEGATIVE, (sp.Eq(SEAM, 0), x >= 0), False),
            (-x, Sense.POSITIVE, (SEAM >= 0, x <= 0, y >= 0), True),  # there is no such place but 0
            (-x, Sense.POSITIVE, (SEAM >= 0, x <= 0, y <= 0), False),  # a sector with its ends
            (-x, Sense.POSITIVE, (SEAM >= 0, x < 0, y <= 0), True),
            (-x, Sense.POSITIVE, (SEAM > 0, x <= 0, y <= 0), False),
            (-x - tiny * y, Sense.NONNEGATIVE, (SEAM >= 0, x <= 0, y <= 0), True),
            (-x + tiny * y, Sense.NONNEGATIVE, (SEAM >= 0, x <= 0, y <= 0), False),
            (SEAM, Sense.POSITIVE, (SEAM > 0, x <= 0, y <= 0), True),
            (SEAM, Sense.POSITIVE, (SEAM >= 0, x <= 0, y <= 0), False),
            (2 * SEAM, Sense.ZERO, (SEAM >= 0, x <= 0, y <= 0), False),
            (x**2, Sense.POSITIVE, (SEAM >= 0, x <= 0, y <= 0), False),
            (-x, Sense.POSITIVE, (SEAM >= 0,), False),  # a half-plane
            (x + y**2, Sense.POSITIVE, (sp.Eq(SEAM, 0), y > 0), True),  # not homogeneous
            (x, Sense.NONNEGATIVE, (sp.Eq(SEAM, 1),), False),
            (x, Sense.NONNEGATIVE, (x**2 >= root(2) * y**2,), False),
            (x, Sense.NONNEGATIVE, (x - y >= 0, y >= 0), True),  # fractions
        ],
    ),
)
def test_on_a_ray_it_is_a_number(expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...], holds: bool) -> None:
    assert decide(Question(expr, sense, given, (x, y))).holds is holds


FIRST, SECOND = y - root(2) * x, root(3) * x - y  # the lines through (1, sqrt(2)) and (1, sqrt(3))
INSIDE = (FIRST >= 0, SECOND >= 0)


@pytest.mark.parametrize(
    ("given", "expr", "told"),
    [
        (INSIDE, FIRST, "yes no no"),  # 0 on the one end
        (INSIDE, SECOND, "yes no no"),
        (INSIDE, x, "yes yes no"),
        (INSIDE, -FIRST, "no no no"),
        (INSIDE, -x, "no no no"),
        (INSIDE, 2 * y - 3 * x, "no no no"),  # changes its sign inside
        (INSIDE, (Norm(root(2), root(7)) - 3) * x, "yes no yes"),  # 0 that does not show
        ((FIRST > 0, SECOND >= 0), FIRST, "yes yes no"),
        ((FIRST > 0, SECOND >= 0), SECOND, "yes no no"),
        ((FIRST >= 0, SECOND > 0), FIRST, "yes no no"),
        ((FIRST >= 0, SECOND > 0), SECOND, "yes yes no"),
        ((FIRST > 0, SECOND > 0), -FIRST, "no no no"),
        ((FIRST > 0, SECOND > 0), 2 * y - 3 * x, "no no no"),
        ((sp.Eq(FIRST, 0), x > 0), x, "yes yes no"),  # a ray
        ((sp.Eq(FIRST, 0), x > 0), -x, "no no no"),
        ((sp.Eq(FIRST, 0), x > 0), FIRST, "yes no yes"),
        ((sp.Eq(FIRST, 0), x > 0), x**3 - y * x**2 / root(2), "yes no yes"),
        ((sp.Eq(FIRST, 0), x >= 0), sp.S.One, "yes yes no"),
        ((sp.Eq(FIRST, 0),), x, "no no no"),  # both rays
        ((sp.Eq(FIRST, 0),), x**2, "yes yes no"),
        ((2 * FIRST >= 0, 3 * FIRST >= 0, FIRST <= 0), x**2, "yes yes no"),  # the line again
        ((2 * FIRST <= 0, FIRST >= 0, FIRST <= 0), x, "no no no"),
        ((FIRST >= 0, 2 * FIRST >= 0, FIRST <= 0, 3 * x >= 0, x >= 0), x, "yes yes no"),  # said twice
        ((sp.Eq(FIRST, 0), sp.Eq(SECOND, 0)), sp.S.NegativeOne, "yes yes yes"),  # nowhere on the circle
        ((FIRST > 0, -FIRST > 0), sp.S.NegativeOne, "yes yes yes"),
        ((FIRST > 0, FIRST <= 0), sp.S.NegativeOne, "yes yes yes"),
        ((FIRST >= 0, SECOND >= 0, x < 0), sp.S.NegativeOne, "yes yes yes"),
        ((FIRST >= 0, SECOND <= 0, x < 0), -x, "yes yes no"),
    ],
)
def test_three_senses(given: tuple[sp.Basic, ...], expr: sp.Expr, told: str) -> None:
    assert " ".join("yes" if decide(Question(expr, sense, given, (x, y))).holds else "no" for sense in SENSES) == told


def test_what_is_undefined_on_a_ray() -> None:
    assert decide(Question(1 / SEAM, Sense.NONNEGATIVE, (sp.Eq(SEAM, 0),), (x, y))).holds is None


K, SIZE = "(1 + sqrt(2))", "sqrt(4 + 2*sqrt(2))"  # of the ray (-k, 1) and its size
PIECES = f"where(-a <= {K}*abs(b), norm(a, b), ({K}/{SIZE} + e)*(-a) + ({SIZE} - {K}*({K}/{SIZE} + e) + f)*abs(b)) - 1"


@pytest.mark.parametrize(
    ("e", "f", "convex", "smooth"),
    long_but(
        [0, 3],
        [
            ("0", "0", True, True),
            pytest.param("1/10**6", "0", True, False, marks=pytest.mark.slow),
            pytest.param("-1/10**6", "0", False, False, marks=pytest.mark.slow),
            ("0", "1/10**6", False, False),
        ],
    ),
)
def test_a_circle_with_tangents_from_a_ray_with_roots(e: str, f: str, convex: bool, smooth: bool) -> None:
    """At b = 0 the tangents meet; ``e`` turns them about the ray, ``f`` lets them miss it."""
    g = PIECES.replace("+ e)", f"+ ({e}))").replace("+ f)", f"+ ({f}))")
    subject = FormulaSubject(Criterion(name="law", g=g, forces=("a", "b"), pressure=None))
    subject.allow(16_000_000)
    assert (polar.convexity(subject) is not None) is convex
    form = polar_form(subject)
    assert (form is not None) is (f == "0")
    if form is not None:
        jumps = [
            subject.ask(form.slope(two) - form.slope(one), Sense.ZERO, *where, circle=(form.x, form.y)).holds
            for one, two, where in form.seams()
        ]
        assert jumps.count(False) == (1 if smooth else 3)  # the tangents' own, and those on the rays


@pytest.mark.long
def test_modes_that_meet_on_rays_with_roots() -> None:
    results = verify("puck", claims=["convexity", "smoothness", "normality", "dissipation"]).results  # Puck, Schürmann (1998)
    assert {r.verdict for r in results} == {Verdict.PROVED}
