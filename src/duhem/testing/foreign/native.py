"""A routine of a shared library, called row by row through ctypes; here, or in a process of its own, whose end is reported.

As a script this file is that process: it needs NumPy alone, and imports nothing of the package.
"""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import subprocess
import sys
import weakref
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

__all__ = ["Native", "NativeFault", "call_rows"]

_VALUES = {"d": ctypes.c_double, "i": ctypes.c_int, "n": ctypes.c_size_t}


class NativeFault(RuntimeError):
    """The library cannot be loaded, has no such symbol, or ended the process that ran it."""


@dataclass(frozen=True)
class Native:
    """``symbol`` of the library at ``path``; ``kinds`` has a letter for each argument.

    "p" is a pointer to the row's numbers; "d", "i" and "n" are a double, an int and a size_t by value.  ``isolated``: it runs in
    a process of its own, so that a crash there is a fault reported here.  Raises NativeFault at once where it cannot be loaded.
    """

    path: str
    symbol: str
    kinds: str
    isolated: bool = False

    def __post_init__(self) -> None:
        _ = self._process if self.isolated else self._function

    @cached_property
    def _function(self) -> Any:
        return _loaded(self.path, self.symbol, self.kinds)

    @cached_property
    def _process(self) -> _Process:
        process = _Process(self.path, self.symbol, self.kinds)
        weakref.finalize(self, process.close)
        return process

    def __reduce__(self) -> Any:  # a copy loads the library again
        return Native, (self.path, self.symbol, self.kinds, self.isolated)

    def __call__(self, columns: list[NDArray[Any]], rows: int) -> NDArray[np.int64]:
        """Call it for each row: ``columns`` has (rows, …) arrays, changed in place where the routine does.  What it returned (rows,).

        Raises NativeFault where the library ends its process; the next call starts another.
        """
        if not self.isolated:
            return call_rows(self._function, self.kinds, columns, rows)
        try:
            codes, changed = self._process.ask(columns, rows)
        except NativeFault:
            del self.__dict__["_process"]
            raise
        for column, new in zip(columns, changed, strict=True):
            column[...] = new
        return codes


def _loaded(path: str, symbol: str, kinds: str) -> Any:
    try:
        library = ctypes.CDLL(path)
    except OSError as fault:
        raise NativeFault(f"{path} cannot be loaded: {fault}") from None
    try:
        function = getattr(library, symbol)
    except AttributeError:
        raise NativeFault(f"{path} has no symbol {symbol!r}") from None
    function.argtypes = [ctypes.c_void_p if kind == "p" else _VALUES[kind] for kind in kinds]
    function.restype = ctypes.c_int
    return function


def call_rows(function: Any, kinds: str, columns: list[NDArray[Any]], rows: int) -> NDArray[np.int64]:
    """Call a loaded function once a row."""
    starts = [(c.ctypes.data, c.strides[0]) if kind == "p" else c.tolist() for kind, c in zip(kinds, columns, strict=True)]
    codes = np.zeros(rows, dtype=np.int64)
    for i in range(rows):
        codes[i] = function(*[s[0] + i * s[1] if kind == "p" else s[i] for kind, s in zip(kinds, starts, strict=True)])
    return codes


class _Process:
    """A process that runs one routine."""

    def __init__(self, path: str, symbol: str, kinds: str) -> None:
        self.name = f"{symbol} of {path}"
        self.child = subprocess.Popen([sys.executable, "-P", __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._say((path, symbol, kinds))
        if fault := self._hear():
            self.close()
            raise NativeFault(str(fault))

    def ask(self, columns: list[NDArray[Any]], rows: int) -> tuple[NDArray[np.int64], list[NDArray[Any]]]:
        self._say((columns, rows))
        codes, changed = self._hear()
        return codes, changed

    def _say(self, what: object) -> None:
        assert self.child.stdin is not None
        try:
            pickle.dump(what, self.child.stdin, protocol=5)
            self.child.stdin.flush()
        except OSError:
            raise self._ended() from None

    def _hear(self) -> Any:
        assert self.child.stdout is not None
        try:
            return pickle.load(self.child.stdout)
        except (EOFError, pickle.UnpicklingError):
            raise self._ended() from None

    def _ended(self) -> NativeFault:
        self.close()
        code = self.child.returncode
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        return NativeFault(f"{self.name} ended its process {how}")

    def close(self) -> None:
        """End it: it goes when it hears no more."""
        for pipe in (self.child.stdin, self.child.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()
        self.child.wait()


def _serve(hear: BinaryIO, say: BinaryIO) -> None:
    """Load one routine and answer until the other side is gone."""

    def answer(what: object) -> None:
        pickle.dump(what, say, protocol=5)
        say.flush()

    path, symbol, kinds = pickle.load(hear)
    try:
        function = _loaded(path, symbol, kinds)
    except NativeFault as fault:
        return answer(str(fault))
    answer(None)
    while True:
        try:
            columns, rows = pickle.load(hear)
        except EOFError:
            return
        columns = [np.array(c) for c in columns]  # what was read may not be written to
        answer((call_rows(function, kinds, columns, rows), columns))


if __name__ == "__main__":
    own = os.dup(1)  # what the library prints goes to the error stream, not between the answers
    os.dup2(2, 1)
    with os.fdopen(own, "wb") as _say:
        _serve(sys.stdin.buffer, _say)
