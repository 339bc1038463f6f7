"""What is asked about K, how often, and what counts as an answer."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sympy import Rational

import duhem
from duhem.api import convexity
from duhem.api.convexity import asked
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Convexity
from duhem.projection.result import Status
from duhem.proof import verification
from duhem.proof.verdict import Verdict

_NUMBERS = count()
G = "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)"


def oval(**changed: Any) -> Criterion:
    """A law that nobody has asked about."""
    return Criterion(**({"name": f"oval-{next(_NUMBERS)}", "g": G, "parameters": {"e": duhem.REAL}} | changed))


@pytest.fixture
def laws(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Criterion]:
    """The laws that are put to the prover, none of which an earlier run has left an answer for."""
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    found: list[Criterion] = []
    verdict_within = verification.verdict_within

    def listened(law: Criterion, *rest: Any) -> Any:
        found.append(law)
        return verdict_within(law, *rest)

    monkeypatch.setattr(verification, "verdict_within", listened)
    return found


def answering(monkeypatch: pytest.MonkeyPatch, answer: Any) -> None:
    monkeypatch.setattr(convexity, "place", lambda *_: None)

    def verdict_within(law: Criterion, *_: Any) -> Any:
        verdict = answer(law)
        if isinstance(verdict, Exception):
            raise verdict
        return verdict

    monkeypatch.setattr(verification, "verdict_within", verdict_within)


def status(law: Criterion, e: Any, pressure: Any = -1.0) -> list[int]:
    found: list[int] = duhem.project(
        law, np.broadcast_to([3.0, 0.5], (np.size(pressure), 2)), pressure, parameters={"e": e}
    ).status.tolist()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("order", [("0.3", "0.8", "0.3"), ("0.8", "0.3", "0.8")])
def test_an_answer_holds_for_its_numbers_alone(order: tuple[str, ...]) -> None:
    law = oval()
    right = {"0.3": [Status.SLIP], "0.8": [Status.STATIONARY]}
    assert [status(law, e) for e in order] == [right[e] for e in order]
    assert status(law, 0.3) == status(law, np.float64(0.3)) == [Status.SLIP]
    assert status(law.fix({"e": "0.8"}), "0.8") == [Status.STATIONARY]


@pytest.mark.slow
def test_it_is_asked_once_for_a_law_and_its_numbers(laws: list[Criterion]) -> None:
    law = oval()
    for _ in range(3):
        status(law, "0.3")
        duhem.project(law, [0.0, 2.0], -2.0, 3.0, {"e": 0.3})
    assert [one.parameters["e"].value for one in laws] == [None, Rational(3, 10)]
    status(law, "0.4")
    assert len(laws) == 3


@pytest.mark.slow
def test_what_is_proved_for_all_numbers_is_asked_once(laws: list[Criterion]) -> None:
    law = oval(parameters={"e": Domain.between(0, "1/4")})
    assert [status(law, e) for e in ("0.1", "0.2", "0.25")] == [[Status.SLIP]] * 3
    assert len(laws) == 1


def test_nobody_is_asked_where_the_method_knows(laws: list[Criterion]) -> None:
    assert duhem.project("coulomb", [1.0, 0.0], -1.0, parameters={"mu": "0.3"}, convex="require").status[0] == Status.SLIP
    assert duhem.project(oval(), [1.0, 3.0], -1.0, parameters={"e": "0.3"}, convex="assume").status[0] == Status.SLIP
    assert laws == []


@pytest.mark.parametrize("verdict", list(Verdict))
def test_a_proof_alone_is_an_answer(monkeypatch: pytest.MonkeyPatch, verdict: Verdict) -> None:
    answering(monkeypatch, lambda law: verdict)
    law = oval()
    assert status(law, "0.3") == [Status.SLIP if verdict is Verdict.PROVED else Status.STATIONARY]
    known = asked(law, {"e": "0.3"}, "ask", unloaded=False)
    assert known == Convexity(loaded=verdict is Verdict.PROVED, unloaded=False)


def test_a_question_that_fails_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    answering(monkeypatch, lambda law: duhem.InputError("no meaning"))
    law = oval()
    assert status(law, "0.3") == [Status.STATIONARY]
    with pytest.raises(duhem.InputError, match="is not shown"):
        duhem.project(law, [3.0, 0.5], -1.0, parameters={"e": "0.3"}, convex="require")


def test_a_law_that_is_undefined_somewhere_is_not_shown_to_be_convex() -> None:
    law = Criterion("edge", "norm(a, b) - sqrt(1 + a**3)", {}, forces=("a", "b"), pressure=None)
    assert duhem.project(law, [0.5, 3.0]).status[0] != Status.SLIP


def test_where_it_has_no_value_there_is_no_point_of_k() -> None:
    law = Criterion("egg", "norm(a, b) - sqrt(1 + a)", {}, forces=("a", "b"), pressure=None)
    found = duhem.project(law, [[3.0, 0.0], [-3.0, 0.0]])
    assert (found.status == Status.SLIP).all()
    assert np.allclose(found.stress, [[(1 + np.sqrt(5)) / 2, 0], [(1 - np.sqrt(5)) / 2, 0]], rtol=0, atol=1e-12)


@pytest.mark.slow
def test_no_pressure_is_a_question_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    pressure = np.array([-1.0, 0.0, -2.0])
    answering(monkeypatch, lambda law: Verdict.PROVED if law.pressure else Verdict.UNDECIDED)
    law = oval()
    assert status(law, "0.3", pressure) == [Status.SLIP, Status.STATIONARY, Status.SLIP]
    assert status(law, "0.3", 0.0) == [Status.STATIONARY] and status(law, "0.3", -1.0) == [Status.SLIP]
    with pytest.raises(duhem.InputError, match=r"is convex at sigma_n = 0 is not shown"):
        duhem.project(law, [3.0, 0.5], 0.0, parameters={"e": "0.3"}, convex="require")
    answering(monkeypatch, lambda law: Verdict.UNDECIDED if law.pressure else Verdict.PROVED)
    assert status(oval(), "0.3", pressure) == [Status.STATIONARY, Status.SLIP, Status.STATIONARY]


@pytest.mark.slow
def test_no_pressure_leaves_a_point() -> None:
    numbers = {"mu_a": "0.3", "mu_b": "0.4", "p": 3}
    done = duhem.project("superellipse", [[1.0, 2.0]] * 2, [-1.0, 0.0], parameters=numbers, convex="require")
    assert done.status.tolist() == [Status.SLIP] * 2 and not done.stress[1].any()


@pytest.mark.slow
def test_k_is_asked_about_beyond_the_ranges_of_forces(laws: list[Criterion]) -> None:
    """Two discs, of which the law claims one: the other is nearer to this trial."""
    two = Criterion(
        f"two-{next(_NUMBERS)}",
        "min(norm(a, b), norm(a + 3, b)) - 1",
        {},
        forces=("a", "b"),
        pressure=None,
        domain={"a": Domain.between("-1", 2)},
    )
    assert duhem.project(two, [2.0, 2.0]).status[0] == Status.STATIONARY
    assert all(not law.domain for law in laws) and laws
    pressed = oval(domain={"sigma_n": Domain.between(-5, 0), "sigma_a": Domain.between(-3, 3)})
    status(pressed, "0.3")
    assert list(laws[-1].domain) == ["sigma_n"]


def test_a_law_that_takes_more_steps_is_flagged_and_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    law = oval(parameters={"e": Domain.between(0, "1/4")})
    with monkeypatch.context() as few:
        few.setattr(convexity, "_STEPS", 3_000)
        assert status(law, "0.1") == [Status.STATIONARY]
        with pytest.raises(duhem.InputError, match=r"is convex is not shown.*more steps"):
            duhem.project(law, [3.0, 0.5], -1.0, parameters={"e": "0.1"}, convex="require")
    assert status(replace(law), "0.1") == [Status.STATIONARY]  # this process has asked already
    convexity._known.cache_clear()
    assert status(law, "0.1") == [Status.SLIP]


def test_both_questions_share_the_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[int] = []
    monkeypatch.setattr(convexity, "place", lambda *_: None)

    def verdict_within(_law: Criterion, _claim: str, steps: int) -> Verdict:
        given.append(steps)
        return Verdict.UNDECIDED

    monkeypatch.setattr(verification, "verdict_within", verdict_within)
    asked(oval(), {"e": "0.3"}, "ask", unloaded=False)
    assert len(given) == 2 and sum(given) == convexity._STEPS and min(given) > 0
