"""The ways along a loading path that there are, by name, and the steps of two of them.

The implicit step, first order, is the closest point of K at the end of the step to the stress without slip,

    sigma = argmin over K(sigma_n) of (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2,   sigma_tr = sigma_before + k du

(Moreau, 1977, the catching-up algorithm).  Its energy is exact in the sense sigma . du = dpsi + sigma . du_in + du_e . k du_e / 2.
The extrapolated step, second order, is two half steps and a whole one, extrapolated (Richardson, 1911), then put back into K:
sigma = P(2 sigma_halves - sigma_whole), with P the closest point, which takes off what the extrapolation left outside.

Both are written once, for rows: many points at one knot of their paths, or one point at knots in turn, up to its first slip.  Trials
are taken from where a point last slipped, so that no rounding gathers while it sticks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from duhem.path import exact, one_row
from duhem.path.batch import Share
from duhem.path.closest import Closest, closest_by, closest_points, shape_by, vouched
from duhem.path.exact import Piece
from duhem.path.ledger import Gains, Ledger
from duhem.path.one_row import ClosestPoint, RowStep, closest_point
from duhem.path.paths import Knot, Which
from duhem.path.run import Plan, energy, inner, times
from duhem.projection.in_blocks import FEW
from duhem.projection.result import Array

__all__ = ["INTEGRATORS", "STEPS", "Integrator", "Step", "Stepped", "Stepping", "gains", "steps", "stretch"]

_MOST_AHEAD = 4096


class Stepped(NamedTuple):
    """What a step makes of n rows: displacement, stress and slip (n, d), what it adds to the sums, which slip, the status where lost."""

    displacement: Array
    stress: Array
    slip: Array
    gains: Gains
    slips: NDArray[np.bool_]
    lost: NDArray[np.int8]


Step = Callable[[Array, Array, Array, Knot, Which], Stepped]
"""(stress and displacement where each row last slipped, stress before, knots, points) -> what the step makes of them; ``before`` has
one row where these are knots of one point in turn."""


def implicit(block: Share, at: Closest) -> Step:
    """The implicit step of a block's points."""
    k, c, path = block.members[0].stiffness, block.compliance, block.paths.at

    def step(anchor_stress: Array, anchor: Array, before: Array, knot: Knot, which: Which) -> Stepped:
        u = path(knot, which)
        trial = anchor_stress + times(u - anchor, k)
        found = at(trial, knot, which)
        slips = found.slips()
        stress = np.where(slips[:, None], found.stress, trial)
        if len(before) < len(trial):
            before = np.concatenate([before, stress[:-1]])
        du = u - path(knot - 1, which)
        return Stepped(u, stress, found.slip, gains(k, c, before, stress, found.slip, found.multiplier, slips, du), slips, found.lost)

    return step


def extrapolated(block: Share, at: Closest) -> Step:
    """The extrapolated step, over paths with two rows a step.

    Multiplier, dissipation and work are extrapolated alike, but the first two never below zero: where the two estimates of a
    dissipation are so far apart that this would happen, that of the half steps stands.  The balance of energy holds to
    the order of the method.
    """
    k, c, path = block.members[0].stiffness, block.compliance, block.paths.at

    def step(anchor_stress: Array, anchor: Array, before: Array, knot: Knot, which: Which) -> Stepped:
        n, end = len(which), 2 * knot
        start, middle, u = path(end - 2, which), path(end - 1, which), path(end, which)
        trial = anchor_stress + times(u - anchor, k)
        half = anchor_stress + times(middle - anchor, k)
        knots = np.concatenate([np.broadcast_to(end - 1, n), np.broadcast_to(end, n)])
        looked = at(np.concatenate([half, trial]), knots, np.concatenate([which, which]))
        seen, lost = looked.slips(), looked.lost.reshape(2, n).max(axis=0)
        slips = seen[:n] | seen[n:]
        if len(before) < n:  # nothing is asked behind the first slip
            n = int(np.argmax(slips)) + 1 if slips.any() else n
            before = np.concatenate([before, trial[: n - 1]])
            start, middle, u, trial = (rows[:n] for rows in (start, middle, u, trial))
            which, slips, lost = which[:n], slips[:n], lost[:n]
        added = np.zeros((4, n))
        added[2] = inner(0.5 * (before + trial), times(trial - before, c))
        stress, slip = trial.copy(), np.zeros_like(trial)
        if (go := np.flatnonzero(slips & (lost == 0))).size:
            own, s, last = which[go], before[go], knots[len(knots) // 2 :][go]
            du, d1, d2 = (u - start)[go], (middle - start)[go], (u - middle)[go]
            whole = at(s + times(du, k), last, own)
            first = at(s + times(d1, k), last - 1, own)
            second = at(first.stress + times(d2, k), last, own)
            back = at(2.0 * second.stress - whole.stress, last, own)
            one = np.array([whole.multiplier, *energies(k, whole.stress, whole.slip, du)])
            parts = [energies(k, found.stress, found.slip, d) for found, d in ((first, d1), (second, d2))]
            two = np.array([first.multiplier + second.multiplier, *np.add(parts[0], parts[1])])
            sums = np.where(2.0 * two >= one, 2.0 * two - one, two)
            sums[2] = 2.0 * two[2] - one[2]  # work has either sign
            stress[go], slip[go], added[:, go] = back.stress, du - times(back.stress - s, c), sums
            lost[go] = np.max([found.lost for found in (whole, first, second, back)], axis=0)
        return Stepped(u, stress, slip, (added[0], added[1], added[2], added[3]), slips, lost)

    return step


@dataclass(frozen=True)
class Stepping:
    """One way of stepping, as a value.

    ``halves``: into how many rows a step of the path is cut; ``rows`` and ``row`` are the step, of many rows and of one on plain
    numbers; ``said`` is what is said of it beside the method of the closest point.
    """

    halves: int
    rows: Callable[[Share, Closest], Step]
    row: Callable[[Share, ClosestPoint], RowStep]
    said: str = ""


STEPS: Mapping[str, Stepping] = MappingProxyType(
    {
        "implicit": Stepping(1, implicit, one_row.implicit),
        "extrapolated": Stepping(2, extrapolated, one_row.extrapolated, ", extrapolated from whole and half steps"),
    }
)


def energies(k: Array, stress: Array, slip: Array, du: Array) -> tuple[Array, Array, Array]:
    """Dissipation sigma . du_in, work sigma . du and du_e . k du_e / 2 of implicit steps, a row each, in Pa m."""
    return inner(stress, slip), inner(stress, du), energy(du - slip, k)


def gains(k: Array, c: Array, before: Array, stress: Array, slip: Array, multiplier: Array, slips: NDArray[np.bool_], du: Array) -> Gains:
    """What implicit steps add to multiplier, dissipation, work and numerical loss, (n,) each; where nothing slips the work is stored."""
    dissipation, work, numerical = energies(k, stress, slip, du)
    if slips.all():
        return multiplier, dissipation, work, numerical
    stored = inner(0.5 * (before + stress), times(stress - before, c))
    return multiplier, np.where(slips, dissipation, 0.0), np.where(slips, work, stored), np.where(slips, numerical, 0.0)


# -- along one path ------------------------------------------------------------------------------------------------------


def _why(method: str, plan: Plan) -> str:
    """How the closest point is found."""
    return f"{closest_points(Share.alone(plan), plan.projection)[1]}{STEPS[method].said}"


def _advance(method: str, plan: Plan, ledger: Ledger) -> Iterator[int]:
    """Fill the ledger row by row; yields the number of rows done.  Stretches without slip are taken in blocks."""
    made = steps(method, plan)
    anchor, ahead = ledger.anchor, 1
    while ledger.done < len(plan.path.values):
        if stretch(plan, ledger, made, anchor, ahead):
            anchor, ahead = ledger.done - 1, 1
        else:
            ahead = min(2 * ahead, _MOST_AHEAD)
        yield ledger.done


def steps(method: str, plan: Plan) -> tuple[Step, RowStep | None]:
    """The step of one path, of several rows and of one; None for this where arrays do it."""
    way = STEPS[method]
    block = Share.alone(plan, way.halves)
    shape = shape_by(block, plan.projection)
    at, _ = closest_by(block, plan.projection, shape)
    point = closest_point(block, plan.projection, shape, at)
    return way.rows(block, vouched(at)), None if point is None else way.row(block, point)


def stretch(plan: Plan, ledger: Ledger, made: tuple[Step, RowStep | None], anchor: int, ahead: int) -> bool:
    """The next rows up to the first that slips, no more than ``ahead``, from the row ``anchor`` that last slipped; whether one does."""
    first, values = ledger.done, plan.path.values
    last = min(first + ahead, len(values))
    step, one = made
    if one is not None and ahead <= FEW:
        anchor_stress, before = ledger.stress[anchor].tolist(), ledger.stress[first - 1].tolist()
        while ledger.done < last and (row := one(anchor_stress, anchor, before, ledger.done)) is not None:
            ledger.row(row)
            if row.slips:
                return True
            before = row.stress
        if ledger.done > first:
            return False
    knots = np.arange(first, last)
    found = step(ledger.stress[anchor], values[anchor], ledger.stress[first - 1 : first], knots, np.zeros_like(knots))
    slips = np.flatnonzero(found.slips)
    n = int(slips[0]) + 1 if slips.size else len(knots)
    ledger.rows(found.stress[:n], found.slip[:n], [gain[:n] for gain in found.gains])
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


INTEGRATORS: Mapping[str, Integrator] = MappingProxyType(
    {name: Integrator(partial(_why, name), partial(_advance, name)) for name in STEPS}
    | {"exact": Integrator(exact.why, exact.advance, exact.piece)}
)
