"""``duhem bench``: error against run time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import settings_option
from duhem.cli.output import Progress
from duhem.cli.study import carry_out, flagship_argument, json_option, peers_option, read_subject, stiffness_option

if TYPE_CHECKING:
    from duhem.benchmark.work_precision import WorkPrecision

__all__ = ["bench"]


@click.command()
@flagship_argument
@settings_option
@click.option(
    "--scene",
    type=click.Choice(["increment", "path", "throughput", "project", "paths", "all"]),
    default="all",
    show_default=True,
    help="One increment alone, a loading path, many increments at once, the same through duhem.project, many steps through "
    "duhem.simulate, or all of these.",
)
@stiffness_option
@click.option(
    "--repeats",
    type=click.IntRange(1),
    default=5,
    show_default=True,
    help="Runs of each measurement; slow ones take fewer, small batches more.",
)
@click.option(
    "--points",
    type=click.IntRange(1),
    default=1_000_000,
    show_default=True,
    help="Increments of the scenes throughput and project, steps of a path in paths.",
)
@peers_option
@json_option
@click.option("--plot", metavar="FILE", help="Draw time over error, both logarithmic (.png, .pdf, .svg, ...).")
def bench(
    law: str,
    settings: Sequence[str],
    scene: str,
    stiffness: str | None,
    repeats: int,
    points: int,
    peers: bool,
    json_file: str | None,
    plot: str | None,
) -> int:
    """Measure error against run time of every method that applies to LAW (left out: antoni2007).

    Errors are taken against a reference in fifty digits that shares nothing with the methods; its own error is shown.
    Every parameter needs a value (--set); those of antoni2007 default to Figure 5 of the paper.  Times are medians with
    least and most; ratios are taken within the run.  What fails is listed, what is left out is named with the reason.

    Exit codes: 0 measured, whether or not a target holds; 2 usage or file error; 4 no method gave an answer; 130
    interrupted, after printing what was done.
    """
    fixed, diagonal = read_subject(law, settings, stiffness)

    from duhem.benchmark import work_precision

    def measure(progress: Progress) -> WorkPrecision:
        return work_precision.bench(
            fixed,
            scenes=work_precision.SCENES if scene == "all" else (scene,),
            stiffness=diagonal,
            peers=peers,
            repeats=repeats,
            points=points,
            on_row=lambda row: progress.show(f"{row.scene}: {row.method} {row.setting}"),
        )

    return carry_out(measure, json_file, plot, [law])
