"""Routines of C and Fortran as the suite calls them: what they are given, what comes back, and what is said where they fail."""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from duhem import Criterion, Domain
from duhem.errors import InputError
from duhem.testing import Material, MaterialState, conformance, decades, from_material, violation
from duhem.testing.foreign import jax_routine, mgis_material, shared_library, shared_material, umat
from duhem.testing.foreign.native import NativeFault
from duhem.testing.foreign.shared import Prototype, rotation
from duhem.testing.routines import Unfinished
from tests.export.shared_library import compiler
from tests.long import mostly_long
from tests.testing.examples import MISES, STEEL, elastic, friction, interface, library, mises, written

BATCHED = """
#include <math.h>
#include <stdlib.h>
#include <unistd.h>
void many(int n, int d, const double *trial, const double *pressure, double mu, double *stress, int *status) {
    for (int i = 0; i < n; i++) {
        double size = 0;
        for (int j = 0; j < d; j++) size += trial[d * i + j] * trial[d * i + j];
        const double share = fmin(1, -mu * pressure[i] / sqrt(size));
        for (int j = 0; j < d; j++) stress[d * i + j] = size > 0 ? share * trial[d * i + j] : 0;
        status[i] = trial[d * i] > 1e3;
    }
}
void crash(const double *trial, double *stress) { stress[0] = trial[0] > 2 ? *(volatile double *)0 : trial[0]; }
void leaves(const double *trial, double *stress) { if (trial[0] > 2) exit(3); stress[0] = trial[0]; }
void endless(const double *trial, double *stress) { while (trial[0] > 2) sleep(1); stress[0] = trial[0]; }
void clobbers(double *trial, double *pressure, double *stiffness, double *mu, double *stress, double *slip) {
    for (int i = 0; i < 2; i++) slip[i] = 0, stress[i] = trial[i];
    if (mu[0] == 1) trial[1] = 0;
    if (mu[0] == 2) pressure[0] = 1;
    if (mu[0] == 3) stiffness[3] += 1;
    if (mu[0] == 4) mu[0] = 5;
    if (mu[0] == 6) stress[2] = 0;
    if (mu[0] == 7) slip[-1] = 1, trial[0] = 1;
}
"""
CLOBBERS = "void clobbers(double *trial, double *pressure, double *stiffness, double *mu, double *stress, double *slip)"


@pytest.fixture(scope="module")
def many() -> Path:
    return written(BATCHED)


def test_one_increment_a_call_and_many_a_call_answer_alike(many: Path) -> None:
    trial, pressure = np.random.default_rng(0).normal(size=(50, 2)), -np.linspace(0.0, 3.0, 50)
    k, one = np.eye(2), friction()["update"]
    batched = shared_library(
        many, "void many(int n, int d, const double *trial, const double *pressure, double mu, double *stress, int *status)"
    )
    far = np.vstack([trial, [[2e3, 1.0]]])
    by_batch = batched(far, np.append(pressure, -1.0), k, mu=0.3)
    by_row = one(trial, pressure, k, mu=0.3)
    limit = -0.3 * pressure[:, None]
    size = np.linalg.norm(trial, axis=1, keepdims=True)
    np.testing.assert_allclose(by_row.stress, np.where(size <= limit, trial, trial / size * limit), atol=1e-15)
    np.testing.assert_allclose(by_batch.stress[:-1], by_row.stress, atol=1e-15)
    assert by_batch.solved.tolist() == [True] * 50 + [False] and by_batch.slip is None


def test_friction_in_c_satisfies_its_law() -> None:
    report = conformance("coulomb", friction()["update"], stiffness=decades(-3, 3).map(lambda k: k * np.eye(2)), max_examples=1)
    assert report.ok and {"slope", "slip", "energy"} <= set(report.passed), str(report)


def test_mises_in_c_satisfies_its_law() -> None:
    """Without hardening, against the criterion in the same components."""

    def made(stiffness: np.ndarray, R: float) -> object:
        own = STEEL | {"E": stiffness[0, 0] / elastic(1.0, 0.3)[0, 0], "yield": R, "H": 0.0}
        return shared_material(library("mises.c"), MISES, stiffness, variables=[0.0], parameters=own)

    g = "sqrt(((a - b)**2 + (b - c)**2 + (c - a)**2)/2 + 3*(d**2 + e**2 + f**2)) - R"
    law = Criterion("J2", g, {"R": Domain(positive=True)}, ("a", "b", "c", "d", "e", "f"), None)
    report = conformance(law, from_material(made), stiffness=elastic(1.0, 0.3), max_examples=1, rows=10, tries=20)
    assert report.ok and "slope" in report.passed, str(report)


def test_a_umat_is_given_its_arguments_in_their_order() -> None:
    """Interface by hand: normal -5, shear elastic (4, 6), limit 1 + 0.4 * 5 = 3."""
    material = interface()["update"]
    after = material.advance(material.virgin(1), np.array([[-1.0, 2.0, 3.0]]), None, 1.0)
    way = np.array([2.0, 3.0]) / np.sqrt(13.0)
    slip = (np.sqrt(52.0) - 3.0) / 2.0
    np.testing.assert_allclose(after.stress, [[-5.0, *(3.0 * way)]])
    np.testing.assert_allclose(after.variables, [[slip]])
    np.testing.assert_allclose([after.stored, after.dissipated], [[25.0 / 10.0 + 9.0 / 4.0], [3.0 * slip]])
    np.testing.assert_allclose(after.tangent[0, 1:, 0], -0.4 * 5.0 * way)  # not that of the transposed
    again = material.advance(after, np.zeros((1, 3)), None, 1.0)
    np.testing.assert_allclose([again.stress, after.stress + 0.0], [after.stress, again.stress])


def test_material_axes_turn_strains_stresses_and_tangents() -> None:
    """T against the product of tensors."""
    rng = np.random.default_rng(1)
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    s = rng.normal(size=(3, 3))
    s += s.T
    places = ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2])
    np.testing.assert_allclose(rotation(q) @ s[places], (q @ s @ q.T)[places], atol=1e-14)
    shears = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    turned = np.linalg.inv(rotation(q)).T @ (shears * s[places])
    np.testing.assert_allclose(turned, shears * (q @ s @ q.T)[places], atol=1e-14)


UMAT = """
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops)
  implicit none
  integer :: ndi, nshr, ntens, nstatv, nprops
  character(len=80) :: cmname
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops)
  ddsdde = reshape(props, [6, 6])
  stress = stress + matmul(ddsdde, dstran)
  sse = dot_product(stress, stran + dstran)/2
end subroutine
"""


def test_an_anisotropic_umat_in_axes_of_its_own(tmp_path: Path) -> None:
    """Elastic, stiffest along its first axis: loaded along the second with axes turned by a right angle, it answers as stiffly."""
    source = tmp_path / "elastic.f90"
    source.write_text(UMAT, "utf-8")
    subprocess.run([compiler("FC", "gfortran"), "-shared", "-fPIC", str(source), "-o", str(tmp_path / "elastic.so")], check=True)
    k = np.diag([9.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    k[0, 1] = k[1, 0] = 1.0
    k[0, 3] = k[3, 0] = 0.5
    material = umat(tmp_path / "elastic.so", list(k.T.ravel()), np.eye(6), axes=[[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    after = material.advance(material.virgin(1), np.array([[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]]), None, 1.0)
    np.testing.assert_allclose(after.stress, [[1.0, 9.0, 0.0, -0.5, 0.0, 0.0]], atol=1e-14)
    np.testing.assert_allclose(after.tangent[0] @ [0.0, 1.0, 0.0, 0.0, 0.0, 0.0], after.stress[0], atol=1e-14)
    np.testing.assert_allclose(after.stored, [4.5])


ENDS = [("crash", "by SIGSEGV"), ("leaves", "with exit code 3")]


@pytest.mark.slow
@pytest.mark.parametrize(("symbol", "how"), ENDS)
def test_what_ends_its_process_is_told_and_the_next_call_is_answered(many: Path, symbol: str, how: str) -> None:
    update = shared_library(many, f"void {symbol}(const double *trial, double *stress)", isolated=True)
    assert update(np.array([[1.0]]), None, np.eye(1)).stress.tolist() == [[1.0]]
    with pytest.raises(NativeFault, match=rf"{symbol} of .*\.so ended its process {how}"):
        update(np.array([[1.0], [3.0]]), None, np.eye(1))
    assert update(np.array([[-1.0]]), None, np.eye(1)).stress.tolist() == [[-1.0]]


SPOILT = [(0, ""), (1, "trial"), (2, "pressure"), (3, "stiffness"), (4, "mu"), (6, "beside stress"), (7, "trial, beside slip")]


@pytest.mark.parametrize("isolated", [False, True])
def test_what_a_library_overwrites_is_told(many: Path, isolated: bool) -> None:
    update = shared_library(many, CLOBBERS, isolated=isolated)
    trial, pressure, k = np.array([[1.5, 2.5], [3.5, 4.5]]), np.array([-1.0, -2.0]), np.eye(2)
    for mu, said in SPOILT:
        found = update(trial, pressure, k, mu=float(mu))
        assert found.stress.tolist() == trial.tolist() == [[1.5, 2.5], [3.5, 4.5]] and k.tolist() == [[1.0, 0.0], [0.0, 1.0]]
        assert (found.overwritten is None) if not said else (found.overwritten.tolist() == [said] * 2)


@pytest.mark.parametrize(("mu", "said"), mostly_long(SPOILT, (0, ""), (7, "trial, beside slip")))
def test_a_library_that_overwrites_is_refused(many: Path, mu: int, said: str) -> None:
    update = shared_library(many, CLOBBERS)
    options = {"stiffness": [2.0, 3.0], "pressure": -1.0, "checks": ["inputs"], "max_examples": 1, "rows": 3, "tries": 5}
    report = conformance(None, update, {"mu": float(mu)}, **options)
    assert report.failed == ({"inputs"} if said else set())
    assert all(f.message == f"overwritten: {said}" for f in report.failures)


def test_a_material_that_overwrites_its_state_is_refused() -> None:
    def advance(before: MaterialState, increment: np.ndarray, pressure: object, duration: float) -> MaterialState:
        before.stress[...] += 2.0 * increment
        return MaterialState(before.strain + increment, before.stress, before.variables)

    report = conformance(None, Material(advance, [[2.0]]), checks=["inputs"], max_examples=1, rows=3, tries=5)
    assert [f.message for f in report.failures] == ["overwritten: stress before the step"]


def test_a_umat_that_overwrites_what_it_is_given_is_told(tmp_path: Path) -> None:
    source = tmp_path / "spoils.f90"
    source.write_text(UMAT.replace("  sse =", "  dstran(6) = 0; statev(3) = 1; dtime = 7\n  sse ="), "utf-8")
    subprocess.run([compiler("FC", "gfortran"), "-shared", "-fPIC", str(source), "-o", str(tmp_path / "spoils.so")], check=True)
    material = umat(tmp_path / "spoils.so", list(np.eye(6).ravel()), np.eye(6), variables=[0.0, 0.0])
    after = material.advance(material.virgin(2), np.ones((2, 6)), None, 1.0)
    assert after.overwritten is not None and after.overwritten.tolist() == ["DSTRAN, DTIME, beside STATEV"] * 2
    assert after.variables.tolist() == [[0.0, 0.0]] * 2


@pytest.mark.slow
def test_a_call_without_end_is_an_error_that_names_its_increment(many: Path, tmp_path: Path) -> None:
    update = shared_library(many, "void endless(const double *trial, double *stress)", isolated=True, seconds=0.5)
    assert update(np.array([[1.0]]), None, np.eye(1)).stress.tolist() == [[1.0]]
    # with a scale, as else the search for it would end the run first
    options = {"stiffness": [1.0], "scale": 1.0, "max_examples": 3, "rows": 4, "tries": 5, "seed": 0}
    report = conformance(None, update, **options)
    failure = report.unfinished
    assert (
        not report.ok
        and failure is not None
        and re.search(r"endless of .*\.so has not answered within 0\.5 s; check its loops", report.ended)
    )
    assert failure.case.trial[0, 0] > 2 or failure.case.path.max() > 2
    assert report.ended.startswith("Unfinished: trial [") and f"in the check {failure.check.name}" in report.ended
    (tmp_path / "test_replay.py").write_text(failure.replay(), "utf-8")
    with pytest.raises(Unfinished):
        runpy.run_path(str(tmp_path / "test_replay.py"))[f"test_{failure.check.name.replace('-', '_')}"]()
    assert update(np.array([[1.5]]), None, np.eye(1)).stress.tolist() == [[1.5]]


@pytest.mark.slow
@pytest.mark.parametrize(("symbol", "how"), mostly_long(ENDS))
def test_a_crash_is_a_failed_check(many: Path, symbol: str, how: str) -> None:
    update = shared_library(many, f"void {symbol}(const double *trial, double *stress)", isolated=True)
    report = conformance(None, update, stiffness=[1.0], max_examples=2, rows=10, tries=20)
    assert report.failed == {"answers"} and how in report.failures[0].message, str(report)
    assert violation("answers", None, update, report.failures[0].case) == report.failures[0].message


def test_a_replay_moves_with_its_library(many: Path, tmp_path: Path) -> None:
    """The folder of both is renamed; the library is found there, and the failure shows again."""
    first, moved = tmp_path / "first", tmp_path / "moved"
    (first / "build").mkdir(parents=True)
    copied = Path(shutil.copy(many, first / "build" / "lib.so"))
    update = shared_library(copied, CLOBBERS)
    options = {"stiffness": [2.0, 3.0], "pressure": -1.0, "checks": ["inputs"], "max_examples": 1, "rows": 3, "tries": 5}
    (file,) = conformance(None, update, {"mu": 1.0}, **options).write_replays(first / "replays")
    first.rename(moved)
    replay = moved / "replays" / file.name
    assert str(tmp_path) not in replay.read_text("utf-8")
    with pytest.raises(AssertionError, match="overwritten: trial"):
        runpy.run_path(str(replay))["test_inputs"]()


def test_what_the_routine_leaves_out_is_not_a_number(many: Path) -> None:
    update = shared_library(many, "void crash(const double *trial, double *stress, double *slip)")
    assert np.isnan(update(np.ones((2, 1)), None, np.eye(1)).slip).all()


WRONG = {
    "void f(float *trial, double *stress)": "'float \\*trial' is not understood",
    "double f(double *trial, double *stress)": "not the prototype",
    "void f(double *trial)": "no argument 'stress'",
    "void f(double *stress)": "no argument 'trial'",
    "void f(double *trial, double stress)": "'double stress' cannot be written to",
    "void f(double trial, double *stress)": "one number",
    "void f(double *trial, double *stress, double *stress)": "named twice",
    "void f(double *trial, double *stress, double n)": "n, d and status are integers",
    "void f(double *trial, double *stress, int mu)": "all else is double",
    "void f(double *trial, double *stress, double *strain)": "'strain' is not known to a routine given trial",
    "void f(int n, double *trial, double pressure, double *stress)": "one pressure for n increments",
}


@pytest.mark.parametrize("text", WRONG)
def test_a_prototype_that_is_none_is_told(text: str) -> None:
    with pytest.raises(InputError, match=WRONG[text]):
        Prototype.read(text, "trial")


def test_what_is_missing_is_told(many: Path, tmp_path: Path) -> None:
    plain = "void {}(const double *trial, double *stress)"
    with pytest.raises(InputError, match=r"there is no such file; give the path"):
        shared_library(tmp_path / "none.so", plain.format("f"))
    for isolated in (False, True):  # the second in a process of its own
        with pytest.raises(InputError, match=r"has no symbol 'nothing'; name an exported function"):
            shared_library(many, plain.format("nothing"), isolated=isolated)
    (tmp_path / "text.so").write_text("no library", "utf-8")
    with pytest.raises(InputError, match="cannot be loaded"):
        shared_library(tmp_path / "text.so", plain.format("f"))
    one = np.ones((1, 2))
    with pytest.raises(InputError, match="argument 'mu': it is neither a known name nor a parameter"):
        friction()["update"](one, -one[:, 0], np.eye(2))
    with pytest.raises(InputError, match="no argument for the parameter 'c'"):
        friction()["update"](one, -one[:, 0], np.eye(2), mu=0.3, c=1.0)
    with pytest.raises(InputError, match="4 direct stresses among 3"):
        umat(many, [], np.eye(3), symbol="crash", direct=4)
    with pytest.raises(InputError, match="material axes with 3 components"):
        umat(many, [], np.eye(3), symbol="crash", direct=1, axes=np.eye(3))
    with pytest.raises(InputError, match="no rotation"):
        umat(many, [], np.eye(6), symbol="crash", axes=2 * np.eye(3))
    with pytest.raises(InputError, match="symmetric, positive definite"):
        umat(many, [], -np.eye(6), symbol="crash")
    with pytest.raises(InputError, match="a material contains its own stiffness; give"):
        conformance(None, mises()["update"], stiffness=[1.0])
    with pytest.raises(InputError, match=r"the law has 2 components of stress .*, and the routine 6"):
        conformance("coulomb", mises()["update"], {"mu": 0.3})
    with pytest.raises(InputError, match="must give the number of forces"):
        conformance(None, friction()["update"])


@pytest.mark.parametrize(("module", "make"), [("jax", lambda: jax_routine(abs)), ("mgis", lambda: mgis_material("a.so", "A", np.eye(6)))])
def test_what_is_not_installed_is_told(module: str, make: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setattr("duhem.testing.foreign.find_spec", lambda _: None)
    with pytest.raises(InputError, match=f"{module} is not installed; install"):
        make()


def test_a_function_of_jax() -> None:
    jnp = pytest.importorskip("jax.numpy")

    def step(trial, pressure, stiffness, mu):  # type: ignore[no-untyped-def]
        size = jnp.sqrt(jnp.maximum(trial @ trial, 1e-300))
        return trial * jnp.minimum(1.0, -mu * pressure / size)

    report = conformance("coulomb", jax_routine(step), stiffness=decades(-3, 3).map(lambda k: k * np.eye(2)), max_examples=3)
    assert report.ok and "slope" in report.passed, str(report)


@pytest.mark.parametrize("word", ["restrict", "__restrict", "__restrict__", "const __restrict__"])
def test_a_pointer_may_be_restricted(word: str) -> None:
    read = Prototype.read(f"void f(int n, const double *{word} trial, const double* {word} pressure, double *{word} stress)", "trial")
    assert [each.kind for each in read.arguments] == ["i", "p", "p", "p"] and read.arguments[2].name == "pressure"
