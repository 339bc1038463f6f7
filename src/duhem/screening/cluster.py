"""Rows asked on a Dask cluster (extra ``cluster``): Dask places chunks of them and does those of a lost worker again.

On each worker a pool of one process asks them, so that a row which crashes or takes too much ends that process and not the worker,
and lines are those of any other pool.  Only as many chunks are under way as keep the workers busy, so that neither side holds many.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator
from os import PathLike, fspath, path
from threading import get_ident
from time import monotonic
from types import TracebackType
from typing import Any, Self

from duhem.errors import DuhemError, InputError, MissingExtraError
from duhem.screening.campaign import Campaign
from duhem.screening.pool import Pool
from duhem.version import __version__

__all__ = ["Cluster"]

_CHUNK = 2.0  # s: rows are sent for about so long
_MOST = 256  # of them at once
_AHEAD = 2  # chunks a thread of the workers
_POOLS = "duhem_pools"  # what a worker of Dask keeps them under
_KEPT = 2  # of them a thread: a campaign that is killed leaves one behind
_PATIENCE = "30s"


class Cluster:
    """The workers of the ``scheduler`` at an address such as tcp://10.0.0.1:8786, or in a file that it has written."""

    def __init__(self, campaign: Campaign, scheduler: str | PathLike[str]) -> None:
        self._dask = _distributed()
        place = fspath(scheduler)
        where = {"scheduler_file": place} if path.isfile(place) else {"address": place}
        try:
            self._client: Any = self._dask.Client(**where, timeout=_PATIENCE, set_as_default=False)
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
            count = max(1, min(_MOST, int(_CHUNK * self._rows / self._seconds) if self._seconds else 1))
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
    try:
        import distributed
    except ImportError:
        raise MissingExtraError("distributed", "cluster") from None
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
