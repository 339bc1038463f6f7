"""Mutants asked of tests that are collected once: each is put into the functions of a fork, which is left after it.

A new process would import the program and collect the tests again for each mutant.
"""

from __future__ import annotations

import gc
import importlib
import os
import resource
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import pytest
from _pytest.main import pytest_runtestloop

__all__ = ["InForks", "Question"]

Bodies = list[tuple[FunctionType, CodeType]]
Question = Callable[[Path, str, Sequence[str], int], bool | None]  # a module, its other text, tests, seconds: whether one fails


class InForks:
    """Collects the tests, and hands ``work`` a question: None is its answer where more than the body of functions differs."""

    def __init__(self, work: Callable[[Question], None]) -> None:
        self._work = work

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """In place of the run: tests run in forks alone."""
        items = {item.nodeid: item for item in session.items}
        gc.freeze()

        def fails(module: Path, text: str, tests: Sequence[str], seconds: int) -> bool | None:
            try:
                bodies = _other_bodies(module, text)
            except SyntaxError:  # pytest is told to take the compiler's warnings for errors
                return True
            if bodies is None:
                return None
            child = os.fork()
            if child == 0:
                resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
                for function, code in bodies:
                    function.__code__ = code
                session.items[:] = [items[test] for test in tests]
                try:
                    pytest_runtestloop(session)
                finally:  # it is left by an exception where a test fails
                    os._exit(session.testsfailed > 0)
            return os.waitpid(child, 0)[1] != 0

        self._work(fails)
        return True


def _other_bodies(module: Path, text: str) -> Bodies | None:
    """The functions of a module that have another body in a text; None where something else differs."""
    code, other = (compile(t, str(module), "exec") for t in (module.read_text(encoding="utf-8"), text))
    if _outside(code) != _outside(other):
        return None
    there = dict(_functions(importlib.import_module(".".join(module.with_suffix("").parts[1:]))))
    pairs = [(c.co_qualname, d) for c, d in zip(_bodies(code), _bodies(other), strict=True) if c != d]
    known = all(name in there and there[name].__code__.co_freevars == body.co_freevars for name, body in pairs)
    return [(there[name], body) for name, body in pairs] if known and pairs else None


def _parts(code: CodeType) -> list[CodeType]:
    return [part for part in code.co_consts if isinstance(part, CodeType)]


def _is_body(code: CodeType) -> bool:
    return bool(code.co_flags & 1)  # of a function, not of a class or a module


def _outside(code: CodeType) -> list[Any]:
    """What a module and its classes do themselves."""
    constants = [part.co_qualname if isinstance(part, CodeType) else part for part in code.co_consts]
    return [code.co_code, code.co_names, repr(constants), *(_outside(part) for part in _parts(code) if not _is_body(part))]


def _bodies(code: CodeType) -> Iterator[CodeType]:
    """The functions of a module and of its classes."""
    for part in _parts(code):
        if _is_body(part):
            yield part
        else:
            yield from _bodies(part)


def _functions(owner: Any, name: str = "") -> Iterator[tuple[str, FunctionType]]:
    """Those of a module and of its classes, below what keeps or wraps them, by their names."""
    name = name or owner.__name__
    for own in vars(owner).values():
        if isinstance(own, type) and own.__module__ == name:
            for kind in own.__mro__:
                yield from _functions(kind, name) if kind is not owner and kind.__module__ == name else ()
        while own is not None and not isinstance(own, FunctionType):
            own = next((inner for key in ("__wrapped__", "__func__", "fget", "func") if (inner := getattr(own, key, None))), None)
        if own is not None and own.__module__ == name:
            yield own.__code__.co_qualname, own
