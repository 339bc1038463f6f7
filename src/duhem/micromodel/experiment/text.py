"""The friction test as text: a table of predictions, the local friction both readings allow, the errata."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from duhem.micromodel.experiment.errata import errata
from duhem.micromodel.experiment.friction_test import Bracket, Experiment
from duhem.show.page import PAGE, Page
from duhem.show.printing import text

__all__ = ["as_text"]


@text.register(Experiment)
def as_text(experiment: Experiment, page: Page = PAGE, *, scatter: sp.Rational) -> str:
    """Everything about ``experiment`` with readings that may be off by ``scatter``."""
    parts = (_specimen(experiment, page), _table(experiment, page), _friction(experiment, scatter, page), _errata(experiment, page))
    return page.report([[*part] for part in parts])


def _specimen(e: Experiment, page: Page) -> Iterator[str]:
    lengths = f"L = {float(e.period) * 1e6:g} um, h = {float(e.height) * 1e6:g} um"
    yield from page.hanging(f"{lengths}, tan alpha = {e.tan_alpha}, tan beta = {e.tan_beta}, load {e.normal_load} N")
    read = f"mu_a_plus = {float(e.measured_plus):g}, mu_a_minus = {float(e.measured_minus):g}"
    yield from page.hanging(f"measured {read} (Antoni et al. 2007, section 3)")


def _table(e: Experiment, page: Page) -> Iterator[str]:
    quarter, (best, _) = sp.Rational(1, 4), e.least_scatter()
    rows: list[tuple[str, ...]] = [
        ("local mu", "mu_a_plus", "mu_a_minus", "load + (N)", "load - (N)", "plus - measured", "minus - measured")
    ]
    for mu in sorted({e.mu_low, sp.Rational(24, 100), best.low, quarter, e.mu_high}):
        at = e.predicted(mu)
        numbers = (mu, at.plus, at.minus, at.load_plus, at.load_minus, at.plus - e.measured_plus, at.minus - e.measured_minus)
        rows.append(tuple(f"{float(x):+.5f}" if i > 4 else f"{float(x):.5f}" for i, x in enumerate(numbers)))
    yield from page.table(rows, "r")


def _friction(e: Experiment, scatter: sp.Rational, page: Page) -> Iterator[str]:
    found = e.consistent(scatter)
    mu, least = e.least_scatter()
    yield from page.hanging(f"local mu that agrees with readings off by at most {float(scatter):g} each (ends proved by exact evaluation)")
    ranges = {
        "mu_a_plus alone": f"{found.by_plus}",
        "mu_a_minus alone": f"{found.by_minus}",
        "both": f"{found.both or 'none'}",
        "the paper (Fig. 9)": f"{float(e.mu_low):.6f} ... {float(e.mu_high):.6f}",
    }
    for title, between in ranges.items():
        yield from page.field(title, between, max(map(len, ranges)))
    apart = f"no mu agrees with both readings if each is off by less than {float(least):.6f}"
    yield from page.item(f"{apart}; with that, mu = {float(mu):.6f}")


def _errata(e: Experiment, page: Page) -> Iterator[str]:
    yield "errata of the print"
    for entry in errata(e):
        yield from page.item(entry.place)
        yield from page.item(f"printed: {entry.printed}", "    ")
        yield from page.item(f"follows: {entry.follows}", "    ")
        for name, value in entry.numbers.items():
            yield from page.item(f"{name} = {_shown(value)}", "      ")


def _shown(value: Any) -> str:
    if isinstance(value, Bracket):
        return f"{float(value):.12f}"
    if isinstance(value, sp.Rational) and not value.is_integer:
        return f"{value} = {float(value):.12g}"
    return str(value)
