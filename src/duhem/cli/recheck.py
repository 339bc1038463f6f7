"""``duhem recheck``: a certificate, checked by the kernel alone."""

from __future__ import annotations

import json
from collections.abc import Sequence

import click

from duhem.cli.arguments import read_fixed_law, settings_option
from duhem.cli.exit_code import HELD, REFUTED
from duhem.cli.output import page, say
from duhem.errors import InputError
from duhem.proof.kernel import certificate as kernel
from duhem.proof.kernel.term import NotWritten

__all__ = ["recheck"]

_MOST_BYTES = 10_000_000
_REMEDY = "make one with: duhem verify LAW --certificate FILE"


@click.command()
@click.argument("certificate", type=click.Path(dir_okay=False))
@click.option("--law", metavar="LAW", help="Also ask that the certificate is about this law.")
@settings_option
def recheck(certificate: str, law: str | None, settings: Sequence[str]) -> int:
    """Check the proofs in CERTIFICATE (duhem verify LAW --certificate FILE) against the text of the law in it.

    The checker shares nothing with what made the proofs: no SymPy, no solver.  --law and --set say which law it should be
    about.  The last line counts what is confirmed and what the kernel has no rule for.  Ends with 1 if a proof that the
    certificate calls checked is not confirmed, or if the law is another.
    """
    document = _read(certificate)
    try:
        rows = kernel.recheck(document)
    except NotWritten as fault:
        raise InputError(f"the certificate cannot be checked: {fault}", where=certificate, remedy=_REMEDY) from None
    if law is not None:
        from duhem.proof.law_text import law_as_text

        if law_as_text(read_fixed_law(law, settings)) != document["law"]:
            say(f"{certificate} is about another law than {law}, or about other values of its parameters")
            return REFUTED
    said = [(r.claim, r.verdict.replace("_", " "), "confirmed" if r.confirmed else "-", r.reason) for r in rows]
    say("\n".join(page().table([("claim", "verdict", "kernel", "why not"), *said], "llll", "", rule=True)))
    say(f"\n{_counted(rows)}")
    return HELD if all(r.confirmed or r.trust != "checked" for r in rows) else REFUTED


def _counted(rows: Sequence[kernel.Rechecked]) -> str:
    """How many proofs are confirmed, how many the kernel has no rule for, and how many it objects to."""
    proofs = [r for r in rows if r.verdict == "proved"]
    if not proofs:
        return "there is no proof in it"
    unruled = sum(r.reason == kernel.NO_RULE for r in proofs)
    confirmed = sum(r.confirmed for r in proofs)
    failed = len(proofs) - confirmed - unruled
    rest = [f"; {what}: {count}" for what, count in (("without a rule here", unruled), ("failed", failed)) if count]
    return f"confirmed: {confirmed} of {len(proofs)} proofs{''.join(rest)}"


def _read(file: str) -> dict[str, object]:
    try:
        with open(file, "rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
        found = json.loads(data, object_pairs_hook=_with_each_key_once)
    except OSError as fault:
        raise InputError(f"the file cannot be read: {fault.strerror}", where=file, remedy="check the path") from None
    except _RepeatedError as fault:
        raise InputError(f"the key {fault} is there twice: of two values readers may see either", where=file, remedy=_REMEDY) from None
    except (ValueError, RecursionError):
        raise InputError("this is no JSON", where=file, remedy=_REMEDY) from None
    if len(data) > _MOST_BYTES or not isinstance(found, dict):
        raise InputError("this is no certificate", where=file, remedy=_REMEDY)
    return found


class _RepeatedError(ValueError):
    """A key of an object that is there twice."""


def _with_each_key_once(pairs: list[tuple[str, object]]) -> dict[str, object]:
    found: dict[str, object] = {}
    for key, value in pairs:
        if key in found:
            raise _RepeatedError(repr(key[:40]))
        found[key] = value
    return found
