"""What a routine has spoilt: arrays that it is only given, and answers that its caller has already."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["FormerAnswers", "Overwritten", "changed", "overwritten"]

Overwritten = NDArray[np.object_]  # (N,) names with commas, "" where nothing was


def changed(pairs: Mapping[str, tuple[NDArray[Any], NDArray[Any]]]) -> dict[str, NDArray[np.bool_]]:
    """Which rows of an array are no more what they were, of pairs by name; what is the same to the last bit is left out."""
    return {name: _differs(*pair) for name, pair in pairs.items() if pair[0].tobytes() != pair[1].tobytes()}


def overwritten(found: Mapping[str, NDArray[np.bool_]]) -> Overwritten | None:
    """The names of what was changed at each of N increments, of (N,) by name; None where nothing was at all."""
    if not any(each.any() for each in found.values()):
        return None
    rows = np.array(list(found.values())).T
    return np.array([", ".join(name for name, bad in zip(found, row, strict=True) if bad) for row in rows], dtype=object)


def _differs(one: NDArray[Any], other: NDArray[Any]) -> NDArray[np.bool_]:
    """Which rows are not the same in each entry; a nan is the same as another."""
    unlike = (one != other) & ~(np.isnan(one) & np.isnan(other))
    return np.asarray(unlike.reshape(len(one), -1).any(axis=1))


_KEPT = 4  # answers to so many increments: as many buffers may be taken by turns
_Parts: TypeAlias = Callable[[], Mapping[str, Any]]
_Answer: TypeAlias = tuple[_Parts, dict[str, bytes]]


class FormerAnswers:
    """The last answers to each number of increments, as the routine gave them, and what they said then.

    A routine that hands out one and the same buffer, as wrappers of C are prone to, changes the answers that its caller has already.
    """

    def __init__(self) -> None:
        self._kept: dict[int, deque[_Answer]] = {}
        self._last = 0

    def spoilt(self, count: int, parts: _Parts) -> str:
        """Which parts of former answers are no longer what they were, "" where none; the answer to ``count`` increments is kept.

        ``parts`` reads what was answered, by name, and reads it anew whenever it is called.
        """
        changed: dict[str, None] = {}
        for number in {count, self._last} & self._kept.keys():
            kept, same = self._kept[number], _none()
            for i, (read, said) in enumerate(kept):
                now = _said(read) if i in (0, len(kept) - 2, len(kept) - 1) else said  # each is looked at early, and once more at last
                differs = [name for name in said if said[name] != now.get(name)]
                changed |= dict.fromkeys(differs)
                if not differs:
                    same.append((read, said))
            self._kept[number] = same
        self._kept.setdefault(count, _none()).append((parts, _said(parts)))
        self._last = count
        return ", ".join(f"{name} of an earlier answer" for name in changed)


def _none() -> deque[_Answer]:
    return deque(maxlen=_KEPT)


def _said(parts: _Parts) -> dict[str, bytes]:
    """What an answer says, to the last bit; what is no array is for others to judge."""
    said = {}
    for name, part in parts().items():
        try:
            said[name] = b"" if part is None else np.asarray(part).tobytes()
        except (TypeError, ValueError):
            said[name] = b""
    return said
