"""An identification as text for people."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from duhem.identification.result import Estimate, Identification
from duhem.show.printing import text

__all__ = ["as_text"]

WIDTH = 96
_FIELD = len("admissible")


@text.register(Identification)
def as_text(done: Identification) -> str:
    """Coefficients with their uncertainty, what was minimised, outliers, and what is proved of the fitted law."""
    law = done.family
    lines = [f"{law.name}: {law.summary}" if law.summary else law.name]
    lines += _field("points", f"{len(done.points)} from {done.points.where}, {done.degrees_of_freedom} more than fitted parameters")
    lines += _field("minimised", done.minimised)
    lines += _field("scatter", _scatter(done))
    if done.chi_squared is not None:
        chance = "" if done.p_value is None else f", p = {done.p_value:.3g}"
        lines += _field("chi^2", f"{done.chi_squared:.4g} on {done.degrees_of_freedom} degrees of freedom{chance}")
    how = f"bootstrap, {len(done.draws)} draws, seed {done.seed}" if len(done.draws) else "from the covariance"
    lines += _field("intervals", f"95 %, {how}")
    lines += ["", *_table([("parameter", "value", "std. error", "least", "greatest", ""), *map(_row, done.estimates)]), ""]
    for name in done.open:
        lines += wrap(f"{name} is {done[name].remark}", WIDTH, initial_indent="  ", subsequent_indent="    ")
    lines += [*_outliers(done), ""]
    lines += _field("proved", ", ".join(f"{r.claim} {r.verdict.value}" for r in done.verification.results))
    standard = {True: "yes", False: "no", None: "undecided"}[done.verification.generalized_standard]
    lines += _field("admissible", f"{standard} (the fitted law, exact parameters)")
    return "\n".join(line.rstrip() for line in lines)


def _scatter(done: Identification) -> str:
    if done.points.absolute:
        return "given, in the unit of the stresses"
    if done.level != done.level:
        return "unknown: no more points than fitted parameters; give a scatter column"
    unit = "in the unit of the stresses" if (done.points.scatter == 1.0).all() else "in the unit of the stresses, at the greatest weight"
    return f"{done.level:.4g} estimated, {unit}"


def _row(estimate: Estimate) -> tuple[str, ...]:
    low, high = estimate.interval or (None, None)
    state = {"fitted": "", "given": "given", "open": "not identifiable"}[estimate.state]
    return (estimate.name, *map(_number, (estimate.value, estimate.standard_error, low, high)), state)


def _outliers(done: Identification) -> Iterator[str]:
    if not done.outliers:
        yield f"  no outliers (none with |standardised residual| > {done.bound:.3g})"
        return
    yield f"  outliers: |standardised residual| > {done.bound:.3g}, which one of {len(done.points)} sound points exceeds with chance 1 %"
    rows = [(f"row {o.row}", f"line {o.line}", f"{o.standardised:+.4g}", f"{o.distance:+.4g}") for o in done.outliers]
    yield from _table([("", "", "standardised", "distance"), *rows])
    if not done.robust:
        yield "  they are in the fit; --robust bounds what they can do"


def _number(x: float | None) -> str:
    return "-" if x is None else f"{x:.6g}"


def _field(title: str, value: str) -> list[str]:
    return wrap(value, WIDTH, initial_indent=f"  {title:<{_FIELD}}  ", subsequent_indent=" " * (_FIELD + 4), break_long_words=False)


def _table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  " + "  ".join([row[0].ljust(widths[0]), *(x.rjust(w) for x, w in zip(row[1:], widths[1:], strict=True))]) for row in rows]
