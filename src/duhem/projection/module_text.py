"""The text of a module that is compiled for one law: functions of its formula, and loops that call them, or stand pasted where they did."""

from __future__ import annotations

import ast
import inspect
import operator
from collections.abc import Callable, Collection, Mapping, Sequence
from copy import deepcopy
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
    tree = _Taken(constants).visit(ast.parse("\n".join([*functions, resized, *map(_source, (*principal_axes.FUNCTIONS, *sources))])))
    return "\n".join([*head, ast.unparse(_called(tree, entries))])


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


def _called(tree: ast.Module, entries: Sequence[str]) -> ast.Module:
    """The module without the functions that nothing calls."""
    named = {
        node.name: {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
    }
    reached, found = set[str](), set(entries) & named.keys()
    while found:
        reached |= found
        found = {name for one in found for name in named[one] if name in named} - reached
    tree.body = [node for node in tree.body if not isinstance(node, ast.FunctionDef) or node.name in reached]
    return tree


def _source(given: ModuleType | Callable[..., Any]) -> str:
    text = inspect.getsource(given)
    return text.partition(MARK)[2].partition("\n")[2] if inspect.ismodule(given) else text


def over_unit(name: str, weight: sp.Expr) -> str:
    """A datum of this weight in units of another ``size``, as text."""
    power = float(weight)
    return {0.0: name, 1.0: f"{name} / size", -1.0: f"{name} * size"}.get(power, f"{name} / size ** {power!r}")


# -- bodies in the places of calls, for a compiler that works through every function by itself --------------------------


def pasted(text: str, names: Collection[str]) -> str:
    """The text with the bodies of these functions, where a call of them is a statement, or all that is assigned.

    Such a function is worked through once where it is called, not by itself, then in the caller and then in whatever calls that.
    One that returns before its end stays as it is.
    """
    tree = ast.parse(text)
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    ending = {name: functions[name] for name in names if name in functions and _ends(functions[name])}
    for function in functions.values():
        _Pasted(ending).visit(function)
    return ast.unparse(ast.fix_missing_locations(tree))


def _ends(function: ast.FunctionDef) -> bool:
    """Whether it returns at its end alone, if anywhere."""
    return all(part is function.body[-1] for part in ast.walk(function) if isinstance(part, ast.Return))


class _Pasted(ast.NodeTransformer):
    """Puts bodies where functions are called; names of their own are marked with that of the function."""

    def __init__(self, functions: Mapping[str, ast.FunctionDef]) -> None:
        self.functions = functions

    def visit_Expr(self, node: ast.Expr) -> Any:
        """A call for what it does."""
        return self._body(node, [])

    def visit_Assign(self, node: ast.Assign) -> Any:
        """A call for what it returns."""
        return self._body(node, node.targets)

    def _body(self, node: ast.Expr | ast.Assign, targets: list[ast.expr]) -> Any:
        call = node.value
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in self.functions):
            return node
        function = deepcopy(self.visit(self.functions[call.func.id]))
        stored = (part.id for part in ast.walk(function) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store))
        named = {name: f"{name}_{function.name}" for name in stored}
        lines: list[ast.stmt] = []
        for parameter, given in zip([one.arg for one in function.args.args], call.args, strict=True):
            if isinstance(given, ast.Name) and parameter not in named:
                named[parameter] = given.id
            else:
                named[parameter] = f"{parameter}_{function.name}"
                lines.append(ast.Assign([ast.Name(named[parameter], ast.Store())], given))
        lines += function.body[ast.get_docstring(function) is not None :]
        for part in ast.walk(function):
            if isinstance(part, ast.Name):
                part.id = named.get(part.id, part.id)
        if isinstance(end := lines[-1], ast.Return):
            lines[-1:] = [ast.Assign(targets, end.value)] if targets and end.value else []
        return lines
