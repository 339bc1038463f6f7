"""``duhem identify``: the admissible law that fits measured limit points best."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import complete_law, convex_option, format_option, read_fixed_formula, settings_option
from duhem.cli.output import HELD, Progress, as_json, aside, check_outputs, deliver, page, say

__all__ = ["identify"]


@click.command()
@click.argument("points", type=click.Path(dir_okay=False))
@click.option(
    "--law",
    default="antoni2007",
    show_default=True,
    shell_complete=complete_law,
    help="The law whose parameters are fitted: a name, a criterion file, or module:attribute.",
)
@settings_option
@click.option("--robust", is_flag=True, help="Minimise Huber's loss instead of the sum of squares. Outliers hardly change this fit.")
@convex_option("ask: reject a fit whose K is not convex; require: also reject a fit whose K is not proved convex; assume: reject none.")
@click.option("--inside", is_flag=True, help="Keep the parameter that shapes K where K is proved convex (see duhem region).")
@click.option(
    "--bootstrap",
    type=click.IntRange(0),
    default=0,
    metavar="N",
    help="Number of bootstrap samples for percentile intervals (default 0: intervals from the covariance).",
)
@click.option("--seed", type=click.IntRange(0), default=0, metavar="S", show_default=True, help="Seed of the bootstrap samples.")
@click.option("--out", metavar="FILE", help="Write the fitted law to this criterion file.")
@click.option("--plot", metavar="FILE", help="Draw the criterion, the points and the outliers (.png, .pdf, .svg, ...).")
@format_option("text", "json", says="For people or for programs.")
def identify(
    points: str,
    law: str,
    settings: Sequence[str],
    robust: bool,
    convex: str,
    inside: bool,
    bootstrap: int,
    seed: int,
    out: str | None,
    plot: str | None,
    form: str,
) -> int:
    """Fit a law to the limit points in POINTS, a CSV file.

    A limit point is a measured stress at which slip begins. duhem then tries to prove that the fitted law is admissible.

    Columns: the forces and the pressure of the law (sigma_a, sigma_b, sigma_n; sigma_n < 0 in compression), all in the same unit. You
    may add weight (proportional to 1/scatter^2) or scatter (standard deviation of each force).
    """
    from duhem import identification
    from duhem.identification.result import check
    from duhem.show.printing import text

    family = read_fixed_formula(law, settings)
    check_outputs(plot, [out], [points, law])
    if plot is not None:
        check(family)
    if inside:
        from duhem.regions.mending.by_parameters import within_region

        with Progress("looking for the region"):
            whole, family = family, within_region(family)
        for name, own in family.parameters.items():
            if own != whole.parameters[name]:
                aside(f"only {own.stated(name)} is tried, where K is proved convex")
    with Progress("identifying"):
        done = identification.identify(points, family, robust=robust, bootstrap=bootstrap, seed=seed, convex=convex)
    say(text(done, page()) if form == "text" else as_json(done.to_dict()))
    deliver("the fitted law", out, done.to_toml)
    deliver("the picture", plot, done.plot)
    return HELD
