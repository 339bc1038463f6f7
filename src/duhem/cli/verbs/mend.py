"""``duhem mend``: the nearest admissible law of a law whose K is not convex."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import choice_option, format_option, law_argument, modules_beside_the_user, read_settings, settings_option
from duhem.cli.output import HELD, UNDECIDED, Progress, as_json, check_outputs, deliver, page, say

__all__ = ["mend"]


@click.command()
@law_argument
@settings_option
@choice_option(
    "--by",
    of=["auto", "parameters", "hull", "harmonics", "coefficients"],
    says="How to mend the law. auto tries all ways, and takes the result whose largest change of the limit load is least.",
)
@click.option("--harmonics", type=click.IntRange(1, 16), default=8, show_default=True, help="Number of harmonics of the gauge.")
@click.option("--out", metavar="FILE", help="Write the mended law to this criterion file.")
@click.option("--plot", metavar="FILE", help="Draw the boundary of K of both laws (.png, .pdf, .svg, ...).")
@format_option("text", "json", says="For people or for programs.")
@click.option("--strict", is_flag=True, help="End with exit code 3 if the result is not proved admissible.")
def mend(law: str, settings: Sequence[str], by: str, harmonics: int, out: str | None, plot: str | None, form: str, strict: bool) -> int:
    """Find the nearest admissible law of LAW, if K of LAW is not convex.

    Four ways exist. parameters: the nearest value of a parameter for which K is convex. hull: the convex hull of K. harmonics: the
    nearest gauge with a few harmonics of the angle. coefficients: the nearest polynomial that is convex by sums of squares. hull and
    harmonics are for laws of two forces.

    duhem verifies the result, and prints by how much the limit load changes: in the mean over all directions of force, and at most, both
    divided by the mean limit load. Each parameter on which the shape of K depends must have a value; give it with --set.
    """
    from duhem.regions.mending import mend as mended
    from duhem.show.printing import text

    check_outputs(plot, [out], [law])
    with modules_beside_the_user(law), Progress("mending"):
        done = mended(law, by, read_settings(settings), harmonics=harmonics)
    say(text(done, page()) if form == "text" else as_json(done.to_dict(out)))
    deliver("the mended law", out, done.to_toml)
    deliver("the picture", plot, done.plot)
    return UNDECIDED if strict and not done.admissible else HELD
