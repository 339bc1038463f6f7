"""The command line.  Nothing heavy is imported before a command needs it, so help and completion are immediate."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.shell_completion import CompletionItem

from duhem import __version__
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.criterion import Criterion
    from duhem.verdict import Verdict
    from duhem.verification import ClaimResult

__all__ = ["cli"]

HELD, REFUTED, UNDECIDED, FAILED, INTERRUPTED = 0, 1, 3, 4, 130


def _complete_law(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    from duhem import catalogue

    named = [CompletionItem(name) for name in catalogue.names() if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


_law_argument = click.argument("law", shell_complete=_complete_law)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="duhem", message="%(prog)s %(version)s")
def cli() -> None:
    """Decide whether a friction or yield law is thermodynamically admissible, and prove it.

    A LAW is a built-in name (duhem list), a criterion file (duhem init NAME), or module:attribute.

    Exit codes: 0 nothing refuted, 1 something refuted, 2 usage or file error, 3 undecided with --strict, 4 internal or
    solver failure, 130 interrupted.
    """


@cli.command()
@_law_argument
@click.option(
    "--set", "settings", metavar="NAME=VALUE", multiple=True, help="Fix a parameter, exactly: mu_a=0.15 or mu_a=3/20. Repeatable."
)
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
    asked = None if claims is None else _claims(claims)
    fixed = _fixed(_law(law), settings)

    from duhem import verification
    from duhem.report import json, text

    report = {"text": text, "json": json}[form]
    decided: list[ClaimResult] = []
    try:
        with _Progress() as progress:

            def on_claim(result: ClaimResult) -> None:
                decided.append(result)
                progress.show(f"{len(decided)}: {result.claim} {result.verdict}")

            done = verification.verify(fixed, claims=asked, on_claim=on_claim)
    except KeyboardInterrupt:
        _say(report.interrupted(fixed, decided))
        return INTERRUPTED
    _say(report.complete(done))
    return _code([r.verdict for r in done.results], strict)


@cli.command()
@_law_argument
@click.option(
    "--format", "form", type=click.Choice(["text", "latex", "markdown"]), default="text", show_default=True, help="How to print it."
)
def derive(law: str, form: str) -> None:
    """Print the symbolic derivation of LAW."""
    chosen = _law(law)
    from duhem import derivation

    derived = derivation.derive(chosen)
    _say({"text": derived.text, "latex": derived.latex, "markdown": derived.markdown}[form]())


@cli.command("list")
def list_laws() -> None:
    """List the laws that can be named."""
    from duhem import catalogue

    names = catalogue.names()
    width = max(map(len, names))
    for name in names:
        _say(f"{name:<{width}}  {catalogue.summary(name)}".rstrip())


@cli.command()
@click.argument("name")
def init(name: str) -> None:
    """Write NAME.toml, a commented criterion file to start from."""
    from duhem import catalogue

    stem = name.removesuffix(".toml")
    content, path = catalogue.template(stem), Path(f"{stem}.toml")
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(content)
    except FileExistsError:
        raise InputError("the file exists already", where=f"{path}", remedy="choose another name or move the file away") from None
    except OSError as fault:
        raise InputError(f"the file cannot be written: {fault.strerror}", where=f"{path}", remedy="write where you may") from None
    _say(f"wrote {path}; verify it with: duhem verify {path}")


@cli.command()
@click.argument("claim", required=False)
def explain(claim: str | None) -> None:
    """Explain the theory of CLAIM, or list the claims."""
    from duhem.claims import CLAIMS

    if claim is None:
        width = max(map(len, CLAIMS))
        for name, entry in CLAIMS.items():
            _say(f"{name:<{width}}  {entry.statement}")
        return
    (name,) = _claims(claim)
    _say(f"{name}: {CLAIMS[name].statement}\n\n{CLAIMS[name].theory.strip()}")


@cli.command()
def doctor() -> int:
    """List installed and missing parts.

    Ends with facts about the machine that help with a bug report.
    """
    from duhem import doctor as parts

    _say(parts.report())
    return FAILED if parts.missing() else HELD


def _say(text: str) -> None:
    """Print a result; a reader that goes away, as in ``duhem list | head -1``, changes no exit code."""
    try:
        click.echo(text)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _law(text: str) -> Criterion:
    from duhem import catalogue

    if ":" in text and os.getcwd() not in sys.path:  # a law in a module beside the user, as with python -m
        sys.path.insert(0, os.getcwd())
    return catalogue.load(text)


def _fixed(law: Criterion, settings: Sequence[str]) -> Criterion:
    from duhem.domain_check import check_domain
    from duhem.expression.number import exact_number

    values = {}
    for setting in settings:
        name, equals, value = (part.strip() for part in setting.partition("="))
        where = f"--set {setting}"
        if not (name and equals and value):
            raise InputError("this is not of the form NAME=VALUE", where=where, remedy="write for example --set mu_a=0.15")
        if name in values:
            raise InputError(f"{name} is set twice", where=where, remedy="set it once")
        try:
            values[name] = exact_number(value)
            law.fix({name: values[name]})
        except InputError as fault:
            raise InputError(fault.what, where=where, remedy=fault.remedy) from None
    fixed = law.fix(values)
    check_domain(fixed, where=" ".join(f"--set {setting}" for setting in settings))
    return fixed


def _claims(text: str) -> tuple[str, ...]:
    from duhem.claims import CLAIMS

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


class _Progress:
    """One line on standard error that overwrites itself and vanishes; nothing at all where that is no terminal."""

    def __enter__(self) -> _Progress:
        self.show("verifying")
        return self

    def __exit__(self, *_: object) -> None:
        self.show("")

    def show(self, text: str) -> None:
        if sys.stderr.isatty():
            print(f"\r\x1b[2K{text[:78]}", end="", file=sys.stderr, flush=True)
