"""The tests that pytest is given: what each of duhem's carries, and one that errs for what cannot be asked.

Where a module or a run ended instead, the results of others would be hidden.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

__all__ = ["UnusableTest", "group", "group_marks"]


def group(item: pytest.Item, name: str) -> None:
    """Mark a test; with ``--dist loadgroup`` those of one ``name`` ask for one worker (xdist 3.8 splits them under pytest 9.2)."""
    item.add_marker("duhem")
    for mark in group_marks(item.config, name):
        item.add_marker(mark)


def group_marks(config: pytest.Config, name: str) -> list[pytest.MarkDecorator]:
    """Return the marker of a group; none without xdist, which alone knows it."""
    if not config.pluginmanager.hasplugin("xdist"):
        return []
    return [pytest.mark.xdist_group(re.sub(r"[][@]", "-", name))]  # xdist looks for brackets and @ itself


class UnusableTest(pytest.Item):
    """A marker or file of which no test can be made, and the line that says why."""

    def __init__(self, *, said: str, line: int | None = None, **whole: Any) -> None:
        super().__init__(**whole)
        self.said, self.line = said, line
        group(self, self.nodeid)

    def setup(self) -> None:
        pytest.fail(self.said, pytrace=False)

    def runtest(self) -> None:
        """There is nothing to run."""

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, self.line, self.name
