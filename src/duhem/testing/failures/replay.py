"""A failure as Python that shows it again: a few lines, or a test file of its own."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Mapping
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis.strategies import SearchStrategy

from duhem.testing.drawn.case import Case
from duhem.testing.routines.origin import Origin

__all__ = ["drawn_again", "lines_again", "test_file", "test_name"]

_NO_LAW = "...  # no file, name or formula gives this law again: put it here"


def test_name(routine: str, check: str) -> str:
    """A file name for a replay, as pytest looks for it."""
    return f"test_{_words(routine.removeprefix('.'))}_{_words(check)}.py"


def _words(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_") or "routine"


def test_file(
    title: str,
    check: str,
    routine: str,
    found: Origin,
    case: Case | None,
    accuracy: float,
    passed: tuple[str, ...],
    place: Path | None = None,
    drawn: str = "",
) -> str:
    """The text of a file that fails with the bug and passes without; a stub where routine or law have to be filled in.

    The folder of the routine, and files that it or the law is made of, such as a shared library, are said from the folder ``place`` of
    the file, where they have one above them in common, so that all may move together.  Where the ``case`` passes, or there is none
    because no single increment shows the failure, the file draws them again, with the arguments ``drawn`` of the run where these can
    be written.  The routine is bound inside the test: pytest would collect one that carries the marker, or its class, from the module.
    """
    making, law = (_moving(place, text) for text in (found.making, found.law))
    law = law or _NO_LAW
    what = "conformance" if case is None else f"Case, {'conformance, ' if drawn else ''}violation"
    beside = _from(place, found.folder)
    paths = [f"sys.path.append({beside or repr(found.folder)})  # where the routine is", ""] if making and found.folder else []
    imports = ["import sys"] if paths else []
    imports += ["from pathlib import Path"] if any("Path(__file__)" in text for text in (*paths, making, law)) else []
    lines = [
        f'"""{title} (of {routine})."""',
        "",
        *([*imports, ""] if imports else []),
        *_imports(law),
        f"from duhem.testing import {what}",
        "",
        *paths,
        *([] if making else [*_stub(routine).splitlines(), ""]),
        f"LAW = {law}",
    ]
    bound = [f"    {line}".rstrip() for line in making.splitlines()] + ([""] if making else [])
    run = []
    if case is not None:
        lines += ["CASE = Case(", *(f"    {line}," for line in case.arguments()), ")"]
        run += [
            f"    wrong = violation({check!r}, LAW, update, CASE, open_parameters={passed!r}, accuracy={accuracy!r})",
            "    assert wrong is None, wrong",
        ]
    if drawn or case is None:
        lacking = "    # the parameters, the stiffness and the pressure of the run that failed go here"
        run += [lacking] if not drawn else [] if case is None else ["    # what a routine keeps of other calls shows only after them"]
        run += [
            f"    report = conformance(LAW, update, {drawn}{drawn and ', '}accuracy={accuracy!r})",
            f"    assert report.failure_of({check!r}) is None, str(report)",
        ]
    return "\n".join([*lines, "", "", f"def test_{_words(check)}() -> None:", *bound, *run, ""])


def lines_again(check: str, routine: str, found: Origin, case: Case, accuracy: float, passed: tuple[str, ...], drawn: str = "") -> str:
    """Lines that print the failure again wherever they are run; ``...`` for a routine or a law that has to be filled in, which is said.

    ``drawn``, of what need not show at one increment alone: the arguments of the run that draws them all again.
    """
    paths = ["import sys"], [f"sys.path.append({found.folder!r})"]
    imported, appended = paths if found.making and found.folder else ([], [])
    making = found.making or f"update = ...  # {_nameless(routine)}"
    free = "" if passed == tuple(case.parameters) else f", open_parameters={passed!r}"
    if drawn:
        what, asked = "conformance", [f"print(conformance(law, update, {drawn}, accuracy={accuracy!r}))"]
    else:
        shown = f"print(violation({check!r}, law, update, case, accuracy={accuracy!r}{free}))"
        what, asked = "Case, violation", [f"case = {case!r}", shown]
    return "\n".join(
        [
            *imported,
            *_imports(found.law),
            f"from duhem.testing import {what}",
            *appended,
            *filter(None, making.splitlines()),
            f"law = {found.law or _NO_LAW}",
            *asked,
        ]
    )


def _nameless(routine: str) -> str:
    """What to put in the place of a routine that has no name to import."""
    maker, inner, _ = routine.rpartition(".<locals>.")
    return f"made by {maker}: put here the lines that make it" if inner else f"{routine} has no name that can be imported: put it here"


def _imports(law: str) -> list[str]:
    """The line that imports what the Python for a law is made of."""
    names = [name for name in ("Criterion", "Domain", "load") if f"{name}(" in law or f"{name}." in law]
    return [f"from duhem import {', '.join(names)}"] if names else []


def drawn_again(given: Mapping[str, Any], **counts: Any) -> str:
    """The arguments with which :func:`duhem.testing.conformance` draws the same cases, as Python; "" where one cannot be written."""
    plain = {name: _plain(value) for name, value in given.items() if value is not None}
    return "" if None in plain.values() else ", ".join(f"{name}={value!r}" for name, value in {**plain, **counts}.items())


def _plain(value: Any) -> Any:
    """Numbers, and lists and mappings of them; None for a strategy."""
    if isinstance(value, Mapping):
        parts = {name: _plain(part) for name, part in value.items()}
        return None if None in parts.values() else parts
    if isinstance(value, str):
        return value
    if isinstance(value, SearchStrategy):
        return None
    if isinstance(value, Real):
        return float(value) if float(value) == value else str(value)
    return np.asarray(value, dtype=np.float64).tolist()


def _from(place: Path | None, folder: str) -> str:
    """Python for a folder or file as seen from the one of the file; '' where they have nothing in common."""
    if place is None or not folder:
        return ""
    try:
        if os.path.commonpath([place, folder]) == Path(folder).anchor:
            return ""
        way = Path(os.path.relpath(folder, place)).as_posix()
    except ValueError:  # another drive
        return ""
    return f"str((Path(__file__).parent / {way!r}).resolve())"


def _moving(place: Path | None, text: str) -> str:
    """Python with the files that it names by their whole path named from the folder of the file."""
    lines = text.encode().splitlines(keepends=True)  # ast counts bytes
    named = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    for node in sorted(named, key=lambda node: (node.lineno, node.col_offset), reverse=True):
        path = str(node.value)
        if os.path.isabs(path) and Path(path).is_file() and node.lineno == node.end_lineno and (beside := _from(place, path)):
            line = lines[node.lineno - 1]
            lines[node.lineno - 1] = line[: node.col_offset] + beside.encode() + line[node.end_col_offset :]
    return b"".join(lines).decode()


def _stub(routine: str) -> str:
    told = f"{routine} has no name that a file can import: call it here"
    return f"def update(trial, pressure, stiffness, **parameters):\n    raise NotImplementedError({told!r})\n"
