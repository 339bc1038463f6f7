"""A slip increment as a sheet and in plain values."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from duhem.projection.result import Array, Projection, Status
from duhem.show.printing import plain, sheet
from duhem.show.sheet import Sheet

__all__ = ["as_dict", "as_sheet"]

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
        rows.append((str(i), _word(done.status[i]), *map(_number, numbers), f"{worst[i]:.1e}"))
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


def _number(x: float) -> str:
    return f"{float(x):.6g}"


def _word(status: Any) -> str:
    return Status(int(status)).name.lower()
