"""Error against run time: the reference against other ways to the same numbers, and rows that tell what happened."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.benchmark import throughput, work_precision
from duhem.benchmark.contenders import Contender, Specimen, applicable
from duhem.benchmark.measurement import Measurement, Spread, Target, WorkPrecision
from duhem.benchmark.reference import Closest, Drive, NoReference, distance
from duhem.benchmark.report import duration
from duhem.benchmark.work_precision import bench
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.omitted import LeftOut
from duhem.projection.closed_form import CLOSED_FORM, ClosedFormOptions
from duhem.projection.increment import Increment
from duhem.projection.result import Solution
from duhem.show.printing import text
from tests.long import long_at, long_but
from tests.oracles.path import drive
from tests.oracles.projection import closest

FIGURE_5 = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
MU = tuple(FIGURE_5.values())
Run = Callable[..., tuple[int, str, str]]


def exactly(name: str, values: dict[str, float]) -> tuple[Any, Any, Any]:
    """g with the parameters at these doubles, the force symbols and the pressure symbol."""
    law = duhem.load(name)
    assert isinstance(law, Criterion)
    table = law.symbols()
    g = law.g.xreplace({table[n]: sp.Rational(*Fraction(v).as_integer_ratio()) for n, v in values.items()})
    return g, law.force_symbols(), table[law.pressure] if law.pressure else None


def coulomb() -> Criterion:
    law = duhem.load("coulomb")
    assert isinstance(law, Criterion)
    return law.fix({"mu": "1/4"})


# -- the reference ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trial", "load", "k"),
    long_at(
        [1, 3, 4, 7],
        [
            ((0.3, 0.2), 1.0, [[1.0, 0.0], [0.0, 1.0]]),
            ((-0.3, -0.2), 1.0, [[1.0, 0.0], [0.0, 4.0]]),
            ((0.3, -0.01), 1.0, [[2.0, 1.0], [1.0, 3.0]]),
            ((0.3, -0.001), 1.0, [[2.0, 1.9], [1.9, 3.0]]),  # the result lies in another quadrant
            ((1e16, 1.0), 1.0, [[1.0, 0.0], [0.0, 1e12]]),
            ((math.nextafter(0.2, 1), 1e-17), 1.0, [[1.0, 0.0], [0.0, 1.0]]),
            ((3e-290, 2e-290), 1e-290, [[1.0, 0.0], [0.0, 2.0]]),
            ((3e290, -2e290), 1e290, [[1.0, 0.0], [0.0, 2.0]]),
            ((0.1, 0.01), 1.0, [[1.0, 0.0], [0.0, 1.0]]),
        ],
    ),
)
def test_reference_agrees_with_the_oracle(trial: tuple[float, float], load: float, k: list[list[float]]) -> None:
    """Two ways: optimality conditions of the formula here, the secular equation of the ellipse there."""
    found, oracle = Closest(*exactly("antoni2007", FIGURE_5), k)(trial, -load), closest(trial, load, MU, k)
    assert found.slips == oracle.slips
    assert found.residual <= 1e-50
    for mine, other in ((found.stress, oracle.stress), (found.slip, oracle.slip)):
        size = max(abs(x) for x in other)
        assert max(abs(a - b) for a, b in zip(mine, other, strict=True)) <= 1e-45 * (size or 1)
    assert abs(found.multiplier - oracle.multiplier) <= 1e-45 * oracle.multiplier


def test_reference_of_a_corner() -> None:
    """Both faces of a box press: stress in the corner, the multiplier of max(|a|/mu_a, |b|/mu_b) shared by its pieces."""
    found = Closest(*exactly("box", {"mu_a": 0.5, "mu_b": 0.25}), [[2.0, 0.0], [0.0, 4.0]])((3.0, -2.0), -1.0)
    assert [float(x) for x in found.stress] == [0.5, -0.25]
    assert [float(x) for x in found.slip] == [1.25, -0.4375]
    assert float(found.multiplier) == pytest.approx(0.5 * 1.25 + 0.25 * 0.4375, rel=1e-15)
    assert found.residual <= 1e-50


def test_reference_takes_out_what_has_no_end() -> None:
    """Von Mises in principal stresses: the radial return, sigma = p + s Y/q, for one stiffness in all directions."""
    trial = (3.0, 1.0, -1.0)
    found = Closest(*exactly("von-mises", {"yield_stress": 1.0}), np.eye(3).tolist())(trial)
    with mpmath.workdps(60):
        expected = [1 + (t - 1) / mpmath.sqrt(12) for t in trial]  # q^2 = 3/2 |s|^2 = 12
        assert max(abs(a - b) for a, b in zip(found.stress, expected, strict=True)) <= mpmath.mpf(10) ** -48


def test_reference_declines_what_it_cannot_do() -> None:
    law = Criterion("ball", "norm(a, b, c) - 1", {}, forces=("a", "b", "c"), pressure=None)
    with pytest.raises(NoReference, match="two bounded directions"):
        Closest(law.g, law.force_symbols(), None, np.eye(3).tolist())
    away = Criterion("away", "norm(a - 3, b) - 1", {}, forces=("a", "b"), pressure=None)
    with pytest.raises(NoReference, match="origin"):
        Closest(away.g, away.force_symbols(), None, np.eye(2).tolist())((9.0, 1.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "k"),
    long_but(
        [0, 2],
        [
            ("norm(a, b) + 1/a - 1", np.eye(2)),
            ("exp(exp(a**2 + b**2)) - 3", np.eye(2)),
            ("norm(a, b) - 1", np.zeros((2, 2))),
            ("norm(a, b) - 1", np.ones((2, 2))),
        ],
    ),
)
def test_a_reference_that_its_digits_do_not_reach_says_why(g: str, k: np.ndarray) -> None:
    law = Criterion("far", g, {}, forces=("a", "b"), pressure=None)
    try:
        found = Closest(law.g, law.force_symbols(), None, k.tolist())((30.0, 10.0))
        assert found.residual < 1e-40
    except NoReference as said:
        assert len(str(said)) > 20
    try:
        driven = Drive(law.g, law.force_symbols(), None, k.tolist())([(0.0, 0.0), (30.0, 10.0)])
        assert driven.error < 1e-10
    except NoReference as said:
        assert len(str(said)) > 20


def test_reference_path_agrees_with_the_disk() -> None:
    """Krieg and Krieg (1977): tan(w/2) = tan(w0/2) exp(-k |du|/(mu |sigma_n|)) for the angle w from du to the stress."""
    driven = Drive(*exactly("coulomb", {"mu": 0.25}), [[2.0, 0.0], [0.0, 2.0]], -1.0)([[0.0, 0.0], [0.25, 0.0], [0.25, 0.3]])
    assert driven.error <= 1e-17
    with mpmath.workdps(40):
        angle = mpmath.pi / 2 - 2 * mpmath.atan(mpmath.exp(-2 * mpmath.mpf(0.3) / mpmath.mpf(0.25)))  # tan(w0/2) = 1
        expected = [mpmath.cos(angle) / 4, mpmath.sin(angle) / 4]
        assert max(abs(a - b) for a, b in zip(driven.stress[-1], expected, strict=True)) <= mpmath.mpf(10) ** -18


@pytest.mark.long
def test_reference_path_agrees_with_collocation() -> None:
    """Across a seam of the quarter ellipses; the other way is Gauss collocation on the criterion as it is printed."""
    points = [[0.0, 0.0], [0.25, -0.05], [0.3, 0.15]]
    driven = Drive(*exactly("antoni2007", FIGURE_5), [[1.0, 0.0], [0.0, 2.0]], -1.0)(points)
    for mine, row in zip(driven.stress[1:], drive(points, MU, 1.0, [1.0, 2.0]), strict=True):
        assert max(abs(float(a - b)) for a, b in zip(mine, row[0], strict=True)) <= 1e-17


def test_distance_is_relative_and_knows_what_is_no_number() -> None:
    assert distance([1.0, 2.0], [mpmath.mpf(1), mpmath.mpf(4)]) == 0.5
    assert distance([0.0], [mpmath.mpf(0)]) == 0.0
    assert math.isnan(distance([math.nan], [mpmath.mpf(1)]))
    assert distance([1.0], [mpmath.mpf(0)]) == math.inf


# -- who is measured -------------------------------------------------------------------------------------------------


def question(name: str, values: dict[str, Any]) -> Increment:
    law = duhem.load(name)
    assert isinstance(law, Criterion)
    specimen = Specimen.of(law.fix(values))
    return specimen.question(np.zeros((1, len(law.forces))), specimen.pressure)


@pytest.mark.slow
def test_what_does_not_apply_is_named_what_is_left_out_and_why() -> None:
    found, left_out = applicable(question("coulomb", {"mu": "1/4"}), (1e-6, None))
    names = [c.name for c in found]
    assert names[0] == "closed-form" and "newton" in names and names.count("cvxpy CLARABEL") == 2
    reasons = {part.part: part.reason for part in left_out}
    assert ("closed-form, numba" in names) != ("closed-form, numba" in reasons)
    if find_spec("numba") is None:
        assert 'pip install "duhem[fast]"' in reasons["closed-form, numba"]
    found, left_out = applicable(question("limacon", {"mu": "1/4", "e": "0.3"}))
    assert [c.name for c in found] == ["newton", *["newton, numba"] * (find_spec("numba") is not None)]
    reasons = {part.part: part.reason for part in left_out}
    assert "no closed form" in reasons["closed-form"] and reasons["cvxpy"]


def test_a_specimen_measures_the_law_at_the_doubles_that_methods_read() -> None:
    specimen = Specimen.of(coulomb().fix({}))
    assert specimen.radius(np.array([3.0, 4.0]), -2.0) == pytest.approx(0.5 / 5.0, rel=1e-15)
    law = duhem.load("antoni2007")
    assert isinstance(law, Criterion)
    exact = Specimen.of(law.fix(FIGURE_5)).law.parameters["mu_a_plus"].value
    assert Fraction(int(exact.p), int(exact.q)) == Fraction(0.2)  # type: ignore[union-attr]


# -- rows ------------------------------------------------------------------------------------------------------------


def skewed() -> Contender:
    """The closed form with every stress a tenth of a percent too large: wrong, and sure of itself."""

    def solve(asked: Increment, options: ClosedFormOptions) -> Solution:
        answer = CLOSED_FORM.solve(asked, options)
        return Solution(answer.stress * 1.001, answer.slip, answer.multiplier, answer.failed)

    return Contender("skewed", replace(CLOSED_FORM, solve=solve), ClosedFormOptions())


def broken() -> Contender:
    def solve(*_: object) -> Solution:
        raise RuntimeError("the solver went away")

    return Contender("broken", replace(CLOSED_FORM, solve=solve), ClosedFormOptions())


@pytest.fixture(scope="module")
def increments() -> WorkPrecision:
    contenders = [Contender.of("closed-form", "closed-form"), skewed(), broken()]
    return bench(coulomb(), scenes=("increment",), repeats=2, contenders=contenders)


def test_a_wrong_method_shows_its_error(increments: WorkPrecision) -> None:
    rows = {row.method: row for row in increments.rows}
    assert rows["closed-form"].error["stress"] <= 1e-15 and rows["closed-form"].flagged == 0
    assert rows["skewed"].error["stress"] == pytest.approx(1e-3, rel=1e-9)
    assert rows["skewed"].flagged == 4  # by the residuals


@pytest.mark.slow
def test_a_method_that_raises_is_listed_as_failed(increments: WorkPrecision) -> None:
    row = next(row for row in increments.rows if row.method == "broken")
    assert row.failure == "RuntimeError: the solver went away"
    assert row.seconds is None and row.error == {}
    assert "failed: RuntimeError: the solver went away" in text(increments)
    assert not increments.failed
    assert bench(coulomb(), scenes=("path",), repeats=1, steps=(1,), contenders=[]).failed is False


def test_nothing_but_failures_is_a_failure() -> None:
    assert WorkPrecision(
        law="x", subject="", machine={}, repeats=1, rows=(Measurement("path", "m", "", failure="no"),),
        targets=(), reference={}, left_out=(), interrupted=False,
    ).failed  # fmt: skip


def test_json_has_every_row_with_its_spread(increments: WorkPrecision) -> None:
    found = json.loads(json.dumps(increments.to_dict(), allow_nan=False))
    assert set(found) == {
        "law", "subject", "machine", "repeats", "interrupted", "reference", "rows", "targets", "left_out",
    }  # fmt: skip
    assert found["reference"]["increment"] <= 1e-50
    assert {"processor", "python", "system", "versions"} <= set(found["machine"])
    assert found["machine"]["versions"]["numpy"] == np.__version__
    for row in found["rows"]:
        if row["failure"] is None:
            seconds = row["seconds"]
            assert 0 < seconds["least"] <= seconds["median"] <= seconds["most"] and seconds["repeats"] == 2


@pytest.mark.slow
def test_path_errors_fall_with_the_order_of_the_integrator(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("duhem.benchmark.work_precision._SLOW", float("inf"))  # on a busy machine too
    law = coulomb()
    result = bench(law, scenes=("path",), repeats=1, steps=(64, 256))
    error = {(row.method, row.setting): row.error["stress"] for row in result.rows}
    fall = {m: error[m, "64 steps a segment"] / error[m, "256 steps a segment"] for m in ("implicit", "extrapolated")}
    assert 3.0 < fall["implicit"] < 5.0  # first order
    assert fall["extrapolated"] > 8.0  # second, or where it kinks a little less
    assert max(e for (m, _), e in error.items() if m == "exact") < 1e-13
    assert isinstance(result.reference["path"], float) and result.reference["path"] <= 1e-17


def test_a_path_into_a_corner_has_no_reference() -> None:
    drive_box = Drive(*exactly("box", {"mu_a": 0.5, "mu_b": 0.25}), [[1.0, 0.0], [0.0, 2.0]], -1.0)
    with pytest.raises(NoReference, match="corner"):
        drive_box([[0.0, 0.0], [3.0, 1.0]])
    face = drive_box([[0.0, 0.0], [3.0, 0.1]])  # along a face, short of the corner
    assert [float(x) for x in face.stress[-1]] == pytest.approx([0.5, 0.2], rel=1e-16)


def test_a_law_without_reference_is_left_out_with_the_reason() -> None:
    law = Criterion("ball", "norm(a, b, c) - 1", {}, forces=("a", "b", "c"), pressure=None)
    result = bench(law, scenes=("increment",), repeats=1)
    assert result.rows == ()
    assert any(part.part == "scene increment" and "two bounded directions" in part.reason for part in result.left_out)
    assert "two bounded directions" in text(result)


@pytest.mark.slow
def test_throughput_compares_with_memory_in_the_same_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(throughput, "_KNOWN", 3)  # answers in many digits
    monkeypatch.setattr(throughput, "_FEWER", 4)  # points for cvxpy
    result = bench(coulomb(), scenes=("throughput",), repeats=1, points=3000)
    targets = {target.what: target for target in result.targets}
    assert len(targets) == 9
    assert targets["extra memory of closed-form, MB"].holds is True
    rows = {(row.method, row.setting): row for row in result.rows}
    bound, plain = rows["memory bandwidth, new arrays", "N = 3000"].seconds, rows["closed-form", "N = 3000"].seconds
    assert bound is not None and plain is not None
    assert targets["closed form (NumPy) / memory bandwidth, new arrays"].value == plain.median / bound.median
    there, reused = rows["memory bandwidth", "N = 3000"].seconds, rows["closed-form, arrays reused", "N = 3000"].seconds
    assert there is not None and reused is not None
    assert targets["closed form (NumPy) / memory bandwidth"].value == reused.median / there.median
    if find_spec("numba") is None:
        target = targets["closed form (numba) / memory bandwidth"]
        assert target.holds is None and "numba is not installed" in target.reason
    assert "Targets" in text(result)


@pytest.mark.slow
def test_whole_calls_are_held_to_a_copy_in_the_same_run() -> None:
    result = bench(coulomb(), scenes=("project",), repeats=1, points=2000, contenders=[Contender.of("closed-form", "closed-form")])
    rows = {(row.method, row.setting): row.seconds for row in result.rows}
    targets = {target.what: target for target in result.targets}
    copy, whole = rows["copy of 24 bytes a point", "N = 2000"], rows["closed-form", "N = 2000"]
    assert copy is not None and whole is not None
    assert targets["duhem.project / copy of 24 bytes a point"].value == whole.least / copy.least
    assert targets["duhem.project (numba) / copy of 24 bytes a point"].holds is None
    assert "wall time a point" in text(result)


@pytest.mark.slow
@pytest.mark.parametrize(("points", "often"), long_at([1], [(5_000, 2), (20_000, 4), (500_000, 40)]))
def test_small_batches_are_taken_more_often(points: int, often: int) -> None:
    rows = list(throughput.call_rows(throughput.Load.of(Specimen.of(coulomb()), points), [], repeats=2))
    assert [row.seconds.repeats // 5 for row in rows if row.seconds is not None] == [2, often][-len(rows) :]


def test_whole_calls_set_a_law_without_closed_form_other_ratios() -> None:
    spread = {0.5: Spread.of([0.5]), 30.0: Spread.of([30.0]), 1.0: Spread.of([1.0])}
    rows = [
        Measurement("project", name, "N = 9000", seconds=spread[x])
        for name, x in (("newton, numba", 0.5), ("newton, numba, one thread", 1.0), ("copy of 24 bytes a point", 0.5))
    ]
    rows.append(Measurement("project", "newton", "N = 2000", seconds=spread[30.0]))
    found = throughput.call_targets(rows, [LeftOut("closed-form", "declares none")])
    assert [(target.value, target.holds) for target in found] == [(60.0, True), (2.0, True)]


def test_steps_of_many_points_are_held_to_the_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = {"kernel alone": 2e-8, "one path, numba": 3e-7, "many points, numba, one thread": 5e-8, "many points, numba": 4e-8}
    rows = [Measurement("paths", name, "", seconds=Spread.of([s])) for name, s in seconds.items()]
    found = work_precision.long_targets(rows, [])
    assert [target.holds for target in found] == [True, True, False]
    assert [target.value for target in found] == pytest.approx([2.5, 0.3, 1.25])
    lost = work_precision.long_targets([*rows[:1], Measurement("paths", "one path, numba", "", failure="no")], [])
    assert [(target.holds, target.reason[:11]) for target in lost] == [(None, "many points"), (None, "failed: no"), (None, "many points")]
    monkeypatch.setattr(work_precision, "find_spec", lambda name: None)
    without = bench(coulomb(), scenes=("paths",), repeats=1, points=200, contenders=[])
    assert [(row.method, row.setting) for row in without.rows] == [("one path", "200 steps")] and not without.failed
    assert [target.holds for target in without.targets] == [None] * 3 and "wall time a step" in text(without)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("name", ["coulomb", "box"])
def test_steps_of_many_points_are_measured(name: str) -> None:
    pytest.importorskip("numba")
    law = coulomb() if name == "coulomb" else duhem.load("box").fix({"mu_a": "1/5", "mu_b": "1/10"})
    result = bench(law, scenes=("paths",), repeats=1, points=20_000)
    assert [row.failure for row in result.rows if row.failure] == [] and len(result.rows) == 6
    assert all(target.value is not None for target in result.targets)


def test_targets_and_spreads() -> None:
    assert Target("x", 41.0, "<=", 40.0).holds is False
    assert Target("x", 39.0, "<=", 40.0).holds is True
    assert Target("x", 1e3, ">=", 1e4).holds is False
    assert Target("x", None, ">=", 1e4).holds is None
    assert Spread.of([3.0, 1.0, 2.0, 10.0], 0.5) == Spread(0.5, 1.25, 5.0, 4)
    assert [duration(s) for s in (2.0, 0.0123, 4.5e-6, 7e-10)] == ["2 s", "12.3 ms", "4.5 us", "0.7 ns"]


def test_an_interrupted_run_keeps_what_is_done() -> None:
    def stop(row: Measurement) -> None:
        raise KeyboardInterrupt

    result = bench(coulomb(), scenes=("increment", "path"), repeats=1, on_row=stop)
    assert result.interrupted and len(result.rows) == 1 and result.rows[0].method == "closed-form"
    assert "Interrupted" in text(result)


def test_input_that_cannot_be_used() -> None:
    law = duhem.load("coulomb")
    assert isinstance(law, Criterion)
    with pytest.raises(InputError, match="--set mu=VALUE"):
        bench(law)
    with pytest.raises(InputError, match="unknown scene"):
        bench(coulomb(), scenes=("sideways",))
    with pytest.raises(InputError, match="repeats"):
        bench(coulomb(), repeats=0)
    flowing = duhem.load("radial-flow")
    assert isinstance(flowing, Criterion)
    with pytest.raises(InputError, match="flow"):
        bench(flowing.fix({"mu_a": "0.2", "mu_b": "0.1"}))
    own = duhem.load("prager")
    assert isinstance(own, Criterion)
    with pytest.raises(InputError, match="an increment of prager is more than a closest point of K"):
        bench(own)


# -- command line ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_command(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("duhem.benchmark.contenders.find_spec", lambda name: None)  # to compile a loop takes twenty seconds
    file = tmp_path / "bench.json"
    code, out, err = run(
        "bench", "limacon", "--set", "mu=0.25", "--set", "e=0.3", "--scene", "increment", "--repeats", "1", "--json", str(file)
    )
    assert (code, err) == (0, f"duhem: wrote the results to {file}\n")
    assert "newton" in out and "Omitted" in out and "closed-form: limacon has no closed form" in out
    assert "newton, numba: numba is not installed" in out
    found = json.loads(file.read_text())
    assert found["duhem"] == duhem.__version__ and found["rows"][0]["method"] == "newton"


@pytest.mark.long
def test_command_draws(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "bench.svg"
    arguments = ("bench", "antoni2007-1d", "--set", "mu_plus=0.2", "--set", "mu_minus=0.1", "--scene", "path", "--repeats", "1", "--plot")
    code, out, err = run(*arguments, str(file))
    if find_spec("matplotlib") is None:
        assert code == 2 and 'pip install "duhem[plot]"' in err
        return
    assert (code, err) == (0, f"duhem: wrote the picture to {file}\n")
    assert "exact" in out and "svg" in file.read_text()
    code, _, err = run(*arguments, str(tmp_path / "bench.xyz"))
    assert code == 2 and "no format of a figure" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("bench", "coulomb"), "--set mu=VALUE"),
        (("bench", "coulomb", "--set", "mu=0.2", "--stiffness", "1 2 3"), "stiffness"),
        (("bench", "no-such-law"), "no-such-law"),
        (("bench", "coulomb", "--set", "mu=0.2", "--repeats", "0"), "--repeats"),
        (("bench", "radial-flow", "--set", "mu_a=0.2", "--set", "mu_b=0.1"), "flow"),
    ],
)
def test_command_rejects(run: Run, arguments: tuple[str, ...], message: str) -> None:
    code, out, err = run(*arguments)
    assert code == 2 and out == "" and message in err


def test_command_says_when_it_was_interrupted(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:

    def stopped(*_: Any) -> Any:
        yield Measurement("increment", "closed-form", "", {"stress": 0.0, "slip": 0.0}, Spread(1.0, 1.0, 1.0, 1))
        raise KeyboardInterrupt

    monkeypatch.setattr(throughput, "single_rows", stopped)
    code, out, _ = run("bench", "--scene", "increment")
    assert code == 130
    assert "closed-form" in out and "Interrupted" in out
