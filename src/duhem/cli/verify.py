"""``duhem verify``: the claims, decided."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import law_argument, read_claims, read_fixed_law, settings_option
from duhem.cli.exit_code import HELD, INTERRUPTED, REFUTED, UNDECIDED
from duhem.cli.output import Progress, page, say

if TYPE_CHECKING:
    from duhem.proof.verdict import Verdict
    from duhem.proof.verification import ClaimResult

__all__ = ["verify"]


@click.command()
@law_argument
@settings_option
@click.option("--claims", metavar="A,B", help="Only these claims (duhem explain lists them).")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="For people or for programs."
)
@click.option("--certificate", metavar="FILE", help="Also write the proofs for duhem recheck, as JSON.")
@click.option(
    "--effort",
    type=click.Choice(["quick", "normal", "thorough"]),
    default="normal",
    show_default=True,
    help="How many steps each claim may cost: an eighth, all, eight times as many.",
)
@click.option("--strict", is_flag=True, help="Exit with 3 if a claim is neither proved nor refuted.")
def verify(law: str, settings: Sequence[str], claims: str | None, form: str, certificate: str | None, effort: str, strict: bool) -> int:
    """Prove or refute what is claimed of LAW.

    Each claim is decided over the whole parameter domain and for every pressure, unless --set fixes a parameter.  Results
    go to standard output, progress to standard error.
    """
    from duhem.show.place import check_place, write

    asked = None if claims is None else read_claims(claims)
    fixed = read_fixed_law(law, settings)
    if certificate is not None:
        check_place(certificate, [law])

    from duhem.proof import report_json, report_text, verification

    decided: list[ClaimResult] = []
    try:
        with Progress() as progress:

            def on_claim(result: ClaimResult) -> None:
                decided.append(result)
                progress.show(f"{len(decided)}: {result.claim} {result.verdict}")

            done = verification.verify(fixed, claims=asked, effort=effort, on_claim=on_claim)
    except KeyboardInterrupt:
        stopped = (
            report_json.interrupted(fixed, decided, effort) if form == "json" else report_text.interrupted(fixed, decided, page(), effort)
        )
        say(stopped)
        return INTERRUPTED
    say(report_json.complete(done) if form == "json" else report_text.complete(done, page()))
    if certificate is not None:
        from duhem.proof.certificate import certificate as certified

        write(certificate, json.dumps(certified(done), indent=1, ensure_ascii=False) + "\n")
    return _code([r.verdict for r in done.results], strict)


def _code(verdicts: Sequence[Verdict], strict: bool) -> int:
    if "refuted" in verdicts:
        return REFUTED
    return UNDECIDED if strict and {"undecided", "tested"} & set(verdicts) else HELD
