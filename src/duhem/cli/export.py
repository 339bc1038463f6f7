"""``duhem export``: a law's increment as source for other programs."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import law_argument, read_fixed_formula, settings_option
from duhem.cli.output import HELD, Progress, say, wrote

__all__ = ["export"]


@click.command()
@law_argument
@settings_option
@click.option(
    "--to", "language", type=click.Choice(["c", "fortran"]), required=True, help="The increment in C, or what calls it in Fortran."
)
@click.option("--out", metavar="FILE", help="Write it there; left out, to standard output.")
def export(law: str, settings: Sequence[str], language: str, out: str | None) -> int:
    """Write the slip increment of LAW and its consistent tangent as source.

    C: one C99 file that needs nothing but the mathematical library; parameters that --set leaves open are arguments.  Fortran: a
    module with the interface (bind(C)) and a subroutine with the arguments of Abaqus' FRIC for a law with a pressure, else of UMAT,
    to be linked with the C file.  LAW is verified first, and the head of the file has the verdicts.  A law whose K is not proved to
    be convex is refused.  A point that the routine does not solve has a status that says so, never an answer.
    """
    from duhem.show.place import check_place, write

    fixed = read_fixed_formula(law, settings)
    if out is not None:
        check_place(out, [law])

    from duhem.export.c_file import c_file
    from duhem.export.fortran_file import fortran_file
    from duhem.export.routine import routine
    from duhem.proof.verification import verify

    routine(fixed)  # what has none is not verified first
    with Progress() as progress:
        done = verify(fixed, on_claim=lambda result: progress.show(f"{result.claim} {result.verdict}"), on_method=progress.tries)
    text = {"c": c_file, "fortran": fortran_file}[language](done)
    if out is None:
        say(text.removesuffix("\n"))
    else:
        write(out, text)
        wrote("the source", out)
    return HELD
