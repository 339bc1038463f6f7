"""``duhem recheck``: a certificate, checked by the kernel alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from duhem.cli.arguments import complete_law, read_fixed_law, settings_option
from duhem.cli.output import HELD, REFUTED, UNDECIDED, page, say
from duhem.errors import InputError
from duhem.proof import recheck as rechecking

__all__ = ["recheck"]


@click.command()
@click.argument("certificate", type=click.Path(dir_okay=False))
@click.option("--law", metavar="LAW", shell_complete=complete_law, help="Also ask that the certificate is about this law.")
@settings_option
def recheck(certificate: str, law: str | None, settings: Sequence[str]) -> int:
    """Check the proofs in CERTIFICATE (duhem verify LAW --certificate FILE) against the text of the law in it.

    The checker shares nothing with what made the proofs: no SymPy, no solver.  It prints the law that the certificate is
    about, then a row for each claim; the last line counts.  --law and --set say which law it should be about.

    Ends with 0 only if everything that the certificate calls proved is confirmed, with 1 if a proof fails or the law is
    another, and with 3 if no proof fails but some rest on the word of a prover or solver, for which the kernel has no rule.
    """
    if not certificate.strip():
        raise InputError("no file is named", where="CERTIFICATE", remedy="make one with: duhem verify LAW --certificate FILE")
    done = rechecking.recheck(Path(certificate))
    if law is not None:
        from duhem.proof.certificate import law_as_text

        if law_as_text(read_fixed_law(law, settings)) != done.law:
            say(f"{certificate} is about another law than {law}, or about other values of its parameters")
            return REFUTED
    say(rechecking.as_text(done, page()))
    return HELD if done.ok else REFUTED if done.failed else UNDECIDED
