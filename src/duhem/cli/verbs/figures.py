"""``duhem figures``: the figures of the source paper, computed from the model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import indent
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import format_option, read_number, read_pair
from duhem.cli.output import HELD, endless_page, say
from duhem.errors import InputError
from duhem.show.page import tied
from duhem.show.place import check_place, write

if TYPE_CHECKING:
    from duhem.micromodel.figures import Recipe

__all__ = ["figures"]


@click.command()
@click.argument("names", nargs=-1, metavar="[NAMES]...")
@click.option(
    "--out",
    "folder",
    metavar="DIR",
    default="figures",
    show_default=True,
    help="The folder for the files. It is created if it does not exist.",
)
@click.option("--set", "settings", metavar="NAME=VALUE", multiple=True, help="Change a parameter of the figures. Repeatable.")
@format_option("png", "pdf", "svg", says="The form of the pictures.")
@click.option("--data", is_flag=True, help="Write the numbers as CSV instead of pictures.")
@click.option("--list", "listing", is_flag=True, help="Only list the figures with their parameters.")
def figures(names: Sequence[str], folder: str, settings: Sequence[str], form: str, data: bool, listing: bool) -> int:
    """Compute the figures of the source paper.

    NAMES are 1, 2, 3, 4, 5, 6, 7, 8, 9 and oblique. Without NAMES, duhem computes all of them. Each figure is computed from the model
    and written as figure-NAME, and its main numbers are printed. Figure 8 is a table: duhem prints it and writes it as CSV.
    """
    from duhem.micromodel.figures import FIGURES, Figure, Table, unknown

    for name in names:
        if name not in FIGURES:
            raise unknown("figure", name, FIGURES)
    chosen = [FIGURES[name] for name in dict.fromkeys(names or FIGURES)]
    page = endless_page()
    if listing:
        below = " " * 9
        for recipe in chosen:
            parameters = ", ".join(tied(f"{name} = {default:g}") for name, default in recipe.parameters.items())
            say("\n".join([*page.hanging(recipe.title, f"{recipe.name:<8} ", below), *page.hanging(parameters, below, below)]))
        return HELD
    values = _read(settings, chosen)
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise InputError(f"the folder cannot be made: {fault.strerror}", where=folder, remedy="name another with --out") from None
    files = {recipe: target / f"figure-{recipe.name}.{form if recipe.drawn and not data else 'csv'}" for recipe in chosen}
    for recipe, file in files.items():
        check_place(file)
        if recipe.drawn and not data:
            from duhem.show.figure import check

            check(file)
    for recipe, file in files.items():
        figure = recipe(**{name: value for name, value in values.items() if name in recipe.parameters})
        if isinstance(figure, Figure) and not data:
            from duhem.micromodel.figures.value import save

            save(figure, file)
        else:
            write(file, figure.to_csv())
        say("\n".join(page.hanging(f"{file}  {figure.title}")))
        if isinstance(figure, Table):
            say(indent(figure.to_text(page.width and page.width - 2), "  "))
        for fact in figure.facts:
            say("\n".join(page.item(str(fact))))
    return HELD


def _read(settings: Sequence[str], chosen: Sequence[Recipe]) -> dict[str, float]:
    """The settings as numbers; each has to be a parameter of one of the figures at least."""
    from duhem.micromodel.figures import unknown

    known = {name: default for recipe in chosen for name, default in recipe.parameters.items()}
    values: dict[str, float] = {}
    for setting in settings:
        name, value = read_pair(setting, f"--set {setting}", "NAME=VALUE", "--set mu=0.24")
        if name not in known:
            raise unknown(f"parameter of figure {', '.join(recipe.name for recipe in chosen)}", name, known)
        if name in values:
            raise InputError(f"{name} is set twice", where=f"--set {setting}", remedy="set it once")
        values[name] = read_number(value, f"--set {setting}")
    return values
