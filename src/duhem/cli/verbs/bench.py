"""``duhem bench``: error against run time."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import choice_option, flagship_argument, json_option, peers_option, read_subject, settings_option, stiffness_option
from duhem.cli.output import Progress, carry_out

if TYPE_CHECKING:
    from duhem.benchmark.work_precision import WorkPrecision

__all__ = ["bench"]

_count_option = partial(click.option, type=click.IntRange(1), show_default=True)


@click.command()
@flagship_argument
@settings_option
@choice_option(
    "--scene",
    of=["increment", "path", "throughput", "project", "paths", "all"],
    default="all",
    says="What to measure. increment: one increment; path: a loading path; throughput: many increments at once; project: the same "
    "through duhem.project; paths: many steps through duhem.simulate.",
)
@stiffness_option
@_count_option("--repeats", default=5, help="Number of runs of each measurement (fewer for slow ones, more for small batches).")
@_count_option("--points", default=1_000_000, help="Number of increments for throughput and project, and of steps for paths.")
@peers_option
@json_option
@click.option("--plot", metavar="FILE", help="Draw run time over error with logarithmic axes (.png, .pdf, .svg, ...).")
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
    """Measure the error and the run time of every method for LAW.

    The default law is antoni2007. The reference has fifty digits and shares no code with the methods; the output shows its own error
    too. Every parameter needs a value (--set); the default values of antoni2007 are those of Figure 5 of the paper. Times are medians
    with minimum and maximum. Ratios compare times of the same run. The output lists failures, and omitted methods with the reason.

    Exit codes: 0 measured, even if a target is missed; 2 usage or file error; 4 no method gave an answer; 130 interrupted, after
    printing the results so far.
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
