"""Verdicts that are expected: the option ``--expect``, what a law expects of itself, and the exit code of what came."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import click

from duhem.cli.arguments import check_names, complete_expected, read_pair
from duhem.cli.exit_code import HELD, REFUTED, UNDECIDED
from duhem.errors import InputError

__all__ = ["check_expected", "code_of", "expect_option", "read_expected"]

expect_option = click.option(
    "--expect",
    metavar="CLAIM=VERDICT",
    multiple=True,
    shell_complete=complete_expected,
    help="A verdict that is no failure, such as smoothness=refuted for corners; any other on this claim is one. Goes before what the"
    " law's own file expects. Repeatable.",
)


def read_expected(given: Sequence[str], asked: Iterable[str]) -> dict[str, str]:
    """The verdicts by claim, each of a claim that is ``asked``."""
    from duhem.proof.verdict import Verdict

    expected: dict[str, str] = {}
    for one in given:
        where = f"--expect {one}"
        claim, verdict = read_pair(one, where, "CLAIM=VERDICT", "--expect smoothness=refuted")
        check_names("claim", [claim], asked, "claims asked for are", where)
        check_names("verdict", [verdict], map(str, Verdict), "verdicts are", where)
        if expected.setdefault(claim, verdict) != verdict:
            raise InputError(f"{claim} is expected to be {expected[claim]} too", where=where, remedy="expect one verdict of each claim")
    return expected


def check_expected(law: str, expected: Mapping[str, str]) -> None:
    """InputError for what a law expects of a claim, or for a verdict, that is none."""
    from duhem.proof.kernel.certificate import CLAIMS, VERDICTS

    check_names("claim", expected, CLAIMS, "claims are", where=f"expect of {law}")
    check_names("verdict", expected.values(), VERDICTS, "verdicts are", where=f"expect of {law}")


def code_of(found: Iterable[tuple[str, Mapping[str, str | None], Mapping[str, str]]], *, strict: bool) -> int:
    """The exit code of laws with their verdicts and the expected ones, by claim; one that is not as expected is told on standard error."""
    codes = {HELD}
    for law, verdicts, expected in found:
        for claim, verdict in verdicts.items():
            if (due := expected.get(claim)) is None:
                codes.add(REFUTED if verdict == "refuted" else UNDECIDED if strict and verdict in ("undecided", "tested") else HELD)
            elif verdict not in (due, None):
                click.echo(f"duhem: {law}: {claim} is {verdict}, where {due} is expected", err=True)
                codes.add(REFUTED)
    return REFUTED if REFUTED in codes else max(codes)
