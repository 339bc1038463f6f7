"""The page of ``duhem verify --report``: what each room says of a verified law, and how to see it again."""

from __future__ import annotations

import platform
import shlex
from collections.abc import Sequence
from functools import partial

from duhem.cli.arguments import read_law
from duhem.cli.verbs.doctor import CORE, versions
from duhem.derivation import derive
from duhem.derivation.printing import chapters
from duhem.errors import DuhemError, InputError, MissingExtraError
from duhem.law import catalogue
from duhem.law.criterion_file import criterion_text
from duhem.omitted import LeftOut
from duhem.portrait.pictures import panels
from duhem.proof import report
from duhem.proof.verification import Verification
from duhem.show import document, figure
from duhem.show.document import Article, Chapter, Lines, Paragraph, Titled
from duhem.version import __version__

__all__ = ["again", "article", "law_lines", "without"]

_SHOWN_WITH = ("matplotlib", "latex2mathml")


def article(found: Verification, command: str, law: str) -> Article:
    """One law on the page; ``command`` is the line that verifies it again, ``law`` its text."""
    derived, missing = _derivation(found)
    return Article(
        found.criterion.name,
        found.criterion.summary,
        (
            report.stated(found),
            *report.decided(found),
            _pictures(found),
            *report.left_aside(found, missing),
            *derived,
            _certified(found),
            _again(command, law),
        ),
    )


def again(law: str, settings: Sequence[str], claims: str | None, effort: str) -> str:
    """The command line that verifies a law again."""
    words = ["duhem", "verify", law, *(word for setting in settings for word in ("--set", setting))]
    words += [] if claims is None else ["--claims", claims]
    return shlex.join(words + ([] if effort == "normal" else ["--effort", effort]))


def law_lines(law: str) -> str:
    """The text of the file that a law is read from, or else of a criterion file that states the same law."""
    if (file := catalogue.file_read(law)) is not None:
        return file.read_text("utf-8-sig")
    return criterion_text(read_law(law))


def without() -> str:
    """What the page lacks for want of a package, and the remedy; empty where it lacks nothing."""
    faults: dict[str, MissingExtraError] = {}
    for part, check in (("pictures", partial(figure.check, None)), ("typeset formulas", document.check)):
        try:
            check()
        except MissingExtraError as fault:
            faults[part] = fault
    if not faults:
        return ""
    [*_, last] = faults.values()
    return f"incomplete: it has no {' and no '.join(faults)}: {', '.join(fault.what for fault in faults.values())}; {last.remedy}"


def _pictures(found: Verification) -> Chapter:
    try:
        return Chapter("Pictures", panels(found))
    except DuhemError as fault:  # without matplotlib, or without numbers to draw it at
        return Chapter("Pictures", (Paragraph(f"None: {fault}.", "without"),))


def _derivation(found: Verification) -> tuple[tuple[Chapter, ...], tuple[LeftOut, ...]]:
    try:
        derived = derive(found.criterion)
    except InputError as fault:
        return (), (LeftOut("derivation", fault.what),)
    return (Chapter("Derivation", chapters(derived)),), derived.left_out


def _certified(found: Verification) -> Chapter:
    try:
        return report.certified(found.certificate())
    except InputError as fault:
        return Chapter("Certificate", (Paragraph(f"None: {fault}."),))


def _again(command: str, law: str) -> Chapter:
    packages = versions((*CORE, *_SHOWN_WITH))
    about = (
        ("duhem", __version__),
        ("python", f"{platform.python_version()} ({platform.python_implementation()})"),
        ("packages", ", ".join(f"{name} {version}" for name, version in packages.items())),
    )
    return Chapter("How to reproduce it", (Lines(command), Titled(about), Paragraph("The law:"), Lines(law)))
