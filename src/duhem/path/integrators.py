"""The ways along a loading path that there are, by name, and the steps of two of them.

The implicit step, first order, is the closest point of K at the end of the step to the stress without slip,

    sigma = argmin over K(sigma_n) of (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2,   sigma_tr = sigma_before + k du

(Moreau, 1977, the catching-up algorithm).  Its energy is exact in the sense sigma . du = dpsi + sigma . du_in + du_e . k du_e / 2.
The extrapolated step, second order, is two half steps and a whole one, extrapolated (Richardson, 1911), then put back into K:
sigma = P(2 sigma_halves - sigma_whole), with P the closest point, which takes off what the extrapolation left outside.

Both are written once, for rows: many points at one knot of their paths, one point at knots in turn, up to its first slip, or one row on
plain numbers.  Trials are taken from where a point last slipped, so that no rounding gathers while it sticks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from duhem.path import exact
from duhem.path.closest import Closest, closest_by, closest_point, shape_by, vouched
from duhem.path.exact import Piece
from duhem.path.loading import Knot, Which
from duhem.path.rows import (
    Ledger,
    ManyRows,
    OneRow,
    RowsFound,
    Step,
    Stepped,
    Vector,
    Ways,
    by_arrays,
)
from duhem.path.run import Plan, Share
from duhem.projection.in_blocks import FEW

__all__ = ["INTEGRATORS", "STEPS", "Integrator", "Stepping", "stretch"]

Rows = ManyRows | OneRow
_MOST_AHEAD = 4096
_ALONE = np.zeros(1, dtype=np.intp)


def implicit(rows: Rows) -> Step:
    """The implicit step."""
    k, c, formulas = rows.k, rows.c, rows.formulas

    def step(anchor_stress: Vector, anchor: Vector, before: Vector, knot: Knot, which: Which) -> Stepped | None:
        u = rows.displacement(knot, which)
        trial = formulas.pulled(anchor_stress, u, anchor, k)
        if (found := rows.closest(trial, knot, which)) is None:
            return None
        stress, slip, multiplier, slips, lost = found
        start = rows.displacement(knot - 1, which)
        near, psi, added = formulas.booked(rows.preceding(before, trial), trial, stress, slip, multiplier, slips, u, start, k, c)
        return Stepped(u, near, slip, psi, added, slips, lost)

    return step


def extrapolated(rows: Rows) -> Step:
    """The extrapolated step, over paths with two rows a step."""
    k, c, formulas = rows.k, rows.c, rows.formulas

    def begun(before: Vector, ways: Ways, end: Knot, which: Which) -> tuple[RowsFound, RowsFound] | None:
        """The first half and the whole step from the stress before."""
        start, middle, u = ways
        whole = rows.closest(formulas.pulled(before, u, start, k), end, which)
        first = rows.closest(formulas.pulled(before, middle, start, k), end - 1, which)
        return None if first is None or whole is None else (first, whole)

    def slid(before: Vector, ways: Ways, end: Knot, which: Which, first: RowsFound, whole: RowsFound) -> Stepped | None:
        start, middle, u = ways
        second = rows.closest(formulas.pulled(first.stress, u, middle, k), end, which)
        back = None if second is None else rows.closest(formulas.doubled(second.stress, whole.stress), end, which)
        if second is None or back is None:
            return None
        slip, psi, added = formulas.summed(before, first[:3], second[:3], whole[:3], back.stress, start, middle, u, k, c)
        return Stepped(u, back.stress, slip, psi, added, True, rows.worst(whole, first, second, back))

    def step(anchor_stress: Vector, anchor: Vector, before: Vector, knot: Knot, which: Which) -> Stepped | None:
        end = 2 * knot
        start, middle, u = (rows.displacement(end - back, which) for back in (2, 1, 0))
        half, trial = (formulas.pulled(anchor_stress, to, anchor, k) for to in (middle, u))
        if (looked := rows.both(half, trial, end, which)) is None:
            return None
        first, whole = looked
        before, slips = rows.preceding(before, trial), first.slips | whole.slips
        near, psi, added = formulas.booked(before, trial, trial, rows.none, 0.0, False, u, u, k, c)
        sticks = Stepped(u, near, rows.none, psi, added, slips, rows.worst(first, whole))
        return rows.sliding(sticks, looked, begun, slid, anchor, (before, (start, middle, u), end, which))

    return step


@dataclass(frozen=True)
class Stepping:
    """One way of stepping, as a value.

    ``halves``: into how many rows a step of the path is cut; ``step`` is the step of rows; ``said`` is what is said of it beside the
    method of the closest point.
    """

    halves: int
    step: Callable[[Rows], Step]
    said: str = ""

    piece: ClassVar[None] = None  # the knots are all that is known

    def by_arrays(self, block: Share, at: Closest) -> Step:
        """The step of a block's points, by arrays."""
        return by_arrays(self.step(ManyRows(block, at)))

    def why(self, plan: Plan) -> str:
        """How the closest point is found."""
        block = Share.alone(plan)
        return f"{closest_by(block, plan.projection, shape_by(block, plan.projection))[1]}{self.said}"

    def steps(self, plan: Plan) -> tuple[Step, Step | None]:
        """The step of one path, of several rows and of one; None for this where arrays do it."""
        block = Share.alone(plan, self.halves)
        shape = shape_by(block, plan.projection)
        at, _ = closest_by(block, plan.projection, shape)
        point = closest_point(block, plan.projection, shape, at)
        return self.by_arrays(block, vouched(at)), None if point is None else self.step(OneRow(block, point))

    def advance(self, plan: Plan, ledger: Ledger) -> Iterator[int]:
        """Fill the ledger row by row; yields the number of rows done.  Stretches without slip are taken in blocks."""
        made = self.steps(plan)
        anchor, ahead = ledger.anchor, 1
        while ledger.done < len(plan.path.values):
            if stretch(plan, ledger, made, anchor, ahead):
                anchor, ahead = ledger.done - 1, 1
            else:
                ahead = min(2 * ahead, _MOST_AHEAD)
            yield ledger.done


STEPS: Mapping[str, Stepping] = MappingProxyType(
    {"implicit": Stepping(1, implicit), "extrapolated": Stepping(2, extrapolated, ", extrapolated from whole and half steps")}
)


def stretch(plan: Plan, ledger: Ledger, made: tuple[Step, Step | None], anchor: int, ahead: int) -> bool:
    """The next rows up to the first that slips, no more than ``ahead``, from the row ``anchor`` that last slipped; whether one does."""
    first, values = ledger.done, plan.path.values
    last = min(first + ahead, len(values))
    step, one = made
    if one is not None and ahead <= FEW:
        begun, before = (ledger.stress[anchor].tolist(), values[anchor].tolist()), ledger.stress[first - 1].tolist()
        while ledger.done < last and (row := one(*begun, before, ledger.done, _ALONE)) is not None:
            ledger.row(row)
            if row.slips:
                return True
            before = row.stress
        if ledger.done > first:
            return False
    knots = np.arange(first, last)
    found = step(
        ledger.stress[anchor : anchor + 1], values[anchor : anchor + 1], ledger.stress[first - 1 : first], knots, np.zeros_like(knots)
    )
    slips = np.flatnonzero(found.slips)
    n = int(slips[0]) + 1 if slips.size else len(knots)
    ledger.rows(found.stress[:n], found.slip[:n], [gain[:n] for gain in found.added])
    return bool(slips.size)


@dataclass(frozen=True)
class Integrator:
    """One way along a path, as a value.

    ``why(plan)`` says what the path is integrated by; ``advance(plan, ledger)`` fills the ledger row by row and yields
    the number of rows done.  ``piece(plan)`` moves the stress within a step, for what lies between two knots; None where
    the knots are all that is known.
    """

    why: Callable[[Plan], str]
    advance: Callable[[Plan, Ledger], Iterator[int]]
    piece: Callable[[Plan], Piece] | None = None


INTEGRATORS: Mapping[str, Integrator | Stepping] = MappingProxyType({**STEPS, "exact": Integrator(exact.why, exact.advance, exact.piece)})
