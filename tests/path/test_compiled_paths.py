"""Compiled steps against NumPy's.  The loop on intervals is compiled in seconds; those on ellipses are further cases."""

from inspect import signature

import numpy as np
import pytest

import duhem
from duhem import Criterion, Domain, InputError, Path, Paths, Status, simulate
from duhem.path.compiled_run import Loops, loops, made

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
SHIFTED = {"mu_a": 0.2, "mu_b": 0.15, "shift": 0.1}
COUPLED = [[1.0, 0.3], [0.3, 2.0]]


def cases():
    draw = np.random.default_rng(2)
    n, m = 600, 12  # more points than are taken abreast, by no whole number
    points = np.cumsum(draw.normal(size=(n, m, 2)) * 0.12, axis=1)
    load = -draw.uniform(0.5, 2.0, size=(n, m))
    load[::3, 4:7] = 0.0  # contact lost and regained
    far = points.copy()
    far[7, 5:] = 1e308
    own = {"mu_a_plus": draw.choice([0.1, 0.2, 0.3], n)}
    line = {"mu_plus": 0.3, "mu_minus": draw.choice([0.2, 0.25], n)}
    yield "antoni2007", Paths.linear(points, pressure=load), MU, [1.0, 2.0]
    yield "antoni2007", Paths.scaled(Path.linear(points[0], pressure=load[0]), draw.normal(size=n)), MU, [1.0, 2.0]
    yield "antoni2007", Paths.linear(points[:50], pressure=load[:50]), MU, COUPLED
    yield "antoni2007", Paths.linear(far, pressure=-1.0), MU, [4.0, 2.0]
    yield "antoni2007", Paths.linear(points, pressure=load), MU | own, [1.0, 2.0]
    yield "shifted-ellipse", Paths.linear(points, pressure=load), SHIFTED, [1.0, 2.0]
    yield "shifted-ellipse", Paths.linear(points[:20], pressure=load[:20, :1]), SHIFTED, COUPLED
    yield "capped", Paths.linear(points, pressure=load), {"mu": 0.3, "tau_max": 0.4}, 1.0
    yield "antoni2007-1d", Paths.linear(points[..., 0], pressure=load), line, 2.0


def same(found, right):
    a, b = found.to_array(), right.to_array()
    return np.array_equal(np.isnan(a), np.isnan(b)) and np.nanmax(np.abs(a - b)) < 1e-13 * np.nanmax(np.abs(b))


def check(law, paths, mu, k):
    """Many points, in two threads too, and one of them alone, whole and from a start."""
    given = {"stiffness": k, "parameters": mu, "substeps": 2}
    fast, right = (simulate(law, paths, keep=3, compiled=compiled, **given) for compiled in (True, False))
    assert same(fast, right) and fast.why.endswith("compiled") and np.array_equal(fast.reached, right.reached)
    assert (fast.status != right.status).sum() <= 2  # on the boundary to rounding
    assert np.array_equal(fast.to_array(), simulate(law, paths, keep=3, compiled=True, threads=2, **given).to_array(), equal_nan=True)
    if (right.status == Status.FAILED).any():
        return
    given["parameters"] = {name: np.atleast_1d(value)[0] for name, value in mu.items()}
    path = paths.path(0)
    one = simulate(law, path, compiled=True, **given)
    assert same(one, simulate(law, path, **given)) and one.why.endswith("compiled")
    part = simulate(law, Path(path.values[:7], None if path.pressure is None else path.pressure[:7], path.time[:7]), **given)
    assert np.abs(simulate(law, path, compiled=True, start=part, **given).to_array() - one.to_array()).max() < 1e-13


@pytest.mark.slow
def test_compiled_steps_on_intervals_are_those_of_numpy(monkeypatch):
    pytest.importorskip("numba")
    (case,) = (case for case in cases() if case[0] == "antoni2007-1d")
    check(*case)
    given = {"stiffness": 2.0, "parameters": {"mu_plus": 0.3, "mu_minus": 0.2}, "compiled": True}
    with pytest.raises(InputError, match="overflow or underflow") as left:
        simulate("antoni2007-1d", Path.linear([0, 1, 1e308], pressure=-1.0), **given)
    assert len(left.value.history) == 2
    path = Path.random(seed=1, points=11, dimension=1, pressure=-1.0)
    whole = simulate("antoni2007-1d", path, **given)
    monkeypatch.setattr("duhem.path.compiled_run._STEPS", 3)
    assert np.array_equal(simulate("antoni2007-1d", path, **given).to_array(), whole.to_array())


@pytest.mark.long
@pytest.mark.slow
def test_compiled_steps_on_ellipses_are_those_of_numpy():
    pytest.importorskip("numba")
    for case in cases():
        if case[0] != "antoni2007-1d":
            check(*case)


@pytest.mark.slow
def test_what_is_not_compiled_says_so_or_runs_as_it_did():
    path = Path.linear([[0, 0], [1, 1]], pressure=-1.0)
    ranged = duhem.load("coulomb").fix({"mu": "1/2"})
    ranged = Criterion("ranged", ranged.g, ranged.parameters, closed_form=ranged.closed_form, domain={"sigma_a": Domain.between(-2, 1)})
    for law, mu, method, words in [
        ("coulomb", {"mu": 0.3}, "exact", "a single exact path"),
        (ranged, {}, "implicit", "a range of stresses"),
    ]:
        with pytest.raises(InputError, match=words) as fault:
            simulate(law, path, stiffness=1.0, parameters=mu, method=method, compiled=True)
        assert fault.value.where == "compiled"
    many = Paths.scaled(path, [1.0, 2.0])
    found = simulate(ranged, many, stiffness=1.0, compiled=True)
    assert np.array_equal(found.to_array(), simulate(ranged, many, stiffness=1.0).to_array()) and "compiled" not in found.why


def test_what_is_kept_hands_on_what_the_loops_take() -> None:
    pytest.importorskip("numba")
    for name in Loops.__dataclass_fields__:
        kept, own = (signature(getattr(each, name)).parameters for each in (loops(), made()))
        assert len(kept) == len(own)
        assert [x for x, y in zip(kept, own, strict=True) if x != y] in ([], ["shape"])
