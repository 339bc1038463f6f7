"""Ranges of the pressure and of forces: part of the statement, of what is proved, of the kernel's domain and of every witness."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

import duhem
from duhem import Criterion, Domain
from duhem.errors import InputError
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.domain import POSITIVE
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import NEGATIVE, ZERO, Bounds
from duhem.proof.kernel.bounds import POSITIVE as ABOVE
from duhem.proof.kernel.certificate import digest, recheck, stated
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.term import NotWritten, parse
from tests.long import long_but


def _law(g: str, *, parameters: dict[str, Domain] | None = None, **domain: Domain) -> Criterion:
    return Criterion(name="x", g=g, forces=("a", "b"), parameters=parameters or {}, domain=domain)


QUARTIC = "a**4 + b**4 - sigma_n/10*a**2*b**2 - 1"  # convex for |sigma_n| <= 60
RAISED = "norm(a, b) - mu*abs(sigma_n) + 1"  # 0 is in K for |sigma_n| >= 1/mu
MU = {"mu": Domain.between("0.2", 1)}
FLARED = "abs(b) - 1 - pos(-1 - a)"  # K is a strip that opens for a < -1
CASES = [
    (_law(QUARTIC, sigma_n=Domain.between(-60)), "convexity", "proved"),
    (_law(QUARTIC, sigma_n=Domain.between(-60, -2)), "convexity", "proved"),
    (_law(QUARTIC, sigma_n=Domain.between("-60.1")), "convexity", "refuted"),
    (_law(QUARTIC, sigma_n=Domain.between(-70, -61)), "convexity", "refuted"),
    (_law(RAISED, parameters=MU, sigma_n=Domain.between(None, -5)), "origin", "proved"),
    (_law(RAISED, parameters=MU, sigma_n=Domain.between(None, "-4.9")), "origin", "refuted"),
    (_law(RAISED, parameters=MU, sigma_n=Domain.between(-1)), "origin", "refuted"),
    (_law("norm(a, b) + sigma_n + 2", sigma_n=Domain.fixed(-2)), "origin", "proved"),
    (_law("norm(a, b) + sqrt(100 + sigma_n) - 11", sigma_n=Domain.between(-100)), "convexity", "proved"),
    (_law(FLARED, a=Domain.between(-3)), "convexity", "refuted"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "claim", "verdict"), long_but([*range(3, 6), 7, 9], CASES))
def test_claims_are_asked_within_the_ranges(law: Criterion, claim: str, verdict: str) -> None:
    found = duhem.verify(law, claims=[claim])[claim]
    assert found.verdict.value == verdict
    if verdict == "proved":
        assert all(span.stated(name) in found.scope for name, span in law.domain.items())
    if found.witness is not None:
        values = [(name, Fraction(point[name])) for point in found.witness.points.values() for name in law.domain]
        assert values and all(value in law.domain[name] for name, value in values)


@pytest.mark.slow
def test_what_is_violated_out_of_range_alone_is_not_refuted() -> None:
    assert duhem.verify(_law(FLARED, a=Domain.between(-1)), claims=["convexity"])["convexity"].verdict.value != "refuted"
    assert duhem.verify(_law("norm(a, b) + sigma_n", a=Domain.between(-1)), claims=["convexity"])["convexity"].verdict.value == "proved"


def test_a_part_of_k_has_no_closed_form() -> None:
    found = duhem.verify(_law("norm(a, b) + sigma_n", a=Domain.between(-1)), claims=["duality"])
    assert found["duality"].verdict.value == "not_applicable"
    assert duhem.verify(_law("norm(a, b) + sigma_n", sigma_n=Domain.between(-1)), claims=["duality"])["duality"].verdict.value == "proved"


def test_the_kernel_reads_them() -> None:
    law = _law(RAISED, parameters=MU, sigma_n=Domain.between(-100, -5), b=Domain.between(-1, 2))
    read = stated(law_as_text(law))
    domain = over(read)
    signs = {"sigma_n + 5": NEGATIVE | ZERO, "sigma_n + 100": ABOVE | ZERO, "sigma_n": NEGATIVE, "b + 1": NEGATIVE | ZERO | ABOVE}
    assert {text: domain.facts(parse(text)).sign for text in signs} == signs
    assert dict(read.ranges) == {"sigma_n": Bounds(Fraction(-100), Fraction(-5)), "b": Bounds(Fraction(-1), Fraction(2))}


def test_a_certificate_with_a_wider_range_is_not_confirmed() -> None:
    written = duhem.verify(CASES[4][0], claims=["origin"]).certificate()
    assert written["law"]["domain"] == {"sigma_n": {"min": None, "max": "-5"}}
    assert [row.confirmed for row in recheck(written)] == [True]
    for wider in ({}, {"sigma_n": {"max": "-4.9"}}):
        other = written | {"law": written["law"] | {"domain": wider}}
        assert [row.confirmed for row in recheck(other | {"sha256": digest(other)})] == [False]


@pytest.mark.parametrize(
    "domain",
    [
        {"sigma_n": {"min": "0"}},
        {"a": {"positive": True}},
        {"a": {"value": "1"}},
        {"mu": {"min": "0"}},
        {"c": {}},
        {"sigma_n": {"positive": True}},
    ],
)
def test_what_the_kernel_refuses(domain: dict[str, object]) -> None:
    with pytest.raises(NotWritten):
        stated(law_as_text(_law(RAISED, parameters=MU)) | {"domain": domain})


def test_it_survives_fixing_and_text() -> None:
    law = _law(RAISED, parameters={"mu": POSITIVE}, sigma_n=Domain.between(-100, -5))
    assert law.fix({"mu": 1}).domain == law.domain == reads(criterion_text(law)).domain


HEAD = '[criterion]\nname = "x"\ng = "norm(sigma_a, sigma_b) + sigma_n"\n[domain]\n'
FAULTS = {
    "no name of the law": ("sigma_x = { min = 0 }", "neither a force nor the pressure"),
    "no pressure left": ("sigma_n = { min = 0 }", "the range contains no sigma_n < 0"),
    "zero force alone": ("sigma_a = { min = 0, max = 0 }", "must have its ends in it, and other values"),
    "empty": ("sigma_n = { min = -1, max = -2 }", "is empty"),
    "a number": ("sigma_n = -100", "is not a table"),
    "another key": ("sigma_n = { least = -100 }", "unknown key 'least'"),
    "no number": ("sigma_n = { min = 'low' }", "is not a number"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_where_it_stands(fault: str) -> None:
    line, message = FAULTS[fault]
    with pytest.raises(InputError, match=message) as caught:
        reads(HEAD + line, "law.toml")
    assert caught.value.where == "law.toml:5:1"
    assert reads(HEAD + "sigma_n = { min = -1e2 }").domain == {"sigma_n": Domain.between(-100)}


@pytest.mark.parametrize("domain", [{"c": POSITIVE}, {"a": POSITIVE}, {"sigma_n": POSITIVE}, {"a": 3}, "a"])
def test_what_a_program_may_get_wrong(domain: object) -> None:
    with pytest.raises(InputError):
        Criterion(name="x", g="norm(a, b) - 1", forces=("a", "b"), domain=domain)  # type: ignore[arg-type]


STRIPS = [  # K within ranges that leave out zero force: what rests on zero force, or on rays from it, would be said wrongly
    ("(a**2 + b**2 - 1)*((a - 4)**2 + b**2 - 1)", {"a": (2, 6), "b": (-2, 2)}, {"convexity": "proved", "dissipation": ""}),
    ("a**2 + b**2 - 1 - 3*a**2*b**2", {"a": ("1/2", 3), "b": ("1/2", 3)}, {"convexity": "refuted"}),
    ("q - p*tan(1/2 + 3/10/(1 + p))", {"p": ("1/4", 2), "q": ("1/10", 2)},
     {"convexity": "proved", "smoothness": "proved", "dissipation": "proved"}),
    ("norm(a, b) - 1", {"a": ("1/2", 2), "b": ("-1/2", 2)}, {"convexity": "proved", "normality": "proved", "dissipation": "proved"}),
    ("1 - norm(a, b)", {"a": ("1/2", 2), "b": ("1/2", 2)}, {"convexity": "refuted", "dissipation": ""}),
    ("abs(b) - a**2", {"a": ("1/2", 2), "b": (-9, 9)}, {"convexity": "refuted", "dissipation": ""}),
    ("abs(b) - sqrt(a)", {"a": ("1/2", 2), "b": (-9, 9)}, {"convexity": "proved", "smoothness": "proved", "dissipation": "proved"}),
    ("log(a) + b**2", {"a": ("1/2", 2), "b": (-2, 2)}, {"convexity": "refuted", "smoothness": "proved"}),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("g", "ranges", "verdicts"), STRIPS)
def test_ranges_may_leave_out_zero_force(g: str, ranges: dict[str, tuple[object, object]], verdicts: dict[str, str]) -> None:
    domain = {name: Domain.between(*ends) for name, ends in ranges.items()}
    law = Criterion(name="x", g=g, forces=tuple(ranges), pressure=None, domain=domain)
    assert reads(criterion_text(law)).domain == law.domain
    found = duhem.verify(law)
    assert found["origin"].verdict.value == "not_applicable" and found.generalized_standard is not True
    known = {claim: found[claim].verdict.value for claim in verdicts}
    assert all(known[claim] == verdict if verdict else known[claim] != "proved" for claim, verdict in verdicts.items()), known
    assert all(result.trust is None or result.trust.value == "checked" for result in found if result.verdict.value == "proved")
    assert duhem.recheck(found.certificate()).ok
    for result in (result for result in found if result.witness is not None):
        for point in result.witness.points.values():  # type: ignore[union-attr]
            assert all(Fraction(point[name]) in law.domain[name] for name in law.domain)


def test_no_region_is_asked_away_from_zero_force() -> None:
    law = Criterion(
        name="x",
        g="a**2 + k*b**2 - 1",
        forces=("a", "b"),
        pressure=None,
        parameters=MU | {"k": POSITIVE},
        domain={"a": Domain.between(1, 2)},
    )
    with pytest.raises(InputError, match="zero force is outside the ranges"):
        duhem.region(law.fix({"mu": 1}), "k")


@pytest.mark.parametrize("entry", [{"min": "2", "max": "-2"}, {"min": "1", "max": "1"}])
def test_ranges_begin_below_their_end(entry: dict[str, str]) -> None:
    with pytest.raises(NotWritten):
        stated(law_as_text(_law("a**2 + b**2 - 1")) | {"domain": {"a": entry}})


@pytest.mark.parametrize("ends", [("1/2", 2), (-2, "-1/2"), ("1/1000", None)])
def test_what_is_about_zero_force_or_all_of_k_is_not_claimed_away_from_zero(ends: tuple[object, object]) -> None:
    """Neither by verify, nor by a certificate to which such ranges are added: K in them is no cone, and its support function another."""
    cone = Criterion(name="x", g="norm(sigma_a, sigma_b) + sigma_n/2", forces=("sigma_a", "sigma_b"))
    away = replace(cone, domain={"sigma_a": Domain.between(*ends)})
    found = duhem.verify(away, coupled=True)
    assert all(found[claim].verdict.value != "proved" for claim in ("origin", "duality", "homogeneity", "bipotential"))
    document = duhem.verify(cone, coupled=True).certificate()
    document["law"] |= {"domain": law_as_text(away)["domain"]}
    document["sha256"] = digest(document)
    refused = {row.claim: row.confirmed for row in recheck(document)}
    assert not any(refused[claim] for claim in ("origin", "duality", "homogeneity", "bipotential"))


def test_dissipation_does_not_rest_on_what_is_shown_of_another_set() -> None:
    """K in the ranges is one of two discs; zero force lies in the other, and (3, 0) is pushed towards it."""
    law = Criterion(name="x", g="(a**2 + b**2 - 1)*((a - 4)**2 + b**2 - 1)", forces=("a", "b"), pressure=None,
                    domain={"a": Domain.between(2, 6), "b": Domain.between(-2, 2)})  # fmt: skip
    document = duhem.verify(law).certificate()
    for row in document["claims"]:
        if row["claim"] in ("origin", "dissipation"):
            rule = {"origin": "evaluation", "dissipation": "fenchel"}[row["claim"]]
            row |= {"verdict": "proved", "trust": "checked", "rule": rule, "evidence": {}}
    document["sha256"] = digest(document)
    assert not any(row.confirmed for row in recheck(document) if row.claim in ("origin", "dissipation"))
