"""The loop that is made for one law: its text run as it is, and compiled, against the search and against bodies with a known answer."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, MissingExtraError
from duhem.expression.scalar_jets import scalar_jets
from duhem.projection import code_cache, compiled_newton, newton
from duhem.projection.increment import Increment, posed, setting
from duhem.projection.newton_kernel import LEFT, SLIP
from duhem.projection.residuals import residuals
from duhem.projection.result import Solution, Status
from duhem.projection.scaled_formula import scaled
from duhem.projection.whitened_body import whitening
from tests.long import long_but, mostly_long
from tests.projection.drawn_questions import LAWS, drawn

STRESSES = ("yield_stress", "c")  # the parameters in Pa of the laws that are put in other units


def _question(name: str, n: int, seed: int, size: float = 1.0, full: bool = False) -> Increment:
    law, rng, stiffness = drawn(name, seed, full)
    pressure = -size * rng.uniform(0.2, 1.2, n) if law.pressure else None
    parameters = {own: value * size if own in STRESSES else value for own, value in LAWS[name].items()}
    return posed(setting(law, stiffness, parameters), size * rng.normal(size=(n, len(law.forces))) * 0.5, pressure)


def _made(question: Increment) -> tuple[dict[str, Any], np.ndarray, np.ndarray, float]:
    """The functions of the loop, not compiled, with the formula's data at each point, its constants and its degree."""
    law, n = question.law, len(question.trial)
    formula = scaled(question.g, law.force_symbols(), law.symbols()[law.pressure] if law.pressure else None)
    space: dict[str, Any] = {}
    jets = scalar_jets(formula.expr, law.force_symbols(), tuple(formula.data))
    exec(compiled_newton.kernel_text(formula, jets, len(law.forces)), space)
    values = formula.values(question.pressure, np.ones(n))
    data = np.stack(list(values.values()), axis=1) if values else np.zeros((n, 0))
    return space, data, np.array(jets.constants), formula.degree


def _as_text(question: Increment) -> tuple[Solution, np.ndarray]:
    """The loop, not compiled."""
    (space, data, constants, degree), (n, d) = _made(question), question.trial.shape
    mean, root = whitening(question)
    out = Solution(np.empty((n, d)), np.empty((n, d)), np.empty(n), np.zeros(n, dtype=bool))
    state = np.empty(n, dtype=np.int8)
    with np.errstate(all="ignore"):
        given = question.trial, data, constants, root, np.linalg.inv(root), degree
        space["solve"](*given, out.stress, out.slip, out.multiplier, state)
    return Solution(out.stress, out.slip / mean, out.multiplier / mean, out.failed), state


@pytest.mark.slow
@pytest.mark.parametrize("full", [False, True], ids=["diagonal", "full"])
@pytest.mark.parametrize("name", long_but([0, 2, 4, 5, 7, 8, 11, 13], LAWS))
def test_it_is_the_search(name: str, full: bool) -> None:
    question = _question(name, 25, 3, full=full)
    found, state = _as_text(question)
    known = newton.solve(question)
    done = state != LEFT
    assert done.mean() >= 0.9 and (state == SLIP).sum() >= 5
    for one, other in ((found.stress, known.stress), (found.slip, known.slip), (found.multiplier, known.multiplier)):
        assert one[done] == pytest.approx(other[done], rel=1e-9, abs=1e-11)
    assert (found.multiplier[done] > 0).tolist() == (known.multiplier[done] > 0).tolist()


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-250, 1e-90, 1e90, 1e250])
@pytest.mark.parametrize("name", ["superellipse", "hosford", "box", "regularised"])
def test_units_do_not_matter(name: str, size: float) -> None:
    here, state = _as_text(_question(name, 8, 5))
    there, again = _as_text(_question(name, 8, 5, size=size))
    assert state.tolist() == again.tolist() and LEFT not in state
    assert there.stress / size == pytest.approx(here.stress, rel=1e-12, abs=1e-14)
    assert there.slip / size == pytest.approx(here.slip, rel=1e-11, abs=1e-13)


def test_beyond_a_smooth_seam_the_other_piece_is_followed() -> None:
    """Where an ellipse of one size goes over into one 879 times as wide, both levels are 0 to rounding, and only one normal is right."""
    k = np.array([[1.0, -3.162277660168379e-07], [-3.162277660168379e-07, 0.1]])
    values = {"mu_a_plus": 4.149865190338329, "mu_a_minus": 29.6575966921924, "mu_b_plus": 1.0, "mu_b_minus": 879.5730415567416}
    question = posed(setting(duhem.load("antoni2007"), k, values), np.array([[-77.36487354333775, 0.0]]), -0.006285992756716055)
    found, state = _as_text(question)
    known = newton.solve(question)
    assert state[0] == SLIP
    assert found.stress[0] == pytest.approx(known.stress[0], rel=1e-9) and found.slip[0] == pytest.approx(known.slip[0], rel=1e-9)


def test_at_a_corner_as_many_pieces_press_as_meet() -> None:
    law = Criterion(name="brick", g="max(abs(a)/2, abs(b), abs(c)/3) - 1", forces=("a", "b", "c"), pressure=None)
    trial = np.array([[5.0, 0.2, 1.0], [5.0, -3.0, 1.0], [-5.0, 3.0, 9.0], [0.1, 0.2, -0.3]])
    found, state = _as_text(posed(setting(law, 1.0, {}), trial, None))
    assert found.stress == pytest.approx(np.clip(trial, [-2, -1, -3], [2, 1, 3]), abs=1e-14)
    assert found.slip == pytest.approx(trial - np.clip(trial, [-2, -1, -3], [2, 1, 3]), abs=1e-13)
    assert state.tolist() == [SLIP, SLIP, SLIP, 0]


@pytest.mark.slow
@pytest.mark.parametrize("d", [2, pytest.param(3, marks=pytest.mark.long)])
def test_far_from_a_body_of_many_sides_pieces_are_exchanged(d: int) -> None:
    """Along the way there are more sides than can meet: one leaves for each that comes."""
    rng = np.random.default_rng(d)
    names = tuple("abc"[:d])
    sides = ", ".join(" + ".join(f"({int(c)}/10)*{x}" for c, x in zip(row, names, strict=True)) for row in rng.integers(-9, 10, (14, d)))
    law = Criterion(name="stone", g=f"max({sides}, {', '.join(f'abs({x})/2' for x in names)}) - 1", forces=names, pressure=None)
    question = posed(setting(law, np.geomspace(1.0, 5.0, d), {}), rng.normal(size=(40, d)) * 30.0, None)
    found, state = _as_text(question)
    known = newton.solve(question)
    assert state.tolist() == [SLIP] * 40
    assert found.stress == pytest.approx(known.stress, rel=1e-12, abs=1e-13)
    assert found.slip == pytest.approx(known.slip, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("trial", [[np.nan, 1.0], [np.inf, 0.0], [1e300, 1e300]])
def test_what_is_no_number_is_left_or_answered(trial: list[float]) -> None:
    question = replace(_question("superellipse", 1, 0), trial=np.array([trial]))
    found, state = _as_text(question)
    assert state[0] == LEFT or np.isfinite(found.stress).all()


INSIDE_ELSEWHERE = {
    "off": ("norm(a - 3, b) - 1", "a b"),
    "through 0": ("norm(a - 1, b) - 1", "a b"),
    "squared": ("b**2 + a*(a - 2)", "a b"),
    "cone": ("norm(b, c) - a/2", "a b c"),
    "narrow": ("abs(b - a/3) - a/100", "a b"),
    "octant": ("max(-a, -b, -c, a + b + c - 2)", "a b c"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([0, 5], INSIDE_ELSEWHERE))
def test_where_the_origin_is_no_inner_point_another_is_found(name: str) -> None:
    g, forces = INSIDE_ELSEWHERE[name]
    law = Criterion(name=name, g=g, forces=tuple(forces.split()), pressure=None)
    d = len(law.forces)
    question = posed(setting(law, np.arange(1.0, d + 1), {}), np.random.default_rng(d).normal(size=(30, d)) * 4.0, None)
    found, state = _as_text(question)
    assert residuals(question, found).worst()[state != LEFT].max() <= 1e-9
    known = newton.solve(question)
    tip = np.abs(known.stress).max(axis=1) < 1e-9  # of a cone without a normal there: for the search
    assert (state != LEFT)[~tip].mean() >= 0.95 and (state == SLIP).any()
    assert found.stress[state != LEFT] == pytest.approx(known.stress[state != LEFT], abs=1e-6)


def test_of_a_body_away_from_the_origin_the_near_side_is_found() -> None:
    law = Criterion(name="off", g="norm(a - 3, b) - 1", forces=("a", "b"), pressure=None)
    found, state = _as_text(posed(setting(law, 1.0, {}), np.array([[9.0, 0.0], [3.1, 0.0], [0.0, 0.0]]), None))
    assert state.tolist() == [SLIP, 0, SLIP]
    assert found.stress == pytest.approx(np.array([[4.0, 0.0], [3.1, 0.0], [2.0, 0.0]]), abs=1e-12)


APEXES = [
    ("drucker-prager", {"alpha": "1/2", "k": 3}, [[6, 7.3, 8.1], [9, 9, 9], [9, 8, 10], [1e9, 1.1e9, 1.2e9]], [2.0] * 4),  # k/(3 alpha)
    ("drucker-prager", {"alpha": "1/100", "k": 3}, [[300, 301, 302], [300, 300, 302]], [100.0] * 2),
    ("lade-duncan", {}, [[-0.9, -0.3, 0.01], [0, -1, 0], [-6, -6, -6]], [0.0] * 3),
    ("original-cam-clay", {}, [[-6.5, -1.4, -4.3], [-2, -2, -2]], [-1.0] * 2),
]


@pytest.mark.parametrize(("name", "values", "trials", "ends"), mostly_long(APEXES, APEXES[0], APEXES[3]))
def test_an_apex_is_met_by_what_supports_it(name: str, values: dict[str, Any], trials: list[list[float]], ends: list[float]) -> None:
    """At the tips of cones no piece has a normal; of the multipliers the work on the slip is theirs, for gauges about the apex."""
    question = posed(setting(duhem.load(name), np.eye(3), values), np.array(trials, dtype=float), None)
    found, state = _as_text(question)
    assert (state == SLIP).all()
    assert found.stress == pytest.approx(np.array(ends)[:, None] * np.ones(3), rel=1e-13, abs=1e-15)
    assert found.slip == pytest.approx(question.trial - found.stress, rel=1e-12, abs=1e-13)
    if name == "drucker-prager":  # g grows with slope 3 alpha along the axis, from whichever normals the slip is made
        assert found.multiplier * 3 * float(question.parameters["alpha"]) == pytest.approx(found.slip.sum(axis=1), rel=1e-9)


@pytest.mark.slow
def test_where_the_search_from_the_boundary_fails_one_from_nearby_does_not() -> None:
    """Next to where a logarithm ends, and where a face is the greatest of the pieces inside but another one ends the way."""
    for name, trials in (
        ("original-cam-clay", [[0.36, 0.11, 0.12]]),
        ("lade-duncan", [[1.05, 0, 0], [0.92, -0.48, -0.16]]),
    ):
        question = posed(setting(duhem.load(name), np.diag([1.0, 3.0, 10.0]), {}), np.array(trials), None)
        found, state = _as_text(question)
        assert (state == SLIP).all() and found.stress == pytest.approx(newton.solve(question).stress, abs=1e-12)


def test_no_smooth_point_is_taken_for_an_apex() -> None:
    """However sharp an ellipse is: half-spaces come close to its end alone, and Newton's method does the rest."""
    law = Criterion(name="needle", g="norm(sigma_a, 100*sigma_b) - 1", pressure=None)
    question = posed(setting(law, np.eye(2), {}), np.array([[3.0, 0.0], [3.0, 1e-3], [2.0, 0.5], [0.3, 1.0]]), None)
    (space, data, constants, _), d = _made(question), 2
    v, m, a = np.zeros((space["ROWS"], d)), np.zeros((space["MATRICES"], d, d)), np.zeros((2 * d, 2 * d + 1))
    q, held = np.append(np.zeros(data.shape[1]), constants), np.zeros((d + 1, 1), np.int8)
    ends = newton.solve(question).stress
    with np.errstate(all="ignore"):
        for n, end in enumerate(ends):
            size = space["begun"](question.trial, data, n, v, m, q, held)
            assert space["apex"](v, m, a, q, held, np.eye(d), np.eye(d)) == 1
            assert v[space["X"]] * size == pytest.approx(end, abs=1e-5)


def test_without_numba_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)
    code_cache.compiled_text.cache_clear()
    with pytest.raises(MissingExtraError, match=r"duhem\[fast\]"):
        duhem.project("superellipse", [1.0, 1.0], -1.0, 1.0, LAWS["superellipse"], method="newton", compiled=True)


SCRIPT = """
import numpy as np, duhem
rng = np.random.default_rng(0)
trial, pressure = rng.normal(size=(40_000, 2)), -rng.uniform(0.2, 1.0, 40_000)
own = dict(mu_a=0.3, mu_b=0.2, p=3)
fast = duhem.project("superellipse", trial, pressure, [1.0, 2.0], own, method="newton", compiled=True)
assert set(fast.status.tolist()) == {0, 1}
few = slice(39_900, None)
alone = duhem.project("superellipse", trial[few], pressure[few], [1.0, 2.0], own, method="newton", compiled=True)
assert (fast.stress[few] == alone.stress).all() and (fast.slip[few] == alone.slip).all()
slow = duhem.project("superellipse", trial[few], pressure[few], [1.0, 2.0], own, method="newton")
print(abs(fast.stress[few] - slow.stress).max(), abs(fast.slip[few] - slow.slip).max())
"""


@pytest.mark.long
def test_compiled_it_is_the_same_and_is_kept(tmp_path: Any) -> None:
    pytest.importorskip("numba")
    for _ in range(2):
        environment = {**os.environ, "DUHEM_CACHE_DIR": str(tmp_path / "kept")}
        done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, env=environment)
        assert done.returncode == 0, done.stderr
        assert max(map(float, done.stdout.split())) < 1e-14
    kept = {path.suffix for path in (tmp_path / "kept").rglob("law_*")}
    assert kept == {".py", ".nbi", ".nbc", ".o"}


def test_a_folder_that_cannot_be_written_is_no_fault(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path / "file"))
    assert code_cache._kept("text") is None


def test_what_stands_in_the_way_in_the_folder_is_written_anew(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    path = code_cache._kept("x = 1\n")
    assert path is not None and path.read_text() == "x = 1\n"
    path.write_text("import os")
    assert code_cache._kept("x = 1\n") == path and path.read_text() == "x = 1\n"
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.slow
def test_few_texts_serve_all_values_of_the_parameters() -> None:
    texts = set()
    for shift in np.linspace(0.01, 0.3, 12).tolist():
        law = duhem.load("superellipse")
        question = setting(law, 1.0, {"mu_a": 0.25 + shift, "mu_b": 0.65 - shift, "p": 4})
        formula = scaled(question.g, law.force_symbols(), law.symbols()["sigma_n"])
        texts.add(compiled_newton.kernel_text(formula, scalar_jets(formula.expr, law.force_symbols(), tuple(formula.data)), 2))
    assert len(texts) <= 2  # the terms in one order or the other


def test_statuses_are_the_judges() -> None:
    assert Status.SLIP == SLIP and Status.STICK == 0


def test_what_is_kept_belongs_to_what_lowers_it(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    for own in ("one", "another", "another"):
        monkeypatch.setattr(code_cache, "_lowered_by", lambda own=own: own)
        code_cache.compiled_text.__wrapped__("def run(x):\n    return x / 2\n", "run")
    assert len(list(tmp_path.glob("law_*.py"))) == 2


WITHOUT_BLAS = """
import sys
from duhem.projection.code_cache import compiled_text
run = compiled_text("def run(x):\\n    return 2.0 * x", "run")
assert run(1.5) == 3.0 and "scipy.linalg" not in sys.modules
from numba.np import arraymath, linalg
assert arraymath.ensure_blas is linalg.ensure_blas and arraymath._HAVE_BLAS
linalg.ensure_blas()
assert "scipy.linalg" in sys.modules
"""


@pytest.mark.slow
def test_what_is_compiled_loads_no_linear_algebra_and_leaves_it_to_others(tmp_path: Any) -> None:
    pytest.importorskip("numba")
    environment = {**os.environ, "DUHEM_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", WITHOUT_BLAS], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
