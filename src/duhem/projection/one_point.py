"""The closest point to one trial on four quarter ellipses: compiled as a part of :mod:`duhem.projection.compiled`, or run as it is."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from duhem.projection.quarter_ellipse import CLOSE, NEAR, SAFE, SEAM, SURE, Formulas

__all__ = ["closest"]


def closest(compile: Callable[[Any], Any], plain: Formulas) -> Callable[..., None]:
    """The closest point to one trial, whatever its numbers; each function is passed through ``compile``."""
    quotient, product, excess, close_excess = plain.quotient, plain.product, plain.excess, plain.close_excess
    direction, multiplier_of, on_grid, of_bits = plain.direction, plain.multiplier, plain.on_grid, plain.of_bits

    @compile
    def ratios(t1: float, t2: float, mu1: float, mu2: float, e: float) -> Any:
        p1, l1 = quotient(abs(t1), mu1)
        p2, l2 = quotient(abs(t2), mu2)
        f = excess(p1, l1, p2, l2, e)
        if abs(f) <= CLOSE * e * e:
            f = close_excess(abs(t1), mu1, abs(t2), mu2, e)
        return p1, l1, p2, l2, f

    @compile
    def turned(high: Any, low: Any, x1: float, l1: float, x2: float, l2: float) -> Any:
        a, a_low = product(high[0], x1)
        b, b_low = product(high[1], x2)
        y = a + b
        v = y - a
        small = (a - (y - v)) + (b - v)
        small = small + (a_low + b_low) + (high[0] * l1 + low[0] * x1) + (high[1] * l2 + low[1] * x2)
        return y + small, small - ((y + small) - y)

    @compile
    def oblique(t1: float, t2: float, e: float, own: int, mu: Any, axes: Any, low: Any, ratio: Any) -> Any:
        best, w1, w2, z, used = np.inf, 0.0, 0.0, np.nan, own
        for flip in range(4):
            q = own ^ flip
            p1, l1, p2, l2, f = ratios(t1, t2, mu[q, 0], mu[q, 1], e)
            l1, l2 = math.copysign(1.0, t1) * l1, math.copysign(1.0, t2) * l2
            p1, p2 = math.copysign(p1, t1), math.copysign(p2, t2)
            y1, _ = turned(axes[q, 0], low[q, 0], p1, l1, p2, l2)
            y2, y2_low = turned(axes[q, 1], low[q, 1], p1, l1, p2, l2)
            v1, v2 = direction(abs(y1), abs(y2), math.copysign(1.0, y2) * y2_low, e, ratio[q])
            c = multiplier_of(f, v1, v2, e, ratio[q])
            v1, v2 = math.copysign(v1, y1), math.copysign(v2, y2)
            a = axes[q, 0, 0] * v1 + axes[q, 1, 0] * v2
            b = axes[q, 0, 1] * v1 + axes[q, 1, 1] * v2
            missed = -np.inf
            if mu[q, 0] != mu[q ^ 1, 0]:
                missed = a if q & 1 else -a
            if mu[q, 1] != mu[q ^ 2, 1]:
                missed = max(missed, b if q & 2 else -b)
            if 0.0 < c < np.inf and missed < best:
                best, w1, w2, z, used = missed, a, b, c, q
            if best < -SURE:
                break
        if best > 0.0:
            if (w1 < 0.0) != ((used & 1) == 1) and mu[used, 0] != mu[used ^ 1, 0]:
                w1 = 0.0
            if (w2 < 0.0) != ((used >> 1) == 1) and mu[used, 1] != mu[used ^ 2, 1]:
                w2 = 0.0
        return w1, w2, (z if best <= SEAM else np.nan), used

    @compile
    def finish(
        n: int, w1: float, w2: float, z: float, power: int, mu1: float, mu2: float, e: float, stress: Any, slip: Any, lam: Any
    ) -> None:
        stress[n, 0], stress[n, 1] = mu1 * e * w1, mu2 * e * w2
        if -900 < power < 900:
            factor = of_bits((np.int64(power) + 1023) << 52)  # 2^power without a call
            lam[n], slip[n, 0], slip[n, 1] = z * factor, z * (w1 / mu1) * factor, z * (w2 / mu2) * factor
        else:
            lam[n] = math.ldexp(z, power)
            slip[n, 0], slip[n, 1] = math.ldexp(z * (w1 / mu1), power), math.ldexp(z * (w2 / mu2), power)
        if not max(abs(slip[n, 0]), abs(slip[n, 1])) < np.inf:
            lam[n] = np.nan

    @compile
    def single(
        n: int, trial: Any, load: Any, mu: Any, axes: Any, low: Any, ratio: Any, compliance: Any, power: Any, first: Any,
        stress: Any, slip: Any, multiplier: Any,
    ) -> None:  # fmt: skip
        """One point, whatever its numbers."""
        t1, t2, e = trial[n, 0], trial[n, 1], load[n]
        stress[n, 0], stress[n, 1], slip[n, 0], slip[n, 1], multiplier[n] = t1, t2, 0.0, 0.0, 0.0
        q = (1 if t1 < 0.0 else 0) + (2 if t2 < 0.0 else 0)
        scale = 0
        if max(abs(t1), abs(t2), e) > SAFE or e < 1.0 / SAFE:
            _, scale = math.frexp(max(abs(t1), abs(t2), e))
            t1, t2, e = math.ldexp(t1, -scale), math.ldexp(t2, -scale), math.ldexp(e, -scale)
        if first[q] < 0:
            p1, l1, p2, l2, f = ratios(t1, t2, mu[q, 0], mu[q, 1], e)
        else:
            p1, l1, p2, l2, f = on_grid(abs(t1), mu[q, 0], abs(t2), mu[q, 1], e)
            cusp = abs((p1 if first[q] == 1 else p2) - (1.0 - ratio[q]) * e)
            if abs(f) <= NEAR * e * e or cusp <= NEAR * e:
                p1, l1, p2, l2, f = ratios(t1, t2, mu[q, 0], mu[q, 1], e)
        if f <= 0.0:
            return
        if first[q] < 0:
            w1, w2, z, q = oblique(t1, t2, e, q, mu, axes, low, ratio)
        else:
            if first[q] == 1:
                p1, p2, l2 = p2, p1, l1
            if ratio[0] == ratio[1] == ratio[2] == ratio[3] == 1.0:  # the closest point lies on the ray of the trial
                length = float(np.hypot(p1, p2))
                w1, w2 = p1 / length, p2 / length
            else:
                w1, w2 = direction(p1, p2, l2, e, ratio[q])
            z = multiplier_of(f, w1, w2, e, ratio[q])
            if first[q] == 1:
                w1, w2 = w2, w1
            w1, w2 = math.copysign(w1, trial[n, 0]), math.copysign(w2, trial[n, 1])
        finish(n, w1, w2, z * compliance[q], scale + power[q], mu[q, 0], mu[q, 1], load[n], stress, slip, multiplier)

    return single
