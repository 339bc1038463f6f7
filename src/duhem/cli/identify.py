"""``duhem identify``: the admissible law that fits measured limit points best."""

from __future__ import annotations

import json
from collections.abc import Sequence

import click

from duhem.cli.arguments import complete_law, convex_option, format_option, read_fixed_formula, settings_option
from duhem.cli.output import HELD, Progress, page, say, wrote
from duhem.show.place import check_places

__all__ = ["identify"]


@click.command()
@click.argument("points", type=click.Path(dir_okay=False))
@click.option(
    "--law",
    default="antoni2007",
    show_default=True,
    shell_complete=complete_law,
    help="The family to fit: a name, a criterion file, or module:attribute.",
)
@settings_option
@click.option("--robust", is_flag=True, help="Minimise Huber's loss, which outliers hardly move, in place of squares.")
@convex_option("Refuse a fit refuted to be convex, one not proved to be, or none.")
@click.option("--bootstrap", type=click.IntRange(0), default=0, metavar="N", help="Draws for percentile intervals; 0: from the covariance.")
@click.option("--seed", type=click.IntRange(0), default=0, metavar="S", show_default=True, help="Seed of the bootstrap.")
@click.option("--out", metavar="FILE", help="Write the fitted law as a criterion file for duhem verify.")
@click.option("--plot", metavar="FILE", help="Draw criterion, points and outliers (.png, .pdf, .svg, ...).")
@format_option("text", "json", says="For people or for programs.")
def identify(
    points: str,
    law: str,
    settings: Sequence[str],
    robust: bool,
    convex: str,
    bootstrap: int,
    seed: int,
    out: str | None,
    plot: str | None,
    form: str,
) -> int:
    """Fit a law to the limit points in POINTS, a CSV file, and prove the fitted law admissible.

    Columns: the law's forces and pressure (sigma_a, sigma_b, sigma_n; sigma_n < 0 in compression), one unit for all, and
    either weight (proportional to 1/scatter^2) or scatter (standard deviation of each force).
    """
    from duhem import identification
    from duhem.show.printing import text

    family = read_fixed_formula(law, settings)
    check_places([out, plot], [points, law])
    if plot is not None:
        from duhem.show import figure

        figure.check(plot)
        identification.printing.check(family)
    with Progress("identifying"):
        done = identification.identify(points, family, robust=robust, bootstrap=bootstrap, seed=seed, convex=convex)
    if out is not None:
        done.to_toml(out)
    say(text(done, page()) if form == "text" else json.dumps(done.to_dict(), indent=2, ensure_ascii=False))
    if plot is not None:
        done.plot(plot)
    wrote("the fitted law", out)
    wrote("the picture", plot)
    return HELD
