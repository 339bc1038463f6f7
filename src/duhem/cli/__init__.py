"""The command line.  A verb is a file in :mod:`duhem.cli.verbs`, found there and imported when it is named or when all are listed.

Nothing heavy is imported before a command needs it, so help and completion are immediate.
"""

from __future__ import annotations

from collections import UserDict
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import click

from duhem.cli import verbs
from duhem.version import __version__

__all__ = ["cli"]


class _Verbs(UserDict[str, Any]):
    """The command of each verb by its name; kept as the name of its module, which is imported when the command is asked for."""

    def __getitem__(self, verb: str) -> click.Command:
        module = self.data[verb]
        return getattr(import_module(module), module.rpartition(".")[2])


@click.group(
    commands=_Verbs((found.name.removesuffix("_"), f"{verbs.__name__}.{found.name}") for found in iter_modules(verbs.__path__)),
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(__version__, prog_name="duhem", message="%(prog)s %(version)s")
def cli() -> None:
    """Decide whether friction and yield laws are thermodynamically admissible.

    A law is admissible if slip never produces energy. For each claim about a law, duhem gives a proof or a counterexample. It also
    computes slip increments and loading paths, and tests update routines (functions that compute the stress at the end of an
    increment).

    K is the set of admissible stresses. LAW is a name (duhem list, duhem atlas), a criterion file (duhem init NAME writes one), or
    module:attribute.

    Exit codes: 0 nothing refuted, 1 something refuted, 2 usage or file error, 3 undecided with --strict, 4 internal or solver failure,
    130 interrupted.
    """
