"""A narrower question keeps its answer: fixed parameters, smaller ranges, fewer claims; and what a proof over wider domains must show."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import pytest

from duhem import Domain, load, recheck, verify
from duhem.law.domain import REAL
from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.certificate import digest
from duhem.proof.verdict import Trust
from tests.campaigns.restrictions import restrictions, weaker
from tests.long import long_but, mostly_long

QUICK = ("antoni2007", "box", "coulomb", "cohesive", "orthotropic", "quartic", "superellipse", "tresca", "von-mises")


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([4, 12], 4))
def test_restrictions_of_quick_laws_are_not_weaker(count: int) -> None:
    whole: dict[str, Any] = {}
    for asked in restrictions(count, 7, QUICK):
        known = whole.setdefault(asked.law, {r.claim: r for r in verify(asked.law).results})
        assert weaker(asked, known) == [], str(asked)


@pytest.mark.slow
@pytest.mark.parametrize("claim", long_but([3], ["convexity", "smoothness", "normality", "dissipation"]))
def test_one_claim_alone_keeps_its_trust(claim: str) -> None:
    """What its rule rests on is proved on the way, and is in the certificate."""
    found = verify("puck", claims=claim)
    assert found[claim].trust is Trust.CHECKED and recheck(found.certificate())[claim].confirmed


@pytest.mark.slow
def test_a_part_by_ranges_is_proved_with_the_whole() -> None:
    part = load("superellipse").within({"mu_a": Domain.between("1/5", "1/2"), "p": Domain.fixed("109/100")})
    found = verify(part, claims="duality")
    assert found["duality"].trust is Trust.CHECKED and recheck(found.certificate()).ok


def test_a_law_knows_what_it_is_a_part_of() -> None:
    """Only where its domains are narrower, and only as long as nothing else of it is changed."""
    law = load("superellipse")
    part = law.within({"p": Domain.between(2, 4)}).fix({"p": 3})
    assert part.whole == law and pickle.loads(pickle.dumps(part)).whole == law
    assert law.whole is None and law.fix({}).whole is None
    assert law.within({"mu_a": REAL}).whole is None and part.within({"p": Domain.between(1)}).whole is None
    assert replace(part, g="norm(sigma_a, sigma_b) - mu_a*mu_b*p").whole is None
    curve = load("limacon")
    assert curve.fix({"e": "1/5"}).whole == curve and curve.whole is None


@pytest.fixture
def certificate() -> dict[str, Any]:
    """Of a part of a law that the kernel knows as a whole alone."""
    return verify("superellipse", {"mu_b": "1/30", "p": "109/100"}, claims="duality").certificate()


def with_domains(certificate: dict[str, Any], over: Any) -> dict[str, Any]:
    (claim,) = certificate["claims"]
    changed = {**certificate, "claims": [{**claim, "evidence": {**claim["evidence"], "over": over}}]}
    return {**changed, "sha256": digest(changed)}


def test_a_proof_over_wider_domains_is_one_of_a_part(certificate: dict[str, Any]) -> None:
    assert recheck(certificate)["duality"].confirmed
    whole = with_domains(certificate, {"mu_b": {"positive": True}, "p": {"min": "1", "max": None}, "mu_a": {"positive": True}})
    assert recheck(whole)["duality"].confirmed


@pytest.mark.parametrize(
    "over",
    long_but([0, 5], [
        {"mu_b": {"positive": True}, "p": {"min": "2", "max": None}},  # the part is not in it
        {"mu_b": {"min": "1/10", "max": "1"}, "p": {"min": "1", "max": None}},
        {"mu_b": {"min": "-1"}, "p": {"min": "1", "max": None}},  # where the law divides by 0
        {"mu_b": {"positive": True}, "q": {"min": "1", "max": None}},
        {"sigma_a": {"positive": True}}, {"p": "1"}, ["p"], "p", 1, {},
    ]),
)  # fmt: skip
def test_a_proof_over_other_domains_is_none(certificate: dict[str, Any], over: Any) -> None:
    assert not recheck(with_domains(certificate, over))["duality"].confirmed


def test_a_proof_for_a_parameter_that_the_law_has_not_says_so(certificate: dict[str, Any]) -> None:
    told = recheck(with_domains(certificate, {"p": {"min": "1", "max": None}, "q": {"positive": True}}))["duality"].reason
    assert told.endswith("a proof is for parameters that are not all of the law's")


def test_what_bounds_cover() -> None:
    unit, positive, real = Bounds.read({"min": "0", "max": "1"}), Bounds.read({"positive": True}), Bounds.read({})
    half, zero = Bounds.read({"value": "1/2"}), Bounds.read({"value": "0"})
    assert all(real.covers(other) for other in (unit, positive, real, half, zero)) and unit.covers(half) and unit.covers(zero)
    assert positive.covers(half) and positive.covers(positive) and not positive.covers(zero) and not positive.covers(unit)
    assert not unit.covers(positive) and not unit.covers(real) and not half.covers(unit) and not half.covers(zero)
