"""Verdicts on laws of several surfaces with slips of their own (Koiter), and on curves from files: true ones, and false neighbours."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import pytest
import sympy as sp

from duhem import load, verify
from duhem.expression.branches import smooth_below
from duhem.expression.parse import parse_expression
from duhem.law.criterion_file import reads
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import digest, recheck, stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.pieces import below
from duhem.proof.kernel.term import NotWritten, parse
from duhem.proof.verification import Verification
from tests.campaigns.polygons import drawn, said
from tests.oracles import drawn_formulas, reevaluation

HEAD = '[criterion]\nname = "x"\nforces = ["s", "t"]\npressure = false\n'


def law(*surfaces: tuple[str, str], parameters: str = "") -> str:
    """A file: each surface with its flow or potential, as it stands there."""
    return (
        HEAD
        + (f"[parameters]\n{parameters}\n" if parameters else "")
        + "".join(f'[[surface]]\ng = "{g}"\n{slip}\n' for g, slip in surfaces)
    )


def interface(dilatancy: str) -> str:
    """Tension cut-off, Coulomb friction 1/2 both ways, compression cap (after Lourenço and Rots 1997): the friction slips by dilatancy."""
    shear = [("t + s/2 - 1", f'flow = ["{dilatancy}", "1"]'), ("-t + s/2 - 1", f'flow = ["{dilatancy}", "-1"]')]
    return law(("s - 1", ""), *shear, ("4*s**2 + t**2 - 100", ""))


def found(text: str, *claims: str) -> dict[str, str]:
    """Verdicts, and how far to be trusted."""
    return {r.claim: r.verdict.value + (f" {r.trust.value}" if r.trust else "") for r in verified(text, *claims).results}


def verified(text: str, *claims: str) -> Verification:
    return verify(reads(text), claims=claims)


KOITER = ("origin", "convexity", "normality", "dissipation")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dilatancy", "normality", "dissipation"),
    [
        ("1/4", "refuted", "proved checked"),
        ("1/2", "proved checked", "proved checked"),  # the flow is grad g, written out
        pytest.param("501/1000", "refuted", "proved checked", marks=pytest.mark.long),
        ("2", "refuted", "refuted"),  # force . flow = 1 + 3 s/2, and K reaches down to s = -4
        ("-1/10", "refuted", "proved checked"),  # 1 - 3 s/5 >= 0 because of the tension cut-off s <= 1 alone
    ],
)
def test_an_interface_of_four_surfaces(dilatancy: str, normality: str, dissipation: str) -> None:
    verdicts = found(interface(dilatancy), *KOITER)
    assert verdicts == {"origin": "proved checked", "convexity": "proved checked", "normality": normality, "dissipation": dissipation}


@pytest.mark.slow
def test_what_holds_because_of_another_surface_fails_without_it() -> None:
    shear = ("t + s/2 - 1", 'flow = ["-1/10", "1"]'), ("-t + s/2 - 1", 'flow = ["-1/10", "-1"]')
    assert found(law(*shear), "dissipation") == {"dissipation": "refuted"}
    across = ("s - 1", 'flow = ["2", "-t"]')  # force . flow = 2 - t**2 on s = 1
    assert found(law(across, ("abs(t) - 1", ""), ("-s - 1", "")), "dissipation") == {"dissipation": "proved checked"}
    assert found(law(across, ("abs(t) - 2", ""), ("-s - 1", "")), "dissipation") == {"dissipation": "refuted"}


def test_a_witness_is_on_the_surface_whose_flow_is_wrong() -> None:
    witness = verified(interface("2"), "dissipation")["dissipation"].witness
    assert witness is not None
    over = []
    for role in ("inside", "outside"):
        s, t = (sp.Rational(witness.points[role][name]) for name in "st")
        over.append(abs(t) + s / 2 - 1)
        assert 2 * s + abs(t) < 0
    assert -sp.Rational(1, 2) < over[0] <= 0 < over[1] < sp.Rational(1, 2)


def test_a_second_opinion_on_the_slip_of_one_surface() -> None:
    law = load("lourenco-rots")
    witness = verify(law, claims=["normality"])["normality"].witness
    assert witness is not None and reevaluation.confirmed(law, "normality", witness)
    inside, tau = witness.points["inside"], witness.points["tau"]
    behind = {name: str(2 * Fraction(inside[name]) - Fraction(x)) for name, x in tau.items()}
    for other in (behind, dict(inside)):
        assert not reevaluation.confirmed(law, "normality", replace(witness, points={**witness.points, "tau": other}))
    associated = replace(law, surfaces=tuple(replace(s, flow=None, potential=None, written_flow=()) for s in law.surfaces))
    assert not reevaluation.confirmed(associated, "normality", witness)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("flow", "normality", "dissipation"),
    [
        pytest.param('potential = "abs(t) + s/2"', "proved", "proved", marks=pytest.mark.long),
        ('potential = "abs(t) + s/4"', "refuted", "proved"),
        pytest.param('potential = "-abs(t) - s/2"', "refuted", "refuted", marks=pytest.mark.long),
        ('flow = ["1/2", "where(t > 0, 1, -1)"]', "proved", "proved"),
        pytest.param('flow = ["1/2", "where(t > 0, 1, 1)"]', "refuted", "refuted", marks=pytest.mark.long),
        ("", "proved", "proved"),
    ],
)
def test_a_surface_with_a_kink(flow: str, normality: str, dissipation: str) -> None:
    text = law(("abs(t) + s/2 - 1", flow), ("s - 1", ""), ("4*s**2 + t**2 - 100", ""))
    assert {c: v.partition(" ")[0] for c, v in found(text, "normality", "dissipation").items()} == {
        "normality": normality,
        "dissipation": dissipation,
    }


def test_surfaces_without_flows_are_one_law() -> None:
    two = law(("4*s**2 + t**2 - 4", ""), ("s - 1", 'flow = ["1", "0"]'))
    for text in (two.replace('flow = ["1", "0"]', ""), two):
        assert found(text, *KOITER) == dict.fromkeys(KOITER, "proved checked")
    dented = law(("min(s**2 + t**2 - 4, (s - 3)**2 + t**2 - 4)", ""), ("t - 1", ""))
    assert found(dented, "convexity", "normality") == {"convexity": "refuted", "normality": "refuted"}


@pytest.mark.slow
def test_one_surface_with_a_flow_is_a_law_with_a_flow() -> None:
    for slip, verdict in (("s", "proved"), ("2*s", "refuted")):
        one = law(("s**2 + t**2 - 1", f'flow = ["{slip}", "t"]'))
        plain = HEAD + f'g = "s**2 + t**2 - 1"\n[flow]\ndirection = ["{slip}", "t"]\n'
        assert found(one, *KOITER) == found(plain, *KOITER) and found(one, *KOITER)["normality"].startswith(verdict)


@pytest.mark.slow
def test_a_flow_needs_a_value_on_its_own_surface_alone() -> None:
    cone = ("norm(s, t) - 1 - s/4", 'flow = ["s/norm(s - 2, t)", "t/norm(s - 2, t)"]')  # undefined at (2, 0), which s <= 1 leaves out
    assert found(law(cone, ("s - 1", "")), "dissipation")["dissipation"].startswith("proved")
    at_boundary = ("s**2 + t**2 - 4", 'flow = ["s/norm(s - 2, t)", "t/norm(s - 2, t)"]')
    assert not found(law(at_boundary, ("t - 1", "")), "dissipation")["dissipation"].startswith("proved")


@pytest.mark.long
def test_polygons_of_surfaces() -> None:
    for polygon in drawn(3, 5):
        truth = polygon.truth()
        for claim, verdict in said(polygon).items():
            assert verdict.startswith(("proved checked" if truth[claim] else "refuted", "tested"))


def test_a_line_through_zero_force_bounds_k_too() -> None:
    half = law(("s", 'flow = ["1", "1"]'), ("s**2 + t**2 - 4", ""))
    assert found(half, "normality", "dissipation") == {"normality": "refuted", "dissipation": "refuted"}


# -- the kernel --------------------------------------------------------------------------------------------------------


def changed(document: dict[str, Any], change: Any) -> dict[str, Any]:
    other = deepcopy(document)
    change(other["law"]["surfaces"])
    return other | {"sha256": digest({k: v for k, v in other.items() if k != "sha256"})}


def confirmed(document: Mapping[str, Any]) -> dict[str, bool]:
    return {row.claim: row.confirmed for row in recheck(document)}


def test_the_kernel_rebuilds_the_question_from_the_surfaces() -> None:
    document = verified(interface("1/2"), *KOITER).certificate()
    assert confirmed(document) == dict.fromkeys(KOITER, True)

    def less_dilatant(surfaces: list[dict[str, Any]]) -> None:
        surfaces[1]["flow"][0] = "1/3"

    def reversed_flow(surfaces: list[dict[str, Any]]) -> None:
        surfaces[2]["flow"] = ["-1/2", "1"]

    def steeper(surfaces: list[dict[str, Any]]) -> None:
        surfaces[1]["g"] = "t + s - 1"

    for change in (less_dilatant, reversed_flow, steeper):
        assert not confirmed(changed(document, change))["normality"]


def test_the_kernel_needs_the_surface_that_a_proof_speaks_of() -> None:
    document = verified(interface("-1/10"), "dissipation").certificate()
    assert confirmed(document)["dissipation"]
    for change in (lambda s: s.pop(0), lambda s: s[0].update(g="s - 2"), lambda s: s[1].update(flow=["-3/4", "1"])):
        assert not confirmed(changed(document, change))["dissipation"]


def test_no_rule_takes_a_law_with_flows_on_its_surfaces_for_associated() -> None:
    text = law(("s**2 + t**2 - 1", 'flow = ["t", "-s"]'), ("s - 2", ""))
    given = stated(law_as_text(reads(text)))
    settled = frozenset({"origin", "convexity"})
    for claim, rule in (
        ("normality", "normality-rule"),
        ("normality", "parallel"),
        ("dissipation", "boundary-power"),
    ):
        empty: dict[str, Any] = {"outward": [], "along": [], "across": []}
        refused = objection(claim, rule, settled, given, empty)
        assert refused or (claim, rule) == ("dissipation", "boundary-power")  # turning about 0 dissipates nothing, and so >= 0
    assert objection("normality", "normality-rule", settled, stated(law_as_text(reads(text.replace('flow = ["t", "-s"]', "")))), {}) == ""


@pytest.mark.parametrize(
    "surfaces",
    [
        [],
        [{"g": "s - 1", "flow": ["1"]}],
        [{"g": "s - 1", "flow": "st"}],
        [{"g": "s - 1", "flow": ["1", "q"]}],
        [{"g": "2 - 1", "flow": None}],
        [{"g": "s < 1", "flow": None}],
        [{"g": "s - 1"}],
    ],
)
def test_the_kernel_reads_no_other_surfaces(surfaces: list[dict[str, Any]]) -> None:
    given = law_as_text(reads(interface("1/2"))) | {"surfaces": surfaces}
    with pytest.raises((NotWritten, KeyError)):
        stated(given)
    with pytest.raises(NotWritten):
        stated(law_as_text(reads(interface("1/2"))) | {"g": "s", "flow": None})


SUMS = [
    "abs(a) - 1",
    "2*abs(a) + pos(b) - 1",
    "max(a, abs(b), a - b) - 1",
    "neg(a - b) + abs(a + b) - 2",
    "max(abs(a) - 1, b - abs(a))",
    "abs(abs(a) - b) - 1",
]


@pytest.mark.parametrize("text", SUMS)
def test_what_is_below_is_nowhere_more(text: str) -> None:
    a, b = sp.symbols("a b", real=True)
    smooth = smooth_below(parse_expression(text, {"a": a, "b": b}))
    term, smaller = parse(text), list(below(parse(text)))
    rng = Random(1)
    for _ in range(50):
        at = {"a": rng.uniform(-3, 3), "b": rng.uniform(-3, 3)}
        value = drawn_formulas.value(term, at)
        assert all(drawn_formulas.value(s, at) <= value + 1e-12 for s in smaller)
        assert all(float(s.subs({a: at["a"], b: at["b"]})) <= value + 1e-12 for s in smooth)


# -- curves ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("e", "convexity"), [("0.4", "proved checked"), ("0.6", "refuted")])
def test_a_limacon_from_a_file(e: str, convexity: str) -> None:
    curve = f"""
[criterion]
name = "x"
[define]
rho = "1 + e*cos(phi)"
[parameters]
e = {{ value = {e} }}
[boundary]
T = ["rho*cos(phi)", "rho*sin(phi)"]
"""
    verification = verify(reads(curve), claims=("origin", "convexity", "normality", "dissipation"))
    assert {r.claim: r.verdict.value for r in verification.results}["origin"] == "proved"
    assert found(curve, "convexity") == {"convexity": convexity}
    rows = confirmed(verification.certificate())
    assert rows["origin"] and rows["convexity"] == (convexity == "proved checked") and rows["dissipation"]


@pytest.mark.slow
def test_the_kernel_proves_nothing_where_g_jumps() -> None:
    jumps = law(("where(s > -1/2, 1, s - 1)", ""), ("t - 1", 'flow = ["0", "1"]'), ("-t - 1", ""))  # K ends at s = -1/2, where no g is 0
    for text in (jumps, HEAD + 'g = "where(s > -1/2, 1, s - 1)"\n'):
        given = stated(law_as_text(reads(text)))
        assert objection("dissipation", "boundary-power", frozenset(), given, {"outward": []})
        assert not found(text, "dissipation")["dissipation"].startswith("proved")
