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
import threading
import weakref
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from tempfile import TemporaryFile
from typing import Any, BinaryIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["SECONDS", "Called", "Native", "NativeFault", "OutOfTime", "call_rows"]

SECONDS = 120.0  # that all rows of one call may take

_VALUES = {"d": ctypes.c_double, "i": ctypes.c_int, "n": ctypes.c_size_t}
_GUARD = 64  # bytes before and after each array that a routine is given
_NOBODYS = 0xFF  # what they hold: a double of it is nan, so that reading there is seen too
_TOLD = 400  # bytes of what a routine has printed

Called: TypeAlias = tuple[NDArray[np.int64], NDArray[np.bool_]]


class NativeFault(RuntimeError):
    """The library cannot be loaded, has no such symbol, or ended the process that ran it."""


class OutOfTime(NativeFault):
    """The library has not answered in the time that it is given, and its process was ended."""


@dataclass(frozen=True)
class Native:
    """``symbol`` of the library at ``path``; ``kinds`` has a letter for each argument.

    "p" is a pointer to the row's numbers; "d", "i" and "n" are a double, an int and a size_t by value.  ``isolated``: it runs in
    a process of its own, so that a crash there is a fault reported here, and so is an answer to all rows that takes more than
    ``seconds``.  Raises NativeFault at once where it cannot be loaded.
    """

    path: str
    symbol: str
    kinds: str
    isolated: bool = False
    seconds: float = SECONDS

    def __post_init__(self) -> None:
        _ = self._process if self.isolated else self._function

    @cached_property
    def _function(self) -> Any:
        return _loaded(self.path, self.symbol, self.kinds)

    @cached_property
    def _process(self) -> _Process:
        process = _Process(self.path, self.symbol, self.kinds, self.seconds)
        weakref.finalize(self, process.close)
        return process

    def __reduce__(self) -> Any:  # a copy loads the library again
        return Native, (self.path, self.symbol, self.kinds, self.isolated, self.seconds)

    def __call__(self, columns: list[NDArray[Any]], rows: int) -> Called:
        """Call it for each row: ``columns`` has (rows, …) arrays, changed in place where the routine does.

        What it returned (rows,), and beside which of its arrays it wrote (rows, arguments): 64 bytes either side are watched.
        Raises NativeFault where the library ends its process, OutOfTime where that had to be ended; the next call starts another.
        """
        if not self.isolated:
            return call_rows(self._function, self.kinds, columns, rows)
        process = self._process
        try:
            called, changed = process.ask(columns, rows)
        except BaseException:  # an interrupt too, which leaves an answer unread
            if process.closed:
                self.__dict__.pop("_process", None)
            raise
        for column, new in zip(columns, changed, strict=True):
            column[...] = new
        return called


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


class _Guarded:
    """The arrays of each row, one behind the other, each between bytes that are nobody's to write to."""

    def __init__(self, columns: list[NDArray[Any]]) -> None:
        sizes = [column[0].nbytes for column in columns]
        widths = [2 * _GUARD + -(-size // _GUARD) * _GUARD for size in sizes]
        self.starts, rows = list(accumulate(widths[:-1], initial=0)), len(columns[0])
        self.columns, self.whole = columns, np.empty((rows, sum(widths)), dtype=np.uint8)
        self.whole.fill(_NOBODYS)
        begins = [start + _GUARD for start in self.starts]
        self.inside = [self.whole[:, begin : begin + size] for begin, size in zip(begins, sizes, strict=True)]
        for inside, column in zip(self.inside, columns, strict=True):
            typed = inside.view(column.dtype)
            typed[...] = column.reshape(typed.shape)
        first = self.whole.ctypes.data
        self.places = [range(first + begin, first + begin + self.whole.size, self.whole.shape[1]) for begin in begins]

    def taken(self) -> NDArray[np.bool_]:
        """Put what is inside back into the arrays; beside which of them there is something (rows, arrays)."""
        for inside, column in zip(self.inside, self.columns, strict=True):
            column[...] = inside.view(column.dtype).reshape(column.shape)
            inside[...] = _NOBODYS
        written = self.whole != _NOBODYS
        if not written.any():
            return np.zeros((len(written), len(self.columns)), dtype=np.bool_)
        return np.asarray(np.logical_or.reduceat(written, self.starts, axis=1))


def call_rows(function: Any, kinds: str, columns: list[NDArray[Any]], rows: int) -> Called:
    """Call a loaded function once a row."""
    pointers = [j for j, kind in enumerate(kinds) if kind == "p"]
    guarded = _Guarded([columns[j] for j in pointers])
    places = dict(zip(pointers, guarded.places, strict=True))
    given = (places[j] if j in places else column.tolist() for j, column in enumerate(columns))
    codes = np.array([function(*each) for each in zip(*given, strict=True)], dtype=np.int64)
    beside = np.zeros((rows, len(kinds)), dtype=np.bool_)
    beside[:, pointers] = guarded.taken()
    return codes, beside


class _Process:
    """A process that runs one routine, and where the system can fork begins another one, loaded already, where that ends it.

    What the routine prints goes to a file, of which the last lines are told with a fault.
    """

    def __init__(self, path: str, symbol: str, kinds: str, seconds: float) -> None:
        self.name, self.seconds, self.late, self.waiting, self.lock = f"{symbol} of {path}", seconds, False, False, threading.Lock()
        self.closed, self.printed = False, TemporaryFile()  # noqa: SIM115 (it lives as long as the process)
        command, pipe = [sys.executable, "-P", __file__], subprocess.PIPE
        at_once = os.environ | {"GFORTRAN_UNBUFFERED_PRECONNECTED": "y"}  # what unit 6 has is not lost with the process
        self.child = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=self.printed, start_new_session=True, env=at_once)
        self._say((path, symbol, kinds))
        if fault := self._hear():
            self.close()
            raise NativeFault(str(fault))

    def ask(self, columns: list[NDArray[Any]], rows: int) -> tuple[Called, list[NDArray[Any]]]:
        self.waiting = True
        watch = threading.Timer(self.seconds, self._give_up)
        watch.daemon = True
        watch.start()
        try:
            begun = os.fstat(self.printed.fileno()).st_size
            self._say((columns, rows))
            answer = self._hear()
            if isinstance(answer, int):
                raise NativeFault(f"{self.name} ended its process {_how(answer)}{self._told(begun)}")
            called, changed = answer
        except KeyboardInterrupt:
            self._kill()
            self.close()
            raise
        finally:
            watch.cancel()
            with self.lock:
                self.waiting = False
        return called, changed

    def _give_up(self) -> None:
        with self.lock:
            if self.waiting:
                self.late = True
                self._kill()

    def _kill(self) -> None:
        """End it with all that it began."""
        with suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(self.child.pid, signal.SIGKILL)
            else:
                self.child.kill()

    def _told(self, begun: int) -> str:
        """The last of what was printed since, in words."""
        with suppress(OSError):
            self.printed.seek(max(begun, os.fstat(self.printed.fileno()).st_size - _TOLD))
            if said := " / ".join(self.printed.read().decode("utf-8", "replace").split("\n")).strip(" /"):
                return f"; it printed: {said}"
        return ""

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
        if self.late:
            return OutOfTime(f"{self.name} has not answered within {self.seconds:g} s{self._told(0)}")
        return NativeFault(f"{self.name} ended its process {_how(self.child.returncode)}{self._told(0)}")

    def close(self) -> None:
        """End it: it goes when it hears no more."""
        self.closed = True
        for pipe in (self.child.stdin, self.child.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()
        self.child.wait()

    def __del__(self) -> None:
        self.printed.close()


def _how(code: int) -> str:
    return f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"


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
    with suppress(BrokenPipeError):
        while hasattr(os, "fork") and (worker := os.fork()):  # who forks holds the library as it was loaded
            answer(os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1]))
    while True:
        try:
            columns, rows = pickle.load(hear)
        except EOFError:
            os._exit(0)
        columns = [np.array(c) for c in columns]  # what was read may not be written to
        answer((call_rows(function, kinds, columns, rows), columns))


if __name__ == "__main__":
    own = os.dup(1)  # what the library prints goes to the error stream, not between the answers
    os.dup2(2, 1)
    with os.fdopen(own, "wb") as _say:
        _serve(sys.stdin.buffer, _say)
