"""A report is a list of lines: sentences with a hanging indent, titled fields, lists and tables, all within one width."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from textwrap import wrap

from duhem.show.table import table
from duhem.show.width import READABLE, WIDTH

__all__ = ["PAGE", "Page", "printable", "tied"]

_TIE = "\N{NO-BREAK SPACE}"


def tied(text: str) -> str:
    """``text`` as one word: a page shows its spaces and breaks no line there, however long it is."""
    return text.replace(" ", _TIE)


def printable(text: str) -> str:
    """``text`` with letters that have no shape, or turn others about, written as Python does; ends of lines and tied spaces stay."""
    return "".join(c if c.isprintable() or c in f"\n{_TIE}" else repr(c)[1:-1] for c in text)


@dataclass(frozen=True)
class Page:
    """Lines of at most ``width`` characters, as far as words allow; None: of any length."""

    width: int | None = WIDTH

    def hanging(self, text: str, first: str = "", rest: str = "    ") -> list[str]:
        """A sentence: ``first`` before its first line, ``rest`` before the others."""
        if self.width is None:
            return [f"{first}{text}".replace(_TIE, " ")] if text else []
        room = min(self.width, READABLE)
        lines = wrap(
            text,
            room,
            initial_indent=first,
            subsequent_indent=rest,
            break_on_hyphens=False,  # formulas have minus signs
            break_long_words=False,
        )
        return [line.replace(_TIE, " ") for line in lines]

    def item(self, text: str, indent: str = "  ") -> list[str]:
        """A sentence under a title."""
        return self.hanging(text, indent, f"{indent}    ")

    def items(self, title: str, texts: Iterable[object]) -> list[str]:
        """A title and a sentence for each of ``texts``; nothing where there are none."""
        lines = [line for text in texts for line in self.item(str(text))]
        return [title, *lines] if lines else []

    def field(self, title: str, text: str, size: int) -> list[str]:
        """``text`` beside its title, whose column is ``size`` wide."""
        return self.hanging(text, f"  {title:<{size}}  ", " " * (size + 4))

    def table(self, rows: Sequence[Sequence[str]], align: str, indent: str = "  ", *, rule: bool = False) -> list[str]:
        """:func:`duhem.show.table.table` of the rows; spaces that are tied stay in one line."""
        return [line.replace(_TIE, " ") for line in table(rows, align, indent, width=self.width, rule=rule)]

    @staticmethod
    def report(parts: Iterable[Sequence[str]]) -> str:
        """The parts that have lines, a blank line between them."""
        return "\n\n".join("\n".join(line.rstrip() for line in part) for part in parts if part)


PAGE = Page()
