"""What an identification returns: coefficients with their uncertainty, outliers, and the law as a proved value.

It is shown as text, as the sheet of a notebook, and as points over the criterion (extra ``plot``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.identification.points import Points
from duhem.law.formula_law import Criterion
from duhem.law.outline import outline, ray_ends
from duhem.show import figure
from duhem.show.page import PAGE, Page
from duhem.show.place import write
from duhem.show.printing import Sheet, Shown, draw, finite, latex_name, latex_number, sheet, text
from duhem.version import __version__

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from duhem.proof.verification import Verification

__all__ = ["Estimate", "Identification", "Outlier", "as_sheet", "as_text", "check", "plot"]

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
        """Return the estimate as the JSON report has it."""
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

    printed_by: ClassVar[str] = "duhem.identification.result"

    def __repr__(self) -> str:
        found = ", ".join(f"{name} = {value:.6g}" for name, value in self.coefficients.items())
        return f"<Identification of {self.family.name} from {len(self.points)} points: {found or 'nothing identifiable'}>"

    @property
    def coefficients(self) -> Mapping[str, float]:
        """The value of every parameter that is not open, by name."""
        return MappingProxyType({e.name: e.value for e in self.estimates if e.value is not None})

    @property
    def fitted(self) -> tuple[str, ...]:
        """The names of the fitted parameters, in the order of their declaration."""
        return tuple(e.name for e in self.estimates if e.state == "fitted")

    @property
    def open(self) -> tuple[str, ...]:
        """The parameters that cannot be identified from these points."""
        return tuple(e.name for e in self.estimates if e.state == "open")

    @property
    def degrees_of_freedom(self) -> int:
        """The number of points less the number of fitted parameters."""
        return len(self.points) - len(self.fitted)

    @property
    def chi_squared(self) -> float | None:
        """The sum of squared residuals; None unless the scatter of the points is absolute."""
        return float(np.sum(np.square(self.residual))) if self.points.absolute else None

    @property
    def p_value(self) -> float | None:
        """The probability of a chi_squared at least as large, if law and scatter are right."""
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
        """Return the result as one JSON object; unknown values are None."""
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


# -- how it is shown ---------------------------------------------------------------------------------------------------

_FIELD = len("admissible")
_HEAD = ("parameter", "value", "std. error", "least", "greatest", "")


@text.register(Identification)
def as_text(done: Identification, page: Page = PAGE) -> str:
    """Return the text: coefficients with their uncertainty, what was minimised, outliers, and what is proved of the fitted law."""
    law, proved = done.family, _proved(done)
    return page.report(
        [
            [*page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name), *_fields(_fitted(done), page)],
            page.table([_HEAD, *map(_row, done.estimates)], "lr"),
            [*(line for remark in _remarks(done) for line in page.item(remark)), *_outliers(done, page)],
            _fields(proved, page),
        ]
    )


@sheet.register(Identification)
def as_sheet(done: Identification) -> Sheet:
    """Return the same as a sheet: the coefficients are a table; open parameters, parameters on a bound and outliers are notes."""
    apart = tuple(f"row {o.row}: standardised {o.standardised:+.4g}, distance {o.distance:+.4g}" for o in done.outliers)
    notes = (("Remarks", tuple(_remarks(done))), ("Outliers", apart))
    fields = {**_fitted(done), **_proved(done)}
    return Sheet(f"Identification of {done.family.name}", tuple(fields.items()), _HEAD, tuple(map(_row, done.estimates)), notes)


def _fitted(done: Identification) -> dict[str, str]:
    fields = {
        "points": f"{len(done.points)} from {done.points.where}, {done.degrees_of_freedom} more than fitted parameters",
        "minimised": done.minimised,
        "scatter": _scatter(done),
    }
    if done.chi_squared is not None:
        chance = "" if done.p_value is None else f", p = {done.p_value:.3g}"
        fields["chi^2"] = f"{done.chi_squared:.4g} on {done.degrees_of_freedom} degrees of freedom{chance}"
    how = f"bootstrap, {len(done.draws)} draws, seed {done.seed}" if len(done.draws) else "from the covariance"
    fields["intervals"] = f"95 %, {how}"
    return fields


def _proved(done: Identification) -> dict[str, str]:
    standard = {True: "yes", False: "no", None: "undecided"}[done.verification.generalized_standard]
    return {
        "proved": ", ".join(f"{r.claim} {r.verdict.value}" for r in done.verification.results),
        "admissible": f"{standard} (the fitted law, exact parameters)",
    }


def _fields(values: Mapping[str, str], page: Page) -> list[str]:
    return [line for title, value in values.items() for line in page.field(title, value, _FIELD)]


def _scatter(done: Identification) -> str:
    if done.points.absolute:
        return "given, in the unit of the stresses"
    if done.level != done.level:
        return "unknown, because there are no more points than fitted parameters; give a scatter column"
    unit = "in the unit of the stresses" if (done.points.scatter == 1.0).all() else "in the unit of the stresses, at the greatest weight"
    return f"{done.level:.4g} estimated, {unit}"


def _remarks(done: Identification) -> Iterator[str]:
    """Yield a sentence for each parameter that is open or ends on a bound."""
    return (f"{e.name} is {e.remark}" for e in done.estimates if e.remark and e.state != "given")


def _row(estimate: Estimate) -> tuple[str, ...]:
    low, high = estimate.interval or (None, None)
    state = {"fitted": "on its bound" if estimate.remark else "", "given": "given", "open": "not identifiable"}[estimate.state]
    return (estimate.name, *map(_number, (estimate.value, estimate.standard_error, low, high)), state)


def _outliers(done: Identification, page: Page) -> Iterator[str]:
    if not done.outliers:
        yield from page.item(f"no outliers (none with |standardised residual| > {done.bound:.3g})")
        return
    chance = f"a limit that one of {len(done.points)} correct points exceeds with probability 1 %"
    yield from page.item(f"outliers: |standardised residual| > {done.bound:.3g}, {chance}")
    rows = [(f"row {o.row}", f"line {o.line}", f"{o.standardised:+.4g}", f"{o.distance:+.4g}") for o in done.outliers]
    yield from page.table([("", "", "standardised", "distance"), *rows], "lr")
    if not done.robust:
        yield from page.item("the fit includes them; --robust limits their influence")


def _number(x: float | None) -> str:
    return "-" if x is None else f"{x:.6g}"


_ALIKE = 1e-9


def check(law: Criterion) -> None:
    """Raise InputError for a law that cannot be drawn."""
    if len(law.forces) != 2:
        raise InputError(f"{law.name} has {len(law.forces)} forces", where="--plot", remedy="only laws of two forces are drawn")


@draw.register(Identification)
def plot(done: Identification, file: figure.Target | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw points and the boundary of K at the median pressure, on ``ax`` or on a new sheet; return the axes.

    Where K grows in proportion to the pressure, forces are those over |sigma_n|.  Otherwise, as with adhesion, each point is
    as many times as far out on its ray as the boundary at the median pressure is, compared with that at its own pressure.

    Raises MissingExtraError without matplotlib, InputError for a law that has not two forces or has open parameters, and
    for a file that cannot be written.
    """
    check(done.law)
    if done.open:
        what = f"{', '.join(done.open)} is not identified"
        raise InputError(what, where="--plot", remedy="fix it with --set NAME=VALUE to draw the criterion")
    title = f"{done.family.name} on {len(done.points)} points"
    return figure.drawn(lambda axes: _paint(axes, done), file, None if ax is None else [ax], size=(5.6, 5.2), title=title)[0]


def _paint(axes: Axes, done: Identification) -> None:
    law, points = done.law, done.points
    load = np.ones(len(points)) if points.pressure is None else np.abs(points.pressure)
    middle, factor = float(np.median(load)), np.ones_like(load)
    there, pressure = "", law.pressure or ""
    if pressure:
        there = rf" at ${latex_name(pressure)} = {latex_number(-middle)}$"
        end, own = (ray_ends(law, done.coefficients, at, points.forces) for at in (np.full_like(load, -middle), -load))
        factor = np.divide(end, own, out=factor, where=own > 0.0)
    ratios = bool(pressure) and np.allclose(factor, middle / load, rtol=_ALIKE, atol=0.0)
    places, unit = (points.forces / load[:, None], middle) if ratios else (points.forces * factor[:, None], 1.0)
    for i, line in enumerate(outline(law, done.coefficients, -middle, float(np.abs(places).max()) * unit or 1.0)):
        axes.plot(*(line / unit).T, color="black", label="_" if i else f"boundary of $K${there}", zorder=1)
    wrong = [o.row - 1 for o in done.outliers]
    sound = np.setdiff1d(np.arange(len(points)), wrong)
    moved = "" if ratios or not np.ptp(load) else f", moved along rays to those{there}"
    axes.plot(*places[sound].T, "o", color=figure.palette(0), label=f"limit points{moved}", zorder=2)
    if wrong:
        axes.plot(*places[wrong].T, "X", markersize=9, color=figure.palette(1), label="outliers: their rows beside them", zorder=3)
    for o in done.outliers:
        figure.note(axes, f"{o.row}", places[o.row - 1])
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.axvline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.set_aspect("equal", adjustable="datalim")
    for axis, force in zip((axes.xaxis, axes.yaxis), law.forces, strict=True):
        if ratios:
            figure.measure(axis, rf"${latex_name(force)}\,/\,|{latex_name(pressure)}|$")
        else:
            figure.measure(axis, f"${latex_name(force)}$", "unit of the points")
    figure.legend(axes)
