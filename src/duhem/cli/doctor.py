"""``duhem doctor``: what is installed."""

from __future__ import annotations

import click

from duhem.cli.exit_code import FAILED, HELD
from duhem.cli.output import say

__all__ = ["doctor"]


@click.command()
def doctor() -> int:
    """List installed and missing parts.

    Ends with facts about the machine that help with a bug report.
    """
    from duhem.cli import installation

    say(installation.report())
    return FAILED if installation.missing() else HELD
