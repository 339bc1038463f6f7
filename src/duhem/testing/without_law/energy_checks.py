"""What the energies of any material satisfy, whatever its law; u is :meth:`HistoryQuery.error`.

In steps of the path followed closely, and the one beyond it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NothingToCheck
from duhem.testing.checks.registry import Finding
from duhem.testing.routines.material import MaterialState
from duhem.testing.without_law.history import HistoryQuery
from duhem.testing.without_law.registry import register

__all__ = ["slipped"]


@register(
    "stored-energy",
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
    if base.stored is None:
        raise NothingToCheck("the routine returns no energy")
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
    allowed = np.where(allowed > 0.0, allowed, 1.0)
    worst, bound = np.full(n, -1.0), np.ones(n)
    for i in range(d):
        more = elastic[i] & ~(off[i] / allowed[i] <= worst / bound)
        worst, bound = np.where(more, off[i], worst), np.where(more, allowed[i], bound)
    if not elastic.any():
        raise NothingToCheck("no step was elastic")
    return Finding(worst, bound)


def _energies(state: MaterialState) -> tuple[Array, Array]:
    if state.stored is None or state.dissipated is None:
        raise NothingToCheck("the routine returns no energies")
    return state.stored, state.dissipated


def _worst(h: HistoryQuery, measured: Array, allowed: Array) -> Finding:
    """Of several steps of all rows, for each row the one that exceeds most."""
    many, may = (x.reshape(-1, len(h.case)) for x in (measured, allowed))
    at = np.argmax(np.nan_to_num(many - may, nan=np.inf), axis=0), np.arange(many.shape[1])
    return Finding(many[at], may[at])


@register(
    "dissipation",
    statement="no step gains what it dissipates",
    formula="d D >= 0",
    source="Antoni et al. (2007), Eqs. 22, 36: Clausius-Duhem",
    tolerance="u (|sigma| + |k du|)",
)
def dissipation(h: HistoryQuery) -> Finding:
    before, after = h.steps
    gained = _energies(after)[1] - _energies(before)[1]
    step = h.length((after.strain - before.strain) @ h.case.stiffness)
    return _worst(h, -gained, h.error(before.stress, after.stress) * (h.length(after.stress) + step))


@register(
    "energy",
    statement="work = stored + dissipated, but for what a step of finite length leaves open",
    formula="(sigma_0 + sigma)/2 . du = d psi + d D",
    source="Antoni et al. (2007), Eqs. 22-31, discrete",
    tolerance="|d sigma| |k du - d sigma|, to which any mean of the stresses of the step brings the balance, + "
    "2 u (|sigma_0| + |sigma| + |k du|) + 32 eps (psi + D)",
)
def energy(h: HistoryQuery) -> Finding:
    if not h.remembers and h.start.slip is None and h.here.slip is None:
        raise NothingToCheck("the routine returns no slip: k^-1 (sigma_tr - sigma) satisfies this by definition")
    before, after = h.steps
    (psi, lost), (psi_0, lost_0) = _energies(after), _energies(before)
    asked = (after.strain - before.strain) @ h.case.stiffness
    work = h.inner(0.5 * (before.stress + after.stress), asked)
    left = np.abs(work - (psi - psi_0) - (lost - lost_0))
    open_ = h.length(after.stress - before.stress) * h.length(h.slip_of(before, after))
    size = h.length(before.stress) + h.length(after.stress) + h.length(asked)
    rounding = 32.0 * np.finfo(np.float64).eps * (np.abs(psi) + np.abs(psi_0) + np.abs(lost) + np.abs(lost_0))
    return _worst(h, left, open_ + 2.0 * h.error(before.stress, after.stress, asked) * size + rounding)


def slipped(h: HistoryQuery) -> NDArray[np.bool_]:
    """Which first increments from the start were not answered elastically."""
    found = h.here
    return np.asarray(h.length(found.trial - found.stress) > 4.0 * h.unit(found) + 1e-9 * h.length(found.trial))
