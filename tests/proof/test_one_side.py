"""A ball without a gap: one side left, which is convex, though no rule says so; two sides, with a chord between them."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from duhem import Criterion
from duhem.law.domain import Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.claims import convexity
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.methods.refuters import convexity_at_far_points
from tests.long import long_but
from tests.oracles.prover.curvature import convex_in_its_region
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.reevaluation import confirmed

SHEAR = "2*sqrt(a**2 + 3*b**2) - 4"  # |a + b| <= 4/sqrt(3) on it, |a| <= 2, |b| <= 2/sqrt(3)
CASES = [
    ("max(norm(a, b) - 1, 1/4 - (a + 3/4)**2)", True),  # the gap |a + 3/4| < 1/2 holds -1/4
    ("max(norm(a, b) - 1, 1/16 - (a + 3/4)**2)", False),  # one point is left on the other side
    ("max(norm(a, b) - 1, 1/25 - (a + 3/4)**2)", False),
    (f"max({SHEAR}, 1001/1000 - (a - 1)**2)", True),
    (f"max({SHEAR}, 1 - (a - 1)**2)", False),  # a = 2 is left
    (f"max({SHEAR}, 2 - abs(a - 1))", True),
    (f"max({SHEAR}, 39/25 - abs(a + b - 3/4))", True),  # 4/sqrt(3) - 3/4 is about 1.559
    (f"max({SHEAR}, 31/20 - abs(a + b - 3/4))", False),
    ("max(a**2 + 4*b**2 - 4, 3/2 - (a/2 + b + 1/4)**2)", True),  # a/2 + b <= sqrt(2)
    ("max(a**2 + 4*b**2 - 4, 1 - (a/2 + b + 1/4)**2)", False),
    ("max(a**2 + 4*b**2 - 4, 3/2 - (a/2 + b + 1/4)**2*a**2)", False),  # of two loads
    ("max(norm(a, b) - r, r**2 - (a + r)**2)", True),
    ("max(norm(a, b) - r, r**2/16 - (a + r/2)**2)", False),
    ("max(norm(a, b) - 1, a - 1/2, 1/4 - (a - 1/2)**4)", True),  # up to a load
    ("max(norm(a, b) - 1, a - 2, 1/4 - (a - 1/2)**2)", False),  # the load and the ball are beyond the gap
    ("max(norm(a, b) - 1, 1/4 - sqrt(abs(a - 1/2)))", False),  # not concave
    ("max(norm(a, b) - 1, 2 - cosh(a - 3/4))", True),
    ("max(1 - norm(a, b), 1/4 - (a + 3/4)**2)", False),  # the ball is what is left out
    ("max(norm(a, b) - c, 9/16 - (a + 3/4)**2)", False),  # 1 <= c <= 2: for c = 2 the gap is crossed
    ("max(norm(a, b)/c - 1/2, c**2/4 - (a + c/4)**2)", True),  # |a| <= c/2
]
PARAMETERS = {"r": Domain(positive=True), "c": Domain.between(1, 2)}


def law(g: str) -> Criterion:
    own = {name: domain for name, domain in PARAMETERS.items() if name in g.replace("sqrt", "").replace("norm", "").replace("cosh", "")}
    return Criterion(name="law", g=g, forces=("a", "b"), pressure=None, parameters=own)


def subject(criterion: Criterion) -> FormulaSubject:
    found = AskedSubject(criterion)
    found.allow(4_000_000)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("g", "convex"), long_but([0, 1, 4, 5, *range(10, 13), 15, 16, 18, 19], CASES))
def test_one_side_is_a_half_space(g: str, convex: bool) -> None:
    assert convex_in_its_region(subject(law(g))).quasiconvex is convex
    assert convex or not convexity(StatedLaw.read(law_as_text(law(g))), {})


@pytest.mark.parametrize(
    "g",
    [
        "max(norm(a, b) - 1, 1/100 - (a + 4/5)**2)",
        "max(norm(a, b) - 1, 1/16 - (a + 3/4)**2)",  # one point is left on the other side
        "max(norm(a, b) - 1, 1/16 - 1/10**9 - (a + 3/4)**2)",
        "max(norm(a - 1, 2*b) - 3/2, (2 - 1/10**12)**2/4 - (a - 1/2)**2)",
        "max(a**2 + a*b + 3*b**2 - 1, 1/100 - a**2 - 4*a*b - 4*b**2)",  # the gap written out
        "max(2*sqrt(a**2 + 3*b**2) - 4, (a + b - 1)*(2 - a - b))",  # a gap between two loads
        "max(norm(a, b) - r, r**2/2 - (a - b)**2)",
    ],
)
def test_a_chord_leads_from_one_side_to_the_other(g: str) -> None:
    criterion = law(g)
    found = convexity_at_far_points(subject(criterion))
    assert found is not None and found.witness is not None
    assert confirmed(criterion, "convexity", found.witness)


@pytest.mark.slow
def test_a_cap_that_ends_before_the_other_side_is_not_refuted() -> None:
    for g in (*(g for g, convex in CASES if convex), "max(norm(a, b) - 1, a - 1/2, b - 1/3)"):
        assert convexity_at_far_points(subject(law(g))) is None


@pytest.mark.long
def test_drawn_gaps_against_the_distance_of_their_ends() -> None:
    """{|L s| <= 1, |y . L s + m| >= c}: of both sides something is left if and only if c <= |y| - |m|, all in fractions."""
    rng, seen = Random(4), set[bool]()
    for _ in range(12):
        k, m = rng.choice((1, 2, 3)), Fraction(rng.randint(-12, 12), 4)
        y, size = rng.choice((((3, 4), 5), ((k, 0), k), ((5, -12), 13)))
        c = max(Fraction(1, 10), size - abs(m) + Fraction(rng.choice((-1, 0, 0, 1)), rng.choice((2, 10**8))))
        rows = (f"(a + {k}*b)", f"(2*a - b/{k})")
        g = f"max(norm({', '.join(rows)}) - 1, ({c})**2 - (({y[0]})*{rows[0]} + ({y[1]})*{rows[1]} + ({m}))**2)"
        two = c <= size - abs(m)
        if not abs(m) < size or c >= size + abs(m):
            continue  # the gap is not met, or nothing is left
        seen.add(two)
        shown = convex_in_its_region(subject(law(g))).quasiconvex
        chord = convexity_at_far_points(subject(law(g)))
        assert (shown, chord is not None) == (not two, two), g
        assert not (two and convexity(StatedLaw.read(law_as_text(law(g))), {})), g
    assert seen == {True, False}
