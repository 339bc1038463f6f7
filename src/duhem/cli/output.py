"""What the commands say: results on standard output, progress on standard error."""

from __future__ import annotations

import os
import sys

import click

from duhem.show.page import Page
from duhem.show.width import WIDTH, terminal_width

__all__ = ["Progress", "endless_page", "page", "say"]


def say(text: str) -> None:
    """Print a result; a reader that goes away, as in ``duhem list | head -1``, changes no exit code."""
    try:
        click.echo(text)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def page() -> Page:
    """As wide as the terminal, else 96 columns."""
    return Page(terminal_width(sys.stdout) or WIDTH)


def endless_page() -> Page:
    """As wide as the terminal; where there is none a sentence is a line, which programs can read."""
    return Page(terminal_width(sys.stdout))


class Progress:
    """One line on standard error that overwrites itself and vanishes; nothing at all where that is no terminal."""

    def __init__(self, what: str = "verifying") -> None:
        self.what = what

    def __enter__(self) -> Progress:
        self.show(self.what)
        return self

    def __exit__(self, *_: object) -> None:
        self.show("")

    def show(self, text: str) -> None:
        if sys.stderr.isatty():
            print(f"\r\x1b[2K{text[:78]}", end="", file=sys.stderr, flush=True)
