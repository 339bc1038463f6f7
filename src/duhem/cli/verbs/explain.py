"""``duhem explain``: the theory of a claim, and what is said of an open one."""

from __future__ import annotations

import click

from duhem.cli.arguments import complete_claims, read_claims
from duhem.cli.output import endless_page, say

__all__ = ["explain"]


@click.command()
@click.argument("claim", required=False, shell_complete=complete_claims)
def explain(claim: str | None) -> None:
    """Explain what a CLAIM says and how it is proved, or, with open, what duhem verify says of a claim that it left open.

    Without CLAIM, duhem lists the claims.
    """
    from duhem.proof.claims import CLAIMS, COUPLED, EVERY
    from duhem.proof.unsettled.open_claims import STATEMENT, THEORY

    page = endless_page()
    if claim is None:
        say("\n".join(page.listed({name: entry.statement for name, entry in CLAIMS.items()} | {"open": STATEMENT})))
        return
    if claim == "open":
        name, statement, told = claim, STATEMENT, THEORY
    else:
        (name,) = (claim,) if claim in COUPLED else read_claims(claim)
        statement, told = EVERY[name].statement, EVERY[name].theory
    say("\n".join(page.hanging(f"{name}: {statement}")))
    for paragraph in told.strip().split("\n\n"):
        theory = paragraph if page.width is None else " ".join(paragraph.split())
        say("\n".join(["", *page.hanging(theory, rest="")]))
