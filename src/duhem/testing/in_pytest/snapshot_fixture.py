"""The fixture ``duhem_snapshot``: laws compared with what is kept beside the test that asks."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pytest

from duhem.errors import DuhemError
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.testing.snapshots.snapshot import Entry, Project, snapshot
from duhem.testing.snapshots.snapshot_difference import differences
from duhem.testing.snapshots.snapshot_file import SnapshotFile

__all__ = ["compared"]


def compared(request: pytest.FixtureRequest, project: Project) -> Callable[..., Entry]:
    """A function that compares a law, or keeps it where ``--duhem-update`` is given, and returns what was found."""
    test = request.node
    file = test.path.parent / "snapshots" / test.path.stem / f"{re.sub(r'[^A-Za-z0-9_.=+-]+', '-', test.name).strip('-')[:100]}.json"
    update = bool(test.config.getoption("--duhem-update"))
    asked: dict[str, Entry] = {}

    def compare(law: Law | str | Path, parameters: Mapping[str, Any] | None = None, claims: Iterable[str] | None = None) -> Entry:
        __tracebackhide__ = True
        name = load(law).name
        shown = os.path.relpath(file, test.config.rootpath)
        if update:
            asked[name] = snapshot(law, project, parameters, claims=claims)
            file.parent.mkdir(parents=True, exist_ok=True)
            SnapshotFile(asked).write(file)
            return asked[name]
        found = _kept(file, name)
        if isinstance(found, DuhemError):
            pytest.fail(f"{name}: {shown}: {found.what}; look at what is found and keep it with --duhem-update", pytrace=False)
        entry, tolerance = found
        now = snapshot(law, project, parameters, claims=claims, increments=entry["increments"])
        if lines := differences(entry, now, tolerance):
            head = f"{name} is not as {shown} has it; if it is meant, keep it with --duhem-update"
            pytest.fail("\n  ".join([head, *lines]), pytrace=False)
        return now

    return compare


def _kept(file: Path, name: str) -> tuple[Entry, float] | DuhemError:
    """What is kept of a law and how far numbers may move; the error where nothing is."""
    try:
        kept = SnapshotFile.read(file)
        return kept.entry(name, file), kept.tolerance
    except DuhemError as fault:
        return fault
