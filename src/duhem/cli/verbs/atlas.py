"""``duhem atlas``: the published laws, what is said of them and what holds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import format_option, group_option
from duhem.cli.output import Progress, as_json, endless_page, say

if TYPE_CHECKING:
    from duhem.law.atlas.entry import AtlasEntry

__all__ = ["atlas", "word"]

_OPEN = ("tested", "undecided")


@click.command()
@group_option
@format_option("text", "markdown", "json")
@click.option(
    "--plot", "file", metavar="FILE", help="Draw a section of each law, all on one sheet (.png, .svg, .pdf, ...), and print no list."
)
def atlas(group: str | None, form: str, file: str | None) -> None:
    """List published laws, their claims in the literature, and verdicts.

    A verdict covers the whole domain that the file of the law declares. "open" means that no method decided the claim. You can use
    each name as LAW in every command.
    """
    from duhem.law.atlas.entry import entries

    laws = entries(group)
    if file is not None:
        from duhem.show.figure import check

        check(file)
        from duhem.portrait.pictures import atlas_sheet

        with Progress("drawing") as progress:
            atlas_sheet(laws, file, progress.show)
        say(file)
    elif form == "json":
        say(as_json([law.to_dict() for law in laws]))
    else:
        say(_markdown(laws) if form == "markdown" else _text(laws))


def word(verdict: str) -> str:
    """A verdict in a cell of the table."""
    return "open" if verdict in _OPEN else verdict.replace("not_applicable", "-")


def _said(law: AtlasEntry) -> str:
    """The claims of the literature, for which parameters they hold, and where they do not."""
    claims = "; ".join(f"{claim}: {text}" for claim, text in law.claims.items())
    return ". ".join(filter(None, (claims, *law.found, law.note)))


def _markdown(laws: Sequence[AtlasEntry]) -> str:
    """One table, a row a law."""
    head = ["law", "source", *laws[0].verdicts, "what is said of it"]
    rows = [[f"`{law.name}`", law.source, *map(word, law.verdicts.values()), _said(law)] for law in laws]
    lines = [[cell.replace("|", "\\|") for cell in row] for row in [head, ["---"] * len(head), *rows]]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _text(laws: Sequence[AtlasEntry]) -> str:
    """A table of verdicts a group, under it what is said of each law."""
    page = endless_page()
    parts: list[Sequence[str]] = []
    for group in dict.fromkeys(law.group for law in laws):
        of_group = [law for law in laws if law.group == group]
        rows = [["law", *of_group[0].verdicts], *([law.name, *map(word, law.verdicts.values())] for law in of_group)]
        parts += [[group, *page.table(rows, "l")]]
        for law in of_group:
            about = (law.source, law.equation, _said(law))
            parts += [[law.name, *(line for text in about if text for line in page.item(text))]]
    return page.report(parts)
