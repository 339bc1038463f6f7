"""What one step of any rate-independent material is, whatever its law; u is :meth:`HistoryQuery.error`."""

from __future__ import annotations

import numpy as np

from duhem.testing.checks import routine_checks, run_checks, tangent_checks
from duhem.testing.checks.query import NothingToCheck
from duhem.testing.checks.registry import Finding
from duhem.testing.routines.material import MaterialState
from duhem.testing.without_law.history import FINER, HistoryQuery
from duhem.testing.without_law.registry import register

__all__: list[str] = []

_PER_MILLE = 1e-3
_DIVIDED = 3  # cases, in one of which some paths are taken in smaller steps
_SMALL = (1e-3, 1e-6, 1e-9)  # shares of a step that are taken to be small


@register(
    "answers",
    statement="the routine answers every increment with finite stresses, state and energies",
    formula="sigma in R^d",
    source="a nan that is passed on silently ruins what comes after",
    tolerance="none",
)
def answers(h: HistoryQuery) -> Finding:
    bad = np.zeros(len(h.case), dtype=np.bool_)
    for state in (*h.course, h.beyond):
        for part in (state.stress, state.variables, state.stored, state.dissipated):
            if part is not None:
                bad |= ~np.isfinite(part.reshape(len(bad), -1)).all(axis=1)
    return Finding(bad.astype(np.float64), np.zeros(len(bad)))


@register(
    "repeatability",
    statement="the same increment from the same state has the same answer, whatever was asked before it and beside it, and alone",
    formula="sigma(state, du) = sigma(state, du)",
    source="a state kept between calls, or shared between points, makes an answer depend on the order of the questions",
    tolerance="2 u",
)
def repeatability(h: HistoryQuery) -> Finding:
    case = h.case
    here, back = h.beyond, np.arange(len(case))[::-1]
    load = None if case.pressure is None else case.pressure[back]
    again = h.counted(h.start.rows(back), case.trial[back], load, rows=back).rows(back)
    return run_checks.compared(h, here.stress, again.stress, 2.0 * h.error(h.start.stress, case.trial, here.stress))


@register(
    "elasticity",
    statement="where a first small step can be undone, and the opposite one has the opposite answer, it is that of the stiffness given",
    formula="sigma(du) = k du, where -du/2 after du leads back to half the stress, -du to none, and sigma(-du) = -sigma(du)",
    source="the stiffness that all else is measured with; shear strains of the tensor and of engineers differ by a factor of two",
    tolerance="|sigma - k du| <= |k du|/1000 at the smallest of three steps: a material may be elastic without being linear",
    again=True,
)
def elasticity(h: HistoryQuery) -> Finding:
    trial = np.concatenate([share * h.case.trial for share in _SMALL])
    both = h.counted(h.virgin, np.concatenate([trial, -trial]), h.case.pressure)
    there, opposite = both.rows(slice(len(trial))), both.rows(slice(len(trial), None))
    size, met = h.length(trial), h.length(there.stress)
    near = _PER_MILLE * np.minimum(size, met)
    undone = (near > 0.0) & (h.length(there.stress + opposite.stress) <= near)  # not so of an interface that opens or closes
    parts = (0.5, 1.0)  # at the tip of a cone what has slipped comes back to no stress too, but not by way of the half
    back = h.counted(there, np.concatenate([there.stress - part * trial for part in parts]), h.case.pressure)
    for part, stress in zip(parts, np.split(back.stress, len(parts)), strict=True):
        undone &= h.length(stress - (1.0 - part) * there.stress) <= near
    off = h.length(there.stress - trial) / np.where(size > 0.0, size, 1.0)
    worst = np.where(undone, off, 0.0).reshape(len(_SMALL), -1).min(axis=0)
    return Finding(worst, np.full(len(worst), _PER_MILLE))


@register(
    "rest",
    statement="without an increment nothing happens, and the next increment is answered as if nothing had",
    formula="sigma(state, 0) = sigma; sigma(state after that, du) = sigma(state, du)",
    source="rate independence: no increment, no change (Moreau 1977, J. Differ. Equ. 26, 347-374)",
    tolerance="2 u at rest; 4 u after the next increment",
    again=True,
)
def rest(h: HistoryQuery) -> Finding:
    case = h.case
    here = h.beyond
    still = h.counted(here, here.stress.copy(), case.pressure)
    still = h.counted(still, still.stress.copy(), case.pressure)
    moved, allowed = h.length(still.stress - here.stress), 2.0 * h.error(here.stress, case.trial)
    trial = here.stress + (case.other - case.trial)
    ends = h.counted(MaterialState.joined([here, still]), np.concatenate([trial, trial + (still.stress - here.stress)]), case.pressure)
    one, two = np.split(ends.stress, 2)
    after, may = h.length(two - one), 4.0 * h.error(here.stress, case.trial, trial, one)
    at_rest = ~(moved <= allowed)
    return Finding(np.where(at_rest, moved, after), np.where(at_rest, allowed, may))


@register(
    "rate",
    statement="rate independence: the same path in a thousandth and in a thousand times the time ends at the same stress",
    formula="sigma(u(t)) = sigma(u(c t)) for c > 0",
    source="Moreau (1977), J. Differ. Equ. 26, 347-374",
    tolerance="2 u, the sum over the steps",
    again=True,
)
def rate(h: HistoryQuery) -> Finding:
    if not h.remembers:
        raise NothingToCheck("the routine is not told of time")
    worst, allowed = np.zeros(len(h.case)), np.zeros(len(h.case))
    for here, before in zip(h.course[1:], h.course[:-1], strict=True):
        allowed += 2.0 * h.error(here.stress, before.stress)
    for duration in (1e-3, 1e3):
        worst = np.maximum(worst, h.length(h.along(1, duration)[-1].stress - h.start.stress))
    return Finding(worst, allowed + 2.0 * h.error(*(h.case.path[:, i] for i in range(h.case.path.shape[1]))))


@register(
    "subdivision",
    statement="a path in twice as many steps ends, in the limit, at the same stress",
    formula="sigma_2n - sigma_n -> 0 as each leg is taken in n steps",
    source="Moreau (1977), J. Differ. Equ. 26, 347-374: the catching-up algorithm converges",
    tolerance=f"the elastic length of the path over {FINER}, between n = {FINER // 2} and {FINER}, or else over {4 * FINER}, between "
    f"n = {4 * FINER} and {8 * FINER}",
    again=True,
)
def subdivision(h: HistoryQuery) -> Finding:
    if not h.by_turns(_DIVIDED):
        raise NothingToCheck(f"asked in one of {_DIVIDED} cases")
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


@register(
    "slope",
    statement="the consistent tangent is the slope of the routine, where differences resolve it (no corner of the answer near)",
    formula="C du = d sigma",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="what the differences at h and h/2, either way, disagree by (twice), + 16 u/h, with h the geometric mean of u and "
    "|sigma_tr| + |sigma|; what they are off by there, where smaller steps one way come ten times closer, or where at all of them "
    "the two ways disagree by a quarter of it (no slope)",
    again=True,
)
def slope(h: HistoryQuery) -> Finding:
    return tangent_checks.slope(h)


@register(
    "slip",
    statement="the slip returned is what the stress lacks",
    formula="k slip = sigma_tr - sigma",
    source="Antoni et al. (2007), Eqs. 25, 31",
    tolerance="2 u",
)
def slip(h: HistoryQuery) -> Finding:
    return routine_checks.slip(h)
