"""Isotropic laws of six stresses, solved in their principal stresses, against many digits and against the loop of six stresses."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from mpmath import MPContext

import duhem
from duhem.projection.increment import increment
from duhem.projection.projector import principal
from duhem.projection.result import Status

mp = MPContext()
mp.dps = 50
PLACES = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
ORDER = duhem.load("tresca-tensor").forces
ENTRY = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "yz": (1, 2), "xz": (0, 2), "xy": (0, 1)}
PLACE = [ENTRY[name[-2:]] for name in ORDER]
LAME = (0.0, 3.0)  # the second modulus over twice the shear modulus


def stiffness(bulk: float) -> np.ndarray:
    """Isotropic, of the shear modulus 1/2."""
    k = np.diag([1.0 if i == j else 0.5 for i, j in PLACE])
    k[:3, :3] += bulk
    return k


def faces(name: str) -> tuple[list[tuple[object, ...]], object]:
    """Normals in principal stresses and the height of all faces, in many digits."""
    phi = mp.mpf(0.6)
    up, down, height = (1, 1, mp.mpf(1)) if name == "tresca-tensor" else ((1 + mp.sin(phi)) / 2, (1 - mp.sin(phi)) / 2, mp.cos(phi))
    normals = [[0, 0, 0] for _ in range(6)]
    for normal, (i, j) in zip(normals, [(i, j) for i in range(3) for j in range(3) if i != j], strict=True):
        normal[i], normal[j] = up, -down
    return [tuple(n) for n in normals], height


def closest(name: str, trial: np.ndarray, bulk: float) -> tuple[list[object], list[object]]:
    """Stress and slip by every set of faces in principal stresses, in fifty digits."""
    tensor = mp.matrix(3)
    for x, (i, j) in zip(trial, PLACE, strict=True):
        tensor[i, j] = tensor[j, i] = mp.mpf(float(x))
    values, axes = mp.eigsy(tensor)
    normals, height = faces(name)
    k = mp.matrix([[mp.mpf(bulk) + (i == j) for j in range(3)] for i in range(3)])
    slip = mp.matrix(3, 1)
    if max(sum(n[i] * values[i] for i in range(3)) for n in normals) > height:
        slip = next(w for w in map(lambda some: pushed(some, values, k, height, normals), sets(normals)) if w is not None)
    stress = mp.matrix([values[i] for i in range(3)]) - k * slip
    out = []
    for own, shear in ((stress, 1), (slip, 2)):
        full = axes * mp.diag(list(own)) * axes.T
        out.append([full[i, j] * (1 if i == j else shear) for i, j in PLACE])
    return out[0], out[1]


def sets(normals):
    return [some for count in (1, 2, 3) for some in combinations(normals, count)]


def pushed(some, values, k, height, normals):
    """The slip along these faces, None where it is not the closest point's."""
    n = mp.matrix([list(row) for row in some])
    gram = n * k * n.T
    if abs(mp.det(gram)) < mp.mpf(10) ** -40:
        return None
    t = mp.matrix([values[i] for i in range(3)])
    weights = mp.lu_solve(gram, n * t - mp.matrix([height] * len(some)))
    s = t - k * (n.T * weights)
    tiny = mp.mpf(10) ** -30 * (1 + max(map(abs, t)))
    right = min(weights) > 0 and max(sum(a * b for a, b in zip(row, s, strict=True)) for row in normals) <= height + tiny
    return n.T * weights if right else None


def drawn(seed: int, count: int) -> np.ndarray:
    """Trials: by chance, with equal principal stresses, near and far, beside the boundary, along axes."""
    draw = np.random.default_rng(seed)
    turn = np.linalg.qr(draw.normal(size=(count, 3, 3)))[0]
    values = draw.normal(size=(count, 3))
    alike = draw.integers(0, 4, count)
    values[alike == 1, 1] = values[alike == 1, 0]
    values[alike == 2] = values[alike == 2, :1] * [1, 1, 1] + 1e-9 * values[alike == 2]
    values *= 10.0 ** draw.choice([0, 0, 1, 2, 3, 5, 8], (count, 1))
    turn[draw.random(count) < 0.2] = np.eye(3)
    full = np.einsum("nij,nj,nkj->nik", turn, values, turn)
    return np.array([[x[i, j] for i, j in PLACE] for x in full])


@pytest.mark.parametrize("bulk", LAME)
@pytest.mark.parametrize("name", ["tresca-tensor", "mohr-coulomb-tensor"])
def test_many_digits_agree(name: str, bulk: float) -> None:
    trial = drawn(int(10 * bulk), 20)
    ended = duhem.project(name, trial[:10], stiffness=stiffness(bulk), parameters={"s0" if name[0] == "t" else "c": 1.0})
    edge = trial[:10] - ended.slip @ stiffness(bulk) * (1.0 - np.resize([1e-13, 1e-9, 1e-5], 10))[:, None]  # beside the boundary
    trial = np.vstack([trial, edge])
    done = duhem.project(name, trial, stiffness=stiffness(bulk), parameters={"s0" if name[0] == "t" else "c": 1.0})
    flagged = 0
    for i, x in enumerate(trial):
        stress, slip = closest(name, x, bulk)
        far_stress, far_slip = (
            float(max(abs(mp.mpf(float(a)) - b) for a, b in zip(own, exact, strict=True)) / max(max(map(abs, exact)), mp.mpf("1e-300")))
            for own, exact in ((done.stress[i], stress), (done.slip[i], slip))
        )
        if done.status[i] in (Status.INACCURATE, Status.FAILED):
            flagged += 1
        else:
            assert far_stress <= 1e-7, (i, x.tolist())
            assert far_slip <= 1e-6 or done.status[i] == Status.STICK, (i, x.tolist())
    assert flagged <= 2  # beside the boundary of a trial that is 1e7 times as large as K, or of an edge


@pytest.mark.parametrize("name", ["hosford-tensor", "tresca-tensor", "mohr-coulomb-tensor"])
def test_the_loop_of_six_stresses_agrees(name: str) -> None:
    law = duhem.load(name)
    trial = np.random.default_rng(3).normal(size=(60, 6)) * np.resize([0.3, 1.0, 3.0, 30.0, 1e4, 1e9], (60, 1))
    own = {"m": 8.0} if "m" in law.parameters else {}
    values = {n: 1.0 for n in law.parameters} | own | ({"phi": 0.6} if "phi" in law.parameters else {})
    done = duhem.project(law, trial, parameters=values, tangent=True)
    for i, x in enumerate(trial):
        one = duhem.prepare(law, parameters=values)(x)
        assert one.status == done.status[i]
        assert np.abs(one.stress - done.stress[i]).max() <= 1e-11 * np.abs(one.stress).max()
        assert np.abs(one.slip - done.slip[i]).max() <= 1e-11 * np.abs(one.slip).max()


def test_what_is_not_isotropic_is_not_reduced() -> None:
    def asked(g: str, k: object = 1.0) -> object:
        law = duhem.Criterion("own", g, stress={"name": "sigma", "kind": "3d"}, pressure=None)
        return principal(increment(law, np.ones((1, 6)), None, k, {}))

    assert asked("principal(sigma, 1) - 1") is not None
    assert asked("principal(sigma, 1) - principal(sigma, 2)/2 - 1", stiffness(0.5)) is not None
    assert asked("principal(sigma, 1) + sigma_xy - 1") is None
    assert asked("principal(sigma, 1) + sigma_xx - 1") is None
    assert asked("eigmax(sigma_xx, sigma_yy, 2*sigma_zz, sigma_yz, sigma_xz, sigma_xy) - 1") is None
    assert asked("eigmax(sigma_xx, sigma_zz, sigma_yy, sigma_yz, sigma_xz, sigma_xy) - 1") is not None  # of a matrix of its own
    assert asked("sqrt(J2(sigma)) - 1") is None
    assert asked("principal(sigma, 1) - 1", np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 1.0])) is None
    assert asked("principal(sigma, 1) - 1", np.diag([1.0, 2.0, 1.0, 0.5, 0.5, 0.5])) is None


@pytest.mark.parametrize(("bulk", "shear"), [(1e15, 1.0), (1e13, 0.51), (1e12, 0.502), (1e11, 0.5002), (1e10, 0.50002), (1e9, 0.500002)])
def test_a_great_bulk_does_not_hide_that_the_shear_is_not_isotropic(bulk: float, shear: float) -> None:
    """One rounding of the greatest entry is more than all of the shear there."""
    k, trial = stiffness(bulk), np.array([3.0, 1.0, 0.0, 0.3, 0.2, 2.0])
    k[5, 5] = shear
    law = duhem.Criterion("own", "principal(sigma, 1) - principal(sigma, 3) - 1", stress={"name": "sigma", "kind": "3d"}, pressure=None)
    assert principal(increment(law, trial, None, k, {})) is None
    done = duhem.project(law, trial, stiffness=k)
    moved = (trial - done.stress[0])[3:] / np.diag(k)[3:]
    assert done.status[0] in (Status.INACCURATE, Status.FAILED) or np.abs(done.slip[0][3:] - moved).max() <= 1e-9


def test_values_of_parameters_are_exact_in_principal_stresses_too() -> None:
    """a - b is 1/3e15, and the double of 1/3 is not 1/3."""
    stress = {"name": "sigma", "kind": "3d"}
    law = duhem.Criterion(
        "own", "principal(sigma, 1) - principal(sigma, 3) - (a - b)", dict.fromkeys("ab", duhem.POSITIVE), stress=stress, pressure=None
    )
    trial, values = np.array([3.0, 1.0, 0.0, 0.3, 0.2, 2.0]) / 3e15, {"a": "1/3", "b": "0.333333333333333"}
    done = duhem.project(law, trial, stiffness=1.0, parameters=values)
    same = duhem.project("tresca-tensor", trial * 3e15, stiffness=1.0, parameters={"s0": 1.0})
    assert done.status[0] == Status.SLIP
    assert np.abs(done.stress * 3e15 - same.stress).max() <= 1e-12


@pytest.mark.parametrize("domain", [duhem.Domain.between("1/3", "1/2"), duhem.Domain.between("1/4", "1/3")])
def test_a_value_at_an_end_of_its_range_that_no_double_has_stays_in_it(domain: duhem.Domain) -> None:
    law = duhem.Criterion(
        "own", "principal(sigma, 1) - principal(sigma, 3) - m", {"m": domain}, stress={"name": "sigma", "kind": "3d"}, pressure=None
    )
    assert duhem.project(law, [3.0, 1.0, 0.0, 0.3, 0.2, 2.0], stiffness=1.0, parameters={"m": "1/3"}).status[0] == Status.SLIP


def test_trials_at_the_end_of_double_precision_spoil_no_other_row() -> None:
    trial = [[1e308, -1e308, 0.0, 1e308, 0.0, 1e308], [3.0, 1.0, 0.0, 0.3, 0.2, 2.0]]
    done = duhem.project("tresca-tensor", trial, stiffness=1.0, parameters={"s0": 1e306})
    assert done.status.tolist() == [Status.FAILED, Status.STICK]
    assert duhem.project("tresca-tensor", [1e307, 0, 0, 0, 0, 0], stiffness=1.0, parameters={"s0": 1e306}).status[0] == Status.SLIP


def test_a_cone_without_a_size_or_a_constant_has_edges_too() -> None:
    g = "3*principal(sigma, 1) - principal(sigma, 2) - 2*principal(sigma, 3)"
    law = duhem.Criterion("own", g, stress={"name": "sigma", "kind": "3d"}, pressure=None)
    done = duhem.project(law, [1.0, 1.0, 1.0, 0.0, 0.0, 1e-9], stiffness=1.0)
    assert done.status[0] != Status.STICK and np.abs(done.stress - [1, 1, 1, 0, 0, 0]).max() <= 1e-8
