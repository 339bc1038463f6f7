"""Wrong answers that tools of proof are known to give, each put to duhem: it must not give them."""

from __future__ import annotations

import math
from fractions import Fraction

import flint
import pytest
import sympy as sp

from duhem import POSITIVE, Criterion, Domain, InputError, Verdict, Verification, verify
from duhem.expression import Neg, Norm, Pos, Where, symbol
from duhem.expression.balls import ball, enclose
from duhem.law.builtin.lobes import lobe_law
from duhem.proof.decide import Answer, Budget, Question, Sense, decide
from tests.long import long_at, long_but
from tests.oracles.reevaluation import confirmed

x, y, z = (symbol(name) for name in "xyz")
PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED


def _law(g: str, **rest: object) -> Criterion:
    return Criterion(name="law", g=g, **rest)  # type: ignore[arg-type]


def _refuted(found: Verification, claim: str) -> bool:
    result = found[claim]
    return result.verdict is REFUTED and result.witness is not None and confirmed(found.criterion, claim, result.witness)


# -- 1. kinks ignored: SymPy's is_convex is True for a concave kink, a jump, a concave minimum ---------------------------


@pytest.mark.parametrize(
    "g",
    [
        "where(sigma_a < 0, sigma_a, 0) - sigma_b",  # the region above a concave graph
        "min(sigma_a, 0) - sigma_b",
        "min(sigma_a + sigma_b, sigma_a - sigma_b)",
        "where(sigma_a > 0, 3*abs(sigma_n), 0) + sigma_b - abs(sigma_n)",  # a step
        "min(norm(sigma_a/2, sigma_b), norm(sigma_a, sigma_b/2)) - abs(sigma_n)",
        "norm(sigma_a, sigma_b) - abs(sigma_n) - abs(sigma_a)/2",
    ],
)
def test_a_concave_kink_is_not_convex(g: str) -> None:
    assert _refuted(verify(_law(g), claims=["convexity"]), "convexity")


@pytest.mark.parametrize(
    "g", ["max(sigma_a, 0) + sigma_b", "pos(sigma_a) + neg(sigma_b) - abs(sigma_n)", "max(sigma_a, sigma_b) - abs(sigma_n)"]
)
def test_a_convex_kink_is_convex(g: str) -> None:
    assert verify(_law(g), claims=["convexity"])["convexity"].verdict is PROVED


@pytest.mark.parametrize(
    "expr", [sp.Min(x, 0), Where(x < 0, x, sp.S.Zero), Pos(x) - Neg(-x) - 1, sp.Abs(x) - Pos(x) - Neg(x) - Pos(-x + 1)]
)
def test_the_decider_looks_at_every_branch(expr: sp.Expr) -> None:
    """Each is negative on one side only, or at one place only."""
    assert decide(Question(expr, Sense.NONNEGATIVE)).holds is not True


# -- 2. two-sided derivatives at a breakpoint ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("right", "left", "convex", "smooth"),
    long_but(
        [0, 1],
        [
            ("norm(sigma_a, sigma_b)", "norm(2*sigma_a, sigma_b)", True, True),  # both leave the b axis at a right angle
            ("norm(sigma_a, sigma_b) + sigma_a", "norm(sigma_a, sigma_b)", True, False),  # the gauge's slope jumps up
            ("norm(sigma_a, sigma_b)", "norm(sigma_a, sigma_b) + sigma_a/2", False, False),  # and down
            ("norm(sigma_a, sigma_b) + sigma_a/2", "norm(sigma_a, sigma_b) + sigma_a/2", True, True),
        ],
    ),
)
def test_slopes_at_a_breakpoint_are_one_sided(right: str, left: str, convex: bool, smooth: bool) -> None:
    found = verify(_law(f"where(sigma_a > 0, {right}, {left}) - abs(sigma_n)"), claims=["convexity", "smoothness"])
    for claim, true in (("convexity", convex), ("smoothness", smooth)):
        assert found[claim].verdict is PROVED if true else _refuted(found, claim), claim


# -- 3. delta-sat, unknown and time-outs refute nothing -----------------------------------------------------------------


def test_a_question_without_steps_stays_open() -> None:
    hard = sp.expand((x**2 + y**2 + z**2) ** 3 - 27 * x**2 * y**2 * z**2)
    assert decide(Question(hard, Sense.NONNEGATIVE), Budget(0)).holds is None


@pytest.mark.slow
@pytest.mark.parametrize("reason", ["unknown", "timeout", "delta-sat with a model that is not one"])
def test_an_open_decider_refutes_nothing(monkeypatch: pytest.MonkeyPatch, reason: str) -> None:
    """Whatever the deciders leave open, or suggest by a wrong model, a law that is convex is not refuted."""
    from duhem.proof.facts import subject

    def shrug(question: Question, budget: Budget | None = None) -> Answer:
        if reason.startswith("delta"):
            return Answer(False, "delta")
        return Answer(None, "none", reason=reason)

    monkeypatch.setattr(subject, "decide", shrug)
    for g in ("sigma_a**4 + 6*sigma_a**2*sigma_b**2 + sigma_b**4 - abs(sigma_n)**4", "norm(sigma_a/mu, sigma_b) - abs(sigma_n)"):
        found = verify(_law(g, parameters={"mu": POSITIVE} if "mu" in g else {}))
        assert not [r.claim for r in found.results if r.verdict is REFUTED]


def test_a_formula_beyond_the_rules_is_not_refuted_for_it() -> None:
    """Convex sets whose formulas are not composed by the rules: sqrt of a sum of squares, a norm of a maximum of signs."""
    for g in ("sqrt(sigma_a**2 + sigma_b**2) - abs(sigma_n)", "norm(max(sigma_a, -sigma_a/2), sigma_b) - abs(sigma_n)"):
        assert verify(_law(g), claims=["convexity"])["convexity"].verdict is PROVED


# -- 4. arbitrary x/0, negative roots, contradictory hypotheses ---------------------------------------------------------


@pytest.mark.parametrize(
    "expr",
    [
        1 / x**2,  # undefined at 0
        x / x**3,
        x / sp.Abs(x) + 1,
        (x**2 + y**2) / (x + y) ** 2,
    ],
)
def test_division_by_zero_proves_nothing(expr: sp.Expr) -> None:
    assert decide(Question(expr, Sense.POSITIVE)).holds is not True


@pytest.mark.parametrize(("expr", "sense"), [((x * y) / x - y, Sense.ZERO), (x / y * y - x, Sense.ZERO)])
def test_a_cancelled_denominator_is_gone_before_the_question(expr: sp.Expr, sense: Sense) -> None:
    """SymPy cancels these on sight; the identity is then true everywhere."""
    assert expr == 0 and decide(Question(expr, sense)).holds is True


def test_division_is_sound_both_ways() -> None:
    positive = symbol("p", positive=True)
    assert decide(Question(1 / positive - 1 / (positive + 1), Sense.POSITIVE)).holds is True
    assert decide(Question(1 / x - 1 / (x + 1), Sense.POSITIVE)).holds is not True  # false between -1 and 0
    assert decide(Question(1 / x, Sense.POSITIVE, (sp.StrictGreaterThan(x, 0),))).holds is True
    assert decide(Question(1 / x, Sense.POSITIVE, (sp.StrictLessThan(x, 0),))).holds is not True


@pytest.mark.parametrize(
    ("expr", "true"),
    [
        (-sp.sqrt(x**2 + 1) - x, False),  # true for the negative root
        (sp.sqrt(x**2 + 1) - 1, True),
        (1 - sp.sqrt(x**2 + 1), False),
        (x - Norm(x, y), False),
        (sp.Pow(x**2 + 1, sp.Rational(1, 4)) - 1, True),
        (1 - sp.Pow(x**2 + 1, sp.Rational(1, 4)), False),
        (sp.Pow(x**2 + 1, sp.Rational(1, 3)) - 1, True),
    ],
)
def test_roots_are_the_non_negative_ones(expr: sp.Expr, true: bool) -> None:
    answer = decide(Question(expr, Sense.NONNEGATIVE))
    assert answer.holds is True if true else answer.holds is not True


def test_a_square_that_vanishes_settles_the_question() -> None:
    """x^2 y >= 0 wherever x = 0, whatever y is: the square may be dropped from the goal only where it is not 0."""
    assert decide(Question(x**2 * y, Sense.NONNEGATIVE, (sp.Eq(x, 0),))).holds is True


def test_a_root_of_something_negative_proves_nothing() -> None:
    assert decide(Question(sp.sqrt(x) + 1, Sense.POSITIVE)).holds is not True
    assert decide(Question(sp.sqrt(x - 1) + 1, Sense.POSITIVE, (sp.GreaterThan(x, 0),))).holds is not True
    assert decide(Question(sp.sqrt(x - 1) + 1, Sense.POSITIVE, (sp.GreaterThan(x, 1),))).holds is True


@pytest.mark.parametrize("constraints", [["e > 1", "e < 0"], ["e < mu", "mu < e"], ["e**2 < 0"], ["mu < 0"], ["e**2 + mu**2 <= 0"]])
def test_contradictory_hypotheses_prove_nothing(constraints: list[str]) -> None:
    """Over an empty domain everything is true; such a law is refused, and not called admissible."""
    parameters = {"e": Domain(), "mu": POSITIVE}
    with pytest.raises(InputError, match=r"e|mu"):
        verify(_law("norm(sigma_a, sigma_b) - (e + mu)*abs(sigma_n)", parameters=parameters, constraints=constraints))


# -- 5. balls: even powers, truncation ----------------------------------------------------------------------------------


def test_the_trap_is_there() -> None:
    """A ball times itself forgets that both are the same: [-1, 2]^2 reaches below 0."""
    trap = flint.arb(0.5, 1.5)
    assert (trap * trap).lower() < 0


@pytest.mark.parametrize("expr", [x**2 + 1, x**4 - 2 * x**2 + 2, (x - y) ** 2 + 1, sp.exp(x) * x**2 + 1, x**2 * sp.exp(-y) + sp.exp(-x)])
def test_even_powers_are_seen_positive(expr: sp.Expr) -> None:
    bounds = tuple(r for s in (x, y) for r in (sp.GreaterThan(s, -1), sp.LessThan(s, 2)))
    assert decide(Question(expr, Sense.POSITIVE, bounds)).holds is True


@pytest.mark.slow
@pytest.mark.parametrize(
    "expr", [x**2 - sp.Rational(1, 10**6), sp.exp(x) - 1, sp.exp(x**2) - 1 - sp.Rational(1, 10**6), sp.cos(x) - sp.Rational(999, 1000)]
)
def test_a_dip_inside_the_box_is_not_missed(expr: sp.Expr) -> None:
    assert decide(Question(expr, Sense.POSITIVE, (sp.GreaterThan(x, -1), sp.LessThan(x, 2))), Budget(1_000_000)).holds is not True


@pytest.mark.parametrize("power", range(1, 9))
def test_balls_enclose_powers(power: int) -> None:
    low, high = Fraction(-1), Fraction(2)
    found = enclose(x**power, {x: ball(low, high)})
    for k in range(31):
        assert found.contains(flint.arb(flint.fmpq(k - 10, 10) ** power))


# -- 6. g not convex, K convex ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "g",
    [
        "sqrt(abs(sigma_a)) - sqrt(abs(sigma_n))",
        "sqrt(norm(sigma_a, sigma_b)) - sqrt(abs(sigma_n))",
        "tanh(norm(sigma_a, 2*sigma_b)/abs(sigma_n)) - 1/2",
        "(sigma_a**2 + sigma_b**2 - abs(sigma_n)**2)**3",
        "norm(sigma_a, sigma_b)**(1/3) - abs(sigma_n)**(1/3)",
    ],
)
def test_the_set_counts_not_the_function(g: str) -> None:
    assert verify(_law(g), claims=["convexity"])["convexity"].verdict is PROVED


# -- 7. convex on every quadrant, concave kink at a seam ----------------------------------------------------------------


@pytest.mark.slow
def test_a_concave_kink_at_a_seam_is_refuted() -> None:
    """Quarters of ellipses turned so that they meet pointing inward: each convex, the whole a star."""
    found = verify(_law("norm(sigma_a, sigma_b) - abs(abs(sigma_a) - abs(sigma_b))/2 - abs(sigma_n)"), claims=["convexity", "smoothness"])
    assert _refuted(found, "convexity") and _refuted(found, "smoothness")


@pytest.mark.parametrize("dent", ["1/1000", "1/1000000"])
def test_a_slight_kink_at_a_seam_counts(dent: str) -> None:
    inward, outward = (
        verify(_law(f"norm(sigma_a, sigma_b) {sign} {dent}*abs(sigma_a) - abs(sigma_n)"), claims=["convexity"]) for sign in "-+"
    )
    assert inward["convexity"].verdict is not PROVED
    assert outward["convexity"].verdict is PROVED


@pytest.mark.slow
@pytest.mark.parametrize("dent", long_but([2], ["1/1000", "1/1000000", "1e-12"]))
@pytest.mark.parametrize("seam", long_at([1], ["sigma_a", "sigma_a - 3*sigma_b", "sigma_a + sigma_b/7 - abs(sigma_n)/3"]))
def test_a_slight_kink_at_a_seam_is_refuted(dent: str, seam: str) -> None:
    """Between the rays of any scout: found on the seam itself."""
    assert _refuted(verify(_law(f"norm(sigma_a, sigma_b) - {dent}*abs({seam}) - abs(sigma_n)"), claims=["convexity"]), "convexity")


PIECES: dict[str, tuple[bool | None, bool]] = {  # without a gauge to read off; the truth by hand, each side of each seam
    "where(sigma_a > 0, sigma_a**4 + sigma_b**4 + sigma_a**2*sigma_b**2/2, sigma_b**4 + sigma_a**2) - 1": (True, True),
    "sigma_a**4 + sigma_b**4 + 5*sigma_a**2*sigma_b**2 + abs(sigma_a)/100 + sigma_a*sigma_b/7 - 1": (None, False),  # open: convex
    "sigma_a**4 + sigma_b**4 + 5*sigma_a**2*sigma_b**2 - 1e-9*abs(sigma_a) - 1": (False, False),
    "max(sigma_a**4 + sigma_b**4 + 3*sigma_a**2*sigma_b**2 - sigma_a*sigma_b/4, sigma_a**2 + sigma_b**4 + sigma_a/5) - 1": (None, False),
    "min(sigma_a**4 + sigma_b**4 + 3*sigma_a**2*sigma_b**2, sigma_a**2 + sigma_b**4 + sigma_a/5) - 1": (False, False),
    "min(max(sigma_a**2 + sigma_b**2 - 1, sigma_a - 1/2), max(sigma_a**2 + sigma_b**2 - 1, -sigma_a - 1/2))": (True, True),  # the disc
    "min(max(sigma_a**2 + sigma_b**2 - 1, sigma_a - 1/2), max(2*sigma_a**2 + sigma_b**2 - 1, -sigma_a - 1/2))": (False, False),
    "min(max(sigma_a - 1, abs(sigma_b) - 1), max(-sigma_a - 1, abs(sigma_b) - 1))": (True, True),  # a strip, from two overlapping ones
    "min(max(sigma_a - 1, abs(sigma_b) - 1), max(-sigma_a - 1, abs(sigma_b) - 1 - 1e-9))": (False, False),
}


@pytest.mark.slow
@pytest.mark.parametrize(("g", "truth"), long_but([2, 4, 8], PIECES.items()))
def test_seams_between_curved_pieces(g: str, truth: tuple[bool | None, bool]) -> None:
    found = verify(_law(g, pressure=None), claims=["convexity", "smoothness"])
    if truth[0] is None:  # K is convex, and no rule and no decider shows it; of the maximum each side is proved alone
        assert found["convexity"].verdict is Verdict.TESTED
    else:
        assert found["convexity"].verdict is PROVED if truth[0] else _refuted(found, "convexity")
    assert found["smoothness"].verdict is (PROVED if truth[1] else REFUTED)  # some corners are finer than the second opinion sees


# -- 8. zero margins ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "at"),
    [("superellipse", {"p": "4"}), ("limacon", {"e": "1/2"}), ("quartic", {"c": "6"}), ("quartic", {"c": "0"}), ("lobes", {"e": "1/10"})],
)
def test_zero_margins_are_proved(law: str, at: dict[str, str]) -> None:
    assert verify(law, at, claims=["convexity"])["convexity"].verdict is PROVED


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "at"), [("limacon", {"e": "0.50000001"}), ("quartic", {"c": "6.00000001"}), ("lobes", {"e": "-0.10000001"})]
)
def test_just_beyond_a_zero_margin_is_refuted(law: str, at: dict[str, str]) -> None:
    assert _refuted(verify(law, at, claims=["convexity"]), "convexity")


# -- 9. what sampling misses --------------------------------------------------------------------------------------------


_R = "norm(sigma_a, sigma_b)"
_WAVE = "(sigma_a**4 - 6*sigma_a**2*sigma_b**2 + sigma_b**4)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("e", "convex"),
    long_but([2, 5], [("0.0668", False), ("0.06666667", False), ("1/15", True), ("0.0666", True), ("-1/15", True), ("-0.0668", False)]),
)
def test_a_dent_that_random_chords_miss(e: str, convex: bool) -> None:
    """The gauge r (1 + e cos 4 theta) is convex if and only if |e| <= 1/15."""
    for g in (f"{_R} + {e}*{_WAVE}/{_R}**3 - abs(sigma_n)", f"{_R}**4 + {e}*{_WAVE} - abs(sigma_n)*{_R}**3"):
        found = verify(_law(g), claims=["convexity"])
        assert found["convexity"].verdict is PROVED if convex else _refuted(found, "convexity")


@pytest.mark.long
def test_a_fine_texture_is_not_missed() -> None:
    """Twelve lobes of depth 1/145 + 1e-6: the dents are narrow and shallow."""
    law = lobe_law(12)
    assert verify(law, {"e": "1/145"}, claims=["convexity"])["convexity"].verdict is PROVED
    assert _refuted(verify(law, {"e": "0.006898"}, claims=["convexity"]), "convexity")


# -- a flow of negative power is not in the normal cone of a K that holds 0 ----------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "factor",
    long_at(
        [0, 2],
        [
            "(sigma_a + 1/2)",
            "where(sigma_a > 0, 1, -1)",
            "where(sigma_a > -1/2, 1, -1)",
            "(sigma_a + 1 - 1/10**9)",
            "where(sigma_b > 9/10, -1, 1)",
        ],
    ),
)
def test_where_power_is_lost_the_slip_is_not_normal(factor: str) -> None:
    law = _law("norm(sigma_a, sigma_b) - 1", pressure=None, flow=(f"sigma_a*{factor}", f"sigma_b*{factor}"))
    found = verify(law, claims=["normality", "dissipation"])
    assert _refuted(found, "dissipation") and _refuted(found, "normality")


@pytest.mark.slow
@pytest.mark.parametrize("turn", ["1/10", "1/1000000000", "3/2"])
def test_a_refuted_normality_says_by_how_much_the_flow_turns_away(turn: str) -> None:
    witness = verify("rotated-flow", {"delta": turn}, claims=["normality"])["normality"].witness
    assert witness is not None
    (a, b), (c, d) = ([Fraction(witness.points[role][f"sigma_{x}"]) for x in "ab"] for role in ("inside", "outside"))
    size = Fraction(witness.parameters["mu"]) * Fraction(witness.points["inside"]["sigma_n"])
    way, along, short = (c - a) ** 2 + (d - b) ** 2, a * (c - a) + b * (d - b), a * a + b * b - size**2
    t = -float(short) / (float(along) + math.sqrt(along**2 - way * short))  # (a + t (c - a), b + t (d - b)) lies on the circle
    assert 0 <= t <= 1
    angle = math.radians(witness.measures["slip_angle_degrees"]) - math.atan2(b + t * (d - b), a + t * (c - a))
    assert math.isclose(math.radians(witness.measures["deviation_degrees"]), float(Fraction(turn)), rel_tol=1e-6)
    assert math.isclose(math.remainder(angle, math.tau), float(Fraction(turn)), abs_tol=1e-9)


def test_a_flow_without_a_value_at_boundary_points_is_looked_at_elsewhere() -> None:
    law = Criterion("half a flow", "norm(a, b) - 1", forces=("a", "b"), flow=("a/(b - abs(b))", "b"))
    found = verify(law, claims=["dissipation"])["dissipation"]  # b < 0: a^2/(2 b) + b^2 < 0 beside b = 0
    assert found.verdict is Verdict.REFUTED
    assert found.witness is not None and confirmed(law, "dissipation", found.witness)
