"""The checks of a routine as what a campaign asks of each of its rows: a line a check, what fails in round numbers."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from dis import opmap
from functools import wraps
from inspect import Parameter, signature, unwrap
from pathlib import Path
from time import monotonic
from typing import Any, TypeAlias

from duhem.errors import DuhemError, InputError
from duhem.law.catalogue import attribute, load_formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.testing.conformance import check_expected, checks_asked, conformance
from duhem.testing.drawn.options import ACCURACY, TRIES, RunOptions, check_share
from duhem.testing.failures.report import FAILED, MET, PASSED, SKIPPED, UNMET, Report
from duhem.testing.routines.material import Material
from duhem.testing.routines.origin import named
from duhem.testing.routines.routine import Update

__all__ = ["RoutineChecks"]

_SOLVED = "solved"
_Line: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]


class _NoMemory(BaseException):
    """The routine got no memory, which says something of the limit and not of the routine; no Exception, which would be its answer.

    ``stated``: a statement of Python raised it, and no lack that was met before.
    """

    def __init__(self, fault: MemoryError) -> None:
        last = fault.__traceback__
        while last is not None and last.tb_next is not None:
            last = last.tb_next
        raises = last is not None and last.tb_frame.f_code.co_code[last.tb_lasti] == opmap["RAISE_VARARGS"]
        self.stated = raises and fault.__context__ is None


@dataclass(frozen=True)
class RoutineChecks:
    """The conformance of one routine to the law of each row, for ``duhem.campaign(..., ask=RoutineChecks(update))``.

    ``routine`` is what :func:`duhem.testing.conformance` takes, in a module that another process can import, or its name
    ``module:callable``, which goes to those processes in its place.  A value that the row fixes goes to it too, by name, where it has an
    argument of that name.  ``checks`` are names, all that are demanded if left out;
    ``examples`` cases are drawn by ``seed``, the same in every run.  ``accuracy``, ``shrink`` (tries to make a failing case smaller),
    ``expect`` (pairs of a check known to fail and the reason) and ``most_flagged`` are those of ``duhem test``.

    A line a check: ``passed`` or ``failed``; ``xfailed`` and ``xpassed`` of those expected to fail; ``not_applicable`` where nothing was
    there to judge.  One line more, ``solved``: no more than the share ``most_flagged`` is flagged by the routine as not solved, where it
    answered any.  The witness of a failure has its increment in round numbers, by how much the check is violated, and what the routine
    likely does instead; ``steps`` are the increments that the routine was asked for in the row, ``seconds`` the row's in equal shares.

    Raises InputError for options that cannot be used.
    """

    routine: Update | str
    checks: tuple[str, ...] | None = None
    examples: int = 30
    seed: int = 0
    accuracy: float = ACCURACY
    most_flagged: float = 0.0
    shrink: int = TRIES
    expect: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        self._found()
        for name, given, least in (("examples", self.examples, 1), ("seed", self.seed, 0), ("shrink", self.shrink, 0)):
            if not isinstance(given, int) or isinstance(given, bool) or given < least:
                raise InputError(f"{name} = {str(given)[:40]}", where=name, remedy=f"give a whole number >= {least}")
        RunOptions(accuracy=self.accuracy).check(None)
        check_share(self.most_flagged, "most_flagged")
        if self.checks is not None:
            checks_asked(_ANY, self.checks, where="checks")
        if not isinstance(self.expect, tuple) or not all(isinstance(pair, tuple) and len(pair) == 2 for pair in self.expect):
            remedy = 'give each check with its reason, for example slope = "no tangent yet"'
            raise InputError(f"{str(self.expect)[:40]} does not map checks to reasons", where="expect", remedy=remedy)
        check_expected(_ANY, dict(self.expect), where="expect")

    @property
    def names(self) -> tuple[str, ...]:
        return (*dict.fromkeys(check.name for check in checks_asked(_ANY, self.checks)), _SOLVED)

    @property
    def options(self) -> tuple[str, ...]:
        """What the command line names beside the campaign."""
        return (f"--routine={self._named()}",)

    @property
    def alone(self) -> bool:
        """A routine may keep what it was called with first, and a campaign asks each row of a process of its own."""
        return True

    def told(self) -> str:
        """All that is asked, and a digest of the file of the routine's module: another routine is another campaign."""
        options = [self.names, self.examples, self.seed, self.accuracy, self.most_flagged, self.shrink, self.expect]
        return f"checks {json.dumps(options)} of {self._named()} {_digest(self._found())}"

    def _named(self) -> str:
        return self.routine if isinstance(self.routine, str) else ":".join(named(self.routine).rsplit(".", 1))

    def _found(self) -> Update:
        found = attribute(self.routine, self.routine) if isinstance(self.routine, str) else self.routine
        if isinstance(found, Material) or not callable(found):
            what = f"{str(self.routine)[:60]} is a {type(found).__name__}, no routine for a law"
            raise InputError(what, where="routine", remedy=_ROUTINE)
        return found

    def answers(self, law: Law) -> Iterator[_Line]:
        """A line for each name; InputError where the law cannot be asked."""
        began = monotonic()
        try:
            with _own_constants_left_out():
                known, drawn = load_formula(law), {"max_examples": self.examples, "tries": self.shrink, "seed": self.seed}
                checks: dict[str, Any] = {"checks": self.checks, "expected_failed_checks": dict(self.expect), **drawn}
                report = conformance(known, _bound(self._found(), known), accuracy=self.accuracy, **checks)
                if report.ended:
                    raise DuhemError(report.ended)
        except _NoMemory as fault:
            if fault.stated:
                raise DuhemError("the routine raises MemoryError by a statement of its own") from None
            raise MemoryError from None
        each = round((monotonic() - began) / len(self.names), 6)
        for name in self.names:
            verdict, said = self._of(name, report)
            yield name, verdict, None, None, None if said is None else json.dumps(said), report.points, each

    def _of(self, name: str, report: Report) -> tuple[str, dict[str, Any] | None]:
        """The verdict on a check, and what there is to say of it."""
        if name == _SOLVED and report.points == 0:
            return "not_applicable", {"reason": "no increment was answered"}
        if name == _SOLVED:
            counted = {"increments": report.points, "flagged": report.flagged, "most": self.most_flagged}
            return "passed" if report.flagged_share <= self.most_flagged else "failed", counted
        how, why = report.outcomes().get(name, (SKIPPED, "there was nothing to judge"))
        failure, cause = report.failure_of(name), report.cause_of(name)
        if failure is None:
            return _VERDICTS[how], {"reason": why} if why else None
        said = {"increment": failure.increment, "violated": f"{failure.check.formula}: {failure.message}"}
        said |= {"likely": failure.diagnosis} if failure.diagnosis else {}
        return _VERDICTS[how], said | ({"explained_by": cause} if cause else {})


_VERDICTS = {PASSED: "passed", FAILED: "failed", SKIPPED: "not_applicable", MET: "xfailed", UNMET: "xpassed"}
_ANY = "coulomb"  # the checks of one law are those of any
_ROUTINE = "give a function update(trial, pressure, stiffness), or what from_material makes of a material"


def _bound(routine: Update, law: Criterion) -> Update:
    """The routine with those values of the row for which it has an argument; where it gets no memory that is no answer of it."""
    row = {name: float(domain.value) for name, domain in law.parameters.items() if domain.value is not None}
    try:
        arguments = signature(routine).parameters.values()
    except (TypeError, ValueError):  # of a compiled one nobody says which it has
        arguments = {}.values()
    if all(argument.kind is not Parameter.VAR_KEYWORD for argument in arguments):
        row = {name: row[name] for name in row.keys() & {argument.name for argument in arguments}}

    process = os.getpid()

    @wraps(routine)
    def update(*given: Any, **values: Any) -> Any:
        try:
            return routine(*given, **values, **row)
        except MemoryError as fault:
            raise _NoMemory(fault) from None
        finally:
            if os.getpid() != process:  # it has forked, and its child would go on with the checks
                os._exit(0)

    return update


@contextmanager
def _own_constants_left_out() -> Iterator[None]:
    """Hypothesis draws numbers too that stand in loaded modules beside the user's: in a checkout duhem's own are among them, as far as
    other rows have loaded them, and the same seed would draw other cases."""
    from hypothesis.internal.conjecture import providers

    known = getattr(providers, "is_local_module_file", None)
    if known is None:  # another version, which has another way
        yield
        return
    own = str(Path(__file__).parents[1])
    vars(providers)["is_local_module_file"] = lambda path: not path.startswith(own) and known(path)
    try:
        yield
    finally:
        vars(providers)["is_local_module_file"] = known


def _digest(routine: Any) -> str:
    module = sys.modules.get(getattr(unwrap(routine), "__module__", None) or "")
    try:
        with open(module.__file__ or "", "rb") as stream:  # type: ignore[union-attr]
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (AttributeError, OSError):
        return "unread"
