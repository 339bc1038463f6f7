"""Rows that grow on disk as they are done, and what is noted beside them so that a killed run can go on.

The rows go into FILE.partial.rows.  FILE.partial begins with the mark of the run; each of its further lines says, after some
rows, what is counted of them, how many bytes they take, and the sum over these bytes.  Whenever the process dies, the last whole
line holds: what stands behind its bytes is cut off, and the run goes on from there.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from duhem.errors import InputError
from duhem.show.place import AnyPath, check_place

__all__ = ["DAMAGED", "MARK", "UNREADABLE", "GrowingFile", "another", "beside", "check_growing", "check_kept", "rows_beside"]

MARK = "# duhem part of run "
UNREADABLE = "check its permissions, or delete it"
DAMAGED = "delete it and start again"

_PIECE = 1 << 22  # bytes read together


def another(place: AnyPath, asked: str = "scene") -> InputError:
    """The part that is kept at a place is of another run than what is ``asked``."""
    remedy = f"delete it, or go on with the {asked} as it was and the version of duhem that wrote it"
    return InputError("this file belongs to another run", where=f"{place}", remedy=remedy)


def beside(file: AnyPath) -> Path:
    """Where the part of the table ``file`` is kept."""
    return Path(f"{os.fspath(file)}.partial")


def rows_beside(file: AnyPath) -> Path:
    """Where the rows of the table ``file`` grow."""
    return Path(f"{beside(file)}.rows")


def check_kept(file: AnyPath, inputs: Iterable[str] = ()) -> None:
    """InputError where the part of the table ``file`` cannot be kept: what stands there is something else, or one of the ``inputs``."""
    place = beside(file)
    check_place(place, inputs)
    try:
        with open(place, "rb") as stream:
            known = stream.read(len(MARK)) == MARK.encode()
    except FileNotFoundError:
        return
    except OSError as fault:
        raise InputError(f"the file of an interrupted run cannot be read: {fault.strerror}", where=f"{place}", remedy=UNREADABLE) from None
    if not known:
        raise InputError("this file does not belong to duhem, and would be overwritten", where=f"{place}", remedy="move it away")


def check_growing(file: AnyPath, inputs: Iterable[str] = ()) -> None:
    """InputError where the rows of the table ``file`` cannot grow beside it."""
    inputs, rows = tuple(inputs), rows_beside(file)
    check_kept(file, inputs)
    check_place(rows, inputs)
    if rows.exists() and not beside(file).exists():
        raise InputError("this file does not belong to duhem, and would be overwritten", where=f"{rows}", remedy="move it away")


class GrowingFile:
    """The rows of the run ``fingerprint`` beside the table ``file``; ``counts`` were noted of them last, ``size`` bytes.

    ``resume`` goes on with what is there; InputError if that is of another run than what is ``asked``, or damaged.  Use it as a
    context: what is noted stays.
    """

    def __init__(self, file: AnyPath, fingerprint: str, counts: tuple[int, ...], resume: bool, asked: str = "scene") -> None:
        self.counts, self.size, self.asked = counts, 0, asked
        self.notes, self.rows = beside(file), rows_beside(file)
        self._sum = hashlib.sha256()
        self._alone = _locked(self.notes)
        try:
            if not (resume and self._recalled(fingerprint)):
                self.notes.write_text(f"{MARK}{fingerprint}\n", encoding="utf-8")
                self.rows.write_bytes(b"")
            self._stream: BinaryIO = open(self.rows, "r+b")  # noqa: SIM115 (closed by __exit__)
            self._stream.truncate(self.size)
            self._stream.seek(self.size)
        except OSError as fault:
            self._alone.close()
            raise self._no_room(fault) from None
        except InputError:
            self._alone.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def write(self, text: str) -> None:
        """Further rows, which count once they are noted; InputError where there is no room for them."""
        data = text.encode()
        try:
            self._stream.write(data)
        except OSError as fault:
            raise self._no_room(fault) from None
        self._sum.update(data)
        self.size += len(data)

    def note(self, *counts: int) -> None:
        """What is written so far stands, with these counts; InputError where there is no room for it."""
        try:
            self._stream.flush()
            with open(self.notes, "a", encoding="utf-8") as notes:
                notes.write(f"{' '.join(map(str, (*counts, self.size)))} {self._sum.hexdigest()}\n")
        except OSError as fault:
            raise self._no_room(fault) from None
        self.counts = counts

    def end(self) -> None:
        """No more rows, and those of no other run until :meth:`close` either."""
        try:
            self._stream.close()
        except OSError as fault:
            raise self._no_room(fault) from None

    def close(self) -> None:
        """Leave what is noted to the next run."""
        with suppress(OSError):  # what had no room was told where it was noted
            self._stream.close()
        self._alone.close()

    def drop(self) -> None:
        """Leave nothing beside the table."""
        self.rows.unlink(missing_ok=True)
        self.notes.unlink()
        self._alone.close()

    def _no_room(self, fault: OSError) -> InputError:
        remedy = "free some disk space, and continue with resume"
        return InputError(f"the rows cannot be written: {fault.strerror}", where=f"{self.rows}", remedy=remedy)

    def _recalled(self, fingerprint: str) -> bool:
        """Whether there is something to go on with, which is looked at byte by byte."""
        try:
            noted_so_far = self.notes.read_bytes()
            mark, *lines = noted_so_far.decode().split("\n")[:-1]  # what no end of line follows was cut off
            rows = open(self.rows, "rb")  # noqa: SIM115 (closed below)
        except (FileNotFoundError, ValueError):
            return False  # nothing there, or not even the mark was whole
        except OSError:
            raise InputError("the file of an interrupted run cannot be read", where=f"{self.notes}", remedy=UNREADABLE) from None
        with rows:
            if mark != f"{MARK}{fingerprint}":
                raise another(self.notes, self.asked)
            if not lines:
                return False
            try:
                *counts, size, noted = lines[-1].split(" ")
                found = tuple(map(int, counts))
                self.size = int(size)
            except ValueError:
                found = ()
            if len(found) != len(self.counts):
                raise InputError("the file of an interrupted run is damaged", where=f"{self.notes}", remedy=DAMAGED)
            self.counts, left = found, self.size
            while left > 0 and (piece := rows.read(min(left, _PIECE))):
                self._sum.update(piece)
                left -= len(piece)
            if left or self._sum.hexdigest() != noted:
                raise InputError("the file of an interrupted run is damaged", where=f"{self.rows}", remedy=DAMAGED)
        os.truncate(self.notes, noted_so_far.rindex(b"\n") + 1)
        return True


def _locked(notes: Path) -> BinaryIO:
    """The file open as long as a run grows there; InputError while another run does, whose rows would be written over."""
    stream = open(notes, "ab")  # noqa: SIM115 (closed by GrowingFile.close)
    try:
        import fcntl

        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        stream.close()
        remedy = "wait until it has ended, or use another name for this table"
        raise InputError("another run is writing this table", where=f"{notes}", remedy=remedy) from None
    except (ImportError, OSError):  # a platform or a file system without locks
        stream.close()
    return stream
