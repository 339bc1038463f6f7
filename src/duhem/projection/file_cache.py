"""Files in which something is kept for the next process: read only where they are what was written.

A seal is a sum over a file's name and content, so that a file which has come to stand for another is none.
"""

from __future__ import annotations

import hashlib
import os
import stat
from contextlib import suppress
from pathlib import Path

__all__ = ["read", "written"]

_MOST = 1 << 26  # bytes: a law's machine code takes some hundred thousand
_OPENED = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)  # a pipe is not waited for


def read(path: Path) -> bytes | None:
    """What was written there; None for what is missing, damaged, another file's, no file or too long."""
    try:
        number = os.open(path, _OPENED)
    except OSError:
        return None
    with suppress(OSError), os.fdopen(number, "rb") as file:
        seen = os.fstat(number)
        if stat.S_ISREG(seen.st_mode) and seen.st_size <= _MOST:
            seal, _, content = file.read(_MOST).partition(b"\n")
            return content if seal == _seal(path, content) else None
    return None


def written(path: Path, content: bytes) -> None:
    """Write beside and rename.  OSError where that cannot be done."""
    beside = path.with_suffix(f".{os.getpid()}")
    beside.write_bytes(_seal(path, content) + b"\n" + content)
    beside.replace(path)


def _seal(path: Path, content: bytes) -> bytes:
    return hashlib.sha256(path.name.encode() + b"\n" + content).hexdigest().encode()
