"""The process that asks rows: it hears ranges of them and says each row's text as it is done, until nobody listens.

As a script this file is that process.  It imports nothing of the package before it has heard where modules are found, so that what
the program beside it defines can be sent.  A row beyond its limits ends the process: the kernel counts the processor's seconds,
whatever code runs, and the bytes asked for.  What a row forks and lets go on as if it were this process ends here, and says nothing.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from duhem.screening.campaign import Campaign

__all__ = ["NO_MEMORY", "READY"]

NO_MEMORY = 70  # the exit code
READY = b"ready"

_GIGABYTE = 10**9


def _serve(link: Connection) -> None:
    sys.path[:] = link.recv()
    try:
        campaign = pickle.loads(link.recv_bytes())
    except Exception as fault:
        link.send_bytes(f"{type(fault).__name__}: {fault}".encode("utf-8", "backslashreplace"))
        return
    process = os.getpid()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who asks ends it otherwise, and what a row raises as if it were one is the row's
    link.send_bytes(READY)
    from duhem.screening.campaign import as_text, asked

    _bound_memory(campaign)
    while True:
        first, last = link.recv()
        for number in range(first, last):
            _bound_seconds(campaign)
            try:
                text = as_text(asked(campaign, number)).encode()
            except MemoryError:
                os._exit(NO_MEMORY)
            if os.getpid() != process:
                os._exit(0)
            link.send_bytes(text)


def _bound_memory(campaign: Campaign) -> None:
    """So much more than there is now."""
    with suppress(ImportError, OSError, ValueError):  # a platform that does not count
        import resource

        with open("/proc/self/statm") as stream:
            now = int(stream.read().split()[0]) * resource.getpagesize()
        _bound(resource.RLIMIT_AS, now + int(campaign.memory * _GIGABYTE))
        _bound(resource.RLIMIT_CORE, 0)


def _bound_seconds(campaign: Campaign) -> None:
    """So many more of the processor than were taken so far, to the next whole one."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
        _bound(resource.RLIMIT_CPU, int(used + campaign.seconds) + 1)


def _bound(limit: int, most: int) -> None:
    """At ``most``, as far as the system lets it."""
    import resource

    hard = resource.getrlimit(limit)[1]
    resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


if __name__ == "__main__":
    try:
        _serve(Connection(int(sys.argv[1])))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        os._exit(0)  # who asked is gone
