"""Temporary arrays that keep their memory from one operation to the next."""

from __future__ import annotations

import numpy as np

__all__ = ["keep_freed_memory"]

_FEW = 1_024  # points whose temporary arrays are too small to matter
_ROOM = 3 << 19  # numbers: some times what the temporary arrays of a block take together


def keep_freed_memory(points: int) -> None:
    """Before work in blocks on so many points.

    The C library of Linux hands freed memory back to the system, and has every page of it faulted in again, until an
    array of megabytes has come and gone: then it takes such sizes for usual.  The closed form of ten thousand to a
    hundred thousand points takes half the time.  Nothing is written to that array, so it costs no memory, and elsewhere it changes nothing.
    """
    if points > _FEW:
        np.empty(_ROOM)
