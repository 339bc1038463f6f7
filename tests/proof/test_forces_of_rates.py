"""Forces as functions of the rates, such as Stribeck's friction: what is proved, what is refuted by rates, and what is refused."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction
from pathlib import Path
from typing import Any

import flint
import numpy as np
import pytest
from click.testing import CliRunner

import duhem
from duhem import Criterion, Domain, InputError
from duhem.cli import cli
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel import rates
from duhem.proof.kernel import stated_law as kernel_law
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.claims import RULES, objection
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, minus
from duhem.testing import conformance

POSITIVE, NO_LESS = duhem.POSITIVE, Domain.between(0, None)
SMOOTH = "u_in_rate/sqrt(u_in_rate**2 + eps**2)"
FRICTION = f"(F_C + (F_S - F_C)*exp(-(u_in_rate/v_S)**2))*{SMOOTH}"
NUMBERS = dict.fromkeys(("F_C", "F_S", "v_S", "eps"), POSITIVE)


def law(*functions: str, pressure: str | None = None, **parameters: Any) -> Criterion:
    """In sigma, or in a and b, the rates of whose variables are u_in_rate and v_in_rate."""
    forces = ("sigma",) if len(functions) == 1 else ("a", "b")
    variables = {name: Variable(force) for name, force in zip(("u_in", "v_in"), forces, strict=False)}
    given: Any = dict(zip(forces, functions, strict=True))
    return Criterion("made", parameters=parameters, forces=forces, pressure=pressure, variables=variables, forces_of_rates=given)


def force(at: Any, rate: Fraction) -> Any:
    """Stribeck's force in a ball, computed by nothing of duhem's."""
    ball = {name: flint.arb(Fraction(x).numerator) / Fraction(x).denominator for name, x in at.items()}
    v = flint.arb(rate.numerator) / rate.denominator
    falls = (-((v / ball["v_S"]) ** 2)).exp()
    return (ball["F_C"] + (ball["F_S"] - ball["F_C"]) * falls) * v / (v**2 + ball["eps"] ** 2).sqrt() + ball["F_v"] * v


@pytest.mark.slow
def test_stribeck_dissipates_and_derives_from_no_convex_potential() -> None:
    found = duhem.verify("stribeck")
    said = {result.claim: str(result.verdict) for result in found}
    assert said["dissipation"] == "proved" and str(found["dissipation"].trust) == "checked" and said["normality"] == "refuted"
    assert {said[claim] for claim in ("origin", "convexity", "smoothness", "duality", "state_laws")} == {"not_applicable"}
    assert all("no K" in found[claim].detail for claim in ("origin", "convexity", "smoothness", "duality"))
    assert found.dissipative is True and found.generalized_standard is False
    witness = found["normality"].witness
    assert witness is not None
    one, other = (Fraction(witness.points["state"][name]) for name in ("u_in_rate", "u_in_rate of the other"))
    at = witness.parameters
    assert Fraction(at["F_S"]) >= Fraction(at["F_C"]) > 0 and Fraction(at["F_v"]) >= 0
    gain = (force(at, one) - force(at, other)) * (flint.arb((one - other).numerator) / (one - other).denominator)
    assert gain < 0
    assert float(next(iter(witness.values.values()))[0]) == pytest.approx(float(gain.mid()), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "parameters"),
    [
        (f"{FRICTION} + F_v*u_in_rate", {"F_v": Domain.between(-1, 0)}),  # negative damping
        (f"-F_C*{SMOOTH}", {}),
        (f"F_C*{SMOOTH} - F_S*u_in_rate", {}),
        (f"F_C*{SMOOTH} - F_S*exp(-u_in_rate**2)", {}),  # a constant part
    ],
)
def test_a_force_that_drives_is_refuted_by_rates(wrong: str, parameters: Any) -> None:
    found = duhem.verify(law(wrong, **NUMBERS, **parameters), claims=["dissipation"])
    assert str(found["dissipation"].verdict) == "refuted" and found.dissipative is False
    assert found["dissipation"].witness is not None and "u_in_rate" in found["dissipation"].witness.points["state"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("functions", "parameters", "normality", "dissipation"),
    [
        (("F_C*u_in_rate",), {"F_C": NO_LESS}, "proved", "proved"),
        (("F_C*u_in_rate**3 + F_S*u_in_rate",), {"F_C": NO_LESS, "F_S": NO_LESS}, "proved", "proved"),
        (("F_C*u_in_rate", "F_S*v_in_rate**3"), {"F_C": NO_LESS, "F_S": NO_LESS}, "proved", "proved"),
        (("u_in_rate + h*v_in_rate", "v_in_rate - h*u_in_rate"), {"h": POSITIVE}, "undecided", "proved"),  # monotone, and no gradient
        (("u_in_rate + h*v_in_rate", "v_in_rate + h*u_in_rate"), {"h": POSITIVE}, "refuted", "refuted"),
        (("F_C/u_in_rate",), {"F_C": POSITIVE}, "refuted", "undecided"),  # no force at rest
        (("F_C*sqrt(u_in_rate)",), {"F_C": POSITIVE}, "undecided", "undecided"),
    ],
)
def test_what_is_proved_holds_at_all_rates(functions: Any, parameters: Any, normality: str, dissipation: str) -> None:
    made = law(*functions, **parameters)
    found = duhem.verify(made, claims=["normality", "dissipation"])
    assert (str(found["normality"].verdict), str(found["dissipation"].verdict)) == (normality, dissipation)
    checked = duhem.recheck(found.certificate())
    proofs = [claim for claim, verdict in (("normality", normality), ("dissipation", dissipation)) if verdict == "proved"]
    assert checked.ok and [row.claim for row in checked.claims if row.outcome == "confirmed"] == proofs


def test_friction_in_the_plane_under_a_pressure_dissipates_and_has_a_potential() -> None:
    size = "sqrt(u_in_rate**2 + v_in_rate**2 + eps**2)"
    plane = law(*(f"mu*abs(sigma_n)*{x}_rate/{size}" for x in ("u_in", "v_in")), pressure="sigma_n", mu=POSITIVE, eps=POSITIVE)
    stated = StatedLaw.read(law_as_text(plane))
    assert objection("dissipation", "resistance", frozenset(), stated, {}) == ""
    assert objection("normality", "monotone-resistance", frozenset(), stated, {}) == ""


SIZE, OTHER = "norm(u_in_rate, v_in_rate)", "norm(u_in_rate, 2*v_in_rate)"
STEADY = "sqrt(u_in_rate**2 + v_in_rate**2 + v_S**2)"


def of_size(share: str, size: str = SIZE, weight: str = "1", tip: bool = True) -> tuple[str, str]:
    """Forces c_i x_i G(w), with 0 where w is 0 if G has no value there."""
    first, second = f"({share})*u_in_rate", f"{weight}*({share})*v_in_rate"
    return (f"where({size} > 0, {first}, 0)", f"where({size} > 0, {second}, 0)") if tip else (first, second)


@pytest.mark.parametrize(
    ("functions", "normal", "dissipates"),
    [
        (of_size(f"F_C/{SIZE}"), True, True),  # dry friction
        (of_size(f"F_C/{SIZE} + F_S*{SIZE}**(n - 1)"), True, True),  # Herschel-Bulkley
        (of_size(f"(sqrt(F_C) + sqrt(F_S*{SIZE}))**2/{SIZE}"), True, True),  # Casson
        (of_size(f"(F_C + (F_S - F_C)/(1 + v_S/{SIZE}))/{SIZE}"), True, True),  # mu(I), F_S >= F_C
        (of_size(f"F_C*({STEADY})**(n - 2)", tip=False), True, True),  # Glen's law, n >= 1
        (of_size(f"F_C/({OTHER})", OTHER, "4"), True, True),  # a norm with weights
        (of_size(f"F_C*{SIZE}**(-2)"), False, True),  # w G(w) falls
        (of_size(f"F_C/{SIZE} - F_S"), False, False),
        (of_size(f"-F_C/{SIZE}"), False, False),  # < 0, and does not fall
        (of_size(f"(F_S + (F_C - F_S)/(1 + v_S/{SIZE}))/{SIZE}"), False, True),
        (of_size(f"F_C/{SIZE}", weight="2"), False, True),  # no gradient
        (of_size(f"F_C/({OTHER})", OTHER), False, True),
        (of_size(f"F_C*({STEADY})**(-n)", tip=False), False, True),
        (of_size(f"F_C/{SIZE}")[::-1], False, False),  # each is of the other rate
        (of_size(f"where({SIZE} > 1, 1, 2)/{SIZE}"), False, True),  # a jump down
        (tuple(x.replace(", 0)", ", F_C)") for x in of_size(f"F_C/{SIZE}")), False, True),  # F_C at rest in each direction is too much
        (of_size("F_C*u_in_rate**2", tip=False), False, True),
    ],
)
def test_forces_of_the_size_of_the_rates_have_a_convex_potential_if_they_do_not_fall(
    functions: Any, normal: bool, dissipates: bool
) -> None:
    """What is shown is looked at between random rates, which are told nothing of sizes."""
    given: Any = {"F_C": Domain.between(1, 2), "F_S": Domain.between(2, 3), "v_S": POSITIVE, "n": Domain.between(1, 2)}
    made = law(*functions, **{x: own for x, own in given.items() if any(x in f for f in functions)})
    stated = StatedLaw.read(law_as_text(made))
    told = [
        not objection(claim, rule, frozenset(), stated, {})
        for claim, rule in (("normality", "monotone-resistance"), ("dissipation", "resistance"))
    ]
    assert told == [normal, dissipates]
    rng = np.random.default_rng(3)
    x = rng.standard_normal((4, 3000)) * rng.choice([0.0, 1e-3, 1.0, 30.0], (4, 3000))
    at = {"norm": lambda *a: np.sqrt(sum(np.square(a))), "sqrt": np.sqrt, "where": np.where, "F_C": 1.3, "F_S": 2.4, "v_S": 0.7, "n": 1.6}
    with np.errstate(all="ignore"):
        one, other = (np.array([eval(f, {**at, "u_in_rate": u, "v_in_rate": v}) for f in functions]) for u, v in (x[:2], x[2:]))
    gain, spent = ((one - other) * (x[:2] - x[2:])).sum(axis=0), (one * x[:2]).sum(axis=0)
    assert not normal or bool(np.all(gain >= -1e-9))
    assert bool(np.all(spent >= 0)) is dissipates


@pytest.mark.parametrize(
    ("function", "normal"),
    [
        ("F_C*sign(u_in_rate) + u_in_rate", True),
        ("where(u_in_rate > 0, F_C*log(1 + u_in_rate), F_S*u_in_rate)", True),
        ("-F_C*sign(u_in_rate) + u_in_rate", False),
        ("where(u_in_rate > 0, F_C + u_in_rate, F_S + 2*u_in_rate)", False),  # F_S at rest, and F_C beside it may be less
        ("F_C*sign(u_in_rate)*exp(-abs(u_in_rate))", False),
        ("where(u_in_rate > 0, 1, where(u_in_rate < 0, -1, 3))", False),
    ],
)
def test_a_force_that_jumps_at_rest_does_not_fall_if_it_has_the_sign_of_the_rate(function: str, normal: bool) -> None:
    made = law(function, F_C=POSITIVE, F_S=POSITIVE)
    assert (not objection("normality", "monotone-resistance", frozenset(), StatedLaw.read(law_as_text(made)), {})) is normal
    rates = np.linspace(-3, 3, 601)
    names = {"sign": np.sign, "abs": np.abs, "where": np.where, "log": lambda x: np.log(np.abs(x) + 1e-300), "exp": np.exp}
    assert bool(np.all(np.diff(eval(function, {**names, "u_in_rate": rates, "F_C": 0.7, "F_S": 1.2})) >= 0)) is normal


@pytest.mark.parametrize(
    ("function", "dissipates"),
    [
        ("F_C*sign(u_in_rate)", True),
        ("F_C*sign(u_in_rate)*(abs(u_in_rate)/(v_S + abs(u_in_rate)**3))**(1/3)", True),  # Gagliardini et al. (2007)
        ("sign(u_in_rate)*F_C + u_in_rate*F_S", True),
        ("-F_C*sign(u_in_rate)", False),
        ("h*sign(u_in_rate)", False),
        ("F_C*sign(u_in_rate - v_S)", False),
        ("F_C*sign(u_in_rate)**2", False),
        ("F_C*sign(u_in_rate)*(v_S - abs(u_in_rate))", False),
    ],
)
def test_a_rate_times_its_sign_is_its_size(function: str, dissipates: bool) -> None:
    made = law(function, F_C=POSITIVE, F_S=POSITIVE, v_S=POSITIVE, h=Domain.between(-1, 1))
    assert (not objection("dissipation", "resistance", frozenset(), StatedLaw.read(law_as_text(made)), {})) is dissipates
    rates = np.linspace(-3, 3, 601)
    names = {"sign": np.sign, "abs": np.abs, "u_in_rate": rates, "F_C": 0.7, "F_S": 0.2, "v_S": 1.1, "h": -0.5}
    assert bool(np.all(rates * eval(function, names) >= 0)) is dissipates


# -- certificates --------------------------------------------------------------------------------------------------------


def rechecked(document: Any, change: Any) -> Any:
    changed = copy.deepcopy(document)
    change(changed)
    changed["sha256"] = digest(changed)
    return duhem.recheck(changed)


@pytest.mark.slow
def test_a_certificate_of_another_law_is_not_confirmed() -> None:
    document = duhem.verify("stribeck", claims="dissipation").certificate()
    assert duhem.recheck(document).ok

    def of(key: str, value: Any) -> Any:
        return lambda changed: changed["law"].__setitem__(key, value)

    text = document["law"]["forces_of_rates"]["sigma"]
    for wrong in (f"-({text})", text.replace("+ F_v", "- F_v"), f"{text} - 1", text.replace("exp(-", "log(")):
        assert rechecked(document, of("forces_of_rates", {"sigma": wrong})).failed == ("dissipation",)
    assert rechecked(document, of("parameters", document["law"]["parameters"] | {"F_v": {"min": "-1", "max": None}})).failed
    assert rechecked(document, of("constraints", [])).ok  # F_C (1 - exp(-x^2)) + F_S exp(-x^2) is > 0 without them
    for wrong in ({}, {"sigma": text, "tau": "0"}, {"tau": text}, {"sigma": "sigma"}, {"sigma": "u_in"}, {"sigma": "x"}, [text]):
        if wrong == {"sigma": "u_in"}:
            assert rechecked(document, of("forces_of_rates", wrong)).failed
            continue
        with pytest.raises(InputError, match="cannot be checked"):
            rechecked(document, of("forces_of_rates", wrong))
    for key, value in (("energy", "u_in**2"), ("g", "sigma"), ("flow", ["sigma"]), ("viscous", True), ("variables", {})):
        with pytest.raises(InputError, match="cannot be checked"):
            rechecked(document, of(key, value))


def test_no_other_rule_speaks_of_such_a_law_and_its_rules_of_no_other() -> None:
    stated = StatedLaw.read(law_as_text(law("F_C*u_in_rate", F_C=NO_LESS)))
    everything = frozenset(claim for claim, _ in RULES)
    for claim, rule in RULES:
        own = rule in ("resistance", "monotone-resistance")
        if claim not in ("state_laws", "thermal"):
            assert (objection(claim, rule, everything, stated, {}) == "") == own
    coulomb = StatedLaw.read(law_as_text(duhem.load("coulomb")))
    for claim, rule in (("dissipation", "resistance"), ("normality", "monotone-resistance")):
        assert "no force is a function" in objection(claim, rule, everything, coulomb, {})


@pytest.mark.parametrize(
    ("function", "normal"),
    [
        ("abs(u_in_rate)*u_in_rate*R", True),
        ("R*max(u_in_rate, 0)", True),  # which has a kink at rest alone
        ("R*max(u_in_rate, 1)", False),
        ("R*(u_in_rate + v_in_rate)", False),
        ("R*u_in_rate/(1 + v_in_rate**2)", False),
    ],
)
def test_a_force_that_is_monotone_only_in_part_is_no_gradient_by_this_rule(function: str, normal: bool) -> None:
    """The third has a kink elsewhere, and the last two depend on the other rate."""
    stated = StatedLaw.read(law_as_text(law(function, "R*v_in_rate", R=POSITIVE)))
    assert (objection("normality", "monotone-resistance", frozenset(), stated, {}) == "") is normal


def shown(claim: str, *functions: str) -> bool:
    rule = {"dissipation": "resistance", "normality": "monotone-resistance"}[claim]
    stated = StatedLaw.read(law_as_text(law(*functions, R=POSITIVE)))
    return objection(claim, rule, frozenset(), stated, {}) == ""


@pytest.mark.parametrize(
    ("claim", "functions", "part"),
    [
        ("normality", ("R*(u_in_rate + v_in_rate)", "R*v_in_rate"), "names"),
        ("dissipation", ("R/u_in_rate",), "value"),
        ("dissipation", ("R",), "power"),
        ("normality", ("-R*u_in_rate",), "slope"),
    ],
)
def test_each_part_of_a_rule_is_needed(claim: str, functions: Any, part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it, the rule would prove this wrong law."""
    assert not shown(claim, *functions)
    if part == "names":
        monkeypatch.setattr(Term, "names", lambda _: frozenset())
        stated = StatedLaw.read(law_as_text(law(*functions, R=POSITIVE)))
        assert rates.forces_increase(stated)
        return
    if part == "value":
        key = ("dissipation", "resistance")
        monkeypatch.setitem(RULES, key, RULES[key]._replace(reads=lambda _: ""))  # type: ignore[index]
    if part == "power":
        monkeypatch.setattr(kernel_law, "product_of", lambda *terms: terms[-1])
    if part == "slope":
        monkeypatch.setattr(rates, "gradient", lambda force, names: tuple(minus(x) for x in gradient(force, names)))
    assert shown(claim, *functions)


def test_names_of_rates_clash_with_no_others() -> None:
    text = law_as_text(law("F_C*u_in_rate", F_C=NO_LESS))
    with pytest.raises(NotWritten, match="twice"):
        StatedLaw.read(text | {"parameters": text["parameters"] | {"u_in_rate": {"min": "0", "max": None}}})
    with pytest.raises(InputError, match="'u_in_rate' is declared twice"):
        law("F_C*u_in_rate", F_C=NO_LESS, u_in_rate=POSITIVE)


# -- the law as a value and as a file --------------------------------------------------------------------------------------

FILE = """\
[criterion]
name = "made"
forces = ["sigma"]
pressure = false

[parameters]
F_C = { min = 0 }

[variables]
u_in = { force = "sigma" }

[dissipation]
forces_of_rates = { sigma = "F_C*u_in_rate" }
"""


def test_a_file_is_the_value_and_is_written_again() -> None:
    read = reads(FILE)
    assert read == law("F_C*u_in_rate", F_C=NO_LESS) and reads(criterion_text(read)) == read == pickle.loads(pickle.dumps(read))
    fixed = read.fix({"F_C": 2})
    assert str(duhem.verify(fixed, claims="dissipation")["dissipation"].verdict) == "proved" and fixed.whole == read
    assert r"\sigma = F_{C}" in read._repr_html_() and "<=" not in read._repr_html_()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"F_C*u_in_rate" }', '"F_C*w_rate" }', "w_rate"),
        ('"F_C*u_in_rate" }', '"F_C*sigma" }', "a force depends on it"),
        ("{ sigma = ", "{ tau = ", "sigma is no function of the rate"),
        ('{ sigma = "F_C*u_in_rate" }', '{ sigma = "F_C*u_in_rate", tau = "1" }', "tau is no force"),
        ('u_in = { force = "sigma" }', "u_in = {}", "u_in_rate"),
        ("pressure = false", 'pressure = false\ng = "sigma - 1"', "are both given"),
        ("[dissipation]\n", '[dissipation]\npotential = "sigma**2"\n', "too"),
        ("[dissipation]\n", '[dissipation]\nrates = { u_in = "sigma" }\n', "the law has rates too"),
        ("[dissipation]\n", '[energy]\npsi = "u_in**2"\n\n[dissipation]\n', "the law has energy too"),
        ("[dissipation]\n", "[domain]\nsigma = { min = -1, max = 1 }\n\n[dissipation]\n", "the law has domain too"),
        ('{ sigma = "F_C*u_in_rate" }', "3", "forces_of_rates is not a table"),
    ],
)
def test_what_does_not_fit_is_named(old: str, new: str, said: str) -> None:
    assert old in FILE
    with pytest.raises(InputError, match=said):
        reads(FILE.replace(old, new))


@pytest.mark.slow
def test_everything_else_refuses_such_a_law(tmp_path: Path) -> None:
    (tmp_path / "law.toml").write_text(FILE)
    read: Any = reads(FILE)
    for ask in (
        lambda: duhem.project(read, [1.0]),
        lambda: duhem.prepare(read, 1.0, {"F_C": 1}),
        lambda: duhem.simulate(read, duhem.Path.linear([0.0, 1.0])),
        lambda: duhem.derive(read),
        lambda: duhem.plot(read, tmp_path / "p.png"),
        lambda: duhem.contact(read, [1.0, 1.0], parameters={"F_C": 1}),
        lambda: conformance(read, lambda *_: None),
    ):
        with pytest.raises(InputError, match="gives forces as functions of the rates, so it has no K"):
            ask()
    for words in (["derive"], ["plot"], ["export", "--to", "c"], ["bench"], ["stress"], ["project", "--trial", "1"]):
        answer = CliRunner().invoke(cli, [words[0], str(tmp_path / "law.toml"), *words[1:]])
        assert isinstance(answer.exception, InputError) and "no K" in str(answer.exception), words
