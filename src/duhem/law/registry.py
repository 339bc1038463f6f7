"""The laws known by name in this process: whatever was decorated or registered since it began."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

__all__ = ["register", "registered"]

_registered: dict[str, Any] = {}


def register(name: str, law: Any) -> None:
    """Make a law, of whatever kind, known by a name in this process."""
    _registered[name] = law


def registered() -> Mapping[str, Any]:
    """The laws registered so far in this process, by name."""
    return MappingProxyType(_registered)
