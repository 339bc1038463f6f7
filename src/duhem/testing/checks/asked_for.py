"""What a run has asked of a routine, counted over its queries."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from duhem.testing.checks.query import Query

__all__ = ["AskedFor"]


@dataclass
class AskedFor:
    """``points`` increments asked for, ``flagged`` and ``undefined`` ones of them, and what checks ``tried``, as queries count them."""

    points: int = 0
    flagged: int = 0
    undefined: int = 0
    tried: Counter[tuple[str, str]] = field(default_factory=Counter)

    def add(self, asked: Iterable[Query]) -> None:
        for query in asked:
            self.points, self.flagged = self.points + query.points, self.flagged + query.flagged
            self.undefined += int(query.unsaid.sum())
            self.tried.update(query.tried)

    def told(self) -> dict[str, Any]:
        """As a report has them."""
        by_name = {name: {what: n for (by, what), n in self.tried.items() if by == name} for name, _ in self.tried}
        return {"points": self.points, "flagged": self.flagged, "undefined": self.undefined, "tried": by_name}
