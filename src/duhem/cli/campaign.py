"""``duhem campaign``: many laws at once."""

from __future__ import annotations

import json
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from duhem.cli.arguments import modules_beside_the_user
from duhem.cli.output import FAILED, HELD, INTERRUPTED, REFUTED, Progress, page, say, wrote

if TYPE_CHECKING:
    from duhem.benchmark.extreme_cases import StressCases
    from duhem.screening.campaign import Campaign
    from duhem.testing import RoutineChecks

__all__ = ["campaign"]


@click.command()
@click.argument("campaign_file", metavar="CAMPAIGN", type=click.Path(dir_okay=False))
@click.option("--workers", metavar="N", type=click.IntRange(min=1), help="Processes that ask rows; left out, one a core.")
@click.option("--scheduler", metavar="ADDRESS", help="The scheduler of a Dask cluster, by address or by the file that it wrote.")
@click.option(
    "--resume",
    is_flag=True,
    help="Go on with a campaign that was stopped; a finished table in Parquet stays, one in CSV is asked anew.",
)
@click.option("--out", metavar="FILE", help="Write the table as .csv or .parquet; left out, the one that the campaign names.")
@click.option("--routine", metavar="MODULE:CALLABLE", help="The routine whose checks CAMPAIGN asks, as of duhem test; no file names it.")
@click.option("--row", metavar="N", type=click.IntRange(min=1), help="Ask this row alone, and print its lines as JSON.")
@click.option("--plot", "picture", metavar="FILE", help="Also draw verdicts over the parameters that vary: .png, .svg, .pdf, ...")
@click.option("--axes", metavar="A,B", help="One or two parameters to draw over, where more of them vary.")
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
    """Ask every row of CAMPAIGN, a TOML file: laws times parameter sets, one line of the table a row and claim.

    A name that is no law, a file that is not there and a fault in the file of a law with grid, draw or table are told before anything is
    asked.  Any other row whose law cannot be read, or that crashes, hangs or asks for too much memory, is a row with its reason and harms
    no other.
    The table is the same from any number of workers, but for the seconds; --scheduler asks a Dask cluster (extra cluster), of SLURM for
    example through dask-jobqueue, whose workers see the files that the campaign names.  A campaign that is interrupted (Ctrl-C, SIGTERM) or
    killed keeps what is done beside the table, and --resume goes on from there.  With --plot CAMPAIGN may be a finished table, which is
    drawn and not asked again.

    Exit codes: 1 where a claim is refuted, a check failed or an increment flagged or wrong, 4 where a row has an error instead, which
    comes first.
    """
    from duhem.errors import InputError
    from duhem.expression.spelling import spelled
    from duhem.screening import entry, file, plane
    from duhem.screening.table import finished_csv
    from duhem.show import figure
    from duhem.show.place import check_place, check_places
    from duhem.show.printing import text
    from duhem.vouched.increments import project

    if axes is not None and picture is None:
        raise InputError("there is no picture for these axes", where=f"--axes {axes}", remedy="name it: --plot plane.png")
    over = None if axes is None else [spelled(name.strip()) for name in axes.split(",")]
    if picture is not None:
        figure.check(picture)
    if campaign_file.endswith((".csv", ".parquet")):
        if picture is None or workers is not None or scheduler is not None or resume or out is not None or row is not None or routine:
            raise InputError("a finished table is drawn, not asked", where=campaign_file, remedy="give --plot FILE, and at most --axes")
        check_place(picture, [campaign_file])
        plane.plot_table(campaign_file, picture, over)
        say(picture)
        return HELD
    if routine is not None:
        click.get_current_context().with_resource(modules_beside_the_user(routine))
    asked = file.read(campaign_file, project=project, routine=routine, checks=_checks, stress=_stress)
    if row is not None:
        if scheduler is not None or resume or out is not None or picture is not None:
            raise InputError("one row is asked here, and its lines are printed", where="--row", remedy="leave the other options out")
        return _alone(asked, row)
    table = asked.out if out is None else out  # an empty name is refused, not taken for none
    if table is None:
        raise InputError("there is no place for the table", where=campaign_file, remedy='write out = "table.csv" in [campaign], or --out')
    if picture is not None:
        check_places([table, picture], asked.inputs)
        plane.check(asked, over)
    if resume and finished_csv(table):
        click.echo(f"duhem: {table} is finished, and CSV says not what was asked of it: every row is asked anew", err=True)
    with Progress("starting") as progress:
        began, last, first = monotonic(), 0.0, -1

        def on_row(done: int, rows: int) -> None:
            nonlocal last, first
            now = monotonic()
            first = done - 1 if first < 0 else first
            if now - last > 0.2:
                last = now
                rate = (done - first) / max(now - began, 1e-9)
                progress.show(f"{done} of {rows} rows, {rate:.1f} a second, {_duration((rows - done) / rate)} left")

        def on_start(dashboard: str) -> None:
            progress.show("")
            click.echo(f"duhem: the cluster's dashboard is {dashboard}", err=True)

        try:
            summary = entry.campaign(
                asked, out=table, workers=workers, scheduler=scheduler, resume=resume, on_row=on_row, on_start=on_start
            )
        except entry.StoppedCampaign as stop:
            progress.show("")
            click.echo(f"duhem: {stop}", err=True)
            return INTERRUPTED
    say(text(summary, page()))
    if picture is not None:
        summary.plot(picture, axes=over)
    wrote(f"the table of {len(asked)} rows", table)
    wrote("the picture", picture)
    return FAILED if summary.errors else REFUTED if summary.refuted else HELD


def _checks(routine: str, **options: Any) -> RoutineChecks:
    from duhem.testing import RoutineChecks

    return RoutineChecks(routine, **options)


def _stress(**options: Any) -> StressCases:
    from duhem.benchmark.extreme_cases import StressCases

    return StressCases(**options)


def _alone(asked: Campaign, row: int) -> int:
    from duhem.errors import InputError
    from duhem.screening.campaign import lines_of
    from duhem.screening.pool import Pool
    from duhem.screening.summary import AGAINST

    if row > len(asked):
        raise InputError(f"there is no row {row} among {len(asked)}", where=f"--row {row}", remedy="give the number of one of them")
    with Pool(asked, 1) as pool:
        lines = [line for text in pool.texts([range(row, row + 1)]) for line in lines_of(text)]
    say(json.dumps([line._asdict() for line in lines], indent=2, ensure_ascii=False))
    return FAILED if lines[0].error else REFUTED if any(line.verdict in AGAINST for line in lines) else HELD


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
