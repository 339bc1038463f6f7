"""Syntax trees of texts, for threads too."""

from __future__ import annotations

import ast
from threading import RLock

__all__ = ["expression_tree", "module_tree"]

_TURN = RLock()
"""CPython counts how deep a tree is that it makes in one place for all threads; another thread may come in while it makes one, with the
garbage that is collected, and then the count is off and a SystemError is raised (python/cpython issue 106905)."""


def module_tree(text: str) -> ast.Module:
    """The statements of a text; raises what ``ast.parse`` raises."""
    with _TURN:
        return ast.parse(text)


def expression_tree(text: str) -> ast.expr:
    """The one expression that a text is; raises what ``ast.parse`` raises."""
    with _TURN:
        return ast.parse(text, mode="eval").body
