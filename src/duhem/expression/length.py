"""Lengths of vectors given by their components: by squares where these stay in the range of doubles, else by hypot."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

__all__ = ["length"]

_SQUARES = 2.0**-900, 2.0**900  # of lengths whose squares are good to the last digits: no part that counts has vanished


def length(first: Any, *others: Any) -> Any:
    """(a^2 + b^2 + ...)^1/2, to 2^-53 (count/2 + 1) of itself on arrays; hypot, which takes ten times as long, where it has to be."""
    parts = (first, *others)
    if not others or not all(isinstance(x, np.ndarray) for x in parts):
        return reduce(np.hypot, others, np.abs(first))
    squares = reduce(np.add, [np.square(x) for x in parts])
    found = np.sqrt(squares)
    if not (squares.min(initial=1.0) >= _SQUARES[0] and squares.max(initial=1.0) <= _SQUARES[1]):
        far = ~((squares >= _SQUARES[0]) & (squares <= _SQUARES[1]))
        each = [x[far] for x in np.broadcast_arrays(*parts)]
        found = np.array(found)
        found[far] = reduce(np.hypot, each[1:], np.abs(each[0]))
    return found
