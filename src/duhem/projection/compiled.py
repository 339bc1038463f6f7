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

_CHUNK = 1024  # points looked at together: their numbers stay in the nearest cache


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
            factor = np.int64((np.int64(power) + 1023) << 52).view(np.float64)  # 2^power without a call
            lam[n], slip[n, 0], slip[n, 1] = z * factor, z * (w1 / mu1) * factor, z * (w2 / mu2) * factor
        else:
            lam[n] = math.ldexp(z, power)
            slip[n, 0], slip[n, 1] = math.ldexp(z * (w1 / mu1), power), math.ldexp(z * (w2 / mu2), power)

    @jit
    def examine(seen: Any, size: int, mu: Any) -> None:
        """Ratios and F of the points of a chunk, and whether each sticks (0), slips (1) or needs care (2): no branch."""
        a_plus, a_minus, b_plus, b_minus = mu[0, 0], mu[1, 0], mu[0, 1], mu[2, 1]
        for i in range(size):
            t1, t2, e = seen[0, i], seen[1, i], seen[2, i]
            p1, l1 = quotient(abs(t1), where(t1 < 0.0, a_minus, a_plus))
            p2, l2 = quotient(abs(t2), where(t2 < 0.0, b_minus, b_plus))
            f = excess(p1, l1, p2, l2, e)
            most = where(abs(t1) > abs(t2), abs(t1), abs(t2))
            rough = (most > SAFE) | (e > SAFE) | (e < 1.0 / SAFE) | (abs(f) <= CLOSE * e * e)
            seen[3, i], seen[4, i], seen[5, i], seen[6, i], seen[7, i] = p1, l1, p2, l2, f
            seen[8, i] = where(rough, 2.0, where(f > 0.0, 1.0, 0.0))

    @jit
    def directions(work: Any, count: int) -> None:
        """w_1, w_2, z of the points gathered in ``work``: no branch, so that the loop runs on vectors."""
        for j in range(count):
            p1, p2, l2, f = work[0, j], work[1, j], work[2, j], work[3, j]
            e, r, rest = work[4, j], work[5, j], work[6, j]
            w1, w2 = direction(p1, p2, l2, e, r, rest)
            work[0, j], work[1, j], work[2, j] = w1, w2, multiplier_of(f, w1, w2, e, r)

    @jit
    def single(
        n: int, trial: Any, load: Any, mu: Any, axes: Any, low: Any, ratio: Any, rest: Any, compliance: Any, power: Any, first: Any,
        stress: Any, slip: Any, multiplier: Any,
    ) -> None:  # fmt: skip
        """One point, whatever its numbers."""
        t1, t2, e = trial[n, 0], trial[n, 1], load[n]
        q = (1 if t1 < 0.0 else 0) + (2 if t2 < 0.0 else 0)
        scale = 0
        if max(abs(t1), abs(t2), e) > SAFE or e < 1.0 / SAFE:
            _, scale = math.frexp(max(abs(t1), abs(t2), e))
            t1, t2, e = math.ldexp(t1, -scale), math.ldexp(t2, -scale), math.ldexp(e, -scale)
        p1, l1, p2, l2, f = ratios(t1, t2, mu[q, 0], mu[q, 1], e)
        if f <= 0.0:
            return
        if first[q] < 0:
            w1, w2, z, q = oblique(t1, t2, e, q, mu, axes, low, ratio, rest)
        else:
            if first[q] == 1:
                p1, p2, l2 = p2, p1, l1
            w1, w2 = direction(p1, p2, l2, e, ratio[q], rest[q])
            z = multiplier_of(f, w1, w2, e, ratio[q])
            if first[q] == 1:
                w1, w2 = w2, w1
            w1, w2 = math.copysign(w1, trial[n, 0]), math.copysign(w2, trial[n, 1])
        finish(n, w1, w2, z * compliance[q], scale + power[q], mu[q, 0], mu[q, 1], load[n], stress, slip, multiplier)

    @numba.njit(error_model="numpy")  # type: ignore[untyped-decorator,unused-ignore]
    def kernel(
        trial: Any, load: Any, mu: Any, axes: Any, low: Any, ratio: Any, rest: Any, compliance: Any, power: Any, first: Any,
        stress: Any, slip: Any, multiplier: Any,
    ) -> None:  # fmt: skip
        """In chunks, each a sequence of loops without branches, so that they run on vectors; points that need care by themselves."""
        seen, work = np.empty((9, _CHUNK)), np.empty((7, _CHUNK))
        place = np.empty(_CHUNK, np.int64)
        unit, plain = np.empty(4), True
        for q in range(4):
            plain = plain and first[q] >= 0 and -900 < power[q] < 900
            unit[q] = math.ldexp(compliance[q], power[q])
        for start in range(0, trial.shape[0], _CHUNK):
            size = min(_CHUNK, trial.shape[0] - start)
            for i in range(size):
                seen[0, i], seen[1, i], seen[2, i] = trial[start + i, 0], trial[start + i, 1], load[start + i]
            stress[start : start + size] = trial[start : start + size]
            slip[start : start + size] = 0.0
            multiplier[start : start + size] = 0.0
            examine(seen, size, mu)
            careful = 0.0
            for i in range(size):
                careful = max(careful, seen[8, i])
            if careful == 2.0 or not plain:
                for i in range(size):
                    if seen[8, i] == 2.0 or (seen[8, i] == 1.0 and not plain):
                        single(
                            start + i, trial, load, mu, axes, low, ratio, rest, compliance, power, first, stress, slip, multiplier
                        )  # fmt: skip
            if not plain:
                continue
            count = 0
            for i in range(size):
                place[count] = i
                count += 1 if seen[8, i] == 1.0 else 0
            for j in range(count):
                i = place[j]
                q = (1 if seen[0, i] < 0.0 else 0) + (2 if seen[1, i] < 0.0 else 0)
                swapped = first[q] == 1
                work[0, j], work[1, j] = where(swapped, seen[5, i], seen[3, i]), where(swapped, seen[3, i], seen[5, i])
                work[2, j], work[3, j] = where(swapped, seen[4, i], seen[6, i]), seen[7, i]
                work[4, j], work[5, j], work[6, j] = seen[2, i], ratio[q], rest[q]
            directions(work, count)
            for j in range(count):
                n = start + place[j]
                t1, t2, e = trial[n, 0], trial[n, 1], load[n]
                q = (1 if t1 < 0.0 else 0) + (2 if t2 < 0.0 else 0)
                swapped = first[q] == 1
                w1 = math.copysign(where(swapped, work[1, j], work[0, j]), t1)
                w2 = math.copysign(where(swapped, work[0, j], work[1, j]), t2)
                m1, m2 = mu[q, 0], mu[q, 1]
                z = work[2, j] * unit[q]
                stress[n, 0], stress[n, 1] = m1 * e * w1, m2 * e * w2
                slip[n, 0], slip[n, 1], multiplier[n] = z * (w1 / m1), z * (w2 / m2), z

    return kernel
