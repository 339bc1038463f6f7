"""What a material satisfies whose law is known, with the state that it keeps: the implicit step of that law, condition by condition.

The checks look at the steps of a path and at the one beyond it, as they were taken (:class:`duhem.testing.checks.law_in_state.LawStep`);
none asks the routine anew.  The stress may be off by u, of which each tolerance is what the conditions of the law make.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.law_in_state import LawStep
from duhem.testing.checks.query import NothingToCheck
from duhem.testing.checks.registry import Finding, register

__all__ = ["names_of"]

_of_states = partial(register, of_a_law=False, of_states=True)
_SIMO_HUGHES = "Simo and Hughes (1998), Computational Inelasticity, chapters 1 and 3: backward Euler"


def names_of(step: LawStep) -> tuple[str, ...]:
    """The names of the internal variables."""
    own = step.of.own
    return own.names[own.observables : own.observables + own.internal]


def _worst(h: HistoryQuery, off: Array, allowed: Array, say: object) -> Finding:
    """Of conditions (M, k) of the steps of all rows the one that is violated most, told by ``say`` of a step and a condition."""
    n, (many, count) = len(h.case), off.shape
    with np.errstate(all="ignore"):
        ratio = np.where(allowed > 0.0, np.abs(off) / np.where(allowed > 0.0, allowed, 1.0), np.where(off == 0.0, 0.0, np.inf))
    ratio = np.where(np.isnan(ratio), np.inf, ratio)
    by_row = ratio.reshape(many // n, n, count).transpose(1, 0, 2).reshape(n, -1)
    at = by_row.argmax(axis=1)
    most = by_row[np.arange(n), at]
    said = [say(int(j // count) * n + i, int(j % count)) if most[i] > 1.0 else "" for i, j in enumerate(at)]  # type: ignore[operator]
    return Finding(most, np.ones(n), np.array(said, dtype=object))


def _at(step: LawStep, i: int) -> str:
    """The state at the end of a step, in words."""
    own, o = step.of.own, step.of.own.observables
    others = [f"{own.names[o + j]} = {step.ended[i, o + j]:.6g}" for j in step.of.known[:4]]
    return f"at sigma = [{', '.join(f'{x:.6g}' for x in step.after.stress[i])}]" + "".join(f", {each}" for each in others)


@_of_states(
    "kept-state",
    statement="what the routine keeps of the slip is what its stress and strain say",
    formula="sigma = d psi/d u (u, alpha)",
    source="without it the plastic strain in the results is not that of the stress",
    tolerance="what u makes of it",
)
def kept_state(h: HistoryQuery) -> Finding:
    step, more = h.law_step, h.law_step.of.more
    if not more:
        raise NothingToCheck("the state has no place for what follows from the stress")
    kept, (value, allowed) = step.after.variables[:, [each.place for each in more]], step.derived()

    def say(i: int, j: int) -> str:
        return f"{more[j].told} is {value[i, j]:.6g} by stress and strain, and kept as {kept[i, j]:.6g}, {_at(step, i)}"

    return _worst(h, kept - value, allowed, say)


@_of_states(
    "stress-of-the-state",
    statement="the stress is that of the law's energy at the state that is kept",
    formula="sigma = d psi/d u (u, alpha)",
    source="Antoni et al. (2007), Eqs. 22-31: the first state law",
    tolerance="4 u",
)
def stress_of_the_state(h: HistoryQuery) -> Finding:
    step, o = h.law_step, h.law_step.of.own.observables
    if len(step.of.slips) >= o:
        raise NothingToCheck("the slip is read from the stress")
    force = step.of.own.free_energy.first(step.ended, step.others)[1][:, :o]
    back = np.argsort(step.of.columns)
    off = step.after.stress - force[:, back]
    size = h.length(off)[:, None]

    def say(i: int, j: int) -> str:
        return f"the stress of the energy is [{', '.join(f'{x:.6g}' for x in force[i, back])}], {_at(step, i)}"

    return _worst(h, size, 4.0 * step.slip_error[:, None], say)


@_of_states(
    "admissibility",
    statement="the stress lies in K of the new state",
    formula="g(Y; alpha) <= 0",
    source=_SIMO_HUGHES,
    tolerance="|dg/dY| u, and what u makes of the variables",
)
def admissibility(h: HistoryQuery) -> Finding:
    step = h.law_step
    if not step.level.shape[1]:
        raise NothingToCheck("a law of rates has no criterion")
    over = np.where(step.bound[:, None] | np.isnan(step.level), 0.0, np.maximum(step.level, 0.0))

    def say(i: int, j: int) -> str:
        return f"g = {step.level[i, j]:.4g}, {step.level[i, j] / step.size[i, j]:.3g} of the terms it is made of, {_at(step, i)}"

    return _worst(h, over, 4.0 * step.level_allowed, say)


@_of_states(
    "loading",
    statement="what flows is at the end of K, and flows outward",
    formula="lambda >= 0, lambda g = 0",
    source=_SIMO_HUGHES,
    tolerance="as of admissibility; of lambda what u makes of it",
)
def loading(h: HistoryQuery) -> Finding:
    step = h.law_step
    if not step.level.shape[1]:
        raise NothingToCheck("a law of rates has no criterion")
    inside = np.where(step.multiplier > 4.0 * step.multiplier_error, np.maximum(-step.level, 0.0), 0.0)
    back = np.maximum(-step.multiplier, 0.0)
    least = np.where(np.isfinite(step.multiplier_error), step.multiplier_error, 1.0)
    count = inside.shape[1]

    def say(i: int, j: int) -> str:
        if j >= count:
            return f"what slips goes against the flow of the law: lambda = {step.multiplier[i, j - count]:.4g}, {_at(step, i)}"
        return f"it flows with g = {step.level[i, j]:.4g} < 0, {-step.level[i, j] / step.size[i, j]:.3g} of its terms, {_at(step, i)}"

    return _worst(h, np.hstack([inside, back]), 4.0 * np.hstack([step.level_allowed, least]), say)


def _evolved(h: HistoryQuery, which: NDArray[np.intp]) -> Finding:
    step = h.law_step
    if not which.size:
        raise NothingToCheck("the law has no such variable")
    names = names_of(step)

    def say(i: int, j: int) -> str:
        v = which[j]
        return f"{names[v]} changes by {step.change[i, v]:.6g}, and by {step.moved[i, v]:.6g} in the law, {_at(step, i)}"

    return _worst(h, step.off[:, which], 2.0 * step.allowed[:, which], say)


@_of_states(
    "flow",
    statement="the plastic strain goes in the direction of the law's flow",
    formula="k^-1 (sigma_tr - sigma) = lambda h(Y; alpha) + dt r",
    source=_SIMO_HUGHES,
    tolerance="what u makes of both sides",
)
def flow(h: HistoryQuery) -> Finding:
    return _evolved(h, h.law_step.of.slips)


@_of_states(
    "evolution",
    statement="each variable of the state is advanced once a step, as the law says",
    formula="alpha - alpha_n = lambda h(Y; alpha) + dt r(Y; alpha)",
    source=_SIMO_HUGHES,
    tolerance="what u makes of both sides, and the accuracy of the variable itself",
)
def evolution(h: HistoryQuery) -> Finding:
    return _evolved(h, h.law_step.of.known)


@_of_states(
    "law-dissipation",
    statement="no step gains energy where the law's does not: Y . d alpha >= 0, with what the law stores",
    formula="Y . (alpha - alpha_n) >= 0",
    source="Antoni et al. (2007), Eqs. 22, 36: Clausius-Duhem",
    tolerance="what u makes of it",
)
def law_dissipation(h: HistoryQuery) -> Finding:
    step, own = h.law_step, h.law_step.of.own
    force = step.of.own.stored(step.ended, step.others)[1]
    gained = -(force * step.change[:, own.order]).sum(axis=1)
    by_law = -(force * step.moved[:, own.order]).sum(axis=1)
    allowed = (np.abs(force) * step.allowed[:, own.order]).sum(axis=1)

    def say(i: int, j: int) -> str:
        return f"the step gains {gained[i]:.4g}, {_at(step, i)}"

    return _worst(h, np.where(by_law > allowed, 0.0, np.maximum(gained, 0.0))[:, None], allowed[:, None], say)
