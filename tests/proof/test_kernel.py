"""The kernel: what it confirms is true of the formula as written, and what it is made of is its own."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import pytest

from duhem import POSITIVE as POSITIVE_DOMAIN
from duhem import Criterion, Domain, verify
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel import claims as kernel_claims
from duhem.proof.kernel import curvature
from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.certificate import CLAIMS, recheck
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.long import mostly_long
from tests.oracles import drawn_formulas
from tests.proof.test_adversary import CLAIMS as LETTERS
from tests.proof.test_adversary import ROWS
from tests.proof.test_adversary import Row as AdversaryLaw

RULES = {claim: [rule for c, rule in kernel_claims.RULES if c == claim] for claim in CLAIMS}


def law(g: str, *, forces: tuple[str, ...] = ("a", "b"), pressure: str | None = None, flow: Any = None, **parameters: Any) -> StatedLaw:
    given = {"forces": forces, "pressure": pressure, "parameters": parameters, "constraints": [], "g": g, "flow": flow}
    return StatedLaw.read(given)


def confirmed(stated: StatedLaw, evidence: dict[str, Any] | None = None) -> set[str]:
    """Every claim that some rule confirms."""
    found = set[str]()
    for claim in CLAIMS:
        rules = [rule for rule in RULES[claim] if evidence is not None or rule != "polar-gauge"]
        if not all(kernel_claims.objection(claim, rule, frozenset(found), stated, evidence or {}) for rule in rules):
            found.add(claim)
    return found


# -- reading -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "same"),
    [("-a**2", "-(a**2)"), ("a - b - 1", "(a - b) - 1"), ("a/b/2", "(a/b)/2"), ("2**-a**2", "2**(-(a**2))"), ("- -a", "-(-a)")],
)
def test_the_parser_binds_as_the_vocabulary_does(text: str, same: str) -> None:
    at = {"a": 1.25, "b": 0.75}
    assert drawn_formulas.value(parse(text), at) == drawn_formulas.value(parse(same), at)
    assert drawn_formulas.value(parse(text), at) == pytest.approx(eval(text, {}, at), rel=1e-15)


@pytest.mark.parametrize(
    "text", ["", "a +", "a b", "f(a)", "abs(a, b)", "where(a, b, a)", "abs(a > b)", "a.real", "(a", "a)", "1e999999999", "()"]
)
def test_what_is_no_formula_is_not_read(text: str) -> None:
    with pytest.raises((NotWritten, OverflowError)):
        law(text)


def test_deep_nesting_is_refused_and_crashes_nothing() -> None:
    for text in ("(" * 5000 + "a" + ")" * 5000, "-" * 5000 + "a", "abs(" * 5000 + "a" + ")" * 5000):
        with pytest.raises((NotWritten, RecursionError)):
            law(text)


@pytest.mark.parametrize(
    "change",
    [
        {"forces": ("a", "a")},
        {"parameters": {"a": {"positive": True}}},
        {"parameters": {"m from end 0": {"positive": True}}},
        {"parameters": {"norm": {"positive": True}}},
        {"pressure": "a"},
        {"constraints": ["a < 1"]},
        {"g": "a + unknown"},
    ],
)
def test_names_are_declared_once_and_are_names(change: dict[str, Any]) -> None:
    given = {"forces": ("a", "b"), "pressure": "s", "parameters": {}, "constraints": [], "g": "abs(a) + s", "flow": None}
    assert StatedLaw.read(given)
    with pytest.raises(NotWritten):
        StatedLaw.read(given | change)


# -- what it confirms is true ------------------------------------------------------------------------------------------


def violation(stated: StatedLaw, shown: Facts, rng: Random, tries: int) -> str | None:
    """A place where what is shown of g does not hold, in floats with a margin."""
    for _ in range(tries):
        at, share = drawn_formulas.parameters(rng), rng.random()
        one, two = drawn_formulas.forces(rng), drawn_formulas.forces(rng)
        between = {f: one[f] * (1 - share) + two[f] * share for f in one}
        try:
            p, q, m = (drawn_formulas.value(stated.g, {**at, **x}) for x in (one, two, between))
        except OverflowError:
            continue
        except (ValueError, ZeroDivisionError) as fault:
            return f"undefined: {fault} at {at}, {one}, {two}"
        if not all(map(math.isfinite, (p, q, m))):
            continue
        margin = 1e-7 * (1 + abs(p) + abs(q) + abs(m))
        if shown.quasiconvex and m > max(p, q) + margin:
            return f"not quasiconvex at {at} between {one} and {two}"
        if shown.convex and m > (1 - share) * p + share * q + margin:
            return f"not convex at {at} between {one} and {two}"
        if shown.concave and m < (1 - share) * p + share * q - margin:
            return f"not concave at {at} between {one} and {two}"
        sign = NEGATIVE if p < -margin else POSITIVE if p > margin else ANY
        if not shown.sign & sign:
            return f"sign {shown.sign} at {at}, {one}: {p}"
    return None


BESIDE = ("(sqrt(abs(a)) + abs(b))**(1/2)", "a*b", "max(a, sqrt(abs(b)))", "abs(a) - abs(b)", "abs(a)**(1/2)", "m - 1")


def drawn(seed: int, count: int, tries: int = 30, most: int = 10) -> tuple[int, list[str]]:
    """How many of ``count`` drawn formulas the kernel shows to be quasiconvex, and what is wrong in what it shows, the first few."""
    rng, shown, wrong = Random(seed), 0, list[str]()
    for g in (*BESIDE, *(drawn_formulas.text(rng, rng.choice((2, 3, 3, 4))) for _ in range(count))):
        if len(wrong) == most:
            break
        try:
            stated = StatedLaw.read(drawn_formulas.law(g))
            found = over(stated).facts(stated.g)
        except NotWritten:
            continue
        if found.defined:
            shown += found.quasiconvex and bool(stated.g.names() & set(drawn_formulas.FORCES))
            if (fault := violation(stated, found, rng, tries)) is not None:
                wrong.append(f"{g}: {fault}")
    return shown, wrong


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([60, 400], 60))
def test_what_is_shown_of_drawn_formulas_holds_at_drawn_points(count: int) -> None:
    shown, wrong = drawn(1, count)
    assert wrong == []
    assert shown > 0.15 * count  # else the question was empty


DEAR = ("lozenge turned out", "hyperbola by a hair", "outside-disc-weighted", "outside-disc-pressure", "pole-at-one-value", "odd-powers")


@pytest.mark.slow
@pytest.mark.parametrize("row", mostly_long(ROWS, *(row for row in ROWS if row.name not in DEAR)), ids=lambda row: row.name)
def test_nothing_false_is_confirmed(row: AdversaryLaw) -> None:
    made = row.law()
    given = {n: {"min": d.low, "max": d.high} if not d.positive else {"positive": True, "max": d.high} for n, d in made.parameters.items()}
    text = {n: {k: v if isinstance(v, bool) or v is None else str(v) for k, v in d.items()} for n, d in given.items()}
    stated = law(row.g, forces=row.forces, pressure=made.pressure, flow=row.flow, **text)
    assert not confirmed(stated) & {LETTERS[letter] for letter in row.false}


UNIT = {"min": "0", "max": "1"}
SIGNED = {"min": "-1", "max": "1"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stated", "claim"),
    [
        (law("norm(a, b) - (1 + e*a/abs(a))*abs(s)", pressure="s", e=UNIT), "smoothness"),
        (law("norm(a, b) - (1 + e*a/abs(a))*abs(s)", pressure="s", e=UNIT), "convexity"),
        (law("norm(a, b) - max(1, log(q))", q=SIGNED), "origin"),
        (law("norm(a, b) - max(1, log(q))", q=SIGNED), "convexity"),
        (law("norm(a, b) - abs_s*abs(s)", pressure="s", abs_s=SIGNED), "origin"),
        (law("exp(log(a)) + abs(b) - 1"), "convexity"),
        (law("sqrt(a)**2 + abs(b) - 1"), "smoothness"),  # it is convex with its edge a = 0
        (law("pos(a)*sqrt(a) + abs(b) - 1"), "smoothness"),
        (law("0/((q + 1)*(q - 1) - q**2 + 1) + abs(a) - 1", q=UNIT), "origin"),
        (law("max(a**4 + b**4 + c*a**2*b**2 - 1, 2*(a**4 + b**4 + c*a**2*b**2 - 1))", c={"min": "0", "max": "6001/1000"}), "convexity"),
        (law("abs(a)*abs(s)", forces=("a",), pressure="s"), "smoothness"),  # K is one point, with every normal
        (law("tan(a) - 1", forces=("a",)), "convexity"),
        (law("where(a > 0, 0, 2) + abs(b) - 1"), "convexity"),
        (law("abs(s) - norm(a, b)", pressure="s"), "convexity"),
        (law("(abs(a)**p + abs(b)**p)**(1/p) - 1", p={"min": "1/2", "max": "4"}), "convexity"),
        (law("(abs(a)**p + abs(b)**p)**(1/p) - 1", p={"min": "1", "max": "4"}), "smoothness"),
        (law("norm(a, b) - 1", flow=["a", "-b"]), "normality"),
    ],
    ids=lambda value: value if isinstance(value, str) else "law",
)
def test_proofs_that_were_wrong_once_are_not_confirmed(stated: StatedLaw, claim: str) -> None:
    assert claim not in confirmed(stated)


SLIPS = {"a": "x", "b": "y"}


@pytest.mark.parametrize(
    ("g", "potential", "right"),
    [
        ("norm(a/m, b) - 1", "norm(m*x, y)", True),
        ("norm(a/m, b) - 1", "norm(x/m, y)", False),
        ("norm(a, b) - 1", "max(abs(x), abs(y))", False),
        ("max(abs(a), abs(b)) - 1", "abs(x) + abs(y)", True),
        ("abs(a) + abs(b)/m - 1", "max(abs(x), m*abs(y))", True),
        ("abs(a) + abs(b)/m - 1", "abs(x) + m*abs(y)", False),
        ("norm(pos(a)/m + neg(a), b) - m", "m*norm(m*pos(x) + neg(x), y)", True),
        ("norm(pos(a)/m + neg(a), b) - m", "m*norm(m*neg(x) + pos(x), y)", False),
        ("norm(e*a, b) - 1", "norm(x/e, y)", False),  # e may be 0
        ("norm(a, b) - e", "e*norm(x, y)", False),  # K may be a point
        ("-norm(-a, b) - 1", "norm(x, y)", False),
        ("norm(a, a) + abs(b) - 1", "max(abs(x), abs(y))", False),
        ("norm(a, b) - 1", "norm(x, y) + x*y/10**9", False),
        ("norm(a, b) - 1", "norm(x, y) + 0/(e - e)", False),
    ],
)
def test_support_functions(g: str, potential: str, right: bool) -> None:
    stated = law(g, m={"positive": True}, e=UNIT)
    found = kernel_claims.objection("duality", "polar-gauge", frozenset(), stated, {"potential": potential, "slips": SLIPS})
    assert (found == "") is right, found


# -- with the provers --------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("g", "claim"), [("exp(log(a)) + abs(b) - 1", "origin"), ("a**3/a + abs(b) - 1", "convexity")])
def test_the_formula_is_checked_as_written(g: str, claim: str) -> None:
    made = verify(Criterion(name="written", g=g, forces=("a", "b"), pressure=None)).certificate()
    assert made["law"]["g"] == g
    assert {c["claim"]: c["trust"] for c in made["claims"]}[claim] != "checked"


def test_a_fixed_law_is_certified_with_its_values() -> None:
    made = verify("superellipse", {"p": 3, "mu_a": "1/3"}).certificate()
    assert made["law"]["parameters"]["p"] == {"value": "3"} and made["inhabited"]["mu_a"] == "1/3"
    assert {c["trust"] for c in made["claims"] if c["claim"] != "duality"} == {"checked"}


@pytest.mark.slow
def test_a_thin_domain_is_shown_not_to_be_empty() -> None:
    domains = {"m": POSITIVE_DOMAIN, "e": POSITIVE_DOMAIN}
    thin = ("m**2 < 2*e**2", "2*e**2 < m**2 + 1/1000000000")
    made = verify(Criterion("thin", "norm(a, m*b)/e - 1", domains, ("a", "b"), None, thin), claims=["origin"]).certificate()
    assert [line.confirmed for line in recheck(made)] == [True]


# -- the kernel is not vacuous -----------------------------------------------------------------------------------------

WRONG_RULES = {
    "a product keeps the curvature of its factor": ("_product", lambda term, parts, domain: Facts(True, ANY, True, True, True)),
    "a maximum of anything is convex": ("_greatest", lambda parts: Facts(True, ANY, True, False, True)),
    "every sum is convex": ("_total", lambda term, parts, domain: Facts(True, ANY, True, True, True)),
    "every power is convex": ("_power", lambda term, domain: Facts(True, ZERO | POSITIVE, True, False, True)),
    "every root of a sum of powers is a norm": ("_minkowski", lambda term, domain: True),
    "every constant is negative": ("sign_of_constant", lambda term, known, domain: known if known in (ZERO, POSITIVE) else NEGATIVE),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WRONG_RULES)
def test_a_wrong_rule_is_caught(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    function, wrong_rule = WRONG_RULES[name]
    monkeypatch.setattr(curvature, function, wrong_rule)
    assert drawn(1, 400, most=1)[1] != []


def test_terms_are_values() -> None:
    assert parse("a + b*2") == parse(" a+b * 2.0 ") and hash(parse("a")) == hash(Term("name", name="a"))


@pytest.mark.parametrize(
    ("text", "same"),
    [("x*x", "x**2"), ("2*x*y*x*x", "2*x**3*y"), ("(a + b)*(a + b)", "(a + b)**2"), ("-x*x", "-x**2")],
)
def test_equal_factors_are_read_as_a_power(text: str, same: str) -> None:
    assert parse(text) == parse(same)


@pytest.mark.parametrize("text", ["x/x", "x*x**(-1)", "sqrt(x)*sqrt(x)"])
def test_no_factors_are_joined_that_may_have_no_value(text: str) -> None:
    law = StatedLaw.read(law_as_text(Criterion("k", "x - 1", {}, ("x",), None)))
    assert not over(law).facts(parse(text)).defined


@pytest.mark.parametrize("square", ["({0})**2", "({0})*({0})"])
def test_a_square_may_be_written_as_a_product(square: str) -> None:
    """The distance from a centre that moves with the parameters: multiplied out, no rule sees that it is one."""
    g = "sqrt(" + " + ".join(square.format(x) for x in ("x - a", "y - b*x", "z - a*b + x")) + ") - m"
    law = Criterion("k", g, {"m": POSITIVE_DOMAIN, "a": Domain(), "b": Domain()}, ("x", "y", "z"), None)
    assert verify(law, claims=["convexity"], effort="quick")["convexity"].trust == "checked"
