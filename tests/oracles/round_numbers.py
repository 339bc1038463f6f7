"""How short a case is to read."""

from __future__ import annotations

from dataclasses import fields
from math import isfinite

import numpy as np

from duhem.testing import Case

__all__ = ["unrounded"]


def unrounded(case: Case) -> int:
    """How many numbers of a case have more than two digits; equal ones count once."""
    parts = [getattr(case, f.name) for f in fields(case)[1:]]
    every = {*case.parameters.values(), *(x for part in parts if part is not None for x in np.ravel(part).tolist())}
    return sum(isfinite(x) and float(f"{x:.1e}") != x for x in every)
