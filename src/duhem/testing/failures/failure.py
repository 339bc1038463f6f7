"""A check that failed on one increment, what it shows there, and the Python that shows it again: a few lines, or a test file of its own.

A failing case is made small: the least of those that are met while Hypothesis shrinks it, then in round numbers.  What the failure does
not need is put to nothing, and the rest is rounded as far as the failure stays.
"""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import count, takewhile
from math import floor, inf, isfinite, log10
from numbers import Real
from pathlib import Path
from random import Random
from textwrap import indent
from time import monotonic
from typing import Any

import numpy as np
from hypothesis import find, settings
from hypothesis.errors import Flaky, NoSuchExample
from hypothesis.strategies import SearchStrategy

from duhem.expression.syntax import module_tree
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array
from duhem.show.place import write
from duhem.testing.checks.query import Raised
from duhem.testing.checks.registry import Check
from duhem.testing.drawn.case import Case, vector
from duhem.testing.drawn.values import Strategy, scaled
from duhem.testing.routines import Origin, Unfinished

__all__ = ["RAISED", "Departure", "Failure", "drawn_again", "least_case", "shortened", "simplified", "write_replays"]

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
    named = [node for node in ast.walk(module_tree(text)) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    for node in sorted(named, key=lambda node: (node.lineno, node.col_offset), reverse=True):
        path = str(node.value)
        if os.path.isabs(path) and Path(path).is_file() and node.lineno == node.end_lineno and (beside := _from(place, path)):
            line = lines[node.lineno - 1]
            lines[node.lineno - 1] = line[: node.col_offset] + beside.encode() + line[node.end_col_offset :]
    return b"".join(lines).decode()


# -- a failing case made small -----------------------------------------------------------------------------------------


_TRIES = 200  # to make a case round
_STRESSES = ("trial", "other", "third", "inside", "beside", "path")
RAISED = 60  # calls that raise while a case is made smaller, at most: each may have cost a process

Failing = Callable[[Case, Sequence[Check]], Failure | None]  # the first of some checks that fails on a case


class _Enough(BaseException):
    """Shrinking has had its tries, or the routine does not come back.  No Exception, which Hypothesis would take for one more failure."""


def least_case(
    failing: Failing,
    checks: Sequence[Check],
    drawn: Strategy,
    profile: settings,
    *,
    seed: int,
    tries: int,
    seconds: float | None,
    raised: Raised,
) -> tuple[Case, Failure] | None:
    """The least of the drawn cases that were met on which one of ``checks`` fails, and the first failure; None where none fails.

    From the first failure on only its check counts; so many ``tries``, and ``seconds``, are left then to find a smaller case.
    """
    met: list[Failure] = []
    tried, until, most = count(), inf, 0

    def fails(case: Case) -> bool:
        nonlocal until, most
        if met and (next(tried) == tries or monotonic() > until or raised.times > most):
            raise _Enough
        try:
            found = failing(case, (met[0].check,) if met else checks)
        except Unfinished as fault:
            raise _Enough(fault) from None
        if found is None:
            return False
        if not met:
            until, most = inf if seconds is None else monotonic() + seconds, raised.times + RAISED
        met.append(found)
        return True

    try:
        with suppress(NoSuchExample, Flaky):  # flaky: the routine has a memory, and the case that failed first is told
            find(drawn, fails, settings=profile, random=Random(seed))
    except _Enough as end:
        if end.args:
            raise end.args[0] from None
    return (met[-1].case, met[0]) if met else None


def simplified(
    case: Case,
    fails: Callable[[Case], bool],
    admitted: Callable[[Mapping[str, float]], bool],
    *,
    free: tuple[str, ...] = (),
    stiffness: bool = True,
    pressure: Callable[[float], bool] | None = lambda p: p <= 0.0,
) -> Case:
    """A case of one increment on which it still ``fails``, of rounder numbers, and of fewer that are not zero.

    What is left as it is: parameters but those that are ``free``, whose values have to be ``admitted``; the stiffness unless
    ``stiffness``; the pressure unless it may take the value that ``pressure`` is asked for.
    """
    shorter = _Shorter(case, fails)
    shorter.whole()
    if pressure is not None and case.pressure is not None:
        shorter.pressed(pressure)
    if stiffness:
        shorter.stiff()
    for name in free:
        shorter.parameter(name, admitted)
    for name in _STRESSES:
        shorter.numbers(name)
    return shorter.case


def shortened(case: Case, fails: Callable[[Case], bool], tries: int) -> Case:
    """A history of one increment on which it still ``fails``, with a shorter path, or none, and rounder stresses, in so many ``tries``."""
    shorter = _Shorter(case, fails, tries)
    shorter.whole(case.factor)  # which is the duration of a leg
    for name in ("trial", "path"):
        shorter.numbers(name)
    return shorter.case


class _Shorter:
    """The shortest case so far; ``left`` counts the tries that remain."""

    def __init__(self, case: Case, fails: Callable[[Case], bool], tries: int = _TRIES) -> None:
        self.case, self.fails, self.left = case, fails, tries

    def put(self, **changes: Any) -> bool:
        """Return whether the case still fails with ``changes``; they stay where it does."""
        if self.left == 0:
            return False
        self.left -= 1
        other = replace(self.case, **changes)
        if not self.fails(other):
            return False
        self.case = other
        return True

    def first(self, changes: Iterable[Mapping[str, Any]]) -> bool:
        """Try changes one after the other until the case still fails with one; return whether there was one."""
        return any(self.put(**each) for each in changes)

    def whole(self, factor: float = 2.0) -> None:
        """Put to nothing the parts that the failure does not look at."""
        case = self.case
        zero = np.zeros_like(case.trial)
        loads = None if case.pressure is None else np.repeat(case.pressure[:, None], 2, axis=1)
        if self.put(**{name: zero for name in _STRESSES[1:5]}, path=np.repeat(zero[:, None], 2, axis=1), loads=loads, factor=factor):
            return
        own, knots = case.loads, range(2, case.path.shape[1])
        self.first({"path": case.path[:, :n], "loads": None if own is None else own[:, :n]} for n in knots)
        for name in _STRESSES[1:5]:
            self.put(**{name: zero})

    def pressed(self, may: Callable[[float], bool]) -> None:
        """Put the pressure to -1 Pa, with all stresses in proportion or as they are, or else to a round number."""
        assert self.case.pressure is not None
        p = float(self.case.pressure[0])
        if may(-1.0) and p < 0.0:
            stresses = {name: getattr(self.case, name) / -p for name in _STRESSES}
            loads = None if self.case.loads is None else self.case.loads / -p
            if p == -1.0 or self.put(**stresses, pressure=[-1.0], loads=loads) or self.put(pressure=[-1.0]):
                p = -1.0
        self.first({"pressure": [other]} for other in _rounder(p) if may(other))
        if self.case.loads is not None and self.case.pressure is not None:
            self.put(loads=np.full_like(self.case.loads, self.case.pressure[0]))

    def stiff(self) -> None:
        k = self.case.stiffness
        self.first({"stiffness": other} for other in (np.eye(len(k)), np.diag(np.diag(k))) if not np.array_equal(other, k))
        for i, j in zip(*np.triu_indices(len(k)), strict=True):
            for x in _rounder(float(self.case.stiffness[i, j])):
                other = self.case.stiffness.copy()
                other[i, j] = other[j, i] = x
                if (np.linalg.eigvalsh(other / np.abs(other).max()) > 1e-12).all() and self.put(stiffness=other):
                    break

    def parameter(self, name: str, admitted: Callable[[Mapping[str, float]], bool]) -> None:
        now = self.case.parameters[name]
        simpler = takewhile(lambda x: now not in (1.0, x), (1.0, 0.5, *_rounder(now)))
        values = ({**self.case.parameters, name: x} for x in simpler)
        self.first({"parameters": each} for each in values if admitted(each))

    def numbers(self, name: str) -> None:
        """Round each number of a part by itself; equal ones are changed together, so that they stay equal."""
        given: Array = getattr(self.case, name)
        for x in np.unique(given[given != 0.0]).tolist():
            now: Array = getattr(self.case, name)
            self.first({name: np.where(now == x, other, now)} for other in (0.0, *_rounder(x)))


def _rounder(x: float) -> Iterator[float]:
    """Yield numbers near ``x`` of one digit and of two, and the next of two towards zero; none where ``x`` has no more itself."""
    if not isfinite(x) or float(f"{x:.1e}") == x:
        return
    yield float(f"{x:.0e}")
    yield float(f"{x:.1e}")
    power = floor(log10(abs(x))) - 1
    yield float(np.copysign(scaled(float(floor(abs(x) / 10.0**power)), power), x))
