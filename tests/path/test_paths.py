"""Many points at once: each is its path by itself, to the last bit; what one cannot do stops no other."""

import tracemalloc
from itertools import pairwise

import numpy as np
import pytest

import duhem
from duhem import Histories, InputError, Path, Paths, Status, simulate
from duhem.law.shapes import Disk
from duhem.path import run as runs
from duhem.path.history import Interrupted
from duhem.path.run import Run
from duhem.path.simulate import MOST_KEPT
from duhem.path.simulate import simulate as simulated

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
LAWS = {
    "antoni2007": (MU, [1.0, 2.0]),
    "antoni2007-1d": ({"mu_plus": 0.3, "mu_minus": 0.2}, 2.0),
    "capped": ({"mu": 0.3, "tau_max": 0.4}, 1.0),
    "shifted-ellipse": (None, [1.0, 2.0]),
}


def walks(n=5, m=12, d=2, seed=0):
    draw = np.random.default_rng(seed)
    return np.cumsum(draw.normal(size=(n, m, d)) * 0.15, axis=1), -draw.uniform(0.5, 2.0, size=(n, m))


def numbers(law, given):
    return {name: 0.2 - 0.05 * i for i, name in enumerate(duhem.load(law).parameters)} if given is None else given


def same(many, alone):
    return np.array_equal(many.to_array(), alone.to_array()) and many.why == alone.why


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated", "exact"])
@pytest.mark.parametrize("law", LAWS)
def test_each_point_is_its_path_by_itself(law, method):
    mu, k = LAWS[law]
    mu, d = numbers(law, mu), len(duhem.load(law).forces)
    points, load = walks(n=3, m=8, d=d)
    load = load if method != "exact" else load[:, :1]
    many = simulate(law, Paths.linear(points, pressure=load), stiffness=k, parameters=mu, method=method, substeps=2)
    for i in range(len(points)):
        path = Path.linear(points[i], pressure=load[i] if load.shape[1] > 1 else load[i, 0])
        assert same(many.history(i), simulate(law, path, stiffness=k, parameters=mu, method=method, substeps=2))
    assert (many.reached == 14).all() and many.multiplier[:, -1].any()


@pytest.mark.parametrize("stiffness", [[1.0, 2.0], [[1.0, 0.3], [0.3, 2.0]]])
def test_points_with_parameters_of_their_own(stiffness):
    points, _ = walks(n=6)
    own = {"mu_a_plus": np.array([0.2, 0.1, 0.2, 0.3, 0.4, 0.1])}
    load = np.linspace(-1.0, -2.0, 6)[:, None]
    many = simulate("antoni2007", Paths.linear(points, pressure=load), stiffness=stiffness, parameters=MU | own)
    for i, mu in enumerate(own["mu_a_plus"].tolist()):
        alone = simulate("antoni2007", Path.linear(points[i], pressure=load[i, 0]), stiffness=stiffness, parameters=MU | {"mu_a_plus": mu})
        assert same(many.history(i), alone)


@pytest.mark.slow
def test_a_law_without_closed_form_goes_by_members_too():
    points, load = walks(n=4, m=5)
    mu = {"mu_a": np.array([0.3, 0.2, 0.3, 0.2]), "mu_b": 0.3, "p": 4}
    many = simulate("superellipse", Paths.linear(points, pressure=load), stiffness=1.0, parameters=mu)
    for i in range(4):
        alone = simulate("superellipse", Path.linear(points[i], pressure=load[i]), stiffness=1.0, parameters=mu | {"mu_a": mu["mu_a"][i]})
        assert np.abs(many.history(i).to_array() - alone.to_array()).max() < 1e-15


def test_multiples_of_one_path_are_the_same_as_all_written_out():
    path = Path.random(seed=4, points=9, scale=0.3, pressure=-1.0)
    by = np.array([[0.5, 1.0], [2.0, -1.0], [1.0, 1.0]])
    spread = Paths.linear(path.values[None] * by[:, None], pressure=-1.0)
    few, all_ = (simulate("antoni2007", p, stiffness=1.0, parameters=MU) for p in (Paths.scaled(path, by), spread))
    assert np.array_equal(few.to_array(), all_.to_array())
    assert np.array_equal(few.history(2).to_array(), simulate("antoni2007", path, stiffness=1.0, parameters=MU).to_array())


def test_neither_blocks_nor_threads_nor_what_is_kept_change_a_number(monkeypatch):
    points, load = walks(n=11, m=13)
    paths, given = Paths.linear(points, pressure=load), {"stiffness": [1.0, 2.0], "parameters": MU}
    whole = simulate("antoni2007", paths, **given)
    last, third = (simulate("antoni2007", paths, keep=keep, **given) for keep in ("last", 5))
    monkeypatch.setattr(runs, "_POINTS", 3)
    heard = []
    parted = simulate("antoni2007", paths, threads=3, on_step=lambda done, all_: heard.append((done, all_)), **given)
    assert np.array_equal(whole.to_array(), parted.to_array()) and heard == [(3, 11), (6, 11), (9, 11), (11, 11)]
    assert third.knots.tolist() == [0, 5, 10, 12] and last.knots.tolist() == [0, 12]
    for part in (last, third):
        for name in ("stress", "slip", "work", "pressure", "displacement"):
            assert np.array_equal(getattr(part, name), getattr(whole, name)[:, part.knots])
    assert np.abs(last.balance[:, 1] - whole.balance.sum(axis=1)).max() < 1e-15
    assert np.abs(whole.balance).max() < 1e-15


# -- points that cannot go on ------------------------------------------------------------------------------------------

DENTED = duhem.Criterion("oval", "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + 3*sigma_a/5)", {})


@pytest.mark.slow
def test_a_point_that_is_lost_has_a_status_and_the_others_go_on():
    knots = np.array([[[0, 0], [0, 0.3], [-3, 0], [-3, 1]], [[0, 0], [0, 0.3], [0.1, 0.2], [5, 1]]], dtype=float)
    found = simulate(DENTED, Paths.linear(knots, pressure=-1.0), stiffness=1.0)
    assert found.status.tolist() == [Status.INACCURATE, Status.STATIONARY] and found.reached.tolist() == [1, 3]
    assert np.isnan(found.stress[0, 2:]).all() and np.isfinite(found.stress[1]).all()
    alone = simulate(DENTED, Path.linear(knots[1], pressure=-1.0), stiffness=1.0)
    assert np.abs(found.history(1).stress - alone.stress).max() < 1e-15
    assert len(found.history(0)) == 2 and len("".join(found.rows()).splitlines()) == 6


@pytest.mark.parametrize("method", ["implicit", "extrapolated", "exact"])
def test_numbers_beyond_double_precision_and_ranges_end_a_point_alone(method):
    law = duhem.load("coulomb").fix({"mu": "1/2"})
    law = duhem.Criterion("ranged", law.g, law.parameters, closed_form=law.closed_form, domain={"sigma_a": duhem.Domain.between(-2, 1)})
    knots = np.array([[[0, 0], [0, 0.5], [0, 1]], [[0, 0], [0, 0.5], [2, 0]], [[0, 0], [0, 0.5], [0, 1e308]]])
    found = simulate(law, Paths.linear(knots, pressure=-4.0), stiffness=4.0, method=method)
    assert found.status.tolist() == [Status.SLIP, Status.OUTSIDE, Status.FAILED] and found.reached.tolist() == [2, 1, 1]
    assert np.isnan(found.work[1:, 2]).all() and np.isfinite(found.work[:, :2]).all()


DISK = duhem.Criterion("disk", "norm(sigma_a, sigma_b) + mu*sigma_n", {"mu": duhem.Domain.between(0, 1)}, closed_form=Disk("mu"))


@pytest.mark.parametrize(
    ("law", "given"),
    [
        (DISK, {"mu": [0.3, 0.0, 0.5]}),  # one of them a point
        ("capped", {"mu": [0.3, 0.2, 0.5], "tau_max": [0.4, 0.1, 0.2]}),
        ("shifted-ellipse", {"mu_a": [0.2, 0.3, 0.1], "mu_b": 0.15, "shift": [0.05, 0.0, -0.05]}),
        ("antoni2007-1d", {"mu_plus": [0.3, 0.2, 0.1], "mu_minus": 0.2}),
    ],
)
def test_shapes_of_their_own_are_those_of_each_point_by_itself(law, given):
    draw = np.random.default_rng(6)
    d = len(duhem.load(law).forces)
    points, load = np.cumsum(draw.normal(size=(3, 6, d)) * 0.3, axis=1) * np.arange(6)[:, None], -draw.uniform(0.5, 2.0, (3, 6))
    load[:, 3] = 0.0
    found = simulated(law, Paths.linear(points, pressure=load), stiffness=1.5, parameters=given)
    for i in range(3):
        own = {name: np.broadcast_to(value, 3)[i] for name, value in given.items()}
        alone = simulated(law, Path.linear(points[i], pressure=load[i]), stiffness=1.5, parameters=own)
        assert np.array_equal(found.history(i).to_array(), alone.to_array())


# -- arguments ---------------------------------------------------------------------------------------------------------

WRONG = {
    "a shape": (lambda: Paths.linear([1.0, 2.0]), "give (N, m, d)"),
    "a number that is none": (lambda: Paths.linear([[0.0, np.nan]]), "points[0, 1] is nan"),
    "a pressure of another shape": (lambda: Paths.linear(np.zeros((3, 4, 2)), pressure=np.zeros(3)), "(3, 1)"),
    "a gap": (lambda: Paths.linear(np.zeros((2, 3)), pressure=[-1.0, 1.0, -1.0]), "pressure[1] is 1.0 > 0"),
    "no multiples": (lambda: Paths.scaled(Path.linear([0, 1]), np.ones((2, 2, 2))), "give (N,) or (N, 1)"),
    "a path in their place": (lambda: Paths.scaled([[0, 1]], [1.0]), "Path.linear"),
    "parameters for others": (lambda: _run(parameters={"mu": np.ones(4)}), "give one number, or (3,)"),
    "a parameter out of its domain": (lambda: _run(parameters={"mu": [1.0, -1.0, -2.0]}), "point 1, coulomb: mu = -1 "),
    "a parameter that no point has": (lambda: _run(parameters={"nu": [1.0, -1.0, -2.0]}), "coulomb: unknown parameter"),
    "a pressure out of its range": (lambda: _ranged([[-1, -2, -1], [-1, -3, -4]]), "pressure[1, 1] is -3.0, outside the range"),
    "a stress outside": (lambda: _run(stress=[9.0, 0.0]), "lies outside K"),
    "a stress for others": (lambda: _run(stress=np.zeros((2, 2))), "(3, 2)"),
    "no keep": (lambda: _run(keep="first"), '"last"'),
    "keep nothing": (lambda: _run(keep=0), "whole number from 1"),
    "no threads": (lambda: _run(threads=0), "whole number from 1"),
    "a start": (lambda: _run(start=simulate("coulomb", LINE, stiffness=1.0, parameters={"mu": 1})), "cannot be continued with start"),
    "keep of one": (lambda: simulate("coulomb", LINE, stiffness=1.0, parameters={"mu": 1}, keep=2), "many points"),
    "more forces": (lambda: simulate("coulomb", Paths.linear(np.zeros((3, 4))), stiffness=1.0), "1 columns"),
}
LINE = Path.linear([[0, 0], [1, 1]], pressure=-1.0)


def _run(**given):
    return simulate("coulomb", Paths.scaled(LINE, [1.0, 2.0, 3.0]), **({"stiffness": 1.0, "parameters": {"mu": 0.3}} | given))


def _ranged(pressure):
    law = duhem.Criterion("ranged", "sigma_n + abs(a)", {}, forces=("a",), domain={"sigma_n": duhem.Domain.between(-2, 0)})
    return simulated(law, Paths.linear(np.zeros((2, 3)), pressure=pressure), stiffness=1.0)


@pytest.mark.parametrize("case", WRONG)
def test_what_does_not_fit_is_said(case):
    attempt, words = WRONG[case]
    with pytest.raises(InputError) as fault:
        attempt()
    assert words in str(fault.value) and fault.value.remedy


def test_more_than_fits_is_refused_before_it_is_asked_for():
    tracemalloc.start()
    with pytest.raises(InputError, match="2 GiB are kept in memory"):
        simulate(
            "coulomb", Paths.scaled(Path.linear(np.zeros((2000, 2)), pressure=-1.0), np.ones(20_000)), stiffness=1.0, parameters={"mu": 1}
        )
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()


def test_an_array_in_a_file_is_not_read_as_a_whole(tmp_path):
    points = np.lib.format.open_memmap(tmp_path / "points.npy", mode="w+", dtype=float, shape=(3, 4, 2))
    points[:], load = walks(n=3, m=4)
    paths = Paths.linear(points, pressure=load)
    assert paths.values is points
    assert np.isfinite(simulate("antoni2007", paths, stiffness=1.0, parameters=MU).stress).all()


def test_interrupted_leaves_the_points_that_are_done(monkeypatch):
    monkeypatch.setattr(runs, "_POINTS", 2)
    points, load = walks(n=7)
    paths, given = Paths.linear(points, pressure=load), {"stiffness": 1.0, "parameters": MU}

    def stop(done, all_):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="4 points") as stopped:
        simulate("antoni2007", paths, on_step=stop, **given)
    whole = simulate("antoni2007", paths, **given)
    assert isinstance(stopped.value.history, Histories)
    assert np.array_equal(stopped.value.history.to_array(), whole.to_array(slice(0, 4)))


def test_the_table_holds_every_digit(tmp_path):
    points, load = walks(n=3, m=5)
    found = simulate("antoni2007", Paths.linear(points, pressure=load), stiffness=1.0, parameters=MU)
    found.to_csv(tmp_path / "h.csv")
    header, *lines = (tmp_path / "h.csv").read_text().splitlines()
    assert header == "point,time,u_a,u_b,u_in_a,u_in_b,sigma_a,sigma_b,sigma_n,lambda,psi,dissipation,work,numerical,balance"
    read = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    assert np.array_equal(read, found.to_array()) and lines[5].startswith("1,0.0,")


@pytest.mark.slow
def test_blocks_are_whole_and_never_empty():
    for n, m in ((1, 2), (4031, 5), (8065, 5), (100, 300_000)):
        paths = Paths.scaled(Path.linear(np.zeros(m)), np.ones(n))
        line = duhem.Criterion("line", "abs(sigma) - 1", {}, forces=("sigma",), pressure=None)
        made = runs.Batch.of(Run(line, paths, stiffness=1.0))
        blocks = made.blocks()
        assert blocks[0][0] == 0 and blocks[-1][1] == n and all(a[1] == b[0] for a, b in pairwise(blocks))
        assert all((last - first) * made.numbers <= runs._NUMBERS for first, last in blocks)
    assert MOST_KEPT == 1 << 28
