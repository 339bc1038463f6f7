"""A slip increment shown: as a sheet, in plain values, and the report of one as text and as a JSON object."""

from __future__ import annotations

import json as js
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from duhem.law.formula_law import Criterion
from duhem.projection.increment import crossed
from duhem.projection.result import Array, Projection, Status
from duhem.show.page import PAGE, Page
from duhem.show.printing import Sheet, plain, sheet
from duhem.version import __version__

__all__ = ["as_dict", "as_sheet", "json", "text"]

# -- many points: a sheet, and plain values -----------------------------------------------------------------------------

_MOST = 12  # points of which a sheet has a row


@sheet.register(Projection)
def as_sheet(done: Projection) -> Sheet:
    """A row a point: status, each force, the slip along it, multiplier, dissipation and the largest residual; of many points the first."""
    vectors = [*done.forces, *(f"slip along {force}" for force in done.forces)]
    worst = done.residuals.worst()
    shown = range(min(len(done.stress), _MOST))
    rows = []
    for i in shown:
        numbers = (*done.stress[i], *done.slip[i], done.multiplier[i], done.dissipation[i])
        rows.append((str(i), _word(done.status[i]), *(f"{float(x):.6g}" for x in numbers), f"{worst[i]:.1e}"))
    more = (f"the first {_MOST} of {len(done.stress)} points; to_dict() and the arrays have all",) if len(done.stress) > _MOST else ()
    remarks = tuple(f"point {i}: {remark}" for i in shown if (remark := done.remark(i)))
    return Sheet(
        done.counted(),
        (("method", f"{done.method} ({done.why}{'; compiled' if done.compiled else ''})"),),
        ("point", "status", *vectors, "multiplier", "dissipation", "residual"),
        tuple(rows),
        (("Shown", more), ("Remarks", remarks)),
    )


@plain.register(Projection)
def as_dict(done: Projection) -> dict[str, Any]:
    """Every point, under the names of the fields; a number that is not finite is None."""
    arrays = ("stress", "slip", "multiplier", "dissipation")
    slopes = {name: _listed(found) for name in ("tangent", "tangent_pressure") if (found := getattr(done, name)) is not None}
    return {
        "forces": list(done.forces),
        "method": done.method,
        "why": done.why,
        "compiled": done.compiled,
        "status": [_word(status) for status in done.status],
        "remarks": [done.remark(i) for i in range(len(done.status))],
        **{name: _listed(getattr(done, name)) for name in arrays},
        "residuals": {entry.name: _listed(getattr(done.residuals, entry.name)) for entry in fields(done.residuals)},
        **slopes,
    }


def _listed(numbers: Array) -> Any:
    listed = numbers.astype(object)
    listed[~np.isfinite(numbers)] = None
    return listed.tolist()


def _word(status: Any) -> str:
    return Status(int(status)).name.lower()


# -- one increment: text, and a JSON object -----------------------------------------------------------------------------

_FIELD = len("dissipation")


def text(law: Criterion, trial: Sequence[float], pressure: float | None, done: Projection, page: Page = PAGE) -> str:
    """Stress and slip by force, multiplier and dissipation, then the residuals."""
    head = page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)
    size = max(_FIELD, len(law.pressure or ""))
    if law.parameters:
        head += page.field("parameters", ", ".join(f"{name} {domain.describe()}" for name, domain in law.parameters.items()), size)
    if law.pressure is not None and pressure is not None:
        head += page.field(law.pressure, _number(pressure), size)
    head += page.field("method", f"{done.method} ({done.why})", size)
    head += page.field("status", f"{_word(done.status[0])} ({remark})" if (remark := _remark(law, done)) else _word(done.status[0]), size)
    rows = [(force, *map(_number, each)) for force, *each in zip(law.forces, trial, done.stress[0], done.slip[0], strict=True)]
    increment = page.table([("force", "trial", "stress", "slip"), *rows], "lr")
    sums = [
        *page.field("multiplier", _number(done.multiplier[0]), _FIELD),
        *page.field("dissipation", _number(done.dissipation[0]), _FIELD),
    ]
    slopes = []
    if done.tangent is not None:
        title = "Tangent d stress/d displacement" + ("" if done.tangent_pressure is None else f", d stress/d {law.pressure}")
        rows = [(force, *map(_number, row)) for force, row in zip(law.forces, _slopes(done), strict=True)]
        block = page.table(rows, "lr")
        if "" in block:  # folded: what stands where has to be said
            columns = [f"displacement along {force}" for force in law.forces]
            columns += [] if done.tangent_pressure is None else [f"{law.pressure}"]
            block = page.table([("by", *columns), *rows], "lr")
        if done.status[0] <= Status.SLIP and not np.isfinite(_slopes(done)).all():
            block = page.hanging("unknown: degenerate corner (the active surfaces are not unique), or an infinite curvature")
        slopes = [*page.hanging(title), *block]
    residuals = page.hanging("Optimality: residuals relative to the increment")
    for entry in fields(done.residuals):
        residuals += page.field(entry.name.replace("_", " "), f"{getattr(done.residuals, entry.name)[0]:.1e}", len("complementarity"))
    return page.report([head, increment, sums, slopes, residuals])


def json(law: Criterion, trial: Sequence[float], pressure: float | None, done: Projection) -> str:
    """The same as one object; a number that is not finite is null."""
    told = as_dict(done)
    report: dict[str, Any] = {
        "duhem": __version__,
        "criterion": law.name,
        "parameters": {name: domain.plain() for name, domain in law.parameters.items()},
        "forces": list(law.forces),
        "trial": list(trial),
        "pressure": pressure,
        "method": done.method,
        "why": done.why,
        "status": told["status"][0],
        "remark": _remark(law, done),
        **{name: told[name][0] for name in ("stress", "slip", "multiplier", "dissipation")},
        "residuals": {name: values[0] for name, values in told["residuals"].items()},
        **{name: told[name][0] for name in ("tangent", "tangent_pressure") if name in told},
    }
    return js.dumps(report, indent=2, ensure_ascii=False)


def _slopes(done: Projection) -> list[list[float]]:
    assert done.tangent is not None
    rows = done.tangent[0].tolist()
    if done.tangent_pressure is None:
        return list(rows)
    return [[*row, x] for row, x in zip(rows, done.tangent_pressure[0].tolist(), strict=True)]


def _remark(law: Criterion, done: Projection) -> str | None:
    """Why a point that looks solved is not, or what of it is no answer of the law's."""
    if done.status[0] == Status.OUTSIDE:
        return f"{crossed(law, done.stress[:1])}, where {law.name} is not declared"
    return done.remark()


def _number(x: float) -> str:
    return f"{float(x):.15g}"
