"""Formulas of LaTeX as MathML that breaks between its terms and fits its line (extra ``report``)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from duhem.errors import MissingExtraError

__all__ = ["check", "ems", "mathematics"]

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
    try:
        import latex2mathml.converter  # noqa: F401
    except ImportError:
        raise MissingExtraError("latex2mathml", "report") from None


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
