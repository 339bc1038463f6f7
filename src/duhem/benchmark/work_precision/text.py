"""A benchmark as tables: errors beside times, failures among them, targets with their outcome."""

from __future__ import annotations

from collections.abc import Sequence

from duhem.benchmark.study_text import report
from duhem.benchmark.work_precision import increments as increment
from duhem.benchmark.work_precision import many_paths, throughput, whole_calls
from duhem.benchmark.work_precision import paths as path
from duhem.benchmark.work_precision.result import Measurement, Spread, WorkPrecision
from duhem.show.page import PAGE, Page, tied

__all__ = ["duration", "text"]

_TITLES = {
    increment.SCENE: "One increment: four trial stresses, each solved alone; largest relative error, time an increment",
    path.SCENE: "A loading path of four straight steps: largest error of the stress at the corners, time of the whole path",
    whole_calls.SCENE: "Many increments through duhem.project: wall time a point",
    many_paths.SCENE: "Many implicit steps through duhem.simulate: wall time a step of one point",
    throughput.SCENE: "Many increments at once: processor time a point; errors of some points, flags of the first 100, first call by the "
    "clock on the wall, what it compiles included",
}
_ERRORS = {increment.SCENE: ("stress", "slip"), path.SCENE: ("stress",), throughput.SCENE: ("stress", "slip")}


def text(result: WorkPrecision, page: Page = PAGE) -> str:
    """All there is, in the order of the scenes."""
    facts = result.machine
    versions = ", ".join(tied(f"{name} {v}") for name, v in facts["versions"].items())
    system = f"{facts['processors_usable']} processors usable, {facts['system']}, Python {facts['python']}"
    scenes = [_scene(result, scene, title, page) for scene, title in _TITLES.items()]
    return report(result, [f"{facts['processor']}, {system}, {versions}"], [*scenes, _targets(result, page)], page)


def _scene(result: WorkPrecision, scene: str, title: str, page: Page) -> list[str]:
    rows = [row for row in result.rows if row.scene == scene]
    return [*page.hanging(title), *_own_error(result, scene, page), *_table(rows, scene, page)] if rows else []


def _own_error(result: WorkPrecision, scene: str, page: Page) -> list[str]:
    own = result.reference.get(scene)
    if own is None:
        return []
    many = f"reference: the optimality conditions in many digits, its own error {own:.0e}" if isinstance(own, float) else ""
    return page.item(many or f"no reference: {own}")


def _table(rows: Sequence[Measurement], scene: str, page: Page) -> list[str]:
    names = _ERRORS.get(scene, ())
    judged = ["flagged"] if scene not in (path.SCENE, whole_calls.SCENE, many_paths.SCENE) else []
    called = ["first call"] if scene == throughput.SCENE else []
    head = ("method", "setting", *(f"error in {n}" for n in names), *judged, *called, "time", "least", "most", "runs")
    body: list[tuple[str, ...]] = [head]
    for row in rows:
        if row.failure is not None:
            body.append((row.method, row.setting, f"failed: {row.failure}"))
            continue
        if "megabytes" in row.error:
            body.append((row.method, row.setting, f"{row.error['megabytes']:.1f} MB"))
            continue
        errors = [f"{row.error[n]:.1e}" if n in row.error else "" for n in names]
        time = _time(row.seconds) if row.seconds else ("",) * 4
        first = [duration(row.first) if row.first is not None else "" for _ in called]
        body.append((row.method, row.setting, *errors, *([str(row.flagged) if row.error else ""] if judged else []), *first, *time))
    noted = [row for row in rows if row.note and row.failure is None and scene != path.SCENE]
    notes = [line for row in noted for line in page.item(f"note: {' '.join(filter(None, (row.method, row.setting)))}: {row.note}")]
    return [*page.table(body, "llr"), *notes]


def _time(spread: Spread) -> tuple[str, ...]:
    return (*map(duration, (spread.median, spread.least, spread.most)), str(spread.repeats))


def duration(seconds: float) -> str:
    """Three digits with a unit that people read."""
    for unit, name in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")):
        if seconds >= unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds * 1e9:.3g} ns"


def _targets(result: WorkPrecision, page: Page) -> list[str]:
    rows = [("ratio", "value", "target", "")]
    for target in result.targets:
        outcome = {True: "holds", False: "DOES NOT HOLD", None: f"not taken: {target.reason}"}[target.holds]
        value = "-" if target.value is None else f"{target.value:.3g}"
        rows.append((target.what, value, tied(f"{target.relation} {target.bound:g}"), outcome))
    return ["Targets (ratios of medians within this run)", *page.table(rows, "lrll")] if result.targets else []
