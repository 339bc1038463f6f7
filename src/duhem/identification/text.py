"""An identification as text for people, and as the sheet that a notebook shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from duhem.identification.result import Estimate, Identification
from duhem.show.page import PAGE, Page
from duhem.show.printing import sheet, text
from duhem.show.sheet import Sheet

__all__ = ["as_sheet", "as_text"]

_FIELD = len("admissible")
_HEAD = ("parameter", "value", "std. error", "least", "greatest", "")


@text.register(Identification)
def as_text(done: Identification, page: Page = PAGE) -> str:
    """Coefficients with their uncertainty, what was minimised, outliers, and what is proved of the fitted law."""
    law, proved = done.family, _proved(done)
    return page.report(
        [
            [*page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name), *_fields(_fitted(done), page)],
            page.table([_HEAD, *map(_row, done.estimates)], "lr"),
            [*(line for remark in _remarks(done) for line in page.item(remark)), *_outliers(done, page)],
            _fields(proved, page),
        ]
    )


@sheet.register(Identification)
def as_sheet(done: Identification) -> Sheet:
    """The same as a sheet: coefficients in a table, what is open or on a bound and what lies apart as notes."""
    apart = tuple(f"row {o.row}: standardised {o.standardised:+.4g}, distance {o.distance:+.4g}" for o in done.outliers)
    notes = (("Remarks", tuple(_remarks(done))), ("Outliers", apart))
    fields = {**_fitted(done), **_proved(done)}
    return Sheet(f"Identification of {done.family.name}", tuple(fields.items()), _HEAD, tuple(map(_row, done.estimates)), notes)


def _fitted(done: Identification) -> dict[str, str]:
    fields = {
        "points": f"{len(done.points)} from {done.points.where}, {done.degrees_of_freedom} more than fitted parameters",
        "minimised": done.minimised,
        "scatter": _scatter(done),
    }
    if done.chi_squared is not None:
        chance = "" if done.p_value is None else f", p = {done.p_value:.3g}"
        fields["chi^2"] = f"{done.chi_squared:.4g} on {done.degrees_of_freedom} degrees of freedom{chance}"
    how = f"bootstrap, {len(done.draws)} draws, seed {done.seed}" if len(done.draws) else "from the covariance"
    fields["intervals"] = f"95 %, {how}"
    return fields


def _proved(done: Identification) -> dict[str, str]:
    standard = {True: "yes", False: "no", None: "undecided"}[done.verification.generalized_standard]
    return {
        "proved": ", ".join(f"{r.claim} {r.verdict.value}" for r in done.verification.results),
        "admissible": f"{standard} (the fitted law, exact parameters)",
    }


def _fields(values: Mapping[str, str], page: Page) -> list[str]:
    return [line for title, value in values.items() for line in page.field(title, value, _FIELD)]


def _scatter(done: Identification) -> str:
    if done.points.absolute:
        return "given, in the unit of the stresses"
    if done.level != done.level:
        return "unknown: no more points than fitted parameters; give a scatter column"
    unit = "in the unit of the stresses" if (done.points.scatter == 1.0).all() else "in the unit of the stresses, at the greatest weight"
    return f"{done.level:.4g} estimated, {unit}"


def _remarks(done: Identification) -> Iterator[str]:
    """What is said of parameters that are open, or end on a bound."""
    return (f"{e.name} is {e.remark}" for e in done.estimates if e.remark and e.state != "given")


def _row(estimate: Estimate) -> tuple[str, ...]:
    low, high = estimate.interval or (None, None)
    state = {"fitted": "on its bound" if estimate.remark else "", "given": "given", "open": "not identifiable"}[estimate.state]
    return (estimate.name, *map(_number, (estimate.value, estimate.standard_error, low, high)), state)


def _outliers(done: Identification, page: Page) -> Iterator[str]:
    if not done.outliers:
        yield from page.item(f"no outliers (none with |standardised residual| > {done.bound:.3g})")
        return
    chance = f"which one of {len(done.points)} sound points exceeds with chance 1 %"
    yield from page.item(f"outliers: |standardised residual| > {done.bound:.3g}, {chance}")
    rows = [(f"row {o.row}", f"line {o.line}", f"{o.standardised:+.4g}", f"{o.distance:+.4g}") for o in done.outliers]
    yield from page.table([("", "", "standardised", "distance"), *rows], "lr")
    if not done.robust:
        yield from page.item("they are in the fit; --robust bounds what they can do")


def _number(x: float | None) -> str:
    return "-" if x is None else f"{x:.6g}"
