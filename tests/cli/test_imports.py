"""What a run does not need is not imported: each command is run in a fresh process that reports its modules at the end."""

import importlib
import inspect
import json
import pkgutil
import subprocess
import sys
from functools import cache

import pytest

import duhem

REPORT = """
import atexit, json, sys
heavy = ("numpy", "sympy", "matplotlib", "cvxpy", "hypothesis", "clarabel", "z3", "flint", "cvc5", "scipy", "pytest", "dask", "distributed")
atexit.register(lambda: print("\\n" + json.dumps([m for m in heavy if m in sys.modules]), file=sys.stderr))
from duhem.__main__ import main
sys.argv = ["duhem", *sys.argv[1:]]
sys.exit(main())
"""


@cache
def imported(*arguments: str) -> frozenset[str]:
    """Which of the heavy packages `duhem ARGUMENTS` had imported when it ended."""
    done = subprocess.run([sys.executable, "-c", REPORT, *arguments], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return frozenset(json.loads(done.stderr.splitlines()[-1]))


@pytest.mark.slow
def test_the_report_sees_an_import() -> None:
    assert "sympy" in imported("verify", "antoni2007")


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["verify", "--help"]], ids=" ".join)
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    assert imported(*arguments) == set()


@pytest.mark.slow
def test_verify_leaves_out_what_it_does_not_need() -> None:
    unneeded = {"matplotlib", "numpy", "cvxpy", "clarabel", "hypothesis", "scipy", "pytest", "dask", "distributed"}
    assert imported("verify", "antoni2007") & unneeded == set()


def test_no_public_name_is_hidden_by_a_module_of_the_same_name() -> None:
    for module in pkgutil.iter_modules(duhem.__path__, "duhem."):  # __main__ included, it must do nothing
        importlib.import_module(module.name)
    values = {name: getattr(duhem, name) for name in duhem.__all__}
    assert [name for name, value in values.items() if inspect.ismodule(value)] == []
