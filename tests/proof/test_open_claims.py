"""What is said of claims that stay open: the part that no rule reads, the closest place, and things to try, each of which helps."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion, Verdict, verify
from duhem.expression.abbreviations import Stress
from duhem.law.domain import POSITIVE, Domain
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.decide import Budget
from duhem.proof.facts.formula_subject import FormulaSubject, admitted_values
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.region import where_loads_allow
from duhem.proof.kernel.stated_law import StatedLaw, without_angles
from duhem.proof.kernel.steps import TooDearError
from duhem.proof.kernel.term import NotWritten, parse
from duhem.proof.unsettled import open_claims, trials
from duhem.proof.unsettled.blocked import blocked
from duhem.proof.unsettled.limits import with_values
from duhem.proof.unsettled.term_text import in_text, names_of
from duhem.proof.unsettled.trials import Attempts, that_help
from duhem.proof.verdict import Evidence, Unsettled, Witness
from duhem.regions import told as told_of_a_region
from duhem.show.printing import sheet, text
from tests.long import long_at, mostly_long
from tests.oracles import drawn_formulas

ANY, AT_LEAST_0 = Domain(), Domain.between(0)


def law(g: str, parameters: dict[str, Domain] | None = None, forces: Sequence[str] = "ab", **more: object) -> Criterion:
    return Criterion("law", g, parameters or {}, **({"forces": tuple(forces)} if forces else {}), pressure=None, **more)  # type: ignore[arg-type]


QUADRATIC = "a**2/x**2 + k*a*b + b**2/y**2 + a - 1"
# law, claim, part that no rule reads, what is lacking, what to try
TOLD = [
    (law("(q - p)**2 - m**2*p**2*(1 - (p/c)**r)", {"m": POSITIVE, "c": POSITIVE, "r": POSITIVE}, "qp"), "convexity",
        "(p/c)**r", "not shown to have a value", "ask for p >= 0 alone: p = { min = 0 } in the section [domain]"),
    (law("abs(q) - m*sqrt(p*(c - p))", {"m": POSITIVE, "c": POSITIVE}, "qp"), "convexity",
        "sqrt(p*(c - p))", "not shown to have a value", "write (abs(q)/m)**2 - p*(c - p) for abs(q) - m*sqrt(p*(c - p)): K stays the same"),
    (law("q**2 + m**2*p**2*log(p/c)", {"m": POSITIVE, "c": POSITIVE}, "qp"), "origin",
        "log(p/c)", "at zero force", "write where(norm(q, p) > 0, m**2*p**2*log(p/c), 0) for m**2*p**2*log(p/c), if you mean 0 there"),
    (law("abs(t) - h*(s + n)**k", {"h": POSITIVE, "s": POSITIVE, "k": Domain.between("1/2", 1)}, "tn"), "convexity",
        "(s + n)**k", "not shown to have a value", "ask for n >= 0 alone: n = { min = 0 } in the section [domain]"),
    (law(QUADRATIC, {"x": POSITIVE, "y": POSITIVE, "k": ANY}), "smoothness", QUADRATIC, "no rule shows that its gradient is not 0",
        'add the constraint "'),
    (law("norm(a, b) + a/2 - c*(1 - d)", {"c": POSITIVE, "d": ANY}), "dissipation",
        "norm(a, b)", "rise along the rays", 'add the constraint "d <= 1" (origin is proved then, too)'),
    (law("norm(a, b) + a/2 - log(s/t)", {"s": POSITIVE, "t": POSITIVE}), "dissipation", "norm(a, b) + a/2 - log(s/t)", "rays",
        'add the constraint "0 <= log(s/t)"'),
    (law("norm(a, b) - c*(1 - d)", {"c": POSITIVE, "d": ANY}), "smoothness",
        "norm(a, b)", "may be 0 on the boundary", 'add the constraint "d < 1"'),
    (law("sqrt(a**2 + c**2) - (d + m*b)", {"c": ANY, "d": ANY, "m": ANY}), "smoothness",
        "a**2 + c**2", "may be 0", "narrow c to what is > 0 (positive = true) and --set m=1/2"),
    (law("-k*(1 + c*cos3theta(s)) + sqrt(3*J2(s))", {"k": POSITIVE, "c": Domain.between(0, "1/9")}, (), stress=Stress("s", "principal")),
        "origin", "1/J2(s)**(3/2)", "at zero force", "write -k + sqrt(3*J2(s))/(1 + c*cos3theta(s)) for"),
    (law("norm(a, b) - c*(1 + d*cos(4*atan2(b, a)))", {"c": POSITIVE, "d": Domain.between(0, 1)}), "origin",
        "1/norm(a, b)**4", "at zero force",
        "write where(norm(a, b) > 0, cos(4*atan2(b, a)), 0) for cos(4*atan2(b, a)), if you mean 0 there"),
    (law("m*log(p/c) + q/p", {"m": POSITIVE, "c": POSITIVE}, "pq", domain={"p": AT_LEAST_0, "q": AT_LEAST_0}), "convexity", "q/p",
        "a product of 2 parts", "write where(p > 0, m*log(p/c)*p, 0) + q for g, which is p times g"),
    (law("(q/(m*p))**n + log(p/c)", {"m": POSITIVE, "c": POSITIVE, "n": Domain.between(1, 5)}, "pq",
         domain={"p": AT_LEAST_0, "q": AT_LEAST_0}), "origin", "1/(m*p)", "at zero force",
        "write (q/m)**n + where(p > 0, log(p/c)*p**n, 0) for g, which is p**n times g"),
    (law("((a + b + c)**3/(a*b*c) - 27)*(a + b + c)**m - h", {"m": Domain.between(0, 1), "h": POSITIVE}, "abc",
         domain=dict.fromkeys("abc", AT_LEAST_0)), "origin", "1/(a*b*c)", "at zero force",
        "write ((a + b + c)**3 - 27*a*b*c)*(a + b + c)**m - h*a*b*c for g, which is a*b*c times g"),
    (law("1 - exp(-(a**2 + b**2)**2 + a**3/100) - k", {"k": Domain.between(0, "9/10")}), "convexity", "exp(", "no rule shows",
        "ask for forces near K alone: a = { min = "),
    (law("q + m*p*log(p/c)", {"m": POSITIVE, "c": POSITIVE}, "pq", domain={"p": AT_LEAST_0, "q": AT_LEAST_0}), "smoothness", "log(p/c)",
        "not shown to have a value", "write p + p_end for p, with the parameter p_end = { positive = true }"),
    (law("t - m*n*log(-n/c)", {"m": POSITIVE, "c": POSITIVE}, "tn",
         domain={"n": Domain.between(-5, 0), "t": AT_LEAST_0}), "smoothness", "log(-n/c)",
        "not shown to have a value", "write n - n_end for n, with the parameter n_end = { positive = true }"),
    (law("t + m*n*log(n/c)", {"m": POSITIVE, "c": POSITIVE}, "tn"), "smoothness", "log(n/c)", "not shown to have a value",
        "with the parameter n_end = { positive = true } and n = { min = 0 } in the section [domain]"),
    (law("-k*(1 + c*cos(2*lode(s))) + sqrt(3*J2(s))", {"k": POSITIVE, "c": Domain.between(0, "1/9")}, (), stress=Stress("s", "principal")),
        "origin", "1/J2(s)**(3/2) in lode(s)", "at zero force", "write where(J2(s) > 0, lode(s), 0) for lode(s), if you mean 0 there"),
    (law("-(1 + q/p)**sqrt(2)/(2 + q/p)**(3*sqrt(2)) + p/c", {"c": POSITIVE}, "pq", domain={"p": AT_LEAST_0, "q": AT_LEAST_0}), "origin",
        "1/p", "at zero force", "if you mean 0 there"),
    (law("abs(t) - n*tan(b + d/(1 + n))", {"b": Domain.between("7/20", "3/5"), "d": Domain.between(0, "3/5")}, "nt",
         domain={"n": AT_LEAST_0}), "convexity", "tan(b + d/(1 + n))", "not shown to have a value", "ask for forces near K alone: n = {"),
    (law("((a + b + c)**3/(a*b*c) - 27)*(a + b + c)**m - h", {"m": Domain.between(0, 1), "h": Domain.between(10, 100)}, "abc",
         domain=dict.fromkeys("abc", AT_LEAST_0)), "convexity", "(a + b + c)**m", "a product of 2 parts", "--set m=0"),
    (law("norm(s, t)/p - 1/(2 + p)", {}, "pst", domain={"p": AT_LEAST_0}), "smoothness", "1/p", "not shown to have a value",
        "write norm(s, t) - p/(2 + p) for g, which is p times g (then it is refuted)"),
    (law("log(p/c) + abs(q/p - h) - e", {"c": POSITIVE, "h": Domain.between(0, 1), "e": AT_LEAST_0}, "pq", domain={"p": AT_LEAST_0}),
        "convexity", "abs(q/p - h)", "abs of what depends on the forces", "abs(q - h*p) - e*p for g, which is p times g"),
    (law("B*(cosh(a/s)*cosh(b/s) - 1)", {"B": AT_LEAST_0, "s": POSITIVE}, viscous=True), "convexity", "cosh(a/s)*cosh(b/s)",
        "a product of 2 parts", "write (cosh(a/s + b/s) + cosh(a/s - b/s))/2 for cosh(a/s)*cosh(b/s), which is the same"),
    (law("where(3*max(a, b) + min(a, b) > 0, max(a, b) - t, (a - b)**2/(8*t) + a + b)", {"t": POSITIVE}), "convexity",
        "where(3*max", "a choice by the forces", "none of them settles the claim"),
]  # fmt: skip


def opened(criterion: Criterion, claim: str) -> Unsettled:
    found = verify(criterion, claims=[claim], effort="quick")[claim]
    assert found.verdict in (Verdict.TESTED, Verdict.UNDECIDED) and found.unsettled is not None
    return found.unsettled


def written_out(criterion: Criterion, text: str) -> str:
    """A text with the invariants of the law's stress written out, as they are in the law."""
    for word in () if criterion.stress is None else ("lode", "cos3theta", "J2"):
        text = text.replace(f"{word}({criterion.stress.name})", f"({criterion.stress.written_out(word, None)})")
    return text


def unquoted(action: str) -> str:
    """Fractions without the marks that a criterion file needs."""
    return re.sub(r'= "(-?\d+/\d+)"', r"= \1", action)


def changed(criterion: Criterion, action: str) -> Criterion:
    """The law after what an action says."""
    first, _, then = unquoted(action).partition(", and then ")
    if then:
        return changed(changed(criterion, first), then)
    action = first
    more: dict[str, object] = {} if criterion.forces_of_rates else {"g": criterion.written, "written": ""}
    if found := re.match(r"narrow (\w+) to (?:(min|max) = (\S+)|what is > 0)", action):
        name, end, value = found.groups()
        own = criterion.parameters[name]
        low, high = (value if end == word else x for word, x in (("min", own.low), ("max", own.high)))
        positive = end is None or (end == "max" and own.positive)
        more["parameters"] = {**criterion.parameters, name: replace(Domain.between(None if positive else low, high), positive=positive)}
    if action.startswith("add the constraint"):
        more["constraints"] = (*criterion.written_constraints, *re.findall(r'"([^"]*)"', action))
        more["written_constraints"] = ()
    if action.startswith("ask for"):
        ranges = {name: dict(re.findall(r"(min|max) = ([^ ,}]+)", ends)) for name, ends in re.findall(r"(\w+) = \{ (.*?) \}", action)}
        sides = {name: Domain.between(ends.get("min"), ends.get("max")) for name, ends in ranges.items()}
        more["domain"] = {**criterion.domain, **{name: x for name, x in sides.items() if name not in criterion.parameters}}
        more["parameters"] = {**criterion.parameters, **{name: x for name, x in sides.items() if name in criterion.parameters}}
    if found := re.match(r"write (.*) for (.*)(?:: K (?:stays|is) the same|(?<! in psi), which is the same)", action):
        new, old = (parse(written_out(criterion, text)) for text in found.groups())
        read = without_angles(parse(criterion.written))
        assert old in read.parts(), action
        more |= {"g": in_text(read.put({old: new}), {}), "surfaces": ()}
    if found := re.match(r"write (.*) for (.*), if you mean 0 there", action):
        limit, part = (written_out(criterion, text) for text in found.groups())
        more["g"] = criterion.written.replace(part, limit)
    if found := re.match(r"write (\w+) ([+-]) (\w+) for \1, with the parameter", action):
        more["g"] = re.sub(rf"\b{found[1]}\b", f"({found[1]} {found[2]} {found[3]})", criterion.written)
        more["parameters"] = {**criterion.parameters, found[3]: POSITIVE}
        more["domain"] = criterion.domain if found[1] in criterion.domain else {found[1]: AT_LEAST_0}
    if found := re.match(r"write (.*) for (.*) in psi", action):
        more |= {"energy": criterion.written_energy.replace(found[2], found[1]), "written_energy": ""}
    if found := re.match(r"write (.*) for g, which is", action):
        more["g"] = found[1]
    settings = dict(re.findall(r"--set (\w+)=(\S+)", action))
    criterion = replace(criterion, **more)  # type: ignore[arg-type]
    return criterion.fix(settings) if settings else criterion


@pytest.mark.parametrize(("criterion", "claim", "part", "why", "action"), long_at((0, 3, 4, 14, 20, 21), TOLD))
def test_an_open_claim_names_the_part_that_no_rule_reads_and_what_helps(
    criterion: Criterion, claim: str, part: str, why: str, action: str
) -> None:
    found = opened(criterion, claim)
    assert found.part is not None and found.why is not None and part in found.part and why in found.why
    told = next(sentence for sentence in (*found.actions, *found.sentences()) if action in sentence)
    if told in found.actions:
        effort = "normal" if "forces near" in told else "quick"  # enclosures are too dear for quick
        settled = Verdict.REFUTED if told.endswith("(then it is refuted)") else Verdict.PROVED
        assert verify(changed(criterion, told), claims=[claim], effort=effort)[claim].verdict is settled
    else:
        assert not found.actions  # nothing that was tried helped, and nothing is suggested


IN_A_BOX = [  # K is not convex in the first two, and comes to a tip in the last
    law("softplus(a - b) + softplus(-a - b/2) - w*softplus(b) + (b**2 - 1)**2/9 - 2", {"w": Domain.between(0, "3/10")}),
    law("sin(2*a)*exp(b/3) + a**2 + b**2*(1 + w*cos(a)) - 1", {"w": Domain.between(0, 1)}),
    law("(q/(m*p))**n + log(p/c)", {"m": Domain.between("4/5", "3/2"), "n": Domain.between(1, 4), "c": POSITIVE}, "pq",
        domain={"p": AT_LEAST_0, "q": AT_LEAST_0}),
]  # fmt: skip


@pytest.mark.parametrize("criterion", long_at((1, 2), IN_A_BOX))
def test_smoothness_is_shown_in_ranges_and_away_from_a_tip(criterion: Criterion) -> None:
    """What is told is followed, and |g| + |grad g| looked at in floats over the ranges that are told."""
    (told,) = map(unquoted, opened(criterion, "smoothness").actions)
    box = {x: Domain.between(low, high) for x, low, high in re.findall(r"(\w+) = \{ min = (\S+), max = (\S+) \}", told)}
    g = criterion.written
    if moved := re.search(r"write (\w+) ([+-]) (\w+) for \w+, with the parameter \w+ = \{ value = (\S+) \}", told):
        name, sign, end, value = moved.groups()
        g = re.sub(rf"\b{name}\b", f"({name} {sign} {value})", g)
        assert f"farther from 0 than {value}" in told and end == f"{name}_end"
    followed = replace(criterion, g=g, written="", domain=box).fix(dict(re.findall(r"--set (\w+)=([^\s:]+)", told)))
    known = verify(followed, claims=["smoothness"])["smoothness"]
    assert known.verdict is Verdict.PROVED and "grad g is continuous" in known.detail and "star-shaped" not in known.detail
    x, y = followed.force_symbols()
    here = followed.g.subs({followed.symbols()[name]: own.high for name, own in followed.parameters.items()})
    grid = np.meshgrid(*(np.linspace(*box[name].ends, 601) + 1e-9 for name in followed.forces))
    with np.errstate(all="ignore"):
        found = (np.abs(np.broadcast_to(sp.lambdify((x, y), f, "numpy")(*grid), grid[0].shape)) for f in (here, here.diff(x), here.diff(y)))
        assert np.nanmin(sum(found)) > 1e-3


def test_what_is_settled_is_not_open() -> None:
    found = verify(law("norm(a, b) - 1"))
    assert all(result.unsettled is None and result.to_dict()["open"] is None for result in found)


def test_a_claim_that_follows_from_an_open_one_has_what_helps_it_too() -> None:
    for found in verify(TOLD[1][0], claims=["normality", "dissipation"], effort="quick"):
        assert found.unsettled is not None and found.unsettled.actions
        for action in found.unsettled.actions:
            assert verify(changed(TOLD[1][0], action), claims=[found.claim], effort="quick")[found.claim].verdict is Verdict.PROVED


def told_of(criterion: Criterion, claim: str, spent: bool = False, **verdicts: Verdict) -> tuple[str, ...]:
    """What is suggested for a claim that is open, where the others stand so."""
    subject = FormulaSubject(criterion)
    subject.allow(1)
    assert not spent or subject.budget.pays(1)
    settled = {
        name: Evidence(verdict, "none", "", shown_against(verdict)) for name, verdict in (*verdicts.items(), (claim, Verdict.TESTED))
    }
    found = open_claims.OpenClaims(criterion).unsettled(claim, subject, settled)
    assert found is not None
    return found.actions


def shown_against(verdict: Verdict) -> Witness | None:
    return Witness({}, {}, {}, "") if verdict is Verdict.REFUTED else None


def test_nothing_is_suggested_that_was_not_tried() -> None:
    """More steps, or values at which the claim seems to fail in floating point, need not help."""
    assert told_of(TOLD[-1][0], "convexity", spent=True) == ()
    assert [action[:15] for action in told_of(TOLD[1][0], "convexity", spent=True)] == ["write (abs(q)/m"]


def test_no_region_of_a_mere_scale_is_told() -> None:
    assert not told_of_a_region(TOLD[-1][0], "convexity", "law")


def test_the_closest_place_is_told_with_its_margin() -> None:
    egg = law("a**2 + b**2*exp(k*a) - 1", {"k": Domain.between("-3/10", "3/10")})
    found = opened(egg, "convexity")
    assert found.margin is not None and 0.5 < found.margin < 0.9 and set(found.place) == {"k", "a", "b"}
    told = json.loads(json.dumps(found.to_dict()))["closest"]
    at = {name: float(value) for name, value in told["place"].items()}
    assert abs(at["a"] ** 2 + at["b"] ** 2 * 2.718281828 ** (at["k"] * at["a"]) - 1) < 1e-4 and told["margin"] == found.margin


@pytest.mark.long
def test_a_place_at_which_the_claim_seems_to_fail_is_suggested() -> None:
    found = opened(TOLD[0][0], "convexity")
    sets = next(action for action in found.actions if "(then it is refuted)" in action)
    assert verify(changed(TOLD[0][0], sets), claims=["convexity"])["convexity"].verdict is Verdict.REFUTED


def test_no_values_are_suggested_at_which_k_is_empty() -> None:
    # a disk of radius c - 1, whose centre is not 0
    disk = law("(a - 9)**2 + b**2 - (c - 1)*abs(c - 1)", {"c": Domain.between(0, 5)})
    asked = open_claims._OpenClaim("smoothness", disk, law_as_text(disk), FormulaSubject(disk), {})
    choices = [{"c": Fraction(value)} for value in ("0", "1/2", "3")]
    assert next(iter(open_claims._with_k(asked, choices))) == {"c": 3}
    root = TOLD[8][0]
    about = "smoothness", law_as_text(root), frozenset[str]()
    assert that_help(*about, None, list) == ["narrow c to what is > 0 (positive = true) and --set m=1/2"]
    assert that_help(*about, None, lambda _: []) == []


def test_a_part_is_quoted_as_the_law_has_it_where_values_are_put_in() -> None:
    fixed = TOLD[2][0].fix({"m": "6/5", "c": 2})
    found = opened(fixed, "origin")
    assert found.part == "log(p/c)" and found.actions[0].startswith(
        "write where(norm(q, p) > 0, m**2*p**2*log(p/c), 0) for m**2*p**2*log(p/c)"
    )
    assert verify(changed(fixed, found.actions[0]), claims=["origin"])["origin"].verdict is Verdict.PROVED
    clay = opened(duhem.load("original-cam-clay"), "origin")
    assert " for M*p*log(p/pc), if you mean 0 there" in clay.actions[0]
    # a part that the law has too stays as it is
    names = names_of(law("2*a + k*a + b*(1 + k)", {"k": Domain.fixed(2)}))
    assert [in_text(parse(x), names) for x in ("2*a", "b*(1 + 2)")] == ["2*a", "b*(1 + k)"]


@pytest.mark.long
def test_large_ranges_are_told_before_an_effect_that_is_switched_off() -> None:
    """With t = 0 smoothness is proved as well."""
    wear = law("norm(a, b) - k*(1 + exp(-(1 + t*a/norm(a, b))*k/s))*tan(f)",
               {"k": POSITIVE, "s": POSITIVE, "t": Domain.between(0, "1/2"), "f": Domain.between("2/5", "4/5")})  # fmt: skip
    (told,) = opened(wear, "smoothness").actions
    assert told.startswith("ask for forces near K alone") and not re.search(r"--set \w+=0\b", told)
    assert verify(wear.fix({"t": 0}), claims=["smoothness"])["smoothness"].verdict is Verdict.PROVED
    assert not objection("smoothness", "slope-in-a-box", frozenset(), StatedLaw.read(law_as_text(changed(wear, told))), {})


def test_a_part_is_named_where_a_product_has_too_many_terms_and_the_whole_formula_where_no_part_is_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    side = "(sqrt(2*J2(s))*(1 + e*(1 + cos3theta(s))/2))"
    g = "((1 - k)*(I1(s)/3 + R/sqrt(6))**2 + sqrt(3/2)*R)**2 + k**2*m*(I1(s)/3 + R/sqrt(6)) - k**2*c".replace("R", side)
    large = law(g, {x: POSITIVE for x in "kmce"}, (), stress=Stress("s", "principal"))
    read = StatedLaw.read(law_as_text(large))
    with pytest.raises(NotWritten, match="too many terms"):
        where_loads_allow(read)
    found = [blocked(claim, read) for claim in ("convexity", "normality", "dissipation")]
    assert all(one is not None and in_text(one.part, names_of(large)).startswith("1/J2(s)**(3/2)") for one in found)
    subject, settled = FormulaSubject(TOLD[-1][0]), {"convexity": Evidence(Verdict.TESTED, "none", "")}
    subject.allow(1)

    def dear(*_: object) -> None:
        raise TooDearError

    monkeypatch.setattr(open_claims, "blocked", dear)
    told = open_claims.OpenClaims(TOLD[-1][0]).unsettled("convexity", subject, settled)
    assert told is not None and told.part == TOLD[-1][0].written and "whole formula" in (told.why or "")


@pytest.mark.long
def test_text_and_sheet_say_what_is_open() -> None:
    found = verify(TOLD[-1][0], claims=["convexity"], effort="quick")
    told, page = " ".join(text(found).split()), str(sheet(found))
    assert "open: v . Hess g v >= 0" in told and "which is a choice by the forces" in told and "Open: convexity" in page


@pytest.mark.parametrize("seed", range(40))
def test_a_term_is_written_as_text_that_is_read_as_the_same(seed: int) -> None:
    draw = Random(seed)
    term = parse(drawn_formulas.text(draw, 4))
    written = in_text(term, {})
    assert in_text(parse(written), {}) == written
    for at in ({**drawn_formulas.parameters(draw), **drawn_formulas.forces(draw)} for _ in range(20)):
        with suppress(ValueError, OverflowError, ZeroDivisionError):  # it has no value there
            assert math.isclose(drawn_formulas.value(parse(written), at), drawn_formulas.value(term, at), rel_tol=1e-6, abs_tol=1e-9), at


def test_a_constraint_has_nothing_of_the_forces_that_are_0() -> None:
    open_ = law("sqrt(a**2 + b**2 + c*d) - 1", {"c": ANY, "d": ANY})
    found = blocked("origin", StatedLaw.read(law_as_text(open_)))
    assert found is not None and [in_text(sign, {}) for sign in found.signs] == ["c*d"]


def test_what_goes_wrong_beside_a_verdict_leaves_it_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(*_: object) -> None:
        raise RuntimeError

    for name in ("law_as_text", "blocked"):
        with monkeypatch.context() as patch:
            patch.setattr(open_claims, name, wrong)
            found = verify(TOLD[-1][0], claims=["convexity"], effort="quick")["convexity"]
        assert found.verdict is Verdict.TESTED and found.unsettled is not None and found.unsettled.part is None
        assert found.unsettled.sentences() == ("open: v . Hess g v >= 0 for all v with v . grad g = 0, wherever g = 0",)


def test_a_term_is_written_with_the_names_of_its_law() -> None:
    criterion = duhem.load("original-cam-clay")
    term = parse("sqrt(3*((sigma_1 - sigma_2)**2 + (sigma_2 - sigma_3)**2 + (sigma_3 - sigma_1)**2)/6)*M")
    assert names_of(criterion)[parse("(-(sigma_1 + sigma_2 + sigma_3)/3)")] == "p"
    assert in_text(term, {parse("(sigma_1 - sigma_2)**2"): "d"}).startswith("sqrt((d + ")
    for given, same in (("a - (-b)", "a + b"), ("a/(b*c)", "a/(b*c)"), ("2/3*a**-2", "2/3/a**2"), ("(a/b)**c", "(a/b)**c")):
        assert in_text(parse(given), {}) == same


@pytest.mark.parametrize("g", ["a**4 + ({})*abs(a) - 1", "exp(a**2) + ({})*abs(a)**3 - 3"])
@pytest.mark.parametrize("constant", ["c*sin(c) - c**2 - 1/1000", "c*tanh(c) - c**2 - 1/1000"])
def test_no_constraint_is_suggested_that_no_parameter_satisfies(g: str, constant: str) -> None:
    # the constant is < 0 everywhere, and no rule shows it: of a law without admissible parameters every claim holds
    found = opened(law(g.format(constant), {"c": ANY}, "a"), "convexity")
    assert found.part is not None and found.part.startswith("c*")
    assert not any("add the constraint" in action for action in found.actions)


# -- followed to the letter ----------------------------------------------------------------------------------------------------

PROVED_TOO = re.compile(r"\(([a-z_, ]+) (?:is|are) proved then, too\)")
PQ = {"p": AT_LEAST_0, "q": AT_LEAST_0}
F = {"F1": ANY, "F2": ANY, "F11": POSITIVE, "F22": POSITIVE, "F12": ANY}
STATE = {"u": Variable("s", observable=True), "d": Variable("Y", domain=Domain.between(0, 1))}
PART = Domain.between(0, "9/10")
FOLLOWED = {
    "a quadric": law("F1*a + F2*b + F11*a**2 + F22*b**2 + 2*F12*a*b - 1", F),
    "strengths": law("a**2/x**2 + b**2/y**2 + 2*f*a*b/(x*y) - 1", {"x": POSITIVE, "y": POSITIVE, "f": Domain.between(-2, 2)}),
    "matrix failure": law("(a/x)**2*(1 - r) + (b/y)**2 + r*a/x - 1", {"x": POSITIVE, "y": POSITIVE, "r": ANY}),
    "adhesion": law("norm(a, b) - c*(1 - w/e)", {"c": POSITIVE, "w": AT_LEAST_0, "e": POSITIVE}),
    "wear": law("norm(a, b) - m*(1 + k*tanh(h) - h)", {"m": POSITIVE, "k": ANY, "h": AT_LEAST_0}),
    "exponent": law("(abs(a)/x)**n + (abs(b)/y)**n - 1", {"x": POSITIVE, "y": POSITIVE, "n": POSITIVE}),
    "clay": law("q**2 - m**2*p**(2 - k)*(c - p)**k", {"m": POSITIVE, "c": POSITIVE, "k": Domain.between("1/2", "3/2")}, "qp"),
    "angle": law("abs(q) - m*p*tan(f)*(1 - exp(-p/k))", {"m": POSITIVE, "f": Domain.between(0, 1), "k": POSITIVE}, "qp"),
    "creep": law("A*(cosh(a) - 1) - B*a**2", {"A": POSITIVE, "B": ANY}, "a", viscous=True),
    "flow": law("A*a**4 + B*a**2 + D*a", {"A": POSITIVE, "B": ANY, "D": ANY}, "a", viscous=True),
    "damage": law("abs(s)/(1 - d) - c", {x: POSITIVE for x in "ckh"} | {"n": Domain.between(1, 4), "u": ANY, "v": ANY, "d": PART}, "sY",
                  flow=("sign(s)/(1 - d)", "(Y/h)**n/(1 - d)"), energy="(1 - d)*k/2*(u - v)**2",
                  variables={"u": Variable("s", observable=True), "v": Variable("s"), "d": Variable("Y", domain=PART)}),
    "invariants": law("(c*I1(s)**6 + 8*J2(s)**3 + h*J3(s)**2)**(1/6) - y",
                      {"c": Domain.between(0, "1/20"), "h": Domain.between(-20, 15), "y": POSITIVE}, (), stress=Stress("s", "principal")),
    "joint": law("abs(t) - n*tan(b + d/(1 + n))", {"b": Domain.between("7/20", "3/5"), "d": Domain.between(0, "3/5")}, "nt",
                 domain={"n": AT_LEAST_0}),
    "three forces": law("a**2 + b**2 + c**2 + w*sin(a*b)*c - 1", {"w": Domain.between(0, "1/2")}, "abc"),
    "fitted": law("a**4 + b**4 + h*a**3*b + m*a*b + a - 1", {"h": Domain.between(-1, 1), "m": Domain.between("-1/4", "1/4")}),
    "soil": law("t**2 + c*s**n - m*s**2", {"c": POSITIVE, "m": POSITIVE, "n": Domain.between("5/2", 5)}, "st", domain={"s": AT_LEAST_0}),
}  # fmt: skip


@pytest.mark.parametrize("name", mostly_long(FOLLOWED, "a quadric", "adhesion", "creep", "damage"))
def test_what_is_suggested_is_true_when_it_is_followed(name: str) -> None:
    """Of every open claim: the law after the action has a K, or a potential, and the claim, and those named beside it, are as it says."""
    criterion, helped = FOLLOWED[name], 0
    for found in verify(criterion, effort="quick"):
        for action in () if found.unsettled is None else found.unsettled.actions:
            too = re.search(PROVED_TOO, action)
            after = verify(changed(criterion, action), claims=[found.claim, *(too[1].split(", ") if too else ())])
            for result in after:
                due = Verdict.REFUTED if "(then it is refuted)" in action else Verdict.PROVED
                assert result.verdict is due, (result.claim, action)
            assert not after.vacuous and admitted_values(after.criterion) is not None
            helped += 1
    assert helped


@pytest.mark.long
def test_a_quadric_is_told_the_minors_of_its_matrix() -> None:
    found = {result.claim: result.unsettled for result in verify(FOLLOWED["a quadric"]) if result.unsettled is not None}
    assert [actions.split(" (")[0] for actions in found["smoothness"].actions] == ['add the constraint "F12**2 <= F11*F22"']
    assert [actions.split(" (")[0] for actions in found["duality"].actions] == ['add the constraint "F12**2 < F11*F22"']
    assert found["duality"].part == "F11*F22 - F12**2" and "in the closed form" in (found["duality"].why or "")


@pytest.mark.slow
def test_ranges_of_the_forces_are_suggested_for_a_potential_without_a_slope_at_zero_force() -> None:
    """Of glassy polymers (Argon)."""
    argon = law("c*(exp(-k*(1 - abs(a)**(5/6))) - exp(-k))", {"c": POSITIVE, "k": POSITIVE}, "a", viscous=True)
    (action,) = opened(argon, "dissipation").actions
    assert action.startswith("ask for these forces alone: a = { min = ")
    assert verify(changed(argon, action), claims=["dissipation"])["dissipation"].verdict is Verdict.PROVED


def test_no_multiple_of_a_potential_is_suggested_which_is_another_law() -> None:
    """K is the same for a multiple > 0 of g."""
    for viscous in (False, True):
        read = StatedLaw.read(law_as_text(law("c*a**2/norm(a, b) - norm(a, b)", {"c": POSITIVE}, viscous=viscous)))
        told = [action for action, _ in with_values(read, {})]
        assert told and any("times g" in action for action in told) is not viscous


def of_rates(force: str, **parameters: Domain) -> Criterion:
    known = {"v": Domain(), **parameters}
    return Criterion("rates", sp.nan, known, ("s",), None, variables={"v": Variable("s")}, forces_of_rates={"s": force})


@pytest.mark.parametrize(
    ("criterion", "claim", "part"),
    [
        (of_rates("c*v_rate + k*tanh(v_rate) - m*v_rate/(1 + v_rate**2)", c=POSITIVE, k=POSITIVE, m=Domain.between(0, "1/10")),
         "dissipation", "-"),
        (of_rates("c*v_rate + k*tanh(v_rate) - m*v_rate/(1 + v_rate**2)", c=POSITIVE, k=POSITIVE, m=Domain.between(0, "1/10")),
         "normality", "-"),
        (of_rates("c*log(v_rate + (1 + v_rate**4)**(1/4))", c=POSITIVE), "normality", "log(v_rate + (1 + v_rate**4)**(1/4))"),
        (law("where(abs(a) > c, a**2 - 8/3*sqrt(c)*abs(a)**(3/2) + 2*c*abs(a) - c**2/3, 0)", {"c": POSITIVE}, "a", viscous=True),
         "origin", "where(abs(a) > c"),
        (law("where(abs(a) > c, a**2 - 8/3*sqrt(c)*abs(a)**(3/2) + 2*c*abs(a) - c**2/3, 0)", {"c": POSITIVE}, "a", viscous=True),
         "convexity", "where(abs(a) > c"),
    ],
)  # fmt: skip
def test_of_rates_and_potentials_nothing_is_said_of_k(criterion: Criterion, claim: str, part: str) -> None:
    found = opened(criterion, claim)
    told = " ".join(found.sentences())
    assert found.part is not None and part in found.part
    assert not re.search(r"\bK\b|\bg\b|flow|boundary|\bz\b", told), told


@pytest.mark.slow
@pytest.mark.parametrize(
    ("forces", "told", "helps"),
    [
        ({"a": "c*u_rate/V", "b": "c*v_rate/V"}, "where(V > 0, F, 0) for the formula F of a and of b", True),
        ({"a": "c*u_rate", "b": "c*v_rate/abs(v_rate)**(1/2)"}, "where(abs(v_rate) > 0, F, 0) for the formula F of b", True),
        ({"a": "c*u_rate/V - v_rate", "b": "c*v_rate/V + u_rate"}, "where(V > 0, F, 0) for the formula F of a and of b", False),
    ],
)
def test_forces_without_a_value_at_rest_are_told_with_one_where_that_helps(forces: dict[str, str], told: str, helps: bool) -> None:
    """The first variable belongs to the second force; the forces of the last law dissipate and have no potential."""
    short, variables = {"V": "norm(u_rate, v_rate)"}, {"v": Variable("b"), "u": Variable("a")}
    known = {"c": POSITIVE, "u": Domain(), "v": Domain()}
    given = Criterion("rest", sp.nan, known, ("a", "b"), None, variables=variables, forces_of_rates=forces, define=short)
    for claim in ("normality", "dissipation"):
        actions = opened(given, claim).actions
        assert [action.split(" (")[0] for action in actions] == (
            [f"write {told}, if you mean 0 there"] if helps or claim == "dissipation" else []
        )
        (size,) = re.findall(r"where\((.*) > 0, F", told)
        named = {
            name: f"where({size} > 0, {text}, 0)" if f"of {name}" in told.split("formula")[1] else text for name, text in forces.items()
        }
        followed = Criterion("rest", sp.nan, known, ("a", "b"), None, variables=variables, forces_of_rates=named, define=short)
        assert (verify(followed, claims=[claim])[claim].verdict is Verdict.PROVED) is bool(actions)


@pytest.mark.parametrize(
    ("energy", "part"),
    [
        ("k*u**2*d**2/2 - c*abs(d - 1/2)", "abs(d - 1/2)"),
        ("k*u**2*(1 - d)/2 + c*abs(u)*d", "abs(u)"),
        ("k*u**2/2 + c*d**2*log(d)", "log(d)"),
    ],
)
@pytest.mark.parametrize("claim", ["state_laws", "dissipation"])
def test_the_part_of_an_energy_without_a_derivative_is_named(energy: str, part: str, claim: str) -> None:
    domains = {"k": POSITIVE, "c": POSITIVE} | {name: own.domain for name, own in STATE.items()}
    given = law("Y - c", domains, "Y", variables=STATE, energy=energy)
    found = blocked(claim, StatedLaw.read(law_as_text(given)))
    assert found is not None and in_text(found.part, {}) == part and found.why.endswith("; the forces are derivatives of psi")


def test_each_claim_of_a_changed_law_is_asked_once_and_all_draw_on_one_purse(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, made = list[tuple[object, ...]](), list[trials.Attempts]()
    new = trials.Attempts.__init__

    def counted(claim: str, rule: str, settled: frozenset[str], read: StatedLaw, evidence: dict[str, object]) -> str:
        asked.append((claim, rule, repr(read)))
        return objection(claim, rule, settled, read, evidence)

    def kept(own: trials.Attempts, *rest: object) -> None:
        new(own, *rest)  # type: ignore[arg-type]
        made.append(own)

    monkeypatch.setattr(trials, "objection", counted)
    monkeypatch.setattr(trials.Attempts, "__init__", kept)
    found = verify(FOLLOWED["clay"], effort="quick")
    assert sum(result.unsettled is not None for result in found) == 4
    assert len(asked) == len({*asked}) and len(made) == 1
    assert 0 < made[0].steps < trials._IN_ALL


def test_no_more_is_tried_when_the_purse_is_empty() -> None:
    text = law_as_text(FOLLOWED["adhesion"])
    part = blocked("smoothness", StatedLaw.read(text))
    for steps, told in ((0, []), (trials._IN_ALL, ['add the constraint "w < e"'])):
        found = that_help("smoothness", text, frozenset({"convexity"}), part, list, tried=trials.Attempts(steps))
        assert [action.split(" (")[0] for action in found] == told


@pytest.mark.parametrize(("x", "said"), [(Fraction(11, 2), '"11/2"'), (Fraction(3), "3"), ("-3/200", '"-3/200"'), ("0.25", "0.25")])
def test_a_number_is_told_as_a_criterion_file_has_it(x: Any, said: str) -> None:
    assert trials._in_a_file(x) == said
    assert Domain.between(tomllib.loads(f"min = {said}")["min"], None).low == sp.Rational(str(x))


def test_values_that_refute_one_claim_are_tried_for_the_next() -> None:
    tried, law = Attempts(), law_as_text(Criterion("law", "a**2 + c*b**2 - 1", {"c": Domain()}, forces=("a", "b"), pressure=None))
    fails, asked = {"c": Fraction(-3)}, list[str]()

    def decide(claim: str, changed: Mapping[str, Any], _: Budget) -> Verdict | None:
        asked.append(claim)
        return Verdict.REFUTED if changed["parameters"]["c"] == {"value": "-3"} else None

    for claim, first in (("convexity", [fails]), ("normality", [])):
        told = that_help(claim, law, frozenset(), None, lambda _: [fails], decide=decide, first=first, tried=tried)
        assert told == ["--set c=-3 (then it is refuted)"]


@pytest.mark.parametrize("g", ["norm(a, b) + h*a*b - t", "sqrt(a**2 + b**2) + h*b**4/(1 + a**2) - t"])
def test_a_tip_inside_k_is_not_blamed(g: str) -> None:
    """Where norm(a, b) = 0 it is -t < 0: what is open is whether the gradient may be 0."""
    told = blocked("smoothness", StatedLaw.read(law_as_text(law(g, {"h": Domain.between(-1, 1), "t": POSITIVE}))))
    assert told is not None and told.why == "is C^1, but no rule shows that its gradient is not 0 where g = 0"
