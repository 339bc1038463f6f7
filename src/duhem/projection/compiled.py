"""The quarter-ellipse kernel through numba: the same formulas, compiled once (some seconds), then kept on disk."""

from __future__ import annotations

import hashlib
import inspect
import math
import sys
from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any, cast

import numpy as np

from duhem.projection import quadrants, quarter_ellipse
from duhem.projection.kept_code import compiled_text
from duhem.projection.plain_numbers import FAULTS, PlainArray, table
from duhem.projection.quadrants import CLOSE, NEAR, SAFE, SEAM, SURE, Quarters
from duhem.projection.quarter_ellipse import Formulas, formulas
from duhem.projection.result import Array

__all__ = ["kernel", "kernels", "one_point", "project", "project_one_by_one"]

_CHUNK = 504  # points looked at together: their numbers stay in the nearest cache, and rows of them apart in it


def project(trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array) -> None:
    """As :func:`duhem.projection.quadrants.project`; MissingExtraError without numba."""
    q, run = quarters, kernel()
    if q.flat.any():  # a segment is a clamp: nothing to gain
        quadrants.project(trial, load, q, stress, slip, multiplier)
        return
    axes = (np.ascontiguousarray(q.axes), np.ascontiguousarray(q.axes_low))
    trial, load = np.ascontiguousarray(trial), np.ascontiguousarray(load)
    run(trial, load, q.mu, *axes, q.ratio, q.compliance, q.power, q.first, stress, slip, multiplier)


_KEPT = """\
# {stamp}
from duhem.projection.compiled import kernels

inner, _ = kernels()


def run({names}):
    inner({names})
"""
_NAMES = "trial, load, mu, axes, low, ratio, compliance, power, first, stress, slip, multiplier"


@cache
def kernel() -> Callable[..., None]:
    """The compiled function, for quarters of which none is flat; MissingExtraError without numba.

    What is kept belongs to the text of the modules that it was made of.
    """
    made_of = "".join(inspect.getsource(module) for module in (sys.modules[__name__], quadrants, quarter_ellipse))
    return compiled_text(_KEPT.format(stamp=hashlib.sha256(made_of.encode()).hexdigest(), names=_NAMES), "run")


@cache
def kernels() -> tuple[Callable[..., None], Callable[..., None]]:
    """The compiled function, made anew in each process, and the one of a single point that other compiled loops may call.

    Loops that run on vectors have no branch in them, know their arrays apart from a few addresses, and are short enough
    for several turns of them to be under way at once: hence three of them, with what they pass on in ``seen``.
    """
    import numba

    jit: Callable[[Any], Any] = numba.njit(error_model="numpy", forceinline=True)
    loose: Callable[[Any], Any] = numba.njit(error_model="numpy", forceinline=True, fastmath={"contract"})
    rounded_once = _fused(numba)

    @jit
    def where(condition: bool, a: float, b: float) -> float:
        return a if condition else b

    @jit
    def exact(a: float, b: float) -> Any:
        high = a * b
        return high, rounded_once(a, b, -high)

    @jit
    def nearly(t: float, mu: float, inverse: float) -> Any:
        """t/mu as a sum of two numbers, without dividing: what the first is off, the second makes up for."""
        high = t * inverse
        return high, rounded_once(-high, mu, t) * inverse

    plain = formulas(jit, where, exact, loose)
    excess, start, root, along, multiplier_of = plain.excess, plain.start, plain.root, plain.turned, plain.multiplier
    single = one_point(jit, plain)

    @jit
    def examine(trial: Any, load: Any, mu: Any, inverse: Any, ratio: Any, first: Any, seen: Any) -> None:
        """Into the rows of ``seen``: the trial and the load, F or nan where that needs care, and the quartic with a first root."""
        a_plus, a_minus, b_plus, b_minus = mu[0, 0], mu[1, 0], mu[0, 1], mu[2, 1]
        over_a_plus, over_a_minus, over_b_plus, over_b_minus = inverse[0, 0], inverse[1, 0], inverse[0, 1], inverse[2, 1]
        r0, r1, r2, r3 = ratio[0], ratio[1], ratio[2], ratio[3]
        f0, f1, f2, f3 = first[0] == 1, first[1] == 1, first[2] == 1, first[3] == 1
        for i in range(load.shape[0]):
            t1, t2, e = trial[2 * i], trial[2 * i + 1], load[i]
            a, b = t1 < 0.0, t2 < 0.0
            r = where(a, where(b, r3, r1), where(b, r2, r0))
            swapped = where(a, where(b, f3, f1), where(b, f2, f0))
            p1, l1 = nearly(abs(t1), where(a, a_minus, a_plus), where(a, over_a_minus, over_a_plus))
            p2, l2 = nearly(abs(t2), where(b, b_minus, b_plus), where(b, over_b_minus, over_b_plus))
            f = excess(p1, l1, p2, l2, e)
            near, beta, three, one, h = start(where(swapped, p2, p1), where(swapped, p1, p2), where(swapped, l1, l2), e, r)
            clear = (abs(f) > CLOSE * (e * e) + 1.0 / SAFE**2) & (f <= SAFE**2)
            seen[0, i], seen[1, i], seen[2, i], seen[3, i] = t1, t2, e, where(clear, f, np.nan)
            seen[4, i], seen[5, i], seen[6, i], seen[7, i] = where(near, 1.0, 0.0), beta, three, one
            seen[8, i] = h

    @jit
    def solve(seen: Any, size: int) -> None:
        """The root of each quartic, whether its point slips or not."""
        for i in range(size):
            seen[8, i] = root(seen[5, i], seen[6, i], seen[7, i], seen[8, i])

    @jit
    def answer(seen: Any, mu: Any, inverse: Any, ratio: Any, first: Any, unit: Any, stress: Any, slip: Any, multiplier: Any) -> None:
        """Stress, slip and multiplier; the multiplier is nan where a number may be out of range or F is."""
        a_plus, a_minus, b_plus, b_minus = mu[0, 0], mu[1, 0], mu[0, 1], mu[2, 1]
        over_a_plus, over_a_minus, over_b_plus, over_b_minus = inverse[0, 0], inverse[1, 0], inverse[0, 1], inverse[2, 1]
        r0, r1, r2, r3 = ratio[0], ratio[1], ratio[2], ratio[3]
        u0, u1, u2, u3 = unit[0], unit[1], unit[2], unit[3]
        f0, f1, f2, f3 = first[0] == 1, first[1] == 1, first[2] == 1, first[3] == 1
        for i in range(multiplier.shape[0]):
            t1, t2, e, f = seen[0, i], seen[1, i], seen[2, i], seen[3, i]
            a, b = t1 < 0.0, t2 < 0.0
            m1, m2 = where(a, a_minus, a_plus), where(b, b_minus, b_plus)
            n1, n2 = where(a, over_a_minus, over_a_plus), where(b, over_b_minus, over_b_plus)
            r = where(a, where(b, r3, r1), where(b, r2, r0))
            u = where(a, where(b, u3, u1), where(b, u2, u0))
            swapped = where(a, where(b, f3, f1), where(b, f2, f0))
            v1, v2 = along(seen[4, i] > 0.0, seen[8, i])
            slips = f > 0.0
            z = where(f <= 0.0, 0.0, multiplier_of(f, v1, v2, e, r) * u)
            w1, w2 = math.copysign(where(swapped, v2, v1), t1), math.copysign(where(swapped, v1, v2), t2)
            stress[2 * i], stress[2 * i + 1] = where(slips, m1 * e * w1, t1), where(slips, m2 * e * w2, t2)
            slip[2 * i], slip[2 * i + 1] = where(slips, z * (w1 * n1), 0.0), where(slips, z * (w2 * n2), 0.0)
            multiplier[i] = where(z <= SAFE**4, z, np.nan)

    @numba.njit(error_model="numpy")  # type: ignore[untyped-decorator,unused-ignore]
    def run(
        trial: Any, load: Any, mu: Any, axes: Any, low: Any, ratio: Any, compliance: Any, power: Any, first: Any,
        stress: Any, slip: Any, multiplier: Any,
    ) -> None:  # fmt: skip
        """In chunks on vectors; what that leaves open, and every point where the axes are oblique, one by one."""
        flat_trial, flat_stress, flat_slip = trial.reshape(-1), stress.reshape(-1), slip.reshape(-1)
        seen = np.empty((9, _CHUNK))
        unit, inverse, straight = np.empty(4), 1.0 / mu, mu.min() > 1.0 / SAFE and mu.max() < SAFE
        for q in range(4):
            straight = straight and first[q] >= 0 and -900 < power[q] < 900
            unit[q] = math.ldexp(compliance[q], power[q])
        for begin in range(0, load.shape[0], _CHUNK):
            stop = min(begin + _CHUNK, load.shape[0])
            two, lengths = slice(2 * begin, 2 * stop), multiplier[begin:stop]
            if straight:
                examine(flat_trial[two], load[begin:stop], mu, inverse, ratio, first, seen)
                solve(seen, lengths.shape[0])
                answer(seen, mu, inverse, ratio, first, unit, flat_stress[two], flat_slip[two], lengths)
                left = 0
                for i in range(lengths.shape[0]):
                    left += lengths[i] != lengths[i]
                if left == 0:
                    continue
            for n in range(begin, stop):
                if not straight or np.isnan(multiplier[n]):
                    single(n, trial, load, mu, axes, low, ratio, compliance, power, first, stress, slip, multiplier)

    return run, single


def one_point(compile: Callable[[Any], Any], plain: Formulas) -> Callable[..., None]:
    """The closest point to one trial, whatever its numbers; each function is passed through ``compile``."""
    quotient, product, excess, close_excess = plain.quotient, plain.product, plain.excess, plain.close_excess
    direction, multiplier_of, on_grid = plain.direction, plain.multiplier, plain.on_grid

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

    @compile
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
                length = np.hypot(p1, p2)
                w1, w2 = p1 / length, p2 / length
            else:
                w1, w2 = direction(p1, p2, l2, e, ratio[q])
            z = multiplier_of(f, w1, w2, e, ratio[q])
            if first[q] == 1:
                w1, w2 = w2, w1
            w1, w2 = math.copysign(w1, trial[n, 0]), math.copysign(w2, trial[n, 1])
        finish(n, w1, w2, z * compliance[q], scale + power[q], mu[q, 0], mu[q, 1], load[n], stress, slip, multiplier)

    return single


def project_one_by_one(trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array) -> None:
    """As :func:`duhem.projection.quadrants.project`, to the bit, without arrays: for few points."""
    run, constants = _plain(), _tables(quarters)
    with np.errstate(all="ignore"):
        for n, (given, e) in enumerate(zip(trial.tolist(), load.tolist(), strict=True)):
            s, moved, weight = PlainArray(), PlainArray(), PlainArray()
            try:
                run(0, {(0, 0): given[0], (0, 1): given[1]}, {0: e}, *constants, s, moved, weight)
            except FAULTS:
                here = slice(n, n + 1)
                quadrants.project(trial[here], load[here], quarters, stress[here], slip[here], multiplier[here])
                continue
            stress[n], slip[n], multiplier[n] = (s[0, 0], s[0, 1]), (moved[0, 0], moved[0, 1]), weight[0]


@cache
def _plain() -> Callable[..., None]:
    return one_point(lambda function: function, formulas(where=lambda condition, a, b: a if condition else b, sqrt=math.sqrt))


@lru_cache(maxsize=256)
def _tables(quarters: Quarters) -> tuple[PlainArray, ...]:
    """mu, axes, low, ratio, compliance, power and first."""
    q = quarters
    rows = [PlainArray() for _ in range(2)]
    for found, axes in zip(rows, (q.axes, q.axes_low), strict=True):
        for place in np.ndindex(4, 2):
            found[place] = axes[place].tolist()
            found.update({(*place, i): x for i, x in enumerate(found[place])})
    return table(q.mu), *rows, *(table(x) for x in (q.ratio, q.compliance, q.power, q.first))


def _fused(numba: Any) -> Callable[..., Any]:
    """a b + c rounded once: one instruction where the processor has it, a call that does the same where not."""
    from numba.extending import intrinsic

    double = numba.types.float64

    @intrinsic  # type: ignore[untyped-decorator,unused-ignore]
    def rounded_once(context: Any, a: Any, b: Any, c: Any) -> Any:
        return double(double, double, double), lambda target, builder, signature, arguments: builder.fma(*arguments)

    return cast(Callable[..., Any], rounded_once)
