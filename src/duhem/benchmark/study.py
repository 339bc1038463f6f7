"""What every benchmark leaves behind, whatever it measures: the law, the machine, what was left out, whether it got to its end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from duhem.left_out import LeftOut

__all__ = ["Study"]


@dataclass(frozen=True, kw_only=True)
class Study(ABC):
    """``subject``: parameters and stiffness in words; ``machine`` as :func:`duhem.benchmark.machine.machine` has it."""

    law: str
    subject: str
    machine: dict[str, Any]
    left_out: tuple[LeftOut, ...]
    interrupted: bool

    @property
    @abstractmethod
    def failed(self) -> bool:
        """Whether nothing at all gave an answer."""

    @abstractmethod
    def measured(self) -> dict[str, Any]:
        """What is its own, for JSON."""

    def to_dict(self) -> dict[str, Any]:
        """For JSON; a number that is not finite is null."""
        head = {"law": self.law, "subject": self.subject, "machine": self.machine}
        return head | self.measured() | {"left_out": [part.to_dict() for part in self.left_out]}
