"""What the kernel reads: formulas as trees, laws with their domains, gradients of potentials, certificates; each exactly so."""

from __future__ import annotations

import inspect
import re
from fractions import Fraction
from typing import Any

import pytest

from duhem.proof.kernel import claims as rules
from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, exact, signs_of_product
from duhem.proof.kernel.certificate import EVIDENCE, NO_RULE, SCHEMA, digest, recheck
from duhem.proof.kernel.domain import gap
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.stated_law import StatedFace, StatedLaw, inhabited
from duhem.proof.kernel.term import WORDS, NotWritten, Term, factors, minus, number, parse, product_of, sum_of
from tests.oracles import drawn_formulas

F = Fraction


def tree(term: Term) -> str:
    if term.op == "number":
        return str(term.value)
    return term.name or f"({' '.join([term.op, *map(tree, term.args)])})"


# -- formulas ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a", "a"), (" a ", "a"), ("+a", "a"), ("-a", "(* -1 a)"), ("--a", "(* -1 (* -1 a))"), ("-+2", "-2"),
        ("a + b - c", "(+ a b (* -1 c))"),
        ("a - 1", "(+ a -1)"), ("a*b/c", "(* a b (** c -1))"), ("a/b*c", "(* a (** b -1) c)"), ("a/-b", "(* a (** (* -1 b) -1))"),
        ("a*-b", "(* a (* -1 b))"), ("a*+b", "(* a b)"), ("-a*b", "(* -1 (* a b))"), ("a**b**c", "(** a (** b c))"),
        ("a**-b", "(** a (* -1 b))"), ("-a**2", "(* -1 (** a 2))"), ("a**-b**2", "(** a (* -1 (** b 2)))"), ("2*a**2", "(* 2 (** a 2))"),
        ("(a + b)*c", "(* (+ a b) c)"), ("a - (b - c)", "(+ a (* -1 (+ b (* -1 c))))"), ("((a))", "a"),
        ("a/(b/c)", "(* a (** (* b (** c -1)) -1))"),
        ("1.5", "3/2"), (".5", "1/2"), ("2.", "2"), ("1e3", "1000"), ("1E-2", "1/100"), ("2.5e+1", "25"), ("12*3", "(* 12 3)"),
        ("sqrt(a)", "(** a 1/2)"), ("log10(a)", "(* (log a) (** (log 10) -1))"), ("norm(a, b)", "(norm a b)"), ("max(a)", "(max a)"),
        ("sign(a)", "(where (> a 0) 1 (where (< a 0) -1 0))"), ("where(a <= b, 1, 2)", "(where (<= a b) 1 2)"), ("a < b", "(< a b)"),
        ("a + 1 >= b - 1", "(>= (+ a 1) (+ b -1))"), ("where((a > b), 1, 2)", "(where (> a b) 1 2)"), 
        ("where(a > 0 and b > 0, 1, 2)", "(where (> a 0) (where (> b 0) 1 2) 2)"), ("ä", "ä"), ("\ufb01", "fi"), ("a_1", "a_1"),
    ],
)  # fmt: skip
def test_a_formula_is_a_tree(text: str, expected: str) -> None:
    assert tree(parse(text)) == expected


@pytest.mark.parametrize(
    "text",
    [
        "", " ", "a b", "a +", "*a", "a**", "a*/b", "(a", "a)", "()", "a,b", "abs(a", "abs a", "abs()", "abs(a,)", "abs(,a)", "f(a)",
        "1a", "a..b",
        "1e1000", "a = b", "a ** ** b", "where(a, 1, 2)", "1 < a < 2", "-", "a -", "and", "or(a, b)", "a<", "<a", "1.2.3", "$", "a;b",
        "a[0]",
        "(a > b) + 1", "max(a > b)", "where(1, a > b, 2)", "a % b", "a//b", "a.b", "'a'", ".", "e1.", "\u00b2",
    ],
)  # fmt: skip
def test_other_texts_are_none(text: str) -> None:
    with pytest.raises(NotWritten):
        parse(text)


@pytest.mark.parametrize("word", WORDS)
def test_a_word_takes_so_many_arguments(word: str) -> None:
    least, most = WORDS[word]
    first = "a > 0" if word == "where" else "a"
    for count in (least - 1, least, most, most + 1):
        text = f"{word}({', '.join([first] * (count > 0) + ['a'] * (count - 1))})"
        if least <= count <= most:
            assert parse(text).names() == {"a"}
        else:
            with pytest.raises(NotWritten):
                parse(text)


def test_depth_and_size_are_bounded() -> None:
    for text in ("(" * 60 + "a" + ")" * 60, "-" * 150 + "a", "2**" * 150 + "a", "a*" + "-" * 150 + "a"):
        assert parse(text).names() == {"a"}
    for text in ("(" * 250 + "a" + ")" * 250, "-" * 250 + "a", "2**" * 250 + "a", "a*" + "-" * 250 + "a"):
        with pytest.raises((NotWritten, RecursionError)):
            parse(text)


def test_terms() -> None:
    a, b = parse("a"), parse("b")
    assert tree(sum_of()) == "(+ 0)" and tree(product_of(a, b)) == "(* 1 a b)" and tree(minus(number(F(1, 2)))) == "-1/2"
    assert factors(parse("a*(b*(a*2))*b")) == [a, b, a, number(2), b] and factors(a) == [a]
    assert parse("a + b*2").size() == 5 and parse("max(a, b)").put({a: b, parse("max(a, b)"): a}) == a
    assert parse("max(a, norm(b))").put({a: b, b: a}) == parse("max(b, norm(a))")


# -- where a parameter lies --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entry", "expected", "sign"),
    [
        ({}, (None, None), ANY), ({"value": "1/3"}, (F(1, 3), F(1, 3)), POSITIVE), ({"value": "-2"}, (-2, -2), NEGATIVE),
        ({"value": "0"}, (0, 0), ZERO), ({"positive": True}, (0, None, True), POSITIVE),
        ({"positive": True, "max": "2.5"}, (0, F(5, 2), True), POSITIVE),
        ({"min": "1"}, (1, None), POSITIVE), ({"max": "-1"}, (None, -1), NEGATIVE), ({"min": "-1", "max": "1"}, (-1, 1), ANY),
        ({"min": "0", "max": "1"}, (0, 1), ZERO | POSITIVE), ({"min": "-1", "max": "0"}, (-1, 0), ZERO | NEGATIVE),
        ({"min": None, "max": None}, (None, None), ANY), ({"min": "0"}, (0, None), ZERO | POSITIVE),
        ({"max": "0"}, (None, 0), ZERO | NEGATIVE),
    ],
)  # fmt: skip
def test_where_a_parameter_lies(entry: dict[str, Any], expected: tuple[Any, ...], sign: int) -> None:
    assert Bounds.read(entry) == Bounds(*expected) and Bounds.read(entry).sign() == sign


@pytest.mark.parametrize(
    "entry",
    [
        {"value": None}, {"value": "1", "min": "0"}, {"positive": False}, {"positive": True, "min": "1"}, {"low": "1"}, {"min": 1},
        {"min": "1e3"},
        {"positive": "yes"}, {"value": "1", "positive": True}, {"max": "1E2"},
    ],
)  # fmt: skip
def test_other_entries_are_none(entry: dict[str, Any]) -> None:
    with pytest.raises(NotWritten):
        Bounds.read(entry)


def test_bounds() -> None:
    closed, opened = Bounds(F(-1), F(2)), Bounds(F(-1), F(2), True, True)
    for known, inside, outside in ((closed, (-1, 0, 2), (-2, 3)), (opened, (0,), (-1, 2)), (Bounds(None, None), (-9, 9), ())):
        assert all(known.holds(F(x)) for x in inside) and not any(known.holds(F(x)) for x in outside)
    assert Bounds(F(0), F(1), False, True).sign() == ZERO | POSITIVE and Bounds(F(-1), F(0), False, True).sign() == NEGATIVE
    assert closed.above(F(0), True) == (0, 2, True, False) and closed.below(F(0), True) == (-1, 0, False, True)
    assert closed.above(F(-2), True) == closed and closed.below(F(3), True) == closed
    assert (
        closed.above(F(-1), True) == (-1, 2, True, False) and opened.above(F(-1), False) == opened and closed.above(F(-1), False) == closed
    )
    assert closed.below(F(2), True) == (-1, 2, False, True) and opened.below(F(2), False) == opened and closed.below(F(2), False) == closed
    assert Bounds(None, None).above(F(1), False) == (1, None, False, False) and Bounds(None, None).below(F(1), False) == (
        None,
        1,
        False,
        False,
    )
    assert exact("-7/3") == F(-7, 3) and exact("0.25") == F(1, 4)


def test_signs_of_products() -> None:
    for a in (NEGATIVE, ZERO, POSITIVE):
        for b in (NEGATIVE, ZERO, POSITIVE):
            value = {NEGATIVE: -1, ZERO: 0, POSITIVE: 1}
            found = value[a] * value[b]
            assert value[signs_of_product(a, b)] == found
    assert signs_of_product(ANY, POSITIVE) == ANY and signs_of_product(ZERO | POSITIVE, NEGATIVE) == NEGATIVE | ZERO
    assert signs_of_product(0, ANY) == 0 and signs_of_product(NEGATIVE | POSITIVE, NEGATIVE) == NEGATIVE | POSITIVE


# -- laws --------------------------------------------------------------------------------------------------------------

LAW: dict[str, Any] = {
    "forces": ["a", "b"], "pressure": "s", "parameters": {"m": {"positive": True}, "n": {"value": "3"}}, "constraints": ["m < n"],
    "g": "norm(a, b) + m*s - n", "flow": None,
}  # fmt: skip
TWO = [{"g": "a - m", "flow": ["1", "0"]}, {"g": "b - m", "flow": None}]


def of_surfaces(*surfaces: dict[str, Any]) -> dict[str, Any]:
    return {**{k: v for k, v in LAW.items() if k not in ("g", "flow")}, "surfaces": list(surfaces)}


def test_a_law_is_read_as_it_is_written() -> None:
    law = StatedLaw.read(LAW)
    assert law.forces == ("a", "b") and law.pressure == "s" and law.associated and law.surfaces == () and law.ranges == ()
    assert law.parameters == {"m": Bounds(F(0), None, True), "n": Bounds(F(3), F(3))}
    assert law.g == parse("norm(a, b) + m*s - n").put({parse("n"): number(3)}) and law.constraints == (parse("m < 3"),)
    assert list(law.faces()) == [StatedFace(law.g, None)] and tree(gap(law.constraints[0])) == "(+ 3 (* -1 m))"
    assert tree(gap(parse("a >= b"))) == "(+ a (* -1 b))" and tree(gap(parse("a > 1"))) == "(+ a -1)"
    flowing = StatedLaw.read({**LAW, "flow": ["a", "n*b"]})
    assert (
        not flowing.associated and flowing.flow == (parse("a"), parse("3*b")) and list(flowing.faces()) == [StatedFace(law.g, flowing.flow)]
    )
    rising = StatedLaw.read({**LAW, "flow": {"potential": "n*a**2/2"}})
    assert rising.potential == parse("3*a**2/2") and rising.flow == gradient(parse("3*a**2/2"), ("a", "b"))
    assert StatedLaw.read({**LAW, "pressure": None, "g": "norm(a, b) - m"}).pressure is None
    assert "atan2" not in tree(StatedLaw.read({**LAW, "g": "norm(a, b)*(2 + cos(2*atan2(b, a))) - m"}).g)


def test_a_law_of_several_surfaces() -> None:
    law = StatedLaw.read(of_surfaces(*TWO))
    one, two = parse("a - m"), parse("b - m")
    assert law.g == Term("max", (one, two)) and law.flow is None and not law.associated
    assert list(law.faces()) == [StatedFace(one, (number(1), number(0)), (two,)), StatedFace(two, None, (one,))]
    alike = StatedLaw.read(of_surfaces({**TWO[0], "flow": None}, TWO[1]))
    assert alike.associated and list(alike.faces()) == [StatedFace(alike.g, None)]
    single = StatedLaw.read(of_surfaces(TWO[0]))
    assert single.g == one and list(single.faces()) == [StatedFace(one, (number(1), number(0)), ())]


RANGES = [
    ({"s": {"min": "-2", "max": "-1"}}, (("s", Bounds(F(-2), F(-1))),)), ({"s": {"min": "-2"}}, (("s", Bounds(F(-2), F(0), False, True)),)),
    ({"s": {}}, (("s", Bounds(None, F(0), False, True)),)), ({"s": {"max": "3"}}, (("s", Bounds(None, F(0), False, True)),)),
    ({"a": {"min": "-1", "max": "2"}}, (("a", Bounds(F(-1), F(2))),)), ({"a": {"min": "0"}}, (("a", Bounds(F(0), None)),)), ({}, ()),
    ({"s": {"value": "-1"}}, (("s", Bounds(F(-1), F(-1))),)),
]  # fmt: skip


@pytest.mark.parametrize(("given", "expected"), RANGES)
def test_ranges_of_the_forces_and_the_pressure(given: dict[str, Any], expected: tuple[Any, ...]) -> None:
    assert StatedLaw.read({**LAW, "domain": given}).ranges == expected


@pytest.mark.parametrize(
    "change",
    [
        {"forces": "ab"}, {"constraints": "m < n"}, {"forces": []}, {"forces": ["a", "a"]}, {"forces": ["a", "b", "s"]},
        {"forces": ["a", "pi"]},
        {"forces": ["a", "b c"]}, {"forces": ["a", "max"]}, {"forces": ["a", "\ufb01"]}, {"pressure": "m"}, {"pressure": "s t"},
        {"constraints": ["m + n"]},
        {"constraints": ["m < a"]}, {"constraints": ["m < s"]}, {"g": "m - n"}, {"g": "a < b"},
        {"g": "a - unknown"},
        {"flow": ["a"]}, {"flow": ["a", "b", "a"]}, {"flow": "ab"}, {"flow": ["a", "a < b"]}, {"flow": ["a", "c"]},
        {"flow": {"potential": "c"}},
        {"flow": {"potential": "atan2(a, b)"}}, {"domain": {"s": {"min": "0"}}}, {"domain": {"s": {"min": "1"}}},
        {"domain": {"a": {"min": "1", "max": "1"}}},
        {"domain": {"a": {"min": "1", "max": "-1"}}}, {"domain": {"m": {"min": "-1"}}}, {"domain": {"s": {"min": "-1", "max": "-2"}}},
        {"domain": {"s": {"value": "0"}}},
        {"domain": {"a": {"positive": True}}}, {"surfaces": TWO}, {"domain": {"s": {"positive": True}}},
    ],
)  # fmt: skip
def test_what_is_no_law_is_not_read(change: dict[str, Any]) -> None:
    with pytest.raises(NotWritten):
        StatedLaw.read({**LAW, **change})


@pytest.mark.parametrize("surfaces", [[], [{"g": "m", "flow": None}], [{"g": "a", "flow": "ab"}], [{"g": "a", "flow": ["1"]}]])
def test_what_is_no_surface_is_not_read(surfaces: list[Any]) -> None:
    with pytest.raises(NotWritten):
        StatedLaw.read(of_surfaces(*surfaces))
    for more in ({"g": "a"}, {"flow": None}):
        with pytest.raises(NotWritten):
            StatedLaw.read({**of_surfaces(*TWO), **more})


@pytest.mark.parametrize(
    ("point", "inside"),
    [
        ({"m": "1", "n": "3"}, True), ({"m": "3", "n": "3"}, False), ({"m": "0", "n": "3"}, False), ({"m": "1", "n": "2"}, False),
        ({"m": "1"}, False),
        ({"m": "1", "n": "3", "s": "-1"}, False), ({"m": "2.99", "n": "3"}, True),
    ],
)  # fmt: skip
def test_a_point_of_the_domain(point: dict[str, str], inside: bool) -> None:
    law = StatedLaw.read(LAW)
    assert inhabited(law.parameters, law.constraints, {n: exact(x) for n, x in point.items()}) is inside
    weak = (parse("m <= 3"), parse("m*m + n > m"))
    assert inhabited(law.parameters, weak, {n: exact(x) for n, x in point.items()}) is (inside or point == {"m": "3", "n": "3"})
    assert not inhabited(law.parameters, (parse("exp(m) < 9"),), {"m": F(1), "n": F(3)})


# -- gradients ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "a", "3", "a + 2*b", "a*b*a", "a**3*b", "(2 + a**2)**0.5", "norm(a, 2*b, 1)", "(3 + a)**m", "exp(a*b)", "log(3 + a)",
        "sin(2*a)*b", "cos(a*b)", "tan(a/2)",
        "sinh(a) + cosh(b*a)", "tanh(a*b)", "atan(2*a)", "asin(a/4) + acos(b/5)", "abs(a)*b", "abs(-a)", "pos(a)*2 + pos(-a)",
        "neg(a) + neg(b)", "max(a, b, 0)",
        "max(b, a)", "min(a, b, a*b)", "min(b, a)", "max(a)", "where(a > b, a**2, b*a)", "where(a < b, a**2, b*a)",
        "eigmax(a, b, 1, 1/2, a, b/3)", "eigmax(b, 2*a, a, b, 1/4, a*b)", "a/b", "m*a - b/m", "2**3*a",
    ],
)  # fmt: skip
def test_gradients_are_slopes(text: str) -> None:
    potential, h = parse(text), 1e-6
    for at in ({"a": 0.7, "b": -0.4, "m": 1.5}, {"a": -0.3, "b": -0.8, "m": 0.5}, {"a": 0.2, "b": 0.9, "m": 2.5}):
        for x, slope in zip("ab", gradient(potential, ("a", "b")), strict=True):
            after, before = (drawn_formulas.value(potential, {**at, x: at[x] + way}) for way in (h, -h))
            assert drawn_formulas.value(slope, at) == pytest.approx((after - before) / (2 * h), rel=1e-6, abs=1e-8), (x, at)


@pytest.mark.parametrize("text", ["atan2(a, b)", "m**a", "a**b"])
def test_what_has_no_gradient(text: str) -> None:
    with pytest.raises(NotWritten):
        gradient(parse(text), ("a", "b"))


# -- certificates ------------------------------------------------------------------------------------------------------


def certified(proofs: list[tuple[str, str, str | None]], **change: Any) -> dict[str, Any]:
    trusts = {(v, r): None if v != "proved" else "prover" if r is None else "checked" for _, v, r in proofs}
    rows = [{"claim": c, "verdict": v, "trust": trusts[v, r], "method": "", "rule": r, "evidence": {}} for c, v, r in proofs]
    law = {**LAW, "g": "norm(a, b) + m*s"}
    made = {"schema": SCHEMA, "law": law, "inhabited": {"m": "1", "n": "3"}, "claims": rows}
    made |= change
    return {"sha256": digest(made), **made}


PROOFS = [
    ("dissipation", "proved", "fenchel"), ("normality", "proved", "normality-rule"), ("convexity", "proved", "composition"),
    ("origin", "proved", "evaluation"), ("smoothness", "refuted", None), ("state_laws", "proved", "by-construction"),
    ("duality", "proved", None),
]  # fmt: skip


def test_a_certificate_is_checked_claim_by_claim() -> None:
    found = {row.claim: row for row in recheck(certified(PROOFS))}
    assert list(found) == ["origin", "convexity", "smoothness", "normality", "dissipation", "duality", "state_laws"]
    assert {claim for claim, row in found.items() if row.confirmed} == {"origin", "convexity", "normality", "dissipation", "state_laws"}
    assert found["smoothness"].reason == "only proofs are checked" and found["duality"].reason == NO_RULE
    assert {claim: row.outcome for claim, row in found.items()} == {
        **dict.fromkeys(("origin", "convexity", "normality", "dissipation"), "confirmed"),
        "smoothness": "no proof", "duality": "no rule", "state_laws": "by construction",
    }  # fmt: skip
    assert found["origin"] == ("origin", "proved", "checked", True, "", False)


def test_a_certificate_from_before_laws_had_a_state_is_confirmed() -> None:
    """Its rule of the state laws has another name, and says the same of a law that states no energy."""
    (now,), (before,) = (recheck(certified([("state_laws", "proved", rule)])) for rule in ("by-construction", "symbolic"))
    assert now == before and before.confirmed and before.by_construction


@pytest.mark.parametrize("missing", ["origin", "convexity", "normality"])
def test_what_a_claim_rests_on_must_be_confirmed(missing: str) -> None:
    for left in ([row for row in PROOFS if row[0] != missing], [(c, "undecided" if c == missing else v, r) for c, v, r in PROOFS]):
        confirmed = {row.claim for row in recheck(certified(left)) if row.confirmed}
        assert confirmed == {"origin", "convexity", "normality", "state_laws"} - {missing} - (
            {"normality"} if missing == "convexity" else set()
        )


@pytest.mark.parametrize(
    "change",
    [
        {"schema": "another"}, {"inhabited": {"m": "4", "n": "3"}}, {"inhabited": {"m": "1"}}, {"inhabited": {"m": 1, "n": "3"}},
        {"inhabited": None},
        {"law": {}}, {"claims": None}, {"claims": [{}]}, {"law": {**LAW, "constraints": ["m < 0"]}},
    ],
)  # fmt: skip
def test_what_is_no_certificate_is_refused(change: dict[str, Any]) -> None:
    assert recheck(certified(PROOFS))
    with pytest.raises(NotWritten):
        recheck(certified(PROOFS, **change))


def test_a_claim_is_stated_once_and_known_and_the_content_is_hashed() -> None:
    for claims in ([*PROOFS, PROOFS[0]], [("beauty", "proved", "evaluation")]):
        with pytest.raises(NotWritten):
            recheck(certified(claims))
    made = certified(PROOFS)
    with pytest.raises(NotWritten):
        recheck({**made, "claims": made["claims"][1:]})
    assert digest({"b": "é", "a": [1, {"c": None}], "sha256": "x"}) == digest({"a": [1, {"c": None}], "b": "é"})
    assert digest({"a": 1}) == "015abd7f5cc57a2dd94b7590f04ad8084273905ee33ec5cebeae62276a97f862"


def test_the_keys_of_evidence_are_those_that_the_rules_read() -> None:
    source = inspect.getsource(rules)
    assert set(re.findall(r'evidence(?:\.get\(|\[)"([^"]+)"', source)) | {"slips"} == set(EVIDENCE)
