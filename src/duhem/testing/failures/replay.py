"""A failure as a test file of its own."""

from __future__ import annotations

import re

from duhem.testing.drawn.case import Case
from duhem.testing.routines.origin import Origin

__all__ = ["test_file", "test_name"]


def test_name(routine: str, check: str) -> str:
    """A file name for a replay, as pytest looks for it."""
    return f"test_{_words(routine.removeprefix('.'))}_{_words(check)}.py"


def _words(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_") or "routine"


def test_file(title: str, check: str, routine: str, found: Origin, case: Case | None, accuracy: float, passed: tuple[str, ...]) -> str:
    """The text of a file that fails with the bug and passes without; a stub where routine or law have to be filled in.

    Without a ``case`` no single increment shows the failure, and the file draws them again.
    """
    law = found.law or "None  # the law has no name that a file can import: put it here"
    names = [name for name in ("Criterion", "Domain", "load") if f"{name}(" in law or f"{name}." in law]
    what = "Case, violation" if case is not None else "conformance"
    lines = [
        f'"""{title} (of {routine})."""',
        "",
        *(["import sys", ""] if found.making and found.folder else []),
        *([f"from duhem import {', '.join(names)}"] if names else []),
        f"from duhem.testing import {what}",
        "",
        *([f"sys.path.append({found.folder!r})  # where the routine is", ""] if found.making and found.folder else []),
        *(found.making or _stub(routine)).splitlines(),
        "",
        f"LAW = {law}",
    ]
    if case is None:
        run = [
            "    # the parameters, the stiffness and the pressure of the run that failed go here",
            f"    report = conformance(LAW, update, checks={[check]!r}, accuracy={accuracy!r})",
            "    assert report.ok, str(report)",
        ]
    else:
        lines += ["CASE = Case(", *(f"    {line}," for line in case.arguments()), ")"]
        run = [
            f"    wrong = violation({check!r}, LAW, update, CASE, open_parameters={passed!r}, accuracy={accuracy!r})",
            "    assert wrong is None, wrong",
        ]
    return "\n".join([*lines, "", "", f"def test_{_words(check)}() -> None:", *run, ""])


def _stub(routine: str) -> str:
    told = f"{routine} has no name that a file can import: call it here"
    return f"def update(trial, pressure, stiffness, **parameters):\n    raise NotImplementedError({told!r})\n"
