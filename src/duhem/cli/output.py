"""What the commands say, results on standard output and progress on standard error, and how they end: exit codes, one meaning each."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from math import inf
from threading import Event, Lock, Thread
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from duhem.show.page import WIDTH, Page, terminal_width
from duhem.version import __version__

if TYPE_CHECKING:
    from duhem.benchmark.measurement import Study
    from duhem.proof.decide import Budget

__all__ = [
    "FAILED",
    "HELD",
    "INTERRUPTED",
    "MEANINGS",
    "REFUTED",
    "UNDECIDED",
    "USAGE",
    "Progress",
    "as_json",
    "aside",
    "carry_out",
    "check_outputs",
    "deliver",
    "endless_page",
    "page",
    "say",
    "wrote",
]

HELD, REFUTED, USAGE, UNDECIDED, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 130

MEANINGS = {
    HELD: "nothing refuted",
    REFUTED: "something refuted",
    USAGE: "usage or file error",
    UNDECIDED: "undecided with --strict",
    FAILED: "internal or solver failure",
    INTERRUPTED: "interrupted",
}

_TICK, _LONG, _PACE = 1.0, 2.0, 0.2  # seconds


def say(text: str) -> None:
    """Print a result; a reader that goes away, as in ``duhem list | head -1``, changes no exit code."""
    try:
        click.echo(text)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def wrote(what: str, file: str | None) -> None:
    """Say on standard error what was written to a file, if there is one; standard output holds results alone."""
    if file is not None:
        aside(f"wrote {what} to {file}")


def deliver(what: str, file: str | None, write: Callable[[str], object]) -> None:
    """Write a file, if one is asked for, and say so."""
    if file is not None:
        write(file)
        wrote(what, file)


def aside(text: object) -> None:
    """Say on standard error what is no result."""
    click.echo(f"duhem: {text}", err=True)


def as_json(value: Any) -> str:
    """A result for programs."""
    import json

    return json.dumps(value, indent=2, ensure_ascii=False)


def check_outputs(plot: str | None, others: Iterable[str | None], inputs: Iterable[str]) -> None:
    """InputError, before the work, where a picture or another file cannot be written, or would be written over an input."""
    from duhem.show.place import check_places

    check_places([*others, plot], inputs)
    if plot is not None:
        from duhem.show import figure

        figure.check(plot)


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
        self._tried: tuple[float, str, Budget] | None = None  # since when, what and at which cost
        self._began, self._said = monotonic(), 0.0
        self._turn = Lock()
        self._ended, self._watch = Event(), Thread(target=self._watching, daemon=True)

    def __enter__(self) -> Progress:
        self.show(self.what)
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        if self._watch.ident is not None:
            self._watch.join()
        self.show("")

    def show(self, text: str) -> None:
        """Show this, and nothing more of what is tried."""
        with self._turn:
            self._tried = None
            self._write(text)

    def often(self, text: Callable[[], str], after: float = 0.0) -> None:
        """Show what ``text`` says, a few times a second, and not before so many seconds have passed."""
        if (now := monotonic()) - self._said > _PACE and now - self._began > after:
            self._said = now
            self.show(text())

    def tries(self, claim: str, method: str, steps: Budget) -> None:
        """Say which method tries which claim and, where it lasts, every second for how long and how many of its steps it has spent."""
        if sys.stderr.isatty():
            with self._turn:
                self._tried = monotonic(), f"{claim}: {method}", steps
                self._write(f"{claim}: {method}")
            if self._watch.ident is None:
                self._watch.start()

    def _watching(self) -> None:
        while not self._ended.wait(_TICK):
            with self._turn:
                since, text, steps = self._tried or (inf, "", None)
                if steps is not None and (seconds := monotonic() - since) > _LONG:
                    spent, whole = steps.spent / 1e6, (steps.spent + steps.left) / 1e6
                    self._write(f"{text}, {seconds:.0f} s, {spent:.1f} of {whole:.0f} million steps")

    def _write(self, text: str) -> None:
        if sys.stderr.isatty():
            print(f"\r\x1b[2K{text[:78]}", end="", file=sys.stderr, flush=True)


def carry_out(measure: Callable[[Progress], Study], json_file: str | None, plot: str | None, inputs: Sequence[str]) -> int:
    """Measure, print, write what is asked for, over none of the ``inputs``; the exit code."""
    from duhem.show.place import write
    from duhem.show.printing import draw, text

    check_outputs(plot, [json_file], inputs)
    with Progress("measuring") as progress:
        done = measure(progress)
    say(text(done, page()))
    deliver("the results", json_file, lambda file: write(file, as_json({"duhem": __version__, **done.to_dict()}) + "\n"))
    deliver("the picture", plot, partial(draw, done))
    return INTERRUPTED if done.interrupted else FAILED if done.failed else HELD
