"""What is compiled for a law has no branch that constants decide, and no function that nothing calls."""

from __future__ import annotations

import ast

import pytest

from duhem.projection import compiled_newton
from duhem.projection.module_text import _Taken, called, names_in
from duhem.projection.projector import Projector

BRANCHES = """
if N > 0 and x > 1:
    a = 1
elif N == 0:
    a = 2
else:
    a = 3
b = N == 0 or x > 1
c = x > 1 and N > 0
"""


@pytest.mark.parametrize("n", [0, 1])
@pytest.mark.parametrize("x", [0.0, 2.0])
def test_what_is_left_of_branches_does_the_same(n: int, x: float) -> None:
    taken = ast.unparse(_Taken({"N": n}).visit(ast.parse(BRANCHES)))
    assert "N" not in taken and ("if" in taken) == (n == 1)
    plain, short = {"N": n, "x": x}, {"x": x}
    exec(BRANCHES, plain)
    exec(taken, short)
    assert [plain[name] for name in "abc"] == [short[name] for name in "abc"]


def test_a_function_stays_where_an_entry_needs_it() -> None:
    text = "K = 1\ndef one(): return two()\ndef two(): return K\ndef three(): return four()\ndef four(): return one()\n"
    functions = {node.name: names_in(node) for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    kept = [called(functions, functions.__getitem__, entries) for entries in (["one"], ["three", "none"])]
    assert kept == [{"one", "two"}, functions.keys()]


def test_a_smooth_law_has_no_pieces_to_exchange_and_tresca_has() -> None:
    for name, pieces in (("von-mises", False), ("tresca", True)):
        asked = Projector.of(name, 1.0, {"yield_stress": 2}).setting
        made = compiled_newton._made(asked.g, asked.law.force_symbols(), None, "solve", ())
        assert made is not None
        assert all((f"def {each}(" in made[0]) == pieces for each in ("exchanged", "added", "followed")) and "def apex(" in made[0]
