"""A slip a little too long, too short or turned is told nowhere: on thin sets, at apexes and edges, with stiffnesses far apart.

The exact answers are made, not found: a stress of the boundary, a slip along its normals, and the trial that they add up to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.benchmark.reference import Closest, distance
from duhem.law.formula_law import Criterion
from duhem.projection import newton
from duhem.projection.increment import Increment, increment
from duhem.projection.residuals import residuals
from duhem.projection.result import ACCURACY, Array, Solution, Status
from tests.long import long_but, mostly_long
from tests.projection.loop_as_text import as_text

VOUCHED = 1e-6  # of the largest component of a slip
OFF = (2e-6, 1e-3)
ROOT = np.array([[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [5.0, 7.0, 1.0]])
STIFF: dict[str, Array] = {
    "one": np.eye(3),
    "apart": np.diag([1.0, 2.0**10, 2.0**20]),
    "turned": ROOT @ np.diag([2.0**18, 2.0**9, 1.0]) @ ROOT.T,
    "one of two": np.eye(2),
    "alike": np.array([[1.0, 1.0 - 2.0**-16], [1.0 - 2.0**-16, 1.0]]),
}


@dataclass(frozen=True)
class Corner:
    """A stress of K in few bits, whole multiples of dg/dsigma on its sides, and so many of them."""

    law: str | Criterion
    parameters: dict[str, Any]
    stress: Sequence[float]
    normals: Sequence[Sequence[float]]
    times: float = 1.0

    @property
    def loaded(self) -> Criterion:
        return self.law if isinstance(self.law, Criterion) else duhem.load(self.law)

    def answers(self, k: Array, rng: np.random.Generator) -> tuple[Increment, Solution]:
        """Trials and what is right of them to the last bit, slips short and long."""
        stress, normals = np.array(self.stress), np.array(self.normals)
        weights = rng.integers(2, 9, (len(LENGTHS), len(normals))) / 8.0
        weights[0] = 1.0  # between all sides: as deep in K as that, an end is still close to each of them
        scale = 2.0 ** np.floor(np.log2(np.array(LENGTHS) * np.abs(stress).max() / np.abs(weights @ normals @ k).max(axis=1)))
        slip = (weights * scale[:, None]) @ normals
        trial = stress + slip @ k
        for t, d in zip(trial.tolist(), slip.tolist(), strict=True):
            pulls = [sum(Fraction(a) * Fraction(b) for a, b in zip(row, d, strict=True)) for row in k.tolist()]
            assert all(Fraction(a) == Fraction(b) + c for a, b, c in zip(t, self.stress, pulls, strict=True))
        question = increment(self.loaded, trial, -1.0 if self.loaded.pressure else None, k, self.parameters)
        multiplier = self.times * weights.sum(axis=1) * scale
        return question, Solution(np.tile(stress, (len(slip), 1)), slip, multiplier, np.zeros(len(slip), dtype=bool))


LENGTHS = (2.0**-14, 2.0**-6, 4.0)
CORNERS = {
    "box": Corner("box", {"mu_a": 0.5, "mu_b": 2.0**-16}, (0.5, 2.0**-16), ((1.0, 0.0), (0.0, 2.0**15)), 0.5),
    "needle": Corner(
        Criterion("needle", "abs(sigma_a) + 65536*abs(sigma_b) - 1", pressure=None), {}, (1.0, 0.0), ((1.0, 2.0**16), (1.0, -(2.0**16)))
    ),
    "tresca": Corner("tresca", {"yield_stress": 1.0}, (1.0, 0.0, 0.0), ((1.0, -1.0, 0.0), (1.0, 0.0, -1.0))),
    "rankine": Corner("rankine", {"ft": 1.0}, (1.0, 1.0, 1.0), np.eye(3).tolist()),
    "apex": Corner(
        Criterion("apex", "max(2*s2 + 2*s3 - 5*s1, 2*s1 + 2*s3 - 5*s2, 2*s1 + 2*s2 - 5*s3) + 1", forces=("s1", "s2", "s3"), pressure=None),
        {},
        (1.0, 1.0, 1.0),
        ((-5.0, 2.0, 2.0), (2.0, -5.0, 2.0), (2.0, 2.0, -5.0)),
    ),
    "bent edge": Corner(
        Criterion("bent", "max(norm(s1, s2), norm(s1, s3)) - 5", forces=("s1", "s2", "s3"), pressure=None),
        {},
        (3.0, 4.0, 4.0),
        ((3.0, 4.0, 0.0), (3.0, 0.0, 4.0)),
        5.0,
    ),
}


def passes(question: Increment, answer: Solution) -> Array:
    return residuals(question, answer, convex=True).worst() <= ACCURACY


def spoilt(answer: Solution, how: str, size: float, rng: np.random.Generator) -> Solution:
    slip = answer.slip
    if how == "turned":
        return replace(answer, slip=slip + size * np.abs(slip).max(axis=1)[:, None] * np.sign(rng.standard_normal(slip.shape)))
    factor = 1.0 + size if how != "shorter" else 1.0 - size
    return replace(answer, slip=factor * slip, multiplier=answer.multiplier * (factor if how == "with its multiplier" else 1.0))


WAYS = ("longer", "shorter", "turned", "with its multiplier")
AT = [(name, k) for name, k in product(CORNERS, STIFF) if len(STIFF[k]) == len(CORNERS[name].stress)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "k"), long_but([0, 2, 15], AT))
def test_at_a_corner_a_slip_is_told_if_it_is_right(name: str, k: str) -> None:
    rng, corner = np.random.default_rng(1), CORNERS[name]
    question, right = corner.answers(STIFF[k], rng)
    assert passes(question, right).all()
    for how, size in product(WAYS, OFF):
        assert not passes(question, spoilt(right, how, size, rng)).any(), (how, size)


@pytest.mark.parametrize("how", mostly_long(WAYS, "longer", "turned"))
def test_a_method_of_ones_own_is_not_believed_at_an_apex(how: str) -> None:
    """What it says is flagged, or put right."""
    corner = CORNERS["apex"]
    question, right = corner.answers(STIFF["one"], np.random.default_rng(2))
    given = spoilt(right, how, 2e-6, np.random.default_rng(3))
    own = replace(newton.NEWTON, name="own", again=None, solve=lambda q, _: given)
    done = duhem.project(corner.loaded, question.trial, stiffness=1.0, method=own)
    assert set(done.status.tolist()) <= {Status.SLIP, Status.INACCURATE}
    off = np.abs(done.slip - right.slip).max(axis=1) / np.abs(right.slip).max(axis=1)
    assert (off[done.status == Status.SLIP] <= VOUCHED).all()


def steep(kind: str, bits: int) -> Corner:
    """Three sides that meet, or two of them beside a third, the second steeper than the first by 2^bits."""
    much = 2**bits
    some = 2 ** (bits // 2)
    along, middle, across = (1.0, 0.0, 0.0), (0.0, float(much), 0.0), (0.0, 0.0, float(some))
    g, stress, normals = {
        "alike": (f"max(s1, {much}*s2, {some}*s3) - 1", (1.0, 1.0 / much, 1.0 / some), (along, middle, across)),
        "two": (f"max(s1, {much}*s2, {some}*s3/4) - 1", (1.0, 1.0 / much, 1.0 / some), (along, middle)),
        "of other heights": (f"max(s1 - 1, {much}*(s2 - 1), {some}*(s3 - 1))", (1.0, 1.0, 1.0), (along, middle, across)),
        "askew": (f"max(s1, s1 + {much}*s2, s1 + {some}*s3 - {much}*s2) - 1", along, (along, (1.0, much, 0.0), (1.0, -much, some))),
        "bent": (
            f"max(s1, {much**2}*s2**2, {some**2}*s3**2) - 1",
            (1.0, 1.0 / much, 1.0 / some),
            (along, (0.0, 2.0 * much, 0.0), (0.0, 0.0, 2.0 * some)),
        ),
    }[kind]
    return Corner(Criterion(kind, g, forces=("s1", "s2", "s3"), pressure=None), {}, stress, normals)


STEEP = list(product(("alike", "two", "of other heights", "askew", "bent"), (0, 4, 8, 16), ("one", "apart")))


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "bits", "k"), mostly_long(STEEP, ("of other heights", 16, "one"), ("two", 16, "apart")))
def test_a_flat_side_is_missed_as_much_as_a_steep_one_shows(kind: str, bits: int, k: str, monkeypatch: Any) -> None:
    """A slip without its part along one side, whose end is lifted off the other sides till these are as high: they hide it."""
    corner, stiffness = steep(kind, bits), STIFF[k]
    question, right = corner.answers(stiffness, np.random.default_rng(3))
    assert passes(question, right).all()
    normals = np.array(corner.normals)
    weights = right.slip @ np.linalg.pinv(normals)
    wrong = 0
    for side, lift in product(range(len(normals)), (0.0, 1.0, 2.0)):
        others = np.arange(len(normals)) != side
        left = weights * others
        beyond = (question.trial - left @ normals @ stiffness - right.stress) @ normals[side]
        gram = normals[others] @ stiffness @ normals[others].T
        left[:, others] -= lift * beyond[:, None] * np.linalg.solve(gram, np.ones(len(gram)))
        slip = left @ normals
        given = Solution(question.trial - slip @ stiffness, slip, left.sum(axis=1), right.failed)
        off = np.abs(slip - right.slip).max(axis=1) > VOUCHED * np.abs(right.slip).max(axis=1)
        assert not (passes(question, given) & off).any(), (side, lift)
        loop = as_text(monkeypatch, question, given, convex=True)
        assert loop.left is not None and set(np.flatnonzero(off)) <= set(loop.left.tolist())
        wrong += int(off.sum())
    assert wrong >= 9


PLY = {"Xt": 1.0, "Xc": 1.0, "Yt": 0.04, "Yc": 0.2, "S": 0.07}


@pytest.mark.slow
@pytest.mark.parametrize(("compiled", "length"), mostly_long(product((False, True), (1e-5, 1e-3)), (False, 1e-5)))
def test_at_the_edge_of_a_ply_no_soft_part_of_a_slip_is_lost(compiled: bool, length: float) -> None:
    """It is how far s1 is beyond its strength, to the last bit; the other two are those of the arc alone."""
    if compiled:
        pytest.importorskip("numba")
    law, stiffness = duhem.load("hashin-rotem"), np.diag([1.0, 1e3, 1e6])
    stress, normals = np.array([1.0, 0.024, 0.056]), np.array([[1.0, 0.0, 0.0], [0.0, 15.0, 0.8 / 0.07]])
    slips = np.random.default_rng(0).uniform(0.2, 1.0, (3, 2)) @ normals
    slips *= (length * np.abs(stress).max() / np.abs(slips @ stiffness).max(axis=1))[:, None]
    trial = stress + slips @ stiffness
    done = duhem.project(law, trial, stiffness=stiffness, parameters=PLY, method="newton", compiled=compiled)
    arc = Criterion("arc", "(s2/0.04)**2 + (t/0.07)**2 - 1", forces=("s2", "t"), pressure=None)
    question = increment(arc, trial[:, 1:], None, stiffness[1:, 1:], {})
    exact = Closest(question.g, arc.force_symbols(), None, question.stiffness.tolist(), 40)
    assert (done.status == Status.SLIP).all()
    for slip, (along, *across) in zip(done.slip.tolist(), trial.tolist(), strict=True):
        assert distance(slip, [along - 1.0, *exact(across, None).slip]) <= VOUCHED


THIN = [("orthotropic", 2.0, e, k) for e in (1e-6, 1e6) for k in ("one of two", "alike")] + [("superellipse", 4.0, 1e-6, "one of two")]
ANGLES = np.array([1.0, 30.0, 1000.0])  # from the tip, in shares of how thin K is


@pytest.mark.slow
@pytest.mark.parametrize(("law", "power", "thin", "k"), long_but([0], THIN))
def test_where_k_is_thin_it_is_asked_how_far_its_closest_point_is(law: str, power: float, thin: float, k: str, monkeypatch: Any) -> None:
    """Exact answers of a K that is larger by a share of itself: of its boundary's distance nothing shows where K is thin.

    By how much they are off for K itself the reference says, in forty digits; the loop to be compiled is asked too.
    """
    axes, stiffness = np.array([0.5, 0.5 * thin]), STIFF[k]
    parameters = {"mu_a": 0.5, "mu_b": 0.5 * thin} | ({} if law == "orthotropic" else {"p": power})
    tip = np.stack([np.cos(1e-6 * ANGLES), np.sin(1e-6 * ANGLES)], axis=1)[:, :: 1 if thin < 1.0 else -1]
    shape = tip ** (2.0 / power)
    normals = shape ** (power - 1.0) / axes
    criterion, seen = duhem.load(law), 0
    for length in (1e-4, 1e-2):
        pulls = normals @ stiffness
        multiplier = length * np.abs(axes * shape).max(axis=1) / np.abs(pulls).max(axis=1)
        for larger in (0.0, 1e-11, 3e-8):
            stress, slip = (1.0 + larger) * axes * shape, multiplier[:, None] * normals
            question = increment(criterion, stress + slip @ stiffness, -1.0, stiffness, parameters)
            answer = Solution(stress, slip, multiplier, np.zeros(len(slip), dtype=bool))
            told = passes(question, answer)
            assert told.all() or larger
            wrong = np.array([_off(question, i, answer) for i in range(len(slip))]) > 1.1 * VOUCHED if larger else ~told
            assert not (told & wrong).any()
            seen += int(wrong.sum())
            loop = as_text(monkeypatch, question, answer, convex=True)
            assert loop.left is not None and set(np.flatnonzero(wrong)) <= set(loop.left.tolist())
    assert seen >= 3


def _off(question: Increment, i: int, answer: Solution) -> float:
    forces = question.law.force_symbols()
    exact = Closest(question.g, forces, question.law.symbols()["sigma_n"], question.stiffness.tolist(), 40)
    return distance(answer.slip[i].tolist(), exact(question.trial[i].tolist(), -1.0).slip)
