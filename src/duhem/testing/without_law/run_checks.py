"""What is asked of a run without a law as a whole."""

from __future__ import annotations

import numpy as np

from duhem.testing.checks import run_checks
from duhem.testing.checks.registry import Finding, registered
from duhem.testing.without_law.history import HistoryQuery
from duhem.testing.without_law.registry import register

__all__: list[str] = []

_ = run_checks  # it registers the check whose words and whole these are
_WHOLE = next(c for c in registered() if c.name == "vacuity")


@register(
    "vacuity",
    statement=_WHOLE.statement,
    formula="sigma = sigma_tr for some, and not for others",
    source=_WHOLE.source,
    tolerance=_WHOLE.tolerance,
    whole=_WHOLE.whole,
)
def vacuity(h: HistoryQuery) -> Finding:
    none = np.zeros(len(h.first[0].trial))
    return Finding(none, none)
