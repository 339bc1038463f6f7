"""The text of a module that is compiled for one law: functions of its formula, and loops that call them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import sympy as sp

from duhem.expression import scalar_bounds, scalar_jets
from duhem.projection.scaled_formula import ScaledFormula

__all__ = ["module_text"]

MARK = "# -- compiled from here"


def module_text(
    formula: ScaledFormula, d: int, kinks: int, functions: Sequence[str], sources: Sequence[ModuleType | Callable[..., Any]]
) -> str:
    """``functions`` of the formula in ``d`` forces, then the ``sources``: functions, or modules from their mark on.

    The text depends on the law's parameters by their exponents and whole numbers alone.
    """
    head = [
        "from math import floor, frexp, isfinite, ldexp",
        "from typing import Any",
        "import numpy as np",
        f"from numpy import {', '.join(sorted({*scalar_jets.FUNCTIONS, *scalar_bounds.FUNCTIONS} - {'isfinite'}))}",
        f"D, KINKS, DATA = {d}, {kinks}, {len(formula.data)}",
    ]
    lines = [f"    q[{k}] = {_sized(k, datum.weight)}" for k, datum in enumerate(formula.data.values())]
    resized = "\n".join(["def resized(data, n, size, q):", *lines, "    return"])
    return "\n\n\n".join(["\n".join(head), *functions, resized, *map(_source, sources)])


def _source(given: ModuleType | Callable[..., Any]) -> str:
    text = inspect.getsource(given)
    return text.partition(MARK)[2].partition("\n")[2] if inspect.ismodule(given) else text


def _sized(k: int, weight: sp.Expr) -> str:
    power = float(weight)
    return {0.0: f"data[n, {k}]", 1.0: f"data[n, {k}] / size", -1.0: f"data[n, {k}] * size"}.get(power, f"data[n, {k}] / size ** {power!r}")
