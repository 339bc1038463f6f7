"""Snapshots of laws as a file: JSON with sorted keys and one value a line, which shows its changes in a review."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from duhem.errors import InputError
from duhem.law.placed_toml import text_of
from duhem.show.place import write
from duhem.testing.snapshots.snapshot import Entry
from duhem.testing.snapshots.snapshot_difference import TOLERANCE, differences

__all__ = ["SnapshotFile"]

_MOST_BYTES = 10_000_000
_REMEDY = "write it with --update"
_NUMBERS = ("trial", "stiffness", "stress", "slip")


@dataclass(frozen=True)
class SnapshotFile:
    """The entries of a file by the name under which each law was asked for; ``tolerance`` as the file states it.

    ``tolerance`` is by how much of their size stresses and slips may move; whoever keeps the file may change it there.
    """

    laws: Mapping[str, Entry] = field(default_factory=dict)
    tolerance: float = TOLERANCE

    @classmethod
    def read(cls, file: str | os.PathLike[str]) -> SnapshotFile:
        """InputError for a file that is not there or is no snapshot."""
        text = text_of(file, "snapshot", _MOST_BYTES, absent=_REMEDY)
        try:
            found = json.loads(text)
            laws, tolerance = found["laws"], found["tolerance"]
            for entry in laws.values():
                differences(entry, entry)  # all that is read later
                if not all(isinstance(each[part], dict) for each in entry["increments"] for part in ("parameters", *_NUMBERS)):
                    raise TypeError
                _ = [each["pressure"] for each in entry["increments"]]
            usable = isinstance(tolerance, float) and 0.0 <= tolerance < 1.0
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            usable = False
        if not usable:
            raise InputError("this is no snapshot", where=f"{file}", remedy=_REMEDY)
        return cls(laws, tolerance)

    def entry(self, name: str, file: str | os.PathLike[str]) -> Entry:
        """What is kept of a law; InputError where nothing is."""
        if name not in self.laws:
            alike = sorted(each for each in self.laws if each.partition(",")[0] == name.partition(",")[0])
            besides = f", only of {'; of '.join(alike)}" if alike else ""  # other values or claims
            raise InputError(f"nothing is kept of {name}{besides}", where=f"{file}", remedy=_REMEDY)
        return self.laws[name]

    def with_entries(self, entries: Mapping[str, Entry]) -> SnapshotFile:
        """With some laws added or replaced."""
        return replace(self, laws={**self.laws, **entries})

    def to_text(self) -> str:
        """The content of the file."""
        whole: dict[str, Any] = {"laws": dict(self.laws), "tolerance": self.tolerance}
        return json.dumps(whole, indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n"

    def write(self, file: str | os.PathLike[str]) -> None:
        """Write it beside and renamed: whole or not at all."""
        write(file, self.to_text())
