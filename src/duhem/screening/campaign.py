"""A campaign as a frozen value: its rows, what is asked of each and what that may cost; and the lines of one row, whatever comes of it.

An inquiry is a value that can be sent to another process, with an answer for each line.  The text of a row is a JSON list of its lines,
which is what processes and parts hold.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import traceback
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from operator import itemgetter
from typing import ClassVar, NamedTuple, Protocol, TypeAlias

from duhem.errors import DuhemError, words_of
from duhem.law.curve_law import Law
from duhem.screening.rows import Row, RowBlock, told
from duhem.version import __version__

__all__ = ["Answer", "Campaign", "Claimed", "Inquiry", "VerdictLine", "as_text", "asked", "ended", "lines_of", "number_of"]

_MOST = 1_000  # characters of an error
_A_LIBRARY = 100_000_000  # bytes: what is mapped at once of a large one, or for a thread


Answer: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]
"""The fields of a :class:`VerdictLine` from ``claim`` to ``seconds``."""


class Inquiry(Protocol):
    """``names`` are the lines that each row has, whatever comes of it; ``options`` what the command line names beside the campaign.

    ``alone`` says that a row may leave behind what the next one meets, so that each is asked in a process of its own.
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def options(self) -> tuple[str, ...]: ...

    @property
    def alone(self) -> bool: ...

    def told(self) -> str:
        """Return words that tell this inquiry from every other."""
        ...

    def answers(self, law: Law) -> Iterator[Answer]:
        """Return a line for each name; raise InputError where the law cannot be asked."""
        ...


@dataclass(frozen=True)
class Claimed:
    """The claims of :func:`duhem.verify`, over what the row leaves open of the parameters."""

    claims: tuple[str, ...]
    effort: str = "normal"
    options: ClassVar[tuple[str, ...]] = ()
    alone: ClassVar[bool] = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.claims

    def told(self) -> str:
        return f"claims {','.join(self.claims)} {self.effort}"

    def answers(self, law: Law) -> Iterator[Answer]:
        from duhem.proof.verification import claim_results

        for r in claim_results(law, self.claims, self.effort):
            witness = None if r.witness is None else json.dumps(r.witness.to_dict())
            trust = None if r.trust is None else r.trust.value
            yield r.claim, r.verdict.value, r.method, trust, witness, r.steps, round(r.seconds, 6)


@dataclass(frozen=True)
class Campaign:
    """Rows in ``blocks``, numbered from 1 on, and the ``inquiry`` put to each.

    What a verdict may cost is counted in steps, by the inquiry; beyond ``seconds`` of the processor or ``memory`` gigabytes more than
    its process has at the start, a row is ended with its process; and so is one that waits, by the clock, ten times ``seconds`` and more.
    """

    blocks: tuple[RowBlock, ...]
    inquiry: Inquiry
    seconds: float = 600.0
    memory: float = 4.0
    out: str | None = None
    inputs: tuple[str, ...] = ()

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @cached_property
    def _ends(self) -> tuple[int, ...]:
        return tuple(accumulate(map(len, self.blocks)))

    def row(self, number: int) -> Row:
        """Return the row of a number from 1 to ``len``."""
        block = bisect_right(self._ends, number - 1)
        before = self._ends[block - 1] if block else 0
        return self.blocks[block].row(number - 1 - before, number)

    @property
    def fingerprint(self) -> str:
        """What tells the campaign's table from every other: all that is asked, and the version of duhem."""
        parts = [__version__, self.inquiry.told(), self.seconds, self.memory, *map(told, self.blocks)]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


class VerdictLine(NamedTuple):
    """One line of the table.  ``parameters`` are those that the row fixes and ``witness`` a violation, both as JSON text.

    ``error`` says why there is no verdict; ``steps`` are what the verdict cost, counted, and ``seconds`` what it took.
    """

    row: int
    law: str
    parameters: str
    claim: str
    verdict: str | None
    method: str | None
    trust: str | None
    witness: str | None
    steps: int
    seconds: float
    error: str | None

    @property
    def counts_as(self) -> str:
        """The verdict under which the line is counted: a claim that holds by construction does not count as proved."""
        from duhem.proof.kernel.claims import BY_CONSTRUCTION

        return "by_construction" if self.method == BY_CONSTRUCTION else "none" if self.verdict is None else self.verdict


def asked(campaign: Campaign, number: int) -> tuple[VerdictLine, ...]:
    """Return the lines of a row, sorted by claim.  They contain every error but lack of memory, also one that would end a program."""
    row = campaign.row(number)
    try:
        return _lines(row, campaign.inquiry.answers(row.law()), None)
    except DuhemError as fault:
        return ended(campaign, row, str(fault))
    except MemoryError:
        raise
    except SystemExit as fault:
        return ended(campaign, row, f"it ends the program, with {fault.code!r}")
    except BaseException as fault:  # a routine raises what it likes
        if _for_lack_of_memory(fault):
            raise MemoryError from None
        place = traceback.extract_tb(fault.__traceback__)[-1]
        where = f"{os.path.basename(place.filename)}:{place.lineno}"
        return ended(campaign, row, f"{': '.join(filter(None, (type(fault).__name__, ' '.join(words_of(fault).split()))))} (at {where})")


def _for_lack_of_memory(fault: BaseException) -> bool:
    """Return whether memory was lacking, also where the error speaks of a library that does not load or a thread that does not start."""
    met = set[int]()
    cause: BaseException | None = fault
    while cause is not None and id(cause) not in met:
        if isinstance(cause, MemoryError) or (isinstance(cause, OSError) and cause.errno == errno.ENOMEM):
            return True
        if (isinstance(cause, ImportError) or "start new thread" in words_of(cause)) and _all_but_taken():
            return True
        met.add(id(cause))
        cause = cause.__cause__ or cause.__context__
    return False


def _all_but_taken() -> bool:
    """Return whether this process has come so near to its limit of memory that one more thread or library does not fit."""
    try:
        import resource

        with open("/proc/self/status") as stream:
            peak = next(1024 * int(line.split()[1]) for line in stream if line.startswith("VmPeak"))
        most = resource.getrlimit(resource.RLIMIT_AS)[0]
    except (ImportError, OSError, StopIteration):  # a platform that does not count
        return False
    return most != resource.RLIM_INFINITY and peak > most - _A_LIBRARY


def ended(campaign: Campaign, row: Row, error: str) -> tuple[VerdictLine, ...]:
    """Return the lines of a row without verdicts, with the reason."""
    answers: Iterator[Answer] = ((name, None, None, None, None, 0, 0.0) for name in campaign.inquiry.names)
    return _lines(row, answers, error if len(error) <= _MOST else f"{error[:_MOST]} ...")


def _lines(row: Row, answers: Iterable[Answer], error: str | None) -> tuple[VerdictLine, ...]:
    why = None if error is None else _writable(error)
    law, values = _writable(row.name.shown), json.dumps(dict(row.values))
    return tuple(VerdictLine(row.number, law, values, *answer, why) for answer in sorted(answers, key=itemgetter(0)))


def _writable(text: str) -> str:
    return text.encode("utf-8", "backslashreplace").decode()


def as_text(lines: Sequence[VerdictLine]) -> str:
    """Return the lines of one row as one line of text."""
    return json.dumps(lines, separators=(",", ":"))


def number_of(text: str) -> int:
    """Return the number of the row of which :func:`as_text` made the text."""
    return int(text[2 : text.index(",")])


def lines_of(text: str) -> tuple[VerdictLine, ...]:
    """Return the lines of which :func:`as_text` made the text."""
    return tuple(VerdictLine(*values) for values in json.loads(text))
