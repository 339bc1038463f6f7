"""``duhem doctor``: what is installed and on what machine it runs, from package metadata alone: nothing of it is imported."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterator

import click

from duhem.cli.output import FAILED, HELD, say
from duhem.projection.in_blocks import cores
from duhem.show.page import PAGE
from duhem.version import __version__, distribution

__all__ = ["CORE", "EXTRAS", "PURPOSES", "doctor", "installed", "missing", "versions"]

# As in pyproject.toml, by the names of the distributions; a test compares the two.
CORE = ("click", "clarabel", "cvxpy-base", "hypothesis", "mpmath", "numpy", "python-flint", "scipy", "sympy", "z3-solver")
EXTRAS = {
    "parquet": ("pyarrow",),
    "cluster": ("dask", "distributed"),
    "plot": ("matplotlib",),
    "notebooks": ("ipykernel", "nbclient", "nbformat", "matplotlib"),
    "report": ("latex2mathml", "matplotlib"),
    "fast": ("numba",),
    "learned": ("onnx",),
    "second": ("cvc5",),
    "docs": ("furo", "latex2mathml", "myst-nb", "sphinx"),
    "test": ("import-linter", "jsonschema", "mypy", "pytest", "pytest-xdist", "pyyaml", "ruff"),
    "mutation": ("cosmic-ray", "coverage"),
}
PURPOSES = {
    "parquet": "histories as Parquet files: simulate --out history.parquet",
    "cluster": "campaigns on many machines with Dask: duhem campaign --scheduler ADDRESS",
    "plot": "pictures: duhem plot, duhem figures, and --plot of other commands",
    "notebooks": "the notebooks of the course (install jupyterlab to open them)",
    "report": "pages with pictures and typeset formulas: verify --report FILE",
    "fast": "compiled increments and paths, with numba",
    "learned": "networks in ONNX files: duhem import net.onnx",
    "second": "cvc5, a second SMT solver, which this version does not use",
    "docs": "these pages as HTML: python -m sphinx docs docs/_build",
    "test": "the tests: python -m pytest",
    "mutation": "a search for changes of the code that no test detects: python -m tests.campaigns.mutation",
}
_FIELD = 15


@click.command()
def doctor() -> int:
    """List the installed and the missing parts.

    The last lines describe the machine. Include them in a bug report.
    """
    say(installed())
    return FAILED if missing() else HELD


def installed() -> str:
    """Core and optional packages with their versions, the remedy for each gap, and facts for a bug report."""
    lines = [f"duhem {__version__}", "", "core", *_rows(CORE, "duhem")]
    for extra, packages in EXTRAS.items():
        lines += ["", *PAGE.hanging(f"extra {extra}: {PURPOSES[extra]}"), *_rows(packages, f"duhem[{extra}]")]
    lines += ["", *PAGE.hanging('To install all extras: pip install "duhem[all]"; from a clone, pip install ".[all]"')]
    return "\n".join([*lines, "", "machine", *_machine()])


def missing() -> tuple[str, ...]:
    """The core packages that are not installed."""
    return tuple(name for name in CORE if distribution(name) is None)


def versions(packages: tuple[str, ...]) -> dict[str, str]:
    """Those of the packages that are installed, with their versions."""
    return {name: found for name in packages if (found := distribution(name)) is not None}


def _rows(packages: tuple[str, ...], requirement: str) -> Iterator[str]:
    for name in packages:
        yield from PAGE.field(name, distribution(name) or "not installed", _FIELD)
    if any(distribution(name) is None for name in packages):
        yield f'  install with: pip install "{requirement}"'


def _machine() -> Iterator[str]:
    facts = {
        "python": f"{platform.python_version()} ({platform.python_implementation()}, {platform.architecture()[0]})",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "processors": f"{cores()} usable",
        "encoding": f"{sys.stdout.encoding or 'unknown'}, file system {sys.getfilesystemencoding()}",
    }
    for name, fact in facts.items():
        yield from PAGE.field(name, fact, _FIELD)
