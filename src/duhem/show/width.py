"""How wide a line may be: as wide as the terminal it goes to; 96 columns where it goes to a file or another program."""

from __future__ import annotations

from typing import TextIO

__all__ = ["READABLE", "WIDTH", "terminal_width"]

WIDTH = 96
READABLE = 110  # prose in longer lines is tiring, however wide the terminal; tables may use all of it
LEAST = 40


def terminal_width(stream: TextIO) -> int | None:
    """Columns of the terminal behind ``stream`` (COLUMNS, where set, overrules it); None where there is none."""
    if not stream.isatty():
        return None
    from shutil import get_terminal_size

    return max(LEAST, get_terminal_size((WIDTH, 24)).columns)
