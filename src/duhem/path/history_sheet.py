"""A history as a sheet: its law, how it was integrated, and some of its knots."""

from __future__ import annotations

import numpy as np

from duhem.path.history import History
from duhem.show.printing import sheet
from duhem.show.sheet import Sheet

__all__ = ["as_sheet"]

_MOST = 12  # knots of which a sheet has a row


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
