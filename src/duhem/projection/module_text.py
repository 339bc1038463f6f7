"""The text of a module that is compiled for one law: functions of its formula, and loops that call them, or stand pasted where they did."""

from __future__ import annotations

import ast
import inspect
import operator
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache, cached_property, lru_cache
from types import ModuleType
from typing import Any

import sympy as sp

from duhem.expression import principal_axes, scalar_bounds, scalar_jets
from duhem.expression.elementary import imports
from duhem.expression.scalar_jets import ScalarJets
from duhem.projection.scaled_formula import ScaledFormula

__all__ = ["module_text", "over_unit", "pasted"]

MARK = "# -- compiled from here"

_COMPARED: Mapping[type[ast.cmpop], Callable[[Any, Any], bool]] = {ast.Eq: operator.eq, ast.Gt: operator.gt}


def module_text(
    formula: ScaledFormula,
    d: int,
    jets: ScalarJets,
    functions: Sequence[str],
    sources: Sequence[ModuleType | Callable[..., Any]],
    entries: Sequence[str],
    **others: int,
) -> str:
    """``functions`` of the formula in ``d`` forces, then the ``sources``: functions, or modules from their mark on.

    A branch that is never taken for the kinks and pairs there are and the ``others``, constants by name, is left out, and then each
    function that the ``entries`` do not call: what is not there need not be compiled.  The text depends on the law's parameters by
    their exponents and whole numbers alone.
    """
    pairs = jets.pairs if d > 2 else 0  # an edge of one has three normals
    constants = {"D": d, "KINKS": jets.kinks, "PAIRS": pairs, "DATA": len(formula.data), **others}
    head = [
        "from math import floor, frexp, isfinite, ldexp",
        "from typing import Any",
        "import numpy as np",
        imports({*scalar_jets.FUNCTIONS, *scalar_bounds.FUNCTIONS} - {"isfinite"}),
        *(f"{name} = {value}" for name, value in constants.items()),
    ]
    lines = [f"    q[{k}] = {over_unit(f'data[n, {k}]', datum.weight)}" for k, datum in enumerate(formula.data.values())]
    resized = "\n".join(["def resized(data, n, size, q):", *lines, "    return"])
    ours = "\n".join(map(_source, (*principal_axes.FUNCTIONS, *sources)))
    parts = [part for text in ("\n".join([*functions, resized]), ours) for part in _parts(text, tuple(constants.items()))]
    named = {part.name: part for part in parts if part.name}
    kept = called(named, lambda name: named[name].names, entries)
    return "\n".join([*head, "\n".join(part.text for part in parts if not part.name or part.name in kept).lstrip()])


class _Part:
    """A statement of a module, and the name of the function that it defines if it does."""

    def __init__(self, node: ast.stmt) -> None:
        self._node = node
        self.name = node.name if isinstance(node, ast.FunctionDef) else ""

    @cached_property
    def names(self) -> frozenset[str]:
        return names_in(self._node)

    @cached_property
    def text(self) -> str:
        return "\n" * bool(self.name) + ast.unparse(self._node)


@lru_cache(maxsize=256)
def _parts(text: str, constants: tuple[tuple[str, int], ...]) -> list[_Part]:
    """What is left of a text; most of ours is the same for many laws."""
    return list(map(_Part, _Taken(dict(constants)).visit(ast.parse(text)).body))


class _Taken(ast.NodeTransformer):
    """Leaves of each branch that constants decide what is taken."""

    def __init__(self, constants: Mapping[str, int]) -> None:
        self.constants = constants

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        """A comparison of a constant with a number is True or False."""
        if isinstance(node.left, ast.Name) and node.left.id in self.constants and isinstance(node.comparators[0], ast.Constant):
            return ast.Constant(_COMPARED[type(node.ops[0])](self.constants[node.left.id], node.comparators[0].value))
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        """Of ``and`` and ``or`` what is left of them."""
        self.generic_visit(node)
        ends = isinstance(node.op, ast.Or)
        kept: list[ast.expr] = []
        for value in node.values:
            if not isinstance(value, ast.Constant):
                kept.append(value)
            elif value.value is ends:
                kept.append(value)
                break
        node.values = kept or [ast.Constant(not ends)]
        return node.values[0] if len(node.values) == 1 else node

    def visit_If(self, node: ast.If) -> Any:
        """The branch that is taken."""
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return (node.body if node.test.value else node.orelse) or ast.Pass()
        return node


def called(functions: Collection[str], names: Callable[[str], Collection[str]], entries: Collection[str]) -> set[str]:
    """Those of some functions, by the ``names`` in each, that the ``entries`` are or call."""
    reached, found = set[str](), {name for name in entries if name in functions}
    while found:
        reached |= found
        found = {name for one in found for name in names(one) if name in functions} - reached
    return reached


def names_in(node: ast.AST) -> frozenset[str]:
    """Every name that is read or given."""
    return frozenset(part.id for part in ast.walk(node) if isinstance(part, ast.Name))


@cache
def _source(given: ModuleType | Callable[..., Any]) -> str:
    text = inspect.getsource(given)
    return text.partition(MARK)[2].partition("\n")[2] if inspect.ismodule(given) else text


def over_unit(name: str, weight: sp.Expr) -> str:
    """A datum of this weight in units of another ``size``, as text."""
    power = float(weight)
    return {0.0: name, 1.0: f"{name} / size", -1.0: f"{name} * size"}.get(power, f"{name} / size ** {power!r}")


# -- bodies in the places of calls, for a compiler that works through every function by itself --------------------------


@lru_cache(maxsize=128)
def pasted(text: str, names: tuple[str, ...]) -> str:
    """The text with the bodies of these functions, where a call of them is a statement, or all that is assigned.

    Such a function is worked through once where it is called, not by itself, then in the caller and then in whatever calls that.
    One that returns before its end stays as it is.
    """
    tree = ast.parse(text)
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    into = _Pasted({name: functions[name] for name in names if name in functions and _ends(functions[name])})
    for function in functions.values():
        into.fill(function)
    return ast.unparse(tree)


def _ends(function: ast.FunctionDef) -> bool:
    """Whether it returns at its end alone, if anywhere."""
    return all(part is function.body[-1] for part in ast.walk(function) if isinstance(part, ast.Return))


class _Pasted:
    """Puts bodies where functions are called, in each function once; names of their own are marked with that of the function."""

    def __init__(self, functions: Mapping[str, ast.FunctionDef]) -> None:
        self.functions, self.filled = functions, set[str]()

    def fill(self, function: ast.FunctionDef) -> ast.FunctionDef:
        """The function with bodies in it."""
        if function.name not in self.filled:
            self.filled.add(function.name)
            self._fill(function)
        return function

    def _fill(self, node: Any) -> None:
        for lines in (getattr(node, name, None) for name in ("body", "orelse")):
            if isinstance(lines, list):
                lines[:] = [one for line in lines for one in self._in_place_of(line)]

    def _in_place_of(self, line: ast.stmt) -> list[ast.stmt]:
        if isinstance(line, ast.Expr):  # a call for what it does
            return self._body(line, [])
        if isinstance(line, ast.Assign):  # a call for what it returns
            return self._body(line, line.targets)
        self._fill(line)
        return [line]

    def _body(self, line: ast.Expr | ast.Assign, targets: list[ast.expr]) -> list[ast.stmt]:
        call = line.value
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in self.functions):
            return [line]
        function = self.fill(self.functions[call.func.id])
        stored = (part.id for part in ast.walk(function) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store))
        named = {name: f"{name}_{function.name}" for name in stored}
        lines: list[ast.stmt] = []
        for parameter, given in zip([one.arg for one in function.args.args], call.args, strict=True):
            if isinstance(given, ast.Name) and parameter not in named:
                named[parameter] = given.id
            else:
                named[parameter] = f"{parameter}_{function.name}"
                lines.append(ast.Assign([ast.Name(named[parameter], ast.Store())], given, lineno=line.lineno))
        lines += (_renamed(own, named) for own in function.body[ast.get_docstring(function) is not None :])
        if isinstance(end := lines[-1], ast.Return):
            lines[-1:] = [ast.Assign(targets, end.value, lineno=line.lineno)] if targets and end.value else []
        return lines


def _renamed(node: Any, named: Mapping[str, str]) -> Any:
    """A copy with other names, which knows no columns: nobody asks for them."""
    if isinstance(node, list):
        return [_renamed(part, named) for part in node]
    if isinstance(node, ast.Name):
        return ast.Name(named.get(node.id, node.id), node.ctx)
    if not isinstance(node, ast.AST) or not node._fields:
        return node
    made: Any = type(node)(*(_renamed(getattr(node, name, None), named) for name in node._fields))
    if isinstance(node, ast.stmt):
        made.lineno = node.lineno
    return made
