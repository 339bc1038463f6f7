"""The shipped examples in C and Fortran, compiled by the machine's compilers, right and with each of their bugs."""

from __future__ import annotations

import atexit
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np

import duhem.testing.foreign
from duhem.testing.foreign import shared_library, shared_material, umat
from tests.export.shared_library import compiler

__all__ = ["BUGS", "EXAMPLES", "FRICTION", "MISES", "compiled_with", "elastic", "friction", "interface", "library", "mises", "written"]

SHIPPED = Path(duhem.testing.foreign.__file__).parent / "examples"
FRICTION = (
    "int friction(const double *trial, double pressure, const double *stiffness, double mu, double *stress, double *slip, double *tangent)"
)
MISES = (
    "int mises(const double *increment, double *stress, double *variables, double *stored, double *dissipated, double *tangent,"
    " double duration, double E, double nu, double yield, double H)"
)
STEEL = {"E": 2.1e11, "nu": 0.3, "yield": 2.5e8, "H": 1e9}


@cache
def _folder() -> Path:
    made = Path(mkdtemp(prefix="duhem-examples-"))
    atexit.register(shutil.rmtree, made, ignore_errors=True)  # Windows keeps what is loaded
    return made


@cache
def library(name: str, bug: int = 0) -> Path:
    """One example, compiled without a warning; the test is skipped without a compiler for it."""
    made = _folder() / f"{Path(name).stem}-{bug}.so"
    strict = ("-Wall", "-Werror", f"-DBUG={bug}", "-O2", "-shared", "-fPIC")
    if name.endswith(".c"):
        command = [compiler("CC", "cc", "gcc", "clang"), "-std=c99", "-Wextra", "-pedantic", *strict, str(SHIPPED / name), "-lm"]
    else:
        command = [compiler("FC", "gfortran"), "-cpp", "-Wno-unused-dummy-argument", *strict, str(SHIPPED / name)]
    subprocess.run([*command, "-o", str(made)], check=True)
    return made


@cache
def written(source: str) -> Path:
    """A library made of text in C."""
    file = _folder() / f"written{sha256(source.encode()).hexdigest()[:8]}.c"
    file.write_text(source, "utf-8")
    made = file.with_suffix(".so")
    subprocess.run([compiler("CC", "cc", "gcc", "clang"), "-O2", "-shared", "-fPIC", str(file), "-o", str(made), "-lm"], check=True)
    return made


@cache
def compiled_with(source: Path, bug: int, other: int | None = None) -> Path:
    """A source in C with one of its bugs, or two, compiled without a warning."""
    made = _folder() / f"{source.stem}-{bug}-{other}.so"
    command = [compiler("CC", "cc", "gcc", "clang"), "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-DBUG={bug}"]
    command += [] if other is None else [f"-DOTHER={other}"]
    subprocess.run([*command, str(source), "-o", str(made), "-lm"], check=True)
    return made


def elastic(young: float, nu: float) -> np.ndarray:
    """The isotropic stiffness (6, 6), shear strains those of engineers."""
    shear = young / (2 * (1 + nu))
    k = np.diag([2 * shear] * 3 + [shear] * 3)
    k[:3, :3] += young * nu / ((1 + nu) * (1 - 2 * nu))
    return k


def friction(bug: int = 0) -> dict[str, Any]:
    """What conformance without a law is given."""
    update = shared_library(library("friction.c", bug), FRICTION)
    return {"update": update, "parameters": {"mu": 0.3}, "stiffness": [2.0, 2.0], "pressure": -1.0}


def mises(bug: int = 0, **other: float) -> dict[str, Any]:
    """Steel, in Pa, with ``other`` parameters."""
    stiffness = elastic(STEEL["E"], STEEL["nu"])
    return {"update": shared_material(library("mises.c", bug), MISES, stiffness, variables=[0.0], parameters=STEEL | other)}


def interface(bug: int = 0, mu: float = 0.4, c: float = 1.0) -> dict[str, Any]:
    """Normal stiffness 5, tangential 2."""
    return {"update": umat(library("interface.f90", bug), [5.0, 2.0, mu, c], np.diag([5.0, 2.0, 2.0]), variables=[0.0], direct=1)}


EXAMPLES: dict[str, Callable[..., dict[str, Any]]] = {"friction": friction, "mises": mises, "interface": interface}
# the bugs of each example, by number, and the check that tells of them first
BUGS = {
    "friction": ["vacuity", "repeatability", "dissipation", "slip", "slope"],
    "mises": ["elasticity", "rate", "slope", "rest", "energy"],
    "interface": ["repeatability", "rest", "slope", "dissipation", "stored-energy"],
}
