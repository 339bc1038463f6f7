"""What has changed between two snapshots of a law, each difference a line that a person can judge."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import hypot
from typing import Any, ClassVar

from duhem.show.printing import plain, sheet
from duhem.show.sheet import Sheet
from duhem.show.shown import Shown

__all__ = ["TOLERANCE", "Differences", "differences"]

TOLERANCE = 1e-9  # by how much of their size stresses and slips may move

_NO_ANSWER = ("inaccurate", "failed")  # their stresses and slips are not compared
_CLAIM = ("verdict", "method", "trust", "scope")


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
    """The differences between two values of :func:`duhem.testing.snapshots.snapshot.snapshot`; none if only roundings moved.

    The stress or slip of an increment, and figures that measure a witness, may move by ``tolerance`` of their size; those of
    an increment that was not solved when it was kept may be any.
    """
    changed = (*_law(kept["law"], now["law"]), *_claims(kept["claims"], now["claims"], tolerance), *_increments(kept, now, tolerance))
    return Differences(changed)


def _law(kept: Mapping[str, Any], now: Mapping[str, Any], name: str = "") -> Iterator[str]:
    for key in sorted({*kept, *now}):
        old, new = kept.get(key), now.get(key)
        if isinstance(old, dict) and isinstance(new, dict):
            yield from _law(old, new, f"{name}{key} ")
        elif old != new:
            yield f"{name}{key}: {_said(old)} → {_said(new)}"


def _said(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} = {_said(part)}" for name, part in value.items()) or "none"
    if isinstance(value, (list, tuple)):
        return "; ".join(map(_said, value)) or "none"
    return "none" if value is None else f"{value}"


def _claims(kept: Mapping[str, Any], now: Mapping[str, Any], tolerance: float) -> Iterator[str]:
    for claim in {**kept, **now}:
        if claim not in kept or claim not in now:
            yield f"{claim}: {'not kept, now ' + now[claim]['verdict'] if claim in now else 'kept, and not asked now'}"
            continue
        old, new = kept[claim], now[claim]
        if old["verdict"] != new["verdict"]:
            yield f"{claim}: {old['verdict']} → {new['verdict']}{_where(new.get('witness'))}"
            continue
        yield from (f"{claim}: {name} {_said(old[name])} → {_said(new[name])}" for name in _CLAIM[1:] if old[name] != new[name])
        yield from (f"{claim}: witness: {line}" for line in _witness(old.get("witness"), new.get("witness"), tolerance))


def _where(witness: Mapping[str, Any] | None) -> str:
    if witness is None:
        return ""
    at = f" at {_said(witness['parameters'])}" if witness["parameters"] else ""
    return f"{at}: {witness['statement']}"


def _witness(kept: Mapping[str, Any] | None, now: Mapping[str, Any] | None, tolerance: float) -> Iterator[str]:
    if kept is None or now is None:
        if kept is not now:
            yield f"{_said(kept)} → {_said(now)}"
        return
    for key in sorted({*kept, *now}):
        old, new = kept.get(key), now.get(key)
        if isinstance(old, dict) and isinstance(new, dict):
            yield from (f"{key} {line}" for line in _witness(old, new, tolerance))
        elif isinstance(old, float) and isinstance(new, float):
            if not abs(new - old) <= tolerance * max(abs(old), abs(new)):
                yield f"{key}: {old!r} → {new!r}"
        elif old != new:
            yield f"{key}: {_said(old)} → {_said(new)}"


def _increments(kept: Mapping[str, Any], now: Mapping[str, Any], tolerance: float) -> Iterator[str]:
    old_reason, new_reason = (_said(each.get("left_out", {}).get("increments")) for each in (kept, now))
    if old_reason != new_reason:
        yield f"increments left out: {old_reason} → {new_reason}"
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
    least = {"stress": _size(old["trial"].values()), "slip": _size(old["trial"][f] / old["stiffness"][f] for f in forces)}
    for part, trial in least.items():
        before, after = ([float(each[part][f]) for f in forces] for each in (old, new))
        moved = _size(b - a for a, b in zip(before, after, strict=True))
        size = _size(before) or trial
        if not moved <= tolerance * size and not _alike(before, after):
            shown = " to ".join(f"({', '.join(f'{x:.6g}' for x in each)})" for each in (before, after))
            share = f"by {moved / size:.1g} of its size" if moved < float("inf") else "and is not finite"
            yield f"{part} moved {share}, from {shown}"


def _size(values: Any) -> float:
    return hypot(*values)


def _alike(before: Sequence[float], after: Sequence[float]) -> bool:
    """Equal, what is not a number included."""
    return all(a == b or (a != a and b != b) for a, b in zip(before, after, strict=True))
