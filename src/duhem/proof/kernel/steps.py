"""What a rule may cost, counted in steps: what is confirmed depends neither on the clock nor on who else uses the machine.

A step is about a microsecond.  The places where the kernel's work is done pay for it; whoever lets it work says how much it may cost.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

__all__ = ["Purse", "TooDearError", "pay", "within"]


class TooDearError(Exception):
    """A rule costs more than it may.  No rule catches it: what is left open for want of steps says nothing of the law."""


class Purse:
    """The steps that are left, and those that were spent."""

    def __init__(self, steps: int) -> None:
        self.left, self.spent = steps, 0


_PURSE: ContextVar[Purse | None] = ContextVar("purse", default=None)


def pay(steps: int) -> None:
    """Pay for work; TooDearError where it costs more than is left.  Without a purse everything may be spent."""
    if (purse := _PURSE.get()) is not None:
        purse.left -= steps
        purse.spent += steps
        if purse.left < 0:
            raise TooDearError


@contextmanager
def within(steps: int) -> Iterator[Purse]:
    """Inside it no more than so many steps are spent."""
    purse = Purse(steps)
    token = _PURSE.set(purse)
    try:
        yield purse
    finally:
        _PURSE.reset(token)
