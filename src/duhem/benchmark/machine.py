"""What the numbers of a benchmark were taken on."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

__all__ = ["cores", "machine"]

_PACKAGES = (
    "numpy", "scipy", "sympy", "mpmath", "cvxpy", "clarabel", "numba", "cvxopt", "ecos", "moreau", "osqp", "qoco", "scs", "jax", "jaxmat",
    "qpax", "proxsuite",
)  # fmt: skip


def machine() -> dict[str, Any]:
    """Processor, system, versions."""
    return {
        "processor": _processor(),
        "processors_usable": cores(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: found for name in _PACKAGES if (found := _version(name)) is not None},
    }


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            for line in stream:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _version(name: str) -> str | None:
    for candidate in (name, f"{name}-base"):
        try:
            return version(candidate)
        except PackageNotFoundError:
            continue
    return None
