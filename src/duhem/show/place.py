"""Whether a file can be written, asked before the work rather than after it; and writing it, whole or not at all."""

from __future__ import annotations

import os

from duhem.errors import InputError

__all__ = ["check_place", "write"]


def check_place(file: str | os.PathLike[str]) -> None:
    """Raises InputError for a folder that is not there, a directory in the file's place, and what may not be written."""
    folder = os.path.dirname(os.path.abspath(file))
    if not os.path.isdir(folder):
        raise InputError("there is no such directory", where=f"{file}", remedy="make it first")
    if os.path.isdir(file):
        raise InputError("this is a directory", where=f"{file}", remedy="name a file")
    if not os.access(folder, os.W_OK) or (os.path.exists(file) and not os.access(file, os.W_OK)):
        raise InputError("it may not be written", where=f"{file}", remedy="write where you may")


def write(file: str, content: str) -> None:
    """Write a text and a line's end; what stood there before stays until all of it is written."""
    beside = f"{file}.writing"
    try:
        with open(beside, "w", encoding="utf-8") as stream:
            stream.write(content + "\n")
        os.replace(beside, file)
    except OSError as fault:
        raise InputError(f"the file cannot be written: {fault.strerror}", where=file, remedy="write where you may") from None
