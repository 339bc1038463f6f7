"""A routine that does not come back: no verdict on it, which would depend on the clock, but an error that names the increment."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from duhem.errors import DuhemError

__all__ = ["Unfinished"]


class Unfinished(DuhemError):
    """A routine has had all the time that it may take, and has not answered; raised by what can end it.

    ``row``: which of the increments it was asked together does so alone, None where that is not known, and ``case`` the case
    of that increment, as the one that is tried.  ``failure``, of one met in a conformance run: what shows it again, as that of the
    check which asked (:class:`duhem.testing.Failure`, with its ``replay()``).
    """

    row: int | None = None
    case: Any = None
    failure: Any = None

    def locate(self, ask: Callable[[slice], object], rows: int) -> None:
        """Note the row, of so many, asked one by one."""
        for i in range(rows if self.row is None else 0):
            with suppress(Exception, SystemExit):  # that an increment fails is told when it is asked alone
                try:
                    ask(slice(i, i + 1))
                except Unfinished:
                    self.row = i
                    return
