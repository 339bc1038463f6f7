"""The one exception users meet: what is wrong, where, and what to do about it; how it is told its place, and a name that was meant."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

__all__ = ["DuhemError", "InputError", "MissingExtraError", "faults_at", "imported_from", "meant", "words_of"]


class DuhemError(Exception):
    """Base of every error duhem raises on purpose.

    ``what`` names the fault, ``where`` its place (file, line, column, argument) and ``remedy`` the way out;
    the text of the exception is the three in one line.
    """

    def __init__(self, what: str, *, where: str = "", remedy: str = "") -> None:
        self.what, self.where, self.remedy = what, where, remedy
        super().__init__(self._text())

    def _text(self) -> str:
        head = f"{self.where}: {self.what}" if self.where else self.what
        return f"{head}; {self.remedy}" if self.remedy else head


class InputError(DuhemError, ValueError):
    """Something the caller wrote (a file, an option, an argument) cannot be used as it stands."""


@contextmanager
def faults_at(where: str | Callable[[], str], *, unless_placed: bool = False) -> Iterator[None]:
    """An InputError of what is done here is told with this place, ``unless_placed`` for those that have one of their own."""
    try:
        yield
    except InputError as fault:
        place = fault.where if unless_placed and fault.where else where if isinstance(where, str) else where()
        raise InputError(fault.what, where=place, remedy=fault.remedy) from None


class MissingExtraError(DuhemError, ImportError):
    """An optional part is asked for and not installed; the remedy is the pip command."""

    def __init__(self, module: str, extra: str) -> None:
        super().__init__(f"{module} is not installed", remedy=f'install it with: pip install "duhem[{extra}]"')


@contextmanager
def imported_from(module: str, extra: str) -> Iterator[None]:
    """A MissingExtraError where what is imported here is not installed."""
    try:
        yield
    except ImportError:
        raise MissingExtraError(module, extra) from None


def words_of(fault: BaseException) -> str:
    """What an error says; nothing where saying it raises."""
    try:
        return str(fault)
    except Exception:
        return ""


def meant(name: object, known: Iterable[str], otherwise: str = "", *, both: bool = False) -> str:
    """The remedy for an unknown name: the one that was probably meant, else (or ``both``) ``otherwise``, or all that are ``known``."""
    from difflib import get_close_matches

    every = tuple(known)
    near = get_close_matches(str(name)[:40], every, n=1)
    otherwise = otherwise or f"known are: {', '.join(every) or 'none'}"
    return f"did you mean {near[0]!r}?{f' {otherwise}' if both else ''}" if near else otherwise
