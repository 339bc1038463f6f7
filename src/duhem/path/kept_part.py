"""A run that was stopped, kept as a table beside the one asked for, so that it can go on to the same last digit."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numpy as np

from duhem.errors import InputError
from duhem.path.history import History
from duhem.path.plan import Plan
from duhem.show.growing_file import DAMAGED, MARK, UNREADABLE, another, beside

__all__ = ["keep", "recall"]


def keep(history: History, file: str | os.PathLike[str], fingerprint: str) -> Path:
    """Write what is done; ``fingerprint`` is that of the run.  A sum over the table shows what was changed or cut off since."""
    place = beside(file)
    history.to_csv(place, above=f"{MARK}{fingerprint} {_sum(history.to_text())}")
    return place


def recall(file: str | os.PathLike[str], plan: Plan, fingerprint: str) -> History | None:
    """The part kept of the run ``fingerprint``, or None if there is none.  InputError if it is of another run or damaged."""
    place = beside(file)
    try:
        text = place.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError):
        raise InputError("the part of a run cannot be read", where=f"{place}", remedy=UNREADABLE) from None
    mark, _, table = text.partition("\n")
    if not mark.startswith(f"{MARK}{fingerprint} "):
        raise another(place)
    try:
        if mark != f"{MARK}{fingerprint} {_sum(table)}":
            raise ValueError
        header, *lines = table.splitlines()
        rows = np.array([[float(cell) for cell in line.split(",")] for line in lines])
        if not np.isfinite(rows).all():
            raise ValueError
        column = dict(zip(header.split(","), rows.T, strict=True))
        return _history(plan, column)
    except (ValueError, KeyError, IndexError):
        raise InputError("the part of a run is damaged", where=f"{place}", remedy=DAMAGED) from None


def _sum(table: str) -> str:
    return hashlib.sha256(table.encode()).hexdigest()


def _history(plan: Plan, column: dict[str, np.ndarray]) -> History:
    law, n = plan.increment.law, len(column["time"])
    tails = [force.removeprefix("sigma_") for force in law.forces]
    return History(
        law=law.name,
        forces=law.forces,
        pressure_name=law.pressure,
        time=column["time"],
        timed=plan.path.timed,
        displacement=np.stack([column[f"u_{t}"] for t in tails], axis=1),
        slip=np.stack([column[f"u_in_{t}"] for t in tails], axis=1),
        stress=np.stack([column[f] for f in law.forces], axis=1),
        pressure=column[law.pressure] if law.pressure else np.zeros(n),
        multiplier=column["lambda"],
        **{name: column[name] for name in ("psi", "dissipation", "work", "numerical", "balance")},
        method="",
        why="",
        plan=plan,
    )
