"""What a run did not need, said in so many words: a part that is left out is named with its reason."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["LeftOut"]


class LeftOut(NamedTuple):
    """A part that was not examined, derived or measured, and why."""

    part: str
    reason: str

    def to_dict(self) -> dict[str, str]:
        """The entry as the JSON reports have it."""
        return self._asdict()

    def __str__(self) -> str:
        return f"{self.part}: {self.reason}"
