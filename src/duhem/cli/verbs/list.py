"""``duhem list``: the laws that can be named."""

from __future__ import annotations

import click

from duhem.cli.arguments import group_option
from duhem.cli.output import endless_page, say

__all__ = ["list"]


@click.command()
@group_option
def list(group: str | None) -> None:
    """List the built-in laws and the groups of the atlas.

    The atlas is the collection of published laws; --group lists the laws of one group.
    """
    from duhem.law import catalogue
    from duhem.law.atlas import entry

    if group is None:
        laws = {name: catalogue.summary(name) for name in catalogue.names()}
        atlas = {name: f"{len(laws)} published laws: duhem list --group {name}" for name, laws in entry.groups().items()}
    else:
        laws, atlas = {each.name: each.summary for each in entry.entries(group)}, {}
    say("\n".join(endless_page().listed(laws | atlas)))
