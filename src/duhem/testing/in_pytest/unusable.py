"""What cannot be asked is one test that errs: where its module or its run ended instead, the results of others would be hidden."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from duhem.testing.in_pytest.groups import group

__all__ = ["UnusableTest"]


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
