"""One row asked: its lines, whatever comes of it.  The text of a row is a JSON list of them, which is what processes and parts hold."""

from __future__ import annotations

import errno
import json
import os
import traceback
from collections.abc import Sequence
from typing import NamedTuple

from duhem.errors import DuhemError, words_of
from duhem.screening.campaign import Campaign
from duhem.screening.inquiries import Answered
from duhem.screening.rows import Row

__all__ = ["VerdictLine", "as_text", "asked", "ended", "lines_of", "number_of"]

_MOST = 1_000  # characters of an error
_A_LIBRARY = 100_000_000  # bytes: what is mapped at once of a large one, or for a thread


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


def asked(campaign: Campaign, number: int) -> tuple[VerdictLine, ...]:
    """The lines of a row, sorted by claim; an error of any kind but lack of memory is in them, one that ends a program too."""
    row = campaign.row(number)
    try:
        return _lines(row, [Answered(*each) for each in campaign.inquiry.answers(row.law())], None)
    except DuhemError as fault:
        return ended(campaign, row, str(fault))
    except MemoryError:
        raise
    except SystemExit as fault:
        return ended(campaign, row, f"it asks the program to end, with {fault.code!r}")
    except BaseException as fault:  # a routine raises what it likes
        if _for_lack_of_memory(fault):
            raise MemoryError from None
        place = traceback.extract_tb(fault.__traceback__)[-1]
        where = f"{os.path.basename(place.filename)}:{place.lineno}"
        return ended(campaign, row, f"{': '.join(filter(None, (type(fault).__name__, ' '.join(words_of(fault).split()))))} (at {where})")


def _for_lack_of_memory(fault: BaseException) -> bool:
    """Whether memory was lacking, also where what lacked it, a library that does not load or a thread, is told as an error of its own."""
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
    """Whether this process has come so near to the memory that it may have that a thread or a library more does not fit."""
    try:
        import resource

        with open("/proc/self/status") as stream:
            peak = next(1024 * int(line.split()[1]) for line in stream if line.startswith("VmPeak"))
        most = resource.getrlimit(resource.RLIMIT_AS)[0]
    except (ImportError, OSError, StopIteration):  # a platform that does not count
        return False
    return most != resource.RLIM_INFINITY and peak > most - _A_LIBRARY


def ended(campaign: Campaign, row: Row, error: str) -> tuple[VerdictLine, ...]:
    """The lines of a row without verdicts, and why."""
    answers = [Answered(name, None, None, None, None, 0, 0.0) for name in campaign.inquiry.names]
    return _lines(row, answers, error if len(error) <= _MOST else f"{error[:_MOST]} ...")


def _lines(row: Row, answers: Sequence[Answered], error: str | None) -> tuple[VerdictLine, ...]:
    why = None if error is None else _writable(error)
    law, values = _writable(row.name.shown), json.dumps(dict(row.values))
    return tuple(
        VerdictLine(row.number, law, values, r.claim, r.verdict, r.method, r.trust, r.witness, r.steps, r.seconds, why)
        for r in sorted(answers, key=lambda reply: reply.claim)
    )


def _writable(text: str) -> str:
    return text.encode("utf-8", "backslashreplace").decode()


def as_text(lines: Sequence[VerdictLine]) -> str:
    """The lines of one row as one line of text."""
    return json.dumps(lines, separators=(",", ":"))


def number_of(text: str) -> int:
    """Of which row a text of :func:`as_text` is."""
    return int(text[2 : text.index(",")])


def lines_of(text: str) -> tuple[VerdictLine, ...]:
    """What :func:`as_text` has written."""
    return tuple(VerdictLine(*values) for values in json.loads(text))
