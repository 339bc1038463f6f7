"""Whether a file can be written, asked before the work rather than after it; and writing it, whole or not at all.

Parquet's package, of the extra ``parquet``, is imported where a table is written or read.

Rows of a long run grow on disk as they are done, with notes beside them so that a killed run can go on.  They go into FILE.partial.rows.
FILE.partial begins with the mark of the run; each of its further lines says, after some rows, what is counted of them, how many bytes
they take, and the sum over these bytes.  Whenever the process dies, the last whole line holds: what stands behind its bytes is cut off,
and the run goes on from there.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Self

from duhem.errors import InputError, MissingExtraError, imported_from

__all__ = [
    "DAMAGED", "MARK", "UNREADABLE", "AnyPath", "GrowingFile", "another", "beside", "check_growing", "check_kept", "check_parquet",
    "check_place", "check_places", "parquet_packages", "rows_beside", "write", "written",
]  # fmt: skip

AnyPath = str | os.PathLike[str]


def check_place(file: AnyPath, inputs: Iterable[AnyPath] = ()) -> None:
    """Raises InputError for a place that is no place for a result.

    That is no name, one in a folder that is not there, a directory, a link, a device or a pipe, what may not be written, and one of the
    ``inputs`` (names of laws among them are of no file), however spelled: nothing that is read is written over.
    """
    if not os.fspath(file):
        raise InputError("no file is named", remedy="name one")
    folder = os.path.dirname(os.path.abspath(file))
    try:
        os.lstat(file)
    except (FileNotFoundError, NotADirectoryError):
        pass
    except (OSError, ValueError) as fault:  # too long, or with a letter that ends it
        reason = getattr(fault, "strerror", None) or str(fault)
        raise InputError(f"duhem cannot write there: {reason}", where=f"{file}"[:200], remedy="name another file") from None
    if not os.path.isdir(folder):
        raise InputError("there is no such directory", where=f"{file}", remedy="make it first")
    if os.path.isdir(file):
        raise InputError("this is a directory", where=f"{file}", remedy="name a file")
    if os.path.islink(file):
        raise InputError("this is a link to another place", where=f"{file}", remedy="give the target of the link, or another file")
    if os.path.exists(file) and not os.path.isfile(file):
        raise InputError("this is a device or a pipe, not a file", where=f"{file}", remedy="name a file")
    if not os.access(folder, os.W_OK) or (os.path.exists(file) and not os.access(file, os.W_OK)):
        raise InputError("you have no permission to write it", where=f"{file}", remedy="write where you may")
    if any(os.path.exists(given) and _same(file, given) for given in inputs):
        raise InputError("this file is an input, and would be overwritten", where=f"{file}", remedy="name another file")


def check_places(files: Iterable[AnyPath | None], inputs: Iterable[AnyPath] = ()) -> None:
    """:func:`check_place` of each result that is asked for; no two of them are one file either."""
    taken = list(inputs)
    outputs: list[AnyPath] = []
    for file in files:
        if file is None:
            continue
        check_place(file, taken)
        if any(_same(file, other) for other in outputs):
            raise InputError("two results have the same file", where=f"{file}", remedy="give each result its own file")
        outputs.append(file)


def write(file: AnyPath, content: str) -> None:
    """Write a text, in UTF-8 with ends of lines as they are; InputError where it cannot be written."""
    with written(file) as beside, open(beside, "w", encoding="utf-8", newline="") as stream:
        stream.write(content)


@contextmanager
def written(file: AnyPath) -> Iterator[str]:
    """An empty file beside ``file`` to write into, which takes its place at the end; where that fails, what stood there stays.

    Its name cannot be foreseen, so that nobody has put a link in its place.  InputError where it cannot be written.
    """
    check_place(file)
    folder, name = os.path.split(os.fspath(file))
    beside = os.path.join(folder, f"{name[:40]}.{os.urandom(4).hex()}.writing")  # cut, as a name has an end
    try:
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield beside
        os.replace(beside, file)
    except OSError as fault:
        reason = fault.strerror or " ".join(str(fault).split())
        remedy = "choose a place with write permission and free disk space"
        raise InputError(f"the file cannot be written: {reason}", where=f"{file}", remedy=remedy) from None
    finally:
        with suppress(OSError):
            os.unlink(beside)


def _same(file: AnyPath, other: AnyPath) -> bool:
    """Whether two names, however spelled, are of one file, or would be if it were there."""
    with suppress(OSError):
        return os.path.samefile(file, other)
    return os.path.realpath(file) == os.path.realpath(other)


def check_parquet() -> None:
    """MissingExtraError where Parquet's package is not installed; nothing is imported."""
    if find_spec("pyarrow") is None:
        raise MissingExtraError("pyarrow", "parquet")


def parquet_packages() -> tuple[Any, Any]:
    """``pyarrow`` and ``pyarrow.parquet``; MissingExtraError without them."""
    with imported_from("pyarrow", "parquet"):
        import pyarrow
        from pyarrow import parquet
    return pyarrow, parquet


# -- rows that grow ----------------------------------------------------------------------------------------------------


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
            with self._room():
                if not (resume and self._recalled(fingerprint)):
                    self.notes.write_text(f"{MARK}{fingerprint}\n", encoding="utf-8")
                    self.rows.write_bytes(b"")
                self._stream: BinaryIO = open(self.rows, "r+b")  # noqa: SIM115 (closed by __exit__)
                self._stream.truncate(self.size)
                self._stream.seek(self.size)
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
        with self._room():
            self._stream.write(data)
        self._sum.update(data)
        self.size += len(data)

    def note(self, *counts: int) -> None:
        """What is written so far stands, with these counts; InputError where there is no room for it."""
        with self._room():
            self._stream.flush()
            with open(self.notes, "a", encoding="utf-8") as notes:
                notes.write(f"{' '.join(map(str, (*counts, self.size)))} {self._sum.hexdigest()}\n")
        self.counts = counts

    def end(self) -> None:
        """No more rows, and those of no other run until :meth:`close` either."""
        with self._room():
            self._stream.close()

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

    @contextmanager
    def _room(self) -> Iterator[None]:
        """InputError where there is none."""
        try:
            yield
        except OSError as fault:
            remedy = "free some disk space, and continue with resume"
            raise InputError(f"the rows cannot be written: {fault.strerror}", where=f"{self.rows}", remedy=remedy) from None

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
