"""What a material or routine satisfies whatever its law, and a material that is held to one; u is :meth:`HistoryQuery.error`.

The checks stand in the order in which they explain each other: one that fails may be why later ones do.  Those of energies look at the
steps of the path followed closely, and at the one beyond it.  Some are asked for by name, as only associated laws, and some only
those without hardening, satisfy them: a good routine of another law may fail these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks import routine_checks
from duhem.testing.checks.history import FINER, HistoryQuery
from duhem.testing.checks.law_in_state import LawStep
from duhem.testing.checks.query import NothingToCheck
from duhem.testing.checks.registry import Finding, enter, register, registered, worst
from duhem.testing.drawn.case import vector
from duhem.testing.routines import MaterialState

__all__: list[str] = []

_PER_MILLE = 1e-3
_DIVIDED = 3  # cases, in one of which some paths are taken in smaller steps
_SMALL = (1e-3, 1e-6, 1e-9)  # shares of a step that are taken to be small


_of_any = partial(register, of_a_law=False)


def _as_of_a_law(name: str, /, **other: object) -> None:
    """Enter the check of that name of a routine with a law, as one that needs none, with ``other`` fields in the place of its own."""
    enter(replace(registered()[name], of_a_law=False, **other))  # type: ignore[arg-type]


def _answers(h: HistoryQuery) -> Finding:
    bad = np.zeros(len(h.case), dtype=np.bool_)
    for state in (*h.course, h.beyond):
        for part in (state.stress, state.variables, state.stored, state.dissipated):
            if part is not None:
                bad |= ~np.isfinite(part.reshape(len(bad), -1)).all(axis=1)
    return Finding(bad.astype(np.float64), np.zeros(len(bad)))


_as_of_a_law("answers", statement="the routine answers every increment with finite stresses, state and energies", measure=_answers)


@_of_any(
    statement="the same increment from the same state has the same answer, alone, together with others, and after others",
    formula="sigma(state, du) = sigma(state, du)",
    source="state that is kept between calls or shared between points makes an answer depend on the order of the calls",
    tolerance="2 u",
)
def repeatability(h: HistoryQuery) -> Finding:
    case = h.case
    here, back = h.beyond, np.arange(len(case))[::-1]
    load = None if case.pressure is None else case.pressure[back]
    again = h.counted(h.start.rows(back), case.trial[back], load, rows=back).rows(back)
    return routine_checks.compared(h, here.stress, again.stress, 2.0 * h.error(h.start.stress, case.trial, here.stress))


_as_of_a_law(
    "inputs",
    formula="the routine does not change the state before the step, the increment, its other inputs and its earlier answers",
    source="the caller uses the state before the step again, for example for a shorter step, and keeps the states of other steps",
)


@_of_any(
    statement="where a first small step can be undone, and the opposite one has the opposite answer, it is that of the stiffness given",
    formula="sigma(du) = k du, where -du/2 after du leads back to half the stress, -du to none, and sigma(-du) = -sigma(du)",
    source="the stiffness that all else is measured with; shear strains of the tensor and of engineers differ by a factor of two",
    tolerance="accuracy, of what steps from 1e-12 on show; where these show no linear range, |sigma - k du| <= |k du|/1000 at the smallest "
    "of three steps",
    again=True,
)
def elasticity(h: HistoryQuery) -> Finding:
    if (k := h.material.measured) is not None:
        return _against_the_measured(h, k)
    trial = np.concatenate([share * h.case.trial for share in _SMALL])
    both = h.counted(h.material.virgin(len(h.case)), np.concatenate([trial, -trial]), h.case.pressure)
    there, opposite = both.rows(slice(len(trial))), both.rows(slice(len(trial), None))
    size, met = h.length(trial), h.length(there.stress)
    near = _PER_MILLE * np.minimum(size, met)
    undone = (near > 0.0) & (h.length(there.stress + opposite.stress) <= near)  # not so of an interface that opens or closes
    parts = (0.5, 1.0)  # at the tip of a cone what has slipped comes back to no stress too, but not by way of the half
    back = h.counted(there, np.concatenate([there.stress - part * trial for part in parts]), h.case.pressure)
    for part, stress in zip(parts, np.split(back.stress, len(parts)), strict=True):
        undone &= h.length(stress - (1.0 - part) * there.stress) <= near
    off = h.length(there.stress - trial) / np.where(size > 0.0, size, 1.0)
    least = np.where(undone, off, 0.0).reshape(len(_SMALL), -1).min(axis=0)
    return Finding(least, np.full(len(least), _PER_MILLE))


def _against_the_measured(h: HistoryQuery, k: Array) -> Finding:
    """The stiffness given against that of the routine itself, in the metric of the latter."""
    given, n = h.given_stiffness, len(h.case)
    if given is None:
        raise NothingToCheck("no stiffness is given to compare with")
    inverse = np.linalg.inv(np.linalg.cholesky(k))
    off = float(np.abs(inverse @ (given - k) @ inverse.T).max())
    i, j = np.unravel_index(np.argmax(np.abs(given - k) / np.sqrt(np.outer(np.diag(k), np.diag(k)))), k.shape)
    halved = i == j and round(k[i, j] / given[i, j], 6) in (0.5, 2.0)
    shear = "; a shear strain of the tensor taken for one of engineers?" if halved else ""
    literal = "; a single-precision literal?" if 1e-9 < off < 1e-6 else shear
    said = f"the stiffness measured from the routine is off by {off:.2g} of the one given: in components ({i + 1}, {j + 1}) it is "
    said += f"{k[i, j]:.10g}, not {given[i, j]:.10g}{literal}"
    allowed = h.accuracy + 1e3 * np.finfo(np.float64).eps
    return Finding(np.full(n, off), np.full(n, allowed), np.full(n, said, dtype=object))


_as_of_a_law("vacuity", formula="sigma = sigma_tr for some, and not for others")


@_of_any(
    statement="rate independence: the same path in a thousandth and in a thousand times the time ends at the same stress",
    formula="sigma(u(t)) = sigma(u(c t)) for c > 0",
    source="Moreau (1977), J. Differ. Equ. 26, 347-374",
    tolerance="2 u, the sum over the steps",
    again=True,
)
def rate(h: HistoryQuery) -> Finding:
    if not h.remembers or h.timed:
        raise NothingToCheck("the law depends on the rate" if h.timed else "the routine has no argument for time")
    ends = [h.length(h.along(1, duration)[-1].stress - h.start.stress) for duration in (1e-3, 1e3)]
    allowed = h.error(*np.moveaxis(h.case.path, 1, 0)) + sum(h.error(before.stress, after.stress) for before, after in pairwise(h.course))
    return Finding(np.max(ends, axis=0), 2.0 * allowed)


def _energies(before: MaterialState, after: MaterialState) -> list[Array]:
    """Stored and dissipated, before the steps, which may all be the first ones, and after."""
    found = [each for state in (before, after) for each in (state.stored, state.dissipated) if each is not None]
    if len(found) < 4 or not any(each.any() for each in found):
        raise NothingToCheck("the routine returns no energies, or none that is not 0")
    return found


def _worst_step(h: HistoryQuery, measured: Array, allowed: Array) -> Finding:
    """Return, of several steps of all rows, for each row the step that exceeds most."""
    return worst(zip(measured.reshape(-1, len(h.case)), allowed.reshape(-1, len(h.case)), strict=True))


@_of_any(
    statement="no step has negative dissipation",
    formula="d D >= 0",
    source="Antoni et al. (2007), Eqs. 22, 36: Clausius-Duhem",
    tolerance="u (|sigma| + |k du|)",
)
def dissipation(h: HistoryQuery) -> Finding:
    before, after = h.steps
    _, lost_0, _, lost = _energies(before, after)
    step = (after.strain - before.strain) @ h.case.stiffness
    found = _worst_step(h, lost_0 - lost, h.error(before.stress, after.stress) * (h.length(after.stress) + h.length(step)))
    if h.case.pressure is None and (found.measured > found.allowed).any():
        alone = h.counted(replace(before, dissipated=np.zeros_like(lost_0)), before.stress + step, None).dissipated
        if ((alone == lost) & (lost != lost_0) & (lost_0 != 0.0)).any():
            said = "the routine returns what the step dissipates, and does not add it to what it is given (SPD = SPD + ...)"
            found = replace(found, said=np.full(len(h.case), said, dtype=object))
    return found


@_of_any(
    statement="a zero increment changes nothing, also not the answer to the next increment",
    formula="sigma(state, 0) = sigma; sigma(state after that, du) = sigma(state, du)",
    source="rate independence: no increment, no change (Moreau 1977, J. Differ. Equ. 26, 347-374)",
    tolerance="2 u at rest; 4 u after the next increment",
    again=True,
)
def rest(h: HistoryQuery) -> Finding:
    if h.timed:
        raise NothingToCheck("the law depends on the rate")
    case = h.case
    here = h.beyond
    still = h.counted(here, here.stress.copy(), case.pressure)
    still = h.counted(still, still.stress.copy(), case.pressure)
    moved, allowed = h.length(still.stress - here.stress), 2.0 * h.error(here.stress, case.trial)
    trial = here.stress + (case.other - case.trial)
    ends = h.counted(MaterialState.joined([here, still]), np.concatenate([trial, trial + (still.stress - here.stress)]), case.pressure)
    one, two = np.split(ends.stress, 2)
    after, may = h.length(two - one), 4.0 * h.error(here.stress, case.trial, trial, one)
    return worst([(moved, allowed), (after, may)])


_as_of_a_law("slip")


@_of_any(
    statement="in an elastic step the stress is the slope of the stored energy",
    formula="sigma = d psi/d u",
    source="Antoni et al. (2007), Eqs. 22, 23",
    tolerance="(u + 1e-6 |sigma|) h + 32 eps psi, by central differences over a step h = (|sigma| + |sigma_tr|)/100 either way, where both "
    "are answered by k to a millionth: there psi is quadratic, and the difference exact",
    again=True,
)
def stored_energy(h: HistoryQuery) -> Finding:
    if not h.remembers:
        raise NothingToCheck("the energy of a routine whose only state is its stress is sigma . k^-1 sigma/2 by definition")
    base = h.start
    for share in (1.0, 0.5):  # back from where the path ends, and from there
        base = h.counted(base, base.stress * (1.0 - 0.1 * share), h.case.pressure)
    if base.stored is None or not base.stored.any():
        raise NothingToCheck("the routine returns no energy, or none that is not 0")
    size, d, n = 1e-2 * (h.length(base.stress) + h.length(h.case.trial)), len(h.axes), len(h.case)
    ways = size[:, None] * h.axes[:, None, :]
    around, stress = np.stack([ways, -ways], axis=1).reshape(2 * d * n, d), np.tile(base.stress, (2 * d, 1))
    ends = h.counted(base, stress + around, h.case.pressure)
    assert ends.stored is not None
    near = (h.length(ends.stress - stress - around) <= np.tile(1e-6 * size, 2 * d)).reshape(d, 2, n).all(axis=1)
    elastic = near & (size > 0.0) & np.isfinite(base.stress).all(axis=1)
    up, down = np.swapaxes(ends.stored.reshape(d, 2, n), 0, 1)
    off = np.abs((up - down) / 2.0 - h.inner(stress[: d * n], ways.reshape(d * n, d)).reshape(d, n))
    rounding = 32.0 * np.finfo(np.float64).eps * (np.abs(up) + np.abs(down))
    allowed = (h.error(base.stress, h.case.trial) + 1e-6 * h.length(base.stress)) * size + rounding
    if not elastic.any():
        raise NothingToCheck("no step was elastic")
    return worst(zip(np.where(elastic, off, -1.0), np.where(elastic & (allowed > 0.0), allowed, 1.0), strict=True))


@_of_any(
    statement="work = stored + dissipated energy, up to the error of a finite step",
    formula="(sigma_0 + sigma)/2 . du = d psi + d D",
    source="Antoni et al. (2007), Eqs. 22-31, discrete",
    tolerance="|d sigma| |k du - d sigma|, to which any mean of the stresses of the step brings the balance, + "
    "2 u (|sigma_0| + |sigma| + |k du|) + 32 eps (psi + D)",
)
def energy(h: HistoryQuery) -> Finding:
    if not h.remembers and h.start.slip is None and h.here.slip is None:
        raise NothingToCheck("the routine returns no slip: k^-1 (sigma_tr - sigma) satisfies this by definition")
    before, after = h.steps
    psi_0, lost_0, psi, lost = _energies(before, after)
    if not psi.any():
        raise NothingToCheck("the routine returns no stored energy, or none that is not 0")
    asked = (after.strain - before.strain) @ h.case.stiffness
    work = h.inner(0.5 * (before.stress + after.stress), asked)
    left = np.abs(work - (psi - psi_0) - (lost - lost_0))
    open_ = h.length(after.stress - before.stress) * h.length(h.slip_of(before, after))
    size = h.length(before.stress) + h.length(after.stress) + h.length(asked)
    rounding = 32.0 * np.finfo(np.float64).eps * (np.abs(psi) + np.abs(psi_0) + np.abs(lost) + np.abs(lost_0))
    return _worst_step(h, left, open_ + 2.0 * h.error(before.stress, after.stress, asked) * size + rounding)


_as_of_a_law(
    "slope",
    statement="the consistent tangent agrees with finite differences of the routine where these are accurate (not near a corner)",
    tolerance="what the differences at h and h/2, either way, disagree by (twice), + 16 u/h, with h the geometric mean of u and "
    "|sigma_tr| + |sigma|; what they are off by there, where smaller steps one way come ten times closer, or where at all of them "
    "the two ways disagree by a quarter of it (no slope)",
)


@_of_any(
    statement="a path in twice as many steps ends, in the limit, at the same stress",
    formula="sigma_2n - sigma_n -> 0 as each leg is taken in n steps",
    source="Moreau (1977), J. Differ. Equ. 26, 347-374: the catching-up algorithm converges",
    tolerance=f"the elastic length of the path over {FINER}, between n = {FINER // 2} and {FINER}, or else over {4 * FINER}, between "
    f"n = {4 * FINER} and {8 * FINER}",
    again=True,
)
def subdivision(h: HistoryQuery) -> Finding:
    if not h.by_turns(_DIVIDED):
        raise NothingToCheck(f"tested in one of {_DIVIDED} cases")
    legs = np.diff(h.case.path, axis=1)
    whole = np.sum([h.length(legs[:, i]) for i in range(legs.shape[1])], axis=0)
    ends = [h.along(FINER // 2)[-1], h.fine[-1]]
    apart, allowed = h.length(ends[1].stress - ends[0].stress), whole / FINER + h.error(*(e.stress for e in ends), h.case.path[:, -1])
    if (~(apart <= allowed) & h.sound).any():
        ends = [h.along(4 * FINER)[-1], h.along(8 * FINER)[-1]]
        closer, may = h.length(ends[1].stress - ends[0].stress), whole / (4 * FINER) + h.error(*(e.stress for e in ends))
        settled = closer <= may
        apart, allowed = np.where(settled, closer, apart), np.where(settled, may, allowed)
    return Finding(apart, allowed)


# -- what only associated laws satisfy -----------------------------------------------------------------------------------


@_of_any(
    statement="the consistent tangent of an associated law, with or without hardening, is symmetric",
    formula="C = C^T",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="d^2 (accuracy + 8 eps), in the metric of k",
    demanded=False,
)
def associated_symmetry(h: HistoryQuery) -> Finding:
    if h.here.tangent is None:
        raise NothingToCheck("the routine returns no tangent")
    return Finding(*routine_checks.asymmetry(h, h.whitened(h.here.tangent)))


for _name, _said in (
    ("non-expansiveness", "the distance between two stresses does not increase"),
    ("potential", "the step derives from a potential"),
    ("ray", "a longer or shorter slip in the same direction ends at the same stress"),
):
    _as_of_a_law(_name, name=f"associated-{_name}", statement=f"of an associated law without hardening: {_said}", demanded=False)


@_of_any(
    statement="without kinematic hardening, the slip does positive work",
    formula="sigma . (du - k^-1 d sigma) >= 0",
    source="Drucker (1951), Proc. First US Natl. Congr. Appl. Mech., 487-491",
    tolerance="2 u (|sigma| + |k du|)",
    demanded=False,
)
def isotropic_plastic_work(h: HistoryQuery) -> Finding:
    before, after = h.steps
    asked = (after.strain - before.strain) @ h.case.stiffness
    lost = -h.inner(after.stress, h.slip_of(before, after))
    return _worst_step(h, lost, 2.0 * h.error(before.stress, after.stress, asked) * (h.length(after.stress) + h.length(asked)))


# -- what a material satisfies whose law is known, with the state that it keeps ------------------------------------------
# The implicit step of that law, condition by condition: these checks look at the steps of a path and at the one beyond it, as they were
# taken (:class:`duhem.testing.checks.law_in_state.LawStep`); none asks the routine anew.  Each tolerance is what the condition makes of u.

_EULER = "Simo and Hughes (1998), Computational Inelasticity, chapters 1 and 3: backward Euler"
_DISSIPATION = "Antoni et al. (2007), Eqs. 22-36: state laws and Clausius-Duhem"

# conditions (M, k) of M steps, by how much they may be violated, and what is said of a step and a condition
Condition: TypeAlias = tuple[Array, Array, Callable[[int, int], str]]
_Enter: TypeAlias = Callable[[Callable[[LawStep, HistoryQuery], Condition]], None]


def _condition(name: str, statement: str, formula: str, tolerance: str = "what u makes of it", source: str = _EULER) -> _Enter:
    """Return a decorator that enters a function of steps and their metric as a check."""

    def add(measure: Callable[[LawStep, HistoryQuery], Condition]) -> None:
        said = {"name": name, "statement": statement, "formula": formula, "tolerance": tolerance, "source": source}
        register(of_a_law=False, of_states=True, **said)(lambda h: _worst_condition(h, *measure(h.law_step, h)))

    return add


def _worst_condition(h: HistoryQuery, off: Array, allowed: Array, say: Callable[[int, int], str]) -> Finding:
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
