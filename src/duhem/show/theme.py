"""A sheet of matplotlib's as a part of a page: its greys are mixed of the page's ink and paper, its colours lifted where that is dark."""

from __future__ import annotations

import re
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

__all__ = ["themed"]

_COLOUR = re.compile(r"#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})(?![0-9a-f])")
_NAMED = re.compile(r"(?:href=\"|url\()#([^\")]+)")
_LINK = "{http://www.w3.org/1999/xlink}href"
_INHERITED = "fill:var(--ink);stroke-linejoin:round;stroke-linecap:butt"  # what matplotlib says of every element of its file


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
