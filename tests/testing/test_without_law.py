"""What a routine is told without a law: its own bugs, the right check first, and nothing false of a good one."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext

import numpy as np
import pytest

from duhem.errors import InputError
from duhem.testing import (
    Case,
    Material,
    MaterialState,
    Report,
    Step,
    assert_conforms,
    checks_for,
    conformance,
    decades,
    projection,
    violation,
)
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.registry import judged, registered
from duhem.testing.routines import Unfinished
from tests.long import long_but, mostly_long
from tests.oracles.routines import Array
from tests.testing.examples import BUGS, EXAMPLES, friction, interface

MUTANTS = [(name, bug, first) for name, found in BUGS.items() for bug, first in enumerate(found, start=1)]
QUICK = [case for case in MUTANTS if case[:2] in {("friction", 1), ("mises", 5), ("interface", 4)}]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "bug", "first"), long_but([0, 13], MUTANTS))
def test_each_bug_is_told_by_the_right_check_first(name: str, bug: int, first: str) -> None:
    report = conformance(None, max_examples=3, rows=12, tries=20, seed=1, **EXAMPLES[name](bug))
    assert report.failures and report.failures[0].check.name == first, str(report)
    failure, right = report.failures[0], EXAMPLES[name]()["update"]
    if not failure.check.whole and first != "repeatability":  # what shows only between calls need not show again alone
        assert len(failure.case) == 1
        assert violation(failure.check.name, None, EXAMPLES[name](bug)["update"], failure.case)
        assert violation(failure.check.name, None, right, failure.case) is None
    library, replay = f"{name}-{bug}.so", failure.replay()
    for text, wrong in ((replay, True), (replay.replace(library, f"{name}-0.so"), False)):
        found: dict[str, Callable[[], None]] = {}
        exec(text, found)
        with pytest.raises(AssertionError) if wrong else nullcontext():
            found[f"test_{first.replace('-', '_')}"]()


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_nothing_is_said_of_a_good_example(name: str) -> None:
    report = conformance(None, max_examples=2, rows=20, seed=2, **EXAMPLES[name]())
    assert report.ok and report.visited["slip"] > 0.1 and report.visited["stick"] > 0.1, str(report)
    assert len(report.passed) + len(report.left_out) == len(checks_for(None))


@pytest.mark.slow
def test_what_only_associated_laws_satisfy_is_asked_for_by_name() -> None:
    """The interface slips along itself whatever the pressure: its law is not associated, and good for all that."""
    by_name = [c for c in checks_for(None, associated=True) if not c.demanded]
    assert [c.name for c in by_name if not c.name.startswith("associated-")] == ["isotropic-plastic-work"]
    symmetry = [c for c in by_name if c.name == "associated-symmetry"]
    assert conformance(None, max_examples=2, rows=10, tries=20, checks=symmetry, **interface()).failed == {"associated-symmetry"}
    assert conformance(None, max_examples=1, rows=20, checks=by_name, **friction()).ok


def test_what_can_be_asked_in_one_call_is() -> None:
    """Most of what the suite costs are its calls: of a first case 21 to draw it, 72 along the path in small steps, and few others."""
    calls = []

    def once(trial: Array, pressure: Array, stiffness: Array) -> Array:
        calls.append(len(trial))
        share = -0.3 * pressure / np.maximum(np.hypot(*trial.T), -0.3 * pressure)
        return share[:, None] * trial

    report = conformance(None, once, stiffness=[2.0, 2.0], pressure=-1.0, max_examples=1, rows=12, seed=1)
    assert report.ok and {"elasticity", "rest", "subdivision"} <= set(report.passed), str(report)
    assert len(calls) <= 112, len(calls)


def kinematic(hardening: float, back: float = 1.0) -> Material:
    """One dimension, modulus 1, yield 1, linear kinematic hardening: the stress may be driven against itself, sigma d eps_p < 0."""

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        plastic = before.variables[:, :1]
        trial = before.stress + increment
        away = trial - hardening * plastic
        amount = np.maximum(np.abs(away) - 1.0, 0.0) / (1.0 + hardening)
        slip = amount * np.sign(away)
        stress, plastic = trial - slip, plastic + back * slip
        stored = 0.5 * (stress**2 + hardening * plastic**2)
        dissipated = before.dissipated[:, None] + amount
        slope = np.where(amount > 0.0, hardening / (1.0 + hardening), 1.0)[:, :, None]
        return MaterialState(before.strain + increment, stress, plastic, stored[:, 0], dissipated[:, 0], None, slope)

    return Material(advance, [[1.0]], [0.0], energies=True, name="kinematic")


@pytest.mark.slow
def test_kinematic_hardening_is_not_accused() -> None:
    report = conformance(None, kinematic(0.5), max_examples=3)
    assert report.ok and {"dissipation", "energy", "rest", "subdivision", "stored-energy"} <= set(report.passed), str(report)
    work = conformance(None, kinematic(3.0), checks=["isotropic-plastic-work"], max_examples=5, tries=20)
    assert work.failed == {"isotropic-plastic-work"}  # which is why it is asked for by name
    assert not conformance(None, kinematic(0.5, back=0.5), max_examples=3, tries=20).ok


def creeping(trial: Array, pressure: Array, stiffness: Array) -> Step:
    """A routine that lets go of a thousandth of the stress each time it is called."""
    size = np.linalg.norm(trial, axis=1, keepdims=True)
    return Step(0.999 * trial / np.maximum(1.0, size))


def test_a_stress_that_creeps_without_an_increment_is_told() -> None:
    report = conformance(None, creeping, stiffness=[1.0, 1.0], pressure=-1.0, max_examples=1, tries=20)
    assert "rest" in report.failed, str(report)


def softened(trial: Array, pressure: Array, stiffness: Array) -> Step:
    """Radial return to a disk, with half of the stiffness as tangent: symmetric, between 0 and k, and the slope of nothing."""
    stress = trial / np.maximum(1.0, np.linalg.norm(trial, axis=1, keepdims=True))
    return Step(stress, tangent=np.broadcast_to(0.5 * stiffness, (len(trial), *stiffness.shape)))


def test_a_tangent_that_is_no_slope_is_told() -> None:
    report = conformance(None, softened, stiffness=[1.0, 1.0], pressure=-1.0, max_examples=1, rows=6, tries=5, checks=["slope"])
    assert report.failed == {"slope"}, str(report)


def alternating(low: float) -> Material:
    """One dimension, modulus 1, yield 1, and ``low`` in every other step that slips: two states are swapped by mistake."""

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        trial, limit = before.stress + increment, np.where(before.variables % 2.0 == 0.0, 1.0, low)
        stress = np.clip(trial, -limit, limit)
        return MaterialState(before.strain + increment, stress, before.variables + (stress != trial))

    return Material(advance, [[1.0]], [0.0])


@pytest.mark.slow
def test_steps_that_do_not_converge_are_told_by_dividing_them() -> None:
    report = conformance(None, alternating(0.2), checks="subdivision", max_examples=2, rows=10, tries=0)
    assert report.failed == {"subdivision"}, str(report)
    assert conformance(None, alternating(1.0), checks="subdivision", max_examples=2, rows=10).ok


def test_a_run_that_never_slips_fails() -> None:
    report = conformance(None, lambda trial, pressure, stiffness: trial, stiffness=[1.0, 3.0], max_examples=2)
    assert report.failed == {"vacuity"} and "nothing slipped" in str(report) and report.visited["slip"] == 0.0
    with pytest.raises(AssertionError, match="nothing slipped"):
        assert_conforms(None, lambda trial, pressure, stiffness: trial, stiffness=[1.0], max_examples=2)


LAWS = [("coulomb", {"mu": 0.3}), ("antoni2007", {}), ("orthotropic", {"mu_a": 0.5, "mu_b": 0.1})]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "values"), mostly_long(LAWS, LAWS[0]), ids=str)
def test_duhems_own_routines_pass_what_needs_no_law(law: str, values: dict[str, float]) -> None:
    numbers = values or {f"mu_{x}_{s}": m for (x, s), m in zip([(x, s) for x in "ab" for s in ("plus", "minus")], (0.2, 0.08, 0.12, 0.15))}  # noqa: B905
    k = decades(-2, 2).map(lambda size: size * np.array([[2.0, 0.5], [0.5, 1.0]]))
    asked = checks_for(None, associated=True)
    report: Report = conformance(
        None, projection(law, tangent=True), numbers, stiffness=k, pressure=decades(-3, 3).map(lambda p: -p), checks=asked, max_examples=1
    )
    assert report.ok, str(report)


def test_parameters_without_a_law_are_numbers_or_strategies_and_checks_have_names() -> None:
    def update(trial: Array, pressure: None, stiffness: Array, limit: float) -> Array:
        assert pressure is None and limit > 0.0
        return np.clip(trial, -limit, limit)

    report = conformance(None, update, {"limit": decades(-3, 3)}, stiffness=decades(-1, 1).map(lambda k: [k, 2.0]), max_examples=4)
    assert report.ok and not any(sign == "seam" for sign in report.visited), str(report)
    with pytest.raises(
        InputError, match="without a law: unknown check 'feasibility'; did you mean 'repeatability'\\? choose one of answers"
    ):
        conformance(None, update, {"limit": 1.0}, stiffness=[1.0], checks="feasibility")


def test_what_does_not_come_back_on_a_history_asked_again_is_told_with_its_increment() -> None:
    """Of 14 histories the fourth and the eleventh are asked again; the eleventh does not come back."""

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        after = before.stress + increment
        if (after[:, 0] == 11.0).any():
            raise Unfinished("endless")
        return MaterialState(before.strain + increment, after, before.variables)

    trial, none = np.arange(1.0, 15.0)[:, None] * [1.0, 0.5], np.zeros((14, 2))
    case = Case({}, np.eye(2), None, trial, trial, trial, none, none, np.ones(14), 2.0, np.zeros((14, 2, 2)), None)
    some = HistoryQuery(Material(advance, np.eye(2)), case, 1e-9, every=7).some
    assert some.rows.tolist() == [3, 10] and isinstance(some, HistoryQuery)
    with pytest.raises(Unfinished) as fault:
        some.counted(some.start, some.case.trial, None)
    assert fault.value.row == 10


def test_what_a_reversed_question_brings_is_counted_at_its_own_increment() -> None:
    """Of five increments asked again the last first, the second is flagged, overwrites what it is given, or does not come back."""
    trial, none, asked = np.arange(1.0, 6.0)[:, None] * [1.0, 0.5], np.zeros((5, 2)), []
    case = Case({}, np.eye(2), None, trial, trial, trial, none, none, np.ones(5), 2.0, np.zeros((5, 2, 2)), None)

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        asked.append(increment[0, 0])
        bad = (increment[:, 0] == 2.0) & (len(asked) > 2)  # the first two are the path and the trial stresses
        if endless and bad.any():
            raise Unfinished("endless")
        spoilt = np.where(bad, "increment", "").astype(object)
        return MaterialState(before.strain + increment, before.stress + increment, before.variables, solved=~bad, overwritten=spoilt)

    endless = False
    query = HistoryQuery(Material(advance, np.eye(2)), case, 1e-9)
    assert judged(registered(of_a_law=False)["repeatability"], query) is None and asked[-2:] == [5.0, 1.0]  # the last is asked alone
    assert query.sound.tolist() == [True, False, True, True, True] and query.overwritten.tolist() == ["", "increment", "", "", ""]
    endless = True
    asked.clear()
    with pytest.raises(Unfinished) as fault:
        judged(registered(of_a_law=False)["repeatability"], HistoryQuery(Material(advance, np.eye(2)), case, 1e-9))
    assert fault.value.row == 1


@pytest.mark.long
def test_what_raises_on_the_way_is_told_by_its_own_increment() -> None:
    def update(trial: Array, pressure: Array | None, stiffness: Array) -> Array:
        if ((trial[:, 0] > 0.7) & (trial[:, 0] < 0.8)).any():
            raise ZeroDivisionError("there")
        return np.clip(trial, -1.0, 1.0)

    report = conformance(None, update, stiffness=[1.0, 2.0], checks=["answers"], max_examples=10, rows=10, seed=0, tries=20)
    (failure,) = report.failures
    assert 0.7 < failure.case.trial[0, 0] < 0.8, failure.increment
    assert violation("answers", None, update, failure.case) == failure.message
