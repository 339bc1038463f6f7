"""Tangents of the generic projector against differences."""

from __future__ import annotations

import numpy as np
import pytest

import duhem
from duhem.projection import newton
from duhem.projection.implicit_tangent import tangent
from duhem.projection.projector import Projector
from tests.long import long_at, long_but, mostly_long
from tests.oracles.optimality import CONVEX, R, increment

SMOOTH = [*(CONVEX[i] for i in (0, 6, 9, 10, 11, 16, 17, 24)), ("superellipse", {"mu_a": R(1, 5), "mu_b": R(1, 10), "p": R(4)})]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "values"), long_but([2, 4, 8], SMOOTH), ids=lambda x: x if isinstance(x, str) else "")
def test_tangent_against_differences(law, values):
    rng = np.random.default_rng(8)
    d = len(duhem.load(law).forces)
    q, _ = np.linalg.qr(rng.standard_normal((d, d)))
    k = (q * np.geomspace(1.0, 8.0, d)) @ q.T
    k = (k + k.T) / 2
    trial, pressure = rng.standard_normal((12, d)), -rng.uniform(0.5, 2, 12)

    def stress(move=0.0, load=0.0):
        return newton.solve(increment(law, trial + move, pressure + load, k, **values)).stress

    question = increment(law, trial, pressure, k, **values)
    of_u, of_pressure = tangent(question, newton.solve(question))
    np.testing.assert_array_equal(of_u, np.swapaxes(of_u, 1, 2))
    root = np.linalg.inv(np.linalg.cholesky(k))
    eigenvalues = np.linalg.eigvalsh(root @ of_u @ root.T)
    assert eigenvalues.min() > -1e-14 and eigenvalues.max() < 1 + 1e-14
    h = 1e-4
    for i in range(d):
        e = k[i] * h  # h along u_i
        slope = (8 * (stress(e) - stress(-e)) - (stress(2 * e) - stress(-2 * e))) / (12 * h)
        near = np.abs(slope - of_u[:, i]).max(axis=1)
        assert np.median(near) < 1e-9 and near.max() < 1e-4
    if of_pressure is None:
        assert duhem.load(law).pressure is None
        return
    slope = (8 * (stress(load=h) - stress(load=-h)) - (stress(load=2 * h) - stress(load=-2 * h))) / (12 * h)
    near = np.abs(slope - of_pressure).max(axis=1)
    assert np.median(near) < 1e-9 and near.max() < 1e-4


def test_tangent_at_corners_and_inside():
    question = increment("box", [[0.9, 0.8], [0.9, 0.1], [0.0, 0.1]], -1.0, (2.0, 3.0), mu_a=R(1, 2), mu_b=R(1, 4))
    of_u, of_pressure = tangent(question, newton.solve(question))
    np.testing.assert_allclose(of_u, [np.zeros((2, 2)), np.diag([0.0, 3.0]), np.diag([2.0, 3.0])], atol=1e-15)
    np.testing.assert_allclose(of_pressure, [[-0.5, -0.25], [-0.5, 0.0], [0.0, 0.0]], atol=1e-15)


def test_a_side_that_hardly_presses_holds_the_corner():
    """The push is normal to the other side within 1e-9, and yet the stress stays."""
    question = increment("box", [[1e4, 0.25 + 1e-5], [1e4, -0.25 - 1e-6], [1e4, 0.25 - 1e-6]], -1.0, 1.0, mu_a=R(1, 2), mu_b=R(1, 4))
    of_u, _ = tangent(question, newton.solve(question))
    np.testing.assert_allclose(of_u, [np.zeros((2, 2)), np.zeros((2, 2)), np.diag([0.0, 1.0])], atol=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mujoco-pyramidal", "rankine"])
def test_a_tip_under_more_normals_than_the_push_needs_stays(name: str) -> None:
    """|a| + |b| + |c| <= 1 pushed along an axis: two of the four normals at the tip make the push, and none lets it go."""
    law = duhem.load(name)
    values = {p: 1 for p, domain in law.parameters.items() if domain.value is None}
    trial = {"mujoco-pyramidal": [0.0, 2.0, 0.0], "rankine": [1.5, 1.5, 1.5]}[name]
    done = duhem.project(law, trial, -1.0 if law.pressure else None, parameters=values, tangent=True)
    assert done.tangent is not None
    np.testing.assert_allclose(done.tangent[0], 0.0, atol=1e-12)
    shifted = duhem.project(law, np.array(trial) + 1e-3 * np.eye(3), -1.0 if law.pressure else None, parameters=values)
    np.testing.assert_allclose(shifted.stress, np.tile(done.stress, (3, 1)), atol=1e-12)


def _differences(law, trial, h=1e-5):
    """d sigma/d u for k = 1, from both sides."""
    d, load = len(law.forces), -1.0 if law.pressure else None
    moved = duhem.project(law, trial + h * np.vstack([np.eye(d), -np.eye(d)]), load, np.ones(d)).stress
    return (moved[:d] - moved[d:]).T / (2 * h)


@pytest.mark.slow
@pytest.mark.parametrize("m", mostly_long([2, 6, 8], 8))
@pytest.mark.parametrize(
    ("principal",), long_but([1, 3], zip([(3.0, 0.0, 0.0), (2.0, 2.0, -1.0), (5.0, 5.0, 2.5), (2.0, 2.0 + 1e-9, -1.0)]))
)
def test_equal_principal_stresses_are_no_kink_of_a_smooth_law(m, principal):
    law = duhem.load("hosford-tensor").fix({"m": m, "s0": 1})
    q, _ = np.linalg.qr(np.random.default_rng(4).standard_normal((3, 3)))
    for turn in (np.eye(3), q):
        s = (turn * np.array(principal)) @ turn.T
        trial = np.array([s[0, 0], s[1, 1], s[2, 2], (s[1, 2] + s[2, 1]) / 2, (s[0, 2] + s[2, 0]) / 2, (s[0, 1] + s[1, 0]) / 2])
        done = duhem.project(law, trial, None, np.ones(len(trial)), tangent=True)
        assert done.tangent is not None and done.status[0] == duhem.Status.SLIP
        np.testing.assert_allclose(done.tangent[0], _differences(law, trial), atol=2e-5)
        if m == 2:
            np.testing.assert_allclose(done.tangent, duhem.project(VON_MISES, trial, None, np.ones(6), tangent=True).tangent, atol=1e-8)


VON_MISES = duhem.Criterion(
    name="x", g="(s_xx - s_yy)**2 + (s_yy - s_zz)**2 + (s_zz - s_xx)**2 + 6*(s_yz**2 + s_xz**2 + s_xy**2) - 2",
    stress={"name": "s", "kind": "3d"}, pressure=None,
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "trial"),
    long_but(
        [1],
        [
            ("yld89", {"M": 2}, [1.05, 1.05, 0.0]),
            ("wiebols-cook", {"C": -1}, [-0.7, -0.7, -0.7]),
            pytest.param("menetrey-willam", {"e": "13/25"}, [0.2, 0.2, 0.2], marks=pytest.mark.long),
            ("nova-montrasio", {}, [-0.6, 0.0, 0.0]),
        ],
    ),
)
def test_at_a_zero_of_a_norm_the_tangent_is_that_of_the_answers(name, values, trial):
    """The norm's square is smooth there; a tip stays where it is, whether it lies between normals or has the push along its axis."""
    law = duhem.load(name)
    law = law.fix({p: values.get(p, 1) for p in law.parameters})
    done = duhem.project(law, trial, None, np.ones(len(trial)), tangent=True)
    assert done.tangent is not None
    np.testing.assert_allclose(done.tangent[0], _differences(law, np.array(trial)), atol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("push",), long_at([1], zip([(2.0, 0.0), (1.5, 0.3), (1.5, -0.3)])))
def test_a_tip_moves_with_the_pressure(push):
    """A cone about the axis of a, whose tip is at a = -sigma_n."""
    law = duhem.Criterion(name="x", g="norm(a + sigma_n, b, c) + 2*(a + sigma_n)", forces=("a", "b", "c"), pressure="sigma_n")
    done = duhem.project(law, [1.0 + push[0], push[1], 0.0], -1.0, tangent=True)
    assert done.tangent is not None and done.tangent_pressure is not None
    np.testing.assert_allclose(done.stress[0], [1.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(done.tangent[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(done.tangent_pressure[0], [-1.0, 0.0, 0.0], atol=1e-6)


@pytest.mark.slow
def test_an_edge_of_equal_principal_stresses_has_no_tangent_that_is_known():
    law = duhem.load("tresca-tensor").fix({"s0": 1})
    done = duhem.project(law, [2.0, 1.9, 0.0, 0.0, 0.0, 0.0], tangent=True)  # on the edge s1 = s2
    assert done.tangent is not None and np.isnan(done.tangent).all()


def test_a_vertex_of_equal_principal_stresses_turns_with_the_trial():
    """All three principal stresses are held there, and their axes are not: the tangent is not 0."""
    g = "max(principal(sigma, 1) - 3/5, principal(sigma, 1) - principal(sigma, 3) - 1)"
    law = duhem.Criterion("own", g, stress={"name": "sigma", "kind": "3d"}, pressure=None)
    done = duhem.project(law, [6.0, 5.0, -2.0, 0.2, 0.3, 0.4], stiffness=1.0, tangent=True)
    assert done.tangent is not None and np.isnan(done.tangent).all()


@pytest.mark.long
def test_all_faces_of_a_vertex_in_six_forces_hold_it():
    law = duhem.load("schmid-fcc").fix({"tc": 1})
    trial = np.array([2.5719642299223375, 0.0, 0.0, 0.0, 0.0, 0.0])
    done = duhem.project(law, trial, None, np.ones(len(trial)), tangent=True)
    assert done.tangent is not None
    np.testing.assert_allclose(done.tangent[0], _differences(law, trial), atol=1e-8)


AT_NOTHING = [
    (name, {}) for name in ("antoni2007", "antoni2007-1d", "capped", "coulomb", "orthotropic", "shifted-ellipse", "regularised")
] + [("box", {}), ("box", {"mu_a": 710, "mu_b": 0.71}), ("box", {"mu_a": 0.71, "mu_b": 710}), ("polygon", {}), ("superellipse", {"p": 4})]
AT_NOTHING += [("limacon", {"e": 0.5}), ("lobes", {"e": 0.1}), ("matchstick", {"mu_a": 1, "mu_b": 1.4}), ("quartic", {"c": 2})]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values"), mostly_long(AT_NOTHING, *(AT_NOTHING[i] for i in (1, 3, 8, 11))), ids=str)
@pytest.mark.parametrize("coupled", long_but([0], [0.0, 3.0]))
def test_without_pressure_k_is_a_point_and_the_tangent_none(name, values, coupled):
    """The answers around say so too; with the pressure they move to one side, by the given rate where there is one."""
    law = duhem.load(name)
    open_ = [p for p, domain in law.parameters.items() if domain.value is None]
    values = {p: values.get(p, 0.25 if p == "shift" else 0.5 - 0.1 * i) for i, p in enumerate(open_)}
    d = len(law.forces)
    trial = np.vstack([np.zeros(d), 88 * np.eye(d), -3 * np.eye(d), np.random.default_rng(0).standard_normal((2, d))])
    if d == 2:
        trial = np.vstack([trial, [88.0, 1.0], [88.0, -3.0]])
    k, told = 10 * np.eye(d) + coupled, 0
    for method in ("closed-form", "newton"):
        if method == "closed-form" and law.closed_form is None:
            continue
        step = Projector.of(law, k, values, method)
        done = step(trial, np.zeros(len(trial)), tangent=True)
        assert not done.tangent.any(), (method, done.tangent)
        for move in 1e-3 * k:
            assert not step(trial + move, np.zeros(len(trial))).stress.any()
        h = 1e-9 * np.ones(len(trial))
        known = np.isfinite(done.tangent_pressure).all(axis=1)
        np.testing.assert_allclose(done.tangent_pressure[known], (step(trial, -h).stress / -h[:, None])[known], rtol=1e-6, atol=1e-6)
        told += known.sum()
    assert told > 0


def _segment(sides):
    return duhem.Criterion("thin", sides, forces=("sigma_a", "sigma_b"), pressure=None)


@pytest.mark.parametrize("sides", ["max(abs(sigma_a) - 1, abs(sigma_b))", "max(abs(sigma_a)/710 - 1/710, abs(sigma_b)/0.71)"])
def test_the_end_of_a_segment_holds_what_is_pushed_past_it(sides):
    done = duhem.project(
        _segment(sides), [[3.0, 0.0], [3.0, 1e-3], [0.5, 2.0], [0.5, -2.0]], None, (2.0, 3.0), method="newton", tangent=True
    )
    expected = [np.zeros((2, 2)), np.zeros((2, 2)), np.diag([2.0, 0.0]), np.diag([2.0, 0.0])]
    np.testing.assert_allclose(done.tangent, expected, atol=1e-12)


WIDE = [
    ("box", {"mu_a": 0.3, "mu_b": 0.35}, [1.0, 0.1]),
    ("box", {"mu_a": 0.3, "mu_b": 0.35}, [3.0, -4.6]),
    ("coulomb", {"mu": 0.3}, [1.0, 0.1]),
    ("superellipse", {"mu_a": 0.3, "mu_b": 0.2, "p": 4}, [1.0, 0.3]),
    ("antoni2007", {"mu_a_plus": 0.2, "mu_a_minus": 0.15, "mu_b_plus": 0.1, "mu_b_minus": 0.12}, [1.0, 0.3]),
]


@pytest.mark.parametrize("scale", [1e-290, 1e-155, 1e155, 1e290])
@pytest.mark.parametrize(("name", "values", "trial"), WIDE)
def test_a_tangent_is_the_same_at_stresses_of_any_size(name: str, values: dict[str, float], trial: list[float], scale: float) -> None:
    """A square of such a stress is beyond doubles: none passes for a stress that does not slip."""
    near, far = (
        duhem.project(name, np.tile(trial, (2, 1)) * size, -size, 2.0, values, method="newton", tangent=True) for size in (1.0, scale)
    )
    assert near.tangent is not None and far.tangent is not None
    np.testing.assert_allclose(far.tangent, near.tangent, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(far.tangent_pressure, near.tangent_pressure, rtol=1e-9, atol=1e-9)
