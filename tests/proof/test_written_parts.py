"""Constraints and boundary curves are proved as they were written, with the parts that SymPy drops although they may have no value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import pytest

from duhem import Verdict, verify
from duhem.errors import InputError
from duhem.law.criterion_file import reads
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.certificate import recheck
from duhem.proof.verdict import Trust
from tests.long import long_but, mostly_long

ROOT = "sqrt(e**2 - 2)"
PARTS = ["0*log(e)", "(e/e - 1)", "0*sqrt(e)", "0/e", f"({ROOT}*(c + 1) - {ROOT}*c - {ROOT})"]
ANYWHERE, WITHIN = ("-1", "3"), ("3/2", "2")  # ranges of e: parts have no value somewhere, everywhere
PLACES = ["constraint of a formula", "constraint of a curve", "boundary", "flow"]


def from_python(place: str, part: str, ends: tuple[str, str]) -> Law:
    parameters = {"e": Domain.between(*ends), "c": Domain.between("1/2", 3)}
    if place == "constraint of a formula":
        return Criterion("law", "norm(sigma_a, sigma_b) + c*sigma_n", parameters, constraints=(f"c + {part} > 0",))  # type: ignore[arg-type]
    boundary, flow, constraints = _curve(place, part)
    return ParametricCriterion("law", boundary, parameters, constraints=constraints, flow=flow)  # type: ignore[arg-type]


def from_a_file(place: str, part: str, ends: tuple[str, str]) -> Law:
    """With the part under a name of its own, where a formula of parameters has one."""
    low, high = (float(Domain.fixed(end).value) for end in ends)
    e = f"[parameters]\ne = {{ min = {low}, max = {high} }}\nc = {{ min = 0.5, max = 3 }}\n"
    define = f'[define]\nrest = "{part}"\n'
    if place == "constraint of a formula":
        head = '[criterion]\nname = "law"\ng = "norm(sigma_a, sigma_b) + c*sigma_n"\nconstraints = ["c + rest > 0"]\n'
        return reads(head + define + e)
    boundary, flow, constraints = _curve(place, "rest")
    text = f'[criterion]\nname = "law"\nconstraints = {[*constraints]}\n[boundary]\nT = {[*boundary]}\n'
    text += f"direction = {[*flow]}\n" if flow else ""
    return reads(text + define + e)


def _curve(place: str, part: str) -> tuple[Any, Any, Any]:
    return (
        ("c*cos(phi) + " + part if place == "boundary" else "c*cos(phi)", "c*sin(phi)"),
        ("cos(phi)", "sin(phi) + " + part) if place == "flow" else None,
        (f"c + {part} > 0",) if place == "constraint of a curve" else (),
    )


def proved(law: Law) -> set[str]:
    """The claims that are, state laws aside: they speak of no part of a formula; none where the law is refused."""
    try:
        found = verify(law)
    except InputError as fault:
        assert "has no value" in str(fault)
        return set()
    return {r.claim for r in found.results if r.verdict is Verdict.PROVED} - {"state_laws"}


@pytest.mark.slow
@pytest.mark.parametrize("make", mostly_long([from_python, from_a_file], from_a_file))
@pytest.mark.parametrize(
    ("part", "place"),  # of a formula's constraint every run asks below
    mostly_long(product(PARTS, PLACES), *((PARTS[1], place) for place in PLACES[1:]), (PARTS[4], "boundary"), (PARTS[4], "flow")),
)
def test_nothing_is_proved_of_what_may_have_no_value(make: Callable[..., Law], place: str, part: str) -> None:
    law = make(place, part, ANYWHERE)
    assert part in str(law_as_text(law)).replace("'", "")
    of_the_boundary = {"origin", "convexity", "smoothness"} if place == "flow" else set()  # these say nothing of a flow
    assert proved(law) <= of_the_boundary >= proved(law.fix({"c": 1}))


@pytest.mark.parametrize("make", long_but([1], [from_python, from_a_file]))
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("part", long_but([2], PARTS))
def test_what_has_a_value_stays_proved(make: Callable[..., Law], place: str, part: str) -> None:
    law = make(place, part, WITHIN)
    for each in (law, law.fix({"e": "7/4"})):
        found = verify(each)
        assert {r.verdict for r in found.results} <= {Verdict.PROVED, Verdict.NOT_APPLICABLE}
        assert part in str(law_as_text(each))
        if place.startswith("constraint") and part not in ("0/e", "(e/e - 1)"):
            continue  # whether a domain is empty the kernel works out in fractions, so not from a constraint with a root or a logarithm
        rows = recheck(found.certificate())
        proofs = {r.claim for r in found.results if r.verdict is Verdict.PROVED}
        checked = {r.claim for r in found.results if r.trust is Trust.CHECKED}
        assert {row.claim for row in rows if row.confirmed} == checked
        assert checked == proofs or "log" in part or "sqrt" in part  # of logarithms and of some roots in a curve the kernel knows nothing


@pytest.mark.slow
@pytest.mark.parametrize("constraint", mostly_long(["e/e <= 1", "0*log(e) <= 1", "0 <= 0/e"], "e/e <= 1"))
def test_a_constraint_that_holds_of_itself_is_handed_on(constraint: str) -> None:
    law = Criterion("law", "norm(sigma_a, sigma_b) - 1", {"e": Domain.between(0, 1)}, pressure=None, constraints=(constraint,))  # type: ignore[arg-type]
    for each in (law, law.fix({"e": 0}), law.within({"e": Domain.between(0, "1/2")})):
        assert law_as_text(each)["constraints"] == [constraint]
        assert not proved(each)
    for each in (law.fix({"e": 1}), law.within({"e": Domain.between("1/2", 1)})):
        assert law_as_text(each)["constraints"] == [constraint]
        assert proved(each) >= {"origin", "convexity", "smoothness", "normality", "dissipation"}


def test_text_goes_where_its_expression_is_replaced() -> None:
    law = from_python("constraint of a curve", "0*log(e)", WITHIN)
    assert isinstance(law, ParametricCriterion)
    c = law.symbols()["c"]
    other = replace(law, constraints=(c < 2,), boundary=(2 * law.boundary[0], law.boundary[1]))  # type: ignore[arg-type]
    assert law_as_text(other)["constraints"] == ["c < 2"]
    assert law_as_text(other)["boundary"] == ["2*c*cos(phi)", "c*sin(phi)"]
    assert law_as_text(replace(law, summary="the same"))["constraints"] == ["c + 0*log(e) > 0"]
    dropped = Criterion("law", "abs(sigma_a) - m", {"m": Domain.between(0, 9)}, ("sigma_a",), constraints=("m > -1", "m < 2"))  # type: ignore[arg-type]
    assert dropped.written_constraints == ("m > -1", "m < 2")
    assert dropped.fix({"m": 1}).written_constraints == ("m < 2",)


@pytest.mark.parametrize("place", ["constraint of a formula", "constraint of a curve"])
@pytest.mark.parametrize("part", PARTS)
def test_the_prover_looks_at_the_text_too(place: str, part: str) -> None:
    """Whatever the kernel says: no closed form counts either where a constraint may have no value."""
    for ends, may in ((ANYWHERE, False), (WITHIN, True)):
        law = from_python(place, part, ends)
        subject = FormulaSubject(law) if isinstance(law, Criterion) else CurveSubject(law)
        assert subject.constraints_defined is may


def test_constraints_are_read_where_the_others_hold() -> None:
    def subject(*constraints: str) -> FormulaSubject:
        parameters = {"e": Domain.between(-1, 1)}
        return FormulaSubject(Criterion("law", "norm(sigma_a, sigma_b) - 1", parameters, pressure=None, constraints=constraints))  # type: ignore[arg-type]

    assert subject("e > 0", "log(e) <= 0").constraints_defined and subject("log(e) <= 0", "e > 0").constraints_defined
    assert not subject("log(e) <= 0").constraints_defined and not subject("e + 0*log(e) > 0").constraints_defined
    assert not subject("log(e) <= 0", "e > -1/2").constraints_defined
