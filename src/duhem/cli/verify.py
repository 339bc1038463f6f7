"""``duhem verify`` and ``duhem explain``: the claims, decided or explained."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import law_argument, read_fixed_law, settings_option
from duhem.cli.exit_code import HELD, INTERRUPTED, REFUTED, UNDECIDED
from duhem.cli.output import Progress, say
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.proof.verdict import Verdict
    from duhem.proof.verification import ClaimResult

__all__ = ["explain", "verify"]


@click.command()
@law_argument
@settings_option
@click.option("--claims", metavar="A,B", help="Only these claims (duhem explain lists them).")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="For people or for programs."
)
@click.option("--strict", is_flag=True, help="Exit with 3 if a claim is neither proved nor refuted.")
def verify(law: str, settings: Sequence[str], claims: str | None, form: str, strict: bool) -> int:
    """Prove or refute what is claimed of LAW.

    Each claim is decided over the whole parameter domain and for every pressure, unless --set fixes a parameter.  Results
    go to standard output, progress to standard error.
    """
    asked = None if claims is None else _named(claims)
    fixed = read_fixed_law(law, settings)

    from duhem.proof import report_json as json
    from duhem.proof import report_text as text
    from duhem.proof import verification

    report = {"text": text, "json": json}[form]
    decided: list[ClaimResult] = []
    try:
        with Progress() as progress:

            def on_claim(result: ClaimResult) -> None:
                decided.append(result)
                progress.show(f"{len(decided)}: {result.claim} {result.verdict}")

            done = verification.verify(fixed, claims=asked, on_claim=on_claim)
    except KeyboardInterrupt:
        say(report.interrupted(fixed, decided))
        return INTERRUPTED
    say(report.complete(done))
    return _code([r.verdict for r in done.results], strict)


@click.command()
@click.argument("claim", required=False)
def explain(claim: str | None) -> None:
    """Explain the theory of CLAIM, or list the claims."""
    from duhem.proof.claims import CLAIMS

    if claim is None:
        width = max(map(len, CLAIMS))
        for name, entry in CLAIMS.items():
            say(f"{name:<{width}}  {entry.statement}")
        return
    (name,) = _named(claim)
    say(f"{name}: {CLAIMS[name].statement}\n\n{CLAIMS[name].theory.strip()}")


def _named(text: str) -> tuple[str, ...]:
    from duhem.proof.claims import CLAIMS

    asked = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    for name in asked:
        if name not in CLAIMS:
            near = get_close_matches(name, CLAIMS, n=1)
            raise InputError(f"unknown claim {name!r}", remedy=f"did you mean {near[0]!r}?" if near else f"claims are: {', '.join(CLAIMS)}")
    if not asked:
        raise InputError("no claim is named", where="--claims", remedy=f"claims are: {', '.join(CLAIMS)}")
    return asked


def _code(verdicts: Sequence[Verdict], strict: bool) -> int:
    if "refuted" in verdicts:
        return REFUTED
    return UNDECIDED if strict and {"undecided", "tested"} & set(verdicts) else HELD
