"""What a slip increment returns: stresses, slips and multipliers, each point with a status of its own."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from duhem.show.printing import Shown

__all__ = ["ACCURACY", "NOT_CLOSEST", "NOT_SHOWN", "Array", "Judged", "Pointwise", "Projection", "Residuals", "Solution", "Status"]

Array = NDArray[np.float64]

ACCURACY = 1e-7  # a point with a larger residual is inaccurate
NOT_CLOSEST = "K is not convex there: the point is stationary, and a closer point may exist"

NOT_SHOWN = "duhem could not show that K is convex: the point is stationary, and a closer point may exist"


class Status(IntEnum):
    """How a point came out; the two failures are never returned as if they were answers.

    ``OUTSIDE``: solved, and the stress lies outside the ranges of forces that the law declares, where it claims nothing.
    ``STATIONARY``: a slip that satisfies the conditions of stationarity, on a K that was asked about and not shown to be convex.
    No point of K was found nearer to the trial stress, and nobody vouches that there is none.
    """

    STICK = 0
    SLIP = 1
    INACCURATE = 2
    FAILED = 3
    OUTSIDE = 4
    STATIONARY = 5


@dataclass(frozen=True, eq=False)
class Pointwise:
    """Arrays with a row a point."""

    def of(self, at: Any) -> Self:
        """Those of the points ``at``."""
        return type(self)(*(getattr(self, f.name)[at] for f in fields(self)))

    def copy(self) -> Self:
        """Arrays of its own."""
        return type(self)(*(getattr(self, f.name).copy() for f in fields(self)))

    def put(self, at: Any, other: Self) -> None:
        """Write those of others over the points ``at``."""
        for f in fields(self):
            getattr(self, f.name)[at] = getattr(other, f.name)

    __getitem__, __setitem__ = of, put  # as of arrays: one may be part of another


@dataclass(frozen=True, eq=False)
class Solution(Pointwise):
    """What a method hands back, unchecked: stress (N, d), slip (N, d), multiplier (N,), failed (N,) where it gave up."""

    stress: Array
    slip: Array
    multiplier: Array
    failed: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Residuals(Pointwise):
    """Optimality of each point (N,), recomputed from the law after every solve, relative to the scale of the increment.

    Where the rounding of g hides what is asked, g is computed in more digits, with the parameters at the doubles given.

    ``feasibility`` max(g, 0); ``multiplier_sign`` max(-lambda, 0); ``complementarity`` the lesser of
    slip and distance from the boundary, one of which is to vanish; ``stationarity``
    distance of trial - k slip from the stress and of slip from lambda times the normal cone, and a tenth of what the slip is off
    by as a share of itself; ``variational`` the largest
    (sigma_tr - sigma) . k^-1 (tau - sigma) over points tau of K that are known: the ends of K on the axes and, unless the
    method shows that K is convex, points beside the stress and, if they show that it is not, the boundary on some hundred rays.
    Where K was asked about and is not shown to be convex, it is instead by how much, over the length of the stress, a point tau
    that is found is nearer to sigma_tr.
    """

    feasibility: Array
    multiplier_sign: Array
    complementarity: Array
    stationarity: Array
    variational: Array

    def worst(self) -> Array:
        """The largest of the five at each point; nan where one is."""
        return np.asarray(np.maximum.reduce([getattr(self, f.name) for f in fields(self)]))

    def stationary_only(self) -> NDArray[np.bool_]:
        """Points (N,) that satisfy the conditions of stationarity and not the inequality: of a convex K there are none."""
        first = np.maximum.reduce([self.feasibility, self.multiplier_sign, self.complementarity, self.stationarity])
        return np.asarray((first <= ACCURACY) & (self.variational > ACCURACY))


@dataclass(frozen=True, eq=False)
class Judged(Pointwise):
    """A solution with what the judge says of it: residuals, dissipation (N,) and status (N,)."""

    solution: Solution
    residuals: Residuals
    dissipation: Array
    status: NDArray[np.int8]


@dataclass(frozen=True, eq=False, repr=False)
class Projection(Shown):
    """The closest-point step of N increments: stress sigma = argmin over K of (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2.

    ``slip`` = k^-1 (sigma_tr - sigma) = lambda dg/dsigma (in m for stiffness in Pa/m); ``multiplier`` lambda >= 0;
    ``dissipation`` sigma . slip >= 0; ``status`` one :class:`Status` a point; ``method`` the one that was taken, ``why`` the
    reason; next to the boundary, where the difference sigma_tr - sigma keeps no digits, a slip is that of the closest
    point in many digits, whatever the method, and vouched for to 1e-6 of its largest component, or so that k slip is right to 1e-27 of the
    stress; ``tangent`` d sigma/d u (N, d, d) and ``tangent_pressure`` d sigma/d sigma_n (N, d) where asked for; ``forces`` names the
    components; ``compiled`` whether loops were taken that numba compiles.  A multiplier beyond doubles is 0 or inf.

    On a K that is not convex a point that only satisfies the stationarity conditions is ``INACCURATE``, never ``SLIP``, as soon as
    one point tau that is tried has (sigma_tr - sigma) . k^-1 (tau - sigma) > 0.  Without such a tau in all of K the point is the
    closest; with one it still may be, and nobody vouches for it.  The tau tried are samples: what lies between them is not seen.
    :func:`duhem.project` therefore asks whether K is convex: where that is not shown a slip is ``STATIONARY`` at best, and
    ``INACCURATE`` as soon as one tau is nearer to sigma_tr.
    """

    printed_by: ClassVar[str] = "duhem.projection.report"

    stress: Array
    slip: Array
    multiplier: Array
    dissipation: Array
    status: NDArray[np.int8]
    method: str
    why: str
    residuals: Residuals
    forces: tuple[str, ...]
    tangent: Array | None = None
    tangent_pressure: Array | None = None
    compiled: bool = False

    def __repr__(self) -> str:
        return f"<{self.counted()}; {self.method}>"

    def to_columns(self) -> dict[str, Any]:
        """One entry a point, by name, as ``pandas.DataFrame`` takes them: status, forces, slips, multiplier, dissipation, residual."""
        slips = {f"slip_{force.removeprefix('sigma_')}": self.slip[:, i] for i, force in enumerate(self.forces)}
        return {
            "status": [Status(int(status)).name.lower() for status in self.status],
            **{force: self.stress[:, i] for i, force in enumerate(self.forces)},
            **slips,
            "multiplier": self.multiplier,
            "dissipation": self.dissipation,
            "residual": self.residuals.worst(),
        }

    def counted(self) -> str:
        """How many points came out with which status, in words."""
        found = ((status.name.lower(), int(np.count_nonzero(self.status == status))) for status in Status)
        return f"Projection of {len(self.status)} points: {', '.join(f'{count} {name}' for name, count in found if count) or 'none'}"

    def remark(self, row: int = 0) -> str | None:
        """Why the answer of a row is inaccurate, failed or stationary, in words; None for the others."""
        if self.status[row] == Status.STATIONARY:
            return NOT_SHOWN
        if self.status[row] not in (Status.INACCURATE, Status.FAILED):
            return None
        if self.residuals.stationary_only()[row]:
            return NOT_CLOSEST
        if self.status[row] == Status.FAILED:
            return f"method {self.method} found no stress that satisfies the optimality conditions"
        if np.isnan(self.residuals.worst()[row]):
            return "g or its gradient has no value at the stress, so the answer cannot be checked"
        if self.residuals.feasibility[row] > ACCURACY:
            return "the stress lies outside K"
        return "the slip is not in the normal cone of K at the stress"
