"""The text of a module that is compiled for one law: functions of its formula, and loops that call them."""

from __future__ import annotations

import ast
import inspect
import operator
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache, cached_property, lru_cache
from types import ModuleType
from typing import Any

import sympy as sp

from duhem.expression import principal_axes, scalar_bounds
from duhem.expression.elementary import imports
from duhem.expression.scalar_jets import ScalarJets
from duhem.expression.syntax import module_tree
from duhem.projection.scaled_formula import ScaledFormula

__all__ = ["module_text", "over_unit"]

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
        imports({*scalar_bounds.FUNCTIONS} - {"isfinite"}),
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
    return list(map(_Part, _Taken(dict(constants)).visit(module_tree(text)).body))


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
