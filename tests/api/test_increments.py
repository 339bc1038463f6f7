"""A slip is called the closest point only where K is shown to be convex; elsewhere it is stationary, and held against nearer points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Convexity
from duhem.projection.projector import Projector
from duhem.projection.result import ACCURACY, Status
from tests.long import long_but, mostly_long
from tests.oracles.drawn_sets import CONVEX, GRID, IN_SPACE, NAMES, NOT_CONVEX, law, oval_of

OVAL = Criterion(
    "oval", "norm(sigma_a, sigma_b)**2 - mu*abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)", {"mu": duhem.POSITIVE, "e": duhem.REAL}
)
DENT, FRONT = [-3.0, 0.0], [3.0, 0.0]


@pytest.mark.slow
@pytest.mark.parametrize("family", mostly_long(NOT_CONVEX, "ovals", "flowers"))
def test_where_k_is_not_convex_no_slip_is_called_one(family: str) -> None:
    rng = np.random.default_rng(11)
    farther = 0
    for _ in range(2):
        g, edge = NOT_CONVEX[family](rng)
        trial = rng.normal(size=(40, 2)) * 2.0
        trial[:3, 0] = trial[3:6, 1] = 0.0
        done = duhem.project(law(g), trial)
        away = np.linalg.norm(trial - done.stress, axis=1)
        nearest = np.array([np.linalg.norm(edge - u, axis=1).min() for u in trial])
        assert not (done.status == Status.SLIP).any()
        assert (away[done.status == Status.STATIONARY] <= nearest[done.status == Status.STATIONARY] + GRID).all()
        said = done.residuals.stationary_only()
        assert (done.status[said] == Status.INACCURATE).all()
        assert (away[said] > nearest[said]).all()  # no alarm without a nearer point
        farther += int(said.sum())
    assert farther > 0


@pytest.mark.slow
@pytest.mark.parametrize("d", mostly_long([3, 4, 6], 3))
@pytest.mark.parametrize("family", mostly_long(IN_SPACE, "ovals", "cassini"))
def test_the_same_in_more_forces(family: str, d: int) -> None:
    rng = np.random.default_rng(d)
    g, apart = IN_SPACE[family](rng, d)
    trial = rng.normal(size=(20, d)) * 1.5
    trial[:3, 1:] = 0.0
    done = duhem.project(Criterion("drawn", g, {}, forces=tuple(NAMES[:d]), pressure=None), trial)
    away, nearest = np.linalg.norm(trial - done.stress, axis=1), apart(trial)
    stationary, said = done.status == Status.STATIONARY, done.residuals.stationary_only()
    assert not (done.status == Status.SLIP).any() and stationary.sum() > 5
    assert (away[stationary] <= nearest[stationary] + GRID).all()
    assert (away[said] > nearest[said]).all()


@pytest.mark.slow
@pytest.mark.parametrize("family", CONVEX)
def test_a_convex_neighbour_slips_or_is_open_and_is_never_inaccurate(family: str) -> None:
    g, edge = CONVEX[family](np.random.default_rng(5))
    trial = np.random.default_rng(6).normal(size=(30, 2)) * 2.0
    done = duhem.project(law(g), trial)
    assert set(done.status) <= {Status.STICK, Status.SLIP, Status.STATIONARY}
    slips = done.status != Status.STICK
    nearest = np.array([np.linalg.norm(edge - u, axis=1).min() for u in trial[slips]])
    assert slips.any() and (np.linalg.norm(trial - done.stress, axis=1)[slips] <= nearest + GRID).all()


@pytest.mark.slow
@pytest.mark.parametrize("pressure", [-1e-9, -1.0, -7.3, -1e12])
@pytest.mark.parametrize(
    ("stiffness",), long_but([0], zip([((1.0, 0.0), (0.0, 1.0)), ((1.0, 0.0), (0.0, 100.0)), ((2.0, 1.0), (1.0, 3.0))]))
)
def test_a_dent_is_told_at_every_pressure_and_stiffness(pressure: float, stiffness: tuple[tuple[float, float], ...]) -> None:
    trial = np.vstack([DENT, FRONT, np.random.default_rng(8).normal(size=(20, 2)) * 2.0])
    done = duhem.project(OVAL, trial * -pressure, pressure, stiffness, parameters={"mu": 1, "e": "0.8"})
    to_length = np.linalg.inv(np.linalg.cholesky(np.array(stiffness))).T
    edge = oval_of(0.8)[1] @ to_length
    away = np.linalg.norm((trial - done.stress / -pressure) @ to_length, axis=1)
    nearest = np.array([np.linalg.norm(edge - u, axis=1).min() for u in trial @ to_length])
    slips = done.status != Status.STICK
    assert (done.status[slips] == np.where(away > nearest + GRID, Status.INACCURATE, Status.STATIONARY)[slips]).all()
    assert Status.STATIONARY in done.status and (Status.INACCURATE in done.status or stiffness[0][1])
    assert (duhem.project(OVAL, trial[:2] * -pressure, pressure, stiffness, parameters={"mu": 1, "e": "0.5"}).status == Status.SLIP).all()


@pytest.mark.parametrize("far", [1.001, 1e3, 1e9])
def test_far_and_near_trials_are_told_alike(far: float) -> None:
    """The middle of the dent is nearest within the dent's radius of curvature alone."""
    end = 0.2  # of the dent, on the axis
    done = duhem.project(OVAL, [[-end * far, 0.0]], -1.0, parameters={"mu": 1, "e": "0.8"})
    assert done.status[0] == (Status.STATIONARY if far < 1.1 else Status.INACCURATE)


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([8, 40], 8))
def test_a_superellipse_with_hollow_sides(count: int) -> None:
    star = law("sqrt(abs(a)) + sqrt(abs(b)) - 1")
    t = np.linspace(0.0, 1.0, 4001)
    corner = np.stack([t**2, (1.0 - t) ** 2], axis=1)
    edge = np.vstack([corner * sign for sign in ([1, 1], [1, -1], [-1, 1], [-1, -1])])
    trial = np.random.default_rng(2).normal(size=(count, 2))
    done = duhem.project(star, trial)
    away = np.linalg.norm(trial - done.stress, axis=1)
    nearest = np.array([np.linalg.norm(edge - u, axis=1).min() for u in trial])
    assert not (done.status == Status.SLIP).any()
    stationary = done.status == Status.STATIONARY
    assert stationary.any() and (away[stationary] <= nearest[stationary] + 1e-3).all()


@pytest.mark.slow
def test_a_point_is_told_alike_alone_and_among_others() -> None:
    trial = np.random.default_rng(4).normal(size=(12, 2)) * 2.0
    pressure = -np.random.default_rng(5).uniform(0.5, 2.0, 12)
    numbers = {"mu": 1, "e": "0.8"}
    together = duhem.project(OVAL, trial, pressure, parameters=numbers).status
    alone = [duhem.project(OVAL, u, float(p), parameters=numbers).status[0] for u, p in zip(trial, pressure, strict=True)]
    assert together.tolist() == alone


@pytest.mark.slow
def test_require_refuses_and_assume_does_not_ask() -> None:
    dented, round_ = {"mu": 1, "e": "0.8"}, {"mu": 1, "e": "0.4"}
    with pytest.raises(duhem.InputError, match=r"^convex: that K of oval is convex is refuted"):
        duhem.project(OVAL, FRONT, -1.0, parameters=dented, convex="require")
    assert duhem.project(OVAL, FRONT, -1.0, parameters=round_, convex="require").status[0] == Status.SLIP
    assert duhem.project(OVAL, FRONT, -1.0, parameters=dented, convex="assume").status[0] == Status.SLIP
    assert duhem.project(OVAL, DENT, -1.0, parameters=dented, convex="assume").status[0] == Status.INACCURATE


@pytest.mark.parametrize("convex", [None, True, "Ask", "no", ["ask"]])
def test_another_word_is_refused(convex: object) -> None:
    with pytest.raises(duhem.InputError, match="choose ask, require, assume"):
        duhem.project("coulomb", [1.0, 0.0], -1.0, parameters={"mu": 1}, convex=convex)  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_nearer_point_is_no_more_than_rounding_at_the_closest_point() -> None:
    """On a K that is shown to be convex the search finds nothing either: what it calls nearer is nearer."""
    trial = np.random.default_rng(7).normal(size=(60, 2)) * np.logspace(-3, 6, 60)[:, None]
    for g in ("abs(a)**3 + abs(b)**3 - 1", "max(a + b - 1, a - 2*b - 1, -a - 1)", "norm(a - 1/2, 5*b) - 1", "a**2 - b", "abs(a - 2*b) - 1"):
        prepared = Projector.of(law(g))
        blind = replace(prepared, setting=replace(prepared.setting, convexity=Convexity(loaded=False, unloaded=False)))
        known, asked = prepared(trial), blind(trial)
        assert (asked.residuals.variational <= ACCURACY).all()
        assert ((asked.status == Status.STATIONARY) == (known.status == Status.SLIP)).all()
