"""``duhem stress``: stiff and extreme cases."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import read_fixed_formula, read_numbers, settings_option
from duhem.cli.bench import FLAGSHIP, settled, written
from duhem.cli.exit_code import FAILED, HELD, INTERRUPTED
from duhem.cli.output import Progress, say
from duhem.version import __version__

__all__ = ["stress"]


@click.command()
@click.argument("law", default=FLAGSHIP)
@settings_option
@click.option("--axis", "axes", metavar="NAME", multiple=True, help="Only this axis of difficulty, for example load. Repeatable.")
@click.option("--stiffness", metavar="K ...", help="Diagonal stiffness, one number a force, in quotes; left out 1 2 ...")
@click.option("--json", "json_file", metavar="FILE", help="Write everything as one JSON object.")
@click.option("--plot", metavar="FILE", help="Draw accurate digits over decades for each axis and method (.png, .pdf, .svg).")
def stress(law: str, settings: Sequence[str], axes: Sequence[str], stiffness: str | None, json_file: str | None, plot: str | None) -> int:
    """Try every method that applies to LAW (left out: antoni2007) on stiff and extreme increments, decade by decade.

    Each answer is judged against a reference in fifty digits: finite, in K, how many digits are accurate, and whether the
    method flags it.  Silently wrong is what has fewer than 6 digits and no flag.  Input that is not finite has to be
    refused.  Every parameter needs a value (--set); those of antoni2007 default to Figure 5 of the paper.

    Exit codes: 0 measured, whatever was found; 2 usage or file error; 4 no method gave an answer; 130 interrupted, after
    printing what was done.
    """
    fixed = read_fixed_formula(law, settled(law, settings))
    diagonal = None if stiffness is None else read_numbers(stiffness, "--stiffness")

    import json

    from duhem.benchmark import extreme_cases as extremes
    from duhem.benchmark.extreme_cases import figure
    from duhem.benchmark.extreme_cases.text import text
    from duhem.show import figure as canvas

    if plot is not None:
        canvas.check(plot)
    with Progress("measuring") as progress:
        done = extremes.stress(
            fixed,
            axes=tuple(axes) or tuple(extremes.AXES),
            stiffness=diagonal,
            on_row=lambda row: progress.show(f"{row.axis} {row.label}: {row.method}"),
        )
    say(text(done))
    if json_file is not None:
        written(json_file, json.dumps({"duhem": __version__, **done.to_dict()}, indent=2, ensure_ascii=False, allow_nan=False))
    if plot is not None:
        figure.save(done, plot)
    return INTERRUPTED if done.interrupted else FAILED if done.failed else HELD
