"""Paths, histories and the step-by-step integrators: energy, signs, orders of convergence, loops of known area."""

import csv
import subprocess
import sys
from importlib import import_module

import numpy as np
import pytest

import duhem
from duhem import Criterion, InputError, MissingExtraError, Path, simulate
from duhem.path import Interrupted
from duhem.path.integrators import INTEGRATORS
from tests.long import mostly_long

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
K = [1.0, 2.0]
METHODS = tuple(INTEGRATORS)


def walk(seed=3, points=12, pressure=-1.0, **options):
    path = Path.random(seed=seed, points=points, scale=0.4, pressure=pressure)
    return simulate("antoni2007", path, stiffness=K, parameters=MU, **options)


def gauge(history):
    mu = np.array([[0.2, 0.08], [0.12, 0.15]])
    return np.hypot(*(history.stress[:, i] / mu[i][(history.stress[:, i] < 0).astype(int)] for i in (0, 1)))


# -- what holds at every step -------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("pressure", [-1.0, (-2.0, -0.5)])
def test_states_stay_in_k_and_no_step_gives_energy_back(method, pressure):
    history = walk(pressure=pressure, method=method, substeps=5)
    assert (gauge(history) <= np.abs(history.pressure) * (1 + 1e-13)).all()
    assert (np.diff(history.dissipation) >= 0.0).all() and history.dissipation[-1] > 0.1
    assert (np.diff(history.multiplier) >= 0.0).all()
    assert np.allclose(history.stress, (history.displacement - history.slip) * K, rtol=0, atol=2e-15)
    assert np.allclose(history.psi, 0.5 * (history.stress**2 / K).sum(axis=1), rtol=1e-15, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "pressure"), [("implicit", -1.0), ("implicit", (-2.0, -0.5)), ("exact", -1.0), ("exact", (-2.0, -0.5))])
def test_the_energy_of_each_step_balances_to_rounding(method, pressure):
    history = walk(pressure=pressure, method=method, substeps=3)
    assert np.abs(history.balance).max() <= 1e-15
    total = history.work - (history.psi - history.psi[0]) - history.dissipation - history.numerical
    assert np.abs(total).max() <= 1e-14
    assert (history.numerical[-1] > 1e-3) == (method == "implicit")


def test_implicit_energies_are_those_of_the_states():
    h = walk(substeps=4)
    du, dslip = np.diff(h.displacement, axis=0), np.diff(h.slip, axis=0)
    slips = (dslip != 0.0).any(axis=1)
    assert 10 < slips.sum() < len(slips)
    assert np.allclose(np.diff(h.dissipation), (h.stress[1:] * dslip).sum(axis=1), rtol=1e-12, atol=1e-16)
    assert np.allclose(np.diff(h.work)[slips], (h.stress[1:] * du).sum(axis=1)[slips], rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_the_rate_does_not_matter(method):
    path = Path.random(seed=5, points=8, scale=0.4, pressure=-1.0)
    slow = Path.linear(path.values, pressure=-1.0, time=np.cumsum(np.linspace(1, 90, 9)))
    a, b = (simulate("antoni2007", p, stiffness=K, parameters=MU, method=method) for p in (path, slow))
    assert np.array_equal(a.stress, b.stress) and np.array_equal(a.slip, b.slip) and a.time[-1] != b.time[-1]


@pytest.mark.parametrize("method", METHODS)
def test_stress_and_displacement_scale_together(method):
    path = Path.random(seed=5, points=8, scale=0.4, pressure=-1.0)
    large = Path.linear(path.values * 2.0**10, pressure=-(2.0**20))
    a = simulate("antoni2007", path, stiffness=K, parameters=MU, method=method)
    b = simulate("antoni2007", large, stiffness=np.multiply(K, 2.0**10), parameters=MU, method=method)
    assert np.array_equal(a.stress * 2.0**20, b.stress)


# -- orders -------------------------------------------------------------------------------------------------------


def errors(method, steps):
    path = Path.circle(0.5, points=64, turns=1.25, pressure=-1.0)
    end = simulate("antoni2007", path, stiffness=K, parameters=MU, method="exact").stress[-1]
    found = []
    for n in steps:
        coarse = Path.circle(0.5, points=n, turns=1.25, pressure=-1.0)
        found.append(np.abs(simulate("antoni2007", coarse, stiffness=K, parameters=MU, method=method).stress[-1] - end).max())
    return np.array(found)


@pytest.mark.long
@pytest.mark.parametrize(("method", "order"), mostly_long([("implicit", 1), ("extrapolated", 2)], ("implicit", 1)))
def test_order_of_convergence(method, order):
    found = errors(method, (256, 512, 1024))
    rates = np.log2(found[:-1] / found[1:])
    assert abs(rates[1] - order) < 0.1 and abs(rates[1] - order) < abs(rates[0] - order), found


# -- one dimension ------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("plus", "minus"), [(0.3, 0.3), (0.33, 0.29), (0.5, 0.1)])
def test_area_of_a_hysteresis_loop(method, plus, minus):
    amplitude, k, load = 2.0, 3.0, 1.5
    path = Path.cycle(amplitude, cycles=2, pressure=-load)
    history = simulate("antoni2007-1d", path, stiffness=k, parameters={"mu_plus": plus, "mu_minus": minus}, method=method, substeps=64)
    turn = 64
    area = history.dissipation[-1] - history.dissipation[turn + 128]  # the second cycle
    width = plus + minus  # each way slips by 2 amplitude - width load/k, under plus one way and minus the other
    assert area == pytest.approx(width * load * (2 * amplitude - width * load / k), rel=1e-13)
    if plus == minus:
        assert area == pytest.approx(4 * plus * load * (amplitude - plus * load / k), rel=1e-13)


@pytest.mark.slow
def test_changing_pressure_along_a_line_is_exact_in_one_step():
    path = Path.random(seed=8, points=30, dimension=1, scale=2.0, pressure=(-3.0, -0.2))
    arguments = {"stiffness": 1.3, "parameters": {"mu_plus": 0.4, "mu_minus": 0.2}}
    one, many = (simulate("antoni2007-1d", path, method="exact", substeps=n, **arguments) for n in (1, 16))
    fine = simulate("antoni2007-1d", path, substeps=512, **arguments)
    assert np.abs(one.stress - many.stress[::16]).max() < 1e-14
    assert np.abs(one.dissipation - many.dissipation[::16]).max() < 1e-13
    assert np.abs(one.stress - fine.stress[::512]).max() < 1e-12
    assert abs(one.dissipation[-1] - fine.dissipation[-1]) < 1e-3


# -- paths and tables ---------------------------------------------------------------------------------------------


def test_a_history_is_a_table_that_drives_again(tmp_path):
    history = walk(substeps=2)
    history.to_csv(tmp_path / "h.csv")
    with open(tmp_path / "h.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    table = history.to_dict()
    assert list(rows[0]) == list(table) and len(rows) == len(history)
    assert all(float(row[name]) == table[name][i] for i, row in enumerate(rows) for name in table)
    again = simulate("antoni2007", Path.from_csv(tmp_path / "h.csv"), stiffness=K, parameters=MU)
    assert np.array_equal(again.stress, history.stress) and np.array_equal(again.pressure, history.pressure)


@pytest.mark.parametrize("times", [None, [0.0, 2.0, 3.0]])
def test_a_history_read_back_states_times_where_its_path_did(times, tmp_path):
    path = Path.linear([[0.0, 0.0], [1.0, 0.2], [1.0, -0.4]], pressure=-1.0, time=times)
    simulate("antoni2007", path, stiffness=K, parameters=MU).to_csv(tmp_path / "h.csv")
    again = Path.from_csv(tmp_path / "h.csv")
    assert again.timed is path.timed and np.array_equal(again.time, path.time)
    (tmp_path / "own.csv").write_text("time,u_a,u_b,sigma_n\n0,0,0,-1\n1,1,0.2,-1\n")
    own = Path.from_csv(tmp_path / "own.csv")
    assert own.timed and not Path.from_csv(tmp_path / "own.csv", time="none").timed


def test_parquet_without_pyarrow_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingExtraError, match=r"duhem\[parquet\]"):
        walk().to_parquet(tmp_path / "h.parquet")


@pytest.mark.slow
def test_plots(tmp_path):
    pytest.importorskip("matplotlib")
    walk(substeps=4).plot(tmp_path / "h.png", law=duhem.load("antoni2007"), **MU)
    assert (tmp_path / "h.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.slow
@pytest.mark.parametrize(("time", "said"), [(None, "step of the path [–]"), ([0.0, 2.0, 3.0], "time $t$ [s]")])
def test_a_picture_counts_seconds_only_where_the_path_states_times(time, said):
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    path = Path.linear([[0.0, 0.0], [0.4, 0.1], [0.1, 0.3]], pressure=-1.0, time=time)
    one = simulate("antoni2007", path, stiffness=K, parameters=MU, substeps=2)
    many = simulate("antoni2007", duhem.Paths.scaled(path, [1.0, 2.0]), stiffness=K, parameters=MU, substeps=2)
    for history in (one, many.history(1)):
        axes = Figure().subplots(1, 3)
        history.plot(axes=axes)
        assert axes[2].get_xlabel() == said


def test_refining_keeps_the_knots():
    for path in (Path.random(seed=1, points=5, pressure=-1.0), Path.circle(0.3, points=7, pressure=-1.0)):
        fine = path.refined(3)
        assert np.array_equal(fine.values[::3], path.values) and np.array_equal(fine.time[::3], path.time)
    assert np.allclose(np.hypot(*fine.values.T), 0.3, rtol=1e-15)
    assert np.array_equal(Path.random(seed=4, points=9).values, Path.random(seed=4, points=9).values)


def test_a_stress_path_inside_k_makes_no_slip_and_one_that_leaves_it_is_refused():
    stress = np.array([[0.0, 0.0], [0.1, 0.05], [-0.04, 0.1]])
    history = simulate("antoni2007", Path.linear(stress, pressure=-1.0, control="stress"), stiffness=K, parameters=MU)
    assert np.array_equal(history.stress, stress) and not history.slip.any() and not history.dissipation.any()
    assert np.allclose(history.displacement, stress / K) and np.abs(history.balance).max() < 1e-17
    with pytest.raises(InputError, match=r"lies outside K.*control=.displacement"):
        simulate("antoni2007", Path.linear(2 * stress, pressure=-1.0, control="stress"), stiffness=K, parameters=MU)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"method": "exacte"}, "unknown method"),
        ({"projection": None}, "unknown method None; choose"),
        ({"projection": 3}, "unknown method 3; choose"),
        ({"parameters": [0.1, 0.2]}, "map each name to a value"),
        ({"path": Path.linear([0.0, 1.0], pressure=-1.0)}, "1 columns"),
        ({"stress": [1.0, 0.0]}, "outside K"),
        ({"stress": [np.nan, 0.0]}, r"stress\[0\] is nan; give finite numbers"),
        ({"stiffness": -1.0}, "not positive"),
        ({"parameters": {}}, "no value"),
        ({"path": Path.linear([[0, 0], [1, 1]])}, "needs the pressure"),
        ({"substeps": 0}, "substeps"),
        ({"law": "box", "parameters": {"mu_a": 0.1, "mu_b": 0.2}, "method": "exact"}, "corner"),
        ({"law": "radial-flow", "method": "exact"}, "no method 'exact'"),
    ],
)
def test_misuse_is_named(change, message):
    given = {"law": "antoni2007", "path": Path.linear([[0, 0], [1, 1]], pressure=-1.0), "stiffness": K, "parameters": MU} | change
    with pytest.raises(InputError, match=message):
        simulate(given.pop("law"), given.pop("path"), **given)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Path.linear([1.0]),
        lambda: Path.linear([0, np.inf]),
        lambda: Path.linear([0, 1], pressure=2.0),
        lambda: Path.linear([0, 1], time=[1, 1]),
        lambda: Path.linear([0, 1], control="force"),
        lambda: Path.circle(-1.0),
        lambda: Path.random(seed=-1, points=3),
        lambda: Path.cycle(1.0, cycles=0),
    ],
)
def test_paths_that_are_none(make):
    with pytest.raises(InputError):
        make()


def test_a_table_that_is_none_names_the_line(tmp_path):
    (tmp_path / "t.csv").write_text("u_a,u_b\n0,0\n1,x\n")
    with pytest.raises(InputError, match=r"t\.csv:3"):
        Path.from_csv(tmp_path / "t.csv")


# -- interruption -------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("after", [1, 17, 40])
def test_an_interrupted_run_goes_on_to_the_same_last_digit(method, after):
    def stop(done, _):
        if done >= after:
            raise KeyboardInterrupt

    whole = walk(method=method, substeps=5)
    with pytest.raises(Interrupted) as caught:
        walk(method=method, substeps=5, on_step=stop)
    part = caught.value.history
    assert after + 1 <= len(part) < len(whole)
    rest = walk(method=method, substeps=5, start=part)
    assert np.array_equal(rest.to_array(), whole.to_array())
    with pytest.raises(InputError, match="another run"):
        walk(seed=4, method=method, substeps=5, start=part)


@pytest.mark.parametrize("other", [{"stiffness": 2.0}, {"parameters": {"mu": 0.31}}, {"stress": [0.2, 0.0]}, {"method": "exact"}], ids=str)
def test_a_part_of_another_run_is_refused(other):
    values, pressure = np.array([[0, 0], [0.1, 0], [0.5, 0.2], [0.3, 0.9], [0, 0.0]]), np.array([-1, -1.5, -0.7, -2, -1.0])
    given = {"stiffness": 1.0, "parameters": {"mu": 0.3}, "stress": [0.1, 0.1]}
    part = simulate("coulomb", Path.linear(values[:3], pressure=pressure[:3]), **given)
    whole = Path.linear(values, pressure=pressure)
    right = simulate("coulomb", whole, **given)
    for again in (given, {name: value for name, value in given.items() if name != "stress"}):  # a start tells its stress
        assert np.array_equal(simulate("coulomb", whole, start=part, **again).to_array(), right.to_array())
    with pytest.raises(InputError, match="another run"):
        simulate("coulomb", whole, start=part, **given | other)


def test_where_no_stress_is_outside_k_a_part_tells_its_own():
    law = Criterion("shifted", "norm(a - sin(sigma_n), b - cos(sigma_n)) - 3/10", {}, forces=("a", "b"))
    values, stress = [[0, 0], [1, 0], [0, 1], [1, 1]], [np.sin(-1.0), np.cos(-1.0)]
    part = simulate(law, Path.linear(values[:3], pressure=-1.0), stress=stress, stiffness=1.0)
    rest = simulate(law, Path.linear(values, pressure=-1.0), start=part, stiffness=1.0)
    assert np.array_equal(rest.to_array(), simulate(law, Path.linear(values, pressure=-1.0), stress=stress, stiffness=1.0).to_array())


@pytest.mark.long
def test_a_line_needs_no_solver_and_a_general_projection_finds_the_same():
    code = (
        "import sys, duhem; from duhem import Path, simulate;"
        "h = simulate('antoni2007-1d', Path.cycle(1.0, pressure=-1.0), stiffness=1.0,"
        " parameters={'mu_plus': .3, 'mu_minus': .2}, substeps=9);"
        "print(*sorted(m for m in ('cvxpy', 'clarabel', 'scipy', 'matplotlib', 'z3', 'pyarrow', 'duhem.projection.newton',"
        " 'duhem.path.slip_equation', 'duhem.derivation', 'duhem.proof.methods', 'duhem.proof.claims') if m in sys.modules));"
        "print(h.dissipation[-1])"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    imported, dissipation = ran.stdout.splitlines()
    assert imported == ""
    path = Path.cycle(1.0, pressure=-1.0)
    general = simulate("antoni2007-1d", path, stiffness=1.0, parameters={"mu_plus": 0.3, "mu_minus": 0.2}, substeps=9, projection="newton")
    assert general.dissipation[-1] == pytest.approx(float(dissipation), rel=1e-12)


def test_assembling_k_once_or_at_every_step_is_the_same():
    values = Path.random(seed=3, points=12, scale=0.4).values
    still = simulate("antoni2007", Path.linear(values, pressure=-1.0), stiffness=K, parameters=MU)
    # an extra knot after the end, under another pressure, makes K depend on the step
    moved = Path.linear(np.vstack([values, values[-1:]]), pressure=[*[-1.0] * len(values), -2.0])
    assert np.array_equal(simulate("antoni2007", moved, stiffness=K, parameters=MU).stress[:-1], still.stress)


@pytest.mark.slow
def test_a_law_without_closed_form_is_checked_once(monkeypatch):
    """However many steps slip: parameters and stiffness are looked at before the first of them."""
    calls = []
    for name in ("duhem.projection.projector", "duhem.projection.increment"):
        module = import_module(name)
        right = module.setting
        monkeypatch.setattr(module, "setting", lambda *a, right=right: calls.append(a) or right(*a))
    counts = []
    for points in (5, 25):
        calls.clear()
        history = simulate(
            "box", Path.random(seed=1, points=points, scale=2.0, pressure=-1.0), stiffness=K, parameters={"mu_a": 0.2, "mu_b": 0.1}
        )
        assert (np.diff(history.multiplier) > 0).sum() >= points - 2
        counts.append(len(calls))
    assert counts[0] == counts[1]


# -- a K that is not convex -----------------------------------------------------------------------------------------

DENTED = duhem.Criterion("oval", "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + 3*sigma_a/5)", {})


def test_a_run_ends_at_a_point_that_is_stationary_and_not_closest():
    with pytest.raises(duhem.DuhemError, match=r"^step 1: .*K is not convex there"):
        simulate(DENTED, Path.linear([[0, 0], [-3, 0], [-3, 1]], pressure=-1.0), stiffness=1.0)


@pytest.mark.parametrize("method", ["implicit", "extrapolated"])
def test_a_run_ends_there_too_where_half_of_the_step_is_found(method):
    """From a slip on, the whole step goes into the dent and the half beside it."""
    begun = simulate(DENTED, Path.linear([[0, 0], [0, 1]], pressure=-1.0), stiffness=1.0, method=method)
    knots = [[0.0, 0.0], [0.0, 1.0], np.array([-3.0, 1.0]) - begun.stress[-1]]
    with pytest.raises(duhem.DuhemError, match="K is not convex there"):
        simulate(DENTED, Path.linear(knots, pressure=-1.0), stiffness=1.0, method=method)


def test_a_run_is_not_ended_by_what_it_does_not_reach():
    """The last step would end in the dent if the one before it had not slipped; both are taken in one block."""
    knots = [[0, 0], [0, 0.1], [0, 0.2], [0, 0.3], [0, 3], [-3, 0]]
    history = simulate(DENTED, Path.linear(knots, pressure=-1.0), stiffness=1.0)
    assert len(history) == len(knots)
    assert duhem.project(DENTED, [-3.0, 0.0], -1.0).status[0] == duhem.Status.INACCURATE
