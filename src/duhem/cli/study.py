"""What ``bench`` and ``stress`` share: the law and the numbers they are taken at, and where their results go."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import click

from duhem.cli.arguments import complete_law, read_fixed_formula, read_numbers
from duhem.cli.output import FAILED, HELD, INTERRUPTED, Progress, as_json, check_outputs, deliver, page, say
from duhem.show.place import write
from duhem.version import __version__

if TYPE_CHECKING:
    from duhem.benchmark.measurement import Study
    from duhem.law.formula_law import Criterion

__all__ = ["carry_out", "flagship_argument", "json_option", "peers_option", "read_subject", "stiffness_option"]

FLAGSHIP = "antoni2007"
FIGURE_5 = {"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"}  # Antoni et al. 2007

flagship_argument = click.argument("law", default=FLAGSHIP, shell_complete=complete_law)
stiffness_option = click.option(
    "--stiffness", metavar="K ...", help="Diagonal stiffness in quotes, one number per force (default: 1 2 ...)."
)
json_option = click.option("--json", "json_file", metavar="FILE", help="Write all results to this file as one JSON object.")
peers_option = click.option(
    "--peers", is_flag=True, help="Also measure the other programs that are installed (SciPy, jaxmat, qpax, ProxQP)."
)


def read_subject(law: str, settings: Sequence[str], stiffness: str | None) -> tuple[Criterion, list[float] | None]:
    """The law, with those of Figure 5 for the parameters of the flagship that are left open, and the diagonal stiffness."""
    if law == FLAGSHIP:
        given = {setting.partition("=")[0].strip() for setting in settings}
        settings = [*settings, *(f"{name}={value}" for name, value in FIGURE_5.items() if name not in given)]
    return read_fixed_formula(law, settings), None if stiffness is None else read_numbers(stiffness, "--stiffness")


def carry_out(measure: Callable[[Progress], Study], json_file: str | None, plot: str | None, inputs: Sequence[str]) -> int:
    """Measure, print, write what is asked for, over none of the ``inputs``; the exit code."""
    from duhem.show.printing import draw, text

    check_outputs(plot, [json_file], inputs)
    with Progress("measuring") as progress:
        done = measure(progress)
    say(text(done, page()))
    deliver("the results", json_file, lambda file: write(file, as_json({"duhem": __version__, **done.to_dict()}) + "\n"))
    deliver("the picture", plot, partial(draw, done))
    return INTERRUPTED if done.interrupted else FAILED if done.failed else HELD
