"""``duhem recheck``: a certificate, checked by the kernel alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from duhem.cli.arguments import complete_law, read_fixed_law, settings_option
from duhem.cli.output import HELD, REFUTED, UNDECIDED, page, say
from duhem.errors import InputError

__all__ = ["recheck"]


@click.command()
@click.argument("certificate", type=click.Path(dir_okay=False))
@click.option("--law", metavar="LAW", shell_complete=complete_law, help="Also check that the certificate is about this law.")
@settings_option
def recheck(certificate: str, law: str | None, settings: Sequence[str]) -> int:
    """Check the proofs in CERTIFICATE again, with the kernel alone.

    duhem verify LAW --certificate FILE writes a certificate. The kernel is a small program that uses neither SymPy nor a solver, and
    no other part of duhem. The output shows the law of the certificate, and one row per claim. With --law and --set you state which law
    you expect.

    Exit codes: 0 if the kernel confirms everything that the certificate calls proved; 1 if a proof fails or the certificate is about
    another law; 3 if no proof fails, but some proofs rely on a prover or solver because the kernel has no rule for them.
    """
    if not certificate.strip():
        raise InputError("no file is named", where="CERTIFICATE", remedy="make one with: duhem verify LAW --certificate FILE")
    from duhem.proof import recheck as rechecking
    from duhem.show.printing import text

    done = rechecking.recheck(Path(certificate))
    if law is not None:
        from duhem.proof.certificate import law_as_text

        if law_as_text(read_fixed_law(law, settings)) != done.law:
            say(f"{certificate} is about another law than {law}, or about other values of its parameters")
            return REFUTED
    say(text(done, page()))
    return HELD if done.ok else REFUTED if done.failed else UNDECIDED
