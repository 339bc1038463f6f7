"""A material with a state held to its law: right ones pass, each mistake is found and named, and what cannot be held is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from duhem import Criterion, Domain
from duhem.errors import InputError
from duhem.testing import Material, MaterialState, check, conformance, violation
from duhem.testing.checks.registry import registered
from tests.long import long_but, mostly_long
from tests.testing.atlas_materials import NAMES
from tests.testing.atlas_materials import material as atlas_material
from tests.testing.hardening import KINDS, MISTAKES, UNNAMED, hardening

Array = np.ndarray
STATES = {name for name, check in registered(False, True).items() if check.of_states}
FEW: dict[str, Any] = {"max_examples": 3, "rows": 8, "tries": 10, "seed": 1}


@pytest.mark.slow
@pytest.mark.parametrize("kind", mostly_long(KINDS, "recovering-at-rest", "warm"))
def test_a_right_umat_passes(kind: str) -> None:
    law, material, parameters = hardening(kind)
    report = conformance(law, material, parameters, **FEW)
    assert report.ok and STATES - {*report.passed} == {"stress-of-the-state"}, str(report)
    assert report.visited["slip"] > 0.2 and report.visited["state"] > 0.2 and report.visited["stick"] > 0.2
    assert {"strain", "stress"} <= {*report.decades} and "visited: " in str(report)


@pytest.mark.slow
@pytest.mark.parametrize("mistake", mostly_long([n for n in MISTAKES if n not in UNNAMED], 2, 9, 15, 20, 27, 44))
def test_a_mistake_is_named_as_the_first_cause(mistake: int) -> None:
    kind, words = MISTAKES[mistake]
    law, material, parameters = hardening(kind, mistake)
    report = conformance(law, material, parameters, **FEW | {"max_examples": 10})
    first = report.failures[0]
    assert words in (first.diagnosis or first.message), str(report)
    if first.check.of_states:
        own: dict[str, Any] = {"parameters": parameters}
        assert violation(first.check.name, law, material, first.case, **own)
        assert violation(first.check.name, law, hardening(kind)[1], first.case, **own) is None


@pytest.mark.long
@pytest.mark.parametrize("mistake", UNNAMED)
def test_a_mistake_without_words_is_found(mistake: int) -> None:
    law, material, parameters = hardening(MISTAKES[mistake][0], mistake)
    assert not conformance(law, material, parameters, **FEW | {"max_examples": 10}).ok


# -- laws of the atlas ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(NAMES, "adhesion", "at1-damage", "chaboche-static-recovery", "perzyna", "slip-hardening"))
def test_a_right_routine_of_each_law_passes(name: str) -> None:
    report = conformance(**atlas_material(name), **FEW)
    assert report.ok and {"slope", *STATES} & {*report.passed}, str(report)


KEPT = [("prager", 2), ("armstrong-frederick-recall", 1), ("chaboche", 2), ("chaboche", 3), ("at1-damage", 0), ("slip-hardening", 1)]
STORED = [(name, variable, how) for name, variable in KEPT for how in ("lost", "twice", "not accumulated")]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "variable", "how"), mostly_long(STORED, ("chaboche", 2, "lost"), ("slip-hardening", 1, "twice")))
def test_a_variable_that_is_stored_wrongly_is_found(name: str, variable: int, how: str) -> None:
    def store(before: Array, after: Array) -> Array:
        kept, change = after.copy(), (after - before)[:, variable]
        kept[:, variable] = {"not accumulated": change}.get(how, before[:, variable] + (2 if how == "twice" else 0) * change)
        return kept

    assert not conformance(**atlas_material(name, store), **FEW, checks=[*STATES]).ok


# -- tips ----------------------------------------------------------------------------------------------------------------

CONE = Criterion("cone", "norm(a, b) + alpha*n - c", {"alpha": Domain(positive=True), "c": Domain(positive=True)}, ("a", "b", "n"), None)


def cone(alpha: float, early: float = 0.0, share: float = 1.0) -> Material:
    """The closest point of a cone, its tip at n = 1/alpha; wrong where the tip comes ``early``, or the flow has a ``share`` along n."""
    k, tip = np.array([3.0, 3.0, 5.0]), np.array([0.0, 0.0, 1.0 / alpha])

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        trial = before.stress + k * increment
        q = np.hypot(trial[:, 0], trial[:, 1])
        by = np.maximum(q + alpha * trial[:, 2] - 1.0, 0.0) / (k[0] + share * k[2] * alpha**2)
        around = np.where(q > 0.0, 1.0 - k[0] * by / np.where(q > 0.0, q, 1.0), 1.0)
        back = np.stack([around * trial[:, 0], around * trial[:, 1], trial[:, 2] - share * alpha * k[2] * by], axis=1)
        stress = np.where((around * q <= early)[:, None] & (by > 0.0)[:, None], tip, back)
        return MaterialState(before.strain + increment, stress, before.variables)

    return Material(advance, np.diag(k))


@pytest.mark.slow
@pytest.mark.parametrize("alpha", long_but([1], [0.1, 1.0, 5.0]))
def test_at_a_tip_the_law_has_many_flows(alpha: float) -> None:
    given: dict[str, Any] = {"parameters": {"alpha": alpha, "c": 1.0}, **FEW, "max_examples": 6, "rows": 30}
    report = conformance(CONE, cone(alpha), **given)
    assert report.ok and {"flow", "loading"} <= {*report.passed}, str(report)
    assert "flow" in conformance(CONE, cone(alpha, early=0.5), **given).failed
    assert {"flow"} <= conformance(CONE, cone(alpha, share=0.5), **given).failed


# -- laws of other shapes ------------------------------------------------------------------------------------------------


def prager(share: float = 1.0, sign: float = 1.0) -> Material:
    """The atlas' law in two components, k = 2, C = 1, R = 1: kept is the back stress X = C alpha, ``share`` of its step alone."""

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        back = before.variables
        trial = before.stress + 2.0 * increment
        away = trial - sign * back
        size = np.linalg.norm(away, axis=1, keepdims=True)
        slip = np.maximum(size - 1.0, 0.0) / 3.0 * away / np.where(size > 0.0, size, 1.0)
        return MaterialState(before.strain + increment, trial - 2.0 * slip, back + share * slip)

    return Material(advance, 2.0 * np.eye(2), [0.0, 0.0])


PRAGER: dict[str, Any] = {"parameters": {"R": 1.0, "k": 2.0, "C": 1.0}, "state": {"-Y_a": 0, "C*beta": 1}}


def test_a_back_stress_is_read_from_where_the_routine_keeps_a_stress() -> None:
    report = conformance("prager", prager(), **PRAGER, **FEW)
    assert report.ok and {"admissibility", "loading", "flow", "evolution", "law-dissipation"} <= {*report.passed}, str(report)
    for wrong, words in ((prager(0.5), "is advanced 0.5 times"), (prager(sign=-1.0), "with the opposite sign")):
        report = conformance("prager", wrong, **PRAGER, **FEW | {"max_examples": 10})
        assert words in report.failures[0].diagnosis, str(report)


def damaged(early: float = 1.0, rigid: float = 0.0) -> Material:
    """Lemaitre's bar of the atlas, E = 1, Y_0 = 1/2: all of a sudden the bar is gone where its strain passes 1."""

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        strain = before.strain + increment
        gone = np.where(np.abs(strain) > early, 1.0, before.variables)
        return MaterialState(strain, (1.0 - gone + rigid * gone) * strain, gone)

    return Material(advance, [[1.0]], [0.0])


def test_a_variable_that_the_stress_depends_on_is_compared_with_it() -> None:
    given: dict[str, Any] = {"parameters": {"E": 1.0, "Y_0": 0.5}, "state": {"D": 0}, **FEW}
    assert conformance("lemaitre-damage", damaged(), checks=[*STATES], **given).ok
    assert conformance("lemaitre-damage", damaged(1.2), checks=[*STATES], **given).failed >= {"admissibility"}
    assert conformance("lemaitre-damage", damaged(rigid=0.1), checks=[*STATES], **given).failed == {"stress-of-the-state"}


def norton(power: float = 3.0) -> Material:
    """Slip at the rate |sigma|^(n - 1) sigma in one component, k = 1, by Newton's method."""

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        trial = before.stress + increment
        size = np.abs(trial)
        stress = size / (1.0 + duration * size ** (power - 1.0))
        for _ in range(100):
            off = stress + duration * stress**power - size
            stress = np.maximum(stress - off / (1.0 + duration * power * stress ** (power - 1.0)), 0.0)
        return MaterialState(before.strain + increment, np.sign(trial) * stress, before.variables)

    return Material(advance, [[1.0]], ())


def test_rates_take_their_time() -> None:
    law = Criterion("norton", "A*abs(sigma)**(n + 1)/(n + 1)", {"A": Domain.fixed(1), "n": Domain.fixed(3)}, ("sigma",), None, viscous=True)
    given: dict[str, Any] = {"checks": ["flow", "rest"], "scale": 1.0, **FEW}
    report = conformance(law, norton(), **given)
    assert report.ok and "flow" in report.passed and report.left_out["rest"] == "the law depends on the rate", str(report)
    assert conformance(law, norton(2.0), **given).failed == {"flow"}


# -- what cannot be held -------------------------------------------------------------------------------------------------


def test_what_cannot_be_held_to_a_law_is_told() -> None:
    law, material, parameters = hardening("kinematic")
    with pytest.raises(InputError, match="the parameter C has no value, and a material contains its own"):
        conformance(law, material, {"R": 1.0, "H": 1.0})
    with pytest.raises(InputError, match="nothing says what p is: no place is given, and the stress does not depend on it"):
        conformance(law, material, parameters, state={"X": slice(7, 13)})
    with pytest.raises(InputError, match=r"'X' has 6 components, and the places .* of 13 are 2"):
        conformance(law, material, parameters, state={"p": 0, "X": [7, 8]})
    with pytest.raises(InputError, match=r"the law has 2 components of stress .* and the routine 6"):
        conformance("prager", material, PRAGER["parameters"])
    with pytest.raises(InputError, match="the check feasibility is not for such a routine"):
        conformance(law, material, parameters, checks=[check("feasibility")])
    with pytest.raises(InputError, match=r"unknown name|is not declared|unknown"):
        conformance(law, material, parameters, state={"p": 0, "Z": 3})
    with pytest.raises(InputError, match="the temperature T has no value"):
        conformance(*hardening("warm")[:2], {"R": 1.0, "H": 1.0, "a": 0.1, "T0": 1.0})
    with pytest.raises(InputError, match="the routine keeps no state"):
        conformance("coulomb", lambda trial, pressure, stiffness: trial, {"mu": 0.3}, state={"p": 0})
    with pytest.raises(InputError, match="functions of the rates"):
        conformance("stribeck", norton(), {})
    with pytest.raises(InputError, match="the size of increments is given with a law"):
        conformance("coulomb", lambda trial, pressure, stiffness: trial, {"mu": 0.3}, scale=1e-3)


# -- no pass in which nothing happened -----------------------------------------------------------------------------------


def bar(yields: float = 1.0, literal: float = 0.0, raises: float = 1.0, seed: int = 0) -> Material:
    """Modulus 1, yield 1 in one component; only a share ``yields`` of the points does, and a share of the calls raises."""
    rng = np.random.default_rng(seed)

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        if rng.random() > raises:
            raise ZeroDivisionError("there")
        trial = before.stress + (1.0 + literal) * increment
        limit = np.where(np.modf(np.abs(trial) * 1e6)[0] < yields, 1.0, np.inf)
        return MaterialState(before.strain + increment, np.clip(trial, -limit, limit), before.variables)

    return Material(advance, [[1.0]], ())


def test_a_stiffness_in_single_precision_is_told_and_hides_nothing() -> None:
    report = conformance(None, bar(literal=4e-8), **FEW)
    assert (
        report.failed == {"elasticity"}
        and "off by 4e-08" in report.failures[0].message
        and "single-precision" in report.failures[0].message
    )
    assert report.visited["slip"] > 0.2
    assert conformance(None, bar(literal=4e-8), accuracy=1e-6, **FEW).ok


@pytest.mark.slow
def test_a_routine_that_hardly_ever_yields_or_raises_is_no_pass() -> None:
    for wrong in (bar(0.0), bar(0.001), bar(raises=0.99)):
        report = conformance(None, wrong, max_examples=8, rows=30, tries=5, seed=3, checks=["vacuity", "elasticity"])
        assert not report.ok, str(report)
    report = conformance(None, bar(raises=0.99, seed=4), max_examples=10, rows=5, tries=5, seed=3, checks=["vacuity"])
    assert "the search for the elastic range failed" in str(report) or "raised ZeroDivisionError" in str(report)


def test_increments_are_of_the_size_that_is_asked_for() -> None:
    """Volume changes are elastic without end: no increment goes beyond what is given, or a hundred times the elastic range."""
    seen = []

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        seen.append(np.abs(increment).max())
        trial = before.stress + increment
        return MaterialState(
            before.strain + increment, np.stack([np.clip(trial[:, 0], -1e-3, 1e-3), trial[:, 1]], axis=1), before.variables
        )

    material = Material(advance, np.eye(2), ())
    assert conformance(None, material, **FEW).ok and max(seen) < 1.0
    seen.clear()
    assert conformance(None, material, largest_strain=0.01, **FEW).ok and max(seen) < 0.2
    with pytest.raises(InputError, match="is not a strain"):
        conformance(None, material, largest_strain=-1.0)
