"""``duhem explain``: the theory of a claim."""

from __future__ import annotations

import click

from duhem.cli.arguments import complete_claims, read_claims
from duhem.cli.output import endless_page, say

__all__ = ["explain"]


@click.command()
@click.argument("claim", required=False, shell_complete=complete_claims)
def explain(claim: str | None) -> None:
    """Explain what a CLAIM says and how it is proved.

    Without CLAIM, duhem lists the claims.
    """
    from duhem.proof.claims import CLAIMS, COUPLED, EVERY

    page = endless_page()
    if claim is None:
        say("\n".join(page.listed({name: entry.statement for name, entry in CLAIMS.items()})))
        return
    (name,) = (claim,) if claim in COUPLED else read_claims(claim)
    say("\n".join(page.hanging(f"{name}: {EVERY[name].statement}")))
    for paragraph in EVERY[name].theory.strip().split("\n\n"):
        theory = paragraph if page.width is None else " ".join(paragraph.split())
        say("\n".join(["", *page.hanging(theory, rest="")]))
