"""Whether a file can be written, asked before the work rather than after it; and writing it, whole or not at all.

Parquet's package, of the extra ``parquet``, is imported where a table is written or read.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from typing import Any

from duhem.errors import InputError, MissingExtraError

__all__ = ["AnyPath", "check_parquet", "check_place", "check_places", "parquet_packages", "write", "written"]

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
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingExtraError("pyarrow", "parquet") from None
    return pyarrow, parquet
