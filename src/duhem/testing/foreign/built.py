"""A shared library of a routine that is given as its source, compiled once a process, with stubs of what Abaqus offers a UMAT."""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from duhem.errors import InputError

__all__ = ["SOURCES", "built"]

_FORTRAN = (".f", ".for", ".ftn", ".f77", ".f90", ".f95", ".f03", ".f08")
_C = (".c", ".cc", ".cpp", ".cxx")
SOURCES = _FORTRAN + _C
_COMPILERS = {"FC": ("gfortran", "ifx", "ifort", "flang"), "CC": ("cc", "gcc", "clang"), "CXX": ("c++", "g++", "clang++")}
_STUBS = Path(__file__).with_name("abaqus_stubs.c")
_PARAMETERS = "      implicit real*8(a-h,o-z)\n      parameter (nprecd=2)\n"
_LINES = 12  # of what a compiler says


def built(path: str | Path) -> Path:
    """The library of a source in Fortran or C; any other file stays as it is.

    Raises InputError where there is no such file, no compiler for it, or one that refuses it, with what it says.
    """
    file = Path(path)
    if file.suffix.lower() not in SOURCES or not file.is_file():
        return file
    return _library(file.resolve(), file.stat().st_mtime_ns)


@cache
def _library(file: Path, _: int) -> Path:
    kind = "FC" if file.suffix.lower() in _FORTRAN else "CC" if file.suffix == ".c" else "CXX"
    names = (named,) if (named := os.environ.get(kind)) else _COMPILERS[kind]
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        what = f"there is no compiler: none of {', '.join(names)} is on the path"
        raise InputError(what, where=str(file), remedy=f"install one, name it in {kind}, or give the compiled library (.so)")
    folder = Path(mkdtemp(prefix="duhem-built-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name in ("ABA_PARAM.INC", "aba_param.inc"):  # a folder of its own, as some systems take both for one
        (folder / name).write_text(_PARAMETERS, "utf-8")
    made = folder / f"{file.stem}.so"
    form = ("-cpp", "-std=legacy", "-ffixed-line-length-none", "-ffree-line-length-none") if "gfortran" in Path(found).name else ()
    stubs = str(folder / "stubs.o")  # apart: C has no use for options of Fortran
    whole = ["-shared", f"-I{folder}", *form, str(file), stubs, "-o", str(made), "-lm"]
    for options in (["-c", str(_STUBS), "-o", stubs], whole):
        done = subprocess.run([found, "-O2", "-fPIC", *options], capture_output=True, text=True, errors="replace", check=False)
        if done.returncode != 0:
            said = "\n".join((done.stderr or done.stdout).strip().splitlines()[:_LINES])
            remedy = "mend the source, or give the compiled library"
            raise InputError(f"{Path(found).name} refuses it:\n{said}", where=str(file), remedy=remedy)
    return made
