"""Parquet's package, of the extra ``parquet``: imported where a table is written or read, and asked for before a long run."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from duhem.errors import MissingExtraError

__all__ = ["check", "packages"]


def check() -> None:
    """MissingExtraError where it is not installed; nothing is imported."""
    if find_spec("pyarrow") is None:
        raise MissingExtraError("pyarrow", "parquet")


def packages() -> tuple[Any, Any]:
    """``pyarrow`` and ``pyarrow.parquet``; MissingExtraError without them."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingExtraError("pyarrow", "parquet") from None
    return pyarrow, parquet
