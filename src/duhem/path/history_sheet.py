"""A history as a sheet: its law, how it was integrated, and some of its knots; of many points, where the first of them ended."""

from __future__ import annotations

import numpy as np

from duhem.path.history import Histories, History
from duhem.projection.result import Status
from duhem.show.printing import sheet
from duhem.show.sheet import Sheet

__all__ = ["as_sheet", "as_sheet_of_many"]

_MOST = 12  # knots or points of which a sheet has a row


@sheet.register(History)
def as_sheet(history: History) -> Sheet:
    """The knots, or of many some from the first to the last, with the columns of the table."""
    table = history.to_array()
    shown = np.unique(np.linspace(0, len(table) - 1, min(len(table), _MOST)).round().astype(int))
    rows = tuple((str(i), *(f"{x:.6g}" for x in table[i].tolist())) for i in shown)
    fewer = (f"{len(shown)} of {len(table)} knots; to_dict() and the arrays have all",) if len(shown) < len(table) else ()
    return Sheet(
        f"History of {history.law}: {len(table)} knots",
        (("method", f"{history.method} ({history.why})" if history.why else history.method),),
        ("knot", *history.columns()),
        rows,
        (("Shown", fewer),),
    )


@sheet.register(Histories)
def as_sheet_of_many(found: Histories) -> Sheet:
    """The last knot that each point reached, with its status; of many points the first."""
    count = min(len(found), _MOST)
    table = found.to_array(slice(0, count)).reshape(count, len(found.knots), -1)
    last = np.searchsorted(found.knots, found.reached, side="right") - 1
    rows = tuple(
        (str(found.points[i]), Status(found.status[i]).name.lower(), *(f"{x:.6g}" for x in table[i, last[i], 1:].tolist()))
        for i in range(count)
    )
    fewer = (f"the first {_MOST} of {len(found)} points; to_dict() and the arrays have all",) if len(found) > _MOST else ()
    return Sheet(
        f"Histories of {found.law}: {len(found)} points, {len(found.knots)} knots each",
        (("method", f"{found.method} ({found.why})" if found.why else found.method), ("ended early", str(found.ended_early()))),
        ("point", "status", *found.columns()[1:]),
        rows,
        (("Shown", fewer),),
    )
