"""Closest point on a quarter ellipse: formulas that hold alike for NumPy arrays and, compiled, for single numbers.

With coefficients mu_i, load e >= 0, p_i = |sigma_tr,i|/mu_i and c_i = k_i/mu_i^2, the boundary point mu_i e w_i,
w = (cos theta, sin theta), satisfies p_i = w_i (e + c_i lambda).  Axis 1 is that of the larger c, r = c_2/c_1 <= 1 and
z = c_1 lambda.  Eliminating z leaves A/sin theta - B/cos theta = C with A = p_2, B = r p_1, C = e (1 - r), a quartic in
the tangent of a half angle; the angle is measured from the nearer axis, so that h <= sqrt(2) - 1.  Every difference
that may cancel is taken in twice the working precision.

Double-word arithmetic: T. J. Dekker (1971), Numer. Math. 18, 224-242.  Projection onto an ellipse: theta is the
eccentric angle; where r -> 0 the trial point nears the evolute and the quartic a triple root.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = ["CLOSE", "NEAR", "SAFE", "SEAM", "SURE", "Formulas", "closest", "formulas"]

SAFE = 2.0**200  # of what lies between 1/SAFE and SAFE cubes neither overflow nor vanish, nor if times a ratio above 1/SAFE^2
CLOSE = 2.0**-45  # relative; closer than this, F of two words is not good to the last digits
NEAR = 2.0**-20  # the same of F from parts on a grid, and of a ratio that the evolute's cusp is taken off
SURE = 1e-14  # a result this far within its quadrant, as a direction, is not there by rounding
SEAM = 1e-6  # a result this far beyond its quadrant, as a direction, is none

_SPLIT = 134217729.0  # 2^27 + 1
_GRID = 2.0**27  # times a number: added and taken off again, 26 digits of what is smaller are left
_DIAGONAL = float(np.sqrt(0.5))
_ONE_THIRD, _THIRD = 1431655766, 715094163  # 2^32/3, rounded up; what the exponent's bias leaves
_HALF = (1023 << 51) - (0x5A827 << 28)  # half the exponent's bias, less about half of what the mantissa adds too much
_STEPS = 3  # cubic convergence from these starts: the worst errors over r = 1e-28 ... 1 are 5e-3, 4e-8, < 1e-18


@dataclass(frozen=True)
class Formulas:
    """The formulas, plain or compiled.

    ``product(a, b)``: a b as a sum of two numbers.  ``quotient(t, mu)``: t/mu likewise.
    ``excess(p1, l1, p2, l2, e)``: F = p_1^2 + p_2^2 - e^2 for p_i = p_i + l_i.
    ``close_excess(t1, mu1, t2, mu2, e)``: F in three words, for points so close to the boundary that two do not settle it.
    ``on_grid(t1, mu1, t2, mu2, e)``: p_1, l_1, p_2, l_2 and F with few operations, off by 2^-75 (p_1 + p_2 + e), and its square.
    ``direction(p1, p2, l2, e, r)``: (w_1, w_2), in three parts: ``start`` gives whether axis 1 is the nearer, the quartic
    beta h^4 + three h^3 + one h - beta and a first h; ``root(beta, three, one, h)`` its h; ``turned(near, h)`` (w_1, w_2).
    ``multiplier(F, w1, w2, e, r)``: z = c_1 lambda.
    ``of_bits(n)``: the number whose 64 bits are those of n.
    """

    product: Callable[..., Any]
    quotient: Callable[..., Any]
    excess: Callable[..., Any]
    close_excess: Callable[..., Any]
    on_grid: Callable[..., Any]
    direction: Callable[..., Any]
    start: Callable[..., Any]
    root: Callable[..., Any]
    turned: Callable[..., Any]
    multiplier: Callable[..., Any]
    of_bits: Callable[..., Any]


Compiler = Callable[[Any], Any]


def _plain(function: Any) -> Any:
    return function


def _bits(x: Any) -> Any:
    return np.float64(x).view(np.int64)


def _of_bits(bits: Any) -> Any:
    return np.int64(bits).view(np.float64)


def formulas(
    compile: Compiler = _plain,
    where: Callable[..., Any] = np.where,
    exact: Callable[..., Any] | None = None,
    loose: Compiler | None = None,
    sqrt: Callable[[Any], Any] = np.sqrt,
    bits: tuple[Compiler, Compiler] = (_bits, _of_bits),
    roots: tuple[Compiler, Compiler] | None = None,
) -> Formulas:
    """The formulas, each passed through ``compile``; ``where(condition, a, b)`` chooses for what they are applied to.

    ``exact``: the product where there is a shorter way to it.  ``loose``: compiles what no error-free sum depends on,
    where products and sums may be rounded together; ``compile`` if left out.  ``sqrt``: the root of what they are applied to;
    ``bits``: its 64 bits as a whole number, and the number of such bits; ``roots``: the cube root and the square root to start from,
    where bits are not at hand.
    """
    loose = compile if loose is None else loose
    bits_of, of_bits = map(compile, bits)

    @compile
    def split_product(a: Any, b: Any) -> Any:
        high = a * b
        a1 = _SPLIT * a
        a1 = a1 - (a1 - a)
        a2 = a - a1
        b1 = _SPLIT * b
        b1 = b1 - (b1 - b)
        b2 = b - b1
        return high, ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2

    @compile
    def split_square(a: Any) -> Any:
        high = a * a
        a1 = _SPLIT * a
        a1 = a1 - (a1 - a)
        a2 = a - a1
        return high, ((a1 * a1 - high) + 2.0 * (a1 * a2)) + a2 * a2

    product = split_product if exact is None else exact
    squared = split_square if exact is None else compile(lambda a: exact(a, a))

    @compile
    def quotient(t: Any, mu: Any) -> Any:
        high = t / mu
        back, low = product(high, mu)
        return high, ((t - back) - low) / mu

    @compile
    def total(a: Any, b: Any) -> Any:
        high = a + b
        v = high - a
        return high, (a - (high - v)) + (b - v)

    @loose
    def lower(sums: Any, squares: Any, p1: Any, l1: Any, p2: Any, l2: Any) -> Any:
        mixed = p1 * l1 + p2 * l2
        return sums + (squares + (mixed + mixed))

    @compile
    def excess(p1: Any, l1: Any, p2: Any, l2: Any, e: Any) -> Any:
        a, a_low = squared(p1)
        b, b_low = squared(p2)
        d, d_low = squared(e)
        x, x_low = total(a, -d)
        y, y_low = total(x, b)
        return y + lower(x_low + y_low, a_low + b_low - d_low, p1, l1, p2, l2)

    @compile
    def square(t: Any, mu: Any) -> Any:
        p = t / mu
        back, low = product(p, mu)
        left = (t - back) - low  # exact, and so is the next remainder
        q = left / mu
        back, low = product(q, mu)
        last = ((left - back) - low) / mu
        a, a_low = product(p, p)
        b, b_low = product(2.0 * p, q)
        return a, a_low, b, b_low + (q * q + 2.0 * p * last)

    @compile
    def close_excess(t1: Any, mu1: Any, t2: Any, mu2: Any, e: Any) -> Any:
        a, a2, a3, a4 = square(t1, mu1)
        b, b2, b3, b4 = square(t2, mu2)
        d, d2 = product(e, e)
        x, x2 = total(a, -d)
        y, y2 = total(x, b)
        low = a4 + b4
        for term in (x2, y2, a2, b2, -d2, a3, b3):
            y, rounding = total(y, term)
            low = low + rounding
        return y + low

    @compile
    def halved(a: Any) -> Any:
        high = _SPLIT * a
        high = high - (high - a)
        return high, a - high

    @compile
    def on_grid(t1: Any, mu1: Any, t2: Any, mu2: Any, e: Any) -> Any:
        """Parts that are multiples of one power of two, so short that their squares and the sums of these are exact."""
        over1, over2 = 1.0 / mu1, 1.0 / mu2
        p1, p2 = t1 * over1, t2 * over2
        grid = _GRID * (p1 + p2 + e)
        (m1, n1), (m2, n2) = halved(mu1), halved(mu2)
        a, b, d = p1 + grid - grid, p2 + grid - grid, e + grid - grid
        a_low, b_low, d_low = (t1 - a * m1 - a * n1) * over1, (t2 - b * m2 - b * n2) * over2, e - d
        p1, p2 = a + a_low, b + b_low
        rest = a_low * (p1 + a) + b_low * (p2 + b) - d_low * (e + d)
        return p1, a - p1 + a_low, p2, b - p2 + b_low, (a * a - d * d) + b * b + rest

    @compile
    def cube_root(x: Any) -> Any:
        """To 5 %, enough to start from: the upper word divided by three (W. Kahan's trick), zero to 1e-103.

        The division is a product and a shift, which vector units have.
        """
        upper = bits_of(x) >> 32
        return of_bits(((upper * _ONE_THIRD >> 32) + _THIRD) << 32)

    @compile
    def square_root(x: Any) -> Any:
        """To 5 % likewise, of a number that is not negative."""
        return of_bits((bits_of(x) >> 1) + _HALF)

    cube_root, square_root = roots or (cube_root, square_root)

    @loose
    def start(p1: Any, p2: Any, l2: Any, e: Any, r: Any) -> Any:
        b, back = r * p1, r * e
        c = e - back
        near = p2 - b - c * _DIAGONAL <= 0.0  # theta <= pi/4
        inner = ((p2 - e) + l2) + back  # p_2 - c
        beta = 0.5 * where(near, p2, b)
        three = where(near, b - c, p2 + c)
        one = where(near, b + c, inner)
        q = cube_root((p2 + c) * (beta * beta))
        plain = near | (inner > 0.0)
        h = where(plain, beta, q - inner) / where(plain, one + where(near, 0.0, q), p2 + c)
        h = where(plain, h, square_root(h))
        return near, beta, three, one, h

    @loose
    def root(beta: Any, three: Any, one: Any, h: Any) -> Any:
        thrice = three + three
        thrice += three
        for _ in range(_STEPS):  # Halley, of arrays in few of them
            last, square = beta * h, h * h
            f = last + three
            f *= square
            f += one
            f *= h
            f -= beta
            slope = 4.0 * last
            slope += thrice
            slope *= square
            slope += one
            last *= 6.0
            last += thrice
            last *= h
            last *= f
            square = slope * slope
            square -= last  # stays above 0.8 slope^2
            f *= slope
            f /= square
            h = h - f
        return h

    @loose
    def turned(near: Any, h: Any) -> Any:
        square = h * h
        share = 1.0 / (1.0 + square)
        long, short = (1.0 - square) * share, (h + h) * share
        return where(near, long, short), where(near, short, long)

    @loose
    def direction(p1: Any, p2: Any, l2: Any, e: Any, r: Any) -> Any:
        near, beta, three, one, h = start(p1, p2, l2, e, r)
        return turned(near, root(beta, three, one, h))

    @loose
    def multiplier(f: Any, w1: Any, w2: Any, e: Any, r: Any) -> Any:
        u1, u2 = w1 * w1, w2 * w2
        u2 = r * u2
        g1, g2 = e * (u1 + u2), u1 + r * u2
        return f / (g1 + sqrt(g1 * g1 + f * g2))

    return Formulas(product, quotient, excess, close_excess, on_grid, direction, start, root, turned, multiplier, of_bits)


# -- the closest point to one trial on four quarter ellipses: compiled as a part of :mod:`duhem.projection.compiled`, or run as it is


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
