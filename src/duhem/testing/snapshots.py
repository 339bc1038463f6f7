"""What is kept of a law, to see when it changes: its text, verdicts with exact witnesses, and some increments; and what has changed.

A snapshot is plain values: what a JSON file holds.  It says nothing of times and machines.  A file has sorted keys and one value a
line, which shows its changes in a review.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import hypot
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

import numpy as np

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.placed_toml import text_of
from duhem.projection.increment import check_associated
from duhem.projection.result import Projection, Status
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.formula_subject import admitted_values
from duhem.proof.verification import ClaimResult, verify
from duhem.show.place import write
from duhem.show.printing import Sheet, Shown, plain, sheet
from duhem.testing.drawn.case import Region

__all__ = ["TOLERANCE", "Differences", "Entry", "Project", "SnapshotFile", "differences", "snapshot"]

Entry: TypeAlias = dict[str, Any]
Project: TypeAlias = Callable[..., Projection]
"""A function as :func:`duhem.project`, which this room does not know."""

_DIGITS = 6  # of a trial stress, so that a person can read it
_ASKED = ("parameters", "pressure", "stiffness", "trial")  # of an increment; the rest is the answer
_CLAIM = ("verdict", "method", "trust", "scope")


def snapshot(
    law: Law | str | Path,
    project: Project,
    parameters: Mapping[str, Any] | None = None,
    *,
    claims: Iterable[str] | None = None,
    increments: Sequence[Mapping[str, Any]] | None = None,
) -> Entry:
    """The law as text, each claim (or those named) with verdict, method, trust, scope and witness, and increments by ``project``.

    ``parameters`` fixes some values.  ``increments`` are those of a former snapshot, asked again; left out, half the way to the
    boundary and three times as far along some directions, at exact values of the parameters inside their domain.  A law without
    a formula, or with a flow of its own, has none, and ``left_out`` says why.  Raises InputError as :func:`duhem.verify`.
    """
    known: Law = load(law).fix(parameters)
    found = verify(known, claims=claims)
    entry: Entry = {"law": law_as_text(known), "claims": {r.claim: _claim(r) for r in found.results}}
    try:
        asked = list(_trials(known)) if increments is None else increments
        return entry | {"increments": [_answered(known, each, project) for each in asked]}
    except InputError as fault:
        return entry | {"increments": [], "left_out": {"increments": fault.what}}


def _claim(result: ClaimResult) -> dict[str, Any]:
    found = result.to_dict()
    witness = found["witness"]
    kept = {name: found[name] for name in _CLAIM}
    if witness is not None:  # what its values are follows from the points
        kept["witness"] = {name: value for name, value in witness.items() if name != "values"}
    return kept


def _trials(law: Law) -> Iterator[dict[str, Any]]:
    """Yield the increments to ask, by the names of the forces.  Raises InputError where the law has none."""
    if not isinstance(law, Criterion):
        raise InputError(f"{law.name} has no formula g, only a boundary curve")
    check_associated(law)
    if (exact := admitted_values(law)) is None:
        raise InputError("duhem found no exact values of the parameters")
    values = {name: float(Fraction(value)) for name, value in exact.items()}
    d = len(law.forces)
    low, high = (-np.inf, 0.0) if (own := law.domain.get(law.pressure or "")) is None else own.ends
    load = None if law.pressure is None else float(np.clip(-1.0, low, high))  # -1, or the pressure next to it within the declared range
    size = 1.0 / np.arange(1.0, d + 1.0)
    mixed = size, size[::-1] * (-1.0) ** np.arange(d)  # off the axes, which no symmetry of the law makes alike
    ways = np.array([*mixed, *np.eye(d)[:2], *-np.eye(d)[:2]])
    reach = Region(law, values).reach(ways, np.full(len(ways), load or 0.0))
    ends = np.where(np.isfinite(reach) & (reach > 0.0), reach, 1.0)[:, None] * ways
    open_ = {name: exact[name] for name, domain in law.parameters.items() if domain.value is None}
    for share, end in [(0.5, ends[0]), *((3.0, each) for each in ends)]:
        trial = {name: float(f"{x:.{_DIGITS}g}") for name, x in zip(law.forces, (share * end).tolist(), strict=True)}
        stiffness = {name: float(i + 1) for i, name in enumerate(law.forces)}
        yield {"parameters": open_, "pressure": load, "stiffness": stiffness, "trial": trial}


def _answered(law: Law, asked: Mapping[str, Any], project: Project) -> dict[str, Any]:
    assert isinstance(law, Criterion)
    if not all({*asked[part]} == {*law.forces} for part in ("trial", "stiffness")):
        raise InputError(f"the forces are {', '.join(law.forces)}, but the stored increments have other forces")
    trial, stiffness = ([asked[part][name] for name in law.forces] for part in ("trial", "stiffness"))
    done = project(law, trial, asked["pressure"], stiffness, dict(asked["parameters"]))
    parts = {"stress": done.stress[0], "slip": done.slip[0]}
    told = {part: [x if np.isfinite(x) else str(x) for x in values.tolist()] for part, values in parts.items()}  # as JSON has them
    named = {part: dict(zip(law.forces, values, strict=True)) for part, values in told.items()}
    return {name: asked[name] for name in _ASKED} | {"status": Status(done.status[0]).name.lower(), **named}


TOLERANCE = 1e-9  # by how much of their size stresses and slips may move

_NO_ANSWER = ("inaccurate", "failed")  # their stresses and slips are not compared


class Differences(Shown, tuple[str, ...]):
    """What has changed, a sentence each; empty, and false, where nothing has."""

    printed_by: ClassVar[str] = __name__

    def __repr__(self) -> str:
        return f"<Differences: {len(self) or 'none'}>"


@sheet.register(Differences)
def _sheet(found: Differences) -> Sheet:
    return Sheet(f"{len(found)} differences" if found else "as kept", notes=(("What has changed", tuple(found)),))


@plain.register(Differences)
def _plain(found: Differences) -> dict[str, Any]:
    return {"differences": list(found)}


def differences(kept: Mapping[str, Any], now: Mapping[str, Any], tolerance: float = TOLERANCE) -> Differences:
    """The differences between two values of :func:`duhem.testing.snapshots`; none if only roundings moved.

    The stress or slip of an increment, and figures that measure a witness, may move by ``tolerance`` of their size; those of
    an increment that was not solved when it was kept may be any.
    """
    law = (said.lstrip(": ") for said in _changed(kept["law"], now["law"], 0.0))
    return Differences((*law, *_claims(kept["claims"], now["claims"], tolerance), *_increments(kept, now, tolerance)))


def _changed(old: Any, new: Any, tolerance: float) -> Iterator[str]:
    """Yield words for each value that differs between two, after its keys in dictionaries; floats may differ by ``tolerance``."""
    if isinstance(old, dict) and isinstance(new, dict):
        yield from (f" {key}{said}" for key in sorted({*old, *new}) for said in _changed(old.get(key), new.get(key), tolerance))
    elif isinstance(old, float) and isinstance(new, float):
        if not abs(new - old) <= tolerance * max(abs(old), abs(new)):
            yield f": {old!r} → {new!r}"
    elif old != new:
        yield f": {_said(old)} → {_said(new)}"


def _said(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} = {_said(part)}" for name, part in value.items()) or "none"
    if isinstance(value, (list, tuple)):
        return "; ".join(map(_said, value)) or "none"
    return "none" if value is None else f"{value}"


def _claims(kept: Mapping[str, Any], now: Mapping[str, Any], tolerance: float) -> Iterator[str]:
    for claim in {**kept, **now}:
        old, new = kept.get(claim), now.get(claim)
        if old is None or new is None:
            yield f"{claim}: {'stored, but not examined now' if new is None else 'not stored, now ' + new['verdict']}"
        elif old["verdict"] != new["verdict"]:
            yield f"{claim}: {old['verdict']} → {new['verdict']}{_where(new.get('witness'))}"
        else:
            yield from (f"{claim}: {name} {_said(old[name])} → {_said(new[name])}" for name in _CLAIM[1:] if old[name] != new[name])
            witnesses = _changed(old.get("witness"), new.get("witness"), tolerance)
            yield from (f"{claim}: witness: {said.lstrip(': ')}" for said in witnesses)


def _where(witness: Mapping[str, Any] | None) -> str:
    if witness is None:
        return ""
    at = f" at {_said(witness['parameters'])}" if witness["parameters"] else ""
    return f"{at}: {witness['statement']}"


def _increments(kept: Mapping[str, Any], now: Mapping[str, Any], tolerance: float) -> Iterator[str]:
    old_reason, new_reason = (_said(each.get("left_out", {}).get("increments")) for each in (kept, now))
    if old_reason != new_reason:
        yield f"increments omitted: {old_reason} → {new_reason}"
        return
    olds, news = kept["increments"], now["increments"]
    if len(olds) != len(news):
        yield f"increments: {len(olds)} → {len(news)}"
    for number, (old, new) in enumerate(zip(olds, news, strict=False), start=1):
        yield from (f"increment {number}: {line}" for line in _increment(old, new, tolerance))


def _increment(old: Mapping[str, Any], new: Mapping[str, Any], tolerance: float) -> Iterator[str]:
    if old["status"] != new["status"]:
        yield f"status {old['status']} → {new['status']}"
    if old["status"] in _NO_ANSWER:
        return
    forces = new["trial"]  # in the order of the law; a file has that of the alphabet
    least = {"stress": hypot(*old["trial"].values()), "slip": hypot(*(old["trial"][f] / old["stiffness"][f] for f in forces))}
    for part, trial in least.items():
        before, after = ([float(each[part][f]) for f in forces] for each in (old, new))
        moved = hypot(*(b - a for a, b in zip(before, after, strict=True)))
        size = hypot(*before) or trial
        if not moved <= tolerance * size and not np.array_equal(before, after, equal_nan=True):
            shown = " to ".join(f"({', '.join(f'{x:.6g}' for x in each)})" for each in (before, after))
            share = f"by {moved / size:.1g} of its size" if moved < float("inf") else "and is not finite"
            yield f"{part} moved {share}, from {shown}"


_MOST_BYTES = 10_000_000
_REMEDY = "write it with --update"
_NUMBERS = ("trial", "stiffness", "stress", "slip")


@dataclass(frozen=True)
class SnapshotFile:
    """The entries of a file by the name under which each law was asked for; ``tolerance`` as the file states it.

    ``tolerance`` is by how much of their size stresses and slips may move; whoever keeps the file may change it there.
    """

    laws: Mapping[str, Entry] = field(default_factory=dict)
    tolerance: float = TOLERANCE

    @classmethod
    def read(cls, file: str | os.PathLike[str]) -> SnapshotFile:
        """InputError for a file that is not there or is no snapshot."""
        text = text_of(file, "snapshot", _MOST_BYTES, absent=_REMEDY)
        try:
            found = json.loads(text)
            laws, tolerance = found["laws"], found["tolerance"]
            for entry in laws.values():
                differences(entry, entry)  # all that is read later
                if not all(isinstance(each[part], dict) for each in entry["increments"] for part in ("parameters", *_NUMBERS)):
                    raise TypeError
                _ = [each["pressure"] for each in entry["increments"]]
            if not isinstance(tolerance, float) or not 0.0 <= tolerance < 1.0:
                raise TypeError
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise InputError("this is no snapshot", where=f"{file}", remedy=_REMEDY) from None
        return cls(laws, tolerance)

    def entry(self, name: str, file: str | os.PathLike[str]) -> Entry:
        """Return what is kept of a law.  Raises InputError where nothing is."""
        if name not in self.laws:
            alike = sorted(each for each in self.laws if each.partition(",")[0] == name.partition(",")[0])
            besides = f", only of {'; of '.join(alike)}" if alike else ""  # other values or claims
            raise InputError(f"there is no snapshot of {name}{besides}", where=f"{file}", remedy=_REMEDY)
        return self.laws[name]

    def with_entries(self, entries: Mapping[str, Entry]) -> SnapshotFile:
        """Return the file with some laws added or replaced."""
        return replace(self, laws={**self.laws, **entries})

    def to_text(self) -> str:
        """Return the content of the file."""
        whole: dict[str, Any] = {"laws": dict(self.laws), "tolerance": self.tolerance}
        return json.dumps(whole, indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n"

    def write(self, file: str | os.PathLike[str]) -> None:
        """Write it beside and renamed: whole or not at all."""
        write(file, self.to_text())
