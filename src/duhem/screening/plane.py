"""Verdicts over one or two parameters: where each row of a table lies, and what came of it there, in plain numbers."""

from __future__ import annotations

import json
from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from duhem.errors import InputError
from duhem.expression.number import exact_number, nearest_double
from duhem.law.placed_toml import meant
from duhem.screening.lines import VerdictLine

__all__ = ["NO_VERDICT", "VerdictPanel", "VerdictPlane", "chosen", "plane", "varying"]

NO_VERDICT = "no verdict"
_MOST = 36  # panels of a picture


@dataclass(frozen=True)
class VerdictPanel:
    """The points at which each verdict was found; with one parameter their second coordinate counts the claims."""

    title: str
    law: str
    points: dict[str, tuple[array[float], array[float]]] = field(default_factory=dict)

    def add(self, verdict: str, x: float, y: float) -> None:
        across, up = self.points.setdefault(verdict, (array("d"), array("d")))
        across.append(x)
        up.append(y)


@dataclass(frozen=True)
class VerdictPlane:
    """A panel for each law and claim over two ``axes``, or for each law over one with a line for each of ``claims``.

    ``beside`` are parameters that vary too, along neither axis; ``unplaced`` rows have no number on an axis, of ``rows``.
    """

    axes: tuple[str, ...]
    claims: tuple[str, ...]
    panels: tuple[VerdictPanel, ...]
    beside: tuple[str, ...]
    unplaced: int
    rows: int


def varying(rows: Iterable[tuple[str, Mapping[str, str]]]) -> dict[str, bool]:
    """The parameters that rows of a law and its values fix, and whether each has two values with one law."""
    first, found = dict[tuple[str, str], str](), dict[str, bool]()
    for law, values in rows:
        for name, value in values.items():
            found[name] = found.get(name, False) or first.setdefault((law, name), value) != value
    return found


def chosen(axes: Sequence[str] | None, found: Mapping[str, bool]) -> tuple[str, ...]:
    """One or two parameters to draw over: ``axes``, or those that vary.  InputError where these are none or too many."""
    if axes is None:
        names = tuple(name for name, varies in found.items() if varies)
        if not names:
            raise InputError("no parameter has two values", where="axes", remedy="a plane is of one or two parameters that vary")
        if len(names) > 2:
            words = f"{', '.join(names[:8])}{' ...' if len(names) > 8 else ''} vary"
            raise InputError(words, where="axes", remedy=f"name one or two of them: {','.join(names[:2])}")
        return names
    names = tuple(axes)
    if not 0 < len(names) < 3 or len(set(names)) < len(names):
        raise InputError(f"{','.join(names)[:60] or 'nothing'} is not one or two parameters", where="axes", remedy="write for example mu,e")
    for name in names:
        if name not in found:
            raise InputError(f"no row has a value of {name[:40]!r}", where="axes", remedy=meant(name, tuple(found)))
    return names


def plane(lines: Iterable[VerdictLine], axes: tuple[str, ...], found: Mapping[str, bool]) -> VerdictPlane:
    """Where the ``lines`` of a table lie over one or two of the parameters that were ``found``.

    InputError where no row has a number on each axis, or pictures of so many laws and claims would be too many.
    """
    panels, claims = dict[tuple[str, str], VerdictPanel](), dict[str, int]()
    unplaced, rows, last = 0, 0, 0
    for line in lines:
        new, last = line.row != last, line.row
        rows += new
        point = _point(json.loads(line.parameters), axes)
        if point is None:
            unplaced += new
            continue
        count = claims.setdefault(line.claim, len(claims))
        key = (line.law, line.claim if len(axes) == 2 else "")
        if key not in panels:
            if len(panels) == _MOST:
                raise InputError(f"there are more than {_MOST} pairs of a law and a claim", remedy="draw a table of fewer laws or claims")
            panels[key] = VerdictPanel(f"{line.law}: {line.claim}" if len(axes) == 2 else line.law, line.law)
        panels[key].add(line.verdict or NO_VERDICT, *point, *((float(count),) if len(axes) == 1 else ()))
    if not panels:
        raise InputError(f"no row has a number for {' and '.join(axes)}", where="axes", remedy="name parameters of one law")
    beside = tuple(name for name, varies in found.items() if varies and name not in axes)
    return VerdictPlane(axes, tuple(claims), tuple(panels.values()), beside, unplaced, rows)


def _point(values: Mapping[str, str], axes: tuple[str, ...]) -> tuple[float, ...] | None:
    """The nearest doubles; None where a value is missing, no number or beyond all doubles."""
    try:
        point = [nearest_double(exact_number(values[name])) for name in axes]
    except (KeyError, InputError):
        return None
    known = tuple(x for x in point if x is not None)
    return known if len(known) == len(axes) else None
