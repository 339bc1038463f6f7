"""Text that numba compiles: once a text, then kept on disk, so that the next process loads it."""

from __future__ import annotations

import ast
import hashlib
import inspect
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property, lru_cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import MissingExtraError
from duhem.projection import machine_code

__all__ = ["WITHIN", "CompiledText", "compiled_text", "interpreted_text", "only_read"]

WITHIN = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""What numba is told of functions that compiled code alone calls."""

_MEANT = {"solve": "closest point", "judge": "check of answers"}


@lru_cache(maxsize=128)
def compiled_text(text: str, entry: str, inlined: tuple[str, ...] = ()) -> CompiledText:
    """The function ``entry`` of a module of our own text, compiled with the functions it calls; it lets go of the interpreter.

    ``inlined``: functions that are put where they are called, which spares handing over many arrays.  What is not yet on disk is
    compiled at the first call (some seconds).  MissingExtraError without numba.
    """
    if find_spec("numba") is None:
        raise MissingExtraError("numba", "fast")
    if inlined:  # other machine code, and what is kept is found by its text alone
        text = f"{text}\n# where they are called: {', '.join(inlined)}\n"
    return CompiledText(text, entry, inlined)


def only_read(given: NDArray[Any]) -> NDArray[Any]:
    """The array whole, and not to be written to, as compiled text takes what it reads: each kind of array is compiled for by itself."""
    whole = np.ascontiguousarray(given).view()
    whole.setflags(write=False)
    return whole


class CompiledText:
    """A function that runs as machine code from disk where there is some for its arguments, and else through numba."""

    def __init__(self, text: str, name: str, inlined: tuple[str, ...]) -> None:
        self._text, self._name, self._inlined = text, name, inlined
        self._kept = _kept(text)
        self._runs: dict[machine_code.Kinds, Callable[..., Any]] = {}
        self._lock = Lock()

    def __call__(self, *arguments: Any) -> Any:
        try:
            known = machine_code.kinds(arguments)
        except LookupError:
            return self._by_numba(*arguments)
        if (run := self._runs.get(known)) is None:
            with self._lock:
                run = self._runs.get(known) or self._found(known)
            if run is None:
                return self._first(known, arguments)
        return run(*arguments)

    def specialised(self, *arguments: Any) -> Callable[..., Any]:
        """The machine code for arguments of the kinds of these, which it is called with once: nothing is looked up again."""
        self(*arguments)
        return self._runs.get(machine_code.kinds(arguments), self)

    def _found(self, known: machine_code.Kinds) -> Callable[..., Any] | None:
        path = None if self._kept is None else machine_code.place(self._kept, self._name, known)
        run = None if path is None else machine_code.kept(path, self._name)
        if run is not None:
            self._runs[known] = run
        return run

    def _first(self, known: machine_code.Kinds, arguments: tuple[Any, ...]) -> Any:
        """Compiled by numba, or found where that keeps it, and kept for the next process."""
        with self._lock:
            compiled = self._by_numba
        import logging  # which numba has loaded

        logging.getLogger("duhem").warning(
            "waiting for numba: to compile the %s of a law takes 10 to 45 seconds, once", _MEANT.get(self._name, "loop")
        )
        result = compiled(*arguments)
        self._runs[known] = compiled
        if self._kept is not None and (path := machine_code.place(self._kept, self._name, known)) is not None:
            machine_code.keep(path, compiled, arguments)
        return result

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        """The function as written: inspect reads its arguments."""
        written: Callable[..., Any] = self._by_numba.py_func
        return written

    @cached_property
    def _by_numba(self) -> Any:
        numba = _numba()
        kept, text = self._kept, self._text
        module = ModuleType(f"duhem_{kept.stem}" if kept else f"duhem_generated_{_name(text)}")
        sys.modules[module.__name__] = module  # where what was kept looks for it
        space = module.__dict__
        exec(
            compile(text, str(kept or "<generated>"), "exec"), space
        )  # our own text: of the user's formula it has SymPy's numbers and our names
        functions = [name for name, value in space.items() if inspect.isfunction(value) and value.__module__ == module.__name__]
        for name in functions:
            if name != self._name:
                space[name] = numba.njit(forceinline=name in self._inlined, **WITHIN)(space[name])
        return numba.njit(error_model="numpy", cache=kept is not None, nogil=True)(space[self._name])


def interpreted_text(text: str | ast.Module, entry: str) -> Callable[..., None]:
    """The function ``entry`` of our own text, parsed or not, as Python runs it: for what is called too seldom to be worth compiling."""
    space: dict[str, Any] = {}
    exec(compile(text, "<generated>", "exec"), space)
    run: Callable[..., None] = space[entry]
    return run


def _numba() -> Any:
    """numba, not asking SciPy whether there is a BLAS: that loads all of scipy.linalg, a tenth of what a first increment takes.

    It asks when its module on arrays is imported, and again where a function that it compiles has need of one: there it finds out.
    """
    try:
        import numba
    except ImportError:
        raise MissingExtraError("numba", "fast") from None
    on_arrays = "numba.np.arraymath"
    if on_arrays not in sys.modules and "scipy.linalg" not in sys.modules and find_spec("scipy") is not None:
        with suppress(ImportError, AttributeError):  # another version of numba
            linalg: Any = import_module("numba.np.linalg")
            asks = linalg.ensure_blas
            linalg.ensure_blas = lambda: None
            try:
                import_module(on_arrays).ensure_blas = asks  # type: ignore[attr-defined]
            finally:
                linalg.ensure_blas = asks
    return numba


def _name(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _kept(text: str) -> Path | None:
    """The file with this text, beside which numba keeps what it compiles; None where there is no place for it."""
    folder = kept_folder()
    path = folder / f"law_{_name(text)}.py"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not path.is_file() or path.read_text("utf-8") != text:
            beside = path.with_suffix(f".{os.getpid()}")
            beside.write_text(text, "utf-8")
            beside.replace(path)
        return path
    except OSError:
        return None


def kept_folder() -> Path:
    """Where is kept what the next process need not make again: DUHEM_CACHE_DIR, else the user's folder for such things."""
    if own := os.environ.get("DUHEM_CACHE_DIR"):
        return Path(own)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "duhem"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "duhem"
