"""``duhem derive``."""

from __future__ import annotations

import click

from duhem.cli.arguments import law_argument, read_law
from duhem.cli.output import endless_page, say

__all__ = ["derive"]


@click.command()
@law_argument
@click.option(
    "--format", "form", type=click.Choice(["text", "latex", "markdown"]), default="text", show_default=True, help="How to print it."
)
def derive(law: str, form: str) -> None:
    """Print the symbolic derivation of LAW."""
    chosen = read_law(law)
    from duhem import derivation
    from duhem.show.printing import text

    derived = derivation.derive(chosen)
    say(text(derived, endless_page()) if form == "text" else {"latex": derived.latex, "markdown": derived.markdown}[form]())
