"""What a material satisfies whose law is known, with the state that it keeps: the implicit step of that law, condition by condition.

The checks look at the steps of a path and at the one beyond it, as they were taken (:class:`duhem.testing.checks.law_in_state.LawStep`);
none asks the routine anew.  The stress may be off by u, and each tolerance is what the law's condition makes of u.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.law_in_state import LawStep
from duhem.testing.checks.query import NothingToCheck
from duhem.testing.checks.registry import Finding, register
from duhem.testing.drawn.case import vector

__all__: list[str] = []

_EULER = "Simo and Hughes (1998), Computational Inelasticity, chapters 1 and 3: backward Euler"
_DISSIPATION = "Antoni et al. (2007), Eqs. 22-36: state laws and Clausius-Duhem"

# conditions (M, k) of M steps, by how much they may be violated, and what is said of a step and a condition
Condition: TypeAlias = tuple[Array, Array, Callable[[int, int], str]]
_Enter: TypeAlias = Callable[[Callable[[LawStep, HistoryQuery], Condition]], None]


def _condition(name: str, statement: str, formula: str, tolerance: str = "what u makes of it", source: str = _EULER) -> _Enter:
    """Return a decorator that enters a function of steps and their metric as a check."""

    def add(measure: Callable[[LawStep, HistoryQuery], Condition]) -> None:
        said = {"name": name, "statement": statement, "formula": formula, "tolerance": tolerance, "source": source}
        register(of_a_law=False, of_states=True, **said)(lambda h: _worst(h, *measure(h.law_step, h)))

    return add


def _worst(h: HistoryQuery, off: Array, allowed: Array, say: Callable[[int, int], str]) -> Finding:
    """Return, for each row, the condition that its steps violate most."""
    n, (many, count), step = len(h.case), off.shape, h.law_step
    with np.errstate(all="ignore"):
        ratio = np.where(allowed > 0.0, np.abs(off) / np.where(allowed > 0.0, allowed, 1.0), np.where(off == 0.0, 0.0, np.inf))
    by_row = np.where(np.isnan(ratio), np.inf, ratio).reshape(many // n, n, count).transpose(1, 0, 2).reshape(n, -1)
    at = by_row.argmax(axis=1)
    most, said = by_row[np.arange(n), at], np.full(n, "", dtype=object)
    for i in np.flatnonzero(most > 1.0):
        leg, j = divmod(int(at[i]), count)
        row, own, o = leg * n + i, step.of.own, step.of.own.observables
        state = [f"{own.names[o + v]} = {step.ended[row, o + v]:.6g}" for v in step.of.known[:4]]
        which = f"in step {leg + 1} of {many // n}, " if many > n else ""
        said[i] = f"{which}{say(row, j)}, at {', '.join([f'sigma = {vector(step.after.stress[row])}', *state])}"
    return Finding(most, np.ones(n), said)


@_condition(
    "kept-state", "what the routine keeps of the slip is what its stress and strain say", "sigma = d psi/d u (u, alpha)",
    source="without it the plastic strain in the results is not that of the stress",
)  # fmt: skip
def _(step: LawStep, h: HistoryQuery) -> Condition:
    if not (more := step.of.more):
        raise NothingToCheck("the state has no place for what follows from the stress")
    kept, (value, allowed) = step.after.variables[:, [each.place for each in more]], step.derived()
    return kept - value, allowed, lambda i, j: f"{more[j].told} is {value[i, j]:.6g} by stress and strain, and kept as {kept[i, j]:.6g}"


@_condition(
    "stress-of-the-state", "the stress is that of the law's energy at the state that is kept", "sigma = d psi/d u (u, alpha)", "4 u",
    _DISSIPATION,
)  # fmt: skip
def _(step: LawStep, h: HistoryQuery) -> Condition:
    o = step.of.own.observables
    if len(step.of.slips) >= o:
        raise NothingToCheck("the slip is read from the stress")
    force = step.of.own.free_energy.first(step.ended, step.others)[1][:, np.argsort(step.of.columns)]
    off = h.length(step.after.stress - force)[:, None]
    return off, 4.0 * step.slip_error[:, None], lambda i, j: f"the stress of the energy is {vector(force[i])}"


def _of_a_criterion(step: LawStep) -> None:
    if not step.level.shape[1]:
        raise NothingToCheck("a law of rates has no criterion")


@_condition("admissibility", "the stress lies in K of the new state", "g(Y; alpha) <= 0", "|dg/dY| u, and what u makes of the variables")
def _(step: LawStep, h: HistoryQuery) -> Condition:
    _of_a_criterion(step)
    over = np.where(step.bound[:, None] | np.isnan(step.level), 0.0, np.maximum(step.level, 0.0))
    share = step.level / step.size
    return over, 4.0 * step.level_allowed, lambda i, j: f"g = {step.level[i, j]:.4g}, {share[i, j]:.3g} of the terms it is made of"


@_condition("loading", "what flows is at the end of K, and flows outward", "lambda >= 0, lambda g = 0", "that of g, and of lambda")
def _(step: LawStep, h: HistoryQuery) -> Condition:
    _of_a_criterion(step)
    inside = np.where(step.multiplier > 4.0 * step.multiplier_error, np.maximum(-step.level, 0.0), 0.0)
    least, count = np.where(np.isfinite(step.multiplier_error), step.multiplier_error, 1.0), inside.shape[1]

    def say(i: int, j: int) -> str:
        if j >= count:
            return f"what slips goes against the flow of the law: lambda = {step.multiplier[i, j - count]:.4g}"
        return f"it flows with g = {step.level[i, j]:.4g} < 0, {-step.level[i, j] / step.size[i, j]:.3g} of its terms"

    back, allowed = np.maximum(-step.multiplier, 0.0), 4.0 * np.hstack([step.level_allowed, least])
    return np.hstack([inside, _but_at_tips(step, back, 4.0 * least)]), allowed, say


def _but_at_tips(step: LawStep, off: Array, allowed: Array) -> Array:
    """What is off, but where the law has many directions."""
    return np.where(step.many_ways[:, None], 0.0, off) if (off > allowed).any() else off


def _evolved(step: LawStep, which: NDArray[np.intp]) -> Condition:
    names = step.of.own.names[step.of.own.observables :]
    if not which.size:
        raise NothingToCheck("the law has no such variable")

    def say(i: int, j: int) -> str:
        v = which[j]
        change, right = step.change[i, v], step.moved[i, v]
        return f"{names[v]} changes by {change:.6g}, and by {right:.6g} in the law, {change - right:.2g} off"

    allowed = 2.0 * step.allowed[:, which]
    return _but_at_tips(step, np.abs(step.off[:, which]), allowed), allowed, say


_STEP = "alpha - alpha_n = lambda h(Y; alpha) + dt r(Y; alpha)"
_condition("flow", "the plastic strain goes in the direction of the law's flow", _STEP)(lambda step, h: _evolved(step, step.of.slips))
_condition("evolution", "each variable of the state is advanced once a step, as the law says", _STEP)(
    lambda step, h: _evolved(step, step.of.known)
)


@_condition(
    "law-dissipation", "no step gains energy where the law's does not, with what the law stores", "Y . (alpha - alpha_n) >= 0",
    source=_DISSIPATION,
)  # fmt: skip
def _(step: LawStep, h: HistoryQuery) -> Condition:
    order, force = step.of.own.order, step.of.own.stored(step.ended, step.others)[1]
    gained, by_law = (-(force * part[:, order]).sum(axis=1, keepdims=True) for part in (step.change, step.moved))
    allowed = (np.abs(force) * step.allowed[:, order]).sum(axis=1, keepdims=True)
    return np.where(by_law > allowed, 0.0, np.maximum(gained, 0.0)), allowed, lambda i, j: f"the step gains {gained[i, 0]:.4g}"
