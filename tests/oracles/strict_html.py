"""HTML that has a type, opens and closes every element in order, and names each thing once."""

from __future__ import annotations

from collections import defaultdict
from html.parser import HTMLParser

__all__ = ["Strict"]

_VOID = {"meta", "br", "hr", "img", "link", "input"}


class Strict(HTMLParser):
    """What stands on a page: its text, element by element, its elements and attributes; an AssertionError where it is crooked."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.said: list[str] = []
        self.style = ""
        self.tags: set[str] = set()
        self.attributes: dict[str, list[str]] = defaultdict(list)
        self._open: list[str] = []
        self._typed = False

    def handle_decl(self, decl: str) -> None:
        self._typed = decl == "DOCTYPE html"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert self._typed, "no type is stated"
        self.tags.add(tag)
        assert len({name for name, _ in attrs}) == len(attrs), f"an attribute of {tag} is there twice"
        for name, value in attrs:
            assert value is not None, name
            assert name != "id" or value not in self.attributes["id"], f"two elements are named {value}"
            self.attributes[name].append(value)
        if tag not in _VOID:
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._open and self._open.pop() == tag, f"</{tag}> closes nothing"

    def handle_data(self, data: str) -> None:
        if self._open[-1:] == ["style"]:
            self.style += data
        elif data.strip():
            self.said.append(data)

    def close(self) -> None:
        super().close()
        assert self._typed and not self._open, f"{self._open} are not closed"
