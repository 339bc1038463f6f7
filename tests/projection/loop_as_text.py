"""The loop that says which points are plainly right, run as the text that it is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from duhem.projection import compiled_judge
from duhem.projection.increment import Increment
from duhem.projection.residuals import Judge, Told
from duhem.projection.result import Solution

__all__ = ["as_text"]


def as_text(monkeypatch: pytest.MonkeyPatch, question: Increment, solution: Solution, convex: bool, chunk: int = 128) -> Told:
    """The loop, not compiled."""

    def run(text: str, entry: str) -> Any:
        assert "CHUNK = 128" in text
        space: dict[str, Any] = {}
        exec(text.replace("CHUNK = 128", f"CHUNK = {chunk}"), space)
        return space[entry]

    monkeypatch.setattr(compiled_judge, "compiled_text", run)
    with np.errstate(all="ignore"):
        return compiled_judge.told(question, solution, Judge.of(question, solution, convex), 1)
