"""``duhem derive``."""

from __future__ import annotations

import click

from duhem.cli.arguments import format_option, law_argument, read_law
from duhem.cli.output import endless_page, say

__all__ = ["derive"]


@click.command()
@law_argument
@format_option("text", "latex", "markdown")
def derive(law: str, form: str) -> None:
    """Print the symbolic derivation of LAW.

    The derivation starts with the free energy. It gives the state laws, the slip and, if a closed form is found, the dissipation
    potential.
    """
    chosen = read_law(law)
    from duhem import derivation
    from duhem.show.printing import text

    derived = derivation.derive(chosen)
    say(text(derived, endless_page()) if form == "text" else {"latex": derived.latex, "markdown": derived.markdown}[form]())
