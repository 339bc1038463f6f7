"""Other forms of g with the same K, values of the parameters and ranges of the forces that are suggested for an open claim."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import pytest

from duhem import Criterion, Verdict, verify
from duhem.expression.abbreviations import Stress
from duhem.law.domain import POSITIVE, Domain
from duhem.law.formula_law import YieldSurface
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.curvature import within_ranges
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from duhem.proof.unsettled import trials
from duhem.proof.unsettled.forms import equal_forms, other_forms
from duhem.proof.unsettled.limits import keeps_k, same_points, with_values
from duhem.proof.unsettled.ranges import around_the_boundary, between
from duhem.proof.unsettled.term_text import in_text
from duhem.proof.unsettled.trials import Rewriting
from tests.long import long_at
from tests.oracles import drawn_formulas
from tests.proof.test_open_claims import ANY, AT_LEAST_0, changed, law, opened

F83 = Fraction(83, 100)


SAND = law("q - m*p*(1 + (n - 1)*(p/c)**(n/(1 - n)))/n", {"m": POSITIVE, "n": Domain.between("1/5", "2/5"), "c": POSITIVE}, "pq",
           domain={"p": AT_LEAST_0, "q": AT_LEAST_0})  # fmt: skip
ROCK = law("max(a, b) - min(a, b) - s*(u - m*max(a, b)/s)**e",
           {"s": POSITIVE, "m": POSITIVE, "u": Domain.between(0, 1), "e": Domain.between("1/2", "3/4")})  # fmt: skip
SIDES = law("(abs(a)/where(a > 0, u, v))**n + (abs(b)/w)**n - 1", {x: POSITIVE for x in "uvw"} | {"n": Domain.between(1, 4)})
CUBE = law("abs(b)**3 + c*pos(b)**3 - (1 - a)**3", {"c": Domain.between(0, 1)})
FORMS = [
    (ROCK, "convexity", "((max(a, b) - min(a, b))/s)**(1/e) - (u - m*max(a, b)/s)"),
    (SIDES, "convexity", "pos(a)/u + neg(a)/v"),
    (SAND, "smoothness", "m*(p + (n - 1)*(1/c)**(n/(1 - n))*p**(n/(1 - n) + 1))/n"),
    (CUBE, "convexity", "(abs(b)**3 + c*pos(b)**3)**(1/3) - (1 - a)"),
]


def inside_both(criterion: Criterion, g: str, seed: int) -> tuple[set[bool], bool]:
    """Which answers there are to whether a point lies in K, and whether both forms give the same at all points, by the terms themselves."""
    draw, answers, same = Random(seed), set[bool](), True
    for _ in range(400):
        names = {name: math.exp(draw.uniform(-1, 1)) for name in criterion.parameters}
        at = {
            name: min(max(x, float(own.low or 0)), float(own.high or 9))
            for (name, x), own in zip(names.items(), criterion.parameters.values(), strict=True)
        }
        for force in criterion.forces:
            own, x = criterion.domain.get(force, ANY), draw.gauss(0, 1) * math.exp(draw.uniform(-2, 2))
            at[force] = x if own.low is None else max(x, float(own.low))

        def level(text: str, at: dict[str, float] = at) -> float:
            try:
                return float(drawn_formulas.value(parse(text), at))
            except (ValueError, OverflowError, ZeroDivisionError, TypeError):
                return math.inf

        one, two = level(criterion.written), level(g)
        if min(abs(one), abs(two)) > 1e-9:
            answers.add(one <= 0)
            same &= (one <= 0) == (two <= 0)
    return answers, same


@pytest.mark.parametrize(("criterion", "claim", "form"), long_at((3,), FORMS))
def test_another_form_with_the_same_k_is_suggested_and_proves_the_claim(criterion: Criterion, claim: str, form: str) -> None:
    told = next(action for action in opened(criterion, claim).actions if "K stays the same" in action or "K is the same" in action)
    assert told.startswith("write ") and form in told
    after = changed(criterion, told)
    assert verify(after, claims=[claim])[claim].verdict is Verdict.PROVED
    answers, same = inside_both(criterion, after.written, 3)
    assert same and answers == {True, False}


@pytest.mark.parametrize(
    ("g", "other"),
    [
        ("where(a > 0, a**2 + b**2 - 1, -1)", "a**2 + b**2 - 1"),
        ("where(a < 0, b - 1, b + a - 1)", "b - 1"),
        ("a**2 + b**2 - 1", "a**2 + b**2 - 101/100"),
        ("sqrt(a) + b - 1", "sqrt(abs(a)) + b - 1"),  # K of the first ends where a < 0
        ("where(norm(a, b) > 0, b**2 - a, 5)", "b**2 - a"),  # zero force is in the second K alone
        ("abs(b) - where(a > 0, a, 0)", "abs(b) - a"),  # the half-line b = 0, a < 0 is in the first K alone
        ("where(a > 0, b**2 - a, abs(a + 3))", "b**2 - a"),  # the line a = -3 is, too
    ],
)
def test_a_form_with_another_k_is_not_taken_for_the_same(g: str, other: str) -> None:
    subject = FormulaSubject(law(g))
    assert same_points(subject, other) == 0 and same_points(subject, f"2*({g})") > 1000


def test_no_form_is_compared_where_k_is_known_not_to_be_convex() -> None:
    """It would be said to have the same K, and to be convex."""
    bent = law("where(a > 0, a**2 + b**2, a**2 + e*b**2) - c", {"e": Domain.between(1, "10001/10000"), "c": POSITIVE})
    found = verify(bent, effort="quick")
    assert found["convexity"].verdict is Verdict.REFUTED
    assert not any("compared" in action for r in found.results if r.unsettled is not None for action in r.unsettled.actions)


@pytest.mark.parametrize(
    ("g", "other"),
    [
        ("where(a > b, a**2 + b**2, (a + b)**2 - 2*a*b) - 1", "a**2 + b**2 - 1"),  # one function, written in two ways
        ("max(a**2/9 - 1, where(b < 0, b**2 - b + a**2/9 - 1, -1), b + a**2/9 - 1)",
         "max(a**2/9 - 1, min(b, 0)**2 - min(b, 0) + a**2/9 - 1, b + a**2/9 - 1)"),
        ("where(a > b, a, b) - 1", "max(a, b) - 1"),
    ],
)  # fmt: skip
def test_a_choice_may_be_left_out_where_k_stays_the_same(g: str, other: str) -> None:
    read, subject = StatedLaw.read(law_as_text(law(g))), FormulaSubject(law(g))
    found = [in_text(read.g.put({part: new}), {}) for part, new, _ in other_forms(read)]
    kept = [text for text in found if same_points(subject, text)]
    assert in_text(parse(other), {}) in kept
    assert all(inside_both(law(g), text, 5)[1] for text in kept)


@pytest.mark.parametrize(
    ("g", "high", "known"),
    [("a + b - (1 - a)**k", "9/10", True), ("a + b - (1 - a)**k", 1, False), ("a + b - (1 - a)**k", 2, False),
     ("abs(b) - (1 - a)**k", 1, True), ("abs(b) - (1 - a)**k", 2, False)],
)  # fmt: skip
def test_k_of_a_root_alone_is_known_to_stay_where_no_power_of_less_than_0_has_a_value(g: str, high: str | int, known: bool) -> None:
    """At a = 3, b = -8 of the first law (1 - a)**1 = -2 has a value, and its root form has none; of the last (1 - a)**2 has one."""
    read = StatedLaw.read(law_as_text(law(g, {"k": Domain.between("1/2", high)})))
    ((_, _, found),) = other_forms(read)
    assert found is known


@pytest.mark.long
def test_a_form_of_which_other_claims_are_open_says_so() -> None:
    """Yu's CASM (1998): times p**n it is proved that zero force lies in K, and no longer that K is convex."""
    parameters = {"m": Domain.between("4/5", "3/2"), "n": Domain.between(1, 5), "r": Domain.between("3/2", 10), "c": POSITIVE}
    casm = law("(q/(m*p))**n + log(p/c)/log(r)", parameters, "pq", domain={"p": AT_LEAST_0, "q": AT_LEAST_0})
    told = next(action for action in opened(casm, "origin").actions if "times g" in action)
    assert "(for this claim alone: convexity would be open)" in told
    assert verify(casm, claims=["convexity"])["convexity"].verdict is Verdict.PROVED
    assert verify(changed(casm, told), claims=["convexity"])["convexity"].verdict is not Verdict.PROVED


def test_another_form_keeps_the_flow_of_the_law_and_joins_its_surfaces() -> None:
    own = law_as_text(law("norm(a, b) - m*sqrt(1 - a)", {"m": POSITIVE}, potential="norm(a, b)"))
    assert own["flow"] and trials._changed(own, Rewriting("", "a - 1"), {}) == {**own, "g": "a - 1"}
    faces = law_as_text(Criterion("faces", forces=("a", "b"), pressure=None, surfaces=(YieldSurface("a - 1"), YieldSurface("b - 1"))))
    assert "surfaces" in faces and "surfaces" not in trials._changed(faces, Rewriting("", "max(a - 1, b - 1)"), {})


@pytest.mark.long
def test_what_a_formula_divides_by_may_depend_on_the_pressure_alone() -> None:
    g = "abs(t) - (abs(n)*(1 - h)*((1 + n/s)**4*tan(i) + tan(f)) + h*c)/(1 - (1 - h)*(1 + n/s)**4*tan(i)*tan(f))"
    joint = Criterion(
        "joint", g.replace("h", "(1 - (1 + n/s)**1.5)"),
        {"s": Domain.between(20, 100), "c": POSITIVE, "f": Domain.between("2/5", "7/10"), "i": Domain.between("1/20", "1/2")}, ("t",), "n",
        domain={"n": Domain.between(-20, 0)},
    )  # fmt: skip
    for claim in ("convexity", "normality"):
        assert (opened(joint, claim).part or "").startswith("1/(1 - ")


@pytest.mark.long
def test_values_at_which_no_effect_is_gone_are_tried_before_0() -> None:
    ply = law("((a*cos(t)**2 + b*sin(2*t))/x)**2 - (a*cos(t)**2 + b*sin(2*t))*(a*sin(t)**2 - b*sin(2*t))/(x*y) + "
              "((a*sin(t)**2 - b*sin(2*t))/y)**2 + ((b*cos(2*t) - a*sin(t)*cos(t))/s)**2 - 1",
              {"x": POSITIVE, "y": POSITIVE, "s": POSITIVE, "t": Domain.between(0, "157/100")})  # fmt: skip
    (told,) = opened(ply, "convexity").actions
    assert re.search(r"--set t=(?!0\b)", told) and verify(changed(ply, told), claims=["convexity"])["convexity"].verdict is Verdict.PROVED


def in_principal(g: str, **parameters: Domain) -> Criterion:
    return law(g, parameters, (), stress=Stress("s", "principal"))


@pytest.mark.parametrize(
    ("g", "known"),
    [("abs(b) - (1 + exp(a))*(2 - a)", True), ("b/a - 1", False), ("abs(b) - (2 - exp(a))*(2 - a)", False)],
)
def test_k_is_known_to_stay_where_g_is_divided_by_what_is_above_0_and_has_a_value(g: str, known: bool) -> None:
    """b/a - 1 has no value at a = 0, where b - a has one; 2 - exp(a) may be < 0."""
    read = StatedLaw.read(law_as_text(law(g, domain={"a": AT_LEAST_0})))
    assert any(sure and new != read.g for _, new, sure in other_forms(read)) is known


@pytest.mark.parametrize("value", ["0", "1", "-7"])
def test_a_factor_that_depends_on_the_lode_angle_is_divided_by(value: str) -> None:
    """A value that is written where J2 is 0 may be one at which the factor is < 0: K is not known to stay."""
    factor = "(3 - k*cos3theta)", f"(3 - k*where(J2 > 0, cos3theta, {value}))"
    for own, sure in ((factor[0], True), (factor[1], False)):
        cone = in_principal(f"sqrt(J2) + (I1 - 1)/{own}", k=Domain.between("1/2", 1))
        read = StatedLaw.read(law_as_text(cone))
        assert any(known for _, _, known in other_forms(read)) is sure
    (told,) = opened(
        cone := in_principal("sqrt(J2) + (I1/3 - 1)*(1 + k*cos3theta)**(-1/4)", k=Domain.between(0, "3/4")), "convexity"
    ).actions
    assert told.startswith("write sqrt(J2(s))*(1 + k*cos3theta(s))**(1/4) + ") and ": K stays the same" in told
    after = in_principal(told.split(" for ")[0].removeprefix("write ").replace("(s)", ""), **cone.parameters)
    assert verify(after, claims=["convexity"])["convexity"].verdict is Verdict.PROVED


@pytest.mark.long
def test_ranges_of_both_forces_are_suggested_in_which_enclosures_show_that_k_is_convex() -> None:
    """For all values of bounded parameters; the ranges hold K: no point of it, as rays from zero force find it, lies outside."""
    wave = law("a**2 + b**2*(1 + e*tanh(a)) + h*sin(a)*b - 1", {"e": Domain.between("-3/10", "3/10"), "h": Domain.between(0, "1/5")})
    found = verify(wave, claims=["convexity"], effort="quick")
    for result in found.results:
        assert result.unsettled is not None
        (told,) = result.unsettled.actions
        assert told.startswith("ask for forces near K alone: a = { min = ") and "--set" not in told
        after = changed(wave, told)
        assert verify(after, claims=[result.claim])[result.claim].verdict is Verdict.PROVED
        for angle in range(0, 360, 5):
            x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            r = max(r / 100 for r in range(400) if level_of(wave, r / 100 * x, r / 100 * y) <= 0)
            for name, value in (("a", r * x), ("b", r * y)):
                assert float(after.domain[name].low or 0) <= value <= float(after.domain[name].high or 0)


def level_of(criterion: Criterion, a: float, b: float) -> float:
    return float(drawn_formulas.value(parse(criterion.written), {"a": a, "b": b, "e": -0.3, "h": 0.2}))


def test_the_middle_of_a_range_is_tried_before_its_ends_and_what_is_proved_at_it_up_to_an_end() -> None:
    assert next(iter(trials._plain({"min": "2/3", "max": "1"}))) == F83 and [*trials._plain({"min": "0", "max": "3"})][-2:] == [3, 0]
    told = [words for _, words in trials._narrower({"min": "2/3", "max": "1"}, [F83])]
    assert {'min = "83/100"', 'max = "83/100"', 'min = "5/6"'} <= {*told}


@pytest.mark.long
def test_a_value_at_a_tip_with_which_a_claim_is_refuted_is_suggested() -> None:
    found = opened(in_principal("sqrt(J2(s))*(2 + cos3theta(s)) + c", c=POSITIVE), "origin")
    assert [*found.actions] == ["write where(J2(s) > 0, cos3theta(s), 0) for cos3theta(s), if you mean 0 there (then it is refuted)"]


# g has no value at a load of 0, with 0 for a part zero force lies in K, and K is another set
@pytest.mark.parametrize(("g", "forces"), [("log(p) + q", "pq"), ("q/p - m", "pq"), ("((a + b + c)**3/(a*b*c) - 27) - m", "abc")])
def test_no_value_is_suggested_that_changes_k(g: str, forces: str) -> None:
    loaded = law(g, {"m": POSITIVE}, forces, domain=dict.fromkeys(forces, AT_LEAST_0))
    told = [*with_values(StatedLaw.read(law_as_text(loaded)), {})]
    kept = {said: keeps_k(FormulaSubject(loaded), in_text(changed_g, {})) for said, changed_g in told}
    assert any("if you mean 0 there" in said for said in kept) and any("times g" in said for said in kept)
    # zero force is a limit of points of K: to have it in K changes nothing; a line of points beside it would
    assert not any(keeps for said, keeps in kept.items() if "if you mean 0 there" in said and "norm(" not in said)
    assert not any("if you mean 0 there" in action and "norm(" not in action for action in opened(loaded, "origin").actions)


@pytest.mark.parametrize(
    ("forces", "part", "divisor"), [(("a", "b"), "(a - 2*b)**3", "abs(a - 2*b)"), (("x", "y", "t"), "(x - y)*t", "norm(x - y, t)")]
)
def test_no_line_of_forces_far_from_k_is_added_to_it(forces: tuple[str, ...], part: str, divisor: str) -> None:
    """Times what it divides by, g is 0 all along that line, on which no place lies that is drawn by itself."""
    size = f"norm({', '.join(forces)})"
    subject = FormulaSubject(Criterion("own", f"{part}/{divisor} + {size} - 1", {}, forces, None))
    assert not keeps_k(subject, f"{part} + {size}*{divisor} - {divisor}")
    assert keeps_k(subject, f"where({divisor} > 0, {part}/{divisor}, 0) + {size} - 1")


@pytest.mark.long
def test_of_several_parts_without_a_value_at_zero_force_each_is_given_one() -> None:
    steel = law(
        "q - k*(1 - c*(I1(s)/(3*q) - 1/3))*(1 - d*cos(lode(s)))".replace("q", "sqrt(3*J2(s))"),
        {"k": POSITIVE, "c": Domain.between(0, "1/10"), "d": Domain.between(0, "1/10")}, (), stress=Stress("s", "principal"),
    )  # fmt: skip
    (action,) = opened(steel, "origin").actions
    assert action.count("norm(s_1, s_2, s_3) > 0") == 2 and "lode(s), 0) for lode(s)" in action and "I1(s)" in action


def test_a_product_of_an_energy_is_written_with_the_same_value() -> None:
    own = {"k": POSITIVE, "H": POSITIVE, "t": POSITIVE, "c": AT_LEAST_0}
    wear = law("abs(A) - k", own, "A", energy="H*(c*log(1 + c/t))", variables={"c": Variable("A")})
    (action,) = opened(wear, "state_laws").actions
    assert action.startswith("write t*(1 + c/t)*log(1 + c/t) - t*log(1 + c/t) for c*log(1 + c/t) in psi")
    assert verify(changed(wear, action.partition(", which")[0]), claims=["state_laws"])["state_laws"].verdict is Verdict.PROVED


@pytest.mark.parametrize(
    "g", ["cosh(a)*cosh(b/2)*c", "exp(a)*exp(-b)*c - 1", "(2*a + 3)*log(1 + a/2)*c", "a*log(c + a) + cosh(a)*cosh(a + b)*cosh(b)",
          "a**2 + b**2 + c*abs(a*b) - 1", "3 + abs(a*b)*(1 + c)/2 + b*abs(a*b - c)"]
)  # fmt: skip
def test_equal_forms_have_the_same_values(g: str) -> None:
    read, draw = StatedLaw.read(law_as_text(law(g, {"c": POSITIVE}))), Random(5)
    forms = list(equal_forms(read.g, within_ranges(read)))
    assert forms
    for part, new in forms:
        at = {"a": draw.uniform(0, 2), "b": draw.uniform(-2, 2), "c": draw.uniform(1, 2)}
        assert math.isclose(drawn_formulas.value(read.g.put({part: new}), at), drawn_formulas.value(read.g, at), rel_tol=1e-12)


def test_a_size_that_is_no_convex_one_is_written_as_the_greater_of_two_where_its_factor_is_at_least_0() -> None:
    """As in Ilyushin's criterion for plates: both formulas are quadratic."""
    plate = law("m**2 + n**2 + p**2 + q**2 + k*abs(m*n + p*q) - 1", {"k": Domain.between(0, 1)}, "mnpq")
    (told,) = opened(plate, "convexity").actions
    assert told.startswith("write max(m**2 + n**2 + p**2 + q**2 + k*(m*n + p*q) - 1, m**2 + n**2 + p**2 + q**2 - k*(m*n + p*q) - 1) for ")
    assert verify(changed(plate, told), claims=["convexity"])["convexity"].verdict is Verdict.PROVED
    for g in ("m**2 - k*abs(m*n) - 1", "m**2 + (k - 1/2)*abs(m*n) - 1", "m**2 + k*abs(m + n) - 1", "m**2 + n*abs(m*n) - 1"):
        read = StatedLaw.read(law_as_text(law(g, {"k": Domain.between(0, 1)}, "mn")))
        assert not any(new.op == "max" for _, new in equal_forms(read.g, within_ranges(read)))


@pytest.mark.parametrize(("claim", "sign"), [("dissipation", "<="), ("smoothness", "<")])
def test_a_root_of_a_quadratic_form_is_told_the_minors_of_its_matrix(claim: str, sign: str) -> None:
    """As in Gol'denblat and Kopnov's criterion: the root has a value for all forces, and is convex, where the form is >= 0."""
    ply = law("a/10 + sqrt(h*a**2 + 2*m*a*b + k*b**2) - 1", {"h": POSITIVE, "k": POSITIVE, "m": ANY})
    (told,) = opened(ply, claim).actions
    assert told.startswith(f'add the constraint "m**2 {sign} h*k"')
    assert verify(changed(ply, told), claims=[claim])[claim].verdict is Verdict.PROVED


def test_what_a_rule_for_ranges_shows_is_asked_though_the_others_did_not_show_it() -> None:
    box = {"domain": {x: {"min": "-2", "max": "2"} for x in "ab"}}
    wave = law_as_text(law("a**2 + b**2*(1 + tanh(a)/5) + sin(a)*b/5 - 1")) | box
    asked = trials._Asked("smoothness", wave, frozenset(), None, trials.Attempts())
    assert [asked(wave), asked(wave, rules=("slope-in-a-box",)), asked(wave)] == [False, True, True]


@pytest.mark.parametrize("size", ["1", "10**6", "10**(-6)"])
@pytest.mark.parametrize("pressures", [None, (-3, "-1/1000"), ("-1/2", None), (-3, -2)])
@pytest.mark.parametrize("forces", [None, ("0.123456", "1.23456")])
def test_ranges_near_k_lie_in_those_of_the_law_and_are_plain(size: str, pressures: Any, forces: Any) -> None:
    """Of every size of K; the ends can be read by the kernel, and K has boundary in them."""
    ranges = {"n": pressures, "a": forces if size == "1" else None}
    own = {name: Domain.between(*ends) for name, ends in ranges.items() if ends}
    g = f"norm(a, b)/({size}) + n*(1/2 + sin(a/({size}))*cos(b/({size}))/7)"
    wave = Criterion(name="law", g=g, forces=("a", "b"), pressure="n", domain=own)
    found = [*around_the_boundary(FormulaSubject(wave))]
    assert found
    for box in found:
        assert {*box} == {"a", "b", "n"}
        sides = {name: (Fraction(ends["min"]), Fraction(ends["max"])) for name, ends in box.items()}
        assert all(low < high and not re.search("[eE]", "".join(box[name].values())) for name, (low, high) in sides.items())
        assert all(own[name].covers(Domain.between(*ends)) for name, ends in sides.items() if name in own)
        replace(wave, domain={name: Domain.between(*ends) for name, ends in sides.items()})
        StatedLaw.read(law_as_text(wave) | {"domain": box})


def test_forces_of_one_sign_are_told_before_ranges_with_values() -> None:
    """Both forces of a damage law are energies, which are >= 0; the root has a value where both are."""
    damage = law("sqrt(a + b*c) - k", {"b": Domain.between("1/2", 4), "k": POSITIVE}, "ac")
    (told,) = opened(damage, "smoothness").actions
    assert told.startswith("ask for a >= 0 and c >= 0 alone: a = { min = 0 } and c = { min = 0 } in the section [domain]")
    both = {x: AT_LEAST_0 for x in "ac"}
    assert verify(replace(damage, domain=both), claims=["smoothness"])["smoothness"].verdict is Verdict.PROVED


def test_no_power_of_a_number_that_is_not_positive_is_told_as_a_constraint() -> None:
    """The criterion file that has it cannot be read."""
    finger = law(
        "norm(f, m/(c*n**k)) - n", {"c": Domain.between("1/10", 2), "k": Domain.between(0, "1/3")}, "nfm", domain={"n": AT_LEAST_0}
    )
    assert not any("0**" in told for told in opened(finger, "origin").actions)


class Answers:
    """In place of the kernel and of what decides: each says of a changed law what a test says, and counts nothing."""

    def __init__(self, claim: str, by_rules: Callable[[Any], bool], decided: Callable[[Any], bool] = lambda _: False) -> None:
        self.claim, self.rules, self.decides, self.steps, self.tried, self.kept = claim, by_rules, decided, 0, trials.Attempts(), 0

    def __call__(self, changed_law: Any, **_: Any) -> bool:
        return self.rules(changed_law)

    def by_rules(self, changed_law: Any) -> Verdict | None:
        return Verdict.PROVED if self.rules(changed_law) else None

    def decided(self, changed_law: Any) -> Verdict | None:
        return Verdict.PROVED if self.rules(changed_law) or self.decides(changed_law) else None

    def widens(self) -> None: ...

    def keep(self, told: str, _: Any) -> str:
        return told


def values_of(changed_law: Any) -> dict[str, Fraction]:
    return {name: Fraction(own["value"]) for name, own in changed_law["parameters"].items() if "value" in own}


PLANE = law_as_text(
    law("k*a**2 + m*b**2 + e*a - 1", {"k": Domain.between("1/5", 1), "m": Domain.between(0, 8), "e": Domain.between(-1, 1)})
)
KNOWN = {"k": Fraction(3, 5), "m": Fraction(4), "e": Fraction(1, 2)}


@pytest.mark.parametrize("known_by", ["rules", "everything"])
@pytest.mark.parametrize(
    ("settles", "off", "told"),
    [
        (lambda at: at.get("k") == 1, 1, "--set k=1"),  # an end of its range
        (lambda at: at.get("k") == 1, 0, None),
        (lambda at: at.get("k") == Fraction(2, 5), 0, "--set k=2/5"),  # a quarter of its range
        (lambda at: at.get("e") == -1 and "m" in at, 1, "--set m=4 --set e=-1"),
        (lambda at: at.get("m") == 4, 0, "--set m=4"),
        (lambda at: at.get("m") == 0 or at.get("k") == Fraction(1, 5), 1, "--set k=1/5"),  # before an effect that is gone
        (lambda at: at.get("m") == 0, 2, "--set m=0"),
        (lambda at: at.get("m") == 0 == at.get("e"), 2, "--set m=0 --set e=0"),
        (lambda at: at.get("m") == 0, 1, None),
    ],
)
def test_the_fewest_values_are_told_and_ends_of_ranges_are_tried(settles: Any, off: int, told: str | None, known_by: str) -> None:
    """Whatever shows the claim: no value that is not needed, and none that is 0 or an end of its range but where that is asked."""
    shown = [lambda changed_law: settles(values_of(changed_law)), lambda _: False]
    asked: Any = Answers("origin", *(shown if known_by == "rules" else reversed(shown)))
    found = trials._fixed(PLANE, (), frozenset("k"), [KNOWN], lambda plain: plain, asked, known_by == "everything", off)
    assert found == ([] if told is None else [told])


@pytest.mark.parametrize("name", KNOWN)
@pytest.mark.parametrize("verdict", [Verdict.PROVED, Verdict.REFUTED])
def test_one_parameter_alone_is_fixed_for_everything_that_decides(name: str, verdict: Verdict) -> None:
    """A search finds more where the others may have any value: a claim may be refuted then, and not at plain values of all."""
    asked: Any = Answers("origin", lambda _: False)
    asked.decided = lambda changed_law: verdict if values_of(changed_law) == {name: KNOWN[name]} else None
    (told,) = trials._fixed(PLANE, (), frozenset("k"), [KNOWN], lambda plain: plain, asked, True, 0)
    assert told == f"--set {name}={KNOWN[name]}" + (" (then it is refuted)" if verdict is Verdict.REFUTED else "")
    assert not trials._fixed(PLANE, (), frozenset("k"), [KNOWN], lambda plain: plain, asked, False, 0)


OWN = " (or set values of your own: ranges are then sought for them)"
BOXES = [{x: {"min": low, "max": high} for x in "ab"} for low, high in (("-4", "4"), ("-1", "1"), ("0.1", "0.5"), ("0.2", "0.3"))]


def inside(side: Any, low: float, high: float) -> bool:
    return low <= Fraction(side["min"]) and Fraction(side["max"]) <= high


@pytest.mark.parametrize(
    ("shown", "ranges", "more", "wide"),
    [
        (lambda box, own: inside(box["a"], -1, 4), {"a": ("-1", "4"), "b": ("-4", "4")}, "", True),  # one end, and both of the other
        (lambda box, own: inside(box["a"], -1, 1), {"a": ("-1", "1"), "b": ("-4", "4")}, "", True),  # a quarter
        (lambda box, own: inside(box["a"], -3, 3), {"a": ("-2.5", "2.5"), "b": ("-4", "4")}, "", True),  # halfway
        (lambda box, own: own["e"] == {"value": "1/2"}, {"a": ("-4", "4"), "b": ("-4", "4")}, f" and --set e=1/2{OWN}", True),
        (lambda box, own: "value" in own["e"] or inside(own["e"], 0, 1), {"a": ("-4", "4"), "b": ("-4", "4")},
         ' and e = { min = "1/2", max = 1 } in the section [parameters]', True),
        (lambda box, own: "value" in own["e"] or inside(own["e"], -0.5, 0.8), {"a": ("-4", "4"), "b": ("-4", "4")},
         ' and e = { min = "-1/4", max = "3/4" } in the section [parameters]', True),
        (lambda box, own: "value" in own["m"] and inside(box["b"], 0, 1), {"a": ("-4", "4"), "b": ("0.1", "0.5")},
         f" and --set m=4{OWN}", False),
    ],
)  # fmt: skip
def test_ranges_are_widened_and_parameters_freed_as_far_as_the_claim_is_shown(shown: Any, ranges: Any, more: str, wide: bool) -> None:
    asked: Any = Answers("convexity", lambda changed_law: shown(changed_law["domain"], changed_law["parameters"]))
    ((told, _),), half = trials._boxed(PLANE, [KNOWN], lambda _: BOXES, asked)
    near = " and ".join(f"{x} = {{ min = {low}, max = {high} }}" for x, (low, high) in ranges.items())
    near_k = "K" if all(ends == ("-4", "4") for ends in ranges.values()) else "a part of K"
    assert told == f"ask for forces near {near_k} alone: {near} in the section [domain]{more}" and half is wide


@pytest.mark.parametrize("seed", range(20))
def test_ranges_between_two_hold_the_narrow_one_and_lie_in_what_holds_both(seed: int) -> None:
    draw = Random(seed)
    ends = [sorted(Fraction(draw.randint(-999, 999), 10 ** draw.randint(0, 3)) for _ in range(2)) for _ in range(2)]
    narrow, wide = ({"min": str(float(low)), "max": str(float(high))} for low, high in ends)
    for side in between(narrow, wide):
        assert inside(narrow, *map(Fraction, side.values())) and inside(side, min(map(min, ends)), max(map(max, ends)))  # type: ignore[arg-type]
    assert not between(narrow, narrow)
