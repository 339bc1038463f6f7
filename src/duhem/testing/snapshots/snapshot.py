"""What is kept of a law, to see when it changes: the law's text, verdicts with exact witnesses, and some increments.

A snapshot is plain values: what a JSON file holds.  It says nothing of times and machines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array, Projection, Status
from duhem.projection.validation import check_associated
from duhem.proof.certificate import admitted_values, law_as_text
from duhem.proof.verification import ClaimResult, verify
from duhem.testing.drawn.region import Region

__all__ = ["Entry", "Project", "snapshot"]

Entry: TypeAlias = dict[str, Any]
Project: TypeAlias = Callable[..., Projection]
"""A function as :func:`duhem.project`, which this room does not know."""

_DIGITS = 6  # of a trial stress, so that a person can read it
_ASKED = ("parameters", "pressure", "stiffness", "trial")  # of an increment; the rest is the answer


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
    kept = {name: found[name] for name in ("verdict", "method", "trust", "scope")}
    if witness is not None:  # what its values are follows from the points
        kept["witness"] = {name: value for name, value in witness.items() if name != "values"}
    return kept


def _trials(law: Law) -> Iterator[dict[str, Any]]:
    """What is asked, by the names of the forces; InputError where the law has no increments."""
    if not isinstance(law, Criterion):
        raise InputError(f"{law.name} has no formula g, only a boundary curve")
    check_associated(law)
    if (exact := admitted_values(law)) is None:
        raise InputError("no exact values of the parameters are found")
    values = {name: float(Fraction(value)) for name, value in exact.items()}
    d = len(law.forces)
    load = None if law.pressure is None else _load(law.domain.get(law.pressure))
    ways = np.array([*_mixed(d), *np.eye(d)[:2], *-np.eye(d)[:2]])
    reach = Region(law, values).reach(ways, np.full(len(ways), load or 0.0))
    ends = np.where(np.isfinite(reach) & (reach > 0.0), reach, 1.0)[:, None] * ways
    open_ = {name: exact[name] for name, domain in law.parameters.items() if domain.value is None}
    for share, end in [(0.5, ends[0]), *((3.0, each) for each in ends)]:
        trial = {name: float(f"{x:.{_DIGITS}g}") for name, x in zip(law.forces, (share * end).tolist(), strict=True)}
        stiffness = {name: float(i + 1) for i, name in enumerate(law.forces)}
        yield {"parameters": open_, "pressure": load, "stiffness": stiffness, "trial": trial}


def _mixed(d: int) -> Array:
    """Two directions off the axes, which no symmetry of the law makes alike."""
    size = 1.0 / np.arange(1.0, d + 1.0)
    return np.array([size, size[::-1] * (-1.0) ** np.arange(d)])


def _load(declared: Domain | None) -> float:
    """-1, or a pressure within the declared range."""
    low, high = (-np.inf, 0.0) if declared is None else declared.ends
    return float(min(max(-1.0, low), high))


def _answered(law: Law, asked: Mapping[str, Any], project: Project) -> dict[str, Any]:
    assert isinstance(law, Criterion)
    if not all({*asked[part]} == {*law.forces} for part in ("trial", "stiffness")):
        raise InputError(f"the forces are {', '.join(law.forces)}, and were others in the increments that are kept")
    trial, stiffness = ([asked[part][name] for name in law.forces] for part in ("trial", "stiffness"))
    done = project(law, trial, asked["pressure"], stiffness, dict(asked["parameters"]))
    parts = {"stress": done.stress[0], "slip": done.slip[0]}
    named = {part: dict(zip(law.forces, map(_number, values.tolist()), strict=True)) for part, values in parts.items()}
    return {name: asked[name] for name in _ASKED} | {"status": Status(done.status[0]).name.lower(), **named}


def _number(value: float) -> float | str:
    """JSON has no number for what is not finite."""
    return value if np.isfinite(value) else str(value)
