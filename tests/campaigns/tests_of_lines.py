"""Which tests run a line of the program, and how long each takes: recorded once, so that a changed line is asked of these alone."""

from __future__ import annotations

import ast
import json
import os
import resource
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import pytest

__all__ = ["TestsOfLines", "in_a_process", "recorded"]

EVERY = ""  # the context of what an import runs


class TestsOfLines(NamedTuple):
    """For a module and a line, who ran it (a test, a file's fixtures, an import); for a test, its seconds of processor time."""

    __test__ = False
    ran: Mapping[str, Mapping[int, Collection[str]]]
    seconds: Mapping[str, float]

    def of(self, module: Path, line: int) -> list[str]:
        """The tests that run the statement at a line, the quickest first; all of them where an import runs it."""
        who = self._who(module, line)
        chosen = (test for test in self.seconds if EVERY in who or test in who or test.split("::")[0] in who)
        return sorted(chosen, key=self.seconds.__getitem__)

    def run_on_import(self, module: Path, line: int) -> bool:
        """Whether an import runs the statement at a line."""
        return EVERY in self._who(module, line)

    def _who(self, module: Path, line: int) -> set[str]:
        lines = self.ran.get(str(module), {})
        return {context for at in _statement(module, line) for context in lines.get(at, ())}


def _statement(module: Path, line: int) -> range:
    """The lines of the innermost statement about a line; of one with a body, those of its head."""
    lines = range(line, line + 1)
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):  # the outer ones first
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if body else node.end_lineno
            if node.lineno <= line <= max(end or 0, node.lineno):
                lines = range(node.lineno, max(end or 0, node.lineno) + 1)
    return lines


def in_a_process(tests: Sequence[str], marks: str, seconds: int, *plugins: Callable[[], object]) -> int:
    """What pytest returns for these tests on the tree as it is, in a process of its own with so many seconds of processor time.

    The plugins are made there, before anything of the program is imported.
    """
    child = os.fork()
    if child == 0:
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        files = list(dict.fromkeys(test.split("::")[0] for test in tests))
        asked = [*(make() for make in plugins), *([_Only(tests)] if "::" in tests[0] else [])]
        os._exit(int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-m", marks, *files], plugins=asked)))
    return os.waitpid(child, 0)[1]


class _Only:
    """Runs these tests alone, in this order."""

    def __init__(self, tests: Sequence[str]) -> None:
        self._place = {test: i for i, test in enumerate(tests)}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = sorted((item for item in items if item.nodeid in self._place), key=lambda item: self._place[item.nodeid])


class _Recorder:
    """Tells coverage who is running, and writes down the times."""

    def __init__(self, data: Path, source: str) -> None:
        import coverage

        self._coverage = coverage.Coverage(data_file=str(data), source=[source], config_file=False)
        self._coverage.start()
        self._seconds: dict[str, float] = {}
        self._times = data.with_suffix(".json")

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        self._coverage.switch_context(item.nodeid.split("::")[0])

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        self._coverage.switch_context(item.nodeid)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        result = yield
        self._seconds[item.nodeid] = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
        self._coverage.switch_context(item.nodeid.split("::")[0])
        return result

    def pytest_sessionfinish(self) -> None:
        self._coverage.stop()
        self._coverage.save()
        self._times.write_text(json.dumps(self._seconds))


def recorded(tests: Sequence[str], marks: str, source: str, at: Path) -> TestsOfLines:
    """The tests of these files without a mutant, and the lines of ``source`` that each of them runs."""
    import coverage

    fails = in_a_process(tests, marks, resource.RLIM_INFINITY, lambda: _Recorder(at, source))
    seconds: dict[str, float] = json.loads(at.with_suffix(".json").read_text())
    if fails or in_a_process(sorted(seconds, key=seconds.__getitem__), marks, resource.RLIM_INFINITY):  # in this order too
        raise SystemExit(f"the tests fail without a mutant ({marks}): {' '.join(tests)}")
    data = coverage.CoverageData(str(at))
    data.read()
    here = Path.cwd()
    ran = {str(Path(f).relative_to(here.resolve())): data.contexts_by_lineno(f) for f in data.measured_files()}
    return TestsOfLines(ran, seconds)
