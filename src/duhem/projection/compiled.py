"""The quarter-ellipse kernel through numba: the same formulas, compiled once (some seconds), then kept on disk."""

from __future__ import annotations

import hashlib
import inspect
import math
import sys
from collections.abc import Callable, Sequence
from functools import cache
from types import ModuleType
from typing import Any, cast

import numpy as np

from duhem.projection import quadrants, quarter_ellipse
from duhem.projection.code_cache import WITHIN, CompiledText, compiled_text, only_read
from duhem.projection.quadrants import Quarters
from duhem.projection.quarter_ellipse import CLOSE, SAFE, formulas
from duhem.projection.result import Array

__all__ = ["compiled_closest", "kept_function", "kernel", "kernels", "project"]

_CHUNK = 504  # points looked at together: their numbers stay in the nearest cache, and rows of them apart in it


def project(trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array) -> None:
    """As :func:`duhem.projection.quadrants.project`; MissingExtraError without numba."""
    run = kernel()
    if quarters.flat.any():  # a segment is a clamp: nothing to gain
        quadrants.project(trial, load, quarters, stress, slip, multiplier)
        return
    run(only_read(trial), only_read(load), *_constants(quarters), stress, slip, multiplier)


def compiled_closest(quarters: Quarters) -> Callable[[Array, float], tuple[Array, Array, Array]]:
    """The same for one trial (1, 2) and its load; none of the quarters is flat."""
    constants = _constants(quarters)
    run = kernel().specialised(only_read(np.zeros((1, 2))), only_read(np.ones(1)), *constants, *_room())

    def closest(trial: Array, load: float) -> tuple[Array, Array, Array]:
        stress, slip, multiplier = _room()
        run(trial, only_read(np.array([load])), *constants, stress, slip, multiplier)
        return stress, slip, multiplier

    return closest


def _room() -> tuple[Array, Array, Array]:
    return np.empty((1, 2)), np.empty((1, 2)), np.empty(1)


def _constants(q: Quarters) -> tuple[Array, ...]:
    return tuple(only_read(x) for x in (q.mu, q.axes, q.axes_low, q.ratio, q.compliance, q.power, q.first))


_NAMES = "trial, load, mu, axes, low, ratio, compliance, power, first, stress, slip, multiplier"


@cache
def kernel() -> CompiledText:
    """The compiled function, for quarters of which none is flat; MissingExtraError without numba."""
    return kept_function(__name__, "kernels()[0]", _NAMES, (sys.modules[__name__], quarter_ellipse))


def kept_function(module: str, made: str, names: str, made_of: Sequence[ModuleType]) -> CompiledText:
    """Return a compiled function of the arguments ``names`` that is kept on disk.

    Each process makes its inner loop by the expression ``made`` of ``module``.  What is kept is used again only while the text of the
    modules ``made_of`` is the same.
    """
    stamp = hashlib.sha256("".join(map(inspect.getsource, made_of)).encode()).hexdigest()
    head = f"# {stamp}\nfrom {module} import {made.partition('(')[0]}\n\ninner = {made}\n\n\n"
    return compiled_text(f"{head}def run({names}):\n    inner({names})\n", "run")


@cache
def kernels() -> tuple[Callable[..., None], Callable[..., None]]:
    """The compiled function, made anew in each process, and the one of a single point that other compiled loops may call.

    Loops that run on vectors have no branch in them, know their arrays apart from a few addresses, and are short enough
    for several turns of them to be under way at once: hence three of them, with what they pass on in ``seen``.
    """
    import numba

    jit: Callable[[Any], Any] = numba.njit(forceinline=True, **WITHIN)
    loose: Callable[[Any], Any] = numba.njit(forceinline=True, fastmath={"contract"}, **WITHIN)
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
    single = quarter_ellipse.closest(jit, plain)

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

    @numba.njit(**WITHIN)  # type: ignore[untyped-decorator,unused-ignore]
    def run(
        trial: Any, load: Any, mu: Any, axes: Any, low: Any, ratio: Any, compliance: Any, power: Any, first: Any,
        stress: Any, slip: Any, multiplier: Any,
    ) -> None:  # fmt: skip
        """In chunks on vectors; what that leaves open, and every point where the axes are oblique, one by one."""
        flat_trial, flat_stress, flat_slip = trial.reshape(-1), stress.reshape(-1), slip.reshape(-1)
        seen = np.empty((9, _CHUNK))
        unit, inverse, straight = np.empty(4), 1.0 / mu, True
        for q in range(4):
            straight = straight and first[q] >= 0 and -900 < power[q] < 900
            straight = straight and 1.0 / SAFE < mu[q, 0] < SAFE and 1.0 / SAFE < mu[q, 1] < SAFE
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


def _fused(numba: Any) -> Callable[..., Any]:
    """a b + c rounded once: one instruction where the processor has it, a call that does the same where not."""
    from numba.extending import intrinsic

    double = numba.types.float64

    @intrinsic  # type: ignore[untyped-decorator,unused-ignore]
    def rounded_once(context: Any, a: Any, b: Any, c: Any) -> Any:
        return double(double, double, double), lambda target, builder, signature, arguments: builder.fma(*arguments)

    return cast(Callable[..., Any], rounded_once)
