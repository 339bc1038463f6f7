"""Syntax trees that threads ask for at once."""

from __future__ import annotations

import ast
import gc
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import duhem
from duhem.expression.syntax import expression_tree, module_tree

FORMULA = "((a + b*3)**2 - (a - (b + (a*(b + 1)))))/(1 + a*a)"


class Garbage:
    """It is collected while a tree is made, and lets another thread come in."""

    def __init__(self) -> None:
        self.me = self

    def __del__(self) -> None:
        for _ in range(200):
            pass


@pytest.fixture
def restless() -> Iterator[None]:
    every, turn = gc.get_threshold(), sys.getswitchinterval()
    gc.set_threshold(50)
    sys.setswitchinterval(1e-5)
    yield
    gc.set_threshold(*every)
    sys.setswitchinterval(turn)


@pytest.mark.usefixtures("restless")
@pytest.mark.parametrize(
    "text", ["\n".join(f"def f{i}(a, b):\n    return {FORMULA}" for i in range(20)), f"({FORMULA})" + f" + ({FORMULA})" * 20]
)
def test_threads_make_trees_at_once(text: str) -> None:
    """CPython 3.11 raises a SystemError after a few of them where nobody waits for the other."""
    tree = module_tree if "def" in text else expression_tree
    alone = ast.dump(tree(text))

    def one(_: int) -> bool:
        for _ in range(20):
            Garbage()
        return ast.dump(tree(text)) == alone

    with ThreadPoolExecutor(6) as pool:
        assert all(pool.map(one, range(60)))


def test_nobody_else_asks_python_for_a_tree() -> None:
    """Only the catalogue does so too, because it must not import SymPy: it reads the first line of a law's module."""
    source = Path(duhem.__file__).parent
    assert {file.name for file in source.rglob("*.py") if "ast.parse(" in file.read_text("utf-8")} == {"syntax.py", "catalogue.py"}
