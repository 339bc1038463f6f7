"""One increment of unilateral contact with friction, pressure included, held against the bipotential.

With p = -sigma_n >= 0, the opening v >= 0, p v = 0 and the slip d normal to K(sigma_n) = p K(-1), the stress (sigma_t, sigma_n) is
trial - k (d, v).  Without coupling in k, p = max(0, -trial_n).  With it p is a root of f(p) = p + trial_n - k_nt . d(p), where d(p) is the
slip under the pressure p: the contact opens if f(0) = trial_n - k_nt . k_tt^-1 trial_t >= 0, and else f(0) < 0 <= f(P) at
P = |trial_n| + |k_nt| |trial_t|, lengths in k_tt^-1.  |dd/dp| <= M, the largest |sigma| in K(-1), so that |k_nt| M < 1 leaves one root.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.api.increments import Prepared, prepare
from duhem.errors import InputError
from duhem.expression.dimensions import degree
from duhem.expression.numpy_ import evaluate
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Metric, posed, stiffness_matrix, trial_rows
from duhem.projection.method import Method
from duhem.projection.result import ACCURACY, Array, Pointwise, Status

__all__ = ["Contact", "contact"]

Polar = Callable[[Array], Array]
"""Phi_1 of slips (N, d), finite for each."""

_FAR = 1e9  # times a stress, which then lies in K(-1) only along a direction in which that has no end
_HALVINGS = 1100  # of an interval of doubles, down to the least of them


@dataclass(frozen=True, eq=False)
class Contact(Pointwise):
    """N increments of contact with friction.

    ``stress`` (N, d + 1) has the forces and sigma_n <= 0; ``slip`` (N, d) and ``opening`` (N,) >= 0 are the inelastic displacements.
    ``gap`` (N,) is b - (sigma . slip - p opening), which is 0 exactly on the law, over the size of its terms; nan if Phi_1 has no closed
    form.  ``balance`` (N,) is by how much trial - k (slip, opening) misses the stress, over the length of the trial.  ``status`` (N,) is a
    :class:`~duhem.projection.result.Status`: ``INACCURATE`` where gap or balance is too large.  ``unique`` (N,) says that the coupling
    in k is shown to be so weak that there is no other answer.
    """

    stress: Array
    slip: Array
    opening: Array
    gap: Array
    balance: Array
    status: NDArray[np.int8]
    unique: NDArray[np.bool_]


def contact(
    law: Criterion | str | Path,
    trial: ArrayLike,
    stiffness: ArrayLike = 1.0,
    parameters: Mapping[str, Any] | None = None,
    method: str | Method[Any] = "auto",
) -> Contact:
    """Compute increments of friction and unilateral contact together: (sigma, sigma_n) = trial - k (slip, opening).

    ``trial`` (d + 1,) or (N, d + 1) is the stress before slip and opening, the forces and then sigma_n (> 0 where the step would pull):
    after an increment du of the displacements, normal last and positive in opening, it is stress + k du.  ``stiffness``, one number,
    (d + 1,) or (d + 1, d + 1), is in the same order.  ``method`` finds the slip under a pressure, as in :func:`duhem.project`.  Raises
    InputError for a law without a pressure, or of which K is not seen to be proportional to it, and as :func:`duhem.project` does.
    """
    criterion = load_formula(law)
    if criterion.pressure is None:
        raise InputError(f"{criterion.name} has no pressure", where="law", remedy="use duhem.project")
    d, k = len(criterion.forces), stiffness_matrix(stiffness, criterion.coordinates)[0]
    ahead = prepare(criterion, k[:d, :d], parameters, method)
    if degree(ahead.projector.setting.g, [criterion.symbols()[name] for name in criterion.coordinates]) is None:
        what = f"K of {criterion.name} is not seen to be proportional to {criterion.pressure}"
        raise InputError(what, where="law", remedy="use duhem.project under a pressure that you know")
    rows = trial_rows(trial, criterion.coordinates)
    pressure, opening = _normal_part(ahead, rows, k)
    polar = _polar(ahead.projector.setting.law, tuple(ahead.projector.setting.parameters.items()))
    forces, slip, status = _tangential_part(ahead, rows[:, :d] - opening[:, None] * k[:d, d], pressure, k[:d, :d], polar)
    stress = np.column_stack([forces, -pressure]) + 0.0  # no -0
    gap, unique = _against_the_bipotential(polar, k, forces, pressure, slip, opening)
    missing = rows - np.column_stack([slip, opening]) @ k - stress
    balance = _share(np.linalg.norm(missing, axis=1), np.linalg.norm(rows, axis=1))
    bad = (balance > ACCURACY) | (np.abs(gap) > ACCURACY)
    status = np.where(bad & (status != Status.FAILED), Status.INACCURATE, status).astype(np.int8)
    return Contact(stress, slip, opening, gap, balance, status, np.full(len(rows), unique))


def _tangential_part(
    ahead: Prepared, trial: Array, pressure: Array, stiffness: Array, polar: Polar | None
) -> tuple[Array, Array, NDArray[np.int8]]:
    """Stress and slip (N, d) under the pressures, and how they were found.

    Without pressure the stress lies in 0 K(-1), the directions in which K(-1) has no end.  Where Phi_1 is finite for each slip that is 0
    alone, and all of the trial becomes slip.  Elsewhere the formula is asked at sigma_n = 0 too: as that may be another set, what it
    gives is held against K(-1).
    """
    setting, normal, free = ahead.projector.setting, 0.0 - pressure, pressure == 0.0  # no -0
    posed(setting, trial, normal)  # which refuses a pressure outside the law's range
    stress: Array = np.zeros_like(trial)
    slip: Array = np.linalg.solve(stiffness, trial.T).T.astype(np.float64)
    status = np.where(slip.any(axis=1), Status.SLIP, Status.STICK).astype(np.int8)
    asked = np.flatnonzero(~free) if polar is not None else np.arange(len(free))
    found = ahead.project(trial[asked], normal[asked])
    stress[asked], slip[asked], status[asked] = found.stress, found.slip, found.status
    if polar is None:
        table = setting.law.symbols()
        far = {table[name]: _FAR * column for name, column in zip(setting.law.forces, stress.T, strict=True)}
        inside = np.asarray(evaluate(setting.g, far | {table[str(setting.law.pressure)]: -1.0})) <= 0.0
        status[free & ~inside] = Status.FAILED
    return stress, slip, status


def _normal_part(ahead: Prepared, rows: Array, k: Array) -> tuple[Array, Array]:
    """Pressures p >= 0 and openings, (N,) each."""
    d = len(k) - 1
    across, trial, normal = k[d, :d], rows[:, :d], rows[:, d]
    back = np.linalg.solve(k[:d, :d], across)
    start = normal - trial @ back
    opening = np.maximum(start, 0.0) / (k[d, d] - across @ back)
    pressure = np.where(start < 0.0, -normal, 0.0)
    if across.any() and (closed := np.flatnonzero(start < 0.0)).size:
        metric = Metric.of(np.ascontiguousarray(k[:d, :d])).of_stress
        low = np.zeros(closed.size)
        high = np.abs(normal[closed]) + np.linalg.norm(trial[closed] @ metric, axis=1) * np.linalg.norm(across @ metric)
        for _ in range(_HALVINGS):
            middle = low + (high - low) / 2.0
            if ((middle <= low) | (middle >= high)).all():
                break
            above = middle + normal[closed] - ahead.project(trial[closed], -middle).slip @ across >= 0.0
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        pressure[closed] = high
    return pressure, opening


def _against_the_bipotential(
    polar: Polar | None, k: Array, stress: Array, pressure: Array, slip: Array, opening: Array
) -> tuple[Array, bool]:
    """b - (sigma . slip - p opening) over the size of its terms (N,), and whether the answer is shown to be the only one."""
    d = len(k) - 1
    across = k[d, :d]
    if polar is None:
        return np.full(len(pressure), np.nan), not across.any()
    metric = Metric.of(np.ascontiguousarray(k[:d, :d])).of_stress
    longest = np.linalg.norm(np.maximum(polar(metric.T), polar(-metric.T)))
    terms = pressure * polar(slip), np.sum(stress * slip, axis=1), pressure * opening
    return _share(terms[0] - terms[1] + terms[2], np.abs(terms).sum(axis=0)), bool(np.linalg.norm(across @ metric) * longest < 1.0)


@lru_cache(maxsize=64)
def _polar(law: Criterion, parameters: tuple[tuple[str, float], ...]) -> Polar | None:
    """Phi_1; None where duhem derives no such closed form."""
    from duhem.derivation.support_function import support_function

    found = support_function(law, dict(parameters))
    if found is None or found.domain or law.pressure is None:
        return None
    potential, rates = found.potential.subs(law.symbols()[law.pressure], -1), found.rates
    return lambda slips: np.broadcast_to(evaluate(potential, dict(zip(rates, slips.T, strict=True))), len(slips))


def _share(part: Array, whole: Array) -> Array:
    return np.divide(part, whole, out=np.zeros_like(part), where=whole > 0.0)
