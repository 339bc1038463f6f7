"""``duhem export``: a law's increment as C or Fortran source, with the verdicts on the law in its head."""

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
    "--to", "language", type=click.Choice(["c", "fortran"]), required=True, help="c: the C file; fortran: the Fortran file that calls it."
)
@click.option("--out", metavar="FILE", help="The file to write (default: standard output).")
def export(law: str, settings: Sequence[str], language: str, out: str | None) -> int:
    """Write the slip increment of LAW as C or Fortran code.

    The code also contains the consistent tangent. C: one C99 file that needs only the mathematical library. A parameter without --set
    becomes an argument. Fortran: a module with the interface (bind(C)), and a subroutine with the arguments of FRIC of Abaqus if the
    law has a pressure, otherwise of UMAT. Link it with the C file. If the state of the law moves with the slip, the code computes one
    implicit step, and its caller keeps the variables (STATEV in UMAT).

    duhem verifies LAW first and writes the verdicts into the head of the file. It rejects a law if it cannot prove that K is convex. If
    the routine cannot solve an increment, it returns a status and no answer.
    """
    from duhem.show.place import check_place, write

    fixed = read_fixed_formula(law, settings)
    if out is not None:
        check_place(out, [law])

    from duhem.export.source_files import c_file, c_functions_of, fortran_file
    from duhem.proof.verification import verify

    c_functions_of(fixed)  # what has none is not verified first
    with Progress() as progress:
        done = verify(fixed, on_claim=lambda result: progress.show(f"{result.claim} {result.verdict}"), on_method=progress.tries)
    text = {"c": c_file, "fortran": fortran_file}[language](done)
    if out is None:
        say(text.removesuffix("\n"))
    else:
        write(out, text)
        wrote("the source", out)
    return HELD
