"""``duhem`` and ``python -m duhem``: every ending becomes an exit code and at most one line on standard error."""

from __future__ import annotations

import errno
import os
import signal
import sys
import traceback
from contextlib import suppress
from io import TextIOWrapper
from typing import TextIO

import click

from duhem.cli import cli
from duhem.cli.output import FAILED, HELD, INTERRUPTED, USAGE
from duhem.errors import DuhemError

__all__ = ["main"]

_MOST = 4_000  # characters of a message
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def main() -> int:
    """Run the command line on ``sys.argv`` and return its exit code."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by who called: nobody listens
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 (open as long as the process)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal that lacks a letter shows a stand-in
            stream.reconfigure(errors="backslashreplace")
    with suppress(ValueError):  # in a thread of another program: the signal is not ours
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # who asks to end has what is done kept, as with Ctrl-C
    try:
        code = cli.main(prog_name="duhem", standalone_mode=False)
        return code if isinstance(code, int) else HELD
    except click.ClickException as fault:
        with suppress(OSError):
            fault.show()
        _drop(sys.stderr)
        return USAGE
    except DuhemError as fault:
        return _complain(str(fault), USAGE)
    except (click.Abort, KeyboardInterrupt):
        return _complain("interrupted", INTERRUPTED)
    except MemoryError:
        return _complain("there is not enough memory; ask for fewer points or steps at once", FAILED)
    except Exception as fault:
        if isinstance(fault, OSError) and fault.errno in _NO_ROOM:
            _drop(sys.stdout)
            return _complain(f"the output cannot be written: {fault.strerror}; write where there is room", USAGE)
        place = traceback.extract_tb(fault.__traceback__)[-1]
        where = f"{os.path.basename(place.filename)}:{place.lineno}"
        remedy = "this is a defect of duhem: report it with the output of duhem doctor"
        return _complain(f"internal failure: {type(fault).__name__}: {fault} (at {where}); {remedy}", FAILED)


def _drop(stream: TextIO) -> None:
    """Forget what was printed and finds no room: it would be tried again, and complained of, at the end."""
    try:
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _complain(text: str, code: int) -> int:
    """One printable line on standard error, whatever the text holds, and however long it quotes."""
    line = " ".join((text if len(text) <= _MOST else f"{text[: _MOST // 2]} ... {text[-_MOST // 2 :]}").split())
    with suppress(OSError):
        print("duhem: " + "".join(c if c.isprintable() else repr(c)[1:-1] for c in line), file=sys.stderr)
    _drop(sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
