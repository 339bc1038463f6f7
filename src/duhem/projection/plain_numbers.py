"""Our own text as Python runs it, on plain numbers: for so few points that arrays take longer to call than to compute.

What a compiler is given runs here.  Its arrays are lists of lists, its functions and powers those of ``math``: an operation that has no
value raises, where compiled code has nan or an infinity and goes on.  Who called takes the point another way, or asks for the function
that ``goes_on`` as well, which takes some ten times as long.  A loop over the few forces of a law is written out, and what constants
decide is worked out once, so that little is left of it but the operations themselves.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from types import CodeType, SimpleNamespace
from typing import Any, cast

import numpy as np

from duhem.expression.elementary import ELEMENTARY, array_function
from duhem.expression.syntax import module_tree

__all__ = ["FAULTS", "interpreted", "zeros"]

FAULTS = ArithmeticError, ValueError
"""What an operation without a value raises."""

_MOST_TURNS, _MOST_LINES = 6, 12  # of a loop that is written out


def zeros(first: int, *others: int) -> Any:
    """Lists of lists of these sizes, of zeros."""
    if len(others) == 1:  # most are, and a call a row would take four times as long
        return [[0.0] * size for size in others * first]
    return [zeros(*others) for _ in range(first)] if others else [0.0] * first


@lru_cache(maxsize=128)
def interpreted(text: str, entry: str, goes_on: bool = False, **constants: int) -> Callable[..., Any]:
    """The function ``entry`` of the text, of whose ``constants`` these have other values; an array that it takes is a list of lists.

    A power that is no real number raises, where Python would take it for a complex one.  ``goes_on``: what has no value is nan or
    infinite, as it is compiled.
    """
    functions, others = list[str](), list[str]()
    for part in re.split(r"\n(?=\S)", text):  # as ``ast.unparse`` writes it, a statement begins where a line does
        (functions if part.startswith("def ") else others).append(part)
    tree, space = module_tree("\n".join(others)), dict[str, Any]()
    for node in tree.body:
        exec(compile(ast.Module([node], []), "<generated>", "exec"), space)
        space |= constants  # what follows from them, too
    names = dict.fromkeys(part.id for part in ast.walk(tree) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store))
    known = ((name, space[name]) for name in names if type(space[name]) in (int, float))
    told = tuple((name, value, repr(value)) for name, value in known)  # 1 and 1.0 are two
    for part in functions:
        exec(_written_out(part.rstrip(), told, goes_on), space)
    space.update(_FUNCTIONS, **(_GOING_ON if goes_on else {}))
    run: Callable[..., Any] = space[entry]
    return run


@lru_cache(maxsize=1024)
def _written_out(text: str, known: tuple[tuple[str, Any, str], ...], goes_on: bool) -> CodeType:
    """One function, as it runs where the constants are ``known``: those of ours are the same for many laws."""
    instead: dict[type, str] = {ast.Pow: "real_power"} | ({ast.Div: "quotient"} if goes_on else {})
    tree = _WrittenOut({name: value for name, value, _ in known}, instead).visit(module_tree(text))
    return compile(tree, "<generated>", "exec")


class _WrittenOut(ast.NodeTransformer):
    """Puts numbers for names that are ``known``, works out what they decide, and writes loops over them out.

    Operations that have a function ``instead`` of them are handed to that.

    A loop that may end early stays one.  No text reads a counter after a loop that may not: nothing would count there.
    """

    def __init__(self, known: Mapping[str, Any], instead: Mapping[type, str]) -> None:
        self.known, self.instead = known, instead

    def generic_visit(self, node: ast.AST) -> ast.AST:
        """A node of what its parts become; the one that was given stays as it is, to be written out again."""
        return _made(type(node), *(self._part(getattr(node, name, None)) for name in node._fields))

    def _part(self, value: Any) -> Any:
        if isinstance(value, ast.AST):
            return self.visit(value) if value._fields else value
        if isinstance(value, list):
            return [line for part in value for line in _listed(self._part(part))]
        return value

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """The number of a name."""
        return _made(ast.Constant, self.known[node.id]) if isinstance(node.ctx, ast.Load) and node.id in self.known else node

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        """The negative of a number."""
        node = cast("ast.UnaryOp", self.generic_visit(node))
        negative = isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant)
        return _made(ast.Constant, operator.neg(node.operand.value)) if negative else node  # type: ignore[attr-defined]

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """What is made of two numbers, or a call."""
        node = cast("ast.BinOp", self.generic_visit(node))
        a, b = node.left, node.right
        if isinstance(a, ast.Constant) and isinstance(b, ast.Constant) and type(node.op) in _OPERATORS:
            return _made(ast.Constant, _OPERATORS[type(node.op)](a.value, b.value))
        if type(node.op) in self.instead:
            return _made(ast.Call, _made(ast.Name, self.instead[type(node.op)], ast.Load()), [a, b], [])
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """An entry of an array as that of a list in a list, its first size as the length."""
        node = cast("ast.Subscript", self.generic_visit(node))
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return _made(ast.Call, _made(ast.Name, "len", ast.Load()), [node.value.value], [])
        if not isinstance(node.slice, ast.Tuple):
            return node
        *outer, last = node.slice.elts
        found = node.value
        for place in outer:
            found = _made(ast.Subscript, found, place, ast.Load())
        return _made(ast.Subscript, found, last, node.ctx)

    def visit_For(self, node: ast.For) -> Any:
        """Its body for each number, where these are few and known."""
        over = self.visit(node.iter)
        ends: list[Any] = [x.value for x in over.args if isinstance(x, ast.Constant)] if isinstance(over, ast.Call) else []
        whole = isinstance(over, ast.Call) and len(ends) == len(over.args) and getattr(over.func, "id", "") == "range"
        turns = range(*ends) if whole else range(0)
        few = whole and len(turns) <= _MOST_TURNS and len(turns) * _statements(node.body) <= _MOST_LINES
        if few and isinstance(node.target, ast.Name) and node.target.id != "_" and not _may_end_early(node):
            lines = list[ast.stmt]()
            for turn in turns:
                lines += _WrittenOut({**self.known, node.target.id: turn}, self.instead)._part(node.body)
            return lines or _made(ast.Pass)
        return self.generic_visit(node)


def _made(kind: type[Any], *parts: Any) -> Any:
    """A node with a place, which a compiler asks for."""
    made = kind(*parts)
    if kind._attributes:
        made.lineno, made.col_offset = 1, 0
    return made


def _statements(lines: Sequence[ast.stmt]) -> int:
    return sum(1 + sum(_statements(getattr(line, name, ())) for name in ("body", "orelse")) for line in lines)


def _may_end_early(loop: ast.For) -> bool:
    return any(isinstance(part, ast.Break | ast.Continue) for part in ast.walk(loop))


def _listed(made: Any) -> list[ast.stmt]:
    return made if isinstance(made, list) else [made]


_OPERATORS: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.FloorDiv: operator.floordiv,
    ast.Pow: operator.pow,
}
_FUNCTIONS = {
    **{word.numpy: getattr(math, name) for name, word in ELEMENTARY.items()},
    **{name: getattr(math, name) for name in ("expm1", "hypot", "inf", "isnan", "log1p", "nan", "sqrt")},
    "arctan2": math.atan2,
    "maximum": max,
    "minimum": min,
    "real_power": math.pow,
    "from_row": lambda rows, first: rows[first:],
    "np": SimpleNamespace(
        inf=math.inf,
        nan=math.nan,
        empty=lambda shape, *_: zeros(*shape) if isinstance(shape, tuple) else zeros(shape),
        int8=np.int8,
        int64=np.int64,
        float64=np.float64,
    ),
}


def _as_compiled(name: str, plain: Callable[..., float]) -> Callable[..., float]:
    """What is plainly a number, and else what arrays have there."""
    of_numpy = array_function(name)

    def found(*numbers: float) -> float:
        try:
            return plain(*numbers)
        except FAULTS:
            with np.errstate(all="ignore"):
                return float(of_numpy(*map(np.float64, numbers)))

    return found


_GOING_ON = {
    name: _as_compiled(name, plain if plain.__module__ == "math" else array_function(name))  # max and min are blind to nan
    for name, plain in _FUNCTIONS.items()
    if callable(getattr(np, name, None))
}
_GOING_ON |= {"real_power": _as_compiled("power", math.pow), "quotient": _as_compiled("divide", operator.truediv)}
