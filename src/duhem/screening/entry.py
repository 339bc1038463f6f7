"""``duhem.campaign``: many laws at once, on the cores of this machine or on a cluster."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from duhem.errors import InputError
from duhem.law.curve_law import Law
from duhem.screening import file
from duhem.screening.campaign import Campaign, Claimed, Inquiry, VerdictLine, lines_of, number_of
from duhem.screening.cluster import Cluster
from duhem.screening.file import Means
from duhem.screening.increments import Project
from duhem.screening.pool import Pool
from duhem.screening.rows import given
from duhem.screening.summary import Counts, Summary
from duhem.screening.table import GrowingLines, check_table, read_lines, stands, write_table

__all__ = ["StoppedCampaign", "campaign"]

OnRow = Callable[[int, int], None]
Pairs = Iterable[str | Law | tuple[str | Law, Mapping[str, Any]]]


class StoppedCampaign(KeyboardInterrupt):
    """A campaign that was interrupted; its text says what is kept and how to go on."""


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
    """Ask many laws at once, each row in a process that may fail without harm to the others.

    ``rows`` is a campaign file, or laws and pairs of a law and its parameters. Asked are ``claims``, all of them or what the file says if
    left out, or ``ask``, such as :class:`duhem.screening.Increments` or :class:`duhem.testing.RoutineChecks`. Where a file asks
    increments, ``project`` is :func:`duhem.project`, which solves them; checks, ``routine`` is the one that is tested, a callable or its
    name ``module:callable``, and ``checks`` is RoutineChecks; stress, ``stress`` is :class:`duhem.benchmark.extreme_cases.StressCases`.
    ``out`` is the table, .csv or .parquet, one line a row and claim; without one the lines are in the summary.
    ``workers`` processes (the cores, if left out) give the same table, and so does a Dask cluster, whose ``scheduler`` is given by its
    address or file (extra ``cluster``). While it runs, what is done is kept beside ``out``, and ``resume`` goes on from there, or leaves
    a finished Parquet table of the campaign as it is, while one in CSV, which says not what was asked, is asked anew; ``on_row`` is called
    with the rows done and all, ``on_start`` with a cluster's dashboard.

    Raises InputError for a campaign that cannot be asked, StoppedCampaign, a KeyboardInterrupt, when interrupted.  What is wrong with a row
    is in its lines: a law that cannot be read, a value outside its domain, a process that crashed or took too much.
    """
    asked = _read(rows, claims, ask, {"project": project, "routine": routine, "checks": checks, "stress": stress})
    table = asked.out if out is None else os.fspath(out)
    if workers is not None and (not isinstance(workers, int) or isinstance(workers, bool) or workers < 1):
        raise InputError(f"{workers!r} workers", where="workers", remedy="give a whole number from 1 on")
    if resume and table is None:
        raise InputError("there is no table to go on with", where="resume", remedy="name it as out")
    if table is not None:
        check_table(table, asked.inputs)
    if scheduler is not None and workers is not None:
        raise InputError("workers and a scheduler are both given", where="workers", remedy="the scheduler has its own")
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
        raise InputError("claims and something else are asked", where="ask", remedy="leave one of them out")
    if means.get("routine") is not None and not isinstance(rows, str | os.PathLike):
        remedy = "give ask=duhem.testing.RoutineChecks(routine)"
        raise InputError("a routine is given, and the rows are of no campaign file that asks it", where="routine", remedy=remedy)
    if isinstance(rows, Campaign | str | os.PathLike):
        read = rows if isinstance(rows, Campaign) else file.read(rows, **means)
        if claims is not None:
            effort = read.inquiry.effort if isinstance(read.inquiry, Claimed) else "normal"
            ask = Claimed(wanted_claims(claims), effort)
        return read if ask is None else replace(read, inquiry=ask)
    if not isinstance(rows, Iterable) or isinstance(rows, Mapping | bytes):  # of a mapping, the values would be passed over
        remedy = "give a campaign file, or a list of laws or of pairs of a law and its values"
        raise InputError(f"{type(rows).__name__} is no campaign", where="rows", remedy=remedy)
    pairs = tuple(each if isinstance(each, tuple) else (each, None) for each in rows)
    if not pairs:
        raise InputError("there are no rows", where="rows", remedy="give at least one law")
    return Campaign((given(pairs),), Claimed(wanted_claims(claims)) if ask is None else ask)


def _gathered(asked: Campaign, pool: Pool | Cluster, on_row: OnRow | None) -> Summary:
    """The lines in the summary."""
    found, counts = dict[int, tuple[VerdictLine, ...]](), Counts(asked)
    for text in pool.texts([range(1, len(asked) + 1)]):
        found[number_of(text)] = lines_of(text)
        if on_row is not None:
            on_row(len(found), len(asked))
    lines = tuple(counts.passing(line for number in sorted(found) for line in found[number]))
    return counts.summary(lines=lines)


def _written(asked: Campaign, pool: Pool | Cluster, table: str, resume: bool, on_row: OnRow | None) -> Summary:
    """The lines in the table, which grows as they are done."""
    counts = Counts(asked)
    with GrowingLines(asked, table, resume) as growing:
        try:
            for text in pool.texts(list(growing.missing())):
                growing.add(text)
                if on_row is not None:
                    on_row(growing.done, len(asked))
        except KeyboardInterrupt:
            growing.keep()
            said = f"interrupted after {growing.done} of {len(asked)} rows, kept beside {table}; go on with --resume"
            raise StoppedCampaign(said) from None
        growing.keep()
        write_table(table, counts.passing(growing.lines()), asked)
        growing.drop()
    return counts.summary(table)
