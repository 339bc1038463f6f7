"""Our own text as Python runs it, on plain numbers: for so few points that arrays take longer to call than to compute.

What a compiler is given runs here.  Its arrays are tables of numbers by their places, its functions and powers those of ``math``: an
operation that has no value raises, where an array has nan, and who called takes the point another way.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.expression.elementary import ELEMENTARY
from duhem.projection.kept_code import interpreted_text

__all__ = ["FAULTS", "PlainArray", "interpreted", "line", "row", "table"]

FAULTS = ArithmeticError, ValueError
"""What an operation without a value raises."""


class PlainArray(dict[Any, Any]):
    """Numbers by their places, with the ``shape`` of the array that they stand for; 0 where none was written."""

    def __init__(self, shape: tuple[int, ...] = ()) -> None:
        super().__init__()
        self.shape = shape

    def __missing__(self, place: Any) -> float:
        return 0.0


def table(array: NDArray[Any]) -> PlainArray:
    """The numbers of an array of one or two axes."""
    found = PlainArray(array.shape)
    if array.ndim == 1:
        found.update(enumerate(array.tolist()))
    else:
        found.update(((i, j), x) for i, row in enumerate(array.tolist()) for j, x in enumerate(row))
    return found


def row(numbers: Sequence[float]) -> PlainArray:
    """A table of one row."""
    found = PlainArray((1, len(numbers)))
    for i, x in enumerate(numbers):
        found[0, i] = x
    return found


def line(numbers: Sequence[float]) -> PlainArray:
    """A list of numbers."""
    found = PlainArray((len(numbers),))
    found.update(enumerate(numbers))
    return found


@lru_cache(maxsize=128)
def interpreted(text: str, entry: str) -> Callable[..., Any]:
    """The function ``entry`` of the text; a power that is no real number raises, where Python would take it for a complex one."""
    tree = ast.parse(text)
    for function in tree.body:
        if isinstance(function, ast.FunctionDef):
            _RealPowers().visit(function)
    run: Any = interpreted_text(ast.fix_missing_locations(tree), entry)
    run.__globals__.update(_FUNCTIONS)
    return run


class _RealPowers(ast.NodeTransformer):
    """Hands powers to ``real_power``."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """A power as a call."""
        self.generic_visit(node)
        if isinstance(node.op, ast.Pow):
            return ast.copy_location(ast.Call(ast.Name("real_power", ast.Load()), [node.left, node.right], []), node)
        return node


class _FromRow:
    """The rows of a table from the first one on."""

    def __init__(self, rows: PlainArray, first: int) -> None:
        self.rows, self.first = rows, first

    def __getitem__(self, place: tuple[int, int]) -> float:
        return float(self.rows[place[0] + self.first, place[1]])

    def __setitem__(self, place: tuple[int, int], value: float) -> None:
        self.rows[place[0] + self.first, place[1]] = value


_FUNCTIONS = {
    **{word.numpy: getattr(math, name) for name, word in ELEMENTARY.items()},
    **{name: getattr(math, name) for name in ("expm1", "hypot", "inf", "isnan", "log1p", "nan", "sqrt")},
    "arctan2": math.atan2,
    "maximum": max,
    "minimum": min,
    "real_power": math.pow,
    "from_row": _FromRow,
    "np": SimpleNamespace(
        inf=math.inf, nan=math.nan, empty=lambda shape, *_: PlainArray(shape), int8=np.int8, int64=np.int64, float64=np.float64
    ),
}
