"""What shows a result: a result calls one of these, the module that prints it says for which type, and neither knows the other.

A room's ``__init__`` imports its printers, or the type names them as ``printed_by`` and they are imported when first asked:
whatever can exist can be shown.
"""

from __future__ import annotations

from functools import singledispatch
from importlib import import_module
from typing import Any, ClassVar, NoReturn

from duhem.show.page import PAGE, Page
from duhem.show.sheet import Sheet, as_html, as_markdown, as_text

__all__ = ["Shown", "draw", "html", "latex", "markdown", "plain", "sheet", "text"]


@singledispatch
def text(result: object, page: Page = PAGE, **options: Any) -> str:
    """The result for people, or else its sheet, in plain text as wide as ``page``; ``options`` as its own method takes them."""
    own = _own(text, result)
    return as_text(sheet(result), page) if own is None else str(own(result, page, **options))


@singledispatch
def markdown(result: object) -> str:
    """The result as Markdown, with formulas in LaTeX; its sheet, if it has no other."""
    own = _own(markdown, result)
    return as_markdown(sheet(result)) if own is None else str(own(result))


@singledispatch
def sheet(result: object) -> Sheet:
    """The result as fields, a table and notes."""
    made: Sheet = (_own(sheet, result) or _unshown(result, "a sheet"))(result)
    return made


def html(result: object, *, typeset: bool = False) -> str:
    """The result's sheet as :func:`duhem.show.sheet.as_html` writes it."""
    return as_html(sheet(result), typeset=typeset)


@singledispatch
def plain(result: object) -> dict[str, Any]:
    """The result in numbers, texts, lists and dictionaries of them, as JSON takes them."""
    made: dict[str, Any] = (_own(plain, result) or _unshown(result, "plain values"))(result)
    return made


@singledispatch
def latex(result: object) -> str:
    """The result in LaTeX: a document, or the formula that it is."""
    return str((_own(latex, result) or _unshown(result, "LaTeX"))(result))


@singledispatch
def draw(result: object, *place: Any, **options: Any) -> Any:
    """The result as a picture; ``place`` and ``options`` as its own ``plot`` takes them."""
    return (_own(draw, result) or _unshown(result, "a picture"))(result, *place, **options)


def _own(printer: Any, result: object) -> Any:
    """The printer of the result's type, once the module is there that its ``printed_by`` names; None where there is none."""
    if (module := getattr(type(result), "printed_by", None)) is not None:
        import_module(module)
    found = printer.dispatch(type(result))
    return None if found is printer.dispatch(object) else found


def _unshown(result: object, form: str) -> NoReturn:
    raise TypeError(f"{type(result).__name__} is not shown as {form}")


class Shown:
    """A result whose ``printed_by`` names the module that registers its printers; nothing of it is imported before it is shown."""

    printed_by: ClassVar[str]

    def to_text(self) -> str:
        """The result for people, in plain text."""
        return text(self)

    def to_html(self) -> str:
        """The result as a piece of HTML with all text escaped and formulas as text."""
        return html(self)

    def to_dict(self) -> dict[str, Any]:
        """The result in plain values, ready for JSON; exact numbers as text such as ``3/20``."""
        return plain(self)

    def _repr_html_(self) -> str:
        return html(self, typeset=True)

    def _repr_markdown_(self) -> str:
        return markdown(self)
