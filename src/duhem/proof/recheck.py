"""A certificate read and checked by the kernel alone: nothing of what makes proofs is imported, no SymPy, no solver."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from duhem.errors import InputError
from duhem.proof.kernel import certificate as kernel
from duhem.proof.kernel.certificate import Rechecked
from duhem.proof.kernel.term import NotWritten
from duhem.show.page import PAGE, Page
from duhem.show.printing import plain, sheet, text
from duhem.show.sheet import Sheet
from duhem.show.shown import Shown

__all__ = ["Recheck", "as_dict", "as_sheet", "as_text", "recheck"]

_MOST_BYTES = 10_000_000
_REMEDY = "make one with: duhem verify LAW --certificate FILE"
_HEAD = ("claim", "verdict", "kernel", "why not")


@dataclass(frozen=True, repr=False, eq=False)
class Recheck(Shown):
    """What the kernel says of a certificate: a row a claim, ``confirmed`` or not with the reason, and the ``law`` it read, as stated there.

    ``recheck["convexity"].confirmed`` is one of them.
    """

    printed_by: ClassVar[str] = __name__

    law: Mapping[str, Any]
    claims: tuple[Rechecked, ...]

    def __repr__(self) -> str:
        return f"<Recheck: {self.counted()}>"

    def __getitem__(self, claim: str) -> Rechecked:
        for row in self.claims:
            if row.claim == claim:
                return row
        raise InputError(f"the certificate says nothing of {claim!r}", remedy=f"it has: {', '.join(r.claim for r in self.claims)}")

    @property
    def ok(self) -> bool:
        """Whether every proof that the certificate calls checked is confirmed."""
        return all(row.confirmed or row.trust != "checked" for row in self.claims)

    def counted(self) -> str:
        """How many proofs are confirmed, how many the kernel has no rule for, and how many it objects to, in words."""
        proofs = [row for row in self.claims if row.verdict == "proved"]
        if not proofs:
            return "there is no proof in it"
        unruled = sum(row.reason == kernel.NO_RULE for row in proofs)
        confirmed = sum(row.confirmed for row in proofs)
        failed = len(proofs) - confirmed - unruled
        rest = [f"; {what}: {count}" for what, count in (("without a rule here", unruled), ("failed", failed)) if count]
        return f"confirmed: {confirmed} of {len(proofs)} proofs{''.join(rest)}"


def recheck(certificate: str | os.PathLike[str] | Mapping[str, Any]) -> Recheck:
    """Check the proofs of a certificate against the text of the law in it, with the kernel alone.

    ``certificate`` is the name of a file that ``duhem verify LAW --certificate FILE`` or :meth:`duhem.Verification.certificate` wrote, its
    text (which begins with a brace), or the object itself.  Raises InputError for what is no certificate, or not the one that was made: its
    hash is another, its law cannot be read, or no parameter is in the domain.  A proof that does not hold is no error: its row says so.
    """
    where, data = _given(certificate)
    document = _object(data, where)
    try:
        return Recheck(document.get("law", {}), kernel.recheck(document))
    except NotWritten as fault:
        raise InputError(f"the certificate cannot be checked: {fault}", where=where, remedy=_REMEDY) from None


def _given(certificate: object) -> tuple[str, bytes]:
    """Where the certificate stands, in words, and its text."""
    here = "certificate"
    if isinstance(certificate, Mapping):
        try:
            return here, json.dumps(dict(certificate)).encode()
        except (TypeError, ValueError, RecursionError):
            raise InputError("this is no certificate", where=here, remedy=_REMEDY) from None
    if isinstance(certificate, str) and certificate.lstrip().startswith("{"):
        return here, certificate.encode("utf-8", "surrogatepass")
    if not isinstance(certificate, str | os.PathLike):
        raise InputError(f"{type(certificate).__name__} is no certificate", where=here, remedy="give a file, its text, or the object")
    file = os.fsdecode(certificate)
    if not file.strip():
        raise InputError("no file is named", where=here, remedy="give a file, its text, or the object")
    try:
        with open(file, "rb") as stream:
            return file, stream.read(_MOST_BYTES + 1)
    except (OSError, ValueError) as fault:
        reason = getattr(fault, "strerror", None) or str(fault)
        raise InputError(f"the file cannot be read: {reason}", where=file[:200], remedy="check the path") from None


def _object(data: bytes, where: str) -> dict[str, Any]:
    try:
        found = json.loads(data, object_pairs_hook=_with_each_key_once) if len(data) <= _MOST_BYTES else None
    except _RepeatedError as fault:
        raise InputError(f"the key {fault} is there twice: of two values readers may see either", where=where, remedy=_REMEDY) from None
    except (ValueError, RecursionError):
        raise InputError("this is no JSON", where=where, remedy=_REMEDY) from None
    if not isinstance(found, dict):
        raise InputError("this is no certificate", where=where, remedy=_REMEDY)
    return found


class _RepeatedError(ValueError):
    """A key of an object that is there twice."""


def _with_each_key_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise _RepeatedError(repr(key[:40]))
        found[key] = value
    return found


@text.register(Recheck)
def as_text(done: Recheck, page: Page = PAGE) -> str:
    """A row a claim, and below them the count."""
    return "\n".join([*page.table([_HEAD, *_rows(done)], "llll", "", rule=True), "", done.counted()])


@sheet.register(Recheck)
def as_sheet(done: Recheck) -> Sheet:
    """The same as a sheet."""
    return Sheet(f"Certificate: {done.counted()}", head=_HEAD, rows=_rows(done))


@plain.register(Recheck)
def as_dict(done: Recheck) -> dict[str, Any]:
    """Every row, the law as the certificate states it, and whether all that it calls checked is confirmed."""
    return {"ok": done.ok, "law": dict(done.law), "claims": [row._asdict() for row in done.claims]}


def _rows(done: Recheck) -> tuple[tuple[str, ...], ...]:
    return tuple((r.claim, r.verdict.replace("_", " "), "confirmed" if r.confirmed else "-", r.reason) for r in done.claims)
