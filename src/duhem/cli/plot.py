"""``duhem plot``: what K of a law looks like."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import Vectors, law_argument, read_law, read_number, read_numbers, read_settings, settings_option
from duhem.cli.output import HELD, say

__all__ = ["plot"]


@click.command(cls=Vectors)
@law_argument
@settings_option
@click.option("--pressure", metavar="P", help="sigma_n <= 0 of the sections; -1 if left out. For a stress tensor: the mean stress.")
@click.option(
    "--plane",
    "planes",
    metavar="A,B",
    multiple=True,
    help="Two forces, or the pressure and a force; deviatoric, meridian, all. Repeatable.",
)
@click.option("--trial", metavar="STRESS", help="Draw one increment from this trial stress, a number per force.")
@click.option("--stiffness", metavar="K", default="1", show_default=True, help="Of the increment: one number, or one per force.")
@click.option("--witness", is_flag=True, help="Verify the law, and draw the witness of each claim that is refuted.")
@click.option("--unit", metavar="UNIT", default="", help="Any text, written as the unit of stresses; Pa is given the prefix that suits.")
@click.option("--to", "file", metavar="FILE", help="Where to (.png, .svg, .pdf, ...); left out, NAME.png in the working folder.")
def plot(
    law: str,
    settings: Sequence[str],
    pressure: str | None,
    planes: Sequence[str],
    trial: str | None,
    stiffness: str,
    witness: bool,
    unit: str,
    file: str | None,
) -> int:
    """Draw K of LAW: sections with boundary, normals, seams, and slips that are not normal.

    A law of more than two forces is cut by pairs of its axes, one of a stress tensor by the deviatoric plane and a meridian, one with
    a pressure at one pressure and along it.  A parameter that is left open gets a plain number of its domain: the title says which.
    """
    import re

    from duhem.show.figure import check
    from duhem.show.place import check_place

    chosen = read_law(law)
    place = file or f"{re.sub(r'[^A-Za-z0-9_-]+', '-', chosen.name)[:80].strip('-') or 'law'}.png"
    check(place)
    check_place(place, [law])
    values = read_settings(settings, chosen)
    rows = read_numbers(stiffness, "--stiffness")
    from duhem.portrait import plot as drawn

    remarks: list[str] = []
    drawn(
        chosen,
        place,
        parameters=values,
        pressure=None if pressure is None else read_number(pressure, "--pressure"),
        planes=planes,
        trial=None if trial is None else read_numbers(trial, "--trial"),
        stiffness=rows if len(rows) > 1 else rows[0],
        witness=witness,
        unit=unit,
        on_remark=remarks.append,
    )
    say("\n".join([place, *remarks]))
    return HELD
