"""Answers kept on disk: the next process reads whether K is shown to be convex without loading what proves it.

What is open is kept too: it is so within the steps that the question names, and asked again it would be.  An answer is found by the whole
law and everything that had a part in it: the question, the text of duhem by its files' sizes and times, as Python finds its bytecode, and
the packages that decide.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import sympy as sp

from duhem.law.formula_law import Criterion
from duhem.projection import kept_files
from duhem.projection.kept_code import kept_folder

__all__ = ["ANSWERS", "keep", "place", "recalled"]

ANSWERS = "proved", "refuted", "open"

_MOST = 4_000  # files: of a law that is convex for some numbers alone there is a question each time
_DECIDE = "sympy", "mpmath", "flint", "z3", "numpy"


def place(law: Criterion, question: str) -> Path | None:
    """Where the answer to a ``question`` about the law is kept; None where there is no telling what it rests on."""
    try:
        digest = hashlib.sha256("\n".join([*_made_with(), question, *_told(law)]).encode()).hexdigest()
        return kept_folder() / "verdicts" / digest[:40]
    except (LookupError, OSError, ValueError, RuntimeError):  # a value of another kind, no file, no folder of the user's own
        return None


def recalled(path: Path) -> str | None:
    """The answer that is kept there; None where there is none, or not a whole one."""
    content = kept_files.read(path)
    return next((answer for answer in ANSWERS if content == answer.encode()), None)


def keep(path: Path, answer: str) -> None:
    """Write the answer down; where there are many, the older half of them makes room."""
    with suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        kept_files.written(path, answer.encode())
        if len(os.listdir(path.parent)) > _MOST:
            for old in sorted(path.parent.iterdir(), key=lambda one: one.stat().st_mtime_ns)[: _MOST // 2]:
                old.unlink(missing_ok=True)


def _told(value: Any) -> Iterator[str]:
    """A value in words that tell it from every other.  LookupError for a kind that is not known here."""
    if isinstance(value, sp.Basic):
        yield sp.srepr(value)
    elif value is None or isinstance(value, (str, int)):
        yield repr(value)
    elif isinstance(value, tuple):
        yield f"tuple of {len(value)}"
        for each in value:
            yield from _told(each)
    elif isinstance(value, Mapping):
        yield f"mapping of {len(value)}"
        for item in value.items():
            yield from _told(item)
    elif is_dataclass(value) and type(value).__module__.startswith("duhem."):
        yield f"{type(value).__module__}.{type(value).__qualname__}"
        for field in fields(value):
            if field.init:  # what else it knows is made of these
                yield from _told(getattr(value, field.name))
    else:
        raise LookupError(type(value))


@cache
def _made_with() -> tuple[str, ...]:
    """What a proof rests on: Python, duhem's text and the packages that decide."""
    own = Path(__file__).parents[1]
    told = [sys.version, sp.__version__, *sorted(f"{k}={v}" for k, v in os.environ.items() if k.startswith("SYMPY_"))]
    for folder, below, names in os.walk(own):
        below.sort()
        told += [_file(Path(folder, name)) for name in sorted(names) if name.endswith(".py")]
    for name in _DECIDE:
        found = find_spec(name)
        told.append(name if found is None or found.origin is None else _file(Path(found.origin)))
    return tuple(told)


def _file(path: Path) -> str:
    seen = path.stat()
    return f"{path} {seen.st_size} {seen.st_mtime_ns}"
