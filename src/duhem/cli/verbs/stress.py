"""``duhem stress``: stiff and extreme cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import check_names, flagship_argument, json_option, peers_option, read_subject, settings_option, stiffness_option
from duhem.cli.output import Progress, carry_out

if TYPE_CHECKING:
    from duhem.benchmark.extreme_cases import ExtremeCases

__all__ = ["stress"]


@click.command()
@flagship_argument
@settings_option
@click.option("--axis", "axes", metavar="NAME", multiple=True, help="Test only this kind of difficulty, for example load. Repeatable.")
@stiffness_option
@peers_option
@json_option
@click.option(
    "--plot", metavar="FILE", help="Draw the number of accurate digits over the difficulty, for each method (.png, .pdf, .svg, ...)."
)
def stress(
    law: str, settings: Sequence[str], axes: Sequence[str], stiffness: str | None, peers: bool, json_file: str | None, plot: str | None
) -> int:
    """Test every method for LAW on stiff and extreme increments.

    The default law is antoni2007. From case to case, the difficulty grows by powers of ten. duhem compares each answer with a
    reference in fifty digits. It tells which answers are finite and in K, how many digits of them are accurate, and which of them the
    method flags. An answer with fewer than 6 accurate digits and no flag is counted as silently wrong. Each method must also reject
    input that is not finite. Every parameter needs a value (--set); the default values of antoni2007 are those of Figure 5 of the paper.

    Exit codes: 0 measured, whatever the results are; 2 usage or file error; 4 no method gave an answer; 130 interrupted, after printing
    the results so far.
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
