"""``duhem verify``: the claims, decided; of several laws a line each, as rows of a campaign without a table."""

from __future__ import annotations

import glob
import os
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import (
    check_names,
    choice_option,
    complete_claims,
    complete_expected,
    laws_argument,
    read_claims,
    read_fixed_law,
    read_law,
    read_pair,
    read_settings,
    report_format_option,
    settings_option,
)
from duhem.cli.output import FAILED, HELD, INTERRUPTED, REFUTED, UNDECIDED, Progress, as_json, aside, deliver, page, say, wrote
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.law.curve_law import Law
    from duhem.proof.verification import ClaimResult, Verification
    from duhem.screening.campaign import LawName, VerdictLine

__all__ = ["verify"]

_expect_option = click.option(
    "--expect",
    metavar="CLAIM=VERDICT",
    multiple=True,
    shell_complete=complete_expected,
    help="The verdict that you expect of a claim, such as smoothness=refuted for a law with corners: it counts as no failure, and any"
    " other verdict on this claim as one. Takes precedence over expect in the law. Repeatable.",
)

_ORDER = ("refuted", "undecided", "tested", "proved", "by_construction", "not_applicable")  # what deserves a look comes first


@click.command()
@laws_argument
@settings_option
@click.option("--claims", metavar="A,B", shell_complete=complete_claims, help="Decide only these claims (duhem explain lists them).")
@report_format_option
@click.option("--report", metavar="FILE", help="Also write an HTML page for people, with pictures and the derivation.")
@click.option("--certificate", metavar="FILE", help="Also write the proofs to this JSON file, for duhem recheck.")
@choice_option(
    "--effort",
    of=["quick", "normal", "thorough"],
    default="normal",
    says="Budget of steps for each claim: quick is an eighth of normal, thorough is eight times normal.",
)
@click.option(
    "--coupled",
    is_flag=True,
    help="Also decide whether the complete contact law (this friction with the pressure and the opening) has a bipotential.",
)
@click.option("--strict", is_flag=True, help="End with exit code 3 if a claim is neither proved nor refuted.")
@_expect_option
@click.option(
    "--workers", metavar="N", type=click.IntRange(min=1), help="Number of processes if you give several laws (default: one per core)."
)
def verify(
    laws: Sequence[str],
    settings: Sequence[str],
    claims: str | None,
    form: str,
    report: str | None,
    certificate: str | None,
    effort: str,
    coupled: bool,
    strict: bool,
    expect: Sequence[str],
    workers: int | None,
) -> int:
    """Prove or refute the claims about one LAW or several.

    LAW may also be a pattern such as 'laws/*.toml'.

    A proof covers the whole domain of the parameters and every pressure. --set fixes a parameter. The trust of a proof is: checked (the
    kernel, a small independent program, confirmed it) or prover (the kernel has no rule for this argument). Results go to standard
    output, progress messages to standard error.

    If you give several laws, each of them has one line of output. If a law cannot be read, crashes, or needs more than 600 s of
    processor time or 4 GB, its line says so, and the exit code is 4. With --coupled, --report, --format json or --format junit, duhem
    verifies the laws one after the other and prints all details.
    """
    from duhem.proof.claims import CLAIMS, COUPLED
    from duhem.show.place import check_places, write

    laws = _found_files(laws)
    asked = None if claims is None else read_claims(claims)
    expected = _read_expected(expect, (*(asked or CLAIMS), *(COUPLED if coupled else ())))
    if len(laws) > 1 and form == "text" and report is None and certificate is None and not coupled:
        return _verify_each(laws, settings, asked, effort, strict, expected, workers)
    if workers is not None:
        remedy = "give several laws, and remove --format, --report and --certificate"
        raise InputError("--workers applies only to several laws with one line of output each", where=f"--workers {workers}", remedy=remedy)
    fixed = [_fixed(law, settings, several=len(laws) > 1) for law in laws]
    due = [_due(law.name, law.expect, expected) for law in fixed]
    check_places([report, certificate], laws)
    if certificate is not None and len(laws) > 1:
        raise InputError(
            "a certificate can contain only one law", where=f"--certificate {certificate}", remedy="verify the laws one by one"
        )
    texts: list[str] = []
    if report is not None:
        from duhem.cli.report import law_lines

        texts = [law_lines(law) for law in laws]

    from duhem.proof import verification
    from duhem.show.printing import text

    done: list[verification.Verification] = []
    for law in fixed:
        decided: list[ClaimResult] = []
        interrupted = False
        try:
            with Progress() as progress:

                def on_claim(result: ClaimResult, decided: list[ClaimResult] = decided, progress: Progress = progress) -> None:
                    decided.append(result)
                    progress.show(f"{len(decided)}: {result.claim} {result.verdict}")

                found = verification.verify(law, claims=asked, effort=effort, coupled=coupled, on_claim=on_claim, on_method=progress.tries)
        except KeyboardInterrupt:  # what was found before is said
            found, interrupted = verification.Verification(law, tuple(decided), (), (), effort=effort, interrupted=True), True
        if form == "text":
            say(f"\n{text(found, page())}" if done else text(found, page()))
            _say_for_which(found, shlex.join([laws[len(done)], *(word for setting in settings for word in ("--set", setting))]))
        done.append(found)
        if interrupted:
            break
    if form == "json":  # one object, or a list of them where several laws are asked for
        objects = ",\n".join(as_json(found.to_dict()) for found in done)
        say(f"[\n{objects}\n]" if len(laws) > 1 else objects)
    elif form == "junit":
        from duhem.proof.report import as_suite
        from duhem.show.junit import as_xml

        say(as_xml(as_suite(found, strict=strict, expected=own) for found, own in zip(done, due, strict=False)))
    if interrupted:
        return INTERRUPTED
    deliver("the certificate", certificate, done[0].certificate)
    if report is not None:
        from duhem.cli.report import again, article, without
        from duhem.show.document import as_page

        commands = (again(law, settings, claims, effort) for law in laws)
        write(report, as_page([article(*each) for each in zip(done, commands, texts, strict=True)]))
        wrote("the page", report)
        if lacking := without():
            aside(f"{report} is {lacking}")
    came = ((found.criterion.name, {r.claim: r.verdict.value for r in found.results}, own) for found, own in zip(done, due, strict=True))
    return _code_of(came, strict=strict)


def _say_for_which(found: Verification, law: str) -> None:
    """Say of each refuted claim for which values of the few parameters of shape it holds, or by which command one finds them."""
    asked = [r.claim for r in found if r.claim in ("origin", "convexity") and r.verdict == "refuted"]
    if found.interrupted or not asked:
        return
    from duhem.regions import told

    said = [sentence for claim in asked if (sentence := told(found.criterion, claim, law))]
    if said:
        say("\n".join(["", "For which parameters", *(f"  {sentence}" for sentence in said)]))


def _fixed(law: str, settings: Sequence[str], *, several: bool) -> Law:
    """The law at the values of ``--set``; an error says of which of several laws it is."""
    try:
        return read_fixed_law(law, settings)
    except InputError as fault:
        if not several or not fault.where.startswith("--set"):
            raise
        raise InputError(fault.what, where=f"{law}, {fault.where}", remedy=fault.remedy) from None


def _read_expected(given: Sequence[str], asked: Iterable[str]) -> dict[str, str]:
    """The verdicts by claim, each of a claim that is ``asked``."""
    expected: dict[str, str] = {}
    for one in given:
        where = f"--expect {one}"
        claim, verdict = read_pair(one, where, "CLAIM=VERDICT", "--expect smoothness=refuted")
        _check_expected({claim: verdict}, asked, "the selected claims are", where)
        if expected.setdefault(claim, verdict) != verdict:
            raise InputError(f"{claim} is expected to be {expected[claim]} too", where=where, remedy="expect one verdict of each claim")
    return expected


def _due(law: str, own: Mapping[str, str], expected: Mapping[str, str]) -> Mapping[str, str]:
    """The verdicts that are no failure: those of ``--expect``, then a law's ``own``.  InputError for a claim or a verdict that is none."""
    from duhem.proof.claims import CLAIMS

    _check_expected(own, CLAIMS, "claims are", f"expect of {law}")
    return {**own, **expected}


def _check_expected(expected: Mapping[str, str], claims: Iterable[str], choice: str, where: str) -> None:
    from duhem.proof.verdict import Verdict

    check_names("claim", expected, claims, choice, where)
    check_names("verdict", expected.values(), map(str, Verdict), "verdicts are", where)


def _code_of(found: Iterable[tuple[str, Mapping[str, str | None], Mapping[str, str]]], *, strict: bool) -> int:
    """The exit code of laws with their verdicts and the expected ones, by claim; one that is not as expected is told on standard error."""
    codes = {HELD}
    for law, verdicts, expected in found:
        for claim, verdict in verdicts.items():
            if (due := expected.get(claim)) is None:
                codes.add(REFUTED if verdict == "refuted" else UNDECIDED if strict and verdict in ("undecided", "tested") else HELD)
            elif verdict not in (due, None):
                aside(f"{law}: {claim} is {verdict}, where {due} is expected")
                codes.add(REFUTED)
    return REFUTED if REFUTED in codes else max(codes)


def _found_files(laws: Iterable[str]) -> list[str]:
    """The laws as they are named, a pattern such as laws/*.toml as the files that it fits.  InputError where it fits none."""
    found = list[str]()
    for law in laws:
        if any(letter in law for letter in "*?[") and not os.path.exists(law):
            files = sorted(glob.glob(law, recursive=True))
            if not files:
                raise InputError(f"no file matches {law[:60]!r}", remedy=f"duhem searched in {os.getcwd()}")
            found += files
        else:
            found.append(law)
    return found


def _verify_each(
    laws: Sequence[str],
    settings: Sequence[str],
    claims: Sequence[str] | None,
    effort: str,
    strict: bool,
    expected: Mapping[str, str],
    workers: int | None,
) -> int:
    """Say a line a law, in their order, each as soon as those before it are said; the exit code of all of them."""
    from duhem.expression.number import exact_text
    from duhem.law.criterion_file import expected_verdicts
    from duhem.proof.verification import wanted_claims
    from duhem.screening.campaign import Campaign, Claimed, Given
    from duhem.screening.pool import Pool

    names = [_law_name(law) for law in laws]
    due = [_due(name.shown, name.law().expect if name.path is None else expected_verdicts(name.path), expected) for name in names]
    values = tuple((name, exact_text(value)) for name, value in read_settings(settings).items())
    for law in laws if values else ():
        try:
            _fixed(law, settings, several=True)
        except InputError as fault:  # what else is wrong with the law is said in its line
            if fault.where.startswith(f"{law}, --set"):
                raise
    asked = Campaign((Given(tuple((name, values) for name in names)),), Claimed(wanted_claims(claims), effort))
    verdicts = list[dict[str, str | None]]()
    try:
        with Progress() as progress, Pool(asked, workers) as pool:
            for lines in _in_order(pool.texts([range(1, len(asked) + 1)])):
                progress.show("")
                say(_one_line(laws[len(verdicts)], lines))
                verdicts.append({line.claim: line.verdict for line in lines})
                progress.show(f"{len(verdicts)} of {len(laws)} laws")
    except KeyboardInterrupt:
        aside(f"interrupted after {len(verdicts)} of {len(laws)} laws")
        return INTERRUPTED
    code = _code_of(zip(laws, verdicts, due, strict=True), strict=strict)
    return FAILED if any(None in each.values() for each in verdicts) else code


def _law_name(law: str) -> LawName:
    """A law for the process that asks it: what is wrong in a file is that row's fault, a name that is none is told at once."""
    from duhem.law import catalogue
    from duhem.screening.campaign import LawName

    if (file := catalogue.file_read(law)) is None:
        return LawName(law) if catalogue.shipped(law.strip().replace("_", "-")) else LawName(law, value=read_law(law))
    if not file.is_file():
        raise InputError(f"there is no file {law[:60]!r}", remedy="check its name")
    return LawName(law, os.path.abspath(file))


def _in_order(texts: Iterable[str]) -> Iterator[tuple[VerdictLine, ...]]:
    """The lines of each row by its number, whichever is done first."""
    from duhem.screening.campaign import lines_of, number_of

    done, following = dict[int, str](), 1
    for text in texts:
        done[number_of(text)] = text
        while following in done:
            yield lines_of(done.pop(following))
            following += 1


def _one_line(law: str, lines: Sequence[VerdictLine]) -> str:
    from duhem.proof.claims import CLAIMS

    if lines[0].error is not None:
        return f"{law}: no verdict: {lines[0].error}"
    by_claim = sorted(lines, key=lambda line: list(CLAIMS).index(line.claim))
    groups = {verdict: ", ".join(line.claim for line in by_claim if line.counts_as == verdict) for verdict in _ORDER}
    return f"{law}: " + "; ".join(f"{verdict.replace('_', ' ')} {claims}" for verdict, claims in groups.items() if claims)
