"""A benchmark as tables: errors beside times, failures among them, targets with their outcome."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from duhem.benchmark.work_precision import increments as increment
from duhem.benchmark.work_precision import paths as path
from duhem.benchmark.work_precision import throughput
from duhem.benchmark.work_precision.result import Measurement, Spread, WorkPrecision

__all__ = ["duration", "table", "text"]

WIDTH = 110
_TITLES = {
    increment.SCENE: "One increment: four trial stresses, each solved alone; largest relative error, time an increment",
    path.SCENE: "A loading path of four straight steps: largest error of the stress at the corners, time of the whole path",
    throughput.SCENE: "Many increments at once: processor time a point",
}


def text(result: WorkPrecision) -> str:
    """All there is, in the order of the scenes."""
    lines = [f"{result.law}: {result.subject}"]
    facts = result.machine
    versions = ", ".join(f"{name} {v}" for name, v in facts["versions"].items())
    lines += wrap(
        f"{facts['processor']}, {facts['processors_usable']} processors usable, {facts['system']}, Python {facts['python']}, {versions}",
        WIDTH,
    )
    for scene, title in _TITLES.items():
        rows = [row for row in result.rows if row.scene == scene]
        if rows:
            lines += ["", title, *_own_error(result, scene), *_table(rows, scene)]
    if result.targets:
        lines += ["", "Targets (ratios of medians within this run)", *_targets(result)]
    if result.left_out:
        lines += ["", "Left out"]
        for part in result.left_out:
            lines += wrap(f"{part.part}: {part.reason}", WIDTH, initial_indent="  ", subsequent_indent="    ")
    if result.interrupted:
        lines += ["", "Interrupted: this is what was done."]
    return "\n".join(lines)


def _own_error(result: WorkPrecision, scene: str) -> Iterator[str]:
    own = result.reference.get(scene)
    if isinstance(own, float):
        yield f"  reference: the optimality conditions in many digits, its own error {own:.0e}"
    elif own is not None:
        yield f"  no reference: {own}"


def _table(rows: Sequence[Measurement], scene: str) -> Iterator[str]:
    names = {increment.SCENE: ("stress", "slip"), path.SCENE: ("stress",), throughput.SCENE: ()}[scene]
    head = (
        "method",
        "setting",
        *(f"error in {n}" for n in names),
        *(["flagged"] if scene == increment.SCENE else []),
        "time",
        "least to most",
    )
    body: list[tuple[str, ...]] = [head]
    for row in rows:
        if row.failure is not None:
            body.append((row.method, row.setting, f"failed: {row.failure}"))
            continue
        flagged = [str(row.flagged)] if scene == increment.SCENE else []
        if "megabytes" in row.error:
            body.append((row.method, row.setting, f"{row.error['megabytes']:.1f} MB", ""))
            continue
        errors = [f"{row.error[n]:.1e}" if n in row.error else "" for n in names]
        time = (duration(row.seconds.median), _range(row.seconds)) if row.seconds else ("", "")
        body.append((row.method, row.setting, *errors, *flagged, *time))
    yield from table(body)
    for row in rows:
        if row.note and row.failure is None and scene != path.SCENE:
            yield from wrap(f"{row.method}: {row.note}", WIDTH, initial_indent="  note: ", subsequent_indent="    ")


def _range(spread: Spread) -> str:
    return f"{duration(spread.least)} to {duration(spread.most)}, {spread.repeats} run{'s' if spread.repeats > 1 else ''}"


def duration(seconds: float) -> str:
    """Three digits with a unit that people read."""
    for unit, name in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")):
        if seconds >= unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds * 1e9:.3g} ns"


def _targets(result: WorkPrecision) -> Iterator[str]:
    body = []
    for target in result.targets:
        outcome = {True: "holds", False: "DOES NOT HOLD", None: f"not taken: {target.reason}"}[target.holds]
        value = "-" if target.value is None else f"{target.value:.3g}"
        body.append((target.what, value, f"{target.relation} {target.bound:g}", outcome))
    yield from table(body)


def table(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    """Columns by their widest entry; a last entry that ends its row early may be of any length."""
    most = max(map(len, rows))
    full = [row for row in rows if len(row) == most]
    widths = [max([len(row[i]) for row in full] + [len(row[i]) for row in rows if len(row) > i + 1]) for i in range(most)]
    for row in rows:
        yield ("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))).rstrip()
