"""Where planes bound K each set of them is tried: the answers are those of many digits, for any stiffness and far away."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.benchmark.reference import Closest, NoReference
from duhem.law.formula_law import Criterion
from duhem.projection import newton
from duhem.projection.compiled_newton import solved_one_by_one
from duhem.projection.extended_precision import closest_beside
from duhem.projection.half_spaces import Faces, planes
from duhem.projection.increment import Increment, increment
from duhem.projection.projector import Projector
from duhem.projection.result import ACCURACY, Array, Solution, Status
from duhem.projection.scaled_formula import power_of_two
from tests.campaigns.increments import at_simplest, pressure_of, trials
from tests.long import mostly_long

NAMES = ["box", "polygon", "tresca", "mohr-coulomb", "rankine", "paul", "yu", "schmidt-ishlinsky", "mujoco-pyramidal", "antoni2007-1d"]
SKEW = Criterion("skew", "max(abs(3*a + b)/7, abs(a - 2*b)/3, a + b/5 - 1) + 1000*sigma_n", forces=("a", "b"))
THIN = Criterion("thin", "max(abs(a + b), abs(a - b)/1000000) - 1", forces=("a", "b"), pressure=None)


def stiffness(kind: str, d: int) -> Array:
    if kind == "one":
        return np.eye(d)
    spread = np.diag(np.geomspace(1.0, 1e4, d))
    return spread if kind == "apart" else spread + 0.3 * (np.ones((d, d)) - np.eye(d))


def asked(law: Criterion, kind: str, far: float, count: int = 60) -> Increment:
    every = trials(law, 40)
    some = np.random.default_rng(0).permutation(len(every))[:count]
    return increment(law, far * every[some], pressure_of(law), stiffness(kind, len(law.forces)), None)


def in_many_digits(question: Increment, found: Solution) -> Iterator[tuple[Array, Array]]:
    """Stress and slip of each increment; in three bounded directions by half-spaces found beside the answer, in 1,600 bits."""
    law = question.law
    symbol = law.symbols()[law.pressure] if law.pressure else None
    try:
        exact = Closest(question.g, law.force_symbols(), symbol, question.stiffness.tolist(), 40)
        exact(question.trial[0].tolist(), float(question.pressure[0]) if law.pressure else None)
    except NoReference:
        beside = closest_beside(question, found, found.multiplier, power_of_two(np.abs(question.trial).max(axis=1)), patient=True)
        assert None not in beside
        yield from ((point.stress, point.slip) for point in beside if point is not None)
        return
    for trial, pressure in zip(question.trial.tolist(), question.pressure.tolist(), strict=True):
        right = exact(trial, pressure if law.pressure else None)
        yield np.array([float(x) for x in right.stress]), np.array([float(x) for x in right.slip])


LAWS = {**{name: at_simplest(name) for name in NAMES}, "skew": SKEW, "thin": THIN}
KEPT = [("tresca", 1.0, "coupled"), ("skew", 1e6, "apart"), ("thin", 1.0, "coupled"), ("box", 1e6, "one")]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "far", "kind"), mostly_long(product(LAWS, [1.0, 1e6], ["one", "apart", "coupled"]), *KEPT))
def test_the_closest_points_are_those_of_many_digits(name: str, far: float, kind: str) -> None:
    question = asked(LAWS[name], kind, far, 24)
    assert planes(question) is not None
    found = newton.search(question)
    assert not found.failed.any()
    for i, (stress, slip) in enumerate(in_many_digits(question, found)):
        size = np.abs(question.trial[i]).max()
        assert np.abs(found.stress[i] - stress).max() <= 4e-15 * size
        assert np.abs(found.slip[i] - slip).max() <= 1e-11 * np.abs(slip).max() + 1e-15 * size / question.stiffness.max()


@pytest.mark.parametrize("name", ["box", "tresca", "mohr-coulomb"])
def test_few_points_and_many_are_answered_alike(name: str) -> None:
    """The loop of few points follows an active set, and shares nothing with the sets that are tried."""
    question = asked(at_simplest(name), "coupled", 1.0)
    many, (few, left) = newton.search(question), solved_one_by_one(question)
    assert not left.size
    for one, other in ((many.stress, few.stress), (many.slip, few.slip)):
        assert one == pytest.approx(other, rel=1e-12, abs=1e-13)
    done = duhem.project(question.law, question.trial, pressure_of(question.law), question.stiffness)
    assert (done.status <= Status.SLIP).all() and (done.residuals.worst() <= ACCURACY).all()


def test_a_row_has_the_same_digits_with_others_beside_it() -> None:
    question = asked(at_simplest("mohr-coulomb"), "coupled", 1.0)
    whole = newton.search(question)
    for rows in (slice(0, 1), slice(7, 40)):
        part = newton.search(replace(question, trial=question.trial[rows], pressure=question.pressure[rows]))
        for name in ("stress", "slip", "multiplier"):
            assert (getattr(part, name) == getattr(whole, name)[rows]).all()


def test_a_face_that_is_missing_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is wrong in the planes shows in g, which the judge asks."""
    right, question = newton.faces, asked(at_simplest("tresca"), "one", 1.0)

    def without_one(*of: object) -> Faces | None:
        known = right(*of)  # type: ignore[arg-type]
        return None if known is None else Faces(known.normals[1:], known.offsets[1:])

    monkeypatch.setattr(newton, "faces", without_one)
    alone = replace(newton.NEWTON, again=None)  # the loop of one point would find what is missing
    done = Projector.of(question.law, question.stiffness, method=alone).at(question)
    told = done.status > Status.SLIP
    assert told.any()
    monkeypatch.setattr(newton, "faces", right)
    assert done.stress[~told] == pytest.approx(newton.search(question).stress[~told], rel=1e-12)


@pytest.mark.parametrize("ratio", [1e2, 1e5, 1e8])
@pytest.mark.parametrize(("d", "pressing"), [(2, 2), (3, 2), (3, 3), (6, 4), (6, 6)])
def test_slips_of_an_edge_have_their_digits_in_every_ratio_of_stiffnesses(d: int, pressing: int, ratio: float) -> None:
    """k slip = sigma_tr - sigma in fractions: half the digits of a slip were lost where faces met, such as the tip of a polygon."""
    rng = np.random.default_rng(d + pressing)
    for _ in range(20):
        turned = np.linalg.qr(rng.normal(size=(d, d)))[0]
        k = (turned * np.geomspace(1.0, ratio, d)) @ turned.T
        normals = np.eye(d)[:pressing] + np.triu(rng.integers(-1, 2, size=(pressing, d)), 1)
        k = 0.5 * (k + k.T)
        exact = sp.Matrix(k.tolist()).applyfunc(sp.Rational)
        faces = sp.Matrix(normals.astype(int).tolist())
        weights = sp.Matrix([sp.Rational(x) for x in rng.uniform(0.1, 1.0, size=pressing) * 10.0 ** rng.uniform(-3.0, 0.0, size=pressing)])
        offsets = sp.ones(pressing, 1)
        edge = faces.T * (faces * faces.T).LUsolve(offsets)
        trial = np.array((edge + exact * faces.T * weights).T.tolist(), dtype=np.float64)
        beyond = faces * sp.Matrix([sp.Rational(x) for x in trial[0].tolist()]) - offsets
        _, slip, _, found = Faces(normals, ()).closest(trial, np.ones((1, pressing)), k)
        right = faces.T * (faces * exact * faces.T).LUsolve(beyond)
        off = sp.Matrix([sp.Rational(x) for x in slip[0].tolist()]) - right
        assert found.all()
        assert sp.sqrt((off.T * exact * off)[0] / (right.T * exact * right)[0]) <= 32 * 2.0**-52 * np.sqrt(ratio)
