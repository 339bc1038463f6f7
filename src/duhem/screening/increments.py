"""Slip increments asked of each row: a batch of trial stresses, drawn about K or given, and what came of the worst of them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from time import monotonic
from typing import Any, ClassVar, TypeAlias

import numpy as np

from duhem.errors import InputError
from duhem.expression.rays import exits
from duhem.law.catalogue import load_formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_fixed
from duhem.projection.increment import increment
from duhem.projection.result import Array, Projection, Status
from duhem.screening.campaign import Answer
from duhem.show.printing import finite

__all__ = ["Increments", "Project", "Trials"]

Project: TypeAlias = Callable[..., Projection]
"""A function as :func:`duhem.project`, which this room does not know; another process finds it by its name."""

_RADII = np.ldexp(1.0, np.arange(-128, 512))
_REACH = 20  # bits: how far K reaches, to a part in a million
_LEAST, _MOST = -1.0, 2.0  # powers of ten of a trial's length over that of K along it


@dataclass(frozen=True)
class Trials:
    """Trial stresses that are given: a number in each of the ``columns``, named as the forces and the pressure, for each increment."""

    columns: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]

    def told(self) -> str:
        return hashlib.sha256(json.dumps([self.columns, self.rows]).encode()).hexdigest()

    def of(self, law: Criterion) -> tuple[Array, Array | None]:
        """Trial stresses (N, d) in Pa and, of a law that has one, pressures (N,); InputError where a column is not there."""
        column = dict(zip(self.columns, np.array(self.rows).T, strict=True))
        wanted = law.coordinates
        if missing := [name for name in wanted if name not in column]:
            raise InputError(f"the increments have no column {missing[0]}", where=law.name, remedy=f"columns are {', '.join(wanted)}")
        return np.stack([column[name] for name in law.forces], axis=1), column[law.pressure] if law.pressure else None


@dataclass(frozen=True)
class Increments:
    """What ``project``, that is :func:`duhem.project`, makes of ``count`` trial stresses, or of the ``trials`` given.

    Every row fixes all parameters of its law.  Drawn are directions, alike in all of them, and lengths between a tenth and a hundred
    times that of K along the direction, evenly by their logarithm, at the ``pressure`` sigma_n in Pa; where K has no length, that of
    1 Pa.  The ``seed`` gives the same ones to every row, up to the size of its K.  ``stiffness`` in Pa/m: one number, one a force, or
    the matrix row by row.

    One line a row: ``ok`` where every increment sticks or slips, ``flagged`` where one has another status.  The witness
    has how many came out with which status, the largest of each residual, the dissipation (sum and least), and the worst increment: a
    flagged one if there is any, of the largest residual.  ``steps`` are the increments asked.  InputError for a count below 1.
    """

    project: Project
    count: int = 0
    seed: int = 0
    trials: Trials | None = None
    pressure: float = -1.0
    stiffness: float | tuple[float, ...] | tuple[tuple[float, ...], ...] = 1.0
    method: str = "auto"
    convex: str = "ask"
    options: ClassVar[tuple[str, ...]] = ()
    alone: ClassVar[bool] = False

    def __post_init__(self) -> None:
        if (self.trials is None) == (self.count < 1):
            raise InputError("give either count and seed, or trials", where="increments", remedy="give count and seed, or trials")

    @property
    def names(self) -> tuple[str, ...]:
        return ("increments",)

    def told(self) -> str:
        drawn = f"{self.count} of seed {self.seed} at {self.pressure!r}" if self.trials is None else self.trials.told()
        return f"increments {drawn}, stiffness {self.stiffness!r}, {self.method}, convex {self.convex}"

    def answers(self, law: Law) -> Iterator[Answer]:
        began = monotonic()
        formula = load_formula(law)
        check_fixed(formula, "give it in set, grid, draw or table")
        trial, pressure = self._drawn(formula) if self.trials is None else self.trials.of(formula)
        done = self.project(formula, trial, pressure, self.stiffness, method=self.method, convex=self.convex)
        flagged = np.flatnonzero(~np.isin(done.status, (Status.STICK, Status.SLIP)))
        witness = json.dumps(finite(_witness(done, flagged, trial, pressure)), allow_nan=False)
        verdict = "flagged" if flagged.size else "ok"
        yield "increments", verdict, done.method, None, witness, len(trial), round(monotonic() - began, 6)

    def _drawn(self, law: Criterion) -> tuple[Array, Array | None]:
        chance, d = np.random.default_rng(self.seed), len(law.forces)
        way = chance.normal(size=(self.count, d))
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        far = 10.0 ** chance.uniform(_LEAST, _MOST, size=self.count)
        pressure = float(self.pressure) if law.pressure else None
        g = increment(law, np.zeros((1, d)), pressure, 1.0, None).g
        others = {} if law.pressure is None else {law.symbols()[law.pressure]: float(self.pressure)}
        last, first = exits(g, law.force_symbols(), way, _RADII, others, _REACH)
        reach = np.where((last >= _RADII[0]) & (last < first), last, 1.0)  # 1 where it has no end or the origin is outside
        return way * (reach * far)[:, None], None if pressure is None else np.full(self.count, pressure)


def _witness(done: Projection, flagged: Any, trial: Array, pressure: Array | None) -> dict[str, Any]:
    worst = done.residuals.worst()
    among = flagged if flagged.size else np.arange(len(trial))
    at = int(among[np.argmax(np.where(np.isnan(worst), np.inf, worst)[among])])
    found = {status.name.lower(): int(np.count_nonzero(done.status == status)) for status in Status}
    return {
        "statuses": {name: count for name, count in found.items() if count},
        "residuals": {name: float(np.max(values)) for name, values in asdict(done.residuals).items()},
        "dissipation": {"sum": float(np.sum(done.dissipation)), "least": float(np.min(done.dissipation))},
        "worst": {
            "trial": trial[at].tolist(),
            "pressure": None if pressure is None else float(pressure[at]),
            "stress": done.stress[at].tolist(),
            "status": Status(done.status[at]).name.lower(),
            "residual": float(worst[at]),
        },
    }
