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
from duhem.proof.decide.rays import _alike, _opposite, _read, _Side, between_rays
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Verdict
from tests.oracles.prover import polar
from tests.oracles.prover.polar_form import polar_form

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


@pytest.mark.slow
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


FIRST, SECOND = y - root(2) * x, root(3) * x - y  # the lines through (1, sqrt(2)) and (1, sqrt(3))
INSIDE = (FIRST >= 0, SECOND >= 0)
SENSES = (Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO)


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
    answers = [asked(expr, sense, *given) for sense in SENSES]
    named = {Answer(True, "rays"): "yes", Answer(False, "rays"): "no", None: "open"}
    assert " ".join(named[a] if not isinstance(a, Question) else "less" for a in answers) == told


@pytest.mark.parametrize(
    ("expr", "given", "kept"),
    [
        (x * y, (*INSIDE, x >= 0), INSIDE),
        (x * y, (x + y > 0, *INSIDE, x >= 0), INSIDE),
        (x * y, (*INSIDE, *INSIDE), INSIDE),
        (x * y, (FIRST > 0, FIRST >= 0, SECOND >= 0), None),  # the first holds on no end that it bounds
        (x * y, (FIRST >= 0, SECOND >= 0), None),
        (x * y, (SECOND >= 0, FIRST <= 0, x >= 0, x + y >= 0), (FIRST <= 0, x + y >= 0)),
        (x * y, (SEAM >= 0,), None),  # a half-plane, and so below
        (-SEAM, (SEAM >= 0, 2 * SEAM >= 0), None),
        (-SEAM, (SEAM >= 0, SEAM > 0), None),
        (-SEAM, (SEAM <= 0, 2 * SEAM <= 0, 3 * SEAM < 0), None),
    ],
)
def test_what_bounds_a_sector_is_kept(expr: sp.Expr, given: tuple[sp.Basic, ...], kept: tuple[sp.Basic, ...] | None) -> None:
    assert asked(expr, Sense.NONNEGATIVE, *given) == (kept and Question(expr, Sense.NONNEGATIVE, kept, (x, y)))


def test_a_relation_that_is_0_in_disguise_bounds_nothing() -> None:
    """0 x >= 0 leaves the half-plane beside it whole, where SEAM is not 0."""
    nought = Norm(root(2), root(7)) - 3
    for given in ((nought * x >= 0, SEAM >= 0), (SEAM >= 0, sp.Eq(nought * y, 0)), (SEAM >= 0, nought * (x + y) > 0)):
        for expr, sense in ((-SEAM, Sense.NONNEGATIVE), (SEAM, Sense.POSITIVE), (SEAM, Sense.ZERO)):
            assert asked(expr, sense, *given) is None


def test_what_is_no_question_between_rays() -> None:
    p = sp.Symbol("p", positive=True)
    assert between_rays(Question(x, Sense.POSITIVE, (SEAM >= 0, x <= 0, y <= 0)), Budget(10**6)) is None
    assert asked(x, Sense.POSITIVE) is None and asked(p * x, Sense.POSITIVE, *INSIDE, x >= 0) is None
    assert asked(p * x, Sense.POSITIVE, sp.Eq(FIRST, 0), x > 0) is None
    assert asked(sp.S.NegativeOne, Sense.POSITIVE, sp.Eq(FIRST, 0), x > 0) == Answer(False, "rays")
    unknown = sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1
    assert asked(unknown * x, Sense.NONNEGATIVE, sp.Eq(FIRST, 0)) is None
    assert asked(x, Sense.NONNEGATIVE, *INSIDE, unknown * x - y <= 0) == Answer(True, "rays")
    assert asked(x, Sense.NONNEGATIVE, *INSIDE, root(2) * (1 + unknown) * x - y <= 0) is None


def test_relations_as_sides() -> None:
    a, b, circle, p = root(2), -root(3), (x, y), sp.Symbol("p", positive=True)
    for relation, strict in ((SEAM >= 0, False), (SEAM > 0, True), (sp.Le(0, SEAM), False), (sp.Lt(0, SEAM), True)):
        assert _read(relation, circle) == [_Side(a, b, strict, relation)]
    for relation, strict in ((SEAM <= 0, False), (SEAM < 0, True)):
        assert _read(relation, circle) == [_Side(-a, -b, strict, relation)]
    same = sp.Eq(a * x, -b * y)
    assert _read(same, circle) == [_Side(a, b, False, same), _Side(-a, -b, False, same)]
    assert _read(x >= 0, circle) == [_Side(1, 0, False, x >= 0)] and _read(y > x, circle) == [_Side(-1, 1, True, y > x)]
    odd = (sp.Ne(SEAM, 0), SEAM >= 1, x * y >= 0, x**2 + y >= 0, 1 / x >= 0, root(x) + y >= 0, p * x + y >= 0, x + p * y >= 0, sp.true)
    assert [relation for relation in odd if _read(relation, circle) is not None] == []


def test_rays_that_are_one_or_opposite() -> None:
    """Eight ways round, each of another length."""
    ways = [(1, 0), (root(3), 1), (0, 1), (-1, root(5)), (-1, 0), (-root(3), -1), (0, -1), (1, -root(5))]
    for (i, one), (j, two) in product(enumerate(ways), repeat=2):
        longer = (root(7) * two[0], root(7) * two[1])
        assert _alike(one, longer) is (i == j), (one, two)
        assert _opposite(one, longer) is (i % 4 == j % 4), (one, two)  # or the same


def test_signs_are_paid_for() -> None:
    """A thousand steps for each pair of sides; an equation has two."""
    for given, price in ((INSIDE, 4_000), ((sp.Eq(FIRST, 0), x >= 0), 9_000)):
        few, enough = Budget(price - 1), Budget(price)
        assert between_rays(Question(x, Sense.POSITIVE, given, (x, y)), few) is None and few.left == price - 1
        assert between_rays(Question(x, Sense.POSITIVE, given, (x, y)), enough) is not None and enough.left == 0


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
