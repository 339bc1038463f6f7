"""``duhem list``: the laws that can be named."""

from __future__ import annotations

import click

from duhem.cli.output import endless_page, say

__all__ = ["list_laws"]


@click.command("list")
def list_laws() -> None:
    """List the laws that can be named."""
    from duhem.law import catalogue

    names = catalogue.names()
    width = max(map(len, names))
    for name in names:
        say("\n".join(endless_page().hanging(catalogue.summary(name), f"{name:<{width}}  ", " " * (width + 2))) or name)
