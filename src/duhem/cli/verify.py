"""``duhem verify``: the claims, decided."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import complete_claims, laws_argument, read_claims, read_fixed_law, report_format_option, settings_option
from duhem.cli.exit_code import INTERRUPTED
from duhem.cli.expected import check_expected, code_of, expect_option, read_expected
from duhem.cli.many_laws import found_files, verify_each
from duhem.cli.output import Progress, page, say, wrote
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.law.curve_law import Law
    from duhem.proof.verification import ClaimResult, Verification

__all__ = ["verify"]


@click.command()
@laws_argument
@settings_option
@click.option("--claims", metavar="A,B", shell_complete=complete_claims, help="Only these claims (duhem explain lists them).")
@report_format_option
@click.option("--report", metavar="FILE", help="Also write a page for people, HTML in one file: pictures, derivation, how to reproduce it.")
@click.option("--certificate", metavar="FILE", help="Also write the proofs for duhem recheck, as JSON.")
@click.option(
    "--effort",
    type=click.Choice(["quick", "normal", "thorough"]),
    default="normal",
    show_default=True,
    help="How many steps each claim may cost: an eighth, all, eight times as many.",
)
@click.option("--strict", is_flag=True, help="Exit with 3 if a claim is neither proved nor refuted.")
@expect_option
@click.option("--workers", metavar="N", type=click.IntRange(min=1), help="Processes that verify several laws; left out, one a core.")
def verify(
    laws: Sequence[str],
    settings: Sequence[str],
    claims: str | None,
    form: str,
    report: str | None,
    certificate: str | None,
    effort: str,
    strict: bool,
    expect: Sequence[str],
    workers: int | None,
) -> int:
    """Prove or refute what is claimed of LAW, or of several laws, also by a pattern such as 'laws/*.toml'.

    Each claim is decided over the whole parameter domain and for every pressure, unless --set fixes a parameter.  Results
    go to standard output, progress to standard error.  Of several laws each has one line, which says what is wrong where a law
    cannot be read, crashes, or takes more than 600 s of the processor or 4 GB; the exit code is then 4.  With --report, --format json or
    junit they are verified in full, one after the other.
    """
    from duhem.proof.claims import CLAIMS
    from duhem.show.place import check_places, write

    laws = found_files(laws)
    asked = None if claims is None else read_claims(claims)
    expected = read_expected(expect, asked or CLAIMS)
    if len(laws) > 1 and form == "text" and report is None and certificate is None:
        return verify_each(laws, settings, asked, effort, strict, expected, workers)
    if workers is not None:
        remedy = "name several laws, and leave --format, --report and --certificate out"
        raise InputError("these are the processes that say of several laws a line each", where=f"--workers {workers}", remedy=remedy)
    fixed = [_fixed(law, settings, several=len(laws) > 1) for law in laws]
    for law in fixed:
        check_expected(law.name, law.expect)
    check_places([report, certificate], laws)
    if certificate is not None and len(laws) > 1:
        raise InputError("a certificate is of one law", where=f"--certificate {certificate}", remedy="verify the laws one by one")
    from duhem.cli.report import again, article, law_lines, without

    texts = [law_lines(law) for law in laws] if report is not None else []

    from duhem.proof import verification

    told = _Told(form, effort, strict, expected, several=len(laws) > 1)
    for law in fixed:
        decided: list[ClaimResult] = []
        try:
            with Progress() as progress:

                def on_claim(result: ClaimResult, decided: list[ClaimResult] = decided, progress: Progress = progress) -> None:
                    decided.append(result)
                    progress.show(f"{len(decided)}: {result.claim} {result.verdict}")

                told.complete(verification.verify(law, claims=asked, effort=effort, on_claim=on_claim, on_method=progress.tries))
        except KeyboardInterrupt:
            told.interrupted(law, decided)
            return INTERRUPTED
    told.end()
    if certificate is not None:
        told.done[0].certificate(certificate)
        wrote("the certificate", certificate)
    if report is not None:
        from duhem.show.document import as_page

        commands = (again(law, settings, claims, effort) for law in laws)
        write(report, as_page([article(*each) for each in zip(told.done, commands, texts, strict=True)]))
        wrote("the page", report)
        if lacking := without():
            click.echo(f"duhem: {report} is {lacking}", err=True)
    return told.code()


def _fixed(law: str, settings: Sequence[str], *, several: bool) -> Law:
    """The law at the values of ``--set``; an error says of which of several laws it is."""
    try:
        return read_fixed_law(law, settings)
    except InputError as fault:
        if not several or not fault.where.startswith("--set"):
            raise
        raise InputError(fault.what, where=f"{law}, {fault.where}", remedy=fault.remedy) from None


@dataclass
class _Told:
    """What is said of one law after the other; a text as soon as it is there, what programs read at the end."""

    form: str
    effort: str
    strict: bool
    expected: Mapping[str, str]
    several: bool
    done: list[Verification] = field(default_factory=list)

    def complete(self, found: Verification) -> None:
        """Add what was found of a law."""
        if self.form == "text":
            from duhem.show.printing import text

            report = text(found, page())
            say(f"\n{report}" if self.done else report)
        self.done.append(found)

    def interrupted(self, law: Law, decided: Sequence[ClaimResult]) -> None:
        """Say what was found before somebody interrupted."""
        from duhem.proof.verification import Verification

        self.complete(Verification(law, tuple(decided), (), (), effort=self.effort, interrupted=True))
        self.end()

    def end(self) -> None:
        """Say what is still to say: one object, or a list of them where several laws are asked for."""
        if self.form == "json":
            objects = [json.dumps(found.to_dict(), indent=2, ensure_ascii=False) for found in self.done]
            say("[\n" + ",\n".join(objects) + "\n]" if self.several else objects[0])
        elif self.form == "junit":
            from duhem.proof.report import as_suite
            from duhem.show.junit import as_xml

            say(as_xml(as_suite(found, strict=self.strict, expected=self.due(found)) for found in self.done))

    def code(self) -> int:
        """The exit code of all laws together."""
        found = ((done.criterion.name, {r.claim: r.verdict.value for r in done.results}, self.due(done)) for done in self.done)
        return code_of(found, strict=self.strict)

    def due(self, found: Verification) -> Mapping[str, str]:
        """The verdicts that are expected of a law: by its own file, and before that by ``--expect``."""
        return {**found.criterion.expect, **self.expected}
