"""Work on many points in blocks of one size, on several threads: what a block gives does not depend on who computes it."""

from __future__ import annotations

import os
from collections.abc import Callable

__all__ = ["BLOCK", "FEW", "FEW_SEARCHED", "cores", "evenly", "in_blocks", "keep_freed_memory"]

BLOCK = 24_000
"""Points of a block of NumPy's passes.  The flagship's million points took 206 to 214 ns a point at least, with 16,384 251 to 260."""


FEW = 4
"""Points that are taken one by one, on plain numbers: to call NumPy takes longer than to compute them."""

FEW_SEARCHED = 32
"""The same of a search that takes steps: of a smooth law arrays are as fast from some 40 points on, of one with corners from 1,000."""

_SHARES = 8  # blocks, or a multiple of them: two, four and eight threads end together


def evenly(n: int, most: int, least: int) -> int:
    """The size of blocks of ``n`` points for threads to share: from ``least`` to ``most`` points each, whoever computes them."""
    return max(least, -(-n // (_SHARES * max(1, -(-n // (_SHARES * most))))))


def in_blocks(n: int, size: int, fill: Callable[[slice], None], threads: int | None = None) -> None:
    """``fill`` for each block of ``n`` points; on several threads an empty one before them, because what it needs is compiled there.

    ``threads``: None for as many as this process may use cores.  More than one is of use to what lets go of the interpreter.
    """
    blocks = [slice(start, min(start + size, n)) for start in range(0, n, size)]
    many = min(len(blocks), threads or cores())
    if many > 1:
        from concurrent.futures import ThreadPoolExecutor

        fill(slice(0, 0))
        with ThreadPoolExecutor(many) as pool:
            list(pool.map(fill, blocks))
    else:
        for block in blocks:
            fill(block)


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


_FEW = 1_024  # points whose temporary arrays are too small to matter
_ROOM = 3 << 19  # numbers: some times what the temporary arrays of a block take together


def keep_freed_memory(points: int) -> None:
    """Before work in blocks on so many points.

    The C library of Linux hands freed memory back to the system, and has every page of it faulted in again, until an
    array of megabytes has come and gone: then it takes such sizes for usual.  The closed form of ten thousand to a
    hundred thousand points takes half the time.  Nothing is written to that array, so it costs no memory, and elsewhere it changes nothing.
    """
    if points > _FEW:
        import numpy as np

        np.empty(_ROOM)
