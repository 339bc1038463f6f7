"""The command line.  Nothing heavy is imported before a command needs it, so help and completion are immediate."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from time import monotonic
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

HELD, REFUTED, USAGE, UNDECIDED, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 130


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


class _Vectors(click.Command):
    """A command whose options named in ``vectors`` take all the numbers that follow, signs included."""

    vectors = ("--trial", "--stiffness")

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        joined: list[str] = []
        for arg in args:
            open_ = bool(joined) and (joined[-1] in self.vectors or joined[-1].startswith(tuple(f"{v}=" for v in self.vectors)))
            if open_ and _is_number(arg):
                joined[-1] += f"{' ' if '=' in joined[-1] else '='}{arg}"
            else:
                joined.append(arg)
        return super().parse_args(ctx, joined)


@cli.command(cls=_Vectors)
@_law_argument
@click.option("--set", "settings", metavar="NAME=VALUE", multiple=True, help="Value of a parameter. Repeatable.")
@click.option("--trial", metavar="A B ...", required=True, help="Trial stress k (u - u_in), one number a force.")
@click.option("--pressure", metavar="N", help="Normal stress sigma_n <= 0 in compression.")
@click.option("--stiffness", metavar="K ...", default="1", show_default=True, help="One number, one a force, or the matrix row by row.")
@click.option(
    "--method", type=click.Choice(["auto", "closed-form", "newton", "cvxpy"]), default="auto", show_default=True, help="How to solve."
)
@click.option("--tangent", is_flag=True, help="Add the consistent tangents.")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="For people or for programs."
)
def project(
    law: str, settings: Sequence[str], trial: str, pressure: str | None, stiffness: str, method: str, tangent: bool, form: str
) -> int:
    """One slip increment of LAW: the closest point of K to a trial stress.

    Prints stress, slip and multiplier with the residuals of the optimality conditions, recomputed from the law's formula.
    Ends with 4 if they say that the point is not solved.
    """
    fixed = _fixed(_law(law), settings)
    target, rows = _numbers(trial, "--trial"), _numbers(stiffness, "--stiffness")
    load = None if pressure is None else _number(pressure, "--pressure")

    from duhem.projection import Status
    from duhem.projection import project as closest
    from duhem.report import increment

    d = len(fixed.forces)
    k = [rows[i : i + d] for i in range(0, d * d, d)] if len(rows) == d * d and d > 1 else rows if len(rows) > 1 else rows[0]
    done = closest(fixed, target, load, k, method=method, tangent=tangent)
    _say({"text": increment.text, "json": increment.json}[form](fixed, target, load, done))
    return HELD if done.status[0] in (Status.STICK, Status.SLIP) else FAILED


@cli.command()
@click.argument("scene", type=click.Path(dir_okay=False))
@click.option("--out", metavar="FILE", help="Write the history as .csv or .parquet; left out, the scene's table, else standard output.")
@click.option("--plot", metavar="FILE", help="Draw stress path, hysteresis and energies (.png, .pdf, .svg).")
@click.option("--explain", is_flag=True, help="Print what the scene needs and what is left out, and stop.")
@click.option("--resume", is_flag=True, help="Go on with a run that was stopped.")
def simulate(scene: str, out: str | None, plot: str | None, explain: bool, resume: bool) -> int:
    """Drive a law along the loading path of SCENE, a TOML file.

    A run that is interrupted keeps what is done in FILE.partial, and --resume goes on from there.
    """
    from duhem import scene as scenes

    try:
        chosen = scenes.read(scene)
    except scenes.SceneFaults as fault:
        for each in fault.faults:
            click.echo(f"duhem: {each}", err=True)
        return USAGE
    table, figure = out or chosen.table, plot or chosen.plot
    scenes.check_outputs(table, figure, resume)
    if explain:
        for part in chosen.parts(table, figure):
            _say(f"{'needed' if part.needed else 'left out'}: {part.part} ({part.reason})")
        return HELD
    with _Progress("simulating") as progress:
        began = last = monotonic()

        def on_step(done: int, steps: int) -> None:
            nonlocal last
            if (now := monotonic()) - last > 0.2 and now - began > 1.0:
                last = now
                progress.show(f"{done} of {steps} steps")

        try:
            history = scenes.perform(chosen, table, resume, on_step)
        except scenes.Stopped as stop:
            progress.show("")
            click.echo(f"duhem: {stop}", err=True)
            return INTERRUPTED
    if table is None:
        _say(history.to_text().removesuffix("\n"))
    if figure is not None:
        from duhem.path.plots import save

        save(history, figure, law=chosen.law, **chosen.problem().increment.parameters)
    return HELD


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


def _is_number(text: str) -> bool:
    from duhem.expression.number import exact_number

    try:
        exact_number(text)
    except InputError:
        return text.lower().lstrip("+-") in ("nan", "inf", "infinity")  # numbers, though not usable ones
    return True


def _numbers(text: str, where: str) -> list[float]:
    from duhem.expression.number import exact_number

    try:
        return [float(exact_number(word)) for word in text.replace(",", " ").split()] or [float(exact_number(text))]
    except InputError as fault:
        raise InputError(fault.what, where=where, remedy=fault.remedy) from None


def _number(text: str, where: str) -> float:
    numbers = _numbers(text, where)
    if len(numbers) > 1:
        raise InputError(f"{len(numbers)} numbers are given", where=where, remedy="give one")
    return numbers[0]


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

    def __init__(self, what: str = "verifying") -> None:
        self.what = what

    def __enter__(self) -> _Progress:
        self.show(self.what)
        return self

    def __exit__(self, *_: object) -> None:
        self.show("")

    def show(self, text: str) -> None:
        if sys.stderr.isatty():
            print(f"\r\x1b[2K{text[:78]}", end="", file=sys.stderr, flush=True)
