"""Campaigns: many laws and parameter sets at once, one table of verdicts."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from duhem.errors import InputError
from duhem.law.curve_law import Law
from duhem.screening.campaign import Campaign, Claimed, Inquiry, VerdictLine, given, lines_of, number_of
from duhem.screening.file import Means, read
from duhem.screening.increments import Increments, Project, Trials
from duhem.screening.pool import Cluster, Pool
from duhem.screening.summary import Counts, Summary
from duhem.screening.table import GrowingLines, check_table, read_lines, stands, write_table

__all__ = ["Increments", "StoppedCampaign", "Summary", "Trials", "campaign"]


OnRow = Callable[[int, int], None]
Pairs = Iterable[str | Law | tuple[str | Law, Mapping[str, Any]]]


class StoppedCampaign(KeyboardInterrupt):
    """This is raised where a campaign is interrupted; its text says what is kept and how to continue."""


def campaign(
    rows: str | os.PathLike[str] | Pairs | Campaign,
    claims: Iterable[str] | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | os.PathLike[str] | None = None,
    resume: bool = False,
    ask: Inquiry | None = None,
    project: Project | None = None,
    routine: Callable[..., Any] | str | None = None,
    checks: Callable[..., Inquiry] | None = None,
    stress: Callable[..., Inquiry] | None = None,
    on_row: OnRow | None = None,
    on_start: Callable[[str], None] | None = None,
) -> Summary:
    """Verify or test many laws and parameter sets.

    Each row runs in its own process, so that a failing row does not harm the others.

    ``rows`` is a campaign file, or a list of laws and of pairs (law, parameters).  ``claims`` selects the claims (default: those of the
    file, or all).  ``ask`` requests something else than claims, for example :class:`duhem.screening.Increments` or
    :class:`duhem.testing.RoutineChecks`.  If the file has ask = "increments", ``project`` must be :func:`duhem.project`.  If it has ask
    = "checks", ``routine`` is the routine to test, a callable or its name ``module:callable``, and ``checks`` is RoutineChecks.  If it
    has ask = "stress", ``stress`` is :class:`duhem.benchmark.extreme_cases.StressCases`. ``out`` is the table, .csv or .parquet, with
    one line per row and claim; without it, the summary contains the lines. ``workers`` is the number of processes (default: the number
    of cores); ``scheduler`` is the address or the file of a Dask cluster (extra ``cluster``).  The table does not depend on them.
    During a run the results are stored beside ``out``, and ``resume`` continues from there. A finished Parquet table is not changed; a
    finished CSV table does not store its campaign and is computed again.  ``on_row`` is called with the number of finished rows and of
    all rows, ``on_start`` with the dashboard of a cluster.

    Raises InputError for an invalid campaign, and StoppedCampaign, a KeyboardInterrupt, when interrupted.  An error in a row, such as a
    law that cannot be read, a value outside its domain, or a process that crashed or exceeded its limits, is written to the lines of
    this row.
    """
    asked = _read(rows, claims, ask, {"project": project, "routine": routine, "checks": checks, "stress": stress})
    table = asked.out if out is None else os.fspath(out)
    if workers is not None and (not isinstance(workers, int) or isinstance(workers, bool) or workers < 1):
        raise InputError(f"{workers!r} workers", where="workers", remedy="give a whole number >= 1")
    if resume and table is None:
        raise InputError("there is no table to continue", where="resume", remedy="name it as out")
    if table is not None:
        check_table(table, asked.inputs)
    if scheduler is not None and workers is not None:
        raise InputError("workers and scheduler are both given", where="workers", remedy="remove workers: the scheduler has its own")
    if resume and table is not None and stands(table, asked):
        counts = Counts(asked)
        deque(counts.passing(read_lines(table)), maxlen=0)
        return counts.summary(table, stood=True)
    with Pool(asked, workers) if scheduler is None else Cluster(asked, scheduler) as pool:
        if isinstance(pool, Cluster) and on_start is not None:
            on_start(pool.dashboard)
        return _gathered(asked, pool, on_row) if table is None else _written(asked, pool, table, resume, on_row)


def _read(rows: str | os.PathLike[str] | Pairs | Campaign, claims: Iterable[str] | None, ask: Inquiry | None, means: Means) -> Campaign:
    from duhem.proof.verification import wanted_claims

    if claims is not None and ask is not None:
        raise InputError("claims and ask are both given", where="ask", remedy="remove one of them")
    if means.get("routine") is not None and not isinstance(rows, str | os.PathLike):
        remedy = "give ask=duhem.testing.RoutineChecks(routine)"
        raise InputError('a routine is given, but there is no campaign file with ask = "checks"', where="routine", remedy=remedy)
    if isinstance(rows, Campaign | str | os.PathLike):
        asked = rows if isinstance(rows, Campaign) else read(rows, **means)
        if claims is not None:
            effort = asked.inquiry.effort if isinstance(asked.inquiry, Claimed) else "normal"
            ask = Claimed(wanted_claims(claims), effort)
        return asked if ask is None else replace(asked, inquiry=ask)
    if not isinstance(rows, Iterable) or isinstance(rows, Mapping | bytes):  # of a mapping, the values would be passed over
        remedy = "give a campaign file, or a list of laws or of pairs of a law and its values"
        raise InputError(f"{type(rows).__name__} is no campaign", where="rows", remedy=remedy)
    pairs = tuple(each if isinstance(each, tuple) else (each, None) for each in rows)
    if not pairs:
        raise InputError("there are no rows", where="rows", remedy="give at least one law")
    return Campaign((given(pairs),), Claimed(wanted_claims(claims)) if ask is None else ask)


def _gathered(asked: Campaign, pool: Pool | Cluster, on_row: OnRow | None) -> Summary:
    """Return a summary that contains all lines."""
    found, counts = dict[int, tuple[VerdictLine, ...]](), Counts(asked)
    for text in pool.texts([range(1, len(asked) + 1)]):
        found[number_of(text)] = lines_of(text)
        if on_row is not None:
            on_row(len(found), len(asked))
    lines = tuple(counts.passing(line for number in sorted(found) for line in found[number]))
    return counts.summary(lines=lines)


def _written(asked: Campaign, pool: Pool | Cluster, table: str, resume: bool, on_row: OnRow | None) -> Summary:
    """Write the lines to the table, which grows during the run, and return the summary without them."""
    counts = Counts(asked)
    with GrowingLines(asked, table, resume) as growing:
        try:
            for text in pool.texts(list(growing.missing())):
                growing.add(text)
                if on_row is not None:
                    on_row(growing.done, len(asked))
        except KeyboardInterrupt:
            growing.keep()
            said = f"interrupted after {growing.done} of {len(asked)} rows, kept beside {table}; continue with --resume"
            raise StoppedCampaign(said) from None
        growing.keep()
        write_table(table, counts.passing(growing.lines()), asked)
        growing.drop()
    return counts.summary(table)
