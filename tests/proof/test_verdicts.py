"""Every built-in law gets the literature's verdict, with witnesses that hold in another arithmetic, by methods that agree."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from duhem import Criterion, Verdict, Verification, load, verify
from duhem.errors import InputError
from duhem.law.builtin.lobes import lobe_law
from duhem.proof.claims import CLAIMS as REGISTERED
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import chords, composition, corners, evaluation, flow, implicit, polar, polyhedral
from duhem.proof.verdict import Evidence
from tests.oracles.literature import CLAIMS, KNOWN, LOBES, THRESHOLDS
from tests.oracles.reevaluation import confirmed
from tests.oracles.verified import verified

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED
ProofMethod = Callable[[FormulaSubject], Evidence | None]


def _holds_elsewhere(verification: Verification) -> bool:
    """Every witness of the verification re-evaluates."""
    return all(r.witness is None or confirmed(verification.criterion, r.claim, r.witness) for r in verification.results)


# -- the whole domain -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", KNOWN)
def test_verdicts_over_the_whole_domain(name: str) -> None:
    assert {claim: verified(name)[claim].verdict for claim in KNOWN[name]} == KNOWN[name]


@pytest.mark.parametrize("name", KNOWN)
def test_nothing_is_left_open(name: str) -> None:
    assert tuple(r.claim for r in verified(name).results) == CLAIMS == tuple(REGISTERED)
    assert [r.claim for r in verified(name).results if r.verdict in (Verdict.UNDECIDED, Verdict.TESTED)] == []


@pytest.mark.parametrize("name", KNOWN)
def test_witnesses_hold_in_another_arithmetic(name: str) -> None:
    for result in verified(name).results:
        assert (result.verdict is REFUTED) == (result.witness is not None)
        assert result.witness is None or confirmed(verified(name).criterion, result.claim, result.witness), result.claim


def test_a_non_convex_law_is_not_normal() -> None:
    """Left out of the table for want of a convention; here: the normal of g is not in the normal cone of a non-convex K."""
    for name, claims in KNOWN.items():
        if claims["convexity"] is REFUTED:
            assert verified(name)["normality"].verdict is REFUTED


def test_the_summary_follows_from_the_claims() -> None:
    for name, claims in KNOWN.items():
        standard = [verified(name)[c].verdict for c in ("origin", "convexity", "normality")]
        assert verified(name).generalized_standard is (REFUTED not in standard)
        assert verified(name).dissipative is True, claims


# -- at and beside thresholds -----------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("name", "at", "claim", "verdict"), THRESHOLDS, ids=lambda v: v if isinstance(v, str) else None)
def test_thresholds(name: str, at: dict[str, str], claim: str, verdict: Verdict) -> None:
    here = verify(name, at, claims=[claim])
    assert here[claim].verdict is verdict
    assert _holds_elsewhere(here)


@pytest.mark.slow
@pytest.mark.parametrize(("n", "e", "verdict"), LOBES)
def test_lobes(n: int, e: str, verdict: Verdict) -> None:
    here = verify(lobe_law(n), {"e": e}, claims=["convexity"])
    assert here["convexity"].verdict is verdict
    assert _holds_elsewhere(here)


# -- two methods, one answer ------------------------------------------------------------------------------------------


def _subject(name: str, at: dict[str, str] | None = None, steps: int = 8_000_000) -> FormulaSubject:
    subject = FormulaSubject(load(name).fix(at))
    subject.allow(steps)
    return subject


CONVEX: list[tuple[str, dict[str, str], list[ProofMethod]]] = [
    ("antoni2007", {}, [composition.convexity, polar.convexity]),
    ("coulomb", {}, [composition.convexity, polar.convexity, implicit.convexity]),
    ("orthotropic", {}, [composition.convexity, polar.convexity]),
    ("cohesive", {}, [composition.convexity, polar.convexity]),
    ("box", {}, [composition.convexity, polar.convexity, implicit.hessian]),
    ("antoni2007-1d", {}, [composition.convexity, implicit.hessian]),
    ("von-mises", {}, [composition.convexity, polar.convexity]),
    ("superellipse", {"p": "4"}, [composition.convexity, polar.convexity]),
    ("quartic", {"c": "3"}, [polar.convexity, implicit.convexity, implicit.hessian]),
    ("quartic", {"c": "6"}, [polar.convexity, implicit.convexity]),
    ("drucker1949", {"c": "1"}, [polar.convexity, implicit.convexity]),
]

SMOOTH: list[tuple[str, dict[str, str], list[ProofMethod]]] = [
    ("antoni2007", {}, [composition.smoothness, polar.smoothness]),
    ("coulomb", {}, [composition.smoothness, polar.smoothness, implicit.smoothness]),
    ("quartic", {"c": "7"}, [composition.smoothness, polar.smoothness, implicit.smoothness]),
    ("superellipse", {"p": "4"}, [composition.smoothness, polar.smoothness]),
    ("shifted-ellipse", {}, [composition.smoothness, implicit.smoothness]),
]

DISSIPATIVE: list[tuple[str, dict[str, str], list[ProofMethod]]] = [
    ("antoni2007", {}, [polar.dissipation, implicit.dissipation]),
    ("coulomb", {}, [polar.dissipation, implicit.dissipation]),
    ("quartic", {"c": "7"}, [polar.dissipation, implicit.dissipation]),
    ("box", {}, [polar.dissipation, implicit.dissipation]),
]


def _ids(row: tuple[str, dict[str, str], list[ProofMethod]]) -> str:
    return "-".join([row[0], *row[1].values()])


@pytest.mark.slow
@pytest.mark.parametrize("row", [*CONVEX, *SMOOTH, *DISSIPATIVE], ids=_ids)
def test_independent_methods_prove_the_same(row: tuple[str, dict[str, str], list[ProofMethod]]) -> None:
    """Each on a case of its own, so that none profits from what another asked."""
    name, at, methods = row
    answers = {method.__module__: method(_subject(name, at)) for method in methods}
    assert {module: answer.verdict if answer else None for module, answer in answers.items()} == dict.fromkeys(answers, PROVED)


PROVERS: dict[str, list[ProofMethod]] = {
    "convexity": [composition.convexity, polyhedral.convexity, polar.convexity, implicit.convexity, implicit.hessian],
    "smoothness": [composition.smoothness, polar.smoothness, implicit.smoothness],
    "dissipation": [polar.dissipation, implicit.dissipation],
    "normality": [flow.normality],
    "origin": [evaluation.origin, polar.origin],
}
REFUTERS: dict[str, list[ProofMethod]] = {
    "convexity": [
        chords.convexity_by_scouting,
        chords.convexity_at_dents,
        chords.convexity_at_seams,
        chords.convexity_by_thorough_scouting,
    ],
    "smoothness": [corners.smoothness],
    "dissipation": [flow.dissipation_refuted],
    "normality": [flow.normality_refuted],
    "origin": [evaluation.origin_refuted],
}
Asked = tuple[str, dict[str, str], str]
STATED: list[Asked] = [(name, {}, claim) for name, claims in KNOWN.items() for claim in claims]
BESIDE: dict[str, Asked] = {name: (name, at, claim) for name, at, claim, verdict in THRESHOLDS if verdict is REFUTED}
FALSE = [asked for asked in STATED if KNOWN[asked[0]][asked[2]] is REFUTED] + list(BESIDE.values())
TRUE = [asked for asked in STATED if KNOWN[asked[0]][asked[2]] is PROVED and asked[2] in PROVERS]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "at", "claim"), FALSE, ids=lambda v: v if isinstance(v, str) else None)
def test_no_method_proves_what_is_false(name: str, at: dict[str, str], claim: str) -> None:
    """Asked directly, also those that the order of the claim never reaches."""
    provers = PROVERS[claim] if not (claim == "normality" and KNOWN[name]["convexity"] is REFUTED) else []
    assert [
        method.__module__ for method in provers if (answer := method(_subject(name, at))) is not None and answer.verdict is PROVED
    ] == []


@pytest.mark.slow
@pytest.mark.parametrize(("name", "at", "claim"), TRUE, ids=lambda v: v if isinstance(v, str) else None)
def test_no_method_refutes_what_is_true(name: str, at: dict[str, str], claim: str) -> None:
    assert [method.__module__ for method in REFUTERS[claim] if method(_subject(name, at)) is not None] == []


def test_scouting_and_curvature_find_the_same_dent() -> None:
    for name, at in (("quartic", {"c": "7"}), ("limacon", {"e": "3/4"}), ("matchstick", {"mu_a": "1", "mu_b": "2"})):
        law: Criterion = load(name).fix(at)
        for method in (chords.convexity_by_scouting, chords.convexity_at_dents):
            answer = method(_subject(name, at))
            assert answer is not None and answer.witness is not None and confirmed(law, "convexity", answer.witness)


@pytest.mark.parametrize("claim", ["origin", "convexity"])
def test_one_claim_may_be_named_alone(claim: str) -> None:
    alone, listed = verify("coulomb", claims=claim), verify("coulomb", claims=[claim])
    assert [r.claim for r in alone.results] == [r.claim for r in listed.results] and claim in {r.claim for r in alone.results}
    with pytest.raises(InputError, match=f"unknown claim '{claim}s'"):
        verify("coulomb", claims=f"{claim}s")
