"""What is written for a compiler, run as it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy as sp

from duhem.expression import principal_axes
from duhem.expression.elementary import array_function
from duhem.expression.scalar_bounds import FUNCTIONS
from duhem.expression.scalar_jets import scalar_jets

__all__ = ["as_functions", "named"]


def named(*functions: str) -> dict[str, Any]:
    """What the text calls: NumPy, some ``functions`` on arrays, and the axes of matrices."""
    return {name: array_function(name) for name in functions} | {f.__name__: f for f in principal_axes.FUNCTIONS} | {"np": np}


def as_functions(formula: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
    """The value (in a tuple), and value, gradient and Hessian, each of a row of numbers."""
    text = scalar_jets(formula, forces, ())
    space = named(*FUNCTIONS)
    exec(f"{text.level}\n\n{text.piece}", space)
    q, d = np.array(text.constants), len(forces)

    def jet(at: Any) -> Any:
        v, m = np.vstack([at, np.zeros(d)]), np.zeros((1, d, d))
        value = space["piece"](v, 0, q, True, np.zeros((1, text.kinks), dtype=np.int8), 0, 1, m, 0)
        return value, v[1], m[0]

    return lambda at: (space["level"](at, 0, q),), jet
