"""Points at which a form that is nowhere negative is 0, in floats: each square in a sum of squares for it vanishes there.

They are sought as zeros of the gradient from many starts (Levenberg 1944, Marquardt 1963).  Nothing is certain of what is found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

__all__ = ["on_spheres", "touching_points", "values_at"]

_TRIED, _STEPS, _ENOUGH = 40, 80, 1e-12  # random points for each start; how often a start is improved; a gradient taken for 0
_MOST = 40_000_000  # entries of second derivatives, all starts together


def touching_points(form: Mapping[tuple[int, ...], Fraction], spheres: Sequence[Sequence[int]], starts: int, near: float = _ENOUGH) -> Any:
    """Zeros of the form as rows, the variables of each of ``spheres``, in which it is homogeneous, having unit length.

    With a greater ``near`` also points at which the gradient is as small, compared with the form's numbers.
    """
    import numpy as np

    powers, factors = np.array(list(form)), np.array([float(c) for c in form.values()])
    n = powers.shape[1]
    if starts * n * n * len(factors) > _MOST:
        return np.empty((0, n))
    x = on_spheres(n, spheres, _TRIED * starts)
    x = x[np.argsort(_terms(x, powers, factors).sum(axis=1), kind="stable")[:starts]]
    damping = np.full(len(x), 1e-2)
    gap, slopes = _system(x, powers, factors, spheres)
    for _ in range(_STEPS):
        size = (gap**2).sum(axis=1)
        if (size < _ENOUGH**2).all():
            break
        left, sizes, axes = np.linalg.svd(slopes, full_matrices=False)
        parts = np.einsum("pgk,pg->pk", left, gap) * sizes / (sizes**2 + (damping * sizes[:, 0] ** 2)[:, None] + 1e-300)
        tried = x - np.einsum("pkv,pk->pv", axes, parts)
        new_gap, new_slopes = _system(tried, powers, factors, spheres)
        better = (new_gap**2).sum(axis=1) < size
        x, gap, slopes = (
            np.where(better.reshape(-1, *[1] * (a.ndim - 1)), b, a) for a, b in ((x, tried), (gap, new_gap), (slopes, new_slopes))
        )
        damping = np.clip(np.where(better, damping / 10, damping * 5), 1e-16, 1e6)
    return x[np.abs(gap).max(axis=1) < near * max(1.0, float(np.abs(factors).max()))]


def values_at(x: Any, form: Mapping[tuple[int, ...], Fraction]) -> Any:
    """The form at each row of x."""
    import numpy as np

    return _terms(x, np.array(list(form)), np.array([float(c) for c in form.values()])).sum(axis=1)


def on_spheres(n: int, spheres: Sequence[Sequence[int]], count: int) -> Any:
    """Random points of n variables (fixed seed), those of each sphere of unit length."""
    import numpy as np

    x = np.random.default_rng(7).standard_normal((count, n))
    for s in spheres:
        x[:, s] /= np.linalg.norm(x[:, s], axis=1, keepdims=True)
    return x


def _terms(x: Any, powers: Any, factors: Any, lowered: Sequence[int] = ()) -> Any:
    """The terms at each row of x, derived once by each variable in ``lowered``."""
    import numpy as np

    powers, factors = powers.copy(), factors.copy()
    for i in lowered:
        factors = factors * powers[:, i]
        powers[:, i] = np.maximum(powers[:, i] - 1, 0)
    used = factors != 0
    table = x[:, :, None] ** np.arange(powers.max() + 1)
    terms = np.broadcast_to(factors[used], (len(x), int(used.sum()))).copy()
    for i in range(x.shape[1]):
        terms *= table[:, i, powers[used, i]]
    return terms


def _system(x: Any, powers: Any, factors: Any, spheres: Sequence[Sequence[int]]) -> tuple[Any, Any]:
    """The gradient and what each sphere lacks to unit length, and the derivatives of these."""
    import numpy as np

    n = x.shape[1]
    gradient = np.stack([_terms(x, powers, factors, (i,)).sum(axis=1) for i in range(n)], axis=1)
    hessian = np.empty((len(x), n, n))
    for i in range(n):
        for j in range(i + 1):
            hessian[:, i, j] = hessian[:, j, i] = _terms(x, powers, factors, (i, j)).sum(axis=1)
    short = np.stack([(x[:, s] ** 2).sum(axis=1) - 1 for s in spheres], axis=1)
    rows = np.zeros((len(x), len(spheres), n))
    for k, s in enumerate(spheres):
        rows[:, k, s] = 2 * x[:, s]
    return np.concatenate([gradient, short], axis=1), np.concatenate([hessian, rows], axis=1)
