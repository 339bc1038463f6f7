"""The laws that declare the shape of K, with unlike values for their parameters."""

from __future__ import annotations

from typing import Any

import mpmath
import sympy as sp

import duhem
from duhem.law import catalogue
from duhem.law.formula_law import Criterion

EPS = 2.0**-52
FIGURE_5 = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
MU = tuple(FIGURE_5.values())
WITH_SHAPE = [name for name in catalogue.names() if getattr(duhem.load(name), "closed_form", None) is not None]
VALUES = {"mu_a": "0.3", "mu_b": "0.2", "shift": "0.1", "tau_max": "0.4", "c": "0.7", "cohesion": "0.5", "mu": "0.25"}


def values(law: Criterion) -> dict[str, str]:
    """Unlike values for the parameters of a built-in law."""
    return {name: VALUES.get(name, str(sp.Rational(2 + i, 10))) for i, name in enumerate(law.parameters)}


def off(x: float, exact: Any) -> float:
    """Relative error in units of eps."""
    if exact == 0:
        return 0.0 if x == 0 else float("inf")
    return float(abs(mpmath.mpf(float(x)) / exact - 1)) / EPS
