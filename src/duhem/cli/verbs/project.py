"""``duhem project``: one slip increment."""

from __future__ import annotations

from collections.abc import Sequence

import click

from duhem.cli.arguments import (
    Vectors,
    choice_option,
    convex_option,
    format_option,
    law_argument,
    read_fixed_formula,
    read_number,
    read_numbers,
    settings_option,
)
from duhem.cli.output import FAILED, HELD, page, say
from duhem.errors import InputError
from duhem.projection.methods import METHODS

__all__ = ["project"]


@click.command(cls=Vectors)
@law_argument
@settings_option
@click.option(
    "--trial",
    metavar="A B ...",
    required=True,
    help="Trial stress, one number per force: the stress without further slip, k (u - u_in), with the displacement u and the slip u_in"
    " so far.",
)
@click.option("--pressure", metavar="N", help="Pressure (normal stress) sigma_n <= 0 in compression.")
@click.option(
    "--stiffness", metavar="K ...", default="1", show_default=True, help="One number, one number per force, or the matrix row by row."
)
@choice_option("--method", of=["auto", *METHODS], says="The method of solution.")
@convex_option("ask: look for a proof that K is convex; require: reject the law without such a proof; assume: do not look for one.")
@click.option("--tangent", is_flag=True, help="Add the consistent tangents (derivatives of the new stress).")
@format_option("text", "json", says="For people or for programs.")
def project(
    law: str, settings: Sequence[str], trial: str, pressure: str | None, stiffness: str, method: str, convex: str, tangent: bool, form: str
) -> int:
    """Compute one slip increment of LAW.

    K is the set of admissible stresses. The new stress is the point of K that is closest to the trial stress. The output shows the
    stress, the slip, the multiplier, and the residuals of the optimality conditions, which duhem recomputes from the formula of the
    law.

    The status is stick or slip if the answer is sound. Every other status ends with exit code 4: inaccurate or failed (the residuals
    are too large, or a closer point of K was found), stationary (K is not known to be convex, so a closer point may exist), outside
    (the stress leaves a range of forces that LAW declares).
    """
    from duhem.law.parameter_domain import check_fixed
    from duhem.law.state import frozen
    from duhem.projection.increment import check_associated

    fixed = read_fixed_formula(law, settings)
    check_associated(fixed)
    fixed = frozen(fixed)
    check_fixed(fixed)
    if fixed.pressure is not None and pressure is None:
        raise InputError(f"{fixed.name} needs the pressure {fixed.pressure}", where="--pressure", remedy="give it, <= 0 in compression")
    target, rows = read_numbers(trial, "--trial"), read_numbers(stiffness, "--stiffness")
    load = None if pressure is None else read_number(pressure, "--pressure")

    from duhem.api.increments import project as closest
    from duhem.projection import report
    from duhem.projection.result import Status

    d = len(fixed.forces)
    k = [rows[i : i + d] for i in range(0, d * d, d)] if len(rows) == d * d and d > 1 else rows if len(rows) > 1 else rows[0]
    done = closest(fixed, target, load, k, method=method, tangent=tangent, convex=convex)
    say(report.json(fixed, target, load, done) if form == "json" else report.text(fixed, target, load, done, page()))
    return HELD if done.status[0] in (Status.STICK, Status.SLIP) else FAILED
