"""What every benchmark leaves behind, whatever it measures: the law, the machine, what was left out, and the frame of its text."""

from __future__ import annotations

import platform
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from duhem.omitted import LeftOut
from duhem.projection.in_blocks import cores
from duhem.show.page import Page
from duhem.show.printing import finite
from duhem.version import distribution

__all__ = ["Study", "machine", "report"]

_PACKAGES = (
    "numpy", "scipy", "sympy", "mpmath", "cvxpy-base", "clarabel", "numba", "cvxopt", "ecos", "moreau", "osqp", "qoco", "scs", "jax",
    "jaxmat", "qpax", "proxsuite",
)  # fmt: skip


def machine() -> dict[str, Any]:
    """Processor, system, versions."""
    return {
        "processor": _processor(),
        "processors_usable": cores(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name.removesuffix("-base"): found for name in _PACKAGES if (found := distribution(name)) is not None},
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            for line in stream:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


@dataclass(frozen=True, kw_only=True)
class Study(ABC):
    """``subject``: parameters and stiffness in words; ``machine`` as :func:`duhem.benchmark.study.machine` has it."""

    law: str
    subject: str
    machine: dict[str, Any] = field(default_factory=machine)
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
        return dict(finite(head | self.measured() | {"left_out": [part.to_dict() for part in self.left_out]}))


def report(study: Study, facts: Sequence[str], parts: Sequence[Sequence[str]], page: Page) -> str:
    """Law and ``facts``, the parts, then what was left out and whether the run was stopped."""
    head = [*page.hanging(f"{study.law}: {study.subject}"), *(line for fact in facts for line in page.hanging(fact, rest=""))]
    stopped = ["Interrupted: this is what was done."] if study.interrupted else []
    return page.report([head, *parts, page.items("Omitted", study.left_out), stopped])
