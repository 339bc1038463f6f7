"""Answers that a routine has given: whether they are what they were, once it has answered again."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np

__all__ = ["FormerAnswers"]

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
