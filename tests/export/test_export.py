"""Exported files: compiled without a warning, put to the conformance suite, honest about what they do not solve."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, Domain, InputError
from duhem.export import increment_kernel
from duhem.export.routine import routine
from duhem.export.source_files import c_file, fortran_file, identifier
from duhem.projection import quarter_ellipse
from duhem.testing import checks_for, conformance, pressures
from duhem.testing.foreign import shared_library, umat
from tests.campaigns.increments import at_simplest
from tests.export.shared_library import OPTIMISED, compiled, compiler, shared, with_fortran
from tests.long import long_at, long_but, mostly_long

LAWS: dict[str, dict[str, Any]] = {"antoni2007": {}, "coulomb": {}, "superellipse": {"p": 3}, "polygon": {}, "tresca": {}, "von-mises": {}}
SUITE = tuple(c for c in checks_for("coulomb") if c.name not in ("multiplier", "slope"))
EYE = np.eye(2)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, "antoni2007"))
def test_the_suite_finds_nothing(name: str) -> None:
    law = duhem.load(name).fix(LAWS[name])
    run = compiled(law, options=OPTIMISED)
    report = conformance(law, run, checks=SUITE, max_examples=3, rows=20, every=1)
    assert report.ok, str(report)
    assert report.flagged_share < 0.25 and report.points > 200  # stiffness and friction over six decades each
    if name != "superellipse":  # whose flat points are too sharp for differences
        near = conformance(law, run, checks=["slope"], pressure=pressures(-1, 1).filter(bool) if law.pressure else None, max_examples=1)
        assert near.ok, str(near)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("right", "wrong"),
    long_but(
        [2, 3],
        [
            (r"v\[slopes\]\[0\] = ", "v[slopes][0] = -"),
            pytest.param(r"m\[bends\]\[0\]\[0\] = ", "m[bends][0][0] = -", marks=pytest.mark.long),
            (r"tangent\[i \* D \+ j\] = mean \* total", "tangent[i * D + j] = -mean * total"),
            (r"slips\[0\]\[i\] /= mean", "slips[0][i] *= mean"),
        ],
    ),
)
def test_a_wrong_sign_is_found(right: str, wrong: str) -> None:
    law = duhem.load("coulomb")
    text, count = re.subn(right, wrong, c_file(duhem.verify(law, claims=["convexity"])))
    assert count == 1
    report = conformance(law, compiled(law, text=text), checks=SUITE, max_examples=3, rows=20, tries=0)
    assert not report.ok or report.flagged_share > 0.3


@pytest.mark.slow
def test_answers_are_those_of_the_search() -> None:
    law = duhem.load("antoni2007")
    run = compiled(law)
    values = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
    k = np.array([[3.0, 0.5], [0.5, 1.0]])
    for trial in np.random.default_rng(0).normal(size=(30, 2)) * 0.4:
        status, stress, slip, loss, tangent = run.one(trial, -1.0, k, list(values.values()))
        known = duhem.project(law, trial, -1.0, k, values, method="newton", tangent=True)
        assert status == known.status[0]
        assert stress == pytest.approx(known.stress[0], abs=1e-14) and slip == pytest.approx(known.slip[0], abs=1e-14)
        assert known.tangent is not None
        assert tangent == pytest.approx(known.tangent[0], abs=1e-12) and loss == pytest.approx(known.dissipation[0], abs=1e-14)


GREATEST = {
    "tresca": "principal(1) - principal(3) - 1",
    "hosford": "(principal(1) - principal(2))**8 + (principal(2) - principal(3))**8 + (principal(1) - principal(3))**8 - 2",
}


@pytest.mark.slow
@pytest.mark.parametrize("full", [False, True], ids=["isotropic", "any"])
@pytest.mark.parametrize("name", GREATEST)
def test_answers_of_laws_with_eigenvalues_are_those_of_the_arrays(name: str, full: bool) -> None:
    law = Criterion(name=name, g=GREATEST[name], stress={"name": "s", "kind": "3d"}, pressure=None)
    run, rng = compiled(law, options=OPTIMISED), np.random.default_rng(4)
    drawn = rng.standard_normal((6, 6))
    k = drawn @ drawn.T / 6.0 + np.eye(6) if full else np.diag([2.0] * 3 + [1.0] * 3) + np.pad(np.full((3, 3), 0.7), (0, 3))
    trials = rng.standard_normal((20, 6))
    known = duhem.project(law, trials, stiffness=k, method="newton", tangent=True)
    assert known.tangent is not None and set(known.status) <= {0, 1}
    told = 0
    for trial, stress, slip, slope in zip(trials, known.stress, known.slip, known.tangent, strict=True):
        status, *found, loss, tangent = run.one(trial, 0.0, k, [])
        assert found[0] == pytest.approx(stress, abs=1e-12) and found[1] == pytest.approx(slip, abs=1e-12)
        assert loss == pytest.approx(stress @ slip, abs=1e-12)
        assert status in (0, 1, 5) and np.isnan(tangent).all() == np.isnan(slope).all() == (status == 5)
        if status < 5:
            told += 1
            assert tangent == pytest.approx(slope, rel=1e-9, abs=1e-9)
    assert told == 20 if name == "hosford" else 5 <= told < 20  # edges of equal eigenvalues have no tangent


PYRAMID, CUBE = "abs(a) + abs(b) + abs(c) - 1", "max(abs(a), abs(b), abs(c)) - 1"
CAPS = "max(norm(a - 1/2, b, c), norm(a + 1/2, b, c)) - 1"  # a lens, whose edge is a circle


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "trial", "tangent"),
    long_at(
        [7, 8],
        [
            (PYRAMID, [1.5, 0.9, 0.8], np.eye(3) - 1.0 / 3.0),
            (PYRAMID, [1.5, 0.1, -0.2], np.zeros((3, 3))),
            (PYRAMID, [1.5, 1.4, 0.1], np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]) / 2.0),
            (CUBE, [2.0, 3.0, 0.5], np.diag([0.0, 0.0, 1.0])),
            (CUBE, [2.0, 3.0, 1e-9], np.diag([0.0, 0.0, 1.0])),
            (CUBE, [1e9, 1.0 + 1e-6, 0.5], np.diag([0.0, 0.0, 1.0])),
            (CUBE, [2.0, 3.0, 4.0], np.zeros((3, 3))),
            (CAPS, [0.0, 0.0, 3.0], np.diag([0.0, np.sqrt(0.75) / 3.0, 0.0])),
            (CAPS, [0.5, 0.0, 2.5], np.diag([0.0, np.sqrt(0.75) / 2.5, 0.0])),
        ],
    ),
)
def test_a_tangent_is_the_slope_on_faces_and_edges(g: str, trial: list[float], tangent: Any) -> None:
    run = compiled(Criterion(name="body", g=g, forces=("a", "b", "c"), pressure=None))
    status, *_, found = run.one(trial, 0.0, np.eye(3), [])
    assert status == 1 and found == pytest.approx(tangent, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "trial", "stress"),
    [
        *((PYRAMID, [size, 0.0, 0.0], [1.0, 0.0, 0.0]) for size in (1.5, 1.0 + 1e-9, 1e6)),  # four sides meet, and two are enough to press
        ("abs(a + sqrt(b**2 + c**2))**2 + abs(a - sqrt(b**2 + c**2))**2 - 2", [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]),  # a ball
    ],
)
def test_where_the_pieces_that_press_do_not_tell_there_is_no_tangent(g: str, trial: list[float], stress: list[float]) -> None:
    run = compiled(Criterion(name="body", g=g, forces=("a", "b", "c"), pressure=None))
    status, found, slip, loss, tangent = run.one(trial, 0.0, np.eye(3), [])
    assert status == 5 and np.isnan(tangent).all()
    assert found == pytest.approx(stress, abs=1e-12) and slip == pytest.approx(np.array(trial) - found, abs=1e-9)
    assert loss == pytest.approx(found @ slip)


@pytest.mark.slow
def test_where_nothing_presses_only_the_origin_is_left() -> None:
    run = compiled(duhem.load("coulomb"))
    k = np.array([[3.0, 0.5], [0.5, 1.0]])
    status, stress, slip, loss, tangent = run.one([3.0, -4.0], 0.0, k, [0.3])
    assert (status, loss) == (1, 0.0) and not stress.any() and not tangent.any()
    assert k @ slip == pytest.approx([3.0, -4.0])
    assert run.one([0.0, 0.0], 0.0, k, [0.3])[0] == 0


@pytest.mark.slow
def test_with_a_cohesion_more_is_left() -> None:
    run = compiled(duhem.load("cohesive"))
    known = duhem.project("cohesive", [3.0, -4.0], 0.0, 1.0, {"mu": 0.3, "cohesion": 0.5})
    values = {"mu": 0.3, "cohesion": 0.5}
    status, stress, *_ = run.one([3.0, -4.0], 0.0, EYE, [values[name] for name in run.parameters])
    assert status == 1 and stress == pytest.approx(known.stress[0], abs=1e-14)


RANGED = Criterion(
    name="ranged",
    g="norm(sigma_a, sigma_b) - (mu + nu)*abs(sigma_n)",
    parameters={"mu": Domain(positive=True), "nu": Domain.between(0, 1)},
    constraints=["nu < mu"],
    domain={"sigma_n": Domain.between(-10, None), "sigma_a": Domain.between(-1, 1)},
)


@pytest.mark.slow
def test_what_is_no_question_has_no_answer() -> None:
    run = compiled(RANGED)
    good: tuple[Any, ...] = ([0.5, 0.0], -1.0, EYE, [0.3, 0.1])
    assert run.one(*good)[0] == 1 and run.one([0.1, 0.0], *good[1:])[0] == 0
    matrices = [[2.0, 1.0], [0.5, 0.4], [np.nan, np.nan], [np.nan, 0.0]]
    stiff = [-EYE, 0.0 * EYE, *([[1.0, above], [below, 1.0]] for above, below in [(2.0, 2.0), *matrices])]
    bad: list[tuple[int, Any]] = [
        *((0, [x, 0.0]) for x in (np.nan, np.inf)),
        *((1, x) for x in (1e-300, -10.5, np.nan, -np.inf)),
        *((2, k) for k in stiff),
        *((3, x) for x in ([0.0, 0.0], [0.3, -0.1], [2.0, 1.5], [0.2, 0.3], [np.nan, 0.1], [np.inf, 0.1])),
    ]
    for place, value in bad:
        status, *answer = run.one(*(value if i == place else x for i, x in enumerate(good)))
        assert status == 3 and all(np.isnan(x).all() for x in answer), (place, value)
    status, stress, *_ = run.one([9.0, 0.0], -9.0, EYE, [0.3, 0.1])
    assert status == 4 and stress == pytest.approx([3.6, 0.0])


@pytest.mark.slow
def test_what_is_not_solved_has_no_answer() -> None:
    """A K without an inner point."""
    law = Criterion(name="line", g="abs(a - b)", forces=("a", "b"), pressure=None)
    run = compiled(law)
    status, *answer = run.one([9.0, 0.0], 0.0, EYE, [])
    assert status == 2 and all(np.isnan(x).all() for x in answer)
    assert run.one([3.0, 3.0], 0.0, EYE, [])[0] == 0


@pytest.mark.slow
def test_where_zero_stress_is_no_inner_point_another_is_found() -> None:
    law = Criterion(name="off", g="norm(a - x, b) - 1", forces=("a", "b"), pressure=None, parameters={"x": Domain(positive=True)})
    run = compiled(law)
    for x in (3.0, 1.0, 40.0):
        status, stress, slip, *_ = run.one([x + 6.0, 8.0], 0.0, EYE, [x])
        assert status == 1 and stress == pytest.approx([x + 0.6, 0.8], abs=1e-12) and slip == pytest.approx([5.4, 7.2], abs=1e-12)
        assert run.one([x + 0.1, 0.0], 0.0, EYE, [x])[0] == 0


@pytest.mark.slow
def test_results_may_take_the_places_of_what_is_given() -> None:
    run = compiled(duhem.load("coulomb"))
    trial, k, own = np.array([3.0, -4.0]), np.array([[3.0, 0.5], [0.5, 1.0]]), np.array([0.3])
    expected = run.one(trial, -1.0, k, own)
    slip, loss = np.empty(2), np.empty(1)
    status = run.run(*(x.ctypes.data if isinstance(x, np.ndarray) else x for x in (trial, -1.0, k, own, trial, slip, loss, k)))
    assert status == expected[0] and (trial == expected[1]).all() and (k == expected[4]).all()


@pytest.mark.slow
def test_no_state_and_no_memory_of_its_own() -> None:
    text = c_file(duhem.verify("antoni2007", claims=["convexity"]))
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    assert not re.search(r"\b(malloc|free|calloc|printf)\(", code)
    assert all(re.match(r"static (double|int|void) \w+\(", line) for line in code.splitlines() if line.startswith("static"))
    outside = [line for line in code.splitlines() if re.match(r"\w", line) and not line.startswith("static")]
    assert [line.split("(")[0] for line in outside if not line.startswith("enum")] == ["int antoni2007_increment"] * 2
    assert text == c_file(duhem.verify("antoni2007", claims=["convexity"]))


@pytest.mark.slow
def test_the_head_says_what_it_is() -> None:
    law = Criterion(
        name="Prévôt */ law",
        g="norm(sigma_a, sigma_b)/mu - abs(sigma_n)",
        parameters={"mu": Domain(positive=True)},
        summary="ends */ #error here /* what??/ and \\",
        source="A. Prévôt\n*/ (1999)",
    )
    done = duhem.verify(law)
    text = c_file(done)
    run = compiled(law, text=text)
    assert run.one([3.0, 4.0], -1.0, EYE, [0.5])[1] == pytest.approx([0.3, 0.4])
    assert identifier(law.name) == "pr_v_t_law" and identifier("2d") == "law_2d"
    head = " ".join(text[: text.index("*/")].replace("*", "").split())
    assert done.certificate()["sha256"] in head
    assert "convexity proved, checked: all parameters" in head and "parameters[0] is mu positive" in head
    assert max(map(len, text[: text.index("*/")].splitlines())) <= 104
    assert "??" not in text


@pytest.mark.parametrize(
    ("law", "why"),
    [
        (duhem.load("rotated-flow"), "its own flow direction"),
        (duhem.load("superellipse"), "--set p=VALUE"),
        (duhem.load("prager"), "more than a closest point of K, but an exported routine"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.name,
)
def test_what_has_no_routine_is_refused(law: Criterion, why: str) -> None:
    with pytest.raises(InputError, match=why):
        routine(law)


THROUGH = ["coulomb", "orthotropic", "tresca", "von-mises"]


@pytest.mark.long
@pytest.mark.parametrize("name", mostly_long(THROUGH, "coulomb"))
def test_a_user_puts_the_file_to_the_suite(name: str, tmp_path: Path) -> None:
    """By the prototype that its head gives, as any C is."""
    law, symbol = duhem.load(name), identifier(name)
    (tmp_path / "own.c").write_text(text := c_file(duhem.verify(law, claims=["convexity"])), "utf-8")
    (prototype,) = {" ".join(one.split()) for one in re.findall(rf"^int {symbol}_increment\(([^)]*)\)", text, re.M)}
    library = shared([tmp_path / "own.c"], with_=compiler("CC", "cc", "gcc", "clang"))
    update = shared_library(library._name, f"int {symbol}_increment({prototype})", solved=(0, 1))
    checks = ["inputs", "feasibility", "variational-inequality", "slip", "slope", "repeatability", "vacuity"]
    report = conformance(law, update, checks=checks, max_examples=2, rows=15, pressure=pressures(-1, 1).filter(bool))
    assert report.ok and {*report.passed} == {*checks} and report.flagged_share < 0.25, str(report)
    assert len(prototype.split(",")) == 8


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("isolated", [False, True])
def test_a_user_puts_the_umat_to_the_suite(isolated: bool, tmp_path: Path) -> None:
    law = Criterion(name="tensor", g="sqrt(3*J2) - 1", stress={"name": "sigma", "kind": "3d"}, pressure=None)
    k = np.diag([3.0, 3.0, 3.0, 1.0, 1.0, 1.0]) + 0.1
    material = umat(fortran(law, tmp_path)._name, k.ravel().tolist(), k, isolated=isolated)
    report = conformance(None, material, max_examples=2, rows=10)
    needed = {"inputs", "energy", "slope", "elasticity", "dissipation", "stored-energy", "rest", "subdivision", "vacuity"}
    assert report.ok and needed <= {*report.passed}, str(report)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("name", ["abaqus-linear", "drucker-prager-tensor", "hill48", "yoon"])
def test_an_exported_umat_satisfies_its_own_law(name: str, tmp_path: Path) -> None:
    """Tips too, where a law has many flows, or its formula no value."""
    law = at_simplest(name)
    d = len(law.forces)
    k = np.diag([2.0] * 3 + [1.0] * (d - 3)) + np.pad(np.full((3, 3), 0.7), (0, d - 3))
    material = umat(fortran(law, tmp_path)._name, k.ravel().tolist(), k, ntens=d, isolated=False)
    report = conformance(law, material, max_examples=6, seed=1, most_flagged=0.1)
    assert report.ok and {"flow", "loading", "admissibility", "slope", "energy"} <= {*report.passed}, str(report)


CIRCLE = duhem.ParametricCriterion("circle", ("cos(phi)", "sin(phi)"))  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_set_that_is_not_convex_is_refused() -> None:
    done = duhem.verify("quartic", claims=["convexity"])
    for write in (c_file, fortran_file):
        with pytest.raises(InputError, match="convexity is refuted"):
            write(done)
    with pytest.raises(InputError, match="boundary curve"):
        c_file(duhem.verify(CIRCLE, claims=["origin"]))


def fortran(law: Criterion, folder: Path) -> ctypes.CDLL:
    """The subroutine, linked with the C file; skipped without a compiler of Fortran."""
    done = duhem.verify(law, claims=["convexity"])
    return with_fortran(folder, c_file(done), fortran_file(done))


def call(subroutine: Any, *arguments: Any) -> None:
    """With a place for each argument: floats and ints as arrays of one."""
    kept = [x if isinstance(x, np.ndarray) else np.array(x, dtype=np.int32 if isinstance(x, int) else float) for x in arguments]
    subroutine(*(ctypes.c_void_p(x.ctypes.data) for x in kept))


@pytest.mark.slow
def test_fric_is_the_increment(tmp_path: Path) -> None:
    law = duhem.load("coulomb")
    library, run = fortran(law, tmp_path), compiled(law)
    k, tau, gamma = np.array([[3.0, 0.5], [0.5, 1.0]]), np.array([0.1, 0.2]), np.array([1.0, -2.0])
    trial = tau + k @ gamma
    expected = run.one(trial, -2.0, k, [0.3])
    slope, of_pressure, slip, loss, room = np.empty((2, 2)), np.empty(2), np.empty(2), np.empty(1), np.zeros(80)
    half = np.ones(1)
    ends = [room] * 27
    call(library.fric_, 7, tau, slope, of_pressure, slip, room, loss, room, half, room, gamma, room, 2.0, *ends[:19], 2, 2, 1, 1, room,
         np.array([*k.ravel(), 0.3]), 5)  # fmt: skip
    assert half == 1.0
    for found, known in ((tau, expected[1]), (slip, expected[2]), (loss[0], expected[3]), (slope, expected[4])):
        assert found == pytest.approx(known, abs=1e-15)
    known = duhem.project(law, trial, -2.0, k, {"mu": 0.3}, tangent=True)
    assert known.tangent_pressure is not None and of_pressure == pytest.approx(-known.tangent_pressure[0], rel=1e-8)


@pytest.mark.slow
def test_umat_has_the_order_of_its_caller(tmp_path: Path) -> None:
    law = Criterion(name="tensor", g="sqrt(3*J2 + sigma_yz**2) - 1", stress={"name": "sigma", "kind": "3d"}, pressure=None)
    library, run = fortran(law, tmp_path), compiled(law)
    k = np.diag([3.0, 3.0, 3.0, 1.0, 1.0, 1.0]) + 0.1
    strain, stress = np.array([0.5, -0.2, 0.1, 0.9, 0.3, -0.7]), np.zeros(6)
    there = [0, 1, 2, 5, 4, 3]  # xx yy zz yz xz xy among xx yy zz xy xz yz
    expected = run.one((k @ strain)[there], 0.0, k, [])
    slope, loss, room, half = np.empty((6, 6)), np.zeros(1), np.zeros(80), np.ones(1)
    call(library.umat_, stress, room, slope, room, loss, *[room] * 6, strain, *[room] * 7, 3, 3, 6, 1, k.copy(), 36, room, room, half,
         *[room] * 9)  # fmt: skip
    assert expected[0] == 1 and half == 1.0
    assert stress[there] == pytest.approx(expected[1], abs=1e-15) and loss == pytest.approx(expected[3], abs=1e-15)
    rounding = 4 * np.finfo(float).eps * k.max()  # the same sums in another order
    assert slope[np.ix_(there, there)] == pytest.approx(expected[4], abs=rounding)


TRESCA = duhem.load("tresca").fix({"yield_stress": 1})


@pytest.fixture(scope="module")
def umat_of_tresca(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return fortran(TRESCA, tmp_path_factory.mktemp("tresca"))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_umat_goes_on_through_plasticity_edges_and_unloading(seed: int, umat_of_tresca: ctypes.CDLL) -> None:
    k = np.diag([3.0, 3.0, 3.0]) + 0.5
    ask, chance = duhem.prepare(TRESCA, k), np.random.default_rng(seed)
    stress, slope, loss, room = np.zeros(3), np.empty((3, 3)), np.zeros(1), np.zeros(80)
    way = chance.standard_normal(3)
    way[1] = way[0] if seed % 2 else way[1]  # onto an edge, where the tangent is not known
    steps = [*[way / 4] * 6, *[-way / 4] * 10, *(0.3 * chance.standard_normal((6, 3)))]
    for strain in steps:
        expected, half = ask(stress + k @ strain), np.ones(1)
        call(umat_of_tresca.umat_, stress, room, slope, room, loss, *[room] * 6, strain.copy(), *[room] * 7, 3, 0, 3, 1, k.copy(), 9, room,
             room, half, *[room] * 9)  # fmt: skip
        assert half == 1.0 and np.isfinite(slope).all() and stress == pytest.approx(expected.stress, abs=1e-12)


def test_a_tangent_that_is_not_known_is_the_stiffness() -> None:
    for name in ("coulomb", "tresca"):
        text = fortran_file(duhem.verify(name, claims=["convexity"]))
        assert "if (status > 1 .and. status /= 5) then" in text and "if (status == 5) dd" in text
        assert max(map(len, text.splitlines())) <= 132  # what a line of Fortran may have


def test_ranges_of_the_exported_closed_form_are_those_of_the_closed_form() -> None:
    """The C text cannot import them: it has the numbers under names of its own."""
    assert (increment_kernel.WIDE, increment_kernel.DIGITS) == (quarter_ellipse.SAFE, quarter_ellipse.NEAR)
