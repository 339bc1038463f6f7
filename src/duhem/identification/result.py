"""What an identification returns: coefficients with their uncertainty, outliers, and the law as a proved value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from duhem.identification.points import Points
from duhem.law.formula_law import Criterion
from duhem.show.place import write
from duhem.show.printing import Shown, draw, finite
from duhem.version import __version__

if TYPE_CHECKING:
    from duhem.proof.verification import Verification

__all__ = ["Estimate", "Identification", "Outlier"]

Array = NDArray[np.float64]
State = Literal["fitted", "given", "open"]


@dataclass(frozen=True)
class Estimate:
    """One parameter: ``fitted`` to the points, ``given`` beforehand, or ``open`` because no point feels it.

    ``standard_error`` and ``interval`` (95 %) are None where nothing is known of them; ``value`` is None if open.
    """

    name: str
    state: State
    value: float | None
    standard_error: float | None = None
    interval: tuple[float, float] | None = None
    remark: str = ""

    def to_dict(self) -> dict[str, Any]:
        """The estimate as the JSON report has it."""
        own = {key: getattr(self, key) for key in ("state", "value", "standard_error")}
        return own | {"interval": None if self.interval is None else list(self.interval), "remark": self.remark}


@dataclass(frozen=True)
class Outlier:
    """A point that does not belong: its ``row`` among the points (from 1), its ``line`` of the file, and how far off it is.

    ``distance`` from the boundary of the robust fit in the unit of the stresses, positive outside; ``standardised``: the
    same over the standard deviation that a sound point would have there.
    """

    row: int
    line: int
    distance: float
    standardised: float


@dataclass(frozen=True, eq=False)
class Identification(Shown):
    """The admissible law of a family that fits measured limit points best.

    ``law`` has the fitted parameters fixed to the exact decimals of ``estimates`` (to a few digits of them if one is an
    exponent, see :func:`identify`); ``verification`` proves what it is.
    ``residual`` (m,) signed distances over scatter; ``standardised`` (m,) those to the robust fit, each over its standard
    deviation, and ``bound`` what an outlier exceeds; ``fisher`` and ``covariance`` (q, q) of the ``fitted`` parameters in
    order, NaN where the level of the scatter is unknown; ``level``: the estimated factor on the scatter of the points (1
    where that is absolute); ``draws`` (b, q) what the bootstrap found.
    """

    law: Criterion
    family: Criterion
    points: Points
    estimates: tuple[Estimate, ...]
    residual: Array
    standardised: Array
    bound: float
    outliers: tuple[Outlier, ...]
    fisher: Array
    covariance: Array
    level: float
    draws: Array
    seed: int
    robust: bool
    minimised: str
    verification: Verification

    printed_by: ClassVar[str] = "duhem.identification.printing"

    def __repr__(self) -> str:
        found = ", ".join(f"{name} = {value:.6g}" for name, value in self.coefficients.items())
        return f"<Identification of {self.family.name} from {len(self.points)} points: {found or 'nothing identifiable'}>"

    @property
    def coefficients(self) -> Mapping[str, float]:
        """Value by name, of every parameter that is not open."""
        return MappingProxyType({e.name: e.value for e in self.estimates if e.value is not None})

    @property
    def fitted(self) -> tuple[str, ...]:
        """The parameters fitted, in order of declaration."""
        return tuple(e.name for e in self.estimates if e.state == "fitted")

    @property
    def open(self) -> tuple[str, ...]:
        """The parameters that cannot be identified from these points."""
        return tuple(e.name for e in self.estimates if e.state == "open")

    @property
    def degrees_of_freedom(self) -> int:
        """Points less fitted parameters."""
        return len(self.points) - len(self.fitted)

    @property
    def chi_squared(self) -> float | None:
        """Sum of squared residuals, where the scatter of the points is absolute."""
        return float(np.sum(np.square(self.residual))) if self.points.absolute else None

    @property
    def p_value(self) -> float | None:
        """Chance of a chi_squared at least as large if law and scatter are right."""
        if self.chi_squared is None or self.degrees_of_freedom < 1:
            return None
        from scipy import stats

        return float(stats.chi2.sf(self.chi_squared, self.degrees_of_freedom))

    def __getitem__(self, name: str) -> Estimate:
        for estimate in self.estimates:
            if estimate.name == name:
                return estimate
        raise KeyError(name)

    def to_dict(self) -> dict[str, Any]:
        """The result as one JSON object; what is unknown is None."""
        names = self.fitted
        found = {
            "duhem": __version__,
            "law": self.family.name,
            "points": len(self.points),
            "parameters": {e.name: e.to_dict() for e in self.estimates},
            "identifiable": not self.open,
            "robust": self.robust,
            "minimised": self.minimised,
            "scatter": self.level,
            "scatter_is": "given" if self.points.absolute else "estimated",
            "degrees_of_freedom": self.degrees_of_freedom,
            "chi_squared": self.chi_squared,
            "p_value": self.p_value,
            "covariance": {"names": list(names), "matrix": self.covariance.tolist()},
            "bootstrap": {"draws": len(self.draws), "seed": self.seed},
            "outlier_bound": self.bound,
            "outliers": [{"row": o.row, "line": o.line, "distance": o.distance, "standardised": o.standardised} for o in self.outliers],
            "claims": {r.claim: r.verdict.value for r in self.verification.results},
            "generalized_standard": self.verification.generalized_standard,
            "dissipative": self.verification.dissipative,
        }
        return dict(finite(found))

    def to_toml(self, file: str | PathLike[str]) -> None:
        """Write the law as a criterion file that ``duhem verify`` takes.  InputError if it cannot be written."""
        from duhem.law.criterion_file import criterion_text

        write(file, criterion_text(self.law))

    def plot(self, file: Any = None, *, ax: Any = None) -> Any:
        """Draw points, criterion and outliers on ``ax`` or a new sheet, into ``file``, a name or stream; the axes (extra ``plot``)."""
        return draw(self, file, ax=ax)
