"""Rows of text in columns that line up, within a width: long text is folded in its cell, columns that do not fit go below."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from textwrap import wrap

__all__ = ["table"]

_GAP = "  "
_NARROW = 12  # a column of text is folded no narrower than this, nor than its longest word


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
