"""What is asked of a law and a loading path, as one value, and the checked question of one path."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.path import step_formulas
from duhem.path.loading import Path
from duhem.path.paths import Paths
from duhem.projection.increment import Convexity, Increment
from duhem.projection.increment import increment as checked
from duhem.projection.result import Array

__all__ = ["Plan", "Run", "columns", "energy", "times"]


@dataclass(frozen=True, eq=False)
class Run:
    """The arguments of :func:`duhem.simulate` that determine numbers, as given and not yet checked; ``threads``, which do not, too.

    ``convexity`` is what is known of K where somebody has asked, None where nobody has.
    """

    law: Criterion | str | pathlib.Path
    path: Path | Paths
    stiffness: ArrayLike
    parameters: Mapping[str, Any] | None = None
    method: str = "implicit"
    projection: str = "auto"
    substeps: int = 1
    stress: ArrayLike | None = None
    keep: int | str = 1
    threads: int = 1
    compiled: bool = False
    convexity: Convexity | None = None


@dataclass(frozen=True, eq=False)
class Plan:
    """A law with numbers in place, and the path.

    ``increment`` is the checked question, its trial stresses being those without slip; ``projection`` the method of the
    closest point.  Displacements in m, stresses in Pa, stiffness in Pa/m.
    """

    increment: Increment
    path: Path
    projection: str
    compliance: Array

    @classmethod
    def of(cls, run: Run) -> Plan:
        """The run of one path, checked; InputError for what does not fit."""
        known, path = load_formula(run.law), run.path
        if not isinstance(path, Path):
            what = f"{type(path).__name__} is no loading path"
            raise InputError(what, where="path", remedy="make one with Path.linear(points, pressure=...) or Path.from_csv(file)")
        fine = path.refined(run.substeps)
        d = len(known.forces)
        if fine.values.shape[1] != d:
            raise InputError(
                f"the path has {fine.values.shape[1]} columns and {known.name} the {d} forces {', '.join(known.forces)}",
                where="path",
                remedy="give one column for each force",
            )
        increment = checked(known, fine.values, fine.pressure, run.stiffness, run.parameters)
        compliance = np.asarray(np.linalg.inv(increment.stiffness))
        return cls(replace(increment, convexity=run.convexity), fine, run.projection, compliance)

    @property
    def stiffness(self) -> Array:
        return self.increment.stiffness

    def psi(self, stress: Array) -> Array:
        """sigma . k^-1 sigma / 2 of each row, in Pa m."""
        return energy(stress, self.compliance)


def energy(rows: Array, matrix: Array) -> Array:
    """rows . matrix rows / 2 of each row."""
    return np.reshape(step_formulas.energy(columns(rows), matrix[:, :, None]), rows.shape[:-1])


def times(rows: Array, matrix: Array) -> Array:
    """rows @ matrix of each row."""
    return np.reshape(step_formulas.times(columns(rows), matrix[:, :, None]).T, rows.shape)


def columns(rows: Array) -> Array:
    """Vectors (..., d) as the columns of formulas, (d, n)."""
    return rows.reshape(-1, rows.shape[-1]).T
