"""A page that stands alone: articles of chapters, written as one HTML file that asks nothing of a network and runs nothing.

All text is text: the page is a tree, and what writes the tree escapes it.  Formulas are MathML that breaks between its terms and
fits its line where latex2mathml is there (extra ``report``).
A sheet of matplotlib's is a part of it: its greys are mixed of the page's ink and paper, its colours lifted where that is dark.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from itertools import chain
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from duhem.errors import MissingExtraError, imported_from
from duhem.show.page import printable
from duhem.show.printing import Typeset
from duhem.version import __version__

__all__ = [
    "Article", "Block", "Chapter", "Columns", "Display", "Drawing", "Lines", "Paragraph", "Sentences", "Titled", "as_page", "check",
    "ems", "mathematics", "themed",
]  # fmt: skip

_RELATIONS = {"=", "≤", "≥", "<", ">", "∈", "⇒", "≠"}
_SUMS = {"+", "−", "-"}
_NORM = "‖"
_BRACKETS = {"(": ")", "[": "]", "{": "}", "⟨": "⟩"}
_OPEN = _RELATIONS | _SUMS | {"(", "[", "{", ",", ";", "⋅", "⟨", "|", _NORM}
_ROOM = re.compile(r"(?<=\\\\)\[\w+\]")  # between rows: a page has its own
_SURE = 1.15  # fonts differ
_SCRIPT = 0.72  # of the size of letters
_GAP = 0.9  # between the columns of a table
_BARS = {"|": 0.3, _NORM: 0.45}


def check() -> None:
    """Raises MissingExtraError without latex2mathml."""
    with imported_from("latex2mathml", "report"):
        import latex2mathml.converter  # noqa: F401


def mathematics(latex: str) -> tuple[Element, ...]:
    """The formula in pieces between which a line may break: before relations, sums and after commas of no bracket.

    Each carries as ``style`` its estimated width in letters, ``--ems``, by which a page makes it fit.
    None of them where the formula is not read.  Raises MissingExtraError without latex2mathml.
    """
    check()
    from latex2mathml.converter import convert

    try:
        root = _plain(ElementTree.fromstring(convert(_ROOM.sub("", latex))))
    except Exception:  # of a reader of others, whose errors have nothing in common
        return ()
    row = root[0] if len(root) == 1 and root[0].tag == "mrow" else root
    return tuple(_piece(part) for part in _pieces(list(row)))


def _plain(element: Element) -> Element:
    """The element without namespaces, which a page has no need of, and with brackets close to what they hold."""
    for each in element.iter():
        each.tag = each.tag.rpartition("}")[2]
        if each.text == r"\|":  # the converter leaves it so behind a size
            each.text = _NORM
        if each.get("fence"):
            each.attrib |= {"lspace": "0", "rspace": "0"}
    return element


def _pieces(row: list[Element]) -> Iterator[list[Element]]:
    piece: list[Element] = []
    depth, within = 0, False
    for element in row:
        said = _sign(element)
        depth += (said in _BRACKETS) - (said in _BRACKETS.values())
        within ^= said == _NORM
        free = depth <= 0 and not within
        if piece and free and (said in _RELATIONS or (said in _SUMS and not _opens(piece))):
            yield piece
            piece = []
        piece.append(element)
        if free and said in (",", ";"):
            yield piece
            piece = []
    if piece:
        yield piece


def _sign(element: Element) -> str:
    """The sign that an element is, with an index or without."""
    base = element[0] if element.tag in ("msub", "msup", "msubsup") else element
    return base.text or "" if base.tag == "mo" else ""


def _opens(piece: list[Element]) -> bool:
    """Whether what follows the piece is a sign, not a sum."""
    return piece[-1].tag == "mo" and (piece[-1].text or "") in _OPEN


def _piece(elements: list[Element]) -> Element:
    if len(elements) > 1 and elements[0].tag == "mo" and elements[0].text in _RELATIONS | _SUMS:
        elements[0].set("form", "infix")
    math = Element("math", displaystyle="true")
    ElementTree.SubElement(math, "mrow").extend(elements)
    math.set("style", f"--ems:{max(_SURE * _width(math), 1.0):.1f}")
    return math


def ems(piece: Element) -> float:
    """The estimated width of a piece."""
    return float((piece.get("style") or "").removeprefix("--ems:"))


def _wide(sign: str, fence: bool) -> float:
    """About how many ems a sign is wide, with the room that a browser leaves beside it; brackets grow with what they hold."""
    if fence:
        return _BARS.get(sign, 0.9)
    if sign in _RELATIONS:
        return 1.35
    return 1.2 if sign in _SUMS else 0.45 if sign in ",;" else 0.95


def _width(element: Element, displayed: bool = True) -> float:
    """About how many ems it is wide; where it is not ``displayed``, quotients are written smaller."""
    match element.tag:
        case "mi" | "mn" | "mtext":
            return 0.56 * len(element.text or "")
        case "mo":
            return _wide(element.text or "", bool(element.get("fence")))
        case "mspace":
            return float((element.get("width") or "0em").removesuffix("em") or 0)
        case "mfrac":
            return (1.0 if displayed else _SCRIPT) * max(_width(part, False) for part in element) + 0.2
        case "msub" | "msup" | "msubsup" | "munderover":
            base, *scripts = element
            return _width(base, displayed) + _SCRIPT * max(_width(script, False) for script in scripts)
        case "mover" | "munder":
            return _width(element[0], displayed)
        case "msqrt" | "mroot":
            return sum(_width(part, displayed) for part in element) + 0.9
        case "mtable":
            columns = max(map(len, element), default=0)
            each = (max((_width(row[i], False) for row in element if i < len(row)), default=0.0) for i in range(columns))
            return sum(each) + _GAP * columns
        case _:
            return sum(_width(part, displayed) for part in element)


_WIDEST = 90.0  # ems: on paper its letters would be of 5 points
_POLICY = "default-src 'none'; style-src 'unsafe-inline'"

_COLOUR = re.compile(r"#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})(?![0-9a-f])")
_NAMED = re.compile(r"(?:href=\"|url\()#([^\")]+)")
_LINK = "{http://www.w3.org/1999/xlink}href"
_INHERITED = "fill:var(--ink);stroke-linejoin:round;stroke-linecap:butt"  # what matplotlib says of every element of its file


@dataclass(frozen=True)
class Paragraph:
    """A paragraph; ``kind`` marks what stands out, as a class of the style."""

    text: str
    kind: str = ""


@dataclass(frozen=True)
class Sentences:
    """A list."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Titled:
    """Pairs of title and content."""

    fields: tuple[tuple[str, str | Typeset], ...]


@dataclass(frozen=True)
class Columns:
    """``rows`` under ``head``; ``kinds`` has a class of the style for each row, ``marked`` is the column that shows it."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    kinds: tuple[str, ...] = ()
    marked: int = -1


@dataclass(frozen=True)
class Display:
    """A numbered formula with a sentence: in plain ``text``, and in ``rows`` of LaTeX with those that say what is ``named`` in them."""

    number: str
    note: str
    text: str
    rows: tuple[str, ...]
    named: tuple[str, ...] = ()


@dataclass(frozen=True)
class Drawing:
    """A picture, as the text of an SVG file, with what stands below it."""

    svg: str
    caption: str


@dataclass(frozen=True)
class Lines:
    """Text whose lines stay as they are."""

    text: str


@dataclass(frozen=True)
class Chapter:
    """Blocks under a title; chapters among them are parts of it."""

    title: str
    blocks: tuple[Block, ...]


Block = Paragraph | Sentences | Titled | Columns | Display | Drawing | Lines | Chapter


@dataclass(frozen=True)
class Article:
    """What is said of one thing: a title, a sentence below it, and chapters."""

    title: str
    lead: str
    chapters: tuple[Chapter, ...]


def as_page(articles: Sequence[Article]) -> str:
    """The whole HTML file, the same for the same articles."""
    return _Page().written(articles)


class _Page:
    """One page in the making: pictures are counted, and it is known whether formulas can be typeset."""

    def __init__(self) -> None:
        self.drawings = 0
        try:
            check()
            self.without = ""
        except MissingExtraError as fault:
            self.without = f"Formulas are shown as text: {fault}."

    def written(self, articles: Sequence[Article]) -> str:
        title = ", ".join(article.title for article in articles)
        page = Element("html", lang="en")
        head = SubElement(page, "head")
        SubElement(head, "meta", charset="utf-8")
        SubElement(head, "meta", {"http-equiv": "Content-Security-Policy", "content": _POLICY})
        SubElement(head, "meta", name="viewport", content="width=device-width, initial-scale=1")
        SubElement(head, "meta", name="generator", content=f"duhem {__version__}")
        SubElement(head, "title").text = printable(f"{title} - duhem")
        SubElement(head, "style").text = files("duhem.show").joinpath("document.css").read_text("utf-8")
        body = SubElement(page, "body")
        if len(articles) > 1:
            contents = SubElement(SubElement(body, "nav"), "ul")
            for i, article in enumerate(articles, 1):
                SubElement(SubElement(contents, "li"), "a", href=f"#law-{i}").text = printable(article.title)
        main = SubElement(body, "main")
        for i, article in enumerate(articles, 1):
            self._article(SubElement(main, "article", id=f"law-{i}"), article)
        return "<!DOCTYPE html>\n" + ElementTree.tostring(page, encoding="unicode", method="html") + "\n"

    def _article(self, place: Element, article: Article) -> None:
        head = SubElement(place, "header")
        _say(head, "h1", article.title)
        if article.lead:
            _say(head, "p", article.lead)
        if self.without:
            _say(head, "p", self.without, "without")
        for chapter in article.chapters:
            self._chapter(place, chapter, 2)

    def _chapter(self, place: Element, chapter: Chapter, level: int) -> None:
        section = SubElement(place, "section")
        _say(section, f"h{min(level, 6)}", chapter.title)
        drawings: Element | None = None
        for block in chapter.blocks:
            if isinstance(block, Drawing):  # side by side where there is room
                drawings = SubElement(section, "div", {"class": "drawings"}) if drawings is None else drawings
                self._drawing(drawings, block)
                continue
            drawings = None
            if isinstance(block, Chapter):
                self._chapter(section, block, level + 1)
            else:
                self._block(section, block)

    def _block(self, place: Element, block: Paragraph | Sentences | Titled | Columns | Display | Lines) -> None:
        match block:
            case Paragraph(text, kind):
                _say(place, "p", text, kind)
            case Sentences(items):
                rows = SubElement(place, "ul")
                for item in items:
                    _say(rows, "li", item)
            case Titled(fields):
                pairs = SubElement(place, "dl")
                for title, content in fields:
                    _say(pairs, "dt", title)
                    self._content(SubElement(pairs, "dd"), content)
            case Columns():
                _grid(place, block)
            case Display():
                self._display(place, block)
            case Lines(text):
                _say(SubElement(place, "pre"), "code", text)

    def _display(self, place: Element, block: Display) -> None:
        shown = SubElement(place, "div", {"class": "display"})
        _say(shown, "p", block.note)
        line = SubElement(shown, "div", {"class": "line"})
        formula = SubElement(line, "div", {"class": "formula"})
        if not self._typeset(formula, (*block.rows, *((r"\text{where}", *block.named) if block.named else ()))):
            _say(formula, "code", block.text)
        _say(line, "span", f"({block.number})", "number")

    def _content(self, place: Element, content: str | Typeset) -> None:
        if isinstance(content, str):
            place.text = printable(content)
        elif not self._typeset(place, (content.latex,)):
            _say(place, "code", content.text)

    def _typeset(self, place: Element, rows: Sequence[str]) -> bool:
        """Whether all rows are there, each on a line that breaks between its pieces; not where a piece is wider than any page."""
        every = [] if self.without else [mathematics(row) for row in rows]
        if not every or not all(every) or max(map(ems, chain.from_iterable(every))) > _WIDEST:
            return False
        for pieces in every:
            line = SubElement(place, "div", {"class": "mathematics"})
            for piece in pieces:
                piece.tail = " "
                line.append(piece)
        return True

    def _drawing(self, place: Element, block: Drawing) -> None:
        self.drawings += 1
        name = f"picture-{self.drawings}"
        figure = SubElement(place, "figure")
        picture = themed(block.svg, name)
        picture.attrib |= {"role": "img", "aria-labelledby": f"{name}-caption"}
        figure.append(picture)
        _say(figure, "figcaption", block.caption).set("id", f"{name}-caption")


def _grid(place: Element, block: Columns) -> None:
    table = SubElement(place, "table")
    row = SubElement(SubElement(table, "thead"), "tr")
    for title in block.head:
        _say(row, "th", title).set("scope", "col")
    body = SubElement(table, "tbody")
    for i, cells in enumerate(block.rows):
        row = SubElement(body, "tr")
        for j, (title, cell) in enumerate(zip(block.head, cells, strict=True)):
            made = SubElement(row, "th", scope="row") if j == 0 else SubElement(row, "td", {"data-title": printable(title)})
            if block.kinds and j == block.marked:
                _say(made, "span", cell, f"verdict {block.kinds[i]}")
            else:
                made.text = printable(cell)


def _say(place: Element, tag: str, text: str, kind: str = "") -> Element:
    made = SubElement(place, tag, {"class": kind} if kind else {})
    made.text = printable("\n".join(line.expandtabs() for line in text.splitlines()))
    return made


def themed(svg: str, name: str) -> Element:
    """The text of an SVG file as an element; the names that it needs begin with ``name``, so that several stand on one page."""
    root = ElementTree.fromstring(svg)
    for parent in root.iter():
        for child in [*parent]:
            if child.tag.rpartition("}")[2] in ("metadata", "style"):
                parent.remove(child)
    needed = set(_NAMED.findall(svg))
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        if element.get("id") not in needed:
            element.attrib.pop("id", None)
        for key, value in [*element.attrib.items()]:
            if key == _LINK:
                del element.attrib[key]
                element.set("href", value.replace("#", f"#{name}-"))
            elif key == "id":
                element.set(key, f"{name}-{value}")
            elif key == "style":
                element.set(key, _COLOUR.sub(_mixed, value).replace("url(#", f"url(#{name}-"))
            elif value.startswith("url(#"):
                element.set(key, value.replace("url(#", f"url(#{name}-"))
    for key in ("width", "height", "version"):
        root.attrib.pop(key, None)
    root.set("style", _INHERITED)
    return root


def _mixed(colour: re.Match[str]) -> str:
    """A grey as so much of the page's ink on its paper; another colour with the page's share of ink, which is none on white."""
    if len({*colour.groups()}) > 1:
        return f"color-mix(in srgb,{colour[0]},var(--ink) var(--lift))"
    return f"color-mix(in srgb,var(--ink) {100.0 * (1.0 - int(colour[1], 16) / 255.0):.3g}%,var(--paper))"
