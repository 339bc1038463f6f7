"""A report is a list of lines, sentences with a hanging indent, titled fields, lists and tables, all within one width.

Lines are as wide as the terminal they go to, 96 columns where they go to a file or another program.  Rows of a table line up in
columns: long text is folded in its cell, columns that do not fit go below.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from textwrap import wrap
from typing import TextIO

__all__ = ["LEAST", "PAGE", "READABLE", "WIDTH", "Page", "printable", "table", "terminal_width", "tied"]

WIDTH = 96
READABLE = 110  # prose in longer lines is tiring, however wide the terminal; tables may use all of it
LEAST = 40

_TIE = "\N{NO-BREAK SPACE}"

_GAP = "  "
_NARROW = 12  # a column of text is folded no narrower than this, nor than its longest word


def terminal_width(stream: TextIO) -> int | None:
    """Columns of the terminal behind ``stream`` (COLUMNS, where set, overrules it); None where there is none."""
    if not stream.isatty():
        return None
    from shutil import get_terminal_size

    return max(LEAST, get_terminal_size((WIDTH, 24)).columns)


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

    def listed(self, texts: Mapping[str, str]) -> list[str]:
        """Each text beside its title, in a column as wide as the widest of them."""
        size = max(map(len, texts))
        beside = (self.hanging(text, f"{title:<{size}}  ", " " * (size + 2)) or [title] for title, text in texts.items())
        return [line for lines in beside for line in lines]

    def table(self, rows: Sequence[Sequence[str]], align: str, indent: str = "  ", *, rule: bool = False) -> list[str]:
        """:func:`table` of the rows; spaces that are tied stay in one line."""
        return [line.replace(_TIE, " ") for line in table(rows, align, indent, width=self.width, rule=rule)]

    @staticmethod
    def report(parts: Iterable[Sequence[str]]) -> str:
        """The parts that have lines, a blank line between them."""
        return "\n\n".join("\n".join(line.rstrip() for line in part) for part in parts if part)


PAGE = Page()


def table(rows: Sequence[Sequence[str]], align: str, indent: str = "", *, width: int | None = None, rule: bool = False) -> list[str]:
    """Lines of at most ``width`` characters, as far as words allow; None: of any length.

    ``align``: a letter a column, ``l`` for text, which may be folded at its spaces, ``r`` for numbers, of which only the heading
    may be; the last letter stands for all columns beyond.  The first row is the head, and ``rule`` draws a line below it.  A
    row may end early: its last cell then runs on over the columns that it lacks.  Where folding is not enough, the columns
    that find no room follow below, beside the first column again.
    """
    count = max(map(len, rows))
    letters = align.ljust(count, align[-1])
    columns = [[row[i] for row in rows if i < len(row) - (len(row) < count)] for i in range(count)]
    natural = [max(map(len, column), default=0) for column in columns]
    endless = sum(len(_GAP) + size for size in natural) + max(len(row[-1]) for row in rows)
    room = endless if width is None else width - len(indent)
    least = [min(size, _least(column, letter)) for column, letter, size in zip(columns, letters, natural, strict=True)]
    lines: list[str] = []
    for block in _blocks(least, room):
        widths = _folded([natural[i] for i in block], [least[i] for i in block], [letters[i] for i in block], room)
        lines += [""] if lines else []
        for n, row in enumerate(rows):
            runs_on = len(row) < count and len(row) - 1 in block
            lines += _row([row[i] for i in block if i < len(row)], widths, [letters[i] for i in block], room if runs_on else None)
            if rule and n == 0:
                lines.append(_GAP.join("-" * size for size in widths))
    return [f"{indent}{line}" if line else line for line in lines]


def _least(column: Sequence[str], letter: str) -> int:
    """How narrow a column can be folded."""
    words = [len(word) for cell in (column[:1] if letter == "r" else column) for word in cell.split(" ")]
    return max([*words, *(map(len, column[1:]) if letter == "r" else [_NARROW])], default=0)


def _blocks(least: Sequence[int], room: int) -> Iterator[list[int]]:
    """The columns that stand side by side, the first column in every block."""
    block, used = [0], least[0]
    for i, size in enumerate(least[1:], 1):
        if used + len(_GAP) + size > room and len(block) > 1:
            yield block
            block, used = [0], least[0]
        block, used = [*block, i], used + len(_GAP) + size
    yield block


def _folded(natural: Sequence[int], least: Sequence[int], letters: Sequence[str], room: int) -> list[int]:
    """Widths that fit: headings over numbers give way first, then the widest text."""
    widths = list(natural)
    while sum(widths) + len(_GAP) * (len(widths) - 1) > room:
        foldable = [i for i, size in enumerate(widths) if size > least[i]]
        if not foldable:
            break
        widths[max(foldable, key=lambda i: (letters[i] == "r", widths[i]))] -= 1
    return widths


def _row(row: Sequence[str], widths: Sequence[int], letters: Sequence[str], room: int | None) -> Iterator[str]:
    """The lines of one row; the last cell runs on to ``room`` where one is given."""
    sizes, kinds = list(widths[: len(row)]), list(letters[: len(row)])
    if room is not None:
        sizes[-1], kinds[-1] = room - sum(sizes[:-1]) - len(_GAP) * (len(row) - 1), "l"
    cells = [_lines(cell, size) for cell, size in zip(row, sizes, strict=True)]
    for line in zip_longest(*cells, fillvalue=""):
        padded = (cell.rjust(size) if kind == "r" else cell.ljust(size) for cell, size, kind in zip(line, sizes, kinds, strict=True))
        yield _GAP.join(padded).rstrip()


def _lines(cell: str, size: int) -> list[str]:
    return [cell] if len(cell) <= size else wrap(cell, max(size, 1), break_long_words=False, break_on_hyphens=False)
