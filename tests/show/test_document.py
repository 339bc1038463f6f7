"""A page holds what it is given as text, asks for nothing, and is the same each time; formulas break, and pictures take its colours."""

from __future__ import annotations

import re
import sys
from xml.etree import ElementTree

import pytest

from duhem.show import document
from duhem.show.document import Article, Block, Chapter, Columns, Display, Drawing, Lines, Paragraph, Sentences, Titled, as_page, themed
from duhem.show.printing import Typeset
from tests.oracles.strict_html import Strict

HOSTILE = "</title></style></pre><script>alert(1)</script><img src=x onerror=alert(2)>&amp;'\"\u202e\0"
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="10pt" viewBox="0 0 10 10">'
    '<defs><path id="a"/><path id="n"/><path id="n"/><style>*{fill: red}</style></defs><metadata>today</metadata>'
    '<use xlink:href="#a" clip-path="url(#b)" style="fill: #404040; stroke: #0072b2"/></svg>'
)


def page(*blocks: Block, title: str = "t") -> Strict:
    made = Strict()
    made.feed(as_page([Article(title, title, (Chapter(title, blocks),))]))
    made.close()
    return made


def test_whatever_stands_in_a_file_is_text() -> None:
    blocks = (
        Paragraph(HOSTILE),
        Sentences((HOSTILE,)),
        Titled(((HOSTILE, HOSTILE),)),
        Columns((HOSTILE, "b"), ((HOSTILE, HOSTILE),), ("proved",), 1),
        Lines(HOSTILE),
        Drawing(SVG, HOSTILE),
        Chapter(HOSTILE, ()),
    )
    seen = page(*blocks, title=HOSTILE)
    shown = HOSTILE.replace("\u202e", "\\u202e").replace("\0", "\\x00")
    assert seen.said.count(shown) == 3 + 10  # title, lead and chapter, and each of the blocks
    assert not {"script", "img", "link", "iframe", "object"} & seen.tags
    assert not [name for name in seen.attributes if name.startswith("on")]


def test_the_page_asks_for_nothing_and_runs_nothing() -> None:
    seen = page(Display("1", "a", "x", ("x",)), Drawing(SVG, "c"))
    assert seen.attributes["content"][0].startswith("default-src 'none';")
    assert not [value for name in ("src", "href", "xlink:href") for value in seen.attributes.get(name, ()) if not value.startswith("#")]
    assert "url(" not in seen.style and "@import" not in seen.style


def test_the_same_articles_give_the_same_bytes() -> None:
    articles = [Article("a", "b", (Chapter("c", (Drawing(SVG, "d"), Titled((("e", Typeset("x", r"\frac{x}{2}")),)))),))] * 2
    assert as_page(articles) == as_page(articles)
    assert [*re.findall(r'href="#(law-\d)"', as_page(articles))] == ["law-1", "law-2"]


def test_a_picture_has_the_greys_of_the_page_and_names_of_its_own() -> None:
    seen = themed(SVG, "p")
    (use,) = seen.iter("use")
    assert use.get("href") == "#p-a" and use.get("clip-path") == "url(#p-b)"
    assert [path.get("id") for path in seen.iter("path")] == ["p-a", None, None]
    fill, stroke = (use.get("style") or "").split("; ")
    assert fill == "fill: color-mix(in srgb,var(--ink) 74.9%,var(--paper))"
    assert stroke == "stroke: color-mix(in srgb,#0072b2,var(--ink) var(--lift))"
    assert {e.tag for e in seen.iter()} == {"svg", "defs", "path", "use"}
    assert (seen.get("viewBox"), seen.get("width")) == ("0 0 10 10", None)


def said(piece: ElementTree.Element) -> str:
    return "".join(piece.itertext())


def test_a_formula_breaks_before_its_relations_and_sums_and_nowhere_else() -> None:
    pytest.importorskip("latex2mathml")
    pieces = document.mathematics(r"D = - a \left(b - c\right) + \frac{d + e}{f} - g,\; h \geq 0")
    assert [said(piece) for piece in pieces] == ["D", "=−a(b−c)", "+d+ef", "−g,", "h", "≥0"]
    assert all(piece.tag == "math" for piece in pieces)
    pieces = document.mathematics(r"x = \max\bigl(a + b, c\bigr) + \bigl\|a + b\bigr\|_2 - \left\|a + b\right\|_2 + (d + e)")
    assert [said(piece) for piece in pieces] == ["x", "=max(a+b,c)", "+‖a+b‖2", "−‖a+b‖2", "+(d+e)"]


def test_what_a_page_has_no_use_for_is_not_on_it() -> None:
    pytest.importorskip("latex2mathml")
    cases = r"g = \begin{cases} \frac{a}{b} & \text{for}\: a > 0 \\[2pt] 0 & \text{otherwise} \end{cases}"
    assert "".join(map(said, document.mathematics(cases))) == "g={abfora>00otherwise"


def test_a_formula_that_is_wider_says_so() -> None:
    pytest.importorskip("latex2mathml")

    def wide(latex: str) -> float:
        (piece,) = document.mathematics(latex)
        return document.ems(piece)

    assert wide(r"\frac{a}{b}") < wide("abcd") < wide(r"\left(\begin{matrix}abcd & abcd\\a & b\end{matrix}\right)") < 13


def test_a_formula_wider_than_any_page_is_text() -> None:
    pytest.importorskip("latex2mathml")
    for count, tag in ((20, "<math"), (400, "<code>g &lt;= 0</code>")):
        assert tag in as_page([Article("a", "", (Chapter("c", (Titled((("e", Typeset("g <= 0", count * "x")),)),)),))])


def test_without_the_converter_formulas_are_text_and_the_page_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "latex2mathml.converter", None)
    made = as_page([Article("a", "", (Chapter("c", (Display("1", "n", "g <= 0", ("g",)),)),))])
    assert "<code>g &lt;= 0</code>" in made and "<math" not in made
    assert 'latex2mathml is not installed; install it with: pip install "duhem[report]"' in made


def test_a_formula_that_is_not_read_is_text() -> None:
    pytest.importorskip("latex2mathml")
    made = as_page([Article("a", "", (Chapter("c", (Display("1", "n", "g <= 0", ("g", r"\left( a")),)),))])
    assert "<code>g &lt;= 0</code>" in made


def test_the_strict_reader_sees_what_is_crooked() -> None:
    for crooked in ("<!DOCTYPE html><html><p></html>", "<!DOCTYPE html><html></p></html>", "<html></html>"):
        with pytest.raises(AssertionError):
            reader = Strict()
            reader.feed(crooked)
            reader.close()
