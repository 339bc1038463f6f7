"""``duhem region``: for which values of one or several parameters a claim holds."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import format_option, law_argument, modules_beside_the_user, read_law, read_pair, read_settings, settings_option
from duhem.cli.output import HELD, INTERRUPTED, UNDECIDED, Progress, as_json, check_outputs, deliver, page, say
from duhem.errors import InputError

__all__ = ["region"]


@click.command()
@law_argument
@click.argument("parameters", nargs=-1, metavar="[PARAMETER]...")
@click.option("--claim", default="convexity", show_default=True, help="The claim that is asked for (duhem explain lists them).")
@click.option(
    "--over",
    metavar="NAME=LOW:HIGH",
    multiple=True,
    help="Ask over this range instead of the value or the range in the law, for example K=0.5:1 or c=0: without an upper end. Repeatable.",
)
@settings_option
@format_option("text", "json", "latex", says="For people, for programs, or the condition as a formula.")
@click.option("--plot", metavar="FILE", help="Draw where the claim holds, fails and is open (.png, .pdf, .svg, ...).")
@click.option("--certificate", metavar="FILE", help="Also write what the kernel confirmed to this JSON file, for duhem recheck.")
@click.option("--steps", type=click.IntRange(1), help="How many steps of the kernel to spend at most, each some microsecond.")
@click.option("--resume", metavar="FILE", help="Go on from the certificate of a region of several parameters.")
@click.option("--strict", is_flag=True, help="End with exit code 3 if a part of the domain is open.")
def region(
    law: str,
    parameters: Sequence[str],
    claim: str,
    over: Sequence[str],
    settings: Sequence[str],
    form: str,
    plot: str | None,
    certificate: str | None,
    steps: int | None,
    resume: str | None,
    strict: bool,
) -> int:
    """Find the exact set of values of PARAMETER, or of several, for which a claim about LAW holds.

    The domain of the parameters is divided into cells. On each cell, the kernel confirms a proof of the claim, or a family of
    counterexamples: one for each value of the parameters. What is neither is open, and duhem says which share of the domain that is.

    PARAMETER may be left out if at most three parameters of the law are free and no mere scales, or if g is quadratic in the forces (or
    the root of such a form) and the signs of its minors depend on at most three. The other parameters are all that they may be; --set
    fixes one of them. If you interrupt the search for a region of several parameters, duhem prints what is known so far;
    --resume goes on from its certificate.
    """
    from duhem import regions
    from duhem.show.printing import latex, text

    check_outputs(plot, [certificate], [law])
    ranges = dict(read_pair(one, f"--over {one}", "NAME=LOW:HIGH", "--over K=0.5:1") for one in over)
    if clash := sorted({*ranges} & {*read_settings(settings)}):
        raise InputError(f"{clash[0]} is both set and given a range", where=f"--over {clash[0]}", remedy="remove one of them")
    with modules_beside_the_user(law), Progress("deciding"):
        fixed = read_law(law).fix(read_settings(settings))
        found = regions.region(fixed, parameters or None, claim, ranges, steps=steps or regions.MOST_STEPS, resume=resume)
    if form == "text":
        say(text(found, page()))
    else:
        say(latex(found) if form == "latex" else as_json(found.to_dict()))
    deliver("the picture", plot, found.plot)
    deliver("the certificate", certificate, found.certificate)
    if isinstance(found, regions.PavedRegion) and found.stopped:
        return INTERRUPTED
    return UNDECIDED if strict and not found.exact else HELD
