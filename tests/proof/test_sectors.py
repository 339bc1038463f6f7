"""Functions of the ordered principal values of a deviator: Willam and Warnke's section, written so that it has a value everywhere.

Its threshold is the literature's, 1/2 <= e <= 1; at e = 1/2 it is Rankine's triangle, at e = 1 a circle.  Drawn sections are held against
f'' + f on a grid of the angle.  Where the formula is 0/0 and has no limit, nothing is proved of it.
"""

from __future__ import annotations

import math
from fractions import Fraction
from random import Random

import pytest

from duhem import Criterion, verify
from duhem.expression.balls import ball
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.plane_section import PlaneSection, local_pieces
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but, mostly_long
from tests.proof import small_laws
from tests.proof.composed import by_kernel, by_prover

X = "(sqrt(3/2)*(principal(s, 1) - I1(s)/3))"
W = f"sqrt(4*(1 - e**2)*{X}**2 + (5*e**2 - 4*e)*2*J2(s))"
PRINTED = f"(4*(1 - e**2)*{X}**2 + (2*e - 1)**2*2*J2(s))/(2*(1 - e**2)*{X} + (2*e - 1)*{W})"
WILLAM = f"where(J2(s) > 0, {PRINTED}, 0)"
COSINE = "cos(lode(s))"
LODE = (
    f"sqrt(J2(s))*(4*(1 - e**2)*{COSINE}**2 + (2*e - 1)**2)"
    f"/(2*(1 - e**2)*{COSINE} + (2*e - 1)*sqrt(4*(1 - e**2)*{COSINE}**2 + 5*e**2 - 4*e))"
)
TIP = " + 0.2*I1(s) - 1"
FIRST, LAST = "(principal(s, 1) - I1(s)/3)", "(principal(s, 3) - I1(s)/3)"

GAPS = f"e*(2*{FIRST} + {LAST}) - {FIRST} - 2*{LAST} - 1"  # e (s1 - s2) + (s2 - s3)


def e(low: str, high: str) -> dict[str, Domain]:
    return {"e": Domain.between(low, high)}


CASES = [
    (WILLAM + TIP, e("0.6", "0.6"), True),
    (WILLAM + TIP, e("0.8", "0.8"), True),  # the root is one of a square
    (WILLAM + TIP, e("0.5", "0.5"), True),
    (WILLAM + TIP, e("1/2", "1"), True),
    (WILLAM + TIP, e("0.499", "0.499"), False),
    (WILLAM + TIP, e("0.49", "1"), False),
    (WILLAM + TIP, e("0.6", "1.01"), False),  # the root has no value
    (f"where(J2(s) <= 0, 0, {PRINTED})" + TIP, e("0.6", "0.6"), True),
    (WILLAM.replace("J2(s) > 0", "J2(s) >= 0") + TIP, e("0.6", "0.6"), False),  # 0/0 is chosen
    (WILLAM.replace("J2(s) > 0", "J2(s) > 1") + TIP, e("0.6", "0.6"), False),
    (WILLAM.replace("J2(s) > 0", "I1(s)**2 > 0") + TIP, e("0.6", "0.6"), False),
    (WILLAM[:-2] + "1)" + TIP, e("0.6", "0.6"), False),  # it jumps on the axis
    (PRINTED + TIP, e("0.6", "0.6"), True),  # 0/0 on the axis, where it tends to 0
    (WILLAM.replace("2*J2(s)", "2.1*J2(s)") + TIP, e("0.6", "0.6"), False),
    (f"3*J2(s) + 0.4*({WILLAM}/sqrt(6) + I1(s)/3) - 1", e("0.52", "0.52"), True),  # Menetrey and Willam
    (f"3*J2(s) - 0.4*({WILLAM}/sqrt(6) + I1(s)/3) - 1", e("0.52", "0.52"), False),
    (f"exp({WILLAM}/3) + exp(0.2*I1(s)) - 3", e("0.6", "0.6"), True),
    (LODE + TIP, e("0.6", "0.6"), True),
    (LODE + TIP, e("0.45", "0.45"), False),
    (LODE.replace(COSINE, "cos(2*lode(s))") + TIP, e("0.6", "0.6"), False),
    (f"sqrt({FIRST}**2 + e*J2(s)) + {FIRST} - 1", e("0", "3"), True),
    (f"sqrt({FIRST}**2 + e*J2(s)) - {FIRST} - 1", e("3", "4"), False),  # the wall turns inward
    (f"-e*{FIRST} + 2*sqrt(J2(s)) - 1", e("0", "1"), False),
    (f"e*{LAST}**2 + J2(s) - 1", e("-1", "0"), False),
    (f"J2(s)/{FIRST} - e", e("1", "1"), False),  # 0/0
    (f"where(J2(s) > 0, J2(s)/{FIRST}, 0) - e", e("1", "1"), False),  # bent outward in the sector, inward at a wall
    (f"where(J2(s) > 0, {FIRST} + J2(s)/{FIRST}, 0) - e", e("1", "1"), False),
    (GAPS, e("1/2", "2"), True),  # each wall turns outward
    (GAPS, e("0.499", "2"), False),
    (GAPS, e("1/2", "2.001"), False),
    (f"{FIRST}**3 + e*J2(s)*{FIRST} - 1", e("1/2", "3"), True),
    (f"{FIRST}**3 + e*J2(s)*{FIRST} - 1", e("-1/2", "-1/2"), False),  # it is < 0 at a wall
    (f"J2(s) + e*{FIRST}**2 - 1", e("0", "3"), True),
    (f"J2(s) + e*{FIRST}**2 - 1", e("-1/10", "-1/10"), False),
]


def law(g: str, kind: str, parameters: dict[str, Domain]) -> Criterion:
    return Criterion(name="law", g=g, stress={"name": "s", "kind": kind}, pressure=None, parameters=parameters)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "parameters", "convex"),
    long_but([2, 4, 7, 9, 17, *range(19, 34)], CASES),
)
def test_the_kernel_knows_the_threshold(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    shown = by_kernel(law(g, "principal", parameters))
    assert (shown.defined and shown.quasiconvex) is convex


@pytest.mark.long
def test_ends_of_ranges_are_limits_only_where_nothing_else_ties_the_parameters() -> None:
    tied = Criterion(
        name="law", g=WILLAM + TIP, stress=law(WILLAM, "principal", e("1", "1")).stress, pressure=None, parameters=e("1/2", "1"),
        constraints=("e <= 1/2",),
    )  # fmt: skip
    assert not by_kernel(tied).convex and not by_prover(tied)


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0], [WILLAM, LODE]))
@pytest.mark.parametrize(("value", "convex"), [("0.55", True), ("0.45", False)])
def test_so_it_does_in_six_components(g: str, value: str, convex: bool) -> None:
    shown = by_kernel(law(g + TIP, "3d", e(value, value)))
    assert (shown.defined and shown.quasiconvex) is convex


TIED = [case for case in CASES if case[1]["e"].value is not None]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([1, 16], TIED))
def test_the_prover_knows_it_too(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    """That a formula has a value everywhere it asks elsewhere."""
    has_value = not any(zero in g for zero in (f"{PRINTED + TIP}", f"J2(s)/{FIRST} - e", ">= 0")) or "where(J2(s) > 0" in g
    assert by_prover(law(g, "principal", parameters)) is convex or not has_value


@pytest.mark.long
def test_drawn_sections_are_convex_where_a_grid_finds_them_so() -> None:
    rng, both = Random(4), [0, 0]
    while min(both) < 3:
        a, b, c, d, k = (round(rng.uniform(-1, 2), 1) for _ in range(5))
        if (least := _bend(a, b, c, d, k)) is None or abs(least) < 0.02:
            continue
        text = f"where(J2(s) > 0, ({a}*{FIRST}**2 + {b}*J2(s))/({c}*{FIRST} + sqrt({d}*{FIRST}**2 + {k}*J2(s))), 0) - 1"
        assert by_kernel(law(text, "principal", {})).convex is (least > 0), text
        both[least > 0] += 1


def _bend(a: float, b: float, c: float, d: float, k: float) -> float | None:
    """The least of f'' + f in the sector and of the turns at its walls; None where f has no value or its divisor is not > 0."""

    def f(theta: float) -> float:
        x = 2 / math.sqrt(3) * math.cos(theta)  # J2 = 1
        return (a * x * x + b) / (c * x + math.sqrt(d * x * x + k))

    grid, step = [i * math.pi / 600 for i in range(201)], 1e-4
    for theta in (0.0, math.pi / 3):
        x = 2 / math.sqrt(3) * math.cos(theta)
        if d * x * x + k < 0.05 or c * x + math.sqrt(d * x * x + k) < 0.05:
            return None
    inside = ((f(t + step) - 2 * f(t) + f(t - step)) / step**2 + f(t) for t in grid[1:-1])
    return min(*inside, (f(math.pi / 3 - step) - f(math.pi / 3 + step)) / (2 * step))


@pytest.mark.slow
@pytest.mark.parametrize("kind", mostly_long(["principal", "3d"], "principal"))
def test_a_section_with_a_value_everywhere_is_decided(kind: str) -> None:
    cone = law(WILLAM + " + a*I1(s) - k", kind, {**e("0.6", "0.6"), "a": POSITIVE, "k": POSITIVE})
    found = verify(cone, claims=["origin", "convexity", "normality", "dissipation"])
    assert {(r.verdict, r.trust) for r in found.results} == {(Verdict.PROVED, Trust.CHECKED)}


FORCES = ("s1", "s2", "s3")
J2 = "(((s1-s2)**2+(s2-s3)**2+(s3-s1)**2)/6)"
BY_HAND = PRINTED.replace("principal(s, 1)", "max(s1,s2,s3)").replace("I1(s)", "(s1+s2+s3)").replace("J2(s)", J2)


REMEDY = "where((s1 - s2)**2 + (s2 - s3)**2 + (s3 - s1)**2 > 0, ..., 0)"


def by_hand(section: str) -> Criterion:
    """As Willam and Warnke (1975) print it, it is 0/0 where the principal stresses are equal."""
    parameters = {"e": Domain.fixed("0.6"), "a": Domain.fixed("0.2"), "k": Domain.fixed("1")}
    return Criterion(name="law", g=f"{section} + a*(s1+s2+s3) - k", forces=FORCES, pressure=None, parameters=parameters)


@pytest.mark.slow
def test_as_printed_it_has_its_limit_where_it_is_0_divided_by_0() -> None:
    found = verify(by_hand(f"({BY_HAND})"), claims=["origin", "convexity"])
    assert {(r.verdict, r.trust) for r in found.results} == {(Verdict.PROVED, Trust.CHECKED)}
    assert any("no value where s1 = s2 = s3. Where g is 0/0 and has a limit" in remark for remark in found.remarks)


@pytest.mark.slow
def test_of_a_formula_without_a_limit_nothing_is_proved_and_the_place_is_said() -> None:
    found = verify(by_hand(f"({BY_HAND})/sqrt({J2})"), claims=["origin"])
    assert found["origin"].verdict is Verdict.UNDECIDED
    assert "no value at zero force" in found["origin"].detail
    assert any("no value where s1 = s2 = s3" in remark for remark in found.remarks)
    assert not any("where((" in said for said in (found["origin"].detail, *found.remarks))  # no limit is advised where there is none


@pytest.mark.long
def test_with_the_remedy_it_is_proved() -> None:
    found = verify(by_hand(REMEDY.replace("...", BY_HAND)), claims=["origin", "convexity"])
    assert {(r.verdict, r.trust) for r in found.results} == {(Verdict.PROVED, Trust.CHECKED)}
    assert not any("no value" in remark for remark in found.remarks)


@pytest.mark.long
def test_below_one_half_it_is_refuted() -> None:
    found = verify(law(WILLAM + TIP, "principal", e("0.4", "0.4")), claims=["origin", "convexity"])
    assert (found["origin"].verdict, found["convexity"].verdict) == (Verdict.PROVED, Verdict.REFUTED)


@pytest.mark.long
def test_its_tip_is_seen() -> None:
    """In planes through the axis; not in one in which another formula holds than anywhere beside it."""
    cone = law(WILLAM + TIP, "principal", e("0.6", "0.6"))
    assert verify(cone, claims=["smoothness"])["smoothness"].verdict is Verdict.REFUTED
    flat = law("where((s_1 - s_2)**2 > 0, s_1**2 + s_2**2 + s_3**2, abs(s_3) + abs(s_1 + s_2)) - 1", "principal", {})
    subject = FormulaSubject(flat)
    box, zero, one = ball(Fraction(-1, 10), Fraction(1, 10)), Fraction(0), Fraction(1)
    within, across = (
        PlaneSection.through(flat.force_symbols(), (zero,) * 3, u, (zero, zero, one)) for u in ((one, one, zero), (one, zero, zero))
    )
    assert local_pieces(subject, {}, within, dict.fromkeys(within.at, box)) == ()
    (piece,) = local_pieces(subject, {}, across, dict.fromkeys(across.at, box))
    a, b = across.at
    assert piece.expr == a**2 + b**2 - 1


def test_a_root_of_nothing_is_left_to_the_other_rules() -> None:
    x = "(max(a, b, c) - (a + b + c)/3)"
    stated = small_laws.law(f"sqrt({x} - {x}) + {x} - 1", forces=("a", "b", "c"))
    assert small_laws.confirmed("origin", "evaluation", stated) and small_laws.confirmed("convexity", "composition", stated)


@pytest.mark.parametrize(
    ("g", "said"),
    [
        ("sqrt(3*J2(s)) - 1 + 0*cos3theta(s)", "duhem uses this limit, because K is closed"),
        ("s_1**2 + s_2/s_3 - 1", "A point where g has no value does not belong to K"),
    ],
)
def test_a_limit_is_said_where_a_proof_takes_it(g: str, said: str) -> None:
    found = verify(Criterion(name="law", g=g, stress={"name": "s", "kind": "principal"}, pressure=None), claims=["origin"])
    assert any(said in remark for remark in found.remarks)
