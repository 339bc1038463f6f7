"""The command line.  Nothing heavy is imported before a command needs it, so help and completion are immediate."""

from __future__ import annotations

import click

from duhem.cli.atlas import atlas
from duhem.cli.bench import bench
from duhem.cli.campaign import campaign
from duhem.cli.derive import derive
from duhem.cli.doctor import doctor
from duhem.cli.explain import explain
from duhem.cli.export import export
from duhem.cli.figures import figures
from duhem.cli.identify import identify
from duhem.cli.init import init
from duhem.cli.list_laws import list_laws
from duhem.cli.plot import plot
from duhem.cli.project import project
from duhem.cli.recheck import recheck
from duhem.cli.simulate import simulate
from duhem.cli.snapshot import snapshot
from duhem.cli.stress import stress
from duhem.cli.test import test
from duhem.cli.verify import verify
from duhem.version import __version__

__all__ = ["cli"]


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="duhem", message="%(prog)s %(version)s")
def cli() -> None:
    """Decide whether friction and yield laws are thermodynamically admissible.

    A law is admissible if slip never produces energy. For each claim about a law, duhem gives a proof or a counterexample. It also
    computes slip increments and loading paths, and tests update routines (functions that compute the stress at the end of an
    increment).

    K is the set of admissible stresses. LAW is a name (duhem list, duhem atlas), a criterion file (duhem init NAME writes one), or
    module:attribute.

    Exit codes: 0 nothing refuted, 1 something refuted, 2 usage or file error, 3 undecided with --strict, 4 internal or solver failure,
    130 interrupted.
    """


for command in (
    verify, recheck, derive, plot, project, simulate, export, bench, stress, test, figures, identify, snapshot, campaign, list_laws, atlas,
    init, explain, doctor,
):  # fmt: skip
    cli.add_command(command)
