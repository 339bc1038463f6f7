"""What shows a result: a result calls one of these, the module that prints it says for which type, and neither knows the other.

A room's ``__init__`` imports its printers, so that whatever can exist can be shown.
"""

from __future__ import annotations

from functools import singledispatch
from typing import Any, NoReturn

from duhem.show.page import PAGE, Page

__all__ = ["draw", "latex", "markdown", "text"]


@singledispatch
def text(result: object, page: Page = PAGE, **options: Any) -> str:
    """The result for people, in plain text as wide as ``page``; ``options`` as its own method takes them."""
    _unshown(result, "text")


@singledispatch
def markdown(result: object) -> str:
    """The result as Markdown, with formulas in LaTeX."""
    _unshown(result, "Markdown")


@singledispatch
def latex(result: object) -> str:
    """The result as a LaTeX document."""
    _unshown(result, "LaTeX")


@singledispatch
def draw(result: object, *place: Any, **options: Any) -> Any:
    """The result as a picture; ``place`` and ``options`` as its own ``plot`` takes them."""
    _unshown(result, "a picture")


def _unshown(result: object, form: str) -> NoReturn:
    raise TypeError(f"{type(result).__name__} is not shown as {form}")
