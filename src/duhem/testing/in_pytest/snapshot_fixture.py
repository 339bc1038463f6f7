"""The fixture ``duhem_snapshot``: laws compared with what is kept beside the test that asks."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from hashlib import sha256
from numbers import Real
from pathlib import Path
from typing import Any

import pytest

from duhem.errors import DuhemError
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.testing.snapshots import Entry, Project, SnapshotFile, differences, snapshot

__all__ = ["compared"]

_LONGEST = 100


def compared(request: pytest.FixtureRequest, project: Project) -> Callable[..., Entry]:
    """A function that compares a law, or keeps it where ``--duhem-update`` is given, and returns what was found.

    The file is of the test with its classes, ``snapshots/test_m/TestX.test_a.json``, and an entry of the law with the values it
    is given and the claims that are named.  The tolerance that the file states stays when it is written again.
    """
    test = request.node
    folder = test.path.parent / "snapshots" / test.path.stem
    classes = [each.name for each in test.listchain() if isinstance(each, pytest.Class)]
    file = folder / f"{_short('.'.join([*classes, test.name]))}.json"
    update = bool(test.config.getoption("--duhem-update"))
    asked: dict[str, Entry] = {}

    def compare(law: Law | str | Path, parameters: Mapping[str, Any] | None = None, claims: Iterable[str] | None = None) -> Entry:
        __tracebackhide__ = True
        named = (claims,) if isinstance(claims, str) else None if claims is None else tuple(claims)
        key = _key(load(law).name, parameters, named)
        shown = os.path.relpath(file, test.config.rootpath)
        kept, lacking = SnapshotFile(), ""
        try:
            kept = SnapshotFile.read(file)
            entry = {} if update else kept.entry(key, file)
        except DuhemError as fault:
            lacking = fault.what
        if update:  # the tolerance is the owner's to change; that of a new file where it cannot be read
            asked[key] = snapshot(law, project, parameters, claims=named)
            file.parent.mkdir(parents=True, exist_ok=True)
            SnapshotFile(asked, kept.tolerance).write(file)
            return asked[key]
        if lacking:  # told outside: what was raised names an option of the command, and pytest would show both
            pytest.fail(f"{key}: {shown}: {lacking}; check the results and store them with --duhem-update", pytrace=False)
        now = snapshot(law, project, parameters, claims=named, increments=entry["increments"])
        if lines := differences(entry, now, kept.tolerance):
            head = f"{key} is not as {shown} has it; if this is intended, store it with --duhem-update"
            pytest.fail("\n  ".join([head, *lines]), pytrace=False)
        return now

    return compare


def _short(name: str) -> str:
    """A name as every file system takes it; what is cut off of a long one still tells it from others."""
    plain = re.sub(r"[^A-Za-z0-9_.=+-]+", "-", name).strip("-")
    return plain if len(plain) <= _LONGEST else f"{plain[: _LONGEST - 9]}-{sha256(name.encode()).hexdigest()[:8]}"


def _key(name: str, parameters: Mapping[str, Any] | None, claims: Iterable[str] | None) -> str:
    """A law with what it is given and asked, whatever the order: ``orthotropic, mu_a = 0.2, mu_b = 0.1, claims convexity origin``."""
    values = ((each, float(value) if isinstance(value, Real) else value) for each, value in (parameters or {}).items())
    asked = [] if claims is None else [" ".join(["claims", *sorted({*map(str, claims)})])]
    return ", ".join([name, *sorted(f"{each} = {value}" for each, value in values), *asked])
