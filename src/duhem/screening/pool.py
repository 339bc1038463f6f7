"""Rows asked in processes of their own: each is done once, and a row that ends its process is a row with its reason.

Whatever ends a process may have come from outside, or from rows before: the row it worked on is asked again in a fresh process, and
only what that says stands.  So lines do not depend on which rows shared a process; where the inquiry wants each row ``alone``, none do, and
the next process begins while the last one works.

A row that waits for ever (a lock, a pipe, a sleep) takes none of the processor's seconds that end a row.  Under it is a net of the
clock's: ten times those seconds, twice in turn, which no row meets that has work to do.

On a Dask cluster (extra ``cluster``) Dask places chunks of rows and does those of a lost worker again.  On each worker a pool of one
process asks them, so that a row which crashes or takes too much ends that process and not the worker, and lines are those of any other
pool.  Only as many chunks are under way as keep the workers busy, so that neither side holds many.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import wait
from os import PathLike, fspath, path
from threading import get_ident
from time import monotonic
from types import TracebackType
from typing import Any, Self

from duhem.errors import DuhemError, InputError, imported_from
from duhem.projection.in_blocks import cores
from duhem.screening import worker
from duhem.screening.campaign import Campaign, as_text, ended
from duhem.version import __version__

__all__ = ["Cluster", "Pool"]

_CHUNK = 0.5  # s: rows are handed out for about so long
_MOST = 256  # of them at once
_COMMAND = (sys.executable, "-P", worker.__file__)
_ROWS = 500  # that a process does at least
_RESIDENT = 256_000_000  # bytes: of a process that has done so many, and is replaced
_STARTS = 5  # processes in turn that end before they could begin: somebody may end one, not all
_PATIENCE = 10.0  # s: a process that speaks no more is waited for
_NO_MEMORY = f"with exit code {worker.NO_MEMORY}"
_WAITED = 10.0  # by the clock, of the processor's seconds that a row may take
_START = 300.0  # s by the clock, of a process that is to begin
_WAITS = "as it only waits"
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class _Worker:
    """One worker: the rows that it is to do yet, and how many it has done."""

    def __init__(self, campaign: bytes) -> None:
        self.left, self.done, self.ready, self.since, self.waits = range(0), 0, False, monotonic(), False
        self.link, far = Pipe()
        command = [*_COMMAND, str(far.fileno())]
        environment = {**os.environ, **dict.fromkeys(_ONE_THREAD, "1")}
        self.child = subprocess.Popen(
            command,
            pass_fds=[far.fileno()],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        far.close()
        with suppress(OSError):  # it is gone, which is seen where its word is waited for
            self.link.send([path or os.getcwd() for path in sys.path])
            self.link.send_bytes(campaign)

    def give(self, rows: range) -> None:
        self.left, self.since = rows, monotonic()
        with suppress(OSError):
            self.link.send((rows.start, rows.stop))

    def close(self) -> None:
        """End it, whatever it does, and what it has started."""
        self.link.close()
        with suppress(OSError):
            os.killpg(self.child.pid, signal.SIGKILL)
        self.child.wait()

    def swollen(self) -> bool:
        """Whether what many rows leave behind in it has become much: kilobytes a row add up, whoever keeps them."""
        if self.done < _ROWS:
            return False
        try:
            with open(f"/proc/{self.child.pid}/statm") as sizes:
                return int(sizes.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") > _RESIDENT
        except (OSError, ValueError):  # no such count: by rows alone
            return self.done > 10 * _ROWS

    def ended(self) -> str:
        """How it ended, which speaks no more."""
        if self.waits:
            self.close()
            return _WAITS
        self.link.close()
        try:
            code = self.child.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self.child.kill()
            code = self.child.wait()
        return f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"


class Pool:
    """``workers`` processes, or one a core, for the rows of a campaign.  Use it as a context: they end with it."""

    def __init__(self, campaign: Campaign, workers: int | None) -> None:
        self.campaign, self.workers = campaign, workers or cores()
        self._sent = pickle.dumps(campaign, protocol=pickle.HIGHEST_PROTOCOL)
        self._processes: list[_Worker] = []
        self._waiting: deque[range] = deque()
        self._alone: deque[int] = deque()  # rows that ended a process and are asked again
        self._ended_one = set[int]()
        self._seconds, self._rows = 0.0, 0
        self._stillborn = 0
        self._apart = campaign.inquiry.alone
        self._patience = _WAITED * (campaign.seconds + 1.0)  # the kernel counts whole seconds

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        for process in self._processes:
            process.close()
        self._processes.clear()

    def texts(self, rows: Iterable[range]) -> Iterator[str]:
        """The text of each row, as they are done.  InputError where no process can be started for the campaign."""
        self._waiting.extend(r for r in rows if r)
        while self._waiting or self._alone or any(p.left for p in self._processes):
            self._hand_out()
            busy = [p for p in self._processes if p.left or not p.ready]
            speaking = wait([p.link for p in busy], max(0.0, min(map(self._until, busy)) - monotonic()))
            for process in [p for p in busy if p.link not in speaking and monotonic() > self._until(p)]:
                process.waits = True
                yield from self._given_up(process)
            for process in (p for p in busy if p.link in speaking):
                try:
                    said = process.link.recv_bytes()
                except (EOFError, OSError):
                    yield from self._given_up(process)
                    continue
                if process.ready:
                    self._cost(process)
                    process.left, process.done = process.left[1:], process.done + 1
                    yield said.decode()
                elif said == worker.READY:
                    process.ready, self._stillborn = True, 0
                else:
                    remedy = "define what is asked in a module that another process can import"
                    raise InputError(f"no process can take the campaign: {said.decode()}", remedy=remedy)

    def _hand_out(self) -> None:
        """Rows to every process that has none, and a process more where there are rows for it."""
        for process in [p for p in self._processes if p.ready and not p.left]:
            if (process.done and (self._alone or self._apart)) or process.swollen():  # a fresh one takes its place
                self._processes.remove(process)
                process.close()
            elif sum(bool(p.left) for p in self._processes) == self.workers:
                continue  # it stands by for the next that is done
            elif self._alone:
                row = self._alone.popleft()
                process.give(range(row, row + 1))
            elif self._waiting:
                process.give(self._chunk())
        without = sum(not p.left for p in self._processes)
        rows = sum(map(len, self._waiting)) + len(self._alone) - without
        for _ in range(min(self.workers * (1 + self._apart) - len(self._processes), rows)):
            self._processes.append(_Worker(self._sent))

    def _chunk(self) -> range:
        """The next rows: about half a second of them, and no more than leaves some for the others."""
        each = self._seconds / self._rows if self._rows else _CHUNK
        share = -(-sum(map(len, self._waiting)) // (2 * self.workers))
        first = self._waiting.popleft()
        count = 1 if self._apart else max(1, min(_MOST, int(_CHUNK / max(each, 1e-9)), share))
        if first[count:]:
            self._waiting.appendleft(first[count:])
        return first[:count]

    def _until(self, process: _Worker) -> float:
        """When by the clock the row of a process, or its start, counts as one that waits for ever."""
        return process.since + (self._patience if process.ready else max(self._patience, _START))

    def _cost(self, process: _Worker) -> None:
        """What a row took, as the chunks that follow are cut by it."""
        now = monotonic()
        self._seconds, self._rows, process.since = self._seconds + now - process.since, self._rows + 1, now

    def _given_up(self, process: _Worker) -> Iterator[str]:
        """The process is gone: its row is asked again, alone, or is given up where that has ended a fresh process too."""
        self._processes.remove(process)
        how = process.ended()
        if not process.ready:
            self._stillborn += 1
            if self._stillborn < _STARTS:
                return
            raise InputError(f"a process ended {how} before it could take the campaign", remedy="check whether there is enough memory")
        if not process.left:
            return
        row, rest = process.left[0], process.left[1:]
        if rest:
            self._waiting.appendleft(rest)
        if row in self._ended_one and not process.done:
            yield as_text(ended(self.campaign, self.campaign.row(row), self._reason(how)))
        else:
            self._ended_one.add(row)
            self._alone.append(row)

    def _reason(self, how: str) -> str:
        if how == _NO_MEMORY:
            return f"it needs more than {self.campaign.memory:g} GB of memory"
        if how == "by SIGXCPU":
            return f"it needs more than {self.campaign.seconds:g} s of processor time"
        if how == _WAITS:
            return (
                f"it waits: more than {self._patience:g} s have passed, and it has not taken {self.campaign.seconds:g} s of processor time"
            )
        return f"its process ended {how}"


# -- a Dask cluster ----------------------------------------------------------------------------------------------------

_SENT_CHUNK = 2.0  # s: rows are sent for about so long
_AHEAD = 2  # chunks a thread of the workers
_POOLS = "duhem_pools"  # what a worker of Dask keeps them under
_KEPT = 2  # of them a thread: a campaign that is killed leaves one behind
_DASK_PATIENCE = "30s"


class Cluster:
    """The workers of the ``scheduler`` at an address such as tcp://10.0.0.1:8786, or in a file that it has written."""

    def __init__(self, campaign: Campaign, scheduler: str | PathLike[str]) -> None:
        self._dask = _distributed()
        place = fspath(scheduler)
        where = {"scheduler_file": place} if path.isfile(place) else {"address": place}
        try:
            self._client: Any = self._dask.Client(**where, timeout=_DASK_PATIENCE, set_as_default=False)
            said = self._client.run(_version)
        except (OSError, ValueError, TypeError) as fault:
            remedy = "start one with: dask scheduler"
            raise InputError(f"the scheduler does not answer: {' '.join(str(fault).split())[:200]}", where=place, remedy=remedy) from None
        if not said:
            raise InputError("the scheduler has no workers", where=place, remedy=f"start some with: dask worker {place}")
        if other := next((version for version in said.values() if version != __version__), None):
            raise InputError(
                f"a worker has duhem {other}, but this program is duhem {__version__}",
                where=place,
                remedy="install the same version everywhere",
            )
        self._sent, self._key = pickle.dumps(campaign, protocol=pickle.HIGHEST_PROTOCOL), campaign.fingerprint
        self._seconds, self._rows = 0.0, 0

    @property
    def dashboard(self) -> str:
        """Where the work can be watched."""
        return str(self._client.dashboard_link)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        try:
            if kind is None:
                self._client.run(_closed, self._key)
        finally:
            self._client.close()

    def texts(self, rows: Iterable[range]) -> Iterator[str]:
        """The text of each row, as they are done.  DuhemError where the cluster cannot go on."""
        campaign = self._client.scatter(self._sent, broadcast=True, hash=False)
        waiting = [each for each in rows if each][::-1]
        done = self._dask.as_completed(loop=self._client.loop)

        def send() -> None:
            first = waiting.pop()
            count = max(1, min(_MOST, int(_SENT_CHUNK * self._rows / self._seconds) if self._seconds else 1))
            if first[count:]:
                waiting.append(first[count:])
            chunk = first[:count]
            done.add(self._client.submit(_asked, campaign, self._key, chunk.start, chunk.stop, pure=False))

        for _ in range(_AHEAD * sum(self._client.nthreads().values())):
            if waiting:
                send()
        for future in done:
            try:
                texts, seconds = future.result()
            except Exception as fault:
                what = f"the cluster has failed: {type(fault).__name__}: {' '.join(str(fault).split())[:300]}"
                raise DuhemError(what, remedy="continue with --resume when the cluster works again") from None
            future.release()
            self._seconds, self._rows = self._seconds + seconds, self._rows + len(texts)
            if waiting:
                send()
            yield from texts


def _distributed() -> Any:
    with imported_from("distributed", "cluster"):
        import distributed
    return distributed


def _version() -> str:
    return __version__


def _asked(sent: bytes, key: str, first: int, last: int) -> tuple[list[str], float]:
    """On a worker: the texts of some rows, and what they took."""
    pools = vars(_distributed().get_worker()).setdefault(_POOLS, {})
    own = key, get_ident()
    pool = pools.pop(own, None) or Pool(pickle.loads(sent), 1)
    for idle in [each for each in list(pools) if each[1] == own[1]][: 1 - _KEPT]:  # of campaigns that nobody ended
        pools.pop(idle).__exit__(None, None, None)
    began = monotonic()
    try:
        texts = list(pool.texts([range(first, last)]))
    except BaseException:  # it may have rows left that nobody waits for
        pool.__exit__(None, None, None)
        raise
    pools[own] = pool
    return texts, monotonic() - began


def _closed(key: str, dask_worker: Any) -> None:
    """On a worker: the campaign is over."""
    pools = vars(dask_worker).get(_POOLS, {})
    for own in [own for own in list(pools) if own[0] == key]:
        pools.pop(own).__exit__(None, None, None)
