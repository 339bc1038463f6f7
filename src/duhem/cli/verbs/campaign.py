"""``duhem campaign``: many laws at once."""

from __future__ import annotations

from functools import partial
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from duhem.cli.arguments import modules_beside_the_user
from duhem.cli.output import FAILED, HELD, INTERRUPTED, REFUTED, Progress, as_json, aside, deliver, page, say, wrote
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.benchmark.extreme_cases import StressCases
    from duhem.screening.campaign import Campaign
    from duhem.testing import RoutineChecks

__all__ = ["campaign"]


@click.command()
@click.argument("campaign_file", metavar="CAMPAIGN", type=click.Path(dir_okay=False))
@click.option("--workers", metavar="N", type=click.IntRange(min=1), help="Number of processes (default: one per core).")
@click.option("--scheduler", metavar="ADDRESS", help="Use this Dask scheduler: its address, or the file that it wrote.")
@click.option(
    "--resume",
    is_flag=True,
    help="Continue a campaign that was stopped. A finished Parquet table is not changed; a finished CSV table is computed again.",
)
@click.option("--out", metavar="FILE", help="Write the table to this .csv or .parquet file (default: the file that CAMPAIGN names).")
@click.option("--routine", metavar="MODULE:CALLABLE", help='The update routine to test if CAMPAIGN has ask = "checks" (see duhem test).')
@click.option("--row", metavar="N", type=click.IntRange(min=1), help="Compute only this row, and print its lines as JSON.")
@click.option("--plot", "picture", metavar="FILE", help="Also draw the verdicts over the parameters that vary (.png, .svg, .pdf, ...).")
@click.option("--axes", metavar="A,B", help="The one or two parameters on the axes of the picture, if more than two vary.")
def campaign(
    campaign_file: str,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    out: str | None,
    routine: str | None,
    row: int | None,
    picture: str | None,
    axes: str | None,
) -> int:
    """Verify many laws and parameter sets, as listed in CAMPAIGN.

    CAMPAIGN is a TOML file. Each of its rows is one law with one parameter set. The table has one line per row and claim. CAMPAIGN may
    also ask for increments, for the checks of a routine, or for stress cases.

    duhem reports a wrong name of a law, a missing file, and an error in a law with grid, draw or table before it starts. Any other row
    that cannot be read, crashes, hangs or needs too much memory is written to the table with the reason, and the other rows are not
    affected. Except for the seconds, the table does not depend on the number of workers. --scheduler uses a Dask cluster (extra
    cluster), for example one that dask-jobqueue starts under SLURM. Its workers must see the files of the campaign.

    A campaign that is interrupted (Ctrl-C, SIGTERM) or killed keeps its results beside the table, and --resume continues from there.
    With --plot, CAMPAIGN may be a finished table; duhem then draws it and computes nothing.

    Exit codes: 1 if a claim is refuted, a check failed, or an increment is flagged or wrong; 4 if a row has an error. 4 takes
    precedence.
    """
    from duhem import screening
    from duhem.api.increments import project
    from duhem.expression.syntax import spelled
    from duhem.screening import file, plane
    from duhem.screening.table import finished_csv
    from duhem.show import figure
    from duhem.show.place import check_place, check_places
    from duhem.show.printing import text

    if axes is not None and picture is None:
        raise InputError("--axes needs the name of a picture", where=f"--axes {axes}", remedy="add for example --plot plane.png")
    over = None if axes is None else [spelled(name.strip()) for name in axes.split(",")]
    if picture is not None:
        figure.check(picture)
    if campaign_file.endswith((".csv", ".parquet")):
        if picture is None or workers is not None or scheduler is not None or resume or out is not None or row is not None or routine:
            raise InputError(
                "the file is a finished table, which duhem can only draw",
                where=campaign_file,
                remedy="add --plot FILE, and use no other option than --axes",
            )
        check_place(picture, [campaign_file])
        plane.plot_table(campaign_file, picture, over)
        say(picture)
        return HELD
    if routine is not None:
        click.get_current_context().with_resource(modules_beside_the_user(routine))
    asked = file.read(campaign_file, project=project, routine=routine, checks=_checks, stress=_stress)
    if row is not None:
        if scheduler is not None or resume or out is not None or picture is not None:
            raise InputError(
                "--row prints the lines of one row and takes no other option", where="--row", remedy="remove the other options"
            )
        return _alone(asked, row)
    table = asked.out if out is None else out  # an empty name is refused, not taken for none
    if table is None:
        raise InputError("the name of the table is missing", where=campaign_file, remedy='write out = "table.csv" in [campaign], or --out')
    if picture is not None:
        check_places([table, picture], asked.inputs)
        plane.check(asked, over)
    if resume and finished_csv(table):
        aside(f"{table} is finished, but a CSV table does not store its campaign: duhem computes all rows again")
    with Progress("starting") as progress:
        began, first = monotonic(), -1

        def on_row(done: int, rows: int) -> None:
            nonlocal first
            first = done - 1 if first < 0 else first
            rate = (done - first) / max(monotonic() - began, 1e-9)
            progress.often(lambda: f"{done} of {rows} rows, {rate:.1f} a second, {_duration((rows - done) / rate)} left")

        def on_start(dashboard: str) -> None:
            progress.show("")
            aside(f"the cluster's dashboard is {dashboard}")

        try:
            summary = screening.campaign(
                asked, out=table, workers=workers, scheduler=scheduler, resume=resume, on_row=on_row, on_start=on_start
            )
        except screening.StoppedCampaign as stop:
            progress.show("")
            aside(stop)
            return INTERRUPTED
    say(text(summary, page()))
    wrote(f"the table of {len(asked)} rows", table)
    deliver("the picture", picture, partial(summary.plot, axes=over))
    return FAILED if summary.errors else REFUTED if summary.refuted else HELD


def _checks(routine: str, **options: Any) -> RoutineChecks:
    from duhem.testing import RoutineChecks

    return RoutineChecks(routine, **options)


def _stress(**options: Any) -> StressCases:
    from duhem.benchmark.extreme_cases import StressCases

    return StressCases(**options)


def _alone(asked: Campaign, row: int) -> int:
    from duhem.screening.campaign import lines_of
    from duhem.screening.pool import Pool
    from duhem.screening.summary import AGAINST

    if row > len(asked):
        raise InputError(f"there is no row {row} among {len(asked)}", where=f"--row {row}", remedy="give the number of one of them")
    with Pool(asked, 1) as pool:
        lines = [line for text in pool.texts([range(row, row + 1)]) for line in lines_of(text)]
    say(as_json([line._asdict() for line in lines]))
    return FAILED if lines[0].error else REFUTED if any(line.verdict in AGAINST for line in lines) else HELD


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
