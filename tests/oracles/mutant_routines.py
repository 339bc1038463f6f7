"""Wrong update routines, each with the check that says what is wrong with it.

Known by construction, but of three of them: that a reflected or swapped stress fails to come back, and what a memory without the
stiffness violates first, was seen when they had been run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import duhem
from duhem.projection.result import Projection
from duhem.testing import Step, from_displacements
from tests.oracles.routines import (
    DISK,
    ELLIPSE,
    MU,
    built_in_stress,
    identity_metric,
    inverse_metric,
    not_a_number,
    nothing,
    over_projection,
    radial_return,
    raises,
    reflected,
    skewed,
    swapped_sign,
    to_the_origin,
    wrong_shape,
)

__all__ = ["MUTANTS", "Mutant"]

Array = np.ndarray
Routine = Callable[..., Any]


@dataclass(frozen=True)
class Mutant:
    """A wrong routine for ``law`` at ``values``; ``roots``: the checks of which one has to be named as the cause, first."""

    kind: str
    name: str
    law: str
    values: Mapping[str, float]
    routine: Callable[[], Routine]  # made anew, for those that remember
    roots: frozenset[str]
    options: Mapping[str, Any] = field(default_factory=dict)


MUTANTS: list[Mutant] = []


def wrong(kind: str, name: str, law: str, values: Mapping[str, float], routine: Routine, *roots: str, **options: Any) -> None:
    MUTANTS.append(Mutant(kind, name, law, values, lambda: routine, frozenset(roots), options))


def solved(law: str, values: Mapping[str, float], trial: Array, pressure: Array | None, k: Any, **options: bool) -> Projection:
    return duhem.project(law, trial, pressure, k, values, **options)


def of(law: str, values: Mapping[str, float]) -> Routine:
    """The right routine of a law, which is a wrong one of another."""
    return lambda trial, pressure, k: solved(law, values, trial, pressure if duhem.load(law).pressure else None, k).stress


def changed(law: str, values: Mapping[str, float], change: Callable[[Array, Array, Array], Array]) -> Routine:
    """The right answer, changed: ``change(right, trial, pressure)``."""
    return lambda trial, pressure, k: change(solved(law, values, trial, pressure, k).stress, trial, pressure)


def beside(change: Callable[[Projection, Array, Array], Mapping[str, Array]]) -> Routine:
    """The right stress with slip, multiplier and tangent, some of them changed: ``change(projection, trial, stiffness)``."""

    def update(trial: Array, pressure: Array, k: Array) -> Step:
        found = solved("orthotropic", ELLIPSE, trial, pressure, k, tangent=True)
        parts = {"slip": found.slip, "multiplier": found.multiplier, "tangent": found.tangent}
        return Step(found.stress, **{**parts, **change(found, trial, k)})

    return update


# -- formula: the law of the routine is another ------------------------------------------------------------------------

CAP = {"mu": 0.5, "tau_max": 0.3}
GLUE = {"mu": 0.3, "cohesion": 0.1}
SIDES = {"mu_a": 0.3, "mu_b": 0.2}

for name, law, values, taken, others, root in [
    ("a coefficient too large in one quadrant", "antoni2007", MU, "antoni2007", {**MU, "mu_b_minus": 0.18}, "feasibility"),
    ("a coefficient too small in one quadrant", "antoni2007", MU, "antoni2007", {**MU, "mu_b_minus": 0.12}, "complementarity"),
    ("plus and minus exchanged", "antoni2007", MU, "antoni2007", {**MU, "mu_a_plus": 0.08, "mu_a_minus": 0.2}, "feasibility"),
    ("axes exchanged", "orthotropic", ELLIPSE, "orthotropic", {"mu_a": 0.1, "mu_b": 0.5}, "feasibility"),
    ("a disk in the ellipse", "orthotropic", ELLIPSE, "coulomb", {"mu": 0.1}, "complementarity"),
    ("a disk about the ellipse", "orthotropic", ELLIPSE, "coulomb", {"mu": 0.5}, "feasibility"),
    ("a box for the ellipse", "orthotropic", ELLIPSE, "box", ELLIPSE, "feasibility"),
    ("an ellipse for the box", "box", SIDES, "orthotropic", SIDES, "complementarity"),
    ("half of mu", "coulomb", DISK, "coulomb", {"mu": 0.15}, "complementarity"),
    ("mu wrong in the seventh digit", "coulomb", DISK, "coulomb", {"mu": 0.3 * (1 + 1e-7)}, "feasibility"),
    ("no cohesion", "cohesive", GLUE, "coulomb", DISK, "complementarity"),
    ("no cap", "capped", CAP, "coulomb", {"mu": 0.5}, "feasibility"),
    ("a cap too low", "capped", CAP, "capped", {"mu": 0.5, "tau_max": 0.29}, "complementarity"),
    ("Tresca for von Mises", "von-mises", {"yield_stress": 1.0}, "tresca", {"yield_stress": 1.0}, "complementarity"),
    ("von Mises for Tresca", "tresca", {"yield_stress": 1.0}, "von-mises", {"yield_stress": 1.0}, "feasibility"),
    ("an exponent of 2 for 4", "superellipse", {**SIDES, "p": 4.0}, "orthotropic", SIDES, "complementarity"),
]:
    wrong("formula", name, law, values, of(taken, others), root)
wrong("formula", "a stress built in", "orthotropic", ELLIPSE, built_in_stress, "homogeneity", "complementarity")

# -- flow: in K, and not the closest point -----------------------------------------------------------------------------


def diagonal_metric(trial: Array, pressure: Array, k: Array) -> Array:
    return solved("orthotropic", ELLIPSE, trial, pressure, np.diag(np.diag(k))).stress


def exchanged_metric(trial: Array, pressure: Array, k: Array) -> Array:
    return solved("orthotropic", ELLIPSE, trial, pressure, k[::-1, ::-1]).stress


def turned(angle: float) -> Routine:
    """On the disk, and turned on its boundary."""

    def change(right: Array, trial: Array, pressure: Array) -> Array:
        c, s = np.cos(angle), np.sin(angle)
        there = right @ np.array([[c, s], [-s, c]]) * (1.0 - 1e-15)
        return np.where((right == trial).all(axis=1, keepdims=True), trial, there)

    return changed("coulomb", DISK, change)


def clipped(trial: Array, pressure: Array, k: Array) -> Array:
    """First one component into the disk, then the other into what that leaves."""
    limit = 0.3 * np.abs(pressure)
    first = np.clip(trial[:, 0], -limit, limit)
    rest = np.sqrt(np.maximum(limit**2 - first**2, 0.0)) * (1.0 - 1e-15)
    return np.stack([first, np.clip(trial[:, 1], -rest, rest)], axis=1)


wrong("flow", "radial return on an ellipse", "orthotropic", ELLIPSE, radial_return, "variational-inequality")
wrong("flow", "the metric of no stiffness", "orthotropic", ELLIPSE, identity_metric, "variational-inequality")
wrong("flow", "the metric of the inverse stiffness", "orthotropic", ELLIPSE, inverse_metric, "variational-inequality")
wrong("flow", "the diagonal of the stiffness", "orthotropic", ELLIPSE, diagonal_metric, "variational-inequality")
wrong("flow", "the stiffnesses exchanged", "orthotropic", ELLIPSE, exchanged_metric, "variational-inequality")
wrong("flow", "the slip turned by a degree", "coulomb", DISK, turned(0.017), "variational-inequality", stiffness=1.0)
wrong("flow", "the slip turned by 1e-6", "coulomb", DISK, turned(1e-6), "variational-inequality", stiffness=1.0)
wrong("flow", "one component after the other", "coulomb", DISK, clipped, "variational-inequality", stiffness=1.0)

# -- projection: the way to the closest point --------------------------------------------------------------------------


def ellipse(change: Callable[[Array, Array, Array], Array]) -> Routine:
    return changed("orthotropic", ELLIPSE, change)


def gauge(stress: Array, pressure: Array) -> Array:
    with np.errstate(all="ignore"):
        return np.nan_to_num(np.hypot(stress[:, :1] / 0.5, stress[:, 1:] / 0.1) / -pressure[:, None], nan=0.0)


def held_back(right: Array, trial: Array, pressure: Array) -> Array:
    """Inside, next to the boundary, moved away from it."""
    size = gauge(trial, pressure)
    return np.where((size > 0.999) & (size < 1.0), 0.999 * right, right)


def single(trial: Array, pressure: Array, k: Array) -> Array:
    return solved("orthotropic", ELLIPSE, trial, pressure, k).stress.astype(np.float32).astype(np.float64)


def no_pressure(trial: Array, pressure: Array, k: Array) -> Array:
    if (pressure == 0.0).any():
        raise ZeroDivisionError("no pressure")
    return solved("orthotropic", ELLIPSE, trial, pressure, k).stress


for name, change, roots in [
    ("unfinished: a thousandth is left", lambda r, t, p: r + 1e-3 * (t - r), ["feasibility"]),
    ("unfinished: 1e-8 is left", lambda r, t, p: r + 1e-8 * (t - r), ["feasibility"]),
    ("sticks up to 1.0001 of the limit", lambda r, t, p: np.where(gauge(t, p) < 1.0001, t, r), ["feasibility"]),
    ("stays back from the boundary", held_back, ["idempotence"]),
    ("far trials are given up", lambda r, t, p: np.where(gauge(t, p) > 100.0, 0.0, r), ["complementarity"]),
    ("forgets to slip on an axis", lambda r, t, p: np.where(t[:, 1:] == 0.0, t, r), ["feasibility"]),
    ("loses the signs", lambda r, t, p: np.abs(r), ["complementarity", "dissipation"]),
    ("holds at no pressure", lambda r, t, p: np.where(p[:, None] == 0.0, t, r), ["feasibility"]),
    ("nan for no slip at all", lambda r, t, p: np.where((t == 0.0).all(axis=1, keepdims=True), np.nan, r), ["answers"]),
]:
    wrong("projection", name, "orthotropic", ELLIPSE, ellipse(change), *roots)
for name, routine, roots in [
    ("no projection", nothing, ["feasibility"]),
    ("over-projection", over_projection, ["complementarity"]),
    ("all stress gone", to_the_origin, ["complementarity"]),
    ("a swapped sign", swapped_sign, ["dissipation", "variational-inequality", "idempotence"]),  # a stress on the boundary comes back
    ("reflection", reflected, ["feasibility", "idempotence"]),
    ("single precision", single, ["feasibility", "idempotence"]),
    ("0/0 without stress", not_a_number, ["answers"]),
    ("an exception at no pressure", no_pressure, ["answers"]),
    ("an exception", raises, ["answers"]),
    ("an array of the wrong shape", wrong_shape, ["answers"]),
]:
    wrong("projection", name, "orthotropic", ELLIPSE, routine, *roots)

# -- tangent -----------------------------------------------------------------------------------------------------------


def continuum(found: Projection, trial: Array, k: Array) -> Array:
    """I - n n^T where it slips, which is not how the step turns: not consistent."""
    n = trial - found.stress
    size = np.linalg.norm(n, axis=1)
    n = np.where(size[:, None] > 0.0, n / np.where(size > 0.0, size, 1.0)[:, None], 0.0)
    return np.eye(2) - n[:, :, None] * n[:, None, :]


for name, tangent in [
    ("the elastic tangent", lambda f, t, k: 0.0 * f.tangent + k),
    ("no tangent, where it slips", lambda f, t, k: np.where((f.stress == t).all(axis=1)[:, None, None], f.tangent, 0.0)),
    ("a tangent that is not symmetric", lambda f, t, k: skewed(f.tangent)),
    ("the continuum tangent", continuum),
    ("a tenth of the tangent missing", lambda f, t, k: 0.9 * f.tangent),
    ("axes of the tangent exchanged", lambda f, t, k: f.tangent[:, ::-1, ::-1]),
    ("the tangent's sign", lambda f, t, k: -f.tangent),
    ("the tangent of the row before", lambda f, t, k: np.roll(f.tangent, 1, axis=0)),
    ("the tangent of one more than the stress", lambda f, t, k: f.tangent + 1e-4 * k),
]:
    routine = beside(lambda f, t, k, tangent=tangent: {"tangent": tangent(f, t, k)})
    wrong("tangent", name, "orthotropic", ELLIPSE, routine, "slope", "tangent", stiffness=1.0, pressure=-1.0)

# -- path and state ----------------------------------------------------------------------------------------------------


def displacements(slip: Callable[[Array, Array, Array, Array], Array], roots: list[str], name: str) -> None:
    """``slip(u, u_in, pressure, stiffness)``: the whole slip at the end."""
    wrong("path", name, "orthotropic", ELLIPSE, from_displacements(slip), *roots)


def slip_of(elastic: Array, pressure: Array, k: Array) -> Array:
    return solved("orthotropic", ELLIPSE, elastic @ k, pressure, k).slip


displacements(lambda u, old, p, k: old + slip_of(u, p, k), ["feasibility"], "the former slip forgotten")
displacements(lambda u, old, p, k: slip_of(u - old, p, k), ["feasibility"], "the former slip not added")
displacements(lambda u, old, p, k: 2 * old + slip_of(u - old, p, k), ["feasibility"], "the former slip counted twice")
displacements(lambda u, old, p, k: old + slip_of(u - old[:, ::-1], p, k), ["feasibility"], "the components of the former slip exchanged")
displacements(lambda u, old, p, k: old + slip_of(u - 0.999 * old, p, k), ["feasibility"], "a slip that heals")


def remembering(answer: Callable[[Array, Array, Array, dict[str, Any]], Array]) -> Callable[[], Routine]:
    def made() -> Routine:
        kept: dict[str, Any] = {}
        return lambda trial, pressure, k: answer(trial, pressure, k, kept)

    return made


def right(trial: Array, pressure: Array, k: Array) -> Array:
    return solved("orthotropic", ELLIPSE, trial, pressure, k).stress


def last_added(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """A thousandth of what was found before is still there."""
    found = right(trial, pressure, k)
    before = kept.get("stress", found)
    kept["stress"] = found
    return 0.999 * found + 0.001 * before[0]


def first_pressure(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """The pressure of the first call is kept for the others."""
    first = kept.setdefault("pressure", pressure[0])
    return right(trial, np.full(len(trial), first), k)


def first_stiffness(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """A factor of the stiffness is made once."""
    return right(trial, pressure, kept.setdefault("stiffness", k))


def former_pressure(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """The pressure of the call before, if that had as many rows."""
    former = kept.get("pressure", pressure)
    kept["pressure"] = pressure.copy()
    return right(trial, former if former.shape == pressure.shape else pressure, k)


def first_sign(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """Forces along a go one way, as the first one does."""
    sign = kept.setdefault("sign", 1.0 if trial[0, 0] >= 0.0 else -1.0)
    found = right(trial, pressure, k)
    return np.stack([np.where(sign * found[:, 0] < 0.0, 0.0, found[:, 0]), found[:, 1]], axis=1)


def remembered(key: Callable[[Array, float, Array], object]) -> Callable[..., Array]:
    """An answer that is looked up first, by a key that forgets something."""

    def answer(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
        for t, p in zip(trial, pressure, strict=True):
            if (name := key(t, p, k)) not in kept:
                kept[name] = right(t[None], np.array([p]), k)[0]  # type: ignore[index]
        return np.array([kept[key(t, p, k)] for t, p in zip(trial, pressure, strict=True)])  # type: ignore[index]

    return answer


def warm_start(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """The answer before is believed where it is right to a thousandth."""
    found = right(trial, pressure, k)
    for i, own in enumerate(found.copy()):
        last = kept.get("last", own)
        if np.linalg.norm(last - own) <= 1e-3 * np.linalg.norm(own):
            found[i] = last
        kept["last"] = found[i].copy()
    return found


def now_and_then(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """Every third call answers with half of the stress."""
    kept["calls"] = kept.get("calls", 0) + 1
    return right(trial, pressure, k) * (0.5 if kept["calls"] % 3 == 0 else 1.0)


def largest(trial: Array, pressure: Array, k: Array) -> Array:
    """Too small beside the largest trial of the call: nothing."""
    found = right(trial, pressure, k)
    return np.where(np.abs(trial) < 1e-6 * np.abs(trial).max(), 0.0, found)


def one_buffer(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Array:
    """The right answer, in memory that the next call writes to."""
    memory = kept.setdefault("memory", np.empty((10_000, 2)))
    memory[: len(trial)] = right(trial, pressure, k)
    return memory[: len(trial)]


def one_tangent(trial: Array, pressure: Array, k: Array, kept: dict[str, Any]) -> Step:
    """One array of tangents for each number of increments."""
    found = solved("orthotropic", ELLIPSE, trial, pressure, k, tangent=True)
    tangent = kept.setdefault(f"{len(trial)}", np.empty_like(found.tangent))
    tangent[...] = found.tangent
    return Step(found.stress, tangent=tangent)


for name, answer in [("one buffer for all answers", one_buffer), ("one tangent for all answers", one_tangent)]:
    MUTANTS.append(Mutant("state", name, "orthotropic", ELLIPSE, remembering(answer), frozenset(["inputs"]), {"stiffness": 1.0}))
for name, answer in [("an answer mixed with the last", last_added), ("every third call another", now_and_then)]:
    MUTANTS.append(Mutant("state", name, "orthotropic", ELLIPSE, remembering(answer), frozenset(["repeatability"])))
kept_pressure = frozenset(["feasibility", "complementarity", "repeatability"])
kept_stiffness = frozenset(["variational-inequality", "repeatability"])
MUTANTS.append(Mutant("state", "the first pressure kept", "orthotropic", ELLIPSE, remembering(first_pressure), kept_pressure))
for name, answer, also in [
    ("the pressure of the call before", former_pressure, ["feasibility", "complementarity"]),
    ("one sign, that of the first trial", first_sign, ["idempotence", "variational-inequality", "complementarity"]),
    ("a memory of six digits", remembered(lambda t, p, k: (*(f"{x:.5e}" for x in t), p, k.tobytes())), []),
    ("a memory without the stiffness", remembered(lambda t, p, k: (t.tobytes(), p)), ["variational-inequality", "stiffness-scale"]),
    ("a start that is believed", warm_start, []),
]:
    MUTANTS.append(Mutant("state", name, "orthotropic", ELLIPSE, remembering(answer), frozenset(["repeatability", *also])))
MUTANTS.append(Mutant("state", "the first stiffness kept", "orthotropic", ELLIPSE, remembering(first_stiffness), kept_stiffness))
wrong("state", "small beside the largest of the call", "orthotropic", ELLIPSE, largest, "repeatability")

# -- energy: slip and multiplier beside a right stress -----------------------------------------------------------------

for name, extras, roots in [
    ("slip of the wrong sign", lambda f, t, k: {"slip": -f.slip}, ["slip"]),
    ("slip in units of stress", lambda f, t, k: {"slip": t - f.stress}, ["slip"]),
    ("half of the slip", lambda f, t, k: {"slip": 0.5 * f.slip}, ["slip"]),
    ("one component of the slip", lambda f, t, k: {"slip": f.slip * [1.0, 0.0]}, ["slip"]),
    ("a multiplier without slip", lambda f, t, k: {"multiplier": f.multiplier + 1.0}, ["multiplier"]),
    ("a negative multiplier", lambda f, t, k: {"multiplier": -f.multiplier}, ["multiplier"]),
    ("twice the multiplier", lambda f, t, k: {"multiplier": 2.0 * f.multiplier}, ["multiplier"]),
    ("no multiplier", lambda f, t, k: {"multiplier": 0.0 * f.multiplier}, ["multiplier"]),
    ("a multiplier wrong in the seventh digit", lambda f, t, k: {"multiplier": f.multiplier * (1 + 1e-7)}, ["multiplier"]),
    ("the length of the slip for a multiplier", lambda f, t, k: {"multiplier": np.linalg.norm(f.slip, axis=1)}, ["multiplier"]),
    (
        "nan for a multiplier where it sticks",
        lambda f, t, k: {"multiplier": np.where(f.multiplier == 0, np.nan, f.multiplier)},
        ["multiplier"],
    ),
]:
    wrong("energy", name, "orthotropic", ELLIPSE, beside(extras), *roots, stiffness=None)
