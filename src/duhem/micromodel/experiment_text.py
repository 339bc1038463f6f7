"""The friction test as text: a table of predictions, the local friction both readings allow, the errata."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import Any

import sympy as sp

from duhem.micromodel.errata import errata
from duhem.micromodel.experiment import Bracket, Experiment

__all__ = ["text"]

WIDTH = 100


def text(experiment: Experiment, scatter: sp.Rational) -> str:
    """Everything about ``experiment`` with readings that may be off by ``scatter``."""
    return "\n".join([*_specimen(experiment), "", *_table(experiment), "", *_friction(experiment, scatter), "", *_errata(experiment)])


def _specimen(e: Experiment) -> Iterator[str]:
    lengths = f"L = {float(e.period) * 1e6:g} um, h = {float(e.height) * 1e6:g} um"
    yield f"{lengths}, tan alpha = {e.tan_alpha}, tan beta = {e.tan_beta}, load {e.normal_load} N"
    yield f"measured mu_a_plus = {float(e.measured_plus):g}, mu_a_minus = {float(e.measured_minus):g} (Antoni et al. 2007, section 3)"


def _table(e: Experiment) -> Iterator[str]:
    quarter, (best, _) = sp.Rational(1, 4), e.least_scatter()
    rows: list[tuple[str, ...]] = [
        ("local mu", "mu_a_plus", "mu_a_minus", "load + (N)", "load - (N)", "plus - measured", "minus - measured")
    ]
    for mu in sorted({e.mu_low, sp.Rational(24, 100), best.low, quarter, e.mu_high}):
        at = e.predicted(mu)
        numbers = (mu, at.plus, at.minus, at.load_plus, at.load_minus, at.plus - e.measured_plus, at.minus - e.measured_minus)
        rows.append(tuple(f"{float(x):+.5f}" if i > 4 else f"{float(x):.5f}" for i, x in enumerate(numbers)))
    yield from _columns(rows)


def _friction(e: Experiment, scatter: sp.Rational) -> Iterator[str]:
    found = e.consistent(scatter)
    mu, least = e.least_scatter()
    yield f"local mu that agrees with readings off by at most {float(scatter):g} each (ends proved by exact evaluation)"
    yield f"  mu_a_plus alone    {found.by_plus}"
    yield f"  mu_a_minus alone   {found.by_minus}"
    yield f"  both               {found.both or 'none'}"
    yield f"  the paper (Fig. 9) {float(e.mu_low):.6f} ... {float(e.mu_high):.6f}"
    yield f"  no mu agrees with both readings if each is off by less than {float(least):.6f}; with that, mu = {float(mu):.6f}"


def _errata(e: Experiment) -> Iterator[str]:
    yield "errata of the print"
    for entry in errata(e):
        yield f"  {entry.place}"
        yield from wrap(f"printed: {entry.printed}", WIDTH, initial_indent="    ", subsequent_indent="      ")
        yield from wrap(f"follows: {entry.follows}", WIDTH, initial_indent="    ", subsequent_indent="      ")
        yield from (f"      {name} = {_shown(value)}" for name, value in entry.numbers.items())


def _shown(value: Any) -> str:
    if isinstance(value, Bracket):
        return f"{float(value):.12f}"
    if isinstance(value, sp.Rational) and not value.is_integer:
        return f"{value} = {float(value):.12g}"
    return str(value)


def _columns(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
