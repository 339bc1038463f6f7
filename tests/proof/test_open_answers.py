"""A method needs every answer it asks for: one that is open, or denied, and it proves nothing.

Each is run on a law of which it proves its claim; then again for each of its questions, with that one answered otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from duhem import Criterion, Domain, verify
from duhem.proof.decide import Answer
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict
from tests.long import long_but, mostly_slow
from tests.oracles.prover import boundary as implicit
from tests.oracles.prover import degrees, on_boundary, parallel, polar
from tests.oracles.prover import evaluation as evaluated
from tests.oracles.prover.decide import AskedSubject

Method = Callable[[FormulaSubject], Evidence | None]
DISC, HALVES, A_B = "a**2 + b**2 - q", "a**2 + b**2 + pos(b)**2 - q", ("a", "b")

ROWS: list[tuple[Method, str, Sequence[str] | None, int]] = [  # how many of the questions may be open, since the method has another way
    (implicit.convexity, DISC, None, 1),
    (implicit.convexity, "max(a**2 + b**2 - q, a - q/2)", None, 2),  # the inside of a branch tells all of it
    (implicit.convexity, "a**2 + b**2 + c**2 - q", None, 0),
    (implicit.hessian, HALVES, None, 0),
    (implicit.hessian, "abs(a) + exp(b) - 1 - q", None, 0),
    (on_boundary.smoothness_on_boundary, HALVES, None, 0),
    (on_boundary.dissipation_on_boundary, HALVES, None, 0),
    (on_boundary.dissipation_on_boundary, DISC, A_B, 0),
    (parallel.normality, DISC, A_B, 0),
    (parallel.normality, "a**2 + b**2 + c**2 - q", ("a", "b", "c"), 0),
    (polar.convexity, "norm(a, b) + abs(a)/2 - q", None, 6),  # its arcs are asked by composition first
    (polar.smoothness, "norm(a, b) + a*b/norm(a, b)/4 + abs(a)*a/norm(a, b)/8 - q", None, 0),
    (degrees.dissipation, "a**2 + b**2 - q", None, 1),
    (evaluated.origin, "a**2 + b**2 - q", None, 0),
]


@pytest.mark.parametrize(
    ("method", "g", "slip", "spare"),
    long_but([0, 2, 5, 7, 8, 11, 12], mostly_slow(ROWS, ROWS[0], ROWS[8], ROWS[13])),
    ids=[f"{m.__module__.rpartition('.')[2]}-{m.__name__}-{g}" for m, g, *_ in ROWS],
)
def test_no_answer_may_be_missing(method: Method, g: str, slip: Sequence[str] | None, spare: int, monkeypatch: pytest.MonkeyPatch) -> None:
    q = Domain.between("1/2", 1)
    law = AskedSubject(Criterion("law", g, {"q": q}, forces=tuple("abc" if "c" in g else "ab"), pressure=None, flow=slip and tuple(slip)))
    asked, told = 0, dict[int, Answer]()
    ask = AskedSubject.ask

    def counted(subject: AskedSubject, *question: Any, **circle: Any) -> Answer:
        nonlocal asked
        asked += 1
        return told[asked] if asked in told else ask(subject, *question, **circle)

    def proved() -> bool:
        nonlocal asked
        asked = 0
        found = method(law)
        return found is not None and found.verdict is Verdict.PROVED

    assert proved()  # what is derived but once is derived now
    monkeypatch.setattr(AskedSubject, "ask", counted)
    assert proved() and asked > 0
    for answer in (Answer(None), Answer(False)):
        still = 0
        for place in range(1, asked + 1):
            told.clear()
            told[place] = answer
            still += proved()
            told.clear()
            proved()
        assert still == spare, asked


def test_a_branch_on_which_nothing_has_a_value_ends_in_no_crash() -> None:
    found = verify(Criterion("nested", "log(neg(log(neg(a)))) + a**2 + b**2", {}, ("a", "b"), None))
    assert [r.claim for r in found] and not any(r.verdict is Verdict.PROVED for r in found if r.claim != "state_laws")
