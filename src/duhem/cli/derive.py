"""``duhem derive``."""

from __future__ import annotations

import click

from duhem.cli.arguments import law_argument, read_law
from duhem.cli.output import say

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

    derived = derivation.derive(chosen)
    say({"text": derived.text, "latex": derived.latex, "markdown": derived.markdown}[form]())
