"""Numbers with roots have one exact sign; sectors and rays between such directions against a walk round the circle."""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin
from random import Random

import pytest
import sympy as sp

from duhem import Criterion, verify
from duhem.expression import Norm
from duhem.proof.decide.budget import Budget
from duhem.proof.decide.question import Answer, Question, Sense
from duhem.proof.decide.radicals import sign_of_radicals
from duhem.proof.decide.rays import between_rays
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.polar_form import polar_form
from duhem.proof.methods import polar
from duhem.proof.verdict import Verdict

x, y = sp.symbols("x y", real=True)
root, tiny = sp.sqrt, sp.Rational(1, 10**80)
DENESTED = root(2) + root(3) - root(5 + 2 * root(6))


@pytest.mark.parametrize(
    ("number", "sign"),
    [
        (DENESTED, 0),
        (DENESTED + tiny, 1),
        (DENESTED - tiny, -1),
        (root(2) + root(3) - root(5 + 2 * root(6) + tiny), -1),
        (1 / (root(2) - 1) - root(2) - 1, 0),
        (1 / (root(2) - 1) - root(2) - 1 - tiny, -1),
        (sp.cbrt(2 + root(5)) - sp.cbrt(root(5) - 2) - 1, 0),  # Cardano's formula
        (sp.cbrt(2 + root(5)) - sp.cbrt(root(5) - 2) - 1 + tiny, 1),
        (sp.Rational(7, 3) ** sp.Rational(3, 4) * sp.Rational(7, 3) ** sp.Rational(-1, 4) - root(21) / 3, 0),
        (Norm(root(2), root(7)) - 3, 0),
        (Norm(root(2), root(7)) - 3 + tiny, 1),
        (sp.S.Zero, 0),
        (sp.log(2) - sp.log(3) + sp.log(sp.Rational(3, 2)), None),  # 0, but of another kind
        (sp.log(2), 1),
        (root(root(2) - 2), None),  # not real
        (root(2) ** sp.Rational(1, 3001) - sp.Pow(2, sp.Rational(1, 6002)) + 0 * root(3), 0),
    ],
)
def test_the_sign_of_a_number(number: sp.Expr, sign: int | None) -> None:
    assert sign_of_radicals(number) == sign


def test_what_is_not_0_is_told_from_it() -> None:
    random = Random(3)
    for _ in range(60):
        a, b, c = (random.randint(1, 30) for _ in range(3))
        d = root(a) + sp.Rational(random.randint(-9, 9), 7) * sp.Rational(b, c) ** sp.Rational(1, 4)
        zero = sp.expand(d**2) ** 2 - d**4
        assert sign_of_radicals(zero) == 0
        step = sp.Rational(random.choice((1, -1)), 10 ** random.randint(1, 120))
        assert sign_of_radicals(zero + step) == sp.sign(step)


def asked(expr: sp.Expr, sense: Sense, *given: sp.Basic) -> Answer | Question | None:
    return between_rays(Question(expr, sense, given, (x, y)), Budget(10**6))


SEAM = root(2) * x - root(3) * y


@pytest.mark.parametrize(
    ("expr", "sense", "given", "holds"),
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
        (x**2, Sense.POSITIVE, (SEAM >= 0, x <= 0, y <= 0), None),
        (-x, Sense.POSITIVE, (SEAM >= 0,), None),  # a half-plane
        (x + y**2, Sense.POSITIVE, (sp.Eq(SEAM, 0), y > 0), None),  # not homogeneous
        (1 / (root(2) * x - root(3) * y), Sense.NONNEGATIVE, (sp.Eq(SEAM, 0),), None),  # undefined
        (x, Sense.NONNEGATIVE, (sp.Eq(SEAM, 1),), None),
        (x, Sense.NONNEGATIVE, (x**2 >= root(2) * y**2,), None),
        (x, Sense.NONNEGATIVE, (x - y >= 0, y >= 0), None),  # fractions
    ],
)
def test_on_a_ray_it_is_a_number(expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...], holds: bool | None) -> None:
    answer = asked(expr, sense, *given)
    assert (answer.holds if isinstance(answer, Answer) else None) is holds


def test_what_is_left_out_says_nothing_more() -> None:
    random, seen = Random(4), dict.fromkeys((Answer, Question, type(None)), 0)
    numbers = [s * root(n) for n, s in product((1, 2, 3, 4), (1, -1))] + [sp.S.Zero]
    turns = [2 * pi * k / 999 for k in range(999)]
    for _ in range(60):
        pairs = [[random.choice(numbers) for _ in range(2)] for _ in range(random.randint(2, 4))]
        signs = [random.choice((sp.Ge, sp.Gt)) for _ in pairs]
        given = [r(a * x + b * y, 0) for (a, b), r in zip(pairs, signs, strict=True)]
        if any(not r.free_symbols for r in given):
            continue
        answer = asked(sp.S.NegativeOne, Sense.NONNEGATIVE, *given)
        kept = answer.given if isinstance(answer, Question) else None
        sides = [(float(a), float(b)) for a, b in pairs]
        where = [t for t in turns if all(a * cos(t) + b * sin(t) > 1e-9 for a, b in sides)]
        if isinstance(answer, Answer):
            assert not where
        if kept is not None:
            left = [side for side, r in zip(sides, given, strict=True) if r in kept]
            assert len(where) == sum(all(a * cos(t) + b * sin(t) > 1e-9 for a, b in left) for t in turns)
        seen[type(answer)] += 1
    assert min(seen.values()) > 5


K, SIZE = "(1 + sqrt(2))", "sqrt(4 + 2*sqrt(2))"  # of the ray (-k, 1) and its size
PIECES = f"where(-a <= {K}*abs(b), norm(a, b), ({K}/{SIZE} + e)*(-a) + ({SIZE} - {K}*({K}/{SIZE} + e) + f)*abs(b)) - 1"


@pytest.mark.parametrize(
    ("e", "f", "convex", "smooth"),
    [
        ("0", "0", True, True),
        pytest.param("1/10**6", "0", True, False, marks=pytest.mark.slow),
        pytest.param("-1/10**6", "0", False, False, marks=pytest.mark.slow),
        ("0", "1/10**6", False, False),
    ],
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
