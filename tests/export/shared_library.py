"""An exported file, compiled by the machine's compilers and called through ctypes as a routine for the conformance suite."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from duhem.export.source_files import c_file, identifier
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array
from duhem.proof.verification import verify
from duhem.testing import Step

__all__ = ["FORTRAN", "OPTIMISED", "STRICT", "Compiled", "compiled", "compiler", "shared", "with_fortran"]

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
OPTIMISED = (*STRICT, "-O2")  # as users compile it; without, it takes a quarter of the time
FORTRAN = ("-std=f2008", "-Wall", "-Wextra", "-Werror", "-Wno-unused-dummy-argument")  # a UMAT has arguments that a law has no use for


def compiler(variable: str, *names: str) -> str:
    """The compiler that the variable names, or the first there is; the test is skipped where there is none."""
    for name in filter(None, (os.environ.get(variable), *names)):
        if found := shutil.which(name):
            return found
    pytest.skip(f"no compiler: none of {', '.join(names)} is on the path, and {variable} names none")


def shared(sources: Sequence[Path], *options: str, with_: str) -> ctypes.CDLL:
    """The library made of the sources, beside the first, under a new name: a name that was loaded before is not read again."""
    library = sources[0].with_suffix(f".{os.urandom(4).hex()}.so")
    subprocess.run([with_, "-O2", *options, "-shared", "-fPIC", *map(str, sources), "-o", str(library), "-lm"], check=True)
    return ctypes.CDLL(str(library))


def with_fortran(folder: Path, c: str, *fortran: str, options: Sequence[str] = OPTIMISED) -> ctypes.CDLL:
    """The library of an exported C file and of what is written in Fortran to call it; skipped without a compiler of either."""
    with_, files = compiler("FC", "gfortran"), [folder / f"own{i}.f90" for i in range(len(fortran))]
    for file, text in zip([folder / "own.c", *files], [c, *fortran], strict=True):
        file.write_text(text, "utf-8")
    made = folder / "own.o"
    subprocess.run([compiler("CC", "cc", "gcc", "clang"), *options, "-c", "-fPIC", str(folder / "own.c"), "-o", str(made)], check=True)
    return shared([*files, made], *FORTRAN, "-J", str(folder), with_=with_)


@dataclass(frozen=True)
class Compiled:
    """The routine of one law; called, it answers many increments as the suite asks them."""

    run: Callable[..., int]
    d: int
    parameters: tuple[str, ...]

    def one(self, trial: Array, pressure: float, stiffness: Array, values: Sequence[float]) -> tuple[int, Array, Array, float, Array]:
        """Status, stress, slip, dissipation and tangent of one increment."""
        stress, slip, loss, tangent = np.full(self.d, 7.0), np.full(self.d, 7.0), np.full(1, 7.0), np.full((self.d, self.d), 7.0)
        given = [np.ascontiguousarray(x, dtype=np.float64) for x in (trial, stiffness, [*values, 0.0])]
        places = [x.ctypes.data for x in (*given, stress, slip, loss, tangent)]
        status = self.run(places[0], pressure, *places[1:])
        return status, stress, slip, float(loss[0]), tangent

    def __call__(self, trial: Array, pressure: Array | None, stiffness: Array, **open_: Any) -> Step:
        values = [float(open_[name]) for name in self.parameters]
        loads = np.zeros(len(trial)) if pressure is None else pressure
        found = [self.one(t, float(p), stiffness, values) for t, p in zip(trial, loads, strict=True)]
        status, stress, slip, _, tangent = (np.array([row[i] for row in found]) for i in range(5))
        return Step(stress, slip, None, tangent, status <= 1)


def compiled(law: Criterion, *, text: str | None = None, options: tuple[str, ...] = (*STRICT, "-O0")) -> Compiled:
    """The law's exported file, or another ``text`` in its place, compiled without a warning; once a text."""
    run = _increment(identifier(law.name), _exported(law, law.written) if text is None else text, options)
    return Compiled(run, len(law.forces), tuple(n for n, domain in law.parameters.items() if domain.value is None))


@cache
def _exported(law: Criterion, written: str) -> str:
    """The C file of a law, which is the same for the same text."""
    return c_file(verify(law, claims=["convexity"]))


@cache
def _increment(name: str, text: str, options: tuple[str, ...]) -> Callable[..., int]:
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:  # Windows keeps what is loaded
        file = Path(folder) / f"{name}.c"
        file.write_text(text, "utf-8")
        run = getattr(shared([file], *options, with_=compiler("CC", "cc", "gcc", "clang")), f"{name}_increment")
    place = ctypes.c_void_p
    run.argtypes, run.restype = [place, ctypes.c_double, *[place] * 6], ctypes.c_int
    return run
