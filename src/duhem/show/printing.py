"""What shows a result: a result calls one of these, the module that prints it says for which type, and neither knows the other.

A room's ``__init__`` imports its printers, or the type names them as ``printed_by`` and they are imported when first asked:
whatever can exist can be shown.

A sheet is a result as titled fields, one table and notes, written as text, HTML or Markdown.  All text is text: what comes from a file is
escaped here and nowhere else, so that a law named ``<script>`` is shown under that name and a ``$`` in a source begins no formula.
Formulas are LaTeX made by SymPy.

Names and numbers are written in formulas in one way, on paper and on figures alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape
from importlib import import_module
from math import isfinite
from typing import Any, ClassVar, NoReturn

from duhem.show.page import PAGE, Page

__all__ = [
    "Sheet", "Shown", "Typeset", "draw", "finite", "html", "latex", "latex_name", "latex_number", "markdown", "marked", "plain", "sheet",
    "text",
]  # fmt: skip


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
    """The result's sheet as :func:`as_html` writes it."""
    return as_html(sheet(result), typeset=typeset)


@singledispatch
def plain(result: object) -> dict[str, Any]:
    """The result in numbers, texts, lists and dictionaries of them, as JSON takes them."""
    made: dict[str, Any] = (_own(plain, result) or _unshown(result, "plain values"))(result)
    return made


def finite(value: Any) -> Any:
    """Dictionaries, lists, texts and numbers as JSON has them: what is not finite is none."""
    if isinstance(value, Mapping):
        return {key: finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [*map(finite, value)]
    return None if isinstance(value, float) and not isfinite(value) else value


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


# -- sheets ------------------------------------------------------------------------------------------------------------


_TYPESET = "$\\"  # what begins a formula for MathJax; in an element of its own it does not
_MARKS = r"\`*_[]|$~#"  # of Markdown; those of HTML are written as entities


@dataclass(frozen=True)
class Typeset:
    """A formula in the words of a criterion file, and in LaTeX."""

    text: str
    latex: str


@dataclass(frozen=True)
class Sheet:
    """``fields`` are pairs of title and content, ``rows`` stand under ``head``, ``notes`` are titled lists of sentences."""

    title: str
    fields: tuple[tuple[str, str | Typeset], ...] = ()
    head: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    notes: tuple[tuple[str, tuple[str, ...]], ...] = ()


def as_text(sheet: Sheet, page: Page) -> str:
    """Plain text within the width of the page."""
    size = max((len(title) for title, _ in sheet.fields), default=0)
    fields = [line for title, said in sheet.fields for line in page.field(title, said if isinstance(said, str) else said.text, size)]
    rows = page.table([sheet.head, *sheet.rows], "l", "") if sheet.rows else []
    return page.report([[*page.hanging(sheet.title), *fields], rows, *(page.items(title, sentences) for title, sentences in sheet.notes)])


def as_html(sheet: Sheet, *, typeset: bool = False) -> str:
    """A piece of HTML without style, script or link; formulas as text, or with ``typeset`` as the LaTeX that notebooks set."""
    return "\n".join(["<div>", *_html(sheet, typeset), "</div>"])


def _html(sheet: Sheet, typeset: bool) -> Iterator[str]:
    yield f"<p><strong>{_prose(sheet.title)}</strong></p>"
    if sheet.fields:
        yield "<table>"
        for title, content in sheet.fields:
            yield f'<tr><th scope="row">{_prose(title)}</th><td>{_cell(content, typeset)}</td></tr>'
        yield "</table>"
    if sheet.rows:
        yield "<table>"
        yield f"<thead>{_row(sheet.head, 'th')}</thead>"
        yield "<tbody>"
        for row in sheet.rows:
            yield _row(row, "td")
        yield "</tbody></table>"
    for title, sentences in sheet.notes:
        if sentences:
            yield f"<p>{_prose(title)}</p>"
            yield f"<ul>{''.join(f'<li>{_prose(sentence)}</li>' for sentence in sentences)}</ul>"


def _row(cells: Sequence[str], tag: str) -> str:
    return f"<tr>{''.join(f'<{tag}>{_prose(cell)}</{tag}>' for cell in cells)}</tr>"


def _cell(content: str | Typeset, typeset: bool) -> str:
    if isinstance(content, str):
        return _prose(content)
    return escape(rf"$\displaystyle {content.latex}$") if typeset else f"<code>{escape(content.text)}</code>"


def _prose(text: str) -> str:
    return "".join(f"<span>{c}</span>" if c in _TYPESET else c for c in escape(text))


def as_markdown(sheet: Sheet) -> str:
    """Markdown with a table of GitHub's kind; formulas in LaTeX."""
    lines = [f"**{marked(sheet.title)}**", ""]
    lines += [f"- {marked(title)}: {_formula(content)}" for title, content in sheet.fields]
    if sheet.rows:
        table = [sheet.head, tuple("---" for _ in sheet.head), *(tuple(map(marked, row)) for row in sheet.rows)]
        lines += ["", *(f"| {' | '.join(row)} |" for row in table)]
    for title, sentences in sheet.notes:
        if sentences:
            lines += ["", f"{marked(title)}:", "", *(f"- {marked(sentence)}" for sentence in sentences)]
    return "\n".join(lines) + "\n"


def _formula(content: str | Typeset) -> str:
    return marked(content) if isinstance(content, str) else f"${content.latex}$"


def marked(text: str) -> str:
    """Text that is text in Markdown."""
    return "".join(f"\\{c}" if c in _MARKS else c for c in escape(" ".join(text.split()), quote=False))


# -- names and numbers in formulas -------------------------------------------------------------------------------------


_GREEK = {
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi", "pi", "rho",
    "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi",
    "Psi", "Omega",
}  # fmt: skip


def latex_name(name: str) -> str:
    """``mu_a_plus`` as mu with index a and exponent +; Greek names as letters; other words upright."""
    head, *rest = name.split("_")
    digits = head.lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
    if digits.isdigit():
        head, rest = head[: -len(digits)], [digits, *rest]
    sign = {"plus": "+", "minus": "-"}.get(rest[-1]) if rest else None
    rest = rest[:-1] if sign else rest
    base = f"\\{head}" if head in _GREEK else head if len(head) == 1 else rf"\mathrm{{{head}}}"
    inner = ",".join(r if r.isdigit() or len(r) == 1 else rf"\mathrm{{{r}}}" for r in rest)
    index = f"_{{{inner}}}" if inner else ""
    return base + index + (f"^{{{sign}}}" if sign else "")


def latex_number(x: float, digits: int = 4) -> str:
    """``x`` to some digits; where those need a power of ten, as one."""
    mantissa, _, power = f"{x:.{digits}g}".partition("e")
    if not power:
        return mantissa
    factor = {"1": "", "-1": "-"}.get(mantissa, rf"{mantissa} \cdot ")
    return f"{factor}10^{{{int(power)}}}"
