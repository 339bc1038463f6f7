"""``duhem stress``: stiff and extreme cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import check_names, settings_option
from duhem.cli.output import Progress
from duhem.cli.study import carry_out, flagship_argument, json_option, peers_option, read_subject, stiffness_option

if TYPE_CHECKING:
    from duhem.benchmark.extreme_cases import ExtremeCases

__all__ = ["stress"]


@click.command()
@flagship_argument
@settings_option
@click.option("--axis", "axes", metavar="NAME", multiple=True, help="Only this axis of difficulty, for example load. Repeatable.")
@stiffness_option
@peers_option
@json_option
@click.option("--plot", metavar="FILE", help="Draw accurate digits over decades for each axis and method (.png, .pdf, .svg, ...).")
def stress(
    law: str, settings: Sequence[str], axes: Sequence[str], stiffness: str | None, peers: bool, json_file: str | None, plot: str | None
) -> int:
    """Try every method that applies to LAW (left out: antoni2007) on stiff and extreme increments, decade by decade.

    Each answer is judged against a reference in fifty digits: finite, in K, how many digits are accurate, and whether the
    method flags it.  Silently wrong is what has fewer than 6 digits and no flag.  Input that is not finite has to be
    refused.  Every parameter needs a value (--set); those of antoni2007 default to Figure 5 of the paper.

    Exit codes: 0 measured, whatever was found; 2 usage or file error; 4 no method gave an answer; 130 interrupted, after
    printing what was done.
    """
    from duhem.benchmark import extreme_cases

    check_names("axis", axes, extreme_cases.AXES, "axes are", "--axis")
    fixed, diagonal = read_subject(law, settings, stiffness)

    def measure(progress: Progress) -> ExtremeCases:
        return extreme_cases.stress(
            fixed,
            axes=tuple(axes) or tuple(extreme_cases.AXES),
            stiffness=diagonal,
            peers=peers,
            on_row=lambda row: progress.show(f"{row.axis} {row.label}: {row.method}"),
        )

    return carry_out(measure, json_file, plot, [law])
