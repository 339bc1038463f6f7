"""A check that failed on one increment, what it shows there, and the Python that shows it again: a few lines, or a test file of its own."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from pathlib import Path
from textwrap import indent
from typing import Any

import numpy as np
from hypothesis.strategies import SearchStrategy

from duhem.law.formula_law import Criterion
from duhem.show.place import write
from duhem.testing.checks.registry import Check
from duhem.testing.drawn.case import Case, vector
from duhem.testing.routines.origin import Origin

__all__ = ["Departure", "Failure", "drawn_again", "write_replays"]

_LINE = "\n"
_NO_LAW = "...  # write the code that makes the law here"

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Departure:
    """One increment: stresses ``trial``, ``returned`` and ``closest`` (None where none is known) in the units of the law.

    ``apart``: ``returned`` is farther from ``closest`` than the routine is allowed to be.
    """

    trial: Numbers
    pressure: float | None
    stiffness: tuple[Numbers, ...]
    returned: Numbers
    closest: Numbers | None
    apart: bool


@dataclass(frozen=True)
class Failure:
    """A check that failed: ``case`` is one increment, shrunk; ``measured`` exceeds ``allowed`` there (or is nan).

    ``departure`` is what the routine returned and the closest point; ``diagnoses`` what it does instead, by name, the likeliest
    first, where that is known (:mod:`duhem.testing.failures.diagnosis`);
    ``explains`` the checks that failed too, likely for the same reason.  ``law`` is None for a routine tested without one.
    ``drawn`` are the arguments of the run that draws all increments again, as Python, "" where these cannot be written; ``alone``: one
    increment may show it by itself, as it need not where a routine keeps something between calls.  ``held``: the arguments, as Python,
    that hold a material to a law with a state.  ``passes_at``: the least power of ten as an accuracy at which the increment passes.
    ``where``: at how many of the increments of each region of stress it fails (:mod:`duhem.testing.failures.diagnosis`).
    """

    check: Check
    law: Criterion | None
    message: str
    case: Case
    measured: float
    allowed: float
    accuracy: float
    routine: str
    open_parameters: tuple[str, ...]
    explains: tuple[str, ...] = ()
    departure: Departure | None = None
    diagnoses: Mapping[str, str] = field(default_factory=dict)
    origin: Origin = field(default_factory=Origin)
    drawn: str = ""
    alone: bool = True
    held: str = ""
    passes_at: float | None = None
    where: str = ""

    @property
    def title(self) -> str:
        """The check and its statement."""
        return str(self.check)

    @property
    def increment(self) -> str:
        """The increment of the case with its parameters, in round numbers."""
        return "; ".join(text for name, text in self._increment() if name in ("law", "increment"))

    @property
    def diagnosis(self) -> str:
        """What the routine likely does instead; '' where nothing is known that gives its answers."""
        return next(iter(self.diagnoses.values()), "")

    def __str__(self) -> str:
        said = [f"  {name:<11} {text}" for name, text in self._said()]
        shown = [] if self.check.whole else ["  to see it again:", *(f"    {line}" for line in self.reproducer().splitlines())]
        return "\n".join([self.title, *said, *shown])

    def _said(self) -> Iterator[tuple[str, str]]:
        yield from zip(("likely", *["or"] * len(self.diagnoses)), self.diagnoses.values(), strict=False)
        if not self.check.whole:
            yield from self._increment()
        if self.where:
            yield "where", self.where
        yield "violated", f"{self.check.formula}: {self.message}"
        yield "tolerance", self.check.tolerance + (f"; passes at an accuracy of {self.passes_at:g}" if self.passes_at else "")
        yield "source", self.check.source
        if self.explains:
            yield "explains", f"{', '.join(self.explains)}, which failed too"

    def _increment(self) -> Iterator[tuple[str, str]]:
        values = [f"{name} = {value:.6g}" for name, value in self.case.parameters.items()]
        if self.law is not None or values:
            yield "law", ", ".join(([] if self.law is None else [self.law.name]) + values)
        case, found = self.case, self.departure
        asked = tuple(case.trial[0]), None if case.pressure is None else float(case.pressure[0]), tuple(map(tuple, case.stiffness.tolist()))
        of_tensors = None if self.law is None or self.law.stress is None else self.law.stress.unit_stiffness
        yield "increment", _increment(*asked, of_tensors)
        if found is None or self.check.law_only:
            return
        if self.law is None and case.path[0].any():
            yield "after", " -> ".join(map(vector, case.path[0].tolist())) + ", a path of k u"
        if (at := (found.trial, found.pressure, found.stiffness)) != asked:
            yield "at", f"{_increment(*at, of_tensors)}, which the check also uses"
        yield "returned", vector(found.returned)
        if found.closest is not None:
            within = "" if found.apart else ", within what is allowed"
            yield "closest", vector(found.closest)
            yield "difference", vector(np.subtract(found.returned, found.closest).tolist()) + within

    # -- Python that shows it again ------------------------------------------------------------------------------------

    def reproducer(self) -> str:
        """Return a few lines of Python that print the failure again wherever they are run.

        ``...`` stands for a routine or a law that has no name to import.  What need not show at one increment alone is shown by the run
        that draws them all again, where its arguments can be written.
        """
        found, whole = self.origin, self.drawn and not self.alone
        on_path = found.folder if found.making else ""
        making = found.making or f"update = ...  # {_nameless(self.routine)}"
        lines = [
            "import sys" if on_path else "",
            _imports(found.law).strip(),
            f"from duhem.testing import {'conformance' if whole else 'Case, violation'}",
            f"sys.path.append({on_path!r})" if on_path else "",
            *making.splitlines(),
            f"law = {found.law or _NO_LAW}",
            "" if whole else f"case = {self.case!r}",
            f"print({self._all_asked('law') if whole else self._asked('law', 'case')})",
        ]
        return "\n".join(filter(None, lines))

    def _asked(self, law: str, case: str) -> str:
        free = "" if self.open_parameters == tuple(self.case.parameters) else f", open_parameters={self.open_parameters!r}"
        held = f", {self.held}" if self.held else ""
        return f"violation({self.check.name!r}, {law}, update, {case}, accuracy={self.accuracy!r}{held}{free})"

    def _all_asked(self, law: str) -> str:
        return f"conformance({law}, update, {self.drawn}{self.drawn and ', '}accuracy={self.accuracy!r})"

    def replay(self, place: Path | None = None) -> str:
        """Return the text of a test file for the folder ``place`` that fails as long as the routine does.

        It shows one increment, and where that passes the run that found it, with its arguments where these can be written: what a routine
        keeps of other calls shows only after them.  The folder of the routine, and files that it or the law is made of, such as a shared
        library, are named from ``place``, where they have a folder above them in common, so that all may move together.  Where the routine
        or the law has no name that a file can import, as one of ``__main__`` or a closure, it is a stub that says so.  The routine is bound
        inside the test: pytest would collect one that carries the marker, or its class, from the module.
        """
        found, check = self.origin, self.check.name
        making, law = (_moving(place, text) for text in (found.making, found.law or _NO_LAW))
        names = f"Case, {'conformance, ' if self.drawn else ''}violation" if self.alone else "conformance"
        beside = _from(place, found.folder) or repr(found.folder)
        path = f"sys.path.append({beside})  # where the routine is\n\n" if making and found.folder else ""
        used = {"import sys": path, "from pathlib import Path": "Path(__file__)" in f"{path}{making}{law}"}
        imports = "".join(f"{line}\n" for line, needed in used.items() if needed)
        arguments = "".join(f"    {line},\n" for line in self.case.arguments())
        case = f"CASE = Case(\n{arguments})\n" if self.alone else ""
        run = [f"{making}\n"] if making else []
        if self.alone:
            run += [f"wrong = {self._asked('LAW', 'CASE')}", "assert wrong is None, wrong"]
        if not self.drawn and not self.alone:
            run.append("# write the parameters, the stiffness and the pressure of the failed run here")
        elif self.drawn and self.alone:
            run.append("# this error depends on earlier calls, so the test repeats the whole run")
        if self.drawn or not self.alone:
            run += [f"report = {self._all_asked('LAW')}", f"assert report.failure_of({check!r}) is None, str(report)"]
        return f'''"""{self.title} (of {self.routine})."""

{imports}{imports and _LINE}{_imports(law)}from duhem.testing import {names}

{path}{"" if making else _stub(self.routine)}LAW = {law}
{case}

def test_{_words(check)}() -> None:
{indent(_LINE.join(run), "    ")}
'''


def _increment(
    trial: Sequence[float], pressure: float | None, stiffness: Sequence[Sequence[float]], of_tensors: Sequence[float] | None
) -> str:
    load = "" if pressure is None else f", pressure {pressure:.6g}"
    return f"trial {vector(trial)}{load}, stiffness {_matrix(stiffness, of_tensors or (1.0,) * len(trial))}"


def _matrix(rows: Sequence[Sequence[float]], one: Sequence[float]) -> str:
    """Write a matrix: a multiple of ``one``, which is what a single number means, as that number, and a diagonal one as its diagonal."""
    diagonal = [row[i] for i, row in enumerate(rows)]
    if any(x for i, row in enumerate(rows) for j, x in enumerate(row) if i != j):
        return f"[{', '.join(map(vector, rows))}]"
    shares = {x / unit for x, unit in zip(diagonal, one, strict=True)}
    return f"{shares.pop():.6g}" if len(shares) == 1 else f"diag {vector(diagonal)}"


def write_replays(failures: Iterable[Failure], folder: str | Path) -> tuple[Path, ...]:
    """Write one test file for each failure, named as pytest looks for it, to a folder that is made where there is none."""
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    written, names = [], list[str]()
    for failure in failures:
        names.append(f"test_{_words(failure.routine.removeprefix('.'))}_{_words(failure.check.name)}")
        many = names.count(names[-1])  # another cause of the same check
        written.append(place / f"{names[-1]}{f'_{many}' if many > 1 else ''}.py")
        write(str(written[-1]), failure.replay(place.resolve()))
    return tuple(written)


def _words(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_") or "routine"


def _nameless(routine: str) -> str:
    """Return a comment that says what to put in the place of a routine without a name to import."""
    maker, inner, _ = routine.rpartition(".<locals>.")
    said = f"made by {maker}" if inner else f"{routine} has no name that can be imported"
    return f"{said}: write the code that makes it here"


def _stub(routine: str) -> str:
    told = f"{routine} has no name that can be imported: call it here"
    return f"def update(trial, pressure, stiffness, **parameters):\n    raise NotImplementedError({told!r})\n\n"


def _imports(law: str) -> str:
    """Return the line that imports what the Python for a law uses, if any."""
    names = [name for name in ("Criterion", "Domain", "load") if f"{name}(" in law or f"{name}." in law]
    return f"from duhem import {', '.join(names)}\n" if names else ""


def drawn_again(given: Mapping[str, Any], **counts: Any) -> str:
    """Write as Python the arguments with which :func:`duhem.testing.conformance` draws the same cases; "" where one cannot be written."""
    plain = {name: _plain(value) for name, value in given.items() if value is not None}
    return "" if None in plain.values() else ", ".join(f"{name}={value!r}" for name, value in {**plain, **counts}.items())


def _plain(value: Any) -> Any:
    """Return a value as numbers, and lists and mappings of them; None for a strategy."""
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
    """Write as Python a folder or file as seen from ``place``; '' where they have no folder in common."""
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
    """Return Python in which files that are named by their whole path are named from ``place``."""
    lines = text.encode().splitlines(keepends=True)  # ast counts bytes
    named = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    for node in sorted(named, key=lambda node: (node.lineno, node.col_offset), reverse=True):
        path = str(node.value)
        if os.path.isabs(path) and Path(path).is_file() and node.lineno == node.end_lineno and (beside := _from(place, path)):
            line = lines[node.lineno - 1]
            lines[node.lineno - 1] = line[: node.col_offset] + beside.encode() + line[node.end_col_offset :]
    return b"".join(lines).decode()
