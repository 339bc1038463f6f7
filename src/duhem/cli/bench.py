"""``duhem bench``: error against run time."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import read_fixed_formula, read_numbers, settings_option
from duhem.cli.exit_code import FAILED, HELD, INTERRUPTED
from duhem.cli.output import Progress, say
from duhem.version import __version__

__all__ = ["FIGURE_5", "FLAGSHIP", "bench", "settled", "written"]

FLAGSHIP = "antoni2007"
FIGURE_5 = {"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"}  # Antoni et al. 2007


def settled(law: str, settings: Sequence[str]) -> tuple[str, ...]:
    """The settings, with those of Figure 5 for the parameters of the flagship that are left open."""
    if law != FLAGSHIP:
        return tuple(settings)
    given = {setting.partition("=")[0].strip() for setting in settings}
    return (*settings, *(f"{name}={value}" for name, value in FIGURE_5.items() if name not in given))


def written(file: str, content: str) -> None:
    """Write a result, whole or not at all."""
    import os

    from duhem.errors import InputError

    beside = f"{file}.writing"
    try:
        with open(beside, "w", encoding="utf-8") as stream:
            stream.write(content + "\n")
        os.replace(beside, file)
    except OSError as fault:
        raise InputError(f"the file cannot be written: {fault.strerror}", where=file, remedy="write where you may") from None


@click.command()
@click.argument("law", default=FLAGSHIP)
@settings_option
@click.option(
    "--scene",
    type=click.Choice(["increment", "path", "throughput", "all"]),
    default="all",
    show_default=True,
    help="One increment alone, a loading path, many increments at once, or all three.",
)
@click.option("--stiffness", metavar="K ...", help="Diagonal stiffness, one number a force, in quotes; left out 1 2 ...")
@click.option("--repeats", type=click.IntRange(1), default=5, show_default=True, help="Runs of each measurement; slow ones take fewer.")
@click.option("--points", type=click.IntRange(1), default=1_000_000, show_default=True, help="Increments of the throughput scene.")
@click.option("--json", "json_file", metavar="FILE", help="Write everything as one JSON object.")
@click.option("--plot", metavar="FILE", help="Draw time over error, both logarithmic (.png, .pdf, .svg).")
def bench(
    law: str, settings: Sequence[str], scene: str, stiffness: str | None, repeats: int, points: int, json_file: str | None, plot: str | None
) -> int:
    """Measure error against run time of every method that applies to LAW (left out: antoni2007).

    Errors are taken against a reference in fifty digits that shares nothing with the methods; its own error is shown.
    Every parameter needs a value (--set); those of antoni2007 default to Figure 5 of the paper.  Times are medians with
    least and most; ratios are taken within the run.  What fails is listed, what is left out is named with the reason.

    Exit codes: 0 measured, whether or not a target holds; 2 usage or file error; 4 no method gave an answer; 130
    interrupted, after printing what was done.
    """
    fixed = read_fixed_formula(law, settled(law, settings))
    diagonal = None if stiffness is None else read_numbers(stiffness, "--stiffness")

    import json

    from duhem.benchmark import work_precision as workprecision
    from duhem.benchmark.work_precision import figure
    from duhem.benchmark.work_precision.text import text
    from duhem.show import figure as canvas

    if plot is not None:
        canvas.check(plot)
    with Progress("measuring") as progress:
        done = workprecision.bench(
            fixed,
            scenes=workprecision.SCENES if scene == "all" else (scene,),
            stiffness=diagonal,
            repeats=repeats,
            points=points,
            on_row=lambda row: progress.show(f"{row.scene}: {row.method} {row.setting}"),
        )
    say(text(done))
    if json_file is not None:
        written(json_file, json.dumps({"duhem": __version__, **done.to_dict()}, indent=2, ensure_ascii=False, allow_nan=False))
    if plot is not None:
        figure.save(done, plot)
    return INTERRUPTED if done.interrupted else FAILED if done.failed else HELD
