"""Names that stand for a formula and invariants of a stress, written out in brackets before a formula is read.

What is read, simplified, proved and checked is a formula of the vocabulary alone; nothing further on knows an abbreviation.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from duhem.errors import InputError
from duhem.expression.invariants import INVARIANTS, Stress
from duhem.expression.number import DECIMAL
from duhem.expression.spelling import spelled

__all__ = ["NONE", "Abbreviations", "WrittenOut"]

_TOKEN = re.compile(rf"(?P<number>{DECIMAL})|(?P<name>[^\W\d]\w*)")
_ARGUMENTS = re.compile(r"\s*\(\s*(?:(?P<stress>[^\W\d]\w*)\s*(?:,\s*(?P<index>\d+)\s*)?|(?P<alone>\d+)\s*)\)")


@dataclass(frozen=True)
class WrittenOut:
    """A formula without abbreviations, and the ``source`` it was made of.

    ``seams`` are places (in the text, in the source, whether what begins there was copied): in order, each up to the next.
    """

    text: str
    source: str
    seams: tuple[tuple[int, int, bool], ...]

    def origin(self, at: int) -> int:
        """Where in the source a place of the text comes from: inside of an abbreviation, where that stands."""
        here, there, copied = self._seam(at)
        return there + (at - here) * copied

    def abbreviation(self, at: int) -> str | None:
        """The abbreviation in whose formula a place of the text lies, if it lies in one."""
        here, _, copied = self._seam(at)
        return None if copied else self.segment(here, at + 1)

    def segment(self, start: int, end: int) -> str:
        """What stands in the source for a part of the text that is not empty."""
        here, there, copied = self._seam(end - 1)
        behind = there + (end - here) if copied else next(seam[1] for seam in self.seams if seam[0] >= end)
        return self.source[self.origin(start) : behind]

    def _seam(self, at: int) -> tuple[int, int, bool]:
        return next(seam for seam in reversed(self.seams) if seam[0] <= at)


@dataclass(frozen=True)
class Abbreviations:
    """``formulas`` by name, nothing abbreviated left in them; the ``stress`` whose invariants are words; names ``to_come``."""

    formulas: Mapping[str, str] = field(default_factory=dict)
    stress: Stress | None = None
    to_come: frozenset[str] = frozenset()

    def words(self) -> frozenset[str]:
        """The invariants that may be used, whose names are taken."""
        return frozenset(INVARIANTS) if self.stress else frozenset()

    def written_out(self, text: str, fault: Callable[[str, int, str], InputError], most: int) -> WrittenOut:
        """``text`` without abbreviations, up to ``most`` characters; a wrong one raises ``fault`` (what, where, remedy)."""
        made, seams, length, behind = list[str](), [(0, 0, True)], 0, 0

        def put(part: str, at: int, copied: bool) -> None:
            nonlocal length
            seams.append((length, at, copied))
            made.append(part)
            length += len(part)

        for token in _TOKEN.finditer(text):
            if token.lastgroup != "name" or token.start() < behind:
                continue
            at = token.start()
            try:
                long, end = self._long(text, token)
            except InputError as wrong:
                raise fault(wrong.what, at, wrong.remedy) from None
            if long is not None:
                put(text[behind:at], behind, True)
                put(f"({long})", at, False)
                behind = end
                if length > most:
                    raise fault("the formula is too large with its definitions written out", at, f"at most {most} characters are read")
        put(text[behind:], behind, True)
        return WrittenOut("".join(made), text, tuple(seams))

    def _long(self, text: str, token: re.Match[str]) -> tuple[str | None, int]:
        """What the name at ``token`` stands for, if it is an abbreviation, and where it ends."""
        name, end = spelled(token[0]), token.end()
        called = text[end:].lstrip().startswith("(")
        if name in self.to_come:
            raise InputError(f"{name!r} is used before it is defined", remedy="a definition uses what stands above it")
        if name in self.formulas:
            if called:
                raise InputError(f"{name!r} is not a function of the language", remedy=f"write {name}*(...)")
            return self.formulas[name], end
        if name not in INVARIANTS or self.stress is None:
            return None, end
        if not called and not INVARIANTS[name].indexed:
            return self.stress.written_out(name), end
        return self._invariant(name, self.stress, _ARGUMENTS.match(text, end), end)

    def _invariant(self, word: str, stress: Stress, given: re.Match[str] | None, end: int) -> tuple[str, int]:
        """``J2`` is ``J2(sigma)`` and ``principal(1)`` is ``principal(sigma, 1)``, as in print: a law has one stress."""
        indexed = INVARIANTS[word].indexed
        usage = f"{word}({stress.name}, 1)" if indexed else f"{word}({stress.name})"
        index = given and (given["index"] or given["alone"])
        other = given and given["stress"] and spelled(given["stress"]) != stress.name
        if given is None or other or (index is not None) != indexed:
            raise InputError(
                f"{word} takes the declared stress{' and a number' * indexed}", remedy=f"write {usage}: {INVARIANTS[word].meaning}"
            )
        if index is not None and index not in ("1", "2", "3"):
            raise InputError(f"there is no principal stress {index[:24]}", remedy="1 is the greatest, 3 the least")
        return stress.written_out(word, None if index is None else int(index)), given.end()


NONE = Abbreviations()
