"""``duhem test``: a slip increment put to every check."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import isqrt
from random import Random
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from duhem.cli.arguments import (
    choice_option,
    complete_law,
    read_attribute,
    read_fixed_formula,
    read_law,
    read_number,
    read_numbers,
    read_pair,
    read_routine,
    read_settings,
    report_format_option,
    settings_option,
)
from duhem.cli.output import FAILED, HELD, INTERRUPTED, REFUTED, Progress, as_json, aside, say, wrote
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.testing.checks.registry import Check
    from duhem.testing.failures.report import Report
    from duhem.testing.routines import Material, Unfinished
    from duhem.testing.run import ConformanceRun

    Routine = Callable[..., ConformanceRun]  # what makes its run

__all__ = ["test"]

_EXAMPLES = {"dev": 30, "ci": 100, "deep": 2000}


@click.command()
@click.argument("subject", metavar="LAW|MODULE:CALLABLE|UMAT", shell_complete=complete_law)
@click.option("--law", metavar="LAW", shell_complete=complete_law, help="The law of the routine MODULE:CALLABLE or of the UMAT.")
@settings_option
@choice_option("--profile", of=[*_EXAMPLES], says="Number of cases: dev 30; ci 100, the same in each run; deep 2000.")
@click.option("--examples", type=click.IntRange(1), metavar="N", help="Number of cases, instead of that of the profile.")
@click.option("--stiffness", metavar="K ...", help="Stiffness in quotes: one number per force, or the matrix row by row (default: random).")
@click.option("--pressure", metavar="N", help="Pressure (normal stress) sigma_n <= 0 (default: random, if there is a law).")
@click.option("--props", metavar="P ...", help="PROPS of a UMAT, in quotes.")
@click.option("--nstatv", type=click.IntRange(0), metavar="N", help="Number of STATEV of a UMAT, which are 0 at first (default 0).")
@click.option("--ntens", type=click.IntRange(1), metavar="N", help="Number of components of a UMAT (default 6; 4, or 3 of plane stress).")
@click.option(
    "--state",
    metavar="NAME=PLACES",
    multiple=True,
    help="Where a variable of the law stands in the state of a material, counted from 0: p=0, or X=7:13. Repeatable.",
)
@click.option("--largest-strain", metavar="E", help="No increment of a material is larger (default: 100 times the elastic strain).")
@click.option("--seed", type=click.IntRange(0), metavar="S", help="Draw the same cases as an earlier run with this seed.")
@click.option("--accuracy", metavar="A", help="Relative error of the stress that you allow the routine (default 1e-9).")
@click.option("--checks", metavar="A,B", help="Run only these checks.")
@click.option(
    "--most-flagged",
    metavar="S",
    help="Maximum fraction of increments that MODULE:CALLABLE may flag as not solved (default 0). Not used for duhem's own methods.",
)
@click.option(
    "--expect",
    metavar="CHECK=REASON",
    multiple=True,
    help="A check that you expect to fail, with the reason. If it passes, this is an error. Repeatable.",
)
@click.option(
    "--shrink",
    type=click.IntRange(0),
    metavar="N",
    default=200,
    show_default=True,
    help="Maximum number of attempts to simplify a failing case.",
)
@click.option(
    "--every",
    type=click.IntRange(1),
    metavar="N",
    help="Some checks call the routine again. Do this for one increment in N (default 7, without a law 2).",
)
@click.option("--replay", metavar="FOLDER", help="Also write each failure to FOLDER, as a test file that repeats it.")
@report_format_option
def test(
    subject: str,
    law: str | None,
    settings: Sequence[str],
    profile: str,
    examples: int | None,
    stiffness: str | None,
    pressure: str | None,
    props: str | None,
    nstatv: int | None,
    ntens: int | None,
    state: Sequence[str],
    largest_strain: str | None,
    seed: int | None,
    accuracy: str | None,
    checks: str | None,
    most_flagged: str | None,
    expect: Sequence[str],
    shrink: int,
    every: int | None,
    replay: str | None,
    form: str,
) -> int:
    """Run every check on an update routine, or on duhem's methods.

    An update routine computes the stress at the end of an increment. A check is a property that every correct routine has. With LAW,
    duhem tests its own methods for this law.

    MODULE:CALLABLE is your routine update(trial (N, d), pressure (N,), stiffness (d, d), **parameters) -> stress (N, d). --law names
    its law. duhem also looks for the module in the working folder. Without --law, only the checks that need no law run. Then the
    routine must be a Material, or --stiffness must give the number of forces, and --set the parameters. Hypothesis draws increments on,
    beside and far from the boundary of K, and simplifies those that fail. The report shows each likely cause once.

    UMAT is a source in Fortran or C (.f, .f90, .c, ...), which duhem compiles, or a shared library. With --law, each condition of the step
    of this law is a check, at the state that the UMAT keeps.

    Exit codes: 0 every check passed; 1 a check failed; 2 usage or file error; 4 a routine gave no answer or exceeded its time; 130
    interrupted, after printing the results so far.
    """
    from duhem.testing.conformance import check_expected, checks_asked

    seed = seed if seed is not None else 0 if profile == "ci" else Random().getrandbits(32)
    again = _again(click.get_current_context(), subject, seed)
    own = _is_routine(subject)
    most = _most_flagged(most_flagged, own)
    expected = dict(read_pair(one, f"--expect {one}", "CHECK=REASON", "--expect slope='no tangent yet'") for one in expect)
    named = None if checks is None else tuple(dict.fromkeys(name.strip() for name in checks.split(",") if name.strip()))
    sizes = None if stiffness is None else _matrix(read_numbers(stiffness, "--stiffness"), own and law is None)
    options: dict[str, Any] = {"max_examples": examples or _EXAMPLES[profile], "rows": 30, "every": every, "tries": shrink, "seed": seed}
    for name, given in {"pressure": pressure, "accuracy": accuracy, "largest_strain": largest_strain}.items():
        options |= {} if given is None else {name: read_number(given, f"--{name.replace('_', '-')}")}
    places = {name: _places(at, f"--state {one}") for one in state for name, at in [read_pair(one, f"--state {one}", *_STATE)]}
    of_umat = {"props": None if props is None else read_numbers(props, "--props"), "nstatv": nstatv, "ntens": ntens}
    material = _material(subject, own, {name: given for name, given in of_umat.items() if given is not None}, places, sizes)
    options |= {"expected": expected, "stiffness": None if _is_umat(subject) else sizes}
    of, held = None if own and law is None else subject, material is not None and law is not None
    check_expected(of, expected, held, "--expect")
    asked_for = checks_asked(of, named, held, "--checks")
    routines, left_out = _routines(subject, own, material, law, settings, places, sizes is not None)
    tested, ended = _carry_out(routines, asked_for, most, options)
    say(_told(form, tested, left_out, again))
    if ended is not None and not isinstance(ended, KeyboardInterrupt):
        aside(ended)
    reports = [report for report, _ in tested.values()]
    if replay is not None:  # a test file for each cause, and for the increment that a routine does not come back from
        for file in (file for report in reports for file in report.write_replays(replay)):
            wrote("a failure as a test", f"{file}")
    if isinstance(ended, KeyboardInterrupt):
        return INTERRUPTED
    silent = [report for report in reports if report.points and report.flagged == report.points]
    if ended is None and any(not report.ok for report in reports if report not in silent):
        return REFUTED
    return FAILED if ended is not None or silent or not reports else HELD


def _matrix(numbers: list[float], free: bool) -> Any:
    """One number a force, one for all where a law says how many there are, or a square of them row by row."""
    if len(numbers) == 1 and not free:
        return numbers[0]
    d = isqrt(len(numbers))
    return [numbers[i : i + d] for i in range(0, d * d, d)] if d * d == len(numbers) and d > 1 else numbers


_STATE = ("NAME=PLACES", "--state X=7:13")
_LIBRARIES = (".so", ".dylib", ".dll")


def _places(text: str, where: str) -> list[int]:
    """Places such as 0, 1,3 or 7:13."""
    try:
        parts = [[*map(int, part.split(":"))] for part in text.split(",")]
        return [place for ends in parts for place in (ends if len(ends) == 1 else range(*ends))]
    except (TypeError, ValueError):
        raise InputError(f"{text!r} are no places", where=where, remedy="write a number, several as 1,3, or a range as 7:13") from None


def _material(subject: str, own: bool, of_umat: Mapping[str, Any], places: Mapping[str, list[int]], k: Any) -> Material | None:
    """The material that is named, or made of a UMAT; None for anything else."""
    from duhem.testing.foreign import umat
    from duhem.testing.routines import Material

    if _is_umat(subject):
        return umat(subject, stiffness=k, **of_umat)
    if of_umat:
        remedy = "name its source or library, such as umat.f, or remove it"
        raise InputError("this option is for a UMAT", where=f"--{next(iter(of_umat))}", remedy=remedy)
    found = read_attribute(subject) if own else None
    if isinstance(found, Material):
        return found
    if places:
        raise InputError("the routine keeps no state", where="--state", remedy="name a UMAT or a Material, or remove it")
    return None


def _is_umat(subject: str) -> bool:
    """Whether it is a source or a library."""
    from duhem.testing.foreign.shared import SOURCES

    return subject.lower().endswith(SOURCES + _LIBRARIES)


def _is_routine(subject: str) -> bool:
    """Whether it is something else than a law."""
    from duhem.law.curve_law import Law

    return _is_umat(subject) or (":" in subject and not isinstance(read_attribute(subject), Law))


def _most_flagged(given: str | None, own: bool) -> float:
    """The share of increments that may be flagged; InputError for what is none, or where duhem's own methods are tested."""
    from duhem.testing.drawn.strategies import check_share

    if given is not None and not own:
        remedy = "remove it: duhem's methods flag what they cannot solve"
        raise InputError("this option applies only to your own routine", where=f"--most-flagged {given}", remedy=remedy)
    share = float(not own) if given is None else read_number(given, "--most-flagged")
    check_share(share, "--most-flagged")
    return share


def _routines(
    subject: str,
    own: bool,
    material: Material | None,
    law: str | None,
    settings: Sequence[str],
    places: Mapping[str, list[int]],
    sized: bool,
) -> tuple[dict[str, Routine], dict[str, str]]:
    """What is tested, by the name it is shown under; of the methods of duhem that do not take a law, why they do not."""
    from duhem.law.catalogue import load_formula
    from duhem.testing.conformance import PROMISED, own_solvers
    from duhem.testing.drawn.strategies import ACCURACY
    from duhem.testing.run import ConformanceRun

    values = {name: float(value) for name, value in read_settings(settings).items()} if own else {}
    if material is not None:
        if law is None and settings:
            what = "a material contains its own parameters"
            raise InputError(what, where=f"--set {settings[0]}", remedy="set them where the material is created")
        held_to = None if law is None else load_formula(read_law(law))
        return {subject: partial(ConformanceRun, held_to, material, values or None, state=places or None, given=law)}, {}
    if law is not None:
        return {subject: partial(ConformanceRun, read_fixed_formula(law, settings), read_routine(subject), None, given=law)}, {}
    if own:
        routine = read_routine(subject)
        if not sized:
            what = f"{subject} is a routine without a law, so the number of forces is not known"
            raise InputError(what, where="--law", remedy="name its law, for example --law coulomb, or give --stiffness")
        return {subject: partial(ConformanceRun, None, routine, values)}, {}
    known = read_fixed_formula(subject, settings)
    solvers = dict(own_solvers(known))
    found: dict[str, Routine] = {
        f"{known.name} {method}": partial(ConformanceRun, known, solver, None, given=subject, accuracy=PROMISED.get(method, ACCURACY))
        for method, solver in solvers.items()
        if not isinstance(solver, str)
    }
    return found, {method: why for method, why in solvers.items() if isinstance(why, str)}


def _carry_out(
    routines: Mapping[str, Routine], checks: Sequence[Check], most_flagged: float, options: Mapping[str, Any]
) -> tuple[dict[str, tuple[Report, str]], KeyboardInterrupt | Unfinished | None]:
    """What came of one after the other, with words on how it was asked, and what ended it before its end."""
    tested: dict[str, tuple[Report, str]] = {}
    with Progress("testing") as progress:
        for name, made in routines.items():
            begun = monotonic()

            def seen(run: ConformanceRun, name: str = name, begun: float = begun) -> None:
                rate = run.examples / max(monotonic() - begun, 1e-9)
                shares = run.visited.shares
                slip = f", slip {shares['slip']:.0%}" if shares else ""
                progress.show(f"{name}: {run.examples} of {options['max_examples']}, {rate:.0f}/s{slip}, {len(run.found)} failed")

            try:
                run = made(checks, on_case=seen, **options)
            except InputError as fault:  # what cannot be used is told by the name of its option
                where = f"--{fault.where.replace('_', '-')}" if fault.where in options else fault.where
                raise InputError(fault.what, where=where, remedy=fault.remedy) from None
            report, seconds = replace(run.outcome(), most_flagged=most_flagged), monotonic() - begun
            asked = f"{report.examples} examples in {seconds:.1f} s, {report.examples / max(seconds, 1e-9):.0f} a second"
            if run.every > 1 and any(each.again for each in run.asked):
                asked += f"\nchecks that call the routine again used one increment in {run.every}; --every 1 uses all of them"
            tested[name] = report, asked
            if run.ended is not None:
                return tested, run.ended
    return tested, None


def _told(form: str, tested: Mapping[str, tuple[Report, str]], left_out: Mapping[str, str], again: str) -> str:
    from duhem.testing.failures.report import as_dict, as_junit

    if form == "junit":
        return as_junit({name: report for name, (report, _) in tested.items()})
    if form == "json":
        routines = {name: {**as_dict(report), "again": again} for name, (report, _) in tested.items()}
        return as_json({"routines": routines, "left_out": left_out})
    parts = [f"{name}\n{report}\n{asked}\nagain: {again}" for name, (report, asked) in tested.items()]
    return "\n\n".join([*parts, *(f"{method} skipped: {why}" for method, why in left_out.items())])


def _again(context: click.Context, subject: str, seed: int) -> str:
    """The command line that draws the same cases."""
    words = ["duhem", "test", subject]
    left_out = ("subject", "seed", "shrink", "replay", "form")  # or said otherwise
    for option in context.command.params:
        value = None if option.name in left_out else context.params.get(option.name or "")
        for each in value if isinstance(value, tuple | list) else [] if value is None else [value]:
            words += [option.opts[0], str(each)]
    return shlex.join([*words, "--seed", str(seed)])
