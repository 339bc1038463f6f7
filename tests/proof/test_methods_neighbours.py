"""Beside what a method proves: laws that lack one hypothesis of its theorem, of which it must say nothing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
import sympy as sp

from duhem import Criterion, Domain, Verdict
from duhem.expression import Norm, Where
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import evidence, refuters
from duhem.proof.search import dents, long_chords
from duhem.proof.verdict import Proof
from tests.long import long_at
from tests.oracles.prover import composition, convex_sums, degrees, power_share, rounded
from tests.oracles.prover import evaluation as evaluated
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.prover.regularity import regularity
from tests.proof.test_power_share import dilatant

UNIT, BEYOND = Domain.between(0, 1), Domain.between(1, 2)


def subject(g: str, forces: str = "ab", pressure: str | None = None, **law: Any) -> FormulaSubject:
    parameters = {name: law.pop(name) for name in ("q", "m") if name in law}
    return AskedSubject(Criterion("law", g, forces=tuple(forces), pressure=pressure, parameters=parameters, **law))


OVAL = "(a**2 + a*b + b**2)"  # its matrix is positive, its squares are not those of a and b alone
MATRIX = {"directions", "convex sums"}


@pytest.mark.parametrize("g", [f"{OVAL} - 1", f"({OVAL} - 1)**3", f"{OVAL} - a - 1"])
def test_where_a_matrix_was_looked_at_the_proof_says_so(g: str) -> None:
    for method in (composition.convexity, composition.smoothness):
        found = method(subject(g))
        assert found is not None and found.proof is not None and set(found.proof.evidence) == MATRIX
        plain = method(subject(g.replace(OVAL, "(a**2 + b**2)")))
        assert plain is not None and plain.proof == Proof("composition")


@pytest.mark.parametrize(
    ("g", "law", "why", "rule", "evidence"),
    [
        (f"sqrt{OVAL} - 1", {}, "by Euler's relation", "euler", MATRIX),
        (f"{OVAL}**2*a - 1", {}, "by Euler's relation", "euler", set()),  # no root is taken
        (f"{OVAL}*a - q", {"q": BEYOND}, "by Euler's relation", "euler", set()),
        (f"{OVAL} - q", {"q": BEYOND}, "because g is convex and negative at the origin", "composition", MATRIX),
    ],
)
def test_why_the_gradient_does_not_vanish(g: str, law: dict[str, Any], why: str, rule: str, evidence: set[str]) -> None:
    told, proof = composition._regular(subject(g, **law)) or ("", None)
    assert told == why and proof is not None and (proof.rule, set(proof.evidence)) == (rule, evidence)


@pytest.mark.parametrize(
    ("g", "law"),
    [
        (f"{OVAL}*a - q", {"q": UNIT}),  # 0 may be on the boundary
        (f"{OVAL} - q", {"q": UNIT}),
        ("norm(a - 2, b) - 1", {}),
        ("sqrt(norm(a - 2, b)) - 1", {}),
        ("a**4 - 3*a**2*b**2 + b**4 + a - 1", {}),  # negative at 0, not convex
        (f"sqrt{OVAL} - abs(a)", {}),
    ],
)
def test_where_the_gradient_may_vanish(g: str, law: dict[str, Any]) -> None:
    assert composition._regular(subject(g, **law)) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "of", "inside"),
    long_at(
        [1, 3, 4],
        [
            ("norm(a - 2, b) - 1", {}, ("2", "0")),
            ("norm(a - q, b) - q", {"q": BEYOND}, ("q", "0")),
            ("norm(a - q, b) - q", {"q": UNIT}, None),  # a point
            ("norm(a - m, b + m/2) - q", {"q": BEYOND, "m": BEYOND}, ("m", "-m/2")),
            ("norm(a - abs(p), b) - abs(p)/2", {"pressure": "p"}, ("-p", "0")),
            ("norm(a, b) - 1", {}, None),  # the origin: another's
            ("sqrt(norm(a - 2, b)) - 1", {}, None),  # not convex
        ],
    ),
)
def test_convex_and_negative_at_a_centre(g: str, of: dict[str, Any], inside: tuple[str, str] | None) -> None:
    found = composition._regular_about_its_centre(subject(g, **of))
    if inside is None:
        assert found is None
    else:
        proof = Proof("composition", {"inside": dict(zip("ab", inside, strict=True))})
        assert found == (f"because g is convex and negative at ({', '.join(inside)})", proof)
    aside = composition._regular_about_its_centre(subject(OVAL.replace("a", "(a - 2)") + " - 1"))
    assert aside is not None and aside[1] is not None and set(aside[1].evidence) == {"inside"} | MATRIX


@pytest.mark.parametrize(("kink", "cancelled"), [("pos(b)**2", True), ("neg(b)**2", True), ("abs(b)**3", True), ("b**4", False)])
def test_what_is_said_of_kinks(kink: str, cancelled: bool) -> None:
    found = composition.smoothness(subject(f"a**2 + b**2 + {kink} - 1"))
    assert found is not None and found.detail.startswith("every kink lies where" if cancelled else "g has no kink, no tip") is True


POLYNOMIAL = "a**4 + a**2*b**2 + b**4"  # convex by sums of squares


@pytest.mark.parametrize(
    ("g", "kind"),
    [
        (f"norm({POLYNOMIAL}, b) - 1", "convex"),
        (f"norm({POLYNOMIAL} - 10, b) - 1", None),  # a ring: below 0 nothing is known to rise
        (f"({POLYNOMIAL} - 10)**2 - 1", None),
        (f"abs({POLYNOMIAL} - 10) - 1", None),
        (f"exp({POLYNOMIAL}) - 3 + a", "convex"),
        (f"sqrt(sqrt({POLYNOMIAL} + 1)) - 2", "quasiconvex"),
        (f"sqrt({POLYNOMIAL} + 1) + a - 2", None),
        (f"{POLYNOMIAL} + a - q", "convex"),
        (f"-({POLYNOMIAL}) + a + 1", None),
    ],
)
def test_convex_sums_below_zero_are_not_taken_for_more(g: str, kind: str | None) -> None:
    found = convex_sums.convexity(subject(g, **({"q": UNIT} if "q" in g else {})))
    assert (found and found.detail.partition(": ")[0]) == (kind and f"g is {kind}")
    assert found is None or (found.proof is not None and set(found.proof.evidence) == MATRIX)


@pytest.mark.parametrize(
    ("g", "forces", "proved"),
    [
        ("a**3 + b**3 + a", "ab", False),  # g rises outward on one half of the plane alone
        ("a**3 + b**3 - norm(a, b)", "ab", True),
        ("a**2 - b**2 - a", "ab", False),
        ("a**3 - a", "a", False),
        ("a**4 + a**2 - 1", "a", True),
        ("a**4 - a**2 - 1", "a", True),
        ("a**4 - 3*a**2 + 1", "a", False),  # comes back to 0
        ("norm(a, b) - exp(a)", "ab", False),
    ],
)
def test_the_power_by_degrees_is_asked_everywhere(g: str, forces: str, proved: bool) -> None:
    assert (degrees.dissipation(subject(g, forces)) is not None) is proved


@pytest.mark.parametrize(
    ("g", "potential", "share"),
    [
        ("2*norm(a, b) + 2*c - 2", "norm(a, b) + c/2", "1/4"),
        ("2*norm(a, b) + 4*c - 2", "norm(a, b) + c", "1/4"),
        ("norm(a, b) + 4*c - 1", "norm(a, b) + 5*c", None),
        ("norm(a, b) + c - q", "2*norm(a, b) + 3*c", None),
        ("a**2 + b**2 - c**2 - q", "a**2 + b**2 - c**2/2", "2"),
        ("where(c > 0, norm(a, b) + c, norm(a, b)) - 1", "norm(a, b) + c/2", None),  # of g no term is c
        ("where(c > 0, norm(a, b), 2*norm(a, b)) - 1", "norm(a, b)", None),  # it jumps
    ],
)
def test_which_share_of_g_a_potential_holds(g: str, potential: str, share: str | None) -> None:
    found = degrees.dissipation_of_potential(subject(g, "abc", potential=potential, q=Domain.fixed(1)))
    assert (found and found.proof and found.proof.evidence["share"]) == share


P = "((p + 1/2)/2)"  # from 0 to 1 on a K with the origin inside
LENS = "max(norm(a, b) - 2*(P - P**2)**(2/3), -P, P - 1)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "of", "round_"),
    long_at(
        [0, 1, 3, 6, 9, 12, 13],
        [
            (LENS.replace("(P - P**2)", "(P*(1 - P))").replace("2/3", "1/3"), {}, True),
            (LENS.replace("(P - P**2)", "((P - P**2)*P)").replace("2/3", "1/2"), {}, False),  # rises like P at its end: a tip
            (LENS.replace("(P - P**2)", "pos(P - P**2)"), {}, True),
            (LENS.replace("(P - P**2)", "(q*(P - P**2))"), {"q": BEYOND}, True),
            (LENS.replace("(P - P**2)", "(q*(P - P**2))"), {"q": UNIT}, False),  # a segment
            (LENS.replace("2*(", "q*("), {"q": BEYOND}, True),
            (LENS.replace("2*(", "q*("), {"q": UNIT}, False),
            (LENS.replace("2/3", "q"), {"q": Domain.between("1/4", "1/2")}, True),
            (LENS.replace("2/3", "q"), {"q": Domain.between("1/4", 1)}, False),  # two cones
            (LENS.replace("2/3", "q"), {"q": Domain.between(0, "1/2")}, False),  # a cylinder
            (LENS.replace("norm(a, b)", "a"), {}, False),
            (LENS.replace("norm(a, b)", "sqrt(norm(a, b))"), {}, False),
            (LENS.replace("-P,", "-P, norm(a - 1/10, b) - 1/5,"), {}, False),  # cut by a ball
            (LENS.replace("-P,", "-P, norm(a - 1/10, b) - 2*(P - P**2)**(2/3),"), {}, False),  # cut by another lens
            (LENS.replace("norm(a, b)", "norm(a, b) - (P - P**2)**(1/3)"), {}, False),
            ("max(a - 1, -a - 1)", {}, False),
        ],
    ),
)
def test_what_ends_round_and_what_does_not(g: str, of: dict[str, Any], round_: bool) -> None:
    assert (rounded.smoothness(subject(g.replace("P", P), "abp", **of)) is not None) is round_


def test_the_same_sets_are_convex_where_their_loads_are_known() -> None:
    """The root is concave between its loads alone."""
    for g, convex in ((LENS, True), (LENS.replace("-P, P - 1", "-P"), False), (LENS.replace("2/3", "2"), False)):
        found = composition.convexity(subject(g.replace("P", P), "abp"))
        assert (found is not None) is convex and (found is None or found.detail.startswith("g is "))


def test_each_end_of_a_load_has_its_own_factor() -> None:
    law = subject("norm(a, b) + p**2 - 1", "abp")
    a, b, p = law.simple.forces

    def ends(load: sp.Expr, loads: Sequence[sp.Expr], parts: Sequence[sp.Expr]) -> bool:
        return rounded._ends_round(load, loads, parts, law)

    low, high = -p, p - 1
    for parts, at_low, at_high in (
        ([p, 1 - p], True, True),
        ([p - p**2], True, True),
        ([p - p**2, p], False, True),  # both are 0 at one end
        ([1 - p], False, True),
        ([p, a + 1], False, False),  # its value there is not known
        ([p, sp.Rational(1, 2) - p], True, False),
        ([p, p - 1], False, True),
        ([p - p**2, 2 - p], True, True),
    ):
        assert (ends(low, [low, high], parts), ends(high, [low, high], parts)) == (at_low, at_high), parts
    corner = a - 1  # in the plane of a and p the set has corners
    assert not ends(low, [low, high, corner], [p, 1 - p]) and not ends(low, [low, p], [p]) and not ends(low, [low, p - 0], [p, 1 - p])
    size = Norm(a, b)
    assert all(rounded._vanishes_with(size, expr, law) for expr in (size, size**2, p * size, p * size**3, sp.sqrt(size)))
    assert not any(rounded._vanishes_with(size, expr, law) for expr in (1 / size, size + p, sp.exp(size), p))


def test_what_is_smooth_but_where_it_is_zero() -> None:
    law = subject("norm(a, b) + p**2 - 1", "abp")
    a, b, p = law.simple.forces
    size = Norm(a, b)
    for expr, smooth in (
        (size, True),
        (sp.Abs(a), True),
        (p - p**2, True),
        (size * sp.Abs(a), True),
        (size + sp.Abs(a), False),
        (size - 1, False),
        (Where(a > 0, a, sp.S.Zero), False),
        (sp.Max(a, b), False),
    ):
        assert rounded._smooth_but_where_zero(expr, law) is smooth, expr


def test_the_factor_of_a_gauge_and_its_root() -> None:
    law = subject("norm(a, b) + p**2 - q", "abp", q=BEYOND)
    (a, b, p), q = law.simple.forces, law.law.symbols()["q"]
    root, size = sp.Pow(p - p**2, sp.Rational(1, 3)), Norm(a, b)
    for f, found in (
        (size - root, (size, root)),
        (size - 3 * root, (size, root)),
        (size - q * root, (size, root)),
        (size - (q - 1) * root, None),  # may be 0
        (size + root, None),
        (size + a - root, (size + a, root)),
        (root - size, None),
        (size - sp.Pow(p, 2), None),
        (size - sp.Pow(p, sp.Rational(-1, 3)), None),
        (size - sp.Pow(p, a), None),
        (size, None),
    ):
        assert rounded._gauge_and_root(f, law) == found, f


def test_roots_as_letters() -> None:
    law = subject("norm(a, b) - 1")
    a, b = law.simple.forces
    r = sp.Symbol("r", positive=True)
    q = sp.Symbol("q", positive=True)
    y = a**2 + b**2
    expr = sp.sqrt(y) + 1 / sp.sqrt(a) + y**2 + sp.sqrt(q) + (a + 1) ** sp.Rational(1, 3)
    assert list(evidence._radicands(expr, (a, b))) == sorted([y, a], key=sp.default_sort_key)
    assert evidence._terms(2 * sp.sqrt(y) * a + y, (a, b), {y: r}) == {a * r: 2, r**2: 1}
    assert evidence._terms(y / sp.sqrt(y) - q, (a, b), {y: r}) == {r: 1, 1: -q}
    assert evidence._terms(sp.exp(a), (a, b), {}) is None and evidence._terms(1 / a + b, (a, b), {}) is None
    assert evidence._terms((a**2 + a * b) / a, (a, b), {}) == {a: 1, b: 1}
    own = subject("4*a + 6*b + a**2 + 5", flow=("2*m", "3"), m=Domain.between(1, 2))
    assert [found.proof.evidence["share"] for found in evidence.dissipation_by_shares(own) if found.proof] == ["0", "m/2", "1/2"]
    assert [power_share._rarely_zero(tip, (a, b)) for tip in (y, a**2 + q, q * a, sp.sqrt(y), a * 0)] == [True, True, False, False, True]


def test_what_is_said_of_a_share_of_the_power() -> None:
    found = power_share.dissipation(AskedSubject(dilatant(alpha=Domain.fixed("0.2"), beta=Domain.fixed("0.05"))))
    assert found is not None and found.verdict is Verdict.PROVED and found.method == "power-share (sign-rules)"
    assert found.detail.startswith("force . flow = 1/4*g + ") and found.detail.endswith("wherever g = 0, also in the limit at an apex")
    assert found.proof is not None and found.proof.rule == "power-share" and found.proof.evidence["share"] == "1/4"


J2, J3 = "((a-b)**2 + (b-c)**2 + (c-a)**2)", "(2*a-b-c)*(2*b-c-a)*(2*c-a-b)"


def test_the_origin_where_g_has_no_value_there() -> None:
    law = subject(f"sqrt({J2}) + {J3}/{J2}/500 - q", "abc", q=UNIT)
    found = evaluated.origin(law)
    assert found is not None and (found.verdict, found.method) == (Verdict.PROVED, "evaluation (sign-rules)")
    assert found.detail == "the limit of g at zero force is -q <= 0"
    for g in ("a/b - 1", "log(a) - 1"):
        why = refuters.origin_undefined(subject(g))
        assert why is not None and (why.verdict, why.method) == (Verdict.UNDECIDED, "none")
        assert why.detail.startswith("g has no value at zero force: it ")
    assert refuters.origin_undefined(subject("norm(a, b) - 1")) is None
    assert evaluated.origin(subject("a/b - 1")) is None and refuters.origin_at_parameters(subject("a/b - 1")) is None
    apart = refuters.origin_at_parameters(subject("norm(a - q, b) - 999/1000", q=UNIT))  # outside at the end of a range alone
    assert apart is not None and apart.witness is not None and sp.Rational(apart.witness.parameters["q"]) > sp.Rational("0.999")


@pytest.mark.parametrize(
    ("g", "does"),
    [
        ("a*b/(a**2 + b**2) - 1", "divides by a**2 + b**2"),  # another value along each load
        ("1/norm(a, b) - 1", "divides by norm(a, b)"),  # no bound
        ("where(a > 0, 1/a, 0)*b**4/(a**2 + b**2) - 1", "divides by a**2 + b**2"),  # of degree 1, and without bound beside a = 0
        ("a**3/(a**2 + b**2) + b**2/(a**2 + b**2) - 1", "divides by a**2 + b**2"),  # the first part alone has a limit
        ("a**3/(a**2 + b**2) + norm(a, b) - 1", "divides by a**2 + b**2"),  # what helps is tried, and said with what is open
        ("log(a**2 + b**2) - 1", "takes the logarithm of a**2 + b**2"),
    ],
)
def test_no_limit_is_promised_where_there_is_none(g: str, does: str) -> None:
    why = refuters.origin_undefined(subject(g))
    assert why is not None and "limit" not in why.detail
    assert why.detail.startswith(f"g has no value at zero force: it {does}, which is 0 there")


def test_how_hard_a_chord_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(long_chords, "sampled_chords", lambda subject, most, steps: asked.append(most) or ())
    monkeypatch.setattr(dents, "chords_across_dents", lambda subject, most, thorough: asked.append(thorough) or ())
    law = subject("a**2 + b**2 - 1")
    for method in (
        refuters.convexity_by_scouting,
        refuters.convexity_by_thorough_scouting,
        refuters.convexity_at_clear_dents,
        refuters.convexity_at_deepest_dents,
    ):
        assert method(law) is None
    few, many, clear, deepest = asked
    assert 0 < few < many and (clear, deepest) == (False, True)


def test_the_first_chord_that_holds_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = [({}, k, -k) for k in range(4)]
    monkeypatch.setattr(refuters, "chord", lambda subject, parameters, p, q, touching: None if p < 2 else (p, q))
    found = refuters._refuted(subject("a**2 + b**2 - 1"), tried)  # type: ignore[arg-type]
    assert found is not None and found.witness == (2, -2)


def test_dents_in_one_arc_and_seams_of_two_pieces() -> None:
    """The first arc is round, the second is dented; the third has no counterexample of its own."""
    half = subject("where(b > 0, norm(a, b), norm(a, b) + 2*a**2*b**2/norm(a, b)**3) - 1")
    found = refuters.convexity_at_dents(half)
    assert found is not None and found.verdict is Verdict.REFUTED
    two = subject("norm(a, b) - abs(a)/2 - 1")
    assert two.pieces is not None and len(two.pieces) == 2
    kinked = refuters.convexity_at_seams(two)
    assert kinked is not None and kinked.verdict is Verdict.REFUTED
    assert refuters.convexity_at_seams(subject("abs(abs(a) - 2) - 1", "a")) is None
    assert refuters.smoothness_at_corners(subject("abs(a) - 1", "a")) is None


@pytest.mark.parametrize(
    ("g", "slip", "proved"),
    [
        ("a**2 + b**2 - 1", ("a", "b"), True),
        ("a**2 + b**2 - 1", ("a - 2*b", "b + 2*a"), True),
        ("a**2 + b**2 - 1", ("-a", "-b"), False),
        ("a**2 + b**2 - 1", ("a - 3/2", "b"), False),
        ("a**2 + b**2 - 1", None, False),
    ],
)
def test_the_power_of_a_flow_that_is_defined_everywhere(g: str, slip: tuple[str, str] | None, proved: bool) -> None:
    assert (power_share.dissipation(subject(g, flow=slip)) is not None) is proved


@pytest.mark.parametrize(
    ("g", "dented"),
    [
        ("norm(a, b) - 9*a*b/norm(a, b)/10 - 1", True),
        ("norm(a, b) - a*b/norm(a, b)/10 - 1", False),
        ("norm(a, b) + (a**3 - 3*a*b**2)/norm(a, b)**2*(1/8 + 1/10**12) - 1", True),  # beyond 1/8 by a hair
        ("norm(a, b) + (a**3 - 3*a*b**2)/norm(a, b)**2/8 - 1", False),
        ("abs(a) + abs(b) - 1", False),
        ("norm(a - 3, b) - 1", False),  # 0 is outside
    ],
)
def test_dents_of_what_is_no_polynomial(g: str, dented: bool) -> None:
    assert (refuters.convexity_at_dents(subject(g)) is not None) is dented


@pytest.mark.parametrize("g", ["atan(norm(a, b)) - e", "exp(norm(a, b)) + a - 1", "sin(norm(a, b)) + a/2", "tanh(norm(a, b) + a) - e/2"])
def test_a_tip_under_another_word_is_not_off_the_boundary(g: str) -> None:
    """At a = b = 0 it is there, for e = 0; what the words give for a mark that is then put to 0 is not asked."""
    of = AskedSubject(
        Criterion("law", g, {"e": Domain(low=0, high=1)} if "e/2" in g or "- e" in g else {}, forces=("a", "b"), pressure=None)
    )
    (tip,) = regularity(of.simple.g, of).tips
    assert not composition._off_boundary(of, tip) and composition.smoothness(of) is None
