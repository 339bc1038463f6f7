"""One example of each kind of foreign routine; the five kinds of mistakes of public code in C, C++ and Fortran, and right twins."""

from __future__ import annotations

import shutil
import subprocess
import sys
import sysconfig
from functools import cache
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pytest
from hypothesis.strategies import sampled_from

from duhem.errors import InputError
from duhem.testing import Report, conformance, decades
from duhem.testing.foreign import jax_routine, mgis_material, shared_library, umat
from duhem.testing.foreign.shared import built
from tests.export.shared_library import compiler
from tests.long import mostly_long
from tests.testing.examples import elastic
from tests.testing.foreign.vumat_blocks import vumat
from tests.testing.hardening import law

HERE = Path(__file__).parent / "foreign"
STEEL = [200e3, 0.3, 250.0, 1000.0]
FEW: dict[str, Any] = {"max_examples": 4, "rows": 8, "tries": 10, "seed": 1}
DISK: dict[str, Any] = {
    "law": "coulomb",
    "stiffness": decades(-3, 3).map(lambda k: k * np.eye(2)),
    "max_examples": 3,
    "seed": 1,
    "tries": 20,
}
POINTS = "void friction(int n, const double *trial, const double *pressure, double mu, double *stress)"


@cache
def compiled(name: str, language: str, folder: Path) -> Path:
    """The library made of a source by the compiler of C or of C++."""
    named = {"c": ("CC", "cc", "gcc", "clang"), "c++": ("CXX", "c++", "g++", "clang++")}[language]
    made = folder / f"{Path(name).stem}-{len(language)}.so"
    strict = ("-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC")
    subprocess.run([compiler(*named), *strict, "-x", language, str(HERE / name), "-o", str(made), "-lm"], check=True)
    return made


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("foreign")


FORTRAN = HERE / "defects.f"  # compiled as a user's is


def judged(language: str, folder: Path, mistake: int) -> Report:
    fixed = language == "fortran"
    if fixed:
        compiler("FC", "gfortran")
    library = built(FORTRAN) if fixed else compiled("defects.c", language, folder)
    if mistake == 5 or mistake == -1:  # the disk, at its tip
        signature = "void friction(const double *trial, double pressure, double mu, double mistake, double *stress)"
        if fixed:
            signature = "void friction_(const double *trial, double *pressure, double *mu, double *mistake, double *stress)"
        update = shared_library(library, signature, parameters={"mistake": float(mistake)})
        checks = ["vacuity", "feasibility", "variational-inequality", "complementarity"]
        return conformance(**DISK | {"max_examples": 6, "pressure": sampled_from([-1.0, 0.0])}, update=update, checks=checks)
    state = {"p": 0} | ({"u_in": slice(1, 7)} if fixed else {})
    given: dict[str, Any] = {"nstatv": 7 if fixed else 1, "state": state, "isolated": mistake in (4, 7, 8, 9), "seconds": 2.0}
    material = umat(FORTRAN if fixed else library, [*STEEL, mistake], elastic(*STEEL[:2]), **given)
    return conformance(law("isotropic"), material, {"R": 250.0, "H": 1000.0}, **FEW)


# the number of the mistake, the check that tells it, and words that name it
KINDS = {
    "another order of components": (1, "slope", "the tangent is wrong in"),
    "flow in unloading": (2, "loading", "it flows with g = -"),
    "negative dissipation": (3, "dissipation", "no step has negative dissipation"),
    "a crash in the error path": (4, "vacuity", "ended its process by SIGSEGV"),
    "an absolute threshold at the tip": (5, "feasibility", "at the tip"),
}


EVERY = [(kind, language) for kind in KINDS for language in ("c", "c++", "fortran")]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "language"), mostly_long(EVERY, EVERY[0], EVERY[11], EVERY[13]))
def test_each_kind_of_mistake_of_public_code_is_found_and_named(kind: str, language: str, folder: Path) -> None:
    mistake, check, words = KINDS[kind]
    report = judged(language, folder, mistake)
    failure = report.failure_of(check)
    assert failure is not None and words in str(failure), str(report)
    assert (mistake, language) != (4, "fortran") or "it printed: ***ERROR - SINGULAR MATRIX" in str(failure)


# what a source in Fortran has more: the number, and words of the report
MORE = {
    6: "a single-precision literal?",
    8: "exit code 0; it printed: ***ERROR - STRAIN TOO LARGE",
    9: "not answered within 2 s; it printed: ***ERROR - NO CONVERGENCE",
}


@pytest.mark.slow
@pytest.mark.parametrize("mistake", mostly_long(MORE, 8))
def test_what_fortran_alone_does_is_told_soon_and_quietly(mistake: int, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    begun = monotonic()
    report = judged("fortran", folder, mistake)
    assert not report.ok and MORE[mistake] in str(report) and monotonic() - begun < 60.0
    assert capfd.readouterr() == ("", "")


def test_a_source_in_fortran_that_cannot_be_run_is_told(tmp_path: Path) -> None:
    compiler("FC", "gfortran")
    file = tmp_path / "umat.for"
    file.write_text("      SUBROUTINE UMAT(A\n      END\n", "utf-8")
    with pytest.raises(InputError, match=r"(?s)gfortran refuses it:\n.*Error: ") as told:
        umat(file)
    assert "cc1" not in str(told.value)
    file.write_text("      SUBROUTINE UMAT(A)\n      CALL GETRANK(I)\n      END\n", "utf-8")
    with pytest.raises(InputError, match="undefined symbol: getrank_; add what is missing"):
        umat(file)


@pytest.mark.long
def test_an_error_that_ends_abaqus_is_an_increment_that_is_not_solved(folder: Path) -> None:
    report = judged("fortran", folder, 7)
    assert report.ok and report.flagged and "slope" in report.passed, str(report)


@pytest.mark.parametrize("language", mostly_long(["c", "c++", "fortran"], "c", "fortran"))
def test_their_right_twins_pass(language: str, folder: Path) -> None:
    for twin in (0, -1):
        report = judged(language, folder, twin)
        assert report.ok and report.visited["slip"] > 0.2, str(report)


def test_a_routine_in_cpp_behind_a_c_function(folder: Path) -> None:
    report = conformance(**DISK, update=shared_library(compiled("friction.cpp", "c++", folder), POINTS))
    assert report.ok and report.visited["slip"] > 0.2, str(report)


@pytest.mark.slow
def test_a_module_of_pybind(folder: Path) -> None:
    pybind = pytest.importorskip("pybind11")
    made = folder / f"friction_pybind{sysconfig.get_config_var('EXT_SUFFIX')}"
    places = [f"-I{place}" for place in (sysconfig.get_paths()["include"], pybind.get_include())]
    command = [compiler("CXX", "c++", "g++", "clang++"), "-std=c++17", "-shared", "-fPIC", *places, str(HERE / "friction_pybind.cpp")]
    subprocess.run([*command, "-o", str(made)], check=True)
    spec = spec_from_file_location("friction_pybind", made)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)

    def update(trial: np.ndarray, pressure: np.ndarray, stiffness: np.ndarray, mu: float) -> np.ndarray:
        return np.asarray(module.friction(trial, pressure, stiffness, mu))

    report = conformance(**DISK, update=update)
    assert report.ok and report.visited["slip"] > 0.2, str(report)


def test_a_vumat_in_blocks(folder: Path) -> None:
    """A function of C with the arguments of a VUMAT; no Abaqus has called it."""
    given: dict[str, Any] = {"parameters": {"R": 250.0, "H": 1000.0}, "state": {"p": 0}, **FEW}
    library = compiled("vumat.c", "c", folder)
    report = conformance(law("isotropic"), vumat(library, [*STEEL, 1.0], 1), **given)
    assert report.ok and {"flow", "evolution", "admissibility"} <= {*report.passed}, str(report)
    report = conformance(law("isotropic"), vumat(library, [*STEEL, 2.0], 1), **given)
    assert "p is advanced twice" in report.failures[0].diagnosis, str(report)


@pytest.mark.slow
def test_jax_compiles_for_few_numbers_of_increments() -> None:
    jnp = pytest.importorskip("jax.numpy")
    sizes = set()

    def step(trial: Any, pressure: Any, stiffness: Any, mu: Any) -> Any:
        size = jnp.sqrt(jnp.maximum(trial @ trial, 1e-300))
        return trial * jnp.minimum(1.0, -mu * pressure / size)

    update = jax_routine(step)
    for n in range(1, 70):
        trial = np.random.default_rng(n).normal(size=(n, 2))
        found = update(trial, -np.ones(n), np.eye(2), mu=0.3)
        assert found.stress.shape == (n, 2) and found.tangent.shape == (n, 2, 2)  # type: ignore[union-attr]
        sizes.add(found.stress.base.shape[0] if found.stress.base is not None else n)  # type: ignore[union-attr]
    assert sizes == {16, 32, 64, 128}
    report = conformance(**DISK, update=update)
    assert report.ok and "slope" in report.passed, str(report)


@pytest.mark.slow
def test_a_behaviour_of_mfront(folder: Path) -> None:
    """Never run so far: it is left out where MGIS and mfront are not installed, as on every machine that has run these tests."""
    if find_spec("mgis") is None or shutil.which("mfront") is None:
        pytest.skip("mgis and mfront are not installed")
    subprocess.run(["mfront", "--obuild", "--interface=generic", str(HERE / "plasticity.mfront")], cwd=folder, check=True)
    properties = dict(zip(("YoungModulus", "PoissonRatio", "R", "H"), STEEL, strict=True))
    library = next(folder.glob(f"src/*{'.dylib' if sys.platform == 'darwin' else '.so'}"))
    report = conformance(None, mgis_material(library, "HardeningSteel", elastic(*STEEL[:2]), properties=properties), **FEW)
    assert report.ok and report.visited["slip"] > 0.2, str(report)
