"""Bodies in the places of calls do what the calls did."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from duhem.projection.module_text import pasted

TEXT = '''
FACTOR = 3

def changed(rows, k, by):
    """What is given stays as it is, and so do names of who calls."""
    by = by * FACTOR
    for i in range(len(rows)):
        rows[i] += by + k

def total(rows):
    found = 0
    for one in rows:
        found += one
    return found

def first_over(rows, most):
    for one in rows:
        if one > most:
            return one
    return most

def both(rows, by):
    changed(rows, by, by + 1)
    found = total(rows)
    return found, by

def entry(rows, by):
    i, one = 7, 8
    changed(rows, 1, by)
    sums = total(rows)
    found, same = both(rows, by + i)
    top = first_over(rows, by)
    return sums, found, same, by, i, one, top, total(rows) + 1
'''
EVERY = ("changed", "total", "first_over", "both", "unknown")


def run(text: str) -> tuple[list[int], Any]:
    space: dict[str, Any] = {}
    exec(text, space)
    rows = [1, 2, 3]
    return rows, space["entry"](rows, 5)


def calls(text: str) -> list[str]:
    entry = next(node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name == "entry")
    return sorted(node.func.id for node in ast.walk(entry) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name))


@pytest.mark.parametrize("names", [(), ("total",), ("changed", "both"), EVERY])
def test_the_text_does_the_same(names: tuple[str, ...]) -> None:
    """Whatever is pasted: names of its own, numbers for parameters, parameters that change, and several returned."""
    assert run(pasted(TEXT, names)) == run(TEXT)


def test_what_is_pasted_is_called_no_more() -> None:
    """But for what returns on the way, and for a call within an expression."""
    assert calls(pasted(TEXT, EVERY)) == ["first_over", "len", "len", "range", "range", "total"]
    assert pasted(TEXT, ()) == ast.unparse(ast.parse(TEXT))
