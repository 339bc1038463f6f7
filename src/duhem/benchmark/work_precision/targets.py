"""The ratios that a benchmark is held to, taken within one run: to what memory allows, and to other programs."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from duhem.benchmark.work_precision.result import Measurement, Target
from duhem.benchmark.work_precision.throughput import ANEW, BOUND, BOUND_NEW, ONCE, REUSED, SCENE, WHOLE
from duhem.left_out import LeftOut

__all__ = ["beside_peers", "targets"]


def targets(rows: Sequence[Measurement], left_out: Sequence[LeftOut]) -> tuple[Target, ...]:
    """The ratios of medians that duhem sets itself, at the most points measured; where one was not measured, why."""
    absent = {part.part: part.reason for part in left_out} | {r.method: f"failed: {r.failure}" for r in rows if r.failure is not None}
    seconds = {row.method: row.seconds.median for row in rows if row.scene == SCENE and row.seconds is not None}
    memory = {row.method: row.error["megabytes"] for row in rows if row.scene == SCENE and "megabytes" in row.error}
    if BOUND not in seconds or BOUND_NEW not in seconds:
        return ()
    if "closed-form" not in seconds:  # what duhem.project is held to is held to with a closed form
        seconds.pop(WHOLE, None)
    absent |= {name + REUSED: reason for name, reason in absent.items()}

    def ratio(what: str, over: str, under: str, relation: str, bound: float) -> Target:
        missing = [name for name in (over, under) if name not in seconds]
        value = None if missing or seconds[under] == 0.0 else seconds[over] / seconds[under]
        reason = "; ".join(absent.get(name, f"{name} was not measured") for name in missing)
        return Target(what, value, relation, bound, reason or ("" if value is not None else "too short for this clock"))

    def megabytes(name: str) -> Target:
        return Target(f"extra memory of {name}, MB", memory.get(name), "<=", 16.0, "" if name in memory else f"{name} was not measured")

    return (
        ratio("closed form (NumPy) / memory bandwidth", "closed-form" + REUSED, BOUND, "<=", 40.0),
        ratio("closed form (numba) / memory bandwidth", "closed-form, numba" + REUSED, BOUND, "<=", 5.0),
        ratio("closed form (NumPy) / memory bandwidth, new arrays", "closed-form", BOUND_NEW, "<=", 40.0),
        ratio("closed form (numba) / memory bandwidth, new arrays", "closed-form, numba", BOUND_NEW, "<=", 5.0),
        ratio("duhem.project, residuals included / memory bandwidth, new arrays", WHOLE, BOUND_NEW, "<=", 40.0),
        ratio("CVXPY, a new problem a point / closed form (NumPy)", ANEW, "closed-form", ">=", 1e4),
        ratio("CVXPY, compiled once / closed form (NumPy)", ONCE, "closed-form", ">=", 1e4),
        megabytes("closed-form"),
        megabytes(WHOLE),
    )


def beside_peers(rows: Sequence[Measurement], own: Collection[str], peers: Collection[str]) -> tuple[Target, ...]:
    """For each peer the time and the error of the quickest of duhem's ``own`` methods, both at the most points both were measured at."""
    found: list[Target] = []
    measured = {(row.method, row.setting): row for row in rows if row.scene == SCENE and row.seconds is not None}
    for peer in peers:
        at = [setting for name, setting in measured if name == peer and any((mine, setting) in measured for mine in own)]
        if not at:
            continue
        theirs = measured[peer, at[-1]]
        mine = min((measured[name, at[-1]] for name in own if (name, at[-1]) in measured), key=_median)
        what = f"{peer} / {mine.method}, time a point at {at[-1]}"
        found.append(Target(what, _median(theirs) / _median(mine) if _median(mine) > 0.0 else None, ">=", 1.0, "too short for this clock"))
        if "stress" in theirs.error and "stress" in mine.error:
            off, other = mine.error["stress"], theirs.error["stress"]
            share = 0.0 if off == 0.0 else off / other if other > 0.0 else float("inf")
            found.append(Target(f"{mine.method} / {peer}, error of the stress at {at[-1]}", share, "<=", 1.0))
    return tuple(found)


def _median(row: Measurement) -> float:
    assert row.seconds is not None
    return row.seconds.median
