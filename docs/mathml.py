"""Formulas as MathML, which browsers show by themselves: no script, no fonts, no network."""

import re
from html import escape, unescape

from docutils.nodes import SkipNode
from latex2mathml.converter import convert

_TAG = re.compile(r"\\tag\{([^}]*)\}")
_BOLD = re.compile(r'<mi mathvariant="bold(?:-italic)?">([^<]+)</mi>')
_NAME = r"<m[io][^>]*>(?:cos|det|exp|max|sin|sup|tan|tr)</m[io]>"
_BEFORE_AN_ARGUMENT = re.compile(rf"({_NAME}|<msup>{_NAME}<mn>2</mn></msup>)(?=<m[insr])")
_BOLD_LETTERS = (("a", "z", 0x1D41A), ("A", "Z", 0x1D400), ("α", "ω", 0x1D736))  # first, last, and the first in bold


def mathml(latex: str, display: str = "inline") -> str:
    """A formula as browsers show it: they know bold letters by their own codes only, and no space behind the name of a function."""
    made = convert(latex.replace(r"\lvert", r"\left|").replace(r"\rvert", r"\right|"), display=display)
    made = _BOLD.sub(lambda match: f"<mi>{_bold(unescape(match[1]))}</mi>", made)
    return _BEFORE_AN_ARGUMENT.sub(r'\1<mspace width="0.17em"/>', made)


def _bold(letter):
    return next((chr(bold + ord(letter) - ord(first)) for first, last, bold in _BOLD_LETTERS if first <= letter <= last), letter)


def inline(writer, node):
    writer.body.append(mathml(node.astext()))
    raise SkipNode


def displayed(writer, node):
    """A formula on a line of its own, with its ``\\tag`` at the end of the line."""
    text = node.astext()
    tag = _TAG.search(text)
    number = f'<span class="eqno">({escape(tag[1])})</span>' if tag else ""
    writer.body.append(f'<div class="math" tabindex="0">{mathml(_TAG.sub("", text), "block")}{number}</div>')
    raise SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", inline_renderers=(inline, None), block_renderers=(displayed, None))
