"""The text of a module with bodies in the places of calls, for a compiler that works through every function by itself."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from copy import deepcopy
from typing import Any

__all__ = ["pasted"]


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
