"""A certificate read and checked by the kernel alone: nothing of what makes proofs is imported, no SymPy, no solver."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from duhem.errors import InputError
from duhem.proof.kernel import certificate as kernel
from duhem.proof.kernel.certificate import Rechecked
from duhem.proof.kernel.parameter_tree import SCHEMA as OF_REGIONS
from duhem.proof.kernel.parameter_tree import TreeLeaf, recheck_tree
from duhem.proof.kernel.term import NotWritten
from duhem.show.page import PAGE, Page, printable
from duhem.show.printing import Sheet, Shown, plain, sheet, text

__all__ = ["Recheck", "RecheckedRegion", "as_dict", "as_sheet", "as_text", "document_of", "recheck"]

_MOST_BYTES = 10_000_000
_REMEDY = "make a new one with: duhem verify LAW --certificate FILE"
_MOST_DEFINITIONS = 3  # that are shown
_MOST_CELLS = 40


@dataclass(frozen=True, repr=False, eq=False)
class Recheck(Shown):
    """What the kernel says of a certificate: a row a claim, ``confirmed`` or not with the reason, and the ``law`` it read, as stated there.

    ``recheck["convexity"].confirmed`` is one of them.
    """

    printed_by: ClassVar[str] = __name__
    head: ClassVar[tuple[str, ...]] = ("claim", "verdict", "trust", "kernel", "why not")

    law: Mapping[str, Any]
    claims: tuple[Rechecked, ...]

    def __repr__(self) -> str:
        return f"<Recheck: {self.counted()}>"

    def __getitem__(self, claim: str) -> Rechecked:
        for row in self.claims:
            if row.claim == claim:
                return row
        raise InputError(f"the certificate does not contain {claim!r}", remedy=f"it has: {', '.join(r.claim for r in self.claims)}")

    @property
    def ok(self) -> bool:
        """Whether everything that the certificate calls proved is confirmed."""
        return not (self.failed or self.without_rule)

    @property
    def failed(self) -> tuple[str, ...]:
        """Claims called proved for whose proof the kernel has an objection."""
        return self._with("failed")

    @property
    def without_rule(self) -> tuple[str, ...]:
        """Claims called proved on the word of a prover or solver: the kernel was given nothing that it could confirm."""
        return self._with("no rule")

    def _with(self, outcome: str) -> tuple[str, ...]:
        return tuple(row.claim for row in self.claims if row.outcome == outcome)

    def counted(self) -> str:
        """How many proofs are confirmed, how many the kernel has no rule for, and how many it objects to, in words.

        What holds by construction is named, and is no proof.
        """
        confirmed, rest = len(self._with("confirmed")), {"without a rule here": len(self.without_rule), "failed": len(self.failed)}
        proofs = confirmed + sum(rest.values())
        said = [f"confirmed: {confirmed} of {proofs} proofs" if proofs else "the certificate contains no proof"]
        said += [f"{what}: {count}" for what, count in rest.items() if count]
        given = self._with("by construction")
        return "; ".join([*said, *([f"by construction: {', '.join(given)}"] if given else [])])


@dataclass(frozen=True, repr=False, eq=False)
class RecheckedRegion(Shown):
    """What the kernel says of the certificate of a region: whether its cells cover the domain of the ``parameter``, or of several, a row
    a cell."""

    printed_by: ClassVar[str] = __name__
    head: ClassVar[tuple[str, ...]] = ("cell", "verdict", "kernel", "why not")

    law: Mapping[str, Any]
    claim: str
    parameter: str
    cells: tuple[TreeLeaf, ...]

    def __repr__(self) -> str:
        return f"<RecheckedRegion: {self.counted()}>"

    @property
    def ok(self) -> bool:
        """Whether everything that the certificate calls proved or refuted is confirmed."""
        return not self.failed

    @property
    def failed(self) -> tuple[str, ...]:
        """The cells for which the kernel has an objection."""
        return tuple(cell.said for cell in self.cells if cell.reason)

    def counted(self) -> str:
        """How many cells are confirmed, open and not confirmed, in words."""
        decided = [cell for cell in self.cells if cell.verdict != "open"]
        said = f"confirmed: {sum(not cell.reason for cell in decided)} of {len(decided)} cells; they cover the domain of {self.parameter}"
        return said + (f"; open: {left}" if (left := len(self.cells) - len(decided)) else "")


def recheck(certificate: str | os.PathLike[str] | Mapping[str, Any]) -> Recheck | RecheckedRegion:
    """Check the proofs of a certificate against the text of its law, with the kernel alone.

    ``certificate`` is the name of a file from ``duhem verify`` or ``duhem region`` with ``--certificate FILE``, or from
    :meth:`duhem.Verification.certificate` or :meth:`duhem.ParameterRegion.certificate`, its text (which begins with a brace), or the
    object itself.  A proof that does not hold is not an error: its row says so. Raises
    InputError for an object that is not a certificate or was changed: its hash is wrong, its law cannot be read, or no parameter lies
    in the domain.
    """
    where, document = document_of(certificate)
    try:
        if document.get("schema") == OF_REGIONS:
            leaves = recheck_tree(document)
            return RecheckedRegion(document["law"], document["claim"], ", ".join(document["parameters"]), leaves)
        return Recheck(document.get("law", {}), kernel.recheck(document))
    except (NotWritten, KeyError) as fault:
        raise InputError(f"the certificate cannot be checked: {fault}", where=where, remedy=_REMEDY) from None


def document_of(certificate: str | os.PathLike[str] | Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Where a certificate stands, in words, and it as an object, from what :func:`recheck` takes; InputError where it is none."""
    where, data = _given(certificate)
    return where, _object(data, where)


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
        raise InputError(f"the key {fault} occurs twice, so its value is not clear", where=where, remedy=_REMEDY) from None
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
@text.register(RecheckedRegion)
def as_text(done: Recheck | RecheckedRegion, page: Page = PAGE) -> str:
    """The law as the certificate states it, a row a claim or a cell, of many cells one for each that failed, and below them the count."""
    fields, rows = _fields(done), _rows(done)
    if isinstance(done, RecheckedRegion) and len(done.cells) > _MOST_CELLS:
        rows = tuple(row for row, cell in zip(rows, done.cells, strict=True) if cell.reason)
    size = max(len(title) for title, _ in fields)
    law = [line for title, said in fields for line in page.field(title, said, size)]
    table = page.table([done.head, *rows], "l" * len(done.head), "", rule=True)
    return page.report([[*page.hanging(_name(done.law)), *law], table, [done.counted()]])


@sheet.register(Recheck)
@sheet.register(RecheckedRegion)
def as_sheet(done: Recheck | RecheckedRegion) -> Sheet:
    """The same as a sheet, with every row."""
    kind = "Certificate" if isinstance(done, Recheck) else "Region"
    return Sheet(f"{kind} of {_name(done.law)}: {done.counted()}", fields=_fields(done), head=done.head, rows=_rows(done))


@plain.register(Recheck)
def as_dict(done: Recheck) -> dict[str, Any]:
    """Every row, the law as the certificate states it, whether all that it calls proved is confirmed, and which claims are not."""
    lists = {"failed": list(done.failed), "without_rule": list(done.without_rule)}
    return {"ok": done.ok, **lists, "law": dict(done.law), "claims": [row._asdict() for row in done.claims]}


@plain.register(RecheckedRegion)
def _fields(done: Recheck | RecheckedRegion) -> tuple[tuple[str, str], ...]:
    return (*_law(done.law), *([("claim", f"{done.claim}, by {done.parameter}")] if isinstance(done, RecheckedRegion) else []))


def _rows(done: Recheck | RecheckedRegion) -> tuple[tuple[str, ...], ...]:
    if isinstance(done, RecheckedRegion):
        outcomes = ("failed" if c.reason else "-" if c.verdict == "open" else "confirmed" for c in done.cells)
        return tuple((c.said, c.verdict, outcome, c.reason) for c, outcome in zip(done.cells, outcomes, strict=True))
    words = {"confirmed": "confirmed", "no proof": "-"}
    return tuple((r.claim, r.verdict.replace("_", " "), r.trust or "-", words.get(r.outcome, r.outcome), r.reason) for r in done.claims)


def _name(law: Mapping[str, Any]) -> str:
    return _line(law.get("name") or "a law without a name")


def _law(law: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What was checked, from the certificate's own texts: every one that the kernel read."""
    if "boundary" in law:
        yield "boundary", f"|{law['pressure']}| ({_list(law['boundary'])}), {law['angle']} from 0 to 2 pi"
        yield "slip", _slip(law["flow"])
    for surface in law.get("surfaces", [law] if "g" in law else []):
        if law.get("viscous"):
            yield "potential", f"Phi* = {_line(surface['g'])}, of which the rates are the gradient"
            continue
        yield "criterion", f"{_line(surface['g'])} <= 0"
        yield "slip", _slip(surface["flow"])
    if define := law.get("define", ()):
        shown = "; ".join(f"{name} = {_line(text)}" for name, text in define[:_MOST_DEFINITIONS])
        more = len(define) - _MOST_DEFINITIONS
        yield "definitions", shown + (f"; and {more} more, as they stand in the certificate" if more > 0 else "")
    pressure = f"; pressure {law['pressure']} <= 0, held fixed" if law["pressure"] else "; no pressure"
    yield "forces", f"{', '.join(law['forces'])}{pressure}"
    state = law.get("variables", {})
    yield "parameters", "; ".join(_range(name, own) for name, own in law["parameters"].items() if name not in state) or "none"
    if state:
        yield "variables", "; ".join(f"{_range(name, law['parameters'][name])} ({_kind(own)})" for name, own in state.items())
    if "energy" in law:
        yield "energy", f"psi = {_line(law['energy'])}"
    if "unforced" in law:
        yield "rates", "; ".join(f"{name}: {_line(rate)} for a unit of the multiplier" for name, rate in law["unforced"].items())
    if "forces_of_rates" in law:
        yield "resistance", "; ".join(f"{force} = {_line(f)}" for force, f in law["forces_of_rates"].items())
    if "rates" in law:
        yield "rates", "; ".join(f"{name}: {_line(rate)}" for name, rate in law["rates"].items())
    if "heat" in law:
        yield "heat", "; ".join(f"from {name}: conductance {_line(h)}" for name, h in law["heat"].items())
    if law.get("domain"):
        yield "restricted to", "; ".join(_range(name, own) for name, own in law["domain"].items())
    if law["constraints"]:
        yield "constraints", _list(law["constraints"])


def _slip(flow: Any) -> str:
    if flow is None:
        return "normal to the boundary (associated)"
    return f"gradient of {_line(flow['potential'])}" if isinstance(flow, Mapping) else f"({_list(flow)})"


def _kind(variable: Mapping[str, Any]) -> str:
    """What a variable of the state is."""
    kind = next((kind for kind in ("observable", "temperature") if variable.get(kind)), "internal")
    return kind if variable.get("force") is None else f"{kind}, force {variable['force']}"


def _range(name: str, own: Mapping[str, Any]) -> str:
    """A domain by its ends: ``mu = 1/2``, ``0 < mu``, ``-1 <= mu <= 2``."""
    if (value := own.get("value")) is not None:
        return f"{name} = {value}"
    low = "0 < " if own.get("positive") else "" if own.get("min") is None else f"{own['min']} <= "
    high = "" if own.get("max") is None else f" <= {own['max']}"
    return f"{low}{name}{high}" if low or high else f"{name} any real number"


def _list(texts: Iterable[str]) -> str:
    return ", ".join(map(_line, texts))


def _line(text: str) -> str:
    """A text in one line, which shows what is in it."""
    return printable(" ".join(text.split()))
