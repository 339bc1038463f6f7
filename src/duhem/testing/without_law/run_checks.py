"""What is asked of a run without a law as a whole, and of what its routine leaves behind."""

from __future__ import annotations

import numpy as np

from duhem.testing.checks import run_checks
from duhem.testing.checks.registry import Finding, registered
from duhem.testing.without_law.history import HistoryQuery
from duhem.testing.without_law.registry import register

__all__: list[str] = []

_OF_LAWS = {c.name: c for c in registered()}
_WHOLE = _OF_LAWS["vacuity"]
_INPUTS = _OF_LAWS["inputs"]


@register(
    "vacuity",
    statement=_WHOLE.statement,
    formula="sigma = sigma_tr for some, and not for others",
    source=_WHOLE.source,
    tolerance=_WHOLE.tolerance,
    whole=_WHOLE.whole,
)
def vacuity(h: HistoryQuery) -> Finding:
    none = np.zeros(len(h.here.trial))
    return Finding(none, none)


@register(
    "inputs",
    statement=_INPUTS.statement,
    formula="the state before the step, the increment and all that is not returned are as before the call, and so are former answers",
    source="who calls it goes on with the state before the step, or tries a shorter one, and keeps the states of other steps",
    tolerance=_INPUTS.tolerance,
)
def inputs(h: HistoryQuery) -> Finding:
    return run_checks.inputs(h)
