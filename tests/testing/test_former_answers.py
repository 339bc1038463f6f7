"""An answer that changes after it was given is told, whoever hands out one buffer, and nothing is said of who does not."""

from __future__ import annotations

import ctypes
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from duhem.testing import Case, Material, MaterialState, Step, conformance, from_displacements, from_material, pointwise, violation
from tests.long import mostly_long
from tests.oracles.routines import DISK, Array

Routine = Callable[..., Any]


def right(trial: Array, pressure: Array, stiffness: Array) -> Array:
    size, limit = np.hypot(*trial.T), -DISK["mu"] * pressure
    with np.errstate(all="ignore"):
        return np.where((size > limit)[:, None], trial / size[:, None] * limit[:, None], trial)


def by_size() -> Routine:
    kept: dict[int, Array] = {}

    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        answer = kept.setdefault(len(trial), np.empty_like(trial))
        answer[...] = right(trial, pressure, stiffness)
        return answer

    return update


def taken_by_turns(number: int) -> Routine:
    routines = deque(by_size() for _ in range(number))

    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        routines.rotate()
        return routines[0](trial, pressure, stiffness)

    return update


def two() -> Routine:
    return taken_by_turns(2)


def four() -> Routine:
    return taken_by_turns(4)


def static_in_c() -> Routine:
    memory = (ctypes.c_double * 1000)()

    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        found = right(trial, pressure, stiffness)
        ctypes.memmove(memory, np.ascontiguousarray(found).ctypes.data, found.nbytes)
        return np.ctypeslib.as_array(memory)[: found.size].reshape(found.shape)

    return update


def one_mapping() -> Routine:
    answer: dict[str, Any] = {}

    def update(trial: Array, pressure: Array, stiffness: Array) -> dict[str, Any]:
        answer["stress"] = right(trial, pressure, stiffness)
        return answer

    return update


def one_list() -> Routine:
    answer: list[list[float]] = []

    def update(trial: Array, pressure: Array, stiffness: Array) -> list[list[float]]:
        answer[:] = right(trial, pressure, stiffness).tolist()
        return answer

    return update


def one_slip() -> Routine:
    kept = np.empty((1000, 2))

    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        stress = right(trial, pressure, stiffness)
        kept[: len(trial)] = (trial - stress) @ np.linalg.inv(stiffness)
        return Step(stress, kept[: len(trial)])

    return update


def one_point() -> Routine:
    answer = np.empty(2)

    def step(trial: Array, pressure: float, stiffness: Array) -> Array:
        answer[...] = right(trial[None], np.array([pressure]), stiffness)[0]
        return answer

    return pointwise(step)


def one_displacement() -> Routine:
    kept: dict[int, Array] = {}

    def step(u: Array, before: Array, pressure: Array, stiffness: Array) -> Array:
        answer, trial = kept.setdefault(len(u), np.empty_like(u)), (u - before) @ stiffness
        answer[...] = before + (trial - right(trial, pressure, stiffness)) @ np.linalg.inv(stiffness)
        return answer

    return from_displacements(step)


BUFFERS: list[tuple[Callable[[], Routine], str]] = [
    (by_size, "stress"), (two, "stress"), (four, "stress"), (static_in_c, "stress"), (one_mapping, "stress"), (one_list, "stress"),
    (one_slip, "slip"), (one_point, "stress"), (one_displacement, "u_in"),
]  # fmt: skip
PLACE = {"stiffness": [1.0, 1.0], "pressure": -1.0}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("made", "part"), mostly_long(BUFFERS, *(BUFFERS[i] for i in (2, 3, 6, 7, 8))), ids=[made.__name__ for made, _ in BUFFERS]
)
@pytest.mark.parametrize("law", mostly_long(["coulomb", None], "coulomb"))
def test_one_buffer_for_all_answers_is_told_and_nothing_else(law: str | None, made: Callable[[], Routine], part: str) -> None:
    values, asked = DISK if law else None, ["answers", "inputs", "repeatability", *(["idempotence", "firmness"] if law else [])]
    report = conformance(law, made(), values, checks=asked, max_examples=1, rows=6, every=3, seed=1, tries=20, **PLACE)
    assert report.failed == {"inputs"}, str(report)
    (failure,) = report.failures
    assert failure.message == f"overwritten: {part} of an earlier answer" and len(failure.case) == 1
    told = [violation("inputs", law, update, failure.case, open_parameters=()) for update in (made(), right)]
    assert told == [failure.message, None]


def test_an_array_that_was_given_or_stays_is_an_answer() -> None:
    """Where all stick what comes back is the array that was given; the tangent is one array, written once."""
    tangent: dict[int, Array] = {}

    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        found = right(trial, pressure, stiffness)
        kept = tangent.setdefault(len(trial), np.zeros((len(trial), 2, 2)))
        return Step(trial if (found == trial).all() else found, tangent=kept)

    for routine in (update, pointwise(lambda trial, pressure, k: right(trial[None], np.array([pressure]), k)[0])):
        for law, values in (("coulomb", DISK), (None, None)):
            report = conformance(law, routine, values, checks=["inputs"], max_examples=2, rows=6, every=1, **PLACE)
            assert report.ok, str(report)


def bar(shared: tuple[str, ...] = (), alone: str = "") -> Material:
    """Modulus 1, yield 1, isotropic hardening 1/2; ``shared`` are the parts handed out in one array."""
    kept: dict[tuple[str, int], Array] = {}

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        trial, n = before.stress + increment, len(increment)
        excess = np.maximum(np.abs(trial) - 1.0 - 0.5 * before.variables, 0.0) / 1.5
        parts = {"stress": trial - np.sign(trial) * excess, "variables": before.variables + excess}
        for name in shared:
            buffer = kept.setdefault((name, n), np.empty((n, 1)))
            buffer[...] = parts[name]
            parts[name] = buffer
        if alone == "squeezes" and n == 1:
            parts["stress"] = np.squeeze(parts["stress"])
        if alone == "other" and n == 1:
            parts["stress"] = 0.9 * parts["stress"]
        return MaterialState(before.strain + increment, **parts)

    return Material(advance, [[1.0]], [0.0])


STATES = ["", "stress", "variables", "stress, variables"]


@pytest.mark.parametrize("shared", mostly_long(STATES, "", "variables"))
def test_a_state_that_is_handed_out_in_one_buffer_is_told(shared: str) -> None:
    parts = tuple(filter(None, shared.split(", ")))
    report = conformance(None, bar(parts), max_examples=1, rows=6, seed=1, tries=20)
    assert report.failed == ({"inputs"} if shared else set()), str(report)
    if shared:
        said = ", ".join(f"{name} of an earlier answer" for name in parts)
        assert report.failures[0].message == f"overwritten: {said}"
        told = [violation("inputs", None, material, report.failures[0].case) for material in (bar(parts), bar())]
        assert told == [f"overwritten: {said}", None]


def test_a_material_with_one_buffer_is_told_by_its_law() -> None:
    made = bar(("stress",))

    def check(material: Material) -> set[str]:
        update = from_material(lambda stiffness, **_: material)
        return {*conformance(None, update, stiffness=[1.0], checks=["inputs"], max_examples=1, rows=4).failed}

    assert check(made) == {"inputs"} and check(bar()) == set()


def remembers() -> Routine:
    """A thousandth of the last answer is added to trial stresses of its shape."""
    last = [np.zeros((0, 2))]

    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        before = last[0] if last[0].shape == trial.shape else 0.0
        last[0] = right(trial + 1e-3 * before, pressure, stiffness)
        return last[0]

    return update


def mistaken_in_a_crowd() -> Routine:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        found = right(trial, pressure, stiffness)
        if len(trial) > 64:
            found[-1] = found[0]
        return found

    return update


OTHERWISE = [(remembers, 5, 14, "in calls of one size, one after the other"), (mistaken_in_a_crowd, 6, 14, "in a call of 300 increments")]


@pytest.mark.parametrize(("made", "cases", "rows", "said"), OTHERWISE, ids=["remembers", "crowd"])
def test_the_same_is_asked_after_itself_and_in_a_crowd(made: Callable[[], Routine], cases: int, rows: int, said: str) -> None:
    asked: dict[str, Any] = {"checks": ["repeatability", "path"], "max_examples": cases, "rows": rows, "tries": 20, **PLACE}
    report = conformance("coulomb", made(), DISK, seed=1, **asked)
    assert report.failures[0].check.name == "repeatability" and said in report.failures[0].message, str(report)


def of_one(change: Callable[[Array], Array]) -> Routine:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        found = right(trial, pressure, stiffness)
        return change(found) if len(trial) == 1 else found

    return update


def raises(stress: Array) -> Array:
    raise IndexError("one row")


ALONE = [
    ((of_one(lambda s: 0.9 * s), PLACE), "repeatability", "between the answer among others and that to the increment alone"),
    ((of_one(np.squeeze), PLACE), "answers", "the stress has the shape (2,), not (1, 2)"),
    ((of_one(raises), PLACE), "answers", "the routine raised IndexError: one row"),
    ((bar(alone="other"), {}), "repeatability", "between the answer among others and that to the increment alone"),
    ((bar(alone="squeezes"), {}), "answers", "the stress has the shape (), not (1, 1)"),
]


@pytest.mark.parametrize(("routine", "check", "said"), mostly_long(ALONE, ALONE[0], ALONE[4]), ids=range(len(ALONE)))
def test_without_a_law_one_increment_is_asked_alone(routine: tuple[Any, dict[str, Any]], check: str, said: str) -> None:
    update, options = routine
    report = conformance(None, update, checks=["answers", "repeatability"], max_examples=1, rows=6, seed=1, tries=20, **options)
    assert [failure.check.name for failure in report.failures] == [check] and said in report.failures[0].message, str(report)
    case: Case = report.failures[0].case
    assert said in str(violation(check, None, update, case))
