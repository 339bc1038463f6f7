"""A campaign as a frozen value: its rows, what is asked of each, and what a row may cost."""

from __future__ import annotations

import hashlib
import json
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

from duhem.screening.inquiries import Inquiry
from duhem.screening.rows import Row, RowBlock
from duhem.version import __version__

__all__ = ["Campaign"]


@dataclass(frozen=True)
class Campaign:
    """Rows in ``blocks``, numbered from 1 on, and the ``inquiry`` put to each.

    What a verdict may cost is counted in steps, by the inquiry; beyond ``seconds`` of the processor or ``memory`` gigabytes more than
    its process has at the start, a row is ended with its process; and so is one that waits, by the clock, ten times ``seconds`` and more.
    """

    blocks: tuple[RowBlock, ...]
    inquiry: Inquiry
    seconds: float = 600.0
    memory: float = 4.0
    out: str | None = None
    inputs: tuple[str, ...] = ()

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @cached_property
    def _ends(self) -> tuple[int, ...]:
        return tuple(accumulate(map(len, self.blocks)))

    def row(self, number: int) -> Row:
        """The row of a number from 1 to ``len``."""
        block = bisect_right(self._ends, number - 1)
        before = self._ends[block - 1] if block else 0
        return self.blocks[block].row(number - 1 - before, number)

    @property
    def fingerprint(self) -> str:
        """What tells the campaign's table from every other: all that is asked, and the version of duhem."""
        told = [__version__, self.inquiry.told(), self.seconds, self.memory, *(block.told() for block in self.blocks)]
        return hashlib.sha256(json.dumps(told).encode()).hexdigest()
