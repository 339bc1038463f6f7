"""Several laws verified beside each other, a line each: rows of a campaign without a table."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import read_fixed_law, read_law, read_settings
from duhem.cli.exit_code import FAILED, INTERRUPTED
from duhem.cli.expected import check_expected, code_of
from duhem.cli.output import Progress, say
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.screening.lines import VerdictLine
    from duhem.screening.rows import LawName

__all__ = ["found_files", "verify_each"]

_ORDER = ("refuted", "undecided", "tested", "proved", "not_applicable")  # what deserves a look comes first


def found_files(laws: Iterable[str]) -> list[str]:
    """The laws as they are named, a pattern such as laws/*.toml as the files that it fits.  InputError where it fits none."""
    found = list[str]()
    for law in laws:
        if any(letter in law for letter in "*?[") and not os.path.exists(law):
            files = sorted(glob.glob(law, recursive=True))
            if not files:
                raise InputError(f"no file is named {law[:60]!r}", remedy=f"they are looked for in {os.getcwd()}")
            found += files
        else:
            found.append(law)
    return found


def verify_each(
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
    from duhem.proof.verification import wanted_claims
    from duhem.screening.campaign import Campaign
    from duhem.screening.inquiries import Claimed
    from duhem.screening.pool import Pool, cores
    from duhem.screening.rows import Given

    names = [_named(law) for law in laws]
    due = [_expected(name) for name in names]
    values = tuple(
        (name, exact_text(setting.partition("=")[2].strip())) for name, setting in zip(read_settings(settings), settings, strict=True)
    )
    if values:
        for law in laws:
            _check_settings(law, settings)
    asked = Campaign((Given(tuple((name, values) for name in names)),), Claimed(wanted_claims(claims), effort))
    verdicts = list[dict[str, str | None]]()
    try:
        with Progress() as progress, Pool(asked, workers or cores()) as pool:
            for lines in _in_order(pool.texts([range(1, len(asked) + 1)])):
                progress.show("")
                say(_told(laws[len(verdicts)], lines))
                verdicts.append({line.claim: line.verdict for line in lines})
                progress.show(f"{len(verdicts)} of {len(laws)} laws")
    except KeyboardInterrupt:
        click.echo(f"duhem: interrupted after {len(verdicts)} of {len(laws)} laws", err=True)
        return INTERRUPTED
    found = ((law, verdict, {**own, **expected}) for law, verdict, own in zip(laws, verdicts, due, strict=True))
    code = code_of(found, strict=strict)
    return FAILED if any(None in each.values() for each in verdicts) else code


def _named(law: str) -> LawName:
    """A law for the process that asks it: what is wrong in a file is that row's fault, a name that is none is told at once."""
    from duhem.law import catalogue
    from duhem.screening.rows import LawName

    if (file := catalogue.file_read(law)) is None:
        return LawName(law) if catalogue.shipped(law.strip().replace("_", "-")) else LawName(law, value=read_law(law))
    if not file.is_file():
        raise InputError(f"there is no file {law[:60]!r}", remedy="check its name")
    return LawName(law, os.path.abspath(file))


def _expected(law: LawName) -> Mapping[str, str]:
    """The verdicts that the law's own file, or its author in Python, expects."""
    from duhem.law.criterion_file import expected_verdicts

    found = law.value.expect if law.value is not None else {} if law.path is None else expected_verdicts(law.path)
    check_expected(law.shown, found)
    return found


def _check_settings(law: str, settings: Sequence[str]) -> None:
    """InputError for a setting that does not fit; what else is wrong with the law is said in its line."""
    try:
        read_fixed_law(law, settings)
    except InputError as fault:
        if fault.where.startswith("--set"):
            raise InputError(fault.what, where=f"{law}, {fault.where}", remedy=fault.remedy) from None


def _in_order(texts: Iterable[str]) -> Iterator[tuple[VerdictLine, ...]]:
    """The lines of each row by its number, whichever is done first."""
    from duhem.screening.lines import lines_of, number_of

    done, following = dict[int, str](), 1
    for text in texts:
        done[number_of(text)] = text
        while following in done:
            yield lines_of(done.pop(following))
            following += 1


def _told(law: str, lines: Sequence[VerdictLine]) -> str:
    from duhem.proof.claims import CLAIMS

    if lines[0].error is not None:
        return f"{law}: no verdict: {lines[0].error}"
    by_claim = sorted(lines, key=lambda line: list(CLAIMS).index(line.claim))
    groups = {verdict: ", ".join(line.claim for line in by_claim if line.verdict == verdict) for verdict in _ORDER}
    return f"{law}: " + "; ".join(f"{verdict.replace('_', ' ')} {claims}" for verdict, claims in groups.items() if claims)
