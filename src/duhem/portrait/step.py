"""One increment in a plane: the trial stress, the closest point of K and the slip."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.portrait.numbers import Numbered
from duhem.portrait.plane import Plane
from duhem.projection.increment import Convexity, posed
from duhem.projection.projector import Projector
from duhem.projection.result import Status
from duhem.proof.verdict import Verdict
from duhem.proof.verification import verify

__all__ = ["TrialStep", "step"]

Array = NDArray[np.float64]

_PART = 0.6  # of the way from trial to end that a slip may lie on
_LEAST = 0.35  # of its length that it keeps


@dataclass(frozen=True)
class TrialStep:
    """Trial and end (2,) of an increment in a plane; ``slip`` (2,) the slip's part in it at some length, None at 0."""

    trial: Array
    stress: Array
    slip: Array | None
    status: str


def step(given: Numbered, trial: ArrayLike, stiffness: ArrayLike, plane: Plane, length: float, pressure: float = -1.0) -> TrialStep:
    """An increment from one trial stress (d,) as a plane of forces shows it: what lies across is left out.

    The slip gets ``length``, or less where it would hide the way from trial to end.
    A law of one force has no plane of forces: there it is drawn along the pressure, at ``pressure``.  Its status is that of
    :func:`duhem.project`.  InputError for another plane along the pressure and for input that it refuses.
    """
    law = load_formula(given.law)
    alone = plane.pressed and len(law.forces) == 1
    base = np.array([0.0, pressure]) if alone else plane.base
    if not (plane.slips or alone):
        remedy = f"name such a plane first, as {','.join(law.forces[:2])}"
        raise InputError("an increment is drawn in a plane of forces", where="trial", remedy=remedy)
    prepared = Projector.of(law, stiffness)
    question = posed(prepared.setting, trial, float(base[-1]) if law.pressure else None)
    if len(question.trial) != 1:
        raise InputError(f"{len(question.trial)} trial stresses are given", where="trial", remedy="give one")
    if not prepared.method.convex:
        question = replace(question, convexity=Convexity(loaded=_shown_convex(law), unloaded=False))
    done = prepared.at(question)
    n, status = len(plane.names), Status(int(done.status[0]))

    def full(force: Array) -> Array:
        return np.concatenate([force, base[len(force) :]])[:n]

    slip = np.concatenate([done.slip[0], np.zeros(n - len(done.slip[0]))])
    size = float(np.linalg.norm(slip))
    ends = plane.within(full(question.trial[0])), plane.within(full(done.stress[0]))
    length = max(_LEAST * length, min(length, _PART * float(np.linalg.norm(ends[1] - ends[0]))))
    way = length * plane.shares(slip) / size if size > 0.0 and np.isfinite(size) else None
    return TrialStep(*ends, way, status.name.lower())


def _shown_convex(law: Criterion) -> bool:
    """Whether K is proved to be convex, its ranges of forces aside: beyond them another point may be nearer."""
    everywhere = replace(law, domain={name: own for name, own in law.domain.items() if name == law.pressure})
    return verify(everywhere, claims="convexity", effort="quick")["convexity"].verdict is Verdict.PROVED
