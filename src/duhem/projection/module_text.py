"""The text of a module that is compiled for one law: functions of its formula, and loops that call them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import sympy as sp

from duhem.expression import principal_axes, scalar_bounds, scalar_jets
from duhem.projection.scaled_formula import ScaledFormula

__all__ = ["module_text", "over_unit"]

MARK = "# -- compiled from here"


def module_text(
    formula: ScaledFormula,
    d: int,
    counts: tuple[int, int],
    functions: Sequence[str],
    sources: Sequence[ModuleType | Callable[..., Any]],
) -> str:
    """``functions`` of the formula in ``d`` forces, then the ``sources``: functions, or modules from their mark on.

    ``counts``: how many kinks and pairs of eigenvalues the formula has.

    The text depends on the law's parameters by their exponents and whole numbers alone.
    """
    head = [
        "from math import floor, frexp, isfinite, ldexp",
        "from typing import Any",
        "import numpy as np",
        f"from numpy import {', '.join(sorted({*scalar_jets.FUNCTIONS, *scalar_bounds.FUNCTIONS} - {'isfinite'}))}",
        f"D, KINKS, PAIRS, DATA = {d}, {counts[0]}, {counts[1]}, {len(formula.data)}",
    ]
    lines = [f"    q[{k}] = {over_unit(f'data[n, {k}]', datum.weight)}" for k, datum in enumerate(formula.data.values())]
    resized = "\n".join(["def resized(data, n, size, q):", *lines, "    return"])
    axes = principal_axes.FUNCTIONS if any(name in text for text in functions for name in principal_axes.__all__) else ()
    return "\n\n\n".join(["\n".join(head), *map(inspect.getsource, axes), *functions, resized, *map(_source, sources)])


def _source(given: ModuleType | Callable[..., Any]) -> str:
    text = inspect.getsource(given)
    return text.partition(MARK)[2].partition("\n")[2] if inspect.ismodule(given) else text


def over_unit(name: str, weight: sp.Expr) -> str:
    """A datum of this weight in units of another ``size``, as text."""
    power = float(weight)
    return {0.0: name, 1.0: f"{name} / size", -1.0: f"{name} * size"}.get(power, f"{name} / size ** {power!r}")
