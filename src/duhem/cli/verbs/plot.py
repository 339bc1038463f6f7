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
@click.option(
    "--pressure", metavar="P", help="The pressure sigma_n <= 0 of the sections (default -1). For a stress tensor: the mean stress."
)
@click.option(
    "--plane",
    "planes",
    metavar="A,B",
    multiple=True,
    help="The plane of a section: two forces, or the pressure and a force, or deviatoric, meridian, all. Repeatable.",
)
@click.option("--trial", metavar="STRESS", help="Draw one increment from this trial stress (one number per force).")
@click.option(
    "--stiffness", metavar="K", default="1", show_default=True, help="Stiffness of the increment: one number, or one number per force."
)
@click.option("--witness", is_flag=True, help="Verify the law, and draw the counterexample of each refuted claim.")
@click.option(
    "--unit",
    metavar="UNIT",
    default="",
    help="The unit of the stresses, as text for the axes. If it is Pa, duhem chooses a prefix such as M.",
)
@click.option("--to", "file", metavar="FILE", help="The picture to write: .png, .svg, .pdf, ... (default: NAME.png in the working folder).")
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
    """Draw K, the set of admissible stresses, of LAW.

    The picture shows sections of K with the boundary, its normals, its seams (lines where the formula of g changes), and the slip
    directions that are not normal.

    If LAW has more than two forces, each section shows two of them. A stress tensor is shown in the deviatoric plane and in a meridian
    plane. A law with a pressure is shown at one pressure and along the pressure axis. If a parameter has no value, duhem takes a simple
    number from its domain, and the title shows this number.
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
