"""The quarter-ellipse kernel point by point through numba: the same formulas, compiled on first use (some seconds)."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from duhem.errors import MissingExtraError
from duhem.projection import quadrants
from duhem.projection.quadrants import CLOSE, SAFE, SEAM, SURE, Quarters
from duhem.projection.quarter_ellipse import formulas
from duhem.projection.result import Array

__all__ = ["project"]

_CHUNK = 1024  # points gathered before their directions are found together


def project(trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array) -> None:
    """As :func:`duhem.projection.quadrants.project`; MissingExtraError without numba."""
    kernel = _kernel()
    if quarters.flat.any():  # a segment is a clamp: nothing to gain
        quadrants.project(trial, load, quarters, stress, slip, multiplier)
        return
    q = quarters
    axes = (np.ascontiguousarray(q.axes), np.ascontiguousarray(q.axes_low))
    kernel(trial, load, q.mu, *axes, q.ratio, q.rest, q.compliance, q.power, q.first, stress, slip, multiplier)


@cache
def _kernel() -> Callable[..., None]:
    try:
        import numba
    except ImportError:
        raise MissingExtraError("numba", "fast") from None
    jit: Callable[[Any], Any] = numba.njit(error_model="numpy", forceinline=True)

    @jit
    def where(condition: bool, a: float, b: float) -> float:
        return a if condition else b

    plain = formulas(jit, where)
    quotient, product, excess, close_excess = plain.quotient, plain.product, plain.excess, plain.close_excess
    direction, multiplier_of = plain.direction, plain.multiplier

    @jit
    def ratios(t1: float, t2: float, mu1: float, mu2: float, e: float) -> Any:
        p1, l1 = quotient(abs(t1), mu1)
        p2, l2 = quotient(abs(t2), mu2)
        f = excess(p1, l1, p2, l2, e)
        if abs(f) <= CLOSE * e * e:
            f = close_excess(abs(t1), mu1, abs(t2), mu2, e)
        return p1, l1, p2, l2, f

    @jit
    def turned(high: Any, low: Any, x1: float, l1: float, x2: float, l2: float) -> Any:
        a, a_low = product(high[0], x1)
        b, b_low = product(high[1], x2)
        y = a + b
        v = y - a
        small = (a - (y - v)) + (b - v)
        small = small + (a_low + b_low) + (high[0] * l1 + low[0] * x1) + (high[1] * l2 + low[1] * x2)
        return y + small, small - ((y + small) - y)

    @jit
    def oblique(t1: float, t2: float, e: float, start: int, mu: Any, axes: Any, low: Any, ratio: Any, rest: Any) -> Any:
        best, w1, w2, z, used = np.inf, 0.0, 0.0, np.nan, start
        for flip in range(4):
            q = start ^ flip
            p1, l1, p2, l2, f = ratios(t1, t2, mu[q, 0], mu[q, 1], e)
            l1, l2 = math.copysign(1.0, t1) * l1, math.copysign(1.0, t2) * l2
            p1, p2 = math.copysign(p1, t1), math.copysign(p2, t2)
            y1, _ = turned(axes[q, 0], low[q, 0], p1, l1, p2, l2)
            y2, y2_low = turned(axes[q, 1], low[q, 1], p1, l1, p2, l2)
            v1, v2 = direction(abs(y1), abs(y2), math.copysign(1.0, y2) * y2_low, e, ratio[q], rest[q])
            c = multiplier_of(f, v1, v2, e, ratio[q])
            v1, v2 = math.copysign(v1, y1), math.copysign(v2, y2)
            a = axes[q, 0, 0] * v1 + axes[q, 1, 0] * v2
            b = axes[q, 0, 1] * v1 + axes[q, 1, 1] * v2
            missed = -np.inf
            if mu[q, 0] != mu[q ^ 1, 0]:
                missed = a if q & 1 else -a
            if mu[q, 1] != mu[q ^ 2, 1]:
                missed = max(missed, b if q & 2 else -b)
            if c > 0.0 and np.isfinite(c) and missed < best:
                best, w1, w2, z, used = missed, a, b, c, q
            if best < -SURE:
                break
        if best > 0.0:
            if (w1 < 0.0) != ((used & 1) == 1) and mu[used, 0] != mu[used ^ 1, 0]:
                w1 = 0.0
            if (w2 < 0.0) != ((used >> 1) == 1) and mu[used, 1] != mu[used ^ 2, 1]:
                w2 = 0.0
        return w1, w2, (z if best <= SEAM else np.nan), used

    @jit
    def finish(
        n: int, w1: float, w2: float, z: float, power: int, mu1: float, mu2: float, e: float, stress: Any, slip: Any, lam: Any
    ) -> None:
        stress[n, 0], stress[n, 1] = mu1 * e * w1, mu2 * e * w2
        if -900 < power < 900:
            factor = math.ldexp(1.0, power)
            lam[n], slip[n, 0], slip[n, 1] = z * factor, z * (w1 / mu1) * factor, z * (w2 / mu2) * factor
        else:
            lam[n] = math.ldexp(z, power)
            slip[n, 0], slip[n, 1] = math.ldexp(z * (w1 / mu1), power), math.ldexp(z * (w2 / mu2), power)

    @jit
    def directions(work: Any, count: int) -> None:
        """w_1, w_2, z of the points gathered in ``work``: no branch, so that the loop runs on vectors."""
        for j in range(count):
            p1, p2, l2, f = work[0, j], work[1, j], work[2, j], work[3, j]
            e, r, rest = work[4, j], work[5, j], work[6, j]
            w1, w2 = direction(p1, p2, l2, e, r, rest)
            work[0, j], work[1, j], work[2, j] = w1, w2, multiplier_of(f, w1, w2, e, r)

    @numba.njit(error_model="numpy")  # type: ignore[untyped-decorator,unused-ignore]
    def kernel(
        trial: Any, load: Any, mu: Any, axes: Any, low: Any, ratio: Any, rest: Any, compliance: Any, power: Any, first: Any,
        stress: Any, slip: Any, multiplier: Any,
    ) -> None:  # fmt: skip
        work, place, scales = np.empty((7, _CHUNK)), np.empty(_CHUNK, np.int64), np.empty(_CHUNK, np.int64)
        used = np.empty(_CHUNK, np.int64)
        for start in range(0, trial.shape[0], _CHUNK):
            count = 0
            for n in range(start, min(start + _CHUNK, trial.shape[0])):
                t1, t2, e = trial[n, 0], trial[n, 1], load[n]
                stress[n, 0], stress[n, 1] = t1, t2
                slip[n, 0], slip[n, 1], multiplier[n] = 0.0, 0.0, 0.0
                q = (1 if t1 < 0.0 else 0) + (2 if t2 < 0.0 else 0)
                scale = 0
                if max(abs(t1), abs(t2), e) > SAFE or e < 1.0 / SAFE:
                    _, scale = math.frexp(max(abs(t1), abs(t2), e))
                    t1, t2, e = math.ldexp(t1, -scale), math.ldexp(t2, -scale), math.ldexp(e, -scale)
                p1, p2 = t1 / mu[q, 0], t2 / mu[q, 1]
                if p1 * p1 + p2 * p2 <= e * e * (1.0 - 1e-13):
                    continue
                p1, l1, p2, l2, f = ratios(t1, t2, mu[q, 0], mu[q, 1], e)
                if f <= 0.0:
                    continue
                if first[q] < 0:
                    w1, w2, z, q = oblique(t1, t2, e, q, mu, axes, low, ratio, rest)
                    finish(n, w1, w2, z * compliance[q], scale + power[q], mu[q, 0], mu[q, 1], load[n], stress, slip, multiplier)
                    continue
                if first[q] == 1:
                    p1, p2, l2 = p2, p1, l1
                work[0, count], work[1, count], work[2, count], work[3, count] = p1, p2, l2, f
                work[4, count], work[5, count], work[6, count] = e, ratio[q], rest[q]
                place[count], scales[count], used[count] = n, scale, q
                count += 1
            directions(work, count)
            for j in range(count):
                n, q, scale = place[j], used[j], scales[j]
                w1, w2 = work[0, j], work[1, j]
                if first[q] == 1:
                    w1, w2 = w2, w1
                w1, w2 = math.copysign(w1, trial[n, 0]), math.copysign(w2, trial[n, 1])
                z = work[2, j] * compliance[q]
                finish(n, w1, w2, z, scale + power[q], mu[q, 0], mu[q, 1], load[n], stress, slip, multiplier)

    return kernel
