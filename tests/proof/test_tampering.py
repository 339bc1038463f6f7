"""A certificate may hold anything: what is no certificate is refused, and nothing in it makes recheck stumble or say what is false."""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

import pytest

from duhem import verify
from duhem.proof.kernel.certificate import digest, recheck, stated
from duhem.proof.kernel.term import NotWritten
from duhem.proof.recheck import recheck as rechecked
from tests.campaigns.tampering import dual, leaves, relabelled
from tests.long import mostly_long

ODD: tuple[Any, ...] = (None, True, 0, -1, 0.5, float("inf"), "", "1e9999999999", "-", [], ["a"], {}, {"a": {}}, "proved", "polar-gauge")


@cache
def made(name: str) -> dict[str, Any]:
    return verify(name).certificate()


def changed(path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    copy = json.loads(json.dumps(made("coulomb")))
    part = copy
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = value
    return copy | {"sha256": digest(copy)}


@pytest.mark.slow
@pytest.mark.parametrize("share", mostly_long(range(8), 0))
def test_odd_values_anywhere_are_refused_or_confirm_no_more(share: int) -> None:
    before = {row.claim for row in recheck(made("coulomb")) if row.confirmed}
    for path in list(leaves(made("coulomb")))[share::8]:
        for value in ODD:
            try:
                rows = recheck(changed(path, value))
            except NotWritten as fault:
                assert said_in_words(str(fault)), (path, value)
                continue
            assert all(row.confirmed or said_in_words(row.reason) for row in rows), (path, value)
            assert path[0] == "law" or {row.claim for row in rows if row.confirmed} <= before, (path, value)


def said_in_words(reason: str) -> bool:
    return reason != "" and re.search(r"[a-z](Error|Written)\b", reason) is None and len(reason) < 300


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("law",), None, "something else stands where an object should"),
        (("claims", 0, "evidence"), None, "something else stands where an object should"),
        (("inhabited",), [], "it is no certificate: something else stands where"),
        (("claims", 0), {}, "it is no certificate: 'claim' is not there"),
        (("law", "g"), "mu " + "y" * 100_000, "the formula is too long"),
        (("law", "g"), "(" * 5_000, "nests too deeply"),
    ],
)
def test_what_is_no_certificate_is_said_in_words(path: tuple[Any, ...], value: Any, words: str) -> None:
    with pytest.raises(NotWritten, match=words) as fault:
        recheck(changed(path, value))
    assert said_in_words(str(fault.value))


@pytest.mark.parametrize(
    ("evidence", "words"),
    [
        ({"potential": 1, "slips": {}}, "something else stands where"),
        ({"potential": "mu*+", "slips": {}}, "the formula ends too early"),
        ({"potential": "mu"}, "'slips' is not there"),
        ({"potential": "mu " + "y" * 100_000, "slips": {}}, "the formula is too long"),
    ],
)
def test_evidence_that_cannot_be_read_is_said_in_words(evidence: Any, words: str) -> None:
    at = next(i for i, claim in enumerate(made("coulomb")["claims"]) if claim["claim"] == "duality")
    (row,) = (row for row in recheck(changed(("claims", at, "evidence"), evidence)) if row.claim == "duality")
    assert not row.confirmed and row.reason.startswith("its evidence cannot be read: ")
    assert words in row.reason and said_in_words(row.reason)


def test_a_function_of_no_force_is_no_law() -> None:
    for g in ("-1", "0", "sigma_n", "mu - 1"):
        with pytest.raises(NotWritten):
            recheck(changed(("law", "g"), g))


@pytest.mark.parametrize("claim", ["claim", "verdict", "rule"])
def test_what_is_no_text_is_no_claim(claim: str) -> None:
    for value in ([], {}, ["convexity"], 1):
        with pytest.raises(NotWritten):
            recheck(changed(("claims", 0, claim), value))


def test_a_number_is_written_out() -> None:
    """A few letters of an exponent would make a number that fills the memory."""
    for path in (("inhabited", "mu"), ("law", "parameters", "mu", "max")):
        with pytest.raises(NotWritten):
            recheck(changed(path, "1e9999999999"))


def test_the_potential_is_compared_with_the_boundary() -> None:
    honest = made("coulomb")
    (duality,) = (c for c in honest["claims"] if c["claim"] == "duality")
    for factor, right in (("1", True), ("1.1", False), ("9/10", False), ("-1", False)):
        claims = [{**duality, "evidence": {**duality["evidence"], "potential": f"{factor}*({duality['evidence']['potential']})"}}]
        assert dual({**honest, "claims": claims}) is right
        assert right or not recheck_of(honest, claims)


def recheck_of(document: dict[str, Any], claims: list[dict[str, Any]]) -> bool:
    copy = {**document, "claims": claims}
    (row,) = recheck(copy | {"sha256": digest(copy)})
    return row.confirmed


@pytest.mark.parametrize(
    "path", [(), ("law",), ("law", "parameters", "mu"), ("claims", 0), ("law", "flow")], ids=lambda path: ".".join(map(str, path))
)
def test_a_word_that_means_nothing_is_refused(path: tuple[Any, ...]) -> None:
    """A reader takes "potential" for the law's, as in a criterion file, and "g" beside a curve too."""
    copy = json.loads(json.dumps(made("coulomb")))
    copy["law"]["flow"] = {"potential": copy["law"]["g"]}
    part = copy
    for key in path:
        part = part[key]
    part["surplus"] = "-sigma_a"
    with pytest.raises(NotWritten):
        recheck(copy | {"sha256": digest(copy)})


@pytest.mark.parametrize("word", ["g", "surfaces", "domain", "potential", "stress"])
def test_a_curve_has_no_formula(word: str) -> None:
    curve = {"forces": ["a", "b"], "pressure": "s", "parameters": {}, "constraints": [], "angle": "t", "flow": None}
    curve["boundary"] = ["cos(t)", "2*sin(t)"]
    assert stated(curve)
    with pytest.raises(NotWritten, match=word):
        stated(curve | {word: "-s*cos(t)"})


@pytest.mark.parametrize("trust", ["prover", "solver"])
@pytest.mark.parametrize("offered", [True, False], ids=["with its rule", "without a rule"])
def test_labels_do_not_confirm(trust: str, offered: bool) -> None:
    """Every claim of a false law is called proved on somebody's word."""
    for g in (
        "mu*abs(sigma_n) - norm(sigma_a, sigma_b)",
        "abs(sigma_a*sigma_b) - mu*sigma_n**2",
        "norm(sigma_a - 3, sigma_b) - mu*abs(sigma_n)",
    ):
        found = rechecked(relabelled({**made("coulomb"), "law": {**made("coulomb")["law"], "g": g}}, trust, offered))
        assert not found.ok
        assert bool(found.failed) == offered and bool(found.without_rule) != offered


@pytest.mark.parametrize("odd", [{}, "", {"mu >= 0": 1}, "mu"])
@pytest.mark.parametrize("word", ["forces", "constraints", "surfaces", "flow"])
def test_a_list_is_a_list(word: str, odd: Any) -> None:
    """An object without keys would be a law without constraints to the kernel, and none to who reads it."""
    law = made("coulomb")["law"]
    other = {k: v for k, v in law.items() if word != "surfaces" or k not in ("g", "flow")} | {word: odd}
    with pytest.raises((NotWritten, KeyError)):
        stated(other)
