"""How a claim asks its methods, and what only the exact room may do."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

import duhem.proof
from duhem import InputError, load
from duhem.law.curve_law import ParametricCriterion
from duhem.proof.claims import CLAIMS, EVERY, Claim, ProofMethod, Rules, words
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Subject, fact
from duhem.proof.verdict import Evidence, Verdict

ROOM = Path(duhem.proof.__file__).parent
DISK = ParametricCriterion("disk", ("cos(phi)", "sin(phi)"))  # type: ignore[arg-type]
PROVED = Evidence(Verdict.PROVED, "made up", "made up")


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=CLAIMS)
def test_each_method_takes_the_kind_of_law_it_is_written_for(claim: Claim) -> None:
    for method in claim.methods:
        if isinstance(method, Rules):
            continue  # the kernel's rules are for either kind
        kinds = [kind for name, kind in get_type_hints(method.run).items() if name != "return"]
        assert method.takes in (get_args(kinds[0]) or kinds[:1]), method.run  # of a union each kind has a row


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=CLAIMS)
@pytest.mark.parametrize("kind", [FormulaSubject, CurveSubject])
def test_each_claim_has_a_method_for_each_kind_of_law(claim: Claim, kind: type[Subject]) -> None:
    assert any(issubclass(kind, method.takes) for method in claim.methods)


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=CLAIMS)
@pytest.mark.parametrize("kind", [FormulaSubject, CurveSubject])
def test_each_method_of_a_claim_has_words_of_its_own(claim: Claim, kind: type[Subject]) -> None:
    called = [words(method, claim.name) for method in claim.methods if issubclass(kind, method.takes) and not isinstance(method, Rules)]
    assert len(set(called)) == len(called) and all(re.fullmatch("[a-z]+( [a-z]+)*", each) and len(each) < 32 for each in called)


def test_the_text_explains_every_claim_and_nothing_else() -> None:
    sections = (f"# {name}\n\n{claim.theory}\n" for name, claim in EVERY.items())
    assert "\n".join(sections) == (ROOM / "theory.txt").read_text("utf-8")
    assert all(claim.theory for claim in EVERY.values()) and Claim("none", "", ()).theory == ""


class Agreeing:
    """A kernel that proves nothing by itself, and confirms everything."""

    def proof(self, claim: str, steps: int, as_written: bool | None = None) -> None:
        return None

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        return True


AGREES = Agreeing()


def test_a_method_is_asked_about_the_laws_it_takes_alone() -> None:
    asked: list[str] = []

    def curve(subject: CurveSubject) -> Evidence | None:
        asked.append("curve")
        return PROVED

    def any_law(subject: Subject) -> Evidence | None:
        asked.append("any law")
        return None

    def formula(subject: FormulaSubject) -> Evidence | None:
        asked.append("formula")
        return PROVED

    claim = Claim("made up", "", (ProofMethod(CurveSubject, curve), ProofMethod(Subject, any_law), ProofMethod(FormulaSubject, formula)))
    assert claim.examine(FormulaSubject(load("coulomb")), {}, AGREES) is PROVED and asked == ["any law", "formula"]
    assert claim.examine(CurveSubject(DISK), {}, AGREES) is PROVED and asked[2:] == ["curve"]
    assert claim.examine(CurveSubject(DISK), {}).verdict is Verdict.UNDECIDED  # what no kernel confirms is no proof
    told: list[tuple[str, str]] = []
    claim.examine(FormulaSubject(load("coulomb")), {}, AGREES, on_method=lambda name, method, budget: told.append((name, method)))
    assert told == [("made up", "test methods any law"), ("made up", "test methods formula")]
    assert Claim("none", "", ()).examine(FormulaSubject(load("coulomb")), {}).verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("later", [Verdict.TESTED, Verdict.PROVED, None])
def test_a_method_that_stops_at_a_number_too_large_is_told_beside_an_open_verdict(later: Verdict | None) -> None:
    def stops(_: FormulaSubject) -> None:
        raise InputError("k is too large for double precision")

    def answers(_: FormulaSubject) -> Evidence | None:
        return None if later is None else Evidence(later, "later", "as it is")

    methods = (ProofMethod(FormulaSubject, stops), ProofMethod(FormulaSubject, answers))
    found = Claim("two", "", methods).examine(FormulaSubject(load("coulomb")), {}, AGREES)
    assert found.verdict is (later or Verdict.UNDECIDED)
    assert found.detail.endswith("; not all methods could try: k is too large for double precision") == (later is not Verdict.PROVED)


def test_a_fact_is_made_once_for_each_law_and_looked_for_again_where_it_was_not_found() -> None:
    made: list[object] = []

    @fact
    def length(subject: Subject) -> int | None:
        made.append(subject)
        return len(subject.law.name) if len(made) > 1 else None

    one, two = FormulaSubject(load("box")), FormulaSubject(load("coulomb"))
    assert [length(one), length(one), length(one), length(two)] == [None, 3, 3, 7]
    assert made == [one, one, two]


def _written(source: str) -> Iterator[str]:
    """Names of the classes that a module makes values of."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            yield node.func.id if isinstance(node.func, ast.Name) else node.func.attr if isinstance(node.func, ast.Attribute) else ""


def test_only_the_exact_room_makes_a_witness() -> None:
    sources = ((path.parent.name, path.read_text("utf-8")) for path in ROOM.parent.rglob("*.py"))
    makers = {room for room, source in sources if "Witness" in source and "Witness" in _written(source)}
    assert makers == {"witness"}
