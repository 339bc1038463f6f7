"""The loop that says which points are plainly right, run as the text that it is."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

from duhem.projection import compiled_judge, judge_kernel
from duhem.projection.increment import Increment
from duhem.projection.residuals import Judge, Told
from duhem.projection.result import Solution

__all__ = ["as_text"]


def as_text(monkeypatch: pytest.MonkeyPatch, question: Increment, solution: Solution, convex: bool, chunk: int = 128) -> Told:
    """The loop, not compiled."""

    def run(text: str, entry: str, inlined: tuple[str, ...]) -> Any:
        sources = text, inspect.getsource(judge_kernel)  # what a law has no use for is in its text no more
        assert all(any(f"def {name}(" in source for source in sources) for name in inlined) and "CHUNK = 128" in text
        space: dict[str, Any] = {}
        exec(text.replace("CHUNK = 128", f"CHUNK = {chunk}"), space)
        return space[entry]

    monkeypatch.setattr(compiled_judge, "compiled_text", run)
    with np.errstate(all="ignore"):
        return compiled_judge.told(question, solution, Judge.of(question, solution, convex), 1)
